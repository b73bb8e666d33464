/*
 * Pages of pictures: axes, rasters, curves and scales share their boxes, which lie apart on the page; rings, rays and
 * ends of lines lie where the range, the bearing and the place say. What is drawn is seen on its way to the page, which
 * is not written.
 */
#include "asserts.h"
#include "test_context.h"

#include "base/vec.h"
#include "out/canvas.h"
#include "out/colormap.h"
#include "out/draw.h"
#include "out/draw_chart.h"
#include "out/overview.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST 64
#define DEGREE (ASDIC_PI / 180.0)

static struct shape {
    asdic_box box;
    asdic_plot_axis axis;
    bool down;
} rasters[MOST], xs[MOST], ys[MOST], frames[MOST], scales[MOST], curves[MOST], legends[MOST];
static size_t raster_count, x_count, y_count, frame_count, scale_count, curve_count, legend_count;
static struct word {
    asdic_lettering at;
    char text[120];
} words[MOST];
static struct line { double x0, y0, x1, y1; } lines[MOST];
static asdic_box rectangles[MOST];
static size_t rectangle_count;
static struct arc { double x, y, radius, low, high; } arcs[MOST];
static size_t word_count, line_count, arc_count;
static uint8_t pixels[2][3 * MOST]; /* of the first and the second raster */
static char notes[ASDIC_NOTE_SIZE];
static double page_w, page_h;

static void forget(void) {
    raster_count = x_count = y_count = frame_count = scale_count = curve_count = legend_count = 0;
    word_count = line_count = arc_count = rectangle_count = 0;
}

static void note(struct shape *shapes, size_t *count, asdic_box box, const asdic_plot_axis *axis,
                 bool down) {
    assert_true(*count < MOST);
    shapes[(*count)++] = (struct shape){box, axis ? *axis : (asdic_plot_axis){0}, down};
}

void __wrap_asdic_canvas_axis_x(asdic_canvas *c, asdic_box box, const asdic_plot_axis *axis,
                                bool grid);
void __wrap_asdic_canvas_axis_y(asdic_canvas *c, asdic_box box, const asdic_plot_axis *axis,
                                bool down, bool grid);
void __wrap_asdic_canvas_scale(asdic_canvas *c, asdic_box box, const asdic_plot_axis *axis,
                               asdic_colormap map, bool down);
void __wrap_asdic_canvas_color_bar(asdic_canvas *c, asdic_box box,
                                   const asdic_picture_options *options);
void __wrap_asdic_canvas_raster(asdic_canvas *c, const asdic_raster *r, asdic_box box);
void __wrap_asdic_canvas_frame(asdic_canvas *c, asdic_box box);
void __wrap_asdic_canvas_curve(asdic_canvas *c, asdic_box box, const asdic_plot_axis *x,
                               const asdic_plot_axis *y, const asdic_series *s);
double __real_asdic_canvas_legend(asdic_canvas *c, asdic_box box, const asdic_series *s,
                                  size_t count);
double __wrap_asdic_canvas_legend(asdic_canvas *c, asdic_box box, const asdic_series *s,
                                  size_t count);
void __wrap_asdic_canvas_text(asdic_canvas *c, asdic_lettering where, const char *text);
void __wrap_asdic_canvas_text_fit(asdic_canvas *c, asdic_lettering where, const char *text,
                                  double room);
void __wrap_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1);
void __wrap_cairo_arc(cairo_t *cr, double x, double y, double radius, double low, double high);
void __wrap_asdic_canvas_frame_text(asdic_canvas *c, double x, const char *title, const char *text);

void __wrap_asdic_canvas_frame_text(asdic_canvas *c, double x, const char *title,
                                    const char *text) {
    (void)c;
    assert_true(x >= ASDIC_MARGIN_PX);
    assert_string_equal(title, "title");
    snprintf(notes, sizeof notes, "%s", text ? text : "");
}

void __wrap_cairo_rectangle(cairo_t *cr, double x, double y, double w, double h);

void __wrap_cairo_rectangle(cairo_t *cr, double x, double y, double w, double h) {
    (void)cr;
    assert_true(rectangle_count < MOST);
    rectangles[rectangle_count++] = (asdic_box){x, y, w, h};
}

asdic_status __wrap_asdic_canvas_save(asdic_canvas *c, const char *path, const char *const *texts);

void __wrap_asdic_canvas_axis_x(asdic_canvas *c, asdic_box box, const asdic_plot_axis *axis,
                                bool grid) {
    (void)c;
    note(xs, &x_count, box, axis, grid);
}

void __wrap_asdic_canvas_axis_y(asdic_canvas *c, asdic_box box, const asdic_plot_axis *axis,
                                bool down, bool grid) {
    (void)c;
    (void)grid;
    note(ys, &y_count, box, axis, down);
}

void __wrap_asdic_canvas_scale(asdic_canvas *c, asdic_box box, const asdic_plot_axis *axis,
                               asdic_colormap map, bool down) {
    (void)c;
    (void)map;
    note(scales, &scale_count, box, axis, down);
}

void __wrap_asdic_canvas_color_bar(asdic_canvas *c, asdic_box box,
                                   const asdic_picture_options *options) {
    asdic_plot_axis axis = asdic_canvas_level_axis(options);
    __wrap_asdic_canvas_scale(c, box, &axis, options->colormap, false);
}

void __wrap_asdic_canvas_raster(asdic_canvas *c, const asdic_raster *r, asdic_box box) {
    (void)c;
    if (raster_count < 2 && 3 * r->width * r->height <= sizeof *pixels) {
        memcpy(pixels[raster_count], r->rgb, 3 * r->width * r->height);
    }
    note(rasters, &raster_count, box,
         &(asdic_plot_axis){.low = (double)r->width, .high = (double)r->height}, false);
}

