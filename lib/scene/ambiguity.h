/*
 * Edges of which a mesh does not say whether plates meet there or a round body is cut coarsely.
 */
#ifndef ASDIC_SCENE_AMBIGUITY_H
#define ASDIC_SCENE_AMBIGUITY_H

#include "scene.h"

/* The crease angle that takes all of them for round. */
#define ASDIC_ROUND_DEG 50.0

typedef struct asdic_ambiguity {
    size_t edges;
    double faces_m2;          /* of all that meet at them */
    double most_rad;          /* that the surface turns at one of them */
    double area_m2, turn_rad; /* of the face, and at the edge, where an echo hangs on it most */
} asdic_ambiguity;

/* Of the triangles from BEGIN to END, a part's, of a committed scene; none where the part is known to be round or flat:
 * it is a primitive, or its crease angle was chosen. */
asdic_status asdic_scene_find_ambiguity(const asdic_scene *scene, size_t begin, size_t end,
                                        asdic_ambiguity *out);

#endif
