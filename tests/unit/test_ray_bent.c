/*
 * Bent rays (kernels/ray_bent.h) against the equation of rays, integrated by steps of Runge and Kutta, and
 * against differences between neighbouring rays. Nothing here knows of circles or lifts.
 */
#define ASDIC_BENT 1
#include "asserts.h"

#define any_true(m) (m)
#include "../../kernels/sampler.h"

#define RAYS 400
#define SPEED 1480.0 /* m/s at depth 0 */

static const double gradients[] = {-1.0, -0.3, -0.016, 1e-4, 0.016, 0.3, 1.0};
#define GRADIENTS (sizeof gradients / sizeof *gradients)

static double draw(unsigned *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state * 0x1p-32;
}

/* Where a ray is: place, direction, travel time and length of its path. */
typedef struct travel {
    double x[3], u[3], time, length;
} travel;

/* d/dl of all that: du/dl = (u (u . grad c) - grad c) / c. */
static travel rate(const travel *at, double g) {
    double c = SPEED + g * at->x[2], along = g * at->u[2];
    travel d = {.time = 1.0 / c, .length = 1.0};
    for (int k = 0; k < 3; k++) {
        d.x[k] = at->u[k];
        d.u[k] = (at->u[k] * along - (k == 2 ? g : 0.0)) / c;
    }
    return d;
}

static travel advanced(const travel *at, const travel *d, double step) {
    travel to = *at;
    for (int k = 0; k < 3; k++) {
        to.x[k] += step * d->x[k];
        to.u[k] += step * d->u[k];
    }
    to.time += step * d->time;
    to.length += step * d->length;
    return to;
}

static travel stepped(const travel *at, double g, double step) {
    travel a = rate(at, g), to = advanced(at, &a, 0.5 * step);
    travel b = rate(&to, g);
    to = advanced(at, &b, 0.5 * step);
    travel c = rate(&to, g);
    to = advanced(at, &c, step);
    travel d = rate(&to, g), sum = {.time = 0.0};
    for (int k = 0; k < 3; k++) {
        sum.x[k] = (a.x[k] + 2.0 * (b.x[k] + c.x[k]) + d.x[k]) / 6.0;
        sum.u[k] = (a.u[k] + 2.0 * (b.u[k] + c.u[k]) + d.u[k]) / 6.0;
    }
    sum.time = (a.time + 2.0 * (b.time + c.time) + d.time) / 6.0;
    sum.length = 1.0;
    return advanced(at, &sum, step);
}

/* Along R for LENGTH. */
static travel travelled(const ray *r, double g, double length) {
    enum { STEPS = 400 };
    travel at = {{r->from.x, r->from.y, r->from.z}, {r->u.x, r->u.y, r->u.z}, 0.0, 0.0};
    for (int i = 0; i < STEPS; i++) {
        at = stepped(&at, g, length / STEPS);
    }
    return at;
}

static ray_medium water_of(double g, double sonar_depth) {
    return (ray_medium){g / SPEED, 1.0 + g / SPEED * sonar_depth};
}

/* Elevations include the horizontal, the vertical and what is nearly so. */
static ray drawn(unsigned *state, ray_medium water) {
    static const double hard[] = {0.0, 1e-9, 0.5, 1.0 - 1e-12, 1.0, -1e-9, -1.0};
    double nth = draw(state), z = 2.0 * draw(state) - 1.0;
    if (nth < 0.35) {
        z = hard[(int)(20.0 * nth)];
    }
    double phi = 2.0 * R_PI * draw(state), m = sqrt((1.0 - z) * (1.0 + z));
    triple from = {40.0 * draw(state), -50.0 * draw(state), 30.0 * draw(state)};
    return ray_start(from, (triple){m * cos(phi), m * sin(phi), z}, water);
}

static triple minus(triple a, triple b) {
    return (triple){a.x - b.x, a.y - b.y, a.z - b.z};
}

static double apart(triple a, const double b[3]) {
    return sqrt(pow(a.x - b[0], 2.0) + pow(a.y - b[1], 2.0) + pow(a.z - b[2], 2.0));
}

