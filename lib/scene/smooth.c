#include "smooth.h"

#include "base/try.h"

#include "bend.h"
#include "moving.h"
#include "patch.h"
#include "straight.h"

#include "laws/scatterer.h"

#include "../../kernels/smooth.h"
#include "../base/context.h"
#include "../base/vec.h"

#include <stdlib.h>

/* Of half the angle at which facets meet at an edge. */
#define HALF_CREASE_COSINE 0.954
/* A patch this much larger than its neighbour may be a flat face with a rounded edge, which stays flat. */
#define FACE_RATIO 4.0
/* It is where the neighbour bends this much faster. On a ball all facets bend alike. */
#define BEND_RATIO 2.0
/* A face is cut into two triangles at least, unless it is one. What is cut into more than one across the way in which
 * it would bend is one for certain: facets of a curved surface turn from one to the next. */
#define SOME_FACETS 1.5
/* Normals differ one way alone where the variance the other way is a smaller share. */
#define ONE_WAY 1e-6
/* Vertices off the surface, as marching cubes leave them, would turn a normal by a larger share of what those around
 * differ from it, r.m.s. */
#define MOST_TURN 0.35
/* What lies ahead over a bevel goes on turning about its edge; the cap of a round body's end, beside fine strips, has
 * its normal along that, with this cosine or more. */
#define ASIDE 0.5

uint32_t asdic_smooth_pack(asdic_vec3 n) {
    double sum = fabs(n.x) + fabs(n.y) + fabs(n.z);
    double x = n.x / sum, y = n.y / sum;
    if (n.z < 0.0) { /* the lower half is folded outwards */
        double fold = x;
        x = (1.0 - fabs(y)) * (fold < 0.0 ? -1.0 : 1.0);
        y = (1.0 - fabs(fold)) * (y < 0.0 ? -1.0 : 1.0);
    }
    uint32_t low = (uint16_t)(int16_t)lround(x * OCTAHEDRON_STEPS);
    uint32_t high = (uint16_t)(int16_t)lround(y * OCTAHEDRON_STEPS);
    return low | high << 16;
}

/* The edges, as seen from P, of the facet that touches it with CORNER. */
typedef struct wedge {
    asdic_vec3 a, b;
} wedge;

static wedge wedge_at(const asdic_surface *s, asdic_vec3 p, uint32_t corner) {
    size_t facet = 3 * (size_t)(corner / 3);
    return (wedge){asdic_vec3_sub(asdic_surface_corner(s, facet + (corner + 1) % 3), p),
                   asdic_vec3_sub(asdic_surface_corner(s, facet + (corner + 2) % 3), p)};
}

/* Weight of a facet's normal at one of its corners, sin / (|a| |b|) of the edges a and b that meet
 * there: exact where the vertices lie on a sphere (N. Max, "Weights for computing vertex normals
 * from facet normals", J. Graphics Tools 4(2), 1999). */
static double corner_weight(wedge w) {
    double aa = asdic_vec3_dot(w.a, w.a), bb = asdic_vec3_dot(w.b, w.b);
    return aa * bb > 0.0 ? asdic_vec3_length(asdic_vec3_cross(w.a, w.b)) / (aa * bb) : 0.0;
}

static double corner_angle(wedge w) {
    return atan2(asdic_vec3_length(asdic_vec3_cross(w.a, w.b)), asdic_vec3_dot(w.a, w.b));
}

static asdic_vec3 sum_of_corners(const asdic_surface *s, uint32_t facet) {
    asdic_vec3 sum = asdic_surface_corner(s, 3 * (size_t)facet);
    sum = asdic_vec3_add(sum, asdic_surface_corner(s, 3 * (size_t)facet + 1));
    return asdic_vec3_add(sum, asdic_surface_corner(s, 3 * (size_t)facet + 2));
}

/* Whether what lies over an edge from FACET touches the facet that has CORNER, ahead of it on the WAY. */
static bool is_bevel(const asdic_surface *s, uint32_t facet, uint32_t corner, asdic_vec3 way) {
    asdic_vec3 own = asdic_surface_normal(s, facet), from = sum_of_corners(s, corner / 3);
    asdic_vec3 edge = asdic_vec3_cross(own, asdic_surface_normal(s, corner / 3));
    double aside = ASIDE * asdic_vec3_length(edge);
    for (uint32_t k = 1; k < 3; k++) {
        uint32_t at = s->vertex[3 * (size_t)(corner / 3) + (corner + k) % 3];
        uint32_t first = s->first[at], end = s->first[at + 1];
        for (uint32_t i = first; i < end && end - first <= ASDIC_MOST_CORNERS; i++) {
            uint32_t next = s->touching[i] / 3;
            asdic_vec3 normal = asdic_surface_normal(s, next);
            if (asdic_vec3_dot(own, normal) < ASDIC_CREASE_COSINE &&
                fabs(asdic_vec3_dot(edge, normal)) < aside &&
                asdic_vec3_dot(way, asdic_vec3_sub(sum_of_corners(s, next), from)) > 0.0) {
                return true;
            }
        }
    }
    return false;
}

