/*
 * The picture and the tables of receiver operating characteristics show the numbers they are given.
 * Every line and text of the picture passes cairo_stroke or cairo_show_text, which this program
 * takes the place of: it notes them.
 */
#include "asserts.h"
#include "test_context.h"

#include <asdic/asdic.h>

#include <cairo.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_LINES 300
#define MOST_POINTS 64
#define MOST_DASHES 8
#define POINTS 7         /* of a curve: no other line has so many */
#define CHANCE_POINTS 40 /* at least: cairo joins steps of one slope */

/* How P_D grows from point to point, in steps: no three points lie on a straight line. */
static double shape(int i) {
    return i * i / 6.0;
}

static char path[] = "/tmp/asdic-roc-XXXXXX.png";

typedef struct drawn_line {
    double x[MOST_POINTS], y[MOST_POINTS], width, red, green, blue;
    int count, dashes;
    double dash[MOST_DASHES];
    cairo_line_cap_t cap;
} drawn_line;

static drawn_line lines[MOST_LINES];
static size_t line_count;
static char texts[20000]; /* all that is written, each behind a line feed */
static size_t text_length;

void cairo_show_text(cairo_t *cr, const char *text) {
    (void)cr;
    text_length += (size_t)snprintf(texts + text_length, sizeof texts - text_length, "\n%s", text);
    assert_true(text_length < sizeof texts);
}

void cairo_stroke(cairo_t *cr) {
    cairo_path_t *found = cairo_copy_path(cr);
    assert_true(line_count < MOST_LINES);
    drawn_line *line = &lines[line_count++];
    memset(line, 0, sizeof *line);
    for (int i = 0; i < found->num_data; i += found->data[i].header.length) {
        if (found->data[i].header.length == 2 && line->count < MOST_POINTS) {
            line->x[line->count] = found->data[i + 1].point.x;
            line->y[line->count++] = found->data[i + 1].point.y;
        }
    }
    line->width = cairo_get_line_width(cr);
    line->dashes = cairo_get_dash_count(cr);
    assert_true(line->dashes <= MOST_DASHES);
    cairo_get_dash(cr, line->dash, NULL);
    line->cap = cairo_get_line_cap(cr);
    cairo_pattern_get_rgba(cairo_get_source(cr), &line->red, &line->green, &line->blue, NULL);
    cairo_path_destroy(found);
    cairo_new_path(cr);
}

/* A panel's frame, half a pixel outside its box: the first line after AT with its corners. */
static const drawn_line *frame_after(size_t at) {
    for (; at < line_count; at++) {
        const drawn_line *l = &lines[at];
        if (l->count >= 4 && l->count <= 5 && l->x[2] - l->x[0] > 500.0 && l->y[2] > l->y[0]) {
            return l;
        }
    }
    fail_msg("no frame");
    return NULL;
}

static size_t next_of(size_t at, int count) {
    while (at < line_count && lines[at].count != count) {
        at++;
    }
    return at;
}

/* X, Y: shares of the frame, Y from below. */
static void assert_curve(const drawn_line *line, const drawn_line *frame, const double *x,
                         const double *y) {
    double left = frame->x[0] + 0.5, width = frame->x[2] - frame->x[0] - 1.0;
    double top = frame->y[0] + 0.5, height = frame->y[2] - frame->y[0] - 1.0;
    for (int i = 0; i < line->count; i++) {
        assert_close(line->x[i], left + width * x[i], 0.02); /* cairo keeps 1/256 of a pixel */
        assert_close(line->y[i], top + height * (1.0 - y[i]), 0.02);
    }
}

/* A variant whose numbers are all different. */
typedef struct variant {
    asdic_roc roc;
    asdic_roc_point points[POINTS];
    asdic_roc_reach reach[POINTS];
} variant;

