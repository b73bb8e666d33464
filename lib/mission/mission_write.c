/*
 * The files that a mission writes: its scene file again, with the present choices and another
 * track, and its own track.
 */
#include "mission.h"

#include "base/arena.h"
#include "base/context.h"
#include "base/text.h"
#include "base/try.h"
#include "out/digits.h"
#include "laws/scatterer.h"
#include "out/file.h"
#include "mission/scene_file/yaml_tree.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct rewriter {
    asdic_arena arena;
    asdic_text text;
    char *folder; /* of the scene file that was read, absolute */
    bool failed;  /* memory was short */
} rewriter;

static asdic_yaml_node *new_node(rewriter *r, asdic_yaml_node *map, const char *key,
                                 asdic_yaml_kind kind) {
    asdic_yaml_node *node = asdic_arena_alloc(&r->arena, sizeof *node);
    if (!node) {
        r->failed = true;
        return NULL;
    }
    node->kind = kind;
    node->key = key;
    node->key_length = strlen(key);
    asdic_yaml_append(map, node);
    return node;
}

/* The map called KEY in MAP, made when it is not there. */
static asdic_yaml_node *need_map(rewriter *r, asdic_yaml_node *map, const char *key) {
    asdic_yaml_node *child = asdic_yaml_child(map, key);
    return child && child->kind == ASDIC_YAML_MAP ? child : new_node(r, map, key, ASDIC_YAML_MAP);
}

static void set_text(rewriter *r, asdic_yaml_node *map, const char *key, const char *value,
                     bool quoted) {
    asdic_yaml_node *node = map ? asdic_yaml_child(map, key) : NULL;
    node = node || !map ? node : new_node(r, map, key, ASDIC_YAML_SCALAR);
    if (!node) {
        return;
    }
    node->kind = ASDIC_YAML_SCALAR;
    node->first = node->last = NULL;
    node->length = strlen(value);
    node->text = asdic_arena_string(&r->arena, value, node->length);
    node->quoted = quoted;
    r->failed |= node->text == NULL;
}

static void set_number(rewriter *r, asdic_yaml_node *map, const char *key, double value) {
    char digits[ASDIC_DIGITS_SIZE];
    asdic_digits_double(digits, value);
    set_text(r, map, key, digits, false);
}

/* A key of any law in a scene file, of its file alone where IS_FILE. */
static bool is_law_key(const char *name, bool is_file) {
    for (size_t l = 0; l < asdic_law_count(); l++) {
        const asdic_law *law = asdic_law_get(l);
        size_t k = asdic_law_key(law, name);
        if (k < law->model.key_count && law->model.keys[k].doc &&
            (law->model.keys[k].columns || !is_file)) {
            return true;
        }
    }
    return false;
}

static bool is_no_law(const asdic_yaml_node *child, const void *unused) {
    (void)unused;
    return !is_law_key(child->key, false);
}

/* The law of MATERIAL in place of what MAP says; that of a file is still what MAP says. */
static void set_law(rewriter *r, asdic_yaml_node *map, const asdic_material *material) {
    if (!material->law || material->row_count) {
        return;
    }
    asdic_yaml_filter(map, is_no_law, NULL);
    for (size_t k = 0; k < material->law->model.key_count; k++) {
        const asdic_model_key *key = &material->law->model.keys[k];
        int length = 0;
        const char *word = asdic_law_word(key, material->value[k], &length);
        char text[64];
        snprintf(text, sizeof text, "%.*s", length, word ? word : "");
        if (isnan(material->value[k])) {
            continue;
        }
        if (word && !key->numeric) {
            set_text(r, map, key->name, text, false);
        } else {
            set_number(r, map, key->name, material->value[k]);
        }
    }
}

/* Whether NODE is the name of a file; that of a mesh or grid stands alone, or in a map as its file. */
static bool is_path(const asdic_yaml_node *node) {
    static const char *const keys[] = {"file", "grid", "mesh", "track"};
    bool found = node->key && is_law_key(node->key, true);
    for (size_t i = 0; node->key && i < sizeof keys / sizeof *keys; i++) {
        found |= strcmp(node->key, keys[i]) == 0;
    }
    return found && node->kind == ASDIC_YAML_SCALAR;
}

/* Names of files are relative to the scene file, which now lies elsewhere. */
static void make_absolute(rewriter *r, asdic_yaml_node *node) {
    for (asdic_yaml_node *child = node->first; child; child = child->next) {
        if (is_path(child) && child->text[0] != '/') {
            char *path = NULL;
            if (asprintf(&path, "%s/%s", r->folder, child->text) < 0) {
                r->failed = true;
                return;
            }
            set_text(r, node, child->key, path, true);
            free(path);
        }
        make_absolute(r, child);
    }
}

