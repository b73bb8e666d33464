/*
 * The null hypothesis: the expected level per beam and bin over a flat bottom under a flat
 * surface with no object, by adaptive quadrature in double precision.
 */
#ifndef ASDIC_EXPECTED_H
#define ASDIC_EXPECTED_H

#include <asdic/ping.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_flat_scene {
    bool has_surface, has_bottom;
    double altitude_m; /* of the sonar above the bottom, >= 0 */
    double depth_m;    /* of the sonar below the surface, >= 0 where there is one */
    asdic_material bottom;
    asdic_material surface; /* without a law: the course's */
} asdic_flat_scene;

/* Fills PING's bottom, surface, volume, noise and total (object and multipath are 0), spread over
 * the resolution cell c / (2 B) where that is longer than a bin. The vehicle's attitude is taken
 * from POSE, its place from FLAT; env->variant chooses absorption and transmission loss, as in
 * simulated pings. PING has as many
 * beams as SONAR has receivers, and any number of bins. Equations and sources:
 * kernels/README.md. */
ASDIC_API asdic_status asdic_expected_compute(asdic_context *ctx, const asdic_flat_scene *flat,
                                              const asdic_environment *env,
                                              const asdic_sonar *sonar, const asdic_pose *pose,
                                              asdic_ping *ping);

/* What a place expects besides its environment and sonar. */
typedef struct asdic_expected_place {
    asdic_flat_scene flat;
    asdic_pose pose; /* north, east and yaw do not matter */
} asdic_expected_place;

/* Whether B may do with A's levels: altitude and depth within SHARE (of each, of 1 m when that is
 * less), roll and pitch within ANGLE_RAD; with 0 and 0 they are the same. */
ASDIC_API bool asdic_expected_is_near(const asdic_expected_place *a, const asdic_expected_place *b,
                                      double share, double angle_rad);

/* Writes beam,bin,range_m,total_db,bottom_db,surface_db,volume_db,noise_db, one row per beam and
 * bin; a field is empty where there is no energy. PATH "-" is the standard output. */
ASDIC_API asdic_status asdic_expected_write_csv(asdic_context *ctx, const char *path,
                                                const asdic_sonar *sonar, const asdic_ping *ping);

#ifdef __cplusplus
}
#endif

#endif