static void fill(variant *v, double least, double step, bool has_model) {
    asdic_band none = {NAN, NAN};
    for (int i = 0; i < POINTS; i++) {
        double pd = least + step * shape(i);
        asdic_estimate p = {pd + 0.02 * step, pd + 0.01 * step, pd + 0.03 * step};
        asdic_estimate q = {pd + 0.12 * step, pd + 0.11 * step, pd + 0.13 * step};
        v->points[i] = (asdic_roc_point){.design_pfa = pow(10.0, i - 6.0),
                                         .threshold_db = i == 2 ? INFINITY : 3.5 - i,
                                         .pfa = {1e-3 * i + 2e-4, 1e-3 * i + 1e-4, 1e-3 * i + 3e-4},
                                         .pd = p,
                                         .closed_pd = pd + 0.04 * step,
                                         .model_pd = none};
        v->reach[i] = (asdic_roc_reach){.range_m = 10.0 + 7.5 * i,
                                        .snr_db = 20.0 - i,
                                        .pd = q,
                                        .closed_pd = pd + 0.14 * step,
                                        .model_pd = none};
        if (has_model) {
            v->points[i].model_pd = (asdic_band){.low = pd, .high = pd + 0.05 * step};
            v->reach[i].model_pd = (asdic_band){.low = pd + 0.1 * step, .high = pd + 0.15 * step};
        }
    }
    v->roc = (asdic_roc){.points = v->points,
                         .point_count = POINTS,
                         .reach = v->reach,
                         .reach_count = POINTS,
                         .pfa = 1e-3,
                         .area = {0.75, 0.74, 0.76},
                         .closed_area = 0.755};
}

/* The lowest P_D of an axis: 0, unless all lie above a half; then a tenth more than they take. */
static double axis_low(double least) {
    return 1.0 - least < 0.5 ? 1.0 - 1.1 * fmax(1.0 - least, 1e-6) : 0.0;
}

/* Blue or vermilion of Okabe & Ito, "Color universal design" (2002); bounds half way to white, the
 * closed form black. */
static void assert_color(const drawn_line *line, size_t which, int k) {
    static const double color[2][3] = {{0.0, 114.0, 178.0}, {213.0, 94.0, 0.0}};
    const double drawn[3] = {line->red, line->green, line->blue};
    for (int i = 0; i < 3; i++) {
        double own = color[which][i] / 255.0;
        assert_close(drawn[i], k < 2 ? 0.5 + 0.5 * own : k == 3 ? 32.0 / 255.0 : own, 0.009);
    }
}

/* The curves of one panel from line AT on, the bounds first; where the next panel begins. STEP: as
 * in fill. */
static size_t assert_panel(size_t at, const variant *all, size_t count, bool is_range,
                           double step) {
    static const double order[6] = {0.01, 0.03, 0.02, 0.04, 0.0, 0.05};
    bool has_model = !isnan(all[0].points[0].model_pd.low);
    double add = is_range ? 0.1 : 0.0, least = 1.0;
    for (size_t v = 0; v < count; v++) {
        double first = all[v].points[0].closed_pd - 0.04 * step;
        least = fmin(least, first + (add + (has_model ? 0.0 : 0.01)) * step);
    }
    double low = axis_low(least);
    const drawn_line *frame = frame_after(next_of(at, POINTS));
    for (size_t v = 0; v < count; v++) {
        double first = all[v].points[0].closed_pd - 0.04 * step;
        for (int k = 0; k < (has_model ? 6 : 4); k++, at++) {
            double x[POINTS], y[POINTS];
            for (int i = 0; i < POINTS; i++) {
                x[i] = is_range ? (10.0 + 7.5 * i) / 55.0 : i / 6.0;
                y[i] = (first + step * (shape(i) + add + order[k]) - low) / (1.0 - low);
            }
            at = next_of(at, POINTS);
            assert_true(at < line_count);
            assert_curve(&lines[at], frame, x, y);
            assert_int_equal(lines[at].dashes > 0, k >= 3);
            assert_int_equal(lines[at].width > 1.5 * 1.5, k == 2);
            assert_color(&lines[at], v, k);
        }
    }
    return at;
}

/* The line of chance, if there is one: P_D is P_FA. */
static const drawn_line *chance_line(void) {
    for (size_t at = 0; at < line_count; at++) {
        if (lines[at].count >= CHANCE_POINTS && lines[at].dashes > 0) {
            return &lines[at];
        }
    }
    return NULL;
}

