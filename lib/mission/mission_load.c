/*
 * From a scene file to a mission.
 */
#include "mission_build.h"

#include "base/context.h"
#include "base/file_read.h"
#include "base/memory_left.h"
#include "base/number.h"
#include "base/sha256.h"
#include "base/try.h"
#include "mission/scene_file/scene_draw.h"
#include "mission/scene_file/scene_keys.h"
#include "mission/scene_file/yaml_tree.h"
#include "sim/array.h"
#include "sim/coherent.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Keeps SIZE BYTES of a scene in MISSION: as UTF-8, and their hash. */
static asdic_status keep_text(asdic_context *ctx, asdic_mission *m, const char *bytes, size_t size,
                              size_t *length) {
    asdic_sha256_hex(bytes, size, m->file_hash);
    memcpy(m->hash, m->file_hash, sizeof m->hash);
    m->text = asdic_text_to_utf8(bytes, size, length);
    return m->text ? ASDIC_OK : asdic_fail_memory(ctx, "the scene file's text");
}

/* Reads the file into MISSION. */
static asdic_status read_text(asdic_context *ctx, asdic_mission *m, size_t *length) {
    char *bytes = NULL;
    size_t size = 0;
    struct stat st;
    if (stat(m->path, &st) == 0 && S_ISDIR(st.st_mode)) {
        return asdic_fail(ctx, ASDIC_ERROR_INPUT,
                          "%s: Is a directory; give a scene file. The scene of a run stands in its "
                          "run.json",
                          m->path);
    }
    TRY(asdic_file_read_piped(ctx, m->path, ASDIC_MOST_SCENE_BYTES, &bytes, &size));
    asdic_status status = keep_text(ctx, m, bytes, size, length);
    free(bytes);
    return status;
}

/* Messages of ROS 2 count seconds in 32 bits, and an MCAP file none before its beginning. */
#define MOST_MESSAGE_S 2147483647.0

static void check_message_times(const mission_builder *b) {
    const asdic_mission *m = b->mission;
    double first_s, last_s;
    if (!(m->settings.output.formats & 1u << ASDIC_FORMAT_mcap)) {
        return;
    }
    asdic_mission_pose(m, 0, &first_s);
    asdic_mission_pose(m, asdic_mission_ping_count(m) - 1, &last_s);
    if (first_s < 0.0 || last_s > MOST_MESSAGE_S) {
        asdic_yaml_problem(b->problems, asdic_yaml_child(b->file->output.node, "mcap"),
                           "messages of ROS 2 are of times from 0 to %.0f s, but the pings from "
                           "%.15g to %.15g s; let the track's 'time_s' begin elsewhere",
                           MOST_MESSAGE_S, first_s, last_s);
    }
}

/* Beams of an array are apertures about as long as it. */
static void check_array(mission_builder *b) {
    const asdic_sonar *sonar = &b->mission->settings.sonar;
    const file_array *array = &b->file->sonar.array;
    asdic_yaml_node *spacing = asdic_yaml_child(array->node, "spacing_wl");
    double off_m = fmax(sonar->array.element.length_h_m, ASDIC_LEAST_LENGTH_M);
    if (!array->node || !asdic_mission_is_sound(b)) {
        return;
    }
    for (size_t i = 0; i < sonar->receiver_count && asdic_is_length(off_m); i++) {
        off_m = sonar->receivers[i].length_h_m;
    }
    if (!asdic_is_length(off_m)) {
        asdic_yaml_problem(
            b->problems, spacing ? spacing : array->node,
            "'spacing_wl' = %.15g makes an aperture of %.4g m, which is out of range "
            "[%g, %g] m; change it, 'elements' or 'frequency_khz'",
            array->spacing_wl, off_m, ASDIC_LEAST_LENGTH_M, ASDIC_MOST_LENGTH_M);
    }
}

static asdic_status build(mission_builder *b) {
    TRY(asdic_settings_take(b->ctx, b->file, &b->mission->settings));
    check_array(b);
    b->mission->pose = asdic_scene_file_pose(b->file);
    TRY(asdic_mission_build_tracks(b));
    TRY(b->mission->base ? asdic_mission_borrow_scene(b) : asdic_mission_build_scene(b));
    TRY(asdic_mission_build_pings(b));
    if (b->problems->total == 0) {
        asdic_mission_build_rays(b);
        if (b->mission->settings.refraction >= 0) {
            asdic_mission_refract(b->mission, (asdic_refraction)b->mission->settings.refraction);
        }
    }
    if (b->extent == MISSION_WHOLE && !b->leaves_positions) {
        asdic_mission_check_positions(b);
        if (b->problems->total == 0) {
            check_message_times(b);
        }
    }
    return ASDIC_OK;
}

