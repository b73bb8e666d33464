/*
 * The few nodes above the subtrees of a scene with moving parts.
 */
#include "bvh.h"
#include "moving.h"

#include <stdlib.h>

typedef struct group {
    size_t first, count;
} group;

static int compare_axis(const asdic_root *a, const asdic_root *b, int axis) {
    float x = a->lo[axis] + a->hi[axis], y = b->lo[axis] + b->hi[axis];
    /* Equal centres are ordered by word, so that the order does not depend on the sort. */
    return x < y ? -1 : x > y ? 1 : (a->word > b->word) - (a->word < b->word);
}

static int compare_x(const void *a, const void *b) {
    return compare_axis(a, b, 0);
}

static int compare_y(const void *a, const void *b) {
    return compare_axis(a, b, 1);
}

static int compare_z(const void *a, const void *b) {
    return compare_axis(a, b, 2);
}

/* The axis along which the centres lie furthest apart. */
static int longest_axis(const asdic_root *roots, size_t count) {
    int longest = 0;
    float most = -1.0f;
    for (int k = 0; k < 3; k++) {
        float lo = roots[0].lo[k] + roots[0].hi[k], hi = lo;
        for (size_t i = 1; i < count; i++) {
            float at = roots[i].lo[k] + roots[i].hi[k];
            lo = at < lo ? at : lo;
            hi = at > hi ? at : hi;
        }
        if (hi - lo > most) {
            most = hi - lo;
            longest = k;
        }
    }
    return longest;
}

static size_t largest(const group *groups, size_t count) {
    size_t most = 0;
    for (size_t i = 1; i < count; i++) {
        most = groups[i].count > groups[most].count ? i : most;
    }
    return most;
}

/* Halves the largest group until there are eight, or one root in each. */
static size_t split(asdic_root *roots, size_t count, group groups[DEV_BVH_WIDTH]) {
    static int (*const compare[3])(const void *, const void *) = {compare_x, compare_y, compare_z};
    size_t n = 1;
    groups[0] = (group){0, count};
    while (n < DEV_BVH_WIDTH) {
        group *g = &groups[largest(groups, n)];
        if (g->count == 1) {
            break;
        }
        asdic_root *from = roots + g->first;
        qsort(from, g->count, sizeof *from, compare[longest_axis(from, g->count)]);
        size_t half = g->count / 2;
        groups[n++] = (group){g->first + half, g->count - half};
        g->count = half;
    }
    return n;
}

static asdic_root whole(const asdic_root *roots, size_t count, uint32_t word) {
    asdic_root r = roots[0];
    for (size_t i = 1; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            r.lo[k] = roots[i].lo[k] < r.lo[k] ? roots[i].lo[k] : r.lo[k];
            r.hi[k] = roots[i].hi[k] > r.hi[k] ? roots[i].hi[k] : r.hi[k];
        }
    }
    r.word = word;
    return r;
}

/* Fills node AT, and from NODES[*USED] on what it needs below; returns its levels. */
static unsigned build(dev_node8 *nodes, size_t at, size_t *used, asdic_root *roots, size_t count) {
    group groups[DEV_BVH_WIDTH];
    size_t n = split(roots, count, groups);
    unsigned below = 0;
    for (size_t i = 0; i < DEV_BVH_WIDTH; i++) {
        if (i >= n) {
            asdic_node8_set_child(&nodes[at], (int)i, NULL, NULL, DEV_EMPTY);
            continue;
        }
        asdic_root *own = roots + groups[i].first;
        asdic_root child = own[0];
        if (groups[i].count > 1) {
            size_t node = (*used)++;
            unsigned levels = build(nodes, node, used, own, groups[i].count);
            below = levels > below ? levels : below;
            child = whole(own, groups[i].count, (uint32_t)node);
        }
        asdic_node8_set_child(&nodes[at], (int)i, child.lo, child.hi, child.word);
    }
    return below + 1;
}

size_t asdic_top_build(dev_node8 *nodes, asdic_root *roots, size_t count, unsigned *depth) {
    size_t used = 1;
    *depth = build(nodes, 0, &used, roots, count);
    return used;
}
