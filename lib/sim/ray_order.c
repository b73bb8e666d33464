#include "ray_order.h"

/* Rays that fly as one packet. */
#define PACKET 16.0

void asdic_ray_order(dev_ping *ping) {
    double slots = (double)ping->groups * ping->per_group;
    /* A packet of a block of F rays out of N spans F / N of elevation and PACKET / F of azimuth. */
    dev_uint before = 1, block = 1, flips = 0;
    while ((double)block * block < PACKET * slots) {
        dev_uint next = before + block;
        before = block;
        block = next;
        flips ^= 1;
    }
    /* The square of a Fibonacci number is 1 or -1 modulo the next, in turn. */
    ping->order_block = block;
    ping->order_inverse = flips ? block - before : before;
    for (dev_uint k = 0; k < 16; k++) {
        ping->order_lanes[k] = k * ping->order_inverse % block;
    }
}
