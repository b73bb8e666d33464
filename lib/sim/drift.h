/*
 * What cells state where the vehicle has gone on, or an object has moved, since they learnt their errors.
 */
#ifndef ASDIC_SIM_DRIFT_H
#define ASDIC_SIM_DRIFT_H

#include "simulator.h"

/* On each side, cells from which an echo may have come. */
typedef struct asdic_drift_reach {
    size_t bins, beams;
} asdic_drift_reach;

typedef struct asdic_drift {
    bool is_any; /* echoes of objects and terrain may lie elsewhere than where they were learnt */
    asdic_drift_reach others, objects; /* of what objects rule, and of what they do not */
    asdic_drift_reach heard;           /* from where an echo may be gone that was learnt */
} asdic_drift;

/* Takes down the errors that were just learnt, where they will drift: over anything but planes. */
asdic_status asdic_drift_learn(asdic_simulator *sim);
void asdic_drift_destroy(asdic_drift_store **store);

asdic_drift asdic_drift_since(const asdic_simulator *sim, const asdic_pose *pose);

/* How BEAM's bins state their errors since DRIFT, those that objects rule or the others; WORKER's until it asks for the
 * next of the same kind. */
const asdic_stated_error *asdic_drift_row(const asdic_simulator *sim, const asdic_drift *drift,
                                          unsigned worker, size_t beam, bool of_objects);

#endif
