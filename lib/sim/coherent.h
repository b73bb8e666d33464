/*
 * Coherent pings: what the device needs for them, and how one is made. docs/coherent.md has the method.
 */
#ifndef ASDIC_SIM_COHERENT_H
#define ASDIC_SIM_COHERENT_H

#include "simulator.h"

#include "../../kernels/coherent.h"

/* What a coherent sonar's samples and looks are. */
typedef struct asdic_coherent_grid {
    size_t samples, looks; /* of an element; of a beam, in all bins */
    double sample_m, look_m, pulse_m, cell_m;
} asdic_coherent_grid;

asdic_coherent_grid asdic_coherent_grid_of(const asdic_sonar *sonar, double sound_speed_mps,
                                           size_t bins);

/* What a ping of BINS takes in: MARGIN bins beyond them, and all between FROM_M and TO_M (pulse.h); of
 * coherent ones as far as smooth pulses, and elements beside the middle, reach. */
typedef struct asdic_reach {
    size_t bins, margin;
    double from_m, to_m;
} asdic_reach;

asdic_reach asdic_reach_of(const asdic_sonar *sonar, const asdic_sampling *sampling,
                           double sound_speed_mps);

/* What a coherent ping needs of SAMPLING and SONAR. */
asdic_status asdic_coherent_check(asdic_context *ctx, const asdic_sonar *sonar,
                                  const asdic_sampling *sampling);

asdic_status asdic_coherent_create(asdic_simulator *sim, const asdic_water_column *water,
                                   asdic_coherent **out);
void asdic_coherent_destroy(asdic_coherent **coherent);

/* Ping INDEX at POSE; the pressures, too, where OUT has room for them. */
asdic_status asdic_coherent_ping(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                 asdic_ping *out);

/* What a ping at POSE will take, by a simulator without a device. */
asdic_status asdic_coherent_foresee(asdic_simulator *sim, const asdic_pose *pose,
                                    asdic_coherent_forecast *out);

/* For tests: the scatterers of the latest ping, in the order in which they are summed; *COUNT of them, to be
 * freed. */
asdic_status asdic_coherent_echoes(asdic_simulator *sim, dev_echo **echoes, size_t *count);
const dev_coherent *asdic_coherent_told(const asdic_coherent *coherent);

#endif
