/*
 * Where the lobes of beams meet the bottom.
 */
#include "asserts.h"
#include "area.h"
#include "test_context.h"

#include "lib/base/vec.h"
#include "lib/mission/run/run_footprint.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdlib.h>

#define HALF_POWER 0.442946 /* sin(u) / u squared is a half at u = 0.442946 pi */

static const asdic_relief no_relief;

/* Vehicle heading east, 10 m above a flat bottom; lobe edges by trigonometry. */
static void footprint_on_a_plane(void **state) {
    (void)state;
    asdic_beam beam = {.pitch_rad = 0.5, .length_h_m = 0.1, .length_v_m = 0.05};
    asdic_swath swath = {.beams = &beam, .count = 1, .wavelength_m = 0.015, .range_m = 100};
    asdic_pose pose = {.position_m = {3, 7, 20}, .yaw_rad = 0.5 * ASDIC_PI};
    asdic_seafloor ground = {.relief = &no_relief, .plane_depth_m = 30};
    asdic_chart_area area;
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_false(area.dashed);
    double half_v = asin(HALF_POWER * 0.015 / 0.05);
    size_t middle = area.count / 4; /* of 17 near points, then 17 far ones */
    assert_int_equal(area.count, 34);
    assert_close(area.east_m[middle], 7.0 + 10.0 / tan(0.5 + half_v), 1e-9);
    assert_close(area.north_m[middle], 3.0, 1e-9);
    assert_close(area.east_m[middle + 17], 7.0 + 10.0 / tan(0.5 - half_v), 1e-9);
    /* Heading east, port is north: the first point is the near one to port. */
    assert_true(area.north_m[0] > 3.0 && area.north_m[16] < 3.0);
    asdic_footprint_finish(&area);
    /* Looking up, it meets nothing: the lobe itself, dashed. */
    beam.pitch_rad = -0.5;
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_true(area.dashed);
    assert_int_equal(area.count, 1 + 17);
    assert_close(area.north_m[0], 3.0, 1e-9); /* from the sonar */
    assert_close(area.east_m[0], 7.0, 1e-9);
    for (size_t i = 0; i < 17; i++) { /* to its range, from the last direction back to the first */
        double aside = asin(HALF_POWER * 0.015 / 0.1) * (1.0 - (double)i / 8.0);
        assert_close(area.north_m[1 + i], 3.0 - 100.0 * sin(aside), 1e-9);
        assert_close(area.east_m[1 + i], 7.0 + 100.0 * cos(0.5) * cos(aside), 1e-9);
    }
    asdic_footprint_finish(&area);
    /* Level, it meets the bottom by its lower edge only: as far as the range goes on the bottom. */
    beam.pitch_rad = 0.0;
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_close(area.east_m[middle], 7.0 + 10.0 / tan(half_v), 1e-9);
    assert_close(area.east_m[middle + 17], 7.0 + sqrt(100.0 * 100.0 - 10.0 * 10.0), 0.02);
    asdic_footprint_finish(&area);
}

/* Straight down, and so broad that both edges pass the range: as far astern as ahead. */
static void footprint_of_a_broad_lobe(void **state) {
    (void)state;
    asdic_beam beam = {.pitch_rad = 0.5 * ASDIC_PI, .length_h_m = 0.1, .length_v_m = 0.0074};
    asdic_swath swath = {.beams = &beam, .count = 1, .wavelength_m = 0.015, .range_m = 15};
    asdic_pose pose = {.position_m = {3, 7, 20}};
    asdic_seafloor ground = {.relief = &no_relief, .plane_depth_m = 30};
    asdic_chart_area area;
    double most_m = sqrt(15.0 * 15.0 - 10.0 * 10.0); /* the lobe's edges: 64 degrees from below */
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_false(area.dashed);
    assert_close(area.north_m[8], 3.0 - most_m, 1e-3);
    assert_close(area.north_m[8 + 17], 3.0 + most_m, 1e-3);
    asdic_footprint_finish(&area);
    /* As broad across: nothing of it lies beyond the range. */
    beam.length_h_m = 0.0074;
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    for (size_t i = 0; i < area.count; i++) {
        assert_true(hypot(area.north_m[i] - 3.0, area.east_m[i] - 7.0) <= most_m + 1e-9);
    }
    asdic_footprint_finish(&area);
    beam.length_h_m = 0.1;
    /* Level, and open all round: from straight below. */
    beam.pitch_rad = 0.0;
    beam.length_v_m = 0.006;
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_close(area.north_m[8], 3.0, 1e-9);
    assert_close(area.north_m[8 + 17], 3.0 + most_m, 1e-3);
    asdic_footprint_finish(&area);
}

