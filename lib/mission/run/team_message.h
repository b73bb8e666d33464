/*
 * The messages between the processes of a team: a head, then a payload.
 *
 *     0 -> others   BEGIN   the number of rays, which a tolerance may have changed
 *     others -> 0   HELLO   a hash of what is to be run, the devices' names; or why not
 *     0 -> others   ORDER   pings for a device
 *     others -> 0   RESULT  one ping
 *     others -> 0   FAILED  a device is lost, and why
 *     0 -> others   STOP    the run is over
 *     others -> 0   BYE     the last message
 */
#ifndef ASDIC_MISSION_TEAM_MESSAGE_H
#define ASDIC_MISSION_TEAM_MESSAGE_H

#include <asdic/ping.h>
#include <asdic/team.h>

typedef enum asdic_message_kind {
    ASDIC_MESSAGE_BEGIN = 1,
    ASDIC_MESSAGE_HELLO,
    ASDIC_MESSAGE_ORDER,
    ASDIC_MESSAGE_RESULT,
    ASDIC_MESSAGE_FAILED,
    ASDIC_MESSAGE_STOP,
    ASDIC_MESSAGE_BYE,
} asdic_message_kind;

/* Longest sentence and name that travel. */
#define ASDIC_MESSAGE_TEXT 512
#define ASDIC_MESSAGE_NAME 256

typedef struct asdic_message {
    uint32_t kind;   /* asdic_message_kind */
    uint32_t device; /* ORDER, RESULT, FAILED: which of the process; HELLO: how many */
    uint64_t first;  /* ORDER: pings first .. end - 1; RESULT: the ping; BEGIN: rays */
    uint64_t end;
    int32_t status; /* HELLO, FAILED: asdic_status */
    uint32_t unused;
} asdic_message;

/* HELLO: this, then the names. */
typedef struct asdic_message_hello {
    char run[65]; /* hash */
    char why[ASDIC_MESSAGE_TEXT];
} asdic_message_hello;

/* Sends HEAD and BYTES of payload. */
asdic_status asdic_message_send(const asdic_team *team, unsigned to, const asdic_message *head,
                                const void *payload, size_t bytes);

/* The next message, its head copied; *PAYLOAD is valid until the next call. HEAD's kind is 0 when
 * there is none. What is no message is skipped. */
asdic_status asdic_message_receive(const asdic_team *team, unsigned *from, asdic_message *head,
                                   const void **payload, size_t *bytes);

/* A ping as a payload. */
size_t asdic_message_ping_bytes(const asdic_ping *ping);
void asdic_message_pack_ping(const asdic_ping *ping, void *payload);
void asdic_message_unpack_ping(const void *payload, asdic_ping *ping);

/* Sleeps for a moment, between two looks for messages. */
void asdic_message_wait(void);

#endif
