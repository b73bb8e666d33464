/*
 * The expected ping with the paper's slips put back in.
 */
#include "errata.h"

#include "base/quadrature.h"

#include "../../kernels/water.h"

/* On the difference of two rules; the better one is kept. Averages of logarithms are rough in the
 * elevation, wherever a ring runs through a null. */
#define TOLERANCE 1e-4
#define ROUGH_TOLERANCE 1e-2

/* Switches that change the average around a ring, and over the water. */
#define RING_ERRATA (ASDIC_ERRATUM_REAR | ASDIC_ERRATUM_DECIBELS | ASDIC_ERRATUM_TWO_AVERAGES)
#define SPHERE_ERRATA                                                                              \
    (RING_ERRATA | ASDIC_ERRATUM_WINDOW | ASDIC_ERRATUM_WINDOW_PITCH | ASDIC_ERRATUM_SPHERE |      \
     ASDIC_ERRATUM_ELEVATION | ASDIC_ERRATUM_SPHERE_SHARE)

typedef struct variant {
    const asdic_flat_laws *laws;
    const asdic_ring *ring;
    const asdic_ring_profile *profile;
    const asdic_errata_sphere *sphere; /* NULL: no switch concerns it */
    unsigned errata;
    double height_m;
    bool surface;
} variant;

static double transmission(const variant *v, double d_m) {
    double alpha = v->laws->absorption_db_per_km;
    double lin = transmission_lin(d_m, alpha);
    /* (2 d - 1) alpha / 1000 for 2 (d - 1) alpha / 1000 */
    return v->errata & ASDIC_ERRATUM_LOSS ? lin * pow(10.0, -1e-4 * alpha) : lin;
}

static double strength(const variant *v, double sin_grazing) {
    return asdic_flat_strength(v->laws, v->surface, sin_grazing);
}

static double ring_mean(const variant *v, double elevation_rad) {
    double e = v->surface ? -elevation_rad : elevation_rad;
    if (v->errata & RING_ERRATA) {
        return asdic_errata_ring_mean(v->ring, e, v->errata);
    }
    double share = v->errata & ASDIC_ERRATUM_HALF_CIRCLE ? 1.0 : 0.5;
    return share * asdic_ring_profile_sum(v->profile, e) / ASDIC_PI;
}

static double boundary_density(double t, void *user) {
    const variant *v = user;
    double h = v->height_m, d = h + t * t;
    return 2.0 * t * d * transmission(v, d) * strength(v, h / d) * 2.0 * ASDIC_PI *
           ring_mean(v, atan2(h, t * sqrt(d + h)));
}

static double ring_area(double height_m, double begin_m, double end_m) {
    double inner = fmax(begin_m, height_m);
    return ASDIC_PI * (end_m - inner) * (end_m + inner);
}

/* As the paper evaluates: the pattern at the middle radius, the rest at the middle slant range. */
static double boundary_at_middle(const variant *v, double begin_m, double end_m) {
    double h = v->height_m, inner = fmax(begin_m, h);
    double r0 = sqrt((inner - h) * (inner + h)), r1 = sqrt((end_m - h) * (end_m + h));
    return transmission(v, 0.5 * (begin_m + end_m)) * strength(v, 2.0 * h / (end_m + inner)) *
           ring_mean(v, atan2(h, 0.5 * (r0 + r1))) * ring_area(h, begin_m, end_m);
}

/* AREA_M2 is the paper's A_(n-1) and becomes A_n = pi r_n^2 - A_(n-1). */
static double boundary_energy(variant *v, double begin_m, double end_m, double *area_m2) {
    double h = v->height_m;
    if (end_m <= h) {
        return 0.0;
    }
    double sum =
        v->errata & ASDIC_ERRATUM_MIDDLE
            ? boundary_at_middle(v, begin_m, end_m)
            : asdic_quadrature(boundary_density, v, sqrt(fmax(begin_m - h, 0.0)), sqrt(end_m - h),
                               v->errata & ASDIC_ERRATUM_DECIBELS ? ROUGH_TOLERANCE : TOLERANCE);
    *area_m2 = ASDIC_PI * (end_m - h) * (end_m + h) - *area_m2;
    return v->errata & ASDIC_ERRATUM_AREA ? sum * *area_m2 / ring_area(h, begin_m, end_m) : sum;
}

