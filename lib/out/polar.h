/*
 * The polar picture of a scanned sonar: a fan whose beams are the directions of the head, each with
 * the levels that it received last.
 */
#ifndef ASDIC_OUT_POLAR_H
#define ASDIC_OUT_POLAR_H

#include <asdic/output.h>
#include <asdic/sweep.h>

typedef struct asdic_polar {
    asdic_sweep sweep;
    size_t columns, bins; /* a full circle has its first direction at both ends */
    size_t shift;         /* of a full circle: column of direction 0 */
    float *levels_db;     /* [column * bins + bin]; NAN: not looked at yet */
    double *bearing_rad;  /* of the columns, from the bow */
} asdic_polar;

/* Nothing looked at yet, of a beam that looks YAW_RAD to starboard of the head. To be finished,
 * whatever is returned. */
asdic_status asdic_polar_init(asdic_context *ctx, const asdic_sweep *sweep, double yaw_rad,
                              size_t bins, asdic_polar *out);
void asdic_polar_finish(asdic_polar *polar);

/* Takes one beam's LEVELS_DB of ping PING in place of those of its direction. */
void asdic_polar_add(asdic_polar *polar, uint64_t ping, const float *levels_db);

/* As a picture wants it; it borrows POLAR's arrays. */
asdic_fan asdic_polar_fan(const asdic_polar *polar, double bin_length_m);

#endif
