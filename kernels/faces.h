/*
 * Rays towards the faces of objects.
 *
 * Far ends of walls, pipes and tops that are seen almost edge on fill many range bins but hardly any solid
 * angle, and a few small faces among many may mirror the sonar and send back nearly all that a bin holds, so
 * that a sampler of directions seldom meets them. Some rays are therefore aimed at points spread evenly over
 * each of the faces that need it (lib/sim/faces.c). Such a ray counts if it meets the point that it was
 * aimed at first.
 * A ray that meets a face, however it was drawn, weighs by the density of all ways to draw it (balance
 * heuristic, Veach 1997, section 9.2): per unit of solid angle, DENSITY rays per square metre are
 * DENSITY d^2 / cos(incidence) (ray_per_steradian).
 */
#ifndef ASDIC_KERNEL_FACES_H
#define ASDIC_KERNEL_FACES_H

#include "echo.h"

/* The solid angle of rays that were drawn as R with WEIGHT and met M. */
static real weigh_faces(const world *w, const meeting *m, __global const dev_hit *hits,
                        natural slots, const ray *r, real weight, real splat) {
    if (w->ping->sampling.face_count == 0u) {
        return weight;
    }
    real density = R(0.0);
    mask missed = (mask)(0);
    LANES {
        uint aim = as_uint(AT(splat, float)), met = 0xffffffffu;
        if (AT(m->kind, const uint) == DEV_KIND_OBJECT) {
            met = hits[AT(slots, uint)].triangle;
            AT(density, float) = w->face_density[met];
        }
        AT(missed, int) = aim >= 0x80000000u && met != (aim & 0x7fffffffu) ? -1 : 0;
    }
    density *= (real)((float)(w->ping->sampling.face_count));
    real cosine = r_max(r_abs(dot3(m->facet, ray_direction(r, m->t))), R(1e-6));
    real faces = choose(density > R(0.0), ray_per_steradian(r, m->t, density, cosine), R(0.0));
    real all = choose(weight > R(0.0), R(1.0) / weight + faces, R(1.0));
    weight = choose(weight > R(0.0), R(1.0) / all, R(0.0));
    return choose(missed, R(0.0), weight);
}

#endif
