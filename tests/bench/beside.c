/* Rays per second beside Embree's on the same rays in the same process, and the ratio to reach. */
#include "beside.h"
#include "kinds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_BUILDS 5

const bench_column beside_columns[] = {{"scene", "scene", 8, 0, 0.0},
                                       {"triangles", "triangles", 9, 0, 0.0},
                                       {"build_s", "build s", 7, 3, 0.0},
                                       {"embree_build_s", "theirs", 7, 3, 0.0},
                                       {"set", "set", 15, 0, 0.0},
                                       {"rays", "rays", 7, 0, 0.0},
                                       {"hits", NULL, 0, 0, 0.0},
                                       {"kernel", "kernel", 9, 0, 0.0},
                                       {"rays_per_s", "Mrays/s", 8, 2, 1e-6},
                                       {"embree_single_rays_per_s", "single", 8, 2, 1e-6},
                                       {"embree_packet_rays_per_s", "packet", 8, 2, 1e-6},
                                       {"embree_coherent_rays_per_s", "coherent", 8, 2, 1e-6},
                                       {"ratio", "ratio", 6, 2, 0.0},
                                       {"goal", "goal", 5, 2, 0.0},
                                       {"disagree", "disagree", 8, 0, 0.0},
                                       {"missed", "missed", 6, 0, 0.0},
                                       {"grazed_silhouette", "grazed", 6, 0, 0.0},
                                       {"past_silhouette", "passed", 6, 0, 0.0},
                                       {"embree_robust_missed", "theirs", 6, 0, 0.0},
                                       {"embree_robust_grazed", "grazed", 6, 0, 0.0},
                                       {"embree_version", NULL, 0, 0, 0.0},
                                       {NULL, NULL, 0, 0, 0.0}};

/* What each set is compared with: the mode of Embree that its rays ask for, or the best of all. */
typedef enum rival { RIVAL_SINGLE, RIVAL_COHERENT, RIVAL_BEST } rival;

/* The sets of `asdic bench rays`, the mirror rays of two, and rays at vertices. */
enum { MIRRORED_DENSE = BENCH_RAY_SETS, MIRRORED_RANDOM, VERTICES, SETS };

static const struct {
    const char *name;
    rival rival;
    double goal[BESIDE_SCENES]; /* Embree's time over ours in terrain, object, small; 0: none */
} sets[SETS] = {
    [BENCH_CONE_DENSE] = {"cone-dense", RIVAL_COHERENT, {1.5, 1.5, 1.5}},
    [BENCH_CONE] = {"cone", RIVAL_COHERENT, {0.95, 0.95, 0.95}},
    [BENCH_SPHERE_DENSE] = {"sphere-dense", RIVAL_COHERENT, {1.0, 1.0, 1.0}},
    [BENCH_SPHERE] = {"sphere", RIVAL_BEST, {0.85, 0.85, 0.85}},
    [BENCH_SPHERE_RANDOM] = {"sphere-random", RIVAL_SINGLE, {0.9, 1.25, 1.25}},
    [MIRRORED_DENSE] = {"mirrored-dense", RIVAL_COHERENT, {0.8, 0.8, 0.8}},
    [MIRRORED_RANDOM] = {"mirrored-random", RIVAL_SINGLE, {0.95, 0.95, 0.95}},
    [VERTICES] = {"vertices", RIVAL_SINGLE, {0.0, 0.0, 0.0}},
};

/* The ratios of every set, by mesh; the lowest is that of mesh WORST. */
typedef struct summary {
    double *ratios[SETS], least[SETS];
    size_t count[SETS];
    char worst[SETS][ASDIC_NAME_SIZE];
} summary;

