#include "detect_truth.h"

#include "heard_range.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "laws/scatterer.h"
#include "mission/mission.h"
#include "scene/scene.h"
#include "sim/environment.h"
#include "sim/ring.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An object's surface counts as equal pieces: of a quarter of a bin squared, but so many. */
#define LEAST_PIECES 256.0
#define MOST_PIECES 16384.0

/* A piece of an object's surface, where it is at the mission's beginning. */
typedef struct piece {
    asdic_vec3 at_m, area_m2; /* along the normal; 0: a point */
} piece;

/* Where the triangles of a part are; those of others may lie between. */
typedef struct span {
    size_t first, end;
} span;

/* The part of an object that lies in a bin. */
typedef struct share {
    double echo_m2;     /* scattering strength x area, or a point's target strength */
    asdic_vec3 towards; /* sum of these x direction from the sonar */
} share;

typedef struct named {
    char name[ASDIC_NAME_SIZE];
    size_t object, part; /* index in the mission; in its scene, SIZE_MAX for a point */
    double point_m2;     /* target strength of a point */
    span triangles;      /* of a part */
    asdic_vec3 middle_m; /* of its pieces */
    share *shares;       /* per bin */
    piece *pieces;
    size_t piece_count;
} named;

struct asdic_namer {
    asdic_run *run;
    const asdic_mission *mission; /* NULL: a single name */
    named *names;
    size_t count;
    asdic_pose pose; /* of the ping */
    asdic_heard_water heard;
    asdic_law_water water;
    asdic_face transmitter; /* its faces */
    asdic_face *receivers;
    const int16_t *objects; /* of the ping's bins, where the run has truth; else NULL */
    bool is_placed;         /* shares are those of POSE, and nothing moves */
};

static void read_triangle(const asdic_scene *scene, size_t index, asdic_vec3 v[3],
                          asdic_vec3 *area_m2) {
    const dev_triangle *t = &scene->triangles[index];
    const float *corners[3] = {t->v0, t->v1, t->v2};
    for (int k = 0; k < 3; k++) {
        asdic_vec3 corner = {corners[k][0], corners[k][1], corners[k][2]};
        v[k] = asdic_vec3_add(corner, scene->origin_m);
    }
    *area_m2 = asdic_vec3_scale(
        asdic_vec3_cross(asdic_vec3_sub(v[1], v[0]), asdic_vec3_sub(v[2], v[0])), 0.5);
}

/* Of each part; NULL: no memory. */
static span *find_spans(const asdic_scene *scene) {
    span *spans = calloc(scene->part_count + 1, sizeof *spans);
    for (size_t i = scene->triangle_count; i > 0 && spans; i--) {
        span *s = &spans[scene->triangles[i - 1].part];
        *s = (span){i - 1, s->end ? s->end : i};
    }
    return spans;
}

static double area_of(const asdic_scene *scene, size_t part, span at) {
    double sum = 0.0;
    asdic_vec3 v[3], area;
    for (size_t i = at.first; i < at.end; i++) {
        if (scene->triangles[i].part == part) {
            read_triangle(scene, i, v, &area);
            sum += asdic_vec3_length(area);
        }
    }
    return sum;
}

/* A place in the triangle V; any number of them fill it evenly (Halton's points of bases 2 and 3,
 * Numer. Math. 2, 84 (1960), folded at the diagonal). */
static asdic_vec3 place_in(const asdic_vec3 v[3], size_t index) {
    double at[2] = {0.0, 0.0};
    for (int k = 0; k < 2; k++) {
        double base = k + 2.0, digit = 1.0 / base;
        for (size_t i = index + 1; i > 0; i /= (size_t)k + 2, digit /= base) {
            at[k] += digit * (double)(i % ((size_t)k + 2));
        }
    }
    if (at[0] + at[1] > 1.0) {
        at[0] = 1.0 - at[0];
        at[1] = 1.0 - at[1];
    }
    asdic_vec3 a = asdic_vec3_scale(asdic_vec3_sub(v[1], v[0]), at[0]);
    return asdic_vec3_add(v[0],
                          asdic_vec3_add(a, asdic_vec3_scale(asdic_vec3_sub(v[2], v[0]), at[1])));
}

