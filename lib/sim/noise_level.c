#include "noise_level.h"

#include "array.h"

#include "../../kernels/noise.h"

#include "base/vec.h"

/* Directivity of a rectangular aperture, 4 pi L_H L_V / lambda^2 (Urick 1983, table 3.2). */
static double directivity(double length_h_m, double length_v_m, double wavelength_m) {
    return 4.0 * ASDIC_PI * length_h_m * length_v_m / (wavelength_m * wavelength_m);
}

/* A shorter side takes in no less from all around than one of lambda / pi. The integral over the pattern of an aperture, in
 * front of it, is then at most 1.6 dB more (of 0.49 by 0.32 wavelengths) and 0.4 dB less than the directivity. */
static double no_shorter(double length_m, double wavelength_m) {
    return fmax(length_m, wavelength_m / ASDIC_PI);
}

/* Of the noise in a resolution cell's time, what comes from all around and the sonar's own. */
typedef struct noise {
    double ambient, own;
} noise;

static noise noise_in_band(const asdic_environment *env, const asdic_sonar *sonar) {
    double f_khz = sonar->frequency_hz / 1e3;
    double sea_db = noise_db(f_khz, env->shipping_density, env->wind_speed_kn);
    return (noise){pow(10.0, 0.1 * noise_band_db(sea_db, sonar->bandwidth_hz)),
                   pow(10.0, 0.1 * noise_band_db(sonar->self_noise_db, sonar->bandwidth_hz))};
}

/* Less than one, as of an echo, in a short bin. */
static double cells_in_bin(const asdic_sonar *sonar, double sound_speed_mps) {
    return sonar->bin_length_m * 2.0 * sonar->bandwidth_hz / sound_speed_mps;
}

/* An element that is half a wavelength long is open to half of all directions at least. */
double asdic_noise_element_lin(const asdic_environment *env, const asdic_sonar *sonar, double share,
                               double sound_speed_mps) {
    double wavelength_m = sound_speed_mps / sonar->frequency_hz;
    double length_m = asdic_array_noise_length_m(&sonar->array, wavelength_m);
    double height_m = no_shorter(sonar->array.element.length_v_m, wavelength_m);
    noise n = noise_in_band(env, sonar);
    n.ambient /= sonar->noise_directivity ? directivity(length_m, height_m, wavelength_m) : share;
    return sonar->noise_enabled ? (n.ambient + n.own) * cells_in_bin(sonar, sound_speed_mps) : 0.0;
}

/* The share of an element's noise in a beam: the sum of the weights' squares, which is what the beam's side was made
 * of (asdic_array_form). */
static double share_of_beam(const asdic_array *array, const asdic_beam *beam) {
    return array->spacing_m * asdic_array_cosine(array, beam) / beam->length_h_m;
}

double asdic_noise_lin(const asdic_environment *env, const asdic_sonar *sonar,
                       const asdic_beam *receiver, double sound_speed_mps) {
    if (!sonar->noise_enabled) {
        return 0.0;
    }
    if (sonar->array.elements > 0) {
        double share = share_of_beam(&sonar->array, receiver);
        return share * asdic_noise_element_lin(env, sonar, share, sound_speed_mps);
    }
    noise n = noise_in_band(env, sonar);
    if (sonar->noise_directivity) {
        double wavelength_m = sound_speed_mps / sonar->frequency_hz;
        double d = directivity(no_shorter(receiver->length_h_m, wavelength_m),
                               no_shorter(receiver->length_v_m, wavelength_m), wavelength_m);
        n.ambient /= fmax(d, 2.0); /* of the open half-space in front */
    }
    return (n.ambient + n.own) * cells_in_bin(sonar, sound_speed_mps);
}

void asdic_noise_levels(const asdic_environment *env, const asdic_sonar *sonar,
                        double sound_speed_mps, asdic_ping *ping) {
    for (size_t b = 0; b < ping->beams; b++) {
        double level = asdic_noise_lin(env, sonar, &sonar->receivers[b], sound_speed_mps);
        for (size_t n = 0; n < ping->bins; n++) {
            ping->intensity_lin[ASDIC_NOISE][b * ping->bins + n] = level;
        }
    }
}

double asdic_noise_least_lin(const asdic_environment *env, const asdic_sonar *sonar,
                             double sound_speed_mps) {
    double least = INFINITY;
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        least = fmin(least, asdic_noise_lin(env, sonar, &sonar->receivers[b], sound_speed_mps));
    }
    return least;
}
