#include "law.h"

#include "base/context.h"

#include "../../kernels/detection.h"

#include <math.h>

#define MOST_LOOKS 1000u
#define LEAST_SHAPE 0.05

bool asdic_background_is_good(const asdic_background *b) {
    return b->mean_lin > 0.0 && isfinite(b->mean_lin) && b->looks >= 1 && b->looks <= MOST_LOOKS &&
           b->shape >= LEAST_SHAPE && b->noise_share >= 0.0 && b->noise_share <= 1.0;
}

asdic_status asdic_background_check(asdic_context *ctx, const asdic_background *b) {
    if (asdic_background_is_good(b)) {
        return ASDIC_OK;
    }
    return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                      "a background of mean %g (must be above 0), %u looks (1..%u), shape %g (from "
                      "%g), noise share %g (0..1)",
                      b->mean_lin, b->looks, MOST_LOOKS, b->shape, LEAST_SHAPE, b->noise_share);
}

asdic_background asdic_background_of(const asdic_sonar *sonar, double sound_speed_mps,
                                     double mean_lin, double noise_lin) {
    return (asdic_background){
        .mean_lin = mean_lin,
        .looks = asdic_sonar_looks(sonar, sound_speed_mps),
        .shape = sonar->speckle == ASDIC_SPECKLE_K ? sonar->speckle_shape : (double)INFINITY,
        .noise_share = mean_lin > 0.0 ? fmin(fmax(noise_lin / mean_lin, 0.0), 1.0) : 0.0};
}

asdic_background asdic_background_blurred(asdic_background b, double stderr_db) {
    double error = stderr_db * log(10.0) / 10.0;
    if (error > 0.0) {
        b.noise_share = b.shape <= ASDIC_SHAPE_MAX ? b.noise_share : 0.0;
        b.shape = fmax(1.0 / ((1.0 + 1.0 / b.shape) * (1.0 + error * error) - 1.0), LEAST_SHAPE);
    }
    return b;
}

bool asdic_target_is_known(asdic_target target) {
    return (unsigned)target <= ASDIC_TARGET_SWERLING2;
}

int asdic_target_code(asdic_target target) {
    return target == ASDIC_TARGET_SWERLING0   ? TARGET_STEADY
           : target == ASDIC_TARGET_SWERLING1 ? TARGET_SWERLING1
                                              : TARGET_SWERLING3;
}

asdic_background asdic_background_with(const asdic_background *b, double target_lin) {
    asdic_background both = *b;
    both.mean_lin += target_lin;
    both.noise_share = (b->noise_share * b->mean_lin + target_lin) / both.mean_lin;
    return both;
}

static double exceed(const asdic_background *b, asdic_target target, double snr, double threshold) {
    int code = asdic_target_code(target);
    double looks = (double)b->looks;
    if (!(threshold > 0.0)) {
        return 1.0;
    }
    if (isinf(threshold)) { /* as of costs that nothing is worth */
        return 0.0;
    }
    if (b->shape > ASDIC_SHAPE_MAX) {
        return detection_exponential(threshold, snr, looks, code);
    }
    if (threshold > ASDIC_DETECT_MOST) { /* nothing but a target as strong comes near */
        snr *= ASDIC_DETECT_MOST / threshold;
        threshold = ASDIC_DETECT_MOST;
    }
    return detection_k(threshold, snr, looks, code, b->shape, b->noise_share);
}

double asdic_detect_pfa(const asdic_background *b, double threshold_lin) {
    if (!asdic_background_is_good(b) || isnan(threshold_lin)) {
        return NAN;
    }
    return exceed(b, ASDIC_TARGET_SWERLING1, 0.0, threshold_lin / b->mean_lin);
}

double asdic_detect_pd(const asdic_background *b, asdic_target target, double target_lin,
                       double threshold_lin) {
    if (!asdic_background_is_good(b) || !asdic_target_is_known(target) || isnan(threshold_lin) ||
        !(target_lin >= 0.0)) {
        return NAN;
    }
    double snr = target_lin / b->mean_lin;
    if (isinf(snr)) {
        return 1.0;
    }
    if (target == ASDIC_TARGET_SWERLING2) {
        asdic_background both = asdic_background_with(b, target_lin);
        return asdic_detect_pfa(&both, threshold_lin);
    }
    return exceed(b, target, snr, threshold_lin / b->mean_lin);
}