/* Fills the pieces of an object once for all pings: a point has one. */
static asdic_status cut_object(const asdic_namer *namer, named *n) {
    const asdic_scene *scene = namer->mission->scene;
    span at = n->triangles;
    double bin_m = namer->run->facts.bin_length_m, area_m2 = area_of(scene, n->part, at);
    double pieces = fmin(fmax(4.0 * area_m2 / (bin_m * bin_m), LEAST_PIECES), MOST_PIECES);
    double each_m2 = area_m2 / floor(pieces), sum = 0.0;
    size_t room = area_m2 > 0.0 ? (size_t)pieces : 1;
    n->pieces = calloc(room, sizeof *n->pieces);
    if (!n->pieces) {
        return asdic_fail_memory(namer->run->ctx, "objects' pieces");
    }
    n->pieces[0].at_m = asdic_mission_get_object(namer->mission, n->object)->pose.position_m;
    n->piece_count = n->part == SIZE_MAX ? 1 : 0;
    for (size_t i = at.first; i < at.end; i++) {
        if (scene->triangles[i].part != n->part) {
            continue;
        }
        asdic_vec3 v[3], area;
        read_triangle(scene, i, v, &area);
        double own = asdic_vec3_length(area);
        for (sum += own; n->piece_count < room && ((double)n->piece_count + 0.5) * each_m2 < sum;
             n->piece_count++) {
            n->pieces[n->piece_count] =
                (piece){place_in(v, n->piece_count), asdic_vec3_scale(area, each_m2 / own)};
        }
    }
    for (size_t i = 0; i < n->piece_count; i++) {
        asdic_vec3 part_m = asdic_vec3_scale(n->pieces[i].at_m, 1.0 / (double)n->piece_count);
        n->middle_m = asdic_vec3_add(n->middle_m, part_m);
    }
    return ASDIC_OK;
}

/* By how much farther than it is an object is heard: its middle, since a ray to each piece takes long. */
static double stretch(const asdic_namer *namer, asdic_vec3 middle_m) {
    asdic_vec3 to = asdic_vec3_sub(middle_m, namer->pose.position_m);
    double far_m = asdic_vec3_length(to);
    return far_m > 0.0 ? asdic_heard_range_m(&namer->heard, to) / far_m : 1.0;
}

/* Whether the way from A to B crosses the triangle V (Moeller & Trumbore, J. Graphics Tools 2(1), 21 (1997)). */
static bool crosses(const asdic_vec3 v[3], asdic_vec3 a, asdic_vec3 b) {
    asdic_vec3 way = asdic_vec3_sub(b, a), from = asdic_vec3_sub(a, v[0]);
    asdic_vec3 e1 = asdic_vec3_sub(v[1], v[0]), e2 = asdic_vec3_sub(v[2], v[0]);
    asdic_vec3 p = asdic_vec3_cross(way, e2), q = asdic_vec3_cross(from, e1);
    double scale = 1.0 / asdic_vec3_dot(e1, p); /* not finite where it runs along: no */
    double at1 = scale * asdic_vec3_dot(from, p), at2 = scale * asdic_vec3_dot(way, q);
    double along = scale * asdic_vec3_dot(e2, q);
    return at1 >= 0.0 && at2 >= 0.0 && at1 + at2 <= 1.0 && along > 0.0 && along < 1.0;
}

/* Whether the way from A to B comes into the sphere about a part. */
static bool comes_near(const asdic_part *part, asdic_vec3 a, asdic_vec3 b) {
    asdic_vec3 way = asdic_vec3_sub(b, a), to = asdic_vec3_sub(part->center_m, a);
    double along = asdic_vec3_dot(to, way) / asdic_vec3_dot(way, way);
    asdic_vec3 nearest = asdic_vec3_scale(way, fmin(fmax(along, 0.0), 1.0));
    return asdic_vec3_length(asdic_vec3_sub(to, nearest)) <= part->radius_m;
}

