/*
 * Where a ping's time goes.
 */
#include "simulator.h"

#include "base/clock.h"
#include "base/context.h"

const char *asdic_phase_name(asdic_phase phase) {
    static const char *const names[ASDIC_PHASE_COUNT] = {"sample",  "trace",  "shade", "bounce",
                                                         "collect", "reduce", "levels"};
    return phase < ASDIC_PHASE_COUNT ? names[phase] : "?";
}

asdic_status asdic_simulator_end_phase(asdic_simulator *sim, asdic_phase phase) {
    if (!sim->phase_s) {
        return ASDIC_OK;
    }
    asdic_status status = asdic_device_finish(sim->device);
    double now_s = asdic_clock_s();
    sim->phase_s[phase] += now_s - sim->phase_from_s;
    sim->phase_from_s = now_s;
    return status;
}

asdic_status asdic_simulator_profile(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                     asdic_ping *ping, double *seconds) {
    if (!sim || !seconds) {
        return asdic_fail(sim ? sim->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_simulator_profile: NULL argument");
    }
    sim->phase_s = seconds;
    sim->phase_from_s = asdic_clock_s();
    asdic_status status = asdic_simulator_ping(sim, pose, index, ping);
    asdic_status ended = asdic_simulator_end_phase(sim, ASDIC_PHASE_LEVELS);
    sim->phase_s = NULL;
    return status ? status : ended;
}
