/*
 * Binary tree by binned surface-area heuristic (I. Wald, "On fast Construction of SAH-based
 * Bounding Volume Hierarchies", 2007): 16 bins per axis over the centroids, items sorted in place.
 * A leaf costs what it takes to test its blocks of four triangles, ceil(n / 4).
 *
 * A subtree over n items owns 2n - 1 entries of the node array, wherever it is built, so that
 * threads need no shared counter and the tree never depends on their number.
 */
#include "bvh.h"

#include "../base/context.h"

#include <math.h>
#include <pthread.h>
#include <string.h>

#define BINS 16
#define LEAF DEV_LEAF_TRIANGLES
/* Smaller subtrees are built by the thread that meets them. */
#define TASK_ITEMS 8192
#define MAX_TASKS 512
#define MAX_THREADS 64

typedef struct bounds {
    float lo[4], hi[4]; /* the fourth lane is idle */
} bounds;

/* One subtree to build: items [first, first + count), its box and the box of twice its centroids. */
typedef struct task {
    size_t first, count, node;
    unsigned depth;
    bounds box, centroids;
} task;

typedef struct split_plan {
    int axis; /* -1: halve */
    int bin;  /* last bin of the left side */
    float offset, scale;
    bounds left, right;
} split_plan;

typedef struct builder {
    asdic_bvh_item *items;
    asdic_bvh_node2 *nodes;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    task queue[MAX_TASKS];
    size_t queued, running;
} builder;

static const bounds NOTHING = {{INFINITY, INFINITY, INFINITY, INFINITY},
                               {-INFINITY, -INFINITY, -INFINITY, -INFINITY}};

static inline void grow(bounds *b, const float lo[4], const float hi[4]) {
    for (int k = 0; k < 4; k++) {
        b->lo[k] = lo[k] < b->lo[k] ? lo[k] : b->lo[k];
        b->hi[k] = hi[k] > b->hi[k] ? hi[k] : b->hi[k];
    }
}

static inline void item_corners(const asdic_bvh_item *item, float lo[4], float hi[4]) {
    for (int k = 0; k < 3; k++) {
        lo[k] = item->lo[k];
        hi[k] = item->hi[k];
    }
    lo[3] = hi[3] = 0.0f;
}

/* Twice the centroid: the sum of the corners, saved a multiplication. */
static inline void item_centroid(const float lo[4], const float hi[4], float centroid[4]) {
    for (int k = 0; k < 4; k++) {
        centroid[k] = lo[k] + hi[k];
    }
}

static float half_area(const bounds *b) {
    float x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
    return x * y + y * z + z * x;
}

static float leaf_cost(const bounds *b, size_t count) {
    return count ? half_area(b) * (float)((count + LEAF - 1) / LEAF) : 0.0f;
}

typedef struct bin_set {
    bounds box[3][BINS];
    uint32_t count[3][BINS];
} bin_set;

static void fill_bins(const asdic_bvh_item *items, size_t count, const float offset[4],
                      const float scale[4], bin_set *bins) {
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < BINS; i++) {
            bins->box[axis][i] = NOTHING;
            bins->count[axis][i] = 0;
        }
    }
    for (size_t i = 0; i < count; i++) {
        float lo[4], hi[4], centroid[4];
        item_corners(&items[i], lo, hi);
        item_centroid(lo, hi, centroid);
        for (int axis = 0; axis < 3; axis++) {
            int bin = (int)((centroid[axis] - offset[axis]) * scale[axis]);
            grow(&bins->box[axis][bin], lo, hi);
            bins->count[axis][bin]++;
        }
    }
}

/* The cheapest cut of one axis; ties go to the lower bin. Returns whether it beats *BEST. */
static bool sweep_axis(const bounds box[BINS], const uint32_t count[BINS], float *best,
                       split_plan *plan) {
    float cost_right[BINS];
    bounds right[BINS], b = NOTHING;
    uint32_t n = 0;
    for (int i = BINS - 1; i > 0; i--) {
        grow(&b, box[i].lo, box[i].hi);
        n += count[i];
        right[i] = b;
        cost_right[i] = n ? leaf_cost(&b, n) : INFINITY;
    }
    bool better = false;
    b = NOTHING;
    n = 0;
    for (int i = 0; i < BINS - 1; i++) {
        grow(&b, box[i].lo, box[i].hi);
        n += count[i];
        if (n == 0) {
            continue;
        }
        float cost = leaf_cost(&b, n) + cost_right[i + 1];
        if (cost < *best) {
            *best = cost;
            better = true;
            plan->bin = i;
            plan->left = b;
            plan->right = right[i + 1];
        }
    }
    return better;
}

static split_plan plan_split(const builder *b, const task *t) {
    split_plan plan = {.axis = -1};
    if (t->depth >= ASDIC_BVH_HEURISTIC_DEPTH) {
        return plan;
    }
    float scale[4] = {0};
    for (int k = 0; k < 3; k++) {
        float span = t->centroids.hi[k] - t->centroids.lo[k];
        /* Just under BINS, so that the largest centroid still falls into the last bin. */
        scale[k] = span > 1e-30f ? 0.9999f * BINS / span : 0.0f;
    }
    bin_set bins;
    fill_bins(b->items + t->first, t->count, t->centroids.lo, scale, &bins);
    float best = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        if (scale[axis] > 0.0f && sweep_axis(bins.box[axis], bins.count[axis], &best, &plan)) {
            plan.axis = axis;
            plan.offset = t->centroids.lo[axis];
            plan.scale = scale[axis];
        }
    }
    return plan;
}