/* Whether N, where it is at PING, lies between A and B. */
static bool lies_between(const asdic_namer *namer, const named *n, size_t ping, asdic_vec3 a,
                         asdic_vec3 b) {
    const asdic_scene *scene = namer->mission->scene;
    const asdic_mission_object *object = asdic_mission_get_object(namer->mission, n->object);
    asdic_pose now = asdic_mission_object_pose(namer->mission, n->object, ping);
    asdic_move back = asdic_move_between(&now, &object->pose);
    if (object->moves) {
        a = asdic_move_point(&back, a);
        b = asdic_move_point(&back, b);
    }
    bool is_near = comes_near(&scene->parts[n->part], a, b);
    size_t end = is_near ? n->triangles.end : n->triangles.first;
    for (size_t i = n->triangles.first; i < end; i++) {
        asdic_vec3 v[3], area;
        read_triangle(scene, i, v, &area);
        if (scene->triangles[i].part == n->part && crosses(v, a, b)) {
            return true;
        }
    }
    return false;
}

/* Whether a body hides a point at AT_M. */
static bool is_hidden(const asdic_namer *namer, size_t ping, asdic_vec3 at_m) {
    bool hidden = false;
    for (size_t i = 0; i < namer->count && !hidden; i++) {
        const named *n = &namer->names[i];
        hidden = n->part != SIZE_MAX && lies_between(namer, n, ping, namer->pose.position_m, at_m);
    }
    return hidden;
}

/* What a piece of a body sends back to the sonar, which is RANGE_M away against TO: as its law says, and nothing from
 * the far side of a closed one. */
static double echo_m2(const asdic_part *part, const asdic_scatterer *s, const piece *p,
                      asdic_vec3 to, double range_m) {
    double area_m2 = asdic_vec3_length(p->area_m2);
    double sine = -asdic_vec3_dot(p->area_m2, to) / (range_m * area_m2);
    sine = part->outward == 0 ? fabs(sine) : sine * part->outward;
    if (!(sine > 0.0)) {
        return 0.0;
    }
    sine = fmin(sine, 1.0);
    asdic_incidence at = asdic_incidence_on_plane(sine, (1.0 - sine) * (1.0 + sine));
    at.range_m = range_m;
    return area_m2 * s->material.law->strength_lin(s, &at);
}

/* Adds the object's pieces to the bins in which they are heard at PING. */
static void place(const asdic_namer *namer, named *n, size_t ping) {
    const asdic_run_facts *facts = &namer->run->facts;
    const asdic_mission_object *object = asdic_mission_get_object(namer->mission, n->object);
    asdic_pose now = asdic_mission_object_pose(namer->mission, n->object, ping);
    asdic_move move = asdic_move_between(&object->pose, &now);
    double times =
        stretch(namer, object->moves ? asdic_move_point(&move, n->middle_m) : n->middle_m);
    const asdic_scene *scene = namer->mission->scene;
    const asdic_part *part = n->part == SIZE_MAX ? NULL : &scene->parts[n->part];
    asdic_scatterer law = {0};
    if (part) {
        law = asdic_scatterer_at(&scene->materials[part->material], &namer->water);
    }
    memset(n->shares, 0, facts->bins * sizeof *n->shares);
    for (size_t i = 0; i < n->piece_count; i++) {
        piece p = n->pieces[i];
        if (object->moves) {
            p.at_m = asdic_move_point(&move, p.at_m);
            p.area_m2 = asdic_move_turn(&move, p.area_m2);
        }
        asdic_vec3 to = asdic_vec3_sub(p.at_m, namer->pose.position_m);
        double range = fmax(asdic_vec3_length(to), 1e-6);
        double bin = times * range / facts->bin_length_m;
        if (bin < (double)facts->bins) {
            share *s = &n->shares[(size_t)bin];
            double echo = part                             ? echo_m2(part, &law, &p, to, range)
                          : is_hidden(namer, ping, p.at_m) ? 0.0
                                                           : n->point_m2;
            s->echo_m2 += echo;
            s->towards = asdic_vec3_add(s->towards, asdic_vec3_scale(to, echo / range));
        }
    }
}

static asdic_status add_name(asdic_namer *namer, size_t object, const span *spans) {
    const asdic_scene *scene = namer->mission->scene;
    const asdic_mission_object *o = asdic_mission_get_object(namer->mission, object);
    named *n = &namer->names[namer->count++];
    memcpy(n->name, o->name, sizeof n->name);
    n->object = object;
    n->part = SIZE_MAX;
    for (size_t p = 0; p < scene->part_count; p++) {
        if (strcmp(scene->parts[p].name, o->name) == 0) {
            n->part = p;
        }
    }
    for (size_t p = 0; p < scene->point_count; p++) {
        if (strcmp(scene->points[p].name, o->name) == 0) {
            n->point_m2 = pow(10.0, 0.1 * scene->points[p].target_strength_db);
        }
    }
    n->shares = calloc(namer->run->facts.bins, sizeof *n->shares);
    if (!n->shares) {
        return asdic_fail_memory(namer->run->ctx, "objects' shares");
    }
    n->triangles = n->part == SIZE_MAX ? (span){0, 0} : spans[n->part];
    return cut_object(namer, n);
}

