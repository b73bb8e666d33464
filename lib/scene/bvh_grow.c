/*
 * The binary tree, grown by several threads. A thread offers large subtrees to the others. The
 * memory order of nodes depends on the threads, the shape of the tree does not.
 */
#include "bvh.h"

#include "../base/context.h"
#include "../base/share.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>

/* Smaller subtrees stay with the thread that meets them. */
#define TASK_ITEMS 8192
#define MAX_TASKS 512
/* Nodes that a thread allocates at once; even, as children lie in pairs. */
#define CHUNK 1024

typedef struct grower {
    asdic_bvh_item *items;
    asdic_bvh_tree *tree;
    atomic_size_t next_node, leaves;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    asdic_bvh_task queue[MAX_TASKS];
    size_t queued, running;
} grower;

/* The state of one thread: nodes left, leaves made. */
typedef struct worker {
    grower *g;
    size_t next, end, leaves;
} worker;

/* Hands T to another thread; false when the queue is full. */
static bool offer(grower *g, const asdic_bvh_task *t) {
    pthread_mutex_lock(&g->lock);
    bool taken = g->queued < MAX_TASKS;
    if (taken) {
        g->queue[g->queued++] = *t;
        pthread_cond_signal(&g->changed);
    }
    pthread_mutex_unlock(&g->lock);
    return taken;
}

static size_t take_pair(worker *w) {
    if (w->next == w->end) {
        w->next = atomic_fetch_add(&w->g->next_node, CHUNK);
        w->end = w->next + CHUNK;
    }
    w->next += 2;
    return w->next - 2;
}

static bool is_planned(const asdic_bvh_tree *tree, size_t node) {
    return tree->best[node][0] >= 0.0f;
}

/* Builds the subtree of T, and its plan where no part of it went to another thread. */
static void grow_subtree(worker *w, const asdic_bvh_task *t) {
    asdic_bvh_tree *tree = w->g->tree;
    asdic_bvh_node2 *node = &tree->nodes[t->node];
    memcpy(node->lo, &t->box.lo, sizeof node->lo);
    memcpy(node->hi, &t->box.hi, sizeof node->hi);
    if (t->count <= DEV_LEAF_TRIANGLES) {
        node->link = (uint32_t)t->first;
        node->count = (uint32_t)t->count;
        memset(tree->best[t->node], 0, sizeof tree->best[t->node]);
        w->leaves++;
        return;
    }
    asdic_bvh_task left, right;
    asdic_bvh_split(w->g->items, t, &left, &right);
    left.node = take_pair(w);
    right.node = left.node + 1;
    node->link = (uint32_t)left.node;
    node->count = 0;
    bool away = right.count >= TASK_ITEMS && offer(w->g, &right);
    grow_subtree(w, &left);
    if (!away) {
        grow_subtree(w, &right);
    }
    if (!away && is_planned(tree, left.node) && is_planned(tree, right.node)) {
        asdic_bvh_plan(tree->nodes, tree->best, t->node);
    } else {
        tree->best[t->node][0] = -1.0f;
    }
}

/* A thread's part: subtrees until there are none. */
static void help(void *user, unsigned worker_index, size_t first, size_t end) {
    grower *g = user;
    worker w = {.g = g};
    (void)worker_index, (void)first, (void)end;
    pthread_mutex_lock(&g->lock);
    for (;;) {
        while (g->queued == 0 && g->running > 0) {
            pthread_cond_wait(&g->changed, &g->lock);
        }
        if (g->queued == 0) {
            break;
        }
        asdic_bvh_task t = g->queue[--g->queued];
        g->running++;
        pthread_mutex_unlock(&g->lock);
        grow_subtree(&w, &t);
        pthread_mutex_lock(&g->lock);
        g->running--;
    }
    pthread_cond_broadcast(&g->changed);
    pthread_mutex_unlock(&g->lock);
    atomic_fetch_add(&g->leaves, w.leaves);
}

/* Plans the top of the tree after several threads have grown its subtrees. */
static void plan_trunk(asdic_bvh_tree *tree, size_t node) {
    if (is_planned(tree, node)) {
        return;
    }
    plan_trunk(tree, tree->nodes[node].link);
    plan_trunk(tree, tree->nodes[node].link + 1);
    asdic_bvh_plan(tree->nodes, tree->best, node);
}

asdic_status asdic_bvh_grow(asdic_context *ctx, asdic_bvh_item *items, size_t count,
                            unsigned threads, asdic_bvh_tree *tree) {
    grower g = {.items = items, .tree = tree, .next_node = 2, .queued = 1};
    /* Touched as far as it is used. A chunk is unfinished at the end of every thread. */
    size_t entries = 2 * count + (ASDIC_SHARE_MOST + 2) * CHUNK;
    *tree = (asdic_bvh_tree){.nodes = malloc(entries * sizeof *tree->nodes),
                             .best = malloc(entries * sizeof *tree->best)};
    if (!tree->nodes || !tree->best) {
        return asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                          "out of memory while building a hierarchy of %zu triangles", count);
    }
    if (pthread_mutex_init(&g.lock, NULL) != 0) {
        return asdic_fail_memory(ctx, "the hierarchy's lock");
    }
    if (pthread_cond_init(&g.changed, NULL) != 0) {
        pthread_mutex_destroy(&g.lock);
        return asdic_fail_memory(ctx, "the hierarchy's lock");
    }
    g.queue[0] = (asdic_bvh_task){.count = count};
    asdic_bvh_measure(items, &g.queue[0]);
    asdic_share(threads, threads, 1, help, &g);
    plan_trunk(tree, 0);
    tree->leaves = g.leaves;
    pthread_cond_destroy(&g.changed);
    pthread_mutex_destroy(&g.lock);
    return ASDIC_OK;
}

void asdic_bvh_tree_finish(asdic_bvh_tree *tree) {
    free(tree->nodes);
    free(tree->best);
    *tree = (asdic_bvh_tree){.nodes = NULL};
}
