#include "run_facts.h"

#include "base/context.h"
#include "base/file_read.h"
#include "base/number.h"
#include "base/text.h"
#include "base/vec.h"
#include "out/digits.h"
#include "out/file.h"
#include "base/problems.h"
#include "run_folder.h"
#include "run_statistics.h"
#include "mission/scene_file/yaml_tree.h"

#include <errno.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define COUNT_OF(array) ((int)(sizeof(array) / sizeof *(array)))

/* The scene file's text is at most 4 MiB and may double when escaped. */
#define MAX_BYTES ((size_t)16 << 20)

#define SAMPLER_NAME(sampler, name) [sampler] = name,
static const char *const sampler_names[] = {ASDIC_SAMPLERS(SAMPLER_NAME)};
static const char *const multipath_names[] = {[ASDIC_MULTIPATH_OFF] = "off",
                                              [ASDIC_MULTIPATH_FIRST] = "first",
                                              [ASDIC_MULTIPATH_BOUNDARIES] = "boundaries"};

static const struct {
    const char *name;
    size_t at;
} times[] = {{"setup", offsetof(asdic_run_times, setup_s)},
             {"simulate", offsetof(asdic_run_times, simulate_s)},
             {"devices", offsetof(asdic_run_times, devices_s)},
             {"write", offsetof(asdic_run_times, write_s)},
             {"pictures", offsetof(asdic_run_times, pictures_s)},
             {"whole", offsetof(asdic_run_times, whole_s)}};

const char *asdic_run_sampler_name(asdic_sampler sampler) {
    return sampler_names[sampler];
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
    return strcmp(a->version, b->version) != 0 ? "version of asdic" : NULL;
}

