/*
 * levels_int16.npy: the levels alone in hundredths of a dB, int16 [ping, beam, bin], -32768 where
 * there is no energy.
 */
#include "npy_levels.h"

#include <math.h>

#define NOTHING INT16_MIN

static void hundredths_of(const float *levels_db, size_t count, uint16_t *converted) {
    for (size_t i = 0; i < count; i++) {
        float hundredths = fminf(fmaxf(100.0f * levels_db[i], -INT16_MAX), INT16_MAX);
        converted[i] = (uint16_t)(isnan(levels_db[i]) ? NOTHING : lrintf(hundredths));
    }
}

static asdic_status open_levels(asdic_context *ctx, const char *path,
                                const asdic_format_about *about, void **out) {
    return asdic_npy_levels_open(ctx, path, about, "'<i2'", out);
}

static asdic_status write_levels(void *file, const asdic_record *record) {
    return asdic_npy_levels_write_16(file, record, hundredths_of);
}

const char asdic_format_doc_npy_int16[] =
    "also levels_int16.npy: hundredths of a dB by ping, beam and bin, -32768 for no energy";

const asdic_format asdic_format_npy_int16 = {.file = "levels_int16.npy",
                                             .level_bytes = 2,
                                             .open = open_levels,
                                             .write = write_levels,
                                             .commit = asdic_npy_levels_commit,
                                             .discard = asdic_npy_levels_discard};
