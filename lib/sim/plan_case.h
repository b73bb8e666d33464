/*
 * What the rules of a plan share: the poses it is for, and a row to fill in.
 */
#ifndef ASDIC_SIM_PLAN_CASE_H
#define ASDIC_SIM_PLAN_CASE_H

#include <asdic/plan.h>

#include "environment.h"

/* What the rules look at. */
typedef struct asdic_plan_case {
    const asdic_scene *scene;
    const asdic_environment *env;
    const asdic_sonar *sonar;
    const asdic_sampling *sampling;
    const asdic_pose *poses;
    size_t count;
    asdic_water_column water; /* where the mission begins */
    double noise_lin;         /* least of any bin; 0: none */
    double depth_least_m, depth_most_m;
    double altitude_least_m; /* above a bottom plane; INFINITY without one */
    double range_m, from_m;  /* what is heard, pulses included, see pulse.h */
    /* Whether rays bend; how far what is heard within range may lie: farther where the water on the
     * way is faster than at the sonar. */
    bool bends;
    double reach_m;
} asdic_plan_case;

void asdic_plan_row_set(asdic_plan *plan, asdic_term term, bool kept, double bound_db,
                        const char *format, ...) __attribute__((format(printf, 5, 6)));

/* How much an energy E added to a bin of noise N changes its level, dB; INFINITY without noise. */
double asdic_plan_change_db(double energy, double noise);

/* Whether anything in the scene can pass a mirror ray on. */
bool asdic_scene_mirrors(const asdic_scene *scene, asdic_multipath multipath,
                         const asdic_law_water *water);

/* The rules on objects and on multipath. */
void asdic_plan_objects(const asdic_plan_case *c, asdic_plan *plan);

#endif
