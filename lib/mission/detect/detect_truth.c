#include "detect_background.h"
#include "detect_truth.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "mission/mission.h"
#include "scene/scene.h"
#include "sim/ring.h"

#include "../../../kernels/beam.h"

#include <stdlib.h>
#include <string.h>

/* Triangles are halved until they lie in one bin, at most so often. */
#define MOST_HALVINGS 14

/* The part of an object that lies in a bin. */
typedef struct share {
    double area_m2;
    asdic_vec3 towards; /* sum of area x direction from the sonar */
} share;

typedef struct named {
    char name[ASDIC_NAME_SIZE];
    size_t object, part; /* index in the mission; in its scene, SIZE_MAX for a point */
    share *shares;       /* per bin */
} named;

struct asdic_namer {
    asdic_run *run;
    asdic_mission *mission; /* NULL: a single name */
    named *names;
    size_t count;
    asdic_pose pose;        /* of the ping */
    asdic_face transmitter; /* its faces */
    asdic_face *receivers;
    bool is_placed; /* shares are those of POSE, and nothing moves */
};

static void add_piece(named *n, const asdic_run_facts *facts, asdic_vec3 from,
                      const asdic_vec3 v[3], int halvings) {
    asdic_vec3 center = asdic_vec3_scale(asdic_vec3_add(v[0], asdic_vec3_add(v[1], v[2])), 1.0 / 3);
    double longest = 0.0, low = INFINITY, high = 0.0;
    int side = 0;
    for (int i = 0; i < 3; i++) {
        double range = asdic_vec3_length(asdic_vec3_sub(v[i], from));
        double length = asdic_vec3_length(asdic_vec3_sub(v[(i + 1) % 3], v[i]));
        low = fmin(low, range);
        high = fmax(high, range);
        side = length > longest ? i : side;
        longest = fmax(length, longest);
    }
    if (low - longest > facts->bin_length_m * (double)facts->bins) {
        return;
    }
    if (halvings < MOST_HALVINGS && longest > facts->bin_length_m &&
        (high - low > facts->bin_length_m || longest > 0.1 * low)) {
        asdic_vec3 a = v[side], b = v[(side + 1) % 3], c = v[(side + 2) % 3];
        asdic_vec3 middle = asdic_vec3_scale(asdic_vec3_add(a, b), 0.5);
        add_piece(n, facts, from, (const asdic_vec3[3]){a, middle, c}, halvings + 1);
        add_piece(n, facts, from, (const asdic_vec3[3]){middle, b, c}, halvings + 1);
        return;
    }
    asdic_vec3 to = asdic_vec3_sub(center, from);
    asdic_vec3 normal = asdic_vec3_cross(asdic_vec3_sub(v[1], v[0]), asdic_vec3_sub(v[2], v[0]));
    double range = fmax(asdic_vec3_length(to), 1e-6), bin = floor(range / facts->bin_length_m);
    if (bin < (double)facts->bins) {
        share *s = &n->shares[(size_t)bin];
        double area = 0.5 * fabs(asdic_vec3_dot(normal, to)) / range; /* as the sonar sees it */
        s->area_m2 += area;
        s->towards = asdic_vec3_add(s->towards, asdic_vec3_scale(to, area / range));
    }
}

/* The object's shift from the mission's beginning to PING. */
static asdic_vec3 moved(const asdic_namer *namer, const named *n, size_t ping, asdic_vec3 at) {
    const asdic_mission_object *o = asdic_mission_get_object(namer->mission, n->object);
    if (!o->moves) {
        return at;
    }
    asdic_pose now = asdic_mission_object_pose(namer->mission, n->object, ping);
    asdic_mat3 before = asdic_mat3_attitude(o->pose.roll_rad, o->pose.pitch_rad, o->pose.yaw_rad);
    asdic_mat3 after = asdic_mat3_attitude(now.roll_rad, now.pitch_rad, now.yaw_rad);
    asdic_vec3 own = asdic_mat3_apply_inverse(before, asdic_vec3_sub(at, o->pose.position_m));
    return asdic_vec3_add(asdic_mat3_apply(after, own), now.position_m);
}