/* Place, direction, travel time and losses at a range are those of the integrated ray. */
static void rays_solve_their_equation(void **state) {
    unsigned seed = 1;
    (void)state;
    for (int i = 0; i < RAYS; i++) {
        double g = gradients[i % GRADIENTS], depth = 25.0 * draw(&seed), k = 0.004;
        ray_medium water = water_of(g, depth);
        ray r = drawn(&seed, water);
        travel end = travelled(&r, g, 0.01 + 300.0 * draw(&seed));
        double range = SPEED * water.sonar * end.time, t = ray_at_range(&r, range);
        triple p = ray_point(&r, t), u = ray_direction(&r, t), back = ray_back(&r, t);
        assert_close(ray_range(&r, t), range, 1e-10 * range);
        assert_close(apart(p, end.x), 0.0, 1e-8);
        assert_close(apart(u, end.u), 0.0, 1e-10);
        assert_close(dot3(u, u), 1.0, 1e-13);
        assert_close(dot3(u, back), -1.0, 1e-13);
        double spread = range / t * (SPEED + g * p.z) / (SPEED * water.sonar);
        double loss = spread * spread * exp(-2.0 * k * (end.length - range));
        assert_close(ray_bending(&r, t, range, -2.0 * k), loss, 1e-6 * loss);
        /* The same way from its ends, and back. */
        ray_way there = ray_between(r.from, p, water, 0.0),
                home = ray_between(p, r.from, water, 0.0);
        assert_close(there.t, t, 1e-10 * t);
        assert_close(dot3(there.r.u, r.u), 1.0, 1e-12);
        assert_close(ray_range(&home.r, home.t), range, 1e-10 * range);
        assert_close(dot3(home.r.u, back), 1.0, 1e-12);
    }
}

/* Lifted rays are straight, T measures them, and the lift can be undone. */
static void lifted_rays_are_straight(void **state) {
    unsigned seed = 2;
    (void)state;
    for (int i = 0; i < RAYS; i++) {
        ray_medium water = water_of(gradients[i % GRADIENTS], 10.0);
        ray r = drawn(&seed, water);
        double t = 300.0 * draw(&seed);
        triple p = ray_point(&r, t), end = ray_lift(p, water), start = ray_lift(r.from, water);
        triple d = ray_traced(&r, water), same = ray_unlift(end, water);
        assert_close(end.x - start.x, t * d.x, 1e-11 * (1.0 + t));
        assert_close(end.y - start.y, t * d.y, 1e-11 * (1.0 + t));
        assert_close(end.z - start.z, t * d.z, 1e-11 * (1.0 + t));
        assert_close(apart(same, (double[]){p.x, p.y, p.z}), 0.0, 1e-11);
        ray again = ray_of_traced(r.from, d, water);
        assert_close(apart(again.u, (double[]){r.u.x, r.u.y, r.u.z}), 0.0, 1e-14);
    }
}

/* Neighbouring rays lie T times their angle apart, and 1 / sin of the grazing angle on a plane. */
static void tubes_are_as_wide_as_t(void **state) {
    unsigned seed = 3;
    int tried = 0;
    (void)state;
    while (tried < RAYS) {
        double g = gradients[tried % GRADIENTS], step = 1e-5, e = 2.6 * (draw(&seed) - 0.5);
        ray_medium water = water_of(g, 10.0);
        triple from = {3.0, 4.0, 12.0}, n = drawn(&seed, water).u, on[2];
        double t = 1.0 + 150.0 * draw(&seed), phi = 6.2 * draw(&seed), range[2];
        ray middle = ray_start(from, (triple){cos(e) * cos(phi), cos(e) * sin(phi), sin(e)}, water);
        triple arriving = ray_direction(&middle, t), place = ray_point(&middle, t);
        double sine = fabs(dot3(arriving, n));
        if (sine < 0.1) {
            continue;
        }
        for (int k = 0; k < 2;
             k++) { /* onto the plane, by steps of Newton that the function takes */
            double at = e + (k - 0.5) * step, near = t;
            triple u = {cos(at) * cos(phi), cos(at) * sin(phi), sin(at)};
            ray r = ray_start(from, u, water);
            for (int i = 0; i < 4; i++) {
                near = ray_onto(&r, near, place, n);
            }
            on[k] = ray_point(&r, near);
            assert_close((on[k].x - place.x) * n.x + (on[k].y - place.y) * n.y +
                             (on[k].z - place.z) * n.z,
                         0.0, 1e-10);
            range[k] = ray_range(&r, near);
        }
        double footprint = ray_footprint(&middle, t, step, n, sine);
        assert_close(footprint, fabs(range[1] - range[0]), 1e-4 * step * t / sine);
        triple move = {on[1].x - on[0].x, on[1].y - on[0].y, on[1].z - on[0].z};
        triple across = cross3(move, arriving);
        assert_close(sqrt(dot3(across, across)), t * step, 1e-4 * t * step);
        tried++;
    }
}

