#include <asdic/output.h>

#include "base/context.h"

#include <stdlib.h>

#define MAX_BEAMS 8
#define CURVES 7

/* Okabe & Ito's colours, distinct with every common colour vision deficiency; M. Okabe, K. Ito,
 * "Color Universal Design", 2008. */
#define OKABE_BLACK 0x000000u
#define OKABE_ORANGE 0xe69f00u
#define OKABE_SKY 0x56b4e9u
#define OKABE_GREEN 0x009e73u
#define OKABE_BLUE 0x0072b2u
#define OKABE_VERMILION 0xd55e00u
#define GREY 0x909090u

/* Levels of one curve as doubles in Y; the series points there. */
static void fill(asdic_series *series, const float *levels_db, size_t bins, const double *x,
                 double *y) {
    for (size_t i = 0; i < bins; i++) {
        y[i] = (double)levels_db[i];
    }
    series->x = x;
    series->y = y;
    series->count = bins;
}

/* Curves of BEAM in drawing order (the simulated one lies below all others) on NUMBERS, which
 * holds CURVES + 1 arrays. Returns how many there are. */
static size_t collect(const asdic_ascope *beam, asdic_series series[CURVES], double *numbers) {
    const struct {
        const float *levels_db;
        asdic_series look;
    } curves[CURVES] = {
        {beam->simulated_db, {.label = "simulated", .rgb = GREY, .width = 1.0}},
        {beam->noise_db, {.label = "noise", .rgb = OKABE_ORANGE, .width = 1.0}},
        {beam->volume_db,
         {.label = "volume", .rgb = OKABE_GREEN, .width = 1.5, .style = ASDIC_LINE_DASH_DOT}},
        {beam->surface_db,
         {.label = "surface", .rgb = OKABE_SKY, .width = 1.8, .style = ASDIC_LINE_DOTTED}},
        {beam->bottom_db,
         {.label = "bottom", .rgb = OKABE_BLUE, .width = 1.5, .style = ASDIC_LINE_DASHED}},
        {beam->object_db, {.label = "object", .rgb = OKABE_VERMILION, .width = 1.5}},
        {beam->total_db, {.label = "expected total", .rgb = OKABE_BLACK, .width = 2.2}},
    };
    double *x = numbers;
    for (size_t i = 0; i < beam->bins; i++) {
        x[i] = ((double)i + 0.5) * beam->bin_length_m;
    }
    size_t count = 0;
    for (size_t k = 0; k < CURVES; k++) {
        if (curves[k].levels_db) {
            series[count] = curves[k].look;
            fill(&series[count], curves[k].levels_db, beam->bins, x,
                 numbers + (count + 1) * beam->bins);
            count++;
        }
    }
    return count;
}

asdic_status asdic_picture_ascope(asdic_context *ctx, const char *path, const asdic_ascope *beams,
                                  size_t beam_count, const asdic_picture_options *options) {
    asdic_plot panels[MAX_BEAMS] = {0};
    asdic_series series[MAX_BEAMS][CURVES] = {0};
    double *numbers[MAX_BEAMS] = {0};
    asdic_status status = ASDIC_OK;
    if (beam_count < 1 || beam_count > MAX_BEAMS) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "an A-scope shows 1..%d beams, not %zu",
                          MAX_BEAMS, beam_count);
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
            .series_count = collect(&beams[i], series[i], numbers[i])};
    }
    status = asdic_picture_plot(ctx, path, panels, beam_count, options);
done:
    for (size_t i = 0; i < beam_count; i++) {
        free(numbers[i]);
    }
    return status;
}
