/*
 * A ray through layered water, in closed form from plane to plane.
 *
 * In a layer of gradient g the ray's angle obeys asinh(tan theta) = const - g t, so that with x = g t,
 * s = sin theta and D = cosh x - s sinh x (C. B. Officer, 1958, ch. 2; the forms are chosen so that
 * none loses digits as g -> 0)
 *
 *     c1 = c / D,   cos theta1 = cos theta c1 / c,   sin theta1 = (s cosh x - sinh x) c1 / c
 *     z1 - z = c1 (s sinh x - 2 sinh^2 (x/2)) / g,   spread  A = c c1 sinh x / g
 *
 * The horizontal distance is p times the sum of A, p = cos theta / c. The width W of a tube per radian
 * of launch elevation grows by P A with P = 1 / c at the launch; at a plane where the gradient steps
 * from g_above to g_below P falls by W (g_below - g_above) cos^2 theta / (c^2 |sin theta|)
 * (dynamic ray tracing: V. Cerveny, "Seismic ray theory", 2001, ch. 4). Then
 *
 *     S = (sum A) |W| / c        spreading of intensity, m^2, the same both ways
 */
#ifndef ASDIC_SIM_BENT_RAY_H
#define ASDIC_SIM_BENT_RAY_H

#include "layers.h"

/* Near a caustic, where rays are no longer what sound does, the gain over straight spreading is held
 * to 20 dB: of what comes back both ways the integral over S would not be finite. */
#define ASDIC_LEAST_SPREAD 1e-2

typedef struct asdic_bent_ray {
    size_t layer;
    double z_m, speed_mps, sine; /* of the angle from the horizontal, positive down */
    double level_spm;            /* p: Snell's constant */
    double time_s, length_m;
    double area_m2_per_s;  /* sum of A; times p: horizontal distance */
    double width_m, slope; /* W, signed: it changes its sign at a caustic; and P, s/m */
} asdic_bent_ray;

/* A ray that leaves DEPTH_M at ELEVATION_RAD, positive down. */
asdic_bent_ray asdic_bent_ray_start(const asdic_layers *layers, double depth_m,
                                    double elevation_rad);

/* Time until it leaves its layer, and *WAY, 1 below or -1 above; INFINITY: never. */
double asdic_bent_ray_exit(const asdic_layers *layers, const asdic_bent_ray *ray, int *way);

/* The ray TIME_S later, within its layer. */
asdic_bent_ray asdic_bent_ray_later(const asdic_layers *layers, const asdic_bent_ray *ray,
                                    double time_s);

/* The ray on the plane where it leaves its layer, TIME_S and WAY of asdic_bent_ray_exit. */
asdic_bent_ray asdic_bent_ray_at_plane(const asdic_layers *layers, const asdic_bent_ray *ray,
                                       double time_s, int way);

/* Takes RAY, on a plane, into the next layer; false where there is none. */
bool asdic_bent_ray_cross(const asdic_layers *layers, asdic_bent_ray *ray, int way);

/* S, without the limit at a caustic. */
static inline double asdic_bent_ray_spread_m2(const asdic_bent_ray *ray) {
    double width = ray->width_m < 0.0 ? -ray->width_m : ray->width_m;
    return ray->area_m2_per_s * width / ray->speed_mps;
}

/* The same with the limit, of a ray whose time is that to RANGE_M. */
static inline double asdic_bent_ray_limited_m2(const asdic_bent_ray *ray, double range_m) {
    double spread = asdic_bent_ray_spread_m2(ray), least = ASDIC_LEAST_SPREAD * range_m * range_m;
    return spread > least ? spread : least;
}

/* A plane HEIGHT_M away in water of one bend (kernels/ray_bent.h), positive: away from the plane. */
typedef struct asdic_bent_plane {
    double height_m, bend_per_m;
} asdic_bent_plane;

/* What the end of LAYERS, BELOW the sonar or above it, looks like to rays from there: the plane in water of one bend before
 * which the same of them turn, and which the others that set out towards it reach up to REACH_M. Where rays graze it they
 * meet it at the range of the layers; at others nearly. */
asdic_bent_plane asdic_bent_plane_through(const asdic_layers *layers, double depth_m, bool below,
                                          double reach_m);

#endif
