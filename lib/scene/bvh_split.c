/*
 * One split by the binned surface-area heuristic (I. Wald, "On fast Construction of SAH-based
 * Bounding Volume Hierarchies", 2007): up to 16 bins per axis over the centroids, items sorted in
 * place. A leaf costs what it takes to test its blocks of four triangles, ceil(n / 4).
 */
#include "bvh.h"

#include <math.h>

#define BINS 16
/* Few items need few bins: clearing and sweeping them costs more than sorting into them. */
#define FEW_ITEMS 64
#define FEW_BINS 8
#define MANY_ITEMS 128
/* Axes much shorter than the longest never win. */
#define SHORT_AXIS 0.05f
#define LEAF DEV_LEAF_TRIANGLES

typedef asdic_bvh_box bounds;

typedef struct split_plan {
    int axis; /* -1: halve */
    int bin;  /* last bin of the left side */
    float offset, scale;
    bounds left, right;
} split_plan;

static inline bounds nothing(void) {
    return (bounds){float4_splat(INFINITY), float4_splat(-INFINITY)};
}

static inline void grow(bounds *b, float4 lo, float4 hi) {
    b->lo = float4_min(lo, b->lo);
    b->hi = float4_max(hi, b->hi);
}

/* The halves of an item, with id and zero in the fourth lanes. Read in pieces, because a load right
 * after a store would wait for it. */
static inline float4 low_of(const asdic_bvh_item *item) {
    return float4_load(item);
}

static inline float4 high_of(const asdic_bvh_item *item) {
    return float4_load((const char *)item + offsetof(asdic_bvh_item, hi));
}

static inline void set_item(asdic_bvh_item *item, float4 lo, float4 hi) {
    float4_store(lo, item);
    float4_store(hi, (char *)item + offsetof(asdic_bvh_item, hi));
}

/* Twice the centroid: the sum of the corners, which saves a multiplication. The id in the fourth
 * lane is masked, since it is not a number to add. */
static inline float4 twice_centroid(float4 lo, float4 hi) {
    const int4 three = {-1, -1, -1, 0};
    return (float4)((int4)lo & three) + hi;
}

static inline float half_area(const bounds *b) {
    float4 d = b->hi - b->lo;
    return d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
}

static inline float leaf_cost(const bounds *b, size_t count) {
    return count ? half_area(b) * (float)((count + LEAF - 1) / LEAF) : 0.0f;
}

typedef struct bin_set {
    bounds box[3][BINS];
    uint32_t count[3][BINS];
} bin_set;

static void clear_bins(bin_set *bins, int used) {
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < used; i++) {
            bins->box[axis][i] = nothing();
            bins->count[axis][i] = 0;
        }
    }
}

static inline void add_to_bins(bin_set *bins, const asdic_bvh_item *item, float4 offset,
                               float4 scale) {
    float4 lo = low_of(item), hi = high_of(item);
    int4 cell = __builtin_convertvector((twice_centroid(lo, hi) - offset) * scale, int4);
    for (int axis = 0; axis < 3; axis++) {
        grow(&bins->box[axis][cell[axis]], lo, hi);
        bins->count[axis][cell[axis]]++;
    }
}

/* Neighbours fall into the same bins, where a load would wait for the store before it. With many
 * items, even and odd ones therefore have separate bins. */
static void fill_bins(const asdic_bvh_item *items, size_t count, float4 offset, float4 scale,
                      int used, bin_set *bins) {
    clear_bins(bins, used);
    if (count < MANY_ITEMS) {
        for (size_t i = 0; i < count; i++) {
            add_to_bins(bins, &items[i], offset, scale);
        }
        return;
    }
    bin_set odd;
    clear_bins(&odd, used);
    for (size_t i = 0; i + 1 < count; i += 2) {
        add_to_bins(bins, &items[i], offset, scale);
        add_to_bins(&odd, &items[i + 1], offset, scale);
    }
    if (count % 2) {
        add_to_bins(bins, &items[count - 1], offset, scale);
    }
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < used; i++) {
            grow(&bins->box[axis][i], odd.box[axis][i].lo, odd.box[axis][i].hi);
            bins->count[axis][i] += odd.count[axis][i];
        }
    }
}

