/*
 * A ring's sum over all elevations, computed once: its value and its integral anywhere.
 */
#ifndef ASDIC_SIM_RING_PROFILE_H
#define ASDIC_SIM_RING_PROFILE_H

#include "ring.h"

typedef struct asdic_ring_profile asdic_ring_profile;

/* Piecewise Chebyshev, refined until the sum is known to 1e-10 of its local largest value. */
asdic_status asdic_ring_profile_create(asdic_context *ctx, const asdic_ring *ring,
                                       asdic_ring_profile **out);
void asdic_ring_profile_destroy(asdic_ring_profile **profile);

/* The profile from now on is that of rings that look LOWER_RAD lower, as of a vehicle that has turned so little that
 * the ring is only moved in elevation. */
void asdic_ring_profile_lower(asdic_ring_profile *profile, double lower_rad);

/* asdic_ring_sum, to a relative 1e-6 also in the nulls of a pattern. */
double asdic_ring_profile_sum(const asdic_ring_profile *profile, double elevation_rad);

/* Integral of sum(e) cos(e) over e from -pi/2 to ELEVATION_RAD: the two-way beam's solid angle below
 * that elevation (positive looks down), sr. */
double asdic_ring_profile_solid_angle(const asdic_ring_profile *profile, double elevation_rad);

#endif
