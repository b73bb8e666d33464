/*
 * Where rays matter is learnt by elevation, so that over planes a yaw changes nothing, while a pitch moves lobes and
 * nulls to elevations that have few rays. Of many receivers the stated error, too, is that of where it was learnt. What a
 * pitch of 7 degrees did to a fan of 48 beams 17 degrees high: errors of 0.22 dB grew to 1.5, with 0.24 stated; 1
 * degree did nothing. Few receivers state what their own rays show: 3 beams 11 degrees high stood 4 degrees.
 * In layers a climb bends rays otherwise: of a beam that rose by a metre out of a layer of 15 1/s, echoes 59 m off were 23
 * dB too low and stated 0.1. The farthest rays may turn by no more than they do in straight water that is climbed through.
 * Over terrain what is far and near changes as the vehicle goes on: 6 m above it the rays of 96 beams erred by 2.3 dB
 * after 4 m where newly learnt ones would by 2.1, after 8 m by 3.1 and 1.9; of 8 beams by 1.4 and 1.0 after 12 m.
 * Past objects a yaw brings others into the beams, as the head of a scanning sonar does from ping to ping: a beam 2.5
 * degrees wide that had turned along a quay by up to 40 degrees stated 1.2 dB where it erred by 2.3, and 5 % of its bins
 * by more than five times what they stated; learnt anew each ping 0.5 % do.
 */
#include "lesson.h"

#include "aim.h"
#include "base/vec.h"
#include "beam_fan.h"
#include "layers.h"

/* These parts of a beam's height, and of the way to the nearer of bottom and surface, change little: of many
 * receivers, of few. */
#define TURN_MANY 0.08
#define TURN_FEW 0.25
/* And these of its width, of a yaw. */
#define YAW_MANY 0.1
#define YAW_FEW 0.25
#define CLIMB_MANY 0.1
#define CLIMB_FEW 0.3
/* So many times the way to the bottom is not far to go over terrain, or past objects. */
#define WAY_MANY 0.5
#define WAY_FEW 1.5
/* Nearer than this a boundary is met at grazing angles alone. */
#define NEAREST_M 1.0
/* With this cosine from the vertical, or less, a beam looks straight up or down. */
#define UPRIGHT 0.05

/* Main lobe to first null of an aperture that is LENGTH_WL long that way. */
static double lobe_rad(double length_wl) {
    return 1.0 / fmax(length_wl, 1.0 / ASDIC_PI);
}

/* How high a beam reaches in elevation. */
static double height_rad(const dev_beam *beam) {
    double across = hypot(beam->rows[5], beam->rows[8]);
    return lobe_rad(
        across > UPRIGHT
            ? hypot(beam->length_h_wl * beam->rows[5], beam->length_v_wl * beam->rows[8]) / across
            : fmax(beam->length_h_wl, beam->length_v_wl));
}

/* How wide it reaches in azimuth. */
static double width_rad(const dev_beam *beam) {
    double level = hypot(beam->rows[0], beam->rows[1]);
    if (!(level > UPRIGHT)) {
        return ASDIC_PI;
    }
    double x = -beam->rows[1] / level, y = beam->rows[0] / level;
    double h = beam->length_h_wl * (beam->rows[3] * x + beam->rows[4] * y),
           v = beam->length_v_wl * (beam->rows[6] * x + beam->rows[7] * y);
    return fmin(lobe_rad(hypot(h, v)) / level, ASDIC_PI);
}

asdic_lesson_reach asdic_lesson_reach_of(const asdic_sonar *sonar) {
    const asdic_pose level = {{0.0, 0.0, 0.0}, 0.0, 0.0, 0.0};
    double wavelength_m = ASDIC_NOMINAL_MPS / sonar->frequency_hz, lowest = 1.0, highest = -1.0;
    dev_beam transmitter = asdic_aim_beam(&sonar->transmitter, &level, wavelength_m);
    double least_height = ASDIC_PI, least_width = ASDIC_PI;
    double left = INFINITY, right = -INFINITY;
    for (size_t r = 0; r < sonar->receiver_count; r++) {
        dev_beam beam = asdic_aim_beam(&sonar->receivers[r], &level, wavelength_m);
        double turn =
            remainder(sonar->receivers[r].yaw_rad - sonar->receivers[0].yaw_rad, 2.0 * ASDIC_PI);
        lowest = fmin(lowest, beam.rows[2]);
        highest = fmax(highest, beam.rows[2]);
        left = fmin(left, turn);
        right = fmax(right, turn);
        least_height = fmin(least_height, height_rad(&beam));
        least_width = fmin(least_width, width_rad(&beam));
    }
    double spread = asin(fmin(highest, 1.0)) - asin(fmax(lowest, -1.0));
    return (asdic_lesson_reach){fmin(height_rad(&transmitter), spread + least_height),
                                fmin(width_rad(&transmitter), right - left + least_width),
                                asdic_sonar_max_range_m(sonar, ASDIC_NOMINAL_MPS),
                                asdic_beam_fan_is_wanted(sonar)};
}

