#include "camera.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FIELD_OF_VIEW_RAD 1.15 /* from side to side */
#define GRID_M 10.0
/* Visibility follows the sonar's range: what it hears is visible, dim at the far end. */
#define FOG_RED 3.6
#define FOG_GREEN 1.7
#define FOG_BLUE 1.4

struct asdic_camera {
    asdic_context *ctx;
    unsigned width, height;
    size_t slots; /* rays, whole tiles */
    asdic_kernel *aim, *shade;
    asdic_buffer *settings, *rays, *hits, *rgb_buffer, *far_buffer;
    uint32_t *rgb;
    float *far_m;
    dev_camera last;
    asdic_vec3 origin_m; /* of the last picture's frame */
};

static asdic_status create_on_device(asdic_camera *c, asdic_device *device) {
    size_t pixels = (size_t)c->width * c->height;
    const struct {
        size_t bytes;
        asdic_buffer **buffer;
    } wanted[] = {{sizeof(dev_camera), &c->settings},
                  {c->slots * sizeof(dev_ray), &c->rays},
                  {c->slots * sizeof(dev_hit), &c->hits},
                  {pixels * sizeof(uint32_t), &c->rgb_buffer},
                  {pixels * sizeof(float), &c->far_buffer}};
    TRY(asdic_kernel_create(device, "camera.cl", "", "camera_rays", &c->aim));
    TRY(asdic_kernel_create(device, "camera.cl", "", "camera_shade", &c->shade));
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        TRY(asdic_buffer_create(device, wanted[i].bytes, NULL, wanted[i].buffer));
    }
    return ASDIC_OK;
}

asdic_status asdic_camera_create(asdic_context *ctx, asdic_device *device, unsigned width,
                                 unsigned height, asdic_camera **out) {
    *out = NULL;
    asdic_camera *c = calloc(1, sizeof *c);
    if (!c) {
        return asdic_fail_memory(ctx, "a camera");
    }
    size_t tiles_x = (width + DEV_CAMERA_TILE - 1) / DEV_CAMERA_TILE;
    size_t tiles_y = (height + DEV_CAMERA_TILE - 1) / DEV_CAMERA_TILE;
    c->ctx = ctx;
    c->width = width;
    c->height = height;
    c->slots = tiles_x * tiles_y * DEV_CAMERA_TILE * DEV_CAMERA_TILE;
    c->rgb = calloc((size_t)width * height, sizeof *c->rgb);
    c->far_m = calloc((size_t)width * height, sizeof *c->far_m);
    asdic_status status = c->rgb && c->far_m ? create_on_device(c, device)
                                             : asdic_fail_memory(ctx, "a camera's picture");
    if (status) {
        asdic_camera_destroy(&c);
    }
    *out = c;
    return status;
}

void asdic_camera_destroy(asdic_camera **pointer) {
    if (!pointer || !*pointer) {
        return;
    }
    asdic_camera *c = *pointer;
    asdic_buffer **buffers[] = {&c->settings, &c->rays, &c->hits, &c->rgb_buffer, &c->far_buffer};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
        asdic_buffer_destroy(buffers[i]);
    }
    asdic_kernel_destroy(&c->aim);
    asdic_kernel_destroy(&c->shade);
    free(c->rgb);
    free(c->far_m);
    free(c);
    *pointer = NULL;
}

static void put(float out[3], asdic_vec3 v) {
    out[0] = (float)v.x;
    out[1] = (float)v.y;
    out[2] = (float)v.z;
}

static double along(const float axis[3], asdic_vec3 v) {
    return (double)axis[0] * v.x + (double)axis[1] * v.y + (double)axis[2] * v.z;
}

static void place_eye(const asdic_camera *c, const asdic_shot *shot, asdic_vec3 origin_m,
                      dev_camera *d) {
    asdic_mat3 turn = asdic_mat3_attitude(0.0, shot->pitch_rad, shot->yaw_rad);
    put(d->eye, asdic_vec3_sub(shot->eye_m, origin_m));
    put(d->ahead, asdic_mat3_apply(turn, (asdic_vec3){1.0, 0.0, 0.0}));
    put(d->right, asdic_mat3_apply(turn, (asdic_vec3){0.0, 1.0, 0.0}));
    put(d->down, asdic_mat3_apply(turn, (asdic_vec3){0.0, 0.0, 1.0}));
    d->tan_x = (float)tan(0.5 * FIELD_OF_VIEW_RAD);
    d->tan_y = d->tan_x * (float)c->height / (float)c->width;
}

