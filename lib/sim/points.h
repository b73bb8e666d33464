/*
 * Point targets: echoes whose strength is given, not computed from a shape.
 */
#ifndef ASDIC_SIM_POINTS_H
#define ASDIC_SIM_POINTS_H

#include "simulator.h"

void asdic_points_finish(asdic_simulator *sim);

/* Adds the echo of every visible point to the object component and the total of OUT, SHOT's ping:
 * SL - TL(d) + TS with both beam patterns, in double, in the bin of its range. Through layers of water there may be
 * several rays to it, and where boundaries are mirrors one by way of the surface and one by way of the bottom plane: it
 * echoes out by each and back by each. What went by way of a mirror is multipath. Traced rays tell whether bottom,
 * surface or an object hides it. Nothing in it is random: it has no sampling error. */
asdic_status asdic_points_add(asdic_simulator *sim, const asdic_ping_shot *shot, asdic_ping *out);

#endif
