#include "glints.h"

#include "aim.h"
#include "base/context.h"
#include "base/sort.h"
#include "base/vec.h"
#include "cones.h"
#include "eigenray.h"
#include "sonar_ray.h"

#include "../../kernels/smooth.h"
#include "../../kernels/target.h"

#include <stdlib.h>

/* Share of the rays for a body's own glint, a ninth of which meets the middle of its lobe; for one between two. */
#define OWN_SHARE 0.01
#define SHARE 0.005
/* Sine of a cone's half-angle, at most. */
#define WIDEST 0.3
/* A cone reaches so many r.m.s. slopes of the target's lobe out. Where that is more than this part of the mirror's own
 * bounding sphere, the body's cone has rays enough. */
#define LOBES 3.0
#define WIDE 0.3
/* Of bodies with more triangles glints between two are not looked for, which takes long: these are met by chance. */
#define MOST_TRIANGLES 65536
/* Bodies that are looked at, each alone and in all pairs. */
#define MOST_BODIES 8
/* Ways through layers to one glint that get rays. */
#define MOST_WAYS 6
/* A facet smaller than this part of both ways is no such spot where it leans farther than by this cosine. */
#define SMALL 0.1
#define LEAST_FACING 0.95
/* Times that triangles are looked for; turns, each time, of settling on one body's and on the other's. */
#define ROUNDS 2
#define TURNS 3
/* Strides in which a glint follows the sonar, of its distance; steps of Newton's method in each, and how much of the
 * target's r.m.s. slope may be left. */
#define STRIDE 0.01
#define MOST_STRIDES 20.0
#define NEWTON 4
#define CLOSE 0.1
#define SETTLING 8

static asdic_vec3 vec3_of(vector v) {
    return (asdic_vec3){v.x, v.y, v.z};
}

static asdic_vec3 unit(asdic_vec3 v) {
    return asdic_vec3_scale(v, 1.0 / fmax(asdic_vec3_length(v), 1e-300));
}

/* V, STEP along D. */
static asdic_vec3 stepped(asdic_vec3 v, double step, asdic_vec3 d) {
    return asdic_vec3_add(v, asdic_vec3_scale(d, step));
}

/* ---- Rays over spots ---- */

/* How the normal of the spot's quadric turns from its middle to X from there. The normal's own curvature, the larger of
 * both others, makes that of a ball a ball and that of a tube a tube. */
static asdic_vec3 turn_of(const asdic_spot *s, asdic_vec3 x) {
    double a = asdic_vec3_dot(s->axes[0], x), b = asdic_vec3_dot(s->axes[1], x);
    asdic_vec3 turn = asdic_vec3_scale(s->normal, s->steepest * asdic_vec3_dot(s->normal, x));
    turn = stepped(turn, s->bend[0] * a + s->bend[1] * b, s->axes[0]);
    return stepped(turn, s->bend[1] * a + s->bend[2] * b, s->axes[1]);
}

/* Where the ray from FROM along U meets the spot's osculating quadric, and the normal there; false: nowhere. */
static bool meet(const asdic_spot *s, const asdic_part *parts, asdic_vec3 from, asdic_vec3 u,
                 asdic_vec3 *at, asdic_vec3 *normal) {
    asdic_vec3 middle = asdic_vec3_add(parts[s->part].center_m, s->offset_m);
    asdic_vec3 begin = asdic_vec3_sub(from, middle);
    double t = -asdic_vec3_dot(s->normal, begin) / asdic_vec3_dot(s->normal, u), rest = 0.0;
    for (int i = 0; i < NEWTON; i++) {
        asdic_vec3 x = stepped(begin, t, u), turn = turn_of(s, x);
        rest = asdic_vec3_dot(s->normal, x) + 0.5 * asdic_vec3_dot(turn, x);
        *normal = asdic_vec3_add(s->normal, turn);
        t -= rest / asdic_vec3_dot(*normal, u);
    }
    *normal = unit(*normal);
    *at = stepped(from, t, u);
    return t > 0.0 && fabs(rest) < 1e-3 * t && asdic_vec3_dot(*normal, u) < 0.0;
}

