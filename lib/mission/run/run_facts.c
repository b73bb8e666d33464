#include "run_facts.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/text.h"
#include "base/vec.h"
#include "out/digits.h"
#include "out/file.h"
#include "run_statistics.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define SAMPLER_NAME(sampler, name) [sampler] = name,
const char *const asdic_run_sampler_names[ASDIC_RUN_SAMPLER_COUNT] = {ASDIC_SAMPLERS(SAMPLER_NAME)};
const char *const asdic_run_multipath_names[ASDIC_RUN_MULTIPATH_COUNT] = {
    [ASDIC_MULTIPATH_OFF] = "off",
    [ASDIC_MULTIPATH_FIRST] = "first",
    [ASDIC_MULTIPATH_BOUNDARIES] = "boundaries"};

const char *const asdic_run_time_names[ASDIC_RUN_TIME_COUNT] = {
    "plan", "setup", "simulate", "devices", "write", "pictures", "whole"};

double *asdic_run_time(asdic_run_times *t, size_t index) {
    double *const times[ASDIC_RUN_TIME_COUNT] = {&t->plan_s,    &t->setup_s, &t->simulate_s,
                                                 &t->devices_s, &t->write_s, &t->pictures_s,
                                                 &t->whole_s};
    return times[index];
}

const asdic_run_uncertain_key asdic_run_uncertain_keys[ASDIC_RUN_UNCERTAIN_COUNT] = {
    {"bottom", ASDIC_BOTTOM}, {"surface", ASDIC_SURFACE}, {"object", ASDIC_OBJECT}};

const char *asdic_run_sampler_name(asdic_sampler sampler) {
    return asdic_run_sampler_names[sampler];
}

const char *asdic_run_facts_differ(const asdic_run_facts *a, const asdic_run_facts *b) {
    if (strcmp(a->scene_hash, b->scene_hash) != 0) {
        return "scene file";
    }
    if (strcmp(a->geometry_hash, b->geometry_hash) != 0) {
        return "mesh, grid or track, or measured law";
    }
    if (a->sampling.seed != b->sampling.seed) {
        return "seed";
    }
    if (a->sampling.rays != b->sampling.rays || a->sampling.sampler != b->sampling.sampler ||
        a->sampling.multipath != b->sampling.multipath) {
        return "sampling";
    }
    if (a->refraction != b->refraction) {
        return "refraction";
    }
    if (a->beams != b->beams || a->bins != b->bins) {
        return "number of beams or bins";
    }
    if (a->plan.left_out != b->plan.left_out) {
        return "choice of terms";
    }
    return strcmp(a->version, b->version) != 0 ? "version of asdic" : NULL;
}

bool asdic_run_facts_add_device(asdic_run_facts *f, asdic_arena *arena, const char *device) {
    for (size_t i = 0; i < f->device_count; i++) {
        if (strcmp(f->devices[i], device) == 0) {
            return true;
        }
    }
    const char **more = asdic_arena_alloc(arena, (f->device_count + 1) * sizeof *more);
    const char *copy = asdic_arena_string(arena, device, strlen(device));
    if (!more || !copy) {
        return false;
    }
    for (size_t i = 0; i < f->device_count; i++) {
        more[i] = f->devices[i];
    }
    more[f->device_count++] = copy;
    f->devices = more;
    return true;
}

void asdic_run_facts_statistics(asdic_run_facts *facts, const asdic_statistics *statistics) {
    facts->rays_traced = statistics->rays;
    facts->saturated = statistics->saturated;
    facts->errors = statistics->errors;
}

/* ---- the sum of run.json: its last member, of all bytes before that member's line ------------- */

#define SUM_KEY "  \"crc32\": \""
#define SUM_DIGITS 8
#define SUM_END "\"\n}\n"

