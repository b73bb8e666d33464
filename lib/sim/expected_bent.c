/*
 * The expected ping in water that bends rays. With e the elevation at launch, t the travel time one
 * way, d = c_s t the range that bins count, L the length of the path, S the spreading, gamma the
 * grazing angle, c the sound speed (c_s at the sonar, c_b where the ray ends) and G(e) the two-way
 * pattern summed around the ring of elevation e, a ray that ends on bottom or surface gives
 *
 *     dE = G(e) s(gamma) exp(-2 K (L - 1)) c_b / (c_s S sin gamma)  cos e de
 *
 * (dA = S c_b / c_s cos e de dphi / sin gamma, two-way loss S^-2), and the water on its way
 *
 *     dE = G(e) s_V exp(-2 K (L - 1)) (c / c_s)^2 / S  dd cos e de .
 *
 * In water of one speed S = d^2, and both are the integrals of expected.c. Rays are integrated over e
 * between the angles at which they graze a plane, with cuts where they end on a bin's edge or at a knot of
 * its scattering law and where they meet a caustic. A ray ends at the first boundary.
 */
#include "expected.h"

#include "base/context.h"
#include "base/grow.h"
#include "base/quadrature.h"
#include "base/sort.h"
#include "base/try.h"
#include "bent_ray.h"

#include <math.h>
#include <stdlib.h>

/* Steps in which a stretch between critical angles is searched for bins' edges and caustics. */
#define SEARCH 128

/* Phases of a two-way pattern, in cycles, that sixteen nodes hold, and four. */
#define CYCLES16 0.8
#define CYCLES4 0.02

/* What rises by more within a bin, as between two knots of a curve, takes more than four nodes. */
#define STEEP 2.0

#define HALVINGS 10

/* Share of its range, and change of its width's logarithm, in which two nodes hold the water of a bin to 1e-8:
 * (1 / 4320) h^4 f'''' of f = d^-4 in h = 0.03 d. */
#define SHORT 0.03

/* How fine a ping is computed. */
typedef struct fineness {
    double kink;   /* share by which sixteen nodes may differ from twice as many */
    double widest; /* panel of a stretch: what the water gives changes by where rays turn ... */
    double widest_free; /* ... and, of rays that end nowhere, by which caustics a bin holds */
    double few_widest, few_cycles; /* panels and phases that four nodes hold, narrow panels apart */
} fineness;

static const fineness exact = {1e-5, 0.015, 0.006, 0.0, 0.0};
static const fineness quick = {1e-3, 1.0, 0.048, 0.5, 0.1};

typedef enum ray_end { ENDS_NOWHERE, ENDS_ON_BOTTOM, ENDS_ON_SURFACE } ray_end;

typedef enum panel_kind { PANEL_WIDE, PANEL_NARROW, PANEL_FREE } panel_kind;

/* Where a ray ends within the range of the bins. */
typedef struct ray_outcome {
    ray_end end;
    double range_m; /* INFINITY: nowhere */
    asdic_bent_ray ray;
    bool crosses_caustic; /* before the last bin, or where it ends */
} ray_outcome;

typedef struct bent_job {
    const asdic_flat_laws *laws;
    const asdic_sonar *sonar;
    asdic_layers layers; /* between the boundaries */
    double depth_m, speed_mps, absorption_np_per_m, range_m;
    double cycles; /* of the two-way pattern that turns fastest, per radian */
    const fineness *fine;
    asdic_ring_profile *const *profiles;
    asdic_ping *ping;
    double *row;        /* volume of each bin along one ray */
    size_t first, last; /* bins of it in use */
} bent_job;

/* ---- One ray ---- */

/* A stretch of a ray within one layer, from where RAY is, at range BEFORE_M. */
typedef struct water_part {
    const bent_job *job;
    const asdic_bent_ray *ray;
    double before_m;
} water_part;

static asdic_bent_ray ray_at(const water_part *part, double range_m) {
    return asdic_bent_ray_later(&part->job->layers, part->ray,
                                (range_m - part->before_m) / part->job->speed_mps);
}

