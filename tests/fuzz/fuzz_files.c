/* Files that users bring: scene, track, grid, meshes. */
#include "scratch.h"
#include "targets.h"

#include <asdic/asdic.h>

#include "mission/track/track.h"
#include "scene/chart.h"
#include "scene/placement.h"

#include <math.h>
#include <stdlib.h>

/* What a failed call owes: a sentence, and nothing behind the pointer. */
static void judge(asdic_context *ctx, asdic_status status, const void *result) {
    if ((status == ASDIC_OK) != (result != NULL) ||
        (status != ASDIC_OK && !asdic_context_error(ctx)[0])) {
        abort();
    }
}

/* The objects as a chart shows them; of few, since each takes a grid of its own. */
static void outline(asdic_context *ctx, const asdic_scene *scene) {
    asdic_outline *outlines = NULL;
    size_t count = 0;
    if (scene->part_count <= 100) {
        asdic_chart_outlines(ctx, scene, &outlines, &count);
        free(outlines);
    }
}

/* A scene file, whole: with the geometry it asks for, its outlines, its track, its plan. */
void fuzz_scene(const uint8_t *data, size_t size) {
    asdic_context *ctx = NULL;
    asdic_mission *mission = NULL;
    asdic_plan plan;
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return;
    }
    asdic_status status =
        asdic_mission_load(ctx, scratch_write("scene.yaml", data, size), &mission);
    judge(ctx, status, mission);
    if (mission) {
        outline(ctx, asdic_mission_scene(mission));
        asdic_mission_pose(mission, asdic_mission_ping_count(mission) - 1, NULL);
        asdic_mission_plan(ctx, mission, &plan);
    }
    asdic_mission_destroy(&mission);
    asdic_context_destroy(&ctx);
}

void fuzz_track(const uint8_t *data, size_t size) {
    asdic_context *ctx = NULL;
    asdic_track *track = NULL;
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return;
    }
    asdic_problems problems = {.name = "track.csv"};
    asdic_status status =
        asdic_track_load(ctx, scratch_write("track.csv", data, size), true, &problems, &track);
    if (status == ASDIC_OK) {
        status = asdic_problems_report(&problems, ctx);
    }
    asdic_problems_finish(&problems);
    judge(ctx, status, track);
    if (track) {
        double from_s = asdic_track_start_s(track), to_s = asdic_track_end_s(track);
        asdic_pose pose = asdic_track_pose(track, from_s + 0.5 * (to_s - from_s));
        if (!isfinite(pose.position_m.x) || !isfinite(pose.yaw_rad)) {
            abort();
        }
    }
    asdic_track_destroy(&track);
    asdic_context_destroy(&ctx);
}

/* Moves the first moving object of a scene that is committed. */
static void move(const asdic_scene *scene) {
    asdic_placement *placement = NULL;
    const asdic_pose there = {.position_m = {3.0, -2.0, 9.0}, .yaw_rad = 1.0, .roll_rad = 0.5};
    if (asdic_placement_create(scene, &placement) == ASDIC_OK) {
        asdic_placement_move(placement, 0, &there);
    }
    asdic_placement_destroy(&placement);
}

/* A mesh that loads must be sound: finite, and fit to be built into a scene, where it moves also. */
static void use_mesh(asdic_context *ctx, asdic_mesh *mesh) {
    asdic_scene *scene = NULL;
    asdic_pose here = {.position_m = {0.0, 0.0, 10.0}};
    asdic_mesh_info info = asdic_mesh_get_info(mesh);
    if (info.triangles == 0 || !isfinite(info.min_m.x) || !isfinite(info.max_m.z)) {
        abort();
    }
    /* Steel is smoothed, which sand is not. */
    asdic_material sand = asdic_material_bottom(2.0), steel = asdic_material_facet(45.0, 0.0, 0.0);
    if (asdic_scene_create(ctx, &scene) == ASDIC_OK &&
        asdic_scene_add_bottom(scene, mesh, here, sand) == ASDIC_OK &&
        asdic_scene_add_moving_object(scene, "moves", mesh, here, steel) == ASDIC_OK &&
        asdic_scene_commit(scene) == ASDIC_OK) {
        asdic_scene_altitude_m(scene, (asdic_vec3){0.1, 0.1, 0.0});
        move(scene);
    }
    asdic_scene_destroy(&scene);
}

static void load_mesh(const char *name, const uint8_t *data, size_t size) {
    asdic_context *ctx = NULL;
    asdic_mesh *mesh = NULL;
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return;
    }
    asdic_status status = asdic_mesh_load(ctx, scratch_write(name, data, size), 1.0, true, &mesh);
    judge(ctx, status, mesh);
    if (mesh) {
        use_mesh(ctx, mesh);
    }
    asdic_mesh_destroy(&mesh);
    asdic_context_destroy(&ctx);
}

void fuzz_obj(const uint8_t *data, size_t size) {
    load_mesh("mesh.obj", data, size);
}

void fuzz_off(const uint8_t *data, size_t size) {
    load_mesh("mesh.off", data, size);
}

void fuzz_ply(const uint8_t *data, size_t size) {
    load_mesh("mesh.ply", data, size);
}

void fuzz_stl(const uint8_t *data, size_t size) {
    load_mesh("mesh.stl", data, size);
}

void fuzz_grid(const uint8_t *data, size_t size) {
    asdic_context *ctx = NULL;
    asdic_mesh *mesh = NULL;
    if (asdic_context_create(&ctx) != ASDIC_OK) {
        return;
    }
    asdic_status status =
        asdic_mesh_load_grid(ctx, scratch_write("grid.asc", data, size), true, &mesh);
    judge(ctx, status, mesh);
    if (mesh) {
        use_mesh(ctx, mesh);
    }
    asdic_mesh_destroy(&mesh);
    asdic_context_destroy(&ctx);
}
