#include "draw.h"

#include "base/context.h"
#include "base/sort.h"
#include "base/try.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_BEAMS 8
#define CURVES 8

/* Okabe & Ito's colours, distinct with every common colour vision deficiency; M. Okabe, K. Ito,
 * "Color Universal Design", 2008. */
#define OKABE_BLACK 0x000000u
#define OKABE_ORANGE 0xe69f00u
#define OKABE_SKY 0x56b4e9u
#define OKABE_GREEN 0x009e73u
#define OKABE_BLUE 0x0072b2u
#define OKABE_VERMILION 0xd55e00u
#define OKABE_PURPLE 0xcc79a7u
#define GREY 0xb4b4b4u

#define NOWHERE_DB (-1e4)
#define MULTIPATH 4 /* indices of the curves */
#define OBJECT 5

/* Look of each curve and its member of asdic_ascope, in drawing order: the thin black simulated
 * curve lies on the broad grey expected one and on all others, so that both are visible where they
 * agree. */
static const struct curve {
    size_t offset; /* of the levels' pointer */
    asdic_series look;
} curves[CURVES] = {
    {offsetof(asdic_ascope, noise_db), {.label = "noise", .rgb = OKABE_ORANGE, .width = 1.2}},
    {offsetof(asdic_ascope, volume_db),
     {.label = "volume", .rgb = OKABE_GREEN, .width = 1.5, .style = ASDIC_LINE_DASH_DOT}},
    {offsetof(asdic_ascope, surface_db),
     {.label = "surface", .rgb = OKABE_SKY, .width = 1.8, .style = ASDIC_LINE_DOTTED}},
    {offsetof(asdic_ascope, bottom_db),
     {.label = "bottom", .rgb = OKABE_BLUE, .width = 1.5, .style = ASDIC_LINE_DASHED}},
    {offsetof(asdic_ascope, multipath_db),
     {.label = "multipath", .rgb = OKABE_PURPLE, .width = 1.5}},
    {offsetof(asdic_ascope, object_db), {.label = "object", .rgb = OKABE_VERMILION, .width = 1.5}},
    {offsetof(asdic_ascope, total_db), {.label = "expected total", .rgb = GREY, .width = 3.2}},
    {offsetof(asdic_ascope, simulated_db),
     {.label = "simulated", .rgb = OKABE_BLACK, .width = 0.9}},
};

static const float *levels_of(const asdic_ascope *beam, size_t curve) {
    const float *levels_db;
    memcpy(&levels_db, (const char *)beam + curves[curve].offset, sizeof levels_db);
    return levels_db;
}

/* Whether any beam has a level on the curve. */
static bool has_level(const asdic_ascope *beams, size_t beam_count, size_t curve) {
    for (size_t k = 0; k < beam_count; k++) {
        const float *levels_db = levels_of(&beams[k], curve);
        for (size_t i = 0; levels_db && i < beams[k].bins; i++) {
            if (isfinite(levels_db[i])) {
                return true;
            }
        }
    }
    return false;
}

static bool has_curve(const asdic_ascope *beams, size_t beam_count, size_t curve) {
    for (size_t k = 0; k < beam_count; k++) {
        if (levels_of(&beams[k], curve)) {
            return true;
        }
    }
    return false;
}

/* A curve has a point a bin, at its centre; of a single bin it has two, at its ends, to be seen. */
static size_t point_count(const asdic_ascope *beam) {
    return beam->bins == 1 ? 2 : beam->bins;
}

static size_t bin_of(const asdic_ascope *beam, size_t point) {
    return beam->bins == 1 ? 0 : point;
}

static double range_of(const asdic_ascope *beam, size_t point) {
    return ((double)point + (beam->bins == 1 ? 0.0 : 0.5)) * beam->bin_length_m;
}

/* Fills the curves of BEAM into NUMBERS, which holds CURVES + 1 arrays: x, then each curve. A curve
 * that only other beams have stays without points, for the legend. */
