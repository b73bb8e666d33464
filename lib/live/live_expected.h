/*
 * The expected curve of one beam along the track, by quadrature; in its own thread when the clock
 * must not wait for it.
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
    asdic_status status; /* of that */
    asdic_ping *ping;    /* of the thread while it runs, as is FOUND */
    asdic_status found;
    pthread_t thread;
    bool is_running;
    double begun_s;
    pthread_mutex_t lock; /* guards is_done */
    bool has_lock, is_done;
} asdic_live_expected;

asdic_status asdic_live_expected_init(asdic_context *ctx, size_t bins, bool in_background,
                                      asdic_live_expected *out);
void asdic_live_expected_finish(asdic_live_expected *expected);

/* Requests the curve of BEAM at PING's position and takes one that is ready. A position within 1 %
 * of altitude and depth and half a degree needs no new curve. */
asdic_status asdic_live_expected_follow(asdic_live_expected *expected, const asdic_mission *mission,
                                        const asdic_loop_ping *ping, size_t beam);

/* A component's curve, by bin; NULL: none is known. */
const float *asdic_live_expected_db(const asdic_live_expected *expected, asdic_component part);

#endif
