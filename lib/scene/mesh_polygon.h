/*
 * A polygon as triangles, concave ones included.
 */
#ifndef ASDIC_SCENE_MESH_POLYGON_H
#define ASDIC_SCENE_MESH_POLYGON_H

#include <asdic/common.h>

/* More corners than any modeller writes; ear clipping takes their square in time. */
#define ASDIC_POLYGON_MAX_CORNERS 4096

/* Cuts the polygon CORNERS (indices into VERTICES_M, 3 doubles each) into at most COUNT - 2
 * triangles, wound as the polygon, and writes their 3 indices each to TRIANGLES. *WRITTEN 0 with
 * true: no area. False: the outline crosses itself. CORNERS is used up. */
bool asdic_polygon_triangulate(const double *vertices_m, uint32_t *corners, size_t count,
                               uint32_t *triangles, size_t *written);

#endif
