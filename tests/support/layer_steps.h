/*
 * Rays through the layers of a cast by Runge-Kutta steps, which know nothing of arcs.
 */
#ifndef ASDIC_TEST_LAYER_STEPS_H
#define ASDIC_TEST_LAYER_STEPS_H

#include <asdic/environment.h>

#include <math.h>

/* Place, direction, time and length of a traced ray,  */
typedef struct traced {
    double r, z, angle, length;
} traced;

/* The layer of the cast that holds Z: 0 above its first point. */
static inline size_t layer_of(const asdic_sound_profile *p, double z) {
    size_t i = 0;
    while (i < p->points && z > p->depth_m[i]) {
        i++;
    }
    return i;
}

/* The speed in LAYER, continued beyond its ends: a step keeps to one. */
static inline double speed_at(const asdic_sound_profile *p, size_t layer, double z,
                              double *gradient) {
    bool outside = layer == 0 || layer == p->points;
    size_t i = layer ? layer - 1 : 0;
    *gradient = outside ? 0.0
                        : (p->sound_speed_mps[i + 1] - p->sound_speed_mps[i]) /
                              (p->depth_m[i + 1] - p->depth_m[i]);
    return p->sound_speed_mps[i] + *gradient * (z - p->depth_m[i]);
}

static inline traced slope(const asdic_sound_profile *p, size_t layer, const traced *at) {
    double g, c = speed_at(p, layer, at->z, &g);
    return (traced){c * cos(at->angle), c * sin(at->angle), -g * cos(at->angle), c};
}

static inline traced move(const traced *from, const traced *by, double h) {
    return (traced){from->r + h * by->r, from->z + h * by->z, from->angle + h * by->angle,
                    from->length + h * by->length};
}

static inline traced step(const asdic_environment *env, const traced *from, double h) {
    const asdic_sound_profile *p = &env->sound_speed_profile;
    size_t layer = layer_of(p, from->z);
    traced a = slope(p, layer, from), at = move(from, &a, 0.5 * h);
    traced b = slope(p, layer, &at);
    at = move(from, &b, 0.5 * h);
    traced c = slope(p, layer, &at);
    at = move(from, &c, h);
    traced d = slope(p, layer, &at), next = move(from, &a, h / 6.0);
    next = move(&next, &b, h / 3.0);
    next = move(&next, &c, h / 3.0);
    return move(&next, &d, h / 6.0);
}

/* Whether a point of the cast lies between A and B. */
static inline bool crosses(const asdic_environment *env, double a, double b) {
    for (size_t i = 0; i < env->sound_speed_profile.points; i++) {
        double z = env->sound_speed_profile.depth_m[i];
        if ((a < z && b > z) || (a > z && b < z)) {
            return true;
        }
    }
    return false;
}

/* Steps of 5 mm that end on the cast's points: across a kink they would lose an order. */
static inline traced trace(const asdic_environment *env, double depth, double elevation,
                           double time_s) {
    const double whole = time_s / 20000;
    traced at = {0.0, depth + (elevation > 0.0 ? 1e-12 : -1e-12), elevation, 0.0};
    for (double done_s = 0.0; done_s < time_s - 1e-12;) {
        double h = fmin(whole, time_s - done_s), least = 0.0;
        traced next = step(env, &at, h);
        if (crosses(env, at.z, next.z)) {
            for (int i = 0; i < 50; i++) {
                double middle = 0.5 * (least + h);
                next = step(env, &at, middle);
                *(crosses(env, at.z, next.z) ? &h : &least) = middle;
            }
            h += 1e-14; /* beyond the point */
            next = step(env, &at, h);
        }
        at = next;
        done_s += h;
    }
    return at;
}

/* The ray in steps of WHOLE seconds where it has come ACROSS_M far horizontally, and its time there in *TIME_S; or
 * after a fifth of a second. */
static inline traced trace_across(const asdic_environment *env, double depth, double elevation,
                                  double across_m, double whole, double *time_s) {
    const double latest_s = 0.2;
    traced at = {0.0, depth + (elevation > 0.0 ? 1e-12 : -1e-12), elevation, 0.0};
    *time_s = 0.0;
    while (*time_s < latest_s && at.r < across_m) {
        double h = whole, least = 0.0;
        traced next = step(env, &at, h);
        if (crosses(env, at.z, next.z) || next.r > across_m) {
            for (int i = 0; i < 50; i++) {
                double middle = 0.5 * (least + h);
                next = step(env, &at, middle);
                *(crosses(env, at.z, next.z) || next.r > across_m ? &h : &least) = middle;
            }
            h += 1e-14;
            next = step(env, &at, h);
        }
        at = next;
        *time_s += h;
    }
    return at;
}

/* A ray between two places, by steps: its angles at both ends, time, length, and the spreading of intensity from
 * neighbours' depths: a tube of one radian is dz/de cos(angle) wide in its plane, and r / cos(e) across it; power
 * through its cross-section times the ratio of sound speeds is the squared pressure. */
typedef struct stepped_ray {
    double elevation, angle, time_s, length_m, spread_m2;
} stepped_ray;

static inline double speed_of(const asdic_environment *env, double z) {
    double gradient;
    return speed_at(&env->sound_speed_profile, layer_of(&env->sound_speed_profile, z), z,
                    &gradient);
}

static inline double missed_by(const asdic_environment *env, double from_m, double to_m,
                               double across_m, double elevation, double whole) {
    double time_s;
    return trace_across(env, from_m, elevation, across_m, whole, &time_s).z - to_m;
}

static inline stepped_ray stepped_ray_of(const asdic_environment *env, double from_m,
                                         double across_m, double e) {
    const double de = 2e-7, whole = 1e-5;
    stepped_ray ray = {.elevation = e};
    traced at = trace_across(env, from_m, e, across_m, whole, &ray.time_s);
    double dz = missed_by(env, from_m, 0.0, across_m, e + de, whole) -
                missed_by(env, from_m, 0.0, across_m, e - de, whole);
    ray.angle = at.angle;
    ray.length_m = at.length;
    ray.spread_m2 = fabs(dz / (2.0 * de) * cos(at.angle)) * across_m / cos(e) *
                    speed_of(env, from_m) / speed_of(env, at.z);
    return ray;
}

/* All rays from FROM_M deep to TO_M deep, ACROSS_M away, up to 57 degrees steep; returns how many, MOST at most. */
static inline int stepped_rays(const asdic_environment *env, double from_m, double to_m,
                               double across_m, stepped_ray *out, int most) {
    enum { FAN = 1501 };
    int count = 0;
    double before = 0.0, e0 = 0.0;
    for (int i = 0; i < FAN && count < most; i++) {
        double x = 2.0 * ((double)i + 0.5) / FAN - 1.0, e = x * fabs(x);
        double here = missed_by(env, from_m, to_m, across_m, e, 2e-4);
        if (i > 0 && (here > 0.0) != (before > 0.0) && fabs(here - before) < 0.5) {
            double a = e0, b = e;
            for (int k = 0; k < 45; k++) {
                double middle = 0.5 * (a + b);
                double miss = missed_by(env, from_m, to_m, across_m, middle, 1e-5);
                *((miss > 0.0) == (before > 0.0) ? &a : &b) = middle;
            }
            out[count++] = stepped_ray_of(env, from_m, across_m, 0.5 * (a + b));
        }
        before = here;
        e0 = e;
    }
    return count;
}

#endif