/* The line of the sum, which must be the last; NULL when there is none. */
static char *find_sum(char *text, size_t length) {
    const size_t line = sizeof SUM_KEY - 1 + SUM_DIGITS + sizeof SUM_END - 1;
    char *at = length > line ? text + length - line : NULL;
    return at && memcmp(at, SUM_KEY, sizeof SUM_KEY - 1) == 0 &&
                   memcmp(text + length - (sizeof SUM_END - 1), SUM_END, sizeof SUM_END - 1) == 0
               ? at
               : NULL;
}

static void print_sum(char digits[SUM_DIGITS + 1], const char *text, const char *end) {
    uint32_t sum = (uint32_t)crc32_z(0, (const unsigned char *)text, (size_t)(end - text));
    snprintf(digits, SUM_DIGITS + 1, "%08x", (unsigned)sum);
}

void asdic_run_facts_sign(char *text, size_t length) {
    char digits[SUM_DIGITS + 1], *line = find_sum(text, length);
    if (line) {
        print_sum(digits, text, line);
        memcpy(line + sizeof SUM_KEY - 1, digits, SUM_DIGITS);
    }
}

bool asdic_run_facts_signed(char *text, size_t length) {
    char digits[SUM_DIGITS + 1], *line = find_sum(text, length);
    if (!line) {
        return false;
    }
    print_sum(digits, text, line);
    return memcmp(line + sizeof SUM_KEY - 1, digits, SUM_DIGITS) == 0;
}

/* ---- writing: one member a line ------------------------------------------------------------- */

static void add_text(asdic_text *json, const char *key, const char *value) {
    asdic_text_format(json, "  \"%s\": ", key);
    asdic_text_add_json(json, value);
    asdic_text_add(json, ",\n");
}

static void add_natural(asdic_text *json, const char *key, uint64_t value) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_digits_natural(digits, value);
    asdic_text_format(json, "  \"%s\": %s,\n", key, digits);
}

static const char *number_or_null(char digits[ASDIC_DIGITS_SIZE], const char *format,
                                  double value) {
    if (!isfinite(value)) {
        return "null";
    }
    asdic_digits_print(digits, format, value);
    return digits;
}

static void add_scene(asdic_text *json, const asdic_run_facts *facts) {
    asdic_text_add(json, "  \"scene\": {\n    \"path\": ");
    asdic_text_add_json(json, facts->scene_path);
    asdic_text_format(json, ",\n    \"sha256\": \"%s\",\n    \"geometry_sha256\": \"%s\",\n",
                      facts->scene_hash, facts->geometry_hash);
    asdic_text_add(json, "    \"text\": ");
    asdic_text_add_json(json, facts->scene_text);
    asdic_text_add(json, "\n  },\n");
}

/* null without a law. */
static void add_law(asdic_text *json, const char *key, const asdic_material *material) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_law_info law = asdic_law_get_info(material->law);
    if (!material->law) {
        asdic_text_format(json, "  \"%s\": null,\n", key);
        return;
    }
    asdic_text_format(json, "  \"%s\": {\"law\": \"%s\"", key, law.name);
    for (size_t i = 0; i < law.model->key_count; i++) {
        if (!isnan(material->value[i])) {
            asdic_text_format(json, ", \"%s\": %s", law.model->keys[i].name,
                              number_or_null(digits, "%.17g", material->value[i]));
        }
    }
    for (size_t i = 0; i < 2 * material->row_count; i++) {
        asdic_text_format(json, "%s%s", i ? ", " : ", \"rows\": [",
                          number_or_null(digits, "%.17g", material->rows[i]));
    }
    asdic_text_add(json, material->row_count ? "]},\n" : "},\n");
}

/* By component; null where no source says how far it errs. */
static void add_uncertainty(asdic_text *json, const asdic_uncertainty *uncertainty) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_text_add(json, "  \"model_uncertainty_db\": {");
    for (size_t i = 0; i < ASDIC_RUN_UNCERTAIN_COUNT; i++) {
        asdic_text_format(
            json, "%s\"%s\": %s", i ? ", " : "", asdic_run_uncertain_keys[i].name,
            number_or_null(digits, "%.4g", uncertainty->db[asdic_run_uncertain_keys[i].component]));
    }
    asdic_text_add(json, "},\n");
}

