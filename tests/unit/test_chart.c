/*
 * The mission from above: relief and outlines of a scene, and that the picture shows them where they say.
 */
#include "asserts.h"
#include "area.h"
#include "decoded.h"
#include "test_context.h"

#include "lib/base/vec.h"
#include "lib/out/draw_chart_page.h"
#include "lib/out/raster_relief.h"
#include "lib/scene/chart.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

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
    add_object(scene, "pair", mesh, (asdic_pose){.position_m = {5120, 6144, 0}});
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

/* The ring of a net cage from above, 9 m to 10 m wide, and a pipe that bends by a right angle: their outlines hold
 * them, not what they go round. */
static void outlines_follow_what_bends(void **state) {
    (void)state;
    enum { PARTS = 64, BENT = PARTS / 4 };
    double corners_m[2 * (PARTS + 1) * 3];
    uint32_t triangles[2 * PARTS * 3];
    for (uint32_t k = 0; k <= PARTS; k++) {
        for (uint32_t side = 0; side < 2; side++) {
            double *at = corners_m + 3 * (2 * k + side), radius_m = side ? 10.0 : 9.0;
            at[0] = radius_m * cos(2.0 * ASDIC_PI * k / PARTS);
            at[1] = radius_m * sin(2.0 * ASDIC_PI * k / PARTS);
            at[2] = 0.0;
        }
    }
    for (uint32_t k = 0; k < PARTS; k++) {
        const uint32_t two[6] = {2 * k, 2 * k + 1, 2 * k + 2, 2 * k + 2, 2 * k + 1, 2 * k + 3};
        memcpy(triangles + 6 * k, two, sizeof two);
    }
    asdic_scene *scene = slope_scene();
    const uint32_t parts[2] = {PARTS, BENT};
    const char *names[2] = {"cage", "pipe"};
    for (int i = 0; i < 2; i++) {
        asdic_mesh *mesh;
        assert_int_equal(asdic_mesh_from_triangles(ctx, corners_m, 2 * (parts[i] + 1), triangles,
                                                   2 * parts[i], &mesh),
                         ASDIC_OK);
        add_object(scene, names[i], mesh, (asdic_pose){.position_m = {50, 60.0 * i, 2}});
    }
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    asdic_outline *outlines;
    size_t count;
    double area_m2[2] = {0.0, 0.0};
    assert_int_equal(asdic_chart_outlines(ctx, scene, &outlines, &count), ASDIC_OK);
    for (size_t k = 0; k < count; k++) {
        int which = strcmp(outlines[k].name, "pipe") == 0;
        area_m2[which] += area_of(outlines[k].north_m, outlines[k].east_m, outlines[k].count);
        for (size_t j = 0; j < outlines[k].count; j++) {
            double at_m =
                hypot(outlines[k].north_m[j] - 50.0, outlines[k].east_m[j] - 60.0 * which);
            assert_in_range((int)(1000.0 * at_m), 8980, 10001);
        }
    }
    /* A ring of 59.6 m2 in a disc of 314, a quarter of it in a hull of 38. */
    assert_close(area_m2[0], 66.0, 9.0);
    assert_close(area_m2[1], 17.0, 3.0);
    free(outlines);
    asdic_scene_destroy(&scene);
}

/* A triangle of 60 m with an arm of 40 m at either end: cut through its middle, parts of it hold none of its sides, and
 * parts of the square round it nothing. The rings hold the triangle and lie within the mesh. */
static void outlines_hold_large_triangles(void **state) {
    (void)state;
    const double corners_m[] = {0, 0,  0, 60, 0, 0,   0, 60, 0,   100, 0, 0,  100, 1,
                                0, 60, 1, 0,  0, 100, 0, 1,  100, 0,   1, 60, 0};
    const uint32_t triangles[] = {0, 1, 2, 1, 3, 4, 1, 4, 5, 2, 6, 7, 2, 7, 8};
    asdic_scene *scene = slope_scene();
    asdic_mesh *mesh;
    asdic_outline *outlines;
    size_t count;
    double area_m2 = 0.0;
    assert_int_equal(asdic_mesh_from_triangles(ctx, corners_m, 9, triangles, 5, &mesh), ASDIC_OK);
    add_object(scene, "sail", mesh, (asdic_pose){0});
    assert_int_equal(asdic_scene_commit(scene), ASDIC_OK);
    assert_int_equal(asdic_chart_outlines(ctx, scene, &outlines, &count), ASDIC_OK);
    for (size_t k = 0; k < count; k++) {
        assert_true(outlines[k].count >= 3);
        for (size_t j = 0; j < outlines[k].count; j++) {
            double north_m = outlines[k].north_m[j], east_m = outlines[k].east_m[j];
            assert_true(fmin(north_m, east_m) > -0.001 && fmax(north_m, east_m) < 100.001);
            assert_true(north_m + east_m <= 60.001 || fmin(north_m, east_m) <= 1.001);
        }
        area_m2 += area_of(outlines[k].north_m, outlines[k].east_m, outlines[k].count);
    }
    assert_close(area_m2, 0.5 * 60.0 * 60.0 + 2.0 * 40.0, 100.0);
    free(outlines);
    asdic_scene_destroy(&scene);
}