/* One scene under measurement. */
typedef struct rig {
    bench *b;
    summary *all;
    size_t index; /* BESIDE_SCENES: a mesh from the command line */
    bench_ray_scene scene;
    float *corners_m;
    size_t triangles;
    double build_s, embree_build_s; /* the fastest of several */
    asdic_caster *caster;
    bench_embree *embree, *robust; /* NULL without */
    asdic_ray *rays, *mirrored;
    asdic_ray_hit *hits, *theirs;
} rig;

typedef struct figures {
    double ours_s, embree_s[BENCH_EMBREE_MODES];
    size_t hits, disagree; /* one hits, the other does not, or ranges differ by more than 1e-3 */
    bench_vertex_rays ours, robust;
} figures;

/* Single rays last, so that r->theirs holds their hits. */
static void time_theirs(rig *r, const asdic_ray *rays, size_t count,
                        double seconds[BENCH_EMBREE_MODES][BENCH_MOST_REPEATS], size_t turn) {
    for (int mode = BENCH_EMBREE_MODES - 1; mode >= 0; mode--) {
        double began = bench_ray_clock_s(r->b);
        if (r->embree) {
            bench_embree_cast(r->embree, (bench_embree_mode)mode, rays, count, r->theirs);
        }
        seconds[mode][turn] = r->embree ? bench_ray_clock_s(r->b) - began : NAN;
    }
}

static asdic_status time_rays(rig *r, const asdic_ray *rays, size_t count, size_t repeats,
                              figures *f) {
    double ours[BENCH_MOST_REPEATS], theirs[BENCH_EMBREE_MODES][BENCH_MOST_REPEATS];
    TRY(asdic_caster_load(r->caster, rays, count));
    for (int k = 0; k < 2; k++) { /* compiles, chooses, warms */
        TRY(asdic_caster_cast(r->caster));
    }
    for (size_t k = 0; k < repeats; k++) {
        TRY(bench_interrupted(r->b));
        double began = bench_ray_clock_s(r->b);
        TRY(asdic_caster_cast(r->caster));
        ours[k] = bench_ray_clock_s(r->b) - began;
        time_theirs(r, rays, count, theirs, k);
    }
    f->ours_s = bench_median(ours, repeats);
    for (int mode = 0; mode < BENCH_EMBREE_MODES; mode++) {
        f->embree_s[mode] = bench_median(theirs[mode], repeats);
    }
    return asdic_caster_read(r->caster, r->hits);
}

static void count_hits(const rig *r, size_t count, figures *f) {
    for (size_t i = 0; i < count; i++) {
        const asdic_ray_hit *o = &r->hits[i], *t = &r->theirs[i];
        bool met = o->triangle != ASDIC_NO_TRIANGLE, theirs = t->triangle != ASDIC_NO_TRIANGLE;
        f->hits += met;
        f->disagree +=
            met != theirs || (met && fabsf(o->range_m - t->range_m) > 1e-3f * fabsf(t->range_m));
    }
}

static void judge_vertices(rig *r, const asdic_ray *rays, size_t count, figures *f) {
    f->ours = bench_rays_judge(r->corners_m, r->triangles, rays, r->hits, count);
    if (r->robust) {
        bench_embree_cast(r->robust, BENCH_EMBREE_SINGLE, rays, count, r->theirs);
        f->robust = bench_rays_judge(r->corners_m, r->triangles, rays, r->theirs, count);
    }
}

static void summarize(summary *all, int set, const char *name, double ratio) {
    if (all->count[set] == 0 || ratio < all->least[set]) {
        all->least[set] = ratio;
        snprintf(all->worst[set], sizeof all->worst[set], "%s", name);
    }
    all->ratios[set][all->count[set]++] = ratio;
}

static void say_summary(const bench *b, summary *all) {
    for (int set = 0; set < SETS; set++) {
        if (all->count[set] > 1 && isfinite(all->least[set])) {
            bench_say(b, "%-15s median of %zu: %.2f, worst: %.2f, %s\n", sets[set].name,
                      all->count[set], bench_median(all->ratios[set], all->count[set]),
                      all->least[set], all->worst[set]);
        }
    }
}

