/*
 * Cones: objects that get rays of their own, and so do their images in planes that mirror.
 */
#ifndef ASDIC_SIM_CONES_H
#define ASDIC_SIM_CONES_H

#include "passage.h"

/* The parts, at most DEV_MAX_CONES, that cones are for, to WITH_CONE; returns how many. */
size_t asdic_cones_pick(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                        const dev_beam *beams, const dev_ping *ping, size_t *with_cone);

/* Gives PING a cone, and RAYS that the background has had. WIDE, across its axis, is as long as the sine of the half-angle
 * there; NARROW is that across both, at most as long. */
void asdic_cones_add(dev_ping *ping, asdic_vec3 towards, asdic_vec3 wide, double narrow,
                     dev_uint rays);

/* Gives PING, whose background, range and rear gain are set, its cones, seen from POSITION_M with
 * BEAMS (transmitter first), and takes their rays from the background: at objects, and at their
 * images in planes that mirror, by WAYS (asdic_passages_find; none: straight, through one layer).
 * Through layers each bundle of rays that comes to an object has a cone, and its shadow none. */
void asdic_cones_place(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                       const dev_beam *beams, const asdic_passage *ways, size_t way_count,
                       dev_ping *ping);

#endif
