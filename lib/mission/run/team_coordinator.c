#include "team_coordinator.h"

#include "base/context.h"
#include "base/try.h"
#include "team_message.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Orders that a device has at once: one that it works on, one that waits, so that it is never
 * idle. */
#define ORDERS 2

/* The thread looks for messages this often. */
#define POLL_NS 500000

/* A device of another process. */
typedef struct remote {
    unsigned rank;
    uint32_t device; /* of that process */
    char name[ASDIC_MESSAGE_NAME];
    asdic_range orders[ORDERS]; /* in the order given; the first is worked on */
    size_t order_count;
    bool is_lost, has_worked;
} remote;

struct asdic_coordinator {
    asdic_queue *queue;
    asdic_team *team;
    uint32_t rays;        /* a ping */
    const char *run_hash; /* what runs must agree in */
    remote *remotes;
    size_t remote_count;
    bool *has_joined; /* by process: it has named its devices */
    size_t silent;    /* processes that have not joined */
    bool is_alive;    /* counted in the queue */
    pthread_t thread;
};

/* Leaves the queue when no process is left to wait for. */
static void retire_if_alone(asdic_coordinator *c) {
    asdic_queue *q = c->queue;
    size_t working = c->silent;
    for (size_t i = 0; i < c->remote_count; i++) {
        working += !c->remotes[i].is_lost;
    }
    if (working == 0 && c->is_alive) {
        c->is_alive = false;
        q->alive--;
        pthread_cond_broadcast(&q->changed);
    }
}

/* R works no more; its pings go back to the queue. */
static void lose(asdic_coordinator *c, remote *r, asdic_status status, const char *why) {
    asdic_queue *q = c->queue;
    pthread_mutex_lock(&q->lock);
    for (size_t i = 0; i < r->order_count; i++) {
        asdic_queue_return(q, r->orders[i]);
    }
    r->order_count = 0;
    r->is_lost = true;
    retire_if_alone(c);
    q->failure = status;
    bool is_dropped = q->alive > 0;
    pthread_cond_broadcast(&q->changed);
    pthread_mutex_unlock(&q->lock);
    if (is_dropped) {
        asdic_log(q->ctx, ASDIC_LOG_ERROR,
                  "device '%s' of process %u failed and is no longer used: %s", r->name, r->rank,
                  why);
    } else {
        asdic_fail(q->ctx, status, "%s", why);
    }
}

static bool add_remotes(asdic_coordinator *c, unsigned rank, const char *names, size_t count) {
    remote *more = realloc(c->remotes, (c->remote_count + count + 1) * sizeof *more);
    if (!more) {
        return false;
    }
    c->remotes = more;
    for (size_t i = 0; i < count; i++) {
        remote *r = &more[c->remote_count++];
        *r = (remote){.rank = rank, .device = (uint32_t)i};
        memcpy(r->name, names + i * ASDIC_MESSAGE_NAME, sizeof r->name);
        r->name[sizeof r->name - 1] = 0;
    }
    return true;
}

static void take_hello(asdic_coordinator *c, unsigned rank, const asdic_message *head,
                       const void *payload, size_t bytes) {
    asdic_queue *q = c->queue;
    asdic_message_hello about;
    const char *names = (const char *)payload + sizeof about;
    size_t count = head->device;
    bool is_whole = bytes >= sizeof about && (bytes - sizeof about) / ASDIC_MESSAGE_NAME == count;
    const char *why = "its message is damaged";
    if (is_whole) {
        memcpy(&about, payload, sizeof about);
        about.run[sizeof about.run - 1] = about.why[sizeof about.why - 1] = 0;
        why = head->status != ASDIC_OK ? about.why
              : strcmp(about.run, c->run_hash) != 0
                  ? "it has another scene, other options or another version"
                  : NULL;
    }
    c->has_joined[rank] = true;
    pthread_mutex_lock(&q->lock);
    if (!why && !(asdic_queue_reserve(q, ORDERS * count) && add_remotes(c, rank, names, count))) {
        why = "memory is short";
    }
    c->silent--;
    retire_if_alone(c);
    pthread_mutex_unlock(&q->lock);
    if (why) {
        asdic_log(q->ctx, ASDIC_LOG_WARNING, "process %u takes no part: %s", rank, why);
    }
}

static remote *find_remote(asdic_coordinator *c, unsigned rank, uint32_t device) {
    for (size_t i = 0; i < c->remote_count; i++) {
        if (c->remotes[i].rank == rank && c->remotes[i].device == device) {
            return &c->remotes[i];
        }
    }
    return NULL;
}

static void take_result(asdic_coordinator *c, remote *r, size_t ping, const void *payload,
                        size_t bytes) {
    asdic_queue *q = c->queue;
    asdic_ping *result = q->slots[ping % q->slot_count].result;
    asdic_range *order = &r->orders[0];
    if (r->is_lost || r->order_count == 0 || order->next != ping ||
        bytes != asdic_message_ping_bytes(result)) {
        return; /* it was given to another device */
    }
    asdic_message_unpack_ping(payload, result);
    r->has_worked = true;
    if (++order->next == order->end) {
        r->orders[0] = r->orders[1];
        r->order_count--;
    }
    pthread_mutex_lock(&q->lock);
    asdic_queue_finish_ping(q, ping);
    pthread_mutex_unlock(&q->lock);
}

