/* What a plan says, row by row: reasons with their numbers, bounds that scale as the energies that they bound, and
 * which term goes when. No device is needed. */
#include "asserts.h"
#include "test_context.h"

#include "base/clock.h"
#include "laws/scatterer.h"
#include "sim/environment.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180.0)

typedef struct yard {
    asdic_environment env;
    asdic_sonar sonar;
    asdic_beam receivers[20];
    asdic_sampling sampling;
    asdic_scene *scene;
    asdic_pose poses[400];
    size_t count;
} yard;

static asdic_plan plan;

/* A sonar of some 75 m range and half a metre a bin at 7 m, over sand at 12 m, with noise. */
static yard begin(bool bottom, bool surface) {
    yard y = {.env = asdic_environment_default(),
              .sonar = asdic_sonar_default(),
              .sampling = asdic_sampling_default(),
              .count = 1};
    y.env.max_depth_m = 12.0;
    y.sonar.noise_enabled = true;
    y.sonar.receiver_count = 1;
    for (size_t i = 0; i < 20; i++) {
        y.receivers[i] = y.sonar.transmitter;
    }
    y.poses[0].position_m.z = 7.0;
    assert_ok(ctx, asdic_scene_create(ctx, &y.scene));
    if (bottom) {
        assert_ok(ctx, asdic_scene_set_bottom_plane(y.scene, 12.0, asdic_material_bottom(2.0)));
    }
    asdic_scene_set_surface(y.scene, surface);
    return y;
}

/* Whether REASON is one to leave a term out. */
static bool leaves_out(const char *reason) {
    static const char *const words[] = {"has no ",    "is never nearer",  "below the noise",
                                        "none of ",   "behind the faces", "nothing ",
                                        "flat scene", "switched off"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++) {
        if (strstr(reason, words[i])) {
            return !strstr(reason, "costs nothing");
        }
    }
    return false;
}

/* Every row is kept or left out as its reason says; what is left out changes nothing to speak of, or is not wanted. */
static void make(yard *y) {
    y->sonar.receivers = y->receivers;
    if (!asdic_scene_get_info(y->scene).bvh_nodes) {
        asdic_scene_commit(y->scene);
    }
    assert_ok(ctx, asdic_plan_make(ctx, y->scene, &y->env, &y->sonar, &y->sampling, y->poses,
                                   y->count, &plan));
    for (int t = 0; t < ASDIC_TERM_COUNT; t++) {
        assert_string_equal(plan.rows[t].name, asdic_term_name((asdic_term)t));
        const asdic_plan_row *row = &plan.rows[t];
        assert_true(((plan.left_out >> t & 1u) == 0) == row->kept);
        if (t != ASDIC_TERM_BORIC_ACID || row->kept) { /* which says so where it is kept alone */
            assert_true(row->kept == !leaves_out(row->reason));
        }
        assert_true(row->kept || row->bound_db <= ASDIC_PLAN_NEGLIGIBLE_DB ||
                    strstr(row->reason, "switched off"));
    }
}

static void end(yard *y) {
    asdic_scene_destroy(&y->scene);
}

static const asdic_plan_row *row_of(asdic_term term) {
    return &plan.rows[term];
}

/* What a bound in decibels makes of the noise. */
static double energy_of(asdic_term term) {
    double bound_db = row_of(term)->bound_db;
    assert_true(bound_db > 1e-6 && isfinite(bound_db));
    return expm1(bound_db * log(10.0) / 10.0);
}

