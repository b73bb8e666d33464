#include "simulator.h"

#include <asdic/plan.h>

#include "base/context.h"
#include "base/share.h"
#include "base/try.h"
#include "base/vec.h"
#include "coherent.h"
#include "drift.h"
#include "laws/tabulate.h"
#include "layers.h"
#include "plan_case.h"
#include "points.h"
#include "pulse.h"
#include "scene/lifted.h"
#include "truth.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Each ping goes through the accumulators of all groups. There are fewer groups where the accumulators do
 * not fit a processor's nearer cache, fewer still where they are huge. Stated errors are as true with 8 and
 * with 4 groups as with 16. */
#define NEAR_CACHE_BYTES ((size_t)2 << 20)
#define GROUP_BYTES_LIMIT ((size_t)16 << 20)
/* The accumulators of pings that go to the device together: they stay in a cache until they are summed and
 * cleared. */
#define PING_BATCH_BYTES_LIMIT ((size_t)4 << 20)
/* PoCL keeps the private variables of a whole work-group, some 2 kB a ray or vector of rays, on one
 * stack of 8 MB; no device gains by more. */
#define LOCAL_LIMIT 1024

/* The tracer takes the form that is compiled first for so many rays, a second of two processors: a driver takes as
 * long for the others where its cache lacks them, which pays where at least as many rays follow. */
#define FEW_RAYS 10000000u

asdic_layout asdic_layout_default(const asdic_device_info *info) {
    bool cpu = info->kind == ASDIC_DEVICE_CPU && !asdic_driver_refuses_vectors(info);
    asdic_layout layout = {.width = cpu ? 8 : 1, .local = cpu ? 16 : 64};
    layout.deposit = cpu                       ? ASDIC_DEPOSIT_COLLECT
                     : info->has_int64_atomics ? ASDIC_DEPOSIT_ATOMIC64
                                               : ASDIC_DEPOSIT_ATOMIC32;
    layout.workers = info->compute_units;
    layout.batch_slots = (size_t)1 << 20;
    layout.ping_batch_slots = (size_t)1 << (cpu ? 13 : 18);
    layout.threads = asdic_processors();
    if (info->kind == ASDIC_DEVICE_CPU && info->compute_units < layout.threads) {
        layout.threads =
            info->compute_units; /* the user's wish, where it is a part of a processor */
    }
    layout.thread_cells = (size_t)1
                          << 14; /* their levels take some four times as long as a thread's start */
    return layout;
}

static unsigned group_count(size_t cells) {
    size_t bytes = DEV_DEPOSIT_COUNT * cells * sizeof(int64_t);
    return bytes * DEV_MAX_GROUPS <= NEAR_CACHE_BYTES          ? DEV_MAX_GROUPS
           : bytes * (DEV_MAX_GROUPS / 2) <= GROUP_BYTES_LIMIT ? DEV_MAX_GROUPS / 2
                                                               : DEV_MAX_GROUPS / 4;
}

/* How many pings go to the device together: those whose rays need one batch. A fan's pings are large and
 * go one by one. */
static size_t ping_batch_size(const asdic_simulator *sim) {
    if (sim->setup.sampling.coherent) {
        return 1;
    }
    size_t slots = sim->setup.groups * sim->setup.per_group;
    size_t bytes = sim->setup.groups * sim->setup.components * sim->setup.cells * sizeof(int64_t);
    size_t size = sim->setup.layout.ping_batch_slots / slots;
    size = size * bytes > PING_BATCH_BYTES_LIMIT ? PING_BATCH_BYTES_LIMIT / bytes : size;
    size = size > ASDIC_LEARN_BLOCK ? ASDIC_LEARN_BLOCK : size;
    return size == 0 || sim->fan.many || slots < sim->setup.sampling.rays ? 1 : size;
}

