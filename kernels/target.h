/*
 * How objects return sound: the rough facet that rays meet, and closed forms of simple bodies.
 *
 * The facet law (per unit area, 1/sr) is a Kirchhoff lobe for the coherent share and Lambert's
 * law for the rest, so that energy is conserved with four stated inputs:
 *
 *     sigma = R^2 { rho exp(-tan^2 i / m) / (4 pi m cos^4 i) + (1 - rho) cos^2 i / pi }
 *     rho   = exp(-g cos^2 i),  g = 4 k^2 s^2   (Rayleigh/Eckart roughness parameter)
 *
 * i incidence from the normal, m mean-square slope, s r.m.s. height, k wavenumber, R amplitude
 * reflection coefficient at normal incidence. Geometric optics: valid for ka > 10; tips, edges and
 * elastic resonances are not in it.
 */
#ifndef ASDIC_KERNEL_TARGET_H
#define ASDIC_KERNEL_TARGET_H

#include "real.h"

/* Energy reflection coefficient at normal incidence between impedances in one unit, R^2. */
FORMULA real impedance_reflection2(real z_mrayl, real water_mrayl) {
    real r = (z_mrayl - water_mrayl) / (z_mrayl + water_mrayl);
    return r * r;
}

/* g = 4 k^2 s^2. */
FORMULA real roughness_parameter(real wavelength_m, real roughness_rms_m) {
    real ks = R(2.0) * R_PI * roughness_rms_m / wavelength_m;
    return R(4.0) * ks * ks;
}

/* Mean-square slope seen at RANGE_M: that of the roughness, widened by diffraction from the flat
 * area A that reflects in phase, lambda^2 / (4 pi A). Far away a plate then returns (A / lambda)^2.
 *
 * Nearer, with q = A / (lambda d), the sphericity of the wave tilts the rays at the plate's edge out
 * of that lobe, which phase does not do to it as soon: 1 - 2 q^2 follows the Fresnel integrals of a
 * square and of a disc to 0.3 dB up to q = 1/2. From there the lobe is that of the zone lambda d, and
 * what comes back tends to d^2 / 4, the image of the sonar.
 *
 * Above 1/2 the lobe would return more than arrives: pieces smaller than a wavelength. */
#define FACET_MOST_SLOPE_MS R(0.5)

FORMULA real facet_slope_ms(real slope_ms, real coherent_area_m2, real wavelength_m, real range_m) {
    real zones = coherent_area_m2 / (wavelength_m * range_m);
    real narrowed = r_max(R(1.0) - R(2.0) * zones * zones, zones);
    real diffraction = wavelength_m * wavelength_m * narrowed / (R(4.0) * R_PI * coherent_area_m2);
    return r_min(slope_ms + diffraction, FACET_MOST_SLOPE_MS);
}

/* What roughness takes out of the lobe, by Lambert's law, for R = 1; it counts by the mean of both cosines. */
FORMULA real facet_diffuse_lin(real cos_in, real cos_out, real g) {
    real lift = R(0.5) * (cos_in + cos_out);
    return -expm1(-g * (lift * lift)) * (cos_in * cos_out) / R_PI;
}

/* sigma, 1/sr, of what comes in and goes out at incidences of the cosines COS_IN and COS_OUT; the lobe is about the
 * direction midway between both, whose incidence has COS_MIDDLE and SIN2_MIDDLE: the pieces that reflect face there, and
 * roughness counts by the mean of both cosines (Kirchhoff's approximation for high frequencies; F. G. Bass and I. M.
 * Fuks, "Wave scattering from statistically rough surfaces", 1979). SLOPE_MS > 0.
 *
 * In single precision the squared sine should come from a cross product: near normal incidence the cosine does not hold
 * it, and a flat plate's lobe is only 1e-5 wide in it. The lobe is one exponential, since exp(-tan^2 i / m) / cos^4 i
 * taken apart is 0 * inf at grazing incidence. */
FORMULA real facet_strength_between_lin(real cos_in, real cos_out, real cos_middle,
                                        real sin2_middle, real reflection2, real g, real slope_ms) {
    real c = r_min(r_max(cos_middle, R(1.0e-6)), R(1.0)), cos2 = c * c;
    real lift = R(0.5) * (cos_in + cos_out);
    real lobe = exp(R(-2.0) * log(cos2) - sin2_middle / (cos2 * slope_ms) - g * (lift * lift)) /
                (R(4.0) * R_PI * slope_ms);
    return reflection2 * (lobe + facet_diffuse_lin(cos_in, cos_out, g));
}

/* The same of what goes back where it comes from. */
FORMULA real facet_strength_angle_lin(real cos_incidence, real sin2, real reflection2, real g,
                                      real slope_ms) {
    real c = r_min(r_max(cos_incidence, R(1.0e-6)), R(1.0));
    return facet_strength_between_lin(c, c, c, sin2, reflection2, g, slope_ms);
}

/* The same from a cosine in [0, 1] alone. */
FORMULA real facet_strength_lin(real cos_incidence, real reflection2, real g, real slope_ms) {
    real sin2 = r_max((R(1.0) - cos_incidence) * (R(1.0) + cos_incidence), R(0.0));
    return facet_strength_angle_lin(cos_incidence, sin2, reflection2, g, slope_ms);
}

/* Share of the arriving energy that goes on in the mirror direction, R^2 exp(-g sin^2 Theta). */
FORMULA real mirror_share(real sin_grazing, real reflection2, real g) {
    return reflection2 * exp(-g * sin_grazing * sin_grazing);
}

/* Target strengths in the far field, m^2 re 1 m^2 (Urick 1983, table 9.1), rigid and smooth. */

FORMULA real sphere_strength_lin(real radius_m) {
    return R(0.25) * radius_m * radius_m;
}

/* Broadside. */
FORMULA real cylinder_strength_lin(real radius_m, real length_m, real wavelength_m) {
    return radius_m * length_m * length_m / (R(2.0) * wavelength_m);
}

/* A flat piece of AREA_M2, a plate or a disc, at normal incidence. */
FORMULA real plate_strength_lin(real area_m2, real wavelength_m) {
    real ratio = area_m2 / wavelength_m;
    return ratio * ratio;
}

FORMULA real disc_strength_lin(real radius_m, real wavelength_m) {
    return plate_strength_lin(R_PI * radius_m * radius_m, wavelength_m);
}

#endif
