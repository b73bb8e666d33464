/*
 * Distances from a segment to what a scene holds. A segment and a triangle that do not meet are
 * nearest at an end of the segment, or at an edge of the triangle (Ericson, Real-Time Collision
 * Detection (2005), sections 5.1.5, 5.1.9 and 5.1.10).
 */
#include "nearest.h"

#include "base/vec.h"

#include <math.h>

typedef struct search {
    const asdic_placement *placement;
    const asdic_scene *scene;
    asdic_vec3 a, b;     /* scene frame */
    double lo[3], hi[3]; /* box round the segment */
    bool looks;          /* from the segment's beginning along it, for ONLY one part: */
    size_t only;
    asdic_vec3 u;              /* that way, a unit vector, */
    double sector_rad, cosine; /* and the angle within which it looks */
    asdic_nearest best;
} search;

static double clamp01(double x) {
    return fmin(fmax(x, 0.0), 1.0);
}

static asdic_vec3 at(asdic_vec3 from, asdic_vec3 along, double t) {
    return asdic_vec3_add(from, asdic_vec3_scale(along, t));
}

static double distance2(asdic_vec3 a, asdic_vec3 b) {
    asdic_vec3 d = asdic_vec3_sub(a, b);
    return asdic_vec3_dot(d, d);
}

/* Squared, between the segments P0 P1 and Q0 Q1 (5.1.9). */
static double segments2(asdic_vec3 p0, asdic_vec3 p1, asdic_vec3 q0, asdic_vec3 q1) {
    asdic_vec3 d1 = asdic_vec3_sub(p1, p0), d2 = asdic_vec3_sub(q1, q0), r = asdic_vec3_sub(p0, q0);
    double a = asdic_vec3_dot(d1, d1), e = asdic_vec3_dot(d2, d2), f = asdic_vec3_dot(d2, r);
    double c = asdic_vec3_dot(d1, r), b = asdic_vec3_dot(d1, d2), d = a * e - b * b;
    double s = a > 0.0 && d > 0.0 ? clamp01((b * f - c * e) / d) : 0.0;
    double t = e > 0.0 ? (b * s + f) / e : 0.0;
    if (t < 0.0 || t > 1.0) {
        t = clamp01(t);
        s = a > 0.0 ? clamp01((b * t - c) / a) : 0.0;
    } else if (e == 0.0) {
        s = a > 0.0 ? clamp01(-c / a) : 0.0;
    }
    return distance2(at(p0, d1, s), at(q0, d2, t));
}

/* Whether X, in the plane of the triangle V with normal N, lies inside. */
static bool is_over(const asdic_vec3 v[3], asdic_vec3 n, asdic_vec3 x) {
    for (int i = 0; i < 3; i++) {
        asdic_vec3 edge = asdic_vec3_sub(v[(i + 1) % 3], v[i]);
        if (asdic_vec3_dot(asdic_vec3_cross(edge, asdic_vec3_sub(x, v[i])), n) < 0.0) {
            return false;
        }
    }
    return true;
}

static double triangle2(asdic_vec3 a, asdic_vec3 b, const asdic_vec3 v[3]) {
    asdic_vec3 n = asdic_vec3_cross(asdic_vec3_sub(v[1], v[0]), asdic_vec3_sub(v[2], v[0]));
    double size2 = asdic_vec3_dot(n, n), best = INFINITY;
    if (size2 > 0.0) {
        double ha = asdic_vec3_dot(asdic_vec3_sub(a, v[0]), n);
        double hb = asdic_vec3_dot(asdic_vec3_sub(b, v[0]), n);
        asdic_vec3 way = asdic_vec3_sub(b, a);
        if (ha * hb <= 0.0 && ha != hb && is_over(v, n, at(a, way, ha / (ha - hb)))) {
            return 0.0;
        }
        if (is_over(v, n, at(a, n, -ha / size2))) {
            best = ha * ha / size2;
        }
        if (is_over(v, n, at(b, n, -hb / size2))) {
            best = fmin(best, hb * hb / size2);
        }
    }
    for (int i = 0; i < 3; i++) {
        best = fmin(best, segments2(a, b, v[i], v[(i + 1) % 3]));
    }
    return best;
}

