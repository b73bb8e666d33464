/*
 * The table behind asdic_model_*, and evaluating many points at once.
 */
#ifndef ASDIC_SIM_MODEL_TABLE_H
#define ASDIC_SIM_MODEL_TABLE_H

#include <asdic/model.h>

#include "laws/scatterer.h"

/* The scattering law whose row INDEX is: the rows are the MODEL_ numbers of kernels/formulas.h, then the
 * laws without a formula there, each with that of its smooth face, of which MIRROR is true. NULL: it is
 * no law's. */
const asdic_law *asdic_model_law(size_t index, bool *mirror);

/* Writes which of VALUES, one a key, lie outside the validity that INFO's source states; NAN: not known.
 * False when none does. */
bool asdic_model_outside(const asdic_model_info *info, const double *values, char *text,
                         size_t size);

/* Evaluates formula MODEL (its index in the table) for COUNT points of ASDIC_MODEL_MAX_KEYS values
 * each, without checking them. DEVICE NULL: in double on the host. */
asdic_status asdic_model_evaluate_many(asdic_context *ctx, asdic_device *device, size_t model,
                                       const double *keys, size_t count, double *out);

#endif