void __wrap_asdic_canvas_frame(asdic_canvas *c, asdic_box box) {
    (void)c;
    note(frames, &frame_count, box, NULL, false);
}

void __wrap_asdic_canvas_curve(asdic_canvas *c, asdic_box box, const asdic_plot_axis *x,
                               const asdic_plot_axis *y, const asdic_series *s) {
    (void)c;
    (void)y;
    (void)s;
    note(curves, &curve_count, box, x, false);
}

double __wrap_asdic_canvas_legend(asdic_canvas *c, asdic_box box, const asdic_series *s,
                                  size_t count) {
    double high = __real_asdic_canvas_legend(NULL, box, s, count);
    if (c) {
        box.h = high;
        note(legends, &legend_count, box, NULL, false);
    }
    return high;
}

void __wrap_asdic_canvas_text_fit(asdic_canvas *c, asdic_lettering where, const char *text,
                                  double room) {
    (void)c;
    (void)room;
    assert_true(word_count < MOST);
    words[word_count].at = where;
    snprintf(words[word_count++].text, sizeof words->text, "%s", text);
}

void __wrap_asdic_canvas_text(asdic_canvas *c, asdic_lettering where, const char *text) {
    __wrap_asdic_canvas_text_fit(c, where, text, NAN);
}

void __wrap_asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1) {
    (void)c;
    assert_true(line_count < MOST);
    lines[line_count++] = (struct line){x0, y0, x1, y1};
}

void __wrap_cairo_arc(cairo_t *cr, double x, double y, double radius, double low, double high) {
    (void)cr;
    assert_true(arc_count < MOST);
    arcs[arc_count++] = (struct arc){x, y, radius, low, high};
}

asdic_status __wrap_asdic_canvas_save(asdic_canvas *c, const char *path, const char *const *texts) {
    (void)path;
    (void)texts;
    page_w = c->width;
    page_h = c->height;
    return ASDIC_OK;
}

static void assert_same(const asdic_box *a, const asdic_box *b) {
    assert_true(a->x == b->x && a->y == b->y && a->w == b->w && a->h == b->h);
}

/* SCALE beside BOX, as high, on a page that has room for both and their words. */
static void assert_beside(const asdic_box *scale, const asdic_box *box) {
    double gap = scale->x - box->x - box->w;
    assert_true(gap > 15.0 && gap < 120.0);
    assert_true(scale->y == box->y && scale->h == box->h && scale->w == ASDIC_BAR_PX);
}

/* BOX leaves room for words of WIDE pixels and of some lines below, and little more than SPARE. */
static void assert_on_page(const asdic_box *box, double wide, double spare) {
    double right = page_w - box->x - box->w - wide, below = page_h - box->y - box->h;
    assert_true(box->x >= ASDIC_MARGIN_PX && box->y >= ASDIC_MARGIN_PX);
    assert_true(right >= 0.75 * ASDIC_MARGIN_PX && right < 3.0 * ASDIC_MARGIN_PX + spare);
    assert_true(below >= 3.0 * ASDIC_TEXT_PX && below < 11.0 * ASDIC_TEXT_PX);
}

static asdic_picture_options options_of(double low_db, double high_db) {
    asdic_picture_options options = asdic_picture_options_default();
    options.db_low = low_db;
    options.db_high = high_db;
    options.title = "title";
    return options;
}

static void waterfalls_share_one_box(void **state) {
    (void)state;
    const float levels_db[24] = {0.0f};
    const asdic_waterfall w = {.levels_db = levels_db,
                               .pings = 6,
                               .bins = 4,
                               .bin_length_m = 2.5,
                               .first_time_s = 10.0,
                               .ping_period_s = 0.5};
    const asdic_picture_options options = options_of(-90.0, -10.0);
    forget();
    assert_ok(ctx, asdic_picture_waterfall(ctx, "w.png", &w, &options));
    assert_true(raster_count == 1 && x_count == 1 && y_count == 1 && frame_count == 1 &&
                scale_count == 1);
    const asdic_box *box = &rasters[0].box;
    assert_true(rasters[0].axis.low == 4.0 && rasters[0].axis.high == 6.0);
    assert_same(box, &xs[0].box);
    assert_same(box, &ys[0].box);
    assert_same(box, &frames[0].box);
    assert_true(xs[0].axis.low == 0.0 && xs[0].axis.high == 10.0);
    assert_true(ys[0].axis.low == 10.0 && ys[0].axis.high == 13.0 && ys[0].down);
    assert_true(scales[0].axis.low == -90.0 && scales[0].axis.high == -10.0);
    assert_true(box->w == 1200.0 && box->h == 240.0); /* whole pixels, 40 high at most */
    assert_true(box->x >= ASDIC_MARGIN_PX + asdic_canvas_axis_y_room(&ys[0].axis, box->h));
    assert_true(box->x < ASDIC_MARGIN_PX + asdic_canvas_axis_y_room(&ys[0].axis, box->h) + 1.5);
    assert_beside(&scales[0].box, box);
    assert_on_page(&scales[0].box, asdic_canvas_color_bar_room(&options, box->h), 0.0);
}