static const asdic_relief no_relief;

/* Four piles 10 m apart or more, without names and with them: whatever was dark stays dark, so that no name
 * lies on a pile, nor on the outline of a large one. */
static void check_names(double half_m) {
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
    uint8_t *rgb[2];
    size_t width, height, covered = 0, dark = 0;
    for (int named = 0; named < 2; named++) {
        for (size_t i = 0; i < 4; i++) {
            piles[i].count = 4;
            for (size_t k = 0; k < 4; k++) {
                piles[i].north_m[k] =
                    32.0 - 10.0 * (double)(i / 2) + (k < 2 ? 1.0 : -1.0) * fmin(half_m, 2.0);
                piles[i].east_m[k] = 12.0 + 20.0 * (double)(i % 2) + (k % 3 ? half_m : -half_m);
            }
            if (named) {
                snprintf(piles[i].name, sizeof piles[i].name, "pile_%zu", i);
            }
        }
        assert_int_equal(asdic_draw_chart(ctx, path, &chart, &options), ASDIC_OK);
        rgb[named] = decode(path, PNG_FORMAT_RGB, &width, &height);
    }
    for (size_t i = 0; i < 3 * width * height; i += 3) { /* the red of each */
        covered += rgb[0][i] < 0x60 && rgb[1][i] > 0x90;
        dark += rgb[1][i] < 0x60 && rgb[0][i] > 0x90;
    }
    assert_int_equal(covered, 0);
    assert_true(dark > 200); /* four names */
    free(rgb[0]);
    free(rgb[1]);
}

static void names_do_not_cover_what_they_name(void **state) {
    (void)state;
    if (!asdic_picture_annotated()) {
        skip();
    }
    check_names(0.2);
    for (double half_m = 3.0; half_m < 5.0; half_m += 0.25) {
        check_names(half_m);
    }
}

static void a_track_is_as_long_as_its_box(void **state) {
    (void)state;
    char path[] = "/tmp/asdic-chart-XXXXXX.png";
    const asdic_picture_options options = asdic_picture_options_default();
    size_t width, height;
    close(mkstemps(path, 4));
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
    size_t width, height;
    assert_true(mkstemp(path) >= 0);
    if (!asdic_picture_annotated()) {
        unlink(path);
        skip();
    }
    asdic_chart_page_init(&page, &chart, &options);
    assert_int_equal(asdic_draw_chart(ctx, path, &chart, &options), ASDIC_OK);
    uint8_t *rgb = decode(path, PNG_FORMAT_RGB, &width, &height);
    for (size_t i = 0; i < 3; i++) {
        size_t x = (size_t)asdic_chart_x(&page, points[i].east_m);
        size_t y = (size_t)asdic_chart_y(&page, points[i].north_m);
        const uint8_t *at = rgb + 3 * (y * width + x);
        assert_int_equal(at[0] == 255 && at[1] == 255 && at[2] == 255, i == 0);
    }
    /* Dashes of 8 pixels and gaps of 6, to the way's end. */
    double from[2] = {asdic_chart_x(&page, points[1].east_m),
                      asdic_chart_y(&page, points[1].north_m)};
    double along[2] = {asdic_chart_x(&page, points[2].east_m) - from[0],
                       asdic_chart_y(&page, points[2].north_m) - from[1]};
    double length = hypot(along[0], along[1]), begin[64];
    size_t begins = 0;
    for (double step = 0, was = 0, is; step < length; step++, was = is) {
        size_t x = (size_t)(from[0] + along[0] * step / length);
        size_t y = (size_t)(from[1] + along[1] * step / length);
        is = rgb[3 * (y * width + x) + 1] < 200;
        if (is > was) {
            begin[begins++ % 64] = step;
        }
    }
    assert_in_range(begins, 8, 64);
    assert_close((begin[begins - 1] - begin[begins - 8]) / 7.0, 14.0, 0.5);
    free(rgb);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(charts_hold_what_is_near),
        cmocka_unit_test(routes_begin_with_a_ring),
        cmocka_unit_test(relief_is_the_bottoms_depth),
        cmocka_unit_test(relief_keeps_to_its_triangles),
        cmocka_unit_test(relief_tells_objects_apart),
        cmocka_unit_test(relief_is_lit_from_the_north_west),
        cmocka_unit_test(light_falls_on_slopes),
        cmocka_unit_test(relief_is_coloured_by_depth),
        cmocka_unit_test(outlines_are_the_objects),
        cmocka_unit_test(outlines_follow_what_bends),
        cmocka_unit_test(outlines_hold_large_triangles),
        cmocka_unit_test(names_do_not_cover_what_they_name),
        cmocka_unit_test(charts_leave_out_what_is_far),
        cmocka_unit_test(a_track_is_as_long_as_its_box),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
