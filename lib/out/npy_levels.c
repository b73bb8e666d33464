#include "npy_levels.h"

#include "base/context.h"
#include "file.h"
#include "npy.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct levels {
    asdic_file *file;
    size_t cells;
    uint16_t *converted; /* one ping, of 16-bit types */
} levels;

void asdic_npy_levels_discard(void **file) {
    levels *l = *file;
    if (l) {
        asdic_file_discard(&l->file);
        free(l->converted);
        free(l);
        *file = NULL;
    }
}

asdic_status asdic_npy_levels_open(asdic_context *ctx, const char *path,
                                   const asdic_format_about *about, const char *dtype, void **out) {
    char header[ASDIC_NPY_HEADER_SIZE], rest[64];
    size_t beams = about->sonar->receiver_count;
    levels *l = *out = calloc(1, sizeof *l);
    if (!l || !(l->converted = malloc(beams * about->bins * sizeof *l->converted))) {
        asdic_npy_levels_discard(out);
        return asdic_fail_memory(ctx, "levels for NumPy");
    }
    l->cells = beams * about->bins;
    asdic_status status = asdic_file_create(ctx, path, &l->file);
    if (status) {
        asdic_npy_levels_discard(out);
        return status;
    }
    snprintf(rest, sizeof rest, "%zu, %zu", beams, about->bins);
    size_t length = asdic_npy_header(header, dtype, about->pings, rest);
    fwrite(header, 1, length, asdic_file_stream(l->file));
    return ASDIC_OK;
}

asdic_status asdic_npy_levels_write(void *file, const asdic_record *record) {
    levels *l = file;
    fwrite(record->level_db[ASDIC_TOTAL], sizeof(float), l->cells, asdic_file_stream(l->file));
    return ASDIC_OK;
}

asdic_status asdic_npy_levels_write_16(void *file, const asdic_record *record,
                                       asdic_npy_convert *convert) {
    levels *l = file;
    convert(record->level_db[ASDIC_TOTAL], l->cells, l->converted);
    fwrite(l->converted, sizeof *l->converted, l->cells, asdic_file_stream(l->file));
    return ASDIC_OK;
}

asdic_status asdic_npy_levels_commit(void **file) {
    asdic_status status = asdic_file_commit(&((levels *)*file)->file);
    asdic_npy_levels_discard(file);
    return status;
}
