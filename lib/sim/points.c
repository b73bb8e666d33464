#include "points.h"

#include "base/context.h"
#include "base/grow.h"
#include "base/try.h"
#include "base/vec.h"
#include "passage.h"
#include "ring.h"
#include "scene/scene.h"
#include "sonar_ray.h"
#include "truth.h"

#include "../../kernels/beam.h"

#include <math.h>
#include <stdlib.h>

/* The ray to a point ends just before it, so that a point on a body's skin is seen. */
#define SHORT_OF_POINT 0.9999
/* A point at the sonar itself, m, is not heard. */
#define NEAREST 1e-9

/* A way from the sonar to a point, and what of its rays is traced. */
struct asdic_point_path {
    size_t point;
    triple u; /* at the sonar */
    double range_m;
    double loss; /* of what goes out and comes back on it, re the source at 1 m */
    asdic_path by;
    size_t first_ray, ray_count;
};

void asdic_points_finish(asdic_simulator *sim) {
    asdic_buffer_destroy(&sim->points.ray_buffer);
    asdic_buffer_destroy(&sim->points.hit_buffer);
    free(sim->points.paths);
    free(sim->points.rays);
    free(sim->points.hits);
}

/* Makes room for a path more and its RAYS. */
static asdic_status make_room(asdic_simulator *sim, size_t rays) {
    asdic_point_rays *p = &sim->points;
    if (!asdic_grow(&p->paths, p->path_count, &p->path_capacity, sizeof *p->paths)) {
        return asdic_fail_memory(sim->ctx, "point targets");
    }
    size_t needed = p->ray_count + rays, hits = p->ray_capacity, capacity = p->ray_capacity;
    if (needed > capacity) {
        asdic_buffer_destroy(&p->ray_buffer);
        asdic_buffer_destroy(&p->hit_buffer);
    }
    if (!asdic_reserve(&p->rays, needed, &capacity, sizeof *p->rays) ||
        !asdic_reserve(&p->hits, needed, &hits, sizeof *p->hits)) {
        return asdic_fail_memory(sim->ctx, "point targets");
    }
    p->ray_capacity = capacity;
    return ASDIC_OK;
}

static void add_ray(asdic_point_rays *p, triple origin, triple along, double t_max) {
    p->hits[p->ray_count] = (dev_hit){INFINITY, ~0u};
    p->rays[p->ray_count++] =
        (dev_ray){.origin = {(float)origin.x, (float)origin.y, (float)origin.z},
                  .t_max = (float)t_max,
                  .direction = {(float)along.x, (float)along.y, (float)along.z}};
}

/* ---- One layer, or none ---- */

/* How far a ray may pass beyond a plane, m: points that lie in one are rounded. */
#define BEYOND_PLANE 1e-3

/* Whether the arc TO keeps between surface and bottom plane on its way, from a sonar FROM_M deep. */
static bool keeps_in_water(const asdic_scene *scene, double from_m, const ray_way *to) {
    double up = fmax(from_m, 0.0) + BEYOND_PLANE;
    double down = fmax(scene->bottom_plane_depth_m - from_m, 0.0) + BEYOND_PLANE;
    return !(scene->has_surface && ray_to_plane(up, -to->r.u.z, -to->r.bend) < to->t) &&
           !(scene->has_bottom_plane && ray_to_plane(down, to->r.u.z, to->r.bend) < to->t);
}

