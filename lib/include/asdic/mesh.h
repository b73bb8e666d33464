/*
 * Triangle meshes: from files (OBJ, PLY, STL, OFF through OpenMesh; ESRI ASCII grids), from
 * arrays, and primitives. A mesh is geometry only; a scene gives it a place and a material.
 */
#ifndef ASDIC_MESH_H
#define ASDIC_MESH_H

#include <asdic/context.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_mesh asdic_mesh;

typedef struct asdic_mesh_info {
    size_t triangles, vertices;
    size_t dropped;    /* degenerate facets left out (vertices apart by roundings are one) */
    size_t copies;     /* facets left out that are there already, wound the same way */
    size_t open_edges; /* edges with one facet only */
    asdic_vec3 min_m, max_m;
    char hint[160]; /* "" or a remark: "300 m across: millimetres? (scale 0.001)" */
} asdic_mesh_info;

/* Vertices are multiplied by SCALE. With Z_UP the file's (x, y, z) = (east, north, up) becomes
 * NED (y, x, -z), facet orientation kept. Refuses what would load as wrong geometry:
 * ASDIC_ERROR_INPUT, with file, line and what is wrong. ASDIC_ERROR_UNSUPPORTED without
 * OpenMesh. */
ASDIC_API asdic_status asdic_mesh_load(asdic_context *ctx, const char *path, double scale,
                                       bool z_up, asdic_mesh **out);

/* ESRI ASCII grid (.asc) of depths or heights; VALUES_ARE_DEPTH: positive down, else heights up.
 * Cells without data leave holes. Rows run south: x north, y east, the grid's own origin.
 * ASDIC_ERROR_INPUT as above. */
ASDIC_API asdic_status asdic_mesh_load_grid(asdic_context *ctx, const char *path,
                                            bool values_are_depth, asdic_mesh **out);

/* VERTICES_M holds 3 * VERTEX_COUNT coordinates, INDICES 3 per triangle; both are copied.
 * ASDIC_ERROR_INPUT for what no file may hold: a corner that is none or not finite, or no facet. */
ASDIC_API asdic_status asdic_mesh_from_triangles(asdic_context *ctx, const double *vertices_m,
                                                 size_t vertex_count, const uint32_t *indices,
                                                 size_t triangle_count, asdic_mesh **out);

/* Primitives centred at the origin, outward facets. The cylinder's axis is y; the plate lies in
 * the y-z plane with its normal along x. SEGMENTS is the number of facets round. */
ASDIC_API asdic_status asdic_mesh_box(asdic_context *ctx, asdic_vec3 size_m, asdic_mesh **out);
ASDIC_API asdic_status asdic_mesh_sphere(asdic_context *ctx, double radius_m, unsigned segments,
                                         asdic_mesh **out);
ASDIC_API asdic_status asdic_mesh_cylinder(asdic_context *ctx, double radius_m, double length_m,
                                           unsigned segments, asdic_mesh **out);
ASDIC_API asdic_status asdic_mesh_plate(asdic_context *ctx, double width_m, double height_m,
                                        asdic_mesh **out);

ASDIC_API void asdic_mesh_destroy(asdic_mesh **mesh);
/* In the mesh's own frame, metres. */
ASDIC_API asdic_mesh_info asdic_mesh_get_info(const asdic_mesh *mesh);

#ifdef __cplusplus
}
#endif

#endif
