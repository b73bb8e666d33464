/*
 * Ambient noise, dB re 1 uPa^2/Hz, omnidirectional; Coates, Underwater Acoustic Systems (1990),
 * after Wenz (1962) and Mellen (1952). f in kHz, 0.1..1000; wind in knots; shipping density D from
 * 0 (very light) to 1 (heavy).
 */
#ifndef ASDIC_KERNEL_NOISE_H
#define ASDIC_KERNEL_NOISE_H

#include "real.h"

FORMULA real noise_turbulence_db(real f_khz) {
    return R(17.0) - R(30.0) * log10(f_khz);
}

FORMULA real noise_traffic_db(real f_khz, real shipping) {
    return R(40.0) + R(20.0) * (shipping - R(0.5)) + R(26.0) * log10(f_khz) -
           R(60.0) * log10(f_khz + R(0.03));
}

/* 5.38 is for knots: 7.5 sqrt(0.5144) of the form in m/s. */
FORMULA real noise_sea_state_db(real f_khz, real wind_kn) {
    return R(50.0) + R(5.38) * sqrt(wind_kn) + R(20.0) * log10(f_khz) -
           R(40.0) * log10(f_khz + R(0.4));
}

FORMULA real noise_thermal_db(real f_khz) {
    return R(-15.0) + R(20.0) * log10(f_khz);
}

/* The power sum of the four. */
FORMULA real noise_db(real f_khz, real shipping, real wind_kn) {
    real turbulence = r_exp10(R(0.1) * noise_turbulence_db(f_khz));
    real traffic = r_exp10(R(0.1) * noise_traffic_db(f_khz, shipping));
    real sea_state = r_exp10(R(0.1) * noise_sea_state_db(f_khz, wind_kn));
    real thermal = r_exp10(R(0.1) * noise_thermal_db(f_khz));
    return R(10.0) * log10(turbulence + traffic + sea_state + thermal);
}

/* Level in a band of BANDWIDTH_HZ with a flat spectrum, dB re 1 uPa^2. */
FORMULA real noise_band_db(real spectrum_db, real bandwidth_hz) {
    return spectrum_db + R(10.0) * log10(bandwidth_hz);
}

#endif
