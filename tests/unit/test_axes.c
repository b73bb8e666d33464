/*
 * Axes and colour scales: each line and word lies where its value does, of boxes that lie anywhere. What is drawn is seen
 * on its way to the page, which stays empty.
 */
#include "asserts.h"

#include "out/canvas.h"
#include "out/colormap.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MOST 64

static struct line { double x0, y0, x1, y1, red; } lines[MOST];
static struct word {
    asdic_lettering at;
    char text[40];
    double room;
} words[MOST];
static struct {
    asdic_box box;
    uint32_t first, last;
    size_t width, height;
} raster;
static size_t line_count, word_count;

void __wrap_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1);
void __wrap_asdic_canvas_text(asdic_canvas *c, asdic_lettering where, const char *text);
void __wrap_asdic_canvas_text_fit(asdic_canvas *c, asdic_lettering where, const char *text,
                                  double room);
void __wrap_asdic_canvas_raster(asdic_canvas *c, const asdic_raster *r, asdic_box box);

void __wrap_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1) {
    struct line l = {x0, y0, x1, y1, NAN};
    double green, blue, alpha;
    assert_int_equal(cairo_get_line_width(c->cr), 1);
    cairo_pattern_get_rgba(cairo_get_source(c->cr), &l.red, &green, &blue, &alpha);
    assert_true(line_count < MOST);
    lines[line_count++] = l;
}

void __wrap_asdic_canvas_text_fit(asdic_canvas *c, asdic_lettering where, const char *text,
                                  double room) {
    (void)c;
    assert_true(word_count < MOST);
    words[word_count].at = where;
    words[word_count].room = room;
    snprintf(words[word_count++].text, sizeof words->text, "%s", text);
}

void __wrap_asdic_canvas_text(asdic_canvas *c, asdic_lettering where, const char *text) {
    __wrap_asdic_canvas_text_fit(c, where, text, NAN);
}

void __wrap_asdic_canvas_raster(asdic_canvas *c, const asdic_raster *r, asdic_box box) {
    (void)c;
    raster.box = box;
    raster.width = r->width;
    raster.height = r->height;
    const uint8_t *end = r->rgb + 3 * (r->height - 1);
    raster.first = (uint32_t)(r->rgb[0] << 16 | r->rgb[1] << 8 | r->rgb[2]);
    raster.last = (uint32_t)(end[0] << 16 | end[1] << 8 | end[2]);
}

static asdic_box outline;

void __wrap_cairo_rectangle(cairo_t *cr, double x, double y, double w, double h);

void __wrap_cairo_rectangle(cairo_t *cr, double x, double y, double w, double h) {
    (void)cr;
    outline = (asdic_box){x, y, w, h};
}

static const asdic_box box = {.x = 100.0, .y = 50.0, .w = 640.0, .h = 331.0};
static asdic_canvas canvas;

static int begin(void **state) {
    (void)state;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 8, 8);
    canvas.cr = cairo_create(surface);
    cairo_surface_destroy(surface);
    return cairo_status(canvas.cr) != CAIRO_STATUS_SUCCESS;
}

static int end(void **state) {
    (void)state;
    cairo_destroy(canvas.cr);
    return 0;
}

static void forget(void) {
    line_count = word_count = 0;
    cairo_set_line_width(canvas.cr, 9.0);
}

/* On the middle of the pixel that X lies in. */
static void assert_crisp(double place, double x) {
    assert_close(place, floor(x) + 0.5, 1e-9);
}

