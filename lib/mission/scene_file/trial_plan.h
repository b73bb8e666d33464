/*
 * What a scene's `trial` section says but its draws.
 */
#ifndef ASDIC_SCENE_FILE_TRIAL_PLAN_H
#define ASDIC_SCENE_FILE_TRIAL_PLAN_H

#include <stdbool.h>

typedef enum asdic_trial_background {
    ASDIC_TRIAL_AUTO,
    ASDIC_TRIAL_FLAT,
    ASDIC_TRIAL_CA,
    ASDIC_TRIAL_OS
} asdic_trial_background;

typedef enum asdic_manoeuvre { ASDIC_HOLD, ASDIC_CLIMB, ASDIC_TURN } asdic_manoeuvre;

typedef struct asdic_trial_plan {
    double hull_radius_m;
    double time_s; /* NAN: by the flight */
    asdic_trial_background background;
    asdic_manoeuvre manoeuvre;
    double reach_m, sector_rad;
    double posterior; /* from which on the manoeuvre loses less */
    unsigned hits, of;
    double climb_m, turn_rad, hold_s;
    bool is_ideal; /* a sonar of these: */
    double pd, pfa;
} asdic_trial_plan;

#endif
