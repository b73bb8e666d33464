#include "team_message.h"

#include "base/context.h"
#include "base/try.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

asdic_status asdic_message_send(const asdic_team *team, unsigned to, const asdic_message *head,
                                const void *payload, size_t bytes) {
    char *whole = malloc(sizeof *head + bytes);
    if (!whole) {
        return ASDIC_ERROR_MEMORY;
    }
    memcpy(whole, head, sizeof *head);
    if (bytes > 0) {
        memcpy(whole + sizeof *head, payload, bytes);
    }
    asdic_status status = team->send(team->user, to, whole, sizeof *head + bytes);
    free(whole);
    return status;
}

asdic_status asdic_message_receive(const asdic_team *team, unsigned *from, asdic_message *head,
                                   const void **payload, size_t *bytes) {
    const void *data = NULL;
    size_t length = 0;
    head->kind = 0;
    for (;;) {
        TRY(team->receive(team->user, from, &data, &length));
        if (!data) {
            return ASDIC_OK;
        }
        if (length >= sizeof *head) {
            memcpy(head, data, sizeof *head);
            *payload = (const char *)data + sizeof *head;
            *bytes = length - sizeof *head;
            return ASDIC_OK;
        }
    }
}

/* The truth of a ping is one block of memory. */
static size_t truth_bytes(const asdic_ping *ping) {
    size_t each = 2 * sizeof(int16_t) + (ASDIC_PATH_COUNT + 3) * sizeof(float);
    return ping->truth ? ping->beams * ping->bins * each : 0;
}

size_t asdic_message_ping_bytes(const asdic_ping *ping) {
    return 2 * sizeof(uint64_t) + truth_bytes(ping) +
           ping->beams * ping->bins * (ASDIC_COMPONENT_COUNT * sizeof(double) + sizeof(float));
}

void asdic_message_pack_ping(const asdic_ping *ping, void *payload) {
    const uint64_t counts[2] = {ping->rays, ping->saturated};
    size_t cells = ping->beams * ping->bins;
    char *at = payload;
    memcpy(at, counts, sizeof counts);
    at += sizeof counts;
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++, at += cells * sizeof(double)) {
        memcpy(at, ping->intensity_lin[c], cells * sizeof(double));
    }
    memcpy(at, ping->stderr_db, cells * sizeof(float));
    if (ping->truth) {
        memcpy(at + cells * sizeof(float), ping->truth + 1, truth_bytes(ping));
    }
}

void asdic_message_unpack_ping(const void *payload, asdic_ping *ping) {
    uint64_t counts[2];
    size_t cells = ping->beams * ping->bins;
    const char *at = payload;
    memcpy(counts, at, sizeof counts);
    ping->rays = counts[0];
    ping->saturated = counts[1];
    at += sizeof counts;
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++, at += cells * sizeof(double)) {
        memcpy(ping->intensity_lin[c], at, cells * sizeof(double));
    }
    memcpy(ping->stderr_db, at, cells * sizeof(float));
    if (ping->truth) {
        memcpy(ping->truth + 1, at + cells * sizeof(float), truth_bytes(ping));
    }
}

void asdic_message_wait(void) {
    nanosleep(&(struct timespec){.tv_nsec = 500000}, NULL);
}

/* ---- the end -------------------------------------------------------------------------------- */

/* The next message, waiting for it. */
static asdic_status wait_for_message(const asdic_team *team, asdic_message *head) {
    const void *payload;
    size_t bytes;
    unsigned from;
    for (;;) {
        TRY(asdic_message_receive(team, &from, head, &payload, &bytes));
        if (head->kind != 0) {
            return ASDIC_OK;
        }
        asdic_message_wait();
    }
}

/* Process 0: tells all others to stop and waits for the last message of each. */
static asdic_status dismiss(const asdic_team *team) {
    const asdic_message stop = {.kind = ASDIC_MESSAGE_STOP};
    asdic_message head = {0};
    for (unsigned to = 1; to < team->size; to++) {
        TRY(asdic_message_send(team, to, &stop, NULL, 0));
    }
    for (unsigned left = team->size - 1; left > 0; left -= head.kind == ASDIC_MESSAGE_BYE) {
        TRY(wait_for_message(team, &head));
    }
    return ASDIC_OK;
}

/* Another process that did not take part: tells process 0 why and waits to be told to stop. */
static asdic_status excuse(asdic_context *ctx, const asdic_team *team) {
    const asdic_message hello = {.kind = ASDIC_MESSAGE_HELLO, .status = ASDIC_ERROR_INPUT};
    const asdic_message bye = {.kind = ASDIC_MESSAGE_BYE};
    asdic_message_hello about = {{0}, {0}};
    asdic_message head = {0};
    snprintf(about.why, sizeof about.why, "%s", asdic_context_error(ctx));
    TRY(asdic_message_send(team, 0, &hello, &about, sizeof about));
    while (head.kind != ASDIC_MESSAGE_STOP) {
        TRY(wait_for_message(team, &head));
    }
    return asdic_message_send(team, 0, &bye, NULL, 0);
}

asdic_status asdic_team_end(asdic_context *ctx, asdic_team *team) {
    if (!team) {
        return asdic_fail_null(ctx, __func__);
    }
    if (team->is_over) {
        return ASDIC_OK;
    }
    team->is_over = true;
    return team->rank == 0 ? dismiss(team) : excuse(ctx, team);
}