/* A tick and a word for each of COUNT ticks 10 apart from 0 on, before them a pale line across the box. */
static void abscissas_have_ticks_below(void **state) {
    (void)state;
    const asdic_plot_axis axis = {.label = "range (m)", .low = -3.0, .high = 47.0};
    for (int grid = 0; grid < 2; grid++) {
        forget();
        asdic_canvas_axis_x(&canvas, box, &axis, grid);
        assert_int_equal(line_count, grid ? 10 : 5);
        assert_int_equal(word_count, 6);
        for (size_t i = 0; i < 5; i++) {
            const struct line *tick = &lines[grid ? 2 * i + 1 : i];
            const struct word *word = &words[i];
            char text[8];
            snprintf(text, sizeof text, "%zu", 10 * i);
            assert_string_equal(word->text, text);
            assert_crisp(tick->x0, 100.0 + 640.0 * (10.0 * (double)i + 3.0) / 50.0);
            assert_true(tick->x1 == tick->x0 && word->at.x == tick->x0);
            assert_true(tick->y0 == 381.0 && tick->y1 > 384.0 && tick->y1 < 391.0 &&
                        tick->red < 0.3);
            assert_true(word->at.y > tick->y1 + 2.0 && word->at.y < tick->y1 + 10.0);
            assert_true(word->at.align_x == 0.5 && word->at.align_y == 1.0 && !word->at.upwards);
            assert_true(word->at.size_px == ASDIC_TEXT_PX && word->room == 640.0);
            if (grid) {
                assert_true(tick[-1].x0 == tick->x0 && tick[-1].x1 == tick->x0);
                assert_true(tick[-1].y0 == 50.0 && tick[-1].y1 == 381.0 && tick[-1].red > 0.7);
            }
        }
        const asdic_lettering *at = &words[5].at;
        assert_string_equal(words[5].text, "range (m)");
        assert_true(at->x == 420.0 && at->align_x == 0.5 && at->align_y == 1.0 && !at->upwards);
        assert_true(at->y > words[0].at.y + 1.5 * ASDIC_TEXT_PX &&
                    at->y < words[0].at.y + 3.0 * ASDIC_TEXT_PX);
    }
}

/* 90 pixels apart along, 30 down, or further; two intervals at least. */
static void ticks_have_room(void **state) {
    (void)state;
    static const struct {
        double px;
        size_t ticks;
    } cases[] = {{6.0, 7}, {6.6, 7}, {5.99, 4}, {3.0, 4}, {2.9, 3}, {0.1, 3}, {12.0, 13}};
    const asdic_plot_axis axis = {.low = 0.0, .high = 60.0}, whole = {.low = 0.0, .high = 40.0};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const asdic_plot_axis *a = cases[i].px < 3.0 ? &whole : &axis;
        forget();
        asdic_canvas_axis_x(&canvas, (asdic_box){0.0, 0.0, 90.0 * cases[i].px, 9.0}, a, false);
        assert_int_equal(line_count, cases[i].ticks);
        assert_int_equal(word_count, cases[i].ticks);
        for (int down = 0; down < 2; down++) {
            forget();
            asdic_canvas_axis_y(&canvas, (asdic_box){0.0, 0.0, 9.0, 30.0 * cases[i].px}, a, down,
                                false);
            assert_int_equal(line_count, cases[i].ticks);
            forget();
            asdic_canvas_scale(&canvas, (asdic_box){0.0, 0.0, 9.0, 30.0 * cases[i].px}, a,
                               ASDIC_COLORMAP_GRAY, down);
            assert_int_equal(line_count, cases[i].ticks);
        }
    }
    /* Names share the axis evenly. */
    static const char *const names[] = {"one", "two", "three", "four"};
    forget();
    asdic_canvas_axis_x(
        &canvas, box, &(asdic_plot_axis){.low = 0.5, .high = 4.5, .names = names, .name_count = 4},
        false);
    assert_int_equal(word_count, 4);
    for (size_t i = 0; i < 4; i++) {
        assert_string_equal(words[i].text, names[i]);
        assert_crisp(words[i].at.x, 100.0 + 160.0 * ((double)i + 0.5));
        assert_true(words[i].room > 145.0 && words[i].room < 160.0);
    }
}

/* The widest word of an axis with ticks at 0, 10, ... 100. */
static double widest(void) {
    return asdic_canvas_text_width("100", ASDIC_TEXT_PX);
}