/* Memory of a run for each bin of each beam, as measured: 1.2 GiB for 1,024 beams of 4,093 bins. */
#define LEVEL_BYTES 304

static asdic_status check_memory(asdic_context *ctx, const asdic_mission *m) {
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    asdic_reach r = asdic_reach_of(sonar, &m->settings.sampling, asdic_mission_speed_mps(m));
    uint64_t needed = (uint64_t)sonar->receiver_count * (r.bins + r.margin) * LEVEL_BYTES;
    char what[64];
    snprintf(what, sizeof what, "%zu beams of %zu bins need", sonar->receiver_count, r.bins);
    return asdic_memory_check(ctx, needed, asdic_memory_left(), what,
                              "use fewer beams or a longer 'bin_length_m'");
}

/* The section `trial` of ROOT, which loses it when a run is drawn; FILE, which is zero, stays so without
 * it. The mission has its hash. */
static asdic_status read_trial(mission_builder *b, asdic_yaml_node *root, file_trial *file) {
    asdic_yaml_node *node = b->draw ? asdic_yaml_child(root, "trial") : NULL;
    if (!b->draw) {
        return ASDIC_OK;
    }
    asdic_schema_read(&asdic_trial_table, asdic_scene_table(), node, b->arena, b->problems, file);
    asdic_text text = {0};
    if (node) {
        asdic_scene_draw_check(file, b->arena, b->problems);
        if (b->tells) {
            asdic_scene_draw_check_values(file, NULL, b->arena, b->problems);
        }
        if (b->opened && asdic_scene_node_good(node)) {
            TRY(asdic_mission_open_drawn(b, file));
        }
        b->draw = node->bad ? NULL : b->draw; /* no run is at fault */
        asdic_mission_take_out(root, node);
        asdic_yaml_print(node, &text);
    }
    bool is_good = !text.failed;
    if (is_good) {
        asdic_sha256_hex(text.data, text.length, b->mission->trial_hash);
    }
    asdic_text_finish(&text);
    return is_good ? ASDIC_OK : asdic_fail_memory(b->ctx, "a trial");
}

/* Of many runs: the names that objects have in any of them. */
static asdic_status keep_classes(mission_builder *b, const asdic_yaml_node *root,
                                 const file_trial *trial) {
    asdic_names names = {0};
    bool good = !b->many || asdic_scene_draw_names(root, trial, &names);
    b->mission->classes = names.items;
    b->mission->class_count = names.count;
    return good ? ASDIC_OK : asdic_fail_memory(b->ctx, "names of classes");
}

/* The scene file's tree with what it includes and what is set and drawn; the mission has text and
 * hash of all but settings, with a draw of these too. */
static asdic_status read_scene(mission_builder *b, asdic_yaml_node **root, file_trial *trial,
                               asdic_drawn *drawn) {
    size_t length = 0;
    bool included = false;
    const asdic_scene_text *memory = b->memory;
    TRY(memory ? keep_text(b->ctx, b->mission, memory->text, memory->length, &length)
               : read_text(b->ctx, b->mission, &length));
    if (!asdic_yaml_read(b->mission->text, length, b->arena, b->problems, root)) {
        return asdic_fail_memory(b->ctx, "the scene file's content");
    }
    asdic_scene_draw(*root, trial, b->draw, ASDIC_TURN_TRIAL, b->arena, b->problems, drawn);
    TRY(read_trial(b, *root, trial));
    b->draws = b->draw && trial->draws.count > 0;
    TRY(keep_classes(b, *root, trial));
    asdic_scene_draw(*root, trial, b->draw, ASDIC_TURN_INCLUDES, b->arena, b->problems, drawn);
    TRY(asdic_mission_include(b, *root, &included));
    if (included && !b->draw) {
        TRY(asdic_mission_keep_tree(b, *root));
    }
    asdic_scene_draw(*root, trial, b->draw, ASDIC_TURN_REST, b->arena, b->problems, drawn);
    asdic_scene_draw_finish(*root, drawn, b->arena, b->problems);
    return b->draw && *root ? asdic_mission_keep_tree(b, *root) : ASDIC_OK;
}

