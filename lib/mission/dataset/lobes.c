#include "labelled.h"

#include "base/vec.h"
#include "out/beam_width.h"
#include "scene/moving.h"
#include "scene/scene.h"
#include "sim/ring.h"

#include <math.h>
#include <stdlib.h>

/* The bearings in the fan's frame at which an object is seen: from REF_RAD on LOW_RAD to HIGH_RAD. Bearings of a facet lie
 * between those of its corners. */
typedef struct extent {
    bool is_there;
    double ref_rad, low_rad, high_rad;
    double least_cos; /* of the elevations of its corners */
} extent;

/* Where a frame's sonar is, and the extents of its objects, by number less 1. */
typedef struct view {
    asdic_mat3 fan;
    asdic_vec3 from_m;
    extent *extents;
} view;

static void add(const view *v, unsigned number, asdic_vec3 at_m) {
    extent *e = &v->extents[number - 1];
    asdic_vec3 to = asdic_mat3_apply_inverse(v->fan, asdic_vec3_sub(at_m, v->from_m));
    double across = hypot(to.x, to.y), bearing_rad = atan2(to.y, to.x);
    if (!e->is_there) {
        *e = (extent){.is_there = true, .ref_rad = bearing_rad, .least_cos = 1.0};
    }
    double off_rad = remainder(bearing_rad - e->ref_rad, 2.0 * ASDIC_PI);
    e->low_rad = fmin(e->low_rad, off_rad);
    e->high_rad = fmax(e->high_rad, off_rad);
    e->least_cos = fmin(e->least_cos, across / fmax(hypot(across, to.z), 1e-9));
}

static void add_facet(const view *v, unsigned number, const asdic_mat3 *turn, asdic_vec3 origin_m,
                      const double corners_m[9]) {
    for (int k = 0; k < 9; k += 3) {
        const asdic_vec3 corner = {corners_m[k], corners_m[k + 1], corners_m[k + 2]};
        add(v, number, asdic_vec3_add(origin_m, asdic_mat3_apply(*turn, corner)));
    }
}

/* What moves stands where FRAME puts it, the rest where the scene has it. OBJECTS by number less 1. */
static void find_extents(const view *v, const asdic_scene *scene,
                         const asdic_mission_object *const *objects) {
    const asdic_mat3 level = asdic_mat3_attitude(0.0, 0.0, 0.0);
    for (size_t i = 0; i < scene->movable_count; i++) {
        const asdic_movable *m = &scene->movables[i];
        unsigned number = scene->parts[m->part].number;
        const asdic_pose *pose = &objects[number - 1]->pose;
        const asdic_mat3 turn = asdic_mat3_of(pose);
        for (size_t t = 0; t < m->count; t++) {
            add_facet(v, number, &turn, pose->position_m, m->corners_m + 9 * t);
        }
    }
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const dev_triangle *t = &scene->triangles[i];
        const asdic_part *part = &scene->parts[t->part];
        if (part->kind == DEV_KIND_OBJECT && !part->moves) {
            const double corners_m[9] = {t->v0[0], t->v0[1], t->v0[2], t->v1[0], t->v1[1],
                                         t->v1[2], t->v2[0], t->v2[1], t->v2[2]};
            add_facet(v, part->number, &level, scene->origin_m, corners_m);
        }
    }
    for (size_t i = 0; i < scene->point_count; i++) {
        unsigned number = scene->points[i].number;
        add(v, number, objects[number - 1]->pose.position_m);
    }
}

static asdic_vec3 column(const asdic_mat3 *m, int k) {
    return (asdic_vec3){m->m[0][k], m->m[1][k], m->m[2][k]};
}

/* The frame in which beams that make a fan stand upright side by side, however the fan is tilted; beams whose faces' sides
 * point one way have the head's. */