static size_t collect(const asdic_ascope *beam, const bool shown[CURVES],
                      asdic_series series[CURVES], double *numbers) {
    size_t count = 0, points = point_count(beam);
    for (size_t i = 0; i < points; i++) {
        numbers[i] = range_of(beam, i);
    }
    for (size_t k = 0; k < CURVES; k++) {
        const float *levels_db = levels_of(beam, k);
        double *y = numbers + (k + 1) * points;
        if (!shown[k]) {
            continue;
        }
        series[count] = curves[k].look;
        series[count].x = numbers;
        series[count].y = y;
        series[count].count = levels_db ? points : 0;
        for (size_t n = 0; n < series[count].count; n++) {
            y[n] = (double)levels_db[bin_of(beam, n)];
            /* Echoes of objects and multipath are short: they rise from the panel's floor and do not float. */
            if ((k == OBJECT || k == MULTIPATH) && !isfinite(y[n])) {
                y[n] = NOWHERE_DB;
            }
        }
        count++;
    }
    return count;
}

/* Of the residuals, a colour for each beam. */
static const uint32_t beam_colors[MAX_BEAMS] = {
    OKABE_BLUE, OKABE_VERMILION, OKABE_GREEN, OKABE_ORANGE,
    OKABE_SKY,  OKABE_PURPLE,    OKABE_BLACK, GREY};
#define MOST_RESIDUAL_DB 40.0

/* What the panel of simulated minus expected levels shows. */
typedef struct residuals {
    asdic_series series[MAX_BEAMS];
    double *numbers[MAX_BEAMS]; /* x, y */
    size_t count;
} residuals;

static void residuals_finish(residuals *r) {
    for (size_t i = 0; i < r->count; i++) {
        free(r->numbers[i]);
    }
}

static bool has_residual(const asdic_ascope *beam) {
    return beam->simulated_db && beam->total_db;
}

static double residual_db(const asdic_ascope *beam, size_t bin) {
    return (double)beam->simulated_db[bin] - (double)beam->total_db[bin];
}

/* Half the panel's height: what holds 95 % of the differences of BEAM, at a round number. */
static asdic_status height_of(asdic_context *ctx, const asdic_ascope *beam, double *out_db) {
    static const double round_db[] = {0.5, 1.0, 2.0, 5.0, 10.0, 20.0};
    double *sizes = malloc(beam->bins * sizeof *sizes);
    size_t n = 0;
    if (!sizes) {
        return asdic_fail_memory(ctx, "an A-scope");
    }
    for (size_t i = 0; i < beam->bins; i++) {
        if (isfinite(residual_db(beam, i))) {
            sizes[n++] = fabs(residual_db(beam, i));
        }
    }
    asdic_sort_doubles(sizes, n);
    double most_db = n > 0 ? sizes[(size_t)(0.95 * (double)(n - 1))] : 0.0;
    free(sizes);
    *out_db = MOST_RESIDUAL_DB;
    for (size_t i = sizeof round_db / sizeof *round_db; i-- > 0;) {
        *out_db = round_db[i] >= most_db ? round_db[i] : *out_db;
    }
    return ASDIC_OK;
}

/* Adds what BEAM has more than it is expected to have. */
static asdic_status add_residual(asdic_context *ctx, const asdic_ascope *beam, residuals *r) {
    size_t points = point_count(beam);
    double *numbers = malloc(2 * points * sizeof *numbers);
    if (!numbers) {
        return asdic_fail_memory(ctx, "an A-scope");
    }
    size_t k = r->count++;
    r->numbers[k] = numbers;
    for (size_t i = 0; i < points; i++) {
        numbers[i] = range_of(beam, i);
        numbers[points + i] = residual_db(beam, bin_of(beam, i));
    }
    r->series[k] = (asdic_series){.label = beam->title,
                                  .x = numbers,
                                  .y = numbers + points,
                                  .count = points,
                                  .rgb = beam_colors[k],
                                  .width = 1.0};
    return ASDIC_OK;
}