static void assert_chance(void) {
    const drawn_line *line = chance_line();
    assert_non_null(line);
    const drawn_line *frame = frame_after((size_t)(line - lines));
    double width = frame->x[2] - frame->x[0] - 1.0, x[MOST_POINTS], y[MOST_POINTS];
    for (int i = 0; i < line->count; i++) {
        x[i] = (line->x[i] - frame->x[0] - 0.5) / width;
        y[i] = pow(10.0, 6.0 * (x[i] - 1.0));
    }
    assert_close(x[0], 0.0, 1e-4);
    assert_close(x[line->count - 1], 1.0, 1e-4);
    assert_curve(line, frame, x, y);
}

static void draw(const variant *all, size_t count) {
    asdic_roc *rocs[8];
    const char *names[8];
    for (size_t i = 0; i < count; i++) {
        rocs[i] = (asdic_roc *)(uintptr_t)&all[i].roc;
        names[i] = i ? "second" : "first";
    }
    line_count = text_length = 0;
    assert_ok(ctx, asdic_roc_draw(ctx, path, "ROC", names, rocs, count));
}

static void assert_texts(size_t count, bool has_model) {
    static const char numbers[] = "area 0.75000 (0.74000\u20260.76000), closed form 0.75500";
    for (size_t i = 0; i < 2; i++) {
        char legend[160];
        snprintf(legend, sizeof legend, "\n%s: %s", i ? "second" : "first", numbers);
        const char *found = strstr(texts, legend);
        assert_int_equal(found != NULL, i < count);
        assert_null(found ? strstr(found + 1, legend) : NULL); /* once */
    }
    size_t samples = 0; /* in the legend, of the thick lines */
    for (size_t at = 0; at < line_count; at++) {
        samples += lines[at].count == 2 && lines[at].width > 1.5 * 1.5;
    }
    assert_int_equal(samples, count);
    assert_int_equal(strstr(texts, "dotted: over the error of the scattering laws") != NULL,
                     has_model);
    assert_non_null(strstr(texts, "solid: by random draws, pale: its bounds of 99 %"));
    assert_non_null(strstr(texts, "in its bearing and depth, P_FA = 0.001")); /* an object's, too */
}

static void curves_lie_where_their_numbers_say(void **state) {
    (void)state;
    static variant all[2];
    for (int has_model = 0; has_model < 2; has_model++) {
        fill(&all[0], 0.2, 0.1, has_model);
        fill(&all[1], 0.1, 0.1, has_model);
        for (size_t count = 1; count <= 2; count++) {
            draw(all, count);
            size_t at = assert_panel(0, all, count, false, 0.1);
            at = assert_panel(at, all, count, true, 0.1);
            assert_int_equal(next_of(at, POINTS), line_count);
            assert_texts(count, has_model);
        }
        assert_chance();
    }
}

static void a_p_fa_of_their_own_is_told(void **state) {
    (void)state;
    static variant all[2];
    fill(&all[0], 0.2, 0.1, false);
    fill(&all[1], 0.1, 0.1, false);
    all[1].roc.pfa = 1e-5;
    draw(all, 2);
    assert_null(strstr(texts, "P_FA = 0.001"));
    assert_non_null(strstr(texts, "each at its own P_FA"));
}

/* Also what lies close to 1, where the axis begins higher and the line of chance lies outside. */
static void a_high_pd_fills_the_axis(void **state) {
    (void)state;
    static variant one;
    for (int has_model = 0; has_model < 2; has_model++) {
        fill(&one, 0.92, 0.01, has_model);
        draw(&one, 1);
        size_t at = assert_panel(0, &one, 1, false, 0.01);
        assert_panel(at, &one, 1, true, 0.01);
        assert_null(chance_line());
    }
    fill(&one, 0.48, 0.05, true);
    draw(&one, 1);
    assert_panel(0, &one, 1, false, 0.05);
    fill(&one, 0.92, 0.01, true);
    one.roc.reach_count = 0;
    draw(&one, 1);
    assert_int_equal(next_of(assert_panel(0, &one, 1, false, 0.01), POINTS), line_count);
}