void asdic_run_facts_statistics(asdic_run_facts *facts, const asdic_statistics *statistics) {
    facts->rays_traced = statistics->rays;
    facts->saturated = statistics->saturated;
    facts->stderr_median_db = statistics->stderr_median_db;
    facts->stderr_worst_db = statistics->stderr_worst_db;
    facts->stderr_rms_db = statistics->stderr_rms_db;
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

static bool is_signed(char *text, size_t length) {
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

/* Components whose laws may state how far they err. */
static const struct {
    const char *name;
    asdic_component component;
} uncertain[] = {{"bottom", ASDIC_BOTTOM}, {"surface", ASDIC_SURFACE}, {"object", ASDIC_OBJECT}};
#define UNCERTAIN (sizeof uncertain / sizeof *uncertain)

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
    for (size_t i = 0; i < UNCERTAIN; i++) {
        asdic_text_format(json, "%s\"%s\": %s", i ? ", " : "", uncertain[i].name,
                          number_or_null(digits, "%.4g", uncertainty->db[uncertain[i].component]));
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

static void add_results(asdic_text *json, const asdic_run_facts *facts) {
    char a[ASDIC_DIGITS_SIZE], b[ASDIC_DIGITS_SIZE], c[ASDIC_DIGITS_SIZE];
    asdic_text_add(json, "  \"time_s\": {");
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        double time_s = *(const double *)((const char *)&facts->times + times[i].at);
        asdic_text_format(json, "%s\"%s\": %s", i ? ", " : "", times[i].name,
                          number_or_null(a, "%.3f", time_s));
    }
    asdic_text_add(json, "},\n");
    asdic_text_format(json, "  \"rays_per_s\": %s,\n",
                      number_or_null(a, "%.0f", facts->rays_per_s));
    asdic_text_format(json, "  \"stderr_db\": {\"median\": %s, \"worst\": %s, \"rms\": %s},\n",
                      number_or_null(a, "%.4g", facts->stderr_median_db),
                      number_or_null(b, "%.4g", facts->stderr_worst_db),
                      number_or_null(c, "%.4g", facts->stderr_rms_db));
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
    add_text(&json, "sampler", sampler_names[facts->sampling.sampler]);
    add_text(&json, "multipath", multipath_names[facts->sampling.multipath]);
    add_refraction(&json, facts);
    add_natural(&json, "first_ping", facts->first_ping);
    add_natural(&json, "pings_planned", facts->pings_planned);
    add_natural(&json, "pings", facts->pings);
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
    add_files(&json, facts);
    asdic_text_add(&json, SUM_KEY "00000000" SUM_END);
    size_t length = json.length;
    char *all = asdic_text_take(&json);
    if (all) {
        asdic_run_facts_sign(all, length);
    }
    char *path = asdic_folder_file(folder, "run.json");
    asdic_status status = all && path ? asdic_file_write_all(ctx, path, all, length)
                                      : asdic_fail_memory(ctx, "run.json");
    free(path);
    free(all);
    return status;
}

/* ---- reading -------------------------------------------------------------------------------- */

typedef struct reader {
    const asdic_yaml_node *root;
    const char *missing; /* first key that is not there or not what it should be */
} reader;

static const char *read_text(reader *r, const asdic_yaml_node *map, const char *key) {
    const asdic_yaml_node *node = asdic_yaml_child(map, key);
    if (!node || node->kind != ASDIC_YAML_SCALAR) {
        r->missing = r->missing ? r->missing : key;
        return "";
    }
    return node->text;
}

static uint64_t read_natural(reader *r, const char *key) {
    const char *text = read_text(r, r->root, key);
    char *end;
    errno = 0;
    uint64_t value = strtoull(text, &end, 10);
    if (end == text || *end || errno || text[0] == '-') {
        r->missing = r->missing ? r->missing : key;
        return 0;
    }
    return value;
}

/* NAN for null, and for what is no number. */
static double read_number(reader *r, const asdic_yaml_node *map, const char *key) {
    const char *text = read_text(r, map, key);
    double value;
    return asdic_number_parse(text, strlen(text), &value) ? NAN : value;
}

static void read_rows(reader *r, asdic_arena *arena, const asdic_yaml_node *list,
                      asdic_material *material) {
    double *rows = list ? asdic_arena_alloc(arena, (list->count + 1) * sizeof *rows) : NULL;
    for (asdic_yaml_node *node = rows ? list->first : NULL; node; node = node->next) {
        bool good = node->text &&
                    asdic_number_parse(node->text, strlen(node->text), &rows[node->index]) == NULL;
        r->missing = good || r->missing ? r->missing : "rows";
    }
    material->rows = rows;
    material->row_count = rows ? list->count / 2 : 0;
}

/* Without a law where there is none. */
static void read_law(reader *r, asdic_arena *arena, const char *key, asdic_material *material) {
    const asdic_yaml_node *map = asdic_yaml_child(r->root, key);
    *material = (asdic_material){0};
    if (map && map->kind == ASDIC_YAML_SCALAR && strcmp(map->text, "null") == 0) {
        return;
    }
    *material = asdic_material_of(asdic_law_find(map ? read_text(r, map, "law") : ""));
    const asdic_model_info *model = asdic_law_get_info(material->law).model;
    for (size_t i = 0; model && i < model->key_count; i++) {
        const char *name = model->keys[i].name;
        material->value[i] = asdic_yaml_child(map, name) ? read_number(r, map, name) : NAN;
    }
    read_rows(r, arena, asdic_yaml_child(map, "rows"), material);
    if (!material->law || asdic_material_check(NULL, material) != ASDIC_OK) {
        r->missing = r->missing ? r->missing : key;
    }
}

static void read_uncertainty(reader *r, asdic_uncertainty *uncertainty) {
    const asdic_yaml_node *map = asdic_yaml_child(r->root, "model_uncertainty_db");
    for (size_t i = 0; i < ASDIC_COMPONENT_COUNT; i++) {
        uncertainty->db[i] = NAN;
    }
    for (size_t i = 0; map && i < UNCERTAIN; i++) {
        const asdic_yaml_node *node = asdic_yaml_child(map, uncertain[i].name);
        bool stated = node && node->text && strcmp(node->text, "null") != 0;
        if (stated) {
            uncertainty->db[uncertain[i].component] = read_number(r, map, uncertain[i].name);
        }
    }
}

static int read_word(reader *r, const char *key, const char *const *words, int count) {
    const char *text = read_text(r, r->root, key);
    for (int i = 0; i < count; i++) {
        if (strcmp(text, words[i]) == 0) {
            return i;
        }
    }
    r->missing = r->missing ? r->missing : key;
    return 0;
}

/* The texts of the list KEY; none where there is no such list. */
static const char **read_texts(reader *r, asdic_arena *arena, const char *key, size_t *count) {
    const asdic_yaml_node *list = asdic_yaml_child(r->root, key);
    *count = 0;
    if (!list || list->kind != ASDIC_YAML_LIST || list->count == 0) {
        return NULL;
    }
    const char **texts = asdic_arena_alloc(arena, list->count * sizeof *texts);
    for (asdic_yaml_node *node = list->first; node && texts; node = node->next) {
        texts[(*count)++] = node->text ? node->text : "";
    }
    return texts;
}

static void read_remarks(reader *r, asdic_remarks *remarks) {
    const asdic_yaml_node *list = asdic_yaml_child(r->root, "remarks");
    const asdic_yaml_node *node = list && list->kind == ASDIC_YAML_LIST ? list->first : NULL;
    for (; node && node->text && remarks->count < ASDIC_MOST_REMARKS; node = node->next) {
        snprintf(remarks->text[remarks->count++], ASDIC_REMARK_SIZE, "%s", node->text);
    }
}

/* Reads the terms in the order of asdic_term. Without them in run.json, all count as kept. */
static void read_terms(reader *r, asdic_plan *plan) {
    const asdic_yaml_node *list = asdic_yaml_child(r->root, "terms");
    const asdic_yaml_node *node = list && list->kind == ASDIC_YAML_LIST ? list->first : NULL;
    for (int t = 0; t < ASDIC_TERM_COUNT && node; t++, node = node->next) {
        asdic_plan_row *row = &plan->rows[t];
        double bound_db = read_number(r, node, "bound_db");
        row->name = asdic_term_name((asdic_term)t);
        row->kept = strcmp(read_text(r, node, "kept"), "true") == 0;
        row->bound_db = isnan(bound_db) ? INFINITY : bound_db;
        snprintf(row->reason, sizeof row->reason, "%s", read_text(r, node, "reason"));
        plan->left_out |= row->kept ? 0u : 1u << t;
    }
}

static void read_files(reader *r, asdic_run_facts *facts) {
    const asdic_yaml_node *list = asdic_yaml_child(r->root, "files");
    const asdic_yaml_node *node = list && list->kind == ASDIC_YAML_LIST ? list->first : NULL;
    for (; node && facts->file_count < ASDIC_RUN_FILES; node = node->next) {
        asdic_run_file *file = &facts->files[facts->file_count++];
        snprintf(file->name, sizeof file->name, "%s", read_text(r, node, "name"));
        file->sum.bytes = strtoull(read_text(r, node, "bytes"), NULL, 10);
        file->sum.crc32 = (uint32_t)strtoul(read_text(r, node, "crc32"), NULL, 16);
    }
}

/* A run without the key is older than refraction: its water has one speed. */
static void read_refraction(reader *r, asdic_run_facts *facts) {
    const char *const forms[] = {asdic_refraction_name(ASDIC_REFRACTION_FULL),
                                 asdic_refraction_name(ASDIC_REFRACTION_LAYER),
                                 asdic_refraction_name(ASDIC_REFRACTION_OFF)};
    const asdic_yaml_node *layer = asdic_yaml_child(r->root, "layer_m");
    if (!asdic_yaml_child(r->root, "refraction")) {
        return;
    }
    facts->refraction = (asdic_refraction)read_word(r, "refraction", forms, COUNT_OF(forms));
    if (facts->refraction == ASDIC_REFRACTION_LAYER) {
        facts->layer_from_m = read_number(r, layer, "from");
        facts->layer_to_m = read_number(r, layer, "to");
    }
}

static void read_all(reader *r, asdic_arena *arena, asdic_run_facts *facts) {
    const asdic_yaml_node *scene = asdic_yaml_child(r->root, "scene");
    const asdic_yaml_node *time_s = asdic_yaml_child(r->root, "time_s");
    const asdic_yaml_node *stderr_db = asdic_yaml_child(r->root, "stderr_db");
    facts->version = read_text(r, r->root, "version");
    facts->state = read_text(r, r->root, "state");
    facts->scene_path = read_text(r, scene, "path");
    facts->scene_hash = read_text(r, scene, "sha256");
    facts->geometry_hash = read_text(r, scene, "geometry_sha256");
    facts->scene_text = read_text(r, scene, "text");
    facts->has_surface = strcmp(read_text(r, r->root, "surface"), "true") == 0;
    facts->bottom = read_text(r, r->root, "bottom");
    read_law(r, arena, "bottom_law", &facts->bottom_law);
    read_law(r, arena, "surface_law", &facts->surface_law);
    read_uncertainty(r, &facts->uncertainty);
    facts->sampling.seed = read_natural(r, "seed");
    facts->sampling.rays = (uint32_t)read_natural(r, "rays");
    facts->sampling.sampler =
        (asdic_sampler)read_word(r, "sampler", sampler_names, COUNT_OF(sampler_names));
    facts->sampling.multipath =
        (asdic_multipath)read_word(r, "multipath", multipath_names, COUNT_OF(multipath_names));
    read_refraction(r, facts);
    facts->first_ping = read_natural(r, "first_ping");
    facts->pings_planned = read_natural(r, "pings_planned");
    facts->pings = read_natural(r, "pings");
    facts->rays_traced = read_natural(r, "rays_traced");
    facts->saturated = read_natural(r, "saturated");
    facts->beams = read_natural(r, "beams");
    facts->bins = read_natural(r, "bins");
    facts->bin_length_m = read_number(r, r->root, "bin_length_m");
    for (size_t i = 0; i < sizeof times / sizeof *times; i++) {
        double *value = (double *)((char *)&facts->times + times[i].at);
        *value =
            asdic_yaml_child(time_s, times[i].name) ? read_number(r, time_s, times[i].name) : NAN;
    }
    facts->rays_per_s = read_number(r, r->root, "rays_per_s");
    facts->stderr_median_db = read_number(r, stderr_db, "median");
    facts->stderr_worst_db = read_number(r, stderr_db, "worst");
    facts->stderr_rms_db =
        asdic_yaml_child(stderr_db, "rms") ? read_number(r, stderr_db, "rms") : NAN;
    facts->devices = read_texts(r, arena, "devices", &facts->device_count);
    facts->pictures = read_texts(r, arena, "pictures", &facts->picture_count);
    read_files(r, facts);
    read_remarks(r, &facts->remarks);
    read_terms(r, &facts->plan);
    if (facts->beams == 0 || facts->beams > 4096 || facts->bins == 0 ||
        facts->bins > SIZE_MAX / 65536 / facts->beams || !(facts->bin_length_m > 0.0)) {
        r->missing = r->missing ? r->missing : "beams, bins or bin_length_m";
    }
}

asdic_status asdic_run_facts_read(asdic_context *ctx, const char *folder, asdic_arena *arena,
                                  asdic_run_facts *facts) {
    char *path = asdic_folder_file(folder, "run.json"), *text = NULL;
    size_t length = 0;
    asdic_yaml_node *root = NULL;
    asdic_problems problems = {0};
    *facts = (asdic_run_facts){0};
    if (!path) {
        return asdic_fail_memory(ctx, "a file name");
    }
    asdic_status status = asdic_file_read(ctx, path, MAX_BYTES, &text, &length);
    if (status == ASDIC_ERROR_INPUT) {
        status =
            asdic_fail(ctx, ASDIC_ERROR_INPUT,
                       "'%s' is not a run folder: it has no run.json that can be read", folder);
    }
    if (status != ASDIC_OK) {
        goto done;
    }
    if (!is_signed(text, length)) {
        status =
            asdic_fail(ctx, ASDIC_ERROR_INPUT,
                       "'%s' is damaged, or of another version of asdic: it does not state the "
                       "sum of its bytes; run again with --force",
                       path);
        goto done;
    }
    problems.name = path;
    if (!asdic_yaml_read(text, length, arena, &problems, &root)) {
        status = asdic_fail_memory(ctx, "run.json");
        goto done;
    }
    reader r = {.root = root};
    if (root && problems.total == 0) {
        read_all(&r, arena, facts);
    }
    if (!root || problems.total > 0 || r.missing) {
        status = asdic_fail(ctx, ASDIC_ERROR_INPUT, "'%s' is damaged: %s%s", path,
                            r.missing ? "no valid " : "it is not JSON", r.missing ? r.missing : "");
    }
done:
    asdic_problems_finish(&problems);
    free(text);
    free(path);
    return status;
}
