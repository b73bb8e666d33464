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

/* TARGET_... of kernels/detection.h. */
int asdic_target_code(asdic_target target);

#endif
