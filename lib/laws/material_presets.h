/*
 * Acoustic impedances of solid bodies, density times longitudinal speed, 1e6 kg/(m2 s): L. E.
 * Kinsler, A. R. Frey, A. B. Coppens, J. V. Sanders, "Fundamentals of Acoustics", 4th ed., Wiley 2000,
 * table A10 (bulk values; wood is oak, acrylic is Lucite, rubber is hard rubber), and air at 20 degC
 * after table A11. For bodies many wavelengths thick: a shell, or a plate thinner than a wavelength,
 * lets sound through and needs a smaller value.
 */
#ifndef ASDIC_LAWS_MATERIAL_PRESETS_H
#define ASDIC_LAWS_MATERIAL_PRESETS_H

#define ASDIC_MATERIAL_PRESETS(X)                                                                  \
    X(acrylic, 3.2)                                                                                \
    X(air, 0.000415)                                                                               \
    X(aluminium, 17.0)                                                                             \
    X(brass, 40.0)                                                                                 \
    X(concrete, 8.0)                                                                               \
    X(copper, 44.5)                                                                                \
    X(glass, 12.9)                                                                                 \
    X(ice, 2.95)                                                                                   \
    X(iron, 33.5)                                                                                  \
    X(lead, 23.2)                                                                                  \
    X(pine, 1.57)                                                                                  \
    X(rubber, 2.64)                                                                                \
    X(steel, 47.0)                                                                                 \
    X(wood, 2.9)

#endif
