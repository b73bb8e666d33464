/*
 * Where the apertures look and where rays should go: world frames of beams, sampling lobes.
 */
#ifndef ASDIC_SIM_AIM_H
#define ASDIC_SIM_AIM_H

#include <asdic/ping.h>

#include "../../kernels/ping_types.h"

/* A sound speed for wavelengths, and so for widths of beams, that need be no truer. */
#define ASDIC_NOMINAL_MPS 1500.0

/* Distinct aims that get a lobe of their own; beyond, lobes are spread over the sector. */
#define ASDIC_AIMS_MOST 8

/* Face frame of BEAM on a vehicle at POSE: rows turn a world direction into (away from the face,
 * along the horizontal side, along the vertical side). */
dev_beam asdic_aim_beam(const asdic_beam *beam, const asdic_pose *pose, double wavelength_m);

/* The direction of a side of BEAM, pi times as long as the side in wavelengths. */
void asdic_aim_side(const dev_beam *beam, bool vertical, float side[3]);

/* Fills LOBES (at most DEV_MAX_LOBES) for SAMPLER from the aimed transmitter (beams[0]) and its
 * receivers; returns how many. REAR: the apertures also leak backwards. */
unsigned asdic_aim_lobes(asdic_sampler sampler, const dev_beam *beams, size_t receiver_count,
                         bool rear, dev_lobe *lobes);

/* How loud a direction TOWARDS a world point may be: envelopes of sinc^2, nulls filled, of the transmitter
 * (beams[0]) and of the receiver that hears it best. */
double asdic_aim_envelope(const dev_beam *beams, size_t receiver_count, asdic_vec3 towards);

/* How many rays, next to each other in elevation, a footprint in range should span; LOBE is the first of a
 * ping's lobes. Successive rays of the lattice differ in azimuth. Where they aim at single beams, few
 * suffice. Over a sector as many are needed as beams lie side by side in it: else a beam's bins would depend
 * on which of the rays happened to look its way. */
double asdic_aim_footprint_rays(const dev_lobe *lobe);

#endif