/* What the water gives at a range, per metre of it. */
static double water_density(const water_part *part, double range_m) {
    const bent_job *job = part->job;
    asdic_bent_ray at = ray_at(part, range_m);
    double spread = asdic_bent_ray_limited_m2(&at, range_m);
    double speed = at.speed_mps / job->speed_mps;
    return speed * speed * exp(-2.0 * job->absorption_np_per_m * (at.length_m - 1.0)) / spread;
}

/* Node I of 2, 4 or 16 on [0, 1], and its weight. */
static double gauss(int i, int nodes, double *weight) {
    static const double node2[1] = {0.577350269189625765}, weight2[1] = {1.0};
    static const double node4[2] = {0.339981043584856265, 0.861136311594052575};
    static const double weight4[2] = {0.652145154862546143, 0.347854845137453857};
    const double *node = nodes == 2 ? node2 : nodes == 4 ? node4 : asdic_gauss16_node;
    const double *weights = nodes == 2 ? weight2 : nodes == 4 ? weight4 : asdic_gauss16_weight;
    double sign = i % 2 ? 0.5 : -0.5;
    *weight = 0.5 * weights[i / 2];
    return 0.5 + sign * node[i / 2];
}

/* From A to B, in y = 1 / d, in which straight water is even. */
static double even_water(const water_part *part, double a, double b, int nodes) {
    double y0 = 1.0 / b, length = 1.0 / a - y0, sum = 0.0;
    for (int i = 0; i < nodes; i++) {
        double weight, d = 1.0 / (y0 + length * gauss(i, nodes, &weight));
        sum += weight * d * d * water_density(part, d);
    }
    return sum * length;
}

/* From A to B, in the logarithm of the width, which goes from WIDTH_A to WIDTH_B: what falls as 1 / W is
 * even in it. */
static double focused_water(const water_part *part, double a, double b, double width_a,
                            double width_b) {
    double length = log(width_b / width_a), slope = (b - a) / (width_b - width_a), sum = 0.0;
    if (fabs(length) < 0.1 || !isfinite(length)) {
        bool is_short = fabs(length) < SHORT && b < (1.0 + SHORT) * a;
        return even_water(part, a, b, is_short ? 2 : 4);
    }
    for (int i = 0; i < 16; i++) {
        double weight, width = width_a * exp(length * gauss(i, 16, &weight));
        sum += weight * fabs(width) * water_density(part, a + slope * (width - width_a));
    }
    return fabs(sum * length * slope);
}

/* Range between A and B at which the width is 0. */
static double find_focus(const water_part *part, double a, double b, double width_a,
                         double width_b) {
    double middle = a;
    for (int i = 0; i < 30 && b - a > 1e-9 * b; i++) {
        double share = i % 3 == 2 ? 0.5 : width_a / (width_a - width_b);
        middle = a + share * (b - a);
        double width = ray_at(part, middle).width_m;
        if (fabs(width) < 1e-7 * middle) {
            break;
        }
        if ((width > 0.0) == (width_a > 0.0)) {
            a = middle;
            width_a = width;
        } else {
            b = middle;
            width_b = width;
        }
    }
    return middle;
}

/* From A to B, with cuts where a caustic begins and ceases to be held. */
static double water(const water_part *part, double a, double b, double width_a, double width_b) {
    if (width_a * width_b > 0.0) {
        return focused_water(part, a, b, width_a, width_b);
    }
    double focus = find_focus(part, a, b, width_a, width_b);
    asdic_bent_ray at = ray_at(part, focus);
    double slope = (width_b - width_a) / (b - a);
    double held =
        ASDIC_LEAST_SPREAD * focus * focus * at.speed_mps / at.area_m2_per_s / fabs(slope);
    double begin = fmax(focus - held, a), end = fmin(focus + held, b);
    return (begin > a ? focused_water(part, a, begin, width_a, slope * (begin - focus)) : 0.0) +
           even_water(part, begin, end, 4) +
           (end < b ? focused_water(part, end, b, slope * (end - focus), width_b) : 0.0);
}

