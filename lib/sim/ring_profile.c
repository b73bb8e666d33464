#include "ring_profile.h"

#include "base/context.h"
#include "base/grow.h"
#include "base/try.h"

#include <stdlib.h>

#define TERMS 24
#define DEEPEST 6
/* A series has converged when its last terms are this small beside the largest. */
#define CONVERGED 1e-8
/* TERMS terms hold this many cycles of a two-way pattern. */
#define CYCLES 4.0
/* Below this share of a piece's largest value the series is too coarse: the ring itself is summed. */
#define NULL_SHARE 1e-4

/* One stretch between kinks. Elevation is a cosine of the position s in [0, 1]: a square-root kink at
 * an end becomes smooth. */
typedef struct stretch {
    double begin_rad, end_rad;
} stretch;

/* Chebyshev series in s of the sum, and of its integral from the piece's begin. */
typedef struct piece {
    size_t stretch;
    double s0, s1;
    double sum[TERMS], integral[TERMS + 1];
    double before;  /* integral up to the piece's begin */
    double largest; /* of the sum at the nodes */
} piece;

struct asdic_ring_profile {
    asdic_ring ring;
    stretch stretches[5];
    size_t stretch_count;
    double cosines[4 * TERMS]; /* of pi i / (2 TERMS) */
    piece *pieces;
    size_t count, capacity;
    double lower_rad; /* than the ring that was summed */
};

static double elevation_at(const stretch *w, double s) {
    return w->begin_rad + 0.5 * (w->end_rad - w->begin_rad) * (1.0 - cos(ASDIC_PI * s));
}

static double position_of(const stretch *w, double elevation_rad) {
    double share = (elevation_rad - w->begin_rad) / (w->end_rad - w->begin_rad);
    return 2.0 / ASDIC_PI * asin(sqrt(fmin(fmax(share, 0.0), 1.0)));
}

/* The TERMS nodes of a Chebyshev series, cos(pi (k + 1/2) / TERMS), and all that a transform needs. */
static void find_cosines(double cosines[4 * TERMS]) {
    for (int i = 0; i < 4 * TERMS; i++) {
        cosines[i] = cos(0.5 * ASDIC_PI * i / TERMS);
    }
}

static double node_at(const asdic_ring_profile *p, int k) {
    return p->cosines[2 * k + 1];
}

/* Chebyshev coefficients from values at the nodes. */
static void transform(const asdic_ring_profile *p, const double *values, double *coefficients) {
    for (int j = 0; j < TERMS; j++) {
        double sum = 0.0;
        for (int k = 0; k < TERMS; k++) {
            sum += values[k] * p->cosines[j * (2 * k + 1) % (4 * TERMS)];
        }
        coefficients[j] = sum * (j ? 2.0 : 1.0) / TERMS;
    }
}

/* Antiderivative over x in [-1, 1], zero at -1, times SCALE. */
static void integrate(const double *c, double scale, double *out) {
    for (int j = 1; j <= TERMS; j++) {
        double lower = j == 1 ? 2.0 * c[0] : c[j - 1];
        double upper = j + 1 < TERMS ? c[j + 1] : 0.0;
        out[j] = scale * (lower - upper) / (2.0 * j);
    }
    out[0] = 0.0;
    for (int j = 1; j <= TERMS; j++) {
        out[0] += j % 2 ? out[j] : -out[j];
    }
}

static double evaluate(const double *c, int terms, double x) {
    double b1 = 0.0, b2 = 0.0;
    for (int j = terms - 1; j > 0; j--) {
        double b = 2.0 * x * b1 - b2 + c[j];
        b2 = b1;
        b1 = b;
    }
    return x * b1 - b2 + c[0];
}

static bool converged(const double *c) {
    double largest = 0.0;
    for (int j = 0; j < TERMS; j++) {
        largest = fmax(largest, fabs(c[j]));
    }
    double tail = fabs(c[TERMS - 1]) + fabs(c[TERMS - 2]) + fabs(c[TERMS - 3]);
    return tail <= CONVERGED * largest;
}

static asdic_status append(asdic_context *ctx, asdic_ring_profile *p, const piece *add) {
    if (!asdic_grow(&p->pieces, p->count, &p->capacity, sizeof *p->pieces)) {
        return asdic_fail_memory(ctx, "the profile of a beam");
    }
    p->pieces[p->count++] = *add;
    return ASDIC_OK;
}

