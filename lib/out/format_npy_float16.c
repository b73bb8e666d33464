/*
 * levels_float16.npy: the levels alone, float16 [ping, beam, bin], NAN where there is no energy.
 */
#include "npy_levels.h"

#include <math.h>

#define LEAST_NORMAL 0x1p-14f
#define LEAST_STEP 0x1p-24f
#define OVERFLOW 65520.0f /* rounds to the number after the largest, 65504 */

/* IEEE 754 binary16, the nearest: of 64 to 128 dB within 0.03 dB. A significand that rounds up to 2
 * carries into the exponent, as it should. */
static uint16_t half_of(float level_db) {
    uint16_t sign = signbit(level_db) ? 0x8000 : 0;
    float size = fabsf(level_db);
    int exponent;
    if (isnan(level_db)) {
        return 0x7e00;
    }
    if (size >= OVERFLOW) {
        return sign | 0x7c00;
    }
    if (size < LEAST_NORMAL) {
        return (uint16_t)(sign | lrintf(size / LEAST_STEP));
    }
    float significand = 2.0f * frexpf(size, &exponent); /* 1..2 */
    return (uint16_t)(sign | (((exponent + 14) << 10) + lrintf(1024.0f * (significand - 1.0f))));
}

static asdic_status open_levels(asdic_context *ctx, const char *path,
                                const asdic_format_about *about, void **out) {
    return asdic_npy_levels_open(ctx, path, about, "'<f2'", out);
}

static asdic_status write_levels(void *file, const asdic_record *record) {
    return asdic_npy_levels_write_16(file, record, half_of);
}

const char asdic_format_doc_npy_float16[] =
    "also levels_float16.npy: dB in 16 bits by ping, beam and bin, within 0.03 dB below 128 dB";

const asdic_format asdic_format_npy_float16 = {.file = "levels_float16.npy",
                                               .level_bytes = 2,
                                               .open = open_levels,
                                               .write = write_levels,
                                               .commit = asdic_npy_levels_commit,
                                               .discard = asdic_npy_levels_discard};
