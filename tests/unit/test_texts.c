/*
 * No two texts of a picture lie on each other, none leaves the page, and all can be read. Every text of a picture
 * passes cairo_show_text, which this program takes the place of: it notes where the text would be.
 */
#include "asserts.h"
#include "test_device.h"

#include "base/number.h"
#include "lib/out/draw_chart_page.h"
#include "lib/out/overview.h"

#include <asdic/asdic.h>

#include <cairo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_TEXTS 600
#define TOUCH_PX 1.0 /* two boxes may share so much */

static test_device t;
static char path[] = "/tmp/asdic-texts-XXXXXX.png";

/* The ink of a text on its page. */
static struct box {
    char text[160];
    double left, right, top, bottom, page_w, page_h;
} boxes[MOST_TEXTS];
static size_t box_count;

static void take_in(struct box *b, cairo_t *cr, double x, double y) {
    cairo_user_to_device(cr, &x, &y);
    b->left = fmin(b->left, x);
    b->right = fmax(b->right, x);
    b->top = fmin(b->top, y);
    b->bottom = fmax(b->bottom, y);
}

/* Whole characters of UTF-8, none of which controls anything: it would be drawn as an empty box. */
static void assert_readable(const char *text) {
    size_t length = strlen(text), size;
    for (size_t at = 0; at < length; at += size) {
        size = asdic_utf8_character(text + at, length - at);
        if (size == 0 || (unsigned char)text[at] < 0x20 || text[at] == 0x7f) {
            fail_msg("'%s' has the byte 0x%02x", text, (unsigned char)text[at]);
        }
    }
}

void cairo_show_text(cairo_t *cr, const char *text) {
    cairo_text_extents_t e;
    cairo_surface_t *page = cairo_get_target(cr);
    double x, y;
    assert_readable(text);
    cairo_get_current_point(cr, &x, &y);
    cairo_text_extents(cr, text, &e);
    assert_true(box_count < MOST_TEXTS);
    if (e.width <= 0.0) {
        return;
    }
    struct box *b = &boxes[box_count++];
    *b = (struct box){.left = INFINITY,
                      .right = -INFINITY,
                      .top = INFINITY,
                      .bottom = -INFINITY,
                      .page_w = cairo_image_surface_get_width(page),
                      .page_h = cairo_image_surface_get_height(page)};
    snprintf(b->text, sizeof b->text, "%s", text);
    for (int corner = 0; corner < 4; corner++) {
        take_in(b, cr, x + e.x_bearing + (corner & 1 ? e.width : 0.0),
                y + e.y_bearing + (corner & 2 ? e.height : 0.0));
    }
}

static bool meet(const struct box *a, const struct box *b) {
    return a->left < b->right - TOUCH_PX && b->left < a->right - TOUCH_PX &&
           a->top < b->bottom - TOUCH_PX && b->top < a->bottom - TOUCH_PX;
}

/* Of the texts since the last call, at least LEAST. */
static void assert_legible(const char *what, size_t least) {
    size_t bad = 0;
    for (size_t i = 0; i < box_count; i++) {
        const struct box *a = &boxes[i];
        if (a->left < 0.0 || a->top < 0.0 || a->right > a->page_w || a->bottom > a->page_h) {
            print_error("%s: '%s' leaves the page\n", what, a->text);
            bad++;
        }
        for (size_t k = 0; k < i; k++) {
            if (meet(a, &boxes[k])) {
                print_error("%s: '%s' lies on '%s'\n", what, a->text, boxes[k].text);
                bad++;
            }
        }
    }
    size_t count = box_count;
    box_count = 0;
    assert_int_equal(bad, 0);
    assert_true(count >= least);
}

static size_t times_written(const char *text) {
    size_t times = 0;
    for (size_t i = 0; i < box_count; i++) {
        times += strcmp(boxes[i].text, text) == 0;
    }
    return times;
}

static void assert_written(const char *text) {
    if (times_written(text) == 0) {
        fail_msg("'%s' is missing", text);
    }
}

/* TEXT, which is written once. */
static const struct box *only(const char *text) {
    size_t i = 0;
    assert_int_equal(times_written(text), 1);
    while (strcmp(boxes[i].text, text) != 0) {
        i++;
    }
    return &boxes[i];
}

static double middle_of(const char *text) {
    return 0.5 * (only(text)->left + only(text)->right);
}

