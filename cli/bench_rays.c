/* `asdic bench rays`: rays per second, and how they compare with another caster's. */
#include "bench_rays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_REPEATS 25
#define BUILDS 5

typedef struct effort {
    size_t dense, few; /* rays of a set */
    size_t dense_repeats, few_repeats, builds;
} effort;

/* One scene under measurement. */
typedef struct bench {
    cli *c;
    asdic_device *device;
    const char *kernel;
    effort effort;
    unsigned threads;
    bool processor_clock, quick;
    bench_ray_scene scene;
    float *corners_m;
    size_t triangles;
    asdic_caster *caster;
    bench_embree *embree, *robust; /* NULL without */
    asdic_ray *rays, *mirrored;
    asdic_ray_hit *hits, *theirs;
} bench;

static double clock_s(const bench *b) {
    return b->processor_clock ? bench_processor_s() : bench_now_s();
}

static effort effort_of(bool quick) {
    return quick ? (effort){20000, 5000, 3, 5, 1}
                 : (effort){409600, 20000, 5, MOST_REPEATS, BUILDS};
}

static bool is_few(bench_ray_set set) {
    return set == BENCH_CONE || set == BENCH_SPHERE;
}

static asdic_status time_ours(bench *b, double *seconds) {
    if (asdic_context_interrupted(cli_context(b->c))) {
        return ASDIC_ERROR_INTERRUPTED;
    }
    double began = clock_s(b);
    asdic_status status = asdic_caster_cast(b->caster);
    *seconds = clock_s(b) - began;
    return status;
}

/* Theirs last, so that b->theirs holds single rays' hits. */
static void time_theirs(bench *b, const asdic_ray *rays, size_t count,
                        double seconds[BENCH_EMBREE_MODES]) {
    for (int mode = BENCH_EMBREE_MODES - 1; b->embree && mode >= 0; mode--) {
        double began = clock_s(b);
        bench_embree_cast(b->embree, (bench_embree_mode)mode, rays, count, b->theirs);
        seconds[mode] = clock_s(b) - began;
    }
}

static asdic_status time_rays(bench *b, const asdic_ray *rays, bench_ray_row *row) {
    double ours[MOST_REPEATS], theirs[BENCH_EMBREE_MODES][MOST_REPEATS];
    size_t repeats = is_few(row->set) ? b->effort.few_repeats : b->effort.dense_repeats;
    asdic_status status = asdic_caster_load(b->caster, rays, row->rays);
    for (int k = 0; !status && k < 2; k++) { /* compiles, chooses, warms */
        status = asdic_caster_cast(b->caster);
    }
    for (size_t k = 0; !status && k < repeats; k++) {
        double seconds[BENCH_EMBREE_MODES] = {NAN, NAN, NAN};
        status = time_ours(b, &ours[k]);
        time_theirs(b, rays, row->rays, seconds);
        for (int mode = 0; mode < BENCH_EMBREE_MODES; mode++) {
            theirs[mode][k] = seconds[mode];
        }
    }
    if (status) {
        return status;
    }
    row->kernel = asdic_caster_kernel(b->caster);
    row->ours_s = bench_median(ours, repeats);
    for (int mode = 0; mode < BENCH_EMBREE_MODES; mode++) {
        row->embree_s[mode] = b->embree ? bench_median(theirs[mode], repeats) : NAN;
    }
    return asdic_caster_read(b->caster, b->hits);
}

static void count_hits(const bench *b, const asdic_ray *rays, bench_ray_row *row) {
    for (size_t i = 0; i < row->rays; i++) {
        const asdic_ray_hit *o = &b->hits[i], *t = &b->theirs[i];
        bool met = o->triangle != ASDIC_NO_TRIANGLE, theirs = t->triangle != ASDIC_NO_TRIANGLE;
        row->hits += met;
        row->disagree +=
            b->embree &&
            (met != theirs || (met && fabsf(o->range_m - t->range_m) > 1e-3f * fabsf(t->range_m)));
    }
    if (row->set == BENCH_VERTICES) {
        row->at_vertices = bench_rays_judge(b->corners_m, b->triangles, rays, b->hits, row->rays);
        if (b->robust) {
            bench_embree_cast(b->robust, BENCH_EMBREE_SINGLE, rays, row->rays, b->theirs);
            row->embree_at_vertices =
                bench_rays_judge(b->corners_m, b->triangles, rays, b->theirs, row->rays);
        }
    }
}

static asdic_status measure_set(bench *b, bench_ray_set set, const asdic_ray *rays, size_t count,
                                bench_ray_result *result) {
    bench_ray_row *row = &result->rows[result->count];
    *row = (bench_ray_row){.set = set, .rays = count, .goal = NAN};
    if (!b->quick) { /* goals are for the whole sets */
        row->goal = bench_ray_goal(b->scene.name, set);
    }
    if (count == 0) {
        return ASDIC_OK; /* nothing was met that could mirror */
    }
    asdic_status status = time_rays(b, rays, row);
    if (!status) {
        count_hits(b, rays, row);
        result->count++;
    }
    return status;
}

static asdic_status measure_sets(bench *b, bench_ray_result *result) {
    asdic_status status = ASDIC_OK;
    for (int set = 0; !status && set < BENCH_RAY_SETS; set++) {
        if (set == BENCH_MIRRORED_DENSE || set == BENCH_MIRRORED_RANDOM) {
            continue; /* with the set whose hits they leave */
        }
        size_t count = is_few((bench_ray_set)set) ? b->effort.few : b->effort.dense;
        bench_rays_fill((bench_ray_set)set, &b->scene, b->corners_m, b->triangles, b->rays, count);
        status = measure_set(b, (bench_ray_set)set, b->rays, count, result);
        if (!status && (set == BENCH_CONE_DENSE || set == BENCH_SPHERE_RANDOM)) {
            size_t kept = bench_rays_mirror(b->corners_m, b->rays, b->hits, count, b->mirrored);
            status = measure_set(b, (bench_ray_set)(set + 1), b->mirrored, kept, result);
        }
    }
    return status;
}

