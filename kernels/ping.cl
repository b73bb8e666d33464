/*
 * What follows the rays of a ping, as one program: a driver then reads the formulas once, not five times.
 */
#include "advance.cl"
#include "collect.cl"
#include "multipath.cl"
#include "shade.cl"
#include "volume.cl"
