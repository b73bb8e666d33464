/*
 * What primitives are made of, before they are made.
 */
#ifndef ASDIC_SCENE_PRIMITIVE_H
#define ASDIC_SCENE_PRIMITIVE_H

#include <stddef.h>

/* Parallels of a sphere between its poles. */
size_t asdic_sphere_rings(unsigned segments);

/* Triangles of asdic_mesh_sphere and asdic_mesh_cylinder. */
size_t asdic_sphere_triangles(unsigned segments);
size_t asdic_cylinder_triangles(unsigned segments);

#endif
