/*
 * What is at one place, by hash tables: vertices apart by roundings, facets that are there already, and
 * edges of one facet.
 */
#include "mesh_build.h"

#include "../base/bits.h"
#include "../base/context.h"
#include "../base/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static uint64_t mix(uint64_t h) {
    h ^= h >> 32;
    h *= 0xd6e8feb86659fd93u;
    h ^= h >> 32;
    h *= 0xd6e8feb86659fd93u;
    return h ^ h >> 32;
}

/* Power of two of at least twice COUNT slots, so that probing ends soon. */
static size_t table_slots(size_t count) {
    size_t slots = 16;
    while (slots < 2 * count) {
        slots *= 2;
    }
    return slots;
}

/* Twins farther apart than this share of the mesh's extent are two vertices. It is the last bit of
 * single precision's numbers within sixteen extents of the origin. */
#define TWIN_SHARE 0x1p-20
/* Corners of one facet become one only where roundings part them: neither reaches half the way to the other, ... */
#define EDGE_SHARE 0.25
/* ... unless the facet is a sliver, whose end is this share of its longest edge or less, between facets that are none,
 * as where a pole is a ring of vertices. Its ends become one where they are no larger share of the mesh. */
#define SLIVER_SHARE 0x1p-18
/* How far a vertex reaches is rounded down to one of these steps, each this share of the one before. All reach as far as
 * the last: what single precision does not tell from a point of the mesh. */
#define STEPS 3
#define STEP_SHARE 0.125

typedef struct weld {
    const double *vertices_m;
    uint32_t *table; /* of the first vertex of each place, by the cell it lies in */
    size_t slots;
    uint8_t *step; /* by vertex; NULL: all reach nowhere */
    bool *stout;   /* by vertex: a facet there is no sliver */
    double reach_m[STEPS];
} weld;

static double reach_of(const weld *w, uint32_t i) {
    return w->step ? w->reach_m[w->step[i]] : 0.0;
}

static double extent_of(const asdic_mesh *mesh) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        const double *v = &mesh->vertices_m[3 * (size_t)mesh->indices[i]];
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], v[k]);
            high[k] = fmax(high[k], v[k]);
        }
    }
    return fmax(0.0, fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2])));
}

/* Squares of FACET's edges; returns that of the longest one that is a sliver's end. */
static double measure_edges(const asdic_mesh *mesh, const uint32_t *facet, double squares_m2[3]) {
    for (int e = 0; e < 3; e++) {
        asdic_vec3 way = asdic_vec3_sub(asdic_mesh_vertex(mesh, facet[(e + 1) % 3]),
                                        asdic_mesh_vertex(mesh, facet[e]));
        squares_m2[e] = asdic_vec3_dot(way, way);
    }
    return SLIVER_SHARE * SLIVER_SHARE * fmax(squares_m2[0], fmax(squares_m2[1], squares_m2[2]));
}

static void find_stout(weld *w, const asdic_mesh *mesh) {
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *facet = &mesh->indices[3 * i];
        double squares_m2[3], end_m2 = measure_edges(mesh, facet, squares_m2);
        bool stout = fmin(squares_m2[0], fmin(squares_m2[1], squares_m2[2])) > end_m2;
        for (int k = 0; k < 3; k++) {
            w->stout[facet[k]] |= stout;
        }
    }
}

/* Length of the shortest edge of FACET that is no end of a sliver between others; INFINITY: none. */
static double shortest_edge(const weld *w, const asdic_mesh *mesh, const uint32_t *facet) {
    double squares_m2[3], shortest_m2 = INFINITY, end_m2 = measure_edges(mesh, facet, squares_m2);
    for (int e = 0; e < 3; e++) {
        if (squares_m2[e] > end_m2 || !w->stout[facet[e]] || !w->stout[facet[(e + 1) % 3]]) {
            shortest_m2 = fmin(shortest_m2, squares_m2[e]);
        }
    }
    return sqrt(shortest_m2);
}

/* How far each vertex reaches: as little as the facets that have it allow. */
static void find_steps(weld *w, const asdic_mesh *mesh, double extent_m) {
    find_stout(w, mesh);
    for (int s = 0; s < STEPS; s++) {
        w->reach_m[s] = s ? STEP_SHARE * w->reach_m[s - 1] : TWIN_SHARE * extent_m;
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *facet = &mesh->indices[3 * i];
        double most_m = EDGE_SHARE * shortest_edge(w, mesh, facet);
        uint8_t step = 0;
        while (step + 1 < STEPS && w->reach_m[step] > most_m) {
            step++;
        }
        for (int k = 0; k < 3; k++) {
            w->step[facet[k]] = step > w->step[facet[k]] ? step : w->step[facet[k]];
        }
    }
}