/* Moves AT, on the spot, to where it mirrors FROM to TO. */
static void settle(const asdic_spot *s, const asdic_part *parts, asdic_vec3 from, asdic_vec3 to,
                   asdic_vec3 *at) {
    asdic_vec3 middle = asdic_vec3_add(parts[s->part].center_m, s->offset_m);
    double a = 0.0, b = 0.0;
    for (int i = 0; i < SETTLING; i++) {
        asdic_vec3 across = stepped(asdic_vec3_scale(s->axes[0], a), b, s->axes[1]);
        double rise = asdic_vec3_dot(turn_of(s, across), across);
        rise /= 1.0 + sqrt(fmax(1.0 - s->steepest * rise, 0.0));
        across = stepped(across, -rise, s->normal);
        *at = asdic_vec3_add(middle, across);
        asdic_vec3 x = asdic_vec3_sub(from, *at), y = asdic_vec3_sub(to, *at);
        asdic_vec3 off = unit(asdic_vec3_add(s->normal, turn_of(s, across)));
        off = asdic_vec3_sub(unit(asdic_vec3_add(unit(x), unit(y))), off);
        double along = asdic_vec3_dot(off, s->axes[0]), aside = asdic_vec3_dot(off, s->axes[1]);
        double near = 0.5 / asdic_vec3_length(x) + 0.5 / asdic_vec3_length(y);
        double first = s->bend[0] + near, last = s->bend[2] + near;
        double all = first * last - s->bend[1] * s->bend[1];
        a += (last * along - s->bend[1] * aside) / all;
        b += (first * aside - s->bend[1] * along) / all;
    }
}

/* A ray over both spots: where it meets them, the cosine of its incidence on the mirror, and how far the target's normal is
 * off the middle between its ways in and out, along the target's axes. Of a straight one both are the target's. */
typedef struct passing {
    asdic_vec3 mirror_m, target_m, arriving;
    double cosine, off[2];
} passing;

static bool pass(const asdic_glint *g, const asdic_part *parts, asdic_vec3 from, asdic_vec3 u,
                 passing *p) {
    asdic_vec3 m, v = u;
    if (!meet(&g->mirror, parts, from, u, &p->mirror_m, &m)) {
        return false;
    }
    p->cosine = -asdic_vec3_dot(u, m);
    p->target_m = p->mirror_m;
    if (!g->straight) {
        v = stepped(u, 2.0 * p->cosine, m);
        if (!meet(&g->target, parts, p->mirror_m, v, &p->target_m, &m)) {
            return false;
        }
    }
    p->arriving = v;
    asdic_vec3 back =
        g->returns ? asdic_vec3_scale(v, -1.0) : unit(asdic_vec3_sub(from, p->target_m));
    asdic_vec3 off = asdic_vec3_sub(unit(asdic_vec3_sub(back, v)), m);
    p->off[0] = asdic_vec3_dot(off, g->target.axes[0]);
    p->off[1] = asdic_vec3_dot(off, g->target.axes[1]);
    return true;
}

/* The glint as FROM sees it: direction, the ray there, and how its miss changes with direction across that. */
typedef struct sighting {
    asdic_vec3 u;
    passing at;
    double by[2][2]; /* by axis across u, along axis of the target */
    double tube_m2;  /* at the target, of one steradian */
} sighting;

static bool vary(const asdic_glint *g, const asdic_part *parts, asdic_vec3 from, sighting *s,
                 asdic_vec3 axes[2]) {
    const double little = 1e-6;
    asdic_vec3_across(s->u, axes);
    if (!pass(g, parts, from, s->u, &s->at)) {
        return false;
    }
    asdic_vec3 moved[2];
    for (int k = 0; k < 2; k++) {
        passing near;
        if (!pass(g, parts, from, unit(stepped(s->u, little, axes[k])), &near)) {
            return false;
        }
        for (int i = 0; i < 2; i++) {
            s->by[k][i] = (near.off[i] - s->at.off[i]) / little;
        }
        moved[k] = asdic_vec3_scale(asdic_vec3_sub(near.target_m, s->at.target_m), 1.0 / little);
    }
    s->tube_m2 = fabs(asdic_vec3_dot(asdic_vec3_cross(moved[0], moved[1]), s->at.arriving));
    return true;
}