/* The farthest range need not be the last; without any there is one panel. */
static void ranges_come_in_any_order(void **state) {
    (void)state;
    static variant one;
    fill(&one, 0.2, 0.1, false);
    for (int i = 0; i < POINTS / 2; i++) {
        double range_m = one.reach[i].range_m;
        one.reach[i].range_m = one.reach[POINTS - 1 - i].range_m;
        one.reach[POINTS - 1 - i].range_m = range_m;
    }
    draw(&one, 1);
    size_t at = assert_panel(0, &one, 1, false, 0.1);
    at = next_of(at, POINTS);
    const drawn_line *frame = frame_after(at);
    assert_close(lines[at].x[0], frame->x[2] - 0.5, 0.02);
    for (int i = 0; i < POINTS; i++) {
        one.reach[i].range_m = 0.1 * (i + 1);
    }
    draw(&one, 1);
    at = next_of(assert_panel(0, &one, 1, false, 0.1), POINTS);
    assert_true(at < line_count);
    assert_close(lines[at].x[POINTS - 1], frame_after(at)->x[2] - 0.5, 0.02);
}

static void too_many_curves_are_refused(void **state) {
    (void)state;
    static variant all[9];
    asdic_roc *rocs[9];
    const char *names[9];
    for (size_t i = 0; i < 9; i++) {
        fill(&all[i], 0.2, 0.1, true);
        rocs[i] = &all[i].roc;
        names[i] = "x";
    }
    line_count = 0;
    assert_ok(ctx, asdic_roc_draw(ctx, path, "ROC", names, rocs, 8));
    size_t curves = 0;
    for (size_t at = next_of(0, POINTS); at < line_count; at = next_of(at + 1, POINTS)) {
        curves++;
    }
    assert_int_equal(curves, 8 * 2 * 6);
    assert_non_null(chance_line());
    assert_int_equal(asdic_roc_draw(ctx, path, "ROC", names, rocs, 9), ASDIC_ERROR_ARGUMENT);
    assert_int_equal(asdic_roc_draw(ctx, path, "ROC", names, rocs, 0), ASDIC_ERROR_ARGUMENT);
}

/* A curve of STYLE and WIDTH; its sample in the legend looks alike. */
static const drawn_line *line_of(asdic_line_style style, double width) {
    double x[POINTS], y[POINTS];
    for (int i = 0; i < POINTS; i++) {
        x[i] = i / 6.0;
        y[i] = shape(i) / 6.0;
    }
    const asdic_series series = {
        .label = "line", .x = x, .y = y, .count = POINTS, .width = width, .style = style};
    const asdic_plot plot = {.x = {.label = "x", .high = 1},
                             .y = {.label = "y", .high = 1},
                             .series = &series,
                             .series_count = 1};
    const asdic_picture_options options = asdic_picture_options_default();
    line_count = text_length = 0;
    assert_ok(ctx, asdic_picture_plot(ctx, path, &plot, 1, &options));
    const drawn_line *line = &lines[next_of(0, POINTS)];
    assert_true(line < lines + line_count);
    size_t samples = 0;
    for (size_t at = 0; at < line_count; at++) {
        const drawn_line *l = &lines[at];
        samples += l->count == 2 && l->width == line->width && l->dashes == line->dashes &&
                   memcmp(l->dash, line->dash, sizeof l->dash) == 0;
    }
    assert_int_equal(samples, 1);
    return line;
}

