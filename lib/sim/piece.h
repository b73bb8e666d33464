/*
 * A piece of surface, a parallelogram or one half of it, and how it is cut.
 */
#ifndef ASDIC_SIM_PIECE_H
#define ASDIC_SIM_PIECE_H

#include "../../kernels/coherent.h"
#include "base/vec.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct asdic_piece {
    asdic_vec3 corner, edge1, edge2; /* scene frame */
    bool folded;                     /* the triangle between the edges */
    dev_uint form;                   /* DEV_FORM_* */
    dev_uint triangle, kind;
    uint32_t name[3]; /* the same for the same piece of the world */
} asdic_piece;

asdic_vec3 asdic_piece_middle(const asdic_piece *p);

/* Of an edge its length. */
double asdic_piece_area(const asdic_piece *p);

/* Farthest that a point of the piece is from its middle. */
double asdic_piece_reach(const asdic_piece *p);

/* Number K of four pieces of half the size. */
asdic_piece asdic_piece_quarter(const asdic_piece *p, uint32_t k);

/* Side number K of a triangle, whose middle edge2 then points at. */
asdic_piece asdic_piece_side(const asdic_piece *p, int k);

/* Number K of the two halves of a side. */
asdic_piece asdic_piece_half_side(const asdic_piece *p, uint32_t k);

/* Number K of the two triangles that a cut through the middle of edge1, edge2 or the third makes of a triangle. */
asdic_piece asdic_piece_half(const asdic_piece *p, int edge, uint32_t k);

#endif
