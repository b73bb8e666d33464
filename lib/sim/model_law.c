#include "model_law.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "ocl/ocl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

typedef struct reading {
    asdic_buffer *tables, *angles, *values;
    asdic_kernel *kernel;
    float *numbers; /* sine and squared cosine of each angle, then the values */
} reading;

static asdic_status read_table(asdic_device *device, const asdic_law_words *tables, dev_uint at,
                               unsigned width, size_t count, reading *r) {
    char options[32];
    uint32_t first = at, points = (uint32_t)count;
    snprintf(options, sizeof options, "-D ASDIC_WIDTH=%u", width);
    TRY(asdic_buffer_create(device, tables->count * sizeof *tables->words, tables->words,
                            &r->tables));
    TRY(asdic_buffer_create(device, 2 * count * sizeof(float), r->numbers, &r->angles));
    TRY(asdic_buffer_create(device, count * sizeof(float), NULL, &r->values));
    TRY(asdic_kernel_create(device, "law.cl", options, "law", &r->kernel));
    const asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(r->tables), ASDIC_ARG_VALUE(first),
                                     ASDIC_ARG_BUFFER(r->angles), ASDIC_ARG_BUFFER(r->values),
                                     ASDIC_ARG_VALUE(points)};
    TRY(asdic_kernel_run(r->kernel, args, sizeof args / sizeof *args, (count + width - 1) / width,
                         0));
    return asdic_buffer_read(r->values, 0, count * sizeof(float), r->numbers + 2 * count);
}

asdic_status asdic_law_table_read(asdic_device *device, const asdic_law_words *tables, dev_uint at,
                                  unsigned width, const double *grazing_rad, size_t count,
                                  double *out) {
    reading r = {.numbers = malloc(3 * count * sizeof(float))};
    if (!r.numbers) {
        return asdic_fail_memory(asdic_device_context(device), "the angles of a law");
    }
    for (size_t i = 0; i < count; i++) {
        double cosine = sin(0.5 * ASDIC_PI - grazing_rad[i]);
        r.numbers[2 * i] = (float)sin(grazing_rad[i]);
        r.numbers[2 * i + 1] = (float)(cosine * cosine);
    }
    asdic_status status = read_table(device, tables, at, width, count, &r);
    for (size_t i = 0; !status && i < count; i++) {
        out[i] = r.numbers[2 * count + i];
    }
    asdic_kernel_destroy(&r.kernel);
    asdic_buffer_destroy(&r.values);
    asdic_buffer_destroy(&r.angles);
    asdic_buffer_destroy(&r.tables);
    free(r.numbers);
    return status;
}

asdic_status asdic_law_strength_db(asdic_context *ctx, asdic_device *device,
                                   const asdic_material *material, const asdic_law_water *water,
                                   double grazing_deg, double *out) {
    TRY(asdic_material_check(ctx, material));
    asdic_scatterer s = asdic_scatterer_at(material, water);
    double grazing_rad = grazing_deg * (ASDIC_PI / 180.0), lin = 0.0;
    if (!device) {
        double cosine = sin((90.0 - grazing_deg) * (ASDIC_PI / 180.0));
        asdic_incidence at = asdic_incidence_on_plane(sin(grazing_rad), cosine * cosine);
        *out = 10.0 * log10(material->law->strength_lin(&s, &at));
        return ASDIC_OK;
    }
    asdic_law_words tables = {0};
    asdic_status status = asdic_law_tables_add(ctx, &s, &tables);
    status =
        status ? status
               : asdic_law_table_read(device, &tables, s.device.strength, 1, &grazing_rad, 1, &lin);
    *out = 10.0 * log10(lin);
    free(tables.words);
    return status;
}

static double smooth(const void *of, double sine, double cos2) {
    const asdic_scatterer *s = of;
    (void)cos2;
    return s->material.law->smooth_reflected(s, sine);
}

asdic_status asdic_law_loss_db(asdic_context *ctx, asdic_device *device,
                               const asdic_material *material, const asdic_law_water *water,
                               double grazing_deg, double *out) {
    TRY(asdic_material_check(ctx, material));
    asdic_scatterer s = asdic_scatterer_at(material, water);
    double grazing_rad = grazing_deg * (ASDIC_PI / 180.0);
    double lin = smooth(&s, sin(grazing_rad), 0.0);
    asdic_status status = ASDIC_OK;
    if (device) {
        asdic_law_words tables = {0};
        dev_uint at = 0;
        for (int i = 0; !status && i < 2; i++) { /* none lies at word 0 */
            status = asdic_law_table_add(ctx, smooth, &s, NULL, 0, &tables, &at);
        }
        status =
            status ? status : asdic_law_table_read(device, &tables, at, 1, &grazing_rad, 1, &lin);
        free(tables.words);
    }
    *out = -10.0 * log10(lin);
    return status;
}
