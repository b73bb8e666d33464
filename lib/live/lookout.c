#include "lookout.h"

#include "base/context.h"
#include "base/hash.h"
#include "base/try.h"
#include "base/vec.h"
#include "scene/scene.h"
#include "sim/expected.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Expected levels are those of a place on a grid, so that they are a function of that place alone,
 * whatever was flown before. The steps are fine: the echo from straight below ends at the
 * edge of a bin, and a beam of half a degree falls by up to 3 dB a mrad. */
#define STEP_M 1e-3
#define STEP_RAD (1e-4 * ASDIC_PI / 180.0)
/* Attitudes of which a beam's profile is kept, some 40 kB, and from one to the next. */
#define ATTITUDES 256
#define PROFILE_BYTES 4e4
#define PROFILE_STEP_RAD (0.05 * ASDIC_PI / 180.0)
/* What of many beams is kept at most, of attitudes and of places. */
#define MOST_BYTES 2.5e8

/* How many of MOST are kept of BYTES each. */
static size_t fit(size_t most, double bytes) {
    return (size_t)fmin(fmax(MOST_BYTES / bytes, 1.0), (double)most);
}

static void forget_places(asdic_lookout *lookout) {
    for (size_t i = 0; i < ASDIC_LOOKOUT_PLACES; i++) {
        free(lookout->places[i].total_lin);
        lookout->places[i] = (lookout_place){.total_lin = NULL};
    }
}

/* Whether the sonar, and what of a beam's bins is expected, are those of the mission before. */
static bool is_same_sonar(const asdic_lookout *lookout, const asdic_mission *mission, size_t bins,
                          size_t known) {
    const asdic_sonar *a = &lookout->sonar, *b = &mission->settings.sonar;
    if (bins != lookout->bins || known != lookout->known ||
        a->receiver_count != b->receiver_count) {
        return false;
    }
    asdic_sonar other = *b;
    other.receivers = a->receivers;
    return memcmp(&other, a, sizeof other) == 0 &&
           memcmp(a->receivers, b->receivers, a->receiver_count * sizeof *a->receivers) == 0;
}

static asdic_status remember(asdic_lookout *lookout, const asdic_mission *mission, size_t bins,
                             size_t known) {
    const asdic_sonar *sonar = &mission->settings.sonar;
    size_t bytes = sonar->receiver_count * sizeof *sonar->receivers;
    asdic_beam *receivers = malloc(bytes);
    size_t cells = sonar->receiver_count * bins;
    forget_places(lookout);
    asdic_ping_destroy(&lookout->scratch);
    free((asdic_beam *)lookout->sonar.receivers);
    free(lookout->total_lin);
    lookout->total_lin = malloc(2 * cells * sizeof(double));
    lookout->noise_lin = lookout->total_lin + cells;
    lookout->sonar = *sonar;
    lookout->sonar.receivers = receivers;
    lookout->bins = bins;
    lookout->known = known;
    if (!receivers || !lookout->total_lin) {
        return asdic_fail_memory(lookout->ctx, "a sonar");
    }
    memcpy(receivers, sonar->receivers, bytes);
    for (size_t i = 0; i < 2 * cells; i++) {
        lookout->total_lin[i] = NAN;
    }
    return asdic_ping_create(lookout->ctx, sonar->receiver_count, known, &lookout->scratch);
}

/* The detector of the mission; one that is there stays, since what it has tabulated holds on. */
static asdic_status need_scan(asdic_lookout *lookout, const asdic_cfar *cfar) {
    const asdic_detector *detector = &lookout->mission->settings.detector;
    if (lookout->scan && lookout->scan_is_flat == lookout->is_flat &&
        lookout->scan_cfar == cfar->kind &&
        memcmp(&lookout->scan_detector, detector, sizeof *detector) == 0) {
        return ASDIC_OK;
    }
    asdic_scan_destroy(&lookout->scan);
    lookout->scan_is_flat = lookout->is_flat;
    lookout->scan_cfar = cfar->kind;
    lookout->scan_detector = *detector;
    double speed_mps = asdic_environment_sound_speed_mps(&lookout->environment, 0.0);
    return asdic_scan_create(lookout->ctx, &lookout->sonar, speed_mps, lookout->bins, detector,
                             lookout->is_flat ? NULL : cfar, &lookout->scan);
}

static asdic_trial_background background_of(const asdic_mission *mission) {
    asdic_trial_background asked = mission->trial.background;
    return asked != ASDIC_TRIAL_AUTO            ? asked
           : asdic_mission_bottom_mesh(mission) ? ASDIC_TRIAL_OS
                                                : ASDIC_TRIAL_FLAT;
}

bool asdic_lookout_is_flat(const asdic_mission *mission) {
    return background_of(mission) == ASDIC_TRIAL_FLAT;
}

static void warn(asdic_context *ctx, bool is_wrong, bool *told, const char *words) {
    if (is_wrong && !*told) {
        asdic_log(ctx, ASDIC_LOG_WARNING, "%s", words);
        *told = true;
    }
}

