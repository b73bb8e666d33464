#include "loop.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/decibel.h"
#include "base/try.h"
#include "mission/mission.h"
#include "mission/track/track.h"
#include "sim/simulator.h"

#include <math.h>
#include <pthread.h>
#include <stdlib.h>

typedef enum loop_state { LOOP_IDLE, LOOP_SUBMITTED, LOOP_DONE, LOOP_CLOSING } loop_state;

/* A caller reads one result while the next is made. */
typedef struct loop_slot {
    asdic_ping *ping;
    float *level_db;
} loop_slot;

struct asdic_loop {
    asdic_context *ctx;
    const asdic_scene *scene;
    asdic_simulator *simulator;
    const asdic_mission *mission; /* NULL: nothing moves but the vehicle */
    double ping_rate_hz, start_s;
    loop_slot slots[2];
    uint64_t first, next; /* ping that it began with, and that to be submitted */

    pthread_t thread;
    bool has_thread, has_lock;
    pthread_mutex_t lock; /* guards state */
    pthread_cond_t changed;
    loop_state state;

    /* Owned by the worker thread while a ping is submitted, by the caller otherwise. */
    asdic_pose pose;
    double submitted_s, latency_s;
    asdic_status status;
};

static loop_slot *slot_of(asdic_loop *loop, uint64_t ping) {
    return &loop->slots[ping % 2];
}

static double time_of(const asdic_loop *loop, uint64_t ping) {
    return loop->start_s + (double)(ping - loop->first) / loop->ping_rate_hz;
}

/* Where the sonar of a vehicle at the submitted pose is, and looks, at ping PING. */
static asdic_pose sonar_pose(const asdic_loop *loop, uint64_t ping) {
    return loop->mission ? asdic_sweep_sonar(&loop->mission->settings.sweep, &loop->pose, ping)
                         : loop->pose;
}

/* Simulates ping NEXT - 1, learning as in a mission. */
static asdic_status simulate(asdic_loop *loop) {
    uint64_t index = loop->next - 1;
    loop_slot *slot = slot_of(loop, index);
    asdic_pose pose = sonar_pose(loop, index);
    if (loop->mission) {
        TRY(asdic_mission_place_at(loop->mission, loop->simulator, time_of(loop, index)));
    }
    if (index == loop->first || asdic_simulator_learn_is_due(loop->simulator, &pose, index)) {
        TRY(asdic_simulator_learn(loop->simulator, &pose, index));
    }
    TRY(asdic_simulator_ping(loop->simulator, &pose, index, slot->ping));
    asdic_decibels(slot->ping->intensity_lin[ASDIC_TOTAL], slot->ping->beams * slot->ping->bins,
                   slot->level_db);
    return ASDIC_OK;
}

static void *work(void *argument) {
    asdic_loop *loop = argument;
    pthread_mutex_lock(&loop->lock);
    for (;;) {
        while (loop->state != LOOP_SUBMITTED && loop->state != LOOP_CLOSING) {
            pthread_cond_wait(&loop->changed, &loop->lock);
        }
        if (loop->state == LOOP_CLOSING) {
            break;
        }
        pthread_mutex_unlock(&loop->lock);
        asdic_status status = simulate(loop);
        double latency_s = asdic_clock_s() - loop->submitted_s;
        pthread_mutex_lock(&loop->lock);
        loop->status = status;
        loop->latency_s = latency_s;
        loop->state = LOOP_DONE;
        pthread_cond_broadcast(&loop->changed);
    }
    pthread_mutex_unlock(&loop->lock);
    return NULL;
}

static asdic_status allocate(asdic_loop *loop, size_t beams, bool truth) {
    size_t bins = asdic_simulator_bin_count(loop->simulator);
    for (int k = 0; k < 2; k++) {
        TRY(asdic_ping_create(loop->ctx, beams, bins, &loop->slots[k].ping));
        TRY(truth ? asdic_ping_add_truth(loop->ctx, loop->slots[k].ping) : ASDIC_OK);
        loop->slots[k].level_db = malloc(beams * bins * sizeof(float));
        if (!loop->slots[k].level_db) {
            return asdic_fail_memory(loop->ctx, "a loop's levels");
        }
    }
    return ASDIC_OK;
}

