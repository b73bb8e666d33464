/*
 * The two-way beam pattern summed around a ring of directions at one elevation: what a flat bottom,
 * a flat surface and the water in between see of a transmitter and a receiver.
 */
#ifndef ASDIC_SIM_RING_H
#define ASDIC_SIM_RING_H

#include <asdic/sonar.h>

#include "base/vec.h"

/* An aperture aimed in the world: rows of WORLD_TO_FACE are out of the face, along the horizontal
 * and along the vertical side. */
typedef struct asdic_face {
    asdic_mat3 world_to_face;
    double length_h_wl, length_v_wl;
    double axis_lin; /* gain on the axis, of which rings know nothing */
} asdic_face;

/* From an aperture's axes to the vehicle's. A beam's positive pitch looks down, an attitude's positive
 * pitch looks up. */
asdic_mat3 asdic_face_mount(const asdic_beam *beam);

/* A receiver's gain on its axis. */
double asdic_beam_axis_lin(const asdic_beam *beam);

asdic_face asdic_face_aim(const asdic_beam *beam, const asdic_pose *pose, double wavelength_m);

/* One-way gain in the direction of a unit vector of the world; behind the face REAR_LIN times that. */
double asdic_face_gain(const asdic_face *face, asdic_vec3 towards, double rear_lin);

/* Receivers whose axes lie where the transmitter sends next to nothing: it was hardly meant to be
 * heard there. */
size_t asdic_receivers_in_the_dark(const asdic_sonar *sonar, double wavelength_m);

typedef struct asdic_ring {
    asdic_face transmitter, receiver;
    double rear_lin; /* one-way gain behind a face */
} asdic_ring;

/* How often a two-way pattern of these apertures turns per radian, at most. */
double asdic_ring_cycles(const asdic_ring *ring);

/* Integral of B_T B_R over azimuth at ELEVATION_RAD, rad. */
double asdic_ring_sum(const asdic_ring *ring, double elevation_rad);

/* Elevations in (-pi/2, pi/2) where a ring begins to lie wholly on one side of a face, ascending:
 * the sum has a kink there. Returns how many, at most 4. */
size_t asdic_ring_kinks(const asdic_ring *ring, double kinks_rad[4]);

#endif
