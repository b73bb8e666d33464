/*
 * The mission from above: relief and outlines of a scene, footprints of beams, overview, and that the
 * picture shows them where they say.
 */
#include "asserts.h"
#include "test_context.h"

#include "lib/base/vec.h"
#include "lib/mission/run/run_footprint.h"
#include "lib/mission/run/run_chart_data.h"
#include "lib/out/draw_chart_page.h"
#include "lib/out/overview.h"
#include "lib/out/raster_relief.h"
#include "lib/scene/chart.h"

#include <asdic/asdic.h>

#include <math.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define HALF_POWER 0.442946 /* sin(u) / u squared is a half at u = 0.442946 pi */

/* A slope from 10 m deep at the south edge (x = 0) to 20 m at the north edge (x = 100), y 0..50. */
static asdic_scene *slope_scene(void) {
    const double corners_m[] = {0, 0, 10, 100, 0, 20, 100, 50, 20, 0, 50, 10};
    const uint32_t triangles[] = {0, 1, 2, 0, 2, 3};
    asdic_scene *scene;
    asdic_mesh *mesh;
    asdic_material sand;
    assert_int_equal(asdic_scene_create(ctx, &scene), ASDIC_OK);
    assert_int_equal(asdic_mesh_from_triangles(ctx, corners_m, 4, triangles, 2, &mesh), ASDIC_OK);
    sand = asdic_material_bottom(2.0);
    assert_int_equal(asdic_scene_add_bottom(scene, mesh, (asdic_pose){0}, sand), ASDIC_OK);
    asdic_mesh_destroy(&mesh);
    return scene;
}

static void relief_is_the_bottoms_depth(void **state) {
    (void)state;
    asdic_scene *scene = slope_scene();
    float depth_m[12 * 7];
    asdic_relief relief = {
        .columns = 7, .rows = 12, .west_m = -10, .south_m = -10, .cell_m = 10, .depth_m = depth_m};
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    asdic_chart_relief(scene, &relief);
    for (size_t row = 0; row < 12; row++) {
        for (size_t column = 0; column < 7; column++) {
            double north_m = -10.0 + (11.5 - (double)row) * 10.0;
            double east_m = -10.0 + ((double)column + 0.5) * 10.0;
            bool is_there = north_m > 0.0 && north_m < 100.0 && east_m > 0.0 && east_m < 50.0;
            if (is_there) {
                assert_close(depth_m[row * 7 + column], 10.0 + 0.1 * north_m, 1e-4);
            } else {
                assert_true(isnan(depth_m[row * 7 + column]));
            }
        }
    }
    double low_m, high_m;
    assert_true(asdic_relief_span(&relief, -10, 60, 0, 50, &low_m, &high_m));
    assert_close(low_m, 10.5, 1e-4);
    assert_close(high_m, 14.5, 1e-4);
    assert_false(asdic_relief_span(&relief, 100, 200, 0, 50, &low_m, &high_m));
    asdic_scene_destroy(&scene);
}

/* Of a single triangle only the cells whose centre lies in it, not all of its box. */
static void relief_keeps_to_its_triangles(void **state) {
    (void)state;
    enum { SIDE = 10 };
    const double corners_m[] = {0, 0, 10, 10, 0, 10, 0, 10, 10};
    const uint32_t triangle[] = {0, 1, 2};
    asdic_scene *scene;
    asdic_mesh *mesh;
    float depth_m[SIDE * SIDE];
    asdic_relief relief = {.columns = SIDE, .rows = SIDE, .cell_m = 1, .depth_m = depth_m};
    assert_int_equal(asdic_scene_create(ctx, &scene), ASDIC_OK);
    assert_int_equal(asdic_mesh_from_triangles(ctx, corners_m, 3, triangle, 1, &mesh), ASDIC_OK);
    asdic_material sand = asdic_material_bottom(2.0);
    assert_int_equal(asdic_scene_add_bottom(scene, mesh, (asdic_pose){0}, sand), ASDIC_OK);
    asdic_mesh_destroy(&mesh);
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    asdic_chart_relief(scene, &relief);
    for (size_t row = 0; row < SIDE; row++) {
        for (size_t column = 0; column < SIDE; column++) {
            float found_m = depth_m[row * SIDE + column];
            double north_m = 9.5 - (double)row, east_m = (double)column + 0.5;
            if (north_m + east_m < 9.5) {
                assert_close(found_m, 10.0, 1e-6);
            } else if (north_m + east_m > 10.5) { /* at 10 m they lie on the edge */
                assert_true(isnan(found_m));
            }
        }
    }
    asdic_scene_destroy(&scene);
}

/* A ball over a plane shows where objects are told apart; one that moves does not. */
static void relief_tells_objects_apart(void **state) {
    (void)state;
    asdic_scene *scene;
    asdic_mesh *ball;
    asdic_material sand = asdic_material_bottom(2.0);
    enum { SIDE = 10 };
    float depth_m[SIDE * SIDE];
    bool is_object[SIDE * SIDE];
    asdic_relief relief = {.columns = SIDE, .rows = SIDE, .cell_m = 1, .depth_m = depth_m};
    assert_int_equal(asdic_scene_create(ctx, &scene), ASDIC_OK);
    assert_int_equal(asdic_scene_set_bottom_plane(scene, 20, sand), ASDIC_OK);
    assert_int_equal(asdic_mesh_sphere(ctx, 0.9, 48, &ball), ASDIC_OK);
    asdic_pose still = {.position_m = {7.5, 2.5, 15}}, moves = {.position_m = {2.5, 7.5, 15}};
    assert_int_equal(asdic_scene_add_object(scene, "still", ball, still, sand), ASDIC_OK);
    assert_int_equal(asdic_scene_add_moving_object(scene, "moves", ball, moves, sand), ASDIC_OK);
    asdic_mesh_destroy(&ball);
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    asdic_chart_relief(scene, &relief);
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        assert_close(depth_m[i], 20.0, 1e-6);
    }
    relief.is_object = is_object;
    asdic_chart_relief(scene, &relief);
    size_t at = 2 * SIDE + 2; /* row 0 is the most northern */
    assert_close(depth_m[at], 14.1, 0.01);
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        assert_int_equal(is_object[i], i == at);
    }
    double low_m, high_m;
    assert_true(asdic_relief_span(&relief, 0, 10, 0, 10, &low_m, &high_m));
    assert_close(low_m, 19.95, 1e-6);
    asdic_scene_destroy(&scene);
}

