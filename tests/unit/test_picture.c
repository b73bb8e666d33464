/*
 * Pictures: the raster byte for byte, text chunks, and that the annotated ones show the data where
 * they say.
 */
#include "asserts.h"
#include "decoded.h"

#include "out/draw.h"
#include "out/overview.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

static asdic_context *ctx;
static char folder[] = "/tmp/asdic-picture-XXXXXX";

static const char *file_in_folder(const char *name) {
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static int set_up(void **state) {
    (void)state;
    return asdic_context_create(&ctx) != ASDIC_OK || !mkdtemp(folder);
}

static int tear_down(void **state) {
    (void)state;
    asdic_context_destroy(&ctx);
    return rmdir(folder); /* fails when a test or the library left something behind */
}

/* 8 x 2 levels: a ramp through and beyond the window, and two that are no energy. */
static const float ramp_db[16] = {-110.0f, -100.0f, -99.9f,    -50.0f, -0.1f,  0.0f,
                                  10.0f,   NAN,     -INFINITY, -75.0f, -25.0f, -60.0f,
                                  -40.0f,  -90.0f,  -10.0f,    -50.0f};
static const asdic_waterfall ramp = {
    .levels_db = ramp_db, .pings = 2, .bins = 8, .bin_length_m = 0.5};

/* As the guide has it. */
static void window_is_minus_160_to_60(void **state) {
    (void)state;
    asdic_picture_options options = asdic_picture_options_default();
    assert_true(options.db_low == -160.0 && options.db_high == -60.0);
}

static void raster_byte_for_byte(void **state) {
    (void)state;
    /* gray is its own index: floor(256 (L + 100) / 100), ends saturated, white without energy. */
    const uint8_t grey[16] = {0,   0,  0,   128, 255, 255, 255, 255,
                              255, 64, 192, 102, 153, 25,  230, 128};
    asdic_picture_options options = asdic_picture_options_default();
    options.db_low = -100.0;
    options.db_high = 0.0;
    options.colormap = ASDIC_COLORMAP_GRAY;
    size_t width, height;
    assert_int_equal(asdic_picture_raster(ctx, file_in_folder("r.png"), &ramp, &options), ASDIC_OK);
    uint8_t *rgb = decode(file_in_folder("r.png"), PNG_FORMAT_RGB, &width, &height);
    assert_int_equal(width, 8);
    assert_int_equal(height, 2);
    for (size_t i = 0; i < 16; i++) {
        assert_int_equal(pixel(rgb, 8, i % 8, i / 8), grey[i] * 0x010101u);
    }
    free(rgb);
}

static void raw_is_linear_in_the_window(void **state) {
    (void)state;
    asdic_picture_options options = asdic_picture_options_default();
    options.db_low = -100.0;
    options.db_high = 0.0;
    assert_int_equal(asdic_picture_raw(ctx, file_in_folder("g.png"), &ramp, &options), ASDIC_OK);
    FILE *file = fopen(file_in_folder("g.png"), "rb");
    assert_non_null(file);
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
    assert_int_equal(png_get_bit_depth(png, info), 16);
    assert_int_equal(png_get_color_type(png, info), PNG_COLOR_TYPE_GRAY);
    png_bytepp rows = png_get_rows(png, info);
    for (size_t i = 0; i < 16; i++) {
        unsigned grey = (unsigned)rows[i / 8][2 * (i % 8)] << 8 | rows[i / 8][2 * (i % 8) + 1];
        double share = fmin(fmax(ramp_db[i] / 100.0 + 1.0, 0.0), 1.0);
        assert_close(grey, isfinite(ramp_db[i]) ? 1.0 + 65534.0 * share : 0.0, 0.51);
    }
    png_destroy_read_struct(&png, &info, NULL);
    fclose(file);
    unlink(file_in_folder("g.png"));
}

/* Twenty-eight hours at 10 Hz: more rows than libpng allows unless asked. */
static void raw_shows_a_million_pings(void **state) {
    (void)state;
    enum { PINGS = 1000001 };
    float *levels_db = calloc(PINGS, sizeof *levels_db);
    assert_non_null(levels_db);
    const asdic_waterfall many = {
        .levels_db = levels_db, .pings = PINGS, .bins = 1, .bin_length_m = 1.0};
    asdic_picture_options options = asdic_picture_options_default();
    assert_int_equal(asdic_picture_raw(ctx, file_in_folder("m.png"), &many, &options), ASDIC_OK);
    free(levels_db);
    uint8_t head[24];
    FILE *file = fopen(file_in_folder("m.png"), "rb");
    assert_non_null(file);
    assert_int_equal(fread(head, 1, sizeof head, file), sizeof head);
    assert_int_equal(head[20] << 24 | head[21] << 16 | head[22] << 8 | head[23], PINGS);
    fclose(file);
    unlink(file_in_folder("m.png"));
}

static void colormaps_have_their_published_ends(void **state) {
    (void)state;
    /* viridis, inferno: CC0 tables; cividis: Nunez et al. 2018; gray, copper: linear ramps. */
    const uint32_t ends[ASDIC_COLORMAP_COUNT][2] = {{0x440154, 0xfde725},
                                                    {0x00224e, 0xfee838},
                                                    {0x000004, 0xfcffa4},
                                                    {0x000000, 0xffffff},
                                                    {0x000000, 0xffc77f}};
    const float levels_db[2] = {-1000.0f, 1000.0f};
    const asdic_waterfall two = {.levels_db = levels_db, .pings = 1, .bins = 2, .bin_length_m = 1};
    asdic_picture_options options = asdic_picture_options_default();
    for (int map = 0; map < ASDIC_COLORMAP_COUNT; map++) {
        asdic_colormap found;
        size_t width, height;
        assert_true(asdic_colormap_find(asdic_colormap_name((asdic_colormap)map), &found));
        assert_int_equal(found, map);
        options.colormap = found;
        asdic_picture_raster(ctx, file_in_folder("m.png"), &two, &options);
        uint8_t *rgb = decode(file_in_folder("m.png"), PNG_FORMAT_RGB, &width, &height);
        assert_int_equal(pixel(rgb, 2, 0, 0), ends[map][0]);
        assert_int_equal(pixel(rgb, 2, 1, 0), ends[map][1]);
        free(rgb);
    }
    assert_false(asdic_colormap_find("jet", &(asdic_colormap){0}));
}

static void gain_is_for_display_only(void **state) {
    (void)state;
    /* 20 log r + 2 r at the centre of a bin of 20 m: r = 10 m: 20 + 20 dB: -90 is shown as -50. */
    const float level_db = -90.0f;
    const asdic_waterfall one = {
        .levels_db = &level_db, .pings = 1, .bins = 1, .bin_length_m = 20.0};
    asdic_picture_options options = asdic_picture_options_default();
    options.db_low = -100.0;
    options.db_high = 0.0;
    options.colormap = ASDIC_COLORMAP_GRAY;
    options.tvg_db_per_decade = 20.0;
    options.tvg_db_per_m = 2.0;
    size_t width, height;
    asdic_picture_raster(ctx, file_in_folder("t.png"), &one, &options);
    uint8_t *rgb = decode(file_in_folder("t.png"), PNG_FORMAT_RGB, &width, &height);
    assert_int_equal(rgb[0], 128);
    free(rgb);
}

static void text_chunks_are_there(void **state) {
    (void)state;
    const char *const texts[] = {"Software", "asdic", "Scene", "Gr\u00fc\u00dfe, 1 \u00b5Pa",
                                 "Key",      NULL,    NULL};
    asdic_picture_options options = asdic_picture_options_default();
    options.texts = texts;
    assert_int_equal(asdic_picture_waterfall(ctx, file_in_folder("w.png"), &ramp, &options),
                     ASDIC_OK);
    FILE *file = fopen(file_in_folder("w.png"), "rb");
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
    png_textp found;
    int count;
    assert_int_equal(png_get_text(png, info, &found, &count), 2);
    for (int i = 0; i < 2; i++) {
        assert_string_equal(found[i].key, texts[2 * i]);
        assert_string_equal(found[i].text, texts[2 * i + 1]);
    }
    png_destroy_read_struct(&png, &info, NULL);
    fclose(file);
    unlink(file_in_folder("w.png"));
}

static size_t count_color(const uint8_t *rgb, size_t pixels, uint32_t color) {
    size_t count = 0;
    for (size_t i = 0; i < pixels; i++) {
        count += pixel(rgb, pixels, i, 0) == color;
    }
    return count;
}

/* One saturated level among low ones covers its share of the plot: 1 / (pings * bins). */
static void waterfall_shows_every_level(void **state) {
    (void)state;
    const struct {
        size_t pings, bins, expected;
    } cases[] = {{1, 1, 1}, {1, 150, 150}, {3, 5, 15}, {100, 50, 5000}};
    asdic_picture_options options = asdic_picture_options_default();
    options.title = "a title";
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        size_t levels = cases[k].pings * cases[k].bins, width, height;
        float *levels_db = malloc(levels * sizeof *levels_db);
        for (size_t i = 0; i < levels; i++) {
            levels_db[i] = -200.0f;
        }
        levels_db[levels / 2] = 0.0f;
        asdic_waterfall picture = {.levels_db = levels_db,
                                   .pings = cases[k].pings,
                                   .bins = cases[k].bins,
                                   .bin_length_m = 0.5,
                                   .ping_period_s = 0.1};
        assert_int_equal(asdic_picture_waterfall(ctx, file_in_folder("s.png"), &picture, &options),
                         ASDIC_OK);
        uint8_t *rgb = decode(file_in_folder("s.png"), PNG_FORMAT_RGB, &width, &height);
        size_t high = count_color(rgb, width * height, 0xfde725);
        size_t low = count_color(rgb, width * height, 0x440154);
        double share = (double)high / (double)(high + low);
        /* The colour bar holds a few of either. */
        assert_close(share, 1.0 / (double)levels, 2e-3);
        assert_true(width <= 1500 && height <= 1300);
        free(rgb);
        free(levels_db);
    }
}