/* How far FACET reaches along WAY, times the length of WAY. */
static double width_along(const asdic_surface *s, uint32_t facet, asdic_vec3 way) {
    double low = INFINITY, high = -INFINITY;
    for (size_t k = 0; k < 3; k++) {
        double at = asdic_vec3_dot(asdic_surface_corner(s, 3 * (size_t)facet + k), way);
        low = fmin(low, at);
        high = fmax(high, at);
    }
    return high - low;
}

/* Whether the much smaller facet that has CORNER begins the bevelled or rounded edge of the flat face
 * that FACET is, or is cut from. */
static bool begins_edge(const asdic_surface *s, uint32_t facet, uint32_t corner) {
    uint32_t other = corner / 3;
    const asdic_patch *face = &s->patches[s->patch[facet]];
    asdic_vec3 own = asdic_surface_normal(s, facet), normal = asdic_surface_normal(s, other);
    asdic_vec3 turn = asdic_vec3_sub(normal, asdic_vec3_scale(own, asdic_vec3_dot(own, normal)));
    asdic_vec3 way = asdic_vec3_sub(sum_of_corners(s, other), sum_of_corners(s, facet));
    if (asdic_patch_width(face, turn) > SOME_FACETS * width_along(s, facet, turn) ||
        (face->area_m2 > SOME_FACETS * asdic_surface_area(s, facet) &&
         is_bevel(s, facet, corner, way))) {
        return true;
    }
    asdic_bend there = asdic_bend_of(s, other, s->round + 3 * (size_t)other);
    asdic_bend here = asdic_bend_of(s, facet, s->round + 3 * (size_t)facet);
    return asdic_bend_along(&there, way) > BEND_RATIO * asdic_bend_along(&here, way);
}

/* Whether the surface that FACET stands for goes on in the facet that has CORNER, where both touch. */
static bool goes_on(const asdic_surface *s, uint32_t facet, uint32_t corner) {
    uint32_t other = corner / 3;
    if (s->patch[other] == s->patch[facet]) {
        return true;
    }
    double least_m2 = s->patches[s->patch[facet]].area_m2 / FACE_RATIO;
    return asdic_vec3_dot(asdic_surface_normal(s, facet), asdic_surface_normal(s, other)) >=
               ASDIC_CREASE_COSINE &&
           !(s->round && s->patches[s->patch[other]].area_m2 < least_m2 &&
             begins_edge(s, facet, corner));
}

/* Where the corners of one vertex begin and end in touching; none of a vertex that stays sharp. */
typedef struct ring {
    uint32_t first, end;
    bool whole; /* every facet goes on in every other: all have one normal there */
} ring;

/* Whether that is so at first sight. */
static bool is_smooth(const asdic_surface *s, ring r) {
    double least_m2 = INFINITY, most_m2 = 0.0;
    for (uint32_t i = r.first; i < r.end; i++) {
        uint32_t first = s->touching[r.first] / 3, facet = s->touching[i] / 3;
        double area_m2 = s->patches[s->patch[facet]].area_m2;
        least_m2 = area_m2 < least_m2 ? area_m2 : least_m2;
        most_m2 = area_m2 > most_m2 ? area_m2 : most_m2;
        if (asdic_vec3_dot(asdic_surface_normal(s, first), asdic_surface_normal(s, facet)) <
            HALF_CREASE_COSINE) {
            return false;
        }
    }
    return !s->round || most_m2 <= FACE_RATIO * least_m2;
}

static ring ring_of(const asdic_surface *s, uint32_t vertex) {
    ring r = {.first = s->first[vertex], .end = s->first[vertex + 1]};
    r.end = r.end - r.first > ASDIC_MOST_CORNERS ? r.first : r.end;
    r.whole = s->whole ? s->whole[vertex] : is_smooth(s, r);
    return r;
}