static asdic_status add_path(asdic_simulator *sim, size_t nth, const asdic_ping_shot *shot) {
    TRY(make_room(sim, 1));
    asdic_vec3 to_m = sim->placement->points[nth].position_m;
    asdic_vec3 at = asdic_vec3_sub(shot->pose.position_m, sim->placement->origin_m);
    ray_way to = asdic_sonar_ray(shot->ping, asdic_vec3_sub(to_m, shot->pose.position_m), NEAREST);
    if (!(to.t > NEAREST) ||
        (to.r.bend != 0.0 && !keeps_in_water(sim->setup.scene, shot->pose.position_m.z, &to))) {
        return ASDIC_OK;
    }
    double absorption = shot->water.absorption_np_per_m;
    double range = ray_range(&to.r, to.t), spread = range / to.t;
    double loss = asdic_simulator_source_lin(sim, &shot->water) *
                  ray_transmission(absorption, range) * spread * spread *
                  ray_bending(&to.r, to.t, range, -2.0 * absorption);
    sim->points.paths[sim->points.path_count++] =
        (asdic_point_path){nth, to.r.u, range, loss, ASDIC_PATH_DIRECT, sim->points.ray_count, 1};
    const ray_medium water = {sim->setup.bend_per_m, 1.0};
    to.r.from = (triple){at.x, at.y, at.z};
    add_ray(&sim->points, ray_lift(to.r.from, water), ray_traced(&to.r, water),
            SHORT_OF_POINT * to.t);
    return ASDIC_OK;
}

/* ---- Layers, and planes that mirror ---- */

/* The frame of layer NUMBER's triangles (scene/lifted.h). */
static ray_medium medium_of(const asdic_simulator *sim, size_t number, double *shift_m) {
    size_t count = sim->setup.layer_count;
    *shift_m = 0.0;
    if (count == 0) {
        return (ray_medium){sim->setup.bend_per_m, 1.0};
    }
    /* Triangles below the bottom plane are in the last layer above it. */
    const dev_layer *layer = &sim->setup.layers[number < count ? number : count - 1];
    *shift_m = layer->shift_m;
    return (ray_medium){layer->bend_per_m, 1.0};
}

/* Where a ray Z_M deep in LAYER is in the water. */
static double fold(const asdic_passage *p, const asdic_layer *layer, double z_m) {
    return layer->image ? 2.0 * p->plane_m - z_m : z_m;
}

/* LEGS of EIGENRAY in the direction LEVEL, COUNT of them, each as its layer's triangles see it. */
static void add_legs(asdic_simulator *sim, const asdic_passage *p, const asdic_vec3 *from_m,
                     const asdic_vec3 *level, const asdic_eigenray *eigenray,
                     const asdic_eigenray_leg *legs, size_t count) {
    asdic_vec3 at = asdic_vec3_sub(*from_m, sim->placement->origin_m);
    triple begin = {at.x, at.y, at.z};
    for (size_t i = 0; i < count; i++) {
        const asdic_layer *layer = &p->layers.layer[legs[i].layer];
        double shift_m;
        const ray_medium water = medium_of(sim, layer->number, &shift_m);
        triple end = {at.x + level->x * legs[i].across_m, at.y + level->y * legs[i].across_m,
                      fold(p, layer, legs[i].z_m) - sim->placement->origin_m.z};
        triple a = ray_lift(begin, water), b = ray_lift(end, water);
        triple along = {b.x - a.x, b.y - a.y, b.z - a.z};
        double length = sqrt(dot3(along, along)), scale = 1.0 / fmax(length, NEAREST);
        double cut = i + 1 < count ? 0.0 : (1.0 - SHORT_OF_POINT) * eigenray->end.length_m;
        a.z += shift_m;
        add_ray(&sim->points, a, (triple){along.x * scale, along.y * scale, along.z * scale},
                fmax(length - cut, 0.0));
        begin = end;
    }
}

/* How often a ray of LEGS meets the plane that mirrors. */
static int bounces(const asdic_passage *p, double from_m, const asdic_eigenray_leg *legs,
                   size_t count) {
    int met = from_m == p->plane_m;
    for (size_t i = 0; i < count; i++) {
        bool last = i + 1 == count;
        met += legs[i].z_m == p->plane_m && (last || p->layers.layer[legs[i].layer].image !=
                                                         p->layers.layer[legs[i + 1].layer].image);
    }
    return met;
}

