#include "faces.h"

#include "aim.h"
#include "base/context.h"
#include "base/share.h"
#include "base/try.h"
#include "base/vec.h"
#include "cones.h"
#include "sonar_ray.h"

#include "../../kernels/smooth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A body's face that looks away keeps this share: it may come into view before the block of pings ends. */
#define AWAY 0.02
/* A face far off the beams keeps at least this share. */
#define OFF_BEAM 0.05

asdic_status asdic_faces_init(asdic_faces *faces, asdic_device *device, const asdic_scene *scene) {
    for (size_t i = 0; scene && i < scene->triangle_count; i++) {
        const asdic_part *part = &scene->parts[scene->triangles[i].part];
        faces->capacity += part->kind == DEV_KIND_OBJECT;
    }
    faces->triangles = faces->capacity ? scene->triangle_count : 0;
    faces->faces = malloc((faces->capacity + 1) * sizeof *faces->faces);
    faces->density = calloc(faces->triangles + 1, sizeof *faces->density);
    if (!faces->faces || !faces->density) {
        return asdic_fail_memory(asdic_device_context(device), "faces");
    }
    TRY(asdic_buffer_create(device, faces->capacity * sizeof *faces->faces, NULL,
                            &faces->face_buffer));
    return asdic_buffer_create(device, faces->triangles * sizeof *faces->density, NULL,
                               &faces->density_buffer);
}

void asdic_faces_finish(asdic_faces *faces) {
    asdic_buffer_destroy(&faces->face_buffer);
    asdic_buffer_destroy(&faces->density_buffer);
    free(faces->faces);
    free(faces->density);
    memset(faces, 0, sizeof *faces);
}

static asdic_vec3 corner(const float *v) {
    return (asdic_vec3){v[0], v[1], v[2]};
}

/* A triangle as the sonar sees it: its area, how much of that counts, and what a square metre of it sends back. */
typedef struct view {
    double area_m2, weight, strength_lin;
    double of_cone; /* its area's share of what its object's cone looks at; 0: that has none */
    size_t bin;
} view;

/* Of objects with a cone those faces get rays of their own that send back more than so many times the mean of their bin,
 * and are together less than such a share of what the cones look at, so that these seldom meet them. */
#define LOUD 0.5
#define SELDOM 1e-3
/* With more receivers, some receiver looks at every face. */
#define MANY_RECEIVERS 8
/* Faces that a thread looks at before it takes others. */
#define FACES_A_TURN 4096

/* Sine of the angle by which the normal of T's surface leans from N, at most. */
static double lean_of(const dev_triangle *t, vector n) {
    double least = 1.0;
    for (int c = 0; c < 3 && t->corner_normals[0] != DEV_FLAT; c++) {
        least = fmin(least, vector_dot(smooth_unpack(t->corner_normals[c]), n));
    }
    return least > 0.0 ? sqrt((1.0 - least) * (1.0 + least)) : 1.0;
}

/* Of T, whose MIDDLE a ray meets along U at RANGE: the strength where it faces the sonar most, within REACH of there. */
static double strength_of(const asdic_eye *e, const dev_triangle *t, const asdic_part *part,
                          asdic_vec3 middle, triple u, double range, double reach) {
    const asdic_scatterer *s = &e->scatterers[part->material];
    vector n = smooth_normal(t, vector_of((float)middle.x, (float)middle.y, (float)middle.z));
    double cosine = fmin(fabs(u.x * n.x + u.y * n.y + u.z * n.z), 1.0);
    double sine = sqrt((1.0 - cosine) * (1.0 + cosine));
    double off = fmin(reach / fmax(range, 1e-9) + lean_of(t, n), 1.0);
    double least = fmax(sine * sqrt((1.0 - off) * (1.0 + off)) - cosine * off, 0.0);
    float size_m2 = (float)(4.0 * part->radius_m * part->radius_m);
    asdic_incidence at = {.sine = sqrt((1.0 - least) * (1.0 + least)),
                          .cos2 = least * least,
                          .coherent_m2 = smooth_flat_m2(t, e->ping->wavelength_m, size_m2),
                          .range_m = range};
    return s->silent ? 0.0 : s->material.law->strength_lin(s, &at);
}