static void reasons_have_their_numbers(void **state) {
    (void)state;
    yard y = begin(true, true);
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_BOTTOM)->reason, "a plane, from 5.0 m");
    assert_string_equal(row_of(ASDIC_TERM_SURFACE)->reason,
                        "from 7.0 m on, below the noise in every bin");
    assert_string_equal(row_of(ASDIC_TERM_VOLUME)->reason,
                        "particles at -90 dB, below the noise in every bin");
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "none of 0 comes within range");
    assert_string_equal(row_of(ASDIC_TERM_MULTIPATH)->reason, "nothing within range reflects");
    assert_string_equal(row_of(ASDIC_TERM_REAR)->reason, "nothing is sent or heard backwards");
    assert_contains(row_of(ASDIC_TERM_BORIC_ACID)->reason, " dB/km at 100 kHz; costs nothing");
    assert_contains(row_of(ASDIC_TERM_NOISE)->reason, " dB in a bin");
    char rays[64];
    snprintf(rays, sizeof rays, "%u a ping: a quadrature would serve too few pings",
             y.sampling.rays);
    assert_string_equal(row_of(ASDIC_TERM_RAYS)->reason, rays);
    assert_true(row_of(ASDIC_TERM_BOTTOM)->kept && isinf(row_of(ASDIC_TERM_BOTTOM)->bound_db));
    assert_true(row_of(ASDIC_TERM_NOISE)->kept && isinf(row_of(ASDIC_TERM_NOISE)->bound_db));
    assert_true(row_of(ASDIC_TERM_RAYS)->bound_db == 0.0);
    assert_true(row_of(ASDIC_TERM_OBJECTS)->bound_db == 0.0 &&
                row_of(ASDIC_TERM_MULTIPATH)->bound_db == 0.0 &&
                row_of(ASDIC_TERM_REAR)->bound_db == 0.0);

    y.sonar.noise_enabled = false;
    y.sonar.rear_floor_db = -40.0;
    y.sampling.multipath = ASDIC_MULTIPATH_OFF;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_SURFACE)->reason, "from 7.0 m on");
    assert_string_equal(row_of(ASDIC_TERM_VOLUME)->reason, "particles at -90 dB");
    assert_string_equal(row_of(ASDIC_TERM_NOISE)->reason, "switched off in the scene");
    assert_string_equal(row_of(ASDIC_TERM_REAR)->reason, "faces leak -40 dB backwards");
    assert_string_equal(row_of(ASDIC_TERM_MULTIPATH)->reason, "switched off in the scene");
    assert_false(row_of(ASDIC_TERM_NOISE)->kept);
    assert_true(row_of(ASDIC_TERM_REAR)->kept && isinf(row_of(ASDIC_TERM_REAR)->bound_db));
    assert_true(isinf(row_of(ASDIC_TERM_SURFACE)->bound_db));
    end(&y);

    y = begin(false, false);
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_BOTTOM)->reason, "the scene has no bottom");
    assert_string_equal(row_of(ASDIC_TERM_SURFACE)->reason, "the scene has no surface");
    assert_false(row_of(ASDIC_TERM_BOTTOM)->kept || row_of(ASDIC_TERM_SURFACE)->kept);
    y.sampling.multipath = ASDIC_MULTIPATH_BOUNDARIES;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_MULTIPATH)->reason,
                        "0 objects and the boundaries reflect");
    assert_true(row_of(ASDIC_TERM_MULTIPATH)->kept);
    end(&y);
}

/* The nearest of all places counts; a boundary just as far as the range ends is still met. */
static void the_nearest_place_counts(void **state) {
    (void)state;
    yard y = begin(true, true);
    y.poses[1].position_m.z = 3.0;
    y.poses[2].position_m.z = 9.5;
    y.count = 3;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_BOTTOM)->reason, "a plane, from 2.5 m");
    assert_contains(row_of(ASDIC_TERM_SURFACE)->reason, "from 3.0 m on");
    y.count = 1;
    y.sonar.max_range_m = 5.0;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_BOTTOM)->reason, "a plane, from 5.0 m");
    assert_string_equal(row_of(ASDIC_TERM_SURFACE)->reason,
                        "the surface is never nearer than 7.0 m, the range ends at 5.0 m");
    y.sonar.max_range_m = 4.5;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_BOTTOM)->reason,
                        "the bottom is never nearer than 5.0 m, the range ends at 4.5 m");
    assert_true(row_of(ASDIC_TERM_BOTTOM)->bound_db == 0.0 &&
                row_of(ASDIC_TERM_SURFACE)->bound_db == 0.0);
    assert_false(row_of(ASDIC_TERM_BOTTOM)->kept || row_of(ASDIC_TERM_SURFACE)->kept);
    y.sonar.max_range_m = 7.0;
    make(&y);
    assert_contains(row_of(ASDIC_TERM_SURFACE)->reason, "from 7.0 m on");
    end(&y);
}

