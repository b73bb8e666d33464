/*
 * Vectors and rotations in double, for host geometry.
 */
#ifndef ASDIC_BASE_VEC_H
#define ASDIC_BASE_VEC_H

#include <asdic/common.h>

#include <math.h>

#define ASDIC_PI 3.14159265358979323846

static inline asdic_vec3 asdic_vec3_add(asdic_vec3 a, asdic_vec3 b) {
    return (asdic_vec3){a.x + b.x, a.y + b.y, a.z + b.z};
}

static inline asdic_vec3 asdic_vec3_sub(asdic_vec3 a, asdic_vec3 b) {
    return (asdic_vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline asdic_vec3 asdic_vec3_scale(asdic_vec3 a, double s) {
    return (asdic_vec3){a.x * s, a.y * s, a.z * s};
}

static inline double asdic_vec3_dot(asdic_vec3 a, asdic_vec3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline asdic_vec3 asdic_vec3_cross(asdic_vec3 a, asdic_vec3 b) {
    return (asdic_vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double asdic_vec3_length(asdic_vec3 a) {
    return sqrt(asdic_vec3_dot(a, a));
}

/* Two unit vectors across the unit vector W, and each other. */
static inline void asdic_vec3_across(asdic_vec3 w, asdic_vec3 axes[2]) {
    asdic_vec3 up = fabs(w.z) < 0.9 ? (asdic_vec3){0.0, 0.0, 1.0} : (asdic_vec3){1.0, 0.0, 0.0};
    asdic_vec3 u = asdic_vec3_cross(up, w);
    axes[0] = asdic_vec3_scale(u, 1.0 / asdic_vec3_length(u));
    axes[1] = asdic_vec3_cross(w, axes[0]);
}

/* Columns are the images of the axes: world = m * body. */
typedef struct asdic_mat3 {
    double m[3][3]; /* row, column */
} asdic_mat3;

/* Body to world for yaw, then pitch, then roll (aerospace order, NED; positive pitch: bow up). */
static inline asdic_mat3 asdic_mat3_attitude(double roll_rad, double pitch_rad, double yaw_rad) {
    double cr = cos(roll_rad), sr = sin(roll_rad);
    double cp = cos(pitch_rad), sp = sin(pitch_rad);
    double cy = cos(yaw_rad), sy = sin(yaw_rad);
    return (asdic_mat3){{{cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr},
                         {sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr},
                         {-sp, cp * sr, cp * cr}}};
}

static inline asdic_mat3 asdic_mat3_of(const asdic_pose *pose) {
    return asdic_mat3_attitude(pose->roll_rad, pose->pitch_rad, pose->yaw_rad);
}

static inline asdic_mat3 asdic_mat3_multiply(asdic_mat3 a, asdic_mat3 b) {
    asdic_mat3 c;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            c.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
        }
    }
    return c;
}

static inline asdic_vec3 asdic_mat3_apply(asdic_mat3 a, asdic_vec3 v) {
    return (asdic_vec3){a.m[0][0] * v.x + a.m[0][1] * v.y + a.m[0][2] * v.z,
                        a.m[1][0] * v.x + a.m[1][1] * v.y + a.m[1][2] * v.z,
                        a.m[2][0] * v.x + a.m[2][1] * v.y + a.m[2][2] * v.z};
}

/* The inverse of a rotation is its transpose. */
static inline asdic_vec3 asdic_mat3_apply_inverse(asdic_mat3 a, asdic_vec3 v) {
    return (asdic_vec3){a.m[0][0] * v.x + a.m[1][0] * v.y + a.m[2][0] * v.z,
                        a.m[0][1] * v.x + a.m[1][1] * v.y + a.m[2][1] * v.z,
                        a.m[0][2] * v.x + a.m[1][2] * v.y + a.m[2][2] * v.z};
}

/* Of a rigid body, from one pose to another. */
typedef struct asdic_move {
    asdic_mat3 before, after;
    asdic_vec3 from_m, to_m;
} asdic_move;

static inline asdic_move asdic_move_between(const asdic_pose *from, const asdic_pose *to) {
    return (asdic_move){asdic_mat3_of(from), asdic_mat3_of(to), from->position_m, to->position_m};
}

static inline asdic_vec3 asdic_move_turn(const asdic_move *move, asdic_vec3 v) {
    return asdic_mat3_apply(move->after, asdic_mat3_apply_inverse(move->before, v));
}

static inline asdic_vec3 asdic_move_point(const asdic_move *move, asdic_vec3 at_m) {
    return asdic_vec3_add(asdic_move_turn(move, asdic_vec3_sub(at_m, move->from_m)), move->to_m);
}

#endif
