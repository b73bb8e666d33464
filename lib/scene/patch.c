#include "patch.h"

#include "joint.h"
#include "mesh_build.h"

#include "../base/context.h"
#include "../base/vec.h"

#include <stdlib.h>
#include <string.h>

/* Facets are coplanar when their normals agree to this, and their planes to this much of the
 * part's extent. */
#define SAME_PLANE 1e-3
/* What lies between edges and is no thicker than this share of its breadth is one face: it bends with a radius of 180
 * breadths at least. */
#define LEVEL 7e-4
/* Neighbours' normals differ by this share of what any two facets' do, squared, at least, where what turns them is
 * rounding; by far less where it is a wave or a bump of several facets. */
#define UNLIKE 0.25
#define NO_PATCH UINT32_MAX
#define NO_FACET UINT32_MAX

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

static uint32_t touching_count(const asdic_surface *s, uint32_t vertex) {
    return s->first[vertex + 1] - s->first[vertex];
}

/* The facet beyond the edge from A to B of FACET, and which WAY it has that edge; none where several have it. WAY, 0
 * before, stays so where none has it. */
static uint32_t facet_beyond(const asdic_surface *s, uint32_t facet, uint32_t a, uint32_t b,
                             int *way) {
    uint32_t at = touching_count(s, a) <= touching_count(s, b) ? a : b, found = NO_FACET;
    if (touching_count(s, at) > ASDIC_MOST_CORNERS) {
        return NO_FACET;
    }
    for (uint32_t i = s->first[at]; i < s->first[at + 1]; i++) {
        uint32_t other = s->touching[i] / 3;
        int has = other == facet ? 0 : edge_of(s, other, a, b);
        if (has != 0 && found != NO_FACET) {
            return NO_FACET;
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
    if (fabs(above) > SAME_PLANE * asdic_vec3_length(way)) {
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
                uint32_t other = facet_beyond(s, facet, v[k], v[(k + 1) % 3], &way);
                if (other == NO_FACET) {
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

void asdic_surface_axes(asdic_vec3 n, asdic_vec3 *u, asdic_vec3 *v) {
    *u = asdic_vec3_cross(n, fabs(n.x) < 0.6 ? (asdic_vec3){1, 0, 0} : (asdic_vec3){0, 1, 0});
    *u = asdic_vec3_scale(*u, 1.0 / asdic_vec3_length(*u));
    *v = asdic_vec3_cross(n, *u);
}

/* Second moments of a patch's area in its plane. */
typedef struct moments {
    asdic_vec3 origin, u, v;
    double area, x, y, xx, yy, xy;
} moments;

static moments moments_at(const asdic_surface *s, uint32_t facet) {
    moments m = {.origin = asdic_surface_corner(s, 3 * (size_t)facet)};
    asdic_surface_axes(asdic_surface_normal(s, facet), &m.u, &m.v);
    return m;
}

static void moments_add(moments *m, const asdic_surface *s, uint32_t facet) {
    double x[3], y[3];
    for (int k = 0; k < 3; k++) {
        asdic_vec3 p = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)facet + k), m->origin);
        x[k] = asdic_vec3_dot(p, m->u);
        y[k] = asdic_vec3_dot(p, m->v);
    }
    double area = 0.5 * fabs((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]));
    double sx = x[0] + x[1] + x[2], sy = y[0] + y[1] + y[2];
    double xx = x[0] * x[0] + x[1] * x[1] + x[2] * x[2];
    double yy = y[0] * y[0] + y[1] * y[1] + y[2] * y[2];
    double xy = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    m->area += area;
    m->x += area * sx / 3.0;
    m->y += area * sy / 3.0;
    m->xx += area * (xx + sx * sx) / 12.0;
    m->yy += area * (yy + sy * sy) / 12.0;
    m->xy += area * (xy + sx * sy) / 12.0;
}

/* A rectangle's variance along a side of length L is L^2 / 12. */
static asdic_patch patch_of(const moments *m) {
    if (!(m->area > 0.0)) {
        return (asdic_patch){0};
    }
    double x = m->x / m->area, y = m->y / m->area;
    double xx = m->xx / m->area - x * x, yy = m->yy / m->area - y * y, xy = m->xy / m->area - x * y;
    double half = 0.5 * (xx - yy), root = hypot(half, xy), turn = 0.5 * atan2(xy, half);
    asdic_vec3 along =
        asdic_vec3_add(asdic_vec3_scale(m->u, cos(turn)), asdic_vec3_scale(m->v, sin(turn)));
    return (asdic_patch){.area_m2 = m->area,
                         .length2_m2 = 12.0 * (0.5 * (xx + yy) + root),
                         .breadth2_m2 = 12.0 * fmax(0.5 * (xx + yy) - root, 0.0),
                         .along = along};
}

double asdic_patch_width(const asdic_patch *p, asdic_vec3 way) {
    double along = asdic_vec3_dot(p->along, way);
    double across2 = fmax(asdic_vec3_dot(way, way) - along * along, 0.0);
    return sqrt(p->length2_m2 * along * along + p->breadth2_m2 * across2);
}

static bool same_plane(const asdic_surface *s, uint32_t seed, uint32_t facet, double size_m) {
    asdic_vec3 n = asdic_surface_normal(s, seed);
    asdic_vec3 d = asdic_vec3_sub(n, asdic_surface_normal(s, facet));
    asdic_vec3 p = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)facet),
                                  asdic_surface_corner(s, 3 * (size_t)seed));
    return asdic_vec3_dot(d, d) < SAME_PLANE * SAME_PLANE &&
           fabs(asdic_vec3_dot(n, p)) < SAME_PLANE * size_m;
}