static asdic_vec3 direction(asdic_vec3 from, asdic_vec3 to) {
    asdic_vec3 along = asdic_vec3_sub(to, from);
    return asdic_vec3_scale(along, 1.0 / asdic_vec3_length(along));
}

/* Whether P, as seen from where S looks from, is within its sector. */
static bool is_ahead(const search *s, asdic_vec3 p) {
    double far = asdic_vec3_length(p);
    return asdic_vec3_dot(p, s->u) >= s->cosine * far - 1e-9 * far;
}

/* Squared, to the nearest that the segment P + t E has ahead, which is its nearest of all or where it enters the sector:
 * where (p . u)^2 = cos^2 p . p. */
static double edge_ahead2(const search *s, asdic_vec3 p, asdic_vec3 e) {
    double pu = asdic_vec3_dot(p, s->u), eu = asdic_vec3_dot(e, s->u), c2 = s->cosine * s->cosine;
    double ee = asdic_vec3_dot(e, e), pe = asdic_vec3_dot(p, e), pp = asdic_vec3_dot(p, p);
    double a = eu * eu - c2 * ee, b = pu * eu - c2 * pe, c = pu * pu - c2 * pp;
    double root = sqrt(fmax(b * b - a * c, 0.0)), best = INFINITY;
    double q = -(b + copysign(root, b)); /* no digits are lost by either root */
    const double t[5] = {0.0, 1.0, -pe / ee, q / a, c / q};
    for (int i = 0; i < 5; i++) {
        asdic_vec3 x = at(p, e, t[i]);
        if (t[i] >= 0.0 && t[i] <= 1.0 && is_ahead(s, x)) {
            best = fmin(best, asdic_vec3_dot(x, x));
        }
    }
    return best;
}

/* Squared, to the nearest that the triangle V has ahead: the foot of the perpendicular, or where the side of the
 * sector that leans most to it meets the triangle, or at an edge. */
static double ahead2(const search *s, const asdic_vec3 v[3]) {
    asdic_vec3 u = s->u,
               n = asdic_vec3_cross(asdic_vec3_sub(v[1], v[0]), asdic_vec3_sub(v[2], v[0]));
    double size2 = asdic_vec3_dot(n, n), best = INFINITY;
    double h = asdic_vec3_dot(asdic_vec3_sub(v[0], s->a), n); /* times the length of N */
    asdic_vec3 aside = asdic_vec3_sub(n, asdic_vec3_scale(u, asdic_vec3_dot(n, u)));
    double lean = asdic_vec3_length(aside), sine = sqrt(fmax(1.0 - s->cosine * s->cosine, 0.0));
    asdic_vec3 foot = asdic_vec3_scale(n, h / size2);
    asdic_vec3 side = asdic_vec3_add(asdic_vec3_scale(u, s->cosine),
                                     asdic_vec3_scale(aside, copysign(sine, h) / lean));
    asdic_vec3 x = size2 > 0.0 && is_ahead(s, foot)
                       ? foot
                       : asdic_vec3_scale(side, h / asdic_vec3_dot(side, n));
    if (size2 > 0.0 && isfinite(asdic_vec3_length(x)) && is_ahead(s, x) &&
        is_over(v, n, asdic_vec3_add(s->a, x))) {
        best = asdic_vec3_dot(x, x);
    }
    for (int i = 0; i < 3; i++) {
        asdic_vec3 edge = asdic_vec3_sub(v[(i + 1) % 3], v[i]);
        best = fmin(best, edge_ahead2(s, asdic_vec3_sub(v[i], s->a), edge));
    }
    return best;
}

static asdic_vec3 corner(const float v[3]) {
    return (asdic_vec3){v[0], v[1], v[2]};
}

