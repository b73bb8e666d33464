/*
 * How much of a profile a mission's rays follow: what simpler forms would leave out, and the choice.
 */
#include "mission.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "sim/bent_ray.h"
#include "sim/expected.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Places at which forms are compared, and beams; between them levels differ by a part of what they
 * differ by there. */
#define PLACES 5
#define BEAMS 3
#define SAFETY 1.25

/* Where nothing is below the sonar, or beside it. */
#define REACH_M 10.0

static const char *const names[] = {"full", "layer", "off"};

const char *asdic_refraction_name(asdic_refraction form) {
    return (unsigned)form <= ASDIC_REFRACTION_OFF ? names[form] : NULL;
}

/* ---- Depths ---- */

typedef struct depth_span {
    double least_m, most_m; /* of the sonar */
    double bottom_m;        /* the deepest below it; NAN: none */
    size_t shallow, deep;   /* pings of them */
} depth_span;

/* Pings looked at, at most, for their depth. */
#define MOST_LOOKS 1000

static depth_span find_span(const asdic_mission *m) {
    depth_span span = {INFINITY, -INFINITY, NAN, 0, 0};
    size_t count = asdic_mission_ping_count(m), looks = count < MOST_LOOKS ? count : MOST_LOOKS;
    for (size_t i = 0; i < looks; i++) {
        size_t ping = looks > 1 ? i * (count - 1) / (looks - 1) : 0;
        asdic_flat_scene flat = asdic_mission_flat_scene(m, ping);
        if (flat.depth_m < span.least_m) {
            span.least_m = flat.depth_m;
            span.shallow = ping;
        }
        if (flat.depth_m > span.most_m) {
            span.most_m = flat.depth_m;
            span.deep = ping;
        }
        if (flat.has_bottom) {
            span.bottom_m = fmax(span.bottom_m, flat.depth_m + flat.altitude_m);
        }
    }
    return span;
}

/* ENV in FORM, for the sonar's depths and those below it. */
static asdic_environment in_form(const asdic_environment *env, asdic_refraction form,
                                 const depth_span *span) {
    asdic_environment out = *env;
    bool has_bottom = !isnan(span->bottom_m);
    out.refraction = form;
    out.layer_from_m = fmax(has_bottom ? span->least_m : span->least_m - REACH_M, 0.0);
    out.layer_to_m = has_bottom ? span->bottom_m : span->most_m + REACH_M;
    return out;
}

void asdic_mission_refract(asdic_mission *mission, asdic_refraction form) {
    if (mission && (unsigned)form <= ASDIC_REFRACTION_OFF) {
        depth_span span = find_span(mission);
        mission->settings.refraction = (int)form;
        mission->settings.environment = in_form(&mission->settings.environment, form, &span);
    }
}

bool asdic_mission_plans_refraction(const asdic_mission *mission) {
    return mission && mission->settings.refraction < 0;
}

/* ---- What simpler forms leave out ---- */

typedef struct comparison {
    asdic_context *ctx;
    const asdic_mission *mission;
    asdic_sonar sonar;
    asdic_beam beams[BEAMS];
    depth_span span;
    asdic_ping *truth, *other;
} comparison;

static asdic_status expect(comparison *c, asdic_refraction form, const asdic_expected_place *at,
                           asdic_ping *out) {
    asdic_environment env = in_form(asdic_mission_environment(c->mission), form, &c->span);
    return asdic_expected_compute(c->ctx, &at->flat, &env, &c->sonar, &at->pose, out);
}

/* The largest change of any bin's total. */
static double change_db(const asdic_ping *truth, const asdic_ping *other) {
    double worst = 0.0;
    for (size_t i = 0; i < truth->beams * truth->bins; i++) {
        double a = truth->intensity_lin[ASDIC_TOTAL][i], b = other->intensity_lin[ASDIC_TOTAL][i];
        if (a > 0.0 || b > 0.0) {
            worst = fmax(worst, fabs(10.0 * log10(b / a)));
        }
    }
    return worst;
}

