/*
 * What a chart shows: depths on a grid, outlines of objects seen from above, and where objects go.
 */
#ifndef ASDIC_BASE_RELIEF_H
#define ASDIC_BASE_RELIEF_H

#include <asdic/common.h>

/* Depths at the centres of square cells, rows from north to south; NAN where there is nothing. */
typedef struct asdic_relief {
    size_t columns, rows;
    double west_m, south_m; /* outer edges */
    double cell_m;
    float *depth_m;  /* [row * columns + column] */
    bool *is_object; /* the same: an object, not the bottom; NULL: bottom alone */
} asdic_relief;

/* Sides enough for a circle that looks round at the size of an object on a chart. */
#define ASDIC_OUTLINE_SIDES 24

/* A convex ring, clockwise on the chart; of one point when COUNT is 1. */
typedef struct asdic_outline {
    char name[ASDIC_NAME_SIZE];
    size_t count;
    double north_m[ASDIC_OUTLINE_SIDES], east_m[ASDIC_OUTLINE_SIDES];
} asdic_outline;

typedef struct asdic_route_point {
    double time_s, north_m, east_m, yaw_rad;
} asdic_route_point;

/* Where the object NAME goes, in the order of time; the points are borrowed. */
typedef struct asdic_route {
    char name[ASDIC_NAME_SIZE];
    const asdic_route_point *points;
    size_t count;
} asdic_route;

#endif