/* With all that a run's pictures say. */
static asdic_picture_options options_of(const char *title) {
    static char heading[512];
    asdic_picture_options o = asdic_picture_options_default();
    snprintf(heading, sizeof heading,
             "%s\n1000 kHz, bandwidth 186.5 kHz  \u00b7  bins of 0.025 m  \u00b7  source level "
             "200.5 dB re 1 \u00b5Pa at 1 m",
             title);
    o.title = heading;
    o.note = "524,288 rays a ping, uniform-sphere sampling, seed 18446744073709551615  \u00b7  "
             "stated error 2.7 dB r.m.s.: take more rays";
    o.tvg_db_per_decade = 40.0;
    o.tvg_db_per_m = 0.4446;
    return o;
}

static void fans(void **state) {
    (void)state;
    enum { BEAMS = 41, BINS = 20 };
    static const double sectors_deg[] = {360, 270, 180, 130, 60, 20, 4};
    static const struct {
        double bin_length_m;
        const char *range;
    } ranges[] = {{0.01, "0.2 m"},   {0.0185, "0.37 m"}, {2.66, "53.2 m"},
                  {3.725, "74.5 m"}, {25, "500 m"},      {617.25, "12345 m"}};
    static float levels_db[BEAMS * BINS];
    double bearing_rad[BEAMS];
    asdic_picture_options options = options_of("fan");
    for (size_t s = 0; s < sizeof sectors_deg / sizeof *sectors_deg; s++) {
        for (size_t k = 0; k < sizeof ranges / sizeof *ranges; k++) {
            /* A full circle has its first direction twice. */
            double beams = sectors_deg[s] == 360 ? BEAMS - 1 : BEAMS;
            for (size_t i = 0; i < BEAMS; i++) {
                bearing_rad[i] = sectors_deg[s] * ((double)i / beams - 0.5) * acos(-1.0) / 180.0;
            }
            asdic_fan fan = {.levels_db = levels_db,
                             .bearing_rad = bearing_rad,
                             .beams = BEAMS,
                             .bins = BINS,
                             .bin_length_m = ranges[k].bin_length_m};
            char what[64];
            snprintf(what, sizeof what, "fan of %g degrees", sectors_deg[s]);
            assert_ok(t.ctx, asdic_picture_fan(t.ctx, path, &fan, &options));
            assert_written(ranges[k].range);
            assert_legible(what, 10);
        }
    }
}

static void waterfalls(void **state) {
    (void)state;
    static const size_t sizes[][2] = {{2, 7}, {3, 2000}, {1001, 10}, {600, 592}};
    asdic_picture_options options =
        options_of("a_rather_long_name_of_a_scene: beam \u2018forward\u2019");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        float *levels_db = calloc(sizes[i][0] * sizes[i][1], sizeof *levels_db);
        asdic_waterfall w = {.levels_db = levels_db,
                             .pings = sizes[i][0],
                             .bins = sizes[i][1],
                             .bin_length_m = 0.25,
                             .first_time_s = 1000.0,
                             .ping_period_s = 0.2};
        assert_ok(t.ctx, asdic_picture_waterfall(t.ctx, path, &w, &options));
        if (sizes[i][0] == 1001) { /* drawn as means of pings: to 1200.2 s all the same */
            assert_written("1200");
        }
        if (sizes[i][1] == 2000) { /* as means of two bins, a pixel each: to 500 m all the same */
            assert_close(middle_of("500") - middle_of("100"), 800.0, 3.0);
        }
        assert_legible("waterfall", 10);
        free(levels_db);
    }
}

static void overviews(void **state) {
    (void)state;
    static const size_t sizes[][2] = {{2, 1}, {60, 3}, {1001, 5}, {9, 12}, {40, 1200}};
    static const char *const names[] = {"starboard_a", "starboard_b", "starboard_c", "d",
                                        "e",           "beam5",       "beam6",       "beam7",
                                        "beam8",       "beam9",       "beam10",      "beam11"};
    const asdic_overview_axes axes = {.names = names, .ping_period_s = 0.2};
    asdic_picture_options options = options_of("overview");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        float *levels_db = calloc(10 * sizes[i][1], sizeof *levels_db);
        asdic_overview o;
        assert_ok(t.ctx, asdic_overview_init(t.ctx, sizes[i][0], sizes[i][1], 10, 5.0, &o));
        for (size_t ping = 0; ping < sizes[i][0]; ping++) {
            asdic_overview_add(&o, levels_db, levels_db, levels_db);
        }
        assert_ok(t.ctx, asdic_draw_overview(t.ctx, path, &o, &axes, &options));
        assert_int_equal(times_written("starboard_a"), sizes[i][1] <= 5 ? 2 : 0);
        if (sizes[i][0] == 1001) { /* two pings a row: to 200.4 s all the same */
            assert_int_equal(times_written("200"), 2);
        }
        if (sizes[i][1] == 1200) { /* two beams a column */
            assert_int_equal(times_written("1000"), 2);
        }
        assert_legible("overview", 10);
        asdic_overview_finish(&o);
        free(levels_db);
    }
}

