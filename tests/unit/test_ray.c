/*
 * The geometry of rays (kernels/ray.h) against constructions of its own kind: points, finite differences,
 * sums. Every water has to pass these, but for where a comment says that it takes rays to be straight.
 */
#include "asserts.h"

#include "../../kernels/ray.h"

#define RAYS 2000

static const ray_medium STILL = {0.0, 1.0};

/* Evenly irregular numbers in [0, 1). */
static double draw(unsigned *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state * 0x1p-32;
}

static triple direction(unsigned *state) {
    double z = 2.0 * draw(state) - 1.0, phi = 2.0 * R_PI * draw(state), m = sqrt(1.0 - z * z);
    return (triple){m * cos(phi), m * sin(phi), z};
}

static triple minus(triple a, triple b) {
    return (triple){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* From a point to where a ray comes, a ray leaves the same way, takes as long, and comes back. */
static void a_way_is_the_ray_to_its_point(void **state) {
    unsigned seed = 1;
    (void)state;
    for (int i = 0; i < RAYS; i++) {
        triple from = {100.0 * draw(&seed), -50.0 * draw(&seed), 30.0 * draw(&seed)};
        ray r = ray_start(from, direction(&seed), STILL);
        double t = 0.01 + 300.0 * draw(&seed);
        triple p = ray_point(&r, t);
        ray_way there = ray_between(r.from, p, STILL, 0.0),
                home = ray_between(p, r.from, STILL, 0.0);
        assert_close(there.t, t, 1e-12 * t);
        assert_close(home.t, t, 1e-12 * t);
        assert_close(dot3(there.r.u, r.u), 1.0, 1e-12);
        assert_close(dot3(home.r.u, ray_back(&r, t)), 1.0, 1e-12);
        assert_close(ray_range(&there.r, there.t), ray_range(&home.r, home.t), 1e-9);
        assert_close(ray_at_range(&r, ray_range(&r, t)), t, 1e-9);
        triple on = ray_point(&r, t + 1e-4), last = ray_direction(&r, t);
        assert_close(dot3(minus(on, p), last), 1e-4, 1e-9);
    }
}

/* Seen from the ray's end on a plane 3 m away, after 5 m: the triangle of 3, 4 and 5. */
static void elevations_are_of_triangles(void **state) {
    (void)state;
    assert_close(ray_plane_elevation(3.0, 5.0), asin(0.6), 1e-15);
    assert_close(ray_plane_elevation(3.0, 3.0), 0.5 * R_PI, 1e-15);
    assert_close(ray_plane_elevation(3.0, 2.0), 0.5 * R_PI, 1e-15);
}

/* A ray with a plane's sine at a range comes to that plane at that range, at that grazing angle. */
static void rays_meet_planes_where_they_say(void **state) {
    unsigned seed = 2;
    (void)state;
    for (int i = 0; i < RAYS; i++) {
        double h = 0.1 + 20.0 * draw(&seed), range = h * (1.0 + 30.0 * draw(&seed));
        double sine = ray_plane_sine(h, range, 0.0);
        ray r =
            ray_start((triple){0.0, 0.0, 3.0}, (triple){sqrt(1.0 - sine * sine), 0.0, sine}, STILL);
        double t = ray_to_plane(h, sine, 0.0);
        assert_close(ray_point(&r, t).z - r.from.z, h, 1e-9);
        assert_close(ray_range(&r, t), range, 1e-9 * range);
        assert_close(ray_plane_range(h, sine, 0.0), range, 1e-9 * range);
        assert_close(ray_direction(&r, t).z, ray_plane_grazing(h, range), 1e-12);
        assert_close(sin(ray_plane_elevation(h, range)), sine, 1e-12);
        /* Shares of rays: density over the sine times the sine's step is the part of the ranges. */
        double near = h, far = 40.0 * h, step = 1e-6 * range;
        double sines = ray_plane_sine(h, range - step, 0.0) - ray_plane_sine(h, range + step, 0.0);
        double density = ray_plane_density(0.3, range, h, near, far, 0.0);
        assert_close(density * sines, 0.3 * 2.0 * step / (far - near), 1e-6 * step / h);
        /* Rings: their area between two coordinates is that between two circles. */
        double s = ray_ring_coordinate(h, range), ds = 1e-4;
        ray_ring ring = ray_ring_at(h, s), inner = ray_ring_at(h, s - ds),
                 outer = ray_ring_at(h, s + ds);
        double circles = outer.range * outer.range - inner.range * inner.range;
        assert_close(ring.range, range, 1e-9 * range);
        assert_close(ring.area * 2.0 * ds, 0.5 * circles, 1e-6 * range);
    }
}

/* A step in elevation moves the point on a tilted plane by the footprint, and turns area to solid angle. */
static void footprints_are_differences(void **state) {
    unsigned seed = 3;
    int tried = 0;
    (void)state;
    while (tried < RAYS) {
        double e = 3.0 * (draw(&seed) - 0.5), phi = 6.2 * draw(&seed), t = 1.0 + 50.0 * draw(&seed);
        triple n = direction(&seed);
        double range[2], step = 1e-6;
        ray r =
            ray_start((triple){0}, (triple){cos(e) * cos(phi), cos(e) * sin(phi), sin(e)}, STILL);
        double sine = fabs(dot3(r.u, n));
        if (sine < 0.05 || cos(e) < 0.05) {
            continue;
        }
        double height = dot3(ray_point(&r, t), n);
        for (int k = 0; k < 2; k++) {
            double at = e + (k - 0.5) * step;
            triple u = {cos(at) * cos(phi), cos(at) * sin(phi), sin(at)};
            range[k] = height / dot3(u, n);
        }
        assert_close(ray_footprint(&r, t, step, n, sine), fabs(range[1] - range[0]),
                     1e-5 * step * t / sine);
        /* One square metre's density is that of its solid angle, cos / d^2. */
        assert_close(ray_per_steradian(&r, t, 1.0, sine), t * t / sine, 1e-9 * t * t / sine);
        tried++;
    }
}

static double simpson(double k, double begin, double end) {
    const int steps = 4000;
    double sum = 0.0, h = (end - begin) / steps;
    for (int i = 0; i <= steps; i++) {
        double weight = i == 0 || i == steps ? 1.0 : i % 2 ? 4.0 : 2.0;
        sum += weight * ray_tube_loss(k, begin + i * h);
    }
    return sum * h / 3.0;
}

/* Water between two ranges is the integral of the loss, and its parts are what is left of it. */
static void water_is_the_integral_of_the_loss(void **state) {
    static const double bins[][2] = {
        {0.5, 1.0}, {1.0, 1.5}, {10.0, 10.5}, {99.0, 100.0}, {0.1, 0.2}};
    static const double absorptions[] = {0.0, 1e-3, 0.05};
    (void)state;
    for (size_t i = 0; i < sizeof bins / sizeof *bins; i++) {
        for (int a = 0; a < 3; a++) {
            double k = absorptions[a], begin = bins[i][0], end = bins[i][1];
            double center = 0.5 * (begin + end), whole = simpson(k, begin, end);
            assert_close(ray_water(k, begin, end), whole, 1e-6 * whole);
            double cut = begin + 0.3 * (end - begin), part = simpson(k, begin, cut);
            double scaled =
                ray_water_part(-2.0 * k, begin, cut, center) * exp(-2.0 * k * (center - 1.0));
            assert_close(scaled, part, 2e-4 * part);
            double ratio = ray_tube_loss(k, cut) / ray_tube_loss(k, center);
            assert_close(ray_relative_loss(-2.0 * k, cut, center), ratio, 1e-12 * ratio);
            double area = ray_tube_area(cut) * ray_transmission(k, cut);
            assert_close(ray_tube_loss(k, cut), area, 1e-12 * area);
        }
    }
}

/* What lies at a mirror ray's reach is as far over the mirror and back as it says. */
static void mirrors_reach_as_far_as_they_say(void **state) {
    unsigned seed = 4;
    (void)state;
    for (int i = 0; i < RAYS; i++) {
        triple u = direction(&seed), v = direction(&seed);
        double t1 = 0.5 + 40.0 * draw(&seed), rest = t1 * (1.01 + 5.0 * draw(&seed));
        ray first = ray_start((triple){0}, u, STILL);
        ray second = ray_start(ray_point(&first, t1), v, STILL);
        double t2 = ray_mirror_reach(rest, t1, dot3(u, v));
        triple x = ray_point(&second, t2), sonar = {0.0, 0.0, 0.0};
        assert_close(t2 + ray_between(x, sonar, STILL, 0.0).t, rest, 1e-9 * rest);
    }
}

/* A convex sphere of radius A at normal incidence: the image lies d1 a / (a + 2 d1) behind it, so that what
 * spreads from there has spread over D + 2 d1 d2 / a. Nothing changes at a flat mirror. */
static void mirrors_spread_as_images_do(void **state) {
    unsigned seed = 5;
    (void)state;
    for (int i = 0; i < RAYS; i++) {
        double d1 = 1.0 + 50.0 * draw(&seed), d2 = 0.1 + 20.0 * draw(&seed);
        double a = 0.2 + 10.0 * draw(&seed), image = d1 * a / (a + 2.0 * d1);
        double spread = d1 * (image + d2) / image, plain = (d1 + d2) * (d1 + d2);
        double gain = plain / (spread * spread);
        assert_close(ray_mirror_gain(d1, d2, 2.0 / a, 1.0 / (a * a)), gain, 1e-9 * gain);
        assert_close(ray_mirror_gain(d1, d2, 0.0, 0.0), 1.0, 1e-12);
    }
}

/* Where no water bends rays, one has no room for more than a line. */
static void straight_rays_know_no_water(void **state) {
    (void)state;
    assert_int_equal(sizeof(ray), 2 * sizeof(triple) + 2 * sizeof(real));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_way_is_the_ray_to_its_point),
        cmocka_unit_test(elevations_are_of_triangles),
        cmocka_unit_test(rays_meet_planes_where_they_say),
        cmocka_unit_test(footprints_are_differences),
        cmocka_unit_test(water_is_the_integral_of_the_loss),
        cmocka_unit_test(mirrors_reach_as_far_as_they_say),
        cmocka_unit_test(mirrors_spread_as_images_do),
        cmocka_unit_test(straight_rays_know_no_water),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