/* Boric acid's absorption both ways over the range, over 1 m at least: of all absorption what goes as 10^(0.78 pH). */
static void boric_acid_is_bounded_by_the_range(void **state) {
    (void)state;
    yard y = begin(true, true);
    make(&y);
    double boric_db_per_km = strtod(row_of(ASDIC_TERM_BORIC_ACID)->reason, NULL);
    double speed_mps = asdic_environment_sound_speed_mps(&y.env, 7.0);
    double range_m = 0.5 * (double)asdic_sonar_bin_count(&y.sonar, speed_mps);
    assert_true(boric_db_per_km > 0.01);
    asdic_environment other = y.env;
    other.ph += 0.3;
    double f_hz = y.sonar.frequency_hz,
           more_db_per_km = asdic_environment_absorption_db_per_km(&other, f_hz, 12.0) -
                            asdic_environment_absorption_db_per_km(&y.env, f_hz, 12.0);
    assert_close_relative(boric_db_per_km, more_db_per_km / (pow(10.0, 0.78 * 0.3) - 1.0), 6e-3);
    assert_close_relative(row_of(ASDIC_TERM_BORIC_ACID)->bound_db, 2e-3 * range_m * boric_db_per_km,
                          6e-3);
    double far_db = row_of(ASDIC_TERM_BORIC_ACID)->bound_db;
    y.sonar.max_range_m = 0.5;
    y.sonar.blanking_m = 0.01;
    make(&y);
    assert_close_relative(row_of(ASDIC_TERM_BORIC_ACID)->bound_db, far_db / range_m, 1e-9);
    assert_false(row_of(ASDIC_TERM_BORIC_ACID)->kept);
    assert_contains(row_of(ASDIC_TERM_BORIC_ACID)->reason, " kHz");
    assert_null(strstr(row_of(ASDIC_TERM_BORIC_ACID)->reason, "costs nothing"));
    end(&y);
}

static asdic_mesh *box(double side_m) {
    asdic_mesh *mesh = NULL;
    assert_ok(ctx, asdic_mesh_box(ctx, (asdic_vec3){side_m, side_m, side_m}, &mesh));
    return mesh;
}

static void add_box(yard *y, const char *name, double side_m, double x_m, double y_m,
                    double impedance_mrayl) {
    asdic_mesh *mesh = box(side_m);
    asdic_pose pose = {.position_m = {x_m, y_m, 7.0}};
    assert_ok(ctx, asdic_scene_add_object(y->scene, name, mesh, pose,
                                          asdic_material_facet(impedance_mrayl, 1e-3, 0.1)));
    asdic_mesh_destroy(&mesh);
}

/* Energies are proportional to what is sent, and to what scatters. */
static void bounds_grow_with_the_energy(void **state) {
    (void)state;
    static const asdic_term terms[] = {ASDIC_TERM_SURFACE, ASDIC_TERM_VOLUME, ASDIC_TERM_OBJECTS,
                                       ASDIC_TERM_MULTIPATH};
    yard y = begin(true, true);
    double before[4];
    add_box(&y, "box", 1.0, 30.0, 0.0, 45.0);
    y.sonar.source_level_db = 150.0;
    make(&y);
    for (int k = 0; k < 4; k++) {
        before[k] = energy_of(terms[k]);
    }
    y.sonar.source_level_db += 10.0 * log10(2.0);
    make(&y);
    for (int k = 0; k < 4; k++) {
        assert_close_relative(energy_of(terms[k]), 2.0 * before[k], 1e-6);
    }
    y.sonar.source_level_db = 150.0;
    y.env.particle_strength_db += 10.0;
    make(&y);
    assert_close_relative(energy_of(ASDIC_TERM_VOLUME), 10.0 * before[1], 1e-6);
    assert_close_relative(energy_of(ASDIC_TERM_SURFACE), before[0], 1e-9);
    end(&y);
}

