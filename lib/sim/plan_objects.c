/*
 * Whether objects matter: none is in reach, none is in front of the faces, or what they could send
 * back at most drowns in the noise of every bin.
 */
#include "plan_case.h"

#include "base/vec.h"
#include "laws/scatterer.h"
#include "ring.h"
#include "scene/scene.h"

#include "../../kernels/ping_types.h"
#include "../../kernels/ray.h"

#include <string.h>

/* Receivers looked at one by one; of more, each is given full gain. */
#define RECEIVERS_MOST 16
/* As in ray_mirror_gain of ray.h. */
#define FOCUS_MOST 100.0

/* A bounding sphere from a pose. */
typedef struct sight {
    asdic_vec3 towards;
    double nearest_m, chord; /* length of the chord to a direction at the sphere's limb, <= 2 */
    double solid_angle;
} sight;

static sight sight_of(const asdic_part *part, const asdic_pose *pose) {
    asdic_vec3 from = pose->position_m, at = part->center_m;
    ray_way to = ray_between((triple){from.x, from.y, from.z}, (triple){at.x, at.y, at.z},
                             (ray_medium){0.0, 1.0}, 0.0);
    double d = to.t, sine = part->radius_m / fmax(d, 1e-9);
    sight s = {.nearest_m = d - part->radius_m, .chord = 2.0, .solid_angle = 4.0 * ASDIC_PI};
    if (sine < 1.0) {
        double cosine = sqrt((1.0 - sine) * (1.0 + sine));
        s.towards = (asdic_vec3){to.r.u.x, to.r.u.y, to.r.u.z};
        s.chord = sqrt(2.0 * (1.0 - cosine));
        s.solid_angle = 2.0 * ASDIC_PI * (1.0 - cosine);
    }
    return s;
}

static double row_dot(const asdic_face *face, int row, asdic_vec3 u) {
    const double *r = face->world_to_face.m[row];
    return r[0] * u.x + r[1] * u.y + r[2] * u.z;
}

/* Envelope of sinc^2 at direction cosines within CHORD of V. */
static double envelope(double length_wl, double v, double chord) {
    double x = ASDIC_PI * length_wl * fmax(fabs(v) - chord, 0.0);
    return x > 1.0 ? 1.0 / (x * x) : 1.0;
}

/* The most that a face can make of a sphere's directions: cosines differ by at most the chord. */
static double gain_most(const asdic_face *face, const sight *s, double rear_lin) {
    double pattern = envelope(face->length_h_wl, row_dot(face, 1, s->towards), s->chord) *
                     envelope(face->length_v_wl, row_dot(face, 2, s->towards), s->chord);
    return face->axis_lin *
           (row_dot(face, 0, s->towards) < -s->chord ? rear_lin * pattern : pattern);
}

typedef struct gains {
    double send, receive; /* the receive gain that is largest */
} gains;

static gains gains_of(const asdic_plan_case *c, const asdic_pose *pose, const sight *s) {
    double rear = pow(10.0, 0.1 * c->sonar->rear_floor_db);
    asdic_face sender = asdic_face_aim(&c->sonar->transmitter, pose, c->water.wavelength_m);
    gains g = {gain_most(&sender, s, rear), 0.0};
    for (size_t r = 0; r < c->sonar->receiver_count; r++) {
        asdic_face face = asdic_face_aim(&c->sonar->receivers[r], pose, c->water.wavelength_m);
        double gain = c->sonar->receiver_count > RECEIVERS_MOST ? 1.0 : gain_most(&face, s, rear);
        g.receive = fmax(g.receive, gain);
        if (g.receive >= 1.0) {
            break;
        }
    }
    return g;
}

static asdic_scatterer scatterer_of(const asdic_plan_case *c, const asdic_material *material) {
    asdic_law_water water = asdic_water_column_laws(&c->water, c->env, c->sonar);
    return asdic_scatterer_at(material, &water);
}

/* Whether an object of M passes a mirror ray on. */
static bool mirrors(const asdic_scatterer *m) {
    return m->device.law == DEV_LAW_FACET && m->device.reflection2 > DEV_MIN_MIRROR;
}

bool asdic_scene_mirrors(const asdic_scene *scene, asdic_multipath multipath,
                         const asdic_law_water *water) {
    bool boundaries = multipath == ASDIC_MULTIPATH_BOUNDARIES;
    bool found = boundaries && (scene->has_surface || scene->has_bottom_plane);
    for (size_t i = 0; i < scene->part_count && !found && multipath != ASDIC_MULTIPATH_OFF; i++) {
        const asdic_part *part = &scene->parts[i];
        const asdic_scatterer m = asdic_scatterer_at(&scene->materials[part->material], water);
        found = (part->kind == DEV_KIND_BOTTOM && boundaries) ||
                (part->kind == DEV_KIND_OBJECT && mirrors(&m));
    }
    return found;
}