/* The share of the energy that the plane sends on. */
static double mirrored(const asdic_passage *p, const asdic_eigenray *found) {
    const asdic_layers *layers = &p->layers;
    const asdic_layer *layer = &layers->layer[asdic_layers_find(layers, p->plane_m)];
    double cosine = found->end.level_spm * asdic_layer_speed_mps(layer, p->plane_m);
    return p->mirror->material.law->reflected(p->mirror,
                                              sqrt(fmax((1.0 - cosine) * (1.0 + cosine), 0.0)));
}

static asdic_status add_eigenrays(asdic_simulator *sim, const asdic_passage *p, size_t nth,
                                  const asdic_ping_shot *shot) {
    const asdic_vec3 from = shot->pose.position_m, to = sim->placement->points[nth].position_m;
    double x = to.x - from.x, y = to.y - from.y, across = hypot(x, y);
    asdic_vec3 level = {across > 0.0 ? x / across : 1.0, across > 0.0 ? y / across : 0.0, 0.0};
    double minus_2k = -2.0 * shot->water.absorption_np_per_m;
    asdic_eigenray rays[ASDIC_MOST_EIGENRAYS];
    size_t count = asdic_passage_rays(p, from.z, asdic_passage_depth_m(p, to.z), across, rays);
    count = asdic_passage_waves(p, from.z, across, shot->water.wavelength_m, rays, count);
    for (size_t i = 0; i < count; i++) {
        const asdic_eigenray *found = &rays[i];
        double range = shot->water.sound_speed_mps * found->end.time_s;
        double spread = asdic_bent_ray_limited_m2(&found->end, range);
        if (!(range > NEAREST)) {
            continue;
        }
        asdic_eigenray_leg legs[ASDIC_MOST_EIGENRAY_LEGS];
        size_t leg_count = asdic_eigenray_legs(&p->layers, from.z, across, found, legs);
        if (p->mirror && bounces(p, from.z, legs, leg_count) != 1) {
            continue;
        }
        double share = p->mirror ? mirrored(p, found) : 1.0;
        double loss = asdic_simulator_source_lin(sim, &shot->water) * share * share *
                      exp(minus_2k * (found->end.length_m - 1.0)) / (spread * spread);
        double cosine = cos(found->elevation_rad);
        triple u = {cosine * level.x, cosine * level.y, sin(found->elevation_rad)};
        TRY(make_room(sim, leg_count));
        sim->points.paths[sim->points.path_count++] =
            (asdic_point_path){nth, u, range, loss, p->by, sim->points.ray_count, leg_count};
        add_legs(sim, p, &from, &level, found, legs, leg_count);
    }
    return ASDIC_OK;
}

/* ---- All ways ---- */

static asdic_status find_paths(asdic_simulator *sim, const asdic_ping_shot *shot) {
    asdic_passage ways[ASDIC_MOST_PASSAGES];
    size_t count = asdic_passages_find(sim, shot->pose.position_m.z, ways);
    bool wet = asdic_passage_in_water(sim->setup.scene, shot->pose.position_m.z);
    sim->points.path_count = sim->points.ray_count = 0;
    for (size_t i = 0; i < sim->setup.scene->point_count; i++) {
        double z_m = sim->placement->points[i].position_m.z;
        if (asdic_passage_in_water(sim->setup.scene, z_m) != wet) {
            continue;
        }
        for (size_t k = 0; k < count; k++) {
            TRY(k == 0 && sim->setup.layer_count == 0 ? add_path(sim, i, shot)
                                                      : add_eigenrays(sim, &ways[k], i, shot));
        }
    }
    return ASDIC_OK;
}

/* What the rays of all paths meet; nothing without triangles. */
static asdic_status trace_paths(asdic_simulator *sim) {
    asdic_point_rays *p = &sim->points;
    if (!sim->tracer || p->ray_count == 0) {
        return ASDIC_OK;
    }
    if (!p->hit_buffer) {
        size_t capacity = p->ray_capacity;
        TRY(asdic_buffer_create(sim->device, capacity * sizeof *p->rays, NULL, &p->ray_buffer));
        TRY(asdic_buffer_create(sim->device, capacity * sizeof *p->hits, NULL, &p->hit_buffer));
    }
    TRY(asdic_buffer_write(p->ray_buffer, 0, p->ray_count * sizeof *p->rays, p->rays));
    TRY(asdic_tracer_run(sim->tracer, p->ray_buffer, p->hit_buffer, (uint32_t)p->ray_count,
                         (uint32_t)p->ray_count, 0));
    return asdic_buffer_read(p->hit_buffer, 0, p->ray_count * sizeof *p->hits, p->hits);
}

