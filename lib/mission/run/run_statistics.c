#include "run_statistics.h"

#include "base/context.h"
#include "base/try.h"
#include "out/raster.h"
#include "out/record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Histogram of levels: 0.1 dB from -500 to 300 dB. */
#define LEVEL_LOW_DB -500.0
#define LEVEL_STEP_DB 0.1
#define LEVEL_BINS 8000
/* Histogram of standard errors by the first bits of a float, which needs no logarithm: 256 bins an
 * octave from 2^-20 to 2^14 dB, fine to 0.4 %. Smaller errors, zero above all, count in the first
 * bin. */
#define ERROR_SHIFT 15
#define ERROR_LOW ((127u - 20u) << (23 - ERROR_SHIFT))
#define ERROR_BINS (34u << (23 - ERROR_SHIFT))
/* The window leaves out this share of the levels at either end: a few spikes would leave most of
 * the colours unused. */
#define LOW_SHARE 0.05
#define HIGH_SHARE 0.995

typedef struct asdic_statistics_counts {
    uint64_t levels[LEVEL_BINS], shown[LEVEL_BINS], errors[ERROR_BINS];
    uint64_t level_count, error_count, records;
    float worst_db;
    double error2_sum; /* of heard bins, dB^2 */
    uint64_t heard;
} counts;

asdic_status asdic_statistics_begin(asdic_context *ctx, asdic_statistics *statistics) {
    *statistics = (asdic_statistics){.counts = calloc(1, sizeof(counts)), .most_db = -INFINITY};
    return statistics->counts ? ASDIC_OK : asdic_fail_memory(ctx, "a run's statistics");
}

asdic_status asdic_statistics_set_gain(asdic_context *ctx, asdic_statistics *statistics,
                                       size_t bins, double bin_length_m,
                                       const asdic_picture_options *options) {
    statistics->bins = bins;
    statistics->gain_db = malloc(bins * sizeof *statistics->gain_db);
    for (size_t n = 0; statistics->gain_db && n < bins; n++) {
        statistics->gain_db[n] = asdic_raster_gain(options, 0.0, ((double)n + 0.5) * bin_length_m);
    }
    return statistics->gain_db ? ASDIC_OK : asdic_fail_memory(ctx, "a gain");
}

void asdic_statistics_finish(asdic_statistics *statistics) {
    free(statistics->gain_db);
    free(statistics->counts);
    statistics->gain_db = NULL;
    statistics->counts = NULL;
}

static size_t level_bin(float level_db) {
    double x = ((double)level_db - LEVEL_LOW_DB) / LEVEL_STEP_DB;
    return !(x >= 0.0) ? 0 : x >= (double)LEVEL_BINS ? LEVEL_BINS - 1 : (size_t)x;
}

static size_t error_bin(float error_db) {
    uint32_t bits;
    memcpy(&bits, &error_db, sizeof bits);
    uint32_t bin = bits >> ERROR_SHIFT;
    return bin < ERROR_LOW ? 0 : bin - ERROR_LOW >= ERROR_BINS ? ERROR_BINS - 1 : bin - ERROR_LOW;
}

/* The middle of a bin; 0 of the first. */
static double error_of(size_t bin) {
    uint32_t bits = ((uint32_t)bin + ERROR_LOW) << ERROR_SHIFT | 1u << (ERROR_SHIFT - 1);
    float error_db;
    memcpy(&error_db, &bits, sizeof error_db);
    return bin == 0 ? 0.0 : (double)error_db;
}

static void add_levels(counts *c, const float *level_db, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (!isnan(level_db[i])) {
            c->levels[level_bin(level_db[i])]++;
            c->level_count++;
        }
    }
}

static void add_shown(counts *c, const asdic_statistics *statistics, const float *level_db,
                      size_t count) {
    for (size_t i = 0; statistics->gain_db && i < count; i++) {
        if (!isnan(level_db[i])) {
            c->shown[level_bin(
                (float)((double)level_db[i] + statistics->gain_db[i % statistics->bins]))]++;
        }
    }
}

static void add_errors(counts *c, const float *error_db, size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (!isnan(error_db[i])) {
            c->errors[error_bin(error_db[i])]++;
            c->error_count++;
            c->worst_db = error_db[i] > c->worst_db ? error_db[i] : c->worst_db;
        }
    }
}

/* Whether a mechanism's echo in bin I is at least as strong as the noise. */
static bool is_heard(const asdic_record *record, size_t i) {
    float noise_db = record->level_db[ASDIC_NOISE][i];
    bool heard = false;
    for (int c = ASDIC_BOTTOM; c < ASDIC_NOISE; c++) {
        float echo_db = record->level_db[c][i];
        heard |= !isnan(echo_db) && !(echo_db < noise_db);
    }
    return heard;
}