static asdic_status start_thread(asdic_loop *loop) {
    loop->has_lock = pthread_mutex_init(&loop->lock, NULL) == 0;
    if (!loop->has_lock || pthread_cond_init(&loop->changed, NULL) != 0) {
        return asdic_fail_memory(loop->ctx, "a loop's lock");
    }
    loop->has_thread = pthread_create(&loop->thread, NULL, work, loop) == 0;
    return loop->has_thread ? ASDIC_OK : asdic_fail_memory(loop->ctx, "a loop's thread");
}

asdic_status asdic_loop_create(asdic_context *ctx, asdic_device *device, const asdic_scene *scene,
                               const asdic_environment *env, const asdic_sonar *sonar,
                               const asdic_sampling *sampling, double depth_m, asdic_loop **out) {
    if (!out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_loop_create: nowhere to put it");
    }
    *out = NULL;
    asdic_loop *loop = calloc(1, sizeof *loop);
    if (!loop) {
        return asdic_fail_memory(ctx, "a loop");
    }
    loop->ctx = ctx;
    loop->scene = scene;
    asdic_status status =
        asdic_simulator_create(ctx, device, scene, env, sonar, sampling, depth_m, &loop->simulator);
    if (status) {
        goto fail;
    }
    asdic_simulator_hasten(loop->simulator);
    loop->ping_rate_hz = sonar->ping_rate_hz;
    if ((status = allocate(loop, sonar->receiver_count, sampling->truth)) != ASDIC_OK ||
        (status = start_thread(loop)) != ASDIC_OK) {
        goto fail;
    }
    *out = loop;
    return ASDIC_OK;
fail:
    asdic_loop_destroy(&loop);
    return status;
}

/* Room for the pressures that the mission's output holds. */
static asdic_status add_elements(asdic_loop *loop, const asdic_settings *settings) {
    size_t samples = asdic_simulator_sample_count(loop->simulator);
    for (int k = 0; k < 2 && settings->elements; k++) {
        TRY(asdic_ping_add_elements(loop->ctx, loop->slots[k].ping, settings->sonar.array.elements,
                                    samples));
    }
    return ASDIC_OK;
}

asdic_status asdic_loop_create_mission(asdic_context *ctx, asdic_device *device,
                                       const asdic_mission *mission, double depth_m, double start_s,
                                       asdic_loop **out) {
    if (!ASDIC_PLACE(out) || !mission || !isfinite(start_s)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "asdic_loop_create_mission: no mission, time or place for the loop");
    }
    asdic_sampling sampling = mission->settings.sampling;
    if (asdic_settings_rays_are_auto(
            &mission->settings)) { /* `auto` is for runs, which have time */
        sampling.rays = asdic_sampling_default().rays;
    }
    sampling.left_out = 0; /* nobody knows yet where the vehicle will go */
    TRY(asdic_loop_create(ctx, device, asdic_mission_scene(mission), &mission->settings.environment,
                          &mission->settings.sonar, &sampling, depth_m, out));
    (*out)->mission = mission;
    (*out)->start_s = start_s;
    asdic_status status = add_elements(*out, &mission->settings);
    if (status) {
        asdic_loop_destroy(out);
    }
    return status;
}

asdic_simulator *asdic_loop_simulator(const asdic_loop *loop) {
    return loop->simulator;
}

void asdic_loop_begin_at(asdic_loop *loop, uint64_t ping) {
    loop->first = loop->next = ping;
}

void asdic_loop_destroy(asdic_loop **pointer) {
    if (!pointer || !*pointer) {
        return;
    }
    asdic_loop *loop = *pointer;
    if (loop->has_thread) {
        pthread_mutex_lock(&loop->lock);
        while (loop->state == LOOP_SUBMITTED) {
            pthread_cond_wait(&loop->changed, &loop->lock);
        }
        loop->state = LOOP_CLOSING;
        pthread_cond_broadcast(&loop->changed);
        pthread_mutex_unlock(&loop->lock);
        pthread_join(loop->thread, NULL);
    }
    if (loop->has_lock) {
        pthread_cond_destroy(&loop->changed);
        pthread_mutex_destroy(&loop->lock);
    }
    for (int k = 0; k < 2; k++) {
        asdic_ping_destroy(&loop->slots[k].ping);
        free(loop->slots[k].level_db);
    }
    asdic_simulator_destroy(&loop->simulator);
    free(loop);
    *pointer = NULL;
}

