#include "roc_curve.h"

#include "law.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/try.h"
#include "sim/variates.h"

#include <math.h>
#include <stdlib.h>

#define DECADES 6
#define PER_DECADE 8
#define RARE_TRIALS 100000u
/* P_FA is counted where at least so many events are expected. */
#define LEAST_EVENTS 1000.0

/* Draws with the target use their own random numbers: they are not the draws without it plus an
 * echo. */
static uint64_t seed_of(uint64_t seed, bool present) {
    return present ? asdic_other_seed(seed) : seed;
}

/* Draws so many at a time, some 10 ms of work, between looks at whether to stop. */
#define DRAW_BLOCK ((size_t)1 << 16)

static asdic_status draw_blocks(asdic_context *ctx, const asdic_background *b, asdic_target target,
                                double target_lin, uint64_t seed, size_t trials, double *out) {
    for (size_t i = 0; i < trials; i += DRAW_BLOCK) {
        size_t count = trials - i < DRAW_BLOCK ? trials - i : DRAW_BLOCK;
        TRY(asdic_step(ctx, "draws", i, trials));
        asdic_detect_draw(b, target, target_lin, seed, i, count, out + i);
    }
    return ASDIC_OK;
}

static asdic_status draw(asdic_context *ctx, const asdic_roc_case *c,
                         const asdic_roc_options *options, asdic_roc *roc) {
    size_t trials = roc->trials;
    roc->none = malloc(2 * trials * sizeof *roc->none);
    if (!roc->none) {
        return asdic_fail_memory(ctx, "draws");
    }
    roc->present = roc->none + trials;
    double from_s = asdic_clock_s();
    TRY(draw_blocks(ctx, &c->none, options->target, 0.0, seed_of(options->seed, false), trials,
                    roc->none));
    TRY(draw_blocks(ctx, &c->rest, options->target, c->target_lin, seed_of(options->seed, true),
                    trials, roc->present));
    roc->draw_s = (asdic_clock_s() - from_s) / (2.0 * (double)trials) * 1e6;
    return ASDIC_OK;
}

static asdic_estimate count(const double *z, size_t trials, double threshold) {
    uint64_t events = 0;
    for (size_t i = 0; i < trials; i++) {
        events += z[i] > threshold;
    }
    return asdic_estimate_of(events, trials);
}

/* P_D at PFA with the means and the echo so many dB off. */
static asdic_status pd_with(asdic_context *ctx, const asdic_roc_case *c, asdic_target target,
                            double pfa, double background_db, double target_db, double *pd) {
    asdic_background none = c->none, rest = c->rest;
    double threshold, background = pow(10.0, 0.1 * background_db);
    none.noise_share = fmin(none.noise_share / background, 1.0);
    rest.noise_share = fmin(rest.noise_share / background, 1.0);
    none.mean_lin *= background;
    rest.mean_lin *= background;
    TRY(asdic_detect_threshold(ctx, &none, pfa, &threshold));
    *pd = asdic_detect_pd(&rest, target, pow(10.0, 0.1 * target_db) * c->target_lin, threshold);
    return ASDIC_OK;
}

asdic_status asdic_roc_band(asdic_context *ctx, const asdic_roc_case *c, asdic_target target,
                            double pfa, asdic_band *out) {
    *out = (asdic_band){NAN, NAN};
    if (c->background_most_db == 0.0 && c->target_error_db == 0.0) {
        return ASDIC_OK;
    }
    TRY(pd_with(ctx, c, target, pfa, c->background_most_db, -c->target_error_db, &out->low));
    return pd_with(ctx, c, target, pfa, c->background_least_db, c->target_error_db, &out->high);
}

static asdic_status add_point(asdic_context *ctx, const asdic_roc_case *c,
                              const asdic_roc_options *options, const asdic_rare_draw *rare,
                              asdic_roc *roc, double pfa) {
    double threshold;
    TRY(asdic_detect_threshold(ctx, &c->none, pfa, &threshold));
    bool is_rare = pfa * (double)roc->trials < LEAST_EVENTS;
    asdic_roc_point *p = &roc->points[roc->point_count++];
    p->design_pfa = pfa;
    p->threshold_db = asdic_level_db(threshold);
    p->pfa = is_rare ? asdic_rare_estimate(&c->none, threshold, rare, RARE_TRIALS)
                     : count(roc->none, roc->trials, threshold);
    p->pd = count(roc->present, roc->trials, threshold);
    p->closed_pd = asdic_detect_pd(&c->rest, options->target, c->target_lin, threshold);
    return asdic_roc_band(ctx, c, options->target, pfa, &p->model_pd);
}