static void try_triangle(search *s, uint32_t id) {
    const dev_triangle *t = asdic_placement_triangle(s->placement, id);
    if (s->looks && t->part != s->only) {
        return;
    }
    const asdic_vec3 v[3] = {corner(t->v0), corner(t->v1), corner(t->v2)};
    double distance_m = sqrt(s->looks ? ahead2(s, v) : triangle2(s->a, s->b, v));
    if (distance_m < s->best.distance_m) {
        s->best = (asdic_nearest){distance_m, t->part};
    }
}

/* Between the box of child I and that of the segment, at most the distance of what they hold. */
static double box_m(const search *s, const dev_node8 *n, int i) {
    const float *lo[3] = {n->lo_x, n->lo_y, n->lo_z}, *hi[3] = {n->hi_x, n->hi_y, n->hi_z};
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double gap = fmax(fmax(lo[k][i] - s->hi[k], s->lo[k] - hi[k][i]), 0.0);
        sum += gap * gap;
    }
    return sqrt(sum);
}

/* Whether the ball round the box of child I meets the sector: false only where nothing in the box is ahead. */
static bool may_be_ahead(const search *s, const dev_node8 *n, int i) {
    asdic_vec3 lo = {n->lo_x[i], n->lo_y[i], n->lo_z[i]}, hi = {n->hi_x[i], n->hi_y[i], n->hi_z[i]};
    asdic_vec3 middle = asdic_vec3_sub(at(lo, asdic_vec3_sub(hi, lo), 0.5), s->a);
    double far = asdic_vec3_length(middle), radius = 0.5 * sqrt(distance2(lo, hi));
    double angle = s->sector_rad + (far > radius ? asin(radius / far) : ASDIC_PI) + 1e-6;
    return angle >= ASDIC_PI || asdic_vec3_dot(middle, s->u) >= cos(angle) * far;
}

/* Nodes and blocks of what moves, the first ones, are the placement's. */
static void search_word(search *s, uint32_t word) {
    const asdic_scene *scene = s->scene;
    if (word & DEV_LEAF) {
        uint32_t index = word & ~DEV_LEAF;
        const dev_block4 *block =
            index < scene->moving_blocks ? &s->placement->blocks[index] : &scene->bvh.blocks[index];
        for (int i = 0; i < DEV_LEAF_TRIANGLES; i++) {
            if (block->id[i] != ~0u) {
                try_triangle(s, block->id[i]);
            }
        }
        return;
    }
    const dev_node8 *node =
        word < scene->moving_nodes ? &s->placement->nodes[word] : &scene->bvh.nodes[word];
    for (int i = 0; i < DEV_BVH_WIDTH; i++) {
        if (node->child[i] != DEV_EMPTY && box_m(s, node, i) < s->best.distance_m &&
            (!s->looks || may_be_ahead(s, node, i))) {
            search_word(s, node->child[i]);
        }
    }
}

/* Searches what is under WORD for what is near WAY. */
static void search_along(search *s, const asdic_way *way, uint32_t word) {
    if (word == DEV_EMPTY) {
        return;
    }
    s->a = asdic_vec3_sub(way->from_m, s->placement->origin_m);
    s->b = asdic_vec3_sub(way->to_m, s->placement->origin_m);
    s->u = s->looks ? direction(s->a, s->b) : s->u;
    const double a[3] = {s->a.x, s->a.y, s->a.z}, b[3] = {s->b.x, s->b.y, s->b.z};
    for (int k = 0; k < 3; k++) {
        s->lo[k] = fmin(a[k], b[k]);
        s->hi[k] = fmax(a[k], b[k]);
    }
    search_word(s, word);
}

/* Searches all triangles. */
static void search_all(search *s, const asdic_way *way, const asdic_way *moving) {
    const asdic_scene *scene = s->scene;
    size_t movables = scene->movable_count;
    search_along(s, way, moving && movables > 0 ? scene->still_root : scene->bvh.root);
    for (size_t i = 0; moving && i < movables; i++) {
        search_along(s, &moving[i], scene->movables[i].root);
    }
}

