#include "joint.h"

#include "base/context.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>

/* A vertex by its place along a line askew to all axes, so that few share one with an edge. */
typedef struct placed {
    double place;
    uint32_t vertex;
} placed;

typedef struct joint {
    uint32_t vertex, corner;
} joint;

static double place_of(asdic_vec3 p) {
    return 0.742 * p.x + 0.557 * p.y + 0.374 * p.z;
}

static int by_place(const void *a, const void *b) {
    const placed *x = a, *y = b;
    return x->place != y->place ? (x->place > y->place) - (x->place < y->place)
                                : (x->vertex > y->vertex) - (x->vertex < y->vertex);
}

static uint32_t next_corner(uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/* The ends of open edges, each once, by place; how many. */
static size_t place_ends(const asdic_surface *s, const uint32_t *open, size_t count, placed *out) {
    size_t kept = 0;
    for (size_t i = 0; i < 2 * count; i++) {
        uint32_t vertex = s->vertex[i % 2 ? next_corner(open[i / 2]) : open[i / 2]];
        out[i] = (placed){place_of(asdic_surface_corner(s, vertex)), vertex};
    }
    qsort(out, 2 * count, sizeof *out, by_place);
    for (size_t i = 0; i < 2 * count; i++) {
        if (kept == 0 || out[kept - 1].vertex != out[i].vertex) {
            out[kept++] = out[i];
        }
    }
    return kept;
}

/* The first of COUNT that lies at PLACE or beyond. */
static size_t first_at(const placed *ends, size_t count, double place) {
    size_t low = 0;
    while (low < count) {
        size_t middle = low + (count - low) / 2;
        if (ends[middle].place < place) {
            low = middle + 1;
        } else {
            count = middle;
        }
    }
    return low;
}

static bool has_vertex(const asdic_surface *s, uint32_t facet, uint32_t vertex) {
    const uint32_t *v = &s->vertex[3 * (size_t)facet];
    return v[0] == vertex || v[1] == vertex || v[2] == vertex;
}

/* Puts the vertices on the open edge that begins at CORNER into OUT, unless that is NULL; how many. */
static size_t join_edge(const asdic_surface *s, uint32_t corner, const placed *ends, size_t count,
                        double tolerance, joint *out) {
    asdic_vec3 from = asdic_surface_corner(s, corner);
    asdic_vec3 edge = asdic_vec3_sub(asdic_surface_corner(s, next_corner(corner)), from);
    double length2 = asdic_vec3_dot(edge, edge), off_m = tolerance * sqrt(length2);
    double low = place_of(from) + fmin(place_of(edge), 0.0) - off_m;
    double high = place_of(from) + fmax(place_of(edge), 0.0) + off_m;
    size_t found = 0;
    for (size_t i = first_at(ends, count, low); i < count && ends[i].place <= high; i++) {
        uint32_t vertex = ends[i].vertex;
        asdic_vec3 way = asdic_vec3_sub(asdic_surface_corner(s, vertex), from);
        double along = asdic_vec3_dot(way, edge) / length2;
        asdic_vec3 aside = asdic_vec3_sub(way, asdic_vec3_scale(edge, along));
        if (along > 0.0 && along < 1.0 && asdic_vec3_dot(aside, aside) <= off_m * off_m &&
            !has_vertex(s, corner / 3, vertex)) {
            if (out) {
                out[found] = (joint){vertex, corner};
            }
            found++;
        }
    }
    return found;
}

/* Puts the corners of COUNT joints behind each vertex' own, into TOUCHING. EXTRA: a zero for every corner. */
static void insert(asdic_surface *s, const joint *found, size_t count, uint32_t *touching,
                   uint32_t *extra) {
    for (size_t i = 0; i < count; i++) {
        extra[found[i].vertex] += 2;
    }
    uint32_t at = 0, corners = 3 * s->count;
    for (uint32_t vertex = 0; vertex < corners; vertex++) {
        uint32_t begin = s->first[vertex], own = s->first[vertex + 1] - begin, more = extra[vertex];
        memcpy(touching + at, s->touching + begin, own * sizeof *touching);
        s->first[vertex] = at;
        extra[vertex] = at + own;
        at += own + more;
    }
    s->first[corners] = at;
    for (size_t i = 0; i < count; i++) {
        touching[extra[found[i].vertex]++] = found[i].corner;
        touching[extra[found[i].vertex]++] = next_corner(found[i].corner);
    }
}

asdic_status asdic_surface_join(asdic_context *ctx, asdic_surface *s, const uint32_t *open,
                                size_t count, double tolerance) {
    size_t corners = 3 * (size_t)s->count, most = 0, found = 0;
    placed *ends = malloc(2 * count * sizeof *ends + 1);
    size_t end_count = ends ? place_ends(s, open, count, ends) : 0;
    for (size_t i = 0; i < count && ends; i++) {
        most += join_edge(s, open[i], ends, end_count, tolerance, NULL);
    }
    joint *joints = malloc(most * sizeof *joints + 1);
    uint32_t *touching = malloc((corners + 2 * most) * sizeof *touching);
    uint32_t *extra = calloc(corners, sizeof *extra);
    bool has_room = ends && joints && touching && extra;
    for (size_t i = 0; i < count && has_room && most > 0; i++) {
        found += join_edge(s, open[i], ends, end_count, tolerance, joints + found);
    }
    if (found > 0) {
        insert(s, joints, found, touching, extra);
        uint32_t *before = s->touching;
        s->touching = touching;
        touching = before;
    }
    free(ends);
    free(joints);
    free(touching);
    free(extra);
    return has_room ? ASDIC_OK : asdic_fail_memory(ctx, "the open edges of an object");
}
