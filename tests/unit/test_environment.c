/*
 * The limits of an environment and a sonar that a caller of the library fills in, field by field, and which
 * places expect the same.
 */
#include "asserts.h"
#include "test_context.h"

#include <asdic/expected.h>

#include "sim/environment.h"

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
    LIMITS(sound_speed_gradient_per_s, -30.0, 30.0);
}

static asdic_environment cast(size_t points, const double depth_m[], const double speed_mps[]) {
    asdic_environment env = asdic_environment_default();
    env.sound_speed_profile.points = points;
    for (size_t i = 0; i < points; i++) {
        env.sound_speed_profile.depth_m[i] = depth_m[i];
        env.sound_speed_profile.sound_speed_mps[i] = speed_mps[i];
    }
    return env;
}

#define REFUSED(env, ...)                                                                          \
    do {                                                                                           \
        const char *const parts[] = {__VA_ARGS__};                                                 \
        assert_status(ctx, check(env), ASDIC_ERROR_ARGUMENT);                                      \
        for (size_t part = 0; part < sizeof parts / sizeof *parts; part++) {                       \
            assert_contains(asdic_context_error(ctx), parts[part]);                                \
        }                                                                                          \
    } while (0)

static void a_profile_has_its_limits(void **state) {
    (void)state;
    const double depth[] = {0.0, 8.0, 20.0}, speed[] = {1495.0, 1495.0, 1483.0};
    asdic_environment env = cast(3, depth, speed);
    assert_ok(ctx, check(env));
    env.sound_speed_gradient_per_s = 0.1;
    REFUSED(env, "exclude each other");
    REFUSED(cast(1, depth, speed), "has 1 points", "[2, 64]");
    env = cast(3, depth, speed);
    env.sound_speed_profile.points = 65;
    REFUSED(env, "has 65 points", "[2, 64]");
    for (int i = 0; i < 64; i++) {
        env.sound_speed_profile.depth_m[i] = i;
        env.sound_speed_profile.sound_speed_mps[i] = 1490.0;
    }
    env.sound_speed_profile.points = 64;
    assert_ok(ctx, check(env));
    REFUSED(cast(3, (const double[]){0.0, 8.0, 8.0}, speed), "point 3", "8 m is not below the 8 m");
    REFUSED(cast(3, (const double[]){0.0, 8.0, 7.0}, speed), "point 3", "not below");
    REFUSED(cast(3, (const double[]){0.0, 8.0, 8.000999}, speed), "point 3",
            "less than 0.001 m below the 8 m");
    assert_ok(ctx, check(cast(3, (const double[]){0.0, 3.048, 3.049}, speed)));
    assert_ok(ctx, check(cast(3, (const double[]){0.0, 10999.89, 11000.0}, speed)));
    REFUSED(cast(3, (const double[]){0.0, 10999.9, 11000.0}, speed), "point 3",
            "less than 0.11 m below the 10999.9 m");
    REFUSED(cast(3, (const double[]){-1.0, 8.0, 9.0}, speed), "point 1", "-1 m", "[0, 11000]");
    REFUSED(cast(3, (const double[]){0.0, NAN, 9.0}, speed), "point 2", "nan");
    REFUSED(cast(3, depth, (const double[]){1495.0, 1299.0, 1483.0}), "point 2", "1299 m/s",
            "[1300, 1700]");
    REFUSED(cast(3, depth, (const double[]){1495.0, 1400.0, 1701.0}), "point 3", "1701 m/s");
    env = asdic_environment_default();
    env.refraction = ASDIC_REFRACTION_LAYER;
    env.layer_from_m = 7.0;
    env.layer_to_m = 5.0;
    REFUSED(env, "from 7 m to 5 m");
    env.layer_to_m = 7.0;
    assert_ok(ctx, check(env));
    env.layer_from_m = 0.0;
    assert_ok(ctx, check(env));
    env.layer_to_m = 11001.0;
    REFUSED(env, "from 0 m to 11001 m");
    env.layer_from_m = -1.0;
    env.layer_to_m = 5.0;
    REFUSED(env, "from -1 m to 5 m");
    env.refraction = ASDIC_REFRACTION_FULL;
    assert_ok(ctx, check(env));
}