asdic_nearest asdic_placement_nearest(const asdic_placement *placement, const asdic_way *way,
                                      const asdic_way *moving, double within_m) {
    const asdic_scene *scene = placement->scene;
    size_t movables = scene->movable_count;
    search s = {.placement = placement, .scene = scene, .best = {within_m, ASDIC_NOTHING}};
    if (scene->has_bottom_plane) {
        double height_m = scene->bottom_plane_depth_m - fmax(way->from_m.z, way->to_m.z);
        s.best.distance_m = fmin(s.best.distance_m, fmax(height_m, 0.0));
    }
    search_all(&s, way, moving);
    for (size_t i = 0; i < scene->point_count; i++) {
        const asdic_way *seen = moving ? &moving[movables + i] : way;
        asdic_vec3 point_m = placement->points[i].position_m;
        double distance_m = sqrt(segments2(seen->from_m, seen->to_m, point_m, point_m));
        if (distance_m < s.best.distance_m) {
            s.best = (asdic_nearest){distance_m, scene->part_count + i};
        }
    }
    return s.best;
}

double asdic_placement_ahead(const asdic_placement *placement, size_t part, const asdic_way *look,
                             const asdic_way *moving, double sector_rad, double within_m) {
    const asdic_scene *scene = placement->scene;
    size_t movables = scene->movable_count;
    search s = {.placement = placement,
                .scene = scene,
                .looks = true,
                .only = part,
                .sector_rad = sector_rad,
                .cosine = cos(sector_rad),
                .best = {within_m, ASDIC_NOTHING}};
    if (part >= scene->part_count) {
        size_t i = part - scene->part_count;
        const asdic_way *way = moving ? &moving[movables + i] : look;
        asdic_vec3 p = asdic_vec3_sub(placement->points[i].position_m, way->from_m);
        s.u = direction(way->from_m, way->to_m);
        double far_m = asdic_vec3_length(p);
        return is_ahead(&s, p) && far_m < within_m ? far_m : INFINITY;
    }
    search_all(&s, look, moving);
    return s.best.part == part ? s.best.distance_m : INFINITY;
}

/* Whether SIDE is that of a place left of the line from A to B. A place on it counts as moved north by next to nothing,
 * and east by less: an edge seen from above belongs to one of the two triangles beside it. */
static bool is_left(double side, const float *a, const float *b) {
    return side > 0.0 || (side == 0.0 && (a[1] > b[1] || (a[1] == b[1] && a[0] < b[0])));
}

/* Where the plumb line through P meets T: 1 below P, -1 elsewhere, 0 nowhere. */
static int plumb(asdic_vec3 p, const dev_triangle *t) {
    const float *v[3] = {t->v0, t->v1, t->v2};
    double area = 0.0, z = 0.0;
    int left = 0;
    for (int i = 0; i < 3; i++) {
        const float *a = v[(i + 1) % 3], *b = v[(i + 2) % 3];
        double side = ((double)a[0] - p.x) * ((double)b[1] - p.y) -
                      ((double)a[1] - p.y) * ((double)b[0] - p.x);
        left += is_left(side, a, b);
        area += side;
        z += side * v[i][2];
    }
    return left % 3 != 0 || area == 0.0 ? 0 : z / area > p.z ? 1 : -1;
}

bool asdic_placement_is_inside(const asdic_placement *placement, asdic_vec3 position_m,
                               size_t *part) {
    const asdic_scene *scene = placement->scene;
    asdic_vec3 p = asdic_vec3_sub(position_m, placement->origin_m);
    size_t below = 0, above = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) { /* of a part one after the other */
        const dev_triangle *t = asdic_placement_triangle(placement, i);
        int where = scene->parts[t->part].kind == DEV_KIND_OBJECT ? plumb(p, t) : 0;
        below += where > 0;
        above += where < 0;
        bool is_last = i + 1 == scene->triangle_count ||
                       asdic_placement_triangle(placement, i + 1)->part != t->part;
        if (is_last && below % 2 && above % 2) {
            *part = t->part;
            return true;
        }
        below = is_last ? 0 : below;
        above = is_last ? 0 : above;
    }
    return false;
}
