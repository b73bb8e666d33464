#include "points.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
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

asdic_status asdic_points_init(asdic_simulator *sim) {
    size_t count = sim->setup.scene->point_count;
    if (count == 0) {
        return ASDIC_OK;
    }
    sim->points.rays = calloc(count, sizeof *sim->points.rays);
    sim->points.hits = calloc(count, sizeof *sim->points.hits);
    if (!sim->points.rays || !sim->points.hits) {
        return asdic_fail_memory(sim->ctx, "point targets");
    }
    if (!sim->tracer) {
        return ASDIC_OK;
    }
    TRY(asdic_buffer_create(sim->device, count * sizeof(dev_ray), NULL, &sim->points.ray_buffer));
    return asdic_buffer_create(sim->device, count * sizeof(dev_hit), NULL, &sim->points.hit_buffer);
}

void asdic_points_finish(asdic_simulator *sim) {
    asdic_buffer_destroy(&sim->points.ray_buffer);
    asdic_buffer_destroy(&sim->points.hit_buffer);
    free(sim->points.rays);
    free(sim->points.hits);
}

/* From the sonar of SHOT to the point NTH. */
static ray_way way_to(const asdic_simulator *sim, size_t nth, const asdic_ping_shot *shot) {
    asdic_vec3 to = sim->placement->points[nth].position_m;
    return asdic_sonar_ray(shot->ping, asdic_vec3_sub(to, shot->pose.position_m), NEAREST);
}

/* Hits of the rays from the sonar to every point; none without triangles. */
static asdic_status trace_points(asdic_simulator *sim, const asdic_ping_shot *shot) {
    size_t count = sim->setup.scene->point_count;
    asdic_vec3 at = asdic_vec3_sub(shot->pose.position_m, sim->setup.scene->origin_m);
    const ray_medium water = {sim->setup.bend_per_m, 1.0};
    for (size_t i = 0; i < count; i++) {
        ray_way to = way_to(sim, i, shot);
        to.r.from = (triple){at.x, at.y, at.z};
        triple origin = ray_lift(to.r.from, water), along = ray_traced(&to.r, water);
        sim->points.rays[i] =
            (dev_ray){.origin = {(float)origin.x, (float)origin.y, (float)origin.z},
                      .t_max = (float)(SHORT_OF_POINT * to.t),
                      .direction = {(float)along.x, (float)along.y, (float)along.z}};
        sim->points.hits[i] = (dev_hit){INFINITY, ~0u};
    }
    if (!sim->tracer) {
        return ASDIC_OK;
    }
    TRY(asdic_buffer_write(sim->points.ray_buffer, 0, count * sizeof(dev_ray), sim->points.rays));
    TRY(asdic_tracer_run(sim->tracer, sim->points.ray_buffer, sim->points.hit_buffer,
                         (uint32_t)count, (uint32_t)count, 0));
    return asdic_buffer_read(sim->points.hit_buffer, 0, count * sizeof(dev_hit), sim->points.hits);
}

/* Whether Z lies in the water; a sonar out of it sees nothing of what is in it, and the reverse. */
static bool in_water(const asdic_scene *scene, double z) {
    return !(scene->has_surface && z < 0.0) &&
           !(scene->has_bottom_plane && z > scene->bottom_plane_depth_m);
}

static double gain_towards(const dev_beam *beam, triple u, double rear_lin) {
    const float *r = beam->rows;
    return beam_pattern_lin(
        r[0] * u.x + r[1] * u.y + r[2] * u.z, r[3] * u.x + r[4] * u.y + r[5] * u.z,
        r[6] * u.x + r[7] * u.y + r[8] * u.z, beam->length_h_wl, beam->length_v_wl, rear_lin);
}

static void add_energy(asdic_ping *out, size_t cell, double energy) {
    double total = out->intensity_lin[ASDIC_TOTAL][cell];
    if (energy > 0.0) {
        out->intensity_lin[ASDIC_OBJECT][cell] += energy;
        out->intensity_lin[ASDIC_TOTAL][cell] += energy;
        out->stderr_db[cell] *= (float)(total / (total + energy));
    }
}

static void add_point(asdic_simulator *sim, const asdic_ping_shot *shot, size_t nth, ray_way to,
                      asdic_ping *out) {
    double range = ray_range(&to.r, to.t), bin = floor(range / sim->setup.sonar.bin_length_m);
    if (!(to.t > NEAREST) || range < sim->setup.sonar.blanking_m ||
        bin >= (double)sim->setup.bins) {
        return;
    }
    triple u = to.r.u;
    const dev_beam *beams = asdic_shot_beams(shot);
    double absorption = shot->water.absorption_np_per_m, spread = range / to.t;
    double energy = asdic_simulator_source_lin(sim, &shot->water) *
                    ray_transmission(absorption, range) * spread * spread *
                    ray_bending(&to.r, to.t, range, -2.0 * absorption) *
                    pow(10.0, sim->placement->points[nth].target_strength_db / 10.0) *
                    gain_towards(&beams[0], u, shot->ping->rear_lin);
    for (size_t b = 0; b < out->beams; b++) {
        double gain = gain_towards(&beams[b + 1], u, shot->ping->rear_lin);
        add_energy(out, b * out->bins + (size_t)bin, energy * gain);
        asdic_truth_add_point(sim, nth, u.z, b, (size_t)bin, energy * gain);
    }
}

asdic_status asdic_points_add(asdic_simulator *sim, const asdic_ping_shot *shot, asdic_ping *out) {
    const asdic_scene *scene = sim->setup.scene;
    const asdic_pose *pose = &shot->pose;
    if (scene->point_count == 0) {
        return ASDIC_OK;
    }
    TRY(trace_points(sim, shot));
    bool wet = in_water(scene, pose->position_m.z);
    for (size_t i = 0; i < scene->point_count; i++) {
        const asdic_point *point = &sim->placement->points[i];
        if (sim->points.hits[i].triangle == ~0u && in_water(scene, point->position_m.z) == wet) {
            add_point(sim, shot, i, way_to(sim, i, shot), out);
        }
    }
    return ASDIC_OK;
}