static void place_vehicle(const asdic_shot *shot, asdic_vec3 origin_m, dev_camera *d) {
    const asdic_pose *pose = shot->vehicle;
    asdic_mat3 turn = asdic_mat3_of(pose);
    put(d->sonar, asdic_vec3_sub(pose->position_m, origin_m));
    for (int row = 0; row < 3; row++) { /* world to body is the transpose */
        for (int column = 0; column < 3; column++) {
            d->body_rows[3 * row + column] = (float)turn.m[column][row];
        }
    }
    asdic_vec3 eye = asdic_mat3_apply_inverse(turn, asdic_vec3_sub(shot->eye_m, pose->position_m));
    put(d->body_eye, eye);
    for (unsigned k = 0; k < d->cones; k++) { /* and as each beam sees it */
        dev_cone_view *cone = &d->cone[k];
        asdic_vec3 from = asdic_vec3_sub(shot->eye_m, pose->position_m);
        for (int row = 0; row < 3; row++) {
            cone->eye[row] = (float)along(cone->rows + 3 * row, from);
        }
    }
    /* Drawn larger than it is where the view is wide, so that it stays visible. */
    d->body_length_m = (float)fmax(1.6, 0.032 * shot->range_m);
    d->body_radius_m = 0.075f * d->body_length_m;
}

static dev_camera describe(const asdic_camera *c, const asdic_scene *scene,
                           const asdic_shot *shot) {
    asdic_vec3 origin_m = c->origin_m;
    dev_camera d = {
        .width = c->width,
        .height = c->height,
        .far_m = (float)(3.0 * shot->range_m),
        .surface_z = scene->has_surface ? (float)-origin_m.z : -INFINITY,
        .bottom_z =
            scene->has_bottom_plane ? (float)(scene->bottom_plane_depth_m - origin_m.z) : INFINITY,
        .sea_level_z = (float)-origin_m.z,
        .fog_per_m = {(float)(FOG_RED / shot->range_m), (float)(FOG_GREEN / shot->range_m),
                      (float)(FOG_BLUE / shot->range_m)},
        .fog_rgb = {0.012f, 0.105f, 0.150f},
        .grid_m = GRID_M,
        .grid_origin = {(float)-remainder(origin_m.x, GRID_M),
                        (float)-remainder(origin_m.y, GRID_M)},
        .range_m = (float)shot->range_m,
        .time_s = (float)fmod(shot->time_s, 1000.0),
        .cones = shot->vehicle ? shot->cones : 0};
    memcpy(d.cone, shot->cone, sizeof d.cone);
    place_eye(c, shot, origin_m, &d);
    if (shot->vehicle) {
        place_vehicle(shot, origin_m, &d);
    }
    return d;
}

#define COUNT(args) (sizeof(args) / sizeof *(args))

asdic_status asdic_camera_shoot(asdic_camera *c, asdic_simulator *sim, const asdic_shot *shot) {
    size_t pixels = (size_t)c->width * c->height;
    asdic_tracer *tracer;
    TRY(asdic_simulator_look(sim, &tracer));
    dev_uint has_mesh = tracer != NULL;
    asdic_buffer *triangles =
        tracer ? asdic_tracer_triangles(tracer) : asdic_simulator_triangles(sim);
    c->origin_m = sim->placement->origin_m;
    c->last = describe(c, sim->setup.scene, shot);
    asdic_kernel_arg aim[] = {ASDIC_ARG_BUFFER(c->settings), ASDIC_ARG_BUFFER(c->rays)};
    asdic_kernel_arg shade[] = {ASDIC_ARG_BUFFER(c->settings),
                                ASDIC_ARG_BUFFER(c->hits),
                                ASDIC_ARG_VALUE(has_mesh),
                                ASDIC_ARG_BUFFER(triangles),
                                ASDIC_ARG_BUFFER(sim->buffers.parts),
                                ASDIC_ARG_BUFFER(c->rgb_buffer),
                                ASDIC_ARG_BUFFER(c->far_buffer)};
    TRY(asdic_buffer_write(c->settings, 0, sizeof c->last, &c->last));
    if (has_mesh) {
        uint32_t slots = (uint32_t)c->slots;
        TRY(asdic_kernel_run(c->aim, aim, COUNT(aim), c->slots, 64));
        TRY(asdic_tracer_run(tracer, c->rays, c->hits, slots, slots, 0));
    }
    TRY(asdic_kernel_run(c->shade, shade, COUNT(shade), c->slots, 64));
    TRY(asdic_buffer_read(c->rgb_buffer, 0, pixels * sizeof(uint32_t), c->rgb));
    return asdic_buffer_read(c->far_buffer, 0, pixels * sizeof(float), c->far_m);
}

const uint32_t *asdic_camera_rgb(const asdic_camera *camera) {
    return camera->rgb;
}

const float *asdic_camera_far_m(const asdic_camera *camera) {
    return camera->far_m;
}

bool asdic_camera_project(const asdic_camera *c, asdic_vec3 at_m, double *x, double *y,
                          double *far_m) {
    const dev_camera *d = &c->last;
    asdic_vec3 eye_m = {(double)d->eye[0], (double)d->eye[1], (double)d->eye[2]};
    asdic_vec3 v = asdic_vec3_sub(asdic_vec3_sub(at_m, c->origin_m), eye_m);
    double ahead = along(d->ahead, v);
    *far_m = asdic_vec3_length(v);
    if (ahead < 0.3) {
        return false;
    }
    *x = 0.5 * c->width * (1.0 + along(d->right, v) / (ahead * (double)d->tan_x));
    *y = 0.5 * c->height * (1.0 + along(d->down, v) / (ahead * (double)d->tan_y));
    return true;
}
