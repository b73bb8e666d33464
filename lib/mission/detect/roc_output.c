/*
 * Receiver operating characteristics as a table and as a picture.
 */
#include <asdic/roc.h>

#include "base/context.h"
#include "base/number.h"
#include "base/try.h"
#include "out/csv.h"
#include "out/file.h"

#include <asdic/output.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MOST_CURVES 8
/* Simulated, its bounds twice, closed form, and that with the laws' errors either way. */
#define LINES_EACH 6
#define LABEL_SIZE 160

static void print_estimate(FILE *out, asdic_estimate e) {
    fprintf(out, "%.9g,%.9g,%.9g", e.value, e.low, e.high);
}

static void print_curve(FILE *out, const char *name, const asdic_roc *roc) {
    for (size_t i = 0; i < roc->point_count; i++) {
        const asdic_roc_point *p = &roc->points[i];
        fprintf(out, "%s,%.9g,", name, p->design_pfa);
        if (isfinite(p->threshold_db)) {
            fprintf(out, "%.9g", p->threshold_db);
        }
        fputc(',', out);
        print_estimate(out, p->pfa);
        fputc(',', out);
        print_estimate(out, p->pd);
        fprintf(out, ",%.9g\n", p->closed_pd);
    }
}

static void print_reach(FILE *out, const char *name, const asdic_roc *roc) {
    for (size_t i = 0; i < roc->reach_count; i++) {
        const asdic_roc_reach *r = &roc->reach[i];
        fprintf(out, "%s,%.9g,%.9g,", name, r->range_m, r->snr_db);
        print_estimate(out, r->pd);
        fprintf(out, ",%.9g\n", r->closed_pd);
    }
}

typedef void print_rows(FILE *out, const char *name, const asdic_roc *roc);

static asdic_status print_all(asdic_context *ctx, FILE *out, print_rows *print,
                              const char *const *names, asdic_roc *const *rocs, size_t count) {
    for (size_t i = 0; i < count; i++) {
        char *name = malloc(2 * strlen(names[i]) + 3);
        if (!name) {
            return asdic_fail_memory(ctx, "a table");
        }
        asdic_csv_field(name, names[i]);
        print(out, name, rocs[i]);
        free(name);
    }
    return ASDIC_OK;
}

static asdic_status write_table(asdic_context *ctx, const char *path, const char *header,
                                print_rows *print, const char *const *names, asdic_roc *const *rocs,
                                size_t count) {
    asdic_file *file = NULL;
    TRY(asdic_file_create(ctx, path, &file));
    locale_t before = asdic_c_locale_enter();
    fputs(header, asdic_file_stream(file));
    asdic_status status = print_all(ctx, asdic_file_stream(file), print, names, rocs, count);
    asdic_c_locale_leave(before);
    status = status ? status : asdic_file_commit(&file);
    asdic_file_discard(&file);
    return status;
}

asdic_status asdic_roc_write_csv(asdic_context *ctx, const char *path, const char *range_path,
                                 const char *const *names, asdic_roc *const *rocs, size_t count) {
    if (!path || !range_path || !names || !rocs) {
        return asdic_fail_null(ctx, __func__);
    }
    TRY(write_table(
        ctx, path,
        "variant,design_pfa,threshold_db,pfa,pfa_low,pfa_high,pd,pd_low,pd_high,closed_pd\n",
        print_curve, names, rocs, count));
    return write_table(ctx, range_path, "variant,range_m,snr_db,pd,pd_low,pd_high,closed_pd\n",
                       print_reach, names, rocs, count);
}

/* Columns of numbers, as plots take them: what P_D is over, and what is drawn of it. */
enum { OVER, LOW, HIGH, VALUE, CLOSED, MODEL_LOW, MODEL_HIGH, COLUMNS };

typedef struct columns {
    double *of[COLUMNS];
    size_t count;
} columns;

static bool columns_init(columns *c, size_t count) {
    double *all = malloc(COLUMNS * (count + 1) * sizeof *all);
    c->count = count;
    for (size_t k = 0; all && k < COLUMNS; k++) {
        c->of[k] = all + k * count;
    }
    return all != NULL;
}

