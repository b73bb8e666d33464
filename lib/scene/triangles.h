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
    size_t dropped;
    size_t open_edges;
};

#endif