/* The tick and the word of 10 I lie where that does, of -2 to 108 over HIGH pixels. */
static void assert_at_ten(size_t i, const struct line *tick, const struct word *word, double high,
                          bool down) {
    char text[8];
    double share = (10.0 * (double)i + 2.0) / 110.0;
    snprintf(text, sizeof text, "%zu", 10 * i);
    assert_string_equal(word->text, text);
    assert_crisp(tick->y0, 50.0 + high * (down ? share : 1.0 - share));
    assert_true(tick->y1 == tick->y0 && word->at.y == tick->y0);
}

static void ordinates_have_ticks_on_the_left(void **state) {
    (void)state;
    const asdic_plot_axis axis = {.label = "depth (m)", .low = -2.0, .high = 108.0};
    for (int k = 0; k < 4; k++) {
        bool down = k & 1, grid = k & 2;
        forget();
        asdic_canvas_axis_y(&canvas, box, &axis, down, grid);
        assert_int_equal(line_count, grid ? 22 : 11);
        assert_int_equal(word_count, 12);
        for (size_t i = 0; i < 11; i++) {
            const struct line *tick = &lines[grid ? 2 * i + 1 : i];
            const struct word *word = &words[i];
            assert_at_ten(i, tick, word, 331.0, down);
            assert_true(tick->x0 == 100.0 && tick->x1 < 97.0 && tick->x1 > 90.0 && tick->red < 0.3);
            assert_true(word->at.x < tick->x1 - 2.0 && word->at.x > tick->x1 - 10.0);
            assert_true(word->at.align_x == 1.0 && word->at.align_y == 0.5 && !word->at.upwards);
            if (grid) {
                assert_true(tick[-1].y0 == tick->y0 && tick[-1].y1 == tick->y0);
                assert_true(tick[-1].x0 == 100.0 && tick[-1].x1 == 740.0 && tick[-1].red > 0.7);
            }
        }
        const asdic_lettering *at = &words[11].at;
        double left = words[0].at.x - widest();
        assert_string_equal(words[11].text, "depth (m)");
        assert_true(at->y == 215.5 && at->upwards && at->align_x == 0.5 && at->align_y == 0.0);
        assert_true(at->x < left - 4.0 && at->x > left - ASDIC_TEXT_PX);
        /* The room holds its capitals, which go as far to its left as it is high. */
        double room = asdic_canvas_axis_y_room(&axis, box.h), used = 100.0 - at->x + ASDIC_TEXT_PX;
        assert_true(room >= used - 5.0 && room < used + 5.0);
        asdic_plot_axis bare = axis;
        bare.label = NULL;
        double bare_room = asdic_canvas_axis_y_room(&bare, box.h);
        assert_close(bare_room, 100.0 - left, 1e-9);
        bare.low = -108.0; /* the first word is the widest */
        bare.high = 2.0;
        assert_close(asdic_canvas_axis_y_room(&bare, box.h) - bare_room,
                     asdic_canvas_text_width("\u2212100", ASDIC_TEXT_PX) - widest(), 1e-9);
    }
}

static void scales_have_ticks_on_the_right(void **state) {
    (void)state;
    const asdic_plot_axis axis = {.label = "level", .low = -2.0, .high = 108.0};
    for (int down = 0; down < 2; down++) {
        forget();
        asdic_canvas_scale(&canvas, box, &axis, ASDIC_COLORMAP_VIRIDIS, down);
        assert_true(raster.width == 1 && raster.height == 256);
        assert_memory_equal(&raster.box, &box, sizeof box);
        const asdic_box within = {100.5, 50.5, 639.0, 330.0}; /* a line of one pixel */
        assert_memory_equal(&outline, &within, sizeof within);
        assert_int_equal(raster.first, asdic_colormap_rgb(ASDIC_COLORMAP_VIRIDIS, 255));
        assert_int_equal(raster.last, asdic_colormap_rgb(ASDIC_COLORMAP_VIRIDIS, 0));
        assert_int_equal(line_count, 11);
        assert_int_equal(word_count, 12);
        for (size_t i = 0; i < 11; i++) {
            const struct line *tick = &lines[i];
            const struct word *word = &words[i];
            assert_at_ten(i, tick, word, 330.0, down);
            assert_true(tick->x0 == 740.0 && tick->x1 > 743.0 && tick->x1 < 750.0 &&
                        tick->red < 0.3);
            assert_true(word->at.x > tick->x1 + 2.0 && word->at.x < tick->x1 + 10.0);
            assert_true(word->at.align_x == 0.0 && word->at.align_y == 0.5 && !word->at.upwards);
        }
        const asdic_lettering *at = &words[11].at;
        double right = words[0].at.x + widest();
        assert_string_equal(words[11].text, "level");
        assert_true(at->y == 215.5 && at->upwards && at->align_x == 0.5);
        assert_true(at->x > right + 0.9 * ASDIC_TEXT_PX && at->x < right + 2.0 * ASDIC_TEXT_PX);
    }
}

