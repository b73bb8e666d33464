/*
 * What water does to sound on its way: speed, absorption, two-way transmission loss.
 * Arguments carry their published units: degrees Celsius, parts per thousand, kHz, metres.
 */
#ifndef ASDIC_KERNEL_WATER_H
#define ASDIC_KERNEL_WATER_H

#include "real.h"

/* Sound speed, m/s. Medwin, J. Acoust. Soc. Am. 58, 1318 (1975), the paper's eq. (1).
 * T 0..35 degC, S 0..45 ppt, z 0..1000 m; standard error 0.2 m/s against Del Grosso. */
FORMULA real sound_speed_medwin_mps(real t_degc, real s_ppt, real z_m) {
    real cubic = t_degc * (R(4.6) + t_degc * (R(-0.055) + t_degc * R(0.00029)));
    return R(1449.2) + cubic + (R(1.34) - R(0.010) * t_degc) * (s_ppt - R(35.0)) + R(0.016) * z_m;
}

/* Sound speed inside the absorption formula, m/s: Francois & Garrison's own, not Medwin's. */
FORMULA real sound_speed_francois_garrison_mps(real t_degc, real s_ppt, real z_m) {
    return R(1412.0) + R(3.21) * t_degc + R(1.19) * s_ppt + R(0.0167) * z_m;
}

/* The three terms below add up to the absorption of Francois & Garrison, J. Acoust. Soc. Am. 72,
 * 896 and 1879 (1982), dB/km one way. Stated accuracy 5 % for 10..500 kHz, -2..22 degC,
 * 30..35 ppt, 0..3500 m; used for 0.2..1000 kHz, and as pure water's square of the frequency up to
 * 3 MHz. Z_M is the depth of the path. */

/* One relaxation, A P f0 f^2 / (f0^2 + f^2), with f0 = 0 (fresh water) allowed. */
FORMULA real absorption_relaxation(real strength, real f0_khz, real f_khz) {
    real f2 = f_khz * f_khz;
    return strength * f0_khz * f2 / (f0_khz * f0_khz + f2);
}

/* Boric acid. NUMERATOR is 8.86; the paper prints 8.696. */
FORMULA real absorption_boric_db_per_km(real numerator, real f_khz, real t_degc, real s_ppt,
                                        real ph, real c_mps) {
    real strength = numerator / c_mps * r_exp10(R(0.78) * ph - R(5.0));
    real f1_khz =
        R(2.8) * sqrt(s_ppt / R(35.0)) * r_exp10(R(4.0) - R(1245.0) / (t_degc + R(273.0)));
    return absorption_relaxation(strength, f1_khz, f_khz);
}

FORMULA real absorption_magnesium_db_per_km(real f_khz, real t_degc, real s_ppt, real z_m,
                                            real c_mps) {
    real strength = R(21.44) * s_ppt / c_mps * (R(1.0) + R(0.025) * t_degc);
    real pressure = R(1.0) + z_m * (R(-1.37e-4) + z_m * R(6.2e-9));
    real f2_khz = R(8.17) * r_exp10(R(8.0) - R(1990.0) / (t_degc + R(273.0))) /
                  (R(1.0) + R(0.0018) * (s_ppt - R(35.0)));
    return absorption_relaxation(strength * pressure, f2_khz, f_khz);
}

/* The two cubics differ by 0.05 % where they meet, at 20 degC. */
FORMULA real absorption_viscosity_db_per_km(real f_khz, real t_degc, real z_m) {
    real cold = R(4.937e-4) + t_degc * (R(-2.59e-5) + t_degc * (R(9.11e-7) - t_degc * R(1.5e-8)));
    real warm = R(3.964e-4) + t_degc * (R(-1.146e-5) + t_degc * (R(1.45e-7) - t_degc * R(6.5e-10)));
    real pressure = R(1.0) + z_m * (R(-3.83e-5) + z_m * R(4.9e-10));
    return choose(t_degc <= R(20.0), cold, warm) * pressure * f_khz * f_khz;
}

/* Absorption, dB/km one way. */
FORMULA real absorption_db_per_km(real f_khz, real t_degc, real s_ppt, real z_m, real ph) {
    real c_mps = sound_speed_francois_garrison_mps(t_degc, s_ppt, z_m);
    return absorption_boric_db_per_km(R(8.86), f_khz, t_degc, s_ppt, ph, c_mps) +
           absorption_magnesium_db_per_km(f_khz, t_degc, s_ppt, z_m, c_mps) +
           absorption_viscosity_db_per_km(f_khz, t_degc, z_m);
}

/* As the paper prints it: 8.696 for 8.86 and the sound speed of eq. (1) for Francois & Garrison's:
 * 2 % low below 1 kHz, 0.3 % at 100 kHz. */
FORMULA real absorption_printed_db_per_km(real f_khz, real t_degc, real s_ppt, real z_m, real ph) {
    real c_mps = sound_speed_medwin_mps(t_degc, s_ppt, z_m);
    return absorption_boric_db_per_km(R(8.696), f_khz, t_degc, s_ppt, ph, c_mps) +
           absorption_magnesium_db_per_km(f_khz, t_degc, s_ppt, z_m, c_mps) +
           absorption_viscosity_db_per_km(f_khz, t_degc, z_m);
}

/* Two-way transmission loss at slant range D_M, dB re 1 m: 40 log10 d + 2 (d - 1) alpha / 1000
 * (Urick 1983; source level and echo are both referred to 1 m). A gain below 1 m. d > 0. */
FORMULA real transmission_loss_db(real d_m, real alpha_db_per_km) {
    return R(40.0) * log10(d_m) + R(2.0) * (d_m - R(1.0)) * alpha_db_per_km * R(0.001);
}

/* As the paper prints it, eq. (2): (2 d - 1) alpha / 1000. */
FORMULA real transmission_loss_printed_db(real d_m, real alpha_db_per_km) {
    return R(40.0) * log10(d_m) + (R(2.0) * d_m - R(1.0)) * alpha_db_per_km * R(0.001);
}

/* Absorption over the whole path from the face and back, 2 d alpha / 1000. */
FORMULA real transmission_loss_two_way_db(real d_m, real alpha_db_per_km) {
    return R(40.0) * log10(d_m) + R(2.0) * d_m * alpha_db_per_km * R(0.001);
}

/* The linear factor of transmission_loss_db; d > 0. */
FORMULA real transmission_lin(real d_m, real alpha_db_per_km) {
    real d2 = d_m * d_m;
    return r_exp10((R(1.0) - d_m) * alpha_db_per_km * R(2.0e-4)) / (d2 * d2);
}

/* Range resolution of a pulse of bandwidth B, c / (2 B), m (Medwin & Clay 1998). */
FORMULA real range_resolution_m(real c_mps, real bandwidth_hz) {
    return R(0.5) * c_mps / bandwidth_hz;
}

/* Range of the last echo before the next ping, c / (2 f_p), m. */
FORMULA real max_range_m(real c_mps, real ping_rate_hz) {
    return R(0.5) * c_mps / ping_rate_hz;
}

#endif
