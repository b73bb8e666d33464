#include "mission_build.h"

#include "base/context.h"
#include "base/file_read.h"
#include "base/memory_left.h"
#include "base/number.h"
#include "base/sha256.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A scene file is written by hand or by a small script; geometry is elsewhere. */
#define MAX_SCENE_BYTES ((size_t)4 << 20)

void asdic_mission_destroy(asdic_mission **mission) {
    if (!mission || !*mission) {
        return;
    }
    asdic_mission *m = *mission;
    asdic_scene_destroy(&m->scene);
    asdic_track_destroy(&m->track);
    for (size_t i = 0; i < m->motion_count; i++) {
        asdic_track_destroy(&m->motions[i].track);
    }
    free(m->motions);
    free(m->objects);
    free(m->receivers);
    free(m->text);
    free(m->path);
    free(m);
    *mission = NULL;
}

/* The file's text into MISSION, as UTF-8, with the hash of its bytes. */
static asdic_status read_text(asdic_context *ctx, asdic_mission *m, size_t *length) {
    char *bytes = NULL;
    size_t size = 0;
    asdic_status status = asdic_file_read(ctx, m->path, MAX_SCENE_BYTES, &bytes, &size);
    if (status != ASDIC_OK) {
        return status;
    }
    asdic_sha256_hex(bytes, size, m->hash);
    m->text = asdic_text_to_utf8(bytes, size, length);
    free(bytes);
    return m->text ? ASDIC_OK : asdic_fail_memory(ctx, "the scene file's text");
}

static asdic_status build(mission_builder *b) {
    asdic_status status = asdic_mission_build_settings(b);
    if (status == ASDIC_OK) {
        status = asdic_mission_build_tracks(b);
    }
    if (status == ASDIC_OK) {
        status = asdic_mission_build_scene(b);
    }
    if (status == ASDIC_OK) {
        status = asdic_mission_build_pings(b);
    }
    if (status == ASDIC_OK && b->problems->total == 0) {
        asdic_mission_check_places(b);
    }
    return status;
}

/* What a run takes for each bin of each beam, as measured: 1,024 beams of 4,093 bins, 1.2 GiB. */
#define LEVEL_BYTES 304

static asdic_status check_memory(asdic_context *ctx, const asdic_mission *m) {
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    double depth_m = asdic_mission_pose(m, 0, NULL).position_m.z;
    double speed_mps = asdic_environment_sound_speed_mps(asdic_mission_environment(m), depth_m);
    size_t bins = asdic_sonar_bin_count(sonar, speed_mps);
    uint64_t needed = (uint64_t)sonar->receiver_count * bins * LEVEL_BYTES;
    char what[64];
    snprintf(what, sizeof what, "%zu beams of %zu bins need", sonar->receiver_count, bins);
    return asdic_memory_check(ctx, needed, asdic_memory_left(), what,
                              "use fewer beams or a longer 'bin_length_m'");
}

static asdic_status load(asdic_context *ctx, asdic_mission *m, const asdic_setting *settings,
                         size_t count) {
    asdic_arena arena = {0};
    asdic_scene_file file;
    asdic_problems problems = {.name = strcmp(m->path, "-") == 0 ? "stdin" : m->path};
    mission_builder builder = {
        .ctx = ctx, .file = &file, .problems = &problems, .arena = &arena, .mission = m};
    size_t length = 0;
    asdic_status status = read_text(ctx, m, &length);
    if (status != ASDIC_OK) {
        goto fail;
    }
    if (!asdic_scene_file_parse_with(m->text, length, settings, count, &arena, &problems, &file)) {
        status = asdic_fail_memory(ctx, "the scene file's content");
        goto fail;
    }
    status = build(&builder);
    if (status == ASDIC_OK) {
        status = asdic_problems_report(&problems, ctx);
    }
    if (status == ASDIC_OK) {
        status = check_memory(ctx, m);
    }
fail:
    asdic_problems_finish(&problems);
    asdic_arena_finish(&arena);
    return status;
}

asdic_status asdic_mission_load(asdic_context *ctx, const char *path, asdic_mission **out) {
    return asdic_mission_load_with(ctx, path, NULL, 0, out);
}

asdic_status asdic_mission_load_with(asdic_context *ctx, const char *path,
                                     const asdic_setting *settings, size_t count,
                                     asdic_mission **out) {
    if (!out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_mission_load: nowhere to put it");
    }
    *out = NULL;
    if (!path) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_mission_load: no path");
    }
    locale_t before = asdic_c_locale_enter();
    asdic_status status = ASDIC_OK;
    asdic_mission *m = calloc(1, sizeof *m);
    if (!m || !(m->path = strdup(path))) {
        status = asdic_fail_memory(ctx, "a mission");
        goto fail;
    }
    m->ctx = ctx;
    m->is_varied = count > 0;
    status = load(ctx, m, settings, count);
    if (status != ASDIC_OK) {
        goto fail;
    }
    *out = m;
    m = NULL;
fail:
    asdic_mission_destroy(&m);
    asdic_c_locale_leave(before);
    return status;
}
