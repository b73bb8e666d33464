/*
 * Profiles of rings that come again, as those of a vehicle that takes the same attitudes over and over.
 */
#ifndef ASDIC_SIM_RING_SHELF_H
#define ASDIC_SIM_RING_SHELF_H

#include "ring_profile.h"

#include <stddef.h>

typedef struct asdic_ring_shelf asdic_ring_shelf;

/* Keeps the profiles of at most SETS sets of rings. */
asdic_status asdic_ring_shelf_create(asdic_context *ctx, size_t sets, asdic_ring_shelf **out);
void asdic_ring_shelf_destroy(asdic_ring_shelf **shelf);

/* The profiles of COUNT RINGS; OUT is the shelf's, until the next call. */
asdic_status asdic_ring_shelf_take(asdic_ring_shelf *shelf, const asdic_ring *rings, size_t count,
                                   asdic_ring_profile *const **out);

#endif
