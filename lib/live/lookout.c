#include "trial_eye.h"

#include "base/context.h"
#include "base/hash.h"
#include "base/try.h"
#include "base/vec.h"
#include "scene/scene.h"
#include "sim/expected.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Expected levels are those of the nearest place on a grid, so that they are a function of the place
 * alone, whatever was flown before. The steps are fine: the echo from straight below ends at the
 * edge of a bin, and a beam of half a degree falls by up to 3 dB a mrad. */
#define STEP_M 1e-3
#define STEP_RAD (1e-4 * ASDIC_PI / 180.0)
/* Attitudes of which a beam's profile is kept, some 40 kB, and from one to the next. */
#define ATTITUDES 256
#define PROFILE_STEP_RAD (0.05 * ASDIC_PI / 180.0)

static void forget_places(asdic_eye *eye) {
    for (size_t i = 0; i < ASDIC_EYE_PLACES; i++) {
        free(eye->places[i].total_lin);
        eye->places[i] = (eye_place){.total_lin = NULL};
    }
}

/* Whether the sonar, and what of a beam's bins is expected, are those of the run before. */
static bool is_same_sonar(const asdic_eye *eye, const asdic_mission *mission, size_t bins,
                          size_t known) {
    const asdic_sonar *a = &eye->sonar, *b = &mission->settings.sonar;
    if (bins != eye->bins || known != eye->known || a->receiver_count != b->receiver_count) {
        return false;
    }
    asdic_sonar other = *b;
    other.receivers = a->receivers;
    return memcmp(&other, a, sizeof other) == 0 &&
           memcmp(a->receivers, b->receivers, a->receiver_count * sizeof *a->receivers) == 0;
}

static asdic_status remember(asdic_eye *eye, const asdic_mission *mission, size_t bins,
                             size_t known) {
    const asdic_sonar *sonar = &mission->settings.sonar;
    size_t bytes = sonar->receiver_count * sizeof *sonar->receivers;
    asdic_beam *receivers = malloc(bytes);
    size_t cells = sonar->receiver_count * bins;
    forget_places(eye);
    asdic_ping_destroy(&eye->scratch);
    free((asdic_beam *)eye->sonar.receivers);
    free(eye->total_lin);
    eye->total_lin = malloc(2 * cells * sizeof(double));
    eye->noise_lin = eye->total_lin + cells;
    eye->sonar = *sonar;
    eye->sonar.receivers = receivers;
    eye->bins = bins;
    eye->known = known;
    if (!receivers || !eye->total_lin) {
        return asdic_fail_memory(eye->ctx, "a sonar");
    }
    memcpy(receivers, sonar->receivers, bytes);
    for (size_t i = 0; i < 2 * cells; i++) {
        eye->total_lin[i] = NAN;
    }
    return asdic_ping_create(eye->ctx, sonar->receiver_count, known, &eye->scratch);
}

/* The detector of the mission; one that is there stays, since what it has tabulated holds on. */
static asdic_status need_scan(asdic_eye *eye, const asdic_cfar *cfar, double speed_mps) {
    const asdic_detector *detector = &eye->mission->settings.detector;
    if (eye->scan && eye->scan_is_flat == eye->is_flat && eye->scan_cfar == cfar->kind &&
        memcmp(&eye->scan_detector, detector, sizeof *detector) == 0) {
        return ASDIC_OK;
    }
    asdic_scan_destroy(&eye->scan);
    eye->scan_is_flat = eye->is_flat;
    eye->scan_cfar = cfar->kind;
    eye->scan_detector = *detector;
    return asdic_scan_create(eye->ctx, &eye->sonar, speed_mps, eye->bins, detector,
                             eye->is_flat ? NULL : cfar, &eye->scan);
}

asdic_trial_background asdic_eye_background(const asdic_mission *mission) {
    asdic_trial_background asked = mission->trial.background;
    return asked != ASDIC_TRIAL_AUTO            ? asked
           : asdic_mission_bottom_mesh(mission) ? ASDIC_TRIAL_OS
                                                : ASDIC_TRIAL_FLAT;
}

asdic_status asdic_eye_open(asdic_eye *eye, const asdic_mission *mission, double depth_m,
                            double reach_m) {
    const asdic_sonar *sonar = &mission->settings.sonar;
    asdic_cfar cfar = asdic_cfar_default();
    asdic_trial_background background = asdic_eye_background(mission);
    eye->mission = mission;
    if (!eye->shelf) {
        TRY(asdic_ring_shelf_create(eye->ctx, ATTITUDES, &eye->shelf));
    }
    TRY(asdic_loop_create_mission(eye->ctx, eye->device, mission, depth_m, 0.0, &eye->loop));
    size_t bins = asdic_loop_bin_count(eye->loop);
    size_t known = (size_t)fmin(ceil(reach_m / sonar->bin_length_m) + 1.0, (double)bins);
    if (!is_same_sonar(eye, mission, bins, known)) {
        asdic_scan_destroy(&eye->scan);
        TRY(remember(eye, mission, bins, known));
    }
    if (memcmp(&eye->environment, &mission->settings.environment, sizeof eye->environment) != 0) {
        forget_places(eye);
        eye->environment = mission->settings.environment;
    }
    eye->is_flat = background == ASDIC_TRIAL_FLAT;
    cfar.kind = background == ASDIC_TRIAL_CA ? ASDIC_CFAR_CA : ASDIC_CFAR_OS;
    double speed_mps = asdic_environment_sound_speed_mps(&mission->settings.environment, depth_m);
    return need_scan(eye, &cfar, speed_mps);
}