/* The scene for operand INDEX, or the built-in one. */
static asdic_status make_scene(bench *b, size_t index) {
    return cli_operand_count(b->c) > 1
               ? bench_ray_scene_load(b->c, cli_operand(b->c, index + 1), b->threads, &b->scene)
               : bench_ray_scene_make(b->c, index, b->quick, b->threads, &b->scene);
}

static double least(const double *values, size_t count) {
    double best = INFINITY;
    for (size_t i = 0; i < count; i++) {
        best = fmin(best, values[i]);
    }
    return best;
}

/* Builds both hierarchies in turn; the last ones stay. */
static asdic_status build(bench *b, size_t index, bench_ray_result *result) {
    double ours[BUILDS], theirs[BUILDS];
    for (size_t k = 0; k < b->effort.builds; k++) {
        asdic_scene_destroy(&b->scene.scene);
        bench_embree_destroy(b->embree);
        b->embree = NULL;
        asdic_status status = make_scene(b, index);
        if (status) {
            return status;
        }
        ours[k] = asdic_scene_get_info(b->scene.scene).hierarchy_s;
        free(b->corners_m);
        b->corners_m = bench_ray_scene_corners(&b->scene, &b->triangles);
        if (!b->corners_m) {
            return ASDIC_ERROR_MEMORY;
        }
        b->embree = bench_embree_create(b->corners_m, b->triangles, b->threads, false, &theirs[k]);
    }
    double robust_s;
    b->robust = bench_embree_create(b->corners_m, b->triangles, b->threads, true, &robust_s);
    asdic_scene_info info = asdic_scene_get_info(b->scene.scene);
    snprintf(result->scene, sizeof result->scene, "%s", b->scene.name);
    result->triangles = info.triangles;
    result->nodes = info.bvh_nodes;
    result->bytes = info.bvh_bytes;
    result->build_s = least(ours, b->effort.builds);
    result->embree_build_s = b->embree ? least(theirs, b->effort.builds) : NAN;
    return ASDIC_OK;
}

static asdic_status measure_scene(bench *b, size_t index, bench_ray_result *result) {
    asdic_status status = build(b, index, result);
    b->rays = malloc(b->effort.dense * sizeof *b->rays);
    b->mirrored = malloc(b->effort.dense * sizeof *b->mirrored);
    b->hits = malloc(b->effort.dense * sizeof *b->hits);
    b->theirs = calloc(b->effort.dense, sizeof *b->theirs);
    if (!status && (!b->rays || !b->mirrored || !b->hits || !b->theirs)) {
        status = ASDIC_ERROR_MEMORY;
    }
    status = status ? status
                    : asdic_caster_create(cli_context(b->c), b->device, b->scene.scene, b->kernel,
                                          &b->caster);
    status = status ? status : measure_sets(b, result);
    asdic_caster_destroy(&b->caster);
    bench_embree_destroy(b->embree);
    bench_embree_destroy(b->robust);
    asdic_scene_destroy(&b->scene.scene);
    free(b->corners_m);
    free(b->rays);
    free(b->mirrored);
    free(b->hits);
    free(b->theirs);
    return status;
}

static asdic_status measure_all(cli *c, asdic_device *device, const bench_options *options,
                                const bench_ray_frame *frame, bench_ray_result *results,
                                size_t wanted, size_t *count) {
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; !status && i < wanted; i++) {
        bench b = {.c = c,
                   .device = device,
                   .kernel = options->kernel,
                   .effort = effort_of(options->quick),
                   .threads = frame->threads,
                   .quick = options->quick,
                   .processor_clock = strcmp(frame->clock, "processor") == 0};
        status = measure_scene(&b, i, &results[i]);
        *count += !status;
        if (!status && !options->json) {
            bench_rays_print(&results[i]);
        }
    }
    return status;
}

int bench_rays(cli *c, const bench_options *options) {
    size_t wanted = cli_operand_count(c) > 1 ? cli_operand_count(c) - 1 : BENCH_RAY_SCENES;
    if (options->picture) {
        return cli_usage(c, "'bench rays' draws nothing; -o writes a table");
    }
    asdic_device **devices = NULL;
    size_t device_count = 0, count = 0;
    bench_ray_frame frame = {.threads = bench_limit_threads(options, 1)};
    bench_ray_result *results = calloc(wanted, sizeof *results);
    asdic_status status =
        results ? cli_open_devices(c, &devices, &device_count) : ASDIC_ERROR_MEMORY;
    if (!status) {
        frame.device = asdic_device_get_info(devices[0]);
        bool one = frame.threads == 1 && frame.device->kind == ASDIC_DEVICE_CPU;
        frame.clock = one ? "processor" : "wall";
        if (!options->json) {
            bench_rays_head(&frame);
        }
        status = measure_all(c, devices[0], options, &frame, results, wanted, &count);
    }
    int code = cli_end(c, status);
    if (!status && options->json) {
        bench_rays_json(&frame, results, count);
    }
    if (!status && options->csv) {
        code = bench_rays_csv(c, options->csv, &frame, results, count);
    }
    asdic_devices_close(&devices, device_count);
    free(results);
    return code;
}