/* The energy of all water is as the transmitter's solid angle: of sides of H and V wavelengths, since sinc^2 is the
 * transform of a triangle, 8 pi times the integral over s and t from 0 to 1 of
 * (1 - s) (1 - t) sinc(2 sqrt(H^2 s^2 + V^2 t^2)), here by Gauss's rule; of the longest 1 / (H V). */
static void water_is_seen_through_the_solid_angle(void **state) {
    (void)state;
    static const struct {
        double h, v, solid_angle, tolerance;
    } rows[] = {
        {3, 2, 0.164113431083821, 0},
        {0.5, 4, 0.523428934313419, 1e-9},
        {10, 3, 0.0331015731881255, 1e-9},
        {2, 25, 0.0197720700337837, 1e-9},
        {40, 20, 0.0012493523814882, 1e-9},
        {100, 100, 9.99930099932516e-05, 1e-9},
        {6000, 6000, 1.0 / (6000.0 * 6000.0), 2e-5},
    };
    double first = 0.0;
    yard y = begin(true, true);
    y.env.sound_speed_mps = 1500.0; /* at 100 kHz 15 mm a wavelength */
    y.sonar.source_level_db = 230.0;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        y.sonar.transmitter.length_h_m = 0.015 * rows[i].h;
        y.sonar.transmitter.length_v_m = 0.015 * rows[i].v;
        make(&y);
        double energy = energy_of(ASDIC_TERM_VOLUME);
        first = i ? first : energy;
        assert_close_relative(energy / first, rows[i].solid_angle / rows[0].solid_angle,
                              rows[i].tolerance);
    }
    end(&y);
}

/* Those beyond the range, behind the faces, in reach. */
static void objects_are_counted(void **state) {
    (void)state;
    yard y = begin(false, false);
    add_box(&y, "ahead", 1.0, 30.0, 0.0, 1.5274);
    add_box(&y, "behind", 1.0, -30.0, 0.0, 1.5274);
    add_box(&y, "far", 1.0, 300.0, 0.0, 45.0);
    y.sonar.noise_enabled = false;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "2 of 3 come within range");
    assert_true(row_of(ASDIC_TERM_OBJECTS)->kept);
    assert_string_equal(row_of(ASDIC_TERM_MULTIPATH)->reason, "nothing within range reflects");
    y.sonar.max_range_m = 29.0; /* spheres round the boxes begin at 30 - sqrt(3) / 2 m */
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "none of 3 comes within range");
    y.sonar.max_range_m = 29.5;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "2 of 3 come within range");
    end(&y);

    y = begin(false, false);
    add_box(&y, "behind", 1.0, -30.0, 0.0, 1.5274);
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason,
                        "1 of 1 come within range, behind the faces");
    y.sonar.rear_floor_db = -100.0;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason,
                        "1 of 1 come within range, below the noise in every bin");
    y.sonar.source_level_db = 190.0;
    y.sonar.rear_floor_db = -10.0;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "1 of 1 come within range");
    double both = energy_of(ASDIC_TERM_OBJECTS); /* through both faces' backs, once each */
    y.sonar.rear_floor_db = -13.0;
    make(&y);
    assert_close_relative(energy_of(ASDIC_TERM_OBJECTS), both * pow(10.0, -0.6), 1e-6);
    for (size_t i = 0; i < 20; i++) { /* a face that turns round sees it, whatever leaks */
        y.receivers[i].yaw_rad = 180.0 * DEGREE;
    }
    make(&y);
    assert_close_relative(energy_of(ASDIC_TERM_OBJECTS), both * pow(10.0, 0.7), 1e-6);
    y.receivers[0].yaw_rad = 0.0; /* the best of the receivers counts */
    y.sonar.receiver_count = 2;
    make(&y);
    assert_close_relative(energy_of(ASDIC_TERM_OBJECTS), both * pow(10.0, 0.7), 1e-6);
    y.receivers[1].yaw_rad = 0.0;
    make(&y);
    assert_close_relative(energy_of(ASDIC_TERM_OBJECTS), both * pow(10.0, -0.6), 1e-6);
    for (size_t i = 0; i < 20; i++) { /* up to sixteen are looked at */
        y.receivers[i].yaw_rad = 0.0;
    }
    y.sonar.receiver_count = 16;
    make(&y);
    assert_close_relative(energy_of(ASDIC_TERM_OBJECTS), both * pow(10.0, -0.6), 1e-6);
    y.sonar.receiver_count = 17;
    make(&y);
    assert_close_relative(energy_of(ASDIC_TERM_OBJECTS), both * pow(10.0, 0.7), 1e-6);
    end(&y);

    y = begin(false, false);
    add_box(&y, "ahead", 1.0, 30.0, 0.0, 45.0);
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_MULTIPATH)->reason,
                        "1 object reflects, below the noise in every bin");
    y.sonar.source_level_db = 230.0;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_MULTIPATH)->reason, "1 object reflects");
    assert_true(row_of(ASDIC_TERM_MULTIPATH)->kept);
    end(&y);
}

