#include "run_member.h"

#include "base/context.h"
#include "run_seat.h"
#include "team_message.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More than process 0 orders at once. */
#define ORDERS 4

/* A message to process 0 that waits to be sent. */
typedef struct letter {
    struct letter *next;
    asdic_message head;
    size_t bytes;
    char payload[];
} letter;

struct member;

typedef struct hand {
    struct member *member;
    uint32_t number;
    asdic_device *device;
    asdic_message orders[ORDERS]; /* in the order in which they came */
    size_t order_count;
    pthread_t thread;
    bool has_thread;
} hand;

typedef struct member {
    asdic_run_job *job;
    const asdic_team *team;
    pthread_mutex_t lock; /* guards what follows and the hands' orders */
    pthread_cond_t changed;
    letter *first, *last;
    bool is_over;
    hand *hands;
} member;

/* False when nobody wants letters any more. */
static bool post(member *m, letter *l) {
    pthread_mutex_lock(&m->lock);
    bool goes_on = !m->is_over;
    if (m->last) {
        m->last->next = l;
    } else {
        m->first = l;
    }
    m->last = l;
    pthread_mutex_unlock(&m->lock);
    return goes_on;
}

static letter *write_letter(asdic_message head, size_t bytes) {
    letter *l = calloc(1, sizeof *l + bytes);
    if (l) {
        l->head = head;
        l->bytes = bytes;
    }
    return l;
}

/* The next order, waiting for it; false when there will be none. */
static bool wait_for_order(hand *h, asdic_message *order) {
    member *m = h->member;
    pthread_mutex_lock(&m->lock);
    while (h->order_count == 0 && !m->is_over) {
        pthread_cond_wait(&m->changed, &m->lock);
    }
    bool goes_on = !m->is_over;
    if (goes_on) {
        *order = h->orders[0];
        memmove(h->orders, h->orders + 1, --h->order_count * sizeof *h->orders);
    }
    pthread_mutex_unlock(&m->lock);
    return goes_on;
}

static asdic_status obey(hand *h, asdic_seat *seat, const asdic_message *order,
                         asdic_ping *result) {
    member *m = h->member;
    for (uint64_t ping = order->first; ping < order->end; ping++) {
        asdic_status status = asdic_seat_pings(seat, (size_t)ping, 1, &result);
        if (status != ASDIC_OK) {
            return status;
        }
        letter *l = write_letter(
            (asdic_message){.kind = ASDIC_MESSAGE_RESULT, .device = h->number, .first = ping},
            asdic_message_ping_bytes(result->beams, result->bins));
        if (!l) {
            return asdic_fail_memory(m->job->ctx, "a message");
        }
        asdic_message_pack_ping(result, l->payload);
        if (!post(m, l)) {
            return ASDIC_OK;
        }
    }
    return ASDIC_OK;
}

/* The last word of a device that failed. */
static void report_failure(hand *h, asdic_status status) {
    letter *l = write_letter((asdic_message){.kind = ASDIC_MESSAGE_FAILED,
                                             .device = h->number,
                                             .status = (int32_t)status},
                             ASDIC_MESSAGE_TEXT);
    if (l) {
        asdic_context_copy_error(h->member->job->ctx, l->payload, ASDIC_MESSAGE_TEXT);
        post(h->member, l);
    }
}

static void *run_hand(void *argument) {
    hand *h = argument;
    const asdic_run_job *job = h->member->job;
    asdic_seat seat;
    asdic_ping *result = NULL;
    asdic_message order;
    asdic_status status =
        asdic_seat_open(&seat, job->ctx, job->mission, h->device, job->facts.bins);
    if (status == ASDIC_OK) {
        status = asdic_ping_create(job->ctx, job->facts.beams, job->facts.bins, &result);
    }
    while (status == ASDIC_OK && wait_for_order(h, &order)) {
        status = obey(h, &seat, &order, result);
    }
    if (status != ASDIC_OK) {
        report_failure(h, status);
    }
    asdic_ping_destroy(&result);
    asdic_seat_close(&seat);
    return NULL;
}

static asdic_status say_hello(const member *m) {
    const asdic_run_job *job = m->job;
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
    asdic_status status = asdic_message_send(m->team, 0, &hello, payload, bytes);
    free(payload);
    return status;
}

