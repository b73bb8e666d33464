/*
 * What the camera is told: shared by host and device, see types.h.
 */
#ifndef ASDIC_KERNEL_CAMERA_TYPES_H
#define ASDIC_KERNEL_CAMERA_TYPES_H

#include "types.h"

#define DEV_CAMERA_CONES 9
/* Pixels are traced tile by tile, so that neighbours in memory look the same way. */
#define DEV_CAMERA_TILE 8

/* A beam to be seen: a cone of elliptical cross-section. */
typedef struct dev_cone_view {
    float
        rows[9]; /* world to (along the axis, horizontal, vertical), the latter over the tangents of
                      the half-widths: the edge of the cone lies at 1 */
    float eye[3]; /* the camera seen from the sonar, so turned */
    float rgb[3];
    float strength;
} dev_cone_view; /* 64 bytes */

/* Lengths in m in the scene frame: world axes, recentred. */
typedef struct dev_camera {
    float eye[3], right[3], down[3], ahead[3];
    float tan_x, tan_y; /* half the field of view */
    dev_uint width, height;
    float far_m;     /* rays end here */
    float surface_z; /* of the plane; -INFINITY: none */
    float bottom_z;  /* INFINITY: none */
    float sea_level_z;
    float fog_per_m[3];
    float fog_rgb[3];
    float grid_origin[2]; /* scene frame of a grid line's crossing */
    float grid_m;
    float sonar[3];      /* where the cones begin */
    float range_m;       /* and how far they reach */
    float body_rows[9];  /* world to vehicle */
    float body_length_m; /* 0: no vehicle */
    float body_radius_m;
    float body_eye[3]; /* the camera seen from the vehicle, in its axes */
    float time_s;      /* for waves */
    dev_uint cones;
    float pad[3];
    dev_cone_view cone[DEV_CAMERA_CONES];
} dev_camera;

#endif