/* Two equal boxes at the same distance bound twice as much; one twice as near sixteen times, but for what it
 * hides and its size. */
static void boxes_add_up(void **state) {
    (void)state;
    double one, two;
    yard y = begin(false, false);
    add_box(&y, "a", 1.0, 40.0, 0.0, 45.0);
    y.sonar.source_level_db = 120.0;
    make(&y);
    one = energy_of(ASDIC_TERM_OBJECTS);
    end(&y);
    y = begin(false, false);
    add_box(&y, "a", 1.0, 40.0, 0.0, 45.0);
    add_box(&y, "b", 1.0, 40.0, 0.0, 45.0);
    y.sonar.source_level_db = 120.0;
    make(&y);
    two = energy_of(ASDIC_TERM_OBJECTS);
    assert_close_relative(two, 2.0 * one, 1e-6);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "2 of 2 come within range");
    end(&y);
    y = begin(false, false);
    add_box(&y, "a", 2.0, 40.0, 0.0, 45.0);
    y.sonar.source_level_db = 120.0;
    make(&y);
    two = energy_of(ASDIC_TERM_OBJECTS); /* four times the area, from a radius further out */
    double near = (40.0 - sqrt(0.75)) / (40.0 - sqrt(3.0));
    assert_close_relative(two, 4.0 * one * pow(near, 4.0), 0.02);
    end(&y);
}

/* Each object is looked at for itself, not at all triangles of the scene. */
static void very_many_objects_are_judged_at_once(void **state) {
    (void)state;
    enum { OBJECTS = 6000 };
    yard y = begin(true, true);
    for (int i = 0; i < OBJECTS; i++) {
        char name[16];
        snprintf(name, sizeof name, "%d", i);
        add_box(&y, name, 0.1, 10.0 + 0.5 * (i / 100), 0.5 * (i % 100) - 25.0, 45.0);
    }
    assert_ok(ctx, asdic_scene_commit(y.scene));
    double start_s = asdic_clock_s();
    make(&y);
    double spent_s = asdic_clock_s() - start_s;
    print_message("%d objects judged in %.3f s\n", OBJECTS, spent_s);
    assert_true(spent_s < 0.2);
    end(&y);
}

/* Over an object there and back, or one way and straight the other: by what it reflects, twice or once, by the way to
 * it or to the surface, which is nearer, and by the directions that it fills. */
