/*
 * Maps as pictures: what of their cells comes to the page that draws them, in whose place this stands.
 */
#include "asserts.h"
#include "test_context.h"

#include "mission/detect/detect_job.h"
#include "mission/run/run_open.h"
#include "out/draw.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

static struct {
    size_t rows, columns, width, height;
    double cell_m;
    uint8_t rgb[1000 * 1000 * 3];
    char note[ASDIC_NOTE_SIZE], title[256];
    double db_low, db_high;
    size_t line_count;
    asdic_series first_line;
} page;

asdic_status __wrap_asdic_draw_map(asdic_context *c, const char *path, const asdic_map *map,
                                   const asdic_raster *raster,
                                   const asdic_picture_options *options);

asdic_status __wrap_asdic_draw_map(asdic_context *c, const char *path, const asdic_map *map,
                                   const asdic_raster *raster,
                                   const asdic_picture_options *options) {
    (void)c;
    (void)path;
    page.rows = map->rows;
    page.columns = map->columns;
    page.cell_m = map->cell_m;
    page.width = raster->width;
    page.height = raster->height;
    snprintf(page.note, sizeof page.note, "%s", options->note ? options->note : "");
    snprintf(page.title, sizeof page.title, "%s", options->title ? options->title : "");
    page.db_low = options->db_low;
    page.db_high = options->db_high;
    page.line_count = map->line_count;
    page.first_line = map->line_count ? map->lines[0] : (asdic_series){0};
    assert_true(raster->width <= 1000 && raster->height <= 1000);
    memcpy(page.rgb, raster->rgb, 3 * raster->width * raster->height);
    return ASDIC_OK;
}

