#include "surface.h"

#include "mesh_build.h"

#include "../base/context.h"
#include "../base/vec.h"

#include <stdlib.h>
#include <string.h>

/* Corners by the vertex they share. */
static void sort_corners(asdic_surface *s) {
    size_t corners = 3 * (size_t)s->count;
    for (size_t c = 0; c < corners; c++) {
        s->first[s->vertex[c] + 1]++;
    }
    for (size_t c = 0; c < corners; c++) {
        s->first[c + 1] += s->first[c];
    }
    /* Filling moves every beginning to its end, which is the next one's beginning. */
    for (size_t c = 0; c < corners; c++) {
        s->touching[s->first[s->vertex[c]]++] = (uint32_t)c;
    }
    memmove(s->first + 1, s->first, corners * sizeof *s->first);
    s->first[0] = 0;
}

/* 1 where FACET has the edge from A to B, -1 where it has that from B to A. */
static int edge_of(const asdic_surface *s, uint32_t facet, uint32_t a, uint32_t b) {
    const uint32_t *v = &s->vertex[3 * (size_t)facet];
    for (int k = 0; k < 3; k++) {
        uint32_t from = v[k], to = v[(k + 1) % 3];
        if ((from == a && to == b) || (from == b && to == a)) {
            return from == a ? 1 : -1;
        }
    }
    return 0;
}

uint32_t asdic_surface_beyond(const asdic_surface *s, uint32_t facet, uint32_t a, uint32_t b,
                              int *way) {
    uint32_t count_a = s->first[a + 1] - s->first[a], count_b = s->first[b + 1] - s->first[b];
    asdic_corners around = asdic_surface_around(s, count_a <= count_b ? a : b);
    uint32_t found = ASDIC_NO_FACET;
    for (uint32_t i = 0; i < around.count; i++) {
        uint32_t other = around.at[i] / 3;
        int has = other == facet ? 0 : edge_of(s, other, a, b);
        if (has != 0 && found != ASDIC_NO_FACET) {
            return ASDIC_NO_FACET;
        }
        *way = has != 0 ? has : *way;
        found = has != 0 ? other : found;
    }
    return found;
}

/* Marks which way the mesh bends at edge K of FACET, where OTHER goes on. */
static void mark_rim(asdic_surface *s, uint32_t facet, int k, uint32_t other) {
    const uint32_t *v = &s->vertex[3 * (size_t)facet], *w = &s->vertex[3 * (size_t)other];
    size_t apex = 0;
    while (apex < 2 && (w[apex] == v[k] || w[apex] == v[(k + 1) % 3])) {
        apex++;
    }
    const float *n = s->facets[facet].normal;
    asdic_vec3 way = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)other + apex),
                                    asdic_surface_corner(s, 3 * (size_t)facet + (size_t)k));
    double above = asdic_vec3_dot((asdic_vec3){n[0], n[1], n[2]}, way);
    if (fabs(above) > ASDIC_SAME_PLANE * asdic_vec3_length(way)) {
        s->facets[facet].rims |= 1u << (above < 0.0 ? k : 3 + k);
    }
}

/* Facets that are wound alike have their common edge in opposite directions. Files may hold a body's facets wound
 * either way; from the first of each piece on the others follow. QUEUE has room for all. Marks rims on the way, and
 * lists the corners at which edges begin that no facet lies beyond, in OPEN; how many. */
static size_t find_sides(asdic_surface *s, uint32_t *queue, uint32_t *open) {
    size_t open_count = 0;
    memset(s->side, 0, s->count);
    for (uint32_t seed = 0; seed < s->count; seed++) {
        size_t head = 0, tail = 0;
        if (s->side[seed] == 0) {
            s->side[seed] = 1;
            queue[tail++] = seed;
        }
        while (head < tail) {
            uint32_t facet = queue[head++];
            const uint32_t *v = &s->vertex[3 * (size_t)facet];
            for (int k = 0; k < 3; k++) {
                int way = 0;
                uint32_t other = asdic_surface_beyond(s, facet, v[k], v[(k + 1) % 3], &way);
                if (other == ASDIC_NO_FACET) {
                    open[open_count] = 3 * facet + (uint32_t)k;
                    open_count += way == 0;
                    continue;
                }
                mark_rim(s, facet, k, other);
                if (s->side[other] == 0) {
                    s->side[other] = (int8_t)(-way * s->side[facet]);
                    queue[tail++] = other;
                }
            }
        }
    }
    return open_count;
}

asdic_status asdic_surface_init(asdic_context *ctx, const double *corners_m, dev_triangle *facets,
                                uint32_t count, asdic_surface *out) {
    size_t corners = 3 * (size_t)count;
    *out = (asdic_surface){.corners_m = corners_m, .facets = facets, .count = count};
    out->vertex = malloc(corners * sizeof *out->vertex);
    out->first = calloc(corners + 2, sizeof *out->first);
    out->touching = malloc(corners * sizeof *out->touching);
    out->side = malloc(count * sizeof *out->side);
    uint32_t *queue = malloc(count * sizeof *queue), *open = malloc(corners * sizeof *open);
    asdic_status status = ASDIC_OK;
    if (!out->vertex || !out->first || !out->touching || !out->side || !queue || !open) {
        status = asdic_fail_memory(ctx, "the surface of an object");
        goto fail;
    }
    status = asdic_weld_vertices(ctx, corners_m, corners, out->vertex);
    if (status != ASDIC_OK) {
        goto fail;
    }
    sort_corners(out);
    size_t open_count = find_sides(out, queue, open);
    if (open_count > 0) {
        status = asdic_surface_join(ctx, out, open, open_count, ASDIC_SAME_PLANE);
    }
fail:
    free(queue);
    free(open);
    return status;
}

void asdic_surface_finish(asdic_surface *surface) {
    free(surface->vertex);
    free(surface->first);
    free(surface->touching);
    free(surface->side);
    free(surface->patch);
    free(surface->patches);
    free(surface->first_fold);
    free(surface->folds);
    free(surface->round);
}

void asdic_surface_axes(asdic_vec3 n, asdic_vec3 *u, asdic_vec3 *v) {
    *u = asdic_vec3_cross(n, fabs(n.x) < 0.6 ? (asdic_vec3){1, 0, 0} : (asdic_vec3){0, 1, 0});
    *u = asdic_vec3_scale(*u, 1.0 / asdic_vec3_length(*u));
    *v = asdic_vec3_cross(n, *u);
}

double asdic_surface_area(const asdic_surface *s, uint32_t facet) {
    asdic_vec3 p = asdic_surface_corner(s, 3 * (size_t)facet);
    asdic_vec3 a = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)facet + 1), p);
    asdic_vec3 b = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)facet + 2), p);
    return 0.5 * asdic_vec3_length(asdic_vec3_cross(a, b));
}

double asdic_surface_width(const asdic_surface *s, uint32_t facet, asdic_vec3 way) {
    double low = INFINITY, high = -INFINITY;
    for (size_t k = 0; k < 3; k++) {
        double at = asdic_vec3_dot(asdic_surface_corner(s, 3 * (size_t)facet + k), way);
        low = fmin(low, at);
        high = fmax(high, at);
    }
    return high - low;
}
