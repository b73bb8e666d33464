/*
 * The summary of a run's records that run.json and the pictures of many pings need. It is made
 * record by record, while devices simulate or from pings.npy, in memory that does not grow with
 * their number.
 */
#ifndef ASDIC_MISSION_RUN_SUMMARY_H
#define ASDIC_MISSION_RUN_SUMMARY_H

#include "out/decimate.h"
#include "out/overview.h"
#include "mission/mission_settings.h"
#include "run_facts.h"
#include "run_statistics.h"

/* At most this many beams get a waterfall unless one is named. */
#define ASDIC_SUMMARY_BEAMS 8
#define ASDIC_TRACK_POINTS 4096

/* What a summary holds. */
typedef struct asdic_summary_plan {
    const asdic_sonar *sonar; /* borrowed, as is the environment */
    const asdic_environment *environment;
    size_t pings, bins; /* pings: as many as will be added, or more when a run is stopped */
    double bin_length_m;
    bool lacks_parts;                       /* of the records: levels and errors alone */
    unsigned images;                        /* 1u << ASDIC_IMAGE_... */
    double tvg_db_per_decade, tvg_db_per_m; /* asked for; 0, 0: none */
    size_t beams[ASDIC_SUMMARY_BEAMS],
        beam_count; /* with a waterfall; asdic_summary_choose_beams */
} asdic_summary_plan;

typedef struct asdic_summary {
    asdic_summary_plan plan;
    asdic_statistics statistics;
    asdic_decimator waterfalls[ASDIC_SUMMARY_BEAMS]; /* of plan.beams */
    asdic_overview overview;
    double overview_db_per_decade, overview_db_per_m; /* its gain */
    float *noise_db, *echo_db; /* [beam * bins + bin], of records that lack parts */
    double *north_m,
        *east_m; /* the track: at most ASDIC_TRACK_POINTS + 1 points, the last one there */
    size_t track_count;
    asdic_pose last_pose;
    double bottom_depth_m; /* straight below the first ping; INFINITY: no bottom */
    size_t added;          /* records */
} asdic_summary;

/* The beam called NAME; ASDIC_ERROR_ARGUMENT when there is none. */
asdic_status asdic_find_beam(asdic_context *ctx, const asdic_sonar *sonar, const char *name,
                             size_t *beam);

/* Fills PLAN's beams: the one called NAME; without a name all, or of too many the one that
 * stands for them (asdic_beam_ahead). ASDIC_ERROR_ARGUMENT when there is no such beam. */
asdic_status asdic_summary_choose_beams(asdic_context *ctx, const char *name,
                                        asdic_summary_plan *plan);

asdic_status asdic_summary_create(asdic_context *ctx, const asdic_summary_plan *plan,
                                  asdic_summary **out);
/* The same for the pictures that SETTINGS ask for, and all pings that FACTS plan. */
asdic_status asdic_summary_create_all(asdic_context *ctx, const asdic_settings *settings,
                                      const asdic_run_facts *facts, asdic_summary **out);
/* Does nothing when SUMMARY is NULL. */
void asdic_summary_add(asdic_summary *summary, const asdic_record *record);
/* After the last record: everything can be read. */
void asdic_summary_end(asdic_summary *summary);
void asdic_summary_destroy(asdic_summary **summary);

#endif