/* 3 km east to 5 km, 1 km north to 2 km: one scale, north up. */
static void maps_lie_north_up(void **state) {
    (void)state;
    const float values[8] = {0.0f};
    const double east_m[5] = {3200.0, 4000.0, 4500.0, NAN, 4600.0},
                 north_m[5] = {1200.0, 1500.0, 1250.0, 1300.0, NAN};
    const asdic_series line = {
        .label = "way", .x = east_m, .y = north_m, .count = 5, .rgb = 0xff0000, .width = 2.0};
    const asdic_map map = {.values = values,
                           .rows = 2,
                           .columns = 4,
                           .north_m = 1000.0,
                           .east_m = 3000.0,
                           .cell_m = 500.0,
                           .label = "depth (m)",
                           .lines = &line,
                           .line_count = 1};
    const asdic_picture_options options = options_of(2.0, 30.0);
    forget();
    assert_ok(ctx, asdic_picture_map(ctx, "m.png", &map, &options));
    assert_true(raster_count == 1 && x_count == 1 && y_count == 1 && frame_count == 1 &&
                scale_count == 1);
    const asdic_box *box = &rasters[0].box;
    assert_same(box, &xs[0].box);
    assert_same(box, &ys[0].box);
    assert_same(box, &frames[0].box);
    assert_same(box, &curves[0].box);
    assert_true(box->w == 2.0 * box->h && box->w >= 600.0 && box->h >= 300.0);
    assert_true(xs[0].axis.low == 3000.0 && xs[0].axis.high == 5000.0);
    assert_true(ys[0].axis.low == 1000.0 && ys[0].axis.high == 2000.0 && !ys[0].down);
    assert_true(scales[0].axis.low == 2.0 && scales[0].axis.high == 30.0);
    assert_string_equal(scales[0].axis.label, "depth (m)");
    double left = ASDIC_MARGIN_PX + asdic_canvas_axis_y_room(&ys[0].axis, box->h);
    assert_true(box->x >= left && box->x < left + 1.5);
    double below = page_h - box->y - box->h;
    assert_true(below > 4.0 * ASDIC_TEXT_PX && below < 6.0 * ASDIC_TEXT_PX);
    assert_true(arc_count == 1); /* where the line ends, its last place that is one */
    assert_close(arcs[0].x, box->x + 0.75 * box->w, 1e-9);
    assert_close(arcs[0].y, box->y + 0.75 * box->h, 1e-9);
    assert_true(arcs[0].radius > 2.0 && arcs[0].radius < 10.0);
    assert_true(legend_count == 1 && legends[0].box.x == box->x &&
                legends[0].box.y > ASDIC_MARGIN_PX);
    assert_true(legends[0].box.y + legends[0].box.h < box->y &&
                legends[0].box.x + legends[0].box.w < page_w);
    assert_beside(&scales[0].box, box);
    assert_on_page(&scales[0].box, asdic_canvas_axis_y_room(&scales[0].axis, box->h), 10.0);
    /* Of any shape at most 1400 by 900, at least 300 each way where that allows it. */
    static const struct {
        size_t rows, columns;
        double w, h;
    } shapes[] = {{10, 10, 760, 760}, {1, 10, 1400, 140}, {4, 10, 760, 304},
                  {10, 4, 304, 760},  {10, 1, 90, 900},   {1, 1, 760, 760}};
    for (size_t i = 0; i < sizeof shapes / sizeof *shapes; i++) {
        const float many[100] = {0.0f};
        const asdic_map other = {
            .values = many, .rows = shapes[i].rows, .columns = shapes[i].columns, .cell_m = 1.0};
        forget();
        assert_ok(ctx, asdic_picture_map(ctx, "m.png", &other, &options));
        assert_close(rasters[0].box.w, shapes[i].w, 1.01);
        assert_close(rasters[0].box.h, shapes[i].h, 1.01);
        assert_true(page_w >= 700.0);
    }
}

