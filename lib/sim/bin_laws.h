/*
 * What a ping's depth makes of its bins.
 */
#ifndef ASDIC_SIM_BIN_LAWS_H
#define ASDIC_SIM_BIN_LAWS_H

#include "simulator.h"

/* Tabulates over the bins what the current ping's WATER does to them, unless that is known; pings at one
 * depth share it. Whether what the device has to know of it (sim->water) has changed. */
bool asdic_bin_laws_tabulate(asdic_simulator *sim, const asdic_water_column *water);

#endif