/* The frame lies round the levels, not on them: each of 1,200 bins keeps its column of pixels. */
static void a_waterfalls_frame_hides_no_level(void **state) {
    (void)state;
    static float levels_db[1200]; /* all at the top of the window */
    const asdic_waterfall full = {
        .levels_db = levels_db, .pings = 1, .bins = 1200, .bin_length_m = 0.5};
    asdic_picture_options options = asdic_picture_options_default();
    size_t width, height, rows = 0;
    if (!asdic_picture_annotated()) {
        skip();
    }
    assert_ok(ctx, asdic_picture_waterfall(ctx, file_in_folder("e.png"), &full, &options));
    uint8_t *rgb = decode(file_in_folder("e.png"), PNG_FORMAT_RGB, &width, &height);
    for (size_t y = 0; y < height; y++) {
        size_t x = 0, row = 0;
        while (x < width && pixel(rgb, width, x, y) != 0xfde725) {
            x++;
        }
        while (x + row < width && pixel(rgb, width, x + row, y) == 0xfde725) {
            row++;
        }
        if (row >= 1000) {
            assert_int_equal(row, 1200);
            assert_int_equal(pixel(rgb, width, x - 1, y), 0x202020);
            assert_int_equal(pixel(rgb, width, x + row, y), 0x202020);
            rows++;
        }
    }
    assert_int_equal(rows, 160);
    free(rgb);
}

