/*
 * A mesh inside: indexed triangles in double, and how a scene sees its geometry.
 */
#ifndef ASDIC_SCENE_TRIANGLES_H
#define ASDIC_SCENE_TRIANGLES_H

#include <asdic/mesh.h>

struct asdic_mesh {
    double *vertices_m; /* 3 * vertex_count, mesh frame */
    uint32_t *indices;  /* 3 * triangle_count */
    size_t vertex_count, triangle_count;
    size_t dropped, copies;
    size_t open_edges;
    bool is_grid;
};

/* Corners of triangle I, mesh frame. */
static inline void asdic_mesh_corners(const asdic_mesh *mesh, size_t i, double out_m[9]) {
    for (int k = 0; k < 9; k++) {
        out_m[k] = mesh->vertices_m[3 * (size_t)mesh->indices[3 * i + k / 3] + k % 3];
    }
}

#endif