static asdic_status create_kernels(asdic_simulator *sim) {
    /* A program is made with no more than it depends on: scenes that differ elsewhere share it. */
    char draw[160], reduce[160], ping[160];
    const unsigned width = sim->setup.layout.width;
    const int deposit = (int)sim->setup.layout.deposit, mesh = sim->tracer ? 1 : 0;
    bool water = !(sim->setup.sampling.left_out & (1u << ASDIC_TERM_VOLUME));
    const char *bent = sim->setup.layer_count         ? " -D ASDIC_BENT=2"
                       : sim->setup.bend_per_m != 0.0 ? " -D ASDIC_BENT=1"
                                                      : "";
    snprintf(draw, sizeof draw, "-D ASDIC_WIDTH=%u -D ASDIC_HAS_MESH=%d%s", width, mesh, bent);
    snprintf(reduce, sizeof reduce, "-D ASDIC_WIDTH=%u -D ASDIC_DEPOSIT=%d", width, deposit);
    snprintf(ping, sizeof ping,
             "-D ASDIC_WIDTH=%u -D ASDIC_DEPOSIT=%d -D ASDIC_HAS_MESH=%d -D ASDIC_COMMON_AXIS=%d "
             "-D ASDIC_HAS_WATER=%d -D ASDIC_HAS_MIRRORS=%d%s%s",
             width, deposit, mesh, sim->fan.common_axis, water, sim->setup.has_mirrors ? 1 : 0,
             bent, sim->setup.sampling.truth ? " -D ASDIC_TRUTH=1" : "");
    bool collects = sim->setup.layout.deposit == ASDIC_DEPOSIT_COLLECT;
    bool adaptive = sim->setup.sampling.sampler == ASDIC_SAMPLER_ADAPTIVE;
    const struct {
        const char *file, *options, *name;
        asdic_kernel **kernel;
        bool needed;
    } wanted[] = {
        {"draw.cl", draw, "sample", &sim->kernels.sample, true},
        {"ping.cl", ping, "shade", &sim->kernels.shade, true},
        {"ping.cl", ping, "advance", &sim->kernels.advance, sim->setup.layer_count > 0},
        {"ping.cl", ping, "volume", &sim->kernels.volume, sim->setup.layer_count > 0 && water},
        {"ping.cl", ping, "collect", &sim->kernels.collect, collects && !sim->fan.many},
        {"reduce.cl", reduce, "suffix", &sim->kernels.suffix, !collects},
        {"reduce.cl", reduce, "reduce", &sim->kernels.reduce, !sim->fan.many},
        {"draw.cl", draw, "pilot", &sim->kernels.pilot, adaptive},
        {"ping.cl", ping, "connect", &sim->kernels.connect, sim->setup.has_mirrors},
        {"ping.cl", ping, "bounce", &sim->kernels.bounce, sim->setup.has_mirrors},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        if (!wanted[i].needed) {
            continue;
        }
        TRY(asdic_kernel_create(sim->device, wanted[i].file, wanted[i].options, wanted[i].name,
                                wanted[i].kernel));
    }
    return asdic_beam_fan_init(sim);
}

bool asdic_simulator_has(const asdic_simulator *sim, unsigned kind) {
    for (size_t i = 0; i < sim->setup.scene->part_count; i++) {
        if (sim->setup.scene->parts[i].kind == kind) {
            return true;
        }
    }
    return false;
}

/* Whether objects are modelled. */
static bool scene_echoes(const asdic_simulator *sim) {
    return asdic_simulator_has(sim, DEV_KIND_OBJECT) &&
           !(sim->setup.sampling.left_out & (1u << ASDIC_TERM_OBJECTS));
}

/* Objects that are left out are not traced either, unless a bottom of triangles is. */
static bool needs_triangles(const asdic_simulator *sim) {
    return scene_echoes(sim) || asdic_simulator_has(sim, DEV_KIND_BOTTOM);
}

/* What the scene's materials and the surface scatter in this water. */
static asdic_status make_scatterers(asdic_simulator *sim, const asdic_water_column *water) {
    asdic_setup *setup = &sim->setup;
    const asdic_scene *scene = setup->scene;
    asdic_law_water in = asdic_water_column_laws(water, &setup->env, &setup->sonar);
    setup->scatterers = calloc(scene->material_count + 1, sizeof *setup->scatterers);
    if (!setup->scatterers) {
        return asdic_fail_memory(sim->ctx, "materials");
    }
    for (size_t i = 0; i < scene->material_count; i++) {
        setup->scatterers[i] = asdic_scatterer_at(&scene->materials[i], &in);
    }
    asdic_scatterer *surface = &setup->scatterers[scene->material_count];
    *surface = asdic_scatterer_at(&scene->surface, &in);
    if (setup->sampling.left_out & (1u << ASDIC_TERM_SURFACE)) {
        asdic_scatterer_silence(surface);
    }
    return ASDIC_OK;
}

