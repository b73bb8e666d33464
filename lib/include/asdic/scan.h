/*
 * A detector at work: one ping's intensities in, what it decides about every bin out; many pings
 * fused in an occupancy grid; detections joined to tracks.
 */
#ifndef ASDIC_SCAN_H
#define ASDIC_SCAN_H

#include <asdic/detect.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a detector may be asked for, of scene files, the program and the library alike. */
#define ASDIC_DETECTOR_MIN_PFA 1e-12
#define ASDIC_DETECTOR_MAX_PFA 0.5
#define ASDIC_DETECTOR_MIN_PRIOR 1e-9
#define ASDIC_DETECTOR_MAX_PRIOR 0.999
#define ASDIC_DETECTOR_MIN_SNR_DB (-20.0)
#define ASDIC_DETECTOR_MAX_SNR_DB 60.0 /* likelihood ratios of stronger targets are not computed */
#define ASDIC_DETECTOR_MIN_COST 1e-6
#define ASDIC_DETECTOR_MAX_COST 1e12

typedef struct asdic_detector {
    asdic_target target;
    double pfa;    /* probability of false alarm per bin */
    double prior;  /* probability that a bin holds a target */
    double snr_db; /* strength of the target that the likelihood ratio assumes, re the background */
    double cost_ratio; /* of a miss over a false alarm: the threshold that costs least, in place of
                        * pfa; NAN: by pfa */
} asdic_detector;

/* Swerling I, 1e-3, 0.01, 10 dB, by P_FA. */
ASDIC_API asdic_detector asdic_detector_default(void);

/* ---- one ping ------------------------------------------------------------------------------- */

typedef struct asdic_scan asdic_scan;

/* CFAR NULL: against expected intensities; else against what the neighbouring bins hold, of bins
 * shorter than a pulse those a pulse apart, whose speckle is independent. SONAR says how many looks
 * a bin has and what its speckle is; nothing is borrowed. */
ASDIC_API asdic_status asdic_scan_create(asdic_context *ctx, const asdic_sonar *sonar,
                                         double sound_speed_mps, size_t bins,
                                         const asdic_detector *detector, const asdic_cfar *cfar,
                                         asdic_scan **out);
ASDIC_API void asdic_scan_destroy(asdic_scan **scan);

/* Where the vehicle is now: a bin has fewer looks in faster water, as the simulator draws them. */
ASDIC_API void asdic_scan_set_sound_speed(asdic_scan *scan, double sound_speed_mps);

/* Whether pings are coherent, whose pulses end in smooth edges, which levels that are expected are
 * without: nothing is then decided in a bin beside one of which ten times as much is expected. It
 * may hold more of that one's edge than of its own. False at first; no matter with CFAR. */
ASDIC_API void asdic_scan_set_coherent(asdic_scan *scan, bool is_coherent);

/* Decides about INTENSITY_LIN[beam * bins + bin]. EXPECTED_LIN: the background's mean, noise
 * included; NULL with CFAR. NOISE_LIN: the noise in it, and all else without texture (detect.h),
 * for K speckle; NULL: none.
 * STDERR_DB: the sampling error of simulated intensities, as a ping states it; NULL: none. It
 * spreads them, so that a threshold by pfa is higher: by 0.01 dB for an error of 0.14 dB, 0.05 for
 * 0.3, 0.2 for 0.6 and 0.8 for 1.4 (one look, P_FA 1e-3). */
ASDIC_API asdic_status asdic_scan_ping(asdic_scan *scan, const double *intensity_lin,
                                       const double *expected_lin, const double *noise_lin,
                                       const float *stderr_db);

/* Of the last ping, [beam * bins + bin]; NAN where there is nothing to decide. */
typedef struct asdic_scan_result {
    const double *background_lin; /* mean of the background */
    const double *threshold_lin;
    const double *llr;
} asdic_scan_result;

ASDIC_API asdic_scan_result asdic_scan_get(const asdic_scan *scan);

/* Where a beam looks: unit vector in the world. */
ASDIC_API asdic_vec3 asdic_beam_axis(const asdic_beam *beam, const asdic_pose *pose);

/* Width between the half-power points of the two-way pattern in the horizontal, rad; that of a
 * Gaussian of the two apertures. At most pi. */
ASDIC_API double asdic_beam_width_rad(const asdic_sonar *sonar, size_t receiver,
                                      double sound_speed_mps);

/* ---- many pings: where something is --------------------------------------------------------- */

/* Log-odds of a target in the cells of a map fixed in the world; independent looks add. */
enum { ASDIC_OCCUPANCY_FLOOR, ASDIC_OCCUPANCY_WATER, ASDIC_OCCUPANCY_PARTS };

typedef struct asdic_occupancy {
    double north_m, east_m; /* south-western corner */
    double cell_m;
    size_t rows, columns; /* to the north, to the east */
    double prior_log_odds, limit;
    float *log_odds;      /* [row * columns + column]; NAN: never looked at */
    float *floor_depth_m; /* the same, for the caller to fill; NAN, as at first: not known */
    float *part[ASDIC_OCCUPANCY_PARTS]; /* log-odds of objects on the floor, and in the water */
} asdic_occupancy;

/* Covers the box; at most 2^26 cells. LIMIT, 10 say, clips the log-odds, so that a map can change
 * its mind. */