static void place(asdic_namer *namer, named *n, size_t ping) {
    const asdic_scene *scene = namer->mission->scene;
    asdic_vec3 from = namer->pose.position_m;
    memset(n->shares, 0, namer->run->facts.bins * sizeof *n->shares);
    if (n->part == SIZE_MAX) {
        const asdic_mission_object *o = asdic_mission_get_object(namer->mission, n->object);
        asdic_vec3 at = moved(namer, n, ping, o->pose.position_m);
        asdic_vec3 v[3] = {at, at,
                           at}; /* a speck of a square millimetre across the line of sight */
        asdic_vec3 to = asdic_vec3_sub(at, from);
        asdic_vec3 aside = {-to.y, to.x, 0.0};
        double length = asdic_vec3_length(aside);
        aside = length > 0.0 ? asdic_vec3_scale(aside, 1e-3 / length) : (asdic_vec3){1e-3, 0, 0};
        v[1] = asdic_vec3_add(at, aside);
        v[2].z += 1e-3;
        add_piece(n, &namer->run->facts, from, v, 0);
        return;
    }
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        if (t->part != n->part) {
            continue;
        }
        const float *corners[3] = {t->v0, t->v1, t->v2};
        asdic_vec3 v[3];
        for (int k = 0; k < 3; k++) {
            asdic_vec3 at = {corners[k][0], corners[k][1], corners[k][2]};
            v[k] = moved(namer, n, ping, asdic_vec3_add(at, scene->origin_m));
        }
        add_piece(n, &namer->run->facts, from, v, 0);
    }
}

static asdic_status add_names(asdic_namer *namer) {
    asdic_context *ctx = namer->run->ctx;
    const asdic_scene *scene = namer->mission->scene;
    size_t objects = asdic_mission_object_count(namer->mission);
    namer->names = calloc(objects + 1, sizeof *namer->names);
    for (size_t i = 0; i < objects && namer->names; i++) {
        const asdic_mission_object *o = asdic_mission_get_object(namer->mission, i);
        if (o->name[0] == 0) { /* the bottom */
            continue;
        }
        named *n = &namer->names[namer->count++];
        memcpy(n->name, o->name, sizeof n->name);
        n->object = i;
        n->part = SIZE_MAX;
        for (size_t p = 0; p < scene->part_count; p++) {
            if (strcmp(scene->parts[p].name, o->name) == 0) {
                n->part = p;
            }
        }
        n->shares = calloc(namer->run->facts.bins, sizeof *n->shares);
        if (!n->shares) {
            return asdic_fail_memory(ctx, "objects' shares");
        }
    }
    return namer->names ? ASDIC_OK : asdic_fail_memory(ctx, "objects' names");
}

static asdic_status name_nothing(asdic_namer *namer) {
    namer->names = calloc(1, sizeof *namer->names);
    if (!namer->names) {
        return asdic_fail_memory(namer->run->ctx, "objects' names");
    }
    strcpy(namer->names[0].name, "object");
    namer->count = 1;
    return ASDIC_OK;
}

static asdic_status find_names(asdic_namer *namer) {
    asdic_run *run = namer->run;
    if (asdic_backdrop_can(run)) {
        TRY(asdic_mission_load(run->ctx, run->facts.scene_path, &namer->mission));
        TRY(add_names(namer));
    } else {
        asdic_log(run->ctx, ASDIC_LOG_WARNING,
                  "scene '%s' is not there as it was when it was run: its objects have no names",
                  run->facts.scene_path);
    }
    if (namer->count > 0) {
        return ASDIC_OK;
    }
    free(namer->names);
    return name_nothing(namer);
}