/* Of the curves that are of some beams alone, and no others. */
static void ascopes_name_the_curves_that_they_have(void **state) {
    (void)state;
    static const char *const names[] = {"noise",     "volume", "surface",        "bottom",
                                        "multipath", "object", "expected total", "simulated"};
    enum { CURVES = sizeof names / sizeof *names };
    const float levels_db[] = {-100, -110, -105};
    asdic_picture_options options = options_of("scene: ping 0");
    for (size_t k = 0; k < CURVES; k++) {
        const float *of[CURVES] = {[CURVES - 1] = levels_db};
        asdic_ascope beams[2];
        for (size_t i = 0; i < 2; i++) {
            of[k] = i == 1 || k == CURVES - 1 ? levels_db : NULL;
            beams[i] = (asdic_ascope){.title = "beam",
                                      .bins = 3,
                                      .bin_length_m = 0.5,
                                      .noise_db = of[0],
                                      .volume_db = of[1],
                                      .surface_db = of[2],
                                      .bottom_db = of[3],
                                      .multipath_db = of[4],
                                      .object_db = of[5],
                                      .total_db = of[6],
                                      .simulated_db = of[7]};
        }
        assert_ok(t.ctx, asdic_picture_ascope(t.ctx, path, beams, 2, &options));
        for (size_t i = 0; i < CURVES; i++) {
            assert_int_equal(times_written(names[i]), i == k || i == CURVES - 1);
        }
        box_count = 0;
    }
}

static void ascopes(void **state) {
    (void)state;
    enum { BINS = 50 };
    float levels_db[BINS];
    asdic_ascope beams[8];
    asdic_picture_options options = options_of("scene: ping 1000, t = 100.025 s, 4 of 512 beams");
    for (int i = 0; i < BINS; i++) {
        levels_db[i] = (float)(-100 - i);
    }
    for (size_t i = 0; i < 8; i++) {
        beams[i] = (asdic_ascope){.title = "beam \u2018a_rather_long_name\u2019",
                                  .bins = BINS,
                                  .bin_length_m = 0.5,
                                  .simulated_db = levels_db,
                                  .total_db = levels_db,
                                  .bottom_db = levels_db,
                                  .surface_db = levels_db,
                                  .volume_db = levels_db,
                                  .noise_db = levels_db,
                                  .object_db = levels_db};
    }
    for (size_t count = 1; count <= 8; count++) {
        assert_ok(t.ctx, asdic_picture_ascope(t.ctx, path, beams, count, &options));
        assert_int_equal(times_written("range (m)"), 1);
        for (size_t i = 0; i < box_count;
             i++) { /* whatever its rows, a legend is above its panel */
            bool is_name = strcmp(boxes[i].text, beams[0].title) == 0;
            assert_true(!is_name || boxes[i].bottom < only("0.4")->top);
        }
        assert_legible("A-scope", 15);
    }
}

/* Panels share the label of their abscissa where it is one and the same. */
static void abscissas_are_labelled(void **state) {
    (void)state;
    const asdic_plot_axis level = {.label = "level (dB)", .high = 1};
    const asdic_plot_axis ends[] = {
        {.label = "range (m)", .low = 1, .high = 10},
        {.label = "range (m)", .low = 1, .high = 20},
        {.label = "range (m)", .low = 2, .high = 10},
        {.label = "range (m)", .low = 1, .high = 10, .logarithmic = true}};
    const double at[] = {3, 4};
    const asdic_series line = {.label = "line", .x = at, .y = at, .count = 2, .width = 1};
    asdic_picture_options options = options_of("plot");
    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        const asdic_plot panels[] = {
            {.x = ends[0], .y = level, .series = &line, .series_count = 1},
            {.x = ends[i], .y = level, .series = &line, .series_count = 1}};
        assert_ok(t.ctx, asdic_picture_plot(t.ctx, path, panels, 2, &options));
        assert_int_equal(times_written("range (m)"), i == 0 ? 1 : 2);
        assert_legible("plot", 10);
    }
}

