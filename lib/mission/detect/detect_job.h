/*
 * What the parts of one call of asdic_run_detect share.
 */
#ifndef ASDIC_MISSION_DETECT_JOB_H
#define ASDIC_MISSION_DETECT_JOB_H

#include <asdic/detections.h>

#include "base/arena.h"
#include "detect/k_table.h"
#include "detect_background.h"
#include "detect_truth.h"
#include "out/file.h"
#include "out/mcap_recording.h"
#include "sim/ring_shelf.h"

typedef struct asdic_detect_job {
    asdic_context *ctx;
    const asdic_detect_options *options;
    asdic_run *run;
    asdic_run_info info;
    asdic_detector detector;
    asdic_mission *mission; /* the run's; NULL: its scene, a mesh or a track is not as it was */
    asdic_scan *scan;
    asdic_k_table *k_table;     /* of the ping's looks */
    asdic_k_table *k_tables[2]; /* of even and odd looks, between which a dive may go to and fro */
    asdic_namer *namer;
    asdic_tracker *tracker;
    asdic_occupancy *map;               /* NULL: none */
    asdic_background_source background; /* not AUTO */
    asdic_backdrop *backdrop;           /* NULL: not simulated */
    asdic_backdrop *parts;              /* of coherent pings; else NULL */
    asdic_ping *expected;               /* NULL: background is not flat */
    asdic_expected_place place;         /* for which it was computed; depth NAN: none yet */
    asdic_ring_shelf *shelf;            /* the beams' profiles */
    asdic_arena memory;                 /* of the arrays that follow, but what grows */
    double *intensity_lin, *noise_lin;  /* of the ping, [beam * bins + bin] */
    double *fixed_lin;                  /* of the background: what K speckle gives no texture */
    double *rest_lin;                   /* expected, without the echoes of objects and ghosts */
    double *object_lin;                 /* those echoes */
    float *error_db;                    /* of the levels and of their background together */
    asdic_truth *truth;
    long *label; /* object of a bin; -1: none */
    bool *detected;
    asdic_plot_point *plots; /* of the ping */
    size_t *plot_cell;       /* the cell where each stands out most */
    size_t *plot_bins;       /* that each joins */
    size_t plot_count;
    /* Over all pings, plots where there is no object: their number, the sum of their bins, the sum
     * of the squares. */
    double false_plots, false_bins, false_squares;
    double design_alarms; /* over bins that hold nothing, what thresholds are for */
    double sound_speed_mps;
    asdic_file *detections, *tracks;
    asdic_mcap_recording *messages; /* NULL: the scene asks for none */
    uint8_t *track_seen;            /* bits by track number: 1 confirmed, 2 of an object */
    size_t track_capacity;
    double *track_north_m, *track_east_m; /* of the vehicle, per ping: for the map */
    double *track_yaw_rad;                /* ... for how it turns */
    size_t pings_done;
    asdic_detect_report *report;
    uint64_t *sight_ping; /* by sight: 1 + the last ping with a bin of it */
    bool *sight_hit;      /* ... and whether it was detected in that */
    double *sight_most;   /* its echo over the threshold where that is most */
} asdic_detect_job;

/* detect_output.c: opens the files and writes their first line; the rows, and the message, of a
 * ping's detections; the rows of its tracks. */
asdic_status asdic_detect_open_files(asdic_detect_job *job);
asdic_status asdic_detect_write_rows(asdic_detect_job *job, const asdic_record *record);
asdic_status asdic_detect_write_tracks(asdic_detect_job *job, const asdic_record *record);

/* detect_output.c: joins neighbouring detections into plots; gives the standard deviations of a
 * plot in a beam of WIDTH_RAD at the horizontal distance PLANE_M. */
void asdic_detect_find_plots(asdic_detect_job *job, const asdic_record *record);
void asdic_detect_spread(const asdic_detect_job *job, double width_rad, double plane_m,
                         double *along_m, double *across_m);

/* detect_false.c: fills tracks_by_chance of the report, when all pings are counted. */
asdic_status asdic_detect_expect_tracks(asdic_detect_job *job);

/* detect_count.c: the report's tables. */
asdic_status asdic_detect_report_create(asdic_detect_job *job);
void asdic_detect_count(asdic_detect_job *job, const asdic_record *record);
/* Whether the rate of false alarms is not predicted: CFAR's P_FA in K speckle. */
bool asdic_detect_is_unknown(const asdic_detect_job *job);
void asdic_detect_finish_report(asdic_detect_job *job);
/* The law of what is in a bin beside an object's echo. */
asdic_background asdic_detect_rest(const asdic_detect_job *job, size_t cell);
double asdic_detect_bin_pd(const asdic_detect_job *job, size_t cell);
/* What of the report a bin's truth belongs to. */
asdic_detect_class *asdic_detect_class_of(const asdic_detect_job *job, size_t cell);

/* detect_output.c: the occupancy map. */
asdic_status asdic_detect_create_map(asdic_detect_job *job);
asdic_status asdic_detect_add_to_map(asdic_detect_job *job, const asdic_record *record);
asdic_status asdic_detect_draw_map(asdic_detect_job *job);

/* World position of a bin on its beam's axis. */
asdic_vec3 asdic_detect_position(const asdic_detect_job *job, const asdic_record *record,
                                 size_t beam, size_t bin);

#endif
