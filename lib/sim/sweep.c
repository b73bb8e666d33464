#include <asdic/sweep.h>

#include "base/vec.h"

#include <math.h>

#define MOST_STEPS 1e6

asdic_sweep asdic_sweep_of(double sector_rad, double step_rad) {
    double count = sector_rad / step_rad;
    /* Degrees of a scene file may leave a step longer than its sector by their rounding. */
    if (!(step_rad > 0.0) || !(count >= 1.0 - 1e-6 && count <= MOST_STEPS)) {
        return (asdic_sweep){0};
    }
    bool is_circle = sector_rad > 2.0 * ASDIC_PI - 1e-9;
    size_t steps = (size_t)rint(count);
    return (asdic_sweep){.directions = steps + (is_circle ? 0 : 1),
                         .step_rad = sector_rad / (double)steps,
                         .is_circle = is_circle};
}

size_t asdic_sweep_direction(const asdic_sweep *sweep, uint64_t ping) {
    size_t n = sweep ? sweep->directions : 0;
    if (n < 2) {
        return 0;
    }
    if (sweep->is_circle) {
        return (size_t)(ping % n);
    }
    size_t place = (size_t)(ping % (2 * (n - 1))); /* there and back */
    return place < n ? place : 2 * (n - 1) - place;
}

double asdic_sweep_bearing_rad(const asdic_sweep *sweep, size_t direction) {
    if (!sweep || sweep->directions == 0) {
        return 0.0;
    }
    size_t steps = sweep->is_circle ? sweep->directions : sweep->directions - 1;
    return ((double)direction - 0.5 * (double)steps) * sweep->step_rad;
}

/* ANGLE plus the whole turns that bring it nearest to GUESS. */
static double near(double angle_rad, double guess_rad) {
    return guess_rad + remainder(angle_rad - guess_rad, 2.0 * ASDIC_PI);
}

/* POSE turned about its own z axis: its attitude times a yaw, taken apart again into yaw, pitch and
 * roll, each without a jump of a whole turn. Pitch and roll are those of what is left without the yaw,
 * whatever that is where the axis is vertical. */
static asdic_pose turn(const asdic_pose *pose, double angle_rad) {
    asdic_pose out = *pose;
    out.yaw_rad += angle_rad;
    if (pose->roll_rad == 0.0 && pose->pitch_rad == 0.0) {
        return out;
    }
    asdic_mat3 m =
        asdic_mat3_multiply(asdic_mat3_of(pose), asdic_mat3_attitude(0.0, 0.0, angle_rad));
    double yaw_rad = atan2(m.m[1][0], m.m[0][0]);
    asdic_mat3 rest = asdic_mat3_multiply(asdic_mat3_attitude(0.0, 0.0, -yaw_rad), m);
    out.yaw_rad = near(yaw_rad, out.yaw_rad);
    out.pitch_rad = atan2(-rest.m[2][0], rest.m[0][0]);
    out.roll_rad = atan2(-rest.m[1][2], rest.m[1][1]);
    return out;
}

static double angle_at(const asdic_sweep *sweep, uint64_t ping) {
    return asdic_sweep_bearing_rad(sweep, asdic_sweep_direction(sweep, ping));
}

asdic_pose asdic_sweep_sonar(const asdic_sweep *sweep, const asdic_pose *vehicle, uint64_t ping) {
    if (!vehicle) {
        return (asdic_pose){0};
    }
    return sweep && sweep->directions ? turn(vehicle, angle_at(sweep, ping)) : *vehicle;
}

asdic_pose asdic_sweep_vehicle(const asdic_sweep *sweep, const asdic_pose *sonar, uint64_t ping) {
    if (!sonar) {
        return (asdic_pose){0};
    }
    return sweep && sweep->directions ? turn(sonar, -angle_at(sweep, ping)) : *sonar;
}
