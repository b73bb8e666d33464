#include "patch.h"

#include "../base/context.h"
#include "../base/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What lies between edges and is no thicker than this share of its breadth is one face: it bends with a radius of 180
 * breadths at least. */
#define LEVEL 7e-4
/* No face's breadth, as a rectangle's that varies as much, is more than this by its part's extent: the root of 3. */
#define MOST_BREADTH 1.74
/* Neighbours' normals differ by this share of what any two facets' do, squared, at least, where what turns them is
 * rounding; by far less where it is a wave or a bump of several facets. */
#define UNLIKE 0.25
/* Facets that turn from one to the next, of which neighbours differ by a smaller share, are of no face where their normals
 * differ by more, r.m.s., than rounding turns them: patches are sought again that are narrower by NARROWER. */
#define ALIKE 0.5
/* Of so few any two are neighbours, or nearly: they turn where a facet beyond them, with no edge between, turns on by no more
 * than so many times as much, squared, as they do from one to the next. */
#define FEW 3
#define TURNS_ON 4.0
#define ROUNDED 3e-5
#define NARROWER 0.1
#define MOST_PARTED 2
#define NO_PATCH UINT32_MAX

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

double asdic_patch_reach(const asdic_surface *s, uint32_t patch, asdic_vec3 way) {
    asdic_vec3 n = asdic_patch_normal(s, patch);
    way = asdic_vec3_sub(way, asdic_vec3_scale(n, asdic_vec3_dot(way, n)));
    double length = asdic_vec3_length(way);
    return length > 0.0 ? asdic_patch_width(&s->patches[patch], way) / length : 0.0;
}

/* How the facets of a face lean: their normals' variance, that of the difference of two neighbours' by what it would be if
 * each leant by itself, and the least such difference, squared, of one and a facet beyond. */
typedef struct lean {
    double variance, unlike, beyond2;
} lean;

/* The facets of QUEUE about N; neighbours are those of the patch WITHIN, or, NO_PATCH, over all edges. */
static lean lean_of(const asdic_surface *s, const uint32_t *queue, size_t count, asdic_vec3 n,
                    uint32_t within) {
    double variance = 0.0, apart = 0.0, pairs = 0.0, beyond2 = INFINITY;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *v = &s->vertex[3 * (size_t)queue[i]];
        asdic_vec3 own = asdic_surface_normal(s, queue[i]), off = asdic_vec3_sub(own, n);
        variance += asdic_vec3_dot(off, off) / (double)count;
        for (int k = 0; k < 3; k++) {
            int way = 0;
            uint32_t other = asdic_surface_beyond(s, queue[i], v[k], v[(k + 1) % 3], &way);
            asdic_vec3 next = other == ASDIC_NO_FACET ? own : asdic_surface_normal(s, other);
            if (other == ASDIC_NO_FACET || asdic_vec3_dot(own, next) < s->crease_cosine) {
                continue;
            }
            asdic_vec3 turn = asdic_vec3_sub(next, own);
            double turn2 = asdic_vec3_dot(turn, turn);
            if (within != NO_PATCH && s->patch[other] != within) {
                beyond2 = fmin(beyond2, turn2);
            } else {
                apart += turn2;
                pairs++;
            }
        }
    }
    double alone = 2.0 * variance * pairs;
    return (lean){variance, alone > 0.0 ? apart / alone : 1.0, beyond2};
}

static bool same_plane(const asdic_surface *s, uint32_t seed, uint32_t facet, double most,
                       double size_m) {
    asdic_vec3 n = asdic_surface_normal(s, seed);
    asdic_vec3 d = asdic_vec3_sub(n, asdic_surface_normal(s, facet));
    asdic_vec3 p = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)facet),
                                  asdic_surface_corner(s, 3 * (size_t)seed));
    return asdic_vec3_dot(d, d) < most * most &&
           fabs(asdic_vec3_dot(n, p)) < ASDIC_SAME_PLANE * size_m;
}

/* What patches are found with: for each facet room in QUEUE, and how often its patch was too wide; the patch that has SEEN
 * each vertex. */
typedef struct growth {
    double size_m;
    uint32_t *queue, *seen;
    uint8_t *too_wide;
} growth;

/* The facets that SEED's plane reaches, into the queue; returns how many. */
static size_t gather(asdic_surface *s, uint32_t seed, uint32_t number, const growth *g) {
    double most = ASDIC_SAME_PLANE * pow(NARROWER, g->too_wide[seed]);
    size_t head = 0, tail = 0;
    g->queue[tail++] = seed;
    s->patch[seed] = number;
    while (head < tail) {
        uint32_t facet = g->queue[head++];
        for (int k = 0; k < 3; k++) {
            uint32_t vertex = s->vertex[3 * (size_t)facet + k];
            if (g->seen[vertex] == number) {
                continue;
            }
            g->seen[vertex] = number;
            for (uint32_t i = s->first[vertex]; i < s->first[vertex + 1]; i++) {
                uint32_t other = s->touching[i] / 3;
                if (s->patch[other] == NO_PATCH && same_plane(s, seed, other, most, g->size_m)) {
                    s->patch[other] = number;
                    g->queue[tail++] = other;
                }
            }
        }
    }
    return tail;
}

/* Whether the COUNT facets of the queue, of patch NUMBER, turn from one to the next, as slivers about a ball's pole do. */
static bool turns(const asdic_surface *s, uint32_t number, const growth *g, size_t count) {
    asdic_vec3 sum = {0.0, 0.0, 0.0};
    if (count < 2) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        sum = asdic_vec3_add(sum, asdic_surface_normal(s, g->queue[i]));
    }
    sum = asdic_vec3_scale(sum, 1.0 / (double)count);
    lean l = lean_of(s, g->queue, count, sum, number);
    return count > FEW ? l.variance > ROUNDED * ROUNDED && l.unlike < ALIKE
                       : l.beyond2 < TURNS_ON * l.unlike * 2.0 * l.variance;
}