/* What bottom and surface send back per solid angle, times d^2 / TL: s / sin(Theta) at most. INFINITY
 * for a bottom of triangles, which may stand at any angle. */
static double background_most(const asdic_plan_case *c) {
    double sum = 0.0;
    for (size_t i = 0; i < c->scene->part_count; i++) {
        if (c->scene->parts[i].kind == DEV_KIND_BOTTOM) {
            return INFINITY;
        }
    }
    if (c->scene->has_bottom_plane) {
        asdic_scatterer s = scatterer_of(c, &c->scene->materials[c->scene->bottom_plane_material]);
        double least = ray_plane_grazing(c->altitude_least_m, c->range_m);
        sum += s.device.law == DEV_LAW_FACET
                   ? asdic_scatterer_most(&s, c->range_m) / fmax(least, 1e-6)
                   : asdic_scatterer_steepest(&s, least);
    }
    if (c->scene->has_surface) {
        asdic_scatterer s = scatterer_of(c, &c->scene->surface);
        sum += asdic_scatterer_steepest(&s, ray_plane_grazing(c->depth_least_m, c->range_m));
    }
    return sum;
}

/* What the rules know of one object, over all poses. */
typedef struct verdict {
    bool reached, faced, mirrors;
    double echo_lin, bounce_lin; /* most in a bin */
} verdict;

typedef struct bounds {
    double background; /* see background_most */
    double objects;    /* the same of objects that are met after a reflection */
    double nearest_m;  /* of anything that can be met */
} bounds;

static void judge_pose(const asdic_plan_case *c, const bounds *b, size_t part,
                       const asdic_pose *pose, verdict *v) {
    const asdic_part *object = &c->scene->parts[part];
    sight s = sight_of(object, pose);
    if (s.nearest_m > c->reach_m) {
        return;
    }
    v->reached = true;
    if (c->bends) { /* its rays leave and return elsewhere than straight ones, and may be focused */
        v->faced = true;
        v->echo_lin = v->bounce_lin = INFINITY;
        return;
    }
    gains g = gains_of(c, pose, &s);
    v->faced = v->faced || (g.send > 0.0 && g.receive > 0.0);
    if (!(c->noise_lin > 0.0) || v->echo_lin == INFINITY) {
        return;
    }
    if (s.nearest_m <= fmax(c->from_m, 0.1)) {
        v->echo_lin = v->bounce_lin = INFINITY;
        return;
    }
    asdic_scatterer m = scatterer_of(c, &c->scene->materials[object->material]);
    double near2 = s.nearest_m * s.nearest_m;
    double source = pow(10.0, 0.1 * c->sonar->source_level_db) *
                    exp(2.0 * c->water.absorption_np_per_m * fmax(1.0 - s.nearest_m, 0.0));
    /* Its own echo; and what is behind it, which would no longer be hidden. */
    double echo = asdic_scatterer_most(&m, c->range_m) * object->area_m2 / (near2 * near2);
    double volume = asdic_volume_strength_lin(c->env, c->sonar);
    double behind = s.solid_angle * (b->background / near2 + volume / s.nearest_m);
    v->echo_lin = fmax(v->echo_lin, source * g.send * g.receive * (echo + behind));
    /* Over it there and back; over it one way, the other way straight. */
    double met = b->background + b->objects, share = m.device.reflection2;
    double same = share * share * g.send * g.receive * FOCUS_MOST / near2;
    double cross = share * (g.send + g.receive) / (b->nearest_m * b->nearest_m);
    source = pow(10.0, 0.1 * c->sonar->source_level_db) * exp(2.0 * c->water.absorption_np_per_m);
    v->bounce_lin = fmax(v->bounce_lin, source * s.solid_angle * met * (same + cross));
}

static verdict judge(const asdic_plan_case *c, const bounds *b, size_t part) {
    verdict v = {0};
    asdic_scatterer m = scatterer_of(c, &c->scene->materials[c->scene->parts[part].material]);
    v.mirrors = mirrors(&m);
    if (c->scene->parts[part].moves) { /* where to is not known here */
        v.reached = v.faced = true;
        v.echo_lin = v.bounce_lin = INFINITY;
        return v;
    }
    for (size_t i = 0; i < c->count; i++) {
        if (i > 0 && memcmp(&c->poses[i], &c->poses[i - 1], sizeof *c->poses) == 0) {
            continue; /* a vehicle that stands sees nothing new */
        }
        judge_pose(c, b, part, &c->poses[i], &v);
    }
    if (!(c->noise_lin > 0.0)) {
        v.echo_lin = v.bounce_lin = INFINITY;
    }
    return v;
}