ASDIC_API asdic_status asdic_occupancy_create(asdic_context *ctx, asdic_vec3 min_m,
                                              asdic_vec3 max_m, double cell_m, double prior,
                                              double limit, asdic_occupancy **out);
ASDIC_API void asdic_occupancy_destroy(asdic_occupancy **map);

/* A ping as a map reads it; nothing is borrowed. Arrays are [beam * bins + bin]. */
typedef struct asdic_look {
    const asdic_sonar *sonar;
    double sound_speed_mps; /* 100..1e4 */
    asdic_pose pose;
    double depth_m; /* water above; INFINITY: not known */
    size_t bins;
    const double *intensity_lin, *background_lin; /* a background of NAN: nothing known */
    const double *noise_lin;                      /* as of asdic_scan_ping; may be NULL */
    double snr_db;                                /* of the weakest object looked for */
} asdic_look;

/* Adds what a ping says of every cell that a beam sees to within 15 dB of its axis, at the ranges
 * that the water leaves to objects there. All beams are asked at once how well their patterns
 * explain what they hear by an object in the cell; echoes found elsewhere are background first. Of
 * cells that one echo may come from, each is told what its neighbours leave over:
 *
 *     l <- clip(l + ln[(q L + (1 - q) max(L, M)) / (q + (1 - q) M)]),
 *
 * L the likelihood ratio of an object in the cell, M its mean over the other cells within a beam's
 * width at the same range, and q the probability that all of these are empty, by what the map says
 * so far (Thrun, Autonomous Robots 15, 111 (2003): a forward model; here a step for each cell). A
 * quiet bin thus clears a cell by as much as an object there would have been heard, a detection is
 * shared by all cells that it may come from, and poses that see them otherwise tell them apart. Of
 * several elevations the ratios are averaged, as for an object that is at one of them. Bins behind
 * a likely object that hold as little as its shadow would say nothing.
 *
 * False cells: in no case are more than prior / (1 - prior) expected above even odds where a cell
 * has no neighbours and nothing before it, as long as odds are not clipped from below (Ville's
 * inequality: a product of likelihood ratios has a mean of at most 1); neighbours make them
 * fewer. */
ASDIC_API asdic_status asdic_occupancy_add(asdic_context *ctx, asdic_occupancy *map,
                                           const asdic_look *look);

/* ---- many pings: what moves where ----------------------------------------------------------- */

/* A detection in the plane, with its covariance. */
typedef struct asdic_plot_point {
    double north_m, east_m;
    double variance_nn_m2, variance_ne_m2, variance_ee_m2;
    long label; /* of the caller's; tracks pass it on */
} asdic_plot_point;

typedef struct asdic_tracker_options {
    double gate;          /* squared Mahalanobis distance: 9.21 holds 99 % */
    double acceleration;  /* spectral density of the targets' accelerations, m^2/s^3 */
    double speed_mps;     /* standard deviation of a new track's speed, each way */
    unsigned confirm, of; /* a track is confirmed by `confirm` hits in `of` pings */
    unsigned misses;      /* ... and dropped after so many pings without one */
} asdic_tracker_options;

/* 9.21, 0.01 m^2/s^3, 0.5 m/s, 3 of 5, 5. */
ASDIC_API asdic_tracker_options asdic_tracker_options_default(void);

typedef struct asdic_track_state {
    unsigned id; /* from 1, in the order of birth */
    bool confirmed;
    bool hit; /* by the last update */
    double north_m, east_m, north_mps, east_mps;
    double sd_north_m, sd_east_m;
    unsigned hits, age; /* pings */
    long label;         /* of the last hit */
} asdic_track_state;

typedef struct asdic_tracker asdic_tracker;

/* Kalman filters of constant velocity; every ping's plots go to the nearest track whose gate they
 * are in, nearest pairs first, and found a new track when there is none. */
ASDIC_API asdic_status asdic_tracker_create(asdic_context *ctx,
                                            const asdic_tracker_options *options,
                                            asdic_tracker **out);
ASDIC_API void asdic_tracker_destroy(asdic_tracker **tracker);
ASDIC_API asdic_status asdic_tracker_update(asdic_tracker *tracker, double time_s,
                                            const asdic_plot_point *plots, size_t count);

/* How many tracks clutter confirms, per plot of it. Plots fall anywhere on LINES lines, which
 * are at EAST_M, ascending, along an arc of radius PLANE_M round where they meet (INFINITY:
 * they run side by side, to the north), PLOTS_PER_M of them a ping on each, with the covariance
 * of PLOT, which is along and across each of them, STEP_S seconds from ping to ping, in which
 * all lines turn by TURN_RAD round where they meet. A plot
 * that no track takes founds one, and every way in which that can go on is followed: the next
 * ping has a plot in its gate with probability 1 - exp(-density x length of lines in the gate),
 * less what other tracks take. A plot on another line counts as one on the track's own once it
 * is in the gate: where lines are nearer than plots are wide, a third fewer tracks may be
 * found. Seen from a vehicle at rest, plots fall in the same bins again and make up to a third
 * more. */
ASDIC_API double asdic_tracker_false_share(const asdic_tracker_options *options, double step_s,
                                           const asdic_plot_point *plot, double plots_per_m,
                                           const double *east_m, size_t lines, double plane_m,
                                           double turn_rad);

/* Tracks alive, valid until the next update. */
ASDIC_API const asdic_track_state *asdic_tracker_get(const asdic_tracker *tracker, size_t *count);

#ifdef __cplusplus
}
#endif

#endif