void asdic_lookout_warn(asdic_context *ctx, const asdic_mission *mission,
                        bool told[ASDIC_LOOKOUT_WARNINGS]) {
    asdic_scene_info scene = asdic_scene_get_info(mission->scene);
    const asdic_settings *s = &mission->settings;
    bool has_mirror = scene.has_surface || scene.has_bottom_plane;
    bool is_flat = asdic_lookout_is_flat(mission);
    bool is_spiky = s->sonar.speckle == ASDIC_SPECKLE_K && !is_flat;
    bool mirrors = s->sampling.multipath == ASDIC_MULTIPATH_BOUNDARIES && has_mirror && is_flat;
    warn(ctx, is_spiky && isnan(s->detector.cost_ratio), &told[ASDIC_LOOKOUT_SPIKES],
         "thresholds are those of CFAR in Rayleigh speckle; K speckle exceeds them more often than "
         "P_FA says");
    warn(ctx, mirrors, &told[ASDIC_LOOKOUT_MIRRORS],
         "the detector expects no echoes that surface and bottom mirror ('multipath: boundaries') "
         "and takes them for targets");
}

/* What there is room for, of so many beams and known bins. */
static asdic_status need_room(asdic_lookout *lookout) {
    double beams = (double)lookout->sonar.receiver_count;
    size_t attitudes = fit(ATTITUDES, beams * PROFILE_BYTES);
    lookout->place_count =
        fit(ASDIC_LOOKOUT_PLACES, beams * (double)lookout->known * 2.0 * sizeof(double));
    if (lookout->shelf && lookout->shelf_attitudes == attitudes) {
        return ASDIC_OK;
    }
    asdic_ring_shelf_destroy(&lookout->shelf);
    lookout->shelf_attitudes = attitudes;
    return asdic_ring_shelf_create(lookout->ctx, attitudes, &lookout->shelf);
}

asdic_status asdic_lookout_open(asdic_lookout *lookout, const asdic_mission *mission, size_t bins,
                                double reach_m) {
    const asdic_settings *settings = &mission->settings;
    asdic_cfar cfar = asdic_cfar_default();
    size_t known = (size_t)fmin(ceil(reach_m / settings->sonar.bin_length_m) + 1.0, (double)bins);
    lookout->mission = mission;
    if (!is_same_sonar(lookout, mission, bins, known)) {
        asdic_scan_destroy(&lookout->scan);
        TRY(remember(lookout, mission, bins, known));
        TRY(need_room(lookout));
    }
    if (memcmp(&lookout->environment, &settings->environment, sizeof lookout->environment) != 0) {
        forget_places(lookout);
        lookout->environment = settings->environment;
    }
    lookout->is_flat = asdic_lookout_is_flat(mission);
    cfar.kind = background_of(mission) == ASDIC_TRIAL_CA ? ASDIC_CFAR_CA : ASDIC_CFAR_OS;
    TRY(need_scan(lookout, &cfar));
    asdic_scan_set_coherent(lookout->scan, settings->sampling.coherent);
    return ASDIC_OK;
}

/* The place of PING, on the grid. */
static asdic_expected_place place_of(const asdic_lookout *lookout, const asdic_loop_ping *ping) {
    asdic_expected_place place = {
        .flat = {.has_surface = asdic_scene_get_info(lookout->mission->scene).has_surface,
                 .bottom = lookout->mission->bottom,
                 .surface = lookout->mission->scene->surface}};
    asdic_loop_ping_place(ping, &place);
    asdic_pose sonar =
        asdic_sweep_sonar(&lookout->mission->settings.sweep, &ping->pose, ping->ping);
    return asdic_expected_place_on_grid(&place.flat, &sonar, STEP_M, STEP_RAD);
}

static size_t slot_of(const asdic_lookout *lookout, const asdic_expected_place *place) {
    const double key[4] = {place->flat.altitude_m, place->flat.depth_m, place->pose.pitch_rad,
                           place->pose.roll_rad};
    return asdic_hash_slot(key, sizeof key, lookout->place_count);
}

/* Copies what KEPT holds to where a scan reads it. */
static void spread(asdic_lookout *lookout, const lookout_place *kept) {
    size_t bytes = lookout->known * sizeof(double);
    for (size_t b = 0; b < lookout->sonar.receiver_count; b++) {
        memcpy(lookout->total_lin + b * lookout->bins, kept->total_lin + b * lookout->known, bytes);
        memcpy(lookout->noise_lin + b * lookout->bins, kept->noise_lin + b * lookout->known, bytes);
    }
}