/* A panel's curves are named in the first one's legend, or in its own where that does not name them. */
static void curves_are_named_once(void **state) {
    (void)state;
    static const struct {
        const char *first, *second;
        size_t firsts, others;
    } cases[] = {{"line", "line", 1, 0},
                 {"line", "other", 1, 1},
                 {"line", NULL, 1, 0},
                 {NULL, "other", 0, 1}};
    const double at[] = {3, 4};
    const asdic_plot_axis axis = {.label = "range (m)", .low = 1, .high = 10};
    asdic_picture_options options = options_of("plot");
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const asdic_series lines[] = {
            {.label = cases[i].first, .x = at, .y = at, .count = 2, .width = 1},
            {.label = cases[i].second, .x = at, .y = at, .count = 2, .width = 1}};
        const asdic_plot panels[] = {
            {.x = axis, .y = axis, .series = lines, .series_count = 1},
            {.x = axis, .y = axis, .series = lines + 1, .series_count = 1}};
        box_count = 0;
        assert_ok(t.ctx, asdic_picture_plot(t.ctx, path, panels, 2, &options));
        assert_int_equal(times_written("line"), cases[i].firsts);
        assert_int_equal(times_written("other"), cases[i].others);
        assert_legible("plot", 8);
    }
}

/* The longest names that objects, beams and variants may have, in every legend and title. */
static void long_names_stay_on_the_page(void **state) {
    (void)state;
    enum { COLUMNS = 8, ROWS = 40 };
    static float db[COLUMNS * ROWS];
    char name[ASDIC_NAME_SIZE], title[ASDIC_NAME_SIZE + 16];
    snprintf(name, sizeof name, "%s",
             "Wreck_of_the_Norwegian_MOUNTAIN_QUEEN_amidships_port_side_stern");
    assert_int_equal(strlen(name), ASDIC_NAME_SIZE - 1);
    snprintf(title, sizeof title, "beam \u2018%s\u2019", name);
    const asdic_plot_axis axis = {.label = "range (m)", .low = 1, .high = 10};
    const double at[] = {3, 4};
    const asdic_series lines[] = {{.label = name, .x = at, .y = at, .count = 2, .width = 1},
                                  {.label = "short", .x = at, .y = at, .count = 2, .width = 1}};
    asdic_picture_options options = options_of("long names");
    const asdic_plot panels[] = {
        {.title = title, .x = axis, .y = axis, .series = lines, .series_count = 2},
        {.title = title, .x = axis, .y = axis, .series = lines + 1, .series_count = 1}};
    for (size_t count = 1; count <= 2; count++) {
        assert_ok(t.ctx, asdic_picture_plot(t.ctx, path, panels, count, &options));
        assert_legible("plot", 10);
    }
    const asdic_map map = {.columns = COLUMNS,
                           .rows = ROWS,
                           .cell_m = 1.0,
                           .values = db,
                           .label = "level (dB)",
                           .lines = lines,
                           .line_count = 2};
    options.db_low = -10.0;
    options.db_high = 10.0;
    assert_ok(t.ctx, asdic_picture_map(t.ctx, path, &map, &options));
    assert_legible("map", 10);
    const asdic_ascope beam = {.title = title,
                               .bins = ROWS,
                               .bin_length_m = 0.5,
                               .simulated_db = db,
                               .total_db = db,
                               .object_db = db};
    const asdic_ascope beams[] = {beam, beam, beam};
    for (size_t count = 1; count <= 3; count++) {
        assert_ok(t.ctx, asdic_picture_ascope(t.ctx, path, beams, count, &options));
        assert_legible("A-scope", 10);
    }
}