static bool is_whole(const asdic_surface *s, ring r) {
    for (uint32_t i = r.first; i < r.end; i++) {
        for (uint32_t j = r.first; j < r.end; j++) {
            if (!goes_on(s, s->touching[i] / 3, s->touching[j])) {
                return false;
            }
        }
    }
    return true;
}

/* Whether the facets' normals at CORNER, about N, differ one way alone, ACROSS, as those of a tube's strips do. */
static bool bends_one_way(const asdic_surface *s, ring r, uint32_t corner, asdic_vec3 n,
                          asdic_vec3 *across) {
    asdic_vec3 u, v;
    double uu = 0.0, uv = 0.0, vv = 0.0;
    asdic_surface_axes(n, &u, &v);
    for (uint32_t i = r.first; i < r.end; i++) {
        if (r.whole || goes_on(s, corner / 3, s->touching[i])) {
            asdic_vec3 normal = asdic_surface_normal(s, s->touching[i] / 3);
            double nu = asdic_vec3_dot(normal, u), nv = asdic_vec3_dot(normal, v);
            uu += nu * nu;
            uv += nu * nv;
            vv += nv * nv;
        }
    }
    *across = asdic_vec3_add(asdic_vec3_scale(u, uu > vv ? uu : uv),
                             asdic_vec3_scale(v, uu > vv ? uv : vv));
    return uu * vv - uv * uv <= ONE_WAY * (uu + vv) * (uu + vv);
}

/* The normal at CORNER, N before, of a surface that bends one way, ACROSS, there. Chords of a circle count by 1 / length,
 * which Max's weights are in a plane; the facets of one strip, however it is cut, share its part by their angles. */
static asdic_vec3 strip_normal(const asdic_surface *s, ring r, uint32_t corner, asdic_vec3 n,
                               asdic_vec3 across) {
    asdic_vec3 sum = {0.0, 0.0, 0.0}, p = asdic_surface_corner(s, corner);
    for (uint32_t i = r.first; i < r.end; i++) {
        uint32_t at = s->touching[i];
        asdic_vec3 normal = asdic_surface_normal(s, at / 3);
        double width = width_along(s, at / 3, across);
        if (width > 0.0 && (r.whole || goes_on(s, corner / 3, at))) {
            double weight = corner_angle(wedge_at(s, p, at)) * asdic_vec3_dot(normal, n) / width;
            sum = asdic_vec3_add(sum, asdic_vec3_scale(normal, weight));
        }
    }
    double length = asdic_vec3_length(sum);
    return length > 0.0 ? asdic_vec3_scale(sum, 1.0 / length) : n;
}

/* The mean of the normals that meet at CORNER; as BEFORE where no face may begin. */
static asdic_vec3 mean_normal(const asdic_surface *s, ring r, const asdic_vec3 *before,
                              uint32_t corner) {
    if (before && r.whole) {
        return before[corner];
    }
    asdic_vec3 sum = {0.0, 0.0, 0.0}, p = asdic_surface_corner(s, corner), across;
    for (uint32_t i = r.first; i < r.end; i++) {
        uint32_t at = s->touching[i];
        if (r.whole || goes_on(s, corner / 3, at)) {
            asdic_vec3 normal = asdic_surface_normal(s, at / 3);
            sum = asdic_vec3_add(sum, asdic_vec3_scale(normal, corner_weight(wedge_at(s, p, at))));
        }
    }
    double length = asdic_vec3_length(sum);
    if (!(length > 0.0)) {
        return asdic_surface_normal(s, corner / 3);
    }
    sum = asdic_vec3_scale(sum, 1.0 / length);
    return bends_one_way(s, r, corner, sum, &across) ? strip_normal(s, r, corner, sum, across)
                                                     : sum;
}

/* The normal at CORNER, nearer to one that makes the same angle with every edge there as the normal BEFORE at the edge's
 * other end: (n + n') e = 0 (where A. Vlachos et al., "Curved PN triangles", I3D 2001, bend no normal beyond the mean of
 * both). Chords of balls and of round cylinders do so, those of other surfaces to the third order of their length, where
 * the mean errs in the second if facets are uneven. Half the way is made, so that neighbours that move together settle;
 * none where that would be a long one. */
