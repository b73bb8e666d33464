#include "materials.h"

#include "../../kernels/backscatter.h"
#include "../../kernels/target.h"

#define WATER_DENSITY_KGPM3 1025.0

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