static void panels_lie_below_each_other(void **state) {
    (void)state;
    const double x[2] = {0.0, 1.0}, y[2] = {0.0, 1.0};
    const asdic_series a[2] = {{.label = "a", .x = x, .y = y, .count = 2, .width = 1.0},
                               {.label = "b", .x = x, .y = y, .count = 2, .width = 1.0}};
    const asdic_series other = {.label = "c", .x = x, .y = y, .count = 2, .width = 1.0};
    const asdic_plot_axis along = {.label = "x", .high = 2.0}, far = {.label = "x", .high = 3.0};
    asdic_plot panels[3] = {
        {.title = "one",
         .x = along,
         .y = {.label = "y", .high = 1.0},
         .series = a,
         .series_count = 2},
        {.title = "two",
         .x = along,
         .y = {.label = "y", .high = 5e4},
         .series = a,
         .series_count = 1},
        {.title = "three", .x = along, .y = {.high = 7.0}, .series = &other, .series_count = 1}};
    const asdic_picture_options options = options_of(-1.0, 1.0);
    for (int round = 0; round < 3; round++) {
        bool is_common = round > 0, is_long = round == 2;
        size_t wide = is_common ? 0 : 1; /* the panel with the widest numbers */
        panels[1].x = is_common ? along : far;
        panels[0].y.high = is_common ? 5e4 : 1.0;
        panels[1].y.high = is_common ? 1.0 : 5e4;
        panels[2].title =
            is_long ? "three, of which so much is to be said that no legend has room beside it"
                    : "three";
        forget();
        assert_ok(ctx, asdic_picture_plot(ctx, "p.png", panels, 3, &options));
        assert_true(x_count == 3 && y_count == 3 && frame_count == 3 && curve_count == 4 &&
                    legend_count == 2);
        for (size_t i = 0; i < 3; i++) {
            const asdic_box *box = &frames[i].box;
            assert_same(box, &xs[i].box);
            assert_same(box, &ys[i].box);
            assert_same(box, &curves[i + (i > 0)].box);
            assert_true(xs[i].down && xs[i].axis.high == panels[i].x.high &&
                        ys[i].axis.high == panels[i].y.high && !ys[i].down);
            assert_true((xs[i].axis.label != NULL) ==
                        (!is_common || i == 2)); /* once, where all are the same */
            assert_true(box->x == frames[0].box.x && box->w == frames[0].box.w &&
                        box->h == frames[0].box.h);
            assert_true(box->x >=
                        ASDIC_MARGIN_PX + asdic_canvas_axis_y_room(&panels[wide].y, box->h));
            assert_true(box->x <
                        ASDIC_MARGIN_PX + asdic_canvas_axis_y_room(&panels[wide].y, box->h) + 1.5);
            assert_true(words[i].at.x == box->x && words[i].at.y < box->y &&
                        words[i].at.y > box->y - 20.0);
            assert_string_equal(words[i].text, panels[i].title);
            if (i > 0) { /* ticks, words and a title between */
                double apart = box->y - frames[i - 1].box.y - box->h, least = is_common ? 3.5 : 5.5;
                assert_true(apart > least * ASDIC_TEXT_PX &&
                            apart < (least + (is_long && i == 2 ? 4.6 : 2.6)) * ASDIC_TEXT_PX);
            }
        }
        const asdic_box *own = &legends[1].box;
        assert_true(legends[0].box.x == frames[0].box.x &&
                    legends[0].box.y + legends[0].box.h < words[0].at.y - 10.0);
        assert_true(legends[0].box.y > ASDIC_MARGIN_PX && legends[0].box.w == frames[0].box.w);
        /* Beside the title, or above one that is long. */
        double aside = own->x - frames[2].box.x, end = own->y + own->h;
        assert_true(is_long ? aside == 0.0 : aside > 50.0 && aside < 120.0);
        assert_true(end > frames[2].box.y - (is_long ? 50.0 : 20.0) &&
                    end < frames[2].box.y - (is_long ? 25.0 : 0.0));
        assert_close(own->x + own->w, frames[2].box.x + frames[2].box.w, 1e-9);
        assert_true(own->y > frames[1].box.y + frames[1].box.h && own->y < frames[2].box.y);
        assert_on_page(&frames[2].box, 0.0, 0.0);
    }
}

/* The overview's columns and rows, over levels and over ranges, and what a pixel shows. */
static void overviews_have_two_panels(void **state) {
    (void)state;
    double shown_db[6] = {-60.0, -50.0, -35.1, NAN, -20.0, 0.0},
           range_m[6] = {0.0, 4.0, 8.0, NAN, 12.0, 20.0};
    const asdic_overview o = {.pings = 2,
                              .beams = 3,
                              .bins = 10,
                              .bin_length_m = 2.0,
                              .ping_group = 1,
                              .beam_group = 1,
                              .rows = 2,
                              .columns = 3,
                              .shown_db = shown_db,
                              .range_m = range_m};
    const char *const names[] = {"port", "ahead", "starboard"};
    asdic_picture_options options = options_of(-60.0, -20.0);
    options.colormap = ASDIC_COLORMAP_GRAY;
    for (int is_named = 0; is_named < 2; is_named++) {
        const asdic_overview_axes axes = {is_named ? names : NULL, 3.0, 0.25};
        forget();
        assert_ok(ctx, asdic_draw_overview(ctx, "o.png", &o, &axes, &options));
        assert_true(raster_count == 2 && y_count == 2 && frame_count == 2 && scale_count == 2);
        assert_int_equal(x_count, is_named ? 0 : 2);
        for (size_t i = 0; i < 2; i++) {
            const asdic_box *box = &rasters[i].box;
            assert_true(rasters[i].axis.low == 3.0 && rasters[i].axis.high == 2.0);
            assert_same(box, &ys[i].box);
            assert_same(box, &frames[i].box);
            assert_true(box->w == 480.0 && box->h == 480.0 && box->y == rasters[0].box.y);
            assert_true(ys[i].axis.low == 3.0 && ys[i].axis.high == 3.5 && ys[i].down);
            assert_beside(&scales[i].box, box);
            if (!is_named) {
                assert_same(box, &xs[i].box);
                assert_true(xs[i].axis.low == -0.5 && xs[i].axis.high == 2.5);
            }
            for (size_t k = 0; is_named && k < 3; k++) {
                const struct word *word = &words[5 * i + k];
                assert_string_equal(word->text, names[k]);
                assert_close(word->at.x, box->x + 80.0 + 160.0 * (double)k, 1e-9);
                assert_true(word->at.y > box->y + 480.0 && word->at.y < box->y + 500.0 &&
                            word->at.align_x == 0.5);
            }
            const struct word *title = &words[is_named ? 5 * i + 4 : i];
            assert_string_equal(title->text,
                                i ? "range of the strongest echo" : "level of the strongest echo");
            assert_true(title->at.x == box->x && title->at.y < box->y &&
                        title->at.y > box->y - 20.0);
            if (is_named) {
                const struct word *of = &words[5 * i + 3];
                assert_string_equal(of->text, "beam");
                assert_true(of->at.x == box->x + 240.0 &&
                            of->at.y > words[5 * i].at.y + ASDIC_TEXT_PX);
            }
        }
        assert_true(scales[0].axis.low == -60.0 && scales[0].axis.high == -20.0);
        assert_true(scales[1].axis.low == 0.0 && scales[1].axis.high == 20.0);
        /* The right panel's times begin where the left scale's words end. */
        double first =
            scales[0].box.x + ASDIC_BAR_PX + asdic_canvas_axis_y_room(&scales[0].axis, 480.0);
        double begin = rasters[1].box.x - asdic_canvas_axis_y_room(&ys[1].axis, 480.0);
        assert_true(begin > first + 20.0 && begin < first + 40.0);
        assert_on_page(&scales[1].box, asdic_canvas_axis_y_room(&scales[1].axis, 480.0), 0.0);
        static const unsigned greys[2][6] = {{0, 64, 159, 0, 255, 255}, {0, 51, 102, 0, 153, 255}};
        for (size_t i = 0; i < 12; i++) {
            assert_int_equal(pixels[i / 6][3 * (i % 6)], i % 6 == 3 ? 255 : greys[i / 6][i % 6]);
        }
        assert_true(rasters[0].box.y >
                    1.5 * ASDIC_TEXT_PX + ASDIC_MARGIN_PX + asdic_canvas_title_room("title"));
        assert_contains(notes, "white: no echo 10 dB above the noise or 0.5 dB");
        assert_null(strstr(notes, "each pixel"));
    }
}

