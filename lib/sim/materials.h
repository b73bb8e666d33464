/*
 * Materials as the device sees them.
 */
#ifndef ASDIC_SIM_MATERIALS_H
#define ASDIC_SIM_MATERIALS_H

#include <asdic/scene.h>

#include "../../kernels/types.h"

/* Characteristic impedance of sea water of 1025 kg/m3, 1e6 kg/(m2 s). */
double asdic_water_impedance_mrayl(double sound_speed_mps);

/* Coefficients of MATERIAL's law at one frequency. PATCH_AREA_M2 is the coherent area of a facet
 * material that leaves its own NAN: the largest coplanar patch of the mesh, or INFINITY to let the
 * Fresnel zone alone limit it (facet_slope_ms in kernels/target.h does that where the range is
 * known). */
dev_material asdic_material_coefficients(const asdic_material *material, double frequency_hz,
                                         double sound_speed_mps, double patch_area_m2);

#endif
