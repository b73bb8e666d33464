/*
 * The loop inside.
 */
#ifndef ASDIC_LIVE_LOOP_H
#define ASDIC_LIVE_LOOP_H

#include <asdic/loop.h>

/* The simulator; it may be used while no ping is submitted. */
asdic_simulator *asdic_loop_simulator(const asdic_loop *loop);

#endif
