/*
 * The laws of a bin's intensity, inside.
 */
#ifndef ASDIC_DETECT_LAW_H
#define ASDIC_DETECT_LAW_H

#include <asdic/detect.h>

/* Above this shape, K speckle counts as Rayleigh speckle. */
#define ASDIC_SHAPE_MAX 1000.0

/* Everything in the range that detect.h states. */
bool asdic_background_is_good(const asdic_background *background);
asdic_status asdic_background_check(asdic_context *ctx, const asdic_background *background);

/* The law of intensities over BACKGROUND when its mean has an error. An error of relative variance
 * e^2 acts as a texture of shape 1 / e^2; with a texture, the variances of both add, whatever the
 * texture modulates. */
asdic_background asdic_background_blurred(asdic_background background, double stderr_db);

/* TARGET_... of kernels/detection.h. */
int asdic_target_code(asdic_target target);

#endif