/* Adds what the water gives on RAY's way from BEGIN_M to END_M, within its layer, to the row. */
static void add_water(bent_job *job, const asdic_bent_ray *ray, double begin_m, double end_m) {
    const asdic_sonar *sonar = job->sonar;
    water_part part = {job, ray, begin_m};
    double at = fmax(begin_m, sonar->blanking_m), bin_m = sonar->bin_length_m;
    end_m = fmin(end_m, job->range_m);
    size_t n = (size_t)(at / bin_m);
    double width = ray_at(&part, at).width_m;
    for (; n < job->ping->bins && at < end_m; n++) {
        double next = fmin((double)(n + 1) * bin_m, end_m);
        if (next > at) {
            job->first = n < job->first ? n : job->first;
            job->last = n > job->last ? n : job->last;
            double width_next = ray_at(&part, next).width_m;
            job->row[n] += water(&part, at, next, width, width_next);
            at = next;
            width = width_next;
        }
    }
}

/* Follows the ray of ELEVATION_RAD to its end or the last bin's; WITH_WATER adds to the row. */
static ray_outcome follow(bent_job *job, double elevation_rad, bool with_water) {
    asdic_bent_ray ray = asdic_bent_ray_start(&job->layers, job->depth_m, elevation_rad);
    bool crosses = false;
    for (;;) {
        int way;
        double time_s = asdic_bent_ray_exit(&job->layers, &ray, &way);
        double begin_m = job->speed_mps * ray.time_s;
        double end_m = begin_m + job->speed_mps * time_s;
        if (with_water) {
            add_water(job, &ray, begin_m, end_m);
        }
        if (!(end_m < job->range_m)) {
            double rest_s = (job->range_m - begin_m) / job->speed_mps;
            crosses |= asdic_bent_ray_later(&job->layers, &ray, rest_s).width_m < 0.0;
            return (ray_outcome){ENDS_NOWHERE, INFINITY, ray, crosses};
        }
        ray = asdic_bent_ray_at_plane(&job->layers, &ray, time_s, way);
        crosses |= ray.width_m < 0.0;
        if (!asdic_bent_ray_cross(&job->layers, &ray, way)) {
            ray_end end = way > 0 ? ENDS_ON_BOTTOM : ENDS_ON_SURFACE;
            return (ray_outcome){end, end_m, ray, crosses};
        }
    }
}

/* ---- Stretches of elevation ---- */

/* Elevation is a cosine of the position s in [0, 1], so that what goes as the root of the distance from
 * an end, as the grazing angle does, is smooth. SHARE is how much of the positions between the critical
 * angles around it a stretch takes: water and boundaries are as even in it as in a whole one of so few. */
typedef struct stretch {
    double begin_rad, end_rad, share;
} stretch;

static double elevation_at(const stretch *w, double s) {
    double half = sin(0.5 * ASDIC_PI * s);
    return w->begin_rad + (w->end_rad - w->begin_rad) * half * half;
}

static double position_of(const stretch *w, double elevation_rad) {
    double along = (elevation_rad - w->begin_rad) / (w->end_rad - w->begin_rad);
    return 2.0 / ASDIC_PI * asin(sqrt(fmin(fmax(along, 0.0), 1.0)));
}

static double slope_at(const stretch *w, double s) {
    return 0.5 * (w->end_rad - w->begin_rad) * ASDIC_PI * sin(ASDIC_PI * s);
}

/* What the end of a ray gives per cos e de and G(e). */
static double boundary(const bent_job *job, const ray_outcome *out) {
    if (out->end == ENDS_NOWHERE || out->range_m < job->sonar->blanking_m) {
        return 0.0;
    }
    const asdic_bent_ray *ray = &out->ray;
    double grazing = fmin(fmax(fabs(ray->sine), 1e-9), 1.0);
    double spread = asdic_bent_ray_limited_m2(ray, out->range_m);
    double strength = asdic_flat_strength(job->laws, out->end == ENDS_ON_SURFACE, grazing);
    double loss = exp(-2.0 * job->absorption_np_per_m * (ray->length_m - 1.0));
    return strength * loss * ray->speed_mps / (job->speed_mps * spread * grazing);
}

