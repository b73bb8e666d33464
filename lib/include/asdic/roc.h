/*
 * How well a design detects: P_D against P_FA, by drawing speckle and noise round the intensities
 * of a simulated ping, and in closed form beside it.
 */
#ifndef ASDIC_ROC_H
#define ASDIC_ROC_H

#include <asdic/mission.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_roc_options {
    /* What is to be detected: this object of the scene, where it stands out most, or (NULL) a point
     * of target_strength_db at range_m, level with the vehicle, bearing_rad to starboard of its
     * bow. */
    const char *object;
    double range_m, bearing_rad, target_strength_db;
    const char *beam;    /* NULL: that in which the target stands out most */
    size_t ping;         /* of the mission: where the vehicle is */
    asdic_target target; /* how the echo fluctuates */
    double pfa;          /* at which P_D is given over range */
    /* Draws with, and draws without the target: 1000..1e8; at each range 20,000 at most. */
    uint64_t trials;
    uint64_t seed; /* one seed, one set of numbers: curves of one seed are compared in pairs */
} asdic_roc_options;

/* No object, range and target strength NAN, ahead; Swerling I, 1e-3, 1e6 trials, seed 1. */
ASDIC_API asdic_roc_options asdic_roc_options_default(void);

/* Estimates have bounds of 99 %. */
typedef struct asdic_roc_point {
    double design_pfa, threshold_db; /* dB re 1 uPa */
    asdic_estimate pfa;              /* by importance sampling where events are few */
    asdic_estimate pd;
    double closed_pd;
    asdic_band model_pd; /* of closed_pd */
} asdic_roc_point;

/* A point as strong as the curve's target at other ranges, in its bearing and at its depth (of an
 * object, whatever of it the beam looks to most directly), in clear sight. */
typedef struct asdic_roc_reach {
    double range_m, snr_db;
    asdic_estimate pd;
    double closed_pd; /* at the P_FA asked for */
    asdic_band model_pd;
} asdic_roc_reach;

typedef struct asdic_roc {
    char beam[ASDIC_NAME_SIZE];
    size_t bin;
    double range_m, background_db, target_db, snr_db, target_strength_db;
    asdic_background background; /* without the target */
    double background_error_db;  /* standard error of a simulated one; 0: over a plane, exact */
    double pfa, closed_pd;       /* P_D at that P_FA */
    asdic_estimate pd;
    asdic_estimate area; /* under the curve: chance that the target looks stronger than none */
    double closed_area;
    size_t point_count, reach_count;
    asdic_roc_point *points; /* P_FA ascending from 1e-6 to 1 */
    asdic_roc_reach *reach;
    double draw_s; /* seconds that a million draws took */
    size_t trials;
    double *none, *present;                                  /* the draws, [trials] */
    double background_uncertainty_db, target_uncertainty_db; /* of the laws; NAN: not stated */
    asdic_band model_pd;                                     /* of closed_pd */
    /* One sentence where the target is detected as often as nothing is; else "". */
    char remark[192];
} asdic_roc;

/* Simulates the ping, without its speckle, and draws round it; a coherent one as a ping of
 * intensities. A scene without speckle is given Rayleigh's. The background is what is expected
 * without objects; over a bottom that is no plane, or with multipath over boundaries, what the ping
 * holds beside the object. Echoes of other objects are none of the object's: it is judged where it
 * is the loudest of them, and ASDIC_ERROR_ARGUMENT where it nowhere is. */
ASDIC_API asdic_status asdic_roc_compute(asdic_context *ctx, const asdic_mission *mission,
                                         asdic_device *device, const asdic_roc_options *options,
                                         asdic_roc **out);
ASDIC_API void asdic_roc_destroy(asdic_roc **roc);

/* B's area less A's, from draws of one seed and number. The pairs make its bounds narrower than
 * those of the areas (DeLong, DeLong & Clarke-Pearson, Biometrics 44, 837 (1988)), except where no
 * draw of either overlaps. */
ASDIC_API asdic_status asdic_roc_compare(asdic_context *ctx, const asdic_roc *a, const asdic_roc *b,
                                         asdic_estimate *difference);

/* B's P_D less A's under the same error of the laws, at either end of their bands; low <= high. NAN
 * where A or B has no band. */
ASDIC_API asdic_band asdic_roc_compare_model(const asdic_roc *a, const asdic_roc *b);

/* The same by itself: the area under the curve of two sets of intensities. */
ASDIC_API asdic_status asdic_roc_area(asdic_context *ctx, const double *none, const double *present,
                                      size_t trials, asdic_estimate *area);

/* Curves with their names, COUNT of them: variant,design_pfa,threshold_db,pfa,pfa_low,... to PATH,
 * and the same over range: variant,range_m,snr_db,pd,... to RANGE_PATH. */
ASDIC_API asdic_status asdic_roc_write_csv(asdic_context *ctx, const char *path,
                                           const char *range_path, const char *const *names,
                                           asdic_roc *const *rocs, size_t count);

/* Both as one picture; at most 8 curves. */
ASDIC_API asdic_status asdic_roc_draw(asdic_context *ctx, const char *path, const char *title,
                                      const char *const *names, asdic_roc *const *rocs,
                                      size_t count);

#ifdef __cplusplus
}
#endif

#endif
