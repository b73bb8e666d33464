/*
 * Rays on the host, from the sonar of a ping.
 */
#ifndef ASDIC_SIM_SONAR_RAY_H
#define ASDIC_SIM_SONAR_RAY_H

#define ASDIC_BENT 1 /* a ping without a bend has straight ones */

#include <asdic/common.h>

#include "../../kernels/ping_types.h"
#include "../../kernels/ray.h"

/* The bend of the water as seen from the sonar. */
static inline double asdic_sonar_bend(const dev_ping *ping) {
    double bend = ping->bend_per_m;
    return bend / (1.0 + bend * (double)ping->origin[2]);
}

/* To a point that lies APART from the sonar; its ray leaves from there, too. */
static inline ray_way asdic_sonar_ray(const dev_ping *ping, asdic_vec3 apart, double least) {
    const ray_medium water = {asdic_sonar_bend(ping), 1.0};
    return ray_between((triple){0.0, 0.0, 0.0}, (triple){apart.x, apart.y, apart.z}, water, least);
}

#endif
