/*
 * `asdic model --device`: COUNT evaluations of formula MODEL in single precision.
 */
#include "formulas.h"

__kernel void model(int model_number, __global const float *keys, __global float *out, uint count) {
    size_t i = get_global_id(0);
    if (i >= count) {
        return;
    }
    real key[MODEL_KEYS];
    for (int k = 0; k < MODEL_KEYS; k++) {
        key[k] = keys[i * MODEL_KEYS + k];
    }
    out[i] = model_value(model_number, key);
}