/* A ray meets a plane where it says, both ways round; shares of rays are differences of sines. */
static void rays_meet_planes_where_they_say(void **state) {
    unsigned seed = 4;
    int turned = 0, missed = 0;
    (void)state;
    for (int i = 0; i < 20 * RAYS; i++) {
        double g = gradients[i % GRADIENTS], h = 0.1 + 20.0 * draw(&seed),
               z = 0.3 * draw(&seed) - 0.15;
        ray_medium water = water_of(g, 30.0);
        double bend = ray_bend(30.0, water), m = sqrt(1.0 - z * z);
        ray r = ray_start((triple){0.0, 0.0, 30.0}, (triple){m, 0.0, z}, water);
        double down = ray_to_plane(h, z, bend), up = ray_to_plane(h, -z, -bend);
        if (down < 700.0) {
            assert_close(ray_point(&r, down).z, 30.0 + h, 1e-8);
            assert_true(ray_point(&r, 0.999 * down).z < 30.0 + h); /* the first time */
            double range = ray_range(&r, down);
            assert_close(ray_plane_range(h, z, bend), range, 1e-9 * range);
            assert_close(ray_plane_sine(h, range, bend), z, 1e-9);
            turned += z < 0.0;
            double step = 1e-4, density = ray_plane_density(0.3, range, h, 1.0, 99.0, bend);
            double sines =
                ray_plane_sine(h, range - step, bend) - ray_plane_sine(h, range + step, bend);
            if (sines > 1e-4 * step) {
                assert_close(density * sines, 0.3 * 2.0 * step / 98.0, 1e-3 * step);
            }
        } else {
            missed += ray_point(&r, 100.0).z < 30.0 + h;
        }
        if (up < 700.0) {
            assert_close(ray_point(&r, up).z, 30.0 - h, 1e-8);
        }
        assert_true(ray_to_plane(INFINITY, z, bend) < 1.0 ? false : true);
    }
    assert_true(turned > 100 && missed > 100);
    assert_true(ray_to_plane(5.0, 0.0, 0.0) == INFINITY);
}

/* Where a ray is at RANGE, re the sound speed of its start, by way of a flat mirror through PLACE. */
static triple over_mirror(const ray *first, triple place, triple n, double range, ray_medium water,
                          triple *direction) {
    double t =
        dot3((triple){place.x - first->from.x, place.y - first->from.y, place.z - first->from.z},
             n) /
        dot3(first->u, n);
    for (int i = 0; i < 8; i++) {
        t = ray_onto(first, t, place, n);
    }
    triple u = ray_direction(first, t);
    double along = dot3(u, n);
    triple to = {u.x - 2.0 * along * n.x, u.y - 2.0 * along * n.y, u.z - 2.0 * along * n.z};
    ray second = ray_start(ray_point(first, t), to, water);
    double t2 = ray_at_range(&second, range - ray_range(first, t));
    *direction = ray_direction(&second, t2);
    return ray_point(&second, t2);
}

/* Over a flat mirror of any slope, the cross-section of a tube is what the mirror's gain says, whose water
 * makes a curved one of it. */
