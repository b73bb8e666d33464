#include "run_survey.h"

#include "base/context.h"
#include "out/record.h"

#include <math.h>
#include <stdlib.h>

/* Histogram of levels: 0.1 dB from -500 to 300 dB. */
#define LEVEL_LOW_DB -500.0
#define LEVEL_STEP_DB 0.1
#define LEVEL_BINS 8000
/* Histogram of standard errors: 400 a decade from 1e-6 to 1e4 dB, fine to 0.6 %. */
#define ERROR_LOW_LOG10 -6.0
#define ERROR_PER_DECADE 400.0
#define ERROR_BINS 4000
/* The window leaves out this share of the levels at either end. */
#define LOW_SHARE 0.01
#define HIGH_SHARE 0.999

typedef struct histograms {
    uint64_t levels[LEVEL_BINS], errors[ERROR_BINS];
    uint64_t level_count, error_count;
    double worst_db;
} histograms;

static size_t clamp(double x, size_t count) {
    return x < 0.0 ? 0 : x >= (double)count ? count - 1 : (size_t)x;
}

static void add(histograms *h, const asdic_record *record, size_t cells) {
    for (size_t i = 0; i < cells; i++) {
        double level_db = (double)record->level_db[ASDIC_TOTAL][i];
        double error_db = (double)record->stderr_db[i];
        if (!isnan(level_db)) {
            h->levels[clamp((level_db - LEVEL_LOW_DB) / LEVEL_STEP_DB, LEVEL_BINS)]++;
            h->level_count++;
        }
        if (!isnan(error_db)) {
            double log = error_db > 0.0 ? log10(error_db) : -INFINITY;
            h->errors[clamp((log - ERROR_LOW_LOG10) * ERROR_PER_DECADE, ERROR_BINS)]++;
            h->error_count++;
            h->worst_db = fmax(h->worst_db, error_db);
        }
    }
}

/* First histogram bin at which SHARE of all COUNT values is reached. */
static size_t quantile(const uint64_t *histogram, size_t bins, uint64_t count, double share) {
    uint64_t sum = 0;
    for (size_t i = 0; i < bins; i++) {
        sum += histogram[i];
        if ((double)sum >= share * (double)count) {
            return i;
        }
    }
    return bins - 1;
}

static void conclude(const histograms *h, asdic_survey *out) {
    out->low_db = -160.0;
    out->high_db = -60.0;
    out->stderr_median_db = out->stderr_worst_db = NAN;
    if (h->level_count > 0) {
        double low = (double)quantile(h->levels, LEVEL_BINS, h->level_count, LOW_SHARE);
        double high = (double)quantile(h->levels, LEVEL_BINS, h->level_count, HIGH_SHARE) + 1.0;
        out->low_db = 10.0 * floor((LEVEL_LOW_DB + low * LEVEL_STEP_DB) / 10.0);
        out->high_db = 10.0 * ceil((LEVEL_LOW_DB + high * LEVEL_STEP_DB) / 10.0);
        if (out->high_db - out->low_db < 10.0) {
            out->high_db = out->low_db + 10.0;
        }
    }
    if (h->error_count > 0) {
        double median = (double)quantile(h->errors, ERROR_BINS, h->error_count, 0.5);
        out->stderr_median_db = pow(10.0, ERROR_LOW_LOG10 + (median + 0.5) / ERROR_PER_DECADE);
        out->stderr_median_db = median == 0.0 ? 0.0 : out->stderr_median_db;
        out->stderr_worst_db = h->worst_db;
    }
}

asdic_status asdic_survey_run(asdic_context *ctx, asdic_store *store, size_t beams, size_t bins,
                              asdic_survey *out) {
    *out = (asdic_survey){0};
    asdic_status status = ASDIC_OK;
    histograms *h = calloc(1, sizeof *h);
    void *bytes = malloc(asdic_store_record_bytes(store));
    if (!h || !bytes) {
        status = asdic_fail_memory(ctx, "a run's statistics");
        goto done;
    }
    for (size_t i = 0; i < asdic_store_count(store); i++) {
        asdic_record record;
        status = asdic_store_read(store, i, bytes);
        if (status != ASDIC_OK) {
            goto done;
        }
        asdic_record_view(bytes, beams, bins, &record);
        add(h, &record, beams * bins);
        out->rays += record.rays;
        out->saturated += record.saturated;
        out->first_time_s = i == 0 ? record.time_s : out->first_time_s;
        out->last_time_s = record.time_s;
    }
    conclude(h, out);
done:
    free(h);
    free(bytes);
    return status;
}
