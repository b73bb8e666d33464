/*
 * Cones: objects that get rays of their own.
 */
#ifndef ASDIC_SIM_CONES_H
#define ASDIC_SIM_CONES_H

#include "scene/scene.h"

#include "../../kernels/ping_types.h"

/* The parts, at most DEV_MAX_CONES, that cones are for, to WITH_CONE; returns how many. */
unsigned asdic_cones_pick(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                          const dev_beam *beams, const dev_ping *ping, size_t *with_cone);

/* Gives PING, whose background, range and rear gain are set, its cones, seen from POSITION_M with BEAMS
 * (transmitter first), and takes their rays from the background. */
void asdic_cones_place(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                       const dev_beam *beams, dev_ping *ping);

#endif