static void put(columns *c, size_t i, double over, asdic_estimate pd, double closed_pd,
                asdic_band model_pd) {
    const double row[COLUMNS] = {over,      pd.low,       pd.high,      pd.value,
                                 closed_pd, model_pd.low, model_pd.high};
    for (size_t k = 0; k < COLUMNS; k++) {
        c->of[k][i] = row[k];
    }
}

static bool curve_of(const asdic_roc *roc, columns *c) {
    bool has_room = columns_init(c, roc->point_count);
    for (size_t i = 0; has_room && i < c->count; i++) {
        const asdic_roc_point *p = &roc->points[i];
        put(c, i, p->design_pfa, p->pd, p->closed_pd, p->model_pd);
    }
    return has_room;
}

static bool reach_of(const asdic_roc *roc, columns *c) {
    bool has_room = columns_init(c, roc->reach_count);
    for (size_t i = 0; has_room && i < c->count; i++) {
        const asdic_roc_reach *r = &roc->reach[i];
        put(c, i, r->range_m, r->pd, r->closed_pd, r->model_pd);
    }
    return has_room;
}

/* Half way to white: bounds stand back behind what they bound. */
static uint32_t pale(uint32_t rgb) {
    return 0x808080u + (rgb >> 1 & 0x7f7f7fu);
}

static size_t add_lines(asdic_series *out, const columns *c, uint32_t rgb, const char *label) {
    asdic_series line = {.x = c->of[OVER], .count = c->count, .rgb = rgb};
    static const double width[LINES_EACH] = {0.7, 0.7, 1.8, 1.0, 1.0, 1.0};
    static const asdic_line_style style[LINES_EACH] = {ASDIC_LINE_SOLID,  ASDIC_LINE_SOLID,
                                                       ASDIC_LINE_SOLID,  ASDIC_LINE_DASHED,
                                                       ASDIC_LINE_DOTTED, ASDIC_LINE_DOTTED};
    for (int k = 0; k < LINES_EACH; k++) { /* NAN is not drawn */
        out[k] = line;
        out[k].y = c->of[LOW + k];
        out[k].width = width[k];
        out[k].style = style[k];
        out[k].label = k == 2 ? label : NULL;
        out[k].rgb = k == 3 ? 0x202020u : k < 2 ? pale(rgb) : rgb;
    }
    return LINES_EACH;
}

/* The lowest P_D of the axis: it shows how far P_D stays from 1 when that is not far. */
static double lowest(const columns *curves, size_t count) {
    double least = 1.0;
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < curves[i].count; k++) {
            least = fmin(least, fmin(curves[i].of[LOW][k], curves[i].of[CLOSED][k]));
            least = fmin(least, curves[i].of[MODEL_LOW][k]); /* NAN gives way */
        }
    }
    double rest = fmax(1.0 - least, 1e-6);
    return rest < 0.5 ? 1.0 - 1.1 * rest : 0.0;
}

static void describe(char label[LABEL_SIZE], const char *name, const asdic_roc *roc) {
    snprintf(label, LABEL_SIZE, "%s: area %.5f (%.5f\u2026%.5f), closed form %.5f", name,
             roc->area.value, roc->area.low, roc->area.high, roc->closed_area);
}

/* The curves of a picture, and the numbers that they point to. */
typedef struct drawing {
    columns curve[MOST_CURVES], reach[MOST_CURVES];
    char labels[MOST_CURVES][LABEL_SIZE];
    double chance_x[61], chance_y[61];
    asdic_series lines[MOST_CURVES * LINES_EACH + 1], range_lines[MOST_CURVES * LINES_EACH];
    size_t line_count, range_line_count;
    double farthest_m;
} drawing;

static void drawing_finish(drawing *d) {
    for (size_t i = 0; i < MOST_CURVES; i++) {
        free(d->curve[i].of[0]);
        free(d->reach[i].of[0]);
    }
    free(d);
}

