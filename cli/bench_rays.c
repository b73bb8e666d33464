/* `asdic bench rays`: how many rays a second find what they meet. */
#include "bench_rays.h"
#include "bench_pings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const bench_column bench_rays_columns[] = {{"scene", "scene", 16, 0, 0.0},
                                           {"triangles", "triangles", 9, 0, 0.0},
                                           {"nodes", NULL, 0, 0, 0.0},
                                           {"bytes", "MB", 7, 1, 1e-6},
                                           {"build_s", "build s", 8, 3, 0.0},
                                           {"set", "set", 14, 0, 0.0},
                                           {"rays", "rays", 8, 0, 0.0},
                                           {"hits", "hits", 8, 0, 0.0},
                                           {"kernel", "kernel", 9, 0, 0.0},
                                           {"rays_per_s", "Mrays/s", 8, 2, 1e-6},
                                           {NULL, NULL, 0, 0, 0.0}};

asdic_status bench_ray_scene_commit(const bench *b, const asdic_mesh *mesh, asdic_scene **out) {
    TRY(asdic_scene_create(cli_context(b->c), out));
    asdic_scene_set_surface(*out, false);
    asdic_scene_set_threads(*out, b->threads);
    TRY(asdic_scene_add_bottom(*out, mesh, (asdic_pose){{0.0, 0.0, 0.0}, 0.0, 0.0, 0.0},
                               asdic_material_bottom(2.0)));
    return asdic_scene_commit(*out);
}

/* At world position AT_M, the cones PITCH_RAD down. */
void bench_ray_scene_look(bench_ray_scene *s, asdic_vec3 at_m, double pitch_rad) {
    asdic_vec3 o = asdic_scene_get_info(s->scene).origin_m;
    const double at[3] = {at_m.x - o.x, at_m.y - o.y, at_m.z - o.z};
    const double towards[3] = {cos(pitch_rad), 0.0, sin(pitch_rad)};
    for (int k = 0; k < 3; k++) {
        s->from_m[k] = (float)at[k];
        s->towards[k] = (float)towards[k];
    }
}

asdic_status bench_ray_scene_terrain(const bench *b, bench_ray_scene *out) {
    *out = (bench_ray_scene){.name = "terrain"};
    TRY(bench_terrain(cli_context(b->c), b->quick ? 20000 : 1000000, b->threads, &out->scene));
    double altitude = asdic_scene_altitude_m(out->scene, (asdic_vec3){0.0, 0.0, 0.0});
    bench_ray_scene_look(out, (asdic_vec3){0.0, 0.0, altitude - BENCH_ALTITUDE_M}, 0.6);
    return ASDIC_OK;
}

asdic_status bench_ray_scene_load(const bench *b, const char *path, bench_ray_scene *out) {
    asdic_mesh *mesh = NULL;
    *out = (bench_ray_scene){.scene = NULL};
    const char *slash = strrchr(path, '/');
    snprintf(out->name, sizeof out->name, "%.63s", slash ? slash + 1 : path);
    asdic_status status = asdic_mesh_load(cli_context(b->c), path, 1.0, false, &mesh);
    status = status ? status : bench_ray_scene_commit(b, mesh, &out->scene);
    if (!status) {
        asdic_mesh_info info = asdic_mesh_get_info(mesh);
        asdic_vec3 size = {info.max_m.x - info.min_m.x, info.max_m.y - info.min_m.y,
                           info.max_m.z - info.min_m.z};
        double across = sqrt(size.x * size.x + size.y * size.y + size.z * size.z);
        asdic_vec3 at = {0.5 * (info.min_m.x + info.max_m.x) - 0.4 * across * cos(0.6),
                         0.5 * (info.min_m.y + info.max_m.y),
                         0.5 * (info.min_m.z + info.max_m.z) - 0.4 * across * sin(0.6)};
        bench_ray_scene_look(out, at, 0.6);
    }
    asdic_mesh_destroy(&mesh);
    return status;
}

bench_ray_effort bench_ray_effort_of(const bench *b) {
    return b->quick ? (bench_ray_effort){20000, 5000, 3, 5}
                    : (bench_ray_effort){409600, 20000, 5, BENCH_MOST_REPEATS};
}