static asdic_status upload_materials(asdic_simulator *sim) {
    asdic_law_words words = {0};
    asdic_status status = asdic_law_tables(sim->ctx, sim->setup.scatterers,
                                           sim->setup.scene->material_count + 1, &words);
    status = status ? status
                    : asdic_buffer_create(sim->device, words.count * sizeof *words.words,
                                          words.words, &sim->buffers.materials);
    free(words.words);
    return status;
}

static asdic_status upload_parts(asdic_simulator *sim) {
    const asdic_scene *scene = sim->setup.scene;
    dev_part *parts = calloc(scene->part_count + 1, sizeof *parts);
    if (!parts) {
        return asdic_fail_memory(sim->ctx, "the parts of a scene");
    }
    for (size_t i = 0; i < scene->part_count; i++) {
        parts[i] = asdic_simulator_part(&scene->parts[i], i);
    }
    asdic_status status = asdic_buffer_create(
        sim->device, (scene->part_count + 1) * sizeof(dev_part), parts, &sim->buffers.parts);
    free(parts);
    return status;
}

static asdic_status check_arguments(asdic_context *ctx, const asdic_scene *scene,
                                    const asdic_environment *env, const asdic_sonar *sonar,
                                    const asdic_sampling *sampling) {
    TRY(asdic_environment_check(ctx, env));
    TRY(asdic_sonar_check(ctx, sonar));
    TRY(asdic_coherent_check(ctx, sonar, sampling));
    if (!scene->committed) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "the scene is not committed: call asdic_scene_commit first");
    }
    if ((unsigned)sampling->sampler > ASDIC_SAMPLER_UNIFORM_SPHERE ||
        (unsigned)sampling->multipath > ASDIC_MULTIPATH_BOUNDARIES) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "unknown sampler %d or multipath %d",
                          (int)sampling->sampler, (int)sampling->multipath);
    }
    if ((unsigned)sampling->kernel > ASDIC_RAY_KERNEL_SCALAR) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "unknown ray kernel %d",
                          (int)sampling->kernel);
    }
    if (sampling->truth && sampling->coherent) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "coherent pings have no truth: leave 'truth' or 'coherent' out");
    }
    if (sampling->rays < 64 || sampling->rays > 1u << 28) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "%u rays per ping: out of range [64, 268435456]", sampling->rays);
    }
    return ASDIC_OK;
}

/* Bins, and how the work on them is laid out. */
static unsigned thread_count(const asdic_simulator *sim) {
    size_t most = sim->setup.layout.threads, worth = sim->setup.layout.thread_cells;
    size_t count = worth > 0 ? sim->setup.cells / worth : 1;
    count = count < most ? count : most;
    return count < 1 ? 1 : count < ASDIC_SHARE_MOST ? (unsigned)count : ASDIC_SHARE_MOST;
}

static void plan_work(asdic_simulator *sim, const asdic_water_column *water) {
    const asdic_sonar *sonar = &sim->setup.sonar;
    asdic_reach reach = asdic_reach_of(sonar, &sim->setup.sampling, water->sound_speed_mps);
    bool casts = !(sim->setup.sampling.left_out & (1u << ASDIC_TERM_RAYS));
    /* Pulses are longer in faster water. */
    sim->setup.margin = casts && reach.margin > 0 ? reach.margin + 1 : 0;
    sim->setup.from_m = reach.from_m;
    sim->setup.bins = reach.bins + sim->setup.margin;
    sim->setup.cells = sim->setup.bins * sim->setup.sonar.receiver_count;
    sim->setup.groups = group_count(sim->setup.cells);
    if (sim->setup.layout.local > LOCAL_LIMIT) {
        sim->setup.layout.local = LOCAL_LIMIT;
    }
    sim->setup.threads = thread_count(sim);
    asdic_beam_fan_plan(&sim->setup.sonar, &sim->fan);
    if (sim->fan.many) { /* the block tells the error */
        sim->setup.groups = 1;
        sim->setup.layout.deposit = ASDIC_DEPOSIT_COLLECT;
    }
    size_t most = asdic_simulator_batch_slots(sim), rays = sim->setup.sampling.rays;
    rays = sim->setup.sampling.coherent ? 0 : rays; /* its scatterers have buffers of their own */
    sim->setup.per_group = asdic_simulator_per_group(sim, rays < most ? rays : most);
}

/* What rays meet, as the water lifts it. */
typedef struct lifted_view {
    asdic_scene *lifted;
    asdic_placement *placement;
    asdic_tracer *tracer;
} lifted_view;

