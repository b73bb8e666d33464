#include "noise_level.h"

#include "../../kernels/noise.h"

#include "base/vec.h"

/* Directivity of a rectangular aperture, 4 pi L_H L_V / lambda^2, never below that of the open
 * front half-space (Urick 1983, table 3.2). */
static double directivity(const asdic_beam *beam, double wavelength_m) {
    double d = 4.0 * ASDIC_PI * beam->length_h_m * beam->length_v_m / (wavelength_m * wavelength_m);
    return fmax(d, 2.0);
}

double asdic_noise_lin(const asdic_environment *env, const asdic_sonar *sonar,
                       const asdic_beam *receiver, double sound_speed_mps) {
    if (!sonar->noise_enabled) {
        return 0.0;
    }
    double f_khz = sonar->frequency_hz / 1e3;
    double sea_db = noise_db(f_khz, env->shipping_density, env->wind_speed_kn);
    double ambient = pow(10.0, 0.1 * noise_band_db(sea_db, sonar->bandwidth_hz));
    double own = pow(10.0, 0.1 * noise_band_db(sonar->self_noise_db, sonar->bandwidth_hz));
    double cell_m = sound_speed_mps / (2.0 * sonar->bandwidth_hz);
    double cells = sonar->bin_length_m / cell_m; /* less than one, as of an echo, in a short bin */
    if (sonar->noise_directivity) {
        ambient /= directivity(receiver, sound_speed_mps / sonar->frequency_hz);
    }
    if (sonar->array.elements > 0) {
        own /= (double)sonar->array.elements;
    }
    return (ambient + own) * cells;
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