/* All facets that SEED's plane reaches. QUEUE has room for all, SEEN for a patch per vertex. */
static void grow_patch(asdic_surface *s, uint32_t seed, uint32_t number, double size_m,
                       uint32_t *queue, uint32_t *seen) {
    moments m = moments_at(s, seed);
    size_t head = 0, tail = 0;
    queue[tail++] = seed;
    s->patch[seed] = number;
    while (head < tail) {
        uint32_t facet = queue[head++];
        moments_add(&m, s, facet);
        for (int k = 0; k < 3; k++) {
            uint32_t vertex = s->vertex[3 * (size_t)facet + k];
            if (seen[vertex] == number) {
                continue;
            }
            seen[vertex] = number;
            for (uint32_t i = s->first[vertex]; i < s->first[vertex + 1]; i++) {
                uint32_t other = s->touching[i] / 3;
                if (s->patch[other] == NO_PATCH && same_plane(s, seed, other, size_m)) {
                    s->patch[other] = number;
                    queue[tail++] = other;
                }
            }
        }
    }
    s->patches[number] = patch_of(&m);
}

/* Whether the facets of QUEUE lean from N each by itself. */
static bool leans_at_random(const asdic_surface *s, const uint32_t *queue, size_t count,
                            asdic_vec3 n) {
    double variance = 0.0, apart = 0.0, pairs = 0.0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *v = &s->vertex[3 * (size_t)queue[i]];
        asdic_vec3 own = asdic_surface_normal(s, queue[i]), off = asdic_vec3_sub(own, n);
        variance += asdic_vec3_dot(off, off) / (double)count;
        for (int k = 0; k < 3; k++) {
            int way = 0;
            uint32_t other = facet_beyond(s, queue[i], v[k], v[(k + 1) % 3], &way);
            asdic_vec3 next = other == NO_FACET ? own : asdic_surface_normal(s, other);
            if (other != NO_FACET && asdic_vec3_dot(own, next) >= ASDIC_CREASE_COSINE) {
                asdic_vec3 turn = asdic_vec3_sub(next, own);
                apart += asdic_vec3_dot(turn, turn);
                pairs++;
            }
        }
    }
    return apart >= UNLIKE * 2.0 * variance * pairs;
}

/* Whether the facets of QUEUE are of several patches and all lie in one plane; FACE then is theirs together. */
static bool is_level(const asdic_surface *s, const uint32_t *queue, size_t count,
                     asdic_patch *face) {
    asdic_vec3 sum = {0.0, 0.0, 0.0};
    bool several = false;
    moments m = moments_at(s, queue[0]);
    for (size_t i = 0; i < count; i++) {
        double area_m2 = asdic_surface_area(s, queue[i]);
        sum = asdic_vec3_add(sum, asdic_vec3_scale(asdic_surface_normal(s, queue[i]), area_m2));
        several |= s->patch[queue[i]] != s->patch[queue[0]];
        moments_add(&m, s, queue[i]);
    }
    double length = asdic_vec3_length(sum);
    if (!several || !(length > 0.0)) {
        return false;
    }
    *face = patch_of(&m);
    face->normal = asdic_vec3_scale(sum, 1.0 / length);
    double low = 0.0, high = 0.0;
    for (size_t i = 0; i < count; i++) {
        for (size_t k = 0; k < 3; k++) {
            asdic_vec3 p = asdic_surface_corner(s, 3 * (size_t)queue[i] + k);
            double above = asdic_vec3_dot(face->normal, asdic_vec3_sub(p, m.origin));
            low = fmin(low, above);
            high = fmax(high, above);
        }
    }
    return high - low <= LEVEL * sqrt(face->breadth2_m2) &&
           leans_at_random(s, queue, count, face->normal);
}

