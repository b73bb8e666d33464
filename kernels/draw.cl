/*
 * Rays and what those of pilot pings bring, as one program: the same for every way in which a ping is summed.
 */
#include "pilot.cl"
#include "sample.cl"