/* One ray of weight cos e de WEIGHT: its water and its end, to every beam. */
static void add_ray(bent_job *job, double elevation_rad, double weight) {
    size_t bins = job->ping->bins, bin = bins;
    job->first = bins;
    job->last = 0;
    ray_outcome out = follow(job, elevation_rad, true);
    double level = boundary(job, &out);
    asdic_component component = out.end == ENDS_ON_SURFACE ? ASDIC_SURFACE : ASDIC_BOTTOM;
    if (level > 0.0) { /* what ends on a bin's edge is not to fall short of it by rounding */
        bin = (size_t)(out.range_m * (1.0 + 1e-12) / job->sonar->bin_length_m);
    }
    for (size_t b = 0; b < job->ping->beams; b++) {
        double share = job->laws->source_lin * weight *
                       asdic_ring_profile_sum(job->profiles[b], elevation_rad);
        double *volume = job->ping->intensity_lin[ASDIC_VOLUME] + b * bins;
        for (size_t n = job->first; n <= job->last && n < bins; n++) {
            volume[n] += share * job->laws->volume_lin * job->row[n];
        }
        if (bin < bins) {
            job->ping->intensity_lin[component][b * bins + bin] += share * level;
        }
    }
    for (size_t n = job->first; n <= job->last && n < bins; n++) {
        job->row[n] = 0.0;
    }
}

/* What the ends of the rays from S0 to S1 give without the beams. */
static double ends(bent_job *job, const stretch *w, double s0, double s1) {
    double sum = 0.0;
    for (int i = 0; i < 16; i++) {
        double weight, s = s0 + (s1 - s0) * gauss(i, 16, &weight);
        ray_outcome out = follow(job, elevation_at(w, s), false);
        sum += weight * slope_at(w, s) * boundary(job, &out);
    }
    return sum * (s1 - s0);
}

static void add_nodes(bent_job *job, const stretch *w, double s0, double s1, int nodes) {
    for (int i = 0; i < nodes; i++) {
        double weight, s = s0 + (s1 - s0) * gauss(i, nodes, &weight);
        double elevation = elevation_at(w, s);
        add_ray(job, elevation, weight * (s1 - s0) * slope_at(w, s) * cos(elevation));
    }
}

/* Rays of positions S0 to S1, which end in one bin, or nowhere. WIDE panels, of bins that are not short
 * beside their range, are halved where scattering laws have kinks, at most DEPTH times. */
static void add_panel(bent_job *job, const stretch *w, double s0, double s1, panel_kind kind,
                      int depth) {
    double phase = job->cycles * fabs(elevation_at(w, s1) - elevation_at(w, s0));
    double middle = 0.5 * (s0 + s1);
    const fineness *fine = job->fine;
    double widest = kind == PANEL_FREE ? fine->widest_free : fine->widest;
    double width = (s1 - s0) * w->share;
    bool halves = phase > CYCLES16 || width > widest;
    if (!halves && kind == PANEL_WIDE && depth > 0) {
        double both = ends(job, w, s0, middle) + ends(job, w, middle, s1);
        halves = fabs(ends(job, w, s0, s1) - both) > fine->kink * both;
    }
    if (halves) {
        add_panel(job, w, s0, middle, kind, depth - 1);
        add_panel(job, w, middle, s1, kind, depth - 1);
    } else {
        bool few = kind == PANEL_NARROW ? phase <= CYCLES4
                                        : kind == PANEL_WIDE && width <= fine->few_widest &&
                                              phase <= fine->few_cycles;
        add_nodes(job, w, s0, s1, few ? 4 : 16);
    }
}

/* ---- Where panels end ---- */

typedef struct cut_list {
    double *s;
    size_t count, capacity;
} cut_list;

/* Whether the ray at S is beyond what is looked for: a range, or, for NAN, a caustic. */
static bool is_beyond(bent_job *job, const stretch *w, double s, double range_m) {
    ray_outcome out = follow(job, elevation_at(w, s), false);
    return isnan(range_m) ? out.ray.width_m > 0.0 : out.range_m > range_m;
}