static double determinant(const sighting *s) {
    return s->by[0][0] * s->by[1][1] - s->by[0][1] * s->by[1][0];
}

/* Turns S, seen FROM, by Newton's method to where nothing is off; false: the ray misses the bodies. */
static bool refine(const asdic_glint *g, const asdic_part *parts, asdic_vec3 from, sighting *s) {
    asdic_vec3 axes[2];
    for (int i = 0; vary(g, parts, from, s, axes); i++) {
        const double *off = s->at.off, all = determinant(s);
        if (i == NEWTON || hypot(off[0], off[1]) < CLOSE * sqrt(g->slope_ms)) {
            return true;
        }
        double x = s->by[1][0] * off[1] - s->by[1][1] * off[0];
        double y = s->by[0][1] * off[0] - s->by[0][0] * off[1];
        s->u = unit(stepped(stepped(s->u, x / all, axes[0]), y / all, axes[1]));
    }
    return false;
}

/* Follows the glint, in strides, from where it was found; false: it is lost. */
static bool sight(const asdic_glint *g, const asdic_part *parts, asdic_vec3 position_m,
                  sighting *s) {
    asdic_vec3 way = asdic_vec3_sub(position_m, g->from_m);
    asdic_vec3 seen_m = asdic_vec3_add(parts[g->mirror.part].center_m, g->seen_m);
    double far = asdic_vec3_length(asdic_vec3_sub(seen_m, g->from_m));
    double strides = ceil(fmin(asdic_vec3_length(way) / (STRIDE * far), MOST_STRIDES));
    int last = (int)fmax(strides, 1.0);
    for (int k = 1; k <= last; k++) {
        asdic_vec3 from = stepped(g->from_m, (double)k / last, way);
        s->u = unit(asdic_vec3_sub(seen_m, from));
        if (!refine(g, parts, from, s)) {
            return false;
        }
        seen_m = s->at.mirror_m;
    }
    return hypot(s->at.off[0], s->at.off[1]) < CLOSE * sqrt(g->slope_ms);
}

/* How far the target's lobe reaches from the glint in directions of the sonar's rays: an ellipse, its half-axes sines. */
typedef struct lobe {
    asdic_vec3 wide;
    double narrow;
} lobe;

/* The lobe of S, seen FROM; false: it lies aside of the body, which ends before. */
static bool find_lobe(const asdic_glint *g, const asdic_part *parts, asdic_vec3 from,
                      const sighting *s, lobe *out) {
    double xx = s->by[0][0] * s->by[0][0] + s->by[0][1] * s->by[0][1];
    double yy = s->by[1][0] * s->by[1][0] + s->by[1][1] * s->by[1][1];
    double xy = s->by[0][0] * s->by[1][0] + s->by[0][1] * s->by[1][1];
    double most = 0.5 * (xx + yy) + hypot(0.5 * (xx - yy), xy), off = LOBES * sqrt(g->slope_ms);
    double turn = 0.5 * atan2(2.0 * xy, xx - yy); /* to the narrow axis */
    double reach = off * sqrt(most) / fmax(fabs(determinant(s)), 1e-9);
    const asdic_part *body = &parts[g->mirror.part];
    double aside_m = asdic_vec3_length(asdic_vec3_sub(s->at.mirror_m, body->center_m));
    double far_m = asdic_vec3_length(asdic_vec3_sub(s->at.mirror_m, from));
    asdic_vec3 axes[2];
    asdic_vec3_across(s->u, axes);
    asdic_vec3 wide = stepped(asdic_vec3_scale(axes[0], -sin(turn)), cos(turn), axes[1]);
    bool misses = aside_m - body->radius_m > reach * far_m;
    reach = fmin(reach, fmin((aside_m + body->radius_m) / far_m, WIDEST));
    /* Over two curved bodies lobes are no ellipses: the longer axis round about holds them. */
    double narrow = g->straight ? fmin(off / sqrt(most), reach) : reach;
    *out = (lobe){asdic_vec3_scale(wide, reach), narrow};
    return !misses;
}