static void mirrors_are_bounded_by_both_ways(void **state) {
    (void)state;
    static const double impedances_mrayl[] = {2.2, 45.0};
    for (size_t i = 0; i < 2; i++) {
        double found[2], right[2];
        for (int k = 0; k < 2; k++) {
            double away_m = k ? 60.0 : 20.0, radius_m = sqrt(0.75);
            yard y = begin(false, true);
            asdic_water_column water = asdic_water_column_at(&y.env, &y.sonar, 7.0);
            asdic_law_water laws = asdic_water_column_laws(&water, &y.env, &y.sonar);
            asdic_material facet = asdic_material_facet(impedances_mrayl[i], 1e-3, 0.1);
            double share = asdic_scatterer_at(&facet, &laws).device.reflection2;
            add_box(&y, "box", 1.0, away_m, 0.0, impedances_mrayl[i]);
            y.sonar.source_level_db = 100.0;
            make(&y);
            found[k] = energy_of(ASDIC_TERM_MULTIPATH);
            double near_m = away_m - radius_m, sine = radius_m / away_m;
            double filled = 1.0 - sqrt(1.0 - sine * sine);
            right[k] = filled * (share * share * 100.0 / (near_m * near_m) + 2.0 * share / 49.0);
            end(&y);
        }
        assert_close_relative(found[0] / found[1], right[0] / right[1], 1e-5);
    }
}

/* Where an object is makes no difference: ahead of a sonar elsewhere that looks elsewhere, its bound is the same but
 * for absorption. */
static void places_make_no_difference(void **state) {
    (void)state;
    static const struct {
        double x_m, y_m, z_m, yaw_deg, pitch_deg;
        asdic_vec3 offset_m;
    } cases[] = {{0.0, 0.0, 7.0, 0.0, 0.0, {20.0, 0.0, 0.0}},
                 {100.0, -300.0, 60.0, 90.0, 0.0, {0.0, 20.0, 0.0}},
                 {-50.0, 20.0, 30.0, 180.0, 0.0, {-20.0, 0.0, 0.0}},
                 {40.0, 70.0, 50.0, 0.0, 90.0, {0.0, 0.0, 20.0}}};
    double wanted = 0.0;
    for (int k = 0; k < 4; k++) {
        yard y = begin(false, false);
        asdic_mesh *mesh = box(1.0);
        asdic_pose *at = &y.poses[0];
        at->position_m = (asdic_vec3){cases[k].x_m, cases[k].y_m, cases[k].z_m};
        at->yaw_rad = cases[k].yaw_deg * DEGREE;
        at->pitch_rad = cases[k].pitch_deg * -DEGREE;
        asdic_pose pose = {.position_m = {cases[k].x_m + cases[k].offset_m.x,
                                          cases[k].y_m + cases[k].offset_m.y,
                                          cases[k].z_m + cases[k].offset_m.z}};
        assert_ok(ctx, asdic_scene_add_object(y.scene, "box", mesh, pose,
                                              asdic_material_facet(45.0, 1e-3, 0.1)));
        y.env.max_depth_m = 100.0;
        y.sonar.source_level_db = 120.0;
        make(&y);
        wanted = k == 0 ? energy_of(ASDIC_TERM_OBJECTS) : wanted;
        assert_close_relative(energy_of(ASDIC_TERM_OBJECTS), wanted, 0.03);
        asdic_mesh_destroy(&mesh);
        end(&y);
    }
}

/* What may move is met, wherever it is; points cost no rays and are never left out in reach; triangles below make a
 * bottom. */