static void mirrors_bend_tubes_as_they_say(void **state) {
    unsigned seed = 6;
    double worst = 0.0, plain = 0.0;
    int tried = 0;
    (void)state;
    while (tried < RAYS) {
        const double g = tried % 2 ? 1.0 : -1.0, depth = 20.0, step = 1e-5;
        ray_medium water = water_of(g, depth);
        triple n = tried % 3 ? drawn(&seed, water).u : (triple){0.0, 0.0, tried % 2 ? -1.0 : 1.0};
        double e = 1.2 * (draw(&seed) - 0.5), t1 = 5.0 + 60.0 * draw(&seed);
        ray first = ray_start((triple){0.0, 0.0, depth}, (triple){cos(e), 0.0, sin(e)}, water);
        double along = dot3(ray_direction(&first, t1), n), d1 = ray_range(&first, t1);
        double side = along > 0.0 ? -1.0 : 1.0, d2 = 5.0 + 60.0 * draw(&seed);
        if (fabs(along) < 0.1) {
            continue;
        }
        triple place = ray_point(&first, t1), at[3], u[3];
        for (int k = 0; k < 3; k++) { /* itself, one a step down, one a step aside */
            double down = e + (k == 1 ? step : 0.0), phi = k == 2 ? step / cos(e) : 0.0;
            ray r = ray_start(
                first.from, (triple){cos(down) * cos(phi), cos(down) * sin(phi), sin(down)}, water);
            at[k] = over_mirror(&r, place, n, d1 + d2, water, &u[k]);
        }
        triple a = minus(at[1], at[0]), b = minus(at[2], at[0]);
        double area = fabs(dot3(cross3(a, b), u[0])) / (step * step);
        double q = (1.0 + water.bend * at[0].z) / water.sonar, x = first.bend * (d1 + d2);
        double spread = (d1 + d2) * bent_sinh(x * x);
        ray_turn turn = ray_mirror_turn(&first, n, along, side);
        double should = q * q * spread * spread;
        plain = fmax(plain, fabs(should / area - 1.0));
        should /= ray_mirror_gain(d1, d2, turn.trace, turn.gauss);
        worst = fmax(worst, fabs(should / area - 1.0));
        tried++;
    }
    print_message("tubes over mirrors: within %.4f; without the water's turn within %.3f\n", worst,
                  plain);
    assert_true(worst < 0.01 && plain > 0.1);
}

/* Of a plane of any slope that a ray meets, the place that is nearest in range: that of all of a net round the foot of
 * the perpendicular, finer and finer. */
static double brute_nearest(triple from, triple foot, triple n, double size, ray_medium water) {
    triple a = fabs(n.x) < 0.6 ? (triple){1.0, 0.0, 0.0} : (triple){0.0, 1.0, 0.0};
    triple u = cross3(n, a), v = cross3(n, u), best = foot;
    double least = INFINITY;
    for (; size > 1e-4; size *= 0.7) {
        triple middle = best;
        for (int k = 0; k < 9; k++) {
            double x = size * (k % 3 - 1), y = size * (k / 3 - 1);
            triple to = {middle.x + x * u.x + y * v.x, middle.y + x * u.y + y * v.y,
                         middle.z + x * u.z + y * v.z};
            ray_way way = ray_between(from, to, water, 1e-9);
            double range = ray_range(&way.r, way.t);
            best = range < least ? to : best;
            least = fmin(range, least);
        }
    }
    return least;
}

static void the_nearest_of_a_plane_is_found(void **state) {
    unsigned seed = 8;
    int tried = 0;
    (void)state;
    while (tried < RAYS) {
        const double g = 0.3 * gradients[tried % GRADIENTS], t = 2.0 + 40.0 * draw(&seed);
        ray_medium water = water_of(g, 20.0);
        triple n = drawn(&seed, water).u;
        double e = 2.8 * (draw(&seed) - 0.5);
        ray r = ray_start((triple){0.0, 0.0, 20.0}, (triple){cos(e), 0.0, sin(e)}, water);
        triple met = ray_point(&r, t);
        double off = dot3(minus(met, r.from), n), range = ray_range(&r, t);
        double sine = fabs(dot3(ray_direction(&r, t), n));
        if (fabs(off) < 0.3 * t) {
            continue; /* a flat ray's is cut at the ray's own range, or far from it */
        }
        triple foot = {r.from.x + off * n.x, r.from.y + off * n.y, r.from.z + off * n.z};
        double least = brute_nearest(r.from, foot, n, 0.5 * t, water);
        assert_close(ray_plane_nearest(&r, t, range, n, sine), 1.0000005 * least, 1e-5 * least);
        r.across = 1e-3; /* behind a layer's edge: as in water that does not bend */
        assert_close(ray_plane_nearest(&r, t, range, n, sine), fmin(range * sine, range),
                     1e-6 * range);
        tried++;
    }
    /* Straight down, in water that bends much: as long as sound takes at the speed at the sonar, c ln(c' / c) / g. */
    for (double g = -10.0; g <= 10.0; g += 4.0) {
        ray_medium water = water_of(g, 20.0);
        ray r = ray_start((triple){0.0, 0.0, 20.0}, (triple){0.0, 0.0, 1.0}, water);
        double t = 40.0, z = ray_point(&r, t).z, c = SPEED + g * 20.0;
        double least = c * log((SPEED + g * z) / c) / g;
        assert_close(ray_plane_nearest(&r, t, 1e3, (triple){0.0, 0.0, 1.0}, 1.0), least,
                     5e-4 * least);
    }
}

