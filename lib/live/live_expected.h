/*
 * The expected curve of one beam as the vehicle goes: by quadrature, in a thread of its own when the
 * clock must not wait for it.
 */
#ifndef ASDIC_LIVE_LIVE_EXPECTED_H
#define ASDIC_LIVE_LIVE_EXPECTED_H

#include <asdic/loop.h>
#include <asdic/mission.h>

#include <pthread.h>

/* What a curve is for. */
typedef struct live_question {
    asdic_expected_place place;
    asdic_environment environment;
    asdic_sonar sonar; /* of the one beam */
    asdic_beam beam;
} live_question;

typedef struct asdic_live_expected {
    asdic_context *ctx;
    bool in_background;
    live_question asked; /* of what is shown, or being computed */
    bool has_answer;
    float *level_db[ASDIC_COMPONENT_COUNT];
    asdic_ping *ping; /* of the thread while it runs */
    asdic_status status;
    pthread_t thread;
    bool is_running;
    double begun_s;
    pthread_mutex_t lock; /* guards is_done */
    bool has_lock, is_done;
} asdic_live_expected;

asdic_status asdic_live_expected_init(asdic_context *ctx, size_t bins, bool in_background,
                                      asdic_live_expected *out);
void asdic_live_expected_finish(asdic_live_expected *expected);

/* Asks for BEAM at the place of PING, and takes what is ready. What changed little is not asked for
 * again: 1 % of the altitude or depth, half a degree. */
asdic_status asdic_live_expected_follow(asdic_live_expected *expected, const asdic_mission *mission,
                                        const asdic_loop_ping *ping, size_t beam);

/* A component's curve, by bin; NULL: none is known. */
const float *asdic_live_expected_db(const asdic_live_expected *expected, asdic_component part);

#endif