/* ---- Where the spots are ---- */

/* What is looked at, and the triangles of each part. */
typedef struct looking {
    const asdic_placement *placement;
    const asdic_eye *eye;
    asdic_vec3 from_m;
    const size_t *first, *end; /* by part */
} looking;

static asdic_vec3 corner_of(const looking *l, const float *v) {
    return asdic_vec3_add((asdic_vec3){v[0], v[1], v[2]}, l->placement->origin_m);
}

/* A triangle from its first corner, and both ends of a way over it from there; distances are from its plane. */
typedef struct facing {
    asdic_vec3 corner_m, b, c, normal, from, to;
    double near, far;
} facing;

/* False: T lies aside, or has the ends on two sides or inside PART, or, small, leans too far. */
static bool faces(const looking *l, const asdic_part *part, const dev_triangle *t, asdic_vec3 from,
                  asdic_vec3 to, facing *f) {
    f->corner_m = corner_of(l, t->v0);
    f->normal = (asdic_vec3){t->normal[0], t->normal[1], t->normal[2]};
    f->from = asdic_vec3_sub(from, f->corner_m);
    f->to = asdic_vec3_sub(to, f->corner_m);
    f->near = asdic_vec3_dot(f->from, f->normal);
    f->far = asdic_vec3_dot(f->to, f->normal);
    if (!(f->near * f->far > 0.0) || part->outward * f->near < 0.0) {
        return false;
    }
    double from2 = asdic_vec3_dot(f->from, f->from), to2 = asdic_vec3_dot(f->to, f->to);
    asdic_vec3 h = stepped(asdic_vec3_scale(f->from, sqrt(to2 / from2)), 1.0, f->to);
    double along = asdic_vec3_dot(h, f->normal);
    bool leans = along * along < LEAST_FACING * LEAST_FACING * asdic_vec3_dot(h, h);
    f->b = asdic_vec3_sub(corner_of(l, t->v1), f->corner_m);
    f->c = asdic_vec3_sub(corner_of(l, t->v2), f->corner_m);
    double size2 = fmax(asdic_vec3_dot(f->b, f->b), asdic_vec3_dot(f->c, f->c));
    return !leans || size2 > SMALL * SMALL * fmin(from2, to2);
}

/* The point of a triangle next to where its plane would mirror one end to the other. */
static asdic_vec3 touch(const facing *f) {
    asdic_vec3 image = stepped(f->to, -2.0 * f->far, f->normal);
    asdic_vec3 way = asdic_vec3_sub(image, f->from);
    asdic_vec3 x = stepped(f->from, f->near / (f->near + f->far), way);
    double area = fmax(asdic_vec3_dot(asdic_vec3_cross(f->b, f->c), f->normal), 1e-30);
    double u = asdic_vec3_dot(asdic_vec3_cross(x, f->c), f->normal) / area;
    double v = asdic_vec3_dot(asdic_vec3_cross(f->b, x), f->normal) / area;
    u = fmin(fmax(u, 0.0), 1.0);
    v = fmin(fmax(v, 0.0), 1.0 - u);
    return stepped(stepped(f->corner_m, u, f->b), v, f->c);
}

/* The surface of T, which has SIDE outside, at AT. */
static asdic_spot spot_of(const looking *l, const dev_triangle *t, asdic_vec3 at, double side) {
    asdic_vec3 in_frame = asdic_vec3_sub(at, l->placement->origin_m);
    vector p = vector_of((float)in_frame.x, (float)in_frame.y, (float)in_frame.z);
    asdic_spot s = {.part = t->part,
                    .offset_m = asdic_vec3_sub(at, l->placement->parts[t->part].center_m),
                    .normal = asdic_vec3_scale(vec3_of(smooth_normal(t, p)), side)};
    asdic_vec3_across(s.normal, s.axes);
    if (t->corner_normals[0] != DEV_FLAT) {
        smooth_frame f = smooth_frame_of(t);
        asdic_vec3 turn[2];
        for (int k = 0; k < 2; k++) {
            asdic_vec3 d = s.axes[k];
            turn[k] =
                vec3_of(smooth_derivative(t, f, vector_of((float)d.x, (float)d.y, (float)d.z)));
        }
        s.bend[0] = side * asdic_vec3_dot(turn[0], s.axes[0]);
        s.bend[1] =
            0.5 * side * (asdic_vec3_dot(turn[0], s.axes[1]) + asdic_vec3_dot(turn[1], s.axes[0]));
        s.bend[2] = side * asdic_vec3_dot(turn[1], s.axes[1]);
        double mean = 0.5 * (s.bend[0] + s.bend[2]);
        s.steepest = mean + copysign(hypot(0.5 * (s.bend[0] - s.bend[2]), s.bend[1]), mean);
    }
    return s;
}

