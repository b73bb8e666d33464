/*
 * The picture of a trial: for every variant the probability of a collision with its interval, and
 * the share of runs that had come so near to something.
 */
#include "trial_folder.h"

#include "base/context.h"
#include "base/sort.h"

#include <math.h>
#include <stdlib.h>

#define LABEL_SIZE 256
/* So many designs have their names below the axis; more have numbers. */
#define MOST_NAMES 8

static const uint32_t colors[] = {0x0072b2u, 0xd55e00u, 0x009e73u, 0xcc79a7u,
                                  0xe69f00u, 0x56b4e9u, 0x7f7f7fu, 0x8c564bu};

typedef struct drawing {
    char numbers[ASDIC_TRIAL_MOST_VARIANTS][24];
    const char *names[ASDIC_TRIAL_MOST_VARIANTS]; /* of ticks */
    char labels[ASDIC_TRIAL_MOST_VARIANTS][LABEL_SIZE];
    double bar_x[ASDIC_TRIAL_MOST_VARIANTS][11], bar_y[ASDIC_TRIAL_MOST_VARIANTS][11];
    double late_x[ASDIC_TRIAL_MOST_VARIANTS][11], late_y[ASDIC_TRIAL_MOST_VARIANTS][11];
    double *x[ASDIC_TRIAL_MOST_VARIANTS], *y[ASDIC_TRIAL_MOST_VARIANTS];
    asdic_series bars[ASDIC_TRIAL_MOST_VARIANTS], needless[ASDIC_TRIAL_MOST_VARIANTS];
    asdic_series curves[ASDIC_TRIAL_MOST_VARIANTS];
} drawing;

/* An interval at AT, its ends marked, and a dot for the value: gaps are not finite. */
static void draw_interval(double at, const asdic_trial_figure *f, double x[11], double y[11]) {
    const double half = 0.12;
    const double px[11] = {at - half, at + half, NAN,           at,           at, NAN, at - half,
                           at + half, NAN,       at - 2 * half, at + 2 * half};
    const double py[11] = {f->low,  f->low,  NAN, f->low,   f->high, NAN,
                           f->high, f->high, NAN, f->value, f->value};
    for (int i = 0; i < 11; i++) {
        x[i] = px[i];
        y[i] = py[i];
    }
}

/* Share of the runs whose clearance was X or less; runs in which there was nothing to come near are of them. False: no
 * memory. */
static bool draw_clearance(drawing *d, const asdic_trial *t, size_t variant) {
    size_t count = 0, runs = 0;
    d->x[variant] = malloc((2 * t->row_count + 2) * sizeof(double));
    d->y[variant] = malloc((2 * t->row_count + 2) * sizeof(double));
    double *found = malloc((t->row_count + 1) * sizeof(double));
    bool good = d->x[variant] && d->y[variant] && found;
    for (size_t i = 0; good && i < t->row_count; i++) {
        const asdic_trial_run *r = &t->rows[i].flown;
        if (t->rows[i].variant != variant || r->outcome >= ASDIC_TRIAL_VOID) {
            continue;
        }
        runs++;
        if (isfinite(r->clearance_m)) {
            found[count++] = r->clearance_m;
        }
    }
    if (good) {
        asdic_sort_doubles(found, count);
    }
    for (size_t i = 0; good && i < count; i++) {
        d->x[variant][2 * i] = d->x[variant][2 * i + 1] = found[i];
        d->y[variant][2 * i] = (double)i / (double)runs;
        d->y[variant][2 * i + 1] = (double)(i + 1) / (double)runs;
    }
    d->curves[variant] = (asdic_series){.x = d->x[variant],
                                        .y = d->y[variant],
                                        .count = 2 * count,
                                        .rgb = colors[variant % 8],
                                        .width = 1.6,
                                        .style = (asdic_line_style)(variant / 8)};
    free(found);
    return good;
}

