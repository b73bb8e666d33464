#include "water_column.h"

#include <math.h>

asdic_water_column asdic_water_column_at(const asdic_environment *env, const asdic_sonar *sonar,
                                         double depth_m) {
    asdic_water_column water;
    water.sound_speed_mps = asdic_environment_sound_speed_mps(env, depth_m);
    water.wavelength_m = water.sound_speed_mps / sonar->frequency_hz;
    double alpha = asdic_environment_absorption_db_per_km(env, sonar->frequency_hz, depth_m);
    water.absorption_np_per_m = alpha * log(10.0) / 1e4;
    return water;
}

asdic_law_water asdic_water_column_laws(const asdic_water_column *water,
                                        const asdic_environment *env, const asdic_sonar *sonar) {
    return (asdic_law_water){.frequency_hz = sonar->frequency_hz,
                             .sound_speed_mps = water->sound_speed_mps,
                             .wavelength_m = water->wavelength_m,
                             .wind_speed_kn = env->wind_speed_kn};
}

static double loss_at(const asdic_water_column *water, double d) {
    return exp(-2.0 * water->absorption_np_per_m * (d - 1.0)) / (d * d);
}

double asdic_water_column_loss(const asdic_water_column *water, double bin_m, size_t bin) {
    return loss_at(water, ((double)bin + 0.5) * bin_m);
}

double asdic_water_column_volume(const asdic_water_column *water, double bin_m, double blanking_m,
                                 size_t bin) {
    double begin = fmax((double)bin * bin_m, blanking_m), end = (double)(bin + 1) * bin_m;
    if (end <= begin) {
        return 0.0;
    }
    if (begin <= 0.0) {
        return INFINITY; /* the integral of d^-2 from the sonar itself */
    }
    /* In y = 1/d the integrand is exp(-2 k (1/y - 1)): smooth, five Gauss points are exact to
     * 1e-12 for any bin a sonar has. */
    static const double node[5] = {0.04691007703066800, 0.23076534494715845, 0.5,
                                   0.76923465505284155, 0.95308992296933200};
    static const double weight[5] = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                     0.23931433524968324, 0.11846344252809454};
    double y0 = 1.0 / end, length = 1.0 / begin - 1.0 / end, sum = 0.0;
    for (int i = 0; i < 5; i++) {
        sum += weight[i] *
               exp(-2.0 * water->absorption_np_per_m * (1.0 / (y0 + node[i] * length) - 1.0));
    }
    return sum * length;
}
