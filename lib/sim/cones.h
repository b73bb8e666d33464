/*
 * Cones: objects that get rays of their own.
 */
#ifndef ASDIC_SIM_CONES_H
#define ASDIC_SIM_CONES_H

#include "scene/scene.h"

#include "../../kernels/ping_types.h"

/* Gives PING, whose rays, range and rear gain are set, its cones, seen from POSITION_M with BEAMS
 * (transmitter first), and the rest of its rays to the background. */
void asdic_cones_place(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                       const dev_beam *beams, dev_ping *ping);

#endif