static asdic_vec3 turned_normal(const asdic_surface *s, ring r, const asdic_vec3 *before,
                                uint32_t corner) {
    asdic_vec3 n = before[corner], p = asdic_surface_corner(s, corner), u, v;
    asdic_surface_axes(n, &u, &v);
    double uu = 0.0, uv = 0.0, vv = 0.0, ru = 0.0, rv = 0.0, spread = 0.0, count = 0.0;
    for (uint32_t i = r.first; i < r.end; i++) {
        uint32_t at = s->touching[i], facet = 3 * (at / 3);
        if (!r.whole && !goes_on(s, corner / 3, at)) {
            continue;
        }
        spread += 2.0 - 2.0 * asdic_vec3_dot(n, asdic_surface_normal(s, at / 3));
        count++;
        for (uint32_t k = 1; k < 3; k++) {
            uint32_t far = facet + (at + k) % 3;
            asdic_vec3 e = asdic_vec3_sub(asdic_surface_corner(s, far), p);
            double eu = asdic_vec3_dot(e, u), ev = asdic_vec3_dot(e, v);
            double rest = asdic_vec3_dot(asdic_vec3_add(n, before[far]), e);
            uu += eu * eu;
            uv += eu * ev;
            vv += ev * ev;
            ru += eu * rest;
            rv += ev * rest;
        }
    }
    double hold = 0.5 * (uu + vv);
    double det = (uu + hold) * (vv + hold) - uv * uv;
    if (!(det > 0.0)) {
        return n;
    }
    double tu = ((vv + hold) * ru - uv * rv) / det, tv = ((uu + hold) * rv - uv * ru) / det;
    if ((tu * tu + tv * tv) * count > MOST_TURN * MOST_TURN * spread) {
        return n;
    }
    n = asdic_vec3_sub(n, asdic_vec3_add(asdic_vec3_scale(u, tu), asdic_vec3_scale(v, tv)));
    return asdic_vec3_scale(n, 1.0 / asdic_vec3_length(n));
}

static bool is_level(const asdic_patch *patch) {
    return asdic_vec3_dot(patch->normal, patch->normal) > 0.0;
}

typedef asdic_vec3 corner_rule(const asdic_surface *s, ring r, const asdic_vec3 *before,
                               uint32_t corner);

/* Normals of all corners, from those BEFORE. */
static void find_normals(const asdic_surface *s, corner_rule *rule, const asdic_vec3 *before,
                         asdic_vec3 *normals) {
    for (uint32_t vertex = 0; vertex < 3 * s->count; vertex++) {
        if (s->vertex[vertex] != vertex) {
            continue;
        }
        ring r = ring_of(s, vertex);
        for (uint32_t i = s->first[vertex]; i < s->first[vertex + 1]; i++) {
            uint32_t corner = s->touching[i];
            if (s->vertex[corner] != vertex) {
                continue; /* an open edge goes past */
            }
            const asdic_patch *patch = &s->patches[s->patch[corner / 3]];
            normals[corner] = is_level(patch)          ? patch->normal
                              : r.first == r.end       ? asdic_surface_normal(s, corner / 3)
                              : r.whole && i > r.first ? normals[s->touching[r.first]]
                                                       : rule(s, r, before, corner);
        }
    }
}

/* Whether another patch has a part in FACET's surface. */
static bool is_bent(const asdic_surface *s, uint32_t facet) {
    for (uint32_t k = 0; k < 3; k++) {
        uint32_t vertex = s->vertex[3 * (size_t)facet + k], first = s->first[vertex];
        uint32_t end = s->first[vertex + 1];
        for (uint32_t i = first; i < end && end - first <= ASDIC_MOST_CORNERS; i++) {
            if (s->patch[s->touching[i] / 3] != s->patch[facet] &&
                goes_on(s, facet, s->touching[i])) {
                return true;
            }
        }
    }
    return false;
}

/* TURNED: where the corners' normals go in double, three a facet; or NULL. */
static void smooth_facet(const asdic_surface *s, uint32_t facet, const asdic_vec3 normals[3],
                         asdic_vec3 *turned) {
    dev_triangle *t = &s->facets[facet];
    const asdic_patch *patch = &s->patches[s->patch[facet]];
    bool level = is_level(patch);
    t->flat_m2 = (float)patch->area_m2;
    if (!level && !is_bent(s, facet)) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        asdic_vec3 own = asdic_vec3_scale(normals[k], s->side[facet]); /* to the facet's side */
        t->corner_normals[k] = asdic_smooth_pack(own);
        if (turned) {
            turned[3 * (size_t)facet + k] = own;
        }
    }
    t->flat_m2 = (float)(level ? patch->area_m2 : patch->length2_m2);
}

