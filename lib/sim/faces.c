#include "faces.h"

#include "aim.h"
#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "cones.h"
#include "sonar_ray.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A face that looks away keeps this share: it may come into view before the block of pings ends. */
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

/* A triangle as the sonar sees it. */
typedef struct view {
    double area_m2, weight;
} view;

/* With more receivers, some receiver looks at every face. */
#define MANY_RECEIVERS 8

static view look(const dev_triangle *t, const dev_ping *ping, const dev_beam *aimed) {
    asdic_vec3 a = corner(t->v0), ab = asdic_vec3_sub(corner(t->v1), a),
               ac = asdic_vec3_sub(corner(t->v2), a);
    asdic_vec3 to = asdic_vec3_sub(a, corner(ping->origin));
    asdic_vec3 middle = asdic_vec3_add(to, asdic_vec3_scale(asdic_vec3_add(ab, ac), 1.0 / 3.0));
    double reach = sqrt(fmax(asdic_vec3_dot(ab, ab), asdic_vec3_dot(ac, ac)));
    ray_way way = asdic_sonar_ray(ping, middle, 0.0);
    double distance = way.t;
    view v = {0.5 * asdic_vec3_length(asdic_vec3_cross(ab, ac)), 0.0};
    if (distance - reach <= ping->reach_m) {
        /* The pattern at the middle of a large face says little about the rest of it. */
        double gain = 1.0;
        if (reach < 0.3 * distance && ping->beams <= MANY_RECEIVERS) {
            asdic_vec3 towards = {way.r.u.x, way.r.u.y, way.r.u.z};
            gain = sqrt(asdic_aim_envelope(aimed, ping->beams, towards));
        }
        bool seen = asdic_vec3_dot(to, corner(t->normal)) < 0.0;
        v.weight = v.area_m2 * (seen ? 1.0 : AWAY) * fmax(gain, OFF_BEAM);
    }
    return v;
}

/* Which parts rays are aimed at: objects without a cone. */
static void want_parts(const asdic_placement *placement, asdic_vec3 position_m,
                       const dev_ping *ping, const dev_beam *aimed, bool *wanted) {
    const asdic_scene *scene = placement->scene;
    size_t with_cone[DEV_MAX_CONES];
    unsigned cones =
        asdic_cones_pick(placement->parts, scene->part_count, position_m, aimed, ping, with_cone);
    for (size_t i = 0; i < scene->part_count; i++) {
        wanted[i] = scene->parts[i].kind == DEV_KIND_OBJECT;
    }
    for (unsigned c = 0; c < cones; c++) {
        wanted[with_cone[c]] = false;
    }
}

/* The faces of the parts WANTED, with running sums of their weights. */
static double gather(asdic_faces *faces, const asdic_placement *placement, const bool *wanted,
                     const dev_ping *ping, const dev_beam *aimed, double *sums) {
    const asdic_scene *scene = placement->scene;
    double sum = 0.0, highest = INFINITY;
    faces->count = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        if (!wanted[scene->triangles[i].part]) {
            continue;
        }
        const dev_triangle *t = asdic_placement_triangle(placement, i);
        double weight = look(t, ping, aimed).weight;
        double top = fmin(fmin(t->v0[2], t->v1[2]), t->v2[2]);
        if (weight > 0.0) {
            sums[faces->count] = sum += weight;
            faces->faces[faces->count++].triangle = (dev_uint)i;
            highest = top > ping->origin[2] ? fmin(highest, top) : highest;
        }
    }
    faces->clearance_m = highest - ping->origin[2];
    return sum;
}

/* Fills the cumulative shares by which rays pick a face, and their density, from the running sums. */
static void weigh(asdic_faces *faces, const asdic_placement *placement, const dev_ping *ping,
                  const dev_beam *aimed, const double *sums, double sum) {
    float before = 0.0f;
    memset(faces->density, 0, faces->triangles * sizeof *faces->density);
    for (size_t k = 0; k < faces->count; k++) {
        dev_face *face = &faces->faces[k];
        const dev_triangle *t = asdic_placement_triangle(placement, face->triangle);
        face->cumulative = k + 1 == faces->count ? 1.0f : (float)(sums[k] / sum);
        faces->density[face->triangle] =
            (float)((face->cumulative - before) / look(t, ping, aimed).area_m2);
        before = face->cumulative;
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
                                asdic_vec3 position_m, const dev_ping *ping,
                                const dev_beam *aimed) {
    faces->clearance_m = INFINITY;
    if (faces->capacity == 0) {
        return ASDIC_OK;
    }
    bool *wanted = calloc(placement->scene->part_count, sizeof *wanted);
    double *sums = malloc(faces->capacity * sizeof *sums);
    asdic_status status = ASDIC_OK;
    if (wanted && sums) {
        want_parts(placement, position_m, ping, aimed, wanted);
        double sum = gather(faces, placement, wanted, ping, aimed, sums);
        weigh(faces, placement, ping, aimed, sums, sum);
        status = upload(faces);
    } else {
        status = asdic_fail_memory(placement->scene->ctx, "faces");
    }
    free(wanted);
    free(sums);
    return status;
}