/* Appends [S0, S1] of a stretch, halved until its series has converged. */
static asdic_status fit(asdic_context *ctx, asdic_ring_profile *p, size_t at, double s0, double s1,
                        int depth) {
    const stretch *w = &p->stretches[at];
    double sum[TERMS], solid[TERMS], series[TERMS];
    piece add = {.stretch = at, .s0 = s0, .s1 = s1};
    for (int k = 0; k < TERMS; k++) {
        double s = 0.5 * (s0 + s1) + 0.5 * (s1 - s0) * node_at(p, k);
        double e = elevation_at(w, s);
        double slope = 0.5 * (w->end_rad - w->begin_rad) * ASDIC_PI * sin(ASDIC_PI * s);
        sum[k] = asdic_ring_sum(&p->ring, e);
        solid[k] = sum[k] * cos(e) * slope;
        add.largest = fmax(add.largest, sum[k]);
    }
    transform(p, sum, add.sum);
    if (!converged(add.sum) && depth < DEEPEST) {
        double middle = 0.5 * (s0 + s1);
        TRY(fit(ctx, p, at, s0, middle, depth + 1));
        return fit(ctx, p, at, middle, s1, depth + 1);
    }
    transform(p, solid, series);
    integrate(series, 0.5 * (s1 - s0), add.integral);
    if (p->count) {
        const piece *last = &p->pieces[p->count - 1];
        add.before = last->before + evaluate(last->integral, TERMS + 1, 1.0);
    }
    return append(ctx, p, &add);
}

static void find_stretches(asdic_ring_profile *p) {
    double edges[6] = {-0.5 * ASDIC_PI};
    size_t kinks = asdic_ring_kinks(&p->ring, edges + 1);
    edges[kinks + 1] = 0.5 * ASDIC_PI;
    for (size_t i = 0; i <= kinks; i++) {
        if (edges[i + 1] - edges[i] > 1e-9) { /* faces aimed alike share their kinks */
            p->stretches[p->stretch_count++] = (stretch){edges[i], edges[i + 1]};
        }
    }
}

static asdic_status fit_all(asdic_context *ctx, asdic_ring_profile *p) {
    for (size_t i = 0; i < p->stretch_count; i++) {
        const stretch *w = &p->stretches[i];
        /* Elevation changes with the position by up to pi / 2 times the stretch. */
        double cycles = asdic_ring_cycles(&p->ring) * 0.5 * ASDIC_PI * (w->end_rad - w->begin_rad);
        size_t cuts = 1 + (size_t)(cycles / CYCLES);
        for (size_t j = 0; j < cuts; j++) {
            TRY(fit(ctx, p, i, (double)j / (double)cuts, (double)(j + 1) / (double)cuts, 0));
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_ring_profile_create(asdic_context *ctx, const asdic_ring *ring,
                                       asdic_ring_profile **out) {
    asdic_ring_profile *p = calloc(1, sizeof *p);
    *out = NULL;
    if (!p) {
        return asdic_fail_memory(ctx, "the profile of a beam");
    }
    p->ring = *ring;
    find_cosines(p->cosines);
    find_stretches(p);
    asdic_status status = fit_all(ctx, p);
    if (status) {
        asdic_ring_profile_destroy(&p);
    }
    *out = p;
    return status;
}

void asdic_ring_profile_destroy(asdic_ring_profile **profile) {
    if (profile && *profile) {
        free((*profile)->pieces);
        free(*profile);
        *profile = NULL;
    }
}

void asdic_ring_profile_lower(asdic_ring_profile *profile, double lower_rad) {
    profile->lower_rad = lower_rad;
}

/* The piece that holds ELEVATION_RAD, and the position in it, [-1, 1]. */
static const piece *find_piece(const asdic_ring_profile *p, double elevation_rad, double *x) {
    size_t at = 0;
    while (at + 1 < p->stretch_count && elevation_rad > p->stretches[at].end_rad) {
        at++;
    }
    double s = position_of(&p->stretches[at], elevation_rad);
    size_t low = 0, high = p->count - 1;
    while (low < high) {
        size_t middle = (low + high) / 2;
        const piece *m = &p->pieces[middle];
        if (m->stretch < at || (m->stretch == at && m->s1 < s)) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    const piece *found = &p->pieces[low];
    *x = (2.0 * s - found->s0 - found->s1) / (found->s1 - found->s0);
    return found;
}

double asdic_ring_profile_sum(const asdic_ring_profile *profile, double elevation_rad) {
    double x;
    elevation_rad -= profile->lower_rad;
    const piece *found = find_piece(profile, elevation_rad, &x);
    double sum = evaluate(found->sum, TERMS, x);
    return sum > NULL_SHARE * found->largest ? sum : asdic_ring_sum(&profile->ring, elevation_rad);
}

double asdic_ring_profile_solid_angle(const asdic_ring_profile *profile, double elevation_rad) {
    double x;
    elevation_rad -= profile->lower_rad;
    const piece *found = find_piece(profile, elevation_rad, &x);
    return found->before + evaluate(found->integral, TERMS + 1, x);
}
