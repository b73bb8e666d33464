/*
 * levels.npy, levels_float16.npy, levels_int16.npy: the levels alone [ping, beam, bin], where there is no energy NAN,
 * or -32768 of whole numbers, which are hundredths of a dB.
 */
#include "format.h"

#include "base/context.h"
#include "file.h"
#include "half.h"
#include "npy.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define NOTHING INT16_MIN

/* Makes levels numbers of 16 bits. */
typedef void converter(const float *levels_db, size_t count, uint16_t *converted);

typedef struct levels {
    asdic_file *file;
    size_t cells;
    converter *convert;  /* NULL: they stay as they are */
    uint16_t *converted; /* one ping */
} levels;

static void hundredths_of(const float *levels_db, size_t count, uint16_t *converted) {
    for (size_t i = 0; i < count; i++) {
        float hundredths = fminf(fmaxf(100.0f * levels_db[i], -INT16_MAX), INT16_MAX);
        converted[i] = (uint16_t)(isnan(levels_db[i]) ? NOTHING : lrintf(hundredths));
    }
}

static void discard_levels(void **file) {
    levels *l = *file;
    if (l) {
        asdic_file_discard(&l->file);
        free(l->converted);
        free(l);
        *file = NULL;
    }
}

static asdic_status begin(asdic_context *ctx, const char *path, const asdic_format_about *about,
                          const char *dtype, converter *convert, void **out) {
    char header[ASDIC_NPY_HEADER_SIZE], rest[64];
    size_t beams = about->sonar->receiver_count, cells = beams * about->bins;
    levels *l = *out = calloc(1, sizeof *l);
    if (!l || !(l->converted = malloc(cells * sizeof *l->converted))) {
        discard_levels(out);
        return asdic_fail_memory(ctx, "levels for NumPy");
    }
    l->cells = cells;
    l->convert = convert;
    asdic_status status = asdic_file_create(ctx, path, &l->file);
    if (status) {
        discard_levels(out);
        return status;
    }
    snprintf(rest, sizeof rest, "%zu, %zu", beams, about->bins);
    size_t length = asdic_npy_header(header, dtype, about->pings, rest);
    fwrite(header, 1, length, asdic_file_stream(l->file));
    return ASDIC_OK;
}

static asdic_status open_float32(asdic_context *ctx, const char *path,
                                 const asdic_format_about *about, void **out) {
    return begin(ctx, path, about, "'<f4'", NULL, out);
}

static asdic_status open_float16(asdic_context *ctx, const char *path,
                                 const asdic_format_about *about, void **out) {
    return begin(ctx, path, about, "'<f2'", asdic_halves_of, out);
}

static asdic_status open_int16(asdic_context *ctx, const char *path,
                               const asdic_format_about *about, void **out) {
    return begin(ctx, path, about, "'<i2'", hundredths_of, out);
}

/* The commit tells what the disk refuses. */
static asdic_status write_levels(void *file, const asdic_record *record) {
    levels *l = file;
    const float *level_db = record->level_db[ASDIC_TOTAL];
    FILE *stream = asdic_file_stream(l->file);
    if (l->convert) {
        l->convert(level_db, l->cells, l->converted);
        fwrite(l->converted, sizeof *l->converted, l->cells, stream);
    } else {
        fwrite(level_db, sizeof *level_db, l->cells, stream);
    }
    return ASDIC_OK;
}

static asdic_status commit_levels(void **file) {
    asdic_status status = asdic_file_commit(&((levels *)*file)->file);
    discard_levels(file);
    return status;
}

const char asdic_format_doc_npy[] = "also levels.npy: float32 by ping, beam and bin";

const asdic_format asdic_format_npy = {.file = "levels.npy",
                                       .level_bytes = 4,
                                       .open = open_float32,
                                       .write = write_levels,
                                       .commit = commit_levels,
                                       .discard = discard_levels};

const char asdic_format_doc_npy_float16[] =
    "also levels_float16.npy: dB in 16 bits by ping, beam and bin, within 0.03 dB below 128 dB";

const asdic_format asdic_format_npy_float16 = {.file = "levels_float16.npy",
                                               .level_bytes = 2,
                                               .open = open_float16,
                                               .write = write_levels,
                                               .commit = commit_levels,
                                               .discard = discard_levels};

const char asdic_format_doc_npy_int16[] =
    "also levels_int16.npy: hundredths of a dB by ping, beam and bin, -32768 for no energy";

const asdic_format asdic_format_npy_int16 = {.file = "levels_int16.npy",
                                             .level_bytes = 2,
                                             .open = open_int16,
                                             .write = write_levels,
                                             .commit = commit_levels,
                                             .discard = discard_levels};
