/* The mirror rays of what a set of rays met. */
#include "beside.h"

#include <math.h>

/* They start this far off the surface. */
#define LIFT_M 1e-3

static void unit_normal(const float *v, double n[3]) {
    double length = 0.0;
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        n[k] = ((double)v[3 + a] - v[a]) * ((double)v[6 + b] - v[b]) -
               ((double)v[3 + b] - v[b]) * ((double)v[6 + a] - v[a]);
        length += n[k] * n[k];
    }
    length = sqrt(length);
    for (int k = 0; k < 3; k++) {
        n[k] = length > 0.0 ? n[k] / length : 0.0;
    }
}

size_t bench_rays_mirror(const float *corners_m, const asdic_ray *rays, const asdic_ray_hit *hits,
                         size_t count, asdic_ray *mirrored) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        if (hits[i].triangle == ASDIC_NO_TRIANGLE) {
            continue;
        }
        double n[3], along = 0.0, to[3];
        float from[3];
        unit_normal(&corners_m[9 * (size_t)hits[i].triangle], n);
        for (int k = 0; k < 3; k++) {
            along += n[k] * rays[i].direction[k];
        }
        for (int k = 0; k < 3; k++) {
            to[k] = rays[i].direction[k] - 2.0 * along * n[k];
            from[k] = (float)(rays[i].origin_m[k] + (double)hits[i].range_m * rays[i].direction[k] -
                              (along > 0.0 ? LIFT_M : -LIFT_M) * n[k]);
        }
        mirrored[kept++] = bench_ray_from(from, to);
    }
    return kept;
}
