#include "run_queue_inside.h"

#include "base/clock.h"
#include "base/context.h"
#include "run_crew.h"
#include "run_seat.h"

#include <stdio.h>
#include <stdlib.h>

/* Results that wait to be taken may hold this much memory. */
#define WINDOW_BYTES ((size_t)256 << 20)

typedef asdic_queue queue;

typedef struct asdic_queue_worker {
    queue *queue;
    asdic_device *device;
    asdic_seat seat;
    asdic_range own; /* pings dealt to this worker and not begun */
    pthread_t thread;
    bool has_thread;
} worker;

static size_t least(size_t a, size_t b) {
    return a < b ? a : b;
}

static size_t most(size_t a, size_t b) {
    return a > b ? a : b;
}

asdic_range asdic_queue_take_returned(queue *q, size_t most_pings) {
    asdic_range *lowest = NULL;
    size_t room = q->taken + q->slot_count;
    for (size_t i = 0; i < q->returned_count; i++) {
        asdic_range *r = &q->returned[i];
        if (r->next < r->end && (!lowest || r->next < lowest->next)) {
            lowest = r;
        }
    }
    if (q->is_stopped || !lowest || lowest->next >= room) {
        return (asdic_range){0, 0};
    }
    asdic_range found = {lowest->next, least(least(lowest->end, room), lowest->next + most_pings)};
    lowest->next = found.end;
    return found;
}

asdic_range asdic_queue_deal(queue *q) {
    size_t block_end = (q->fresh / ASDIC_LEARN_BLOCK + 1) * ASDIC_LEARN_BLOCK;
    asdic_range range = {q->fresh, least(least(q->fresh + q->chunk, block_end), q->work->end)};
    q->fresh = range.end;
    return range;
}

bool asdic_queue_reserve(queue *q, size_t count) {
    size_t capacity = q->returned_capacity + count;
    asdic_range *more = realloc(q->returned, capacity * sizeof *more);
    if (more) {
        q->returned = more;
        q->returned_capacity = capacity;
    }
    return more != NULL;
}

void asdic_queue_return(queue *q, asdic_range range) {
    q->returned[q->returned_count++] = range;
}

void asdic_queue_finish_ping(queue *q, size_t ping) {
    q->slots[ping % q->slot_count].is_ready = true;
    q->remaining--;
    q->ready_s = q->ready_s > 0.0 ? q->ready_s : asdic_clock_s();
    pthread_cond_broadcast(&q->changed);
}

/* The next pings for W, waiting for room; none when there will be none. Returned pings go first: the
 * window cannot move on without them. */
static asdic_range claim(queue *q, worker *w) {
    for (;;) {
        if (q->is_stopped || q->remaining == 0 || asdic_context_interrupted(q->ctx)) {
            return (asdic_range){0, 0};
        }
        asdic_range back = asdic_queue_take_returned(q, 1);
        if (back.next < back.end) {
            return back;
        }
        if (w->own.next == w->own.end && q->fresh < q->work->end) {
            w->own = asdic_queue_deal(q);
        }
        size_t room = q->taken + q->slot_count;
        if (w->own.next < w->own.end && w->own.next < room) {
            asdic_range mine = {w->own.next, w->own.next};
            mine.end += asdic_seat_volley(&w->seat, mine.next, least(w->own.end, room) - mine.next);
            w->own.next = mine.end;
            return mine;
        }
        /* What remains is with others, who may yet fail. */
        pthread_cond_wait(&q->changed, &q->lock);
    }
}

static asdic_status work_through(queue *q, worker *w) {
    asdic_status status = ASDIC_OK;
    pthread_mutex_lock(&q->lock);
    for (;;) {
        asdic_ping *results[ASDIC_LEARN_BLOCK];
        asdic_range mine = claim(q, w);
        if (mine.next == mine.end) {
            break;
        }
        for (size_t ping = mine.next; ping < mine.end; ping++) {
            results[ping - mine.next] = q->slots[ping % q->slot_count].result;
        }
        pthread_mutex_unlock(&q->lock);
        double begin_s = asdic_clock_s();
        status = asdic_seat_pings(&w->seat, mine.next, mine.end - mine.next, results);
        double end_s = asdic_clock_s();
        pthread_mutex_lock(&q->lock);
        q->devices_s += end_s - begin_s;
        if (status != ASDIC_OK) {
            asdic_queue_return(q, mine);
            break;
        }
        for (size_t ping = mine.next; ping < mine.end; ping++) {
            asdic_queue_finish_ping(q, ping);
        }
    }
    pthread_mutex_unlock(&q->lock);
    return status;
}

/* Says goodbye: what was dealt to this worker is for others. */
static void retire(queue *q, worker *w, asdic_status status) {
    char why[512];
    asdic_context_copy_error(q->ctx, why, sizeof why);
    pthread_mutex_lock(&q->lock);
    asdic_queue_return(q, w->own);
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
    queue *q = w->queue;
    asdic_status status =
        asdic_seat_open(&w->seat, q->ctx, q->work->mission, w->device, q->work->bins);
    note_ready(q);
    if (status == ASDIC_OK) {
        status = work_through(q, w);
    }
    retire(q, w, status);
    asdic_seat_close(&w->seat);
    return NULL;
}

/* Hands results over in order until all are taken or no worker is left to wait for. */
static asdic_status take_results(queue *q, asdic_queue_result *result) {
    asdic_status status = ASDIC_OK;
    pthread_mutex_lock(&q->lock);
    while (status == ASDIC_OK && q->taken < q->work->end) {
        asdic_slot *s = &q->slots[q->taken % q->slot_count];
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
    size_t devices = work->device_count + (work->team ? work->team->size - 1 : 0);
    q->slot_count = least(most(WINDOW_BYTES / bytes, 2 * devices), 2 * ASDIC_LEARN_BLOCK * devices);
    q->chunk = least(least(q->slot_count / (2 * devices), ASDIC_LEARN_BLOCK),
                     most(1, pings / (4 * devices)));
    q->slot_count = least(q->slot_count, pings);
    q->slots = calloc(q->slot_count, sizeof *q->slots);
    q->workers = calloc(work->device_count, sizeof *q->workers);
    /* A worker returns the ping that failed and what it had left. */
    if (!q->slots || !q->workers || !asdic_queue_reserve(q, 2 * work->device_count)) {
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
        *w = (worker){.queue = q, .device = q->work->devices[i]};
        w->has_thread = pthread_create(&w->thread, NULL, run_worker, w) == 0;
        q->alive += w->has_thread;
    }
    if (q->alive == 0) {
        q->failure = asdic_fail_memory(q->ctx, "threads");
    }
    pthread_mutex_unlock(&q->lock);
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
    asdic_crew *crew = NULL;
    asdic_status status = queue_init(&q);
    if (status == ASDIC_OK && work->team) {
        status = asdic_crew_start(&q, work->team, &crew);
    }
    if (status == ASDIC_OK) {
        start_workers(&q);
        status = take_results(&q, result);
        for (size_t i = 0; i < work->device_count; i++) {
            if (q.workers[i].has_thread) {
                pthread_join(q.workers[i].thread, NULL);
            }
        }
        asdic_crew_finish(&crew, work->name, work->user);
        result->taken = q.taken - work->first;
        result->devices_s = q.devices_s;
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
