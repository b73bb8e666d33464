#include "run_crew.h"

#include "base/context.h"
#include "team_message.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Orders that a device has at once: one that it works on, one that waits, so that it never does. */
#define ORDERS 2

/* Waiting for messages, the thread looks again after this long. */
#define NAP_NS 500000

/* A device of another process. */
typedef struct helper {
    unsigned rank;
    uint32_t device; /* of that process */
    char name[ASDIC_MESSAGE_NAME];
    asdic_range orders[ORDERS]; /* in the order given; the first is worked on */
    size_t order_count;
    bool is_lost, has_worked;
} helper;

struct asdic_crew {
    asdic_queue *queue;
    asdic_team *team;
    helper *helpers;
    size_t helper_count;
    bool *has_spoken; /* by process */
    size_t silent;    /* processes that have not said what they have */
    bool is_alive;    /* counted in the queue */
    pthread_t thread;
};

/* Leaves the queue when nobody is left to wait for. */
static void retire_if_alone(asdic_crew *c) {
    asdic_queue *q = c->queue;
    size_t working = c->silent;
    for (size_t i = 0; i < c->helper_count; i++) {
        working += !c->helpers[i].is_lost;
    }
    if (working == 0 && c->is_alive) {
        c->is_alive = false;
        q->alive--;
        pthread_cond_broadcast(&q->changed);
    }
}

/* H works no more; what it was ordered to do is for others. */
static void lose(asdic_crew *c, helper *h, asdic_status status, const char *why) {
    asdic_queue *q = c->queue;
    pthread_mutex_lock(&q->lock);
    for (size_t i = 0; i < h->order_count; i++) {
        asdic_queue_return(q, h->orders[i]);
    }
    h->order_count = 0;
    h->is_lost = true;
    retire_if_alone(c);
    q->failure = status;
    bool is_dropped = q->alive > 0;
    pthread_cond_broadcast(&q->changed);
    pthread_mutex_unlock(&q->lock);
    if (is_dropped) {
        asdic_log(q->ctx, ASDIC_LOG_WARNING,
                  "device '%s' of process %u failed and is no longer used: %s", h->name, h->rank,
                  why);
    } else {
        asdic_fail(q->ctx, status, "%s", why);
    }
}

static bool add_helpers(asdic_crew *c, unsigned rank, const char *names, size_t count) {
    helper *more = realloc(c->helpers, (c->helper_count + count + 1) * sizeof *more);
    if (!more) {
        return false;
    }
    c->helpers = more;
    for (size_t i = 0; i < count; i++) {
        helper *h = &more[c->helper_count++];
        *h = (helper){.rank = rank, .device = (uint32_t)i};
        memcpy(h->name, names + i * ASDIC_MESSAGE_NAME, sizeof h->name);
        h->name[sizeof h->name - 1] = 0;
    }
    return true;
}

static void take_hello(asdic_crew *c, unsigned rank, const asdic_message *head, const void *payload,
                       size_t bytes) {
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
              : strcmp(about.run, q->work->run_hash) != 0
                  ? "it has another scene, other options or another version"
                  : NULL;
    }
    c->has_spoken[rank] = true;
    pthread_mutex_lock(&q->lock);
    if (!why && !(asdic_queue_reserve(q, ORDERS * count) && add_helpers(c, rank, names, count))) {
        why = "memory is short";
    }
    c->silent--;
    retire_if_alone(c);
    pthread_mutex_unlock(&q->lock);
    if (why) {
        asdic_log(q->ctx, ASDIC_LOG_WARNING, "process %u takes no part: %s", rank, why);
    }
}

static helper *find_helper(asdic_crew *c, unsigned rank, uint32_t device) {
    for (size_t i = 0; i < c->helper_count; i++) {
        if (c->helpers[i].rank == rank && c->helpers[i].device == device) {
            return &c->helpers[i];
        }
    }
    return NULL;
}

static void take_result(asdic_crew *c, helper *h, size_t ping, const void *payload, size_t bytes) {
    asdic_queue *q = c->queue;
    asdic_ping *result = q->slots[ping % q->slot_count].result;
    asdic_range *order = &h->orders[0];
    if (h->is_lost || h->order_count == 0 || order->next != ping ||
        bytes != asdic_message_ping_bytes(result->beams, result->bins)) {
        return; /* nobody waits for it */
    }
    asdic_message_unpack_ping(payload, result);
    h->has_worked = true;
    if (++order->next == order->end) {
        h->orders[0] = h->orders[1];
        h->order_count--;
    }
    pthread_mutex_lock(&q->lock);
    asdic_queue_finish_ping(q, ping);
    pthread_mutex_unlock(&q->lock);
}

/* Takes one message, if there is one. */
static asdic_status take_message(asdic_crew *c, bool *any) {
    asdic_message head;
    const void *payload = NULL;
    size_t bytes = 0;
    unsigned from = 0;
    asdic_status status = asdic_message_receive(c->team, &from, &head, &payload, &bytes);
    *any = head.kind != 0;
    helper *h = find_helper(c, from, head.device);
    if (head.kind == ASDIC_MESSAGE_HELLO && from < c->team->size && !c->has_spoken[from]) {
        take_hello(c, from, &head, payload, bytes);
    } else if (head.kind == ASDIC_MESSAGE_RESULT && h) {
        take_result(c, h, (size_t)head.first, payload, bytes);
    } else if (head.kind == ASDIC_MESSAGE_FAILED && h) {
        char why[ASDIC_MESSAGE_TEXT] = "";
        memcpy(why, payload, bytes < sizeof why ? bytes : sizeof why - 1);
        lose(c, h, (asdic_status)head.status, why);
    }
    return status;
}