static void add_devices(asdic_text *json, const asdic_run_facts *facts) {
    asdic_text_add(json, "  \"devices\": [");
    for (size_t i = 0; i < facts->device_count; i++) {
        asdic_text_add(json, i ? ", " : "");
        asdic_text_add_json(json, facts->devices[i]);
    }
    asdic_text_add(json, "],\n");
}

static void add_remarks(asdic_text *json, const asdic_remarks *remarks) {
    asdic_text_add(json, "  \"remarks\": [");
    for (size_t i = 0; i < remarks->count; i++) {
        asdic_text_add(json, i ? ",\n    " : "\n    ");
        asdic_text_add_json(json, remarks->text[i]);
    }
    asdic_text_add(json, remarks->count ? "\n  ],\n" : "],\n");
}

static void add_terms(asdic_text *json, const asdic_plan *plan) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_text_add(json, "  \"terms\": [\n");
    for (int t = 0; t < ASDIC_TERM_COUNT; t++) {
        const asdic_plan_row *row = &plan->rows[t];
        asdic_text_add(json, "    {\"name\": ");
        asdic_text_add_json(json, asdic_term_name((asdic_term)t));
        asdic_text_format(
            json, ", \"kept\": %s, \"bound_db\": %s, \"reason\": ", row->kept ? "true" : "false",
            number_or_null(digits, "%.3g", row->bound_db));
        asdic_text_add_json(json, row->reason);
        asdic_text_add(json, t + 1 < ASDIC_TERM_COUNT ? "},\n" : "}\n  ],\n");
    }
}

static void add_scan(asdic_text *json, const asdic_run_facts *facts) {
    const asdic_sweep *s = &facts->sweep;
    char step[ASDIC_DIGITS_SIZE];
    if (s->directions) {
        asdic_digits_print(step, "%.10g", s->step_rad * 180.0 / ASDIC_PI);
        asdic_text_format(json,
                          "  \"scan\": {\"directions\": %zu, \"step_deg\": %s, \"circle\": %s},\n",
                          s->directions, step, s->is_circle ? "true" : "false");
    }
}

static void add_elements(asdic_text *json, const asdic_run_elements *e) {
    char a[ASDIC_DIGITS_SIZE], b[ASDIC_DIGITS_SIZE], c[ASDIC_DIGITS_SIZE];
    if (e->sample_m > 0.0) {
        asdic_digits_print(a, "%.17g", e->spacing_m);
        asdic_digits_print(b, "%.17g", e->sample_m);
        asdic_digits_print(c, "%.17g", e->wavelength_m);
        asdic_text_format(
            json, "  \"elements\": {\"spacing_m\": %s, \"sample_m\": %s, \"wavelength_m\": %s},\n",
            a, b, c);
    }
}

static void add_results(asdic_text *json, const asdic_run_facts *facts) {
    asdic_run_times times = facts->times;
    char a[ASDIC_DIGITS_SIZE], b[ASDIC_DIGITS_SIZE], c[ASDIC_DIGITS_SIZE];
    asdic_text_add(json, "  \"time_s\": {");
    for (size_t i = 0; i < ASDIC_RUN_TIME_COUNT; i++) {
        asdic_text_format(json, "%s\"%s\": %s", i ? ", " : "", asdic_run_time_names[i],
                          number_or_null(a, "%.3f", *asdic_run_time(&times, i)));
    }
    asdic_text_add(json, "},\n");
    asdic_text_format(json, "  \"rays_per_s\": %s,\n",
                      number_or_null(a, "%.0f", facts->rays_per_s));
    asdic_text_format(json, "  \"stderr_db\": {\"median\": %s, \"worst\": %s, \"rms\": %s},\n",
                      number_or_null(a, "%.4g", facts->errors.median_db),
                      number_or_null(b, "%.4g", facts->errors.worst_db),
                      number_or_null(c, "%.4g", facts->errors.rms_db));
}

