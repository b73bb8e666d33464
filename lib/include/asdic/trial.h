/*
 * Trials: how often does this vehicle with this sonar and this rule hit something, and how often
 * does it turn away from nothing?
 *
 * A run is a vehicle that flies along the waypoints of a scene, pings, detects, and gives way by a
 * rule, in a scene of which a `trial` section draws parts at random. It depends on the scene, the
 * seed and its number alone. Several variants of the scene are flown with the same random numbers,
 * so that their difference is known better than either.
 */
#ifndef ASDIC_TRIAL_H
#define ASDIC_TRIAL_H

#include <asdic/loop.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum asdic_trial_outcome {
    ASDIC_TRIAL_CLEAR,  /* passed its last waypoint */
    ASDIC_TRIAL_HIT,    /* came nearer to something than its hull's radius */
    ASDIC_TRIAL_LATE,   /* ran out of time; nothing was hit */
    ASDIC_TRIAL_VOID,   /* began in the bottom or in an object: the draw is impossible */
    ASDIC_TRIAL_BROKEN, /* the rule failed */
    ASDIC_TRIAL_OUTCOMES
} asdic_trial_outcome;

typedef enum asdic_trial_cause {
    ASDIC_TRIAL_NO_CAUSE,
    ASDIC_TRIAL_NOT_SEEN,       /* held on into it */
    ASDIC_TRIAL_SEEN_LATE,      /* the same manoeuvre, begun at the rule's reach, clears it */
    ASDIC_TRIAL_COULD_NOT_TURN, /* ... hits all the same */
    ASDIC_TRIAL_CAUSES
} asdic_trial_cause;

/* "clear", "hit", ...; "", "not seen", ... */
ASDIC_API const char *asdic_trial_outcome_name(asdic_trial_outcome outcome);
ASDIC_API const char *asdic_trial_cause_name(asdic_trial_cause cause);

typedef struct asdic_trial_run {
    asdic_trial_outcome outcome;
    asdic_trial_cause cause;
    char what[ASDIC_NAME_SIZE]; /* HIT, VOID: "bottom" or an object's name */
    double time_s, distance_m;
    size_t pings;
    double clearance_m; /* least distance from the hull to anything but the surface */
    unsigned manoeuvres;
    unsigned needless; /* of these: holding on for the rule's reach would have hit nothing */
    /* HIT: from where the manoeuvre under way began to the nearest of what was hit that was in the
     * rule's sector then; of the bottom, to where it was hit. NAN: there is none. */
    double seen_m;
} asdic_trial_run;

/* What a rule is told, once a ping. */
typedef struct asdic_trial_look {
    size_t worker; /* from 0: calls of one worker follow one another */
    uint64_t run;
    const asdic_sonar *sonar;
    const asdic_loop_ping *ping; /* its number counts from 0 in every run */
    const asdic_scan_result *found;
} asdic_trial_look;

/* What is flown in place of the waypoints until the next ping; neither: hold on. */
typedef struct asdic_trial_order {
    bool turns, dives;
    double yaw_rad, z_m;
} asdic_trial_order;

/* A rule in place of the scene's own. DECIDE fills ORDER, which is zero, or says what is wrong in
 * WHY and returns false: the run counts as broken, and others go on. Workers call it from threads
 * of their own. */
#define ASDIC_TRIAL_WHY 256
typedef struct asdic_trial_rule {
    bool (*decide)(void *user, const asdic_trial_look *look, asdic_trial_order *order,
                   char why[ASDIC_TRIAL_WHY]);
    void *user;
    const char *name; /* kept with the trial: what is resumed or merged has one name; NULL: none */
} asdic_trial_rule;

/* A scene flown with a value of one of its keys in place of what it says; KEY NULL: as it is. */
typedef struct asdic_trial_variants {
    const char *key;
    const char *const *values;
    size_t count; /* 1 at least */
} asdic_trial_variants;

#define ASDIC_TRIAL_MOST_VARIANTS 16

typedef struct asdic_trial_options {
    const char *scene;
    const char *folder; /* created */
    uint64_t runs;      /* of each variant */
    uint64_t seed;
    uint64_t first, count; /* the part of the runs to fly; count UINT64_MAX: to the end */
    uint32_t rays;         /* a ping, instead of the scene's; 0: the scene's, 4096 of `auto` */
    asdic_trial_variants variants;
    const asdic_trial_rule *rule; /* NULL: the scene's; none with an `ideal` sonar */
    bool force, resume;
    asdic_team *team; /* NULL: this process alone */
    void (*progress)(void *user, uint64_t done, uint64_t all, uint64_t pings); /* may be NULL */
    void *user;
} asdic_trial_options;