/* The triangle of a part, its spot, and the point of that, which mirror FROM to TO best; NULL: none. */
static const dev_triangle *find_spot(const looking *l, size_t part, asdic_vec3 from, asdic_vec3 to,
                                     asdic_spot *out, asdic_vec3 *at) {
    const dev_triangle *best = NULL;
    double least = INFINITY;
    for (size_t i = l->first[part]; i < l->end[part]; i++) {
        const dev_triangle *t = asdic_placement_triangle(l->placement, i);
        facing f;
        if (t->part != part || !faces(l, &l->placement->parts[part], t, from, to, &f)) {
            continue;
        }
        asdic_vec3 p = touch(&f);
        asdic_vec3 h = asdic_vec3_add(unit(asdic_vec3_sub(from, p)), unit(asdic_vec3_sub(to, p)));
        asdic_spot spot = spot_of(l, t, p, f.near > 0.0 ? 1.0 : -1.0);
        asdic_vec3 off = asdic_vec3_sub(unit(h), spot.normal);
        double off2 = asdic_vec3_dot(off, off);
        if (off2 < least) {
            least = off2;
            best = t;
            *out = spot;
        }
    }
    if (best) {
        settle(out, l->placement->parts, from, to, at);
    }
    return best;
}

/* ---- Which glints there are ---- */

static const asdic_scatterer *scatterer_of(const looking *l, const asdic_spot *s) {
    return &l->eye->scatterers[l->placement->parts[s->part].material];
}

/* Mean-square slope of the lobe of T, RANGE_M on the way. */
static double slope_of(const looking *l, const dev_triangle *t, double range_m) {
    const asdic_part *part = &l->placement->parts[t->part];
    const dev_material *m = &l->eye->scatterers[part->material].device;
    float wavelength_m = l->eye->ping->wavelength_m;
    float size_m2 = (float)(4.0 * part->radius_m * part->radius_m);
    float flat_m2 = m->formula[1] > 0.0f ? m->formula[1] : smooth_flat_m2(t, wavelength_m, size_m2);
    return facet_slope_ms(m->formula[0], flat_m2, wavelength_m, range_m);
}

/* How loud it is: what both bodies pass on, over what the tube of rays spreads; 0: it does not stand out, or the mirror's
 * own cone is as narrow. */
static double loudness(const looking *l, const asdic_glint *g, const sighting *s) {
    const asdic_part *parts = l->placement->parts;
    const asdic_scatterer *over = scatterer_of(l, &g->mirror),
                          *target = scatterer_of(l, &g->target);
    double share = g->straight ? 1.0 : over->material.law->reflected(over, s->at.cosine);
    double g_target = target->device.roughness_g,
           range = asdic_vec3_length(asdic_vec3_sub(s->at.mirror_m, l->from_m));
    double peak = exp(-g_target) / (4.0 * g->slope_ms);
    lobe reach;
    asdic_vec3 home = asdic_vec3_sub(s->at.target_m, l->from_m);
    double spread_m2 = g->returns ? s->tube_m2 : asdic_vec3_dot(home, home);
    double body = WIDE * parts[g->mirror.part].radius_m / range;
    if (share < (double)DEV_MIN_MIRROR || peak < 1.0 ||
        !find_lobe(g, parts, l->from_m, s, &reach) ||
        asdic_vec3_length(reach.wide) * reach.narrow > body * body) {
        return 0.0;
    }
    asdic_vec3 back = g->returns ? s->u : unit(home);
    double gain = sqrt(asdic_aim_envelope(l->eye->aimed, l->eye->ping->beams, s->u) *
                       asdic_aim_envelope(l->eye->aimed, l->eye->ping->beams, back));
    return gain * share * (g->returns ? share : 1.0) * exp(-g_target) /
           (fabs(determinant(s)) * spread_m2);
}

