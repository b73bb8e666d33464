/*
 * The range at which what is somewhere in the water is heard: that of its time, by the ray that leads
 * there. Where rays bend it is another than the distance.
 */
#ifndef ASDIC_MISSION_HEARD_RANGE_H
#define ASDIC_MISSION_HEARD_RANGE_H

#include "sim/layers.h"

#include <asdic/scene.h>

typedef struct asdic_heard_water {
    bool bends;
    asdic_layers layers;
    double from_m, sound_speed_mps; /* of the sonar */
    double top_m, bottom_m;         /* planes that rays do not cross; infinite: none */
} asdic_heard_water;

/* The water of ENV round a sonar FROM_M deep in SCENE. */
asdic_heard_water asdic_heard_water_of(const asdic_environment *env, const asdic_scene *scene,
                                       double from_m);

/* Where something TO_M from the sonar is heard, by the ray that spreads least; in a shadow its distance. */
double asdic_heard_range_m(const asdic_heard_water *water, asdic_vec3 to_m);

#endif
