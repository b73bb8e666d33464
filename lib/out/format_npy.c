/*
 * levels.npy: the levels alone, float32 [ping, beam, bin], NAN where there is no energy.
 */
#include "npy_levels.h"

static asdic_status open_levels(asdic_context *ctx, const char *path,
                                const asdic_format_about *about, void **out) {
    return asdic_npy_levels_open(ctx, path, about, "'<f4'", out);
}

const char asdic_format_doc_npy[] = "also levels.npy: float32 by ping, beam and bin";

const asdic_format asdic_format_npy = {.file = "levels.npy",
                                       .level_bytes = 4,
                                       .open = open_levels,
                                       .write = asdic_npy_levels_write,
                                       .commit = asdic_npy_levels_commit,
                                       .discard = asdic_npy_levels_discard};
