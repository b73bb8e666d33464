#include "polar.h"

#include "base/context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

asdic_status asdic_polar_init(asdic_context *ctx, const asdic_sweep *sweep, double yaw_rad,
                              size_t bins, asdic_polar *out) {
    size_t columns = sweep->directions + (sweep->is_circle ? 1 : 0);
    *out = (asdic_polar){.sweep = *sweep, .columns = columns, .bins = bins};
    out->levels_db = calloc(columns, bins * sizeof *out->levels_db);
    out->bearing_rad = calloc(columns, sizeof *out->bearing_rad);
    if (!out->levels_db || !out->bearing_rad) {
        return asdic_fail_memory(ctx, "the picture of a scan");
    }
    for (size_t i = 0; i < columns * bins; i++) {
        out->levels_db[i] = NAN;
    }
    double rest_rad = yaw_rad;
    if (sweep->is_circle) { /* whole steps move columns, so that the seam stays astern */
        double steps = rint(yaw_rad / sweep->step_rad), n = (double)sweep->directions;
        out->shift = (size_t)(steps - n * floor(steps / n));
        rest_rad -= steps * sweep->step_rad;
    }
    for (size_t i = 0; i < columns; i++) {
        out->bearing_rad[i] = asdic_sweep_bearing_rad(sweep, i) + rest_rad;
    }
    return ASDIC_OK;
}

void asdic_polar_finish(asdic_polar *polar) {
    free(polar->levels_db);
    free(polar->bearing_rad);
    *polar = (asdic_polar){0};
}

void asdic_polar_add(asdic_polar *polar, uint64_t ping, const float *levels_db) {
    size_t direction = asdic_sweep_direction(&polar->sweep, ping);
    size_t at = (direction + polar->shift) % polar->sweep.directions;
    size_t row = polar->bins * sizeof *levels_db;
    memcpy(polar->levels_db + at * polar->bins, levels_db, row);
    if (polar->sweep.is_circle && at == 0) {
        memcpy(polar->levels_db + (polar->columns - 1) * polar->bins, levels_db, row);
    }
}

asdic_fan asdic_polar_fan(const asdic_polar *polar, double bin_length_m) {
    return (asdic_fan){.levels_db = polar->levels_db,
                       .bearing_rad = polar->bearing_rad,
                       .beams = polar->columns,
                       .bins = polar->bins,
                       .bin_length_m = bin_length_m};
}
