#include "model_table.h"
#include "model_law.h"

#include "base/context.h"
#include "base/try.h"
#include "base/words.h"
#include "ocl/ocl.h"

#include "../../kernels/formulas.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(MODEL_KEYS == ASDIC_MODEL_MAX_KEYS, "host and device disagree on the keys");

/* Rows of laws that a slip of a name is compared with. */
#define LAWS_MOST 64

static asdic_status find_model(asdic_context *ctx, const char *name, size_t *out) {
    const char *names[MODEL_COUNT + LAWS_MOST];
    size_t count = asdic_model_count() < MODEL_COUNT + LAWS_MOST ? asdic_model_count()
                                                                 : MODEL_COUNT + LAWS_MOST;
    for (size_t i = 0; i < count; i++) {
        names[i] = asdic_model_get(i)->name;
        if (strcmp(name, names[i]) == 0) {
            *out = i;
            return ASDIC_OK;
        }
    }
    size_t near = asdic_words_nearest(name, names, count);
    return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                      near < count ? "unknown model '%s'; did you mean '%s'?"
                                   : "unknown model '%s'; 'asdic model' lists them",
                      name, near < count ? names[near] : "");
}

/* "f_khz t_degc [variant=corrected|printed]". */
static void list_keys(const asdic_model_info *info, char *text, size_t size) {
    size_t used = 0;
    text[0] = '\0';
    for (size_t i = 0; i < info->key_count && used < size; i++) {
        const asdic_model_key *key = &info->keys[i];
        used += (size_t)snprintf(text + used, size - used, "%s%s%s%s%s%s", i ? " " : "",
                                 key->required ? "" : "[", key->name, key->words ? "=" : "",
                                 key->words ? key->words : "", key->required ? "" : "]");
    }
}

/* The position of WORD in "a|b|c", or -1. */
static int word_index(const char *words, const char *word) {
    size_t length = strlen(word);
    for (int i = 0; words; i++) {
        const char *end = strchr(words, '|');
        size_t n = end ? (size_t)(end - words) : strlen(words);
        if (n == length && strncmp(words, word, n) == 0) {
            return i;
        }
        words = end ? end + 1 : NULL;
    }
    return -1;
}

static asdic_status read_value(asdic_context *ctx, const asdic_model_info *info,
                               const asdic_model_key *key, const char *text, double *out) {
    if (key->columns) { /* a file, read with the law */
        *out = 0.0;
        return ASDIC_OK;
    }
    int word = word_index(key->words, text);
    if (word >= 0) {
        *out = key->min + word;
        return ASDIC_OK;
    }
    if (!key->numeric) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: '%s' = '%s' is not one of %s", info->name,
                          key->name, text, key->words);
    }
    if (!asdic_words_number(text, out)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: '%s' = '%s' is not a number%s%s",
                          info->name, key->name, text, key->words ? " nor one of " : "",
                          key->words ? key->words : "");
    }
    if (*out < key->min || *out > key->max) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: '%s' = %s is out of range [%g, %g]",
                          info->name, key->name, text, key->min, key->max);
    }
    return ASDIC_OK;
}

/* The key of "key=value", which must be one of INFO's. */
static asdic_status find_key(asdic_context *ctx, const asdic_model_info *info,
                             const char *assignment, size_t *out) {
    char name[64], keys[512];
    const char *names[ASDIC_MODEL_MAX_KEYS];
    const char *equals = strchr(assignment, '=');
    list_keys(info, keys, sizeof keys);
    if (!equals || equals == assignment) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: '%s' is not key=value; keys: %s",
                          info->name, assignment, keys);
    }
    snprintf(name, sizeof name, "%.*s", (int)(equals - assignment), assignment);
    for (size_t i = 0; i < info->key_count; i++) {
        names[i] = info->keys[i].name;
        if (strcmp(name, names[i]) == 0) {
            *out = i;
            return ASDIC_OK;
        }
    }
    size_t near = asdic_words_nearest(name, names, info->key_count);
    if (near < info->key_count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "%s: unknown key '%s'; did you mean '%s'? keys: %s", info->name, name,
                          names[near], keys);
    }
    return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: unknown key '%s'; keys: %s", info->name, name,
                      keys);
}

bool asdic_model_outside(const asdic_model_info *info, const double *values, char *text,
                         size_t size) {
    size_t used = 0;
    for (size_t i = 0; i < info->key_count && used < size; i++) {
        const asdic_model_key *key = &info->keys[i];
        if (values[i] < key->valid_min || values[i] > key->valid_max) {
            used += (size_t)snprintf(text + used, size - used, "%s'%s' = %g not in [%g, %g]",
                                     used ? ", " : "", key->name, values[i], key->valid_min,
                                     key->valid_max);
        }
    }
    return used > 0;
}

