#include "run_queue.h"

#include "base/context.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

/* Results that wait to be taken may hold this much memory. */
#define WINDOW_BYTES ((size_t)256 << 20)
#define NO_PING SIZE_MAX

typedef struct range {
    size_t next, end;
} range;

typedef struct slot {
    asdic_ping *result;
    bool is_ready;
} slot;

struct queue;

typedef struct worker {
    struct queue *queue;
    asdic_device *device;
    asdic_simulator *simulator;
    range own;    /* pings dealt to this worker and not begun */
    size_t block; /* the simulator has learnt for this block; NO_PING: for none */
    pthread_t thread;
    bool has_thread;
} worker;

typedef struct queue {
    asdic_context *ctx;
    const asdic_queue_work *work;
    pthread_mutex_t lock; /* guards everything below */
    pthread_cond_t changed;
    slot *slots; /* ping p lives in slots[p % slot_count] */
    size_t slot_count;
    size_t chunk;     /* pings dealt at once, within a learning block */
    size_t fresh;     /* first ping that was not dealt */
    size_t taken;     /* first ping that was not taken */
    size_t remaining; /* pings not simulated yet */
    range *returned;  /* by devices that failed, one range each */
    size_t returned_count;
    size_t alive; /* workers */
    bool is_stopped;
    asdic_status failure; /* of the last device that failed */
    double ready_s;
    worker *workers;
} queue;

static size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

static size_t most(size_t a, size_t b) {
    return a > b ? a : b;
}

/* The lowest ping that a failed device gave back, if there is room for its result. */
static size_t claim_returned(queue *q) {
    range *lowest = NULL;
    for (size_t i = 0; i < q->returned_count; i++) {
        range *r = &q->returned[i];
        if (r->next < r->end && (!lowest || r->next < lowest->next)) {
            lowest = r;
        }
    }
    return lowest && lowest->next < q->taken + q->slot_count ? lowest->next++ : NO_PING;
}

/* Deals the next chunk; chunks do not cross learning blocks, so that a device seldom learns for
 * few pings. */
static void deal(queue *q, worker *w) {
    size_t block_end = (q->fresh / ASDIC_LEARN_BLOCK + 1) * ASDIC_LEARN_BLOCK;
    w->own.next = q->fresh;
    w->own.end = least(least(q->fresh + q->chunk, block_end), q->work->end);
    q->fresh = w->own.end;
}

/* The next ping for W, waiting for room; NO_PING when there will be none. Returned pings go first:
 * the window cannot move on without them. */
static size_t claim(queue *q, worker *w) {
    for (;;) {
        if (q->is_stopped || q->remaining == 0 || asdic_context_interrupted(q->ctx)) {
            return NO_PING;
        }
        size_t ping = claim_returned(q);
        if (ping != NO_PING) {
            return ping;
        }
        if (w->own.next == w->own.end && q->fresh < q->work->end) {
            deal(q, w);
        }
        if (w->own.next < w->own.end && w->own.next < q->taken + q->slot_count) {
            return w->own.next++;
        }
        /* What remains is with others, who may yet fail. */
        pthread_cond_wait(&q->changed, &q->lock);
    }
}

static asdic_status simulate(queue *q, worker *w, size_t ping, asdic_ping *result) {
    const asdic_mission *mission = q->work->mission;
    size_t block = ping / ASDIC_LEARN_BLOCK;
    if (w->block != block) {
        size_t pilot = block * ASDIC_LEARN_BLOCK;
        asdic_pose pose = asdic_mission_pose(mission, pilot, NULL);
        asdic_status status = asdic_mission_place(mission, w->simulator, pilot);
        if (status == ASDIC_OK) {
            status = asdic_simulator_learn(w->simulator, &pose, pilot);
        }
        if (status != ASDIC_OK) {
            return status;
        }
        w->block = block;
    }
    asdic_pose pose = asdic_mission_pose(mission, ping, NULL);
    asdic_status status = asdic_mission_place(mission, w->simulator, ping);
    return status == ASDIC_OK ? asdic_simulator_ping(w->simulator, &pose, ping, result) : status;
}