/* False when memory is short. */
static bool add_curves(drawing *d, const char *const *names, asdic_roc *const *rocs, size_t count) {
    static const uint32_t colors[MOST_CURVES] = {0x0072b2u, 0xd55e00u, 0x009e73u, 0xcc79a7u,
                                                 0xe69f00u, 0x56b4e9u, 0x7f7f7fu, 0x8c564bu};
    for (size_t i = 0; i < count; i++) {
        if (!curve_of(rocs[i], &d->curve[i]) || !reach_of(rocs[i], &d->reach[i])) {
            return false;
        }
        describe(d->labels[i], names[i], rocs[i]);
        d->line_count += add_lines(d->lines + d->line_count, &d->curve[i], colors[i], d->labels[i]);
        d->range_line_count +=
            add_lines(d->range_lines + d->range_line_count, &d->reach[i], colors[i], NULL);
        for (size_t k = 0; k < d->reach[i].count; k++) {
            d->farthest_m = fmax(d->farthest_m, d->reach[i].of[OVER][k]);
        }
    }
    return true;
}

static void add_chance(drawing *d) {
    for (int i = 0; i < 61; i++) {
        d->chance_x[i] = d->chance_y[i] = pow(10.0, -6.0 + 0.1 * i);
    }
    d->lines[d->line_count++] = (asdic_series){.label = "chance",
                                               .x = d->chance_x,
                                               .y = d->chance_y,
                                               .count = 61,
                                               .rgb = 0x909090u,
                                               .width = 1.0,
                                               .style = ASDIC_LINE_DOTTED};
}

static asdic_status draw(asdic_context *ctx, const char *path, const char *title, drawing *d,
                         asdic_roc *const *rocs, size_t count) {
    char range_title[160], pfa[32];
    if (lowest(d->curve, count) == 0.0) { /* else it lies outside */
        add_chance(d);
    }
    snprintf(pfa, sizeof pfa, "P_FA = %g", rocs[0]->pfa);
    for (size_t i = 1; i < count; i++) {
        if (rocs[i]->pfa != rocs[0]->pfa) {
            snprintf(pfa, sizeof pfa, "each at its own P_FA");
        }
    }
    snprintf(range_title, sizeof range_title,
             "The same target at other ranges in its bearing and depth, %s", pfa);
    asdic_plot plots[2] = {{.title = "The target where it is",
                            .x = {.label = "P_FA", .low = 1e-6, .high = 1.0, .logarithmic = true},
                            .y = {.label = "P_D", .low = lowest(d->curve, count), .high = 1.0},
                            .series = d->lines,
                            .series_count = d->line_count},
                           {.title = range_title,
                            .x = {.label = "range (m)", .low = 0.0, .high = d->farthest_m},
                            .y = {.label = "P_D", .low = lowest(d->reach, count), .high = 1.0},
                            .series = d->range_lines,
                            .series_count = d->range_line_count}};
    asdic_picture_options options = asdic_picture_options_default();
    const char *const texts[] = {"Software", "asdic", "Title", title, NULL};
    bool has_model = d->curve[0].count > 0 && !isnan(d->curve[0].of[MODEL_LOW][0]);
    options.title = title;
    options.texts = texts;
    options.note =
        has_model ? "solid: by random draws, pale: its bounds of 99 %  \u00b7  dashed: closed "
                    "form  \u00b7  dotted: over the error of the scattering laws"
                  : "solid: by random draws, pale: its bounds of 99 %  \u00b7  dashed: closed form";
    return asdic_picture_plot(ctx, path, plots, d->farthest_m > 0.0 ? 2 : 1, &options);
}

asdic_status asdic_roc_draw(asdic_context *ctx, const char *path, const char *title,
                            const char *const *names, asdic_roc *const *rocs, size_t count) {
    if (!path || !title || !names || !rocs) {
        return asdic_fail_null(ctx, __func__);
    }
    if (count == 0 || count > MOST_CURVES) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%zu curves in a picture: 1 to %d", count,
                          MOST_CURVES);
    }
    drawing *d = calloc(1, sizeof *d);
    if (!d) {
        return asdic_fail_memory(ctx, "a picture");
    }
    locale_t before = asdic_c_locale_enter();
    asdic_status status = add_curves(d, names, rocs, count) ? draw(ctx, path, title, d, rocs, count)
                                                            : asdic_fail_memory(ctx, "a picture");
    asdic_c_locale_leave(before);
    drawing_finish(d);
    return status;
}
