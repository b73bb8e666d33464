#include "run_workers.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/try.h"
#include "run_device.h"
#include "run_queue.h"
#include "team_coordinator.h"

#include <stdlib.h>

typedef struct worker {
    asdic_queue *queue;
    const asdic_work *work;
    asdic_run_device device;
    asdic_range own; /* pings dealt to this worker and not begun */
    pthread_t thread;
    bool has_thread;
} worker;

/* The next pings for W, waiting for room; empty when there will be none. Returned pings go first:
 * results are taken in order, and the rest waits for them. */
static asdic_range claim(asdic_queue *q, worker *w) {
    for (;;) {
        if (q->is_stopped || q->remaining == 0 || asdic_context_interrupted(q->ctx)) {
            return (asdic_range){0, 0};
        }
        asdic_range back = asdic_queue_take_returned(q, 1);
        if (back.next < back.end) {
            return back;
        }
        if (w->own.next == w->own.end && q->fresh < q->end) {
            w->own = asdic_queue_deal(q);
        }
        size_t room = asdic_queue_room(q), end = w->own.end < room ? w->own.end : room;
        if (w->own.next < end) {
            asdic_range mine = {w->own.next, w->own.next};
            mine.end += asdic_run_device_batch(&w->device, mine.next, end - mine.next);
            w->own.next = mine.end;
            return mine;
        }
        /* Other workers have the remaining pings, and may fail. */
        pthread_cond_wait(&q->changed, &q->lock);
    }
}

static asdic_status work_through(asdic_queue *q, worker *w) {
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
        status = asdic_run_device_pings(&w->device, mine.next, mine.end - mine.next, results);
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

/* Takes W out of the queue: others do what was dealt to it. */
static void retire(asdic_queue *q, worker *w, asdic_status status) {
    char why[512];
    asdic_context_copy_error(q->ctx, why, sizeof why);
    pthread_mutex_lock(&q->lock);
    asdic_queue_return(q, w->own);
    q->alive--;
    bool is_dropped = status != ASDIC_OK && status != ASDIC_ERROR_INTERRUPTED && q->alive > 0;
    if (status != ASDIC_OK) {
        q->failure = status;
    }
    pthread_cond_broadcast(&q->changed);
    pthread_mutex_unlock(&q->lock);
    if (is_dropped) {
        asdic_log(q->ctx, ASDIC_LOG_ERROR, "device '%s' failed and is no longer used: %s",
                  asdic_device_get_info(w->device.device)->name, why);
    }
}

static void *run_worker(void *argument) {
    worker *w = argument;
    asdic_queue *q = w->queue;
    asdic_status status = asdic_run_device_open(&w->device, q->ctx, w->work->mission,
                                                w->device.device, w->work->bins);
    pthread_mutex_lock(&q->lock);
    asdic_queue_note_ready(q);
    pthread_mutex_unlock(&q->lock);
    status = status ? status : work_through(q, w);
    retire(q, w, status);
    asdic_run_device_close(&w->device);
    return NULL;
}

/* Hands results over in order until all are taken or no worker is left to wait for. */
static asdic_status take_results(asdic_queue *q, const asdic_work *work,
                                 asdic_work_result *result) {
    asdic_status status = ASDIC_OK;
    pthread_mutex_lock(&q->lock);
    while (status == ASDIC_OK && q->taken < q->end) {
        asdic_slot *s = &q->slots[q->taken % q->slot_count];
        if (s->is_ready) {
            result->ready_s = q->ready_s;
            pthread_mutex_unlock(&q->lock);
            status = work->take(work->user, q->taken, s->result);
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

static void start_workers(asdic_queue *q, const asdic_work *work, worker *workers) {
    pthread_mutex_lock(&q->lock);
    for (size_t i = 0; i < work->device_count; i++) {
        worker *w = &workers[i];
        *w = (worker){.queue = q, .work = work, .device.device = work->devices[i]};
        w->has_thread = pthread_create(&w->thread, NULL, run_worker, w) == 0;
        q->alive += w->has_thread;
    }
    if (q->alive == 0) {
        q->failure = asdic_fail_memory(q->ctx, "threads");
    }
    pthread_mutex_unlock(&q->lock);
}

static asdic_status run_workers(asdic_queue *q, const asdic_work *work, worker *workers,
                                asdic_work_result *result) {
    asdic_coordinator *coordinator = NULL;
    if (work->team) {
        TRY(asdic_coordinator_start(q, work->team, asdic_mission_sampling(work->mission)->rays,
                                    work->run_hash, &coordinator));
    }
    start_workers(q, work, workers);
    asdic_status status = take_results(q, work, result);
    for (size_t i = 0; i < work->device_count; i++) {
        if (workers[i].has_thread) {
            pthread_join(workers[i].thread, NULL);
        }
    }
    asdic_coordinator_finish(&coordinator, work->name, work->user);
    result->devices_s = q->devices_s;
    TRY(status);
    if (q->taken == q->end) {
        return ASDIC_OK;
    }
    return asdic_context_interrupted(q->ctx)
               ? asdic_fail(q->ctx, ASDIC_ERROR_INTERRUPTED, "interrupted at ping %zu", q->taken)
               : q->failure;
}

bool asdic_devices_are_there(asdic_device *const *devices, size_t count) {
    bool are_there = devices && count > 0;
    for (size_t i = 0; are_there && i < count; i++) {
        are_there = devices[i] != NULL;
    }
    return are_there;
}

asdic_status asdic_workers_run(asdic_context *ctx, const asdic_work *work,
                               asdic_work_result *result) {
    const asdic_sonar *sonar = asdic_mission_sonar(work->mission);
    asdic_queue_size size = {.first = work->first,
                             .end = work->end,
                             .devices =
                                 work->device_count + (work->team ? work->team->size - 1 : 0),
                             .own = work->device_count,
                             .beams = sonar->receiver_count,
                             .bins = work->bins,
                             .elements = work->elements,
                             .bin_length_m = sonar->bin_length_m,
                             .truth = asdic_mission_sampling(work->mission)->truth};
    asdic_queue q;
    *result = (asdic_work_result){.ready_s = asdic_clock_s()};
    worker *workers = calloc(work->device_count, sizeof *workers);
    asdic_status status = asdic_queue_init(&q, ctx, &size);
    if (status == ASDIC_OK) {
        status = workers ? run_workers(&q, work, workers, result)
                         : asdic_fail_memory(ctx, "the threads of a run");
    }
    asdic_queue_finish(&q);
    free(workers);
    return status;
}
