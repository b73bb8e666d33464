#include "simple.h"

kernel void add(global const int *a, global int *out, const int amount, const uint n) {
    const uint i = get_global_id(0);
    if (i < n) {
        out[i] = a[i] + AMOUNT_SCALE * amount;
    }
}

/* Sizes as the device sees them, and local memory handed in as an argument. */
kernel void sizes(global uint *out, local uint *scratch) {
    scratch[get_local_id(0)] = 1;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (get_global_id(0) == 0) {
        out[0] = (uint)get_global_size(0);
        out[1] = (uint)get_local_size(0);
        out[2] = scratch[get_local_size(0) - 1];
    }
}