static asdic_status add_names(asdic_namer *namer) {
    size_t objects = asdic_mission_object_count(namer->mission);
    span *spans = find_spans(namer->mission->scene);
    namer->names = calloc(objects + 1, sizeof *namer->names);
    asdic_status status =
        spans && namer->names ? ASDIC_OK : asdic_fail_memory(namer->run->ctx, "objects' names");
    for (size_t i = 0; i < objects && !status; i++) {
        bool is_bottom = asdic_mission_get_object(namer->mission, i)->name[0] == 0;
        status = is_bottom ? ASDIC_OK : add_name(namer, i, spans);
    }
    free(spans);
    return status;
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
    if (namer->mission) {
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

asdic_status asdic_namer_create(asdic_run *run, const asdic_mission *mission, asdic_namer **out) {
    *out = NULL;
    asdic_namer *namer = calloc(1, sizeof *namer);
    if (!namer || !(namer->receivers = calloc(run->facts.beams, sizeof *namer->receivers))) {
        free(namer);
        return asdic_fail_memory(run->ctx, "objects' names");
    }
    namer->run = run;
    namer->mission = mission;
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
        free((*namer)->names[i].pieces);
    }
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

double asdic_namer_uncertainty_db(const asdic_namer *namer, size_t index) {
    bool is_named = namer->names[index].pieces != NULL;
    return is_named
               ? asdic_mission_object_uncertainty_db(namer->mission, namer->names[index].object)
               : namer->run->facts.uncertainty.db[ASDIC_OBJECT];
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
    namer->objects = record->truth.object;
    if (namer->count < 2 || namer->objects ||
        (namer->is_placed && memcmp(&namer->pose, &record->pose, sizeof namer->pose) == 0)) {
        return ASDIC_OK;
    }
    const asdic_environment *env = &namer->run->settings.environment;
    asdic_water_column water = asdic_water_column_at(env, sonar, record->pose.position_m.z);
    double wavelength_m = water.wavelength_m;
    namer->water = asdic_water_column_laws(&water, env, sonar);
    namer->pose = record->pose;
    namer->heard = asdic_heard_water_of(env, namer->mission->scene, record->pose.position_m.z);
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

/* The object with the strongest echo in BIN; *WEIGHT is 0 when there is none. */
static size_t heaviest(const asdic_namer *namer, size_t beam, size_t bin, double *weight) {
    double rear_lin = pow(10.0, 0.1 * namer->run->settings.sonar.rear_floor_db);
    size_t best = 0;
    *weight = 0.0;
    for (size_t i = 0; i < namer->count; i++) {
        const share *s = &namer->names[i].shares[bin];
        double length = asdic_vec3_length(s->towards);
        if (!(length > 0.0)) {
            continue;
        }
        asdic_vec3 u = asdic_vec3_scale(s->towards, 1.0 / length);
        double gain = asdic_face_gain(&namer->transmitter, u, rear_lin) *
                      asdic_face_gain(&namer->receivers[beam], u, rear_lin);
        double w = s->echo_m2 * (gain + 1e-12);
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
    int number = namer->objects ? namer->objects[beam * bins + bin] : 0;
    if (namer->objects) { /* names are the scene's objects, in its order */
        return number > 0 && (size_t)number <= namer->count ? (size_t)number - 1 : 0;
    }
    /* A pulse, and the footprint of a ray, reach into neighbouring bins. */
    size_t best = 0;
    double weight = 0.0;
    for (size_t off = 0; off < bins && !(weight > 0.0); off++) {
        best = bin >= off ? heaviest(namer, beam, bin - off, &weight) : 0;
        if (!(weight > 0.0) && bin + off < bins) {
            best = heaviest(namer, beam, bin + off, &weight);
        }
    }
    return best;
}
