#include "lobes.h"

#include "base/vec.h"
#include "out/beam_width.h"
#include "scene/moving.h"
#include "scene/scene.h"

#include <math.h>
#include <stdlib.h>

/* The bearings at which an object is seen from the head: from REF_RAD on LOW_RAD to HIGH_RAD. Bearings of a facet lie
 * between those of its corners. */
typedef struct extent {
    bool is_there;
    double ref_rad, low_rad, high_rad;
    double least_cos; /* of the elevations of its corners */
} extent;

/* Where a frame's sonar is, and the extents of its objects, by number less 1. */
typedef struct view {
    asdic_mat3 head;
    asdic_vec3 from_m;
    extent *extents;
} view;

static void add(const view *v, unsigned number, asdic_vec3 at_m) {
    extent *e = &v->extents[number - 1];
    asdic_vec3 to = asdic_mat3_apply_inverse(v->head, asdic_vec3_sub(at_m, v->from_m));
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

/* The sine of the angle from a beam's axis to half power, in bearing; a beam on its side is as wide as it is high. */
static double lobe_sine(const asdic_beam *beam, double wavelength_m) {
    double wide = sin(0.5 * asdic_half_power_rad(wavelength_m, beam->length_h_m));
    double high = sin(0.5 * asdic_half_power_rad(wavelength_m, beam->length_v_m));
    return fabs(cos(beam->roll_rad)) * wide + fabs(sin(beam->roll_rad)) * high;
}

/* Off the upright plane through the beam's axis a direction has the sine sin(bearing - the beam's) cos(elevation), of
 * which the pattern is a function. */
static bool reaches(const asdic_beam *beam, double sine, const extent *e) {
    double half_rad = 0.5 * (e->high_rad - e->low_rad);
    double middle_rad = e->ref_rad + 0.5 * (e->high_rad + e->low_rad);
    double lobe_rad = asin(fmin(sine / fmax(e->least_cos, 1e-9), 1.0));
    double off_rad = fabs(remainder(beam->yaw_rad - middle_rad, 2.0 * ASDIC_PI));
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
    const view v = {asdic_mat3_of(&pose), pose.position_m, calloc(most, sizeof *v.extents)};
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
    for (size_t i = 0; good && i < count * beams; i++) {
        const asdic_beam *beam = &sonar->receivers[i % beams];
        heard[i] = reaches(beam, lobe_sine(beam, wavelength_m), &v.extents[i / beams]);
    }
    free(objects);
    free(v.extents);
    if (!good) {
        free(heard);
        heard = NULL;
    }
    return heard;
}