/* One warning, whatever the number of keys outside. */
static void warn_validity(asdic_context *ctx, const asdic_model_info *info, const double *values) {
    char keys[512];
    if (asdic_model_outside(info, values, keys, sizeof keys)) {
        asdic_log(ctx, ASDIC_LOG_WARNING, "%s: outside the validity of its source (%s), with %s",
                  info->name, info->source, keys);
    }
}

static asdic_status read_assignments(asdic_context *ctx, const asdic_model_info *info,
                                     const char *const *assignments, size_t count, double *values) {
    bool given[ASDIC_MODEL_MAX_KEYS] = {false};
    for (size_t i = 0; i < info->key_count; i++) {
        values[i] = info->keys[i].fallback;
    }
    for (size_t i = 0; i < count; i++) {
        size_t k = 0;
        TRY(find_key(ctx, info, assignments[i], &k));
        if (given[k]) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: key '%s' is given twice", info->name,
                              info->keys[k].name);
        }
        TRY(read_value(ctx, info, &info->keys[k], strchr(assignments[i], '=') + 1, &values[k]));
        given[k] = true;
    }
    const char *choice = NULL;
    for (size_t i = 0; i < info->key_count; i++) {
        if (given[i] && info->keys[i].chooses && choice) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: '%s' and '%s' exclude each other",
                              info->name, choice, info->keys[i].name);
        }
        choice = given[i] && info->keys[i].chooses ? info->keys[i].name : choice;
        if (info->keys[i].required && !given[i]) {
            char keys[512];
            list_keys(info, keys, sizeof keys);
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: key '%s' is missing; keys: %s",
                              info->name, info->keys[i].name, keys);
        }
    }
    warn_validity(ctx, info, values);
    return ASDIC_OK;
}

/* Which of radius, length, width, height and frequency (keys 1..5) each shape needs. */
static asdic_status check_target(asdic_context *ctx, const asdic_model_info *info,
                                 const double *values) {
    static const char *const needs[] = {"radius_m", "radius_m length_m f_khz",
                                        "width_m height_m f_khz", "radius_m f_khz"};
    const char *need = needs[(int)values[0]];
    for (size_t i = 1; i < info->key_count; i++) {
        const char *name = info->keys[i].name;
        if (isnan(values[i]) && strstr(need, name)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "%s: key '%s' is missing; this shape needs %s [c_mps]", info->name,
                              name, need);
        }
    }
    double ka = 2.0 * R_PI * 1e3 * values[5] / values[6] * values[1];
    if (ka < 10.0 && values[0] < 1.5) {
        asdic_log(ctx, ASDIC_LOG_WARNING,
                  "%s: ka = %.3g; geometric optics is within 0.5 dB above 10 only", info->name, ka);
    }
    return ASDIC_OK;
}

/* Whole looks; a shape for the K distribution; without one the null is exponential. */
static asdic_status check_detection(asdic_context *ctx, const asdic_model_info *info,
                                    double *values) {
    double *shape = &values[info->key_count - 1], looks = values[info->key_count - 2];
    if (looks != floor(looks)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: 'looks' = %g is not a whole number",
                          info->name, looks);
    }
    if (isnan(*shape) && values[0] == 1.0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: model=k needs a shape", info->name);
    }
    *shape = isnan(*shape) ? INFINITY : *shape;
    return ASDIC_OK;
}

static asdic_status check_together(asdic_context *ctx, size_t model, double *values) {
    const asdic_model_info *info = asdic_model_get(model);
    if (model == MODEL_TARGET_STRENGTH) {
        return check_target(ctx, info, values);
    }
    if (model == MODEL_PFA || model == MODEL_PD) {
        return check_detection(ctx, info, values);
    }
    return ASDIC_OK;
}

/* Keys in single precision; of angles whose cosine counts, what that lost goes along. */
static void round_keys(size_t model, const double *keys, size_t count, float *floats) {
    for (size_t i = 0; i < count * MODEL_KEYS; i++) {
        floats[i] = (float)keys[i];
    }
    if (model != MODEL_SURFACE_BACKSCATTER && model != MODEL_FACET_STRENGTH) {
        return;
    }
    for (size_t i = 0, angle = model == MODEL_SURFACE_BACKSCATTER ? 2 : 0; i < count; i++) {
        size_t at = i * MODEL_KEYS + angle;
        floats[i * MODEL_KEYS + MODEL_REST] = (float)(keys[at] - (double)floats[at]);
    }
}

/* What an evaluation holds on the device. */
typedef struct device_points {
    asdic_buffer *keys, *out;
    asdic_kernel *kernel;
} device_points;