/* Sorts the items by the plan; returns the size of the left side and the sides' centroid boxes. */
static size_t partition(asdic_bvh_item *items, size_t count, const split_plan *plan, bounds *left,
                        bounds *right) {
    *left = *right = NOTHING;
    size_t i = 0, end = count;
    while (i < end) {
        float lo[4], hi[4], centroid[4];
        item_corners(&items[i], lo, hi);
        item_centroid(lo, hi, centroid);
        if ((int)((centroid[plan->axis] - plan->offset) * plan->scale) <= plan->bin) {
            grow(left, centroid, centroid);
            i++;
        } else {
            grow(right, centroid, centroid);
            asdic_bvh_item held = items[--end];
            items[end] = items[i];
            items[i] = held;
        }
    }
    return i;
}

static void measure(const asdic_bvh_item *items, size_t count, bounds *box, bounds *centroids) {
    *box = *centroids = NOTHING;
    for (size_t i = 0; i < count; i++) {
        float lo[4], hi[4], centroid[4];
        item_corners(&items[i], lo, hi);
        item_centroid(lo, hi, centroid);
        grow(box, lo, hi);
        grow(centroids, centroid, centroid);
    }
}

/* Writes the node of T; returns false for a leaf, else the two halves of the work. */
static bool split_node(const builder *b, const task *t, task *left, task *right) {
    asdic_bvh_node2 *node = &b->nodes[t->node];
    memcpy(node->lo, t->box.lo, sizeof node->lo);
    memcpy(node->hi, t->box.hi, sizeof node->hi);
    if (t->count <= LEAF) {
        node->link = (uint32_t)t->first;
        node->count = (uint32_t)t->count;
        return false;
    }
    asdic_bvh_item *items = b->items + t->first;
    split_plan plan = plan_split(b, t);
    size_t cut;
    if (plan.axis >= 0) {
        cut = partition(items, t->count, &plan, &left->centroids, &right->centroids);
        left->box = plan.left;
        right->box = plan.right;
    } else { /* centroids that cannot be told apart, or too deep: halve, in whole blocks */
        cut = (t->count / 2 + LEAF - 1) / LEAF * LEAF;
        measure(items, cut, &left->box, &left->centroids);
        measure(items + cut, t->count - cut, &right->box, &right->centroids);
    }
    left->first = t->first;
    left->count = cut;
    left->node = t->node + 1;
    right->first = t->first + cut;
    right->count = t->count - cut;
    right->node = t->node + 2 * cut;
    left->depth = right->depth = t->depth + 1;
    node->link = (uint32_t)right->node;
    node->count = 0;
    return true;
}

/* Hands T to another thread; false when the queue is full. */
static bool offer(builder *b, const task *t) {
    pthread_mutex_lock(&b->lock);
    bool taken = b->queued < MAX_TASKS;
    if (taken) {
        b->queue[b->queued++] = *t;
        pthread_cond_signal(&b->changed);
    }
    pthread_mutex_unlock(&b->lock);
    return taken;
}

static void build_subtree(builder *b, const task *root) {
    task stack[ASDIC_BVH_HEURISTIC_DEPTH + 40];
    size_t top = 0;
    stack[top++] = *root;
    while (top > 0) {
        task t = stack[--top], left, right;
        if (!split_node(b, &t, &left, &right)) {
            continue;
        }
        if (right.count < TASK_ITEMS || !offer(b, &right)) {
            stack[top++] = right;
        }
        stack[top++] = left;
    }
}

static void *work(void *user) {
    builder *b = user;
    pthread_mutex_lock(&b->lock);
    for (;;) {
        while (b->queued == 0 && b->running > 0) {
            pthread_cond_wait(&b->changed, &b->lock);
        }
        if (b->queued == 0) {
            break;
        }
        task t = b->queue[--b->queued];
        b->running++;
        pthread_mutex_unlock(&b->lock);
        build_subtree(b, &t);
        pthread_mutex_lock(&b->lock);
        b->running--;
    }
    pthread_cond_broadcast(&b->changed);
    pthread_mutex_unlock(&b->lock);
    return NULL;
}

asdic_status asdic_bvh_split(asdic_context *ctx, asdic_bvh_item *items, size_t count,
                             unsigned threads, asdic_bvh_node2 *nodes) {
    builder b = {.items = items, .nodes = nodes, .queued = 1};
    if (pthread_mutex_init(&b.lock, NULL) != 0) {
        return asdic_fail_memory(ctx, "the hierarchy's lock");
    }
    if (pthread_cond_init(&b.changed, NULL) != 0) {
        pthread_mutex_destroy(&b.lock);
        return asdic_fail_memory(ctx, "the hierarchy's lock");
    }
    b.queue[0] = (task){.count = count};
    measure(items, count, &b.queue[0].box, &b.queue[0].centroids);
    pthread_t helpers[MAX_THREADS];
    unsigned started = 0;
    /* A thread that cannot be started is no loss: the others do its work. */
    while (started + 1 < threads && started < MAX_THREADS &&
           pthread_create(&helpers[started], NULL, work, &b) == 0) {
        started++;
    }
    work(&b);
    for (unsigned i = 0; i < started; i++) {
        pthread_join(helpers[i], NULL);
    }
    pthread_cond_destroy(&b.changed);
    pthread_mutex_destroy(&b.lock);
    return ASDIC_OK;
}