static void add_row(rig *r, int set, size_t count, const figures *f) {
    const double *t = f->embree_s, rays = (double)count;
    double theirs = sets[set].rival == RIVAL_SINGLE     ? t[BENCH_EMBREE_SINGLE]
                    : sets[set].rival == RIVAL_COHERENT ? t[BENCH_EMBREE_COHERENT]
                                                        : fmin(fmin(t[0], t[1]), t[2]);
    /* Goals are for the whole sets of the scenes at hand. */
    bool has_goal = r->embree && !r->b->quick && r->index < BESIDE_SCENES && set != VERTICES;
    bool at_vertices = set == VERTICES;
    summarize(r->all, set, r->scene.name, theirs / f->ours_s);
    const bench_cell cells[] = {
        BENCH_TEXT(r->scene.name),
        BENCH_NUMBER(r->triangles),
        BENCH_NUMBER(r->build_s),
        BENCH_NUMBER(r->embree_build_s),
        BENCH_TEXT(sets[set].name),
        BENCH_NUMBER(count),
        BENCH_NUMBER(f->hits),
        BENCH_TEXT(asdic_caster_kernel(r->caster)),
        BENCH_NUMBER(rays / f->ours_s),
        BENCH_NUMBER(rays / t[BENCH_EMBREE_SINGLE]),
        BENCH_NUMBER(rays / t[BENCH_EMBREE_PACKET]),
        BENCH_NUMBER(rays / t[BENCH_EMBREE_COHERENT]),
        BENCH_NUMBER(theirs / f->ours_s),
        BENCH_NUMBER(has_goal ? sets[set].goal[r->index] : NAN),
        BENCH_NUMBER(r->embree ? (double)f->disagree : NAN),
        BENCH_NUMBER(at_vertices ? (double)f->ours.missed : NAN),
        BENCH_NUMBER(at_vertices ? (double)f->ours.grazed : NAN),
        BENCH_NUMBER(at_vertices ? (double)f->ours.passed : NAN),
        BENCH_NUMBER(at_vertices && r->robust ? (double)f->robust.missed : NAN),
        BENCH_NUMBER(at_vertices && r->robust ? (double)f->robust.grazed : NAN),
        BENCH_TEXT(bench_embree_version() ? bench_embree_version() : "")};
    bench_add(r->b, cells);
}

static asdic_status measure_set(rig *r, int set, const asdic_ray *rays, size_t count) {
    bench_ray_effort effort = bench_ray_effort_of(r->b);
    bool few = set < BENCH_RAY_SETS && bench_ray_set_is_few((bench_ray_set)set);
    figures f = {.hits = 0};
    if (count == 0) {
        return ASDIC_OK; /* nothing was met that could mirror */
    }
    TRY(time_rays(r, rays, count, few ? effort.few_repeats : effort.dense_repeats, &f));
    count_hits(r, count, &f);
    if (set == VERTICES) {
        judge_vertices(r, rays, count, &f);
    }
    add_row(r, set, count, &f);
    return ASDIC_OK;
}

static asdic_status measure_sets(rig *r) {
    bench_ray_effort effort = bench_ray_effort_of(r->b);
    for (int set = 0; set < BENCH_RAY_SETS; set++) {
        size_t count = bench_ray_set_is_few((bench_ray_set)set) ? effort.few : effort.dense;
        bench_rays_fill((bench_ray_set)set, &r->scene, r->rays, count);
        TRY(measure_set(r, set, r->rays, count));
        if (set == BENCH_CONE_DENSE || set == BENCH_SPHERE_RANDOM) {
            size_t kept = bench_rays_mirror(r->corners_m, r->rays, r->hits, count, r->mirrored);
            int mirrored = set == BENCH_CONE_DENSE ? MIRRORED_DENSE : MIRRORED_RANDOM;
            TRY(measure_set(r, mirrored, r->mirrored, kept));
        }
    }
    bench_rays_at_vertices(&r->scene, r->corners_m, r->triangles, r->rays, effort.dense);
    return measure_set(r, VERTICES, r->rays, effort.dense);
}

