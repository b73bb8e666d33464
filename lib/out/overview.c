#include "overview.h"

#include "base/context.h"
#include "decimate.h"

#include <math.h>
#include <stdlib.h>

asdic_status asdic_overview_init(asdic_context *ctx, size_t pings, size_t beams, size_t bins,
                                 double bin_length_m, asdic_overview *out) {
    *out = (asdic_overview){.pings = pings,
                            .beams = beams,
                            .bins = bins,
                            .bin_length_m = bin_length_m,
                            .ping_group = asdic_divide_up(pings, ASDIC_OVERVIEW_MAX_ROWS),
                            .beam_group = asdic_divide_up(beams, ASDIC_OVERVIEW_MAX_COLUMNS)};
    out->rows = asdic_divide_up(pings, out->ping_group);
    out->columns = asdic_divide_up(beams, out->beam_group);
    out->shown_db = malloc(out->rows * out->columns * sizeof *out->shown_db);
    out->range_m = malloc(out->rows * out->columns * sizeof *out->range_m);
    out->gain_db = calloc(bins, sizeof *out->gain_db);
    if (!out->shown_db || !out->range_m || !out->gain_db) {
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
    free(overview->gain_db);
    *overview = (asdic_overview){0};
}

static double range_of(const asdic_overview *o, size_t bin) {
    return ((double)bin + 0.5) * o->bin_length_m;
}

void asdic_overview_set_gain(asdic_overview *o, double db_per_decade, double db_per_m) {
    for (size_t bin = 0; bin < o->bins; bin++) {
        double range_m = range_of(o, bin);
        o->gain_db[bin] = db_per_decade * log10(range_m) + db_per_m * range_m;
    }
}

/* Whether levels fall by DROP_DB from BIN on, towards the last bin or (STEP -1) the first, before
 * they rise above its own; AT_END where they do neither. */
static bool falls(const asdic_overview *o, const float *levels_db, size_t bin, int step,
                  double drop_db, bool at_end) {
    double here_db = (double)levels_db[bin] + o->gain_db[bin];
    for (size_t i = bin + (size_t)step; i < o->bins; i += (size_t)step) { /* below 0: beyond bins */
        double level_db = (double)levels_db[i] + o->gain_db[i];
        if (level_db > here_db) {
            return false;
        }
        if (!(level_db > here_db - drop_db)) { /* as without energy */
            return true;
        }
    }
    return at_end;
}

/* Whether BIN stands out of its neighbourhood by more than its sampling error. What follows the
 * last bin is not known: where the gain outdoes the fall of the reverberation it is the strongest
 * without an echo. */
static bool is_peak(const asdic_overview *o, const float *levels_db, size_t bin, double error_db) {
    double drop_db = fmax(ASDIC_OVERVIEW_ABOVE_REST_DB, error_db); /* NAN: not known */
    return o->bins < 3 || (falls(o, levels_db, bin, 1, drop_db, false) &&
                           falls(o, levels_db, bin, -1, drop_db, true));
}

/* The strongest echo of a beam, SHOWN_DB with the gain; as many as there are bins without an echo. */
static size_t strongest(const asdic_overview *o, const float *levels_db, const float *noise_db,
                        const float *stderr_db, double *shown_db) {
    size_t best = o->bins;
    *shown_db = -INFINITY;
    for (size_t bin = 0; bin < o->bins; bin++) {
        double level_db = (double)levels_db[bin], with_gain_db = level_db + o->gain_db[bin];
        bool is_noise = level_db < (double)noise_db[bin] + ASDIC_OVERVIEW_ABOVE_NOISE_DB;
        if (with_gain_db > *shown_db && !is_noise &&
            is_peak(o, levels_db, bin, (double)stderr_db[bin])) { /* false for NAN */
            *shown_db = with_gain_db;
            best = bin;
        }
    }
    return best;
}

void asdic_overview_add(asdic_overview *o, const float *levels_db, const float *noise_db,
                        const float *stderr_db) {
    size_t row = o->added++ / o->ping_group;
    for (size_t beam = 0; beam < o->beams; beam++) {
        size_t cell = row * o->columns + beam / o->beam_group;
        size_t first = beam * o->bins;
        double shown_db;
        size_t bin =
            strongest(o, levels_db + first, noise_db + first, stderr_db + first, &shown_db);
        if (bin < o->bins && !(o->shown_db[cell] >= shown_db)) {
            o->shown_db[cell] = shown_db;
            o->range_m[cell] = range_of(o, bin);
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