static void waterfall_averages_energy(void **state) {
    (void)state;
    /* 4000 bins are averaged by four: 0 dB beside three empty ones is 10 log 1/4 = -6.02 dB. */
    float levels_db[4000];
    for (size_t i = 0; i < 4000; i++) {
        levels_db[i] = i % 4 == 0 ? 0.0f : -INFINITY;
    }
    asdic_waterfall picture = {
        .levels_db = levels_db, .pings = 1, .bins = 4000, .bin_length_m = 0.1};
    asdic_picture_options options = asdic_picture_options_default();
    options.colormap = ASDIC_COLORMAP_GRAY;
    options.db_low = -6.1;
    options.db_high = -5.9; /* -6.0206: index floor(256 * 0.397) = 101 */
    size_t width, height;
    assert_int_equal(asdic_picture_waterfall(ctx, file_in_folder("a.png"), &picture, &options),
                     ASDIC_OK);
    uint8_t *rgb = decode(file_in_folder("a.png"), PNG_FORMAT_RGB, &width, &height);
    size_t shown = count_color(rgb, width * height, 101 * 0x010101u);
    assert_true(shown >= 1000 * (asdic_picture_annotated() ? 100 : 1));
    free(rgb);
}

static void fan_starboard_is_right(void **state) {
    (void)state;
    /* Three beams, the starboard one hot. */
    const float levels_db[3] = {-200.0f, -200.0f, 0.0f};
    const double bearing_rad[3] = {-0.5, 0.0, 0.5};
    const asdic_fan fan = {.levels_db = levels_db,
                           .bearing_rad = bearing_rad,
                           .beams = 3,
                           .bins = 1,
                           .bin_length_m = 9};
    asdic_picture_options options = asdic_picture_options_default();
    size_t width, height, left = 0, right = 0;
    assert_int_equal(asdic_picture_fan(ctx, file_in_folder("f.png"), &fan, &options), ASDIC_OK);
    uint8_t *rgb = decode(file_in_folder("f.png"), PNG_FORMAT_RGB, &width, &height);
    for (size_t i = 0; i < width * height; i++) {
        if (pixel(rgb, width * height, i, 0) == 0xfde725) {
            left += i % width < width / 3;
            right += i % width > width / 3;
        }
    }
    assert_int_equal(left, 0);
    assert_true(right > 10000);
    free(rgb);
    const double to_and_fro[3] = {0.5, -0.5, 0.0};
    asdic_fan wrong = fan;
    wrong.bearing_rad = to_and_fro;
    assert_int_equal(asdic_picture_fan(ctx, file_in_folder("f.png"), &wrong, &options),
                     ASDIC_ERROR_ARGUMENT);
}

/* A fan whose beams are listed from starboard to port is the same picture, texts included. Its sectors are of
 * uneven beams, of one that ends on an axis, and all round. */
static void fans_are_the_same_listed_either_way(void **state) {
    (void)state;
    enum { BEAMS = 9, BINS = 40 };
    static const double low_rad[] = {-0.7, 0.0, 0.3, -3.0}, step_rad[] = {0.1, 0.15, 0.4, 0.75};
    asdic_picture_options options = asdic_picture_options_default();
    options.db_low = 0.0;
    options.db_high = 100.0;
    for (size_t k = 0; k < sizeof low_rad / sizeof *low_rad; k++) {
        float levels_db[2][BEAMS * BINS];
        double bearing_rad[2][BEAMS];
        uint8_t *rgb[2];
        size_t width[2], height[2];
        for (size_t b = 0; b < BEAMS; b++) {
            double at_rad = low_rad[k] + step_rad[k] * (double)b * (1.0 + 0.01 * (double)b);
            bearing_rad[0][b] = bearing_rad[1][BEAMS - 1 - b] = at_rad;
            for (size_t i = 0; i < BINS; i++) {
                float level_db = (float)((37 * b + 11 * i) % 100);
                levels_db[0][b * BINS + i] = level_db;
                levels_db[1][(BEAMS - 1 - b) * BINS + i] = level_db;
            }
        }
        for (size_t way = 0; way < 2; way++) {
            const asdic_fan fan = {.levels_db = levels_db[way],
                                   .bearing_rad = bearing_rad[way],
                                   .beams = BEAMS,
                                   .bins = BINS,
                                   .bin_length_m = 1.0};
            assert_int_equal(asdic_picture_fan(ctx, file_in_folder("w.png"), &fan, &options),
                             ASDIC_OK);
            rgb[way] = decode(file_in_folder("w.png"), PNG_FORMAT_RGB, &width[way], &height[way]);
        }
        assert_int_equal(width[0], width[1]);
        assert_int_equal(height[0], height[1]);
        assert_memory_equal(rgb[0], rgb[1], 3 * width[0] * height[0]);
        free(rgb[0]);
        free(rgb[1]);
    }
}

