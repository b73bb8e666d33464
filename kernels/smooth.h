/*
 * Curved surfaces made of flat facets: the normal inside a facet, interpolated between its corners
 * (B. T. Phong, "Illumination for computer generated pictures", CACM 18(6), 1975). It decides the
 * angle of scattering and of reflection; areas, and what a ray meets, stay those of the facet.
 *
 * A corner's normal takes 32 bits: the octahedral map of Meyer et al., "On floating-point normal
 * vectors", EGSR 2010, at 16 bits a coordinate, 6e-5 rad at worst: a twentieth of the narrowest lobe,
 * that of a flat patch 100 m away at 1 MHz.
 */
#ifndef ASDIC_KERNEL_SMOOTH_H
#define ASDIC_KERNEL_SMOOTH_H

#include "types.h"
#include "vector.h"

#ifdef __OPENCL_C_VERSION__
#define SMOOTH_SPACE __global
#define smooth_abs fabs
#else
#define SMOOTH_SPACE
#define smooth_abs fabsf
#endif

#define OCTAHEDRON_STEPS 32767.0f

static inline vector vector_load(SMOOTH_SPACE const float v[3]) {
    return vector_of(v[0], v[1], v[2]);
}

static inline vector smooth_unpack(dev_uint word) {
    dev_int low = (dev_int)(word & 0xffffu), high = (dev_int)(word >> 16);
    float x = (float)(low < 32768 ? low : low - 65536) / OCTAHEDRON_STEPS;
    float y = (float)(high < 32768 ? high : high - 65536) / OCTAHEDRON_STEPS;
    float z = 1.0f - smooth_abs(x) - smooth_abs(y);
    if (z < 0.0f) { /* the lower half is folded outwards */
        float fold = x;
        x = (1.0f - smooth_abs(y)) * (fold < 0.0f ? -1.0f : 1.0f);
        y = (1.0f - smooth_abs(fold)) * (y < 0.0f ? -1.0f : 1.0f);
    }
    return vector_unit(vector_of(x, y, z));
}

/* Two edges of a facet from its first corner, its normal, and 1 / |their cross product|; 0 where
 * rounding has made it a line. */
typedef struct smooth_frame {
    vector a, b, normal;
    float per_area;
} smooth_frame;

static inline smooth_frame smooth_frame_of(SMOOTH_SPACE const dev_triangle *t) {
    smooth_frame f;
    vector corner = vector_load(t->v0);
    f.a = vector_step(vector_load(t->v1), -1.0f, corner);
    f.b = vector_step(vector_load(t->v2), -1.0f, corner);
    f.normal = vector_load(t->normal);
    float area = vector_dot(vector_cross(f.a, f.b), f.normal);
    f.per_area = area > 1e-30f ? 1.0f / area : 0.0f;
    return f;
}

/* Unit normal of the surface at point P of facet T. */
static inline vector smooth_normal(SMOOTH_SPACE const dev_triangle *t, vector p) {
    if (t->corner_normals[0] == DEV_FLAT) {
        return vector_load(t->normal);
    }
    smooth_frame f = smooth_frame_of(t);
    vector q = vector_step(p, -1.0f, vector_load(t->v0));
    float u = vector_dot(vector_cross(q, f.b), f.normal) * f.per_area;
    float v = vector_dot(vector_cross(f.a, q), f.normal) * f.per_area;
    u = u > 0.0f ? (u < 1.0f ? u : 1.0f) : 0.0f;
    v = v > 0.0f ? (v < 1.0f - u ? v : 1.0f - u) : 0.0f;
    vector n =
        vector_step(vector_of(0.0f, 0.0f, 0.0f), 1.0f - u - v, smooth_unpack(t->corner_normals[0]));
    n = vector_step(n, u, smooth_unpack(t->corner_normals[1]));
    n = vector_step(n, v, smooth_unpack(t->corner_normals[2]));
    return vector_unit(n);
}

/* The flat area of T that reflects in phase, m2, of an object whose largest extent has the square SIZE_M2. */
static inline float smooth_flat_m2(SMOOTH_SPACE const dev_triangle *t, float wavelength_m,
                                   float size_m2) {
    float curved = wavelength_m * t->radius_m;
    curved = curved < size_m2 ? curved : size_m2;
    return t->flat_m2 > curved ? t->flat_m2 : curved;
}

/* What a mirror's curvature does to a ray along U. */
typedef struct smooth_bend {
    float trace; /* kappa_t / cos i + kappa_s cos i: curvatures along and across the plane of
                    incidence, positive where the side that the ray meets is convex, 1/m */
    float gauss; /* their Gaussian product, 1/m2 */
} smooth_bend;

/* Change of the normal in direction D of the facet's plane. */
static inline vector smooth_derivative(SMOOTH_SPACE const dev_triangle *t, smooth_frame f,
                                       vector d) {
    float u = vector_dot(vector_cross(d, f.b), f.normal) * f.per_area;
    float v = vector_dot(vector_cross(f.a, d), f.normal) * f.per_area;
    vector first = smooth_unpack(t->corner_normals[0]);
    vector a = vector_step(smooth_unpack(t->corner_normals[1]), -1.0f, first);
    vector b = vector_step(smooth_unpack(t->corner_normals[2]), -1.0f, first);
    return vector_step(vector_of(u * a.x, u * a.y, u * a.z), v, b);
}

static inline smooth_bend smooth_bend_of(SMOOTH_SPACE const dev_triangle *t, vector u) {
    smooth_bend bend;
    bend.trace = bend.gauss = 0.0f;
    if (t->corner_normals[0] == DEV_FLAT) {
        return bend;
    }
    smooth_frame f = smooth_frame_of(t);
    float cosine = vector_dot(u, f.normal);
    vector along = vector_step(u, -cosine, f.normal);
    if (vector_dot(along, along) < 1e-8f) {
        along = f.a; /* normal incidence: any direction in the plane */
    }
    along = vector_unit(along);
    vector across = vector_cross(f.normal, along);
    vector d_along = smooth_derivative(t, f, along), d_across = smooth_derivative(t, f, across);
    float tt = vector_dot(d_along, along), ts = vector_dot(d_along, across);
    float ss = vector_dot(d_across, across), st = vector_dot(d_across, along);
    float c = smooth_abs(cosine);
    c = c > 1e-3f ? c : 1e-3f;
    bend.trace = (cosine < 0.0f ? 1.0f : -1.0f) * (tt / c + ss * c);
    bend.gauss = tt * ss - ts * st;
    return bend;
}

#endif