static bounds bounds_of(const asdic_plan_case *c) {
    bounds b = {.background = background_most(c)};
    b.nearest_m = fmin(c->altitude_least_m, c->scene->has_surface ? c->depth_least_m : INFINITY);
    for (size_t i = 0; i < c->scene->part_count; i++) {
        asdic_scatterer m = scatterer_of(c, &c->scene->materials[c->scene->parts[i].material]);
        b.objects = fmax(b.objects,
                         asdic_scatterer_most(&m, c->range_m) / 1e-3); /* as grazing() in echo.h */
        for (size_t k = 0; k < c->count; k++) {
            b.nearest_m = fmin(b.nearest_m, sight_of(&c->scene->parts[i], &c->poses[k]).nearest_m);
        }
    }
    b.nearest_m = fmax(b.nearest_m, 0.0);
    return b;
}

typedef struct census {
    size_t objects, reached, faced, mirrors;
    double echo_lin, bounce_lin; /* sums over objects */
} census;

static census take_census(const asdic_plan_case *c) {
    census n = {0};
    bounds b = bounds_of(c);
    for (size_t i = 0; i < c->scene->part_count; i++) {
        if (c->scene->parts[i].kind != DEV_KIND_OBJECT) {
            continue;
        }
        verdict v = judge(c, &b, i);
        n.objects++;
        n.reached += v.reached;
        n.faced += v.reached && v.faced;
        n.mirrors += v.reached && v.mirrors;
        n.echo_lin += v.reached ? v.echo_lin : 0.0;
        n.bounce_lin += v.reached && v.mirrors ? v.bounce_lin : 0.0;
    }
    return n;
}

/* Point targets cost no rays: they count, but never keep triangles. */
static size_t points_reached(const asdic_plan_case *c) {
    size_t reached = 0;
    for (size_t i = 0; i < c->scene->point_count; i++) {
        asdic_part point = {.center_m = c->scene->points[i].position_m};
        bool near = c->scene->points[i].moves;
        for (size_t k = 0; !near && k < c->count; k++) {
            near = sight_of(&point, &c->poses[k]).nearest_m <= c->reach_m;
        }
        reached += near;
    }
    return reached;
}

static void plan_multipath(const asdic_plan_case *c, const census *n, asdic_plan *plan) {
    double bound = n->mirrors ? asdic_plan_change_db(n->bounce_lin, c->noise_lin) : 0.0;
    const char *plural = n->mirrors == 1 ? "" : "s", *singular = n->mirrors == 1 ? "s" : "";
    bool boundaries = c->sampling->multipath == ASDIC_MULTIPATH_BOUNDARIES;
    if (c->sampling->multipath == ASDIC_MULTIPATH_OFF) {
        asdic_plan_row_set(plan, ASDIC_TERM_MULTIPATH, false, INFINITY,
                           "switched off in the scene");
    } else if (boundaries) {
        asdic_plan_row_set(plan, ASDIC_TERM_MULTIPATH, true, INFINITY,
                           "%zu object%s and the boundaries reflect", n->mirrors, plural);
    } else if (n->mirrors == 0) {
        asdic_plan_row_set(plan, ASDIC_TERM_MULTIPATH, false, 0.0, "nothing within range reflects");
    } else if (bound <= ASDIC_PLAN_NEGLIGIBLE_DB) {
        asdic_plan_row_set(plan, ASDIC_TERM_MULTIPATH, false, bound,
                           "%zu object%s reflect%s, below the noise in every bin", n->mirrors,
                           plural, singular);
    } else {
        asdic_plan_row_set(plan, ASDIC_TERM_MULTIPATH, true, bound, "%zu object%s reflect%s",
                           n->mirrors, plural, singular);
    }
}

void asdic_plan_objects(const asdic_plan_case *c, asdic_plan *plan) {
    census n = take_census(c);
    size_t points = points_reached(c), all = n.objects + c->scene->point_count;
    double bound = n.objects ? asdic_plan_change_db(n.echo_lin, c->noise_lin) : 0.0;
    /* Over the boundaries and back an object is heard that no face looks at. */
    bool direct = c->sampling->multipath != ASDIC_MULTIPATH_BOUNDARIES;
    plan_multipath(c, &n, plan);
    bool bounced = !(plan->left_out & (1u << ASDIC_TERM_MULTIPATH)) && n.mirrors > 0;
    if (n.reached + points == 0) {
        asdic_plan_row_set(plan, ASDIC_TERM_OBJECTS, false, 0.0, "none of %zu comes within range",
                           all);
    } else if (points == 0 && direct && n.faced == 0 && !bounced) {
        asdic_plan_row_set(plan, ASDIC_TERM_OBJECTS, false, 0.0,
                           "%zu of %zu come within range, behind the faces", n.reached, all);
    } else if (points == 0 && direct && bound <= ASDIC_PLAN_NEGLIGIBLE_DB && !bounced) {
        asdic_plan_row_set(plan, ASDIC_TERM_OBJECTS, false, bound,
                           "%zu of %zu come within range, below the noise in every bin", n.reached,
                           all);
    } else {
        asdic_plan_row_set(plan, ASDIC_TERM_OBJECTS, true, points ? INFINITY : bound,
                           "%zu of %zu come within range", n.reached + points, all);
    }
}
