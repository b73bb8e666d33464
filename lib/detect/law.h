/*
 * The laws of a bin's intensity, inside.
 */
#ifndef ASDIC_DETECT_LAW_H
#define ASDIC_DETECT_LAW_H

#include <asdic/detect.h>

/* Largest shape that is told from Rayleigh speckle. */
#define ASDIC_SHAPE_MAX 1000.0

/* Everything in the range that detect.h states. */
bool asdic_background_is_good(const asdic_background *background);
asdic_status asdic_background_check(asdic_context *ctx, const asdic_background *background);

/* BACKGROUND as intensities have it whose mean errs by so much. An error of relative variance
 * e^2 is a texture of shape 1 / e^2; what texture there is has the variance of both, whatever it
 * modulates. */
asdic_background asdic_background_blurred(asdic_background background, double stderr_db);

/* TARGET_... of kernels/detection.h. */
int asdic_target_code(asdic_target target);

#endif