/* One run of 1,000; seed 1. */
ASDIC_API asdic_trial_options asdic_trial_options_default(void);

/* Flies all runs of all variants on DEVICES and writes FOLDER: trial.csv, a row for each run and
 * variant; trial.json, the figures; trial.png. Its bytes are the same however runs were dealt: as
 * many at a time as there are devices. For scenes whose sonar is `ideal` DEVICES may be NULL; it is
 * then as many as processors. ASDIC_ERROR_INTERRUPTED: what is written can be resumed. */
ASDIC_API asdic_status asdic_trial_fly(asdic_context *ctx, asdic_device **devices,
                                       size_t device_count, const asdic_trial_options *options);

/* Joins all parts of a trial, made with FIRST and COUNT, into FOLDER: the bytes of the whole.
 * ASDIC_ERROR_INPUT when runs are in no part, or in two. */
ASDIC_API asdic_status asdic_trial_merge(asdic_context *ctx, const char *const *folders,
                                         size_t folder_count, const char *folder, bool force);

/* As asdic_mission_find_rays, from the options' rays on, else 1,024, along the waypoints of run 0
 * of variant VARIANT where they are above the bottom. */
ASDIC_API asdic_status asdic_trial_find_rays(asdic_context *ctx, asdic_device *device,
                                             const asdic_trial_options *options, size_t variant,
                                             const asdic_tolerance *tolerance,
                                             asdic_ray_budget *out);

/* Whether FOLDER holds a trial. */
ASDIC_API bool asdic_trial_is_in(const char *folder);

/* Flies run RUN of variant VARIANT again and leaves FOLDER/scene.yaml and FOLDER/track.csv: a scene
 * of that run's pings, which asdic_mission_run simulates to the same bytes; with `refraction:
 * layer` but for the layer, which is fitted to the depths that were flown. ASDIC_ERROR_EXISTS where
 * FOLDER holds such files or a run, unless options.force; or the trial's own scene. */
ASDIC_API asdic_status asdic_trial_replay(asdic_context *ctx, asdic_device *device,
                                          const asdic_trial_options *options, uint64_t run,
                                          size_t variant, const char *folder, asdic_trial_run *out);

/* A figure with its interval of 95 %. */
typedef struct asdic_trial_figure {
    double value, low, high;
} asdic_trial_figure;

typedef struct asdic_trial_result {
    uint64_t outcomes[ASDIC_TRIAL_OUTCOMES], causes[ASDIC_TRIAL_CAUSES];
    uint64_t runs;                      /* flown to an end: without those void or broken */
    asdic_trial_figure collision;       /* probability; Clopper and Pearson */
    asdic_trial_figure needless;        /* probability of one or more in a run; the same */
    asdic_trial_figure needless_per_km; /* by the spread from run to run */
    double km, least_clearance_m;
    uint64_t pings;
    /* Against the first variant, over the runs that both flew: */
    asdic_trial_figure difference; /* of the probability of a collision; Tango's score interval */
    double mcnemar;                /* probability of as many discordant pairs by chance alone */
    double paired_share; /* of the runs that designs flown apart would have taken for as narrow an
                          * interval */
} asdic_trial_result;

typedef struct asdic_trial asdic_trial;

/* Reads the trial in FOLDER. */
ASDIC_API asdic_status asdic_trial_open(asdic_context *ctx, const char *folder, asdic_trial **out);
ASDIC_API void asdic_trial_close(asdic_trial **trial);
ASDIC_API size_t asdic_trial_variant_count(const asdic_trial *trial);
/* "sonar.file = one.yaml"; of a scene without variants its name. */
ASDIC_API const char *asdic_trial_variant_name(const asdic_trial *trial, size_t variant);
ASDIC_API asdic_trial_result asdic_trial_get(const asdic_trial *trial, size_t variant);

/* ---- counting ------------------------------------------------------------------------------- */

/* EVENTS in TRIALS with the bounds of Clopper and Pearson, which hold with LEVEL (0.95) or more. */
ASDIC_API asdic_trial_figure asdic_trial_share(uint64_t events, uint64_t trials, double level);

/* The difference of two shares in PAIRS pairs, FIRST of which happened in the first alone and
 * SECOND in the second alone: (FIRST - SECOND) / PAIRS with the score interval of Tango, Statistics
 * in Medicine 17, 891 (1998), of LEVEL. */
ASDIC_API asdic_trial_figure asdic_trial_paired(uint64_t first, uint64_t second, uint64_t pairs,
                                                double level);

/* McNemar's test, exact and two-sided. */
ASDIC_API double asdic_trial_mcnemar(uint64_t first, uint64_t second);

#ifdef __cplusplus
}
#endif

#endif
