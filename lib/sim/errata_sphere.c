/*
 * Averages of beam patterns over the water seen by a range bin, right and as printed.
 */
#include "errata.h"

#include "base/context.h"

#include "../../kernels/beam.h"
#include "../../kernels/ray.h"

#include <stdlib.h>

#define MOST_ROWS 2400

/* Sums over directions, cumulative in the angle that the boundaries cut. */
typedef struct cumulative {
    double sum[MOST_ROWS + 1]; /* up to k * pi / rows - pi / 2 */
    double front;              /* weight of the directions in front */
    double pitch_rad;          /* of the face whose elevation is the key; 0: world elevation */
} cumulative;

struct asdic_errata_sphere {
    unsigned errata;
    asdic_flat_scene flat;
    int rows;     /* steps of either angle, and of the tables */
    size_t count; /* 1: both patterns together; 2: transmitter, receiver */
    cumulative tables[2];
};

/* One direction: where it points in the world, and its weight in the average. */
typedef struct direction {
    asdic_vec3 unit;
    double elevation_rad, weight;
} direction;

/* Row I of ROWS, column J: equal steps in both angles. The paper's set covers the sphere twice with
 * vectors that are not unit vectors, and no Jacobian. */
static direction direction_at(unsigned errata, int i, int j, int rows) {
    double second = 2.0 * ASDIC_PI * (j + 0.5) / rows - ASDIC_PI;
    if (errata & ASDIC_ERRATUM_SPHERE) {
        double first = 2.0 * ASDIC_PI * (i + 0.5) / rows - ASDIC_PI;
        asdic_vec3 v = {cos(first) * cos(second), sin(first), sin(second)};
        asdic_vec3 unit = asdic_vec3_scale(v, 1.0 / asdic_vec3_length(v));
        return (direction){unit, asin(unit.z), 1.0};
    }
    double e = ASDIC_PI * (i + 0.5) / rows - 0.5 * ASDIC_PI;
    return (direction){{cos(e) * cos(second), cos(e) * sin(second), sin(e)}, e, cos(e)};
}

/* A face's own elevation, and its pattern, where its elevation may be the paper's atan(vz / vx). */
static double face_pattern(const asdic_face *face, asdic_vec3 unit, unsigned errata, bool *front,
                           double *psi_rad) {
    asdic_vec3 v = asdic_mat3_apply(face->world_to_face, unit);
    *front = v.x > 0.0;
    *psi_rad = atan2(v.z, hypot(v.x, v.y));
    if (errata & ASDIC_ERRATUM_ELEVATION) {
        double theta = atan2(v.y, fabs(v.x));
        *psi_rad = atan2(v.z, fabs(v.x));
        v.y = sin(theta) * cos(*psi_rad);
        v.z = sin(*psi_rad);
    }
    return beam_pattern_lin(1.0, v.y, v.z, face->length_h_wl, face->length_v_wl, 0.0);
}

static double with_rear(const asdic_errata_sphere *s, double pattern, bool front, double rear_lin) {
    if (front) {
        return pattern;
    }
    return s->errata & ASDIC_ERRATUM_REAR ? 1.0 : rear_lin * pattern;
}

/* Adds one direction to TABLE; WHICH is 0 for the transmitter, 1 for the receiver, 2 for both. */
static void add(const asdic_errata_sphere *s, const asdic_ring *ring, int which,
                const direction *at, cumulative *table) {
    bool front_t, front_r;
    double psi_t, psi_r;
    double t = face_pattern(&ring->transmitter, at->unit, s->errata, &front_t, &psi_t);
    double r = face_pattern(&ring->receiver, at->unit, s->errata, &front_r, &psi_r);
    bool front = which == 0 ? front_t : front_r;
    double value = (which == 1 ? 1.0 : with_rear(s, t, front_t, ring->rear_lin)) *
                   (which == 0 ? 1.0 : with_rear(s, r, front_r, ring->rear_lin));
    if (s->errata & ASDIC_ERRATUM_DECIBELS) {
        value = front ? 10.0 * log10(fmax(which == 0 ? t : r, 1e-300)) : 0.0;
    }
    double key = at->elevation_rad;
    if (s->errata & ASDIC_ERRATUM_WINDOW_PITCH) {
        key = which == 0 ? psi_t : psi_r;
    }
    int k = (int)((key / ASDIC_PI + 0.5) * s->rows);
    table->sum[1 + (k < 0 ? 0 : k >= s->rows ? s->rows - 1 : k)] += at->weight * value;
    table->front += front ? at->weight : 0.0;
}

