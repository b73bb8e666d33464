#include "materials.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/target.h"

#define WATER_DENSITY_KGPM3 1025.0

/* Density and sound speed of mud (clay), sand, gravel and rock (limestone) over those of water: F. B.
 * Jensen, W. A. Kuperman, M. B. Porter, H. Schmidt, "Computational Ocean Acoustics", table 1.3. */
static const double bottom_density_ratio[4] = {1.5, 1.9, 2.0, 2.4};
static const double bottom_speed_ratio[4] = {1.0, 1.1, 1.2, 2.0};
/* R.m.s. height over a metre of the relief spectra of APL-UW TR 9407 (1994) for mud, medium sand,
 * gravel and rough rock. */
static const double bottom_height_rms_m[4] = {0.003, 0.008, 0.016, 0.05};

/* TABLE at a bottom type from 1 to 4, fractions in between. */
static double at_type(const double table[4], double type) {
    int low = type < 1.0 ? 1 : type < 4.0 ? (int)type : 3;
    return table[low - 1] + (table[low < 3 ? low : 3] - table[low - 1]) * (type - low);
}

double asdic_water_impedance_mrayl(double sound_speed_mps) {
    return 1e-6 * WATER_DENSITY_KGPM3 * sound_speed_mps;
}

dev_material asdic_material_coefficients(const asdic_material *material, double frequency_hz,
                                         double sound_speed_mps) {
    dev_material out = {0};
    if (material->law == ASDIC_LAW_BOTTOM) {
        out.law = DEV_LAW_BOTTOM;
        out.bottom_type = (float)material->bottom_type;
        out.bottom_gain = (float)bottom_gain(material->bottom_type, 1e-3 * frequency_hz);
        out.bottom_peak = (float)bottom_peak(material->bottom_type);
        out.density_ratio = (float)at_type(bottom_density_ratio, material->bottom_type);
        out.index = (float)(1.0 / at_type(bottom_speed_ratio, material->bottom_type));
        out.roughness_g = (float)roughness_parameter(
            sound_speed_mps / frequency_hz, at_type(bottom_height_rms_m, material->bottom_type));
        return out;
    }
    double wavelength_m = sound_speed_mps / frequency_hz;
    double water_mrayl = asdic_water_impedance_mrayl(sound_speed_mps);
    out.law = DEV_LAW_FACET;
    out.reflection2 = (float)impedance_reflection2(material->impedance_mrayl, water_mrayl);
    out.roughness_g = (float)roughness_parameter(wavelength_m, material->roughness_rms_m);
    out.slope_ms = (float)(material->slope_rms * material->slope_rms);
    out.coherent_area_m2 =
        isnan(material->coherent_area_m2) ? 0.0f : (float)material->coherent_area_m2;
    return out;
}