/* Names below an axis keep their size where each has room, and get smaller where they have not. */
static void names_share_an_abscissa(void **state) {
    (void)state;
    static const char *const names[] = {"a_design_of_some_width", "b_design_of_some_width",
                                        "c_design_of_some_width", "d_design_of_some_width",
                                        "e_design_of_some_width", "f_design_of_some_width",
                                        "g_design_of_some_width"};
    const double at[] = {1, 2};
    const asdic_series line = {.label = "line", .x = at, .y = at, .count = 2, .width = 1};
    asdic_picture_options options = options_of("plot");
    double wide_px = 0.0;
    for (size_t count = 2; count <= 7; count++) {
        const asdic_plot panel = {
            .x = {.low = 0.5, .high = (double)count + 0.5, .names = names, .name_count = count},
            .y = {.label = "level (dB)", .high = 2},
            .series = &line,
            .series_count = 1};
        box_count = 0;
        assert_ok(t.ctx, asdic_picture_plot(t.ctx, path, &panel, 1, &options));
        assert_close(middle_of(names[1]) - middle_of(names[0]), 1040.0 / (double)count, 2.0);
        double px = only(names[0])->right - only(names[0])->left;
        double room_px = 1040.0 / (double)count - 5.0; /* apart from the next */
        wide_px = count == 2 ? px : wide_px;
        assert_true(px < room_px + 1.0);
        if (wide_px + 2.0 < room_px) {
            assert_true(px == wide_px);
        } else {
            assert_true(px > 0.88 * room_px); /* sizes are whole pixels */
        }
        assert_legible("plot", 5);
    }
}

/* The frames of a video are of one size, whether an object is in view or not. */
static void ascopes_are_of_one_height(void **state) {
    (void)state;
    const float levels_db[2] = {-100, -90}, none_db[2] = {-INFINITY, -INFINITY};
    asdic_picture_options options = options_of("scene: ping 1, t = 0.1 s");
    double height = 0.0;
    for (int has_object = 0; has_object < 2; has_object++) {
        asdic_ascope beam = {.title = "beam \u2018forward\u2019",
                             .bins = 2,
                             .bin_length_m = 0.5,
                             .simulated_db = levels_db,
                             .total_db = levels_db,
                             .bottom_db = levels_db,
                             .surface_db = levels_db,
                             .volume_db = levels_db,
                             .noise_db = levels_db,
                             .object_db = has_object ? levels_db : none_db};
        box_count = 0;
        assert_ok(t.ctx, asdic_picture_ascope(t.ctx, path, &beam, 1, &options));
        assert_true(box_count > 0);
        assert_true(!has_object || boxes[0].page_h == height);
        height = boxes[0].page_h;
        box_count = 0;
    }
}

static void plans(void **state) {
    (void)state;
    /* Four piles 10 m apart beside the beginning of a track that is long or short. */
    static const asdic_relief no_relief;
    enum { SIDE = 61 };
    static float depth_m[SIDE * SIDE]; /* around the beginning */
    const asdic_relief relief = {.columns = SIDE,
                                 .rows = SIDE,
                                 .west_m = -205,
                                 .south_m = -205,
                                 .cell_m = 10,
                                 .depth_m = depth_m};
    const double lengths_m[] = {0, 4, 100, 400};
    asdic_outline piles[5] = {0};
    asdic_picture_options options = options_of("plan");
    piles[4].count = 1; /* far off the map, of the same name as the first on it */
    piles[4].north_m[0] = 1e4;
    for (size_t i = 0; i < 4; i++) {
        piles[i].count = 4;
        for (size_t k = 0; k < 4; k++) {
            piles[i].north_m[k] = 2.0 - 10.0 * (double)(i / 2) + (k < 2 ? 0.2 : -0.2);
            piles[i].east_m[k] = 12.0 + 10.0 * (double)(i % 2) + (k % 3 ? 0.2 : -0.2);
        }
        snprintf(piles[i].name, sizeof piles[i].name, "pile_number_%zu", i);
    }
    const asdic_outline last = piles[4];
    memmove(piles + 1, piles, 4 * sizeof *piles);
    piles[0] = last;
    snprintf(piles[0].name, sizeof piles[0].name, "%s", piles[1].name);
    for (size_t i = 0; i < SIDE * SIDE; i++) {
        depth_m[i] = 1000.0f + (float)i;
    }
    for (size_t i = 0; i < 2 * sizeof lengths_m / sizeof *lengths_m; i++) {
        bool has_depths = i % 2 == 1;
        const double north_m[2] = {0, lengths_m[i / 2]}, east_m[2] = {0, 0};
        asdic_chart chart = {.relief = has_depths ? &relief : &no_relief,
                             .outlines = piles,
                             .outline_count = 5,
                             .north_m = north_m,
                             .east_m = east_m,
                             .track_count = 2,
                             .last_time_s = 1000.125};
        assert_ok(t.ctx, asdic_draw_chart(t.ctx, path, &chart, &options));
        if (north_m[1] >= 100) { /* else they lie off the map */
            assert_written("pile_number_0");
        }
        assert_int_equal(times_written("depth (m)"), has_depths);
        assert_legible("plan", 12);
    }
}