/* Without a gradient, and as it goes to nothing, rays are straight. */
static void no_gradient_is_straight(void **state) {
    unsigned seed = 5;
    (void)state;
    for (int i = 0; i < RAYS; i++) {
        static const double least[] = {0.0, 1e-300, -1e-300, 1e-12, -1e-12};
        double g = least[i % 5];
        ray r = drawn(&seed, water_of(g, 3.0));
        double t = 400.0 * draw(&seed);
        triple p = ray_point(&r, t), u = ray_direction(&r, t);
        const double straight[] = {r.from.x + t * r.u.x, r.from.y + t * r.u.y,
                                   r.from.z + t * r.u.z};
        assert_close(apart(p, straight), 0.0, 1e-9);
        assert_close(dot3(u, r.u), 1.0, 1e-9);
        assert_close(ray_range(&r, t), t, 1e-9);
        assert_close(ray_at_range(&r, t), t, 1e-9);
        assert_close(ray_bending(&r, t, t, -0.01), 1.0, 1e-9);
    }
}

/* The adaptive sampler's elevations run from nadir to zenith, by the density that they say, without a gap and without
 * coming twice; and x is found again. */
static void elevations_have_their_densities(void **state) {
    enum { STEPS = 20000 };
    (void)state;
    for (size_t i = 0; i < GRADIENTS; i++) {
        float bend = (float)ray_bend(12.0, water_of(gradients[i], 12.0));
        dev_ping ping = {.origin = {0.0f, 0.0f, 12.0f},
                         .sampling.zones = {.bottom_m = 20.0f,
                                            .surface_m = 12.0f,
                                            .bottom_bend_per_m = bend,
                                            .surface_bend_per_m = -bend,
                                            .bottom_far_m = 70.0f,
                                            .surface_far_m = 60.0f,
                                            .cap_rad = 0.1745f,
                                            .share = {0.03f, 0.57f, 0.07f, 0.30f, 0.03f}}};
        double above = 1.0, all = 0.0;
        for (int k = 0; k < STEPS; k++) {
            double x = (k + 0.5) / STEPS, density = 0.0;
            elevation e = elevation_of_x(&ping, x);
            assert_close(x_of_elevation(&ping, e.uz, e.across, &density), x, 1e-6);
            assert_close(density, e.density, 1e-5 * density);
            assert_close(e.uz * e.uz + e.across * e.across, 1.0, 1e-9);
            assert_true(e.uz < above);
            above = e.uz;
            all += 1.0 / (density * STEPS);
        }
        print_message("%6.3f 1/s: sines from -1 to 1 measure %.7f\n", gradients[i], all);
        assert_close(all, 2.0, 1e-4);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_solve_their_equation),
        cmocka_unit_test(lifted_rays_are_straight),
        cmocka_unit_test(tubes_are_as_wide_as_t),
        cmocka_unit_test(rays_meet_planes_where_they_say),
        cmocka_unit_test(mirrors_bend_tubes_as_they_say),
        cmocka_unit_test(the_nearest_of_a_plane_is_found),
        cmocka_unit_test(no_gradient_is_straight),
        cmocka_unit_test(elevations_have_their_densities),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