static void finish_view(lifted_view *view) {
    asdic_tracer_destroy(&view->tracer);
    asdic_placement_destroy(&view->placement);
    asdic_scene_unlift(&view->lifted);
}

/* Of the scene as it was committed. */
static asdic_status make_view(asdic_simulator *sim, lifted_view *view) {
    asdic_ray_kernel kernel = sim->setup.sampling.kernel;
    const asdic_scene *scene = sim->setup.scene;
    if (sim->setup.layer_count > 0) {
        TRY(asdic_scene_lift_layers(scene, sim->setup.layers, sim->setup.layer_count,
                                    &view->lifted));
        scene = view->lifted;
    } else if (sim->setup.bend_per_m != 0.0) {
        TRY(asdic_scene_lift(scene, sim->setup.bend_per_m, &view->lifted));
        scene = view->lifted;
    }
    TRY(asdic_placement_create(scene, &view->placement));
    if (sim->device && needs_triangles(sim)) {
        TRY(asdic_tracer_create(sim->device, scene, &view->tracer));
        asdic_tracer_wait(view->tracer, FEW_RAYS);
    }
    if (view->tracer && sim->setup.layer_count > 0) { /* to the layers that they are in */
        TRY(asdic_tracer_move_all(view->tracer, view->placement));
    }
    return view->tracer && kernel != ASDIC_RAY_KERNEL_AUTO
               ? asdic_tracer_set_kernel(view->tracer, asdic_tracer_kernel_name((size_t)kernel - 1))
               : ASDIC_OK;
}

/* Takes VIEW, which may be half made, and gives what there was. */
static void swap_view(asdic_simulator *sim, lifted_view *view) {
    lifted_view own = {sim->lifted, sim->placement, sim->tracer};
    sim->lifted = view->lifted;
    sim->placement = view->placement;
    sim->tracer = view->tracer;
    *view = own;
}

/* What the device needs of the scene. */
static asdic_status bring_scene(asdic_simulator *sim, const asdic_water_column *water) {
    lifted_view view = {0};
    asdic_status status = make_view(sim, &view);
    swap_view(sim, &view);
    TRY(status);
    TRY(make_scatterers(sim, water));
    TRY(sim->device ? upload_materials(sim) : ASDIC_OK);
    TRY(sim->device ? upload_parts(sim) : ASDIC_OK);
    const asdic_law_water in = asdic_water_column_laws(water, &sim->setup.env, &sim->setup.sonar);
    sim->setup.has_mirrors =
        !(sim->setup.sampling.left_out & (1u << ASDIC_TERM_MULTIPATH)) &&
        asdic_scene_mirrors(sim->setup.scene, sim->setup.sampling.multipath, &in);
    sim->setup.components = sim->setup.has_mirrors ? DEV_DEPOSIT_COUNT
                            : scene_echoes(sim)    ? DEV_DEPOSIT_OBJECT + 1u
                                                   : DEV_DEPOSIT_OBJECT;
    sim->fan.sums = sim->setup.components + sim->setup.sampling.truth + sim->setup.has_mirrors;
    sim->fan.row = DEV_FAN_ROW(sim->setup.bins);
    return ASDIC_OK;
}

/* The depths that rays may reach: of all there is. */
static void scene_depths(const asdic_scene *scene, double sonar_m, double *from_m, double *to_m) {
    *from_m = scene->has_surface ? fmin(sonar_m, 0.0) : sonar_m;
    *to_m = sonar_m;
    if (scene->has_bottom_plane) {
        *to_m = fmax(*to_m, scene->bottom_plane_depth_m);
    }
    if (scene->triangle_count > 0) {
        *from_m = fmin(*from_m, fmax(scene->min_m.z, 0.0));
        *to_m = fmax(*to_m, scene->max_m.z);
    }
}

/* Without a bottom, or a surface, nothing ends rays but the range. The sound speed must be one of water wherever they
 * come, as in asdic_expected_compute. */
static asdic_status check_water(const asdic_simulator *sim, double sonar_m, double from_m,
                                double to_m) {
    const asdic_setup *setup = &sim->setup;
    double speed_mps = asdic_environment_sound_speed_mps(&setup->env, sonar_m);
    double range_m = asdic_reach_of(&setup->sonar, &setup->sampling, speed_mps).to_m;
    if (!setup->scene->has_surface) {
        from_m = fmin(from_m, fmax(sonar_m - range_m, 0.0));
    }
    if (!setup->scene->has_bottom_plane && !asdic_simulator_has(sim, DEV_KIND_BOTTOM)) {
        to_m = fmax(to_m, sonar_m + range_m);
    }
    return asdic_environment_check_depths(sim->ctx, &setup->env, from_m, to_m);
}