static void add_files(asdic_text *json, const asdic_run_facts *facts) {
    asdic_text_add(json, "  \"files\": [");
    for (size_t i = 0; i < facts->file_count; i++) {
        const asdic_run_file *file = &facts->files[i];
        char bytes[ASDIC_DIGITS_SIZE];
        asdic_digits_natural(bytes, file->sum.bytes);
        asdic_text_format(json, "%s    {\"name\": \"%s\", \"bytes\": %s, \"crc32\": \"%08x\"}",
                          i ? ",\n" : "\n", file->name, bytes, (unsigned)file->sum.crc32);
    }
    asdic_text_add(json, facts->file_count ? "\n  ],\n  \"pictures\": [" : "],\n  \"pictures\": [");
    for (size_t i = 0; i < facts->picture_count; i++) {
        asdic_text_add(json, i ? ", " : "");
        asdic_text_add_json(json, facts->pictures[i]);
    }
    asdic_text_add(json, "],\n");
}

static void add_refraction(asdic_text *json, const asdic_run_facts *facts) {
    char a[ASDIC_DIGITS_SIZE], b[ASDIC_DIGITS_SIZE];
    bool fitted = facts->refraction == ASDIC_REFRACTION_LAYER;
    add_text(json, "refraction", asdic_refraction_name(facts->refraction));
    asdic_text_format(json, "  \"layer_m\": {\"from\": %s, \"to\": %s},\n",
                      number_or_null(a, "%.17g", fitted ? facts->layer_from_m : NAN),
                      number_or_null(b, "%.17g", fitted ? facts->layer_to_m : NAN));
}

asdic_status asdic_run_facts_write(asdic_context *ctx, const char *folder,
                                   const asdic_run_facts *facts) {
    asdic_text json = {0};
    char digits[ASDIC_DIGITS_SIZE];
    asdic_text_add(&json, "{\n");
    add_text(&json, "version", facts->version);
    add_text(&json, "state", facts->state);
    add_scene(&json, facts);
    asdic_text_format(&json, "  \"surface\": %s,\n", facts->has_surface ? "true" : "false");
    add_text(&json, "bottom", facts->bottom);
    add_law(&json, "bottom_law", &facts->bottom_law);
    add_law(&json, "surface_law", &facts->surface_law);
    add_uncertainty(&json, &facts->uncertainty);
    add_natural(&json, "seed", facts->sampling.seed);
    add_natural(&json, "rays", facts->sampling.rays);
    add_text(&json, "sampler", asdic_run_sampler_names[facts->sampling.sampler]);
    add_text(&json, "multipath", asdic_run_multipath_names[facts->sampling.multipath]);
    add_refraction(&json, facts);
    add_natural(&json, "first_ping", facts->first_ping);
    add_natural(&json, "pings_planned", facts->pings_planned);
    add_natural(&json, "pings", facts->pings);
    add_natural(&json, "whole_first_ping", facts->whole_first_ping);
    add_natural(&json, "whole_pings", facts->whole_pings);
    add_natural(&json, "rays_traced", facts->rays_traced);
    add_natural(&json, "saturated", facts->saturated);
    add_devices(&json, facts);
    add_remarks(&json, &facts->remarks);
    add_terms(&json, &facts->plan);
    add_results(&json, facts);
    add_scan(&json, facts);
    add_natural(&json, "beams", facts->beams);
    add_natural(&json, "bins", facts->bins);
    asdic_text_format(&json, "  \"bin_length_m\": %s,\n",
                      number_or_null(digits, "%.17g", facts->bin_length_m));
    add_elements(&json, &facts->elements);
    add_files(&json, facts);
    asdic_text_add(&json, SUM_KEY "00000000" SUM_END);
    if (!json.failed) {
        asdic_run_facts_sign(json.data, json.length);
    }
    return asdic_file_write_text(ctx, asdic_file_in(folder, "run.json").text, &json, "run.json",
                                 false);
}
