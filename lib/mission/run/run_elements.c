#include "run_elements.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/try.h"
#include "sim/coherent.h"

#include <stdio.h>
#include <string.h>

#define MAGIC 10 /* bytes before an NPY header's text */

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
                                 const asdic_elements_shape *shape, asdic_records **out) {
    char rest[64];
    *out = NULL;
    if (shape->elements == 0) {
        return ASDIC_OK;
    }
    snprintf(rest, sizeof rest, "%zu, %zu", shape->elements, shape->samples);
    const asdic_records_shape records = {ASDIC_ELEMENTS_NAME, "'<c8'", rest,
                                         (size_t)asdic_elements_bytes(shape)};
    TRY(asdic_records_open(ctx, folder, mode, &records, out));
    asdic_status status =
        mode == ASDIC_STORE_RESUME ? asdic_records_cut(*out, shape->pings) : ASDIC_OK;
    if (status) {
        asdic_records_close(out);
    }
    return status;
}

bool asdic_elements_complete(asdic_context *ctx, const char *folder,
                             const asdic_elements_shape *shape) {
    asdic_records *e = NULL;
    bool is_whole = asdic_elements_open(ctx, folder, ASDIC_STORE_READ, shape, &e) == ASDIC_OK &&
                    (!e || asdic_records_count(e) >= shape->pings);
    asdic_records_close(&e);
    return is_whole;
}
