/*
 * A chase camera: pictures of the scene, cast through the hierarchy that traces sound, or where that bends through
 * one of its own. It uses the simulator between pings.
 */
#ifndef ASDIC_LIVE_CAMERA_H
#define ASDIC_LIVE_CAMERA_H

#include "sim/simulator.h"

#include "../../kernels/camera_types.h"

typedef struct asdic_camera asdic_camera;

asdic_status asdic_camera_create(asdic_context *ctx, asdic_device *device, unsigned width,
                                 unsigned height, asdic_camera **out);
void asdic_camera_destroy(asdic_camera **camera);

/* What is to be seen. */
typedef struct asdic_shot {
    asdic_vec3 eye_m;          /* world */
    double yaw_rad, pitch_rad; /* where the camera looks; positive pitch up */
    const asdic_pose *vehicle; /* drawn when it is there; the beams begin there */
    double range_m;            /* of the sonar */
    double time_s;
    unsigned cones;
    dev_cone_view cone[DEV_CAMERA_CONES];
} asdic_shot;

asdic_status asdic_camera_shoot(asdic_camera *camera, asdic_simulator *sim, const asdic_shot *shot);

/* The last picture: WIDTH x HEIGHT of 0x00RRGGBB, and the distance of what each pixel shows, m. */
const uint32_t *asdic_camera_rgb(const asdic_camera *camera);
const float *asdic_camera_far_m(const asdic_camera *camera);

/* Where the last picture shows a point of the world, in pixels, and its distance, m. False when it is
 * behind the camera. */
bool asdic_camera_project(const asdic_camera *camera, asdic_vec3 at_m, double *x, double *y,
                          double *far_m);

#endif
