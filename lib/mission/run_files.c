#include "run_files.h"

#include "base/context.h"
#include "out/file.h"
#include "out/npy.h"
#include "run_folder.h"

#include <stdio.h>
#include <stdlib.h>

asdic_status asdic_files_replay(asdic_context *ctx, asdic_store *store, const asdic_sonar *sonar,
                                size_t bins, asdic_csv *csv) {
    asdic_status status = ASDIC_OK;
    void *bytes = malloc(asdic_store_record_bytes(store));
    if (!bytes) {
        return asdic_fail_memory(ctx, "a record");
    }
    for (size_t i = 0; i < asdic_store_count(store) && status == ASDIC_OK; i++) {
        asdic_record record;
        status = asdic_store_read(store, i, bytes);
        if (status == ASDIC_OK) {
            asdic_record_view(bytes, sonar->receiver_count, bins, &record);
            status = asdic_csv_add(csv, &record);
        }
    }
    free(bytes);
    return status;
}

asdic_status asdic_files_levels(asdic_context *ctx, asdic_store *store, const char *folder,
                                size_t beams, size_t bins) {
    char header[ASDIC_NPY_HEADER_SIZE], rest[64];
    char *path = asdic_folder_path(folder, "levels", "", "npy");
    asdic_file *file = NULL;
    void *bytes = malloc(asdic_store_record_bytes(store));
    asdic_status status =
        bytes && path ? asdic_file_create(ctx, path, &file) : asdic_fail_memory(ctx, "levels.npy");
    if (status != ASDIC_OK) {
        goto done;
    }
    snprintf(rest, sizeof rest, "%zu, %zu", beams, bins);
    size_t length = asdic_npy_header(header, "'<f4'", asdic_store_count(store), rest);
    fwrite(header, 1, length, asdic_file_stream(file));
    for (size_t i = 0; i < asdic_store_count(store) && status == ASDIC_OK; i++) {
        asdic_record record;
        status = asdic_store_read(store, i, bytes);
        if (status == ASDIC_OK) {
            asdic_record_view(bytes, beams, bins, &record);
            fwrite(record.level_db[ASDIC_TOTAL], sizeof(float), beams * bins,
                   asdic_file_stream(file));
        }
    }
    if (status == ASDIC_OK) {
        status = asdic_file_commit(&file);
    }
done:
    asdic_file_discard(&file);
    free(path);
    free(bytes);
    return status;
}