/* Strokes, dots and gaps are told apart, and grow with the line. */
static void styles_are_told_apart(void **state) {
    (void)state;
    static const int dashes[] = {[ASDIC_LINE_SOLID] = 0,
                                 [ASDIC_LINE_DASHED] = 2,
                                 [ASDIC_LINE_DOTTED] = 2,
                                 [ASDIC_LINE_DASH_DOT] = 4};
    for (asdic_line_style style = ASDIC_LINE_SOLID; style <= ASDIC_LINE_DASH_DOT; style++) {
        const drawn_line thin = *line_of(style, 1.5), thick = *line_of(style, 3.0);
        const double *dash = thin.dash, width = thin.width;
        assert_close(thick.width, 2.0 * width, 1e-9);
        assert_int_equal(thin.dashes, dashes[style]);
        assert_int_equal(thick.dashes, dashes[style]);
        for (int i = 0; i < thin.dashes; i++) {
            assert_close(thick.dash[i], 2.0 * dash[i], 1e-9);
            assert_true(i % 2 == 0 ||
                        (dash[i] >= 2.0 * width && dash[i] <= 4.0 * width)); /* gaps */
        }
        bool is_dotted = style == ASDIC_LINE_DOTTED; /* by round ends of strokes without length */
        assert_int_equal(thin.cap == CAIRO_LINE_CAP_ROUND, is_dotted);
        if (is_dotted) {
            assert_close(dash[0], 0.0, 1e-9);
        } else if (style != ASDIC_LINE_SOLID) {
            assert_true(dash[0] >= 4.0 * width && dash[0] <= 8.0 * width);
        }
        if (style == ASDIC_LINE_DASH_DOT) {
            assert_true(dash[2] >= width && dash[2] <= 0.4 * dash[0]);
        }
    }
}

/* One row of a table: its numbers, NAN for an empty field. */
static void assert_row(FILE *file, const char *name, const double *expected, int count) {
    char line[512], *rest = line;
    assert_non_null(fgets(line, sizeof line, file));
    assert_string_equal(strsep(&rest, ","), name);
    for (int i = 0; i < count; i++) {
        const char *field = strsep(&rest, ",\n");
        assert_non_null(field);
        if (isnan(expected[i])) {
            assert_string_equal(field, "");
        } else {
            assert_close(strtod(field, NULL), expected[i], 1e-8 * fabs(expected[i]));
        }
    }
    assert_string_equal(rest, "");
}

static void tables_hold_the_numbers(void **state) {
    (void)state;
    static variant all[2];
    char range_path[] = "/tmp/asdic-roc-range-XXXXXX", line[512];
    close(mkstemp(range_path));
    const char *const names[] = {"\"\"\"", "b"}; /* doubled and in quotes: as long as it gets */
    asdic_roc *rocs[2] = {&all[0].roc, &all[1].roc};
    fill(&all[0], 0.2, 0.1, true);
    fill(&all[1], 0.1, 0.1, false);
    assert_ok(ctx, asdic_roc_write_csv(ctx, path, range_path, names, rocs, 2));
    FILE *file = fopen(path, "r"), *range_file = fopen(range_path, "r");
    assert_non_null(fgets(line, sizeof line, file));
    assert_non_null(fgets(line, sizeof line, range_file));
    for (int v = 0; v < 2; v++) {
        for (int i = 0; i < POINTS; i++) {
            const asdic_roc_point *p = &all[v].points[i];
            const asdic_roc_reach *r = &all[v].reach[i];
            double threshold = i == 2 ? NAN : p->threshold_db;
            double row[] = {p->design_pfa, threshold, p->pfa.value, p->pfa.low,  p->pfa.high,
                            p->pd.value,   p->pd.low, p->pd.high,   p->closed_pd};
            double far[] = {r->range_m, r->snr_db,  r->pd.value,
                            r->pd.low,  r->pd.high, r->closed_pd};
            assert_row(file, v ? "b" : "\"\"\"\"\"\"\"\"", row, 9);
            assert_row(range_file, v ? "b" : "\"\"\"\"\"\"\"\"", far, 6);
        }
    }
    assert_null(fgets(line, sizeof line, file));
    assert_null(fgets(line, sizeof line, range_file));
    fclose(file);
    fclose(range_file);
    unlink(range_path);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curves_lie_where_their_numbers_say),
        cmocka_unit_test(a_p_fa_of_their_own_is_told),
        cmocka_unit_test(a_high_pd_fills_the_axis),
        cmocka_unit_test(ranges_come_in_any_order),
        cmocka_unit_test(too_many_curves_are_refused),
        cmocka_unit_test(styles_are_told_apart),
        cmocka_unit_test(tables_hold_the_numbers),
    };
    close(mkstemps(path, 4));
    int failed = cmocka_run_group_tests(tests, context_begin, context_end);
    unlink(path);
    return failed;
}
