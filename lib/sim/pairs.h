/*
 * Pairs of ways: where several rays come to a body through layers, what goes out by each of them comes home by all. Rays
 * of a ping go home as they came; what they bring of such a body is louder by what comes home by the others.
 */
#ifndef ASDIC_SIM_PAIRS_H
#define ASDIC_SIM_PAIRS_H

#include "passage.h"

/* Sets the pairs of PING, which is aimed from POSITION_M with BEAMS (transmitter first): of the parts that
 * asdic_cones_pick finds, by WAY, the straight one of asdic_passages_find. */
void asdic_pairs_place(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                       const dev_beam *beams, const asdic_passage *way, dev_ping *ping);

#endif
