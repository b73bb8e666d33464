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
#include "sim/plan_case.h"
#include "sim/ring.h"

#include <math.h>
#include <stdio.h>

/* Places at which forms are compared, and beams; between them levels differ by a part of what they
 * differ by there. */
#define PLACES 5
#define BEAMS 3
#define SAFETY 1.25
#define FORMS (ASDIC_REFRACTION_OFF + 1)

/* Parts of a bin by which echoes may shift in each of two forms before levels are compared: what falls on
 * one side of an edge or the other, by less than any user measures, is no change. */
#define SHIFT (1.0 / 40.0)

/* Wavelengths of an aperture that is wide in the horizontal. A wider one sees the same elevations at
 * lower levels, in every form. */
#define WIDEST_WL 64.0

/* Objects whose echoes are compared, at most. */
#define TARGETS 32

/* Where nothing is below the sonar, or beside it; one that is no higher above the bottom than NEAR_M lies on it. */
#define REACH_M 10.0
#define NEAR_M 0.1

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

/* ENV in FORM, for the sonar's depths and those below it; above it where it lies on the bottom. */
static asdic_environment in_form(const asdic_environment *env, asdic_refraction form,
                                 const depth_span *span) {
    asdic_environment out = *env;
    bool has_bottom = !isnan(span->bottom_m);
    bool is_above = span->bottom_m - span->least_m > NEAR_M;
    out.refraction = form;
    out.layer_from_m = fmax(is_above ? span->least_m : span->least_m - REACH_M, 0.0);
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
    asdic_expected_place places[PLACES];
    bool are_new[PLACES]; /* unlike those before */
    size_t bins;
    asdic_ring_shelf *shelf;
    asdic_ping *truths[PLACES], *other; /* NULL: not yet */
    size_t expected;                    /* pings so far */
    bool decides; /* for the choice alone: what is known to matter is looked at no longer */
} comparison;

static asdic_status expect(comparison *c, asdic_refraction form, const asdic_expected_place *at,
                           asdic_ping *out) {
    asdic_environment env = in_form(asdic_mission_environment(c->mission), form, &c->span);
    TRY(asdic_step(c->ctx, "expected pings", c->expected++, PLACES * FORMS));
    return asdic_expected_compute_among(c->ctx, c->shelf, at, 0.0, &env, &c->sonar, out);
}

/* The levels that bin N of so many would have were all echoes of LIN nearer or farther by up to SHIFT. */
static void levels_about(const double *lin, size_t n, size_t bins, double *low, double *high) {
    double stays = (1.0 - SHIFT) * lin[n];
    double nearer = n + 1 < bins ? stays + SHIFT * lin[n + 1] : lin[n];
    double farther = n > 0 ? stays + SHIFT * lin[n - 1] : lin[n];
    *low = fmin(lin[n], fmin(nearer, farther));
    *high = fmax(lin[n], fmax(nearer, farther));
}

/* The largest change of any bin's total. */
static double change_db(const asdic_ping *truth, const asdic_ping *other) {
    double worst = 0.0;
    for (size_t i = 0; i < truth->beams * truth->bins; i++) {
        size_t n = i % truth->bins;
        double a_low, a_high, b_low, b_high;
        levels_about(truth->intensity_lin[ASDIC_TOTAL] + (i - n), n, truth->bins, &a_low, &a_high);
        levels_about(other->intensity_lin[ASDIC_TOTAL] + (i - n), n, truth->bins, &b_low, &b_high);
        if (a_low > b_high || b_low > a_high) {
            worst = fmax(worst, 10.0 * log10(fmax(a_low / b_high, b_low / a_high)));
        }
    }
    return worst;
}

/* Raises *BOUND_DB by what FORM changes at the places. For the choice alone it ends where the form is known not to
 * do. */