/* Beams have names while there is room for each, at most 16; groups are told of. */
static void overviews_name_what_fits(void **state) {
    (void)state;
    enum { BEAMS = 17 };
    static const struct {
        size_t beams;
        const char *name;
        bool is_named;
    } cases[] = {
        {16, "b", true}, {17, "b", false}, {4, "a name of thirty letters, or more", false}};
    double values[BEAMS] = {0.0};
    const asdic_picture_options options = options_of(-60.0, -20.0);
    for (size_t i = 0; i < 3; i++) {
        const char *names[BEAMS];
        for (size_t k = 0; k < BEAMS; k++) {
            names[k] = k + 1 < cases[i].beams ? "b" : cases[i].name; /* the last one may be long */
        }
        const asdic_overview o = {.pings = 3,
                                  .beams = cases[i].beams,
                                  .bins = 10,
                                  .bin_length_m = 2.0,
                                  .ping_group = 3,
                                  .beam_group = 1,
                                  .rows = 1,
                                  .columns = cases[i].beams,
                                  .shown_db = values,
                                  .range_m = values};
        const asdic_overview_axes axes = {.names = names};
        forget();
        assert_ok(ctx, asdic_draw_overview(ctx, "o.png", &o, &axes, &options));
        assert_int_equal(x_count, cases[i].is_named ? 0 : 2);
        assert_contains(notes, "each pixel is the strongest of 3 pings \u00d7 1 beam");
        assert_true(ys[0].axis.low == -0.5 && ys[0].axis.high == 2.5); /* by number */
    }
}

/* The point at RADIUS and BEARING from the apex of the outline. */
static void place(double radius, double bearing, double *x, double *y) {
    *x = arcs[0].x + radius * sin(bearing);
    *y = arcs[0].y - radius * cos(bearing);
}

/* 61 beams of 2 degrees to 50 m: rings each 10 m but where the last one's words are, rays each 10 degrees. */
static void fans_have_rings_and_bearings(void **state) {
    (void)state;
    enum { BEAMS = 61, BINS = 100 };
    static float levels_db[BEAMS * BINS];
    double bearing_rad[BEAMS], x, y;
    for (int i = 0; i < BEAMS; i++) {
        bearing_rad[i] = (2.0 * i - 60.0) * DEGREE;
    }
    const asdic_fan fan = {.levels_db = levels_db,
                           .bearing_rad = bearing_rad,
                           .beams = BEAMS,
                           .bins = BINS,
                           .bin_length_m = 0.5};
    const asdic_picture_options options = options_of(-90.0, -10.0);
    forget();
    assert_ok(ctx, asdic_picture_fan(ctx, "f.png", &fan, &options));
    assert_true(raster_count == 1 && scale_count == 1);
    const asdic_box *box = &rasters[0].box;
    double radius = arcs[0].radius;
    assert_true(box->w == rasters[0].axis.low && box->h == rasters[0].axis.high);
    assert_true(box->w <= 1001.0 && box->w > 990.0 && box->h <= 760.0);
    assert_close(arcs[0].x, box->x + ceil(radius * sin(61.0 * DEGREE)), 1e-9);
    assert_close(arcs[0].y, box->y + radius, 1e-9);
    assert_int_equal(arc_count, 5);
    for (size_t i = 0; i < 5; i++) {
        assert_true(arcs[i].x == arcs[0].x && arcs[i].y == arcs[0].y);
        assert_close(arcs[i].radius, i ? 0.2 * (double)i * radius : radius, 1e-9);
        assert_close(arcs[i].low, -151.0 * DEGREE, 1e-9);
        assert_close(arcs[i].high, -29.0 * DEGREE, 1e-9);
    }
    assert_int_equal(line_count, 2 + 5 + 13);
    for (size_t i = 0; i < 2; i++) { /* the edges */
        place(radius, i ? 61.0 * DEGREE : -61.0 * DEGREE, &x, &y);
        assert_true(lines[i].x0 == arcs[0].x && lines[i].y0 == arcs[0].y);
        assert_close(lines[i].x1, x, 1e-9);
        assert_close(lines[i].y1, y, 1e-9);
    }
    static const char *const rings[] = {"10", "20", "30", "40", "50 m"};
    for (size_t i = 0; i < 5; i++) { /* aside of the starboard edge */
        const struct line *l = &lines[2 + i];
        const asdic_lettering *at = &words[i].at;
        place(0.2 * (double)(i + 1) * radius, 61.0 * DEGREE, &x, &y);
        assert_string_equal(words[i].text, rings[i]);
        assert_close(l->x0, x, 1e-9);
        assert_close(l->y0, y, 1e-9);
        double out_x = cos(61.0 * DEGREE), out_y = sin(61.0 * DEGREE);
        double tick = (l->x1 - x) * out_x + (l->y1 - y) * out_y,
               gap = (at->x - x) * out_x + (at->y - y) * out_y;
        assert_close((l->x1 - x) * out_y - (l->y1 - y) * out_x, 0.0, 1e-9);
        assert_close((at->x - x) * out_y - (at->y - y) * out_x, 0.0, 1e-9);
        assert_true(tick > 5.0 && tick < 9.0 && gap > tick + 3.0 && gap < tick + 8.0);
        assert_true(at->align_x == 0.0);
        assert_close(at->align_y, 0.5 + 0.5 * out_y, 1e-9);
    }
    for (size_t i = 0; i < 13; i++) { /* outside the arc */
        const struct line *l = &lines[7 + i];
        const asdic_lettering *at = &words[5 + i].at;
        double angle = (10.0 * (double)i - 60.0) * DEGREE;
        char text[16];
        snprintf(text, sizeof text, "%s%d\u00b0", i < 6 ? "\u2212" : "", abs(10 * (int)i - 60));
        assert_string_equal(words[5 + i].text, text);
        place(radius, angle, &x, &y);
        assert_close(l->x0, x, 1e-9);
        assert_close(l->y0, y, 1e-9);
        double tick = hypot(l->x1 - arcs[0].x, l->y1 - arcs[0].y) - radius;
        double gap = hypot(at->x - arcs[0].x, at->y - arcs[0].y) - radius;
        assert_close(atan2(l->x1 - arcs[0].x, arcs[0].y - l->y1), angle, 1e-9);
        assert_close(atan2(at->x - arcs[0].x, arcs[0].y - at->y), angle, 1e-9);
        assert_true(tick > 6.0 && tick < 10.0 && gap > tick + 3.0 && gap < tick + 9.0);
        assert_close(at->align_x, 0.5 - 0.5 * sin(angle), 1e-9);
        assert_close(at->align_y, 0.5 - 0.5 * cos(angle), 1e-9);
    }
    assert_beside(&scales[0].box, box);
    assert_true(page_w >
                scales[0].box.x + scales[0].box.w + asdic_canvas_color_bar_room(&options, box->h));
    assert_true(page_h > box->y + box->h + 40.0 && box->x > 60.0 && box->y > 60.0);
}