static void fill(asdic_errata_sphere *s, const asdic_ring *ring, int which, cumulative *table) {
    const asdic_face *face = which == 0 ? &ring->transmitter : &ring->receiver;
    for (int i = 0; i < s->rows; i++) {
        for (int j = 0; j < s->rows; j++) {
            direction at = direction_at(s->errata, i, j, s->rows);
            add(s, ring, which, &at, table);
        }
    }
    for (int k = 0; k < s->rows; k++) {
        table->sum[k + 1] += table->sum[k];
    }
    table->pitch_rad = asin(fmin(fmax(face->world_to_face.m[0][2], -1.0), 1.0));
}

asdic_status asdic_errata_sphere_create(asdic_context *ctx, const asdic_flat_scene *flat,
                                        const asdic_ring *ring, unsigned errata,
                                        asdic_errata_sphere **out) {
    bool apart = errata & (ASDIC_ERRATUM_TWO_AVERAGES | ASDIC_ERRATUM_DECIBELS);
    asdic_errata_sphere *s = calloc(1, sizeof *s);
    *out = s;
    if (!s) {
        return asdic_fail_memory(ctx, "the average of a beam over the sphere");
    }
    s->errata = errata;
    s->flat = *flat;
    s->rows = (int)fmin(fmax(24.0 * asdic_ring_cycles(ring), 720.0), MOST_ROWS);
    s->count = apart ? 2 : 1;
    for (size_t i = 0; i < s->count; i++) {
        fill(s, ring, apart ? (int)i : 2, &s->tables[i]);
    }
    return ASDIC_OK;
}

void asdic_errata_sphere_destroy(asdic_errata_sphere **sphere) {
    if (sphere) {
        free(*sphere);
        *sphere = NULL;
    }
}

static double below(const asdic_errata_sphere *s, const cumulative *table, double key_rad) {
    double x = fmin(fmax((key_rad / ASDIC_PI + 0.5) * s->rows, 0.0), s->rows);
    int k = x < s->rows ? (int)x : s->rows - 1;
    return table->sum[k] + (x - k) * (table->sum[k + 1] - table->sum[k]);
}

/* The elevation that a boundary cuts off; none before it is reached, where the paper's "0
 * otherwise" leaves nothing. */
static double cut(const asdic_errata_sphere *s, bool present, double height_m, double d_m) {
    if (present && d_m <= height_m && (s->errata & ASDIC_ERRATUM_WINDOW)) {
        return 0.0;
    }
    return present ? ray_plane_elevation(height_m, d_m) : 0.5 * ASDIC_PI;
}

static double window_sum(const asdic_errata_sphere *s, const cumulative *table, double d_m) {
    double bottom = cut(s, s->flat.has_bottom, s->flat.altitude_m, d_m);
    double surface = cut(s, s->flat.has_surface, s->flat.depth_m, d_m);
    if (s->errata & ASDIC_ERRATUM_WINDOW_PITCH) { /* written for z up, in a frame with z down */
        return below(s, table, surface + table->pitch_rad) -
               below(s, table, -bottom + table->pitch_rad);
    }
    return below(s, table, bottom) - below(s, table, -surface);
}

double asdic_errata_sphere_mean(const asdic_errata_sphere *s, double d_m) {
    bool doubled = s->errata & ASDIC_ERRATUM_SPHERE_SHARE;
    double mean = 1.0, mean_db = 0.0;
    for (size_t i = 0; i < s->count; i++) {
        const cumulative *table = &s->tables[i];
        double share = window_sum(s, table, d_m) / table->front; /* of the front half */
        mean_db += doubled ? 2.0 * share : share;
        mean *= doubled ? 2.0 * share : 0.5 * share;
    }
    if (s->errata & ASDIC_ERRATUM_DECIBELS) {
        return (doubled ? 1.0 : 0.5) * pow(10.0, 0.1 * mean_db);
    }
    return mean;
}