/* A triangle so near a layer is taken to lie in it: more than what lifted.c allows, and than rounding. */
#define NEAR_M 0.1

/* X or more: the next of 1, 1.25, 1.5, 1.75 times a power of two. */
static double round_up(double x) {
    int exponent;
    double fraction = frexp(x, &exponent);
    return ldexp(ceil(8.0 * fraction), exponent - 3);
}

/* Lifted, no layer may touch another's out to REACH_M from the frame's origin. One lies below the other as it is: each is
 * moved down by more than its triangles may stand out of it and than lifting moves them, and no farther, since a tracer
 * rounds as coordinates are large; rounded up so far that scenes whose poses and objects differ a little are lifted
 * alike. */
static void part_layers(asdic_setup *setup, double reach_m) {
    const asdic_lift_room *room = &setup->lift_room;
    double wide2 = reach_m * reach_m + 0.25 * room->high_m * room->high_m;
    double apart = round_up(1.1 * (room->tall_m + room->bend_per_m * wide2) + NEAR_M);
    for (size_t i = 0; i < setup->layer_count; i++) {
        setup->layers[i].shift_m =
            (float)(apart * ((double)i - 0.5 * (double)(setup->layer_count - 1)));
    }
    setup->lift_room.reach_m = reach_m;
}

/* LAYERS in the scene frame. */
static void place_layers(asdic_simulator *sim, const asdic_layers *layers, double depth_m) {
    const asdic_scene *scene = sim->setup.scene;
    const asdic_sonar *sonar = &sim->setup.sonar;
    asdic_lift_room *room = &sim->setup.lift_room;
    asdic_vec3 above = asdic_vec3_sub(scene->max_m, scene->origin_m);
    asdic_vec3 below = asdic_vec3_sub(scene->origin_m, scene->min_m);
    /* Of a box round the origin that holds the scene: objects may lie on one side of it. */
    asdic_vec3 size = {2.0 * fmax(above.x, below.x), 2.0 * fmax(above.y, below.y),
                       2.0 * fmax(above.z, below.z)};
    double pulse_m = asdic_pulse_bins(sonar, ASDIC_SOUND_MOST_MPS) * sonar->bin_length_m;
    double range_m = asdic_sonar_max_range_m(sonar, ASDIC_SOUND_MOST_MPS);
    double beyond_m = pulse_m > sonar->bin_length_m ? fmin(0.5 * pulse_m, range_m) : 0.0;
    *room = (asdic_lift_room){
        .high_m = size.z + fabs(depth_m - scene->origin_m.z) +
                  asdic_sonar_max_range_m(sonar, 1500.0) + beyond_m,
        .rays_m = (range_m + beyond_m) * (ASDIC_SOUND_MOST_MPS / ASDIC_SOUND_LEAST_MPS),
        .tall_m = scene->triangle_count > 0 ? scene->max_m.z - scene->min_m.z : 0.0,
        .least_m = 0.5 * hypot(size.x, size.y),
    };
    for (size_t i = 0; i < scene->movable_count; i++) { /* however it turns */
        double radius_m = scene->parts[scene->movables[i].part].radius_m;
        room->tall_m = fmax(room->tall_m, 2.0 * radius_m);
    }
    if (scene->movable_count > 0) { /* a sonar in that box hears what moves beside it */
        room->least_m = fmax(room->least_m, ASDIC_LAYERED_STEP_M) + room->rays_m;
    }
    for (size_t i = 0; i < layers->count; i++) {
        const asdic_layer *l = &layers->layer[i];
        double bend = l->gradient_per_s / asdic_layer_speed_mps(l, scene->origin_m.z);
        room->bend_per_m = fmax(room->bend_per_m, fabs(bend));
        bool empty = scene->triangle_count == 0 || l->top_m > scene->max_m.z + NEAR_M ||
                     l->bottom_m < scene->min_m.z - NEAR_M;
        empty = empty && scene->movable_count == 0; /* where those go is not known yet */
        sim->setup.layers[i] = (dev_layer){(float)fmax(l->top_m - scene->origin_m.z, -1e5),
                                           (float)fmin(l->bottom_m - scene->origin_m.z, 1e5),
                                           (float)bend, 0.0f, !empty};
    }
    sim->setup.layer_count = layers->count;
    part_layers(&sim->setup, room->least_m);
}

