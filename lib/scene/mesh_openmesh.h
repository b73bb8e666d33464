/*
 * The bridge to OpenMesh, the only C++ of the library.
 */
#ifndef ASDIC_SCENE_MESH_OPENMESH_H
#define ASDIC_SCENE_MESH_OPENMESH_H

#include "mesh_scan.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Polygons as OpenMesh returns them. Freed by asdic_polygons_finish. */
typedef struct asdic_polygons {
    float *vertices_m; /* 3 * vertex_count */
    uint32_t *corners; /* of all facets, one after the other */
    uint32_t *first;   /* facet_count + 1 offsets into corners */
    size_t vertex_count, corner_count, facet_count;
} asdic_polygons;

/* Reads the scanned file's bytes. ASDIC_ERROR_UNSUPPORTED in a build without OpenMesh. Safe to call
 * from several threads: OpenMesh's global state is guarded, its own messages are dropped. */
asdic_status asdic_openmesh_read(const asdic_mesh_scan *scan, asdic_polygons *out);
void asdic_polygons_finish(asdic_polygons *polygons);

#ifdef __cplusplus
}
#endif

#endif
