/*
 * Three floats: a point or a direction of one ray. Those of ASDIC_WIDTH rays are a triple (ray.h).
 *
 * A struct, never an array: PoCL keeps the private arrays of a whole work-group on one stack.
 */
#ifndef ASDIC_KERNEL_VECTOR_H
#define ASDIC_KERNEL_VECTOR_H

#ifdef __OPENCL_C_VERSION__
#define vector_sqrt sqrt
#else
#include <math.h>
#define vector_sqrt sqrtf
#endif

typedef struct vector {
    float x, y, z;
} vector;

static inline vector vector_of(float x, float y, float z) {
    vector v;
    v.x = x;
    v.y = y;
    v.z = z;
    return v;
}

static inline vector vector_add(vector a, vector b) {
    return vector_of(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline vector vector_scale(vector a, float s) {
    return vector_of(a.x * s, a.y * s, a.z * s);
}

/* A + T B */
static inline vector vector_step(vector a, float t, vector b) {
    return vector_of(a.x + t * b.x, a.y + t * b.y, a.z + t * b.z);
}

static inline float vector_dot(vector a, vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vector vector_cross(vector a, vector b) {
    return vector_of(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline vector vector_unit(vector a) {
    float scale = 1.0f / vector_sqrt(vector_dot(a, a));
    return vector_of(a.x * scale, a.y * scale, a.z * scale);
}

#endif
