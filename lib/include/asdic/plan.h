/*
 * What a scene needs: every term of the model kept or left out, why, and a proven bound in dB on
 * what leaving it out changes in any bin of any ping.
 */
#ifndef ASDIC_PLAN_H
#define ASDIC_PLAN_H

#include <asdic/ping.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum asdic_term {
    ASDIC_TERM_BOTTOM,
    ASDIC_TERM_SURFACE,
    ASDIC_TERM_VOLUME,
    ASDIC_TERM_OBJECTS,
    ASDIC_TERM_MULTIPATH,
    ASDIC_TERM_NOISE,
    ASDIC_TERM_REAR,
    ASDIC_TERM_BORIC_ACID,
    ASDIC_TERM_RAYS, /* left out: the scene is flat, quadrature tells all */
    ASDIC_TERM_COUNT
} asdic_term;

typedef struct asdic_plan_row {
    const char *name; /* "surface" */
    bool kept;
    double bound_db;  /* largest change of a level if left out; INFINITY: not bounded, 0: exact */
    char reason[160]; /* "the surface lies 80.0 m from the sonar, beyond 74.5 m" */
} asdic_plan_row;

typedef struct asdic_plan {
    asdic_plan_row rows[ASDIC_TERM_COUNT];
    unsigned left_out; /* 1u << asdic_term of rows not kept: goes into asdic_sampling.left_out */
} asdic_plan;

/* "surface"; never NULL. */
ASDIC_API const char *asdic_term_name(asdic_term term);

/* A term is left out when nothing of it can be received, or when its energy is so far below the
 * noise floor in every bin that the level changes by at most this, dB. */
#define ASDIC_PLAN_NEGLIGIBLE_DB 1e-3

/* Plans for a vehicle that takes COUNT >= 1 POSES in a committed SCENE. */
ASDIC_API asdic_status asdic_plan_make(asdic_context *ctx, const asdic_scene *scene,
                                       const asdic_environment *env, const asdic_sonar *sonar,
                                       const asdic_sampling *sampling, const asdic_pose *poses,
                                       size_t count, asdic_plan *out);

#ifdef __cplusplus
}
#endif

#endif