static asdic_status add_points(asdic_context *ctx, const asdic_roc_case *c,
                               const asdic_roc_options *options, asdic_roc *roc) {
    asdic_status status = ASDIC_OK;
    asdic_rare_draw *rare = malloc(RARE_TRIALS * sizeof *rare); /* the same for every threshold */
    if (!rare) {
        return asdic_fail_memory(ctx, "draws");
    }
    for (size_t i = 0; i < RARE_TRIALS; i++) {
        rare[i] = asdic_rare_draw_one(&c->none, options->seed, i);
    }
    for (int i = 0; i <= DECADES * PER_DECADE && status == ASDIC_OK; i++) {
        double pfa = pow(10.0, (double)i / PER_DECADE - DECADES);
        status = asdic_step(ctx, "points", (size_t)i, DECADES * PER_DECADE + 1);
        status = status ? status : add_point(ctx, c, options, rare, roc, pfa);
    }
    free(rare);
    return status;
}

/* Integral of P_D over P_FA by Simpson's rule in u, ln P_FA = -60 (1 - u)^2: dense towards 1, and
 * where the curve is steep for strong targets. */
static asdic_status closed_area(asdic_context *ctx, const asdic_roc_case *c,
                                const asdic_roc_options *options, double *area) {
    enum { STEPS = 400 };
    double sum = 0.0;
    for (int i = 0; i <= STEPS; i++) {
        TRY(asdic_step(ctx, "steps of the closed form", (size_t)i, STEPS + 1));
        /* The integral begins at ln P_FA = -60; what lies below is negligible. */
        double log_pfa = -60.0 * (1.0 - (double)i / STEPS) * (1.0 - (double)i / STEPS), threshold;
        double slope = 120.0 * (1.0 - (double)i / STEPS) * exp(log_pfa);
        TRY(asdic_detect_threshold(ctx, &c->none, exp(log_pfa), &threshold));
        double pd = asdic_detect_pd(&c->rest, options->target, c->target_lin, threshold);
        sum += (i == 0 || i == STEPS ? 1.0 : i % 2 ? 4.0 : 2.0) * pd * slope;
    }
    *area = sum / (3.0 * STEPS);
    return ASDIC_OK;
}

asdic_band asdic_roc_compare_model(const asdic_roc *a, const asdic_roc *b) {
    asdic_band none = {NAN, NAN};
    if (!a || !b || isnan(a->model_pd.low) || isnan(b->model_pd.low)) {
        return none;
    }
    double low = b->model_pd.low - a->model_pd.low, high = b->model_pd.high - a->model_pd.high;
    return (asdic_band){fmin(low, high), fmax(low, high)};
}

asdic_status asdic_roc_fill(asdic_context *ctx, const asdic_roc_case *c,
                            const asdic_roc_options *options, asdic_roc *roc) {
    double threshold;
    TRY(draw(ctx, c, options, roc));
    roc->points = calloc(DECADES * PER_DECADE + 1, sizeof *roc->points);
    if (!roc->points) {
        return asdic_fail_memory(ctx, "a curve");
    }
    TRY(add_points(ctx, c, options, roc));
    TRY(asdic_roc_area(ctx, roc->none, roc->present, roc->trials, &roc->area));
    TRY(closed_area(ctx, c, options, &roc->closed_area));
    TRY(asdic_detect_threshold(ctx, &c->none, roc->pfa, &threshold));
    roc->pd = count(roc->present, roc->trials, threshold);
    roc->closed_pd = asdic_detect_pd(&c->rest, options->target, c->target_lin, threshold);
    return asdic_roc_band(ctx, c, options->target, roc->pfa, &roc->model_pd);
}

void asdic_roc_destroy(asdic_roc **roc) {
    if (roc && *roc) {
        free((*roc)->none);
        free((*roc)->points);
        free((*roc)->reach);
        free(*roc);
        *roc = NULL;
    }
}