/* Of 44 m the words of 40 m would touch those of the last ring; of 46 m they do not. */
static void rings_leave_room_for_the_last(void **state) {
    (void)state;
    enum { BEAMS = 3, BINS = 92 };
    static float levels_db[BEAMS * BINS];
    const double bearing_rad[BEAMS] = {-40.0 * DEGREE, 0.0, 40.0 * DEGREE};
    const asdic_picture_options options = options_of(-90.0, -10.0);
    for (size_t bins = 88; bins <= BINS; bins += 4) {
        const asdic_fan fan = {.levels_db = levels_db,
                               .bearing_rad = bearing_rad,
                               .beams = BEAMS,
                               .bins = bins,
                               .bin_length_m = 0.5};
        forget();
        assert_ok(ctx, asdic_picture_fan(ctx, "f.png", &fan, &options));
        assert_int_equal(arc_count, bins == 88 ? 4 : 5);
    }
}

/* Words stand outside an edge wherever it points: to the right of one ahead, below one abeam, to the left of one astern.
 * A section's bearings are angles below the level. */
static void words_stand_outside_the_edge(void **state) {
    (void)state;
    enum { BEAMS = 3, BINS = 40 };
    static float levels_db[BEAMS * BINS];
    static const struct {
        double yaw_deg, align_x;
    } cases[] = {{40.0, 0.0}, {60.0, 0.5}, {90.0, 1.0}};
    const asdic_picture_options options = options_of(-90.0, -10.0);
    for (size_t i = 0; i < 3; i++) {
        const double yaw = cases[i].yaw_deg * DEGREE, bearing_rad[BEAMS] = {-yaw, 0.0, yaw};
        asdic_fan fan = {.levels_db = levels_db,
                         .bearing_rad = bearing_rad,
                         .beams = BEAMS,
                         .bins = BINS,
                         .bin_length_m = 0.5};
        forget();
        assert_ok(ctx, asdic_picture_fan(ctx, "f.png", &fan, &options));
        assert_true(words[0].at.align_x == cases[i].align_x);
        assert_close(words[0].at.align_y, 0.5 + 0.5 * sin(1.5 * yaw), 1e-9);
        const double down_rad[BEAMS] = {ASDIC_PI - yaw, ASDIC_PI, ASDIC_PI + yaw};
        fan.bearing_rad = down_rad;
        fan.is_section = true;
        forget();
        assert_ok(ctx, asdic_picture_fan(ctx, "f.png", &fan, &options));
        size_t straight = 0;
        for (size_t k = 0; k < word_count; k++) {
            straight +=
                strcmp(words[k].text, "90\u00b0") == 0 && fabs(words[k].at.x - arcs[0].x) < 1e-6;
        }
        assert_int_equal(straight, 1);
    }
}

