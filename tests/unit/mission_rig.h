/*
 * Missions from a text, with meshes in memory and other files in a folder of their own, and what is said of them.
 */
#ifndef ASDIC_TESTS_MISSION_RIG_H
#define ASDIC_TESTS_MISSION_RIG_H

#include "asserts.h"

#include <asdic/asdic.h>

#include <stdlib.h>
#include <unistd.h>

typedef struct workshop {
    asdic_context *ctx;
    char folder[64];
    asdic_named_mesh meshes[16];
    size_t mesh_count;
    char said[4096]; /* of the last scene, a line each, without the folder */
} workshop;

static inline void write_file(const workshop *w, const char *name, const char *text) {
    char path[128];
    snprintf(path, sizeof path, "%s/%s", w->folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

/* A track of ROWS: time, north, east, down, roll, pitch, yaw. */
static inline void write_track(const workshop *w, const char *name, const char *rows) {
    char text[4096];
    snprintf(text, sizeof text, "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n%s", rows);
    write_file(w, name, text);
}

/* COUNT triangles of CORNERS, three each, which scenes know as the mesh NAME. */
static inline void add_mesh(workshop *w, const char *name, const double (*corners)[3],
                            size_t count) {
    uint32_t indices[64];
    asdic_mesh *mesh = NULL;
    for (uint32_t i = 0; i < 3 * count; i++) {
        indices[i] = i;
    }
    assert_ok(w->ctx,
              asdic_mesh_from_triangles(w->ctx, *corners, 3 * count, indices, count, &mesh));
    w->meshes[w->mesh_count++] = (asdic_named_mesh){.name = name, .mesh = mesh};
}

static inline int begin(void **state) {
    workshop *w = calloc(1, sizeof *w);
    if (!w || asdic_context_create(&w->ctx) != ASDIC_OK) {
        return -1;
    }
    snprintf(w->folder, sizeof w->folder, "/tmp/asdic-mission-XXXXXX");
    *state = w;
    return mkdtemp(w->folder) ? 0 : -1;
}

static inline int end(void **state) {
    workshop *w = *state;
    char command[128];
    snprintf(command, sizeof command, "rm -r %s", w->folder);
    int failed = system(command);
    for (size_t i = 0; i < w->mesh_count; i++) {
        asdic_mesh *mesh = (asdic_mesh *)w->meshes[i].mesh;
        asdic_mesh_destroy(&mesh);
    }
    asdic_context_destroy(&w->ctx);
    free(w);
    return failed;
}

static inline void keep_lines(void *user, asdic_log_level level, const char *message) {
    workshop *w = user;
    size_t length = strlen(w->folder), at = strlen(w->said);
    (void)level;
    if (strncmp(message, w->folder, length) == 0) {
        message += length + 1;
    }
    snprintf(w->said + at, sizeof w->said - at, "%s\n", message);
}

/* The mission of TEXT, as if it were the file scene.yaml in the folder; NULL where it is wrong. */
static inline asdic_mission *load_text(workshop *w, const char *text) {
    char path[128];
    asdic_mission *m = NULL;
    snprintf(path, sizeof path, "%s/scene.yaml", w->folder);
    asdic_scene_text scene = {.text = text,
                              .length = strlen(text),
                              .name = path,
                              .meshes = w->meshes,
                              .mesh_count = w->mesh_count};
    w->said[0] = '\0';
    asdic_context_set_log(w->ctx, ASDIC_LOG_WARNING, keep_lines, w);
    asdic_mission_load_text(w->ctx, &scene, &m);
    asdic_context_set_log(w->ctx, ASDIC_LOG_WARNING, NULL, NULL);
    return m;
}

/* A scene in water of 1500 m/s, heard to 75 m; what follows begins in line 4. */
#define SCENE                                                                                      \
    "version: 1\nenvironment: {sound_speed_mps: 1500}\n"                                           \
    "sonar: {frequency_khz: 100, ping_rate_hz: 10, source_level_db: 0, receivers: [{name: a}]}\n"

/* What is said of SCENE and REST. */
static inline const char *said_of(workshop *w, const char *rest) {
    char text[4096];
    snprintf(text, sizeof text, SCENE "%s", rest);
    asdic_mission *m = load_text(w, text);
    asdic_mission_destroy(&m);
    return w->said;
}

#endif
