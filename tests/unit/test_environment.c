/*
 * The limits of an environment that a caller of the library fills in, field by field, and which places
 * expect the same.
 */
#include "asserts.h"
#include "test_context.h"

#include <asdic/expected.h>

#include <math.h>

static asdic_status check(asdic_environment env) {
    return asdic_environment_check(ctx, &env);
}

#define LIMITS(field, least, most)                                                                 \
    do {                                                                                           \
        asdic_environment env = asdic_environment_default();                                       \
        env.field = (least);                                                                       \
        assert_ok(ctx, check(env));                                                                \
        env.field = (most);                                                                        \
        assert_ok(ctx, check(env));                                                                \
        env.field = nextafter(least, -INFINITY);                                                   \
        assert_status(ctx, check(env), ASDIC_ERROR_ARGUMENT);                                      \
        assert_contains(asdic_context_error(ctx), #field);                                         \
        env.field = nextafter(most, INFINITY);                                                     \
        assert_status(ctx, check(env), ASDIC_ERROR_ARGUMENT);                                      \
        env.field = INFINITY;                                                                      \
        assert_status(ctx, check(env), ASDIC_ERROR_ARGUMENT);                                      \
    } while (0)

static void every_field_has_its_limits(void **state) {
    (void)state;
    LIMITS(temperature_degc, -2.0, 40.0);
    LIMITS(salinity_ppt, 0.0, 45.0);
    LIMITS(ph, 7.0, 8.5);
    LIMITS(wind_speed_kn, 0.0, 60.0);
    LIMITS(shipping_density, 0.0, 1.0);
    LIMITS(particle_strength_db, -200.0, 0.0);
    LIMITS(sound_speed_mps, 1300.0, 1700.0);
    LIMITS(max_depth_m, 0.0, 11000.0);
}

/* Only what water and depth can tell may be left to them. */
static void nan_stands_for_what_is_derived(void **state) {
    (void)state;
    asdic_environment env = asdic_environment_default();
    env.sound_speed_mps = env.max_depth_m = NAN;
    assert_ok(ctx, check(env));
    env.temperature_degc = NAN;
    assert_status(ctx, check(env), ASDIC_ERROR_ARGUMENT);
    env = asdic_environment_default();
    env.salinity_ppt = NAN;
    assert_status(ctx, check(env), ASDIC_ERROR_ARGUMENT);
    env = asdic_environment_default();
    env.wind_speed_kn = NAN;
    assert_status(ctx, check(env), ASDIC_ERROR_ARGUMENT);
}

static asdic_expected_place place(void) {
    return (asdic_expected_place){
        .flat = {.altitude_m = 10.0, .depth_m = 5.0, .has_surface = true, .has_bottom = true}};
}

static bool is_near(asdic_expected_place other) {
    asdic_expected_place first = place();
    bool there = asdic_expected_is_near(&first, &other, 0.01, 0.1);
    assert_int_equal(asdic_expected_is_near(&other, &first, 0.01, 0.1), there);
    return there;
}

/* A place differs by what its level hangs on, to either side, and by nothing else. */
static void places_differ_by_what_matters(void **state) {
    (void)state;
    for (int side = -1; side <= 1; side += 2) {
        asdic_expected_place p = place();
        p.pose.roll_rad = side * 0.09;
        p.pose.pitch_rad = -side * 0.09;
        p.flat.altitude_m += side * 0.09;
        p.flat.depth_m += side * 0.04;
        assert_true(is_near(p));
        p.pose.yaw_rad = side * 3.0;
        p.pose.position_m.x = side * 1e4;
        assert_true(is_near(p));

        p = place();
        p.pose.roll_rad = side * 0.11;
        assert_false(is_near(p));
        p = place();
        p.pose.pitch_rad = side * 0.11;
        assert_false(is_near(p));
        p = place();
        p.flat.altitude_m += side * 0.12;
        assert_false(is_near(p));
        p = place();
        p.flat.depth_m += side * 0.06;
        assert_false(is_near(p));
    }
    asdic_expected_place p = place();
    p.flat.has_surface = false;
    assert_false(is_near(p));
    p = place();
    p.flat.has_bottom = false;
    assert_false(is_near(p));
    /* Opposite rolls are no place of their own. */
    asdic_expected_place a = place(), b = place();
    a.pose.roll_rad = 0.3;
    b.pose.roll_rad = -0.3;
    assert_false(asdic_expected_is_near(&a, &b, 0.01, 0.1));
    b.pose.roll_rad = 0.35;
    assert_true(asdic_expected_is_near(&a, &b, 0.01, 0.1));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_field_has_its_limits),
        cmocka_unit_test(nan_stands_for_what_is_derived),
        cmocka_unit_test(places_differ_by_what_matters),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
