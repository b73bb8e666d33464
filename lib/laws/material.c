#include "scatterer.h"

#include "base/context.h"
#include "base/try.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

asdic_material asdic_material_of(const asdic_law *law) {
    asdic_material material = {.law = law};
    for (size_t i = 0; i < ASDIC_MODEL_MAX_KEYS; i++) {
        material.value[i] = NAN;
    }
    return material;
}

/* What is known to be a key of the law. */
static void give(asdic_material *material, const char *key, double value) {
    material->value[asdic_law_key(material->law, key)] = value;
}

asdic_material asdic_material_bottom(double bottom_type) {
    asdic_material material = asdic_material_of(asdic_law_find("searay"));
    give(&material, "type", bottom_type);
    return material;
}

asdic_material asdic_material_facet(double impedance_mrayl, double roughness_rms_m,
                                    double slope_rms) {
    asdic_material material = asdic_material_of(asdic_law_find("rough-facet"));
    give(&material, "impedance_mrayl", impedance_mrayl);
    give(&material, "roughness_rms_mm", 1e3 * roughness_rms_m);
    give(&material, "slope_rms", slope_rms);
    return material;
}

double asdic_material_get(const asdic_material *material, const char *key) {
    size_t at = material && material->law && key ? asdic_law_key(material->law, key) : SIZE_MAX;
    return at < (at == SIZE_MAX ? 0 : material->law->model.key_count) ? material->value[at] : NAN;
}

asdic_status asdic_material_set(asdic_context *ctx, asdic_material *material, const char *key,
                                double value) {
    if (!material || !material->law || !key) {
        return asdic_fail_null(ctx, __func__);
    }
    size_t at = asdic_law_key(material->law, key);
    if (at == material->law->model.key_count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "the law '%s' has no '%s'",
                          material->law->name, key);
    }
    material->value[at] = value;
    return ASDIC_OK;
}

bool asdic_material_equal(const asdic_material *a, const asdic_material *b) {
    if (a->law != b->law || a->row_count != b->row_count) {
        return false;
    }
    for (size_t i = 0; a->law && i < a->law->model.key_count; i++) {
        bool neither = isnan(a->value[i]) && isnan(b->value[i]);
        if (!neither && a->value[i] != b->value[i]) {
            return false;
        }
    }
    return a->row_count == 0 || a->rows == b->rows ||
           memcmp(a->rows, b->rows, 2 * a->row_count * sizeof *a->rows) == 0;
}

const char *asdic_law_word(const asdic_model_key *key, double value, int *length) {
    const char *word = value == rint(value) ? key->words : NULL;
    for (double n = key->min; word && n < value; n++) {
        word = strchr(word, '|');
        word = word ? word + 1 : NULL;
    }
    *length = word ? (int)strcspn(word, "|") : 0;
    return word;
}

void asdic_material_describe(const asdic_material *material, char *text, size_t size) {
    const asdic_law *law = material ? material->law : NULL;
    snprintf(text, size, "%s", law ? law->name : "none");
    for (size_t i = 0; law && i < law->model.key_count; i++) {
        const asdic_model_key *key = &law->model.keys[i];
        bool is_usual = key->words && isnan(material->value[i]);
        double value = is_usual ? key->fallback : material->value[i]; /* a bottom is sand */
        if (!key->doc || isnan(value)) {
            continue;
        }
        int length = 0;
        const char *word = asdic_law_word(key, value, &length);
        if (word) {
            snprintf(text, size, "%.*s", length, word);
        } else {
            snprintf(text, size, "%s %.3g", key->name, value);
        }
        return;
    }
}

asdic_status asdic_material_read_table(asdic_context *ctx, asdic_material *material,
                                       const char *path, asdic_problems *problems) {
    const asdic_law *law = material ? material->law : NULL;
    double *rows = NULL;
    size_t *lines = NULL, count = 0;
    if (!law || !path || !law->table.count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no law that reads a file");
    }
    TRY(asdic_columns_read(ctx, path, &law->table, problems, &rows, &lines, &count));
    free(lines);
    if (rows) {
        material->rows = rows;
        material->row_count = count;
    }
    return ASDIC_OK;
}

asdic_status asdic_material_read_rows(asdic_context *ctx, asdic_material *material,
                                      const char *path) {
    asdic_problems problems = {.name = path};
    asdic_status status = asdic_material_read_table(ctx, material, path, &problems);
    status = status ? status : asdic_problems_fail(&problems, ctx);
    asdic_problems_finish(&problems);
    return status;
}

static const struct {
    unsigned use;
    const char *words;
} uses[] = {{ASDIC_LAW_BOTTOM, "a bottom"},
            {ASDIC_LAW_OBJECT, "an object"},
            {ASDIC_LAW_SURFACE, "the sea surface"}};

asdic_status asdic_material_check_use(asdic_context *ctx, const asdic_material *material,
                                      unsigned use) {
    /* A bottom, as of facets, may be of what objects are. */
    unsigned fits = use == ASDIC_LAW_BOTTOM ? ASDIC_LAW_BOTTOM | ASDIC_LAW_OBJECT : use;
    TRY(asdic_material_check(ctx, material));
    if (material->law->uses & fits) {
        return ASDIC_OK;
    }
    char names[256] = "";
    size_t used = 0, u = 0;
    for (size_t i = 0; i < asdic_law_count() && used < sizeof names; i++) {
        asdic_law_info law = asdic_law_get_info(asdic_law_get(i));
        used += law.uses & fits ? (size_t)snprintf(names + used, sizeof names - used, "%s%s",
                                                   used ? ", " : "", law.name)
                                : 0;
    }
    while (uses[u].use != use) {
        u++;
    }
    return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s is no law of %s; those are %s",
                      material->law->name, uses[u].words, names);
}

/* The same limits as in a file, of COLUMNS. */
static asdic_status check_rows(asdic_context *ctx, const asdic_material *material,
                               const char *columns) {
    const char *name = material->law->name;
    const asdic_columns *table = &material->law->table;
    double before = -INFINITY;
    if (!material->rows || material->row_count == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: no rows of %s", name, columns);
    }
    for (size_t i = 0; i < material->row_count; i++) {
        const double *row = material->rows + i * table->count;
        for (size_t c = 0; c < table->count; c++) {
            const asdic_column *column = &table->items[c];
            if (!(row[c] >= column->min && row[c] <= column->max)) {
                return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                                  "%s: row %zu: '%s' = %g is out of range [%g, %g]", name, i + 1,
                                  column->name, row[c], column->min, column->max);
            }
        }
        if (!(row[0] > before)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: row %zu: '%s' = %g is not %s %g",
                              name, i + 1, table->items[0].name, row[0], table->rises, before);
        }
        before = row[0];
    }
    return ASDIC_OK;
}

asdic_status asdic_material_check(asdic_context *ctx, const asdic_material *material) {
    if (!material || !material->law) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a material without a scattering law");
    }
    const asdic_model_info *model = &material->law->model;
    for (size_t i = 0; i < model->key_count; i++) {
        const asdic_model_key *key = &model->keys[i];
        double value = material->value[i];
        if (!isnan(value) && !(value >= key->min && value <= key->max)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "%s: '%s' = %g is out of range [%g, %g]%s%s", material->law->name,
                              key->name, value, key->min, key->max, key->unit ? " " : "",
                              key->unit ? key->unit : "");
        }
        if (key->columns) {
            TRY(check_rows(ctx, material, key->columns));
        }
    }
    return ASDIC_OK;
}