/* The slot of a vertex in CELL that is one with vertex I, or the free one that ends the search. */
static size_t slot_in(const weld *w, const double cell[3], uint32_t i) {
    const double *v = &w->vertices_m[3 * (size_t)i];
    uint64_t h = 0;
    for (int k = 0; k < 3; k++) {
        h = mix(h ^ asdic_bits_of(cell[k] + 0.0)); /* -0 equals 0 */
    }
    size_t slot = h & (w->slots - 1);
    for (; w->table[slot] != UINT32_MAX; slot = (slot + 1) & (w->slots - 1)) {
        const double *other = &w->vertices_m[3 * (size_t)w->table[slot]];
        double reach_m = fmin(reach_of(w, i), reach_of(w, w->table[slot]));
        if (fabs(v[0] - other[0]) <= reach_m && fabs(v[1] - other[1]) <= reach_m &&
            fabs(v[2] - other[2]) <= reach_m) {
            break;
        }
    }
    return slot;
}

/* A coordinate's cell among those of a reach, itself where nothing but itself is in reach of it. */
static double cell_of(double reach_m, double x) {
    return reach_m > 0.0 ? floor(x / (4.0 * reach_m)) : x;
}

/* The least vertex known in the cells of CELLS_M that is one with vertex I. Cells are wider than what is in
 * reach of it, which then lies in eight of them at most, mostly in one. */
static uint32_t twin_in(const weld *w, uint32_t i, double cells_m) {
    const double *v = &w->vertices_m[3 * (size_t)i];
    double reach_m = fmin(reach_of(w, i), cells_m), ends[2][3], cell[3];
    uint32_t least = UINT32_MAX;
    int split = 0; /* the axes along which it lies in two */
    for (int k = 0; k < 3; k++) {
        ends[0][k] = cell_of(cells_m, v[k] - reach_m);
        ends[1][k] = cell_of(cells_m, v[k] + reach_m);
        split |= (ends[0][k] != ends[1][k]) << k;
    }
    for (int corner = 0; corner <= split; corner++) {
        if (corner & ~split) {
            continue;
        }
        for (int k = 0; k < 3; k++) {
            cell[k] = ends[corner >> k & 1][k];
        }
        uint32_t found = w->table[slot_in(w, cell, i)];
        least = found < least ? found : least;
    }
    return least;
}

static uint32_t first_twin(const weld *w, uint32_t i, const bool *used) {
    uint32_t least = UINT32_MAX;
    for (int s = 0; s < STEPS; s++) {
        uint32_t found = used[s] ? twin_in(w, i, w->reach_m[s]) : UINT32_MAX;
        least = found < least ? found : least;
    }
    if (least == UINT32_MAX) {
        double cell[3];
        for (int k = 0; k < 3; k++) {
            cell[k] = cell_of(reach_of(w, i), w->vertices_m[3 * (size_t)i + k]);
        }
        w->table[slot_in(w, cell, i)] = least = i;
    }
    return least;
}

static asdic_status weld_all(asdic_context *ctx, weld *w, size_t count, uint32_t *welded) {
    bool used[STEPS] = {!w->step};
    for (size_t i = 0; w->step && i < count; i++) {
        used[w->step[i]] = true;
    }
    w->slots = table_slots(count);
    w->table = malloc(w->slots * sizeof *w->table);
    if (!w->table) {
        return asdic_fail_memory(ctx, "the welding of a mesh's vertices");
    }
    memset(w->table, 0xff, w->slots * sizeof *w->table);
    for (size_t i = 0; i < count; i++) {
        welded[i] = first_twin(w, (uint32_t)i, used);
    }
    free(w->table);
    return ASDIC_OK;
}

asdic_status asdic_weld_vertices(asdic_context *ctx, const double *vertices_m, size_t count,
                                 uint32_t *welded) {
    weld w = {.vertices_m = vertices_m};
    return weld_all(ctx, &w, count, welded);
}

static uint32_t root_of(uint32_t *welded, uint32_t i) {
    for (; welded[i] != i; i = welded[i]) {
        welded[i] = welded[welded[i]];
    }
    return i;
}

static bool are_within(const asdic_mesh *mesh, uint32_t a, uint32_t b, double most_m) {
    asdic_vec3 way = asdic_vec3_sub(asdic_mesh_vertex(mesh, b), asdic_mesh_vertex(mesh, a));
    return fmax(fabs(way.x), fmax(fabs(way.y), fabs(way.z))) <= most_m;
}

static bool may_collapse(const weld *w, uint32_t i) {
    return w->stout[i] && w->step[i] == 0;
}

/* The ends of slivers become one where they are within MOST_M along each axis, and no other facet has an edge as short.
 * WELDED tells where corners go already, ENDS where that goes. A row of ends may lead on and on: none goes farther
 * than MOST_M. */
