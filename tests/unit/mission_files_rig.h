/*
 * Missions loaded from the file scene.yaml in a folder of their own, with settings and draws.
 */
#ifndef ASDIC_TESTS_MISSION_FILES_RIG_H
#define ASDIC_TESTS_MISSION_FILES_RIG_H

#include "mission_rig.h"

#define POSE "mission: {pose: {position_m: [0, 0, 3]}}\n"
#define FLAT "bottom: {depth_m: 12}\n"
#define SONAR "sonar: {file: a.yaml, ping_rate_hz: 10, receivers: [{name: a}]}\n"

static inline const char *path_of(const workshop *w, const char *name) {
    static char paths[2][128];
    static int turn;
    turn = 1 - turn;
    snprintf(paths[turn], sizeof paths[turn], "%s/%s", w->folder, name);
    return paths[turn];
}

/* What is in the file NAME. */
static inline const char *content_of(const workshop *w, const char *name) {
    static char text[8192];
    FILE *file = fopen(path_of(w, name), "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    assert_int_equal(fclose(file), 0);
    return text;
}

/* Loads the file scene.yaml, with what is said of it; NULL where it is wrong. */
static inline asdic_mission *load_with(workshop *w, const asdic_setting *settings, size_t count,
                                       const asdic_draw *draw) {
    asdic_mission *m = NULL;
    w->said[0] = '\0';
    asdic_context_set_log(w->ctx, ASDIC_LOG_WARNING, keep_lines, w);
    if (draw) {
        asdic_mission_load_run(w->ctx, path_of(w, "scene.yaml"), settings, count, draw, &m);
    } else {
        asdic_mission_load_with(w->ctx, path_of(w, "scene.yaml"), settings, count, &m);
    }
    asdic_context_set_log(w->ctx, ASDIC_LOG_WARNING, NULL, NULL);
    return m;
}

#endif