/* Builds both hierarchies in turn; the last ones stay. */
static asdic_status build(rig *r) {
    size_t builds = r->b->quick ? 1 : MOST_BUILDS;
    double theirs_s = NAN;
    r->build_s = r->embree_build_s = INFINITY;
    for (size_t k = 0; k < builds; k++) {
        asdic_scene_destroy(&r->scene.scene);
        bench_embree_destroy(r->embree);
        free(r->corners_m);
        r->embree = NULL;
        r->corners_m = NULL;
        TRY(r->index < BESIDE_SCENES
                ? beside_scene(r->b, r->index, &r->scene)
                : bench_ray_scene_load(r->b, cli_operand(r->b->c, r->index - BESIDE_SCENES + 1),
                                       &r->scene));
        r->build_s = fmin(r->build_s, asdic_scene_get_info(r->scene.scene).hierarchy_s);
        r->corners_m = beside_corners(&r->scene, &r->triangles);
        if (!r->corners_m) {
            return ASDIC_ERROR_MEMORY;
        }
        r->embree =
            bench_embree_create(r->corners_m, r->triangles, r->b->threads, false, &theirs_s);
        r->embree_build_s = fmin(r->embree_build_s, theirs_s);
    }
    r->robust = bench_embree_create(r->corners_m, r->triangles, r->b->threads, true, &theirs_s);
    r->embree_build_s = r->embree ? r->embree_build_s : NAN;
    return ASDIC_OK;
}

static asdic_status measure(rig *r) {
    size_t most = bench_ray_effort_of(r->b).dense;
    TRY(build(r));
    r->rays = malloc(most * sizeof *r->rays);
    r->mirrored = malloc(most * sizeof *r->mirrored);
    r->hits = malloc(most * sizeof *r->hits);
    r->theirs = calloc(most, sizeof *r->theirs);
    if (!r->rays || !r->mirrored || !r->hits || !r->theirs) {
        return ASDIC_ERROR_MEMORY;
    }
    TRY(asdic_caster_create(cli_context(r->b->c), r->b->device, r->scene.scene,
                            cli_text(r->b->c, "kernel"), &r->caster));
    return measure_sets(r);
}

/* One scene after the other. */
static asdic_status measure_scenes(bench *b, size_t named, summary *all) {
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; !status && i < (named ? named : BESIDE_SCENES); i++) {
        rig r = {.b = b, .all = all, .index = named ? BESIDE_SCENES + i : i};
        status = measure(&r);
        asdic_caster_destroy(&r.caster);
        bench_embree_destroy(r.embree);
        bench_embree_destroy(r.robust);
        asdic_scene_destroy(&r.scene.scene);
        free(r.corners_m);
        free(r.rays);
        free(r.mirrored);
        free(r.hits);
        free(r.theirs);
    }
    return status;
}

asdic_status beside(bench *b) {
    size_t named = bench_scene_count(b);
    summary all = {.count = {0}};
    bench_say(b, "%u thread%s, %s%s\n", b->threads, b->threads == 1 ? "" : "s",
              bench_embree_version() ? "beside Embree " : "without Embree",
              bench_embree_version() ? bench_embree_version() : "");
    asdic_status status = ASDIC_OK;
    for (int set = 0; set < SETS; set++) {
        all.ratios[set] = malloc((named + BESIDE_SCENES) * sizeof **all.ratios);
        status = all.ratios[set] ? status : ASDIC_ERROR_MEMORY;
    }
    status = status ? status : measure_scenes(b, named, &all);
    if (!status) {
        say_summary(b, &all);
    }
    for (int set = 0; set < SETS; set++) {
        free(all.ratios[set]);
    }
    return status;
}