/* The cheapest cut of one axis; ties go to the lower bin. Returns whether it beats *BEST. */
static bool sweep_axis(const bounds *box, const uint32_t *count, int used, float *best,
                       split_plan *plan) {
    float cost_right[BINS];
    bounds right[BINS], b = nothing();
    uint32_t n = 0;
    for (int i = used - 1; i > 0; i--) {
        grow(&b, box[i].lo, box[i].hi);
        n += count[i];
        right[i] = b;
        cost_right[i] = n ? leaf_cost(&b, n) : INFINITY;
    }
    bool better = false;
    b = nothing();
    n = 0;
    for (int i = 0; i < used - 1; i++) {
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

static split_plan plan_split(const asdic_bvh_item *items, const asdic_bvh_task *t) {
    split_plan plan = {.axis = -1};
    if (t->depth >= ASDIC_BVH_HEURISTIC_DEPTH) {
        return plan;
    }
    int used = t->count < FEW_ITEMS ? FEW_BINS : BINS;
    float4 scale = float4_splat(0.0f), span = t->centroids.hi - t->centroids.lo;
    float longest = fmaxf(fmaxf(span[0], span[1]), span[2]);
    float least = fmaxf(1e-30f, SHORT_AXIS * longest);
    for (int k = 0; k < 3; k++) {
        /* Just under the bins used, so that the largest centroid still falls into the last one. */
        scale[k] = span[k] > least ? 0.9999f * (float)used / span[k] : 0.0f;
    }
    bin_set bins;
    fill_bins(items, t->count, t->centroids.lo, scale, used, &bins);
    float best = INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        if (scale[axis] > 0.0f &&
            sweep_axis(bins.box[axis], bins.count[axis], used, &best, &plan)) {
            plan.axis = axis;
            plan.offset = t->centroids.lo[axis];
            plan.scale = scale[axis];
        }
    }
    return plan;
}

/* Sorts the items by the plan; returns the size of the left side and the sides' centroid boxes.
 * Every item is swapped with the first of the right side, without a branch to guess. */
static size_t partition(asdic_bvh_item *items, size_t count, const split_plan *plan, bounds *left,
                        bounds *right) {
    bounds l = nothing(), r = nothing();
    const float4 low = float4_splat(INFINITY), high = float4_splat(-INFINITY);
    size_t end = 0;
    for (size_t i = 0; i < count; i++) {
        float4 lo = low_of(&items[i]), hi = high_of(&items[i]);
        float4 centroid = twice_centroid(lo, hi);
        bool goes = (int)((centroid[plan->axis] - plan->offset) * plan->scale) <= plan->bin;
        int4 mask = (int4){0, 0, 0, 0} - (int)goes;
        set_item(&items[i], low_of(&items[end]), high_of(&items[end]));
        set_item(&items[end], lo, hi);
        end += goes;
        grow(&l, float4_choose(mask, centroid, low), float4_choose(mask, centroid, high));
        grow(&r, float4_choose(mask, low, centroid), float4_choose(mask, high, centroid));
    }
    *left = l;
    *right = r;
    return end;
}

void asdic_bvh_measure(const asdic_bvh_item *items, asdic_bvh_task *task) {
    bounds b = nothing(), c = nothing();
    for (size_t i = task->first; i < task->first + task->count; i++) {
        float4 lo = low_of(&items[i]), hi = high_of(&items[i]);
        float4 centroid = twice_centroid(lo, hi);
        grow(&b, lo, hi);
        grow(&c, centroid, centroid);
    }
    task->box = b;
    task->centroids = c;
}

void asdic_bvh_split(asdic_bvh_item *items, const asdic_bvh_task *t, asdic_bvh_task *left,
                     asdic_bvh_task *right) {
    split_plan plan = plan_split(items + t->first, t);
    bool halve = plan.axis < 0;
    /* Equal centroids, or too deep: halves, in whole blocks. */
    size_t cut =
        halve ? (t->count / 2 + LEAF - 1) / LEAF * LEAF
              : partition(items + t->first, t->count, &plan, &left->centroids, &right->centroids);
    left->first = t->first;
    left->count = cut;
    right->first = t->first + cut;
    right->count = t->count - cut;
    left->depth = right->depth = t->depth + 1;
    left->box = plan.left;
    right->box = plan.right;
    if (halve) {
        asdic_bvh_measure(items, left);
        asdic_bvh_measure(items, right);
    }
}