/* Makes what lies between edges and is nearly in a plane one patch. QUEUE has room for all facets; DONE has false for each,
 * SPENT for each vertex. */
static void level_faces(asdic_surface *s, uint32_t *queue, bool *done, bool *spent) {
    for (uint32_t seed = 0; seed < s->count; seed++) {
        size_t head = 0, tail = 0;
        if (!done[seed]) {
            done[seed] = true;
            queue[tail++] = seed;
        }
        while (head < tail) {
            uint32_t facet = queue[head++];
            asdic_vec3 own = asdic_surface_normal(s, facet);
            for (int k = 0; k < 3; k++) {
                uint32_t vertex = s->vertex[3 * (size_t)facet + k], first = s->first[vertex];
                uint32_t end = s->first[vertex + 1];
                bool all = true;
                for (uint32_t i = first;
                     i < end && !spent[vertex] && end - first <= ASDIC_MOST_CORNERS; i++) {
                    uint32_t other = s->touching[i] / 3;
                    if (!done[other] && asdic_vec3_dot(own, asdic_surface_normal(s, other)) >=
                                            ASDIC_CREASE_COSINE) {
                        done[other] = true;
                        queue[tail++] = other;
                    }
                    all &= done[other];
                }
                spent[vertex] |= all;
            }
        }
        asdic_patch face;
        if (tail > 1 && is_level(s, queue, tail, &face)) {
            s->patches[s->patch[seed]] = face;
            for (size_t i = 0; i < tail; i++) {
                s->patch[queue[i]] = s->patch[seed];
            }
        }
    }
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
    status = asdic_weld_vertices(ctx, corners_m, corners, NULL, count, out->vertex);
    if (status != ASDIC_OK) {
        goto fail;
    }
    sort_corners(out);
    size_t open_count = find_sides(out, queue, open);
    if (open_count > 0) {
        status = asdic_surface_join(ctx, out, open, open_count, SAME_PLANE);
    }
fail:
    free(queue);
    free(open);
    return status;
}

asdic_status asdic_surface_find_patches(asdic_context *ctx, double size_m, asdic_surface *s) {
    size_t corners = 3 * (size_t)s->count;
    s->patch = malloc(s->count * sizeof *s->patch);
    s->patches = malloc(s->count * sizeof *s->patches);
    uint32_t *queue = malloc(s->count * sizeof *queue), *seen = malloc(corners * sizeof *seen);
    bool *done = calloc(4 * (size_t)s->count, sizeof *done);
    uint32_t number = 0;
    bool has_room = s->patch && s->patches && queue && seen && done;
    if (has_room) {
        memset(s->patch, 0xff, s->count * sizeof *s->patch);
        memset(seen, 0xff, corners * sizeof *seen);
    }
    for (uint32_t facet = 0; has_room && facet < s->count; facet++) {
        if (s->patch[facet] == NO_PATCH) {
            grow_patch(s, facet, number++, size_m, queue, seen);
        }
    }
    if (has_room) {
        level_faces(s, queue, done, done + s->count);
    }
    free(queue);
    free(seen);
    free(done);
    return has_room ? ASDIC_OK : asdic_fail_memory(ctx, "the flat patches of an object");
}

double asdic_surface_area(const asdic_surface *s, uint32_t facet) {
    asdic_vec3 p = asdic_surface_corner(s, 3 * (size_t)facet);
    asdic_vec3 a = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)facet + 1), p);
    asdic_vec3 b = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)facet + 2), p);
    return 0.5 * asdic_vec3_length(asdic_vec3_cross(a, b));
}

void asdic_surface_finish(asdic_surface *surface) {
    free(surface->vertex);
    free(surface->first);
    free(surface->touching);
    free(surface->side);
    free(surface->patch);
    free(surface->patches);
}