static void relief_is_lit_from_the_north_west(void **state) {
    (void)state;
    /* Ridges along both diagonals: flanks facing north-west are brighter than those facing
     * south-east, at equal depth. */
    enum { SIDE = 21 };
    float depth_m[SIDE * SIDE];
    asdic_relief relief = {.columns = SIDE, .rows = SIDE, .cell_m = 1, .depth_m = depth_m};
    for (int i = 0; i < SIDE * SIDE; i++) {
        depth_m[i] = 20.0f + 0.3f * fabsf((float)(i / SIDE + i % SIDE - SIDE + 1));
    }
    asdic_raster raster;
    asdic_relief_look look = {.low_m = 10, .high_m = 40};
    for (uint32_t i = 0; i < 256; i++) {
        look.bottom_rgb[i] = i * 0x10101u;
    }
    assert_int_equal(asdic_raster_relief(ctx, &relief, &look, &raster), ASDIC_OK);
    const uint8_t *north_west = raster.rgb + 3 * (5 * SIDE + 5);
    const uint8_t *south_east = raster.rgb + 3 * (15 * SIDE + 15);
    assert_true(north_west[0] > south_east[0] + 40);
    asdic_raster_finish(&raster);
}

/* Depths from west to east, and from north to south, which is the same to the light; WANT is the colour of
 * each, 0xc8640a for a flat bottom and 0x640ac8 for an object. */
