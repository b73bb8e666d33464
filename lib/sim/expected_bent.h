/*
 * The expected ping where the sound speed changes with depth.
 */
#ifndef ASDIC_SIM_EXPECTED_BENT_H
#define ASDIC_SIM_EXPECTED_BENT_H

#include "expected.h"

/* Adds bottom, surface and volume of each beam's ring, one of RINGS a beam, to PING, which holds 0. */
asdic_status asdic_expected_bent(asdic_context *ctx, const asdic_flat_laws *laws,
                                 const asdic_environment *env, const asdic_sonar *sonar,
                                 const asdic_ring *rings, asdic_ping *ping);

#endif
