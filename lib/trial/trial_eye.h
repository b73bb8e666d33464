/*
 * What a vehicle sees in a ping: simulated levels, and what a detector makes of them.
 */
#ifndef ASDIC_TRIAL_TRIAL_EYE_H
#define ASDIC_TRIAL_TRIAL_EYE_H

#include "mission/mission.h"

#include <asdic/loop.h>

#define ASDIC_EYE_PLACES 1024

/* Levels expected at a place. */
typedef struct eye_place {
    asdic_expected_place place;
    double *total_lin, *noise_lin; /* NULL: not computed yet */
} eye_place;

typedef struct asdic_eye {
    asdic_context *ctx;
    asdic_device *device;
    const asdic_mission *mission;
    asdic_loop *loop;
    asdic_scan *scan; /* kept from run to run with what it is made for: */
    bool scan_is_flat;
    asdic_cfar_kind scan_cfar;
    asdic_detector scan_detector;
    bool is_flat; /* a bin is compared with what is expected */
    struct asdic_ring_shelf *shelf;
    asdic_ping *scratch;
    /* Expected levels, kept from run to run as long as water and sonar stay the same. */
    eye_place places[ASDIC_EYE_PLACES];
    asdic_environment environment;
    asdic_sonar sonar;             /* with receivers of its own */
    size_t bins, known;            /* of a beam; of these, what is expected in the first */
    double *total_lin, *noise_lin; /* of a ping, NAN behind those */
} asdic_eye;

/* What a bin is compared with in trials of MISSION: its own choice, never ASDIC_TRIAL_AUTO. */
asdic_trial_background asdic_eye_background(const asdic_mission *mission);

/* EYE is zero but for ctx and device at first; the next run opens it again. DEPTH_M: of the sonar at
 * the first ping. Nothing is detected beyond REACH_M where levels are compared with what is expected,
 * since to expect them takes longer than to simulate them. */
asdic_status asdic_eye_open(asdic_eye *eye, const asdic_mission *mission, double depth_m,
                            double reach_m);

/* The ping at POSE of the vehicle; valid until the next. */
asdic_status asdic_eye_look(asdic_eye *eye, const asdic_pose *pose, asdic_loop_ping *ping,
                            asdic_scan_result *found);

/* Of a run; and of all. Safe on zeros. */
void asdic_eye_close(asdic_eye *eye);
void asdic_eye_finish(asdic_eye *eye);

#endif
