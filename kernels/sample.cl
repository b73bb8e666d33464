/*
 * sample: draws one batch of rays, of one ping or of several that go together.
 *
 * Rays lie in the order of order.h. Slots beyond the last ray are switched off (t_max 0, solid angle 0).
 */
#include "learnt.h"
#include "ping_batch.h"

/* Background rays per steradian in a direction that a cone drew. */
static real background_rays(__global const dev_ping *ping, __global const float *table,
                            const ray_sample *s) {
    real density, y = R(0.0), m = sqrt(r_max(s->x * s->x + s->y * s->y, R(1e-12)));
    real x = x_of_elevation(ping, s->z, m, &density);
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        ((float *)&density)[lane] *= learnt_density(table, DEV_TABLE_CELLS, ((float *)&x)[lane]);
    }
    azimuth_lobes lobes = azimuth_lobes_at(ping, s->z, m);
    return (real)((float)(ping->sampling.background)) * density *
           azimuth_density(ping, table, &lobes, x, atan2(s->y, s->x), &y);
}

/* LANE of S: a direction from the sonar to a point of the face that holds the quantile XI1. */
static void sample_face(__global const dev_ping *ping, __global const dev_face *faces,
                        __global const dev_triangle *triangles, float xi1, float xi2, uint lane,
                        ray_sample *s) {
    uint low = 0u, high = ping->sampling.faces - 1u;
    while (low < high) {
        uint middle = (low + high) / 2u;
        low = faces[middle].cumulative <= xi1 ? middle + 1u : low;
        high = faces[middle].cumulative <= xi1 ? high : middle;
    }
    float before = low > 0u ? faces[low - 1u].cumulative : 0.0f;
    float part = (xi1 - before) / (faces[low].cumulative - before);
    float along = sqrt(clamp(part, 0.0f, 1.0f)), across = along * xi2;
    __global const dev_triangle *t = triangles + faces[low].triangle;
    float to[3];
    for (uint k = 0; k < 3u; k++) {
        to[k] = t->v0[k] + along * (t->v1[k] - t->v0[k]) + across * (t->v2[k] - t->v1[k]) -
                ping->origin[k];
    }
#if ASDIC_BENT /* as ray_between */
    float bend = ping->bend_per_m / (1.0f + ping->bend_per_m * ping->origin[2]);
    to[2] += 0.5f * bend * (to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
#endif
    float inverse = 1.0f / sqrt(max(to[0] * to[0] + to[1] * to[1] + to[2] * to[2], 1e-12f));
    ((float *)&s->x)[lane] = to[0] * inverse;
    ((float *)&s->y)[lane] = to[1] * inverse;
    ((float *)&s->z)[lane] = to[2] * inverse;
    /* The splat names the triangle for weigh_faces: negative, unlike a width. */
    ((float *)&s->splat)[lane] = as_float(0x80000000u | faces[low].triangle);
}

/* Aims rays at faces. Their weights are set in shade.cl, when it is known what they meet (faces.h). */
static void aim_at_faces(__global const dev_ping *ping, __global const dev_face *faces,
                         __global const dev_triangle *triangles, natural index, ray_sample *s) {
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        uint own = ((uint *)&index)[lane] - ping->sampling.face_first;
        if (own < ping->sampling.face_count) {
            float xi1 =
                ((float)(own) + ping->sampling.lattice_offset) / (float)(ping->sampling.face_count);
            uint golden = own * 2654435769u + ping->sampling.lattice_shift;
            float xi2 = ((float)(golden >> 9) + 0.5f) * 1.1920928955078125e-7f;
            sample_face(ping, faces, triangles, min(xi1, 0.99999994f), xi2, lane, s);
        }
    }
}

/* Which lanes are rays of CONE. */
static mask drawn_by(__global const dev_cone *cone, natural index) {
    return (index >= cone->first) & (index < cone->first + cone->count);
}

/* What directions are drawn by. */
typedef struct sampler_store {
    __global const float *table;
    __global const dev_face *faces;
    __global const dev_triangle *triangles;
} sampler_store;

/* Replaces the directions of the rays that belong to cones and faces, and weighs every ray by all the ways
 * in which its direction could have been drawn. */
