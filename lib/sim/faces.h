/*
 * Faces of objects that rays are aimed at, see kernels/faces.h.
 */
#ifndef ASDIC_SIM_FACES_H
#define ASDIC_SIM_FACES_H

#include "../../kernels/ping_types.h"
#include "laws/scatterer.h"
#include "ocl/ocl.h"
#include "scene/placement.h"

typedef struct asdic_faces {
    dev_face *faces; /* those that rays are aimed at, the first COUNT */
    float *density;  /* of rays, per square metre and ray aimed at faces, by triangle */
    size_t count, capacity, triangles;
    double clearance_m; /* of the sonar above the highest of them that lies lower; INFINITY: none */
    asdic_buffer *face_buffer, *density_buffer;
} asdic_faces;

/* Room for the faces of SCENE's objects; without any, or SCENE NULL: CAPACITY 0. */
asdic_status asdic_faces_init(asdic_faces *faces, asdic_device *device, const asdic_scene *scene);
void asdic_faces_finish(asdic_faces *faces);

/* What faces are looked at with, and by how many threads. */
typedef struct asdic_eye {
    const dev_ping *ping;              /* round whose pose they are chosen */
    const dev_beam *aimed;             /* its apertures, transmitter first */
    const asdic_scatterer *scatterers; /* by material */
    unsigned threads;
} asdic_eye;

/* Which faces rays are aimed at from POSITION_M, by their areas and by what they send back; tells the device. Of objects
 * with a cone of their own (asdic_cones_place) only those are taken that its rays seldom meet. */
asdic_status asdic_faces_choose(asdic_faces *faces, const asdic_placement *placement,
                                asdic_vec3 position_m, const asdic_eye *eye);

#endif