static view look(const asdic_eye *e, const dev_triangle *t, const asdic_part *part) {
    const dev_ping *ping = e->ping;
    asdic_vec3 a = corner(t->v0), ab = asdic_vec3_sub(corner(t->v1), a),
               ac = asdic_vec3_sub(corner(t->v2), a);
    asdic_vec3 to = asdic_vec3_sub(a, corner(ping->origin));
    asdic_vec3 inward = asdic_vec3_scale(asdic_vec3_add(ab, ac), 1.0 / 3.0);
    double reach = sqrt(fmax(asdic_vec3_dot(ab, ab), asdic_vec3_dot(ac, ac)));
    ray_way way = asdic_sonar_ray(ping, asdic_vec3_add(to, inward), 0.0);
    double distance = way.t;
    view v = {.area_m2 = 0.5 * asdic_vec3_length(asdic_vec3_cross(ab, ac))};
    if (distance - reach <= ping->reach_m) {
        /* The pattern at the middle of a large face says little about the rest of it. */
        double gain = 1.0;
        if (reach < 0.3 * distance && ping->beams <= MANY_RECEIVERS) {
            asdic_vec3 towards = {way.r.u.x, way.r.u.y, way.r.u.z};
            gain = sqrt(asdic_aim_envelope(e->aimed, ping->beams, towards));
        }
        bool seen =
            part->outward == 0 || part->outward * asdic_vec3_dot(to, corner(t->normal)) < 0.0;
        v.weight = v.area_m2 * (seen ? 1.0 : AWAY) * fmax(gain, OFF_BEAM);
        v.strength_lin = strength_of(e, t, part, asdic_vec3_add(a, inward),
                                     ray_direction(&way.r, distance), distance, reach);
        v.bin = (size_t)fmin(fmax(distance, 0.0) / ping->bin_m, ping->bins - 1.0);
    }
    return v;
}

/* Which parts have a cone. */
static void find_coned(const asdic_placement *placement, asdic_vec3 position_m, const asdic_eye *e,
                       bool *coned) {
    size_t with_cone[DEV_MAX_CONES];
    size_t cones = asdic_cones_pick(placement->parts, placement->scene->part_count, position_m,
                                    e->aimed, e->ping, with_cone);
    for (unsigned c = 0; c < cones; c++) {
        coned[with_cone[c]] = true;
    }
}

/* What threads look at. */
typedef struct looking {
    const asdic_faces *faces;
    const asdic_placement *placement;
    const bool *coned; /* by part */
    const asdic_eye *eye;
    view *views;
} looking;

static void look_at_some(void *user, unsigned worker, size_t first, size_t end) {
    const looking *l = user;
    (void)worker;
    for (size_t k = first; k < end; k++) {
        const dev_triangle *t = asdic_placement_triangle(l->placement, l->faces->faces[k].triangle);
        const asdic_part *part = &l->placement->scene->parts[t->part];
        l->views[k] = look(l->eye, t, part);
        l->views[k].of_cone =
            l->coned[t->part] ? l->views[k].area_m2 / (ASDIC_PI * part->radius_m * part->radius_m)
                              : 0.0;
    }
}

/* How far the sonar is above the highest lower one of the objects without a cone. */
static double clearance_of(const looking *l) {
    double sonar = l->eye->ping->origin[2], highest = INFINITY;
    for (size_t k = 0; k < l->faces->count; k++) {
        const dev_triangle *t = asdic_placement_triangle(l->placement, l->faces->faces[k].triangle);
        double top = fmin(fmin(t->v0[2], t->v1[2]), t->v2[2]);
        if (top > sonar && !l->coned[t->part] && l->views[k].weight > 0.0) {
            highest = fmin(highest, top);
        }
    }
    return highest - sonar;
}

