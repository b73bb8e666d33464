/*
 * Every line of formulas.txt through the public API: in double on the host, or with "device" as
 * second argument in single precision there.
 */
#include "asserts.h"
#include "test_device.h"

#include <asdic/model.h>

#include <unistd.h>

typedef struct vector {
    char text[512]; /* the line, cut into words */
    const char *name;
    const char *keys[ASDIC_MODEL_MAX_KEYS];
    size_t key_count;
    double expected, absolute, relative;
} vector;

static const char *vector_path; /* files that its lines name lie beside it */
static test_device place;       /* its device is NULL on the host */

/* false for comments and blank lines. */
static bool parse(const char *line, vector *out) {
    snprintf(out->text, sizeof out->text, "%s", line);
    char *comment = strchr(out->text, '#');
    if (!comment || comment == out->text) {
        return false;
    }
    *comment = '\0';
    char *rest = NULL;
    out->name = strtok_r(out->text, " ", &rest);
    out->key_count = 0;
    for (char *word; (word = strtok_r(NULL, " ", &rest)) && strcmp(word, "=") != 0;) {
        assert_true(out->key_count < ASDIC_MODEL_MAX_KEYS);
        out->keys[out->key_count++] = word;
    }
    assert_int_equal(sscanf(rest, "%lf %lf %lf", &out->expected, &out->absolute, &out->relative),
                     3);
    return true;
}

/* What single precision may cost: 1e-3 dB, or 1e-5 of other units. */
static void widen(vector *v, bool decibel) {
    v->absolute += decibel ? 1e-3 : 1e-30;
    v->relative += decibel ? 0.0 : 1e-5;
}

/* Of one formula: values met, the largest error where many digits are known, and the largest share of
 * a tolerance. */
typedef struct record {
    size_t values;
    double error, share;
} record;

enum { MOST_MODELS = 64 };

static size_t model_number(const char *name) {
    size_t i = 0;
    while (i < asdic_model_count() && strcmp(asdic_model_get(i)->name, name) != 0) {
        i++;
    }
    return i;
}

static void note(record *r, double off, double allowed, bool exact) {
    r->values++;
    r->error = exact ? fmax(r->error, off) : r->error;
    r->share = allowed > 0.0 ? fmax(r->share, off / allowed) : r->share;
}

static void print_records(const record *records) {
    for (size_t i = 0; i < asdic_model_count(); i++) {
        print_message("%-20s %3zu values, largest error %.2g %s, %.2f of a tolerance\n",
                      asdic_model_get(i)->name, records[i].values, records[i].error,
                      asdic_model_get(i)->unit, records[i].share);
    }
}

static void formulas_meet_independent_values(void **state) {
    (void)state;
    size_t lines = 0, wrong = 0;
    record records[MOST_MODELS] = {{0}};
    char line[512];
    FILE *file = fopen(vector_path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        vector v;
        double values[2] = {NAN, -1.0}; /* the second is left alone */
        if (!parse(line, &v)) {
            continue;
        }
        size_t model = model_number(v.name);
        bool exact = v.absolute + v.relative * fabs(v.expected) < 1e-4;
        assert_true(model < asdic_model_count() && model < MOST_MODELS);
        if (place.device) {
            widen(&v, strcmp(asdic_model_get(model)->unit, "dB") == 0);
        }
        asdic_status status =
            asdic_model_evaluate(place.ctx, place.device, v.name, v.keys, v.key_count, values);
        double value = values[0];
        assert_true(values[1] == -1.0);
        double off = value == v.expected ? 0.0 : fabs(value - v.expected);
        double allowed = v.absolute + v.relative * fabs(v.expected);
        bool met = status == ASDIC_OK && (off == 0.0 || off <= allowed);
        note(&records[model], off, allowed, exact);
        if (!met) {
            print_error("got %.17g (%s) for: %s", value,
                        status == ASDIC_OK ? "off" : asdic_context_error(place.ctx), line);
        }
        wrong += !met;
        lines++;
    }
    fclose(file);
    print_records(records);
    assert_true(lines >= 200);
    assert_int_equal(wrong, 0);
}

int main(int argc, char **argv) {
    bool on_device = argc == 3 && strcmp(argv[2], "device") == 0;
    if (argc != 2 && !on_device) {
        return 1;
    }
    vector_path = argv[1];
    if (on_device) {
        place = test_device_open_or_skip();
    } else if (asdic_context_create(&place.ctx) != ASDIC_OK) {
        return 1;
    }
    const char *slash = strrchr(vector_path, '/');
    char folder[4096];
    snprintf(folder, sizeof folder, "%.*s", slash ? (int)(slash - vector_path) : 1,
             slash ? vector_path : ".");
    if (chdir(folder) != 0) {
        return 1;
    }
    vector_path = slash ? slash + 1 : vector_path;
    const struct CMUnitTest tests[] = {cmocka_unit_test(formulas_meet_independent_values)};
    return test_device_end(&place, cmocka_run_group_tests(tests, NULL, NULL));
}
