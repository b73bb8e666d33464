/*
 * How meshes are made, by loaders and primitives: allocate, fill in, complete.
 */
#ifndef ASDIC_SCENE_MESH_BUILD_H
#define ASDIC_SCENE_MESH_BUILD_H

#include "triangles.h"

/* Farther out, single precision has nothing left for the scene (and no sea is that wide). */
#define ASDIC_MESH_LIMIT_M 1e9

/* Uninitialised vertices and indices of the given numbers. */
asdic_status asdic_mesh_allocate(asdic_context *ctx, size_t vertex_count, size_t triangle_count,
                                 asdic_mesh **out);

/* Checks numbers and indices, drops and counts degenerate facets, counts open edges. NAME begins
 * every error. */
asdic_status asdic_mesh_complete(asdic_context *ctx, asdic_mesh *mesh, const char *name);

/* Edges that belong to one facet only, once vertices at one place count as one. */
asdic_status asdic_mesh_count_open_edges(asdic_context *ctx, const asdic_mesh *mesh, size_t *count);

/* WELDED[i] becomes the lowest index of a vertex where vertex i is, to the roundings that part a
 * seam's two sides; VERTICES_M holds 3 * COUNT. INDICES NULL: every three vertices are a triangle. */
asdic_status asdic_weld_vertices(asdic_context *ctx, const double *vertices_m, size_t count,
                                 const uint32_t *indices, size_t triangles, uint32_t *welded);

/* Sets the remark on an extent that looks like another unit's. A body of more than 200 m is a rare
 * ship, or one in millimetres; a bottom may well be 20 km wide. */
void asdic_mesh_hint_at_units(asdic_mesh_info *info, bool body);

asdic_vec3 asdic_mesh_vertex(const asdic_mesh *mesh, size_t index);

#endif
