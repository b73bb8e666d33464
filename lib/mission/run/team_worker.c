#include "run_job.h"

#include "base/context.h"
#include "base/try.h"
#include "run_device.h"
#include "team_message.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* At least as many orders as process 0 gives a device at once. */
#define ORDERS 4

/* A message to process 0 that waits to be sent. */
typedef struct message {
    struct message *next;
    asdic_message head;
    size_t bytes;
    char payload[];
} message;

struct team_worker;

typedef struct device_thread {
    struct team_worker *worker;
    uint32_t number;
    asdic_device *device;
    asdic_message orders[ORDERS]; /* in the order in which they came */
    size_t order_count;
    pthread_t thread;
    bool has_thread;
} device_thread;

typedef struct team_worker {
    asdic_run_job *job;
    const asdic_team *team;
    pthread_mutex_t lock; /* guards what follows and the threads' orders */
    pthread_cond_t changed;
    message *first, *last;
    bool is_over;
    device_thread *threads;
} team_worker;

/* Queues OUT for sending. False when the run is over. */
static bool post(team_worker *w, message *out) {
    pthread_mutex_lock(&w->lock);
    bool goes_on = !w->is_over;
    if (w->last) {
        w->last->next = out;
    } else {
        w->first = out;
    }
    w->last = out;
    pthread_mutex_unlock(&w->lock);
    return goes_on;
}

static message *new_message(asdic_message head, size_t bytes) {
    message *out = calloc(1, sizeof *out + bytes);
    if (out) {
        out->head = head;
        out->bytes = bytes;
    }
    return out;
}

/* The next order, waiting for it; false when there will be none. */
static bool wait_for_order(device_thread *d, asdic_message *order) {
    team_worker *w = d->worker;
    pthread_mutex_lock(&w->lock);
    while (d->order_count == 0 && !w->is_over) {
        pthread_cond_wait(&w->changed, &w->lock);
    }
    bool goes_on = !w->is_over;
    if (goes_on) {
        *order = d->orders[0];
        memmove(d->orders, d->orders + 1, --d->order_count * sizeof *d->orders);
    }
    pthread_mutex_unlock(&w->lock);
    return goes_on;
}

static asdic_status simulate_order(device_thread *d, asdic_run_device *device,
                                   const asdic_message *order, asdic_ping *result) {
    team_worker *w = d->worker;
    for (uint64_t ping = order->first; ping < order->end; ping++) {
        TRY(asdic_run_device_pings(device, (size_t)ping, 1, &result));
        message *out = new_message(
            (asdic_message){.kind = ASDIC_MESSAGE_RESULT, .device = d->number, .first = ping},
            asdic_message_ping_bytes(result));
        if (!out) {
            return asdic_fail_memory(w->job->ctx, "a message");
        }
        asdic_message_pack_ping(result, out->payload);
        if (!post(w, out)) {
            return ASDIC_OK;
        }
    }
    return ASDIC_OK;
}

/* The last message of a device that failed. */
static void report_failure(device_thread *d, asdic_status status) {
    message *out = new_message((asdic_message){.kind = ASDIC_MESSAGE_FAILED,
                                               .device = d->number,
                                               .status = (int32_t)status},
                               ASDIC_MESSAGE_TEXT);
    if (out) {
        asdic_context_copy_error(d->worker->job->ctx, out->payload, ASDIC_MESSAGE_TEXT);
        post(d->worker, out);
    }
}

static asdic_status simulate_orders(device_thread *d, asdic_run_device *device,
                                    asdic_ping **result) {
    const asdic_run_job *job = d->worker->job;
    asdic_message order;
    TRY(asdic_run_device_open(device, job->ctx, job->mission, d->device, job->facts.bins));
    TRY(asdic_ping_create(job->ctx, job->facts.beams, job->facts.bins, result));
    if (job->facts.sampling.truth) {
        TRY(asdic_ping_add_truth(job->ctx, *result));
    }
    while (wait_for_order(d, &order)) {
        TRY(simulate_order(d, device, &order, *result));
    }
    return ASDIC_OK;
}

static void *run_device_thread(void *argument) {
    device_thread *d = argument;
    asdic_run_device device = {0};
    asdic_ping *result = NULL;
    asdic_status status = simulate_orders(d, &device, &result);
    if (status != ASDIC_OK) {
        report_failure(d, status);
    }
    asdic_ping_destroy(&result);
    asdic_run_device_close(&device);
    return NULL;
}