static uint32_t pixel(size_t x, size_t y) {
    const uint8_t *p = page.rgb + 3 * (y * page.width + x);
    return (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
}

/* Grey is its own index: floor(256 v / 50). */
static asdic_picture_options to_fifty(void) {
    asdic_picture_options options = asdic_picture_options_default();
    options.colormap = ASDIC_COLORMAP_GRAY;
    options.db_low = 0.0;
    options.db_high = 50.0;
    return options;
}

/* Six cells of 333 pixels a side; the first row is the most southern. */
static void maps_are_north_up(void **state) {
    (void)state;
    const float values[2][3] = {{NAN, 10, 20}, {30, 40, 5}};
    const uint32_t grey[2][3] = {{153, 204, 25}, {255, 51, 102}};
    asdic_map map = {.values = values[0], .rows = 2, .columns = 3, .cell_m = 0.5};
    asdic_picture_options options = to_fifty();
    assert_int_equal(asdic_picture_map(ctx, "m", &map, &options), ASDIC_OK);
    assert_true(page.rows == 2 && page.columns == 3 && page.cell_m == 0.5);
    assert_true(page.width == 999 && page.height == 666);
    assert_string_equal(page.note, "");
    for (size_t y = 0; y < 666; y++) {
        for (size_t x = 0; x < 999; x++) {
            assert_int_equal(pixel(x, y), grey[y / 333][x / 333] * 0x10101u);
        }
    }
}

/* Two cells wide, along east and along north: of every two, one is unknown, and some wholly. */
static void large_maps_show_the_greatest(void **state) {
    (void)state;
    static const struct {
        size_t length, group, pixels;
    } cases[] = {{1000, 1, 1000}, {1001, 2, 501}, {2001, 3, 667}};
    for (size_t i = 0; i < 6; i++) {
        static float values[2 * 2001];
        size_t length = cases[i / 2].length, group = cases[i / 2].group;
        size_t pixels = cases[i / 2].pixels, wide = group > 1 ? 1 : 2;
        bool north = i % 2;
        for (size_t k = 0; k < 2 * length; k++) {
            size_t along = north ? k / 2 : k % length, across = north ? k % 2 : k / length;
            bool is_known = (along + across) % 2 == 0 && (along < 300 || along > 305);
            values[k] = is_known ? (float)(along * 7 % 11 * 4) : NAN;
        }
        asdic_map map = {.values = values,
                         .rows = north ? length : 2,
                         .columns = north ? 2 : length,
                         .cell_m = 0.5};
        asdic_picture_options options = to_fifty();
        options.note = "a note";
        assert_int_equal(asdic_picture_map(ctx, "m", &map, &options), ASDIC_OK);
        assert_true(page.cell_m == 0.5 * (double)group);
        assert_int_equal(page.rows, north ? pixels : wide);
        assert_int_equal(page.columns, north ? wide : pixels);
        assert_true(page.width == page.columns && page.height == page.rows);
        char note[100] = "a note";
        if (group > 1) {
            snprintf(note, sizeof note,
                     "a note  \u00b7  each pixel is the greatest of %zu \u00d7 %zu cells", group,
                     group);
        }
        assert_string_equal(page.note, note);
        for (size_t p = 0; p < pixels; p++) {
            double most = -1.0;
            for (size_t k = p * group; k < (p + 1) * group && k < length; k++) {
                bool is_known = (group > 1 || k % 2 == 0) && (k < 300 || k > 305);
                most = is_known ? fmax(most, (double)(k * 7 % 11 * 4)) : most;
            }
            uint32_t right = most < 0.0 ? 0xffffff : (uint32_t)(256.0 * most / 50.0) * 0x10101u;
            size_t x = north ? 0 : p, y = north ? pixels - 1 - p : page.height - 1;
            assert_int_equal(pixel(x, y), right);
        }
    }
}

static void maps_of_nothing_are_refused(void **state) {
    (void)state;
    const float value = 1.0f;
    const asdic_map good = {.values = &value, .rows = 1, .columns = 1, .cell_m = 1};
    const asdic_series none = {.count = 2, .width = 1.0};
    asdic_map wrong[8] = {good, good, good, good, good, good, good, good};
    asdic_picture_options options = to_fifty();
    asdic_picture_options bad[4] = {options, options, options, options};
    wrong[0].rows = wrong[1].columns = 0;
    wrong[2].cell_m = 0.0;
    wrong[3].cell_m = INFINITY;
    wrong[4].values = NULL;
    wrong[5].north_m = NAN;
    wrong[6].east_m = INFINITY;
    wrong[7].lines = &none;
    wrong[7].line_count = 1;
    bad[0].db_high = 0.0;
    bad[1].db_low = -INFINITY;
    bad[2].colormap = ASDIC_COLORMAP_COUNT;
    bad[3].format = (asdic_picture_format)99;
    for (size_t i = 0; i < 8; i++) {
        assert_int_equal(asdic_picture_map(ctx, "m", &wrong[i], &options), ASDIC_ERROR_ARGUMENT);
    }
    for (size_t i = 0; i < 4; i++) {
        assert_int_equal(asdic_picture_map(ctx, "m", &good, &bad[i]), ASDIC_ERROR_ARGUMENT);
    }
    assert_int_equal(asdic_picture_map(ctx, NULL, &good, &options), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_picture_map(ctx, "m", NULL, &options), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_picture_map(ctx, "m", &good, NULL), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_picture_map(ctx, "m", &good, &options), ASDIC_OK);
}

/* The occupancy map of asdic detect has the vehicle's way so far over it, and that alone. */
static void an_occupancy_map_has_the_way(void **state) {
    (void)state;
    double north_m[] = {1.0, 2.0, 9.0}, east_m[] = {5.0, 7.0, 9.0};
    const asdic_vec3 low = {0.0, 0.0, 0.0}, high = {10.0, 20.0, 0.0};
    asdic_sonar sonar = asdic_sonar_default();
    char folder[] = "f";
    asdic_run run = {.folder = folder, .facts = {.bin_length_m = 0.5}};
    asdic_detect_job job = {.ctx = ctx,
                            .run = &run,
                            .info = {.sonar = &sonar, .scene_name = "lake", .scene_hash = "0"},
                            .detector = {.prior = 0.02, .snr_db = 12.0},
                            .track_north_m = north_m,
                            .track_east_m = east_m};
    assert_ok(ctx, asdic_occupancy_create(ctx, low, high, 1.0, 0.02, 10.0, &job.map));
    for (job.pings_done = 1; job.pings_done < 3; job.pings_done++) {
        char title[64];
        snprintf(title, sizeof title, "lake: occupancy after %s\n",
                 job.pings_done == 1 ? "1 ping" : "2 pings");
        assert_ok(ctx, asdic_detect_draw_map(&job));
        assert_int_equal(page.line_count, 1);
        assert_int_equal(page.first_line.count, job.pings_done);
        assert_ptr_equal(page.first_line.x, east_m);
        assert_ptr_equal(page.first_line.y, north_m);
        assert_true(page.rows == 10 && page.columns == 20 && page.cell_m == 1.0);
        assert_true(page.db_low < 0.0 && page.db_low == -page.db_high);
        assert_contains(page.title, title);
        assert_contains(page.note, "cells of 1 m");
        assert_contains(page.note, "prior 0.02, targets from 12 dB above");
    }
    asdic_occupancy_destroy(&job.map);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_are_north_up),
        cmocka_unit_test(large_maps_show_the_greatest),
        cmocka_unit_test(maps_of_nothing_are_refused),
        cmocka_unit_test(an_occupancy_map_has_the_way),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