/* FLOATS: the keys of COUNT points, then room for their values. */
static asdic_status run_on_device(asdic_device *device, device_points *d, size_t model,
                                  size_t count, float *floats) {
    size_t key_count = count * MODEL_KEYS;
    int number = (int)model;
    uint32_t points = (uint32_t)count;
    TRY(asdic_buffer_create(device, key_count * sizeof *floats, floats, &d->keys));
    TRY(asdic_buffer_create(device, count * sizeof *floats, NULL, &d->out));
    TRY(asdic_kernel_create(device, "model.cl", "", "model", &d->kernel));
    const asdic_kernel_arg args[] = {ASDIC_ARG_VALUE(number), ASDIC_ARG_BUFFER(d->keys),
                                     ASDIC_ARG_BUFFER(d->out), ASDIC_ARG_VALUE(points)};
    TRY(asdic_kernel_run(d->kernel, args, sizeof args / sizeof *args, count, 0));
    return asdic_buffer_read(d->out, 0, count * sizeof *floats, floats + key_count);
}

static asdic_status evaluate_on_device(asdic_device *device, size_t model, const double *keys,
                                       size_t count, double *out) {
    device_points d = {0};
    float *floats = malloc(count * (MODEL_KEYS + 1) * sizeof *floats);
    if (!floats) {
        return asdic_fail_memory(asdic_device_context(device), "the keys of a model");
    }
    round_keys(model, keys, count, floats);
    asdic_status status = run_on_device(device, &d, model, count, floats);
    for (size_t i = 0; !status && i < count; i++) {
        out[i] = floats[count * MODEL_KEYS + i];
    }
    asdic_kernel_destroy(&d.kernel);
    asdic_buffer_destroy(&d.out);
    asdic_buffer_destroy(&d.keys);
    free(floats);
    return status;
}

asdic_status asdic_model_evaluate_many(asdic_context *ctx, asdic_device *device, size_t model,
                                       const double *keys, size_t count, double *out) {
    if (model >= MODEL_COUNT || count > UINT32_MAX) { /* laws have asdic_law_strength_db */
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "model %zu of %d, %zu points", model,
                          MODEL_COUNT, count);
    }
    if (device) {
        return evaluate_on_device(device, model, keys, count, out);
    }
    for (size_t i = 0; i < count; i++) {
        out[i] = model_value((int)model, keys + i * MODEL_KEYS);
    }
    return ASDIC_OK;
}

/* A law at one angle, with the VALUES of its keys; the file it may have is in one of ASSIGNMENTS. */
static asdic_status evaluate_law(asdic_context *ctx, asdic_device *device, size_t model,
                                 const double *values, const char *const *assignments, size_t count,
                                 double *out) {
    bool mirror;
    const asdic_law *law = asdic_model_law(model, &mirror);
    asdic_material material = asdic_material_of(law);
    asdic_law_water water = {.frequency_hz = 1e5, .sound_speed_mps = 1500.0};
    double grazing_deg = 0.0;
    for (size_t k = 0; k < law->model.key_count; k++) {
        const asdic_model_key *key = &law->model.keys[k];
        if (key->columns) {
            for (size_t i = 0; i < count; i++) {
                size_t length = strlen(key->name);
                if (strncmp(assignments[i], key->name, length) == 0) {
                    TRY(asdic_material_read_rows(ctx, &material, assignments[i] + length + 1));
                }
            }
            continue;
        }
        double *to = strcmp(key->name, "f_khz") == 0         ? &water.frequency_hz
                     : strcmp(key->name, "c_mps") == 0       ? &water.sound_speed_mps
                     : strcmp(key->name, "wind_kn") == 0     ? &water.wind_speed_kn
                     : strcmp(key->name, "wind_mps") == 0    ? &water.wind_speed_kn
                     : strcmp(key->name, "grazing_deg") == 0 ? &grazing_deg
                                                             : &material.value[k];
        double scale = strcmp(key->name, "f_khz") == 0      ? 1e3
                       : strcmp(key->name, "wind_mps") == 0 ? 3600.0 / 1852.0
                                                            : 1.0;
        *to = scale * values[k];
    }
    water.wavelength_m = water.sound_speed_mps / water.frequency_hz;
    asdic_status status =
        mirror ? asdic_law_loss_db(ctx, device, &material, &water, grazing_deg, out)
               : asdic_law_strength_db(ctx, device, &material, &water, grazing_deg, out);
    free((double *)material.rows);
    return status;
}

asdic_status asdic_model_evaluate(asdic_context *ctx, asdic_device *device, const char *name,
                                  const char *const *assignments, size_t count, double *out) {
    bool good = name && out && (assignments || count == 0);
    for (size_t i = 0; good && i < count; i++) {
        good = assignments[i] != NULL;
    }
    if (!good) {
        return asdic_fail_null(ctx, __func__);
    }
    double values[ASDIC_MODEL_MAX_KEYS] = {0.0};
    size_t model = 0;
    TRY(find_model(ctx, name, &model));
    TRY(read_assignments(ctx, asdic_model_get(model), assignments, count, values));
    TRY(check_together(ctx, model, values));
    if (model >= MODEL_COUNT) {
        return evaluate_law(ctx, device, model, values, assignments, count, out);
    }
    return asdic_model_evaluate_many(ctx, device, model, values, 1, out);
}