static asdic_status append(asdic_context *ctx, cut_list *cuts, double s) {
    if (!asdic_grow(&cuts->s, cuts->count, &cuts->capacity, sizeof *cuts->s)) {
        return asdic_fail_memory(ctx, "an expected ping");
    }
    cuts->s[cuts->count++] = s;
    return ASDIC_OK;
}

/* The position between A and B at which is_beyond changes. */
static double find(bent_job *job, const stretch *w, double a, double b, double range_m) {
    bool at_a = is_beyond(job, w, a, range_m);
    for (int i = 0; i < 40 && fabs(b - a) > 1e-12; i++) {
        double middle = 0.5 * (a + b);
        if (is_beyond(job, w, middle, range_m) == at_a) {
            a = middle;
        } else {
            b = middle;
        }
    }
    return 0.5 * (a + b);
}

/* Every edge of a bin between the ranges at which the rays of A and B end, A's to B's. */
static asdic_status cut_at_bins(asdic_context *ctx, bent_job *job, const stretch *w, double a,
                                double b, cut_list *cuts) {
    double range_a = follow(job, elevation_at(w, a), false).range_m;
    double range_b = follow(job, elevation_at(w, b), false).range_m;
    double near = fmin(range_a, range_b), far = fmin(fmax(range_a, range_b), job->range_m);
    double bin_m = job->sonar->bin_length_m, blanking_m = job->sonar->blanking_m;
    if (!(near < far)) {
        return ASDIC_OK;
    }
    if (near < blanking_m && blanking_m < far) {
        TRY(append(ctx, cuts, find(job, w, a, b, blanking_m)));
    }
    for (double n = floor(near / bin_m) + 1.0; n * bin_m < far; n += 1.0) {
        if (n * bin_m > blanking_m) {
            double s = find(job, w, a, b, n * bin_m);
            TRY(append(ctx, cuts, s));
        }
    }
    if (isinf(fmax(range_a, range_b))) { /* the last bin's end */
        TRY(append(ctx, cuts, find(job, w, a, b, far * (1.0 - 1e-15))));
    }
    return ASDIC_OK;
}

/* In water of many layers a stretch takes long. */
static asdic_status go_on(asdic_context *ctx) {
    return asdic_context_interrupted(ctx)
               ? asdic_fail(ctx, ASDIC_ERROR_INTERRUPTED, "interrupted while rays were bent")
               : ASDIC_OK;
}

/* Where rays meet the plane PLANE_M deep at an angle at which its LAW has a knot: by Snell's law whatever their way. */
static asdic_status cut_at_knots(asdic_context *ctx, const bent_job *job, const stretch *w,
                                 const asdic_scatterer *law, double plane_m, cut_list *cuts) {
    double slower = job->speed_mps / asdic_layers_speed_mps(&job->layers, plane_m), deg;
    for (size_t i = 0; deg = asdic_scatterer_knot_deg(law, i), !isnan(deg); i++) {
        double elevation = acos(slower * cos(deg * (ASDIC_PI / 180.0))); /* NAN: none does */
        for (int side = -1; side <= 1; side += 2) {
            if (side * elevation > w->begin_rad && side * elevation < w->end_rad) {
                TRY(append(ctx, cuts, position_of(w, side * elevation)));
            }
        }
    }
    return ASDIC_OK;
}

