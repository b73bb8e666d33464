#include "simple.h"

kernel void broken(global int *out) {
    out[0] = nowhere + 1;
}