static void add_heard(counts *c, const asdic_record *record, size_t count) {
    for (size_t i = 0; i < count; i++) {
        double error_db = (double)record->stderr_db[i];
        if (!isnan(error_db) && is_heard(record, i)) {
            c->error2_sum += error_db * error_db;
            c->heard++;
        }
    }
}

static bool has_level(const float *level_db, size_t count) {
    size_t i = 0;
    while (i < count && !(level_db[i] > -INFINITY)) {
        i++;
    }
    return i < count;
}

static float greatest_db(const float *level_db, size_t count) {
    float most_db = -INFINITY;
    for (size_t i = 0; i < count; i++) {
        most_db = level_db[i] > most_db ? level_db[i] : most_db;
    }
    return most_db;
}

/* What there is, and how loud: of the echoes, too, of which speckle may leave less in the total. */
static void add_most(asdic_statistics *statistics, const asdic_record *record, size_t count) {
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        statistics->has[c] = statistics->has[c] || has_level(record->level_db[c], count);
    }
    float total_db = greatest_db(record->level_db[ASDIC_TOTAL], count);
    float object_db = greatest_db(record->level_db[ASDIC_OBJECT], count);
    statistics->most_db = fmax(statistics->most_db, (double)fmaxf(total_db, object_db));
}

void asdic_statistics_add(asdic_statistics *statistics, const asdic_record *record, size_t cells) {
    counts *c = statistics->counts;
    add_levels(c, record->level_db[ASDIC_TOTAL], cells);
    add_shown(c, statistics, record->level_db[ASDIC_TOTAL], cells);
    add_errors(c, record->stderr_db, cells);
    add_heard(c, record, cells);
    add_most(statistics, record, cells);
    statistics->rays += record->rays;
    statistics->saturated += record->saturated;
    statistics->first_time_s = c->records == 0 ? record->time_s : statistics->first_time_s;
    statistics->last_time_s = record->time_s;
    c->records++;
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

/* The window that shows COUNT levels, counted in HISTOGRAM. */
static void window(const uint64_t *histogram, uint64_t count, double *low_db, double *high_db) {
    *low_db = -160.0;
    *high_db = -60.0;
    if (count > 0) {
        double low = (double)quantile(histogram, LEVEL_BINS, count, LOW_SHARE);
        double high = (double)quantile(histogram, LEVEL_BINS, count, HIGH_SHARE) + 1.0;
        *low_db = 10.0 * floor((LEVEL_LOW_DB + low * LEVEL_STEP_DB) / 10.0);
        *high_db = 10.0 * ceil((LEVEL_LOW_DB + high * LEVEL_STEP_DB) / 10.0);
        *high_db = fmax(*high_db, *low_db + 10.0);
    }
}

void asdic_statistics_end(asdic_statistics *out) {
    const counts *c = out->counts;
    out->errors =
        (asdic_run_errors){NAN, NAN, c->heard > 0 ? sqrt(c->error2_sum / (double)c->heard) : NAN};
    window(c->levels, c->level_count, &out->low_db, &out->high_db);
    window(out->gain_db ? c->shown : c->levels, c->level_count, &out->shown_low_db,
           &out->shown_high_db);
    if (c->error_count > 0) {
        out->errors.median_db = error_of(quantile(c->errors, ERROR_BINS, c->error_count, 0.5));
        out->errors.worst_db = (double)c->worst_db;
    }
}

asdic_status asdic_ping_get_errors(asdic_context *ctx, const asdic_ping *ping,
                                   asdic_run_errors *out) {
    if (!ping || !out) {
        return asdic_fail_null(ctx, __func__);
    }
    const asdic_record_head head = {0};
    asdic_statistics statistics;
    asdic_record record;
    TRY(asdic_statistics_begin(ctx, &statistics));
    void *bytes = calloc(1, asdic_record_bytes(ping->beams, ping->bins));
    if (bytes) {
        asdic_record_pack(&head, ping, bytes);
        asdic_record_view(bytes, ping->beams, ping->bins, &record);
        asdic_statistics_add(&statistics, &record, ping->beams * ping->bins);
        asdic_statistics_end(&statistics);
        *out = statistics.errors;
    }
    asdic_statistics_finish(&statistics);
    free(bytes);
    return bytes ? ASDIC_OK : asdic_fail_memory(ctx, "a ping's errors");
}