static asdic_status find_cuts(asdic_context *ctx, bent_job *job, const stretch *w, cut_list *cuts) {
    const asdic_flat_scene *flat = &job->laws->flat;
    int steps = (int)ceil(SEARCH * w->share);
    double before_s = 1e-5;
    ray_outcome before = follow(job, elevation_at(w, before_s), false);
    cuts->count = 0;
    TRY(append(ctx, cuts, 0.0));
    for (int i = 1; i <= steps; i++) {
        double s = i == steps ? 1.0 - 1e-5 : (double)i / steps;
        TRY(go_on(ctx));
        ray_outcome here = follow(job, elevation_at(w, s), false);
        bool folds = before.end != ENDS_NOWHERE && here.end == before.end &&
                     (before.ray.width_m > 0.0) != (here.ray.width_m > 0.0);
        if (folds) {
            double fold = find(job, w, before_s, s, NAN);
            TRY(append(ctx, cuts, fold));
            TRY(cut_at_bins(ctx, job, w, before_s, fold, cuts));
            TRY(cut_at_bins(ctx, job, w, fold, s, cuts));
        } else {
            TRY(cut_at_bins(ctx, job, w, before_s, s, cuts));
        }
        before = here;
        before_s = s;
    }
    if (flat->has_bottom) {
        TRY(cut_at_knots(ctx, job, w, &job->laws->bottom, flat->depth_m + flat->altitude_m, cuts));
    }
    if (flat->has_surface) {
        TRY(cut_at_knots(ctx, job, w, &job->laws->surface, 0.0, cuts));
    }
    TRY(append(ctx, cuts, 1.0));
    asdic_sort_doubles(cuts->s, cuts->count);
    return ASDIC_OK;
}

/* Whether what the ends of the rays from S0 to S1 give changes so little that four nodes hold it. */
static bool is_even(bent_job *job, const stretch *w, double s0, double s1) {
    ray_outcome a = follow(job, elevation_at(w, s0 + 0.01 * (s1 - s0)), false);
    ray_outcome b = follow(job, elevation_at(w, s1 - 0.01 * (s1 - s0)), false);
    double at_a = boundary(job, &a), at_b = boundary(job, &b);
    return at_a <= STEEP * at_b && at_b <= STEEP * at_a;
}

static panel_kind kind_of(bent_job *job, const stretch *w, double s0, double s1) {
    ray_outcome middle = follow(job, elevation_at(w, 0.5 * (s0 + s1)), false);
    if (middle.end != ENDS_NOWHERE) {
        bool narrow = (s1 - s0) * w->share < 0.5 / SEARCH &&
                      middle.range_m > 8.0 * job->sonar->bin_length_m && is_even(job, w, s0, s1);
        return narrow ? PANEL_NARROW : PANEL_WIDE;
    }
    for (int i = 0; i <= 16; i++) {
        double s = s0 + (s1 - s0) * (0.001 + 0.998 / 16.0 * i);
        if (follow(job, elevation_at(w, s), false).crosses_caustic) {
            return PANEL_FREE;
        }
    }
    return PANEL_WIDE;
}

static asdic_status add_stretch(asdic_context *ctx, bent_job *job, const stretch *w,
                                cut_list *cuts) {
    TRY(find_cuts(ctx, job, w, cuts));
    for (size_t i = 0; i + 1 < cuts->count; i++) {
        double s0 = cuts->s[i], s1 = cuts->s[i + 1];
        TRY(go_on(ctx));
        if (s1 - s0 > 1e-13) {
            add_panel(job, w, s0, s1, kind_of(job, w, s0, s1), HALVINGS);
        }
    }
    return ASDIC_OK;
}

/* ---- All rays ---- */

/* Elevations at which rays change their course, horizontal or grazing a plane, ascending. */
#define MOST_EDGES (4 * (ASDIC_PROFILE_POINTS + 1) + 3)

/* Kinks nearer each other count as one: they are many only where beams are, narrow ones, whose sums are
 * small there. */
#define KINK_GAP_RAD 0.005
#define MOST_KINKS 640 /* pi / KINK_GAP_RAD */

static void add_edge(double *edges, size_t *count, double edge, double gap) {
    for (size_t i = 0; i < *count; i++) {
        if (fabs(edges[i] - edge) < gap) {
            return;
        }
    }
    edges[(*count)++] = edge;
}

/* How deep or high rays come before the end of the last bin. */
static double find_reach(const bent_job *job) {
    double fastest = job->speed_mps;
    for (size_t i = 0; i < job->layers.count; i++) {
        const asdic_layer *layer = &job->layers.layer[i];
        for (int k = 0; k < 2; k++) {
            double plane = k ? layer->bottom_m : layer->top_m;
            double speed = isfinite(plane) ? asdic_layer_speed_mps(layer, plane) : 0.0;
            fastest = fmax(fastest, speed);
        }
    }
    return job->range_m * fastest / job->speed_mps;
}