/* The patch of SEED. One that turns is parted: its facets are looked at again, for narrower ones. */
static void grow_patch(asdic_surface *s, uint32_t seed, uint32_t number, const growth *g) {
    size_t count = gather(s, seed, number, g);
    while (g->too_wide[seed] < MOST_PARTED && turns(s, number, g, count)) {
        for (size_t i = 0; i < count; i++) {
            uint32_t facet = g->queue[i];
            s->patch[facet] = NO_PATCH;
            g->too_wide[facet] += g->too_wide[facet] < MOST_PARTED;
            for (int k = 0; k < 3; k++) {
                g->seen[s->vertex[3 * (size_t)facet + k]] = NO_PATCH;
            }
        }
        count = gather(s, seed, number, g);
    }
    moments m = moments_at(s, seed);
    for (size_t i = 0; i < count; i++) {
        moments_add(&m, s, g->queue[i]);
    }
    s->patches[number] = patch_of(&m);
    s->patches[number].facet = seed;
}

/* Whether the facets of QUEUE, of a part of SIZE_M, are of several patches and all lie in one plane; FACE then is theirs
 * together. */
static bool are_level(const asdic_surface *s, const uint32_t *queue, size_t count, double size_m,
                      asdic_patch *face) {
    asdic_vec3 sum = {0.0, 0.0, 0.0}, origin = asdic_surface_corner(s, 3 * (size_t)queue[0]);
    bool several = false;
    for (size_t i = 0; i < count; i++) {
        double area_m2 = asdic_surface_area(s, queue[i]);
        sum = asdic_vec3_add(sum, asdic_vec3_scale(asdic_surface_normal(s, queue[i]), area_m2));
        several |= s->patch[queue[i]] != s->patch[queue[0]];
    }
    double length = asdic_vec3_length(sum), low = 0.0, high = 0.0;
    if (!several || !(length > 0.0)) {
        return false;
    }
    asdic_vec3 n = asdic_vec3_scale(sum, 1.0 / length);
    for (size_t i = 0; i < 3 * count; i++) {
        asdic_vec3 p = asdic_surface_corner(s, 3 * (size_t)queue[i / 3] + i % 3);
        double above = asdic_vec3_dot(n, asdic_vec3_sub(p, origin));
        low = fmin(low, above);
        high = fmax(high, above);
        if (high - low > LEVEL * MOST_BREADTH * size_m) {
            return false;
        }
    }
    moments m = moments_at(s, queue[0]);
    for (size_t i = 0; i < count; i++) {
        moments_add(&m, s, queue[i]);
    }
    *face = patch_of(&m);
    face->normal = n;
    face->facet = queue[0];
    return high - low <= LEVEL * sqrt(face->breadth2_m2) &&
           lean_of(s, queue, count, n, NO_PATCH).unlike >= UNLIKE;
}

/* Makes what lies between edges and is nearly in a plane one patch. QUEUE has room for all facets; DONE has false for each,
 * SPENT for each vertex. */
static void level_faces(asdic_surface *s, double size_m, uint32_t *queue, bool *done, bool *spent) {
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
                uint32_t vertex = s->vertex[3 * (size_t)facet + k];
                asdic_corners around = asdic_surface_around(s, vertex);
                bool all = true;
                for (uint32_t i = 0; i < around.count && !spent[vertex]; i++) {
                    uint32_t other = around.at[i] / 3;
                    if (!done[other] &&
                        asdic_vec3_dot(own, asdic_surface_normal(s, other)) >= s->crease_cosine) {
                        done[other] = true;
                        queue[tail++] = other;
                    }
                    all &= done[other];
                }
                spent[vertex] |= all;
            }
        }
        asdic_patch face;
        if (tail > 1 && are_level(s, queue, tail, size_m, &face)) {
            s->patches[s->patch[seed]] = face;
            for (size_t i = 0; i < tail; i++) {
                s->patch[queue[i]] = s->patch[seed];
            }
        }
    }
}

asdic_status asdic_surface_find_patches(asdic_context *ctx, double size_m, asdic_surface *s) {
    size_t corners = 3 * (size_t)s->count;
    s->patch = malloc(s->count * sizeof *s->patch);
    s->patches = malloc(s->count * sizeof *s->patches);
    uint32_t *queue = malloc(s->count * sizeof *queue), *seen = malloc(corners * sizeof *seen);
    bool *done = calloc(4 * (size_t)s->count, sizeof *done);
    uint8_t *too_wide = calloc(s->count, sizeof *too_wide);
    const growth g = {size_m, queue, seen, too_wide};
    uint32_t number = 0;
    bool has_room = s->patch && s->patches && queue && seen && done && too_wide;
    if (has_room) {
        memset(s->patch, 0xff, s->count * sizeof *s->patch);
        memset(seen, 0xff, corners * sizeof *seen);
    }
    for (uint32_t facet = 0; has_room && facet < s->count; facet++) {
        if (s->patch[facet] == NO_PATCH) {
            grow_patch(s, facet, number++, &g);
        }
    }
    if (has_room) {
        level_faces(s, size_m, queue, done, done + s->count);
    }
    free(queue);
    free(seen);
    free(done);
    free(too_wide);
    return has_room ? ASDIC_OK : asdic_fail_memory(ctx, "the flat patches of an object");
}
