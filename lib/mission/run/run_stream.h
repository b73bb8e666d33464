/*
 * A mission's levels to the standard output, as they come.
 */
#ifndef ASDIC_MISSION_RUN_STREAM_H
#define ASDIC_MISSION_RUN_STREAM_H

#include "run_job.h"

/* The rows of bins.csv and nothing else: no folder, no pictures. */
asdic_status asdic_run_stream(asdic_run_job *job);

#endif
