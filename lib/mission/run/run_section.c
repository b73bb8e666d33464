#include "run_section.h"

#include "base/vec.h"

#include <asdic/scan.h>

/* Sines of what a beam may stand out of the plane, and of what the plane's axis may stand out of the level. */
#define FLAT 0.01
#define STEEP 0.5

static asdic_vec3 axis_of(const asdic_beam *beam) {
    const asdic_pose level = {0};
    return asdic_beam_axis(beam, &level);
}

static asdic_vec3 unit(asdic_vec3 v) {
    return asdic_vec3_scale(v, 1.0 / asdic_vec3_length(v));
}

/* The axis about which the beams go round; of no length where they do not. */
static asdic_vec3 turning_axis(const asdic_sonar *sonar) {
    asdic_vec3 sum = {0};
    for (size_t i = 1; i < sonar->receiver_count; i++) {
        asdic_vec3 one = axis_of(&sonar->receivers[i - 1]), next = axis_of(&sonar->receivers[i]);
        sum = asdic_vec3_add(sum, asdic_vec3_cross(one, next));
    }
    return sum;
}

double asdic_section_bearing_rad(const asdic_section *s, const asdic_beam *beam, double near_rad) {
    asdic_vec3 u = axis_of(beam);
    double bearing_rad = atan2(asdic_vec3_dot(u, s->right), -asdic_vec3_dot(u, s->down));
    return near_rad + remainder(bearing_rad - near_rad, 2.0 * ASDIC_PI);
}

void asdic_section_bearings(const asdic_section *s, const asdic_sonar *sonar, double *bearing_rad) {
    size_t n = sonar->receiver_count;
    double last_rad = ASDIC_PI;
    for (size_t i = 0; i < n; i++) {
        size_t beam = s && s->is_reversed ? n - 1 - i : i;
        const asdic_beam *at = &sonar->receivers[beam];
        bearing_rad[beam] = s ? asdic_section_bearing_rad(s, at, last_rad) : at->yaw_rad;
        last_rad = bearing_rad[beam];
    }
}

size_t asdic_beam_ahead(const asdic_sonar *sonar) {
    asdic_section section;
    size_t best = 0;
    if (asdic_section_of(sonar, &section)) {
        return (sonar->receiver_count - 1) / 2;
    }
    for (size_t i = 1; i < sonar->receiver_count; i++) {
        bool is_nearer =
            axis_of(&sonar->receivers[i]).x > axis_of(&sonar->receivers[best]).x + 1e-12;
        best = is_nearer ? i : best;
    }
    return best;
}

/* Clockwise on the page, and less than once round. */
static bool goes_round(const asdic_section *s, const asdic_sonar *sonar) {
    size_t n = sonar->receiver_count;
    double first = 0.0, last = 0.0;
    for (size_t i = 0; i < n; i++) {
        const asdic_beam *beam = &sonar->receivers[s->is_reversed ? n - 1 - i : i];
        double bearing_rad = asdic_section_bearing_rad(s, beam, i == 0 ? ASDIC_PI : last);
        if (i > 0 && !(bearing_rad > last)) {
            return false;
        }
        first = i == 0 ? bearing_rad : first;
        last = bearing_rad;
    }
    return last - first < 2.0 * ASDIC_PI;
}

bool asdic_section_of(const asdic_sonar *sonar, asdic_section *out) {
    asdic_vec3 axis = turning_axis(sonar), down = {.z = 1.0};
    if (sonar->receiver_count < 3 || !(asdic_vec3_length(axis) > 1e-9)) {
        return false;
    }
    axis = unit(axis);
    for (size_t i = 0; i < sonar->receiver_count; i++) {
        if (fabs(asdic_vec3_dot(axis, axis_of(&sonar->receivers[i]))) > FLAT) {
            return false;
        }
    }
    if (fabs(axis.z) > STEEP) {
        return false;
    }
    down = unit(asdic_vec3_sub(down, asdic_vec3_scale(axis, axis.z)));
    /* About AXIS the beams turn from DOWN to this: counter-clockwise on a page that has it on its right. */
    asdic_vec3 right = asdic_vec3_cross(axis, down);
    bool is_starboard = fabs(right.y) > fabs(right.x);
    bool flips = (is_starboard ? right.y : right.x) < 0.0;
    *out = (asdic_section){.right = asdic_vec3_scale(right, flips ? -1.0 : 1.0),
                           .down = down,
                           .is_starboard = is_starboard,
                           .is_reversed = !flips};
    return goes_round(out, sonar);
}
