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
    double altitude_m;  /* of the sonar above the bottom, >= 0 */
    double depth_m;     /* of the sonar below the surface, >= 0 */
    double bottom_type; /* 1 mud .. 4 rock */
} asdic_flat_scene;

/* Fills PING's bottom, surface, volume, noise and total (object and multipath are 0). The vehicle's
 * attitude is taken from POSE, its place from FLAT. env->variant chooses the paper's printed sums. */
ASDIC_API asdic_status asdic_expected_compute(asdic_context *ctx, const asdic_flat_scene *flat,
                                              const asdic_environment *env,
                                              const asdic_sonar *sonar, const asdic_pose *pose,
                                              asdic_ping *ping);

#ifdef __cplusplus
}
#endif

#endif