size_t asdic_loop_bin_count(const asdic_loop *loop) {
    return loop ? asdic_simulator_bin_count(loop->simulator) : 0;
}

static asdic_status check_pose(asdic_loop *loop, const asdic_pose *pose) {
    TRY(asdic_pose_check(loop->ctx, pose));
    if (pose->position_m.z > 11000.0) {
        return asdic_fail(loop->ctx, ASDIC_ERROR_ARGUMENT,
                          "z = %g m is deeper than any sea; at most 11000 m", pose->position_m.z);
    }
    if (pose->position_m.z < 0.0) {
        return asdic_fail(loop->ctx, ASDIC_ERROR_ARGUMENT,
                          "a vehicle at z = %g m is above the sea surface; z is positive down",
                          pose->position_m.z);
    }
    return ASDIC_OK;
}

static loop_state state_of(asdic_loop *loop) {
    pthread_mutex_lock(&loop->lock);
    loop_state state = loop->state;
    pthread_mutex_unlock(&loop->lock);
    return state;
}

asdic_status asdic_loop_submit(asdic_loop *loop, const asdic_pose *pose) {
    if (!loop || !pose) {
        return asdic_fail(loop ? loop->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_loop_submit: NULL argument");
    }
    if (state_of(loop) != LOOP_IDLE) {
        return asdic_fail(loop->ctx, ASDIC_ERROR_ARGUMENT,
                          "ping %llu was submitted and not collected",
                          (unsigned long long)(loop->next - 1));
    }
    TRY(check_pose(loop, pose));
    loop->submitted_s = asdic_clock_s();
    loop->pose = *pose;
    loop->pose.roll_rad = asdic_track_round(pose->roll_rad);
    loop->pose.pitch_rad = asdic_track_round(pose->pitch_rad);
    loop->pose.yaw_rad = asdic_track_round(pose->yaw_rad);
    loop->next++;
    pthread_mutex_lock(&loop->lock);
    loop->state = LOOP_SUBMITTED;
    pthread_cond_broadcast(&loop->changed);
    pthread_mutex_unlock(&loop->lock);
    return ASDIC_OK;
}

bool asdic_loop_ready(asdic_loop *loop) {
    return loop && state_of(loop) == LOOP_DONE;
}

asdic_status asdic_loop_collect(asdic_loop *loop, asdic_loop_ping *out) {
    if (!loop || !out) {
        return asdic_fail(loop ? loop->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_loop_collect: NULL argument");
    }
    pthread_mutex_lock(&loop->lock);
    while (loop->state == LOOP_SUBMITTED) {
        pthread_cond_wait(&loop->changed, &loop->lock);
    }
    bool is_done = loop->state == LOOP_DONE;
    loop->state = LOOP_IDLE;
    pthread_mutex_unlock(&loop->lock);
    if (!is_done) {
        return asdic_fail(loop->ctx, ASDIC_ERROR_ARGUMENT, "no ping was submitted");
    }
    if (loop->status) {
        return loop->status;
    }
    uint64_t index = loop->next - 1;
    const loop_slot *slot = slot_of(loop, index);
    *out =
        (asdic_loop_ping){.ping = index,
                          .time_s = time_of(loop, index),
                          .pose = loop->pose,
                          .altitude_m = asdic_scene_altitude_m(loop->scene, loop->pose.position_m),
                          .latency_s = loop->latency_s,
                          .beams = slot->ping->beams,
                          .bins = slot->ping->bins,
                          .bin_length_m = slot->ping->bin_length_m,
                          .sweep = asdic_mission_sweep(loop->mission),
                          .level_db = slot->level_db,
                          .parts = slot->ping};
    return ASDIC_OK;
}

void asdic_loop_ping_place(const asdic_loop_ping *ping, asdic_expected_place *place) {
    place->pose = ping->pose;
    place->flat.has_bottom = isfinite(ping->altitude_m);
    place->flat.altitude_m = place->flat.has_bottom ? ping->altitude_m : 0.0;
    place->flat.depth_m = ping->pose.position_m.z;
}
