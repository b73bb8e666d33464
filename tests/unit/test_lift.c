/*
 * The lift of one layer (kernels/lift.h) against rays that a Runge-Kutta integrator follows through
 * c(z) = c0 (1 + k z), which knows nothing of circles.
 */
#include "asserts.h"
#include "one_layer.h"

#define STEP_M 0.05
#define STEPS 4400 /* 220 m */

/* 0 on its own, both signs of what is next to nothing, and of what lakes have. */
static const double gradients[] = {0.0, 1e-15, -1e-15, 1e-6, -1e-6, 0.016, 0.3, -0.3, 1.0, -1.0};
#define GRADIENTS (sizeof gradients / sizeof *gradients)
#define C0 1490.0

/* Evenly irregular numbers in [0, 1). */
static double draw(unsigned *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state * 0x1p-32;
}

static triple direction(unsigned *state) {
    double z = 2.0 * draw(state) - 1.0, phi = 2.0 * R_PI * draw(state), m = sqrt(1.0 - z * z);
    return (triple){m * cos(phi), m * sin(phi), z};
}

/* Place, direction, and c0 times the time that it took. */
typedef struct traced {
    long double at[3], u[3], time;
} traced;

/* d/ds of all: dx/ds = u, du/ds = -(grad c - u (u grad c)) / c, dt/ds = 1 / c. */
static void slope(long double k, const traced *r, traced *out) {
    long double n = 1.0L + k * r->at[2];
    for (int i = 0; i < 3; i++) {
        out->at[i] = r->u[i];
        out->u[i] = k / n * (r->u[i] * r->u[2] - (i == 2 ? 1.0L : 0.0L));
    }
    out->time = 1.0L / n;
}

static void move(const traced *from, const traced *by, long double h, traced *out) {
    for (int i = 0; i < 3; i++) {
        out->at[i] = from->at[i] + h * by->at[i];
        out->u[i] = from->u[i] + h * by->u[i];
    }
    out->time = from->time + h * by->time;
}

static void step(long double k, long double h, traced *r) {
    traced a, b, c, d, at;
    slope(k, r, &a);
    move(r, &a, 0.5L * h, &at);
    slope(k, &at, &b);
    move(r, &b, 0.5L * h, &at);
    slope(k, &at, &c);
    move(r, &c, h, &at);
    slope(k, &at, &d);
    move(r, &a, h / 6.0L, r);
    move(r, &b, h / 3.0L, r);
    move(r, &c, h / 3.0L, r);
    move(r, &d, h / 6.0L, r);
}

static traced start(triple from, triple u) {
    return (traced){{from.x, from.y, from.z}, {u.x, u.y, u.z}, 0.0};
}

static traced trace(double k, triple from, triple u, int steps) {
    traced r = start(from, u);
    for (int i = 0; i < steps; i++) {
        step(k, STEP_M, &r);
    }
    return r;
}

static triple place(const traced *r) {
    return (triple){(double)r->at[0], (double)r->at[1], (double)r->at[2]};
}

static triple heading(const traced *r) {
    return (triple){(double)r->u[0], (double)r->u[1], (double)r->u[2]};
}

static triple minus(triple a, triple b) {
    return (triple){a.x - b.x, a.y - b.y, a.z - b.z};
}

static double length(triple a) {
    return sqrt(dot3(a, a));
}

static triple scaled(triple a, double by) {
    return (triple){a.x * by, a.y * by, a.z * by};
}

/* Rays from anywhere in any direction: their lifted points lie on the line of the lifted launch. */
static void rays_are_straight_where_they_are_lifted(void **state) {
    unsigned seed = 1;
    double worst = 0.0;
    (void)state;
    for (size_t g = 0; g < GRADIENTS; g++) {
        double k = gradients[g] / C0;
        for (int ray = 0; ray < 6; ray++) {
            triple from = {80.0 * draw(&seed) - 40.0, 60.0 * draw(&seed), 30.0 * draw(&seed)};
            triple u = direction(&seed), first = lift_point(k, from);
            triple along = lift_direction(k, from, u);
            along = scaled(along, 1.0 / length(along));
            traced r = start(from, u);
            for (int i = 1; i <= STEPS; i++) {
                step(k, STEP_M, &r);
                if (i % 440 == 0) {
                    triple way = minus(lift_point(k, place(&r)), first);
                    worst = fmax(worst, length(cross3(way, along)));
                }
            }
        }
    }
    print_message("off the line by %.2g m at most\n", worst);
    assert_true(worst < 2e-12);
}

/* Points, directions and normals come back from the lift. */
static void the_lift_comes_back(void **state) {
    unsigned seed = 2;
    (void)state;
    for (int i = 0; i < 4000; i++) {
        double k = gradients[i % GRADIENTS] / C0;
        triple p = {400.0 * draw(&seed) - 200.0, 300.0 * draw(&seed), 60.0 * draw(&seed)};
        triple u = direction(&seed), v = direction(&seed);
        triple lifted = lift_point(k, p), back = lift_back(k, lifted);
        assert_close(length(minus(back, p)), 0.0, 1e-12 * 400.0);
        assert_close(lift_speed(k, lifted), 1.0 + k * p.z, 1e-14);
        triple home = lift_direction_back(k, p, lift_direction(k, p, scaled(u, 3.0)));
        assert_close(length(minus(home, u)), 0.0, 1e-13);
        /* A normal is across the steps that a surface holds, lifted or not. */
        triple a = lift_direction(k, p, u), b = lift_direction(k, p, v), n = cross3(u, v);
        triple normal = lift_normal_back(k, p, cross3(a, b));
        assert_close(length(cross3(normal, n)) / length(n), 0.0, 1e-11);
        assert_true(dot3(normal, n) > 0.0);
    }
}