/* A name goes 8 px beside what it names, or 26 px where all eight sides are taken, here but for one: below left. */
static void names_go_where_there_is_room(void **state) {
    (void)state;
    static const asdic_relief no_relief;
    static const double taken_px[8][2] = {{36, 0},   {-36, 0}, {0, -27},   {0, 27},
                                          {36, -27}, {36, 27}, {-36, -27}, {-14, 16}};
    const double north_m[2] = {0, 100}, east_m[2] = {0, 100};
    asdic_picture_options options = options_of("plan");
    asdic_outline outlines[9] = {0};
    asdic_chart_page page;
    asdic_chart chart = {.relief = &no_relief,
                         .outlines = outlines,
                         .outline_count = 9,
                         .north_m = north_m,
                         .east_m = east_m,
                         .track_count = 2,
                         .last_time_s = 1};
    for (size_t i = 0; i < 9; i++) {
        outlines[i].count = 1;
        outlines[i].north_m[0] = outlines[i].east_m[0] = 50;
    }
    snprintf(outlines[8].name, sizeof outlines[8].name, "named");
    asdic_chart_page_init(&page, &chart, &options);
    for (size_t i = 0; i < 8; i++) {
        outlines[i].east_m[0] += taken_px[i][0] / page.px_per_m;
        outlines[i].north_m[0] -= taken_px[i][1] / page.px_per_m;
    }
    box_count = 0;
    assert_ok(t.ctx, asdic_draw_chart(t.ctx, path, &chart, &options));
    assert_int_equal(times_written("named"), 1);
    double x = asdic_chart_x(&page, 50), y = asdic_chart_y(&page, 50);
    for (size_t i = 0; i < box_count; i++) {
        const struct box *b = &boxes[i];
        if (strcmp(b->text, "named") == 0) {
            assert_close(b->right, x - 26.0 - 3.0, 2.0); /* its ground is 3 px wider */
            assert_true(b->top > y + 26.0 && b->bottom < y + 26.0 + 20.0);
        }
    }
    assert_legible("plan", 12);
}

/* A name is left out where there is no room up to 80 px off, on none of eight sides. */
static void names_go_up_to_80_px_off(void **state) {
    (void)state;
    enum { PLACES = 40 };
    static const double sides[8][2] = {{1, 0},  {-1, 0}, {0, -1},  {0, 1},
                                       {1, -1}, {1, 1},  {-1, -1}, {-1, 1}};
    static const asdic_relief no_relief;
    static asdic_outline outlines[PLACES + 1];
    const double north_m[2] = {0, 100}, east_m[2] = {0, 100};
    asdic_picture_options options = options_of("plan");
    asdic_chart_page page;
    asdic_chart chart = {.relief = &no_relief,
                         .outlines = outlines,
                         .outline_count = PLACES + 1,
                         .north_m = north_m,
                         .east_m = east_m,
                         .track_count = 2,
                         .last_time_s = 1};
    for (size_t i = 0; i <= PLACES; i++) {
        outlines[i].count = 1;
        outlines[i].north_m[0] = outlines[i].east_m[0] = 50;
    }
    snprintf(outlines[PLACES].name, sizeof outlines[PLACES].name, "named");
    asdic_chart_page_init(&page, &chart, &options);
    for (size_t i = 0; i < PLACES;
         i++) { /* a point in the near end of each place, from 8 px to 80 */
        double px = 8.0 + 18.0 * (double)(i / 8) + 2.0;
        outlines[i].east_m[0] += sides[i % 8][0] * px / page.px_per_m;
        outlines[i].north_m[0] -= sides[i % 8][1] * px / page.px_per_m;
    }
    for (size_t is_free = 0; is_free < 2; is_free++) {
        if (is_free) { /* the farthest one below left */
            outlines[PLACES - 1] = outlines[0];
        }
        box_count = 0;
        assert_ok(t.ctx, asdic_draw_chart(t.ctx, path, &chart, &options));
        assert_int_equal(times_written("named"), is_free);
        assert_legible("plan", 11);
    }
}

