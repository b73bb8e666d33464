#include <asdic/output.h>

#include "base/context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_BEAMS 8
#define CURVES 7
#define TOTAL 5 /* index of the expected total */

/* Okabe & Ito's colours, distinct with every common colour vision deficiency; M. Okabe, K. Ito,
 * "Color Universal Design", 2008. */
#define OKABE_BLACK 0x000000u
#define OKABE_ORANGE 0xe69f00u
#define OKABE_SKY 0x56b4e9u
#define OKABE_GREEN 0x009e73u
#define OKABE_BLUE 0x0072b2u
#define OKABE_VERMILION 0xd55e00u
#define GREY 0xa0a0a0u

/* Look of each curve and its member of asdic_ascope, in drawing order: the thin simulated curve
 * lies on the bold expected one, so that both are visible where they agree. */
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
    {offsetof(asdic_ascope, object_db), {.label = "object", .rgb = OKABE_VERMILION, .width = 1.5}},
    {offsetof(asdic_ascope, total_db),
     {.label = "expected total", .rgb = OKABE_BLACK, .width = 2.6}},
    {offsetof(asdic_ascope, simulated_db), {.label = "simulated", .rgb = GREY, .width = 1.2}},
};

static const float *levels_of(const asdic_ascope *beam, size_t curve) {
    const float *levels_db;
    memcpy(&levels_db, (const char *)beam + curves[curve].offset, sizeof levels_db);
    return levels_db;
}

/* Whether any beam has a level on the curve; empty curves are left out of the legend. */
static bool is_shown(const asdic_ascope *beams, size_t beam_count, size_t curve) {
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

/* Fills the curves of BEAM into NUMBERS, which holds CURVES + 1 arrays: x, then each curve. A curve
 * that only other beams have stays without points, for the legend. */
static size_t collect(const asdic_ascope *beam, const bool shown[CURVES],
                      asdic_series series[CURVES], double *numbers) {
    size_t count = 0;
    for (size_t i = 0; i < beam->bins; i++) {
        numbers[i] = ((double)i + 0.5) * beam->bin_length_m;
    }
    for (size_t i = 0; i < CURVES; i++) {
        /* Without an expected one the simulated one comes first: its mechanisms lie on it. */
        size_t k = shown[TOTAL] ? i : (i + CURVES - 1) % CURVES;
        const float *levels_db = levels_of(beam, k);
        double *y = numbers + (k + 1) * beam->bins;
        if (!shown[k]) {
            continue;
        }
        series[count] = curves[k].look;
        series[count].x = numbers;
        series[count].y = y;
        series[count].count = levels_db ? beam->bins : 0;
        for (size_t n = 0; n < series[count].count; n++) {
            y[n] = (double)levels_db[n];
        }
        count++;
    }
    return count;
}

asdic_status asdic_picture_ascope(asdic_context *ctx, const char *path, const asdic_ascope *beams,
                                  size_t beam_count, const asdic_picture_options *options) {
    asdic_plot panels[MAX_BEAMS] = {0};
    asdic_series series[MAX_BEAMS][CURVES] = {0};
    double *numbers[MAX_BEAMS] = {0};
    bool shown[CURVES];
    asdic_status status = ASDIC_OK;
    if (beam_count < 1 || beam_count > MAX_BEAMS) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "an A-scope shows 1..%d beams, not %zu",
                          MAX_BEAMS, beam_count);
    }
    for (size_t k = 0; k < CURVES; k++) {
        shown[k] = is_shown(beams, beam_count, k);
    }
    for (size_t i = 0; i < beam_count; i++) {
        numbers[i] = malloc((CURVES + 1) * beams[i].bins * sizeof *numbers[i]);
        if (!numbers[i]) {
            status = asdic_fail_memory(ctx, "an A-scope");
            goto done;
        }
        panels[i] = (asdic_plot){
            .title = beams[i].title,
            .x = {.label = "range (m)", .high = (double)beams[i].bins * beams[i].bin_length_m},
            .y = {.label = "level (dB re 1 \u00b5Pa)",
                  .low = options->db_low,
                  .high = options->db_high},
            .series = series[i],
            .series_count = collect(&beams[i], shown, series[i], numbers[i])};
    }
    status = asdic_picture_plot(ctx, path, panels, beam_count, options);
done:
    for (size_t i = 0; i < beam_count; i++) {
        free(numbers[i]);
    }
    return status;
}
