/*
 * Meshes from files, by file: one that several objects name is read once, and so is one that every run of a
 * trial names, as long as the file stays as it is.
 */
#include "mission_build.h"

#include "base/context.h"

#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

struct mission_mesh {
    char *path;
    double scale;
    bool z_up;
    struct stat file; /* when it was read */
    asdic_mesh *mesh;
};

static bool is_file(const struct stat *a, const struct stat *b) {
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino && a->st_size == b->st_size &&
           a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec == b->st_mtim.tv_nsec;
}

static mission_mesh *find(asdic_mission *m, const char *path) {
    for (size_t i = 0; i < m->mesh_count; i++) {
        if (strcmp(m->meshes[i].path, path) == 0) {
            return &m->meshes[i];
        }
    }
    return NULL;
}

/* The place of the mesh from PATH; NULL when memory is short. */
static mission_mesh *add(asdic_mission *m, const char *path) {
    mission_mesh *grown = realloc(m->meshes, (m->mesh_count + 1) * sizeof *grown);
    char *copy = strdup(path);
    m->meshes = grown ? grown : m->meshes;
    if (!grown || !copy) {
        free(copy);
        return NULL;
    }
    grown[m->mesh_count] = (mission_mesh){.path = copy};
    return &grown[m->mesh_count++];
}

asdic_status asdic_mission_need_mesh(mission_builder *b, const char *path, double scale, bool z_up,
                                     const asdic_mesh **out) {
    struct stat now = {0};
    mission_mesh *kept = find(b->mission, path);
    bool is_there = stat(path, &now) == 0;
    if (kept && is_there && kept->mesh && kept->scale == scale && kept->z_up == z_up &&
        is_file(&kept->file, &now)) {
        *out = kept->mesh;
        return ASDIC_OK;
    }
    kept = kept ? kept : add(b->mission, path);
    if (!kept) {
        return asdic_fail_memory(b->ctx, "a mesh");
    }
    asdic_mesh_destroy(&kept->mesh);
    kept->scale = scale;
    kept->z_up = z_up;
    kept->file = now;
    asdic_status status = asdic_mesh_load(b->ctx, path, scale, z_up, &kept->mesh);
    *out = kept->mesh;
    return status;
}

void asdic_mission_take_meshes(asdic_mission *mission, asdic_mission *donor) {
    mission->meshes = donor->meshes;
    mission->mesh_count = donor->mesh_count;
    donor->meshes = NULL;
    donor->mesh_count = 0;
}

void asdic_mission_forget_meshes(asdic_mission *mission) {
    for (size_t i = 0; i < mission->mesh_count; i++) {
        free(mission->meshes[i].path);
        asdic_mesh_destroy(&mission->meshes[i].mesh);
    }
    free(mission->meshes);
    mission->meshes = NULL;
    mission->mesh_count = 0;
}
