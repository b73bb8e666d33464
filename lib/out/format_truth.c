/*
 * truth.npy: what each bin's energy comes from (asdic/truth.h), one structured record a ping.
 */
#include "base/context.h"
#include "base/try.h"
#include "file.h"
#include "format.h"
#include "npy.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct truth_file {
    asdic_file *file;
    size_t cells;
} truth_file;

static void discard_truth(void **file) {
    truth_file *t = *file;
    if (t) {
        asdic_file_discard(&t->file);
        free(t);
        *file = NULL;
    }
}

static asdic_status open_truth(asdic_context *ctx, const char *path,
                               const asdic_format_about *about, void **out) {
    char header[ASDIC_NPY_HEADER_SIZE], dtype[ASDIC_RECORD_DTYPE_SIZE] = "[";
    size_t beams = about->sonar->receiver_count;
    truth_file *t = *out = calloc(1, sizeof *t);
    if (!t) {
        return asdic_fail_memory(ctx, "truth for NumPy");
    }
    t->cells = beams * about->bins;
    asdic_status status = asdic_file_create(ctx, path, &t->file);
    if (status) {
        discard_truth(out);
        return status;
    }
    size_t used = asdic_truth_dtype(dtype, sizeof dtype, 1, beams, about->bins);
    snprintf(dtype + used, sizeof dtype - used, "]");
    size_t length = asdic_npy_header(header, dtype, about->pings, "");
    fwrite(header, 1, length, asdic_file_stream(t->file));
    return ASDIC_OK;
}

static asdic_status write_truth(void *file, const asdic_record *record) {
    truth_file *t = file;
    for (size_t i = 0; record->truth.share && i < ASDIC_TRUTH_FIELDS; i++) {
        fwrite(asdic_truth_values(&record->truth, i), asdic_truth_fields[i].width, t->cells,
               asdic_file_stream(t->file));
    }
    return ASDIC_OK;
}

static asdic_status commit_truth(void **file) {
    asdic_status status = asdic_file_commit(&((truth_file *)*file)->file);
    discard_truth(file);
    return status;
}

const char asdic_format_doc_truth[] =
    "also truth.npy: strongest source, object, shares by path and depression of every bin";

const asdic_format asdic_format_truth = {.file = "truth.npy",
                                         .level_bytes = ASDIC_TRUTH_BYTES,
                                         .open = open_truth,
                                         .write = write_truth,
                                         .commit = commit_truth,
                                         .discard = discard_truth};