static void ascope_draws_its_curves(void **state) {
    (void)state;
    float levels_db[50];
    for (size_t i = 0; i < 50; i++) {
        levels_db[i] = i == 25 ? NAN : -100.0f - (float)i;
    }
    asdic_ascope scope = {.title = "beam",
                          .bins = 50,
                          .bin_length_m = 0.5,
                          .total_db = levels_db,
                          .bottom_db = levels_db,
                          .volume_db = levels_db,
                          .multipath_db = levels_db};
    asdic_picture_options options = asdic_picture_options_default();
    asdic_status status = asdic_picture_ascope(ctx, file_in_folder("p.png"), &scope, 1, &options);
    if (!asdic_picture_annotated()) {
        assert_int_equal(status, ASDIC_ERROR_UNSUPPORTED);
        return;
    }
    assert_int_equal(status, ASDIC_OK);
    size_t width, height;
    uint8_t *rgb = decode(file_in_folder("p.png"), PNG_FORMAT_RGB, &width, &height);
    assert_true(count_color(rgb, width * height, 0xb4b4b4) > 500); /* the total, bold */
    assert_true(count_color(rgb, width * height, 0xcc79a7) > 20);  /* multipath */
    free(rgb);
    const char *const vector_files[] = {"p.pdf", "p.svg"};
    for (int i = 0; i < 2; i++) {
        struct stat st;
        const char *path = file_in_folder(vector_files[i]);
        assert_int_equal(asdic_picture_ascope(ctx, path, &scope, 1, &options), ASDIC_OK);
        assert_int_equal(stat(path, &st), 0);
        assert_true(st.st_size > 2000);
        unlink(path);
    }
}

/* The simulated levels are 3 dB above the expected ones: a panel of its own shows it, half-way up
 * its axis of 5 dB either way. An object in one bin alone rises from the floor of its panel. */
/* Wherever on a curve it is, the first place and the last included. */
static void a_lone_point_is_a_dot(void **state) {
    (void)state;
    enum { POINTS = 4 };
    const double x[POINTS] = {0.5, 1.0, 1.5, 2.0};
    asdic_picture_options options = asdic_picture_options_default();
    if (!asdic_picture_annotated()) {
        skip();
    }
    for (size_t at = 0; at < POINTS; at++) {
        double y[POINTS] = {NAN, NAN, NAN, NAN};
        size_t width, height;
        y[at] = 5.0;
        const asdic_series curve = {.x = x, .y = y, .count = POINTS, .rgb = 0x0072b2, .width = 1.5};
        const asdic_plot panel = {.x = {.label = "x", .low = 0, .high = 3},
                                  .y = {.label = "y", .low = 0, .high = 10},
                                  .series = &curve,
                                  .series_count = 1};
        assert_int_equal(asdic_picture_plot(ctx, file_in_folder("p.png"), &panel, 1, &options),
                         ASDIC_OK);
        uint8_t *rgb = decode(file_in_folder("p.png"), PNG_FORMAT_RGB, &width, &height);
        assert_true(count_color(rgb, width * height, 0x0072b2) > 0);
        free(rgb);
    }
}

static void ascope_shows_residuals_and_lone_echoes(void **state) {
    (void)state;
    float expected_db[50], simulated_db[50], object_db[50];
    for (size_t i = 0; i < 50; i++) {
        expected_db[i] = -100.0f;
        simulated_db[i] = -97.0f;
        object_db[i] = i == 25 ? -80.0f : NAN;
    }
    asdic_ascope scope = {.title = "beam",
                          .bins = 50,
                          .total_db = expected_db,
                          .simulated_db = simulated_db,
                          .object_db = object_db};
    asdic_picture_options options = asdic_picture_options_default();
    if (!asdic_picture_annotated()) {
        skip();
    }
    for (int k = 0; k < 2; k++) {
        size_t width, height, residual = 0, tall = 0;
        scope.bin_length_m = k == 0 ? 0.5 : 2.0;
        assert_int_equal(asdic_picture_ascope(ctx, file_in_folder("p.png"), &scope, 1, &options),
                         ASDIC_OK);
        uint8_t *rgb = decode(file_in_folder("p.png"), PNG_FORMAT_RGB, &width, &height);
        for (size_t y = 0; y < height; y++) {
            size_t blue = 0;
            for (size_t x = 0; x < width; x++) {
                uint32_t p = pixel(rgb, width, x, y);
                blue += (p & 0xff) > (p >> 16) + 0x60; /* 0x0072b2, smoothed */
                tall += x > width / 2 - 40 && x < width / 2 + 60 && (p >> 16) > (p & 0xff) + 0xa0;
            }
            residual = blue > 900 ? residual + 1 : residual;
        }
        free(rgb);
        assert_true(residual >= 1 && residual <= 3); /* one level line, nearly as long as the box */
        assert_true(tall > 200);                     /* from -160 to -80 dB and back */
    }
    size_t width, height;
    scope.bins = 1; /* as wide as the box */
    scope.bin_length_m = 50.0;
    assert_int_equal(asdic_picture_ascope(ctx, file_in_folder("p.png"), &scope, 1, &options),
                     ASDIC_OK);
    uint8_t *rgb = decode(file_in_folder("p.png"), PNG_FORMAT_RGB, &width, &height);
    assert_true(count_color(rgb, width * height, 0xb4b4b4) > 900); /* the total, bold */
    free(rgb);
}

