/*
 * levels.npy: the levels alone, float32 [ping, beam, bin], NAN where there is no energy.
 */
#include "base/context.h"
#include "file.h"
#include "format.h"
#include "npy.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct levels {
    asdic_file *file;
    size_t cells;
} levels;

static void discard_levels(void **file) {
    levels *l = *file;
    if (l) {
        asdic_file_discard(&l->file);
        free(l);
        *file = NULL;
    }
}

static asdic_status open_levels(asdic_context *ctx, const char *path,
                                const asdic_format_about *about, void **out) {
    char header[ASDIC_NPY_HEADER_SIZE], rest[64];
    size_t beams = about->sonar->receiver_count;
    levels *l = *out = calloc(1, sizeof *l);
    if (!l) {
        return asdic_fail_memory(ctx, "levels.npy");
    }
    l->cells = beams * about->bins;
    asdic_status status = asdic_file_create(ctx, path, &l->file);
    if (status) {
        discard_levels(out);
        return status;
    }
    snprintf(rest, sizeof rest, "%zu, %zu", beams, about->bins);
    size_t length = asdic_npy_header(header, "'<f4'", about->pings, rest);
    fwrite(header, 1, length, asdic_file_stream(l->file));
    return ASDIC_OK;
}

/* The commit tells what the disk refuses. */
static asdic_status write_levels(void *file, const asdic_record *record) {
    levels *l = file;
    fwrite(record->level_db[ASDIC_TOTAL], sizeof(float), l->cells, asdic_file_stream(l->file));
    return ASDIC_OK;
}

static asdic_status commit_levels(void **file) {
    asdic_status status = asdic_file_commit(&((levels *)*file)->file);
    discard_levels(file);
    return status;
}

const char asdic_format_doc_npy[] = "also levels.npy: float32 by ping, beam and bin";

const asdic_format asdic_format_npy = {.file = "levels.npy",
                                       .open = open_levels,
                                       .write = write_levels,
                                       .commit = commit_levels,
                                       .discard = discard_levels};