static void check_light(const float *line_m, size_t count, bool is_object, const uint32_t *want) {
    enum { WIDE = 3, MOST = 9 };
    asdic_relief_look look = {
        .low_m = 10, .high_m = 40, .object_rgb = 0x640ac8, .empty_rgb = 0x123456};
    for (size_t i = 0; i < 256; i++) {
        look.bottom_rgb[i] = 0xc8640a;
    }
    for (int south = 0; south < 2; south++) {
        float depth_m[WIDE * MOST];
        bool objects[WIDE * MOST];
        asdic_raster raster;
        asdic_relief relief = {.columns = south ? WIDE : count,
                               .rows = south ? count : WIDE,
                               .cell_m = 1,
                               .depth_m = depth_m,
                               .is_object = objects};
        for (size_t i = 0; i < WIDE * count; i++) {
            depth_m[i] = line_m[south ? i / WIDE : i % count];
            objects[i] = is_object;
        }
        assert_int_equal(asdic_raster_relief(ctx, &relief, &look, &raster), ASDIC_OK);
        for (size_t i = 0; i < WIDE * count; i++) {
            const uint8_t *p = raster.rgb + 3 * i;
            uint32_t rgb = (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
            assert_int_equal(rgb, want[south ? i / WIDE : i % count]);
        }
        asdic_raster_finish(&raster);
    }
}

/* The light's share on a slope s down towards it is (1 + s / sqrt(2)) / sqrt(1 + s^2), from 0.6 to 1.25. Of a
 * bottom slopes are exaggerated to a root mean square of a half, at most 20 times. */
static void light_falls_on_slopes(void **state) {
    (void)state;
    const uint32_t flat = 0xc8640a, none = 0x123456, dark = 0x783c06;
    /* Slopes of 0, 0.5, 0.5, 0, 0: 0.79 as shown, a share of 1.223. */
    check_light((const float[]){21, 21, 20, 20, 20}, 5, false,
                (const uint32_t[]){flat, 0xf57a0c, 0xf57a0c, flat, flat});
    check_light((const float[]){20, 20, 21, 21, 21}, 5, false,
                (const uint32_t[]){flat, dark, dark, flat, flat});
    /* 0.01 becomes 0.2, to the very edges: 1.119 and 0.842. */
    const uint32_t bright = 0xe0700b, dim = 0xa85408;
    check_light((const float[]){20.02f, 20.01f, 20}, 3, false,
                (const uint32_t[]){bright, bright, bright});
    check_light((const float[]){20, 20.01f, 20.02f}, 3, false, (const uint32_t[]){dim, dim, dim});
    /* Beside a hole a cell's own depth stands for what is not known. */
    check_light((const float[]){21, NAN, 20, 20}, 4, false,
                (const uint32_t[]){flat, none, flat, flat});
    /* Of an object they are as they are: 0.5, a share of 1.211. */
    check_light((const float[]){21, 21, 20, 20}, 4, true,
                (const uint32_t[]){0x640ac8, 0x790cf2, 0x790cf2, 0x640ac8});
}

/* From the greatest depth that is shown, 0, to the least, 255; cells that stand alone are flat. */
static void relief_is_coloured_by_depth(void **state) {
    (void)state;
    float depth_m[] = {10, NAN, 25, NAN, 38.9f, NAN, 40, NAN, 41, NAN, 9};
    const uint32_t want[] = {255, 0x777, 128, 0x777, 9, 0x777, 0, 0x777, 0, 0x777, 255};
    asdic_relief relief = {.columns = 11, .rows = 1, .cell_m = 1, .depth_m = depth_m};
    asdic_relief_look look = {.low_m = 10, .high_m = 40, .empty_rgb = 0x777};
    asdic_raster raster;
    for (uint32_t i = 0; i < 256; i++) {
        look.bottom_rgb[i] = i;
    }
    assert_int_equal(asdic_raster_relief(ctx, &relief, &look, &raster), ASDIC_OK);
    for (size_t i = 0; i < 11; i++) {
        assert_int_equal(raster.rgb[3 * i + 1] << 8 | raster.rgb[3 * i + 2], want[i]);
    }
    asdic_raster_finish(&raster);
}

static double area_of(const double *north_m, const double *east_m, size_t count) {
    double twice = 0.0;
    for (size_t i = 0; i < count; i++) {
        size_t k = (i + 1) % count;
        twice += north_m[i] * east_m[k] - north_m[k] * east_m[i];
    }
    return 0.5 * twice; /* positive clockwise, north up and east right */
}

static void add_object(asdic_scene *scene, const char *name, asdic_mesh *mesh, asdic_pose pose) {
    asdic_material steel = asdic_material_bottom(2.0);
    assert_int_equal(asdic_scene_add_object(scene, name, mesh, pose, steel), ASDIC_OK);
    asdic_mesh_destroy(&mesh);
}

static void outlines_are_the_objects(void **state) {
    (void)state;
    asdic_scene *scene = slope_scene();
    asdic_outline *outlines;
    asdic_mesh *mesh;
    size_t count;
    assert_int_equal(asdic_mesh_box(ctx, (asdic_vec3){4, 2, 1}, &mesh), ASDIC_OK);
    add_object(scene, "box", mesh,
               (asdic_pose){.position_m = {50, 20, 5}, .yaw_rad = 30.0 * ASDIC_PI / 180.0});
    assert_int_equal(asdic_mesh_sphere(ctx, 3.0, 48, &mesh), ASDIC_OK);
    add_object(scene, "ball", mesh, (asdic_pose){.position_m = {70, 30, 5}});
    assert_int_equal(asdic_scene_add_point(scene, "buoy", (asdic_vec3){1, 2, 3}, -20), ASDIC_OK);
    /* Two triangles far apart in one mesh: two things. */
    const double corners_m[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 40, 40, 0, 41, 40, 0, 40, 41, 0};
    const uint32_t triangles[] = {0, 1, 2, 3, 4, 5};
    assert_int_equal(asdic_mesh_from_triangles(ctx, corners_m, 6, triangles, 2, &mesh), ASDIC_OK);
    add_object(scene, "pair", mesh, (asdic_pose){0});
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    assert_int_equal(asdic_chart_outlines(ctx, scene, &outlines, &count), ASDIC_OK);
    assert_int_equal(count, 5);
    assert_string_equal(outlines[0].name, "box");
    assert_int_equal(outlines[0].count, 4);
    assert_close(area_of(outlines[0].north_m, outlines[0].east_m, 4), 8.0, 1e-3);
    assert_string_equal(outlines[1].name, "ball");
    assert_int_equal(outlines[1].count, 24);
    double disc_m2 = area_of(outlines[1].north_m, outlines[1].east_m, outlines[1].count);
    assert_close(disc_m2, ASDIC_PI * 9.0, 1.0); /* a polygon of 24 sides, within a mesh */
    assert_string_equal(outlines[2].name, "pair");
    assert_string_equal(outlines[3].name, "pair");
    for (int i = 2; i < 4; i++) {
        assert_int_equal(outlines[i].count, 3);
        assert_close(area_of(outlines[i].north_m, outlines[i].east_m, 3), 0.5, 1e-4);
    }
    assert_string_equal(outlines[4].name, "buoy");
    assert_int_equal(outlines[4].count, 1);
    assert_close(outlines[4].north_m[0], 1.0, 0.0);
    assert_close(outlines[4].east_m[0], 2.0, 0.0);
    free(outlines);
    asdic_scene_destroy(&scene);
}

static const asdic_relief no_relief;

/* Vehicle heading east, 10 m above a flat bottom; lobe edges by trigonometry. */
static void footprint_on_a_plane(void **state) {
    (void)state;
    asdic_beam beam = {.pitch_rad = 0.5, .length_h_m = 0.1, .length_v_m = 0.05};
    asdic_swath swath = {.beams = &beam, .count = 1, .wavelength_m = 0.015, .range_m = 100};
    asdic_pose pose = {.position_m = {3, 7, 20}, .yaw_rad = 0.5 * ASDIC_PI};
    asdic_ground ground = {.relief = &no_relief, .plane_depth_m = 30};
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
    asdic_ground ground = {.relief = &no_relief, .plane_depth_m = 30};
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
    asdic_ground ground = {.relief = &no_relief, .plane_depth_m = 30};
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
    asdic_ground ground = {.relief = &no_relief, .plane_depth_m = 30};
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
    asdic_ground ground = {.relief = &no_relief, .plane_depth_m = 30};
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

/* East of 45 degrees, in the outer half of a beam, there is no bottom: the area ends there. Where
 * there is none between 40 and 50 degrees, it returns along the range instead of by a chord through
 * what the beam does not see. */
static void footprint_beside_a_hole(void **state) {
    (void)state;
    enum { SIDE = 100 };
    float *depth_m = malloc(SIDE * SIDE * sizeof *depth_m);
    asdic_relief relief = {.columns = SIDE,
                           .rows = SIDE,
                           .west_m = -50,
                           .south_m = -50,
                           .cell_m = 1,
                           .depth_m = depth_m};
    asdic_beam beam = {.pitch_rad = 0.3, .length_h_m = 0.0075, .length_v_m = 0.05};
    asdic_swath swath = {.beams = &beam, .count = 1, .wavelength_m = 0.015, .range_m = 40};
    asdic_pose pose = {.position_m = {0, 0, 5}, .yaw_rad = 0.25 * ASDIC_PI};
    asdic_ground ground = {.relief = &relief, .plane_depth_m = INFINITY};
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
    enum { SIDE = 100 };
    float *depth_m = malloc(SIDE * SIDE * sizeof *depth_m);
    asdic_relief relief = {.columns = SIDE,
                           .rows = SIDE,
                           .west_m = -50,
                           .south_m = -50,
                           .cell_m = 1,
                           .depth_m = depth_m};
    for (int i = 0; i < SIDE * SIDE; i++) {
        double north_m = 49.5 - i / SIDE;
        depth_m[i] = north_m > 30.0 ? 0.0f : 10.0f;
    }
    asdic_beam beam = {.length_h_m = 0.1, .length_v_m = 0.05};
    asdic_swath swath = {.beams = &beam, .count = 1, .wavelength_m = 0.015, .range_m = 45};
    asdic_pose pose = {.position_m = {0, 0, 5}};
    asdic_ground ground = {.relief = &relief, .plane_depth_m = INFINITY};
    asdic_chart_area area;
    assert_int_equal(asdic_footprint_find(ctx, &swath, &pose, &ground, &area), ASDIC_OK);
    assert_false(area.dashed);
    assert_close(area.north_m[8 + 17], 30.0, 1.0);
    asdic_footprint_finish(&area);
    free(depth_m);
}

static void overview_keeps_the_strongest(void **state) {
    (void)state;
    /* 3000 pings in groups of 3, 2 beams, 4 bins of 10 m; a gain of 20 log r decides. */
    asdic_overview o;
    const float noise_db[8] = {NAN, NAN, NAN, NAN, -100, -100, -100, -100};
    assert_int_equal(asdic_overview_init(ctx, 3000, 2, 4, 10.0, &o), ASDIC_OK);
    assert_int_equal(o.rows, 1000);
    asdic_overview_set_gain(&o, 20.0, 0.0);
    for (int ping = 0; ping < 3000; ping++) {
        float peak_db = ping == 301 ? 0.0f : -60.0f;
        /* Beam 0: -40 dB at 5 m (-26 shown), the peak at 15 m; beam 1: nothing 10 dB above noise. */
        const float levels_db[8] = {-40, peak_db, NAN, -70, -95, -95, NAN, -91};
        asdic_overview_add(&o, levels_db, noise_db);
    }
    for (size_t row = 0; row < 1000; row++) {
        bool is_peak = row == 100;
        assert_close(o.range_m[2 * row], is_peak ? 15.0 : 5.0, 0);
        assert_close(o.shown_db[2 * row], is_peak ? 20.0 * log10(15.0) : -40.0 + 20.0 * log10(5.0),
                     1e-9);
        assert_true(isnan(o.shown_db[2 * row + 1]));
    }
    double low_db, high_db;
    asdic_overview_window(&o, &low_db, &high_db);
    assert_close(low_db, -30.0, 0);
    assert_close(high_db, 30.0, 0);
    asdic_overview_finish(&o);
}

/* 601 beams are shown two by two: each cell has the stronger of its own, the last beam one to itself. */
static void overview_groups_many_beams(void **state) {
    (void)state;
    enum { BEAMS = 601, COLUMNS = 301 };
    asdic_overview o;
    float levels_db[2][BEAMS], noise_db[BEAMS];
    for (int b = 0; b < BEAMS; b++) {
        levels_db[0][b] = (float)-b;
        levels_db[1][b] = (float)(b - 1000);
        noise_db[b] = NAN;
    }
    assert_int_equal(asdic_overview_init(ctx, 2, BEAMS, 1, 10.0, &o), ASDIC_OK);
    assert_int_equal(o.columns, COLUMNS);
    asdic_overview_add(&o, levels_db[0], noise_db);
    asdic_overview_add(&o, levels_db[1], noise_db);
    for (int c = 0; c < COLUMNS; c++) {
        int last = c == COLUMNS - 1 ? 2 * c : 2 * c + 1;
        assert_close(o.shown_db[c], -2.0 * c, 0.0);
        assert_close(o.shown_db[COLUMNS + c], last - 1000.0, 0.0);
        assert_close(o.range_m[c], 5.0, 0.0);
    }
    asdic_overview_finish(&o);
}

/* The gain is that of each bin's middle, and of no bin more than there are. */
static void overview_gain_is_of_its_bins(void **state) {
    (void)state;
    double gain_db[] = {7, 7, 7, 7};
    asdic_overview o = {.bins = 3, .bin_length_m = 10, .gain_db = gain_db};
    asdic_overview_set_gain(&o, 20.0, 0.1);
    assert_close(gain_db[0], 20.0 * log10(5.0) + 0.5, 1e-12);
    assert_close(gain_db[2], 20.0 * log10(25.0) + 2.5, 1e-12);
    assert_close(gain_db[3], 7.0, 0.0);
}

/* Whole tens about what is shown, ten at least, and some where nothing is. */
static void overview_has_room_for_its_levels(void **state) {
    (void)state;
    static const double cases[][4] = {{NAN, NAN, 0, 10},    {-37, NAN, -40, -30},
                                      {-40, -40, -40, -30}, {-41, 12, -50, 20},
                                      {NAN, 20, 20, 30},    {-0.5, 0.5, -10, 10}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double shown_db[2] = {cases[i][0], cases[i][1]}, low_db, high_db;
        asdic_overview o = {.rows = 1, .columns = 2, .shown_db = shown_db};
        asdic_overview_window(&o, &low_db, &high_db);
        assert_close(low_db, cases[i][2], 0.0);
        assert_close(high_db, cases[i][3], 0.0);
    }
}

/* Reverberation that its gain makes rise to the last bin is no echo; a weaker one on it is. */
static void overview_leaves_out_the_last_bin(void **state) {
    (void)state;
    asdic_overview o;
    float levels_db[100], noise_db[100];
    assert_int_equal(asdic_overview_init(ctx, 1, 1, 100, 1.0, &o), ASDIC_OK);
    asdic_overview_set_gain(&o, 40.0, 0.0);
    for (size_t i = 0; i < 100; i++) {
        levels_db[i] = -50.0f - 30.0f * log10f((float)i + 0.5f) + (i == 60 ? 1.0f : 0.0f);
        noise_db[i] = NAN;
    }
    asdic_overview_add(&o, levels_db, noise_db);
    assert_close(o.range_m[0], 60.5, 0);
    asdic_overview_finish(&o);
}

/* The red of a picture, which is deleted; the caller frees. */
static uint8_t *reds(const char *path, size_t *count) {
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_file(&image, path));
    image.format = PNG_FORMAT_RGB;
    *count = (size_t)image.width * image.height;
    uint8_t *rgb = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(rgb);
    assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
    for (size_t i = 0; i < *count; i++) {
        rgb[i] = rgb[3 * i];
    }
    unlink(path);
    return rgb;
}

/* Four piles 10 m apart, without names and with them: whatever was dark stays dark, so that no name
 * lies on a pile. */
static void names_do_not_cover_what_they_name(void **state) {
    (void)state;
    char path[] = "/tmp/asdic-chart-XXXXXX";
    assert_true(mkstemp(path) >= 0);
    const double track_north_m[2] = {0, 100}, track_east_m[2] = {0, 0};
    asdic_outline piles[4] = {0};
    asdic_chart chart = {.relief = &no_relief,
                         .outlines = piles,
                         .outline_count = 4,
                         .north_m = track_north_m,
                         .east_m = track_east_m,
                         .track_count = 2};
    asdic_picture_options options = asdic_picture_options_default();
    uint8_t *red[2];
    size_t count = 0, covered = 0, dark = 0;
    if (!asdic_picture_annotated()) {
        unlink(path);
        skip();
    }
    for (int named = 0; named < 2; named++) {
        for (size_t i = 0; i < 4; i++) {
            piles[i].count = 4;
            for (size_t k = 0; k < 4; k++) {
                piles[i].north_m[k] = 2.0 - 10.0 * (double)(i / 2) + (k < 2 ? 0.2 : -0.2);
                piles[i].east_m[k] = 12.0 + 10.0 * (double)(i % 2) + (k % 3 ? 0.2 : -0.2);
            }
            if (named) {
                snprintf(piles[i].name, sizeof piles[i].name, "pile_%zu", i);
            }
        }
        assert_int_equal(asdic_draw_chart(ctx, path, &chart, &options), ASDIC_OK);
        red[named] = reds(path, &count);
    }
    for (size_t i = 0; i < count; i++) {
        covered += red[0][i] < 0x60 && red[1][i] > 0x90;
        dark += red[1][i] < 0x60 && red[0][i] > 0x90;
    }
    assert_int_equal(covered, 0);
    assert_true(dark > 200); /* four names */
    free(red[0]);
    free(red[1]);
}

static void routes_are_the_runs(void **state) {
    (void)state;
    /* North 10 m in 10 s, then east 10 m in 10 s, turning from 350 to 20 degrees in the second leg. */
    const double turn_rad = ASDIC_PI / 180.0;
    asdic_route_point points[] = {
        {0, 0, 0, -10 * turn_rad}, {10, 10, 0, 350 * turn_rad}, {20, 10, 10, 20 * turn_rad}};
    asdic_route route = {.name = "boat", .points = points, .count = 3};
    /* Its bow 2 m ahead of its place at the first ping, a rock elsewhere. */
    asdic_outline outlines[] = {{.name = "rock", .count = 1, .north_m = {5}, .east_m = {5}},
                                {.name = "boat",
                                 .count = 1,
                                 .north_m = {2 * cos(-10 * turn_rad)},
                                 .east_m = {2 * sin(-10 * turn_rad)}}};
    asdic_chart_data data = {.routes = &route,
                             .route_count = 1,
                             .points = points,
                             .outlines = outlines,
                             .outline_count = 2};
    asdic_chart_data_cut(&data, 5.0, 15.0);
    assert_int_equal(data.route_count, 1);
    assert_int_equal(route.count, 3);
    const double expected[3][3] = {{5, 5, 0}, {10, 10, 0}, {15, 10, 5}};
    for (int i = 0; i < 3; i++) {
        assert_close(route.points[i].time_s, expected[i][0], 0);
        assert_close(route.points[i].north_m, expected[i][1], 1e-12);
        assert_close(route.points[i].east_m, expected[i][2], 1e-12);
    }
    assert_close(outlines[0].north_m[0], 5.0, 0);
    assert_close(outlines[1].north_m[0], 10.0 + 2.0 * cos(5 * turn_rad), 1e-12);
    assert_close(outlines[1].east_m[0], 5.0 + 2.0 * sin(5 * turn_rad), 1e-12);
    /* One ping is no way to go. */
    asdic_chart_data_cut(&data, 15.0, 15.0);
    assert_int_equal(data.route_count, 0);
}

/* From its first time to its last, and from before to behind them, a route is whole. */
static void routes_are_cut_beyond_their_ends(void **state) {
    (void)state;
    for (double beyond_s = 0.0; beyond_s < 6.0; beyond_s += 5.0) {
        asdic_route_point points[] = {{0, 1, 2, 0.1}, {10, 3, 4, 0.2}, {20, 5, 6, 0.3}};
        asdic_route route = {.name = "boat", .points = points, .count = 3};
        asdic_chart_data data = {.routes = &route, .route_count = 1, .points = points};
        asdic_chart_data_cut(&data, -beyond_s, 20.0 + beyond_s);
        assert_int_equal(route.count, 3);
        for (size_t i = 0; i < 3; i++) {
            double time_s = 10.0 * (double)i + ((double)i - 1.0) * beyond_s;
            assert_close(points[i].time_s, time_s, 0.0);
            assert_close(points[i].north_m, 1.0 + 2.0 * (double)i, 0.0);
            assert_close(points[i].east_m, 2.0 + 2.0 * (double)i, 0.0);
            assert_close(points[i].yaw_rad, 0.1 + 0.1 * (double)i, 1e-15);
        }
    }
}

static void write_kept(const char *folder, const char *name, const char *text) {
    char path[64];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* What a run kept: a corner a line, where a new number begins an outline; a point a line, where a new name begins a
 * route; depths from the north-western cell on. */
static void kept_charts_are_read(void **state) {
    (void)state;
    char folder[] = "/tmp/asdic-chart-XXXXXX", command[64];
    assert_non_null(mkdtemp(folder));
    write_kept(folder, "objects.csv",
               "object,outline,x_m,y_m\nrock,0,1,2\nrock,0,3,4\nbox,1,5,6\nbox,2,7,8\n"
               "box,2,9,10\nbox,2,11,12\n");
    write_kept(folder, "routes.csv",
               "object,time_s,x_m,y_m,yaw_deg\nboat,0,1,2,90\nboat,1,3,4,-90\nboa,0,5,6,0\n"
               "boat,0,7,8,180\nboat,2,9,10,180");
    write_kept(folder, "terrain.asc",
               "ncols 3\nnrows 2\nxllcorner -5\nyllcorner 7.5\ncellsize 2\n"
               "NODATA_value -9999\n1 2 3\n4 -9999 6\n");
    asdic_chart_data data;
    assert_int_equal(asdic_chart_data_read(ctx, folder, &data), ASDIC_OK);
    static const struct {
        const char *name;
        size_t count;
    } outlines[] = {{"rock", 2}, {"box", 1}, {"box", 3}},
      routes[] = {{"boat", 2}, {"boa", 1}, {"boat", 2}};
    double next = 1.0;
    assert_int_equal(data.outline_count, 3);
    for (size_t i = 0; i < 3; i++) {
        const asdic_outline *o = &data.outlines[i];
        assert_string_equal(o->name, outlines[i].name);
        assert_int_equal(o->count, outlines[i].count);
        for (size_t k = 0; k < o->count; k++) {
            assert_close(o->north_m[k], next++, 0.0);
            assert_close(o->east_m[k], next++, 0.0);
        }
    }
    static const double times_s[] = {0, 1, 0, 0, 2}, yaws_deg[] = {90, -90, 0, 180, 180};
    size_t point = 0;
    next = 1.0;
    assert_int_equal(data.route_count, 3);
    for (size_t i = 0; i < 3; i++) {
        const asdic_route *r = &data.routes[i];
        assert_string_equal(r->name, routes[i].name);
        assert_int_equal(r->count, routes[i].count);
        for (size_t k = 0; k < r->count; k++, point++) {
            assert_close(r->points[k].time_s, times_s[point], 0.0);
            assert_close(r->points[k].north_m, next++, 0.0);
            assert_close(r->points[k].east_m, next++, 0.0);
            assert_close(r->points[k].yaw_rad, yaws_deg[point] * ASDIC_PI / 180.0, 1e-12);
        }
    }
    const asdic_relief *relief = &data.relief;
    assert_true(relief->columns == 3 && relief->rows == 2 && relief->cell_m == 2.0);
    assert_true(relief->west_m == -5.0 && relief->south_m == 7.5);
    for (size_t i = 0; i < 6; i++) {
        double depth_m = (double)relief->depth_m[i];
        assert_true(i == 4 ? isnan(depth_m) : depth_m == (double)(i + 1));
    }
    asdic_chart_data_finish(&data);
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

/* Outlines have up to 24 corners, in files of any version. */
static void outlines_of_24_corners_are_read(void **state) {
    (void)state;
    char folder[] = "/tmp/asdic-chart-XXXXXX", command[64];
    assert_non_null(mkdtemp(folder));
    for (size_t corners = 24; corners <= 25; corners++) {
        char text[1024] = "object,outline,x_m,y_m\n";
        for (size_t k = 0; k < corners; k++) {
            snprintf(text + strlen(text), sizeof text - strlen(text), "rock,0,%zu,1\n", k);
        }
        write_kept(folder, "objects.csv", text);
        asdic_chart_data data;
        assert_int_equal(asdic_chart_data_read(ctx, folder, &data),
                         corners > 24 ? ASDIC_ERROR_INPUT : ASDIC_OK);
        if (corners <= 24) {
            assert_int_equal(data.outlines[0].count, corners);
            asdic_chart_data_finish(&data);
        }
    }
    snprintf(command, sizeof command, "rm -r %s", folder);
    assert_int_equal(system(command), 0);
}

/* Width, height and how many pixels are RGB of a picture, which is deleted. */
static size_t count_pixels(const char *path, uint32_t rgb, size_t *width, size_t *height) {
    png_image image = {.version = PNG_IMAGE_VERSION};
    size_t count = 0;
    assert_true(png_image_begin_read_from_file(&image, path));
    image.format = PNG_FORMAT_RGB;
    uint8_t *pixels = malloc(PNG_IMAGE_SIZE(image));
    assert_true(png_image_finish_read(&image, NULL, pixels, 0, NULL));
    *width = image.width;
    *height = image.height;
    for (size_t i = 0; i < *width * *height; i++) {
        const uint8_t *p = pixels + 3 * i;
        count += ((uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2]) == rgb;
    }
    free(pixels);
    unlink(path);
    return count;
}

static void pictures_show_them(void **state) {
    (void)state;
    char path[] = "/tmp/asdic-chart-XXXXXX.png";
    asdic_picture_options options = asdic_picture_options_default();
    size_t width, height;
    close(mkstemps(path, 4));
    options.colormap = ASDIC_COLORMAP_VIRIDIS;
    if (!asdic_picture_annotated()) {
        unlink(path);
        skip();
    }
    /* A track of 100 m north: a line of vermilion 2.5 pixels wide, of which one column or two are
     * filled whole, as long as the box says. */
    const double north_m[2] = {0, 100}, east_m[2] = {0, 0};
    asdic_chart chart = {
        .relief = &no_relief, .north_m = north_m, .east_m = east_m, .track_count = 2};
    assert_int_equal(asdic_draw_chart(ctx, path, &chart, &options), ASDIC_OK);
    size_t track = count_pixels(path, 0xd55e00, &width, &height);
    assert_true(track > 600 && track < 6000);
    assert_true(width > 400 && width < 1300 && height > 860 && height < 1200);
    /* One beam of two at the top of the window, the other empty. */
    asdic_overview o;
    const float levels_db[2] = {-60, NAN}, noise_db[2] = {NAN, NAN};
    const asdic_overview_axes axes = {0};
    assert_int_equal(asdic_overview_init(ctx, 1, 2, 1, 10.0, &o), ASDIC_OK);
    asdic_overview_add(&o, levels_db, noise_db);
    assert_int_equal(asdic_draw_overview(ctx, path, &o, &axes, &options), ASDIC_OK);
    size_t bright = count_pixels(path, 0xfde725, &width, &height);
    assert_close((double)bright, 240.0 * 240.0, 400.0); /* the scale has a few of them */
    asdic_overview_finish(&o);
}

/* Pixels of the brightest colour in an overview of PINGS and 7 beams, LIT of which have an echo, in ping 0. */
static size_t lit_pixels(size_t pings, size_t lit, size_t *height) {
    char path[] = "/tmp/asdic-chart-XXXXXX.png";
    asdic_picture_options options = asdic_picture_options_default();
    const asdic_overview_axes axes = {0};
    float levels_db[7], noise_db[7];
    asdic_overview o;
    size_t width;
    close(mkstemps(path, 4));
    options.colormap = ASDIC_COLORMAP_VIRIDIS;
    assert_int_equal(asdic_overview_init(ctx, pings, 7, 1, 10.0, &o), ASDIC_OK);
    for (size_t ping = 0; ping < pings; ping++) {
        for (size_t b = 0; b < 7; b++) {
            levels_db[b] = ping == 0 && b < lit ? -60.0f : NAN;
            noise_db[b] = NAN;
        }
        asdic_overview_add(&o, levels_db, noise_db);
    }
    assert_int_equal(asdic_draw_overview(ctx, path, &o, &axes, &options), ASDIC_OK);
    asdic_overview_finish(&o);
    return count_pixels(path, 0xfde725, &width, height);
}

/* A cell is whole pixels: 68 wide where 7 share 480, and as many high as fit into 720, from 1 to 240. */
static void cells_of_an_overview_are_whole_pixels(void **state) {
    (void)state;
    static const struct {
        size_t pings, cell_px, rows_px;
    } expected[] = {{5, 144, 720}, {11, 65, 715}, {2, 240, 480}, {1000, 1, 1000}};
    if (!asdic_picture_annotated()) {
        skip();
    }
    for (size_t i = 0; i < sizeof expected / sizeof *expected; i++) {
        size_t height, one = lit_pixels(expected[i].pings, 1, &height);
        size_t two = lit_pixels(expected[i].pings, 2, &height);
        assert_int_equal(two - one, 68 * expected[i].cell_px); /* without what the scale has */
        assert_in_range(height, expected[i].rows_px + 60, expected[i].rows_px + 250);
    }
}

/* What lies half a track's length beside it is left out, wherever north 0 is. */
static void charts_leave_out_what_is_far(void **state) {
    static const double south_m[] = {0.0, 900.0, -1000.0};
    (void)state;
    for (size_t k = 0; k < sizeof south_m / sizeof *south_m; k++) {
        const double north_m[] = {south_m[k], south_m[k] + 100.0}, east_m[] = {0.0, 0.0};
        const asdic_outline rock = {.count = 1, .north_m = {south_m[k] + 50.0}, .east_m = {50.0}};
        asdic_chart chart = {.relief = &no_relief,
                             .outlines = &rock,
                             .outline_count = 1,
                             .north_m = north_m,
                             .east_m = east_m,
                             .track_count = 2};
        const asdic_picture_options options = asdic_picture_options_default();
        asdic_chart_page beside, alone;
        asdic_chart_page_init(&beside, &chart, &options);
        chart.outline_count = 0;
        asdic_chart_page_init(&alone, &chart, &options);
        assert_close(beside.east_m, alone.east_m, 1e-9);
        assert_true(beside.east_m < 50.0);
        /* The map's frame keeps off the page's edges. */
        assert_true(alone.box.x >= ASDIC_MARGIN_PX);
        assert_true(alone.width >= alone.box.x + alone.box.w + ASDIC_MARGIN_PX);
        assert_true(alone.height >= alone.box.y + alone.box.h + ASDIC_MARGIN_PX);
    }
}

/* Every point of a track, an area, an outline and a route, to each side of the others: what is shown ends a little
 * beyond it, and elsewhere a little beyond the others. Of outlines and routes what is near. */
static void charts_hold_what_is_near(void **state) {
    (void)state;
    enum { POINTS = 3, KINDS = 4 };
    const asdic_picture_options options = asdic_picture_options_default();
    for (unsigned n = 0; n < POINTS * KINDS * 4; n++) {
        /* Track and area from corner to corner, 100 m apart; outline and route in the middle. */
        double north_m[KINDS][POINTS] = {{-50, 0, 50}, {-50, 0, 50}}, east_m[KINDS][POINTS] = {{0}};
        unsigned kind = n / POINTS % KINDS, point = n % POINTS, side = n / POINTS / KINDS;
        memcpy(east_m, north_m, sizeof east_m);
        *(side < 2 ? &north_m[kind][point] : &east_m[kind][point]) = side % 2 ? 62.0 : -62.0;
        asdic_outline outline = {.count = POINTS};
        asdic_route_point points[POINTS];
        for (size_t i = 0; i < POINTS; i++) {
            outline.north_m[i] = north_m[2][i];
            outline.east_m[i] = east_m[2][i];
            points[i] = (asdic_route_point){(double)i, north_m[3][i], east_m[3][i], 0.0};
        }
        const asdic_route route = {.name = "", .points = points, .count = POINTS};
        const asdic_chart_area area = {.north_m = north_m[1], .east_m = east_m[1], .count = POINTS};
        const asdic_chart chart = {.relief = &no_relief,
                                   .outlines = &outline,
                                   .outline_count = 1,
                                   .routes = &route,
                                   .route_count = 1,
                                   .areas = &area,
                                   .area_count = 1,
                                   .north_m = north_m[0],
                                   .east_m = east_m[0],
                                   .track_count = POINTS};
        asdic_chart_page p;
        asdic_chart_page_init(&p, &chart, &options);
        const double shown_m[4] = {-p.south_m, p.north_m, -p.west_m, p.east_m};
        for (unsigned k = 0; k < 4; k++) {
            assert_close(shown_m[k], (k == side ? 62.0 : 50.0) + 0.06 * 112.0, 1e-9);
        }
    }
}

/* White inside the ring where an object's way begins, and nowhere else along it. */
static void routes_begin_with_a_ring(void **state) {
    (void)state;
    char path[] = "/tmp/asdic-chart-XXXXXX";
    const double north_m[2] = {0, 100}, east_m[2] = {0, 0};
    asdic_route_point points[3] = {
        {0, 20, 30, 0}, {1, 50, 60, 0}, {2, 80, 20, 0}}; /* time, north, east */
    const asdic_route route = {.name = "", .points = points, .count = 3};
    const asdic_picture_options options = asdic_picture_options_default();
    asdic_chart chart = {.relief = &no_relief,
                         .routes = &route,
                         .route_count = 1,
                         .north_m = north_m,
                         .east_m = east_m,
                         .track_count = 2};
    asdic_chart_page page;
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_true(mkstemp(path) >= 0);
    if (!asdic_picture_annotated()) {
        unlink(path);
        skip();
    }
    asdic_chart_page_init(&page, &chart, &options);
    assert_int_equal(asdic_draw_chart(ctx, path, &chart, &options), ASDIC_OK);
    assert_true(png_image_begin_read_from_file(&image, path));
    image.format = PNG_FORMAT_RGB;
    uint8_t *rgb = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(rgb);
    assert_true(png_image_finish_read(&image, NULL, rgb, 0, NULL));
    unlink(path);
    for (size_t i = 0; i < 3; i++) {
        size_t x = (size_t)asdic_chart_x(&page, points[i].east_m);
        size_t y = (size_t)asdic_chart_y(&page, points[i].north_m);
        const uint8_t *at = rgb + 3 * (y * image.width + x);
        assert_int_equal(at[0] == 255 && at[1] == 255 && at[2] == 255, i == 0);
    }
    free(rgb);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(charts_hold_what_is_near),
        cmocka_unit_test(routes_begin_with_a_ring),
        cmocka_unit_test(cells_of_an_overview_are_whole_pixels),
        cmocka_unit_test(relief_is_the_bottoms_depth),
        cmocka_unit_test(relief_keeps_to_its_triangles),
        cmocka_unit_test(relief_tells_objects_apart),
        cmocka_unit_test(relief_is_lit_from_the_north_west),
        cmocka_unit_test(light_falls_on_slopes),
        cmocka_unit_test(relief_is_coloured_by_depth),
        cmocka_unit_test(outlines_are_the_objects),
        cmocka_unit_test(footprint_on_a_plane),
        cmocka_unit_test(footprint_of_a_broad_lobe),
        cmocka_unit_test(footprint_of_many_beams),
        cmocka_unit_test(footprint_all_round),
        cmocka_unit_test(footprint_in_water_that_bends),
        cmocka_unit_test(footprint_on_terrain),
        cmocka_unit_test(footprint_beside_a_hole),
        cmocka_unit_test(overview_keeps_the_strongest),
        cmocka_unit_test(overview_groups_many_beams),
        cmocka_unit_test(overview_gain_is_of_its_bins),
        cmocka_unit_test(overview_has_room_for_its_levels),
        cmocka_unit_test(overview_leaves_out_the_last_bin),
        cmocka_unit_test(names_do_not_cover_what_they_name),
        cmocka_unit_test(routes_are_the_runs),
        cmocka_unit_test(routes_are_cut_beyond_their_ends),
        cmocka_unit_test(kept_charts_are_read),
        cmocka_unit_test(outlines_of_24_corners_are_read),
        cmocka_unit_test(charts_leave_out_what_is_far),
        cmocka_unit_test(pictures_show_them),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