static void what_moves_is_kept(void **state) {
    (void)state;
    yard y = begin(false, false);
    asdic_mesh *mesh = box(1.0);
    asdic_pose far = {.position_m = {5000.0, 0.0, 7.0}};
    assert_ok(ctx, asdic_scene_add_moving_object(y.scene, "boat", mesh, far,
                                                 asdic_material_facet(45.0, 1e-3, 0.1)));
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "1 of 1 come within range");
    assert_true(row_of(ASDIC_TERM_OBJECTS)->kept && isinf(row_of(ASDIC_TERM_OBJECTS)->bound_db));
    assert_string_equal(row_of(ASDIC_TERM_MULTIPATH)->reason, "1 object reflects");
    end(&y);

    y = begin(false, false);
    assert_ok(ctx, asdic_scene_add_object(y.scene, "wreck", mesh, far,
                                          asdic_material_facet(45.0, 1e-3, 0.1)));
    assert_ok(ctx, asdic_scene_add_point(y.scene, "far", (asdic_vec3){300.0, 0.0, 7.0}, 0.0));
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "none of 2 comes within range");
    assert_string_equal(row_of(ASDIC_TERM_MULTIPATH)->reason, "nothing within range reflects");
    end(&y);

    y = begin(false, false);
    assert_ok(ctx, asdic_scene_add_point(y.scene, "near", (asdic_vec3){-30.0, 0.0, 7.0}, 0.0));
    assert_ok(ctx, asdic_scene_add_point(y.scene, "far", (asdic_vec3){300.0, 0.0, 7.0}, 0.0));
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "1 of 2 come within range");
    assert_true(row_of(ASDIC_TERM_OBJECTS)->kept && isinf(row_of(ASDIC_TERM_OBJECTS)->bound_db));
    y.poses[1].position_m = (asdic_vec3){250.0, 0.0, 7.0};
    y.count = 2;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "2 of 2 come within range");
    end(&y);

    y = begin(false, true);
    assert_ok(ctx,
              asdic_scene_add_bottom(y.scene, mesh, (asdic_pose){.position_m = {0.0, 0.0, 50.0}},
                                     asdic_material_bottom(2.0)));
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_BOTTOM)->reason, "a mesh, traced");
    assert_true(row_of(ASDIC_TERM_BOTTOM)->kept && isinf(row_of(ASDIC_TERM_BOTTOM)->bound_db));
    assert_string_equal(row_of(ASDIC_TERM_OBJECTS)->reason, "none of 0 comes within range");
    end(&y);
    asdic_mesh_destroy(&mesh);
}

/* Straight rays graze the surface from a sonar at it; those that bend upwards come back to it. */
static void a_sonar_at_the_surface_hears_it_where_rays_come_back(void **state) {
    (void)state;
    for (int bends = 0; bends < 2; bends++) {
        yard y = begin(true, true);
        y.poses[0].position_m.z = 0.0;
        y.env.sound_speed_gradient_per_s = bends ? 0.5 : 0.0;
        make(&y);
        assert_true(row_of(ASDIC_TERM_SURFACE)->kept == (bends != 0));
        end(&y);
    }
}

/* A quadrature for every depth and attitude, which 32 pings a beam must share; eight at most are remembered. */
static void quadratures_want_many_pings(void **state) {
    (void)state;
    yard y = begin(true, true);
    for (size_t i = 0; i < 400; i++) {
        y.poses[i].position_m = (asdic_vec3){(double)i, 0.0, 7.0};
        y.poses[i].yaw_rad = 0.01 * (double)i;
    }
    y.count = 31;
    make(&y);
    assert_true(row_of(ASDIC_TERM_RAYS)->kept);
    y.count = 32;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_RAYS)->reason,
                        "a flat scene without objects: 1 quadratures for 32 pings");
    assert_false(row_of(ASDIC_TERM_RAYS)->kept);
    assert_true(row_of(ASDIC_TERM_RAYS)->bound_db == 0.0);
    y.sampling.coherent = true; /* of scatterers, one by one */
    make(&y);
    assert_true(row_of(ASDIC_TERM_RAYS)->kept);
    y.sampling.coherent = false;
    y.sampling.truth = true; /* directions */
    make(&y);
    assert_true(row_of(ASDIC_TERM_RAYS)->kept);
    y.sampling.truth = false;
    y.sonar.receiver_count = 2;
    y.count = 63;
    make(&y);
    assert_true(row_of(ASDIC_TERM_RAYS)->kept);
    y.count = 64;
    make(&y);
    assert_false(row_of(ASDIC_TERM_RAYS)->kept);
    y.sonar.receiver_count = 1;
    for (size_t i = 0; i < 400; i++) {
        y.poses[i].position_m.z = 3.0 + (double)(i % 8);
    }
    y.count = 255;
    make(&y);
    assert_true(row_of(ASDIC_TERM_RAYS)->kept);
    y.count = 256;
    make(&y);
    assert_string_equal(row_of(ASDIC_TERM_RAYS)->reason,
                        "a flat scene without objects: 8 quadratures for 256 pings");
    y.poses[300].pitch_rad = 0.01;
    y.count = 300;
    make(&y);
    assert_false(row_of(ASDIC_TERM_RAYS)->kept);
    y.count = 400; /* a ninth view */
    make(&y);
    assert_true(row_of(ASDIC_TERM_RAYS)->kept);
    assert_contains(row_of(ASDIC_TERM_RAYS)->reason, "too few pings");
    end(&y);

    y = begin(true, true);
    add_box(&y, "box", 1.0, 30.0, 0.0, 45.0);
    make(&y);
    char rays[32];
    snprintf(rays, sizeof rays, "%u a ping", y.sampling.rays);
    assert_string_equal(row_of(ASDIC_TERM_RAYS)->reason, rays);
    assert_true(row_of(ASDIC_TERM_RAYS)->kept && isinf(row_of(ASDIC_TERM_RAYS)->bound_db));
    end(&y);
}