/* All round: no edges, ranges astern, -180 degrees once, and 74.5 m to its digit. */
static void circles_are_labelled_astern(void **state) {
    (void)state;
    enum { BEAMS = 8, BINS = 149 };
    static float levels_db[BEAMS * BINS];
    double bearing_rad[BEAMS];
    for (int i = 0; i < BEAMS; i++) {
        bearing_rad[i] = (45.0 * i - 157.5) * DEGREE;
    }
    const asdic_fan fan = {.levels_db = levels_db,
                           .bearing_rad = bearing_rad,
                           .beams = BEAMS,
                           .bins = BINS,
                           .bin_length_m = 0.5};
    const asdic_picture_options options = options_of(-90.0, -10.0);
    forget();
    assert_ok(ctx, asdic_picture_fan(ctx, "f.png", &fan, &options));
    const asdic_box *box = &rasters[0].box;
    double radius = arcs[0].radius;
    assert_true(radius == 380.0 && box->w == 760.0 && box->h == 760.0);
    assert_true(arcs[0].x == box->x + 380.0 && arcs[0].y == box->y + 380.0);
    static const char *const rings[] = {"20", "40", "60", "74.5 m"};
    assert_int_equal(arc_count, 4);
    for (size_t i = 0; i < 4; i++) {
        double far = i < 3 ? 20.0 * (double)(i + 1) / 74.5 * radius : radius;
        const asdic_box *plate = &rectangles[i];
        assert_close(plate->x + 0.5 * plate->w, words[i].at.x, 1e-9);
        assert_close(plate->y + 0.5 * plate->h, words[i].at.y, 1e-9);
        assert_true(plate->w > asdic_canvas_text_width(rings[i], ASDIC_TEXT_PX) &&
                    plate->h > ASDIC_TEXT_PX);
        assert_true(plate->w < asdic_canvas_text_width(rings[i], ASDIC_TEXT_PX) + 20.0 &&
                    plate->h < 30.0);
        assert_string_equal(words[i].text, rings[i]);
        assert_true(words[i].at.x == arcs[0].x && words[i].at.align_x == 0.5 &&
                    words[i].at.align_y == 0.5);
        if (i < 3) {
            assert_close(words[i].at.y, arcs[0].y + far, 1e-9);
            assert_close(arcs[i + 1].radius, far, 1e-9);
        } else { /* inside the circle */
            assert_true(words[i].at.y < arcs[0].y + far - 10.0 &&
                        words[i].at.y > arcs[0].y + far - 20.0);
        }
    }
    assert_true(line_count == word_count - 4 && line_count >= 8);
    size_t astern = 0;
    for (size_t i = 0; i < line_count; i++) {
        astern += lines[i].y0 > arcs[0].y + radius - 1.0;
    }
    assert_int_equal(astern, 1);
    assert_string_equal(words[4].text, "180\u00b0");
}

/* A square of SIZE_M about a place. */
static asdic_outline square(const char *name, double north_m, double east_m, double size_m) {
    asdic_outline o = {.count = 4};
    snprintf(o.name, sizeof o.name, "%s", name);
    for (size_t k = 0; k < 4; k++) {
        o.north_m[k] = north_m + (k < 2 ? 0.5 : -0.5) * size_m;
        o.east_m[k] = east_m + (k % 3 ? 0.5 : -0.5) * size_m;
    }
    return o;
}

static asdic_box box_of(const struct word *name) {
    return (asdic_box){name->at.x - 3.0, name->at.y - 10.0,
                       asdic_canvas_text_width(name->text, ASDIC_NOTE_PX) + 6.0, 20.0};
}

