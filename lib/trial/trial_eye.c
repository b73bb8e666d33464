#include "trial_eye.h"

#include "base/try.h"

asdic_status asdic_eye_open(asdic_eye *eye, const asdic_mission *mission, double depth_m,
                            double reach_m) {
    TRY(asdic_loop_create_mission(eye->lookout.ctx, eye->device, mission, depth_m, 0.0,
                                  &eye->loop));
    return asdic_lookout_open(&eye->lookout, mission, asdic_loop_bin_count(eye->loop), reach_m);
}

asdic_status asdic_eye_look(asdic_eye *eye, const asdic_pose *pose, asdic_loop_ping *ping,
                            asdic_scan_result *found) {
    TRY(asdic_loop_submit(eye->loop, pose));
    TRY(asdic_loop_collect(eye->loop, ping));
    return asdic_lookout_detect(&eye->lookout, ping, found);
}

void asdic_eye_close(asdic_eye *eye) {
    asdic_loop_destroy(&eye->loop);
}

void asdic_eye_finish(asdic_eye *eye) {
    asdic_eye_close(eye);
    asdic_lookout_finish(&eye->lookout);
}
