/*
 * What a vehicle can run into: the bottom, and objects of which some move.
 */
#ifndef ASDIC_TRIAL_TRIAL_HAZARDS_H
#define ASDIC_TRIAL_TRIAL_HAZARDS_H

#include "mission/mission.h"
#include "scene/nearest.h"

typedef struct asdic_hazards asdic_hazards;

/* Of MISSION, which is borrowed. */
asdic_status asdic_hazards_create(const asdic_mission *mission, asdic_hazards **out);
void asdic_hazards_destroy(asdic_hazards **hazards);

/* Whether anything moves. */
bool asdic_hazards_move(const asdic_hazards *hazards);

/* From the straight way FROM_M to TO_M (world), flown from FROM_S to TO_S (mission time), to what is
 * nearest, where that is below WITHIN_M; else WITHIN_M. The sea surface does not count. Objects go
 * as straight meanwhile as the vehicle does, and turn a little: as if those at the ends of the way
 * were all, which is exact for one that does not turn. */
asdic_nearest asdic_hazards_nearest(asdic_hazards *hazards, asdic_vec3 from_m, asdic_vec3 to_m,
                                    double from_s, double to_s, double within_m);

/* From LOOK's beginning (world) at TIME_S to the nearest surface of PART within SECTOR_RAD of its direction
 * and nearer than WITHIN_M; INFINITY: nothing of it is there. */
double asdic_hazards_ahead(asdic_hazards *hazards, size_t part, const asdic_way *look,
                           double time_s, double sector_rad, double within_m);

/* Whether POSITION_M (world) is inside an object at the time of the first ping, and inside which. */
bool asdic_hazards_hold(const asdic_hazards *hazards, asdic_vec3 position_m, size_t *part);

#endif