bool bench_ray_set_is_few(bench_ray_set set) {
    return set == BENCH_CONE || set == BENCH_SPHERE;
}

double bench_ray_clock_s(const bench *b) {
    bool one = b->threads == 1 && asdic_device_get_info(b->device)->kind == ASDIC_DEVICE_CPU;
    return one ? cli_processor_s() : cli_clock_s();
}

/* The median of casting RAYS, warm. */
static asdic_status time_rays(const bench *b, asdic_caster *caster, size_t repeats,
                              double *seconds) {
    double times[BENCH_MOST_REPEATS];
    for (int k = 0; k < 2; k++) { /* compiles, chooses, warms */
        TRY(asdic_caster_cast(caster));
    }
    for (size_t k = 0; k < repeats; k++) {
        TRY(bench_interrupted(b));
        double began = bench_ray_clock_s(b);
        TRY(asdic_caster_cast(caster));
        times[k] = bench_ray_clock_s(b) - began;
    }
    *seconds = bench_median(times, repeats);
    return ASDIC_OK;
}

static asdic_status measure_set(bench *b, const bench_ray_scene *s, asdic_caster *caster,
                                bench_ray_set set, asdic_ray *rays, asdic_ray_hit *hits) {
    bench_ray_effort effort = bench_ray_effort_of(b);
    bool few = bench_ray_set_is_few(set);
    size_t count = few ? effort.few : effort.dense, met = 0;
    double seconds;
    bench_rays_fill(set, s, rays, count);
    TRY(asdic_caster_load(caster, rays, count));
    TRY(time_rays(b, caster, few ? effort.few_repeats : effort.dense_repeats, &seconds));
    TRY(asdic_caster_read(caster, hits));
    for (size_t i = 0; i < count; i++) {
        met += hits[i].triangle != ASDIC_NO_TRIANGLE;
    }
    asdic_scene_info info = asdic_scene_get_info(s->scene);
    const bench_cell cells[] = {BENCH_TEXT(s->name),
                                BENCH_NUMBER(info.triangles),
                                BENCH_NUMBER(info.bvh_nodes),
                                BENCH_NUMBER(info.bvh_bytes),
                                BENCH_NUMBER(info.hierarchy_s),
                                BENCH_TEXT(bench_ray_set_name(set)),
                                BENCH_NUMBER(count),
                                BENCH_NUMBER(met),
                                BENCH_TEXT(asdic_caster_kernel(caster)),
                                BENCH_NUMBER((double)count / seconds)};
    bench_add(b, cells);
    return ASDIC_OK;
}

static asdic_status measure_sets(bench *b, const bench_ray_scene *s, asdic_ray *rays,
                                 asdic_ray_hit *hits) {
    asdic_caster *caster = NULL;
    TRY(asdic_caster_create(cli_context(b->c), b->device, s->scene, cli_text(b->c, "kernel"),
                            &caster));
    asdic_status status = ASDIC_OK;
    for (int set = 0; !status && set < BENCH_RAY_SETS; set++) {
        status = measure_set(b, s, caster, (bench_ray_set)set, rays, hits);
    }
    asdic_caster_destroy(&caster);
    return status;
}

asdic_status bench_rays(bench *b) {
    size_t most = bench_ray_effort_of(b).dense, named = bench_scene_count(b);
    asdic_ray *rays = malloc(most * sizeof *rays);
    asdic_ray_hit *hits = malloc(most * sizeof *hits);
    asdic_status status = rays && hits ? ASDIC_OK : ASDIC_ERROR_MEMORY;
    for (size_t i = 0; !status && i < (named ? named : 1); i++) {
        bench_ray_scene scene = {.scene = NULL};
        status = named ? bench_ray_scene_load(b, cli_operand(b->c, i + 1), &scene)
                       : bench_ray_scene_terrain(b, &scene);
        status = status ? status : measure_sets(b, &scene, rays, hits);
        asdic_scene_destroy(&scene.scene);
    }
    free(rays);
    free(hits);
    return status;
}
