/*
 * The loop: a simulator inside somebody else's clock. Submit a pose, go on with other work,
 * collect the ping. A thread of the loop's own simulates; nothing here waits but collect.
 *
 *     asdic_loop_submit(loop, &pose);
 *     ... steer, draw, talk to others ...
 *     asdic_loop_collect(loop, &ping);        (ping.level_db[beam * ping.bins + bin])
 *
 * Pings are numbered from 0 and learn as a mission's do (asdic/ping.h): a mission whose track holds
 * the submitted poses, one every 1 / ping_rate_hz, and whose scene has
 * `model: {terms: all, refraction: full}`, gives the same bytes: nothing is planned here.
 */
#ifndef ASDIC_LOOP_H
#define ASDIC_LOOP_H

#include <asdic/expected.h>
#include <asdic/mission.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_loop asdic_loop;

/* A ping as it leaves the loop; what it points to is valid until the next collect. */
typedef struct asdic_loop_ping {
    uint64_t ping;     /* its number */
    double time_s;     /* simulated: of the first ping, plus ping / ping_rate_hz */
    asdic_pose pose;   /* as submitted, angles in whole nanodegrees, as track files hold them */
    double altitude_m; /* above the bottom straight below; INFINITY where there is none */
    double latency_s;  /* from submit to levels */
    size_t beams, bins;
    double bin_length_m;
    asdic_sweep sweep;       /* of a scanned sonar's head, which is in the direction of PING */
    const float *level_db;   /* total, dB re 1 uPa, NAN without energy, [beam * bins + bin] */
    const asdic_ping *parts; /* everything else, linear */
} asdic_loop_ping;

/* As asdic_simulator_create: SCENE and DEVICE must outlive the loop, the rest is copied. DEVICE
 * belongs to the loop whenever a ping is submitted and not collected; in between the caller may
 * use it. */
ASDIC_API asdic_status asdic_loop_create(asdic_context *ctx, asdic_device *device,
                                         const asdic_scene *scene, const asdic_environment *env,
                                         const asdic_sonar *sonar, const asdic_sampling *sampling,
                                         double depth_m, asdic_loop **out);

/* The same for what a mission describes, all of its terms, and its moving objects where they are
 * when the first ping happens at START_S. Where the scene says `rays: auto`, as many as of
 * asdic_sampling_default, so that pings come in time. Where its output has them, pings hold
 * truth and the pressure at every element. The mission must outlive the loop. */
ASDIC_API asdic_status asdic_loop_create_mission(asdic_context *ctx, asdic_device *device,
                                                 const asdic_mission *mission, double depth_m,
                                                 double start_s, asdic_loop **out);

/* Waits for a ping that is being simulated. */
ASDIC_API void asdic_loop_destroy(asdic_loop **loop);

/* Range bins of a beam, fixed when the loop was made; 0 for NULL. */
ASDIC_API size_t asdic_loop_bin_count(const asdic_loop *loop);

/* Starts the next ping at POSE and returns at once. ASDIC_ERROR_ARGUMENT when the ping before was
 * not collected, or POSE is not finite or above the sea surface. From below the bottom
 * (asdic_mission_bottom_m), which the caller may refuse, there is none in its altitude. */
ASDIC_API asdic_status asdic_loop_submit(asdic_loop *loop, const asdic_pose *pose);

/* Whether collect would not wait. */
ASDIC_API bool asdic_loop_ready(asdic_loop *loop);

/* Waits for the submitted ping; its failure is returned here. ASDIC_ERROR_ARGUMENT when none was
 * submitted. */
ASDIC_API asdic_status asdic_loop_collect(asdic_loop *loop, asdic_loop_ping *out);

/* Puts the vehicle of PLACE where PING was: what asdic_expected_compute then gives has no
 * object. */
ASDIC_API void asdic_loop_ping_place(const asdic_loop_ping *ping, asdic_expected_place *place);

#ifdef __cplusplus
}
#endif

#endif