/* As OLD has them. */
static void move_alike(const asdic_placement *old, asdic_placement *placement) {
    const asdic_scene *scene = placement->scene;
    for (size_t i = 0; i < scene->movable_count / asdic_scene_copies(scene); i++) {
        asdic_placement_move(placement, i, &old->poses[i]);
    }
    memcpy(placement->points, old->points, scene->point_count * sizeof *old->points);
}

asdic_status asdic_simulator_part_layers(asdic_simulator *sim, double reach_m) {
    double before_m = sim->setup.lift_room.reach_m;
    size_t bytes = sim->setup.layer_count * sizeof *sim->setup.layers;
    lifted_view view = {0};
    part_layers(&sim->setup, reach_m);
    asdic_status status = make_view(sim, &view);
    if (!status) {
        move_alike(sim->placement, view.placement);
        status = view.tracer ? asdic_tracer_move_all(view.tracer, view.placement) : ASDIC_OK;
    }
    status = status ? status : asdic_device_finish(sim->device);
    status = status ? status : asdic_buffer_write(sim->buffers.layers, 0, bytes, sim->setup.layers);
    if (status) {
        part_layers(&sim->setup, before_m);
    } else {
        swap_view(sim, &view);
    }
    finish_view(&view);
    return status;
}

/* How rays bend: as in one layer, which is fitted between the sonar and the bottom where there are more. */
static asdic_status plan_bend(asdic_simulator *sim, double depth_m) {
    const asdic_scene *scene = sim->setup.scene;
    asdic_environment *env = &sim->setup.env;
    asdic_layers layers;
    double from_m, to_m;
    scene_depths(scene, depth_m, &from_m, &to_m);
    TRY(check_water(sim, depth_m, from_m, to_m));
    asdic_layers_of(env, depth_m, &layers);
    if (scene->has_bottom_plane) {
        /* A sonar on it is taken to be a little above it (LEAST_PLANE in shot.c): no other water begins in between. */
        asdic_layers_end(&layers, scene->bottom_plane_depth_m);
    }
    if (layers.count > 1) {
        asdic_environment one = *env;
        one.refraction = ASDIC_REFRACTION_LAYER;
        one.layer_from_m = fmax(depth_m, 0.0);
        one.layer_to_m = fmax(to_m, one.layer_from_m);
        place_layers(sim, &layers, depth_m);
        asdic_layers_of(&one, depth_m, &layers);
    }
    const asdic_layer *layer = &layers.layer[0];
    sim->setup.bend_per_m = layer->gradient_per_s / asdic_layer_speed_mps(layer, scene->origin_m.z);
    return ASDIC_OK;
}

/* Everything of SIM that follows from its setup, for a sonar in WATER. */
static asdic_status furnish(asdic_simulator *sim, const asdic_water_column *water) {
    const asdic_scene *scene = sim->setup.scene;
    TRY(asdic_sonar_check_bins(sim->ctx, &sim->setup.sonar, water->sound_speed_mps));
    plan_work(sim, water);
    TRY(bring_scene(sim, water));
    sim->setup.ping_batch = ping_batch_size(sim);
    TRY(asdic_store_create_host(sim));
    asdic_simulator_prepare(sim, water);
    if (!sim->device) {
        return ASDIC_OK; /* it foresees */
    }
    if (!sim->setup.sampling.coherent) {
        TRY(create_kernels(sim));
    }
    TRY(asdic_store_create_device(sim));
    /* Rays that bend in layers would miss the faces they are aimed at by one fitted bend, and those faces' energy. */
    bool aims = scene_echoes(sim) && sim->setup.layer_count == 0;
    TRY(asdic_faces_init(&sim->learnt.faces, sim->device, aims ? scene : NULL));
    TRY(asdic_truth_init(sim));
    TRY(asdic_speckle_create(sim->ctx, &sim->setup.sonar, water->sound_speed_mps,
                             asdic_simulator_bin_count(sim), sim->setup.threads, &sim->speckle));
    asdic_simulator_forget(sim);
    return sim->setup.sampling.coherent ? asdic_coherent_create(sim, water, &sim->coherent)
                                        : ASDIC_OK;
}