/* Work for H, all of which there is room for; an idle device also takes the beginning of more. */
static asdic_range find_order(asdic_queue *q, const helper *h) {
    asdic_range range = asdic_queue_take_returned(q, q->chunk);
    size_t room = q->taken + q->slot_count, begin = q->fresh;
    if (range.next < range.end || q->is_stopped || begin >= room) {
        return range;
    }
    range = asdic_queue_deal(q);
    if (range.end > room) {
        range.end = h->order_count == 0 ? room : begin;
        q->fresh = range.end;
    }
    return range;
}

static asdic_status order_more(asdic_crew *c, bool *any) {
    asdic_queue *q = c->queue;
    for (size_t i = 0; i < c->helper_count; i++) {
        helper *h = &c->helpers[i];
        if (h->is_lost || h->order_count == ORDERS) {
            continue;
        }
        pthread_mutex_lock(&q->lock);
        asdic_range range = find_order(q, h);
        pthread_mutex_unlock(&q->lock);
        if (range.next == range.end) {
            continue;
        }
        asdic_message order = {.kind = ASDIC_MESSAGE_ORDER,
                               .device = h->device,
                               .first = range.next,
                               .end = range.end};
        h->orders[h->order_count++] = range;
        *any = true;
        asdic_status status = asdic_message_send(c->team, h->rank, &order, NULL, 0);
        if (status != ASDIC_OK) {
            return status;
        }
    }
    return ASDIC_OK;
}

/* Until something happens in the queue, or it is time to look for messages. False when the queue is
 * stopped. */
static bool rest(asdic_queue *q, bool is_busy) {
    struct timespec until;
    pthread_mutex_lock(&q->lock);
    if (!q->is_stopped && !is_busy) {
        clock_gettime(CLOCK_REALTIME, &until);
        until.tv_nsec += NAP_NS;
        until.tv_sec += until.tv_nsec / 1000000000;
        until.tv_nsec %= 1000000000;
        pthread_cond_timedwait(&q->changed, &q->lock, &until);
    }
    bool goes_on = !q->is_stopped && !asdic_context_interrupted(q->ctx);
    pthread_mutex_unlock(&q->lock);
    return goes_on;
}

static asdic_status say_begin(const asdic_crew *c) {
    const asdic_message begin = {.kind = ASDIC_MESSAGE_BEGIN,
                                 .first = asdic_mission_sampling(c->queue->work->mission)->rays};
    asdic_status status = ASDIC_OK;
    for (unsigned to = 1; to < c->team->size && status == ASDIC_OK; to++) {
        status = asdic_message_send(c->team, to, &begin, NULL, 0);
    }
    return status;
}

static void *run_crew(void *argument) {
    asdic_crew *c = argument;
    asdic_status status = say_begin(c);
    bool is_busy = false;
    while (status == ASDIC_OK && rest(c->queue, is_busy)) {
        is_busy = false;
        status = take_message(c, &is_busy);
        if (status == ASDIC_OK) {
            status = order_more(c, &is_busy);
        }
    }
    /* Stopped, interrupted, or out of touch: nothing more comes from the others. */
    char why[ASDIC_MESSAGE_TEXT];
    asdic_context_copy_error(c->queue->ctx, why, sizeof why);
    c->silent = 0;
    for (size_t i = 0; i < c->helper_count; i++) {
        if (status != ASDIC_OK && !c->helpers[i].is_lost) {
            lose(c, &c->helpers[i], status, why);
        }
        c->helpers[i].is_lost = true;
    }
    pthread_mutex_lock(&c->queue->lock);
    retire_if_alone(c);
    pthread_mutex_unlock(&c->queue->lock);
    return NULL;
}

asdic_status asdic_crew_start(asdic_queue *q, asdic_team *team, asdic_crew **out) {
    asdic_crew *c = calloc(1, sizeof *c);
    *out = NULL;
    if (!c) {
        return asdic_fail_memory(q->ctx, "a team");
    }
    *c = (asdic_crew){.queue = q, .team = team, .silent = team->size - 1, .is_alive = true};
    c->has_spoken = calloc(team->size, sizeof *c->has_spoken);
    pthread_mutex_lock(&q->lock); /* the thread may leave the queue before it has been counted */
    bool is_started = c->has_spoken && pthread_create(&c->thread, NULL, run_crew, c) == 0;
    q->alive += is_started;
    pthread_mutex_unlock(&q->lock);
    if (!is_started) {
        free(c->has_spoken);
        free(c);
        return asdic_fail_memory(q->ctx, "a thread");
    }
    *out = c;
    return ASDIC_OK;
}

void asdic_crew_finish(asdic_crew **crew, void (*name)(void *user, const char *device),
                       void *user) {
    asdic_crew *c = *crew;
    if (!c) {
        return;
    }
    pthread_join(c->thread, NULL);
    asdic_team_end(c->queue->ctx, c->team);
    for (size_t i = 0; i < c->helper_count; i++) {
        if (c->helpers[i].has_worked && name) {
            name(user, c->helpers[i].name);
        }
    }
    free(c->has_spoken);
    free(c->helpers);
    free(c);
    *crew = NULL;
}
