/*
 * The paper's slips as switches, one bit each, numbered as in kernels/README.md. Any set of them can
 * be put back into the expected ping; asdic_expected_compute's printed variant puts back those that
 * the printed text evaluates to a number with.
 */
#ifndef ASDIC_SIM_ERRATA_H
#define ASDIC_SIM_ERRATA_H

#include "expected.h"

/* In the order of the table of asdic_erratum_get. */
typedef enum asdic_erratum_bit {
    ASDIC_ERRATUM_ABSORPTION = 1u << 0,    /* 1, 2 */
    ASDIC_ERRATUM_LOSS = 1u << 1,          /* 5 */
    ASDIC_ERRATUM_WAVELENGTH = 1u << 2,    /* 7 */
    ASDIC_ERRATUM_SINC = 1u << 3,          /* 9 */
    ASDIC_ERRATUM_REAR = 1u << 4,          /* 10 */
    ASDIC_ERRATUM_MIRROR = 1u << 5,        /* 11 */
    ASDIC_ERRATUM_DECIBELS = 1u << 6,      /* 12 */
    ASDIC_ERRATUM_TWO_AVERAGES = 1u << 7,  /* 13 */
    ASDIC_ERRATUM_HALF_CIRCLE = 1u << 8,   /* 14 */
    ASDIC_ERRATUM_AREA = 1u << 9,          /* 15 */
    ASDIC_ERRATUM_MIDDLE = 1u << 10,       /* 17 */
    ASDIC_ERRATUM_WINDOW = 1u << 11,       /* 21 */
    ASDIC_ERRATUM_WINDOW_PITCH = 1u << 12, /* 22 */
    ASDIC_ERRATUM_SPHERE = 1u << 13,       /* 23 */
    ASDIC_ERRATUM_ELEVATION = 1u << 14,    /* 24 */
    ASDIC_ERRATUM_SPHERE_SHARE = 1u << 15, /* 25 */
    ASDIC_ERRATUM_REMAINDER = 1u << 16,    /* 26 */
    ASDIC_ERRATUM_NOISE_WIND = 1u << 17,   /* 31 */
    ASDIC_ERRATUM_DIRECTIVITY = 1u << 18,  /* 32 */
    ASDIC_ERRATUM_NOISE_CELLS = 1u << 19,  /* 33 */
    ASDIC_ERRATUM_SURFACE_CAP = 1u << 20,  /* 40 */
} asdic_erratum_bit;

/* Those that asdic_errata_beam puts in; the others change what it is given. */
#define ASDIC_ERRATA_OF_BEAM                                                                       \
    (ASDIC_ERRATUM_LOSS | ASDIC_ERRATUM_REAR | ASDIC_ERRATUM_DECIBELS |                            \
     ASDIC_ERRATUM_TWO_AVERAGES | ASDIC_ERRATUM_HALF_CIRCLE | ASDIC_ERRATUM_AREA |                 \
     ASDIC_ERRATUM_MIDDLE | ASDIC_ERRATUM_WINDOW | ASDIC_ERRATUM_WINDOW_PITCH |                    \
     ASDIC_ERRATUM_SPHERE | ASDIC_ERRATUM_ELEVATION | ASDIC_ERRATUM_SPHERE_SHARE |                 \
     ASDIC_ERRATUM_REMAINDER)

/* All that the printed text says and a number comes out of. Resolution cells are left out (each
 * bin is evaluated once), since their areas by the printed recursion would count discs. */
#define ASDIC_ERRATA_PRINTED                                                                       \
    (ASDIC_ERRATUM_ABSORPTION | ASDIC_ERRATUM_LOSS | ASDIC_ERRATUM_DECIBELS |                      \
     ASDIC_ERRATUM_TWO_AVERAGES | ASDIC_ERRATUM_HALF_CIRCLE | ASDIC_ERRATUM_AREA |                 \
     ASDIC_ERRATUM_MIDDLE | ASDIC_ERRATUM_WINDOW | ASDIC_ERRATUM_WINDOW_PITCH |                    \
     ASDIC_ERRATUM_SPHERE | ASDIC_ERRATUM_ELEVATION | ASDIC_ERRATUM_SPHERE_SHARE |                 \
     ASDIC_ERRATUM_DIRECTIVITY | ASDIC_ERRATUM_NOISE_CELLS | ASDIC_ERRATUM_SURFACE_CAP)

/* One receiver's bottom, surface and volume with the switches ERRATA. */
asdic_status asdic_errata_beam(asdic_context *ctx, const asdic_flat_laws *laws,
                               const asdic_sonar *sonar, const asdic_ring *ring, unsigned errata,
                               asdic_ping *ping, size_t beam);

/* The two-way mean over the whole circle at an elevation, linear, as the switches have it. */
double asdic_errata_ring_mean(const asdic_ring *ring, double elevation_rad, unsigned errata);

/* The two-way mean over the whole sphere between the boundaries, linear, as the switches have it. */
typedef struct asdic_errata_sphere asdic_errata_sphere;

asdic_status asdic_errata_sphere_create(asdic_context *ctx, const asdic_flat_scene *flat,
                                        const asdic_ring *ring, unsigned errata,
                                        asdic_errata_sphere **out);
void asdic_errata_sphere_destroy(asdic_errata_sphere **sphere);
double asdic_errata_sphere_mean(const asdic_errata_sphere *sphere, double d_m);

#endif