static asdic_status keep_drawn(mission_builder *b, const asdic_drawn *drawn) {
    asdic_setting *kept = calloc(drawn->count + 1, sizeof *kept);
    b->mission->drawn = kept;
    for (size_t i = 0; kept && i < drawn->count; i++) {
        kept[i].key = strdup(drawn->items[i].key); /* the list's end is the first without a key */
        kept[i].value = kept[i].key ? strdup(drawn->items[i].value) : NULL;
        kept = kept[i].value ? kept : NULL;
    }
    return kept ? ASDIC_OK : asdic_fail_memory(b->ctx, "what was drawn");
}

/* What the scene's geometry is made from, as text: of a run of a trial, so that the next can see
 * whether its own is the same. */
static asdic_status keep_geometry(mission_builder *b, const asdic_yaml_node *root) {
    static const char *const keys[] = {"surface", "bottom", "objects"};
    asdic_text text = {0};
    asdic_text_add(&text, b->mission->trial.is_ideal ? "silent\n" : "");
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        const asdic_yaml_node *node = asdic_yaml_child(root, keys[i]);
        asdic_text_format(&text, "%s:\n", keys[i]);
        b->mission->ground_length = text.length; /* up to the objects, the last */
        if (node) {
            asdic_yaml_print(node, &text);
        }
    }
    b->mission->geometry = asdic_text_take(&text);
    return b->mission->geometry ? ASDIC_OK : asdic_fail_memory(b->ctx, "a scene");
}

static void take_out(asdic_yaml_node *map, const char *key) {
    asdic_yaml_node *child = asdic_yaml_child(map, key);
    if (child) {
        asdic_mission_take_out(map, child);
    }
}

/* What the scene of ROOT, which was read, is but for places; and the base that is the same. In layers of water
 * nothing may move: places are then part of it, and the pose where one layer is fitted to its depth. */
static asdic_status find_base(mission_builder *b, asdic_yaml_node *root) {
    asdic_mission *m = b->mission;
    asdic_settings settings = {0};
    TRY(asdic_settings_take(b->ctx, b->file, &settings));
    const asdic_environment *env = &settings.environment;
    m->stands_anywhere = env->sound_speed_profile.points == 0;
    bool is_fitted = settings.refraction == ASDIC_REFRACTION_LAYER;
    asdic_settings_finish(&settings);
    asdic_yaml_node *objects = asdic_yaml_child(root, "objects");
    for (asdic_yaml_node *o = objects ? objects->first : NULL; o; o = o->next) {
        const asdic_yaml_node *name = asdic_yaml_child(o, "name");
        if (!name) {
            asdic_yaml_problem(b->problems, o,
                               "an object of a data set needs a 'name': it is its class");
        } else if (asdic_mission_class(m, name->text) == 0) {
            asdic_yaml_problem(b->problems, o,
                               "'name' is the object's class in a data set; draw it by 'choice'");
        }
    }
    for (asdic_yaml_node *o = objects ? objects->first : NULL; o && m->stands_anywhere;
         o = o->next) {
        take_out(o, "position_m");
        take_out(o, "rotation_deg");
    }
    if (!is_fitted) {
        take_out(asdic_yaml_child(root, "mission"), "pose");
    }
    asdic_text text = {0};
    asdic_yaml_print(root, &text);
    size_t length = text.length;
    char *whole = asdic_text_take(&text);
    if (!whole) {
        return asdic_fail_memory(b->ctx, "what a scene is");
    }
    asdic_sha256_hex(whole, length, m->form);
    free(whole);
    for (size_t i = 0; i < b->base_count; i++) {
        m->base = b->bases[i] && strcmp(b->bases[i]->form, m->form) == 0 ? b->bases[i] : m->base;
    }
    return ASDIC_OK;
}

static asdic_status load(mission_builder *b, asdic_scene_file *file) {
    asdic_yaml_node *root = NULL;
    file_trial trial = {0};
    asdic_drawn drawn = {.settings = b->settings, .setting_count = b->setting_count};
    TRY(read_scene(b, &root, &trial, &drawn));
    if (b->extent == MISSION_TEXT) {
        return asdic_problems_report(b->problems, b->ctx);
    }
    if (!asdic_scene_file_take(root, b->arena, b->problems, file)) {
        return asdic_fail_memory(b->ctx, "the scene file's content");
    }
    if (b->extent == MISSION_CHECKED) {
        return asdic_problems_report(b->problems, b->ctx);
    }
    TRY(keep_drawn(b, &drawn));
    if (b->many && root && b->problems->total == 0) {
        TRY(find_base(b, root));
    }
    b->mission->trial = asdic_scene_file_trial(&trial);
    if (b->leaves_positions) {
        TRY(keep_geometry(b, root));
    }
    if (b->extent == MISSION_EMPTY) {
        file->objects.count = 0;
    }
    TRY(build(b));
    TRY(asdic_problems_report(b->problems, b->ctx));
    return check_memory(b->ctx, b->mission);
}

