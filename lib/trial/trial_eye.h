/*
 * What a vehicle sees in a ping: simulated levels, and what a detector makes of them.
 */
#ifndef ASDIC_TRIAL_TRIAL_EYE_H
#define ASDIC_TRIAL_TRIAL_EYE_H

#include "live/lookout.h"

typedef struct asdic_eye {
    asdic_device *device;
    asdic_loop *loop;
    asdic_lookout lookout;
} asdic_eye;

/* EYE is zero but for device and the lookout's ctx at first; the next run opens it again. DEPTH_M: of the
 * sonar at the first ping. REACH_M as of asdic_lookout_open. */
asdic_status asdic_eye_open(asdic_eye *eye, const asdic_mission *mission, double depth_m,
                            double reach_m);

/* The ping at POSE of the vehicle; valid until the next. */
asdic_status asdic_eye_look(asdic_eye *eye, const asdic_pose *pose, asdic_loop_ping *ping,
                            asdic_scan_result *found);

/* Of a run; and of all. Safe on zeros. */
void asdic_eye_close(asdic_eye *eye);
void asdic_eye_finish(asdic_eye *eye);

#endif