static asdic_status work_through(queue *q, worker *w) {
    asdic_status status = ASDIC_OK;
    pthread_mutex_lock(&q->lock);
    for (;;) {
        size_t ping = claim(q, w);
        if (ping == NO_PING) {
            break;
        }
        slot *s = &q->slots[ping % q->slot_count];
        pthread_mutex_unlock(&q->lock);
        status = simulate(q, w, ping, s->result);
        pthread_mutex_lock(&q->lock);
        if (status != ASDIC_OK) {
            q->returned[q->returned_count++] = (range){ping, ping + 1};
            break;
        }
        s->is_ready = true;
        q->remaining--;
        pthread_cond_broadcast(&q->changed);
    }
    pthread_mutex_unlock(&q->lock);
    return status;
}

static asdic_status start_simulator(queue *q, worker *w) {
    asdic_mission *mission = q->work->mission;
    /* Every part of a mission has as many bins as its first ping. */
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    asdic_status status = asdic_simulator_create(
        q->ctx, w->device, asdic_mission_scene(mission), asdic_mission_environment(mission),
        asdic_mission_sonar(mission), asdic_mission_sampling(mission), depth_m, &w->simulator);
    if (status != ASDIC_OK) {
        return status;
    }
    size_t bins = asdic_simulator_bin_count(w->simulator);
    if (bins != q->work->bins) {
        return asdic_fail(q->ctx, ASDIC_ERROR_ARGUMENT, "the simulator has %zu bins, the run %zu",
                          bins, q->work->bins);
    }
    return ASDIC_OK;
}

/* Says goodbye: what was dealt to this worker is for others. */
static void retire(queue *q, worker *w, asdic_status status) {
    char why[512];
    snprintf(why, sizeof why, "%s", asdic_context_error(q->ctx));
    pthread_mutex_lock(&q->lock);
    q->returned[q->returned_count++] = w->own;
    q->alive--;
    bool is_dropped = status != ASDIC_OK && q->alive > 0;
    if (status != ASDIC_OK) {
        q->failure = status;
    }
    pthread_cond_broadcast(&q->changed);
    pthread_mutex_unlock(&q->lock);
    if (is_dropped) {
        asdic_log(q->ctx, ASDIC_LOG_WARNING, "device '%s' failed and is no longer used: %s",
                  asdic_device_get_info(w->device)->name, why);
    }
}

static void note_ready(queue *q) {
    pthread_mutex_lock(&q->lock);
    q->ready_s = q->ready_s > 0.0 ? q->ready_s : asdic_clock_s();
    pthread_mutex_unlock(&q->lock);
}

static void *run_worker(void *argument) {
    worker *w = argument;
    asdic_status status = start_simulator(w->queue, w);
    note_ready(w->queue);
    if (status == ASDIC_OK) {
        status = work_through(w->queue, w);
    }
    retire(w->queue, w, status);
    asdic_simulator_destroy(&w->simulator);
    return NULL;
}

/* Hands results over in order until all are taken or no worker is left to wait for. */
static asdic_status take_results(queue *q, asdic_queue_result *result) {
    asdic_status status = ASDIC_OK;
    pthread_mutex_lock(&q->lock);
    while (status == ASDIC_OK && q->taken < q->work->end) {
        slot *s = &q->slots[q->taken % q->slot_count];
        if (s->is_ready) {
            result->ready_s = q->ready_s;
            pthread_mutex_unlock(&q->lock);
            status = q->work->take(q->work->user, q->taken, s->result);
            pthread_mutex_lock(&q->lock);
            s->is_ready = false;
            q->taken += status == ASDIC_OK;
            pthread_cond_broadcast(&q->changed);
        } else if (q->alive == 0) {
            break;
        } else {
            pthread_cond_wait(&q->changed, &q->lock);
        }
    }
    q->is_stopped = true;
    pthread_cond_broadcast(&q->changed);
    pthread_mutex_unlock(&q->lock);
    return status;
}

