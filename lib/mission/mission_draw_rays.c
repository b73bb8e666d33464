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
#define POINTS 400

/* By where a ray ends: nowhere, on the bottom, on the surface. */
static const uint32_t colours[] = {0x808080, 0x8c510a, 0x2166ac};
static const char *const labels[] = {"rays that end nowhere within range",
                                     "rays that end on the bottom", "rays that end on the surface"};

typedef struct drawing {
    asdic_layers layers;
    double depth_m, time_s; /* of the sonar; of the last bin, one way */
    double x[RAYS + 2][POINTS], y[RAYS + 2][POINTS];
    asdic_series series[RAYS + 2];
    size_t count;
} drawing;

static void add_point(asdic_series *series, double *x, double *y, const asdic_bent_ray *ray) {
    if (series->count < POINTS) {
        x[series->count] = ray->level_spm * ray->area_m2_per_s;
        y[series->count++] = -ray->z_m;
    }
}

/* Follows a ray, with points that are even in time; returns where it ends, as colours. */
static int follow(const drawing *d, double elevation_rad, asdic_series *series, double *x,
                  double *y) {
    asdic_bent_ray ray = asdic_bent_ray_start(&d->layers, d->depth_m, elevation_rad);
    const double step_s = d->time_s / (POINTS / 2);
    add_point(series, x, y, &ray);
    while (series->count < POINTS) {
        int way;
        double exit_s = asdic_bent_ray_exit(&d->layers, &ray, &way);
        double end_s = fmin(exit_s, d->time_s - ray.time_s);
        for (double t = step_s; t < end_s; t += step_s) {
            asdic_bent_ray later = asdic_bent_ray_later(&d->layers, &ray, t);
            add_point(series, x, y, &later);
        }
        if (!(exit_s <= d->time_s - ray.time_s)) {
            ray = asdic_bent_ray_later(&d->layers, &ray, end_s);
            add_point(series, x, y, &ray);
            return 0;
        }
        ray = asdic_bent_ray_at_plane(&d->layers, &ray, exit_s, way);
        add_point(series, x, y, &ray);
        if (!asdic_bent_ray_cross(&d->layers, &ray, way)) {
            return way > 0 ? 1 : 2;
        }
    }
    return 0;
}

static void add_rays(drawing *d) {
    bool is_named[3] = {false, false, false};
    for (int i = 0; i < RAYS; i++) {
        asdic_series *series = &d->series[d->count];
        double *x = d->x[d->count], *y = d->y[d->count];
        *series = (asdic_series){.x = x, .y = y, .width = 1.0};
        int end = follow(d, (i - STEEPEST) * ASDIC_PI / 180.0, series, x, y);
        series->rgb = colours[end];
        series->label = is_named[end] ? NULL : labels[end];
        is_named[end] = true;
        d->count++;
    }
}

static void add_plane(drawing *d, double depth_m, double range_m, const char *label) {
    double *x = d->x[d->count], *y = d->y[d->count];
    x[0] = 0.0;
    x[1] = range_m;
    y[0] = y[1] = -depth_m;
    d->series[d->count++] =
        (asdic_series){.label = label, .x = x, .y = y, .count = 2, .rgb = 0x202020, .width = 2.5};
}

/* The depths that rays reach. */
static void find_depths(const drawing *d, double *low, double *high) {
    *low = *high = -d->depth_m;
    for (size_t i = 0; i < d->count; i++) {
        for (size_t k = 0; k < d->series[i].count; k++) {
            *low = fmin(*low, d->y[i][k]);
            *high = fmax(*high, d->y[i][k]);
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
        add_plane(d, 0.0, range_m, NULL);
    }
    if (flat.has_bottom) {
        add_plane(d, flat.depth_m + flat.altitude_m, range_m, NULL);
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
    free(name);
    free(d);
    return status;
}