asdic_lesson asdic_lesson_at(const asdic_scene *scene, const asdic_environment *env,
                             const asdic_lesson_reach *reach, const asdic_pose *pose) {
    bool many = reach->many;
    asdic_scene_info info = asdic_scene_get_info(scene);
    bool is_even = info.triangles == 0;
    double altitude_m = asdic_scene_altitude_m(scene, pose->position_m), boundary = altitude_m;
    if (info.has_surface) {
        boundary = fmin(boundary, pose->position_m.z);
    }
    return (asdic_lesson){
        .pose = *pose,
        .turn_rad = (many ? TURN_MANY : TURN_FEW) * reach->height_rad,
        .yaw_rad = is_even ? INFINITY : (many ? YAW_MANY : YAW_FEW) * reach->width_rad,
        .climb_m = (many ? CLIMB_MANY : CLIMB_FEW) * fmax(boundary, NEAREST_M),
        .way_m = is_even ? INFINITY : (many ? WAY_MANY : WAY_FEW) * fmax(altitude_m, NEAREST_M),
        .is_even = is_even,
        .env = env,
        .range_m = reach->range_m,
        .top_m = info.has_surface ? 0.0 : -INFINITY,
        .bottom_m = is_even ? pose->position_m.z + altitude_m : INFINITY,
    };
}

/* Downwards in the vehicle's axes. */
static asdic_vec3 down_of(const asdic_pose *pose) {
    const asdic_mat3 to_world = asdic_mat3_attitude(pose->roll_rad, pose->pitch_rad, 0.0);
    return (asdic_vec3){to_world.m[2][0], to_world.m[2][1], to_world.m[2][2]};
}

asdic_lesson asdic_lesson_none(void) {
    return (asdic_lesson){.turn_rad = INFINITY,
                          .yaw_rad = INFINITY,
                          .climb_m = INFINITY,
                          .way_m = INFINITY,
                          .is_even = true};
}

/* By how much a ray that crosses what is AWAY_M below the vehicle leaves it higher or lower, at most, than it did where
 * LESSON was learnt: where the sound speed is c less than at the vehicle, c0, an elevation e becomes that of the square
 * e^2 + 2 c / c0, and to come there within the range e is no less than AWAY_M over it. */
static double turned_rad(const asdic_lesson *lesson, const asdic_layers *layers, double depth_m,
                         double away_m) {
    if (fabs(away_m) > lesson->range_m) {
        return 0.0;
    }
    double then_m = lesson->pose.position_m.z, speed_mps = asdic_layers_speed_mps(layers, then_m);
    double then = asdic_layers_speed_mps(layers, then_m + away_m) - speed_mps;
    double now =
        asdic_layers_speed_mps(layers, depth_m + away_m) - asdic_layers_speed_mps(layers, depth_m);
    double change = fabs(now - then) / speed_mps;
    return fmin(sqrt(2.0 * change), change * lesson->range_m / fabs(away_m));
}

/* How far the vehicle would have to climb through straight water to turn the farthest rays as layers do at DEPTH_M, which
 * turn them most where one ends in the water, seen from either depth. */
static double bent_m(const asdic_lesson *lesson, double depth_m) {
    double then_m = lesson->pose.position_m.z, most_rad = 0.0;
    if (!lesson->env || depth_m == then_m) {
        return 0.0;
    }
    asdic_layers layers;
    asdic_layers_of(lesson->env, depth_m, &layers);
    for (size_t i = 0; i + 1 < layers.count; i++) {
        double end_m = layers.layer[i].bottom_m;
        if (end_m <= lesson->top_m || end_m >= lesson->bottom_m) {
            continue;
        }
        double now_rad = turned_rad(lesson, &layers, depth_m, end_m - depth_m);
        double then_rad = turned_rad(lesson, &layers, depth_m, end_m - then_m);
        most_rad = fmax(most_rad, fmax(now_rad, then_rad));
    }
    return most_rad * lesson->range_m;
}

static bool serves(const asdic_lesson *lesson, const asdic_pose *pose) {
    asdic_vec3 then = down_of(&lesson->pose), now = down_of(pose);
    double turn_rad = hypot(hypot(now.x - then.x, now.y - then.y), now.z - then.z);
    asdic_vec3 way_m = asdic_vec3_sub(pose->position_m, lesson->pose.position_m);
    double yaw_rad = remainder(pose->yaw_rad - lesson->pose.yaw_rad, 2.0 * ASDIC_PI);
    return turn_rad <= lesson->turn_rad && fabs(yaw_rad) <= lesson->yaw_rad &&
           fabs(way_m.z) <= lesson->climb_m && hypot(way_m.x, way_m.y) <= lesson->way_m &&
           bent_m(lesson, pose->position_m.z) <= lesson->climb_m;
}

bool asdic_lesson_is_due(const asdic_lesson *lesson, const asdic_pose *pose, uint64_t index) {
    return index % ASDIC_LEARN_BLOCK == 0 || !serves(lesson, pose);
}