/* The bar of levels: low at the bottom, its room what labels and title take. */
static void bars_are_scales_of_levels(void **state) {
    (void)state;
    asdic_picture_options options = asdic_picture_options_default();
    asdic_plot_axis axis = asdic_canvas_level_axis(&options);
    forget();
    asdic_canvas_color_bar(&canvas, box, &options);
    assert_string_equal(words[0].text, "\u2212160");
    assert_crisp(lines[0].y0, 380.0);
    assert_string_equal(words[word_count - 1].text, axis.label);
    assert_int_equal(raster.first, asdic_colormap_rgb(options.colormap, 255));
    double room = asdic_canvas_color_bar_room(&options, box.h);
    assert_true(room == asdic_canvas_axis_y_room(&axis, box.h));
    assert_true(words[word_count - 1].at.x < 740.0 + room &&
                words[word_count - 1].at.x > 735.0 + room - ASDIC_TEXT_PX);
}

static void levels_and_times_have_axes(void **state) {
    (void)state;
    asdic_picture_options options = asdic_picture_options_default();
    options.db_low = -120.0;
    options.db_high = -70.0;
    asdic_plot_axis axis = asdic_canvas_level_axis(&options);
    assert_true(axis.low == -120.0 && axis.high == -70.0);
    assert_string_equal(axis.label, "level (dB re 1 \u00b5Pa)");
    options.tvg_db_per_m = 0.1;
    assert_string_equal(asdic_canvas_level_axis(&options).label, "level + gain (dB re 1 \u00b5Pa)");
    options.tvg_db_per_m = 0.0;
    options.tvg_db_per_decade = 20.0;
    assert_string_equal(asdic_canvas_level_axis(&options).label, "level + gain (dB re 1 \u00b5Pa)");
    axis = asdic_canvas_time_axis(8.0, 3.0, 0.5);
    assert_string_equal(axis.label, "time (s), downwards");
    assert_true(axis.low == 3.0 && axis.high == 7.0);
    axis = asdic_canvas_time_axis(8.0, 3.0, 0.0);
    assert_string_equal(axis.label, "ping");
    assert_true(axis.low == -0.5 && axis.high == 7.5);
    /* Whole pixels, at most 40 each, as many as fill 720 or, at least, 160. */
    static const double each[][2] = {{1, 160}, {4, 40},  {17, 40}, {18, 40},
                                     {19, 37}, {400, 1}, {1000, 1}};
    for (size_t i = 0; i < sizeof each / sizeof *each; i++) {
        assert_close(asdic_canvas_pixels_each((size_t)each[i][0], 720.0, 40.0, 160.0), each[i][1],
                     0.0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(abscissas_have_ticks_below),
        cmocka_unit_test(ticks_have_room),
        cmocka_unit_test(ordinates_have_ticks_on_the_left),
        cmocka_unit_test(scales_have_ticks_on_the_right),
        cmocka_unit_test(bars_are_scales_of_levels),
        cmocka_unit_test(levels_and_times_have_axes),
    };
    return cmocka_run_group_tests(tests, begin, end);
}