/* Completes G, with its target on TO at Q, seen at P; false: it is not loud. */
static bool judge(const looking *l, const dev_triangle *to, asdic_vec3 p, asdic_vec3 q,
                  asdic_glint *g) {
    const asdic_part *parts = l->placement->parts;
    double there = asdic_vec3_length(asdic_vec3_sub(p, l->from_m));
    g->slope_ms = slope_of(l, to, there + asdic_vec3_length(asdic_vec3_sub(q, p)));
    g->seen_m = asdic_vec3_sub(p, parts[g->mirror.part].center_m);
    sighting s;
    if (!sight(g, parts, l->from_m, &s)) {
        return false;
    }
    g->score = loudness(l, g, &s);
    return g->score > 0.0;
}

/* Looks for the glint of TARGET in MIRROR. */
static bool find_glint(const looking *l, size_t mirror, size_t target, bool returns,
                       asdic_glint *g) {
    const asdic_part *parts = l->placement->parts;
    asdic_vec3 p, q = parts[target].center_m;
    const dev_triangle *to = NULL;
    *g = (asdic_glint){.returns = returns, .from_m = l->from_m};
    for (int i = 0; i < ROUNDS; i++) {
        if (!find_spot(l, mirror, l->from_m, q, &g->mirror, &p)) {
            return false;
        }
        to = find_spot(l, target, p, returns ? p : l->from_m, &g->target, &q);
        if (!to) {
            return false;
        }
        for (int k = 0; k < TURNS; k++) {
            settle(&g->mirror, parts, l->from_m, q, &p);
            settle(&g->target, parts, p, returns ? p : l->from_m, &q);
        }
    }
    return judge(l, to, p, q, g);
}

/* Looks for the glint of PART itself. */
static bool find_own(const looking *l, size_t part, asdic_glint *g) {
    asdic_vec3 p;
    *g = (asdic_glint){.straight = true, .returns = true, .from_m = l->from_m};
    const dev_triangle *to = find_spot(l, part, l->from_m, l->from_m, &g->mirror, &p);
    g->target = g->mirror;
    return to && judge(l, to, p, p, g);
}

static bool is_louder(const void *a, const void *b) {
    return ((const asdic_glint *)a)->score > ((const asdic_glint *)b)->score;
}

/* Whether a part is a body that mirrors or glints at all. */
static bool may_glint(const looking *l, size_t part) {
    const asdic_scatterer *s = &l->eye->scatterers[l->placement->parts[part].material];
    return l->placement->parts[part].kind == DEV_KIND_OBJECT && !s->silent &&
           s->device.law == DEV_LAW_FACET;
}

typedef struct body {
    size_t part;
    double size;
} body;

static bool looks_larger(const void *a, const void *b) {
    return ((const body *)a)->size > ((const body *)b)->size;
}

/* The bodies that look largest of those that may glint, within range, of MOST triangles; returns how many. */
static size_t pick_bodies(const looking *l, size_t most, body bodies[MOST_BODIES]) {
    size_t count = 0;
    for (size_t i = 0; i < l->placement->scene->part_count; i++) {
        const asdic_part *part = &l->placement->parts[i];
        double distance = asdic_vec3_length(asdic_vec3_sub(part->center_m, l->from_m));
        const body seen = {i, part->radius_m / fmax(distance, 1e-9)};
        if (!may_glint(l, i) || l->end[i] - l->first[i] > most ||
            distance - part->radius_m > l->eye->ping->range_m) {
            continue;
        }
        asdic_sort_keep(bodies, &count, MOST_BODIES, &seen, sizeof seen, looks_larger);
    }
    return count;
}

static void keep(asdic_glint_list *glints, const asdic_glint *g) {
    asdic_sort_keep(glints->glint, &glints->count, DEV_MAX_CONES, g, sizeof *g, is_louder);
}

