/*
 * A run, judged: what a detector finds in its pings, and what was there.
 */
#ifndef ASDIC_DETECTIONS_H
#define ASDIC_DETECTIONS_H

#include <asdic/run.h>
#include <asdic/scan.h>

#ifdef __cplusplus
extern "C" {
#endif

/* What a bin is compared with. */
typedef enum asdic_background_source {
    ASDIC_BACKGROUND_AUTO,      /* FLAT over a plane or no bottom, but where these are mirrors;
                                 * else SIMULATED, or CFAR where the scene file, a mesh or a track
                                 * is gone or has changed */
    ASDIC_BACKGROUND_FLAT,      /* what is expected over a plane, straight below the vehicle */
    ASDIC_BACKGROUND_SIMULATED, /* the scene without its objects, with its bottom, simulated by many
                                 * rays; kept in the run folder as background.npy */
    ASDIC_BACKGROUND_CFAR,      /* the neighbouring bins */
} asdic_background_source;

/* Of the cells of an occupancy map. */
#define ASDIC_DETECT_MIN_CELL_M 0.001
#define ASDIC_DETECT_MAX_CELL_M 1000.0

typedef struct asdic_detect_options {
    const asdic_detector *detector; /* NULL: the scene's */
    bool has_cfar;                  /* the same as ASDIC_BACKGROUND_CFAR */
    asdic_cfar cfar;
    double truth_snr_db; /* an object is in a bin when its echo is so strong re all else there */
    /* Of the occupancy map; NAN: none. 0: half a bin, 0.5 m at least, doubled while the map has
     * more than 4 million. Else from ASDIC_DETECT_MIN_CELL_M to ASDIC_DETECT_MAX_CELL_M. */
    double cell_m;
    asdic_tracker_options tracker;
    bool force; /* replace what an earlier call left */
    asdic_background_source background;
    const char *device; /* that simulates a background, see asdic_devices_open; NULL: "auto" */
    /* Pings of the background, then pings judged, which cast no rays; may be NULL. */
    void (*progress)(void *user, const asdic_run_progress *progress);
    void *user;
} asdic_detect_options;

/* The scene's detector, expected background, 0 dB, cells by the bins, the default tracker. */
ASDIC_API asdic_detect_options asdic_detect_options_default(void);

/* What a bin holds, by the expected intensities that the run recorded beside the levels. */
typedef enum asdic_truth {
    ASDIC_TRUTH_NONE,   /* neither of the following */
    ASDIC_TRUTH_OBJECT, /* an object's echo above truth_snr_db */
    ASDIC_TRUTH_GHOST,  /* an echo by way of a mirror, as strong */
    ASDIC_TRUTH_FAINT,  /* an echo of either kind, weaker, but above -20 dB: counted apart */
} asdic_truth;

/* A row of the confusion table. */
typedef struct asdic_detect_class {
    asdic_truth truth;
    char name[ASDIC_NAME_SIZE]; /* of the object; else "none", "ghost", "faint" */
    uint64_t bins, detected;
    /* Detections that P_D predicts, or of "none" P_FA: over neighbours as designed, else by what
     * is in the bin, which is less than the background in an object's shadow. NAN: not
     * predicted. */
    double expected;
} asdic_detect_class;

/* An object as one beam saw it. */
typedef struct asdic_detect_sight {
    char object[ASDIC_NAME_SIZE], beam[ASDIC_NAME_SIZE];
    size_t pings_seen, pings_detected; /* with a bin that holds it, and detected in one of them */
    size_t ping;                       /* where it stood out most: */
    double range_m, snr_db, pd; /* re all else in the bin; closed form for the run's speckle */
    bool detected;
    asdic_band model_pd; /* of pd over the error of the scattering laws */
} asdic_detect_sight;

typedef struct asdic_detect_report {
    asdic_detector detector;
    bool by_cfar;
    bool is_sample;           /* levels have speckle; else they are means and rates mean little */
    bool is_coherent;         /* pings were: what is in a bin was simulated by intensities */
    double sampling_error_db; /* median over bins of the rays' standard error: keep it small */
    double sampling_lift_db;  /* by how much a threshold by P_FA is higher for such an error */
    unsigned looks;           /* of a bin, at the first ping's depth */
    size_t pings;
    uint64_t bins, detections;
    asdic_estimate pfa; /* over bins that hold nothing; its bounds know that they share speckle */
    double design_pfa;  /* what their thresholds are for; NAN: CFAR's in K speckle */
    size_t tracks, tracks_confirmed, tracks_of_objects;
    asdic_background_source background; /* that was used, never AUTO */
    double background_error_db;         /* median standard error of a simulated one; else 0 */
    double background_s;                /* what its simulation took; 0: it was there */
    /* Confirmed ones that are to be expected of false alarms alone. NAN: not known, of coherent
     * pings, whose false alarms come again, of K speckle over thresholds of CFAR, and of a scanned
     * sonar that turns by more than a beam in the pings by which a track is judged. */
    double tracks_by_chance;
    size_t class_count, sight_count;
    asdic_detect_class *classes; /* objects in order of appearance, then ghost, faint, none */
    asdic_detect_sight *sights;  /* by object, then beam */
} asdic_detect_report;

/* Detects in every ping of a run. Writes detections.csv, tracks.csv and occupancy.png into its
 * folder. *OUT is to be freed by asdic_detect_report_destroy; OUT may be NULL. */
ASDIC_API asdic_status asdic_run_detect(asdic_context *ctx, const char *folder,
                                        const asdic_detect_options *options,
                                        asdic_detect_report **out);
ASDIC_API void asdic_detect_report_destroy(asdic_detect_report **report);

#ifdef __cplusplus
}
#endif

#endif