asdic_status asdic_simulator_check_depth(asdic_context *ctx, double depth_m) {
    return fabs(depth_m) <= 11000.0
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                            "the sonar's depth, %g m, is out of range [-11000, 11000] m", depth_m);
}

asdic_status asdic_simulator_create_with(asdic_context *ctx, asdic_device *device,
                                         const asdic_scene *scene, const asdic_environment *env,
                                         const asdic_sonar *sonar, const asdic_sampling *sampling,
                                         double depth_m, const asdic_layout *layout,
                                         asdic_simulator **out) {
    if (!scene || !env || !sonar || !sampling) {
        return asdic_fail_null(ctx, "asdic_simulator_create");
    }
    TRY(check_arguments(ctx, scene, env, sonar, sampling));
    TRY(asdic_simulator_check_depth(ctx, depth_m));
    asdic_simulator *sim = calloc(1, sizeof *sim);
    if (!sim) {
        return asdic_fail_memory(ctx, "a simulator");
    }
    *sim = (asdic_simulator){.ctx = ctx,
                             .device = device,
                             .setup = {.scene = scene,
                                       .env = *env,
                                       .sonar = *sonar,
                                       .sampling = *sampling,
                                       .layout = *layout}};
    if (sampling->truth) { /* quadrature tells no directions */
        sim->setup.sampling.left_out &= ~(1u << ASDIC_TERM_RAYS);
    }
    const unsigned left_out = sim->setup.sampling.left_out;
    if ((left_out & (1u << ASDIC_TERM_BORIC_ACID)) && !(left_out & (1u << ASDIC_TERM_RAYS))) {
        /* 10^(0.78 pH - 5), its strength, is then zero. Quadrature asks for a pH. */
        sim->setup.env.ph = -INFINITY;
    }
    asdic_status status = plan_bend(sim, depth_m);
    if (!status) {
        const asdic_water_column water = asdic_water_column_at(&sim->setup.env, sonar, depth_m);
        status = furnish(sim, &water);
    }
    if (status) {
        asdic_simulator_destroy(&sim);
    }
    *out = sim;
    return status;
}

asdic_status asdic_simulator_create(asdic_context *ctx, asdic_device *device,
                                    const asdic_scene *scene, const asdic_environment *env,
                                    const asdic_sonar *sonar, const asdic_sampling *sampling,
                                    double depth_m, asdic_simulator **out) {
    if (!ASDIC_PLACE(out) || !device) {
        return asdic_fail_null(ctx, __func__);
    }
    asdic_layout layout = asdic_layout_default(asdic_device_get_info(device));
    return asdic_simulator_create_with(ctx, device, scene, env, sonar, sampling, depth_m, &layout,
                                       out);
}

void asdic_simulator_destroy(asdic_simulator **pointer) {
    if (!pointer || !*pointer) {
        return;
    }
    asdic_simulator *sim = *pointer;
    if (sim->device) {
        asdic_device_abandon(sim->device); /* it may still read what it was sent */
    }
    asdic_kernel **kernels = (asdic_kernel **)&sim->kernels;
    for (size_t i = 0; i < sizeof sim->kernels / sizeof *kernels; i++) {
        asdic_kernel_destroy(&kernels[i]);
    }
    asdic_beam_fan_finish(&sim->fan);
    asdic_quadrature_finish(&sim->quadrature);
    asdic_speckle_destroy(&sim->speckle);
    asdic_coherent_destroy(&sim->coherent);
    asdic_faces_finish(&sim->learnt.faces);
    asdic_points_finish(sim);
    asdic_truth_finish(sim);
    asdic_sight_finish(&sim->sight);
    finish_view(&(lifted_view){sim->lifted, sim->placement, sim->tracer});
    asdic_calibration_destroy(&sim->learnt.calibration);
    asdic_drift_destroy(&sim->learnt.drift);
    asdic_store_destroy(sim);
    free(sim);
    *pointer = NULL;
}

asdic_buffer *asdic_simulator_triangles(const asdic_simulator *sim) {
    return sim->tracer ? asdic_tracer_triangles(sim->tracer) : sim->buffers.no_triangles;
}

void asdic_simulator_hasten(asdic_simulator *sim) {
    if (sim->tracer) {
        asdic_tracer_wait(sim->tracer, 0);
    }
}

size_t asdic_simulator_bin_count(const asdic_simulator *sim) {
    return sim ? sim->setup.bins - sim->setup.margin : 0;
}
