/*
 * Open edges, by two hash tables: vertices at one place to one number, then edges to a count of facets.
 */
#include "mesh_build.h"

#include "../base/bits.h"
#include "../base/context.h"

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
/* Corners of one facet never become one: neither reaches half the way to the other. */
#define EDGE_SHARE 0.25
/* Width of a cell, by what is in reach: few vertices are so near its sides that they are looked for in others. */
#define CELL 16.0

/* How far apart, along each axis, the vertices that are one may be. */
static double reach_of(const double *vertices_m, const uint32_t *indices, size_t triangles) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    double edge2 = INFINITY, extent = 0.0;
    for (size_t i = 0; i < 3 * triangles; i++) {
        const double *v = &vertices_m[3 * (indices ? indices[i] : i)];
        size_t next = i % 3 == 2 ? i - 2 : i + 1;
        const double *w = &vertices_m[3 * (indices ? indices[next] : next)];
        double square = 0.0;
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], v[k]);
            high[k] = fmax(high[k], v[k]);
            square += (w[k] - v[k]) * (w[k] - v[k]);
        }
        edge2 = fmin(edge2, square);
    }
    for (int k = 0; k < 3; k++) {
        extent = fmax(extent, high[k] - low[k]);
    }
    return fmin(TWIN_SHARE * extent, EDGE_SHARE * sqrt(edge2));
}

typedef struct weld {
    const double *vertices_m;
    uint32_t *table; /* of the first vertex of each place, by the cell it lies in */
    size_t slots;
    double reach_m, cell_m;
} weld;

/* The slot of a vertex within reach of V in CELL, or the free one that ends the search. */
static size_t slot_in(const weld *w, const double cell[3], const double *v) {
    uint64_t h = 0;
    for (int k = 0; k < 3; k++) {
        h = mix(h ^ asdic_bits_of(cell[k] + 0.0)); /* -0 equals 0 */
    }
    size_t slot = h & (w->slots - 1);
    for (; w->table[slot] != UINT32_MAX; slot = (slot + 1) & (w->slots - 1)) {
        const double *other = &w->vertices_m[3 * (size_t)w->table[slot]];
        if (fabs(v[0] - other[0]) <= w->reach_m && fabs(v[1] - other[1]) <= w->reach_m &&
            fabs(v[2] - other[2]) <= w->reach_m) {
            break;
        }
    }
    return slot;
}

/* A coordinate's, itself where nothing but itself is in reach of it. */
static double cell_of(const weld *w, double x) {
    return w->reach_m > 0.0 ? floor(x / w->cell_m) : x;
}

/* The first vertex that is one with vertex I. Cells are wider than what is in reach of it, which
 * then lies in eight cells at most, mostly in one. */
static uint32_t first_twin(const weld *w, uint32_t i) {
    const double *v = &w->vertices_m[3 * (size_t)i];
    double own[3], low[3], high[3], cell[3];
    for (int k = 0; k < 3; k++) {
        own[k] = cell_of(w, v[k]);
        low[k] = cell_of(w, v[k] - w->reach_m);
        high[k] = cell_of(w, v[k] + w->reach_m);
    }
    size_t home = slot_in(w, own, v);
    uint32_t least = w->table[home];
    for (int corner = 0; corner < 8; corner++) {
        bool again = false, is_home = true;
        for (int k = 0; k < 3; k++) {
            bool upper = corner >> k & 1;
            cell[k] = upper ? high[k] : low[k];
            again |= upper && high[k] == low[k];
            is_home &= cell[k] == own[k];
        }
        uint32_t found = again || is_home ? UINT32_MAX : w->table[slot_in(w, cell, v)];
        least = found < least ? found : least;
    }
    if (least == UINT32_MAX) {
        w->table[home] = least = i;
    }
    return least;
}

asdic_status asdic_weld_vertices(asdic_context *ctx, const double *vertices_m, size_t count,
                                 const uint32_t *indices, size_t triangles, uint32_t *welded) {
    weld w = {.vertices_m = vertices_m,
              .slots = table_slots(count),
              .reach_m = reach_of(vertices_m, indices, triangles)};
    w.cell_m = CELL * w.reach_m;
    w.table = malloc(w.slots * sizeof *w.table);
    if (!w.table) {
        return asdic_fail_memory(ctx, "the welding of a mesh's vertices");
    }
    memset(w.table, 0xff, w.slots * sizeof *w.table);
    for (size_t i = 0; i < count; i++) {
        welded[i] = first_twin(&w, (uint32_t)i);
    }
    free(w.table);
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

asdic_status asdic_mesh_count_open_edges(asdic_context *ctx, const asdic_mesh *mesh,
                                         size_t *count) {
    size_t slots = table_slots(3 * mesh->triangle_count);
    uint32_t *welded = malloc((mesh->vertex_count + 1) * sizeof *welded);
    edge_slot *table = calloc(slots, sizeof *table);
    asdic_status status = ASDIC_OK;
    *count = 0;
    if (!welded || !table) {
        status = asdic_fail_memory(ctx, "the edges of a mesh");
        goto fail;
    }
    status = asdic_weld_vertices(ctx, mesh->vertices_m, mesh->vertex_count, mesh->indices,
                                 mesh->triangle_count, welded);
    if (status != ASDIC_OK) {
        goto fail;
    }
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        const uint32_t *f = &mesh->indices[3 * i];
        count_edge(table, slots, welded[f[0]], welded[f[1]]);
        count_edge(table, slots, welded[f[1]], welded[f[2]]);
        count_edge(table, slots, welded[f[2]], welded[f[0]]);
    }
    for (size_t i = 0; i < slots; i++) {
        *count += table[i].facets == 1;
    }
fail:
    free(table);
    free(welded);
    return status;
}