/* Of a plane that is within REACH_M. */
static void add_grazing(const bent_job *job, double depth_m, const asdic_layer *layer,
                        double reach_m, double *edges, size_t *count) {
    bool is_near = fabs(depth_m - job->depth_m) <= reach_m;
    double speed = is_near ? asdic_layer_speed_mps(layer, depth_m) : 0.0;
    if (speed > job->speed_mps) {
        double ratio = job->speed_mps / speed;
        double edge = atan2(sqrt((1.0 - ratio) * (1.0 + ratio)), ratio);
        add_edge(edges, count, edge, 1e-9);
        add_edge(edges, count, -edge, 1e-9);
    }
}

static size_t find_edges(const bent_job *job, double *edges) {
    size_t count = 3;
    edges[0] = -0.5 * ASDIC_PI;
    edges[1] = 0.0;
    edges[2] = 0.5 * ASDIC_PI;
    double reach_m = find_reach(job);
    for (size_t i = 0; i < job->layers.count; i++) {
        const asdic_layer *layer = &job->layers.layer[i];
        add_grazing(job, layer->top_m, layer, reach_m, edges, &count);
        add_grazing(job, layer->bottom_m, layer, reach_m, edges, &count);
    }
    asdic_sort_doubles(edges, count);
    return count;
}

static size_t find_kinks(const bent_job *job, const asdic_ring *rings, double *kinks) {
    size_t count = 0;
    for (size_t b = 0; b < job->ping->beams; b++) {
        double rad[4];
        size_t found = asdic_ring_kinks(&rings[b], rad);
        for (size_t i = 0; i < found; i++) {
            add_edge(kinks, &count, rad[i], KINK_GAP_RAD);
        }
    }
    asdic_sort_doubles(kinks, count);
    return count;
}

static asdic_status integrate(asdic_context *ctx, bent_job *job, const asdic_ring *rings) {
    double edges[MOST_EDGES], kinks[MOST_KINKS];
    size_t count = find_edges(job, edges), kink_count = find_kinks(job, rings, kinks), k = 0;
    cut_list cuts = {0};
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; i + 1 < count && status == ASDIC_OK; i++) {
        stretch whole = {edges[i], edges[i + 1], 1.0}, w = whole;
        while (w.begin_rad < whole.end_rad && status == ASDIC_OK) {
            while (k < kink_count && kinks[k] < w.begin_rad + 1e-9) {
                k++;
            }
            bool ends = k == kink_count || kinks[k] > whole.end_rad - 1e-9;
            w.end_rad = ends ? whole.end_rad : kinks[k];
            w.share = position_of(&whole, w.end_rad) - position_of(&whole, w.begin_rad);
            status = add_stretch(ctx, job, &w, &cuts);
            w.begin_rad = w.end_rad;
        }
    }
    free(cuts.s);
    return status;
}

asdic_status asdic_expected_bent(asdic_context *ctx, const asdic_flat_laws *laws,
                                 const asdic_environment *env, const asdic_sonar *sonar,
                                 const asdic_bent_view *view, asdic_ping *ping) {
    const asdic_flat_scene *flat = &laws->flat;
    bent_job job = {.laws = laws,
                    .sonar = sonar,
                    .depth_m = flat->depth_m,
                    .speed_mps = laws->water.sound_speed_mps,
                    .absorption_np_per_m = laws->water.absorption_np_per_m,
                    .range_m = (double)ping->bins * sonar->bin_length_m,
                    .ping = ping,
                    .fine = view->is_quick ? &quick : &exact,
                    .profiles = view->profiles,
                    .row = calloc(ping->bins, sizeof *job.row)};
    asdic_layers_between(env, flat, &job.layers);
    for (size_t i = 0; i < ping->beams; i++) {
        job.cycles = fmax(job.cycles, asdic_ring_cycles(&view->rings[i]));
    }
    asdic_status status =
        job.row ? integrate(ctx, &job, view->rings) : asdic_fail_memory(ctx, "an expected ping");
    free(job.row);
    return status;
}
