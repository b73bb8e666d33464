#include "array.h"

#include "ring.h"

#include "../../kernels/beam.h"

/* Of 87 degrees: a beam along the line is no aperture's. */
#define LEAST_COSINE 0.05

/* dB: a beam that is steered to where an element hears nothing. */
#define LEAST_SENSITIVITY_DB (-300.0)

double asdic_array_sine(const asdic_array *array, const asdic_beam *beam) {
    asdic_mat3 element = asdic_face_mount(&array->element), aimed = asdic_face_mount(beam);
    double sine = 0.0;
    for (int k = 0; k < 3; k++) {
        sine += element.m[k][1] * aimed.m[k][0];
    }
    return sine;
}

double asdic_array_cosine(const asdic_array *array, const asdic_beam *beam) {
    double sine = asdic_array_sine(array, beam);
    return sqrt(fmax(1.0 - sine * sine, LEAST_COSINE * LEAST_COSINE));
}

double asdic_array_noise_length_m(const asdic_array *array, double wavelength_m) {
    return fmin(array->spacing_m, fmax(array->element.length_h_m, 0.5 * wavelength_m));
}

void asdic_array_form(const asdic_array *array, double wavelength_m, asdic_beam *beams,
                      size_t count) {
    double weights[ASDIC_ARRAY_MAX_ELEMENTS], squares = 0.0;
    asdic_array_weights(array, weights);
    for (size_t e = 0; e < array->elements; e++) {
        squares += weights[e] * weights[e];
    }
    for (size_t b = 0; b < count; b++) {
        double across_wl =
            array->element.length_h_m / wavelength_m * asdic_array_sine(array, &beams[b]);
        beams[b].length_h_m = array->spacing_m / squares * asdic_array_cosine(array, &beams[b]);
        beams[b].length_v_m = array->element.length_v_m;
        beams[b].sensitivity_db = fmax(10.0 * log10(sinc2(across_wl)), LEAST_SENSITIVITY_DB);
    }
}