static void maps(void **state) {
    (void)state;
    static const size_t sizes[][2] = {{4, 4}, {400, 20}, {20, 400}, {3000, 1000}};
    const double way_m[2] = {0, 1};
    asdic_series way = {
        .label = "vehicle, ending at the dot", .x = way_m, .y = way_m, .count = 2, .width = 1};
    asdic_picture_options options = options_of("map");
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        float *values = calloc(sizes[i][0] * sizes[i][1], sizeof *values);
        asdic_map map = {.values = values,
                         .rows = sizes[i][0],
                         .columns = sizes[i][1],
                         .cell_m = 0.5,
                         .label = "ln of the odds of a target",
                         .lines = &way,
                         .line_count = 1};
        assert_ok(t.ctx, asdic_picture_map(t.ctx, path, &map, &options));
        assert_legible("map", 10);
        free(values);
    }
}

/* The middle of the label TEXT of an axis: of east's, the lowest, across; of north's, the leftmost, down. */
static double label_px(const char *text, bool is_east) {
    const struct box *found = NULL;
    for (size_t i = 0; i < box_count; i++) {
        const struct box *b = &boxes[i];
        bool is_it = strcmp(b->text, text) == 0;
        found = is_it && (!found || (is_east ? b->top > found->top : b->left < found->left))
                    ? b
                    : found;
    }
    assert_non_null(found);
    return is_east ? 0.5 * (found->left + found->right) : 0.5 * (found->top + found->bottom);
}

/* How many rows from TOP to BOTTOM are red at X, or some pixels beside: ink is not even about the middle of a label. */
static size_t reds(cairo_surface_t *page, double x, double top, double bottom) {
    size_t count = 0, stride = (size_t)cairo_image_surface_get_stride(page);
    for (double y = ceil(top); y < bottom; y += 1.0) {
        const unsigned char *row = cairo_image_surface_get_data(page) + (size_t)y * stride;
        bool is_red = false;
        for (size_t column = (size_t)x - 4; column <= (size_t)x + 4; column++) {
            uint32_t pixel;
            memcpy(&pixel, row + 4 * column, sizeof pixel);
            is_red = is_red || (pixel & 0xffffffu) == 0xff0000u;
        }
        count += is_red;
    }
    return count;
}

/* The way from 10 m north to 30 lies there by the axes, and the greatest value is on top of its scale. */
static void maps_are_to_their_scales(void **state) {
    (void)state;
    static const float values[100 * 100];
    static const double east_m[2] = {30, 30}, north_m[2] = {10, 30};
    const asdic_series way = {
        .label = "way", .x = east_m, .y = north_m, .count = 2, .width = 2, .rgb = 0xff0000};
    const asdic_map map = {.values = values,
                           .rows = 100,
                           .columns = 100,
                           .cell_m = 0.5,
                           .label = "value",
                           .lines = &way,
                           .line_count = 1};
    asdic_picture_options options = options_of("map");
    options.db_low = 700;
    options.db_high = 900;
    box_count = 0;
    assert_ok(t.ctx, asdic_picture_map(t.ctx, path, &map, &options));
    assert_true(only("900")->bottom < only("700")->top);
    double x = label_px("30", true), north = label_px("30", false), south = label_px("10", false);
    double px_per_m = (south - north) / 20.0;
    box_count = 0;
    cairo_surface_t *page = cairo_image_surface_create_from_png(path);
    assert_int_equal(cairo_surface_status(page), CAIRO_STATUS_SUCCESS);
    assert_close((double)reds(page, x, north, south), south - north, 3.0);
    assert_int_equal(reds(page, x, north - 15.0 * px_per_m, north - px_per_m), 0);
    assert_int_equal(reds(page, x, south + px_per_m, south + 9.0 * px_per_m), 0);
    cairo_surface_destroy(page);
}

/* Eight variants: long names, curves that lie close together. */
static void rocs(void **state) {
    (void)state;
    static asdic_roc variants[8];
    static asdic_roc_point points[8][2];
    static asdic_roc_reach reach[8][2];
    asdic_roc *rocs[8];
    char names[8][64];
    const char *name[8];
    for (size_t i = 0; i < 8; i++) {
        double pd = 0.9999 - 1e-5 * (double)i;
        for (size_t k = 0; k < 2; k++) {
            asdic_estimate p = {pd, pd - 1e-5, pd + 1e-5};
            points[i][k] = (asdic_roc_point){
                .design_pfa = k ? 1.0 : 1e-6, .pd = p, .closed_pd = pd, .model_pd = {0.9, 1.0}};
            reach[i][k] = (asdic_roc_reach){
                .range_m = k ? 185.5 : 1.0, .pd = p, .closed_pd = pd, .model_pd = {0.9, 1.0}};
        }
        variants[i] = (asdic_roc){.points = points[i],
                                  .point_count = 2,
                                  .reach = reach[i],
                                  .reach_count = 2,
                                  .pfa = 1e-3,
                                  .area = {0.99999, 0.99998, 1.0},
                                  .closed_area = 0.99999};
        rocs[i] = &variants[i];
        snprintf(names[i], sizeof names[i], "length_h_m = %.6f", 0.123456 + (double)i);
        name[i] = names[i];
    }
    for (size_t count = 1; count <= 8; count++) {
        assert_ok(t.ctx, asdic_roc_draw(t.ctx, path, options_of("ROC").title, name, rocs, count));
        assert_legible("ROC", 20 + count);
    }
}

