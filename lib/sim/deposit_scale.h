/*
 * The fixed-point scale of the accumulator.
 */
#ifndef ASDIC_SIM_DEPOSIT_SCALE_H
#define ASDIC_SIM_DEPOSIT_SCALE_H

#include "scene/scene.h"

#include "../../kernels/ping_types.h"

/* Fills PING's deposit_scale and deposit_limit from its water, its rays and what the scene's parts
 * are made of (MATERIALS, as the scene numbers them), for all pings of a simulator. A sum of `rays`
 * deposits at the limit stays below 2^62, so that no sum can overflow; the quantum lies about 180 dB
 * below the loudest conceivable sum of its component, before range. */
void asdic_deposit_scales(const asdic_scene *scene, const dev_material *materials, dev_ping *ping);

#endif