static asdic_mat3 fan_of(const asdic_sonar *sonar) {
    const asdic_mat3 first = asdic_face_mount(&sonar->receivers[0]),
                     last = asdic_face_mount(&sonar->receivers[sonar->receiver_count - 1]);
    asdic_vec3 y = column(&first, 1), z = asdic_vec3_cross(y, column(&last, 1));
    double size = asdic_vec3_length(z);
    if (size < 1e-6) {
        return asdic_mat3_attitude(0.0, 0.0, 0.0);
    }
    z = asdic_vec3_scale(z, copysign(1.0 / size, z.z));
    asdic_vec3 x = asdic_vec3_cross(y, z);
    return (asdic_mat3){{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
}

/* A beam in the fan's frame. SINE: of the angle from its axis to half power, in bearing; on its side it is as wide as it is
 * high. */
typedef struct lobe {
    double yaw_rad, pitch_rad, sine;
} lobe;

static lobe lobe_of(const asdic_mat3 *fan, const asdic_beam *beam, double wavelength_m) {
    const asdic_mat3 face = asdic_face_mount(beam);
    const asdic_vec3 x = asdic_mat3_apply_inverse(*fan, column(&face, 0)),
                     y = asdic_mat3_apply_inverse(*fan, column(&face, 1));
    double wide = sin(0.5 * asdic_half_power_rad(wavelength_m, beam->length_h_m));
    double high = sin(0.5 * asdic_half_power_rad(wavelength_m, beam->length_v_m));
    double level = hypot(x.x, x.y);                                   /* the cosine of its pitch */
    double turned = level > 0.0 ? fmin(fabs(y.z) / level, 1.0) : 0.0; /* the sine of its roll */
    return (lobe){atan2(x.y, x.x), atan2(x.z, level),
                  sqrt(1.0 - turned * turned) * wide + turned * high};
}

/* Off the upright plane through the beam's axis a direction has the sine sin(bearing - the beam's) cos(elevation), of
 * which the pattern is a function. */
static bool reaches(const lobe *l, const extent *e) {
    double half_rad = 0.5 * (e->high_rad - e->low_rad);
    double middle_rad = e->ref_rad + 0.5 * (e->high_rad + e->low_rad);
    double lobe_rad = asin(fmin(l->sine / fmax(e->least_cos, 1e-9), 1.0));
    double off_rad = fabs(remainder(l->yaw_rad - middle_rad, 2.0 * ASDIC_PI));
    /* A steep beam's half-space goes on beyond the point below, or above: there its plane has the opposite bearing. */
    if (fabs(l->pitch_rad) + acos(e->least_cos) > 0.5 * ASDIC_PI) {
        off_rad = fmin(off_rad, ASDIC_PI - off_rad);
    }
    return e->is_there && (2.0 * half_rad >= ASDIC_PI || off_rad <= half_rad + lobe_rad);
}

bool *asdic_lobes_reach(const asdic_mission *frame, const asdic_mission *owner) {
    const asdic_sonar *sonar = asdic_mission_sonar(frame);
    const asdic_pose pose = asdic_mission_pose(frame, 0, NULL);
    double wavelength_m =
        asdic_environment_sound_speed_mps(&frame->settings.environment, pose.position_m.z) /
        sonar->frequency_hz;
    size_t most = frame->object_count + 1, beams = sonar->receiver_count, count = 0;
    const asdic_mission_object **objects = calloc(most, sizeof *objects);
    const asdic_mat3 fan = fan_of(sonar);
    const view v = {asdic_mat3_multiply(asdic_mat3_of(&pose), fan), pose.position_m,
                    calloc(most, sizeof *v.extents)};
    bool *heard = calloc(most * beams, sizeof *heard);
    bool good = objects && v.extents && heard;
    for (size_t i = 0; good && i < frame->object_count; i++) {
        if (frame->objects[i].name[0]) { /* not the bottom */
            objects[count++] = &frame->objects[i];
        }
    }
    if (good) {
        find_extents(&v, owner->scene, objects);
    }
    for (size_t b = 0; good && b < beams; b++) {
        const lobe l = lobe_of(&fan, &sonar->receivers[b], wavelength_m);
        for (size_t i = 0; i < count; i++) {
            heard[i * beams + b] = reaches(&l, &v.extents[i]);
        }
    }
    free(objects);
    free(v.extents);
    if (!good) {
        free(heard);
        heard = NULL;
    }
    return heard;
}
