/*
 * How meshes are made, by loaders and primitives: allocate, fill in, complete.
 */
#ifndef ASDIC_SCENE_MESH_BUILD_H
#define ASDIC_SCENE_MESH_BUILD_H

#include <stddef.h>

#include "triangles.h"

/* Farther out, single precision has nothing left for the scene (and no sea is that wide). */
#define ASDIC_MESH_LIMIT_M 1e9

/* Uninitialised vertices and indices of the given numbers. */
asdic_status asdic_mesh_allocate(asdic_context *ctx, size_t vertex_count, size_t triangle_count,
                                 asdic_mesh **out);

/* Checks numbers and indices, welds vertices, drops and counts degenerate facets and copies, counts open
 * edges. NAME begins every error. */
asdic_status asdic_mesh_complete(asdic_context *ctx, asdic_mesh *mesh, const char *name);
/* The same of vertices without roundings, which stay: a primitive may be a billion times as long as wide. */
asdic_status asdic_mesh_complete_exact(asdic_context *ctx, asdic_mesh *mesh, const char *name);

/* Its steps. Corners become the lowest vertex that is where theirs is, to the roundings that part a
 * seam's two sides; ... */
asdic_status asdic_mesh_weld(asdic_context *ctx, asdic_mesh *mesh);
/* ... of facets with the same corners, whichever way they are wound, the first stays: all of them would be heard; ... */
asdic_status asdic_mesh_drop_copies(asdic_context *ctx, asdic_mesh *mesh);
/* ... and edges that belong to one facet only are open. */
asdic_status asdic_mesh_count_open_edges(asdic_context *ctx, asdic_mesh *mesh);

/* WELDED[i] becomes the lowest index of a vertex exactly where vertex i is; VERTICES_M holds 3 * COUNT. */
asdic_status asdic_weld_vertices(asdic_context *ctx, const double *vertices_m, size_t count,
                                 uint32_t *welded);

/* Sets the remark on an extent that looks like another unit's. A body of more than 200 m is a rare
 * ship, or one in millimetres; a bottom may well be 20 km wide, and what is ground is wider than high. */
void asdic_mesh_hint_at_units(asdic_mesh_info *info, bool body, bool ground);

asdic_vec3 asdic_mesh_vertex(const asdic_mesh *mesh, size_t index);

/* Triangles of asdic_mesh_sphere and asdic_mesh_cylinder. */
size_t asdic_sphere_triangles(unsigned segments);
size_t asdic_cylinder_triangles(unsigned segments);

#endif
