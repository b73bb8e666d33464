/*
 * The edges that stand for smooth faces: one that two faces of a plane share is none of what they are together.
 */
#ifndef ASDIC_SIM_BORDER_H
#define ASDIC_SIM_BORDER_H

#include "piece.h"
#include "scene/placement.h"

typedef struct asdic_border {
    asdic_piece *sides; /* DEV_FORM_EDGE */
    size_t count, capacity;
} asdic_border;

/* Whether there was memory for one more. */
bool asdic_border_add(asdic_border *border, const asdic_piece *side);

/* Leaves out what faces share, and sorts the rest. */
void asdic_border_join(asdic_border *border, const asdic_placement *placement);

#endif