/* Time and arc of the way between two points of a traced ray. */
static void time_and_arc_are_those_of_a_traced_ray(void **state) {
    unsigned seed = 3;
    (void)state;
    for (int i = 0; i < 60; i++) {
        double k = gradients[i % GRADIENTS] / C0;
        triple from = {0.0, 0.0, 40.0 * draw(&seed)}, u = direction(&seed);
        u = i % 7 == 0 ? (triple){0.0, 0.0, 1.0} : i % 7 == 1 ? (triple){1.0, 0.0, 0.0} : u;
        int steps = 1 + (int)(STEPS * draw(&seed));
        traced r = trace(k, from, u, steps);
        double distance = length(minus(place(&r), from));
        double n0 = 1.0 + k * from.z, n1 = 1.0 + k * (double)r.at[2];
        assert_close_relative(lift_time(k, distance, n0, n1), (double)r.time, 1e-13);
        assert_close_relative(lift_length(k, distance, n0, hypot(u.x, u.y)), steps * STEP_M, 1e-12);
        assert_close_relative(lift_distance(k, (double)r.time, n0, n1), distance, 1e-13);
    }
}

/* A tube of three traced rays: its cross-section by finite differences. Spreading is the same from
 * either end: the cross-section from 0 by n0 / n1 is that from 1 by n1 / n0. */
static void spreading_is_that_of_a_traced_tube(void **state) {
    const double apart = 1e-4;
    unsigned seed = 4;
    (void)state;
    for (int i = 0; i < 60; i++) {
        double k = gradients[i % GRADIENTS] / C0;
        triple from = {0.0, 0.0, 40.0 * draw(&seed)}, u = direction(&seed);
        triple side = cross3(u, (triple){0.3, -0.2, 0.9}), up;
        side = scaled(side, 1.0 / length(side));
        up = cross3(u, side);
        int steps = 20 + (int)(STEPS * draw(&seed));
        traced end = trace(k, from, u, steps), pair[2];
        triple wide[2];
        for (int axis = 0; axis < 2; axis++) {
            triple by = axis ? up : side;
            for (int sign = 0; sign < 2; sign++) {
                double angle = sign ? -apart : apart;
                triple v = {u.x * cos(angle) + by.x * sin(angle),
                            u.y * cos(angle) + by.y * sin(angle),
                            u.z * cos(angle) + by.z * sin(angle)};
                pair[sign] = trace(k, from, v, steps);
            }
            wide[axis] = scaled(minus(place(&pair[0]), place(&pair[1])), 0.5 / apart);
        }
        double area = fabs(dot3(cross3(wide[0], wide[1]), heading(&end)));
        double distance = length(minus(place(&end), from));
        double n0 = 1.0 + k * from.z, n1 = 1.0 + k * (double)end.at[2];
        assert_close_relative(lift_tube_area(k, distance, n0, n1), area, 2e-8);
        double spread = lift_spread(k, distance, n0, n1);
        assert_close_relative(spread * spread, area * n0 / n1, 2e-8);
    }
}

/* As k -> 0 with either sign every form goes over into that of straight rays, to rounding. */
static void nothing_is_lost_as_the_gradient_goes(void **state) {
    (void)state;
    for (double g = 1e-3; g > 1e-300; g *= 1e-3) {
        for (int sign = -1; sign <= 1; sign += 2) {
            double k = sign * g / C0, d = 137.0, most = fmax(fabs(k) * d, 1e-16) * 2.0;
            assert_close(lift_time(k, d, 1.0, 1.0) / d, 1.0, most);
            assert_close(lift_length(k, d, 1.0, 1.0) / d, 1.0, most);
            assert_close(lift_spread(k, d, 1.0, 1.0) / d, 1.0, most);
            assert_close(lift_tube_area(k, d, 1.0, 1.0) / (d * d), 1.0, most);
            assert_close(lift_distance(k, d, 1.0, 1.0) / d, 1.0, most);
        }
    }
    assert_true(lift_time(0.0, 7.0, 1.0, 1.0) == 7.0 && lift_length(0.0, 7.0, 1.0, 1.0) == 7.0);
    assert_true(lift_spread(0.0, 7.0, 1.0, 1.0) == 7.0 && lift_distance(0.0, 7.0, 1.0, 1.0) == 7.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_are_straight_where_they_are_lifted),
        cmocka_unit_test(the_lift_comes_back),
        cmocka_unit_test(time_and_arc_are_those_of_a_traced_ray),
        cmocka_unit_test(spreading_is_that_of_a_traced_tube),
        cmocka_unit_test(nothing_is_lost_as_the_gradient_goes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