/* Sends what waits; true when there was something. */
static bool send_letters(member *m, asdic_status *status) {
    pthread_mutex_lock(&m->lock);
    letter *l = m->first;
    m->first = m->last = NULL;
    pthread_mutex_unlock(&m->lock);
    bool any = l != NULL;
    while (l) {
        letter *next = l->next;
        if (*status == ASDIC_OK) {
            *status = asdic_message_send(m->team, 0, &l->head, l->payload, l->bytes);
        }
        free(l);
        l = next;
    }
    return any;
}

static void take_order(member *m, const asdic_message *head) {
    pthread_mutex_lock(&m->lock);
    hand *h = head->device < m->job->device_count ? &m->hands[head->device] : NULL;
    if (h && h->order_count < ORDERS) {
        h->orders[h->order_count++] = *head;
        pthread_cond_broadcast(&m->changed);
    }
    pthread_mutex_unlock(&m->lock);
}

/* Waits for a message of KIND, or to be sent home; takes orders meanwhile. */
static asdic_status listen(member *m, asdic_message_kind kind, asdic_message *head) {
    asdic_status status = ASDIC_OK;
    do {
        const void *payload;
        size_t bytes;
        unsigned from;
        status = asdic_message_receive(m->team, &from, head, &payload, &bytes);
        if (status == ASDIC_OK && head->kind == ASDIC_MESSAGE_ORDER) {
            take_order(m, head);
        }
        if (!send_letters(m, &status) && head->kind == 0) {
            asdic_message_rest();
        }
    } while (status == ASDIC_OK && head->kind != kind && head->kind != ASDIC_MESSAGE_STOP);
    return status;
}

static asdic_status start_hands(member *m) {
    m->hands = calloc(m->job->device_count, sizeof *m->hands);
    if (!m->hands) {
        return asdic_fail_memory(m->job->ctx, "threads");
    }
    for (size_t i = 0; i < m->job->device_count; i++) {
        hand *h = &m->hands[i];
        *h = (hand){.member = m, .number = (uint32_t)i, .device = m->job->devices[i]};
        h->has_thread = pthread_create(&h->thread, NULL, run_hand, h) == 0;
        if (!h->has_thread) {
            asdic_status status = asdic_fail_memory(m->job->ctx, "a thread");
            report_failure(h, status);
        }
    }
    return ASDIC_OK;
}

static void join_hands(member *m) {
    asdic_status ignored = ASDIC_ERROR_INTERRUPTED; /* nobody wants letters any more */
    pthread_mutex_lock(&m->lock);
    m->is_over = true;
    pthread_cond_broadcast(&m->changed);
    pthread_mutex_unlock(&m->lock);
    for (size_t i = 0; m->hands && i < m->job->device_count; i++) {
        if (m->hands[i].has_thread) {
            pthread_join(m->hands[i].thread, NULL);
        }
    }
    send_letters(m, &ignored);
    free(m->hands);
}

asdic_status asdic_member_run(asdic_run_job *job) {
    asdic_team *team = job->options->team;
    member m = {.job = job,
                .team = team,
                .lock = PTHREAD_MUTEX_INITIALIZER,
                .changed = PTHREAD_COND_INITIALIZER};
    asdic_message head = {0};
    asdic_status status = listen(&m, ASDIC_MESSAGE_BEGIN, &head);
    if (status == ASDIC_OK && head.kind == ASDIC_MESSAGE_BEGIN) {
        asdic_mission_sampling(job->mission)->rays = (uint32_t)head.first;
        status = asdic_job_describe(job); /* of a failure asdic_team_end tells process 0 */
        if (status == ASDIC_OK) {
            status = start_hands(&m);
        }
        if (status == ASDIC_OK) {
            status = say_hello(&m);
        }
        if (status == ASDIC_OK) {
            status = listen(&m, ASDIC_MESSAGE_STOP, &head);
        }
    }
    join_hands(&m);
    pthread_cond_destroy(&m.changed);
    pthread_mutex_destroy(&m.lock);
    if (status == ASDIC_OK) {
        const asdic_message bye = {.kind = ASDIC_MESSAGE_BYE};
        team->is_over = true;
        status = asdic_message_send(team, 0, &bye, NULL, 0);
    }
    return status;
}