static void collapse_slivers(const weld *w, const asdic_mesh *mesh, double most_m,
                             const uint32_t *welded, uint32_t *ends) {
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        ends[i] = i;
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *facet = &mesh->indices[3 * i];
        double squares_m2[3], end_m2 = measure_edges(mesh, facet, squares_m2);
        for (int e = 0; e < 3; e++) {
            uint32_t a = facet[e], b = facet[(e + 1) % 3];
            if (squares_m2[e] > end_m2 || !may_collapse(w, a) || !may_collapse(w, b)) {
                continue;
            }
            a = root_of(ends, welded[a]);
            b = root_of(ends, welded[b]);
            if (are_within(mesh, a, b, most_m)) {
                ends[a > b ? a : b] = a > b ? b : a;
            }
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) { /* those before it have settled */
        uint32_t root = ends[ends[i]];
        ends[i] = are_within(mesh, i, root, most_m) ? root : i;
    }
}

static void move_corners(asdic_mesh *mesh, const uint32_t *to) {
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        mesh->indices[i] = to[mesh->indices[i]];
    }
}

asdic_status asdic_mesh_weld(asdic_context *ctx, asdic_mesh *mesh) {
    size_t count = mesh->vertex_count;
    double extent_m = extent_of(mesh);
    weld w = {.vertices_m = mesh->vertices_m,
              .step = calloc(count + 1, sizeof *w.step),
              .stout = calloc(count + 1, sizeof *w.stout)};
    uint32_t *welded = malloc((count + 1) * sizeof *welded);
    uint32_t *ends = malloc((count + 1) * sizeof *ends);
    asdic_status status = ASDIC_OK;
    if (!w.step || !w.stout || !welded || !ends) {
        status = asdic_fail_memory(ctx, "the welding of a mesh's vertices");
        goto fail;
    }
    /* Facets may have corners of their own: how far these reach depends on all facets at their place. */
    status = asdic_weld_vertices(ctx, mesh->vertices_m, count, welded);
    if (status != ASDIC_OK) {
        goto fail;
    }
    move_corners(mesh, welded);
    find_steps(&w, mesh, extent_m);
    status = weld_all(ctx, &w, count, welded);
    if (status != ASDIC_OK) {
        goto fail;
    }
    collapse_slivers(&w, mesh, SLIVER_SHARE * extent_m, welded, ends);
    move_corners(mesh, welded);
    move_corners(mesh, ends);
fail:
    free(ends);
    free(welded);
    free(w.stout);
    free(w.step);
    return status;
}

/* Whether two facets have the same corners, in either turn. */
static bool is_copy(const uint32_t *a, const uint32_t *b) {
    for (int k = 0; k < 3; k++) {
        uint32_t next = b[(k + 1) % 3], last = b[(k + 2) % 3];
        if (a[0] == b[k] && ((a[1] == next && a[2] == last) || (a[1] == last && a[2] == next))) {
            return true;
        }
    }
    return false;
}

asdic_status asdic_mesh_drop_copies(asdic_context *ctx, asdic_mesh *mesh) {
    size_t slots = table_slots(mesh->triangle_count), kept = 0;
    uint32_t *table = malloc(slots * sizeof *table);
    if (!table) {
        return asdic_fail_memory(ctx, "the facets of a mesh");
    }
    memset(table, 0xff, slots * sizeof *table);
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *f = &mesh->indices[3 * i];
        size_t slot = mix(mix(f[0]) + mix(f[1]) + mix(f[2])) & (slots - 1);
        while (table[slot] != UINT32_MAX && !is_copy(f, &mesh->indices[3 * (size_t)table[slot]])) {
            slot = (slot + 1) & (slots - 1);
        }
        if (table[slot] == UINT32_MAX) {
            table[slot] = (uint32_t)kept;
            memmove(&mesh->indices[3 * kept++], f, 3 * sizeof *f);
        }
    }
    mesh->copies = mesh->triangle_count - kept;
    mesh->triangle_count = kept;
    free(table);
    return ASDIC_OK;
}

typedef struct edge_slot {
    uint32_t low, high, facets; /* facets 0: free */
} edge_slot;

static void count_edge(edge_slot *table, size_t slots, uint32_t a, uint32_t b) {
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    size_t slot = mix((uint64_t)low << 32 | high) & (slots - 1);
    while (table[slot].facets != 0 && (table[slot].low != low || table[slot].high != high)) {
        slot = (slot + 1) & (slots - 1);
    }
    table[slot].low = low;
    table[slot].high = high;
    table[slot].facets++;
}

asdic_status asdic_mesh_count_open_edges(asdic_context *ctx, asdic_mesh *mesh) {
    size_t slots = table_slots(3 * mesh->triangle_count);
    edge_slot *table = calloc(slots, sizeof *table);
    if (!table) {
        return asdic_fail_memory(ctx, "the edges of a mesh");
    }
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        count_edge(table, slots, mesh->indices[i], mesh->indices[i % 3 == 2 ? i - 2 : i + 1]);
    }
    for (size_t i = 0; i < slots; i++) {
        mesh->open_edges += table[i].facets == 1;
    }
    free(table);
    return ASDIC_OK;
}