/* A track of 100 m to the east, a big object, one too small to be seen otherwise than as a dot, seven at one place. */
static void charts_show_places_and_names(void **state) {
    (void)state;
    enum { PILE = 7 };
    const double north_m[2] = {0.0, 0.0}, east_m[2] = {0.0, 100.0};
    const asdic_relief nothing = {0};
    asdic_outline outlines[2 + PILE];
    asdic_chart chart = {.relief = &nothing,
                         .outlines = outlines,
                         .outline_count = 2 + PILE,
                         .north_m = north_m,
                         .east_m = east_m,
                         .track_count = 2,
                         .first_time_s = 3.0,
                         .last_time_s = 53.5};
    const asdic_picture_options options = options_of(-1.0, 1.0);
    double px_per_m = 8.0;
    for (int round = 0; round < 4; round++) { /* the first tells the scale */
        double dot_m = (round % 2 ? 5.1 : 4.9) / px_per_m;
        outlines[0] = square("big", 12.0, 40.0, 10.0);
        outlines[1] = square("dot", -12.0, 20.0, dot_m);
        for (size_t i = 0; i < PILE; i++) {
            char name[32];
            snprintf(name, sizeof name, "pile of stones %zu", i);
            outlines[2 + i] = square(name, -10.0, 60.0, 1.5);
        }
        forget();
        assert_ok(ctx, asdic_draw_chart(ctx, "c.png", &chart, &options));
        assert_true(x_count == 1 && y_count == 1 && frame_count == 1 && scale_count == 0 &&
                    legend_count == 1);
        const asdic_box *box = &frames[0].box;
        const asdic_plot_axis *x = &xs[0].axis, *y = &ys[0].axis;
        assert_same(box, &xs[0].box);
        assert_same(box, &ys[0].box);
        px_per_m = box->w / (x->high - x->low);
        assert_close(box->h / (y->high - y->low), px_per_m, 0.03);
        assert_true(x->low < -5.0 && x->high > 105.0 && y->low < -17.0 && y->high > 22.0 &&
                    !ys[0].down);
        assert_true(x->low > -12.0 && x->high < 112.0);
        assert_true(box->w <= 1100.0 && box->h >= 320.0);
        if (round < 2) {
            continue;
        }
        double at_x = 0.0, at_y = box->y + box->h * (1.0 - (0.0 - y->low) / (y->high - y->low));
        assert_int_equal(arc_count, round % 2 ? 1 : 2);
        if (round % 2 == 0) { /* the dot */
            assert_close(arcs[0].x, box->x + (20.0 - x->low) * px_per_m, 0.1);
            assert_close(arcs[0].y, at_y + 12.0 * px_per_m, 0.5);
            assert_true(arcs[0].radius > 2.0 && arcs[0].radius < 3.0);
        }
        const struct arc *start = &arcs[arc_count - 1];
        assert_close(start->x, box->x + (0.0 - x->low) * px_per_m, 0.1);
        assert_close(start->y, at_y, 0.5);
        /* A scale at the bottom left: its length is what it says. */
        double length_m = strtod(words[0].text, NULL);
        assert_true(line_count == 3 && strstr(words[0].text, " m"));
        assert_close(lines[0].x1 - lines[0].x0, length_m * px_per_m, 0.1);
        assert_true(length_m == 20.0 || length_m == 50.0);
        assert_true(lines[0].y0 == lines[0].y1 && lines[0].x0 < box->x + 40.0 &&
                    lines[0].y0 > box->y + box->h - 40.0);
        for (size_t i = 1; i < 3; i++) { /* its ends */
            assert_true(lines[i].x0 == (i < 2 ? lines[0].x0 : lines[0].x1) &&
                        lines[i].x1 == lines[i].x0);
            assert_close(lines[i].y0 + lines[i].y1, 2.0 * lines[0].y0, 1e-9);
        }
        assert_close(words[0].at.x, 0.5 * (lines[0].x0 + lines[0].x1), 1e-9);
        assert_true(words[0].at.y < lines[0].y0 - 5.0 && words[0].at.y > lines[0].y0 - 15.0);
        /* North at the top right, in the middle of its plate. */
        const asdic_box *plates = rectangles + 2; /* behind the map and its clip */
        assert_string_equal(words[1].text, "N");
        assert_true(words[1].at.x > box->x + box->w - 50.0 && words[1].at.y < box->y + 50.0);
        assert_close(plates[1].x + 0.5 * plates[1].w, words[1].at.x, 1e-9);
        assert_true(plates[1].y > box->y && plates[1].y < words[1].at.y - 10.0);
        assert_true(plates[1].y + plates[1].h > words[1].at.y + 40.0 &&
                    plates[1].x + plates[1].w < box->x + box->w);
        assert_true(plates[0].x < lines[0].x0 && plates[0].x + plates[0].w > lines[0].x1 &&
                    plates[0].x > box->x);
        assert_true(plates[0].y < words[0].at.y - 10.0 && plates[0].y + plates[0].h > lines[0].y0);
        assert_true(plates[0].y + plates[0].h < box->y + box->h);
        static const char *const names[] = {"start, 3 s", "end, 53.5 s", "big", "dot"};
        static const double places_m[][2] = {
            {0.0, 0.0}, {0.0, 100.0}, {12.0, 40.0}, {-12.0, 20.0}, {-10.0, 60.0}};
        assert_int_equal(word_count, 6 + PILE);
        for (size_t i = 0; i < 4 + PILE; i++) {
            const struct word *name = &words[2 + i];
            asdic_box own = box_of(name);
            size_t of = i < 4 ? i : 4;
            at_x = box->x + (places_m[of][1] - x->low) * px_per_m;
            at_y = box->y + box->h - (places_m[of][0] - y->low) * px_per_m;
            if (i < 4) {
                assert_string_equal(name->text, names[i]);
            }
            assert_true(own.x > box->x && own.x + own.w < box->x + box->w && own.y > box->y &&
                        own.y + own.h < box->y + box->h);
            /* Beside its place, not on it; of the pile farther and farther off. */
            double off_x = fmax(fmax(own.x - at_x, at_x - own.x - own.w), 0.0);
            double off_y = fmax(fmax(own.y - at_y, at_y - own.y - own.h), 0.0);
            double off = fmax(off_x, off_y), half_px = i == 2  ? 5.0 * px_per_m
                                                       : i > 3 ? 0.75 * px_per_m
                                                               : 2.5;
            assert_true(i == 2 ? off > 8.0 && off + own.w < half_px /* on what is large */
                               : off > half_px && off < half_px + (i < 5 ? 20.0 : 80.0));
            assert_same(&own, &plates[2 + i]);
            for (size_t k = 0; k < 2 + i; k++) {
                const asdic_box *other = &plates[k];
                assert_true(own.x >= other->x + other->w || other->x >= own.x + own.w ||
                            own.y >= other->y + other->h || other->y >= own.y + own.h);
            }
        }
        assert_true(legends[0].box.x == box->x && legends[0].box.y + legends[0].box.h < box->y);
        assert_on_page(box, 0.0, 40.0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(waterfalls_share_one_box),
        cmocka_unit_test(maps_lie_north_up),
        cmocka_unit_test(panels_lie_below_each_other),
        cmocka_unit_test(overviews_have_two_panels),
        cmocka_unit_test(overviews_name_what_fits),
        cmocka_unit_test(rings_leave_room_for_the_last),
        cmocka_unit_test(words_stand_outside_the_edge),
        cmocka_unit_test(charts_show_places_and_names),
        cmocka_unit_test(fans_have_rings_and_bearings),
        cmocka_unit_test(circles_are_labelled_astern),
    };
    return cmocka_run_group_tests(tests, context_begin, context_end);
}