/* The place of PING, on the grid. */
static asdic_expected_place place_of(const asdic_eye *eye, const asdic_loop_ping *ping) {
    asdic_expected_place place = {
        .flat = {.has_surface = asdic_scene_get_info(eye->mission->scene).has_surface,
                 .bottom = eye->mission->bottom,
                 .surface = eye->mission->scene->surface}};
    asdic_loop_ping_place(ping, &place);
    asdic_pose sonar = asdic_sweep_sonar(&eye->mission->settings.sweep, &ping->pose, ping->ping);
    return asdic_expected_place_on_grid(&place.flat, &sonar, STEP_M, STEP_RAD);
}

static size_t slot_of(const asdic_expected_place *place) {
    const double key[4] = {place->flat.altitude_m, place->flat.depth_m, place->pose.pitch_rad,
                           place->pose.roll_rad};
    return asdic_hash_slot(key, sizeof key, ASDIC_EYE_PLACES);
}

/* Copies what KEPT holds to where a scan reads it. */
static void spread(asdic_eye *eye, const eye_place *kept) {
    size_t bytes = eye->known * sizeof(double);
    for (size_t b = 0; b < eye->sonar.receiver_count; b++) {
        memcpy(eye->total_lin + b * eye->bins, kept->total_lin + b * eye->known, bytes);
        memcpy(eye->noise_lin + b * eye->bins, kept->noise_lin + b * eye->known, bytes);
    }
}

/* What is expected at PLACE, into the eye's total and noise. */
static asdic_status expect(asdic_eye *eye, const asdic_expected_place *place) {
    eye_place *kept = &eye->places[slot_of(place)];
    size_t cells = eye->sonar.receiver_count * eye->known;
    if (!kept->total_lin || !asdic_expected_is_near(place, &kept->place, 0.0, 0.0)) {
        TRY(asdic_expected_compute_among(eye->ctx, eye->shelf, place, PROFILE_STEP_RAD,
                                         &eye->environment, &eye->sonar, eye->scratch));
        kept->total_lin = kept->total_lin ? kept->total_lin : malloc(2 * cells * sizeof(double));
        if (!kept->total_lin) {
            return asdic_fail_memory(eye->ctx, "expected levels");
        }
        kept->noise_lin = kept->total_lin + cells;
        kept->place = *place;
        memcpy(kept->total_lin, eye->scratch->intensity_lin[ASDIC_TOTAL], cells * sizeof(double));
        memcpy(kept->noise_lin, eye->scratch->intensity_lin[ASDIC_NOISE], cells * sizeof(double));
    }
    spread(eye, kept);
    return ASDIC_OK;
}

asdic_status asdic_eye_look(asdic_eye *eye, const asdic_pose *pose, asdic_loop_ping *ping,
                            asdic_scan_result *found) {
    TRY(asdic_loop_submit(eye->loop, pose));
    TRY(asdic_loop_collect(eye->loop, ping));
    if (eye->is_flat) {
        asdic_expected_place place = place_of(eye, ping);
        TRY(expect(eye, &place));
    }
    asdic_scan_set_sound_speed(
        eye->scan, asdic_environment_sound_speed_mps(&eye->environment, pose->position_m.z));
    TRY(asdic_scan_ping(eye->scan, ping->parts->intensity_lin[ASDIC_TOTAL],
                        eye->is_flat ? eye->total_lin : NULL,
                        eye->is_flat ? eye->noise_lin : ping->parts->intensity_lin[ASDIC_NOISE],
                        ping->parts->stderr_db));
    *found = asdic_scan_get(eye->scan);
    return ASDIC_OK;
}

void asdic_eye_close(asdic_eye *eye) {
    asdic_loop_destroy(&eye->loop);
}

void asdic_eye_finish(asdic_eye *eye) {
    asdic_eye_close(eye);
    asdic_scan_destroy(&eye->scan);
    forget_places(eye);
    asdic_ring_shelf_destroy(&eye->shelf);
    asdic_ping_destroy(&eye->scratch);
    free((asdic_beam *)eye->sonar.receivers);
    eye->sonar.receivers = NULL;
    free(eye->total_lin);
    eye->total_lin = NULL;
}
