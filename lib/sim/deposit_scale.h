/*
 * The fixed-point scale of the accumulator.
 */
#ifndef ASDIC_SIM_DEPOSIT_SCALE_H
#define ASDIC_SIM_DEPOSIT_SCALE_H

#include "../../kernels/ping_types.h"

#include <stddef.h>

/* Fills PING's deposit_scale and deposit_limit from its water and the materials, for all pings of a
 * simulator. No sum overflows that physics allows; the quantum lies about 180 dB below the loudest
 * conceivable sum, before range. */
void asdic_deposit_scales(const dev_material *materials, size_t count, dev_ping *ping);

#endif
