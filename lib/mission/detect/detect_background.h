/*
 * What of a run's pings only another simulation tells, by intensities and without speckle: the background, which is
 * the run's scene without its objects, kept in the run folder as background.npy; and the parts of coherent
 * pings, which state none, from the scene as it is, kept as parts.npy.
 */
#ifndef ASDIC_MISSION_DETECT_BACKGROUND_H
#define ASDIC_MISSION_DETECT_BACKGROUND_H

#include "mission/run/run_open.h"

#include <asdic/detections.h>

#include <math.h>

typedef struct asdic_backdrop asdic_backdrop;

typedef enum asdic_backdrop_kind { ASDIC_BACKDROP_EMPTY, ASDIC_BACKDROP_PARTS } asdic_backdrop_kind;

/* Opens what an earlier call left for this run, or simulates it; *SIMULATED_S is the time that took,
 * 0 when it was there. */
asdic_status asdic_backdrop_open(asdic_run *run, asdic_backdrop_kind kind,
                                 const asdic_detect_options *options, double *simulated_s,
                                 asdic_backdrop **out);
void asdic_backdrop_close(asdic_backdrop **backdrop);

/* Of the run's ping INDEX the mean intensity, and what of it came by way of mirrors, [beam * bins + bin], valid until
 * the next call. */
asdic_status asdic_backdrop_read(asdic_backdrop *backdrop, size_t index, const double **mean_lin,
                                 const double **mirrored_lin);

/* Points the parts of RECORD, the run's ping INDEX, to those of a backdrop of parts, valid until the next call. */
asdic_status asdic_backdrop_tell(asdic_backdrop *backdrop, size_t index, asdic_record *record);

/* Adds to ERROR_DB, standard errors of the levels of the ping that was read last, those of the
 * background. A level whose own error is below what the background's says of so few rays has that
 * one. */
void asdic_backdrop_add_error(const asdic_backdrop *backdrop, float *error_db);

/* Whether SAMPLING lets the planes of FLAT mirror what is scattered, of which a quadrature knows nothing. */
bool asdic_flat_scene_mirrors(const asdic_flat_scene *flat, const asdic_sampling *sampling);

/* Of a record's level; 0 where there is none. */
static inline double asdic_detect_lin(float level_db) {
    return isnan(level_db) ? 0.0 : pow(10.0, 0.1 * (double)level_db);
}

/* The median standard error of the bins read so far, dB. */
double asdic_backdrop_error_db(const asdic_backdrop *backdrop);

#endif
