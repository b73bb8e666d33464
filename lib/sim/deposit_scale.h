/*
 * The fixed-point scale of the accumulator.
 */
#ifndef ASDIC_SIM_DEPOSIT_SCALE_H
#define ASDIC_SIM_DEPOSIT_SCALE_H

#include "laws/scatterer.h"
#include "scene/scene.h"

#include <asdic/sonar.h>

#include "../../kernels/ping_types.h"

/* Fills the scale and limit of PING's sums from its water, its rays, the transmitter and what the
 * scene's parts are made of (SCATTERERS, as the scene numbers its materials, then the surface), for all
 * pings of a simulator; LAYERS: its water has several, which focus.
 * If rays were exact, sums would come to 2^61 at most, of 2^63 that there are. The quantum is about 180 dB
 * below the loudest possible sum of its component, before range. */
void asdic_deposit_scales(const asdic_scene *scene, const asdic_beam *transmitter,
                          const asdic_scatterer *scatterers, bool layers, dev_ping *ping);

#endif
