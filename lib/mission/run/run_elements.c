#include "run_elements.h"

#include "base/context.h"
#include "base/file_name.h"
#include "sim/coherent.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC 10 /* bytes before an NPY header's text */

struct asdic_elements {
    asdic_elements_shape shape;
    asdic_records *records;
};

asdic_elements_shape asdic_elements_shape_of(const asdic_settings *settings, size_t pings,
                                             size_t bins, double sound_speed_mps) {
    if (!settings->elements) {
        return (asdic_elements_shape){0};
    }
    asdic_coherent_grid grid = asdic_coherent_grid_of(&settings->sonar, sound_speed_mps, bins);
    return (asdic_elements_shape){pings, settings->sonar.array.elements, grid.samples};
}

asdic_status asdic_elements_shape_read(asdic_context *ctx, const char *folder,
                                       const asdic_settings *settings, asdic_elements_shape *out) {
    char header[128] = "";
    *out = (asdic_elements_shape){0};
    if (!settings->elements) {
        return ASDIC_OK;
    }
    asdic_file_name path = asdic_file_in(folder, ASDIC_ELEMENTS_NAME);
    FILE *file = fopen(path.text, "rb");
    size_t length = file ? fread(header, 1, sizeof header - 1, file) : 0;
    const char *shape = length > MAGIC ? strstr(header + MAGIC, "(") : NULL;
    bool is_read =
        shape && sscanf(shape, "(%zu, %zu, %zu", &out->pings, &out->elements, &out->samples) == 3;
    if (file) {
        fclose(file);
    }
    return is_read && out->elements == settings->sonar.array.elements
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_INPUT, "'%s' is missing or damaged", path.text);
}

uint64_t asdic_elements_bytes(const asdic_elements_shape *shape) {
    return (uint64_t)shape->elements * shape->samples * 2 * sizeof(float);
}

asdic_status asdic_elements_open(asdic_context *ctx, const char *folder, asdic_store_mode mode,
                                 const asdic_elements_shape *shape, asdic_elements **out) {
    char rest[64];
    *out = NULL;
    if (shape->elements == 0) {
        return ASDIC_OK;
    }
    asdic_elements *e = *out = calloc(1, sizeof *e);
    if (!e) {
        return asdic_fail_memory(ctx, ASDIC_ELEMENTS_NAME);
    }
    snprintf(rest, sizeof rest, "%zu, %zu", shape->elements, shape->samples);
    const asdic_records_shape records = {ASDIC_ELEMENTS_NAME, "'<c8'", rest,
                                         (size_t)asdic_elements_bytes(shape)};
    e->shape = *shape;
    asdic_status status = asdic_records_open(ctx, folder, mode, &records, &e->records);
    if (!status && mode == ASDIC_STORE_RESUME) {
        status = asdic_records_cut(e->records, shape->pings);
    }
    if (status) {
        asdic_elements_close(out);
    }
    return status;
}

asdic_elements_shape asdic_elements_shape_now(const asdic_elements *e) {
    return e ? e->shape : (asdic_elements_shape){0};
}

bool asdic_elements_has(const asdic_elements *e, size_t index) {
    return !e || index < asdic_records_count(e->records);
}

bool asdic_elements_complete(asdic_context *ctx, const char *folder,
                             const asdic_elements_shape *shape) {
    asdic_elements *e = NULL;
    bool is_whole = asdic_elements_open(ctx, folder, ASDIC_STORE_READ, shape, &e) == ASDIC_OK &&
                    asdic_elements_has(e, shape->pings - 1);
    asdic_elements_close(&e);
    return is_whole;
}

asdic_status asdic_elements_write(asdic_elements *e, size_t index, const float *pressure) {
    return e ? asdic_records_write(e->records, index, pressure) : ASDIC_OK;
}

asdic_status asdic_elements_read(asdic_elements *e, size_t index, float *pressure) {
    return asdic_records_read(e->records, index, pressure);
}

asdic_status asdic_elements_commit(asdic_elements *e) {
    return e ? asdic_records_commit(e->records) : ASDIC_OK;
}

void asdic_elements_close(asdic_elements **elements) {
    if (elements && *elements) {
        asdic_records_close(&(*elements)->records);
        free(*elements);
        *elements = NULL;
    }
}