/* Room for the normals of a part that moves; NULL for one that stays. */
static asdic_status reserve_normals(asdic_scene *scene, size_t part, asdic_movable **out) {
    *out = NULL;
    for (size_t i = 0; i < scene->movable_count && !*out; i++) {
        *out = scene->movables[i].part == part ? &scene->movables[i] : NULL;
    }
    if (!*out) {
        return ASDIC_OK;
    }
    free((*out)->normals); /* of a commit that failed */
    (*out)->normals = calloc(9 * (*out)->count + 1, sizeof(double));
    return (*out)->normals ? ASDIC_OK : asdic_fail_memory(scene->ctx, "a moving object's normals");
}

/* Turns normals from the world to the mesh's frame. */
static void turn_back(const asdic_movable *m, const asdic_vec3 *world) {
    asdic_mat3 turn = asdic_mat3_of(&m->anchor);
    for (size_t i = 0; i < 3 * m->count; i++) {
        asdic_vec3 n = asdic_mat3_apply_inverse(turn, world[i]);
        m->normals[3 * i] = n.x;
        m->normals[3 * i + 1] = n.y;
        m->normals[3 * i + 2] = n.z;
    }
}

/* Normals of all corners, in NORMALS; SPARE has room for as many. */
static void find_corner_normals(asdic_surface *s, asdic_vec3 *normals, asdic_vec3 *spare,
                                asdic_vec3 *round, bool *whole) {
    find_normals(s, mean_normal, NULL, round);
    s->round = round;
    for (uint32_t vertex = 0; vertex < 3 * s->count; vertex++) {
        ring r = ring_of(s, vertex);
        whole[vertex] = r.whole || is_whole(s, r);
    }
    s->whole = whole;
    find_normals(s, mean_normal, round, normals);
    find_normals(s, turned_normal, normals, spare);
    find_normals(s, turned_normal, spare, normals);
}

/* Smooths the facets of a part, whose SURFACE begins with triangle BEGIN. */
static asdic_status smooth_part(asdic_scene *scene, size_t begin, asdic_surface *surface) {
    asdic_movable *moving;
    size_t number = scene->triangles[begin].part;
    TRY(reserve_normals(scene, number, &moving));
    asdic_vec3 *turned = moving ? calloc(3 * moving->count, sizeof *turned) : NULL;
    if (moving && !turned) {
        return asdic_fail_memory(scene->ctx, "a moving object's normals");
    }
    asdic_status status =
        asdic_surface_find_patches(scene->ctx, 2.0 * scene->parts[number].radius_m, surface);
    size_t corners = 3 * (size_t)surface->count;
    asdic_vec3 *normals = malloc(3 * corners * sizeof *normals);
    bool *whole = malloc(corners * sizeof *whole);
    if (!status && (!normals || !whole)) {
        status = asdic_fail_memory(scene->ctx, "the corner normals of an object");
    }
    if (!status) {
        find_corner_normals(surface, normals, normals + corners, normals + 2 * corners, whole);
    }
    for (uint32_t facet = 0; !status && facet < surface->count; facet++) {
        smooth_facet(surface, facet, normals + 3 * (size_t)facet, turned);
    }
    status = status ? status : asdic_surface_find_straight(scene->ctx, surface, normals);
    free(normals);
    free(whole);
    if (moving && !status) {
        turn_back(moving, turned);
    }
    free(turned);
    return status;
}

/* Rims of an object, triangles BEGIN to END; what is CURVED is smoothed as well. */
static asdic_status finish_part(asdic_scene *scene, size_t begin, size_t end, bool curved) {
    asdic_surface surface;
    asdic_status status =
        asdic_surface_init(scene->ctx, scene->corners_m + 9 * begin, scene->triangles + begin,
                           (uint32_t)(end - begin), &surface);
    if (!status && curved) {
        status = smooth_part(scene, begin, &surface);
    }
    asdic_surface_finish(&surface);
    return status;
}

asdic_status asdic_scene_smooth(asdic_scene *scene) {
    for (size_t begin = scene->built, end; begin < scene->triangle_count; begin = end) {
        /* A part's triangles lie together, in the order in which they were added. */
        uint32_t number = scene->triangles[begin].part;
        for (end = begin; end < scene->triangle_count && scene->triangles[end].part == number;) {
            scene->triangles[end++].corner_normals[0] = DEV_FLAT;
        }
        const asdic_part *part = &scene->parts[number];
        bool curved = scene->materials[part->material].law->formula == DEV_LAW_FACET;
        if (curved || part->kind == DEV_KIND_OBJECT) {
            TRY(finish_part(scene, begin, end, curved));
        }
    }
    return ASDIC_OK;
}
