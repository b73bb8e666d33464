#include "expected.h"

#include "../../kernels/backscatter.h"

asdic_flat_laws asdic_flat_laws_at(const asdic_flat_scene *flat, const asdic_environment *env,
                                   const asdic_sonar *sonar) {
    double f_khz = 1e-3 * sonar->frequency_hz, wind_kn = env->wind_speed_kn;
    return (asdic_flat_laws){
        .flat = *flat,
        .water = asdic_water_column_at(env, sonar, flat->depth_m),
        .absorption_db_per_km =
            asdic_environment_absorption_db_per_km(env, sonar->frequency_hz, flat->depth_m),
        .source_lin = pow(10.0, 0.1 * sonar->source_level_db),
        .bottom_gain = bottom_gain(flat->bottom_type, f_khz),
        .bottom_peak = bottom_peak(flat->bottom_type),
        .surface_gain = surface_gain(wind_kn, f_khz),
        .surface_beta0 = surface_beta0(wind_kn),
        .surface_beta1 = surface_beta1(f_khz),
        .surface_cap_lin = surface_cap_lin(wind_kn),
        .volume_lin = pow(10.0, 0.1 * volume_backscatter_db(env->particle_strength_db, f_khz)),
    };
}

double asdic_flat_bottom_lin(const asdic_flat_laws *laws, double sin_grazing) {
    return bottom_backscatter_lin(laws->bottom_gain, laws->bottom_peak, laws->flat.bottom_type,
                                  sin_grazing);
}

double asdic_flat_surface_lin(const asdic_flat_laws *laws, double sin_grazing) {
    return surface_backscatter_lin(laws->surface_gain, laws->surface_beta0, laws->surface_beta1,
                                   laws->surface_cap_lin, sin_grazing);
}

double asdic_flat_elevation_rad(double height_m, double d_m) {
    if (d_m <= height_m) {
        return 0.5 * ASDIC_PI;
    }
    return atan2(height_m, sqrt((d_m - height_m) * (d_m + height_m)));
}