/* Takes one message, if there is one. */
static asdic_status take_message(asdic_coordinator *c, bool *any) {
    asdic_message head = {0};
    const void *payload = NULL;
    size_t bytes = 0;
    unsigned from = 0;
    asdic_status status = asdic_message_receive(c->team, &from, &head, &payload, &bytes);
    *any = head.kind != 0;
    remote *r = find_remote(c, from, head.device);
    if (head.kind == ASDIC_MESSAGE_HELLO && from < c->team->size && !c->has_joined[from]) {
        take_hello(c, from, &head, payload, bytes);
    } else if (head.kind == ASDIC_MESSAGE_RESULT && r) {
        take_result(c, r, (size_t)head.first, payload, bytes);
    } else if (head.kind == ASDIC_MESSAGE_FAILED && r) {
        char why[ASDIC_MESSAGE_TEXT] = "";
        memcpy(why, payload, bytes < sizeof why ? bytes : sizeof why - 1);
        lose(c, r, (asdic_status)head.status, why);
    }
    return status;
}

/* Pings for R that all have room for their results. A device that is idle also takes a part of a
 * range. */
static asdic_range find_order(asdic_queue *q, const remote *r) {
    asdic_range range = asdic_queue_take_returned(q, q->chunk);
    size_t room = q->taken + q->slot_count, begin = q->fresh;
    if (range.next < range.end || q->is_stopped || begin >= room) {
        return range;
    }
    range = asdic_queue_deal(q);
    if (range.end > room) {
        range.end = r->order_count == 0 ? room : begin;
        q->fresh = range.end;
    }
    return range;
}

static asdic_status order_more(asdic_coordinator *c, bool *any) {
    asdic_queue *q = c->queue;
    for (size_t i = 0; i < c->remote_count; i++) {
        remote *r = &c->remotes[i];
        if (r->is_lost || r->order_count == ORDERS) {
            continue;
        }
        pthread_mutex_lock(&q->lock);
        asdic_range range = find_order(q, r);
        pthread_mutex_unlock(&q->lock);
        if (range.next == range.end) {
            continue;
        }
        asdic_message order = {.kind = ASDIC_MESSAGE_ORDER,
                               .device = r->device,
                               .first = range.next,
                               .end = range.end};
        r->orders[r->order_count++] = range;
        *any = true;
        TRY(asdic_message_send(c->team, r->rank, &order, NULL, 0));
    }
    return ASDIC_OK;
}

/* Waits until the queue changes or it is time to look for messages. False when the queue is
 * stopped. */
static bool wait_for_change(asdic_queue *q, bool is_busy) {
    struct timespec until;
    pthread_mutex_lock(&q->lock);
    if (!q->is_stopped && !is_busy) {
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_nsec += POLL_NS;
        until.tv_sec += until.tv_nsec / 1000000000;
        until.tv_nsec %= 1000000000;
        pthread_cond_timedwait(&q->changed, &q->lock, &until);
    }
    bool goes_on = !q->is_stopped && !asdic_context_interrupted(q->ctx);
    pthread_mutex_unlock(&q->lock);
    return goes_on;
}

static asdic_status send_begin(const asdic_coordinator *c) {
    const asdic_message begin = {.kind = ASDIC_MESSAGE_BEGIN, .first = c->rays};
    for (unsigned to = 1; to < c->team->size; to++) {
        TRY(asdic_message_send(c->team, to, &begin, NULL, 0));
    }
    return ASDIC_OK;
}

static void *run_coordinator(void *argument) {
    asdic_coordinator *c = argument;
    asdic_status status = send_begin(c);
    bool is_busy = false;
    while (status == ASDIC_OK && wait_for_change(c->queue, is_busy)) {
        is_busy = false;
        status = take_message(c, &is_busy);
        status = status ? status : order_more(c, &is_busy);
    }
    /* Stopped, interrupted or cut off: nothing more comes from the other processes. */
    char why[ASDIC_MESSAGE_TEXT];
    asdic_context_copy_error(c->queue->ctx, why, sizeof why);
    c->silent = 0;
    for (size_t i = 0; i < c->remote_count; i++) {
        if (status != ASDIC_OK && !c->remotes[i].is_lost) {
            lose(c, &c->remotes[i], status, why);
        }
        c->remotes[i].is_lost = true;
    }
    pthread_mutex_lock(&c->queue->lock);
    retire_if_alone(c);
    pthread_mutex_unlock(&c->queue->lock);
    return NULL;
}

asdic_status asdic_coordinator_start(asdic_queue *q, asdic_team *team, uint32_t rays,
                                     const char *run_hash, asdic_coordinator **out) {
    asdic_coordinator *c = calloc(1, sizeof *c);
    *out = NULL;
    if (!c) {
        return asdic_fail_memory(q->ctx, "a team");
    }
    *c = (asdic_coordinator){.queue = q,
                             .team = team,
                             .rays = rays,
                             .run_hash = run_hash,
                             .silent = team->size - 1,
                             .is_alive = true};
    c->has_joined = calloc(team->size, sizeof *c->has_joined);
    pthread_mutex_lock(&q->lock); /* the thread must not leave the queue before it is counted */
    bool is_started = c->has_joined && pthread_create(&c->thread, NULL, run_coordinator, c) == 0;
    q->alive += is_started;
    pthread_mutex_unlock(&q->lock);
    if (!is_started) {
        free(c->has_joined);
        free(c);
        return asdic_fail_memory(q->ctx, "a thread");
    }
    *out = c;
    return ASDIC_OK;
}

void asdic_coordinator_finish(asdic_coordinator **coordinator,
                              void (*name)(void *user, const char *device), void *user) {
    asdic_coordinator *c = *coordinator;
    if (!c) {
        return;
    }
    pthread_join(c->thread, NULL);
    asdic_team_end(c->queue->ctx, c->team);
    for (size_t i = 0; i < c->remote_count; i++) {
        if (c->remotes[i].has_worked && name) {
            name(user, c->remotes[i].name);
        }
    }
    free(c->has_joined);
    free(c->remotes);
    free(c);
    *coordinator = NULL;
}