/* All faces of objects, and how they look. */
static void gather(asdic_faces *faces, const looking *l) {
    const asdic_scene *scene = l->placement->scene;
    faces->count = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        if (scene->parts[scene->triangles[i].part].kind == DEV_KIND_OBJECT) {
            faces->faces[faces->count++].triangle = (dev_uint)i;
        }
    }
    asdic_share(l->eye->threads, faces->count, FACES_A_TURN, look_at_some, (void *)l);
    faces->clearance_m = clearance_of(l);
}

/* Of the faces in a bin: how much of them counts, what that sends back, and what share of cones is loud there. */
typedef struct bin_sum {
    double weight, echo_lin, of_cone;
} bin_sum;

/* What a square metre sends back, beside the mean of its bin. */
static double loudness(const view *v, const bin_sum *b) {
    return b->echo_lin > 0.0 ? v->strength_lin * b->weight / b->echo_lin : 0.0;
}

/* How many rays a face gets, relative to others; 0: none. Bins with more faces get more, by the root, so that the few of
 * a wall's far end are not left out. Of a bin's faces a few that mirror the sonar may send back nearly all, and the louder
 * one is the more it gets; the others lose half at most, as the mean square of what the second root gives is 1. */
static double share_of(const view *v, const bin_sum *bins) {
    const bin_sum *b = &bins[v->bin];
    double loud = loudness(v, b);
    bool met = v->of_cone > 0.0 && (loud < LOUD || b->of_cone > SELDOM);
    if (!(v->weight > 0.0) || met) {
        return 0.0;
    }
    return v->weight * (1.0 + sqrt(loud)) / sqrt(b->weight);
}

/* Which faces get rays: fills their cumulative shares, and their density. */
static void weigh(asdic_faces *faces, const view *views, bin_sum *bins) {
    for (size_t k = 0; k < faces->count; k++) {
        bins[views[k].bin].weight += views[k].weight;
        bins[views[k].bin].echo_lin += views[k].weight * views[k].strength_lin;
    }
    for (size_t k = 0; k < faces->count; k++) {
        bin_sum *b = &bins[views[k].bin];
        b->of_cone += loudness(&views[k], b) >= LOUD ? views[k].of_cone : 0.0;
    }
    double all = 0.0, sum = 0.0;
    for (size_t k = 0; k < faces->count; k++) {
        all += share_of(&views[k], bins);
    }
    size_t seen = faces->count;
    float before = 0.0f;
    memset(faces->density, 0, faces->triangles * sizeof *faces->density);
    faces->count = 0;
    for (size_t k = 0; k < seen; k++) {
        double share = share_of(&views[k], bins);
        if (share > 0.0) {
            dev_face face = {.triangle = faces->faces[k].triangle};
            sum += share;
            face.cumulative = (float)(sum / all);
            faces->density[face.triangle] = (float)((face.cumulative - before) / views[k].area_m2);
            before = face.cumulative;
            faces->faces[faces->count++] = face;
        }
    }
}

static asdic_status upload(const asdic_faces *faces) {
    if (faces->count == 0) {
        return ASDIC_OK;
    }
    TRY(asdic_buffer_write(faces->face_buffer, 0, faces->count * sizeof *faces->faces,
                           faces->faces));
    return asdic_buffer_write(faces->density_buffer, 0, faces->triangles * sizeof *faces->density,
                              faces->density);
}

asdic_status asdic_faces_choose(asdic_faces *faces, const asdic_placement *placement,
                                asdic_vec3 position_m, const asdic_eye *eye) {
    faces->clearance_m = INFINITY;
    if (faces->capacity == 0) {
        return ASDIC_OK;
    }
    bool *coned = calloc(placement->scene->part_count, sizeof *coned);
    view *views = malloc(faces->capacity * sizeof *views);
    bin_sum *bins = calloc(eye->ping->bins, sizeof *bins);
    asdic_status status = ASDIC_OK;
    if (coned && views && bins) {
        find_coned(placement, position_m, eye, coned);
        gather(faces, &(looking){faces, placement, coned, eye, views});
        weigh(faces, views, bins);
        status = upload(faces);
    } else {
        status = asdic_fail_memory(placement->scene->ctx, "faces");
    }
    free(coned);
    free(views);
    free(bins);
    return status;
}
