/*
 * The expected ping where the sound speed changes with depth.
 */
#ifndef ASDIC_SIM_EXPECTED_BENT_H
#define ASDIC_SIM_EXPECTED_BENT_H

#include "expected.h"

/* How beams look: a ring each, and its profile. */
typedef struct asdic_bent_view {
    const asdic_ring *rings;
    asdic_ring_profile *const *profiles;
    bool is_quick; /* to 0.01 dB */
} asdic_bent_view;

/* Adds bottom, surface and volume of each beam to PING, which holds 0. */
asdic_status asdic_expected_bent(asdic_context *ctx, const asdic_flat_laws *laws,
                                 const asdic_environment *env, const asdic_sonar *sonar,
                                 const asdic_bent_view *view, asdic_ping *ping);

#endif
