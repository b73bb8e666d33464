/*
 * Remarks on where rays that bend do not come: shadows, and rays that stay in the water.
 */
#include "mission.h"

#include "base/vec.h"
#include "sim/bent_ray.h"

#include <math.h>

/* Rays from -STEEPEST to STEEPEST; those nearer the horizontal decide. */
#define STEEPEST_RAD 0.5
#define RAYS 4001

/* A share of what straight rays reach that no ray reaches is no shadow: bins end there. */
#define SHADOW_SHARE 0.95

/* Of fewer degrees of elevation nothing is said: half a degree. */
#define TELLING_RAD 0.009

typedef enum water_end { STAYS, ON_BOTTOM, ON_SURFACE } water_end;

typedef struct water_ray {
    water_end end;
    double reach_m; /* horizontally */
    unsigned turns;
} water_ray;

static water_ray follow(const asdic_layers *layers, double depth_m, double elevation_rad,
                        double time_s) {
    asdic_bent_ray ray = asdic_bent_ray_start(layers, depth_m, elevation_rad);
    water_ray out = {STAYS, 0.0, 0};
    while (out.turns < 2) { /* then it turns for ever */
        int way;
        double exit_s = asdic_bent_ray_exit(layers, &ray, &way);
        bool in_time = ray.time_s + exit_s < time_s;
        asdic_bent_ray next = in_time ? asdic_bent_ray_at_plane(layers, &ray, exit_s, way)
                                      : asdic_bent_ray_later(layers, &ray, time_s - ray.time_s);
        out.turns += next.sine * ray.sine < 0.0;
        ray = next;
        if (!in_time) {
            break;
        }
        if (!asdic_bent_ray_cross(layers, &ray, way)) {
            out.end = way > 0 ? ON_BOTTOM : ON_SURFACE;
            break;
        }
    }
    out.reach_m = ray.level_spm * ray.area_m2_per_s;
    return out;
}

/* What a fan of rays tells. */
typedef struct fan_reach {
    double reach_m[3];                    /* the farthest, by end */
    double least_rad, most_rad;           /* elevations of those that turn twice: trapped */
    double turn_least_rad, turn_most_rad; /* ... that turn at all */
} fan_reach;

static void add_ray(const asdic_layers *layers, double depth_m, double elevation_rad, double time_s,
                    fan_reach *f) {
    water_ray ray = follow(layers, depth_m, elevation_rad, time_s);
    f->reach_m[ray.end] = fmax(f->reach_m[ray.end], ray.reach_m);
    if (ray.turns > 0) {
        f->turn_least_rad = fmin(f->turn_least_rad, elevation_rad);
        f->turn_most_rad = fmax(f->turn_most_rad, elevation_rad);
    }
    if (ray.turns > 1) {
        f->least_rad = fmin(f->least_rad, elevation_rad);
        f->most_rad = fmax(f->most_rad, elevation_rad);
    }
}

/* Even in the cube root of the elevation, and to both sides of those that graze a plane: the last
 * that reach a boundary. */
static fan_reach cast_fan(const asdic_layers *layers, double depth_m, double speed_mps,
                          double time_s) {
    fan_reach f = {{0.0, 0.0, 0.0}, INFINITY, -INFINITY, INFINITY, -INFINITY};
    for (int i = 0; i < RAYS; i++) {
        double x = 2.0 * (i + 0.5) / RAYS - 1.0;
        add_ray(layers, depth_m, STEEPEST_RAD * x * x * x, time_s, &f);
    }
    for (size_t i = 0; i < 2 * layers->count; i++) {
        const asdic_layer *layer = &layers->layer[i / 2];
        double plane_m = i % 2 ? layer->bottom_m : layer->top_m;
        double plane_mps = isfinite(plane_m) ? asdic_layer_speed_mps(layer, plane_m) : 0.0;
        for (int k = 0; k < 4 && plane_mps > speed_mps; k++) {
            double grazing = acos(speed_mps / plane_mps) + (k % 2 ? 1e-9 : -1e-9);
            add_ray(layers, depth_m, k < 2 ? grazing : -grazing, time_s, &f);
        }
    }
    return f;
}

/* Degrees, to a tenth. */
static double tenths(double rad) {
    return rint(rad * (1800.0 / ASDIC_PI)) / 10.0 + 0.0;
}

/* How far rays reach a plane AWAY_M above or below where they are straight; 0 where the fan is too flat. */
static double straight_reach_m(double away_m, double range_m) {
    return away_m < SHADOW_SHARE * sin(STEEPEST_RAD) * range_m
               ? sqrt((range_m - away_m) * (range_m + away_m))
               : 0.0;
}

void asdic_mission_remark_water(const asdic_mission *mission, asdic_remarks *out) {
    const asdic_environment *env = asdic_mission_environment(mission);
    if (!asdic_environment_bends(env)) {
        return;
    }
    asdic_flat_scene flat = asdic_mission_flat_scene(mission, 0);
    double speed_mps = asdic_environment_sound_speed_mps(env, flat.depth_m);
    double range_m = asdic_sonar_max_range_m(asdic_mission_sonar(mission), speed_mps);
    const struct {
        const char *name;
        water_end end;
        bool is_there;
        double away_m;
    } planes[] = {{"bottom", ON_BOTTOM, flat.has_bottom, flat.altitude_m},
                  {"surface", ON_SURFACE, flat.has_surface, flat.depth_m}};
    asdic_layers layers;
    asdic_layers_between(env, &flat, &layers);
    fan_reach f = cast_fan(&layers, flat.depth_m, speed_mps, range_m / speed_mps);
    for (size_t i = 0; i < 2; i++) {
        double reach_m = f.reach_m[planes[i].end];
        double straight_m = straight_reach_m(planes[i].away_m, range_m);
        bool is_short = reach_m < SHADOW_SHARE * straight_m;
        if (planes[i].is_there && is_short) {
            asdic_remark_add(
                out,
                "water: no ray of the first ping reaches the %s beyond %.4g m: a shadow begins "
                "there",
                planes[i].name, reach_m);
        }
    }
    bool turn = f.turn_most_rad - f.turn_least_rad > TELLING_RAD;
    bool trapped = f.most_rad - f.least_rad > TELLING_RAD;
    if (turn || trapped) {
        asdic_remark_add(
            out,
            "water: rays of the first ping that leave between %g and %g degrees below the "
            "horizontal %s",
            tenths(trapped ? f.least_rad : f.turn_least_rad),
            tenths(trapped ? f.most_rad : f.turn_most_rad),
            trapped ? "turn back and forth: trapped in a channel" : "turn before they end");
    }
}
