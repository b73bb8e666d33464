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

/* Not where PART is known to be round or flat: it is a primitive, or its crease angle was chosen; nor where it is rough. */
bool asdic_scene_may_be_ambiguous(const asdic_scene *scene, const asdic_part *part);

/* Of the triangles from BEGIN to END, those of a part that may be ambiguous, of a committed scene. */
asdic_status asdic_scene_find_ambiguity(const asdic_scene *scene, size_t begin, size_t end,
                                        asdic_ambiguity *out);

#endif
