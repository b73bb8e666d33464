/*
 * How much of a profile a mission's rays follow: what simpler forms would leave out, and the choice.
 */
#include "mission.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "scene/scene.h"
#include "sim/eigenray.h"
#include "sim/environment.h"
#include "sim/expected.h"
#include "sim/ring.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Places at which forms are compared, and beams; between them levels differ by a part of what they
 * differ by there. */
#define PLACES 5
#define BEAMS 3
#define SAFETY 1.25

/* Objects whose echoes are compared, at most. */
#define TARGETS 32

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

/* ---- Echoes of objects ---- */

/* The direct ray to an object's middle that spreads least. */
typedef struct sight {
    asdic_vec3 leaves; /* unit vector */
    double lin;        /* of what comes back from there; 0: none, in a shadow */
    double range_m;    /* at which it is heard */
} sight;

static sight look(const comparison *c, asdic_refraction form, asdic_vec3 from_m, asdic_vec3 to_m) {
    asdic_environment env = in_form(asdic_mission_environment(c->mission), form, &c->span);
    double top_m = c->mission->scene->has_surface ? 0.0 : -INFINITY;
    asdic_vec3 way_m = asdic_vec3_sub(to_m, from_m);
    double across_m = hypot(way_m.x, way_m.y);
    asdic_layers layers;
    asdic_eigenray rays[ASDIC_MOST_EIGENRAYS];
    asdic_layers_of(&env, from_m.z, &layers);
    size_t count = asdic_eigenrays_find(&layers, from_m.z, to_m.z, across_m, rays);
    for (size_t i = 0; i < count; i++) {
        if (asdic_eigenray_keeps_between(&layers, from_m.z, across_m, &rays[i], top_m, INFINITY)) {
            double range_m = asdic_environment_sound_speed_mps(&env, from_m.z) * rays[i].end.time_s;
            double spread = asdic_bent_ray_limited_m2(&rays[i].end, range_m);
            double aside = across_m > 0.0 ? cos(rays[i].elevation_rad) / across_m : 0.0;
            asdic_vec3 leaves = {aside * way_m.x, aside * way_m.y, sin(rays[i].elevation_rad)};
            return (sight){leaves, 1.0 / (spread * spread), range_m};
        }
    }
    return (sight){.lin = 0.0};
}

/* By how much what BEAM hears of A would change were it B. */
static double sight_change_db(double gain_a, const sight *a, double gain_b, const sight *b,
                              double bin_m) {
    double x = gain_a * a->lin, y = gain_b * b->lin;
    if (!(x > 0.0) && !(y > 0.0)) {
        return 0.0;
    }
    /* Of an echo that comes later a share goes into the next bin. */
    double later = x > 0.0 && y > 0.0 ? fabs(a->range_m - b->range_m) / bin_m : 0.0;
    return fabs(10.0 * log10(y / x)) + 10.0 * log10(1.0 + later);
}

/* What an object at TO does in the beam that hears it best. */
static void compare_target(const comparison *c, const asdic_pose *pose, asdic_vec3 to_m,
                           asdic_refraction_plan *out) {
    const asdic_sonar *sonar = asdic_mission_sonar(c->mission);
    asdic_water_column water =
        asdic_water_column_at(asdic_mission_environment(c->mission), sonar, pose->position_m.z);
    double rear_lin = pow(10.0, 0.1 * sonar->rear_floor_db), best = -1.0;
    double gains[ASDIC_REFRACTION_OFF + 1] = {0};
    sight sights[ASDIC_REFRACTION_OFF + 1];
    for (int form = 0; form <= ASDIC_REFRACTION_OFF; form++) {
        sights[form] = look(c, (asdic_refraction)form, pose->position_m, to_m);
    }
    /* In a shadow there is a beam that would hear it. */
    int best_form = sights[0].lin > 0.0 ? ASDIC_REFRACTION_FULL : ASDIC_REFRACTION_OFF;
    asdic_face transmitter = asdic_face_aim(&sonar->transmitter, pose, water.wavelength_m);
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        asdic_face receiver = asdic_face_aim(&sonar->receivers[b], pose, water.wavelength_m);
        double heard = asdic_face_gain(&receiver, sights[best_form].leaves, rear_lin);
        if (heard > best) {
            best = heard;
            for (int form = 0; form <= ASDIC_REFRACTION_OFF; form++) {
                gains[form] = asdic_face_gain(&transmitter, sights[form].leaves, rear_lin) *
                              asdic_face_gain(&receiver, sights[form].leaves, rear_lin);
            }
        }
    }
    double *bounds[] = {
        [ASDIC_REFRACTION_LAYER] = &out->layer_db, [ASDIC_REFRACTION_OFF] = &out->off_db};
    for (int form = ASDIC_REFRACTION_LAYER; form <= ASDIC_REFRACTION_OFF; form++) {
        double change =
            sight_change_db(gains[0], &sights[0], gains[form], &sights[form], sonar->bin_length_m);
        *bounds[form] = fmax(*bounds[form], SAFETY * change);
    }
}

static void compare_targets(const comparison *c, size_t ping, double range_m,
                            asdic_refraction_plan *out) {
    asdic_pose pose = asdic_mission_pose(c->mission, ping, NULL);
    size_t count = asdic_mission_object_count(c->mission);
    size_t step = (count + TARGETS - 1) / TARGETS;
    for (size_t i = 0; i < count; i += step) {
        const asdic_mission_object *o = asdic_mission_get_object(c->mission, i);
        asdic_vec3 middle_m = {0.5 * (o->min_m.x + o->max_m.x), 0.5 * (o->min_m.y + o->max_m.y),
                               0.5 * (o->min_m.z + o->max_m.z)};
        asdic_vec3 at_m =
            o->moves ? asdic_mission_object_pose(c->mission, i, ping).position_m : middle_m;
        bool is_bottom = o->name[0] == 0;
        double away_m = asdic_vec3_length(asdic_vec3_sub(at_m, pose.position_m));
        if (!is_bottom && away_m > 0.0 && away_m <= range_m) {
            compare_target(c, &pose, at_m, out);
        }
    }
}

/* ---- The choice ---- */

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
        compare_targets(c, ping, (double)bins * c->sonar.bin_length_m, out);
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

/* What a form does that leaves out what changes levels by DB. */
static void say_change(char *text, size_t size, double db) {
    if (isinf(db)) {
        snprintf(text, size, "move an object into or out of a shadow");
    } else {
        snprintf(text, size, "change a level by up to %.3g dB", db);
    }
}

static void choose(asdic_refraction_plan *out) {
    bool none = out->off_db <= ASDIC_REFRACTION_NEGLIGIBLE_DB;
    bool one = out->layer_db <= ASDIC_REFRACTION_NEGLIGIBLE_DB;
    char straight[48], layer[48];
    out->needed = none  ? ASDIC_REFRACTION_OFF
                  : one ? ASDIC_REFRACTION_LAYER
                        : ASDIC_REFRACTION_FULL;
    say_change(straight, sizeof straight, out->off_db);
    say_change(layer, sizeof layer, out->layer_db);
    snprintf(out->reason, sizeof out->reason,
             "straight rays would %s, one layer fitted from %.4g to %.4g m would %s", straight,
             out->layer_from_m, out->layer_to_m, layer);
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
