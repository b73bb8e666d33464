#include "surface.h"

#include "crease.h"

#include "../base/context.h"
#include "../base/vec.h"

#include <stdlib.h>

/* Normals differ one way alone where the variance the other way is a smaller share. */
#define ONE_WAY 1e-6
/* Vertices off the surface, as marching cubes leave them, would turn a normal by a larger share of what those around
 * differ from it, r.m.s. */
#define MOST_TURN 0.35

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

/* Whether the facets' normals AROUND a corner, about N, differ one way alone, ACROSS, as those of a tube's strips do. */
static bool bends_one_way(const asdic_surface *s, asdic_corners around, asdic_vec3 n,
                          asdic_vec3 *across) {
    asdic_vec3 u, v;
    double uu = 0.0, uv = 0.0, vv = 0.0;
    asdic_surface_axes(n, &u, &v);
    for (uint32_t i = 0; i < around.count; i++) {
        asdic_vec3 normal = asdic_surface_normal(s, around.at[i] / 3);
        double nu = asdic_vec3_dot(normal, u), nv = asdic_vec3_dot(normal, v);
        uu += nu * nu;
        uv += nu * nv;
        vv += nv * nv;
    }
    *across = asdic_vec3_add(asdic_vec3_scale(u, uu > vv ? uu : uv),
                             asdic_vec3_scale(v, uu > vv ? uv : vv));
    return uu * vv - uv * uv <= ONE_WAY * (uu + vv) * (uu + vv);
}

/* The normal at P, N before, of a surface that bends one way, ACROSS, there. Chords of a circle count by 1 / length,
 * which Max's weights are in a plane; the facets of one strip, however it is cut, share its part by their angles. */
static asdic_vec3 strip_normal(const asdic_surface *s, asdic_corners around, asdic_vec3 p,
                               asdic_vec3 n, asdic_vec3 across) {
    asdic_vec3 sum = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < around.count; i++) {
        uint32_t at = around.at[i];
        asdic_vec3 normal = asdic_surface_normal(s, at / 3);
        double width = asdic_surface_width(s, at / 3, across);
        if (width > 0.0) {
            double weight = corner_angle(wedge_at(s, p, at)) * asdic_vec3_dot(normal, n) / width;
            sum = asdic_vec3_add(sum, asdic_vec3_scale(normal, weight));
        }
    }
    double length = asdic_vec3_length(sum);
    return length > 0.0 ? asdic_vec3_scale(sum, 1.0 / length) : n;
}

/* The mean of the normals AROUND CORNER. */
static asdic_vec3 mean_normal(const asdic_surface *s, asdic_corners around, uint32_t corner) {
    asdic_vec3 sum = {0.0, 0.0, 0.0}, p = asdic_surface_corner(s, corner), across;
    for (uint32_t i = 0; i < around.count; i++) {
        uint32_t at = around.at[i];
        asdic_vec3 normal = asdic_surface_normal(s, at / 3);
        sum = asdic_vec3_add(sum, asdic_vec3_scale(normal, corner_weight(wedge_at(s, p, at))));
    }
    double length = asdic_vec3_length(sum);
    if (!(length > 0.0)) {
        return asdic_surface_normal(s, corner / 3);
    }
    sum = asdic_vec3_scale(sum, 1.0 / length);
    return bends_one_way(s, around, sum, &across) ? strip_normal(s, around, p, sum, across) : sum;
}

/* The normal at CORNER, nearer to one that makes the same angle with every edge there as the normal BEFORE at the edge's
 * other end: (n + n') e = 0 (where A. Vlachos et al., "Curved PN triangles", I3D 2001, bend no normal beyond the mean of
 * both). Chords of balls and of round cylinders do so, those of other surfaces to the third order of their length, where
 * the mean errs in the second if facets are uneven. Half the way is made, so that neighbours that move together settle;
 * none where that would be a long one. */
static asdic_vec3 turned_normal(const asdic_surface *s, asdic_corners around,
                                const asdic_vec3 *before, uint32_t corner) {
    asdic_vec3 n = before[corner], p = asdic_surface_corner(s, corner), u, v;
    asdic_surface_axes(n, &u, &v);
    double uu = 0.0, uv = 0.0, vv = 0.0, ru = 0.0, rv = 0.0, spread = 0.0;
    for (uint32_t i = 0; i < around.count; i++) {
        uint32_t at = around.at[i], facet = 3 * (at / 3);
        spread += 2.0 - 2.0 * asdic_vec3_dot(n, asdic_surface_normal(s, at / 3));
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
    if ((tu * tu + tv * tv) * around.count > MOST_TURN * MOST_TURN * spread) {
        return n;
    }
    n = asdic_vec3_sub(n, asdic_vec3_add(asdic_vec3_scale(u, tu), asdic_vec3_scale(v, tv)));
    return asdic_vec3_scale(n, 1.0 / asdic_vec3_length(n));
}

/* Normals of all corners, from those BEFORE: TURNED, or the mean where a face begins. WHOLE: by vertex, whether all facets
 * have one there. */
static void find_normals(const asdic_surface *s, bool turned, const asdic_vec3 *before,
                         const bool *whole, asdic_vec3 *normals) {
    uint32_t room[ASDIC_MOST_CORNERS];
    for (uint32_t vertex = 0; vertex < 3 * s->count; vertex++) {
        if (s->vertex[vertex] != vertex) {
            continue;
        }
        asdic_corners all = asdic_surface_around(s, vertex);
        bool same = before && !turned && (whole[vertex] || asdic_crease_is_even(s, all));
        for (uint32_t i = s->first[vertex]; i < s->first[vertex + 1]; i++) {
            uint32_t corner = s->touching[i];
            if (s->vertex[corner] != vertex) {
                continue; /* an open edge goes past */
            }
            const asdic_patch *patch = &s->patches[s->patch[corner / 3]];
            if (asdic_patch_is_level(patch)) {
                normals[corner] = patch->normal;
            } else if (all.count == 0) {
                normals[corner] = asdic_surface_normal(s, corner / 3);
            } else if (whole[vertex] && i > s->first[vertex]) {
                normals[corner] = normals[all.at[0]];
            } else if (same) {
                normals[corner] = before[corner];
            } else {
                asdic_corners around =
                    whole[vertex] ? all : asdic_crease_within(s, all, corner / 3, room);
                normals[corner] = turned ? turned_normal(s, around, before, corner)
                                         : mean_normal(s, around, corner);
            }
        }
    }
}

asdic_status asdic_corner_normals_find(asdic_context *ctx, asdic_surface *s, asdic_vec3 *normals) {
    uint32_t corners = 3 * s->count;
    asdic_vec3 *round = malloc(corners * sizeof *round), *spare = malloc(corners * sizeof *spare);
    bool *whole = calloc(corners, sizeof *whole), has_room = round && spare && whole;
    for (uint32_t vertex = 0; has_room && vertex < corners; vertex++) {
        whole[vertex] = asdic_crease_is_smooth(s, asdic_surface_around(s, vertex));
    }
    if (has_room) {
        find_normals(s, false, NULL, whole, round);
    }
    s->round = round;
    for (uint32_t vertex = 0; has_room && vertex < corners; vertex++) {
        whole[vertex] = asdic_crease_is_whole(s, asdic_surface_around(s, vertex));
    }
    if (has_room) {
        find_normals(s, false, round, whole, normals);
        find_normals(s, true, normals, whole, spare);
        find_normals(s, true, spare, whole, normals);
    }
    free(spare);
    free(whole);
    return has_room ? ASDIC_OK : asdic_fail_memory(ctx, "the corner normals of an object");
}