asdic_status asdic_namer_create(asdic_run *run, asdic_namer **out) {
    *out = NULL;
    asdic_namer *namer = calloc(1, sizeof *namer);
    if (!namer || !(namer->receivers = calloc(run->facts.beams, sizeof *namer->receivers))) {
        free(namer);
        return asdic_fail_memory(run->ctx, "objects' names");
    }
    namer->run = run;
    asdic_status status = find_names(namer);
    if (status) {
        asdic_namer_destroy(&namer);
    }
    *out = namer;
    return status;
}

void asdic_namer_destroy(asdic_namer **namer) {
    if (!namer || !*namer) {
        return;
    }
    for (size_t i = 0; i < (*namer)->count; i++) {
        free((*namer)->names[i].shares);
    }
    asdic_mission_destroy(&(*namer)->mission);
    free((*namer)->names);
    free((*namer)->receivers);
    free(*namer);
    *namer = NULL;
}

size_t asdic_namer_count(const asdic_namer *namer) {
    return namer->count;
}

const char *asdic_namer_name(const asdic_namer *namer, size_t index) {
    return namer->names[index].name;
}

static bool moves(const asdic_namer *namer) {
    for (size_t i = 0; i < namer->count; i++) {
        if (asdic_mission_get_object(namer->mission, namer->names[i].object)->moves) {
            return true;
        }
    }
    return false;
}

asdic_status asdic_namer_begin_ping(asdic_namer *namer, const asdic_record *record) {
    const asdic_sonar *sonar = &namer->run->settings.sonar;
    if (namer->count < 2 ||
        (namer->is_placed && memcmp(&namer->pose, &record->pose, sizeof namer->pose) == 0)) {
        return ASDIC_OK;
    }
    double wavelength_m = asdic_environment_sound_speed_mps(&namer->run->settings.environment,
                                                            record->pose.position_m.z) /
                          sonar->frequency_hz;
    namer->pose = record->pose;
    namer->transmitter = asdic_face_aim(&sonar->transmitter, &record->pose, wavelength_m);
    for (size_t b = 0; b < sonar->receiver_count; b++) {
        namer->receivers[b] = asdic_face_aim(&sonar->receivers[b], &record->pose, wavelength_m);
    }
    for (size_t i = 0; i < namer->count; i++) {
        place(namer, &namer->names[i], (size_t)record->ping);
    }
    namer->is_placed = !moves(namer);
    return ASDIC_OK;
}

static double gain(const asdic_face *face, asdic_vec3 towards) {
    asdic_vec3 v = asdic_mat3_apply(face->world_to_face, towards);
    return beam_pattern_lin(v.x, v.y, v.z, face->length_h_wl, face->length_v_wl, 1e-6);
}

/* The object with the largest part in BIN; *WEIGHT is 0 when there is none. */
static size_t heaviest(const asdic_namer *namer, size_t beam, size_t bin, double *weight) {
    size_t best = 0;
    *weight = 0.0;
    for (size_t i = 0; i < namer->count; i++) {
        const share *s = &namer->names[i].shares[bin];
        double length = asdic_vec3_length(s->towards);
        if (!(length > 0.0)) {
            continue;
        }
        asdic_vec3 u = asdic_vec3_scale(s->towards, 1.0 / length);
        double w =
            s->area_m2 * (gain(&namer->transmitter, u) * gain(&namer->receivers[beam], u) + 1e-12);
        if (w > *weight) {
            *weight = w;
            best = i;
        }
    }
    return best;
}

size_t asdic_namer_find(const asdic_namer *namer, size_t beam, size_t bin) {
    size_t bins = namer->run->facts.bins;
    if (namer->count < 2) {
        return 0;
    }
    /* A pulse, and the footprint of a ray, reach into neighbouring bins. */
    for (size_t off = 0; off < bins; off++) {
        double weight = 0.0;
        size_t best = bin >= off ? heaviest(namer, beam, bin - off, &weight) : 0;
        if (!(weight > 0.0) && bin + off < bins) {
            best = heaviest(namer, beam, bin + off, &weight);
        }
        if (weight > 0.0) {
            return best;
        }
    }
    return 0;
}
