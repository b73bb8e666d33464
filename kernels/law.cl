/*
 * A law's table at COUNT grazing angles, each given as its sine and its squared cosine.
 */
#include "law_table.h"

__kernel void law(__global const uint *tables, uint at, __global const float *angles,
                  __global float *out, uint count) {
    uint first = (uint)(get_global_id(0)) * ASDIC_WIDTH;
    real sine = R(1.0), cos2 = R(0.0);
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        uint i = min(first + lane, count - 1u);
        ((float *)&sine)[lane] = angles[2u * i];
        ((float *)&cos2)[lane] = angles[2u * i + 1u];
    }
    real value = law_table_lin(tables, (natural)(at), sine, cos2);
    for (uint lane = 0; lane < ASDIC_WIDTH && first + lane < count; lane++) {
        out[first + lane] = ((const float *)&value)[lane];
    }
}
