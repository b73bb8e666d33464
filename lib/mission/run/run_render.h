/*
 * Drawing a run.
 */
#ifndef ASDIC_MISSION_RUN_RENDER_H
#define ASDIC_MISSION_RUN_RENDER_H

#include "run_summary.h"

/* As asdic_run_render with SUMMARY, made while the run's pings came; NULL: made
 * from the folder. */
asdic_status asdic_run_render_summary(asdic_context *ctx, const char *folder,
                                      const asdic_render_options *options,
                                      const asdic_summary *summary);

#endif
