#include "live_expected.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/try.h"

#include <stdlib.h>
#include <string.h>

/* In the background pings come first: at most one new curve in this time. */
#define BREAK_S 0.7
#define SAME_SHARE 0.01
#define SAME_RAD 0.009

asdic_status asdic_live_expected_init(asdic_context *ctx, size_t bins, bool in_background,
                                      asdic_live_expected *e) {
    *e = (asdic_live_expected){.ctx = ctx, .in_background = in_background, .begun_s = -1e9};
    TRY(asdic_ping_create(ctx, 1, bins, &e->ping));
    e->level_db[0] = calloc(ASDIC_COMPONENT_COUNT * bins, sizeof(float));
    if (!e->level_db[0]) {
        return asdic_fail_memory(ctx, "expected levels");
    }
    for (size_t c = 1; c < ASDIC_COMPONENT_COUNT; c++) {
        e->level_db[c] = e->level_db[0] + c * bins;
    }
    e->has_lock = pthread_mutex_init(&e->lock, NULL) == 0;
    return e->has_lock ? ASDIC_OK : asdic_fail_memory(ctx, "a lock");
}

void asdic_live_expected_finish(asdic_live_expected *e) {
    if (e->is_running) {
        pthread_join(e->thread, NULL);
    }
    if (e->has_lock) {
        pthread_mutex_destroy(&e->lock);
    }
    asdic_ping_destroy(&e->ping);
    free(e->level_db[0]);
    *e = (asdic_live_expected){0};
}

static live_question question_of(const asdic_mission *mission, const asdic_loop_ping *ping,
                                 size_t beam) {
    live_question q = {.place = {.flat = asdic_mission_flat_scene(mission, 0)},
                       .environment = *asdic_mission_environment(mission),
                       .sonar = *asdic_mission_sonar(mission),
                       .beam = asdic_mission_sonar(mission)->receivers[beam]};
    asdic_sweep sweep = asdic_mission_sweep(mission);
    asdic_loop_ping_place(ping, &q.place);
    q.place.pose = asdic_sweep_sonar(&sweep, &ping->pose, ping->ping);
    q.sonar.receivers = NULL;
    q.sonar.receiver_count = 1;
    return q;
}

static bool is_same(const live_question *a, const live_question *b) {
    return asdic_expected_is_near(&a->place, &b->place, SAME_SHARE, SAME_RAD) &&
           a->environment.wind_speed_kn == b->environment.wind_speed_kn &&
           a->sonar.source_level_db == b->sonar.source_level_db &&
           memcmp(&a->beam, &b->beam, sizeof a->beam) == 0;
}

static void *answer(void *argument) {
    asdic_live_expected *e = argument;
    live_question q = e->asked;
    q.sonar.receivers = &q.beam;
    e->found = asdic_expected_compute(e->ctx, &q.place.flat, &q.environment, &q.sonar,
                                      &q.place.pose, e->ping);
    pthread_mutex_lock(&e->lock);
    e->is_done = true;
    pthread_mutex_unlock(&e->lock);
    return NULL;
}

static void take(asdic_live_expected *e) {
    e->status = e->found;
    e->has_answer = e->status == ASDIC_OK;
    for (int c = 0; e->has_answer && c < ASDIC_COMPONENT_COUNT; c++) {
        for (size_t i = 0; i < e->ping->bins; i++) {
            e->level_db[c][i] = (float)asdic_level_db(e->ping->intensity_lin[c][i]);
        }
    }
}

/* True while the thread works. */
static bool is_busy(asdic_live_expected *e) {
    if (!e->is_running) {
        return false;
    }
    pthread_mutex_lock(&e->lock);
    bool is_done = e->is_done;
    pthread_mutex_unlock(&e->lock);
    if (is_done) {
        pthread_join(e->thread, NULL);
        e->is_running = false;
        take(e);
    }
    return !is_done;
}

asdic_status asdic_live_expected_follow(asdic_live_expected *e, const asdic_mission *mission,
                                        const asdic_loop_ping *ping, size_t beam) {
    if (is_busy(e)) {
        return ASDIC_OK;
    }
    live_question now = question_of(mission, ping, beam);
    bool is_other_beam = memcmp(&now.beam, &e->asked.beam, sizeof now.beam) != 0;
    e->has_answer = e->has_answer && !is_other_beam;
    if (e->has_answer && is_same(&now, &e->asked)) {
        return e->status;
    }
    if (e->in_background && e->has_answer && asdic_clock_s() - e->begun_s < BREAK_S) {
        return e->status;
    }
    e->asked = now;
    e->begun_s = asdic_clock_s();
    e->is_done = false;
    e->is_running = e->in_background && pthread_create(&e->thread, NULL, answer, e) == 0;
    if (!e->is_running) {
        answer(e);
        take(e);
    }
    return e->status;
}

const float *asdic_live_expected_db(const asdic_live_expected *e, asdic_component part) {
    return e->has_answer ? e->level_db[part] : NULL;
}
