/*
 * What each bin's energy comes from (asdic/truth.h), from the device's rows (kernels/truth.h).
 */
#ifndef ASDIC_SIM_TRUTH_H
#define ASDIC_SIM_TRUTH_H

#include "simulator.h"

/* Buffers, where truth is wanted. ASDIC_ERROR_ARGUMENT: more objects than can be told apart. */
asdic_status asdic_truth_init(asdic_simulator *sim);
void asdic_truth_finish(asdic_simulator *sim);

/* Beams whose truth is told together, and which a thread takes at once. */
#define ASDIC_TRUTH_BEAMS 4u

/* Before the rays of the first COUNT shots: says which bins each row spans, clears the rows. Nothing where no
 * ping of OUT has truth. */
asdic_status asdic_truth_begin(asdic_simulator *sim, size_t count, asdic_ping *const *out);

/* After them: fetches the rows; those of a fan are fetched with its tiles. */
asdic_status asdic_truth_fetch(asdic_simulator *sim);

/* *ROW: where to add what WHAT gives to each beam, until the next call; NULL where nobody asks. */
asdic_status asdic_truth_point_row(asdic_simulator *sim, asdic_truth_point what, double **row);

/* Fills the truth of ASDIC_TRUTH_BEAMS beams of OUT from BEAM on, as soon as they have the levels of SHOT and while
 * these are in a cache; where points or the pulse's length will change them, does nothing. WORKER: the thread's
 * number, below setup.threads. */
void asdic_truth_tell(asdic_simulator *sim, const asdic_ping_shot *shot, unsigned worker,
                      size_t beam, asdic_ping *out);

/* Fills the truth of OUT, which is what shot NTH became, with points and pulse, before speckle, where
 * asdic_truth_tell has not. */
void asdic_truth_end(asdic_simulator *sim, size_t nth, asdic_ping *out);

#endif
