/*
 * levels_float16.npy: the levels alone, float16 [ping, beam, bin], NAN where there is no energy.
 */
#include "half.h"
#include "npy_levels.h"

static asdic_status open_levels(asdic_context *ctx, const char *path,
                                const asdic_format_about *about, void **out) {
    return asdic_npy_levels_open(ctx, path, about, "'<f2'", out);
}

static asdic_status write_levels(void *file, const asdic_record *record) {
    return asdic_npy_levels_write_16(file, record, asdic_halves_of);
}

const char asdic_format_doc_npy_float16[] =
    "also levels_float16.npy: dB in 16 bits by ping, beam and bin, within 0.03 dB below 128 dB";

const asdic_format asdic_format_npy_float16 = {.file = "levels_float16.npy",
                                               .level_bytes = 2,
                                               .open = open_levels,
                                               .write = write_levels,
                                               .commit = asdic_npy_levels_commit,
                                               .discard = asdic_npy_levels_discard};