/* The panels of BEAMS, COUNT of them. */
typedef struct scope {
    asdic_plot panels[MAX_BEAMS + 1];
    asdic_series series[MAX_BEAMS][CURVES];
    double *numbers[MAX_BEAMS];
    residuals residuals;
} scope;

static void scope_finish(scope *s) {
    residuals_finish(&s->residuals);
    for (size_t i = 0; i < MAX_BEAMS; i++) {
        free(s->numbers[i]);
    }
}

static asdic_status add_panel(asdic_context *ctx, scope *s, size_t i, const asdic_ascope *beam,
                              const bool shown[CURVES], const asdic_picture_options *options) {
    s->numbers[i] = malloc((CURVES + 1) * point_count(beam) * sizeof *s->numbers[i]);
    if (!s->numbers[i]) {
        return asdic_fail_memory(ctx, "an A-scope");
    }
    s->panels[i] =
        (asdic_plot){.title = beam->title,
                     .x = {.label = "range (m)", .high = (double)beam->bins * beam->bin_length_m},
                     .y = {.label = "level (dB re 1 \u00b5Pa)",
                           .low = options->db_low,
                           .high = options->db_high},
                     .series = s->series[i],
                     .series_count = collect(beam, shown, s->series[i], s->numbers[i])};
    return has_residual(beam) ? add_residual(ctx, beam, &s->residuals) : ASDIC_OK;
}

asdic_status asdic_ascope_residual_db(asdic_context *ctx, const asdic_ascope *beams,
                                      size_t beam_count, double *out_db) {
    double most_db = 0.0, beam_db = 0.0;
    for (size_t i = 0; i < beam_count; i++) {
        if (has_residual(&beams[i])) {
            TRY(height_of(ctx, &beams[i], &beam_db));
            most_db = fmax(most_db, beam_db);
        }
    }
    *out_db = most_db;
    return ASDIC_OK;
}

asdic_status asdic_draw_ascope(asdic_context *ctx, const char *path, const asdic_ascope *beams,
                               size_t beam_count, double most_db,
                               const asdic_picture_options *options) {
    scope s = {0};
    bool shown[CURVES];
    asdic_status status = ASDIC_OK;
    size_t count = beam_count;
    for (size_t k = 0; k < CURVES; k++) {
        shown[k] = has_curve(beams, beam_count, k);
    }
    for (size_t i = 0; i < beam_count && status == ASDIC_OK; i++) {
        status = add_panel(ctx, &s, i, &beams[i], shown, options);
    }
    if (s.residuals.count > 0) {
        s.panels[count] = (asdic_plot){.title = "simulated \u2212 expected",
                                       .x = s.panels[0].x,
                                       .y = {.label = "dB", .low = -most_db, .high = most_db},
                                       .series = s.residuals.series,
                                       .series_count = s.residuals.count};
        count++;
    }
    status = status ? status : asdic_picture_plot(ctx, path, s.panels, count, options);
    scope_finish(&s);
    return status;
}

asdic_status asdic_picture_ascope(asdic_context *ctx, const char *path, const asdic_ascope *beams,
                                  size_t beam_count, const asdic_picture_options *options) {
    static const float *const none = NULL;
    asdic_ascope shown[MAX_BEAMS];
    double most_db;
    if (!path || !beams || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    if (beam_count < 1 || beam_count > MAX_BEAMS) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "an A-scope shows 1..%d beams, not %zu",
                          MAX_BEAMS, beam_count);
    }
    for (size_t i = 0; i < beam_count; i++) {
        shown[i] = beams[i];
        for (size_t k = 0; k < CURVES; k++) { /* a curve without a level needs no legend */
            if (!has_level(beams, beam_count, k)) {
                memcpy((char *)&shown[i] + curves[k].offset, &none, sizeof none);
            }
        }
    }
    TRY(asdic_ascope_residual_db(ctx, shown, beam_count, &most_db));
    return asdic_draw_ascope(ctx, path, shown, beam_count, most_db, options);
}