static asdic_status compare(comparison *c, const asdic_expected_place *at,
                            asdic_refraction_plan *out) {
    double *bounds[] = {
        [ASDIC_REFRACTION_LAYER] = &out->layer_db, [ASDIC_REFRACTION_OFF] = &out->off_db};
    TRY(expect(c, ASDIC_REFRACTION_FULL, at, c->truth));
    for (int form = ASDIC_REFRACTION_LAYER; form <= ASDIC_REFRACTION_OFF; form++) {
        TRY(expect(c, (asdic_refraction)form, at, c->other));
        *bounds[form] = fmax(*bounds[form], SAFETY * change_db(c->truth, c->other));
    }
    return ASDIC_OK;
}

/* The place of PING, for what is expected there. */
static asdic_expected_place place_at(const comparison *c, size_t ping) {
    asdic_flat_scene flat = asdic_mission_flat_scene(c->mission, ping);
    asdic_pose pose = asdic_mission_pose(c->mission, ping, NULL);
    return asdic_expected_place_on_grid(&flat, &pose, 0.0, 0.0);
}

static asdic_status compare_places(comparison *c, asdic_refraction_plan *out) {
    size_t count = asdic_mission_ping_count(c->mission);
    asdic_expected_place places[PLACES];
    double speed_mps =
        asdic_environment_sound_speed_mps(asdic_mission_environment(c->mission), c->span.least_m);
    size_t bins = asdic_sonar_bin_count(&c->sonar, speed_mps);
    TRY(asdic_ping_create(c->ctx, c->sonar.receiver_count, bins, &c->truth));
    TRY(asdic_ping_create(c->ctx, c->sonar.receiver_count, bins, &c->other));
    for (size_t i = 0; i < PLACES; i++) {
        size_t ping = i == 0 ? c->span.shallow : i == 1 ? c->span.deep : (i - 2) * (count - 1) / 2;
        bool is_new = true;
        places[i] = place_at(c, ping);
        for (size_t k = 0; k < i; k++) {
            is_new = is_new && !asdic_expected_is_near(&places[k], &places[i], 0.0, 0.0);
        }
        if (is_new) {
            TRY(compare(c, &places[i], out));
        }
    }
    return ASDIC_OK;
}

static void choose(asdic_refraction_plan *out) {
    bool none = out->off_db <= ASDIC_REFRACTION_NEGLIGIBLE_DB;
    bool one = out->layer_db <= ASDIC_REFRACTION_NEGLIGIBLE_DB;
    out->needed = none  ? ASDIC_REFRACTION_OFF
                  : one ? ASDIC_REFRACTION_LAYER
                        : ASDIC_REFRACTION_FULL;
    snprintf(out->reason, sizeof out->reason,
             "straight rays would change a level by up to %.3g dB, one layer fitted from %.4g to "
             "%.4g m by up to %.3g dB",
             out->off_db, out->layer_from_m, out->layer_to_m, out->layer_db);
}

asdic_status asdic_mission_refraction(asdic_context *ctx, const asdic_mission *mission,
                                      asdic_refraction_plan *out) {
    if (!mission || !out) {
        return asdic_fail_null(ctx, __func__);
    }
    *out = (asdic_refraction_plan){.needed = ASDIC_REFRACTION_OFF,
                                   .reason = "the sound speed is the same at all depths"};
    asdic_environment full = *asdic_mission_environment(mission);
    full.refraction = ASDIC_REFRACTION_FULL;
    if (!asdic_environment_bends(&full)) {
        return ASDIC_OK;
    }
    comparison c = {.ctx = ctx,
                    .mission = mission,
                    .sonar = *asdic_mission_sonar(mission),
                    .span = find_span(mission)};
    asdic_environment layer = in_form(&full, ASDIC_REFRACTION_LAYER, &c.span);
    size_t receivers = c.sonar.receiver_count, kept = receivers < BEAMS ? receivers : BEAMS;
    for (size_t b = 0; b < kept; b++) {
        c.beams[b] = c.sonar.receivers[kept > 1 ? b * (receivers - 1) / (kept - 1) : 0];
    }
    c.sonar.receivers = c.beams;
    c.sonar.receiver_count = kept;
    out->layer_from_m = layer.layer_from_m;
    out->layer_to_m = layer.layer_to_m;
    asdic_status status = compare_places(&c, out);
    asdic_ping_destroy(&c.truth);
    asdic_ping_destroy(&c.other);
    if (status == ASDIC_OK) {
        choose(out);
    }
    return status;
}