static bool is_clear(const asdic_simulator *sim, const asdic_point_path *path) {
    for (size_t i = 0; i < path->ray_count; i++) {
        if (sim->points.hits[path->first_ray + i].triangle != ~0u) {
            return false;
        }
    }
    return true;
}

static double gain_towards(const dev_beam *beam, triple u, double rear_lin) {
    const float *r = beam->rows;
    return beam_pattern_lin(
        r[0] * u.x + r[1] * u.y + r[2] * u.z, r[3] * u.x + r[4] * u.y + r[5] * u.z,
        r[6] * u.x + r[7] * u.y + r[8] * u.z, beam->length_h_wl, beam->length_v_wl, rear_lin);
}

static void add_energy(asdic_ping *out, asdic_component component, size_t cell, double energy) {
    double total = out->intensity_lin[ASDIC_TOTAL][cell];
    if (energy > 0.0) {
        out->intensity_lin[component][cell] += energy;
        out->intensity_lin[ASDIC_TOTAL][cell] += energy;
        out->stderr_db[cell] *= (float)(total / (total + energy));
    }
}

/* What goes out on OUTWARD and comes back on HOME. */
static asdic_status add_echo(asdic_simulator *sim, const asdic_ping_shot *shot,
                             const asdic_point_path *outward, const asdic_point_path *home,
                             asdic_ping *out) {
    bool same = outward == home;
    asdic_path by = home->by ? home->by : outward->by;
    double range = same ? home->range_m : 0.5 * (outward->range_m + home->range_m);
    double bin = floor(range / sim->setup.sonar.bin_length_m);
    if (range < sim->setup.from_m || bin >= (double)sim->setup.bins) {
        return ASDIC_OK;
    }
    const dev_beam *beams = asdic_shot_beams(shot);
    double loss = same ? home->loss : sqrt(outward->loss) * sqrt(home->loss);
    double energy = loss *
                    pow(10.0, sim->placement->points[home->point].target_strength_db / 10.0) *
                    gain_towards(&beams[0], outward->u, shot->ping->rear_lin);
    double *truth;
    TRY(asdic_truth_point_row(sim, (asdic_truth_point){home->point, (size_t)bin, home->u.z, by},
                              &truth));
    for (size_t b = 0; b < out->beams; b++) {
        double heard = energy * asdic_beam_axis_lin(&sim->setup.sonar.receivers[b]) *
                       gain_towards(&beams[b + 1], home->u, shot->ping->rear_lin);
        add_energy(out, by ? ASDIC_MULTIPATH : ASDIC_OBJECT, b * out->bins + (size_t)bin, heard);
        if (truth) {
            truth[b] += heard;
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_points_add(asdic_simulator *sim, const asdic_ping_shot *shot, asdic_ping *out) {
    const asdic_point_rays *p = &sim->points;
    if (sim->setup.scene->point_count == 0) {
        return ASDIC_OK;
    }
    TRY(find_paths(sim, shot));
    TRY(trace_paths(sim));
    for (size_t i = 0; i < p->path_count; i++) {
        const asdic_point_path *home = &p->paths[i];
        if (!is_clear(sim, home)) {
            continue;
        }
        /* Paths to one point follow each other. */
        size_t k = i;
        while (k > 0 && p->paths[k - 1].point == home->point) {
            k--;
        }
        for (; k < p->path_count && p->paths[k].point == home->point; k++) {
            if (is_clear(sim, &p->paths[k])) {
                TRY(add_echo(sim, shot, &p->paths[k], home, out));
            }
        }
    }
    return ASDIC_OK;
}