/* A second line of the title makes the page taller by its own height, and is drawn in grey. */
static void subtitles_have_a_line(void **state) {
    (void)state;
    asdic_picture_options options = asdic_picture_options_default();
    size_t width, height[2], grey[2];
    if (!asdic_picture_annotated()) {
        skip();
    }
    for (int i = 0; i < 2; i++) {
        options.title = i == 0 ? "title" : "title\nsubtitle that says what the levels hang on";
        assert_int_equal(asdic_picture_waterfall(ctx, file_in_folder("t.png"), &ramp, &options),
                         ASDIC_OK);
        uint8_t *rgb = decode(file_in_folder("t.png"), PNG_FORMAT_RGB, &width, &height[i]);
        grey[i] = count_color(rgb, width * height[i], 0x606060);
        free(rgb);
    }
    assert_true(height[1] > height[0] + 10 && height[1] < height[0] + 40);
    assert_true(grey[1] > grey[0] + 20);
}

static void failures_leave_nothing(void **state) {
    (void)state;
    asdic_picture_options options = asdic_picture_options_default();
    const char *path = file_in_folder("full"); /* a link: no slip may replace the device itself */
    assert_int_equal(symlink("/dev/full", path), 0);
    assert_int_equal(asdic_picture_raster(ctx, path, &ramp, &options), ASDIC_ERROR_IO);
    assert_contains(asdic_context_error(ctx), "/full': No space left on device");
    assert_int_equal(unlink(path), 0);
    assert_int_equal(asdic_picture_raster(ctx, file_in_folder("no/r.png"), &ramp, &options),
                     ASDIC_ERROR_IO);
    options.db_high = options.db_low;
    assert_int_equal(asdic_picture_raster(ctx, file_in_folder("r.png"), &ramp, &options),
                     ASDIC_ERROR_ARGUMENT);
    options = asdic_picture_options_default();
    asdic_waterfall none = ramp;
    none.pings = 0;
    assert_int_equal(asdic_picture_waterfall(ctx, file_in_folder("r.png"), &none, &options),
                     ASDIC_ERROR_ARGUMENT);
}