/* Of more than eight beams each has its place on the edges, in its bearing. */
static void footprint_of_many_beams(void **state) {
    enum { BEAMS = 9 };
    (void)state;
    asdic_beam beams[BEAMS];
    for (int b = 0; b < BEAMS; b++) {
        beams[b] = (asdic_beam){
            .yaw_rad = (b - 4) * 0.17, .pitch_rad = 0.5, .length_h_m = 0.1, .length_v_m = 0.05};
    }
    asdic_swath swath = {.beams = beams, .count = BEAMS, .wavelength_m = 0.015, .range_m = 100};
    asdic_pose pose = {.position_m = {3, 7, 20}, .yaw_rad = 0.5 * ASDIC_PI};
    asdic_seafloor ground = {.relief = &no_relief, .plane_depth_m = 30};
    asdic_chart_area area;
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_int_equal(area.count, 2 * (BEAMS + 2)); /* and the outer edges of the outer two */
    double half_h = asin(HALF_POWER * 0.015 / 0.1);
    for (int i = 0; i < BEAMS + 2; i++) {
        double yaw = i == 0           ? beams[0].yaw_rad - half_h
                     : i == BEAMS + 1 ? beams[BEAMS - 1].yaw_rad + half_h
                                      : beams[i - 1].yaw_rad;
        double bearing = atan2(3.0 - area.north_m[i], area.east_m[i] - 7.0);
        assert_close(bearing, yaw, i == 0 || i == BEAMS + 1 ? 0.02 : 1e-9);
    }
    asdic_footprint_finish(&area);
}

/* All round, with lobes broader than a step, there is a ring, and nothing of it twice. */
static void footprint_all_round(void **state) {
    enum { BEAMS = 72 };
    (void)state;
    asdic_beam beams[BEAMS];
    for (int b = 0; b < BEAMS; b++) {
        beams[b] = (asdic_beam){.yaw_rad = (b - 36) * ASDIC_PI / 36.0,
                                .pitch_rad = 0.5,
                                .length_h_m = 0.05,
                                .length_v_m = 0.05};
    }
    asdic_swath swath = {.beams = beams, .count = BEAMS, .wavelength_m = 0.015, .range_m = 100};
    asdic_pose pose = {.position_m = {3, 7, 20}, .yaw_rad = 1.0};
    asdic_seafloor ground = {.relief = &no_relief, .plane_depth_m = 30};
    asdic_chart_area area;
    double half_v = asin(HALF_POWER * 0.015 / 0.05);
    double far_m = 10.0 / tan(0.5 - half_v), near_m = 10.0 / tan(0.5 + half_v);
    double corners = BEAMS / ASDIC_PI * sin(ASDIC_PI / BEAMS) * cos(ASDIC_PI / BEAMS);
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_close_relative(fabs(area_of(area.north_m, area.east_m, area.count)),
                          ASDIC_PI * corners * (far_m * far_m - near_m * near_m), 1e-9);
    asdic_footprint_finish(&area);
    /* Looking up: the circle to which they hear. */
    for (int b = 0; b < BEAMS; b++) {
        beams[b].pitch_rad = -0.5;
    }
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_true(area.dashed);
    for (size_t i = 0; i < area.count; i++) {
        assert_close(hypot(area.north_m[i] - 3.0, area.east_m[i] - 7.0), 100.0 * cos(0.5), 1e-9);
    }
    asdic_footprint_finish(&area);
}

/* Where a ray that leaves 20 m at DOWN meets 30 m: arcs of circles, whose angles keep cos / c; x from level to
 * level is c / (g cos) times the difference of the sines (C. B. Officer, 1958, ch. 2). */
static double arcs_m(const double *depth_m, const double *speed_mps, int layers, double down_rad) {
    double x_m = 0.0, angle = down_rad;
    for (int i = 0; i < layers; i++) {
        double g = (speed_mps[i + 1] - speed_mps[i]) / (depth_m[i + 1] - depth_m[i]);
        double next = acos(cos(angle) * speed_mps[i + 1] / speed_mps[i]);
        x_m += speed_mps[i] / (g * cos(angle)) * (sin(angle) - sin(next));
        angle = next;
    }
    return x_m;
}

