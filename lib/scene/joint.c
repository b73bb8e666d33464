#include "surface.h"

#include "point_tree.h"

#include "base/context.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>

typedef struct joint {
    uint32_t vertex, corner;
} joint;

static uint32_t next_corner(uint32_t corner) {
    return corner % 3 == 2 ? corner - 2 : corner + 1;
}

/* The ends of open edges, each once; how many. SEEN: false for every corner. */
static size_t list_ends(const asdic_surface *s, const uint32_t *open, size_t count, bool *seen,
                        asdic_point_place *out) {
    size_t kept = 0;
    for (size_t i = 0; i < 2 * count; i++) {
        uint32_t vertex = s->vertex[i % 2 ? next_corner(open[i / 2]) : open[i / 2]];
        if (!seen[vertex]) {
            out[kept++] = (asdic_point_place){asdic_surface_corner(s, vertex), vertex};
            seen[vertex] = true;
        }
    }
    return kept;
}

static bool has_vertex(const asdic_surface *s, uint32_t facet, uint32_t vertex) {
    const uint32_t *v = &s->vertex[3 * (size_t)facet];
    return v[0] == vertex || v[1] == vertex || v[2] == vertex;
}

/* An open edge, and how many joints are found on it. */
typedef struct open_edge {
    const asdic_surface *surface;
    asdic_point_search search;
    double length2;
    uint32_t corner;
    size_t found;
    joint *out; /* NULL: they are counted alone */
} open_edge;

static void try_end(void *caller, const asdic_point_place *end) {
    open_edge *e = caller;
    const asdic_point_search *q = &e->search;
    asdic_vec3 way = asdic_vec3_sub(end->at_m, q->from_m);
    double part = asdic_vec3_dot(way, q->way_m);
    if (!(part > 0.0 && part < e->length2)) {
        return;
    }
    double share = part / e->length2;
    asdic_vec3 aside = asdic_vec3_sub(way, asdic_vec3_scale(q->way_m, share));
    if (share < 1.0 && asdic_vec3_dot(aside, aside) <= q->reach_m * q->reach_m &&
        !has_vertex(e->surface, e->corner / 3, end->id)) {
        if (e->out) {
            e->out[e->found] = (joint){end->id, e->corner};
        }
        e->found++;
    }
}

/* Puts the vertices on the open edge that begins at CORNER into OUT, unless that is NULL; how many. */
static size_t join_edge(const asdic_surface *s, uint32_t corner, const asdic_point_place *ends,
                        size_t count, double tolerance, joint *out) {
    asdic_vec3 from = asdic_surface_corner(s, corner);
    asdic_vec3 way = asdic_vec3_sub(asdic_surface_corner(s, next_corner(corner)), from);
    open_edge edge = {
        .surface = s, .corner = corner, .length2 = asdic_vec3_dot(way, way), .out = out};
    edge.search = (asdic_point_search){from, way, tolerance * sqrt(edge.length2), try_end, &edge};
    asdic_point_tree_search(ends, count, &edge.search);
    return edge.found;
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
    asdic_point_place *ends = malloc(2 * count * sizeof *ends + 1);
    bool *seen = calloc(corners, sizeof *seen);
    size_t end_count = ends && seen ? list_ends(s, open, count, seen, ends) : 0;
    asdic_point_tree_plant(ends, end_count);
    for (size_t i = 0; i < count && end_count > 0; i++) {
        most += join_edge(s, open[i], ends, end_count, tolerance, NULL);
    }
    joint *joints = malloc(most * sizeof *joints + 1);
    uint32_t *touching = malloc((corners + 2 * most) * sizeof *touching);
    uint32_t *extra = calloc(corners, sizeof *extra);
    bool has_room = ends && seen && joints && touching && extra;
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
    free(seen);
    free(joints);
    free(touching);
    free(extra);
    return has_room ? ASDIC_OK : asdic_fail_memory(ctx, "the open edges of an object");
}
