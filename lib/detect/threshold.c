#include "law.h"

#include "base/context.h"
#include "base/try.h"

#include <float.h>
#include <math.h>

/* Intensities re the mean between which a threshold is looked for, and how finely the likelihood
 * ratio of K clutter is looked through for its first crossing. */
#define LEAST 1e-12
#define MOST 1e12
#define STEP 1.25
/* ... of a threshold, relative. */
#define PRECISION 1e-15

/* ln of the intensity that B, of unit mean, exceeds with the probability e^LOG_PFA. Halves where the ends are too far
 * apart for a probability, and where three chords did less; else along the chord, where an end that stays counts half
 * (Dowell & Jarratt, BIT 11, 168 (1971)). */
static double find_crossing(const asdic_background *b, double log_pfa) {
    double low = log(LEAST), high = log(MOST), above = INFINITY, below = -INFINITY, last = NAN;
    for (int slow = 0; high - low > PRECISION * fmax(fabs(low), 1.0);) {
        double width = high - low, least = 0.25 * PRECISION * fmax(fabs(low), 1.0);
        double at = 0.5 * (low + high);
        if (isfinite(above) && isfinite(below) && slow < 3) {
            at = fmin(fmax(low + width * above / (above - below), low + least), high - least);
        }
        if (at <= low || at >= high) {
            break;
        }
        double excess = log(asdic_detect_pfa(b, exp(at))) - log_pfa;
        if (excess > 0.0) {
            below *= last > 0.0 ? 0.5 : 1.0;
            low = at;
            above = excess;
        } else {
            above *= last <= 0.0 ? 0.5 : 1.0;
            high = at;
            below = excess;
        }
        last = excess;
        slow = high - low > 0.5 * width ? slow + 1 : 0;
    }
    return high;
}

asdic_status asdic_detect_threshold(asdic_context *ctx, const asdic_background *b, double pfa,
                                    double *threshold_lin) {
    if (!b || !threshold_lin) {
        return asdic_fail_null(ctx, __func__);
    }
    TRY(asdic_background_check(ctx, b));
    if (!(pfa >= 1e-300 && pfa <= 1.0)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a false-alarm probability of %g: must be in [1e-300, 1]", pfa);
    }
    asdic_background unit = *b;
    unit.mean_lin = 1.0;
    double log_intensity = find_crossing(&unit, log(pfa));
    *threshold_lin = pfa >= 1.0 ? 0.0 : b->mean_lin * exp(log_intensity);
    return ASDIC_OK;
}

asdic_status asdic_detect_threshold_llr(asdic_context *ctx, const asdic_background *b,
                                        asdic_target target, double target_lin, double llr,
                                        double *threshold_lin) {
    if (!b || !threshold_lin) {
        return asdic_fail_null(ctx, __func__);
    }
    TRY(asdic_background_check(ctx, b));
    if (!(target_lin > 0.0) || !isfinite(target_lin) || isnan(llr) ||
        !asdic_target_is_known(target)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a target of kind %d and intensity %g, a log-likelihood ratio of %g: no "
                          "threshold",
                          (int)target, target_lin, llr);
    }
    /* Neither target nor clutter is more than 1000 times its mean, but for negligible shares. */
    double most = 1e3 * (b->mean_lin * fmax(1.0, 1.0 / b->shape) + target_lin);
    double low = 0.0, high = fmax(1e-6 * b->mean_lin, DBL_MIN); /* which grows by steps */
    if (asdic_detect_llr(b, target, target_lin, 0.0) >= llr) {
        *threshold_lin = 0.0;
        return ASDIC_OK;
    }
    while (asdic_detect_llr(b, target, target_lin, high) < llr) {
        low = high;
        high *= STEP;
        if (high > most) {
            *threshold_lin = INFINITY;
            return ASDIC_OK;
        }
    }
    for (int i = 0; i < 100 && high - low > 1e-14 * high; i++) {
        double middle = 0.5 * (low + high);
        if (asdic_detect_llr(b, target, target_lin, middle) < llr) {
            low = middle;
        } else {
            high = middle;
        }
    }
    *threshold_lin = high;
    return ASDIC_OK;
}