/* What was left to a run's plan has been simulated as it is now: who runs it again hears the same. */
static void set_refraction(rewriter *r, const asdic_mission *m, asdic_yaml_node *model) {
    const asdic_environment *env = &m->settings.environment;
    if (m->settings.refraction < 0 && asdic_environment_bends(env)) {
        set_text(r, model, "refraction", asdic_refraction_name(env->refraction), false);
    }
}

static void apply(rewriter *r, const asdic_mission *m, asdic_yaml_node *root, const char *track) {
    asdic_yaml_node *bottom = asdic_yaml_child(root, "bottom");
    asdic_yaml_node *mission = need_map(r, root, "mission");
    set_number(r, need_map(r, root, "environment"), "wind_speed_kn",
               m->settings.environment.wind_speed_kn);
    set_number(r, need_map(r, root, "sonar"), "source_level_db", m->settings.sonar.source_level_db);
    if (asdic_settings_rays_are_auto(&m->settings)) {
        set_text(r, need_map(r, root, "sampling"), "rays", "auto", false);
    } else {
        set_number(r, need_map(r, root, "sampling"), "rays", m->settings.sampling.rays);
    }
    set_number(r, need_map(r, root, "sampling"), "seed", (double)m->settings.sampling.seed);
    set_text(r, need_map(r, root, "model"), "terms", "all", false);
    set_refraction(r, m, need_map(r, root, "model"));
    if (bottom && bottom->kind == ASDIC_YAML_MAP && !asdic_yaml_child(bottom, "none")) {
        set_law(r, bottom, &m->bottom);
    }
    if (mission) {
        mission->first = mission->last = NULL;
        mission->count = 0;
        set_text(r, mission, "track", track, true);
    }
}

/* The absolute folder of the scene file PATH; freed by the caller. */
static asdic_status find_folder(asdic_context *ctx, const char *path, char **out) {
    const char *slash = strrchr(path, '/');
    char *name = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
    *out = name ? realpath(name, NULL) : NULL;
    int error = errno;
    free(name);
    return *out              ? ASDIC_OK
           : error == ENOMEM ? asdic_fail_memory(ctx, "a scene file")
                             : asdic_fail(ctx, ASDIC_ERROR_IO, "the folder of '%s' is gone: %s",
                                          path, strerror(error));
}

asdic_status asdic_mission_write_scene(asdic_context *ctx, const asdic_mission *mission,
                                       const char *path, const char *track) {
    if (!mission || !path || !track) {
        return asdic_fail_null(ctx, __func__);
    }
    rewriter r = {0};
    asdic_problems problems = {.name = mission->path};
    asdic_yaml_node *root = NULL;
    TRY(find_folder(ctx, mission->path, &r.folder));
    asdic_status status = ASDIC_OK;
    if (!asdic_yaml_read(mission->text, strlen(mission->text), &r.arena, &problems, &root) ||
        !root) {
        status = problems.total ? asdic_problems_report(&problems, ctx)
                                : asdic_fail_memory(ctx, "a scene file");
        goto done;
    }
    make_absolute(&r, root);
    apply(&r, mission, root, track);
    asdic_yaml_print(root, &r.text);
    r.text.failed |= r.failed;
    status = asdic_file_write_text(ctx, path, &r.text, "a scene file", false);
done:
    asdic_problems_finish(&problems);
    asdic_text_finish(&r.text);
    asdic_arena_finish(&r.arena);
    free(r.folder);
    return status;
}

/* --- the track -------------------------------------------------------------------------------- */

asdic_status asdic_mission_write_pings(asdic_context *ctx, const asdic_mission *mission,
                                       size_t first, size_t count, const char *path) {
    asdic_file *file = NULL;
    TRY(asdic_file_create(ctx, path, &file));
    const asdic_sweep *sweep = &mission->settings.sweep;
    asdic_track_file_begin(file, sweep);
    for (size_t i = first; i < first + count; i++) {
        double time_s;
        asdic_pose vehicle = asdic_mission_vehicle_pose(mission, i, &time_s);
        asdic_track_file_add(file, sweep, i, time_s, &vehicle);
    }
    return asdic_file_commit(&file);
}

asdic_status asdic_mission_write_track(asdic_context *ctx, const asdic_mission *mission,
                                       const char *path) {
    if (!mission || !path) {
        return asdic_fail_null(ctx, __func__);
    }
    return asdic_mission_write_pings(ctx, mission, 0, asdic_mission_ping_count(mission), path);
}
