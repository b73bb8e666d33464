#include "run_facts.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/file_read.h"
#include "base/number.h"
#include "base/problems.h"
#include "mission/scene_file/yaml_tree.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT_OF(array) ((int)(sizeof(array) / sizeof *(array)))

/* The scene file's text is at most 4 MiB and may double when escaped. */
#define MAX_BYTES ((size_t)16 << 20)

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
    if (map && map->kind == ASDIC_YAML_SCALAR && map->length == 0) { /* null */
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
    for (size_t i = 0; map && i < ASDIC_RUN_UNCERTAIN_COUNT; i++) {
        const asdic_yaml_node *node = asdic_yaml_child(map, asdic_run_uncertain_keys[i].name);
        if (node && node->length > 0) { /* not null */
            uncertainty->db[asdic_run_uncertain_keys[i].component] =
                read_number(r, map, asdic_run_uncertain_keys[i].name);
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

/* None where there is no elements.npy, or the run is older than the key. */
static void read_elements(reader *r, asdic_run_elements *elements) {
    const asdic_yaml_node *map = asdic_yaml_child(r->root, "elements");
    if (map) {
        *elements =
            (asdic_run_elements){read_number(r, map, "spacing_m"), read_number(r, map, "sample_m"),
                                 read_number(r, map, "wavelength_m")};
    }
}

/* A run without the keys is older than they are: nothing is known of a whole. */
static void read_whole(reader *r, asdic_run_facts *facts) {
    bool says = asdic_yaml_child(r->root, "whole_pings") != NULL;
    facts->whole_first_ping = says ? read_natural(r, "whole_first_ping") : facts->first_ping;
    facts->whole_pings = says ? read_natural(r, "whole_pings") : facts->pings_planned;
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
        (asdic_sampler)read_word(r, "sampler", asdic_run_sampler_names, ASDIC_RUN_SAMPLER_COUNT);
    facts->sampling.multipath = (asdic_multipath)read_word(
        r, "multipath", asdic_run_multipath_names, ASDIC_RUN_MULTIPATH_COUNT);
    read_refraction(r, facts);
    facts->first_ping = read_natural(r, "first_ping");
    facts->pings_planned = read_natural(r, "pings_planned");
    facts->pings = read_natural(r, "pings");
    read_whole(r, facts);
    facts->rays_traced = read_natural(r, "rays_traced");
    facts->saturated = read_natural(r, "saturated");
    facts->beams = read_natural(r, "beams");
    facts->bins = read_natural(r, "bins");
    facts->bin_length_m = read_number(r, r->root, "bin_length_m");
    read_elements(r, &facts->elements);
    for (size_t i = 0; i < ASDIC_RUN_TIME_COUNT; i++) {
        const char *name = asdic_run_time_names[i];
        *asdic_run_time(&facts->times, i) =
            asdic_yaml_child(time_s, name) ? read_number(r, time_s, name) : NAN;
    }
    facts->rays_per_s = read_number(r, r->root, "rays_per_s");
    facts->errors.median_db = read_number(r, stderr_db, "median");
    facts->errors.worst_db = read_number(r, stderr_db, "worst");
    facts->errors.rms_db =
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
    const asdic_file_name file = asdic_file_in(folder, "run.json");
    const char *path = file.text;
    char *text = NULL;
    size_t length = 0;
    asdic_yaml_node *root = NULL;
    asdic_problems problems = {0};
    *facts = (asdic_run_facts){0};
    asdic_status status = asdic_file_read(ctx, path, MAX_BYTES, &text, &length);
    if (status == ASDIC_ERROR_INPUT) {
        status =
            asdic_fail(ctx, ASDIC_ERROR_INPUT,
                       "'%s' is not a run folder: it has no run.json that can be read", folder);
    }
    if (status != ASDIC_OK) {
        goto done;
    }
    if (!asdic_run_facts_signed(text, length)) {
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
    return status;
}
