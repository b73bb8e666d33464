/*
 * Averages of beam patterns around a ring, right and as printed.
 */
#include "errata.h"

#include "base/quadrature.h"

#include "../../kernels/beam.h"

/* What is averaged: both patterns or one of them, as energy or in decibels. */
typedef struct average {
    const asdic_ring *ring;
    bool transmitter, receiver, decibels, rear_unity;
} average;

static double one_way(const asdic_face *face, asdic_vec3 direction) {
    asdic_vec3 v = asdic_mat3_apply(face->world_to_face, direction);
    return beam_pattern_lin(1.0, v.y, v.z, face->length_h_wl, face->length_v_wl, 0.0);
}

/* Energy of one aperture; behind it the rear gain, or 1 where "0 otherwise" was read as 0 dB. */
static double energy(const average *a, const asdic_face *face, bool front, asdic_vec3 direction) {
    if (front) {
        return one_way(face, direction);
    }
    return a->rear_unity ? 1.0 : a->ring->rear_lin * one_way(face, direction);
}

static double value_at(const average *a, const asdic_arc *arc, asdic_vec3 direction) {
    const asdic_ring *ring = a->ring;
    if (a->decibels) { /* "0 otherwise" adds nothing */
        bool front = a->transmitter ? arc->front_t : arc->front_r;
        const asdic_face *face = a->transmitter ? &ring->transmitter : &ring->receiver;
        return front ? 10.0 * log10(fmax(one_way(face, direction), 1e-300)) : 0.0;
    }
    double value = 1.0;
    value *= a->transmitter ? energy(a, &ring->transmitter, arc->front_t, direction) : 1.0;
    value *= a->receiver ? energy(a, &ring->receiver, arc->front_r, direction) : 1.0;
    return value;
}

/* Nothing comes from behind a face. */
static bool is_silent(const average *a, const asdic_arc *arc) {
    bool behind = (a->transmitter && !arc->front_t) || (a->receiver && !arc->front_r);
    return behind && (a->decibels || (a->ring->rear_lin <= 0.0 && !a->rear_unity));
}

/* Integral around the circle. Logarithms of nulls ask for short panels. */
static double circle(const average *a, double elevation_rad) {
    double sin_e = sin(elevation_rad), cos_e = cos(elevation_rad), sum = 0.0;
    asdic_arc arcs[5];
    size_t count = asdic_ring_arcs(a->ring, elevation_rad, arcs);
    for (size_t j = 0; j < count; j++) {
        if (is_silent(a, &arcs[j])) {
            continue;
        }
        double length = arcs[j].end_rad - arcs[j].begin_rad;
        int panels = 4 + (int)(length * cos_e * asdic_ring_cycles(a->ring));
        double half = 0.5 * length / panels;
        for (int i = 0; i < panels * 2 * ASDIC_GAUSS16_HALF; i++) {
            int p = i / (2 * ASDIC_GAUSS16_HALF), k = i % ASDIC_GAUSS16_HALF;
            double side = i / ASDIC_GAUSS16_HALF % 2 ? half : -half;
            double phi = arcs[j].begin_rad + (2 * p + 1) * half + side * asdic_gauss16_node[k];
            asdic_vec3 u = {cos_e * cos(phi), cos_e * sin(phi), sin_e};
            sum += half * asdic_gauss16_weight[k] * value_at(a, &arcs[j], u);
        }
    }
    return sum;
}

double asdic_errata_ring_mean(const asdic_ring *ring, double elevation_rad, unsigned errata) {
    average both = {ring, true, true, false, errata & ASDIC_ERRATUM_REAR};
    average transmitter = both, receiver = both;
    transmitter.receiver = receiver.transmitter = false;
    /* The paper divides by pi where the circle has 2 pi. */
    double share = errata & ASDIC_ERRATUM_HALF_CIRCLE ? 1.0 : 0.5;
    if (errata & ASDIC_ERRATUM_DECIBELS) {
        transmitter.decibels = receiver.decibels = true;
        double mean_db =
            (circle(&transmitter, elevation_rad) + circle(&receiver, elevation_rad)) / ASDIC_PI;
        return share * pow(10.0, 0.1 * mean_db);
    }
    if (errata & ASDIC_ERRATUM_TWO_AVERAGES) {
        return share * circle(&transmitter, elevation_rad) / ASDIC_PI * share *
               circle(&receiver, elevation_rad) / ASDIC_PI;
    }
    return share * circle(&both, elevation_rad) / ASDIC_PI;
}