/* Says of which run an error of the input is; the sentence in CTX stays otherwise. */
static asdic_status name_run(asdic_context *ctx, const asdic_draw *draw, asdic_status status) {
    char *sentence = status == ASDIC_ERROR_INPUT ? strdup(asdic_context_error(ctx)) : NULL;
    if (sentence) {
        asdic_fail(ctx, status,
                   "%s, as drawn for run %llu with seed %llu; keep what is drawn to what a scene "
                   "may have, tails of 'normal' by 'within'",
                   sentence, (unsigned long long)draw->run, (unsigned long long)draw->seed);
        free(sentence);
    }
    return status;
}

static asdic_status load_file(asdic_context *ctx, const char *path, const mission_builder *how,
                              asdic_mission **out) {
    bool good = path && (how->settings || how->setting_count == 0);
    for (size_t i = 0; good && i < how->setting_count; i++) {
        good = how->settings[i].key && how->settings[i].value;
    }
    if (!ASDIC_PLACE(out) || !good) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "asdic_mission_load: no path, no settings, one without a key or a value, "
                          "or nowhere to put the mission");
    }
    asdic_mission *m = calloc(1, sizeof *m);
    if (!m || !(m->path = strdup(path))) {
        free(m);
        return asdic_fail_memory(ctx, "a mission");
    }
    m->ctx = ctx;
    m->is_varied = (how->setting_count > 0 && !how->draw) || how->extent != MISSION_WHOLE;
    asdic_arena arena = {0};
    asdic_scene_file file;
    bool is_stdin = !how->memory && strcmp(path, "-") == 0;
    asdic_problems problems = {.name = is_stdin ? "stdin" : path};
    mission_builder builder = *how;
    builder.ctx = ctx;
    builder.file = &file;
    builder.problems = &problems;
    builder.arena = &arena;
    builder.mission = m;
    locale_t before = asdic_c_locale_enter();
    asdic_status status = load(&builder, &file);
    asdic_c_locale_leave(before);
    asdic_problems_finish(&problems);
    asdic_arena_finish(&arena);
    m->said = asdic_mission_get_choices(m);
    if (status) {
        asdic_mission_destroy(&m);
    }
    *out = m;
    return status && builder.draws ? name_run(ctx, builder.draw, status) : status;
}

asdic_status asdic_mission_load(asdic_context *ctx, const char *path, asdic_mission **out) {
    return load_file(ctx, path, &(mission_builder){.extent = MISSION_WHOLE}, out);
}

asdic_status asdic_mission_load_with(asdic_context *ctx, const char *path,
                                     const asdic_setting *settings, size_t count,
                                     asdic_mission **out) {
    const mission_builder how = {
        .extent = MISSION_WHOLE, .settings = settings, .setting_count = count};
    return load_file(ctx, path, &how, out);
}

asdic_status asdic_mission_load_trial(asdic_context *ctx, const char *path,
                                      const asdic_setting *settings, size_t count,
                                      const asdic_draw *draw, asdic_mission *donor,
                                      asdic_mission **out) {
    const mission_builder how = {.extent = MISSION_WHOLE,
                                 .settings = settings,
                                 .setting_count = count,
                                 .draw = draw,
                                 .leaves_positions = true,
                                 .donor = donor};
    return load_file(ctx, path, &how, out);
}

asdic_status asdic_mission_load_run(asdic_context *ctx, const char *path,
                                    const asdic_setting *settings, size_t count,
                                    const asdic_draw *draw, asdic_mission **out) {
    if (!ASDIC_PLACE(out) || !draw) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "asdic_mission_load_run: no draw, or nowhere to put it");
    }
    const mission_builder how = {
        .extent = MISSION_WHOLE, .settings = settings, .setting_count = count, .draw = draw};
    return load_file(ctx, path, &how, out);
}

