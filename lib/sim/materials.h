/*
 * Materials as the device sees them.
 */
#ifndef ASDIC_SIM_MATERIALS_H
#define ASDIC_SIM_MATERIALS_H

#include <asdic/scene.h>

#include "../../kernels/types.h"

/* Characteristic impedance of sea water of 1025 kg/m3, 1e6 kg/(m2 s). */
double asdic_water_impedance_mrayl(double sound_speed_mps);

/* Coefficients of MATERIAL's law at one frequency. The coherent area of a facet material that leaves
 * its own NAN becomes 0: what each facet says. */
dev_material asdic_material_coefficients(const asdic_material *material, double frequency_hz,
                                         double sound_speed_mps);

#endif