/* What is expected where PING was, into the lookout's total and noise. */
static asdic_status expect(asdic_lookout *lookout, const asdic_loop_ping *ping) {
    const asdic_expected_place place = place_of(lookout, ping);
    lookout_place *kept = &lookout->places[slot_of(lookout, &place)];
    size_t cells = lookout->sonar.receiver_count * lookout->known;
    if (!kept->total_lin || !asdic_expected_is_near(&place, &kept->place, 0.0, 0.0)) {
        TRY(asdic_expected_compute_among(lookout->ctx, lookout->shelf, &place, PROFILE_STEP_RAD,
                                         &lookout->environment, &lookout->sonar, lookout->scratch));
        kept->total_lin = kept->total_lin ? kept->total_lin : malloc(2 * cells * sizeof(double));
        if (!kept->total_lin) {
            return asdic_fail_memory(lookout->ctx, "expected levels");
        }
        kept->noise_lin = kept->total_lin + cells;
        kept->place = place;
        memcpy(kept->total_lin, lookout->scratch->intensity_lin[ASDIC_TOTAL],
               cells * sizeof(double));
        memcpy(kept->noise_lin, lookout->scratch->intensity_lin[ASDIC_NOISE],
               cells * sizeof(double));
    }
    spread(lookout, kept);
    return ASDIC_OK;
}

/* A ping of the loop that LOOKOUT is for. */
static asdic_status check_ping(const asdic_lookout *lookout, const asdic_loop_ping *ping) {
    size_t beams = lookout->sonar.receiver_count;
    return ping->beams == beams && ping->bins == lookout->bins
               ? ASDIC_OK
               : asdic_fail(lookout->ctx, ASDIC_ERROR_ARGUMENT,
                            "a ping of %zu beams and %zu bins: the lookout is for %zu and %zu",
                            ping->beams, ping->bins, beams, lookout->bins);
}

asdic_status asdic_lookout_expect(asdic_lookout *lookout, const asdic_loop_ping *ping,
                                  const double **total_lin) {
    if (!lookout || !ping || !total_lin) {
        return asdic_fail_null(lookout ? lookout->ctx : NULL, __func__);
    }
    TRY(check_ping(lookout, ping));
    TRY(expect(lookout, ping));
    *total_lin = lookout->total_lin;
    return ASDIC_OK;
}

/* Before the first decision: who wants expected levels alone need not know. */
static void tell(asdic_lookout *lookout) {
    bool told[ASDIC_LOOKOUT_WARNINGS] = {false};
    if (lookout->tells && !lookout->is_flat &&
        lookout->mission->trial.background == ASDIC_TRIAL_AUTO) {
        asdic_log(lookout->ctx, ASDIC_LOG_WARNING,
                  "the bottom is no plane, over which levels are expected: bins are held against "
                  "their neighbours (OS-CFAR), whose P_FA is higher where levels step");
    }
    if (lookout->tells) {
        asdic_lookout_warn(lookout->ctx, lookout->mission, told);
    }
    lookout->tells = false;
}

asdic_status asdic_lookout_detect(asdic_lookout *lookout, const asdic_loop_ping *ping,
                                  asdic_scan_result *found) {
    if (!lookout || !ping || !found) {
        return asdic_fail_null(lookout ? lookout->ctx : NULL, __func__);
    }
    bool is_flat = lookout->is_flat;
    TRY(check_ping(lookout, ping));
    tell(lookout);
    if (is_flat) {
        TRY(expect(lookout, ping));
    }
    double z_m = ping->pose.position_m.z;
    asdic_scan_set_sound_speed(lookout->scan,
                               asdic_environment_sound_speed_mps(&lookout->environment, z_m));
    TRY(asdic_scan_ping(lookout->scan, ping->parts->intensity_lin[ASDIC_TOTAL],
                        is_flat ? lookout->total_lin : NULL,
                        is_flat ? lookout->noise_lin : ping->parts->intensity_lin[ASDIC_NOISE],
                        ping->parts->stderr_db));
    *found = asdic_scan_get(lookout->scan);
    return ASDIC_OK;
}

void asdic_lookout_finish(asdic_lookout *lookout) {
    asdic_scan_destroy(&lookout->scan);
    forget_places(lookout);
    asdic_ring_shelf_destroy(&lookout->shelf);
    asdic_ping_destroy(&lookout->scratch);
    free((asdic_beam *)lookout->sonar.receivers);
    lookout->sonar.receivers = NULL;
    free(lookout->total_lin);
    lookout->total_lin = NULL;
}

asdic_status asdic_lookout_create(asdic_context *ctx, const asdic_mission *mission, size_t bins,
                                  asdic_lookout **out) {
    if (!ASDIC_PLACE(out) || !mission || bins == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: a mission and bins are needed", __func__);
    }
    asdic_lookout *lookout = calloc(1, sizeof *lookout);
    if (!lookout) {
        return asdic_fail_memory(ctx, "a lookout");
    }
    lookout->ctx = ctx;
    lookout->tells = true;
    asdic_status status = asdic_lookout_open(lookout, mission, bins, INFINITY);
    if (status) {
        asdic_lookout_destroy(&lookout);
        return status;
    }
    *out = lookout;
    return ASDIC_OK;
}

void asdic_lookout_destroy(asdic_lookout **lookout) {
    if (lookout && *lookout) {
        asdic_lookout_finish(*lookout);
        free(*lookout);
        *lookout = NULL;
    }
}