static void find_all(asdic_glints *glints, const looking *l, bool mirrors) {
    body bodies[MOST_BODIES];
    size_t count = pick_bodies(l, SIZE_MAX, bodies);
    asdic_glint g;
    for (size_t k = 0; k < count; k++) {
        if (find_own(l, bodies[k].part, &g)) {
            keep(&glints->own, &g);
        }
    }
    count = mirrors ? pick_bodies(l, MOST_TRIANGLES, bodies) : 0;
    for (size_t k = 0; k < 2 * count * count; k++) {
        size_t mirror = bodies[k / 2 / count].part, target = bodies[k / 2 % count].part;
        if (mirror != target && find_glint(l, mirror, target, k % 2 != 0, &g)) {
            keep(&glints->between, &g);
        }
    }
}

asdic_status asdic_glints_find(asdic_glints *glints, const asdic_placement *placement,
                               asdic_vec3 position_m, const asdic_eye *eye, bool mirrors) {
    const asdic_scene *scene = placement->scene;
    size_t *first = calloc(2 * scene->part_count + 1, sizeof *first),
           *end = first + scene->part_count;
    glints->own.count = glints->between.count = 0;
    if (!first) {
        return asdic_fail_memory(scene->ctx, "glints");
    }
    for (size_t i = 0; i < scene->triangle_count; i++) {
        size_t part = scene->triangles[i].part;
        first[part] = end[part] > 0 ? first[part] : i;
        end[part] = i + 1;
    }
    find_all(glints, &(looking){placement, eye, position_m, first, end}, mirrors);
    free(first);
    return ASDIC_OK;
}

/* The directions of the rays that come APART from the sonar by WAY, which is straight; returns how many. */
static size_t find_ways(const dev_ping *ping, const asdic_passage *way, double from_m,
                        asdic_vec3 apart, asdic_vec3 towards[MOST_WAYS]) {
    if (way->layers.count <= 1) {
        triple u = asdic_sonar_ray(ping, apart, 0.0).r.u;
        towards[0] = (asdic_vec3){u.x, u.y, u.z};
        return 1;
    }
    asdic_eigenray rays[ASDIC_MOST_EIGENRAYS];
    double level = hypot(apart.x, apart.y), least = fmax(level, 1e-9);
    size_t count = asdic_eigenrays_find(&way->layers, from_m, from_m + apart.z, level, rays);
    count = count < MOST_WAYS ? count : MOST_WAYS;
    for (size_t i = 0; i < count; i++) {
        double flat = cos(rays[i].elevation_rad) / least;
        towards[i] = (asdic_vec3){flat * apart.x, flat * apart.y, sin(rays[i].elevation_rad)};
    }
    return count;
}

static void place(const asdic_glint_list *glints, double share, const asdic_part *parts,
                  asdic_vec3 position_m, const asdic_passage *way, dev_ping *ping) {
    dev_uint each = (dev_uint)(share * ping->batch.rays);
    size_t room = way->layers.count > 1 ? DEV_CONES : 3 * DEV_MAX_CONES;
    for (size_t k = 0; k < glints->count && each > 0; k++) {
        const asdic_glint *g = &glints->glint[k];
        sighting s;
        lobe reach;
        if (!sight(g, parts, position_m, &s) || !find_lobe(g, parts, position_m, &s, &reach)) {
            continue;
        }
        asdic_vec3 towards[MOST_WAYS];
        size_t count =
            find_ways(ping, way, position_m.z, asdic_vec3_sub(s.at.mirror_m, position_m), towards);
        for (size_t i = 0; i < count && ping->sampling.cones < room; i++) {
            asdic_cones_add(ping, towards[i], reach.wide, reach.narrow, each);
        }
    }
}

void asdic_glints_place(const asdic_glints *glints, const asdic_part *parts, asdic_vec3 position_m,
                        const asdic_passage *way, dev_ping *ping) {
    place(&glints->own, OWN_SHARE, parts, position_m, way, ping);
    place(&glints->between, SHARE, parts, position_m, way, ping);
}
