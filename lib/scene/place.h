/*
 * From a mesh's corners to a scene's triangles.
 */
#ifndef ASDIC_SCENE_PLACE_H
#define ASDIC_SCENE_PLACE_H

#include "scene.h"

#include "../base/vec.h"

/* Three corners from the mesh's frame to the world. */
void asdic_place_corners(const double mesh_m[9], asdic_mat3 turn, asdic_vec3 position_m,
                         double world_m[9]);

/* Fills corners, recentred and rounded, and the normal of OUT; its other members stay. */
void asdic_place_triangle(const double world_m[9], asdic_vec3 origin_m, dev_triangle *out);

/* Bounding sphere of COUNT triangles' corners, and their box. */
void asdic_place_sphere(const double *world_m, size_t count, asdic_part *part, asdic_vec3 *lo_m,
                        asdic_vec3 *hi_m);

/* Area of a part's COUNT triangles, and whether they face outwards about its centre. */
void asdic_place_faces(const double *world_m, size_t count, asdic_part *part);

#endif
