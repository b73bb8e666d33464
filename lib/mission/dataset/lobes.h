/*
 * In which beams' main lobes the objects of a frame lie; other beams hear them by side lobes.
 */
#ifndef ASDIC_MISSION_DATASET_LOBES_H
#define ASDIC_MISSION_DATASET_LOBES_H

#include "mission/mission.h"

/* HEARD[(number - 1) * beams + beam] for each object, by the numbers that truth gives them: whether the beam hears
 * some of the object at half power or more, in bearing from the sonar at FRAME's first pose. OWNER has the scene, perhaps
 * with its objects elsewhere. To be freed; NULL: no memory. */
bool *asdic_lobes_reach(const asdic_mission *frame, const asdic_mission *owner);

#endif
