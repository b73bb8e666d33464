/*
 * A picture of rays over range and depth.
 */
#include "mission.h"

#include <asdic/output.h>

#include "base/context.h"
#include "base/vec.h"
#include "sim/bent_ray.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Rays from -STEEPEST to STEEPEST degrees of elevation, one a degree. */
#define STEEPEST 20
#define RAYS (2 * STEEPEST + 1)
/* Of a ray, evenly in time; besides there is one where it enters another layer. */
#define POINTS 200

/* By where a ray ends: nowhere, on the bottom, on the surface. */
static const uint32_t colours[] = {0x808080, 0x8c510a, 0x2166ac};
static const char *const labels[] = {"rays that end nowhere within range",
                                     "rays that end on the bottom", "rays that end on the surface"};

/* In a sound channel a ray may enter layers without end. */
typedef struct line {
    double *x, *y;
    size_t count, room;
} line;

typedef struct drawing {
    asdic_layers layers;
    double depth_m, time_s; /* of the sonar; of the last bin, one way */
    line lines[RAYS + 2];
    asdic_series series[RAYS + 2];
    size_t count;
    bool is_memory_short;
} drawing;

static void add_point(drawing *d, double x, double y) {
    line *l = &d->lines[d->count];
    if (l->count == l->room) {
        size_t room = l->room ? 2 * l->room : POINTS;
        double *more_x = realloc(l->x, room * sizeof *l->x);
        l->x = more_x ? more_x : l->x;
        double *more_y = realloc(l->y, room * sizeof *l->y);
        l->y = more_y ? more_y : l->y;
        d->is_memory_short = d->is_memory_short || !more_x || !more_y;
        l->room = d->is_memory_short ? l->room : room;
    }
    if (!d->is_memory_short) {
        l->x[l->count] = x;
        l->y[l->count++] = y;
    }
}

static void add_place(drawing *d, const asdic_bent_ray *ray) {
    add_point(d, ray->level_spm * ray->area_m2_per_s, -ray->z_m);
}

/* The line of these points. */
static void add_series(drawing *d, const char *label, uint32_t rgb, double width) {
    const line *l = &d->lines[d->count];
    d->series[d->count++] = (asdic_series){
        .label = label, .x = l->x, .y = l->y, .count = l->count, .rgb = rgb, .width = width};
}

/* Follows a ray, with points that are even in time; returns where it ends, as colours. */
static int follow(drawing *d, double elevation_rad) {
    asdic_bent_ray ray = asdic_bent_ray_start(&d->layers, d->depth_m, elevation_rad);
    const double step_s = d->time_s / POINTS;
    add_place(d, &ray);
    for (;;) {
        int way;
        double exit_s = asdic_bent_ray_exit(&d->layers, &ray, &way);
        double end_s = fmin(exit_s, d->time_s - ray.time_s);
        for (double t = step_s; t < end_s; t += step_s) {
            asdic_bent_ray later = asdic_bent_ray_later(&d->layers, &ray, t);
            add_place(d, &later);
        }
        if (!(exit_s <= d->time_s - ray.time_s)) {
            ray = asdic_bent_ray_later(&d->layers, &ray, end_s);
            add_place(d, &ray);
            return 0;
        }
        ray = asdic_bent_ray_at_plane(&d->layers, &ray, exit_s, way);
        add_place(d, &ray);
        if (!asdic_bent_ray_cross(&d->layers, &ray, way)) {
            return way > 0 ? 1 : 2;
        }
    }
}

static void add_rays(drawing *d) {
    bool is_named[3] = {false, false, false};
    for (int i = 0; i < RAYS; i++) {
        int end = follow(d, (i - STEEPEST) * ASDIC_PI / 180.0);
        add_series(d, is_named[end] ? NULL : labels[end], colours[end], 1.0);
        is_named[end] = true;
    }
}

static void add_plane(drawing *d, double depth_m, double range_m) {
    add_point(d, 0.0, -depth_m);
    add_point(d, range_m, -depth_m);
    add_series(d, NULL, 0x202020, 2.5);
}

/* The depths that rays reach. */
static void find_depths(const drawing *d, double *low, double *high) {
    *low = *high = -d->depth_m;
    for (size_t i = 0; i < d->count; i++) {
        for (size_t k = 0; k < d->series[i].count; k++) {
            *low = fmin(*low, d->lines[i].y[k]);
            *high = fmax(*high, d->lines[i].y[k]);
        }
    }
    double margin = fmax(0.05 * (*high - *low), 0.1);
    *low -= margin;
    *high += margin;
}

asdic_status asdic_mission_draw_rays(asdic_context *ctx, const asdic_mission *mission, size_t index,
                                     const char *path) {
    if (!mission || !path) {
        return asdic_fail_null(ctx, __func__);
    }
    if (index >= asdic_mission_ping_count(mission)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "ping %zu of a mission of %zu", index,
                          asdic_mission_ping_count(mission));
    }
    drawing *d = calloc(1, sizeof *d);
    char *name = asdic_scene_name(mission->path), title[512];
    asdic_status status = ASDIC_OK;
    if (!d || !name) {
        status = asdic_fail_memory(ctx, "a picture of rays");
        goto done;
    }
    const asdic_environment *env = asdic_mission_environment(mission);
    const asdic_sonar *sonar = asdic_mission_sonar(mission);
    asdic_flat_scene flat = asdic_mission_flat_scene(mission, index);
    double speed_mps = asdic_environment_sound_speed_mps(env, flat.depth_m), low, high;
    double range_m = asdic_sonar_max_range_m(sonar, speed_mps);
    asdic_picture_options look = asdic_picture_options_default();
    d->depth_m = flat.depth_m;
    d->time_s = range_m / speed_mps;
    asdic_layers_between(env, &flat, &d->layers);
    add_rays(d);
    if (flat.has_surface) {
        add_plane(d, 0.0, range_m);
    }
    if (flat.has_bottom) {
        add_plane(d, flat.depth_m + flat.altitude_m, range_m);
    }
    if (d->is_memory_short) {
        status = asdic_fail_memory(ctx, "a picture of rays");
        goto done;
    }
    find_depths(d, &low, &high);
    const asdic_plot plot = {
        .x = {.label = "horizontal range (m)", .high = range_m},
        .y = {.label = "height above the sea surface (m)", .low = low, .high = high},
        .series = d->series,
        .series_count = d->count};
    snprintf(title, sizeof title,
             "%s: rays from %.4g m, %d to %d degrees\nsound speed there %.1f m/s; flat bottom as "
             "below the sonar",
             name, flat.depth_m, -STEEPEST, STEEPEST, speed_mps);
    look.title = title;
    status = asdic_picture_plot(ctx, path, &plot, 1, &look);
done:
    for (size_t i = 0; d && i < RAYS + 2; i++) {
        free(d->lines[i].x);
        free(d->lines[i].y);
    }
    free(name);
    free(d);
    return status;
}