/* Deep, far, with long names. */
static const char deep[] = "version: 1\n"
                           "environment: {temperature_degc: 4, wind_speed_kn: 35}\n"
                           "bottom: {depth_m: 4321.5, type: 2.345}\n"
                           "sonar:\n"
                           "  frequency_khz: 12.345\n"
                           "  bandwidth_khz: 1.2345\n"
                           "  ping_rate_hz: 0.12345\n"
                           "  bin_length_m: 12.345\n"
                           "  source_level_db: 234.5\n"
                           "  receivers:\n"
                           "    - {name: a_beam_with_an_uncommonly_long_name, pitch_deg: 45}\n"
                           "mission: {pose: {position_m: [0, 0, 1234.5]}}\n"
                           "sampling: {rays: 1000}\n";

static void write_deep(const char *scene) {
    FILE *file = fopen(scene, "w");
    assert_non_null(file);
    assert_true(fputs(deep, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

/* The window, small and large: the map's scale, its depths, the status. */
static void views(void **state) {
    (void)state;
    static const char *const scenes[] = {"mission", "sonar_ping360", "survey", "scenario2", "deep"};
    static const unsigned sizes[][2] = {{640, 360}, {800, 600}, {1280, 720}, {1920, 1080}};
    for (size_t i = 0; i < sizeof scenes / sizeof *scenes; i++) {
        for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
            asdic_view_options options = asdic_view_options_default();
            asdic_mission *mission = NULL;
            asdic_view *view = NULL;
            char scene[512], what[128];
            options.width = sizes[k][0];
            options.height = sizes[k][1];
            bool is_own = strcmp(scenes[i], "deep") == 0;
            snprintf(scene, sizeof scene, is_own ? "%s.yaml" : "%s/scenes/%s.yaml",
                     is_own ? path : DATA_DIR, scenes[i]);
            if (is_own) {
                write_deep(scene);
            }
            snprintf(what, sizeof what, "view of %s, %u x %u", scenes[i], sizes[k][0], sizes[k][1]);
            assert_ok(t.ctx, asdic_mission_load(t.ctx, scene, &mission));
            assert_ok(t.ctx, asdic_view_create(t.ctx, mission, t.device, &options, &view));
            box_count = 0;
            assert_ok(t.ctx, asdic_view_step(view));
            assert_written("source");
            assert_written("bandwidth");
            assert_written("bins");
            assert_legible(what, 50);
            asdic_view_destroy(&view);
            asdic_mission_destroy(&mission);
            if (is_own) {
                unlink(scene);
            }
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fans),
        cmocka_unit_test(waterfalls),
        cmocka_unit_test(overviews),
        cmocka_unit_test(ascopes_name_the_curves_that_they_have),
        cmocka_unit_test(ascopes),
        cmocka_unit_test(abscissas_are_labelled),
        cmocka_unit_test(curves_are_named_once),
        cmocka_unit_test(long_names_stay_on_the_page),
        cmocka_unit_test(names_share_an_abscissa),
        cmocka_unit_test(ascopes_are_of_one_height),
        cmocka_unit_test(plans),
        cmocka_unit_test(names_go_where_there_is_room),
        cmocka_unit_test(names_go_up_to_80_px_off),
        cmocka_unit_test(maps),
        cmocka_unit_test(maps_are_to_their_scales),
        cmocka_unit_test(rocs),
        cmocka_unit_test(views),
    };
    if (!asdic_picture_annotated()) {
        return 77;
    }
    t = test_device_open_or_skip();
    close(mkstemps(path, 4));
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    unlink(path);
    test_device_close(&t);
    return failed;
}
