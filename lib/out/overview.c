#include "overview.h"

#include "base/context.h"
#include "raster.h"

#include <math.h>
#include <stdlib.h>

static size_t divide_up(size_t a, size_t b) {
    return a / b + (a % b != 0);
}

asdic_status asdic_overview_init(asdic_context *ctx, size_t pings, size_t beams, size_t bins,
                                 double bin_length_m, asdic_overview *out) {
    *out = (asdic_overview){.pings = pings,
                            .beams = beams,
                            .bins = bins,
                            .bin_length_m = bin_length_m,
                            .ping_group = divide_up(pings, ASDIC_OVERVIEW_MAX_ROWS),
                            .beam_group = divide_up(beams, ASDIC_OVERVIEW_MAX_COLUMNS)};
    out->rows = divide_up(pings, out->ping_group);
    out->columns = divide_up(beams, out->beam_group);
    out->shown_db = malloc(out->rows * out->columns * sizeof *out->shown_db);
    out->range_m = malloc(out->rows * out->columns * sizeof *out->range_m);
    if (!out->shown_db || !out->range_m) {
        asdic_overview_finish(out);
        return asdic_fail_memory(ctx, "an overview");
    }
    for (size_t i = 0; i < out->rows * out->columns; i++) {
        out->shown_db[i] = out->range_m[i] = NAN;
    }
    return ASDIC_OK;
}

void asdic_overview_finish(asdic_overview *overview) {
    free(overview->shown_db);
    free(overview->range_m);
    *overview = (asdic_overview){0};
}

/* The strongest bin of a beam; false without an echo. */
static bool strongest(const asdic_overview *o, const float *levels_db, const float *noise_db,
                      const asdic_picture_options *options, double *shown_db, double *range_m) {
    *shown_db = -INFINITY;
    for (size_t bin = 0; bin < o->bins; bin++) {
        double at_m = ((double)bin + 0.5) * o->bin_length_m;
        double level_db = asdic_raster_gain(options, (double)levels_db[bin], at_m);
        bool is_noise =
            (double)levels_db[bin] < (double)noise_db[bin] + ASDIC_OVERVIEW_ABOVE_NOISE_DB;
        if (level_db > *shown_db && !is_noise) { /* false for NAN */
            *shown_db = level_db;
            *range_m = at_m;
        }
    }
    return isfinite(*shown_db);
}

void asdic_overview_add(asdic_overview *o, const float *levels_db, const float *noise_db,
                        const asdic_picture_options *options) {
    size_t row = o->added++ / o->ping_group;
    for (size_t beam = 0; beam < o->beams; beam++) {
        size_t cell = row * o->columns + beam / o->beam_group;
        double shown_db, range_m = NAN;
        bool is_there = strongest(o, levels_db + beam * o->bins, noise_db + beam * o->bins, options,
                                  &shown_db, &range_m);
        if (is_there && !(o->shown_db[cell] >= shown_db)) {
            o->shown_db[cell] = shown_db;
            o->range_m[cell] = range_m;
        }
    }
}

void asdic_overview_window(const asdic_overview *o, double *low_db, double *high_db) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < o->rows * o->columns; i++) {
        if (!isnan(o->shown_db[i])) {
            low = fmin(low, o->shown_db[i]);
            high = fmax(high, o->shown_db[i]);
        }
    }
    bool is_empty = low > high;
    *low_db = is_empty ? 0.0 : 10.0 * floor(low / 10.0);
    *high_db = is_empty ? 10.0 : fmax(10.0 * ceil(high / 10.0), *low_db + 10.0);
}
