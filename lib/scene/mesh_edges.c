/*
 * Open edges, by two hash tables: equal vertices to one number, then edges to a count of facets.
 */
#include "mesh_build.h"

#include "../base/bits.h"
#include "../base/context.h"

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

static uint64_t hash_vertex(const double v[3]) {
    uint64_t h = 0;
    for (int k = 0; k < 3; k++) {
        double x = v[k] == 0.0 ? 0.0 : v[k]; /* -0 equals 0 */
        h = mix(h ^ asdic_bits_of(x));
    }
    return h;
}

asdic_status asdic_weld_vertices(asdic_context *ctx, const double *vertices_m, size_t count,
                                 uint32_t *welded) {
    size_t slots = table_slots(count);
    uint32_t *table = malloc(slots * sizeof *table);
    if (!table) {
        return asdic_fail_memory(ctx, "the welding of a mesh's vertices");
    }
    memset(table, 0xff, slots * sizeof *table);
    for (size_t i = 0; i < count; i++) {
        const double *v = &vertices_m[3 * i];
        size_t slot = hash_vertex(v) & (slots - 1);
        while (table[slot] != UINT32_MAX) {
            const double *w = &vertices_m[3 * (size_t)table[slot]];
            if (v[0] == w[0] && v[1] == w[1] && v[2] == w[2]) {
                break;
            }
            slot = (slot + 1) & (slots - 1);
        }
        if (table[slot] == UINT32_MAX) {
            table[slot] = (uint32_t)i;
        }
        welded[i] = table[slot];
    }
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
    status = asdic_weld_vertices(ctx, mesh->vertices_m, mesh->vertex_count, welded);
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