asdic_status asdic_mission_check_run(asdic_context *ctx, const char *path,
                                     const asdic_setting *settings, size_t count,
                                     const asdic_draw *draw, asdic_text *opened) {
    asdic_mission *mission = NULL;
    const mission_builder how = {.extent = MISSION_CHECKED,
                                 .settings = settings,
                                 .setting_count = count,
                                 .draw = draw,
                                 .tells = opened != NULL,
                                 .opened = opened};
    asdic_status status = load_file(ctx, path, &how, &mission);
    asdic_mission_destroy(&mission);
    return status;
}

/* Whether the text that is kept is not the file's, whose lines can be read anew: a pipe's cannot. */
static bool is_to_be_read(const asdic_mission *m) {
    struct stat st;
    return strcmp(m->hash, m->file_hash) != 0 && stat(m->path, &st) == 0 && S_ISREG(st.st_mode);
}

asdic_status asdic_mission_check_draws(asdic_context *ctx, const asdic_mission *mission) {
    if (!mission) {
        return asdic_fail_null(ctx, __func__);
    }
    const char *path = strcmp(mission->path, "-") == 0 ? "stdin" : mission->path;
    const asdic_scene_text text = {.text = mission->text, .length = strlen(mission->text)};
    asdic_text opened = {0};
    asdic_mission *checked = NULL;
    const mission_builder how = {.extent = MISSION_TEXT,
                                 .draw = &(asdic_draw){0, 0},
                                 .opened = &opened,
                                 .memory = is_to_be_read(mission) ? NULL : &text};
    asdic_status status = load_file(ctx, path, &how, &checked);
    asdic_mission_destroy(&checked);
    asdic_text_finish(&opened);
    return status;
}

asdic_status asdic_mission_load_like(asdic_context *ctx, const char *path, const asdic_draw *draw,
                                     const asdic_mission *const *bases, size_t count, bool tells,
                                     asdic_mission **out) {
    const mission_builder how = {.extent = MISSION_WHOLE,
                                 .draw = draw,
                                 .many = true,
                                 .tells = tells,
                                 .bases = bases,
                                 .base_count = count};
    return load_file(ctx, path, &how, out);
}

asdic_status asdic_mission_load_text(asdic_context *ctx, const asdic_scene_text *scene,
                                     asdic_mission **out) {
    bool good = scene && scene->text && scene->name && (scene->meshes || scene->mesh_count == 0);
    for (size_t i = 0; good && i < scene->mesh_count; i++) {
        good = scene->meshes[i].name && scene->meshes[i].mesh;
    }
    if (!ASDIC_PLACE(out) || !good) {
        return asdic_fail(
            ctx, ASDIC_ERROR_ARGUMENT,
            "asdic_mission_load_text: a scene needs a text and a name, and each of its "
            "meshes a name and a mesh; the mission needs a place");
    }
    if (scene->length > ASDIC_MOST_SCENE_BYTES) {
        return asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: a scene of %zu bytes; at most %zu are read",
                          scene->name, scene->length, ASDIC_MOST_SCENE_BYTES);
    }
    const mission_builder how = {.extent = MISSION_WHOLE, .memory = scene};
    return load_file(ctx, scene->name, &how, out);
}

asdic_status asdic_mission_load_empty(asdic_context *ctx, const char *path, asdic_mission **out) {
    return load_file(ctx, path, &(mission_builder){.extent = MISSION_EMPTY}, out);
}

/* Without a word: a scene that was changed since may say anything. */
static asdic_status load_same(const char *path, const char *hash, asdic_mission **out) {
    asdic_mission *text = NULL;
    TRY(load_file(NULL, path, &(mission_builder){.extent = MISSION_TEXT}, &text));
    bool is_same = strcmp(text->hash, hash) == 0;
    asdic_mission_destroy(&text);
    return is_same ? asdic_mission_load(NULL, path, out) : ASDIC_OK;
}

asdic_status asdic_mission_load_same(asdic_context *ctx, const char *path, const char *hash,
                                     asdic_mission **out) {
    *out = NULL;
    asdic_status status = strcmp(path, "-") != 0 ? load_same(path, hash, out) : ASDIC_OK;
    return status == ASDIC_OK || status == ASDIC_ERROR_INPUT || status == ASDIC_ERROR_UNSUPPORTED
               ? ASDIC_OK
               : asdic_fail(ctx, status, "scene '%s' cannot be loaded again: %s", path,
                            asdic_status_text(status));
}