static asdic_status compare(comparison *c, asdic_refraction form, double *bound_db) {
    for (size_t i = 0; i < PLACES; i++) {
        if (c->decides && *bound_db > ASDIC_REFRACTION_NEGLIGIBLE_DB) {
            break;
        }
        if (!c->are_new[i]) {
            continue;
        }
        if (!c->truths[i]) {
            TRY(asdic_ping_create(c->ctx, c->sonar.receiver_count, c->bins, &c->truths[i]));
            TRY(expect(c, ASDIC_REFRACTION_FULL, &c->places[i], c->truths[i]));
        }
        TRY(expect(c, form, &c->places[i], c->other));
        *bound_db = fmax(*bound_db, SAFETY * change_db(c->truths[i], c->other));
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

typedef struct target {
    asdic_vec3 at_m;
    sight sights[FORMS];
    double heard,
        gains[FORMS]; /* of the beam that hears it best: one way; by each form, both ways */
} target;

/* The objects within RANGE_M of the vehicle at PING, or some of them. */
static size_t find_targets(const asdic_mission *mission, size_t ping, asdic_vec3 from_m,
                           double range_m, target targets[TARGETS]) {
    size_t objects = asdic_mission_object_count(mission), count = 0;
    size_t step = (objects + TARGETS - 1) / TARGETS;
    for (size_t i = 0; i < objects; i += step) {
        const asdic_mission_object *o = asdic_mission_get_object(mission, i);
        asdic_vec3 middle_m = {0.5 * (o->min_m.x + o->max_m.x), 0.5 * (o->min_m.y + o->max_m.y),
                               0.5 * (o->min_m.z + o->max_m.z)};
        asdic_vec3 at_m =
            o->moves ? asdic_mission_object_pose(mission, i, ping).position_m : middle_m;
        bool is_bottom = o->name[0] == 0;
        double away_m = asdic_vec3_length(asdic_vec3_sub(at_m, from_m));
        if (!is_bottom && away_m > 0.0 && away_m <= range_m) {
            targets[count++] = (target){.at_m = at_m, .heard = -1.0};
        }
    }
    return count;
}

/* Through LAYERS, with SPEED_MPS at the sonar, below TOP_M. */
static sight look(const asdic_layers *layers, double speed_mps, double top_m, asdic_vec3 from_m,
                  asdic_vec3 to_m) {
    asdic_vec3 way_m = asdic_vec3_sub(to_m, from_m);
    double across_m = hypot(way_m.x, way_m.y);
    asdic_eigenray rays[ASDIC_MOST_EIGENRAYS];
    size_t count = asdic_eigenrays_find(layers, from_m.z, to_m.z, across_m, rays);
    for (size_t i = 0; i < count; i++) {
        if (asdic_eigenray_keeps_between(layers, from_m.z, across_m, &rays[i], top_m, INFINITY)) {
            double range_m = speed_mps * rays[i].end.time_s;
            double spread = asdic_bent_ray_limited_m2(&rays[i].end, range_m);
            double aside = across_m > 0.0 ? cos(rays[i].elevation_rad) / across_m : 0.0;
            asdic_vec3 leaves = {aside * way_m.x, aside * way_m.y, sin(rays[i].elevation_rad)};
            return (sight){leaves, 1.0 / (spread * spread), range_m};
        }
    }
    return (sight){.lin = 0.0};
}

/* Takes RECEIVER for the beam that hears T best, if it does. In a shadow there is one that would. */
static void hear(target *t, const asdic_face *transmitter, const asdic_face *receiver,
                 double rear_lin) {
    const sight *full = &t->sights[ASDIC_REFRACTION_FULL], *off = &t->sights[ASDIC_REFRACTION_OFF];
    double heard =
        asdic_face_gain(receiver, full->lin > 0.0 ? full->leaves : off->leaves, rear_lin);
    if (heard > t->heard) {
        t->heard = heard;
        for (int form = 0; form < FORMS; form++) {
            t->gains[form] = asdic_face_gain(transmitter, t->sights[form].leaves, rear_lin) *
                             asdic_face_gain(receiver, t->sights[form].leaves, rear_lin);
        }
    }
}

/* By how much what is heard of T would change by FORM. */
static double target_change_db(const target *t, int form, double bin_m) {
    const sight *a = &t->sights[ASDIC_REFRACTION_FULL], *b = &t->sights[form];
    double x = t->gains[ASDIC_REFRACTION_FULL] * a->lin, y = t->gains[form] * b->lin;
    if (!(x > 0.0) && !(y > 0.0)) {
        return 0.0;
    }
    /* Of an echo that comes later a share goes into the next bin. */
    double later = x > 0.0 && y > 0.0 ? fabs(a->range_m - b->range_m) / bin_m : 0.0;
    return fabs(10.0 * log10(y / x)) + 10.0 * log10(1.0 + later);
}

static void compare_targets(const comparison *c, size_t ping, double range_m,
                            asdic_refraction_plan *out) {
    const asdic_environment *all = asdic_mission_environment(c->mission);
    const asdic_sonar *sonar = asdic_mission_sonar(c->mission);
    asdic_pose pose = asdic_mission_pose(c->mission, ping, NULL);
    asdic_water_column water = asdic_water_column_at(all, sonar, pose.position_m.z);
    double top_m = c->mission->scene->has_surface ? 0.0 : -INFINITY;
    double rear_lin = pow(10.0, 0.1 * sonar->rear_floor_db);
    target targets[TARGETS];
    size_t count = find_targets(c->mission, ping, pose.position_m, range_m, targets);
    for (int form = 0; form < FORMS && count > 0; form++) {
        asdic_environment env = in_form(all, (asdic_refraction)form, &c->span);
        double speed_mps = asdic_environment_sound_speed_mps(&env, pose.position_m.z);
        asdic_layers layers;
        asdic_layers_of(&env, pose.position_m.z, &layers);
        for (size_t i = 0; i < count; i++) {
            targets[i].sights[form] =
                look(&layers, speed_mps, top_m, pose.position_m, targets[i].at_m);
        }
    }
    asdic_face transmitter = asdic_face_aim(&sonar->transmitter, &pose, water.wavelength_m);
    for (size_t b = 0; b < sonar->receiver_count && count > 0; b++) {
        asdic_face receiver = asdic_face_aim(&sonar->receivers[b], &pose, water.wavelength_m);
        for (size_t i = 0; i < count; i++) {
            hear(&targets[i], &transmitter, &receiver, rear_lin);
        }
    }
    for (size_t i = 0; i < count; i++) {
        double layer = target_change_db(&targets[i], ASDIC_REFRACTION_LAYER, sonar->bin_length_m);
        double off = target_change_db(&targets[i], ASDIC_REFRACTION_OFF, sonar->bin_length_m);
        out->layer_db = fmax(out->layer_db, SAFETY * layer);
        out->off_db = fmax(out->off_db, SAFETY * off);
    }
}

/* ---- The choice ---- */

/* The place of PING, for what is expected there. */
static asdic_expected_place place_at(const comparison *c, size_t ping) {
    asdic_flat_scene flat = asdic_mission_flat_scene(c->mission, ping);
    asdic_pose pose = asdic_mission_pose(c->mission, ping, NULL);
    return asdic_expected_place_on_grid(&flat, &pose, 0.0, 0.0);
}

/* Straight rays come first: where they do, nothing else is asked for. */
static asdic_status compare_places(comparison *c, asdic_refraction_plan *out) {
    size_t count = asdic_mission_ping_count(c->mission);
    size_t pings[PLACES];
    TRY(asdic_ring_shelf_create(c->ctx, PLACES, &c->shelf));
    TRY(asdic_ping_create(c->ctx, c->sonar.receiver_count, c->bins, &c->other));
    for (size_t i = 0; i < PLACES; i++) {
        pings[i] = i == 0 ? c->span.shallow : i == 1 ? c->span.deep : (i - 2) * (count - 1) / 2;
        c->places[i] = place_at(c, pings[i]);
        bool is_new_ping = true;
        c->are_new[i] = true;
        for (size_t k = 0; k < i; k++) {
            c->are_new[i] =
                c->are_new[i] && !asdic_expected_is_near(&c->places[k], &c->places[i], 0.0, 0.0);
            is_new_ping = is_new_ping && pings[k] != pings[i];
        }
        if (is_new_ping) {
            compare_targets(c, pings[i], (double)c->bins * c->sonar.bin_length_m, out);
        }
    }
    TRY(compare(c, ASDIC_REFRACTION_OFF, &out->off_db));
    bool straight_do = c->decides && out->off_db <= ASDIC_REFRACTION_NEGLIGIBLE_DB;
    return straight_do ? ASDIC_OK : compare(c, ASDIC_REFRACTION_LAYER, &out->layer_db);
}

/* What a form does that leaves out what changes levels by DB. */
static void say_change(char *text, size_t size, double db) {
    if (isinf(db)) {
        snprintf(text, size, "move an object into or out of a shadow");
    } else {
        snprintf(text, size, "change a level by %s %.3g dB", db < 1e-3 ? "less than" : "up to",
                 fmax(db, 1e-3));
    }
}

static void choose(const asdic_mission *mission, asdic_refraction_plan *out) {
    bool none = out->off_db <= ASDIC_REFRACTION_NEGLIGIBLE_DB;
    bool one = out->layer_db <= ASDIC_REFRACTION_NEGLIGIBLE_DB;
    char straight[48], layer[48];
    out->needed = none  ? ASDIC_REFRACTION_OFF
                  : one ? ASDIC_REFRACTION_LAYER
                        : ASDIC_REFRACTION_FULL;
    say_change(straight, sizeof straight, out->off_db);
    say_change(layer, sizeof layer, out->layer_db);
    const asdic_law_water water = asdic_mission_law_water(mission);
    bool mirrors =
        asdic_scene_mirrors(mission->scene, mission->settings.sampling.multipath, &water);
    snprintf(out->reason, sizeof out->reason,
             "%sstraight rays would %s, one layer fitted from %.4g to %.4g m would %s",
             mirrors ? "echoes over mirrors aside, " : "", straight, out->layer_from_m,
             out->layer_to_m, layer);
}

/* The first, middle and last beam, no wider than WIDEST_WL where they lie level. */
static void take_beams(comparison *c, double wavelength_m) {
    const asdic_sonar *all = asdic_mission_sonar(c->mission);
    size_t receivers = all->receiver_count, kept = receivers < BEAMS ? receivers : BEAMS;
    c->sonar = *all;
    c->sonar.receivers = c->beams;
    c->sonar.receiver_count = kept;
    for (size_t b = 0; b < kept; b++) {
        asdic_beam *beam = &c->beams[b];
        *beam = all->receivers[kept > 1 ? b * (receivers - 1) / (kept - 1) : 0];
        if (fabs(sin(beam->roll_rad)) < 0.5) {
            beam->length_h_m = fmin(beam->length_h_m, WIDEST_WL * wavelength_m);
        }
    }
}

static asdic_status plan(asdic_context *ctx, const asdic_mission *mission, bool decides,
                         asdic_refraction_plan *out) {
    *out = (asdic_refraction_plan){.needed = ASDIC_REFRACTION_OFF,
                                   .reason = "the sound speed is the same at all depths"};
    asdic_environment full = *asdic_mission_environment(mission);
    full.refraction = ASDIC_REFRACTION_FULL;
    if (!asdic_environment_bends(&full)) {
        return ASDIC_OK;
    }
    comparison c = {.ctx = ctx, .mission = mission, .span = find_span(mission), .decides = decides};
    asdic_environment layer = in_form(&full, ASDIC_REFRACTION_LAYER, &c.span);
    double speed_mps = asdic_environment_sound_speed_mps(&full, c.span.least_m);
    take_beams(&c, speed_mps / asdic_mission_sonar(mission)->frequency_hz);
    c.bins = asdic_sonar_bin_count(&c.sonar, speed_mps);
    out->layer_from_m = layer.layer_from_m;
    out->layer_to_m = layer.layer_to_m;
    asdic_status status = compare_places(&c, out);
    asdic_ring_shelf_destroy(&c.shelf);
    for (size_t i = 0; i < PLACES; i++) {
        asdic_ping_destroy(&c.truths[i]);
    }
    asdic_ping_destroy(&c.other);
    if (status == ASDIC_OK) {
        choose(mission, out);
    }
    return status;
}

asdic_status asdic_mission_refraction(asdic_context *ctx, const asdic_mission *mission,
                                      asdic_refraction_plan *out) {
    return mission && out ? plan(ctx, mission, false, out) : asdic_fail_null(ctx, __func__);
}

asdic_status asdic_mission_refract_as_needed(asdic_context *ctx, asdic_mission *mission) {
    asdic_refraction_plan p;
    if (!mission) {
        return asdic_fail_null(ctx, __func__);
    }
    if (asdic_mission_plans_refraction(mission) &&
        asdic_environment_bends(asdic_mission_environment(mission))) {
        TRY(plan(ctx, mission, true, &p));
        asdic_mission_refract(mission, p.needed);
    }
    return ASDIC_OK;
}