static asdic_status draw(asdic_context *ctx, const asdic_trial *t, const drawing *d,
                         const char *path) {
    double most = 0.0, most_needless = 0.0, farthest = 0.0;
    size_t n = t->facts.variants;
    for (size_t v = 0; v < n; v++) {
        most = fmax(most, t->results[v].collision.high);
        most_needless = fmax(most_needless, t->results[v].needless.high);
        for (size_t i = 0; i < d->curves[v].count; i++) {
            farthest = fmax(farthest, d->x[v][i]);
        }
    }
    const asdic_plot_axis variants = {.label = n > MOST_NAMES ? "design, in the order of the legend"
                                               : t->facts.key ? t->facts.key
                                                              : "design",
                                      .low = 0.5,
                                      .high = (double)n + 0.5,
                                      .names = d->names,
                                      .name_count = n};
    const asdic_plot plots[3] = {
        {.title = "Runs that end in a collision",
         .x = variants,
         .y = {.label = "P(collision)", .low = 0.0, .high = fmin(1.05 * most + 1e-6, 1.0)},
         .series = d->bars,
         .series_count = n},
        {.title = "Runs that give way to nothing",
         .x = variants,
         .y = {.label = "P(needless)", .low = 0.0, .high = fmin(1.05 * most_needless + 1e-6, 1.0)},
         .series = d->needless,
         .series_count = n},
        {.title = "How near they come",
         .x = {.label = "clearance (m)", .low = 0.0, .high = fmax(farthest, 1e-3)},
         .y = {.label = "share of runs", .low = 0.0, .high = 1.0},
         .series = d->curves,
         .series_count = n}};
    char title[512];
    snprintf(title, sizeof title, "%s: %llu runs of each design\nseed %llu", t->facts.scene,
             (unsigned long long)t->facts.count, (unsigned long long)t->facts.seed);
    const char *const texts[] = {"Software", "asdic", "Title", title, NULL};
    asdic_picture_options options = asdic_picture_options_default();
    options.title = title;
    options.texts = texts;
    options.note = "intervals of 95 % (Clopper and Pearson)";
    return asdic_picture_plot(ctx, path, plots, 3, &options);
}

asdic_status asdic_trial_draw(asdic_context *ctx, const asdic_trial *t, const char *path) {
    drawing *d = calloc(1, sizeof *d);
    bool good = d != NULL;
    for (size_t v = 0; good && v < t->facts.variants; v++) {
        const asdic_trial_result *r = &t->results[v];
        asdic_series line = {.rgb = colors[v % 8], .width = 1.6, .count = 11};
        snprintf(d->labels[v], LABEL_SIZE, "%s: P(collision) %.4f (%.4f\u2026%.4f)", t->names[v],
                 r->collision.value, r->collision.low, r->collision.high);
        snprintf(d->numbers[v], sizeof d->numbers[v], "%zu", v + 1);
        d->names[v] = t->facts.variants > MOST_NAMES ? d->numbers[v]
                      : t->facts.key                 ? t->facts.values[v]
                                                     : t->names[v];
        draw_interval((double)v + 1.0, &r->collision, d->bar_x[v], d->bar_y[v]);
        draw_interval((double)v + 1.0, &r->needless, d->late_x[v], d->late_y[v]);
        d->bars[v] = d->needless[v] = line;
        d->bars[v].label = d->labels[v];
        d->bars[v].x = d->bar_x[v];
        d->bars[v].y = d->bar_y[v];
        d->needless[v].x = d->late_x[v];
        d->needless[v].y = d->late_y[v];
        good = draw_clearance(d, t, v);
    }
    asdic_status status = good ? draw(ctx, t, d, path) : asdic_fail_memory(ctx, "a picture");
    for (size_t v = 0; d && v < ASDIC_TRIAL_MOST_VARIANTS; v++) {
        free(d->x[v]);
        free(d->y[v]);
    }
    free(d);
    return status;
}