/* A gradient that would take the sound speed to 0 is refused with the depth. */
static void a_gradient_is_checked_over_the_depths_of_a_scene(void **state) {
    (void)state;
    asdic_environment env = asdic_environment_default();
    env.sound_speed_mps = 1490.0;
    env.sound_speed_gradient_per_s = -29.8;
    assert_ok(ctx, asdic_environment_check_depths(ctx, &env, 0.0, 6.3));
    assert_status(ctx, asdic_environment_check_depths(ctx, &env, 0.0, 60.0), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "1300 m/s at a depth of 6.376 m and 0 at 50 m");
    env.sound_speed_gradient_per_s = 1.0;
    assert_ok(ctx, asdic_environment_check_depths(ctx, &env, 0.0, 210.0));
    assert_status(ctx, asdic_environment_check_depths(ctx, &env, 0.0, 211.0), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "1700 m/s at a depth of 210 m, and");
    env.sound_speed_gradient_per_s = -1.0;
    assert_ok(ctx, asdic_environment_check_depths(ctx, &env, 190.0, 190.0)); /* 1300 m/s */
}

/* The speed at a depth: on the lines between the points and at both ends; what bends says whether it
 * changes anywhere; one layer is the line of least squares. */
static void speeds_come_from_the_profile(void **state) {
    (void)state;
    const double depth[] = {2.0, 8.0, 20.0}, speed[] = {1495.0, 1495.0, 1483.0};
    const double same[] = {1495.0, 1495.0, 1495.0}, line[] = {1491.0, 1494.0, 1500.0};
    asdic_environment env = cast(3, depth, speed);
    assert_true(asdic_environment_bends(&env));
    assert_close(asdic_environment_sound_speed_mps(&env, 0.0), 1495.0, 0.0);
    assert_close(asdic_environment_sound_speed_mps(&env, 8.0), 1495.0, 0.0);
    assert_close(asdic_environment_sound_speed_mps(&env, 11.0), 1492.0, 1e-9);
    assert_close(asdic_environment_sound_speed_mps(&env, 99.0), 1483.0, 1e-9);
    env.refraction = ASDIC_REFRACTION_OFF;
    assert_false(asdic_environment_bends(&env));
    assert_close(asdic_environment_sound_speed_mps(&env, 11.0), 1492.0, 1e-9);
    env = cast(3, depth, same);
    assert_false(asdic_environment_bends(&env));
    assert_close(asdic_environment_sound_speed_mps(&env, 5.0), 1495.0, 0.0);
    env = cast(3, depth, line);
    env.refraction = ASDIC_REFRACTION_LAYER;
    env.layer_from_m = 3.0;
    env.layer_to_m = 19.0;
    assert_close(asdic_environment_sound_speed_mps(&env, 40.0), 1510.0, 1e-9);
    /* Level, then -1.5 1/s: by symmetry the mean and half the slope. */
    env = cast(3, (const double[]){0.0, 8.0, 16.0}, (const double[]){1495.0, 1495.0, 1483.0});
    env.refraction = ASDIC_REFRACTION_LAYER;
    env.layer_to_m = 16.0;
    assert_close(asdic_environment_sound_speed_mps(&env, 8.0), 1492.0, 1e-9);
    assert_close(asdic_environment_sound_speed_mps(&env, 9.0), 1492.0 - 0.75, 1e-9);
    env = asdic_environment_default();
    assert_false(asdic_environment_bends(&env));
    env.sound_speed_gradient_per_s = -1e-12;
    assert_true(asdic_environment_bends(&env));
    env.sound_speed_gradient_per_s = -0.5;
    assert_close(asdic_environment_sound_speed_mps(&env, 10.0), 1489.99 - 5.0, 1e-9);
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

/* A sonar's numbers, as the schema of scene files has their limits; receivers as README and header say. */
static void a_sonar_has_its_limits(void **state) {
    (void)state;
    enum { MOST = 4096 };
    static asdic_beam beams[MOST + 1];
    asdic_sonar sonar = asdic_sonar_default();
    const struct {
        const char *name;
        double *value, least, most;
    } fields[] = {{"frequency_hz", &sonar.frequency_hz, 100.0, 3e6},
                  {"bandwidth_hz", &sonar.bandwidth_hz, 1.0, 1e6},
                  {"ping_rate_hz", &sonar.ping_rate_hz, 0.01, 1000.0},
                  {"source_level_db", &sonar.source_level_db, -300.0, 300.0},
                  {"bin_length_m", &sonar.bin_length_m, 0.001, 1000.0},
                  {"blanking_m", &sonar.blanking_m, 0.01, 10000.0},
                  {"length_h_m", &sonar.transmitter.length_h_m, 1e-4, 100.0},
                  {"length_v_m", &sonar.transmitter.length_v_m, 1e-4, 100.0},
                  {"length_h_m", &beams[MOST - 1].length_h_m, 1e-4, 100.0},
                  {"length_v_m", &beams[MOST - 1].length_v_m, 1e-4, 100.0}};
    for (int i = 0; i <= MOST; i++) {
        beams[i] = sonar.transmitter;
    }
    sonar.receivers = beams;
    sonar.receiver_count = MOST;
    sonar.max_range_m = 20.0; /* few bins, however short */
    for (size_t i = 0; i < sizeof fields / sizeof *fields; i++) {
        double before = *fields[i].value;
        const double good[] = {fields[i].least, fields[i].most};
        const double bad[] = {nextafter(good[0], -INFINITY), nextafter(good[1], INFINITY), NAN};
        for (int k = 0; k < 2; k++) {
            *fields[i].value = good[k];
            assert_ok(ctx, asdic_sonar_check(ctx, &sonar));
        }
        for (int k = 0; k < 3; k++) {
            *fields[i].value = bad[k];
            assert_status(ctx, asdic_sonar_check(ctx, &sonar), ASDIC_ERROR_ARGUMENT);
            assert_contains(asdic_context_error(ctx), fields[i].name);
        }
        *fields[i].value = before;
    }
    sonar.receiver_count = 1;
    assert_ok(ctx, asdic_sonar_check(ctx, &sonar));
    for (size_t count = 0; count <= MOST + 1; count += MOST + 1) {
        sonar.receiver_count = count;
        assert_status(ctx, asdic_sonar_check(ctx, &sonar), ASDIC_ERROR_ARGUMENT);
        assert_contains(asdic_context_error(ctx), "receiver_count");
        assert_contains(asdic_context_error(ctx), "[1, 4096]");
    }
    sonar.receiver_count = 1;
    sonar.receivers = NULL;
    assert_status(ctx, asdic_sonar_check(ctx, &sonar), ASDIC_ERROR_ARGUMENT);
    sonar.receivers = beams;
    sonar.speckle = (asdic_speckle)99;
    assert_status(ctx, asdic_sonar_check(ctx, &sonar), ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "unknown speckle 99");
}

/* Whatever pings are made with it. */
static void an_array_has_its_limits(void **state) {
    (void)state;
    asdic_beam beam = {.length_h_m = 0.1, .length_v_m = 0.1};
    asdic_sonar sonar = asdic_sonar_default();
    const asdic_array good = {.elements = ASDIC_ARRAY_MAX_ELEMENTS,
                              .spacing_m = 0.01,
                              .shading = ASDIC_SHADING_CHEBYSHEV,
                              .side_lobe_db = -100.0,
                              .element = {.length_h_m = 0.01, .length_v_m = 0.01}};
    asdic_array bad[13];
    for (int i = 0; i < 13; i++) {
        bad[i] = good;
    }
    bad[0].elements = 1;
    bad[1].elements = ASDIC_ARRAY_MAX_ELEMENTS + 1;
    bad[2].spacing_m = 0.0;
    bad[3].element.length_h_m = NAN;
    bad[4].element.length_v_m = 0.0;
    bad[5].shading = (asdic_shading)99;
    bad[6].side_lobe_db = -9.9;
    bad[7].side_lobe_db = NAN;
    bad[8].spacing_m = INFINITY;
    bad[9].spacing_m = 0.341; /* twenty wavelengths are at most 0.34 m */
    bad[10].element.yaw_rad = INFINITY;
    bad[11].element.pitch_rad = NAN;
    bad[12].element.length_v_m = INFINITY;
    sonar.receivers = &beam;
    sonar.receiver_count = 1;
    sonar.array = good;
    assert_ok(ctx, asdic_sonar_check(ctx, &sonar));
    sonar.array.shading = ASDIC_SHADING_HANN; /* which has no level of its own */
    sonar.array.side_lobe_db = 0.0;
    assert_ok(ctx, asdic_sonar_check(ctx, &sonar));
    sonar.array.spacing_m = 0.34;
    assert_ok(ctx, asdic_sonar_check(ctx, &sonar));
    for (int i = 0; i < 13; i++) {
        sonar.array = bad[i];
        assert_status(ctx, asdic_sonar_check(ctx, &sonar), ASDIC_ERROR_ARGUMENT);
    }
    sonar.array = bad[3];
    sonar.array.elements = 0; /* none, whatever else is said of it */
    assert_ok(ctx, asdic_sonar_check(ctx, &sonar));
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
    /* Without a bottom there is no height above it, whatever is said. */
    p.flat.altitude_m = INFINITY;
    assert_true(asdic_expected_is_near(&p, &p, 0.0, 0.0));
    /* Opposite rolls are no place of their own. */
    asdic_expected_place a = place(), b = place();
    a.pose.roll_rad = 0.3;
    b.pose.roll_rad = -0.3;
    assert_false(asdic_expected_is_near(&a, &b, 0.01, 0.1));
    b.pose.roll_rad = 0.35;
    assert_true(asdic_expected_is_near(&a, &b, 0.01, 0.1));
}

static void the_default_is_moderate_water(void **state) {
    (void)state;
    asdic_environment env = asdic_environment_default();
    assert_true(env.temperature_degc == 10.0 && env.salinity_ppt == 35.0 && env.ph == 8.0);
    assert_true(env.wind_speed_kn == 10.0 && env.shipping_density == 0.5);
    assert_true(env.particle_strength_db == -90.0 && isnan(env.sound_speed_mps));
}

/* Of 3 dB a kilometre; the integral over a bin by 10,000 rectangles. */
static void a_water_column_takes_its_share(void **state) {
    (void)state;
    asdic_environment env = asdic_environment_default();
    asdic_sonar sonar = asdic_sonar_default();
    const asdic_water_column water = {1500.0, 0.015, 3e-3 * log(10.0) / 10.0};
    env.sound_speed_mps = 1500.0;
    sonar.frequency_hz = 100e3;
    assert_close_relative(asdic_water_column_at(&env, &sonar, 5.0).wavelength_m, 0.015, 1e-12);
    double alpha = asdic_environment_absorption_db_per_km(&env, 100e3, 5.0);
    assert_true(alpha > 30.0 && alpha < 40.0); /* 10 degC, 35 ppt, 100 kHz */
    sonar.source_level_db = 183.0;
    double source = pow(10.0, 18.3);
    assert_close_relative(asdic_water_column_source_lin(&water, &env, &sonar), source, 1e-12);
    env.variant = ASDIC_VARIANT_PRINTED;
    assert_close_relative(asdic_water_column_source_lin(&water, &env, &sonar),
                          source * pow(10.0, -3e-4), 1e-12);
    /* The centre of bin 8 of 2 m is 17 m away: twice 16 m of absorption. */
    assert_close_relative(asdic_water_column_loss(&water, 2.0, 8), pow(10.0, -3e-4 * 32.0) / 289.0,
                          1e-12);
    assert_true(asdic_water_column_volume(&water, 2.0, 10.0, 4) == 0.0);
    assert_true(isinf(asdic_water_column_volume(&water, 2.0, 0.0, 0)));
    assert_true(isfinite(asdic_water_column_volume(&water, 2.0, 0.5, 0)));
    for (size_t bin = 5; bin < 30; bin += 12) {
        double begin = fmax(2.0 * (double)bin, 11.0),
               width = (2.0 * (double)bin + 2.0 - begin) / 1e4;
        double sum = 0.0;
        for (int i = 0; i < 10000; i++) {
            double d = begin + (i + 0.5) * width;
            sum += width * pow(10.0, -6e-4 * (d - 1.0)) / (d * d);
        }
        assert_close_relative(asdic_water_column_volume(&water, 2.0, 11.0, bin), sum, 1e-6);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_field_has_its_limits),
        cmocka_unit_test(a_profile_has_its_limits),
        cmocka_unit_test(an_array_has_its_limits),
        cmocka_unit_test(the_default_is_moderate_water),
        cmocka_unit_test(a_water_column_takes_its_share),
        cmocka_unit_test(a_gradient_is_checked_over_the_depths_of_a_scene),
        cmocka_unit_test(speeds_come_from_the_profile),
        cmocka_unit_test(nan_stands_for_what_is_derived),
        cmocka_unit_test(a_sonar_has_its_limits),
        cmocka_unit_test(places_differ_by_what_matters),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
