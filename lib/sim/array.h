/*
 * Beams that an array forms, as pings of intensities know them.
 */
#ifndef ASDIC_SIM_ARRAY_H
#define ASDIC_SIM_ARRAY_H

#include <asdic/sonar.h>

/* Sides of apertures. */
#define ASDIC_LEAST_LENGTH_M 1e-4
#define ASDIC_MOST_LENGTH_M 100.0

static inline bool asdic_is_length(double side_m) {
    return side_m >= ASDIC_LEAST_LENGTH_M && side_m <= ASDIC_MOST_LENGTH_M;
}

/* Of the angle that BEAM is steered by from the array's front, to starboard. */
double asdic_array_sine(const asdic_array *array, const asdic_beam *beam);

/* The same angle's; never so small that nothing would be left of the array's length. */
double asdic_array_cosine(const asdic_array *array, const asdic_beam *beam);

/* An element's length along the line, for noise from all around. One that is shorter than half a wavelength takes in
 * no less than such a one, but next to others hears what they hear. */
double asdic_array_noise_length_m(const asdic_array *array, double wavelength_m);

#endif
