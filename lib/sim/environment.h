/*
 * The water at a sonar's depth: sound speed, absorption, and how levels fall with range.
 */
#ifndef ASDIC_SIM_ENVIRONMENT_H
#define ASDIC_SIM_ENVIRONMENT_H

#include <asdic/environment.h>
#include <asdic/sonar.h>

#include "laws/scatterer.h"

/* Sound speeds of water. */
#define ASDIC_SOUND_LEAST_MPS 1300.0
#define ASDIC_SOUND_MOST_MPS 1700.0

/* Whether point I of PROFILE cannot follow those before it; WHY says what is wrong with it. */
bool asdic_sound_profile_flaw(const asdic_sound_profile *profile, size_t i, char *why, size_t size);

typedef struct asdic_water_column {
    double sound_speed_mps, wavelength_m;
    double absorption_np_per_m; /* one-way decay of intensity: alpha ln 10 / 1e4 */
} asdic_water_column;

asdic_water_column asdic_water_column_at(const asdic_environment *env, const asdic_sonar *sonar,
                                         double depth_m);

/* The same as scattering laws ask for it. */
asdic_law_water asdic_water_column_laws(const asdic_water_column *water,
                                        const asdic_environment *env, const asdic_sonar *sonar);

/* The energy of the source, linear, re 1 uPa^2 at 1 m. The paper prints 2 d - 1 metres of absorption
 * where 2 (d - 1) is meant: its variant takes one metre more. */
double asdic_water_column_source_lin(const asdic_water_column *water, const asdic_environment *env,
                                     const asdic_sonar *sonar);

/* TL(d) d^2 = d^-2 exp(-2 k (d - 1)) at the centre of BIN. */
double asdic_water_column_loss(const asdic_water_column *water, double bin_m, size_t bin);

/* Integral over the received part of BIN of d^2 TL(d) = d^-2 exp(-2 k (d - 1)), 1/m. */
double asdic_water_column_volume(const asdic_water_column *water, double bin_m, double blanking_m,
                                 size_t bin);

/* What a cubic metre of water scatters back, 1/m. */
double asdic_volume_strength_lin(const asdic_environment *env, const asdic_sonar *sonar);

/* That SONAR has no more bins than it may in such water. */
asdic_status asdic_sonar_check_bins(asdic_context *ctx, const asdic_sonar *sonar,
                                    double sound_speed_mps);

#endif
