/*
 * All kernels of a ping as one program: a driver then reads the formulas once, not six times.
 */
#include "advance.cl"
#include "collect.cl"
#include "multipath.cl"
#include "reduce.cl"
#include "sample.cl"
#include "shade.cl"
#include "pilot.cl"
#include "volume.cl"