static asdic_status send_hello(const team_worker *w) {
    const asdic_run_job *job = w->job;
    size_t bytes = sizeof(asdic_message_hello) + job->device_count * ASDIC_MESSAGE_NAME;
    char *payload = calloc(1, bytes);
    asdic_message_hello about = {{0}, {0}};
    if (!payload) {
        return asdic_fail_memory(job->ctx, "a message");
    }
    asdic_job_hash(job, about.run);
    memcpy(payload, &about, sizeof about);
    for (size_t i = 0; i < job->device_count; i++) {
        snprintf(payload + sizeof about + i * ASDIC_MESSAGE_NAME, ASDIC_MESSAGE_NAME, "%s",
                 asdic_device_get_info(job->devices[i])->name);
    }
    const asdic_message hello = {.kind = ASDIC_MESSAGE_HELLO,
                                 .device = (uint32_t)job->device_count};
    asdic_status status = asdic_message_send(w->team, 0, &hello, payload, bytes);
    free(payload);
    return status;
}

/* Sends the messages that wait; true when there were any. */
static bool send_messages(team_worker *w, asdic_status *status) {
    pthread_mutex_lock(&w->lock);
    message *out = w->first;
    w->first = w->last = NULL;
    pthread_mutex_unlock(&w->lock);
    bool any = out != NULL;
    while (out) {
        message *next = out->next;
        if (*status == ASDIC_OK) {
            *status = asdic_message_send(w->team, 0, &out->head, out->payload, out->bytes);
        }
        free(out);
        out = next;
    }
    return any;
}

static void take_order(team_worker *w, const asdic_message *head) {
    pthread_mutex_lock(&w->lock);
    device_thread *d = head->device < w->job->device_count ? &w->threads[head->device] : NULL;
    if (d && d->order_count < ORDERS) {
        d->orders[d->order_count++] = *head;
        pthread_cond_broadcast(&w->changed);
    }
    pthread_mutex_unlock(&w->lock);
}

/* Waits for a message of KIND, or for the end of the run; takes orders meanwhile. */
static asdic_status listen(team_worker *w, asdic_message_kind kind, asdic_message *head) {
    asdic_status status = ASDIC_OK;
    do {
        const void *payload;
        size_t bytes;
        unsigned from;
        status = asdic_message_receive(w->team, &from, head, &payload, &bytes);
        if (status == ASDIC_OK && head->kind == ASDIC_MESSAGE_ORDER) {
            take_order(w, head);
        }
        if (!send_messages(w, &status) && head->kind == 0) {
            asdic_message_wait();
        }
    } while (status == ASDIC_OK && head->kind != kind && head->kind != ASDIC_MESSAGE_STOP);
    return status;
}

static asdic_status start_threads(team_worker *w) {
    w->threads = calloc(w->job->device_count, sizeof *w->threads);
    if (!w->threads) {
        return asdic_fail_memory(w->job->ctx, "threads");
    }
    for (size_t i = 0; i < w->job->device_count; i++) {
        device_thread *d = &w->threads[i];
        *d = (device_thread){.worker = w, .number = (uint32_t)i, .device = w->job->devices[i]};
        d->has_thread = pthread_create(&d->thread, NULL, run_device_thread, d) == 0;
        if (!d->has_thread) {
            asdic_status status = asdic_fail_memory(w->job->ctx, "a thread");
            report_failure(d, status);
        }
    }
    return ASDIC_OK;
}

static void join_threads(team_worker *w) {
    asdic_status ignored = ASDIC_ERROR_INTERRUPTED; /* what waits is freed, not sent */
    pthread_mutex_lock(&w->lock);
    w->is_over = true;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->lock);
    for (size_t i = 0; w->threads && i < w->job->device_count; i++) {
        if (w->threads[i].has_thread) {
            pthread_join(w->threads[i].thread, NULL);
        }
    }
    send_messages(w, &ignored);
    free(w->threads);
}

/* From the beginning of the run, of which process 0 tells, to its end. */
static asdic_status take_part(team_worker *w) {
    asdic_run_job *job = w->job;
    asdic_message head = {0};
    TRY(listen(w, ASDIC_MESSAGE_BEGIN, &head));
    if (head.kind != ASDIC_MESSAGE_BEGIN) {
        return ASDIC_OK;
    }
    asdic_mission_sampling(job->mission)->rays = (uint32_t)head.first;
    TRY(asdic_job_describe(job)); /* of a failure asdic_team_end tells process 0 */
    TRY(start_threads(w));
    TRY(send_hello(w));
    return listen(w, ASDIC_MESSAGE_STOP, &head);
}

asdic_status asdic_team_worker_run(asdic_run_job *job) {
    asdic_team *team = job->options->team;
    team_worker w = {.job = job,
                     .team = team,
                     .lock = PTHREAD_MUTEX_INITIALIZER,
                     .changed = PTHREAD_COND_INITIALIZER};
    asdic_status status = take_part(&w);
    join_threads(&w);
    pthread_cond_destroy(&w.changed);
    pthread_mutex_destroy(&w.lock);
    TRY(status);
    const asdic_message bye = {.kind = ASDIC_MESSAGE_BYE};
    team->is_over = true;
    return asdic_message_send(team, 0, &bye, NULL, 0);
}