static void what_is_missing_is_refused(void **state) {
    (void)state;
    yard y = begin(true, true);
    y.sonar.receivers = y.receivers;
    assert_status(ctx,
                  asdic_plan_make(ctx, y.scene, &y.env, &y.sonar, &y.sampling, y.poses, 1, &plan),
                  ASDIC_ERROR_ARGUMENT);
    assert_contains(asdic_context_error(ctx), "not committed");
    asdic_scene_commit(y.scene);
    const asdic_pose there = y.poses[0];
    y.poses[0].position_m.z = NAN; /* is not above everything */
    assert_status(ctx,
                  asdic_plan_make(ctx, y.scene, &y.env, &y.sonar, &y.sampling, y.poses, 1, &plan),
                  ASDIC_ERROR_ARGUMENT);
    y.poses[0] = there;
    assert_status(ctx,
                  asdic_plan_make(ctx, y.scene, &y.env, &y.sonar, &y.sampling, y.poses, 0, &plan),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(ctx,
                  asdic_plan_make(ctx, y.scene, &y.env, &y.sonar, &y.sampling, y.poses, 1, NULL),
                  ASDIC_ERROR_ARGUMENT);
    assert_status(ctx, asdic_plan_make(ctx, y.scene, &y.env, NULL, &y.sampling, y.poses, 1, &plan),
                  ASDIC_ERROR_ARGUMENT);
    y.env.salinity_ppt = -1.0;
    assert_status(ctx,
                  asdic_plan_make(ctx, y.scene, &y.env, &y.sonar, &y.sampling, y.poses, 1, &plan),
                  ASDIC_ERROR_ARGUMENT);
    y.env.salinity_ppt = 35.0;
    y.sonar.bin_length_m = -1.0;
    assert_status(ctx,
                  asdic_plan_make(ctx, y.scene, &y.env, &y.sonar, &y.sampling, y.poses, 1, &plan),
                  ASDIC_ERROR_ARGUMENT);
    assert_string_equal(asdic_term_name(ASDIC_TERM_RAYS), "rays");
    assert_string_equal(asdic_term_name(ASDIC_TERM_COUNT), "unknown term");
    end(&y);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(reasons_have_their_numbers),
        cmocka_unit_test(the_nearest_place_counts),
        cmocka_unit_test(boric_acid_is_bounded_by_the_range),
        cmocka_unit_test(bounds_grow_with_the_energy),
        cmocka_unit_test(water_is_seen_through_the_solid_angle),
        cmocka_unit_test(objects_are_counted),
        cmocka_unit_test(boxes_add_up),
        cmocka_unit_test(very_many_objects_are_judged_at_once),
        cmocka_unit_test(mirrors_are_bounded_by_both_ways),
        cmocka_unit_test(places_make_no_difference),
        cmocka_unit_test(what_moves_is_kept),
        cmocka_unit_test(a_sonar_at_the_surface_hears_it_where_rays_come_back),
        cmocka_unit_test(quadratures_want_many_pings),
        cmocka_unit_test(what_is_missing_is_refused),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