static void footprint_in_water_that_bends(void **state) {
    (void)state;
    const double depth_m[] = {20, 24, 30}, speed_mps[] = {1490, 1480, 1474};
    asdic_layers layers = {
        2, {{-INFINITY, 24, 20, 1490, -2.5, 0, false}, {24, INFINITY, 24, 1480, -1.0, 1, false}}};
    asdic_beam beam = {.pitch_rad = 0.5, .length_h_m = 0.1, .length_v_m = 0.05};
    asdic_swath swath = {
        .beams = &beam, .count = 1, .wavelength_m = 0.015, .range_m = 200, .layers = &layers};
    asdic_pose pose = {.position_m = {3, 7, 20}};
    asdic_seafloor ground = {.relief = &no_relief, .plane_depth_m = 30};
    double half_v = asin(HALF_POWER * 0.015 / 0.05);
    for (int level = 0; level < 2; level++) {
        asdic_chart_area area;
        beam.pitch_rad = level ? half_v + 1e-4 : 0.5; /* the upper edge level, or nearly */
        assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
        assert_false(area.dashed);
        size_t middle = area.count / 4;
        double near_m = arcs_m(depth_m, speed_mps, 2, beam.pitch_rad + half_v);
        double far_m = arcs_m(depth_m, speed_mps, 2, beam.pitch_rad - half_v);
        assert_close(area.north_m[middle], 3.0 + near_m, 5e-3);
        assert_close(area.north_m[middle + 17], 3.0 + far_m, 5e-3);
        assert_close(area.east_m[middle], 7.0, 1e-9);
        asdic_footprint_finish(&area);
    }
    /* Upward refraction: the lower edge, too, turns before the bottom. */
    layers = (asdic_layers){1, {{-INFINITY, INFINITY, 20, 1490, 5.0, 0, false}}};
    beam.pitch_rad = 0.0;
    asdic_chart_area area;
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_true(area.dashed);
    asdic_footprint_finish(&area);
}

enum { SIDE = 100 };

/* As many metres a side, around the origin. */
static asdic_relief square(float *depth_m) {
    return (asdic_relief){.columns = SIDE,
                          .rows = SIDE,
                          .west_m = -0.5 * SIDE,
                          .south_m = -0.5 * SIDE,
                          .cell_m = 1,
                          .depth_m = depth_m};
}

/* East of 45 degrees, in the outer half of a beam, there is no bottom: the area ends there. Where
 * there is none between 40 and 50 degrees, it returns along the range instead of by a chord through
 * what the beam does not see. */
static void footprint_beside_a_hole(void **state) {
    (void)state;
    float *depth_m = malloc(SIDE * SIDE * sizeof *depth_m);
    asdic_relief relief = square(depth_m);
    asdic_beam beam = {.pitch_rad = 0.3, .length_h_m = 0.0075, .length_v_m = 0.05};
    asdic_swath swath = {.beams = &beam, .count = 1, .wavelength_m = 0.015, .range_m = 40};
    asdic_pose pose = {.position_m = {0, 0, 5}, .yaw_rad = 0.25 * ASDIC_PI};
    asdic_seafloor ground = {.relief = &relief, .plane_depth_m = INFINITY};
    for (int between = 0; between < 2; between++) {
        double from_deg = between ? 40.0 : 45.0, to_deg = between ? 50.0 : 136.0;
        for (int i = 0; i < SIDE * SIDE; i++) {
            double bearing_deg = atan2(i % SIDE - 49.5, 49.5 - i / SIDE) * 180.0 / ASDIC_PI;
            depth_m[i] = bearing_deg > from_deg && bearing_deg < to_deg ? NAN : 10.0f;
        }
        asdic_chart_area area;
        assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
        assert_false(area.dashed);
        size_t inside = 0, at_range = 0;
        for (size_t i = 0; i < area.count; i++) {
            double range_m = hypot(area.north_m[i], area.east_m[i]);
            double bearing_deg = atan2(area.east_m[i], area.north_m[i]) * 180.0 / ASDIC_PI;
            bool is_inside = bearing_deg > from_deg + 1.5 && bearing_deg < to_deg - 1.5;
            inside += is_inside;
            at_range += is_inside && range_m > 35.0;
        }
        assert_int_equal(inside, at_range);
        assert_true(between ? area.count == 34 && inside > 0 : area.count < 24 && inside == 0);
        asdic_footprint_finish(&area);
    }
    free(depth_m);
}

static void footprint_on_terrain(void **state) {
    (void)state;
    /* A wall up to the surface at x = 30 m stops a level beam that would go on to 100 m. */
    float *depth_m = malloc(SIDE * SIDE * sizeof *depth_m);
    asdic_relief relief = square(depth_m);
    for (int i = 0; i < SIDE * SIDE; i++) {
        double north_m = 49.5 - i / SIDE;
        depth_m[i] = north_m > 30.0 ? 0.0f : 10.0f;
    }
    asdic_beam beam = {.length_h_m = 0.1, .length_v_m = 0.05};
    asdic_swath swath = {.beams = &beam, .count = 1, .wavelength_m = 0.015, .range_m = 45};
    asdic_pose pose = {.position_m = {0, 0, 5}};
    asdic_seafloor ground = {.relief = &relief, .plane_depth_m = INFINITY};
    asdic_chart_area area;
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_false(area.dashed);
    assert_close(area.north_m[8 + 17], 30.0, 1.0);
    asdic_footprint_finish(&area);
    free(depth_m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(footprint_on_a_plane),
        cmocka_unit_test(footprint_of_a_broad_lobe),
        cmocka_unit_test(footprint_of_many_beams),
        cmocka_unit_test(footprint_all_round),
        cmocka_unit_test(footprint_in_water_that_bends),
        cmocka_unit_test(footprint_on_terrain),
        cmocka_unit_test(footprint_beside_a_hole),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
