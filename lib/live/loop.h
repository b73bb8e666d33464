/*
 * The loop inside.
 */
#ifndef ASDIC_LIVE_LOOP_H
#define ASDIC_LIVE_LOOP_H

#include <asdic/loop.h>

/* The simulator; it may be used while no ping is submitted. */
asdic_simulator *asdic_loop_simulator(const asdic_loop *loop);

/* Numbers pings from PING on, which is at the time that LOOP begins at. Before the first is submitted. */
void asdic_loop_begin_at(asdic_loop *loop, uint64_t ping);

#endif
