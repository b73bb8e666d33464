#include "water_column.h"

#include "../../kernels/ray.h"

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

double asdic_water_column_loss(const asdic_water_column *water, double bin_m, size_t bin) {
    return ray_tube_loss(water->absorption_np_per_m, ((double)bin + 0.5) * bin_m);
}

double asdic_water_column_volume(const asdic_water_column *water, double bin_m, double blanking_m,
                                 size_t bin) {
    double begin = fmax((double)bin * bin_m, blanking_m), end = (double)(bin + 1) * bin_m;
    if (end <= begin) {
        return 0.0;
    }
    /* Infinite from the sonar itself on. */
    return begin > 0.0 ? ray_water(water->absorption_np_per_m, begin, end) : INFINITY;
}