static double sphere_mean(const variant *v, double d) {
    if (v->sphere) {
        return asdic_errata_sphere_mean(v->sphere, d);
    }
    return asdic_flat_solid_angle(&v->laws->flat, v->profile, d) / (4.0 * ASDIC_PI);
}

static double volume_density(double d, void *user) {
    const variant *v = user;
    return d * d * transmission(v, d) * 4.0 * ASDIC_PI * sphere_mean(v, d);
}

static double volume_energy(variant *v, double begin_m, double end_m) {
    if (v->errata & ASDIC_ERRATUM_MIDDLE) {
        double middle = 0.5 * (begin_m + end_m);
        double shell = 4.0 / 3.0 * ASDIC_PI * (pow(end_m, 3.0) - pow(begin_m, 3.0));
        return v->laws->volume_lin * transmission(v, middle) * shell * sphere_mean(v, middle);
    }
    return v->laws->volume_lin * asdic_quadrature(volume_density, v, begin_m, end_m, TOLERANCE);
}

static void add_bin(variant *bottom, variant *surface, double begin_m, double end_m,
                    double area_m2[2], asdic_ping *ping, size_t at) {
    const asdic_flat_laws *laws = bottom->laws;
    if (laws->flat.has_bottom) {
        ping->intensity_lin[ASDIC_BOTTOM][at] =
            laws->source_lin * boundary_energy(bottom, begin_m, end_m, &area_m2[0]);
    }
    if (laws->flat.has_surface) {
        ping->intensity_lin[ASDIC_SURFACE][at] =
            laws->source_lin * boundary_energy(surface, begin_m, end_m, &area_m2[1]);
    }
    ping->intensity_lin[ASDIC_VOLUME][at] =
        laws->source_lin * volume_energy(bottom, begin_m, end_m);
}

asdic_status asdic_errata_beam(asdic_context *ctx, const asdic_flat_laws *laws,
                               const asdic_sonar *sonar, const asdic_ring *ring, unsigned errata,
                               asdic_ping *ping, size_t beam) {
    asdic_errata_sphere *sphere = NULL;
    asdic_ring_profile *profile = NULL;
    asdic_status status = asdic_ring_profile_create(ctx, ring, &profile);
    if (status == ASDIC_OK && errata & SPHERE_ERRATA) {
        status = asdic_errata_sphere_create(ctx, &laws->flat, ring, errata, &sphere);
    }
    double cell_m = laws->water.sound_speed_mps / (2.0 * sonar->bandwidth_hz);
    double length_m = sonar->bin_length_m, area_m2[2] = {0.0, 0.0};
    variant bottom = {laws, ring, profile, sphere, errata, laws->flat.altitude_m, false};
    variant surface = {laws, ring, profile, sphere, errata, laws->flat.depth_m, true};
    for (size_t n = 0; n < ping->bins && status == ASDIC_OK; n++) {
        double begin = fmax((double)n * length_m, sonar->blanking_m);
        double end = (double)(n + 1) * length_m;
        if (errata & ASDIC_ERRATUM_REMAINDER) { /* whole cells only */
            end = (double)n * length_m + floor(length_m / cell_m + 1e-9) * cell_m;
        }
        if (end > begin) {
            add_bin(&bottom, &surface, begin, end, area_m2, ping, beam * ping->bins + n);
        }
    }
    asdic_errata_sphere_destroy(&sphere);
    asdic_ring_profile_destroy(&profile);
    return status;
}