static asdic_status queue_init(queue *q) {
    const asdic_queue_work *work = q->work;
    size_t beams = asdic_mission_sonar(work->mission)->receiver_count;
    size_t bytes = beams * work->bins * (ASDIC_COMPONENT_COUNT * sizeof(double) + sizeof(float));
    size_t pings = work->end - work->first;
    q->slot_count = least(most(WINDOW_BYTES / bytes, 2 * work->device_count),
                          2 * ASDIC_LEARN_BLOCK * work->device_count);
    q->chunk = least(least(q->slot_count / (2 * work->device_count), ASDIC_LEARN_BLOCK),
                     most(1, pings / (4 * work->device_count)));
    q->slot_count = least(q->slot_count, pings);
    q->slots = calloc(q->slot_count, sizeof *q->slots);
    q->workers = calloc(work->device_count, sizeof *q->workers);
    /* A worker returns the ping that failed and what it had left. */
    q->returned = calloc(2 * work->device_count, sizeof *q->returned);
    if (!q->slots || !q->workers || !q->returned) {
        return asdic_fail_memory(q->ctx, "the queue of pings");
    }
    for (size_t i = 0; i < q->slot_count; i++) {
        asdic_status status = asdic_ping_create(q->ctx, beams, work->bins, &q->slots[i].result);
        if (status != ASDIC_OK) {
            return status;
        }
        q->slots[i].result->bin_length_m = asdic_mission_sonar(work->mission)->bin_length_m;
    }
    return ASDIC_OK;
}

static void queue_finish(queue *q) {
    for (size_t i = 0; q->slots && i < q->slot_count; i++) {
        asdic_ping_destroy(&q->slots[i].result);
    }
    free(q->slots);
    free(q->workers);
    free(q->returned);
}

static void start_workers(queue *q) {
    pthread_mutex_lock(&q->lock);
    for (size_t i = 0; i < q->work->device_count; i++) {
        worker *w = &q->workers[i];
        *w = (worker){.queue = q, .device = q->work->devices[i], .block = NO_PING};
        w->has_thread = pthread_create(&w->thread, NULL, run_worker, w) == 0;
        q->alive += w->has_thread;
    }
    if (q->alive == 0) {
        q->failure = asdic_fail_memory(q->ctx, "threads");
    }
    pthread_mutex_unlock(&q->lock);
}

double asdic_clock_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

asdic_status asdic_queue_run(asdic_context *ctx, const asdic_queue_work *work,
                             asdic_queue_result *result) {
    queue q = {.ctx = ctx,
               .work = work,
               .lock = PTHREAD_MUTEX_INITIALIZER,
               .changed = PTHREAD_COND_INITIALIZER,
               .remaining = work->end - work->first,
               .fresh = work->first,
               .taken = work->first};
    *result = (asdic_queue_result){.ready_s = asdic_clock_s()};
    asdic_status status = queue_init(&q);
    if (status == ASDIC_OK) {
        start_workers(&q);
        status = take_results(&q, result);
        for (size_t i = 0; i < work->device_count; i++) {
            if (q.workers[i].has_thread) {
                pthread_join(q.workers[i].thread, NULL);
            }
        }
        result->taken = q.taken - work->first;
        if (status == ASDIC_OK && q.taken < work->end) {
            status = asdic_context_interrupted(ctx) ? asdic_fail(ctx, ASDIC_ERROR_INTERRUPTED,
                                                                 "interrupted at ping %zu", q.taken)
                                                    : q.failure;
        }
    }
    queue_finish(&q);
    pthread_cond_destroy(&q.changed);
    pthread_mutex_destroy(&q.lock);
    return status;
}
