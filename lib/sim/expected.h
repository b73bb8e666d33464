/*
 * The pieces of the expected ping: one beam pair over a flat scene.
 */
#ifndef ASDIC_SIM_EXPECTED_H
#define ASDIC_SIM_EXPECTED_H

#include <asdic/expected.h>

#include "environment.h"
#include "ring_shelf.h"

/* What a scene's laws are made of, in double precision. */
typedef struct asdic_flat_laws {
    asdic_flat_scene flat;
    asdic_water_column water;
    double absorption_db_per_km;
    double source_lin;
    asdic_scatterer bottom, surface; /* that the scene has */
    double volume_lin;               /* 1/m */
} asdic_flat_laws;

asdic_flat_laws asdic_flat_laws_at(const asdic_flat_scene *flat, const asdic_environment *env,
                                   const asdic_sonar *sonar);

/* Backscattering strength of bottom or surface, 1/sr, at the sine of the grazing angle. */
double asdic_flat_strength(const asdic_flat_laws *laws, bool surface, double sin_grazing);

/* The two-way solid angle in the water at slant range D_M: what bottom and surface leave of the
 * sphere, sr. */
double asdic_flat_solid_angle(const asdic_flat_scene *flat, const asdic_ring_profile *profile,
                              double d_m);

/* The place over FLAT in POSE's attitude, so that places which differ by less than a step are one: altitude
 * and depth on a grid of STEP_M, rounded down, so that no first echo is expected late; roll and pitch on
 * one of STEP_RAD, rounded; as they are with a step of 0. */
asdic_expected_place asdic_expected_place_on_grid(const asdic_flat_scene *flat,
                                                  const asdic_pose *pose, double step_m,
                                                  double step_rad);

/* As asdic_expected_compute, for many places, to 0.01 dB: SHELF keeps the profiles of beams and
 * attitudes that come again, for which the wavelength is the nearest of a row that rises by
 * 2^(1/4096); rays that bend are fewer, and a bin over which a pattern hardly turns has three nodes.
 * With a STEP_RAD > 0 attitudes for which there are profiles are so far apart, and a beam's is moved
 * by what its elevation differs from theirs, but not where it looks steeply up or down. */
asdic_status asdic_expected_compute_among(asdic_context *ctx, asdic_ring_shelf *shelf,
                                          const asdic_expected_place *place, double step_rad,
                                          const asdic_environment *env, const asdic_sonar *sonar,
                                          asdic_ping *ping);

/* How beams look: a ring each, and its profile. */
typedef struct asdic_bent_view {
    const asdic_ring *rings;
    asdic_ring_profile *const *profiles;
    bool is_quick; /* to 0.01 dB */
} asdic_bent_view;

/* Adds bottom, surface and volume of each beam to PING, which holds 0. */
asdic_status asdic_expected_bent(asdic_context *ctx, const asdic_flat_laws *laws,
                                 const asdic_environment *env, const asdic_sonar *sonar,
                                 const asdic_bent_view *view, asdic_ping *ping);

#endif