static void add_objects(__global const dev_ping *ping, const sampler_store *store, natural index,
                        ray_sample *s) {
    mask drawn = index >= ping->sampling.background;
    for (uint c = 0; c < ping->sampling.cones; c++) {
        mask here = drawn_by(ping->sampling.cone + c, index);
        if (any_true(here)) {
            natural j = index - ping->sampling.cone[c].first;
            natural golden = j * (natural)(2654435769u) + (natural)(ping->sampling.lattice_shift);
            /* Where an echo falls off from the middle, rays that all lay as far out in their rings would err alike: each
             * lies elsewhere in its own, by the plastic number, whose steps keep clear of the golden one's. */
            natural plastic = j * (natural)(2447445413u) + (natural)(ping->sampling.lattice_shift);
            real xi1 = (to_real(j) + random_uniform(plastic)) /
                       (real)((float)(ping->sampling.cone[c].count));
            ray_sample own =
                sample_cone(ping->sampling.cone + c, r_min(xi1, R(1.0)), random_uniform(golden));
            s->x = choose(here, own.x, s->x);
            s->y = choose(here, own.y, s->y);
            s->z = choose(here, own.z, s->z);
            s->splat = choose(here, own.splat, s->splat);
        }
    }
    if (ping->sampling.face_count != 0u) {
        aim_at_faces(ping, store->faces, store->triangles, index, s);
    }
    real rays = R(1.0) / s->solid_angle;
    if (any_true(drawn)) {
        rays = choose(drawn, background_rays(ping, store->table, s), rays);
    }
    for (uint c = 0; c < ping->sampling.cones; c++) {
        __global const dev_cone *cone = ping->sampling.cone + c;
        mask inside = in_cone(cone, s->x, s->y, s->z) | drawn_by(cone, index);
        real own = (real)((float)(cone->count)) / (R_PI * (real)(cone->chord[0] * cone->chord[1]));
        rays += choose(inside, own, R(0.0));
    }
    s->solid_angle = R(1.0) / rays;
}

static ray_sample draw_adaptive(__global const dev_ping *ping, const sampler_store *store,
                                natural index) {
    real count = (real)((float)(ping->sampling.background));
    real xi1 = (to_real(index) + (real)(ping->sampling.lattice_offset)) / count;
    natural golden = index * (natural)(2654435769u) + (natural)(ping->sampling.lattice_shift);
    ray_sample s = sample_adaptive(ping, store->table, r_min(xi1, R(0.99999994)),
                                   random_uniform(golden), count);
    if (ping->sampling.background != ping->batch.rays) {
        add_objects(ping, store, index, &s);
    }
    return s;
}

APART static ray_sample draw(__global const dev_ping *ping, const sampler_store *store,
                             natural index) {
    if (ping->sampling.sampler == DEV_SAMPLER_ADAPTIVE) {
        return draw_adaptive(ping, store, index);
    }
    real count = (real)((float)(ping->batch.rays));
    uint purpose = RANDOM_SAMPLE + (ping->sampling.stream << 4);
    random4 random =
        random_draw(index, ping->ping[0], ping->ping[1], purpose, ping->seed[0], ping->seed[1]);
    return ping->sampling.sampler == DEV_SAMPLER_BEAM
               ? sample_beam(ping->sampling.lobe, ping->sampling.lobes, random, count)
               : sample_uniform_sphere(random, count);
}

__kernel void LEAST_WAVES(3)
    sample(__global const dev_ping *pings, __global const float *table,
           __global const dev_face *faces, __global const dev_triangle *triangles,
           __global dev_ray *rays, __global float *solid_angles, __global float *splats) {
    __global const dev_ping *ping = row_ping(pings);
    uint first = (uint)(get_global_id(0)) * ASDIC_WIDTH;
    if (first >= batch_slots(ping)) {
        return;
    }
    size_t own = row_slots(ping);
    rays += own;
    solid_angles += own;
    splats += own;
    natural index = ping->batch.first * ping->batch.groups + rays_in(ping, first);
    sampler_store store = {table, faces, triangles};
    ray_sample s = draw(ping, &store, index);
    ray_medium water = {(real)(ping->bend_per_m),
                        (real)(1.0f + ping->bend_per_m * ping->origin[2])};
    triple sonar = {(real)(ping->origin[0]), (real)(ping->origin[1]), (real)(ping->origin[2])};
    triple u = {s.x, s.y, s.z};
#if ASDIC_LAYERS /* advance.cl goes on from here */
    triple from = sonar, along = u;
    real t_max = (real)(ping->reach_m);
    (void)water;
#else
    triple from = ray_lift(sonar, water);
    ray r = ray_start(sonar, u, water);
    triple along = ray_traced(&r, water);
    real t_max = ray_at_range(&r, (real)(ping->reach_m));
#endif
    for (uint lane = 0; lane < ASDIC_WIDTH; lane++) {
        uint slot = first + lane;
        bool on = ((uint *)&index)[lane] < ping->batch.rays;
        dev_ray ray;
        ray.origin[0] = ((float *)&from.x)[lane];
        ray.origin[1] = ((float *)&from.y)[lane];
        ray.origin[2] = ((float *)&from.z)[lane];
        ray.t_max = on ? ((float *)&t_max)[lane] : 0.0f;
        ray.direction[0] = ((float *)&along.x)[lane];
        ray.direction[1] = ((float *)&along.y)[lane];
        ray.direction[2] = ((float *)&along.z)[lane];
        ray.source = slot;
        rays[slot] = ray;
        solid_angles[slot] = on ? ((float *)&s.solid_angle)[lane] : 0.0f;
        splats[slot] = ((float *)&s.splat)[lane];
    }
}