/* What stands over and below pictures. */
static void words_say_what_is_shown(void **state) {
    (void)state;
    char text[ASDIC_SUBTITLE_SIZE], note[ASDIC_NOTE_SIZE];
    asdic_sonar sonar = asdic_sonar_default();
    sonar.frequency_hz = 123456.0;
    sonar.bandwidth_hz = 12500.0;
    sonar.source_level_db = 217.5;
    asdic_picture_subtitle(&sonar, 0.0375, text);
    assert_string_equal(text, "123.456 kHz, bandwidth 12.5 kHz  \u00b7  bins of 0.0375 m  \u00b7  "
                              "source level 217.5 dB re 1 \u00b5Pa at 1 m");
    sonar.source_level_db = 0.0;
    sonar.noise_enabled = true;
    asdic_picture_subtitle(&sonar, 0.0375, text);
    assert_non_null(strstr(text, "source level 0 dB re 1 \u00b5Pa at 1 m"));
    sonar.noise_enabled = false;
    asdic_picture_subtitle(&sonar, 0.0375, text);
    assert_string_equal(text, "123.456 kHz, bandwidth 12.5 kHz  \u00b7  bins of 0.0375 m  \u00b7  "
                              "levels re an SL of 0 dB");
    asdic_picture_subtitle(NULL, 0.0375, text);
    assert_string_equal(text, "");
    asdic_picture_subtitle(&sonar, 0.0375, NULL);
    static const struct {
        const char *note;
        double per_decade, per_m;
        size_t rows, columns;
        const char *right;
    } cases[] = {{NULL, 0, 0, 1, 1, ""},
                 {"a note", 0, 0, 1, 1, "a note"},
                 {NULL, 0, 0.02, 1, 1, "time-varied gain for display: 0 log r + 0.02 r dB"},
                 {"a", 30, 0, 2, 1,
                  "a  \u00b7  time-varied gain for display: 30 log r + 0 r dB  \u00b7  each pixel "
                  "is the mean "
                  "energy of 2 pings \u00d7 1 bin"},
                 {NULL, 0, 0, 1, 2, "each pixel is the mean energy of 1 ping \u00d7 2 bins"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const asdic_decimator levels = {.row_group = cases[i].rows,
                                        .column_group = cases[i].columns};
        asdic_picture_options options = asdic_picture_options_default();
        options.note = cases[i].note;
        options.tvg_db_per_decade = cases[i].per_decade;
        options.tvg_db_per_m = cases[i].per_m;
        asdic_draw_note(note, &options, &levels);
        assert_string_equal(note, cases[i].right);
    }
}

/* How often PART is in the picture of MAP, which is an SVG whatever its name. */
static int times_in_map(const asdic_map *map, const char *part) {
    char path[256];
    static char text[1 << 20];
    asdic_picture_options options = asdic_picture_options_default();
    options.format = ASDIC_PICTURE_SVG;
    snprintf(path, sizeof path, "%s", file_in_folder("map.png"));
    assert_ok(ctx, asdic_picture_map(ctx, path, map, &options));
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    assert_int_equal(fclose(file), 0);
    assert_int_equal(unlink(path), 0);
    assert_contains(text, "<svg");
    int times = 0;
    for (const char *at = text; (at = strstr(at, part)); at++) {
        times++;
    }
    return times;
}

/* Lines of a map are curves like others: dashed, and interrupted where a point is not finite. */
static void maps_follow_their_format_and_lines(void **state) {
    (void)state;
    if (!asdic_picture_annotated()) {
        skip();
    }
    const float value = -100.0f;
    double east_m[5] = {0.1, 0.2, 0.5, 0.8, 0.9}, north_m[5] = {0.5, 0.5, 0.5, 0.5, 0.5};
    asdic_series line = {.x = east_m, .y = north_m, .count = 5, .rgb = 0x123456, .width = 1.0};
    asdic_map map = {.values = &value,
                     .rows = 1,
                     .columns = 1,
                     .cell_m = 1,
                     .label = "v",
                     .lines = &line,
                     .line_count = 1};
    assert_int_equal(times_in_map(&map, "stroke-dasharray"), 0);
    line.style = ASDIC_LINE_DASHED;
    assert_int_equal(times_in_map(&map, "stroke-dasharray"), 1);
    line.style = ASDIC_LINE_SOLID;
    int moves = times_in_map(&map, "M ");
    east_m[2] = NAN; /* two pieces */
    assert_int_equal(times_in_map(&map, "M "), moves + 1);
    assert_int_equal(times_in_map(&map, "nan"), 0);
    north_m[4] = INFINITY; /* a piece and a dot, and the dot of the end there */
    assert_true(times_in_map(&map, "M ") > moves);
    assert_int_equal(times_in_map(&map, "inf"), 0);
    map.label = NULL; /* of values without a name */
    assert_true(times_in_map(&map, "M ") > 0);
}

/* Each by one thing alone, and no file is left. */
static void what_cannot_be_drawn_is_refused(void **state) {
    (void)state;
    const asdic_picture_options good = asdic_picture_options_default();
    asdic_picture_options wrong[8] = {good, good, good, good, good, good, good, good};
    wrong[0].db_low = -INFINITY;
    wrong[1].db_high = INFINITY;
    wrong[2].db_high = wrong[2].db_low + 0.95e-3;
    wrong[3].tvg_db_per_decade = NAN;
    wrong[4].tvg_db_per_m = NAN;
    wrong[5].colormap = ASDIC_COLORMAP_COUNT;
    wrong[6].format = (asdic_picture_format)99;
    wrong[7].db_low = -1e308;
    wrong[7].db_high = 1e308;
    const double bearing_rad[2] = {0.5, 0.5};
    const asdic_fan fan = {
        .levels_db = ramp_db, .bearing_rad = bearing_rad, .beams = 1, .bins = 8, .bin_length_m = 1};
    char path[256];
    snprintf(path, sizeof path, "%s", file_in_folder("r.png"));
    for (size_t i = 0; i < 8; i++) {
        assert_int_equal(asdic_picture_raster(ctx, path, &ramp, &wrong[i]), ASDIC_ERROR_ARGUMENT);
        assert_int_equal(asdic_picture_fan(ctx, path, &fan, &wrong[i]), ASDIC_ERROR_ARGUMENT);
    }
    asdic_waterfall falls[8] = {ramp, ramp, ramp, ramp, ramp, ramp, ramp, ramp};
    falls[0].pings = falls[1].bins = 0;
    falls[2].bin_length_m = 0.0;
    falls[3].levels_db = NULL;
    falls[4].bin_length_m = INFINITY;
    falls[5].first_time_s = NAN;
    falls[6].ping_period_s = INFINITY;
    falls[7].ping_period_s = -1.0;
    const double far_rad = 1e17, nowhere_rad = NAN;
    asdic_fan fans[8] = {fan, fan, fan, fan, fan, fan, fan, fan};
    fans[0].beams = fans[1].bins = 0;
    fans[2].bin_length_m = 0.0;
    fans[3].levels_db = NULL;
    fans[4].bearing_rad = NULL;
    fans[5].bearing_rad = &far_rad;
    fans[6].bearing_rad = &nowhere_rad;
    fans[7].beams = 2;
    for (size_t i = 0; i < 8; i++) {
        const asdic_waterfall *fall = &falls[i];
        assert_int_equal(asdic_picture_waterfall(ctx, path, fall, &good), ASDIC_ERROR_ARGUMENT);
        assert_int_equal(asdic_picture_raster(ctx, path, fall, &good), ASDIC_ERROR_ARGUMENT);
        assert_int_equal(asdic_picture_raw(ctx, path, fall, &good), ASDIC_ERROR_ARGUMENT);
        assert_int_equal(asdic_picture_fan(ctx, path, &fans[i], &good), ASDIC_ERROR_ARGUMENT);
    }
    assert_contains(asdic_context_error(ctx), "beam 0 lies at 0.5 and beam 1 at 0.5 rad");
    const asdic_plot_axis axis = {.label = "m", .low = 1, .high = 2};
    const asdic_plot_axis none[4] = {{.low = 1, .high = 1},
                                     {.low = 0, .high = INFINITY},
                                     {.low = 0, .high = 1, .logarithmic = true},
                                     {.low = NAN, .high = 1}};
    for (size_t i = 0; i < 8; i++) {
        const asdic_plot panels[2] = {
            {.x = axis, .y = axis}, {.x = i < 4 ? none[i] : axis, .y = i < 4 ? axis : none[i - 4]}};
        assert_int_equal(asdic_picture_plot(ctx, path, panels, 2, &good), ASDIC_ERROR_ARGUMENT);
        assert_int_equal(asdic_picture_plot(ctx, path, panels, 0, &good), ASDIC_ERROR_ARGUMENT);
    }
    const asdic_plot panel = {.x = axis, .y = axis};
    const double place[2] = {1.0, 2.0};
    const asdic_series curve = {.x = place, .y = place, .count = 2, .width = 1.0};
    asdic_series curves[6] = {curve, curve, curve, curve, curve, curve};
    curves[0].x = NULL;
    curves[1].y = NULL;
    curves[2].width = NAN;
    curves[3].style = (asdic_line_style)99;
    curves[4].width = -1.0;
    curves[5].width = INFINITY;
    for (size_t i = 0; i < 7; i++) {
        asdic_plot of = panel;
        of.series = i < 6 ? &curves[i] : NULL;
        of.series_count = 1;
        assert_int_equal(asdic_picture_plot(ctx, path, &of, 1, &good), ASDIC_ERROR_ARGUMENT);
    }
    assert_int_equal(asdic_picture_plot(ctx, path, &panel, 1, &wrong[6]), ASDIC_ERROR_ARGUMENT);
    const asdic_ascope scope = {.bins = 8, .bin_length_m = 1, .simulated_db = ramp_db};
    assert_int_equal(asdic_picture_ascope(ctx, NULL, &scope, 1, &good), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_picture_ascope(ctx, path, NULL, 1, &good), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_picture_ascope(ctx, path, &scope, 1, NULL), ASDIC_ERROR_ARGUMENT);
    for (int i = 0; i < 3; i++) {
        const char *at = i == 0 ? NULL : path;
        const asdic_waterfall *fall = i == 1 ? NULL : &ramp;
        const asdic_picture_options *options = i == 2 ? NULL : &good;
        assert_int_equal(asdic_picture_waterfall(ctx, at, fall, options), ASDIC_ERROR_ARGUMENT);
        assert_int_equal(asdic_picture_raster(ctx, at, fall, options), ASDIC_ERROR_ARGUMENT);
        assert_int_equal(asdic_picture_raw(ctx, at, fall, options), ASDIC_ERROR_ARGUMENT);
        assert_int_equal(asdic_picture_fan(ctx, at, i == 1 ? NULL : &fan, options),
                         ASDIC_ERROR_ARGUMENT);
        assert_int_equal(asdic_picture_plot(ctx, at, i == 1 ? NULL : &panel, 1, options),
                         ASDIC_ERROR_ARGUMENT);
    }
    const double metres[] = {1.0, 0.0, -1.0, NAN, INFINITY}; /* of a cell */
    for (size_t i = 0; i < 8; i++) {
        asdic_map map = {
            .columns = 2, .rows = 2, .cell_m = metres[i < 5 ? i : 0], .values = ramp_db};
        map.rows =
            i == 0 ? SIZE_MAX / sizeof *ramp_db / 2 + 1 : map.rows; /* more than there can be */
        map.columns = i == 5 ? 0 : map.columns;
        map.north_m = i == 6 ? NAN : 0.0;
        map.east_m = i == 7 ? INFINITY : 0.0;
        assert_int_equal(asdic_picture_map(ctx, path, &map, &good), ASDIC_ERROR_ARGUMENT);
    }
    assert_int_equal(access(path, F_OK), -1);
}

/* Processor time of a curve that goes to and fro, as a level with speckle does. */
static double seconds_of_curve(size_t count) {
    enum { MOST = 1 << 15 };
    static double x[MOST], y[MOST];
    uint32_t state = 1;
    for (size_t i = 0; i < count; i++) {
        state = 1664525u * state + 1013904223u;
        x[i] = (double)i / (double)count;
        y[i] = ldexp(state, -32);
    }
    const asdic_series curve = {.x = x, .y = y, .count = count, .width = 1.0};
    const asdic_plot panel = {.x = {.label = "x", .low = 0, .high = 1},
                              .y = {.label = "y", .low = 0, .high = 1},
                              .series = &curve,
                              .series_count = 1};
    const asdic_picture_options options = asdic_picture_options_default();
    const char *path = file_in_folder("curve.png");
    clock_t begin = clock();
    assert_int_equal(asdic_picture_plot(ctx, path, &panel, 1, &options), ASDIC_OK);
    assert_int_equal(remove(path), 0);
    return (double)(clock() - begin) / CLOCKS_PER_SEC;
}

/* Eight times as many points; in one piece they took forty times as long. */
static void time_of_curves_grows_as_their_points(void **state) {
    (void)state;
    if (!asdic_picture_annotated()) {
        skip();
    }
    double few_s = seconds_of_curve(1 << 12), many_s = seconds_of_curve(1 << 15);
    print_message("%.3f s, %.3f s\n", few_s, many_s);
    assert_true(many_s < 16.0 * few_s);
}

/* -100 dB at 5 and at 15 m, with 20 log r + r; the window's 100 dB are 65534 steps. */
static void gain_is_of_the_bins_centre(void **state) {
    (void)state;
    const float levels_db[2] = {-100.0f, -100.0f};
    asdic_picture_options options = asdic_picture_options_default();
    uint16_t grey[2];
    options.db_low = -100.0;
    options.db_high = 0.0;
    options.tvg_db_per_decade = 20.0;
    options.tvg_db_per_m = 1.0;
    asdic_draw_grey(&options, levels_db, 2, 10.0, grey);
    assert_close(grey[0], 1.0 + 655.34 * (13.9794 + 5.0), 0.51);
    assert_close(grey[1], 1.0 + 655.34 * (23.5218 + 15.0), 0.51);
}

/* Whether a column of the rows FROM to TO is paper. */
static bool is_blank(const uint8_t *rgb, size_t width, size_t x, size_t from, size_t to) {
    while (from < to && pixel(rgb, width, x, from) == 0xffffff) {
        from++;
    }
    return from == to;
}

/* Names of sixteen beams, 000 to 015, below a panel of 480 pixels: five or more between neighbours. */
static void names_of_beams_are_apart(void **state) {
    (void)state;
    if (!asdic_picture_annotated()) {
        skip();
    }
    enum { BEAMS = 16 };
    char text[BEAMS][4];
    const char *names[BEAMS];
    float levels_db[BEAMS], noise_db[BEAMS];
    for (int i = 0; i < BEAMS; i++) {
        snprintf(text[i], sizeof text[i], "%03d", i);
        names[i] = text[i];
        levels_db[i] = 0.0f;
        noise_db[i] = -100.0f;
    }
    asdic_overview o;
    asdic_picture_options options = asdic_picture_options_default();
    assert_int_equal(asdic_overview_init(ctx, 2, BEAMS, 1, 10.0, &o), ASDIC_OK);
    asdic_overview_add(&o, levels_db, noise_db, noise_db);
    asdic_overview_add(&o, levels_db, noise_db, noise_db);
    options.db_low = -10.0; /* what is shown lies inside: no paper */
    options.db_high = 10.0;
    const asdic_overview_axes axes = {.names = names};
    const char *path = file_in_folder("o.png");
    assert_int_equal(asdic_draw_overview(ctx, path, &o, &axes, &options), ASDIC_OK);
    asdic_overview_finish(&o);
    size_t width, height, bottom = 0, left, right, gaps = 0;
    uint8_t *rgb = decode(path, PNG_FORMAT_RGB, &width, &height);
    const size_t inside = 300; /* a column of the first panel */
    for (size_t y = 1, run = 0; y < height; y++) {
        run = pixel(rgb, width, inside, y) != 0xffffff ? run + 1 : 0;
        bottom = run > 100 ? y : bottom;
    }
    for (left = inside; pixel(rgb, width, left - 1, bottom - 9) != 0xffffff; left--) {
    }
    for (right = inside; pixel(rgb, width, right + 1, bottom - 9) != 0xffffff; right++) {
    }
    assert_in_range(right - left, 478, 490);
    for (size_t x = left, run = 0; x < right; x++) {
        run = is_blank(rgb, width, x, bottom + 9, bottom + 30) ? run + 1 : 0;
        gaps += run == 5;
    }
    free(rgb);
    assert_in_range(gaps, BEAMS - 1, BEAMS + 1); /* and at the panel's edges */
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(window_is_minus_160_to_60),
        cmocka_unit_test(raster_byte_for_byte),
        cmocka_unit_test(raw_is_linear_in_the_window),
        cmocka_unit_test(raw_shows_a_million_pings),
        cmocka_unit_test(colormaps_have_their_published_ends),
        cmocka_unit_test(gain_is_for_display_only),
        cmocka_unit_test(text_chunks_are_there),
        cmocka_unit_test(waterfall_shows_every_level),
        cmocka_unit_test(a_waterfalls_frame_hides_no_level),
        cmocka_unit_test(waterfall_averages_energy),
        cmocka_unit_test(fan_starboard_is_right),
        cmocka_unit_test(fans_are_the_same_listed_either_way),
        cmocka_unit_test(ascope_draws_its_curves),
        cmocka_unit_test(a_lone_point_is_a_dot),
        cmocka_unit_test(ascope_shows_residuals_and_lone_echoes),
        cmocka_unit_test(subtitles_have_a_line),
        cmocka_unit_test(words_say_what_is_shown),
        cmocka_unit_test(maps_follow_their_format_and_lines),
        cmocka_unit_test(what_cannot_be_drawn_is_refused),
        cmocka_unit_test(time_of_curves_grows_as_their_points),
        cmocka_unit_test(gain_is_of_the_bins_centre),
        cmocka_unit_test(names_of_beams_are_apart),
        cmocka_unit_test(failures_leave_nothing),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
