#include "simulator.h"

#include <asdic/plan.h>

#include "base/context.h"
#include "materials.h"
#include "points.h"
#include "scene/scene.h"
#include "water_column.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A group's accumulator is cleared and summed every ping: fewer groups where it is large. */
#define GROUP_BYTES_LIMIT ((size_t)16 << 20)
/* PoCL keeps the private variables of a whole work-group, some 2 kB a ray or vector of rays, on one
 * stack of 8 MB; no device gains by more. */
#define LOCAL_LIMIT 1024

asdic_layout asdic_layout_default(const asdic_device_info *info) {
    bool cpu = info->kind == ASDIC_DEVICE_CPU;
    asdic_layout layout = {.width = cpu ? 8 : 1, .local = cpu ? 16 : 64};
    layout.deposit = cpu                       ? ASDIC_DEPOSIT_OWNED
                     : info->has_int64_atomics ? ASDIC_DEPOSIT_ATOMIC64
                                               : ASDIC_DEPOSIT_ATOMIC32;
    layout.batch_slots = (size_t)1 << 20;
    return layout;
}

static unsigned group_count(size_t cells) {
    unsigned groups = DEV_MAX_GROUPS;
    while (groups > 4 && groups * DEV_DEPOSIT_COUNT * cells * sizeof(int64_t) > GROUP_BYTES_LIMIT) {
        groups /= 2;
    }
    return groups;
}

static asdic_status create_kernels(asdic_simulator *sim) {
    char options[160];
    snprintf(options, sizeof options,
             "-D ASDIC_WIDTH=%u -D ASDIC_DEPOSIT=%d -D ASDIC_HAS_MESH=%d -D ASDIC_FAN=%d "
             "-D ASDIC_HAS_WATER=%d -D ASDIC_HAS_MIRRORS=%d",
             sim->layout.width, (int)sim->layout.deposit, sim->tracer ? 1 : 0,
             sim->fan.cells ? 1 : 0, sim->sampling.left_out & (1u << ASDIC_TERM_VOLUME) ? 0 : 1,
             sim->has_mirrors ? 1 : 0);
    bool owned = sim->layout.deposit == ASDIC_DEPOSIT_OWNED;
    bool adaptive = sim->sampling.sampler == ASDIC_SAMPLER_ADAPTIVE;
    const struct {
        const char *name;
        asdic_kernel **kernel;
        bool needed;
    } wanted[] = {
        {"sample", &sim->sample, true},
        {"shade", &sim->shade, true},
        {"collect", &sim->collect, owned},
        {"suffix", &sim->suffix, !owned && !sim->fan.cells},
        {"reduce", &sim->reduce, !sim->fan.cells},
        {"survey", &sim->survey, adaptive},
        {"connect", &sim->connect, sim->has_mirrors},
        {"bounce", &sim->bounce, sim->has_mirrors},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        if (!wanted[i].needed) {
            continue;
        }
        asdic_status status =
            asdic_kernel_create(sim->device, "ping.cl", options, wanted[i].name, wanted[i].kernel);
        if (status) {
            return status;
        }
    }
    return asdic_beam_fan_init(&sim->fan, sim->device, sim->layout.width,
                               sim->components * sim->bins);
}

static size_t ping_bytes(const asdic_simulator *sim) {
    return sizeof(dev_ping) + (sim->sonar.receiver_count + 1) * sizeof(dev_beam);
}

/* Sums, one word of cut deposits, spreads; of a fan: sums as floats, the word. */
size_t asdic_simulator_results_bytes(const asdic_simulator *sim) {
    if (sim->fan.cells) {
        return sim->components * sim->cells * sizeof(float) + sizeof(uint32_t);
    }
    return (sim->components * sim->cells + 1) * sizeof(int64_t) + sim->cells * sizeof(float);
}

size_t asdic_simulator_per_group(const asdic_simulator *sim, size_t rays) {
    size_t most = sim->layout.batch_slots, step = sim->groups == 1 ? 64 : 16;
    rays = rays < most ? rays : most;
    return ((rays + sim->groups - 1) / sim->groups + step - 1) / step * step;
}

static asdic_status create_buffers(asdic_simulator *sim) {
    size_t pilot = asdic_simulator_per_group(sim, ASDIC_PILOT_RAYS);
    size_t most = sim->per_group > pilot ? sim->per_group : pilot;
    size_t slots = sim->groups * most;
    size_t bounce_slots = sim->has_mirrors ? slots : 0;
    size_t sets = sim->layout.deposit != ASDIC_DEPOSIT_OWNED ? 0 : sim->has_mirrors ? 3 : 1;
    size_t accumulator = sim->groups * (size_t)sim->fixed.group_cells * sizeof(int64_t) +
                         asdic_beam_fan_tail_bytes(&sim->fan, sim->components * sim->bins);
    const struct {
        size_t bytes;
        asdic_buffer **buffer;
    } wanted[] = {
        {ping_bytes(sim), &sim->ping_buffer},
        {(DEV_TABLE_CELLS + 1) * sizeof(float), &sim->table_buffer},
        {slots * sizeof(dev_ray), &sim->rays},
        {slots * sizeof(float), &sim->solid_angles},
        {slots * sizeof(float), &sim->splats},
        {sim->tracer ? slots * sizeof(dev_hit) : 0, &sim->hits},
        {bounce_slots * sizeof(dev_ray), &sim->bounced},
        {bounce_slots * sizeof(dev_hit), &sim->bounced_hits},
        {bounce_slots * sizeof(dev_ray), &sim->returning},
        {bounce_slots * sizeof(dev_hit), &sim->returning_hits},
        {bounce_slots * 4 * sizeof(float), &sim->mirrors},
        {sets * slots * sizeof(dev_parcel), &sim->parcels},
        {0, &sim->no_triangles},
        {sim->bins * sizeof(float), &sim->volume_inverse},
        {sim->bins * sizeof(float), &sim->volume_ratio},
        {accumulator, &sim->accumulator},
        {asdic_simulator_results_bytes(sim), &sim->results},
        {sizeof(uint32_t), &sim->saturated},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        asdic_status status =
            asdic_buffer_create(sim->device, wanted[i].bytes, NULL, wanted[i].buffer);
        if (status) {
            return status;
        }
    }
    return ASDIC_OK;
}

bool asdic_simulator_has(const asdic_simulator *sim, unsigned kind) {
    for (size_t i = 0; i < sim->scene->part_count; i++) {
        if (sim->scene->parts[i].kind == kind) {
            return true;
        }
    }
    return false;
}

/* Whether objects are modelled. */
static bool scene_echoes(const asdic_simulator *sim) {
    return asdic_simulator_has(sim, DEV_KIND_OBJECT) &&
           !(sim->sampling.left_out & (1u << ASDIC_TERM_OBJECTS));
}

/* Objects that are left out are not traced either, unless a bottom of triangles is. */
static bool needs_triangles(const asdic_simulator *sim) {
    return scene_echoes(sim) || asdic_simulator_has(sim, DEV_KIND_BOTTOM);
}

/* Whether anything in the scene can pass a mirror ray on. */
static bool scene_has_mirrors(const asdic_simulator *sim) {
    if (sim->sampling.multipath == ASDIC_MULTIPATH_OFF ||
        sim->sampling.left_out & (1u << ASDIC_TERM_MULTIPATH)) {
        return false;
    }
    bool boundaries = sim->sampling.multipath == ASDIC_MULTIPATH_BOUNDARIES;
    if (boundaries && (sim->scene->has_surface || sim->scene->has_bottom_plane)) {
        return true;
    }
    for (size_t i = 0; i < sim->scene->part_count; i++) {
        const asdic_part *part = &sim->scene->parts[i];
        if (boundaries && part->kind == DEV_KIND_BOTTOM) {
            return true;
        }
        if (part->kind == DEV_KIND_OBJECT &&
            sim->host_materials[part->material].law == DEV_LAW_FACET &&
            sim->host_materials[part->material].reflection2 > DEV_MIN_MIRROR) {
            return true;
        }
    }
    return false;
}

/* Scattering coefficients and parts; they depend on the frequency alone. */
static asdic_status upload_materials(asdic_simulator *sim, double sound_speed_mps) {
    const asdic_scene *scene = sim->scene;
    sim->material_count = scene->material_count ? scene->material_count : 1;
    sim->host_materials = calloc(sim->material_count, sizeof(dev_material));
    dev_part *parts = calloc(scene->part_count + 1, sizeof(dev_part));
    asdic_status status = ASDIC_OK;
    if (!sim->host_materials || !parts) {
        status = asdic_fail_memory(sim->ctx, "materials");
        goto done;
    }
    for (size_t i = 0; i < scene->material_count; i++) {
        sim->host_materials[i] = asdic_material_coefficients(
            &scene->materials[i], sim->sonar.frequency_hz, sound_speed_mps);
    }
    for (size_t i = 0; i < scene->part_count; i++) {
        parts[i] = asdic_simulator_part(&scene->parts[i]);
    }
    status = asdic_buffer_create(sim->device, sim->material_count * sizeof(dev_material),
                                 sim->host_materials, &sim->materials);
    if (!status) {
        status = asdic_buffer_create(sim->device, (scene->part_count + 1) * sizeof(dev_part), parts,
                                     &sim->parts);
    }
done:
    free(parts);
    return status;
}

static asdic_status check_arguments(asdic_context *ctx, const asdic_scene *scene,
                                    const asdic_environment *env, const asdic_sonar *sonar,
                                    const asdic_sampling *sampling) {
    asdic_status status = asdic_environment_check(ctx, env);
    if (!status) {
        status = asdic_sonar_check(ctx, sonar);
    }
    if (status) {
        return status;
    }
    if (!scene->committed) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "the scene is not committed: call asdic_scene_commit first");
    }
    if ((unsigned)sampling->kernel > ASDIC_RAY_KERNEL_SCALAR) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "unknown ray kernel %d",
                          (int)sampling->kernel);
    }
    if (sampling->rays < 64 || sampling->rays > 1u << 28) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "%u rays per ping: out of range [64, 268435456]", sampling->rays);
    }
    return ASDIC_OK;
}

static asdic_status allocate_host(asdic_simulator *sim) {
    size_t beams = sim->sonar.receiver_count;
    sim->receivers = malloc(beams * sizeof *sim->receivers);
    sim->ping = calloc(1, ping_bytes(sim));
    sim->bin_table = calloc(2 * sim->bins, sizeof *sim->bin_table);
    sim->bin_loss = calloc(sim->bins, sizeof *sim->bin_loss);
    sim->bin_volume = calloc(sim->bins, sizeof *sim->bin_volume);
    sim->host_results = malloc(asdic_simulator_results_bytes(sim));
    sim->stated = malloc(sim->cells * sizeof *sim->stated);
    sim->smear_scratch = malloc((3 * sim->bins + 1) * sizeof *sim->smear_scratch);
    if (!sim->smear_scratch || !sim->receivers || !sim->stated || !sim->ping || !sim->bin_table ||
        !sim->bin_loss || !sim->bin_volume || !sim->host_results) {
        return asdic_fail_memory(sim->ctx, "a simulator");
    }
    memcpy(sim->receivers, sim->sonar.receivers, beams * sizeof *sim->receivers);
    sim->sonar.receivers = sim->receivers;
    return ASDIC_OK;
}

asdic_status asdic_simulator_create_with(asdic_context *ctx, asdic_device *device,
                                         const asdic_scene *scene, const asdic_environment *env,
                                         const asdic_sonar *sonar, const asdic_sampling *sampling,
                                         double depth_m, const asdic_layout *layout,
                                         asdic_simulator **out) {
    if (!out || !device || !scene || !env || !sonar || !sampling || !layout) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_simulator_create: NULL argument");
    }
    *out = NULL;
    asdic_status status = check_arguments(ctx, scene, env, sonar, sampling);
    if (status) {
        return status;
    }
    if (!isfinite(depth_m)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "the sonar's depth is %g m", depth_m);
    }
    asdic_simulator *sim = calloc(1, sizeof *sim);
    if (!sim) {
        return asdic_fail_memory(ctx, "a simulator");
    }
    *sim = (asdic_simulator){.ctx = ctx,
                             .device = device,
                             .scene = scene,
                             .env = *env,
                             .sonar = *sonar,
                             .sampling = *sampling,
                             .layout = *layout,
                             .tabulated_absorption = -1.0};
    if (sampling->left_out & (1u << ASDIC_TERM_BORIC_ACID)) {
        sim->env.ph = -INFINITY; /* 10^(0.78 pH - 5), its strength, is then zero */
    }
    sim->layout.local = layout->local < LOCAL_LIMIT ? layout->local : LOCAL_LIMIT;
    asdic_water_column water = asdic_water_column_at(env, sonar, depth_m);
    sim->bins = asdic_sonar_bin_count(sonar, water.sound_speed_mps);
    sim->cells = sim->bins * sonar->receiver_count;
    sim->groups = group_count(sim->cells);
    if (!layout->beam_by_beam) {
        asdic_beam_fan_plan(sonar, water.wavelength_m, &sim->fan);
    }
    if (sim->fan.cells) { /* one map that all work-items share; the block tells the error */
        sim->groups = 1;
        sim->layout.deposit = asdic_device_get_info(device)->has_int64_atomics
                                  ? ASDIC_DEPOSIT_ATOMIC64
                                  : ASDIC_DEPOSIT_ATOMIC32;
    }
    size_t most = layout->batch_slots > ASDIC_PILOT_RAYS ? layout->batch_slots : ASDIC_PILOT_RAYS;
    sim->per_group = asdic_simulator_per_group(sim, sampling->rays < most ? sampling->rays : most);
    if ((status = asdic_placement_create(scene, &sim->placement)) != ASDIC_OK) {
        goto fail;
    }
    if (needs_triangles(sim) &&
        (status = asdic_tracer_create(device, scene, &sim->tracer)) != ASDIC_OK) {
        goto fail;
    }
    if (sim->tracer && sampling->kernel != ASDIC_RAY_KERNEL_AUTO &&
        (status = asdic_tracer_set_kernel(
             sim->tracer, asdic_tracer_kernel_name((size_t)sampling->kernel - 1))) != ASDIC_OK) {
        goto fail;
    }
    if ((status = upload_materials(sim, water.sound_speed_mps)) != ASDIC_OK) {
        goto fail;
    }
    sim->has_mirrors = scene_has_mirrors(sim);
    sim->components = sim->has_mirrors    ? DEV_DEPOSIT_COUNT
                      : scene_echoes(sim) ? DEV_DEPOSIT_OBJECT + 1u
                                          : DEV_DEPOSIT_OBJECT;
    if ((status = allocate_host(sim)) != ASDIC_OK) {
        goto fail;
    }
    asdic_simulator_prepare(sim, &water);
    if ((status = create_kernels(sim)) != ASDIC_OK || (status = create_buffers(sim)) != ASDIC_OK) {
        goto fail;
    }
    if ((status = asdic_points_init(sim)) != ASDIC_OK) {
        goto fail;
    }
    asdic_simulator_forget(sim);
    *out = sim;
    return ASDIC_OK;

fail:
    asdic_simulator_destroy(&sim);
    return status;
}

asdic_status asdic_simulator_create(asdic_context *ctx, asdic_device *device,
                                    const asdic_scene *scene, const asdic_environment *env,
                                    const asdic_sonar *sonar, const asdic_sampling *sampling,
                                    double depth_m, asdic_simulator **out) {
    if (!device) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_simulator_create: device is NULL");
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
    asdic_device_finish(sim->device); /* it may still read what a failed ping sent */
    asdic_buffer **buffers[] = {
        &sim->ping_buffer, &sim->table_buffer,   &sim->rays,           &sim->solid_angles,
        &sim->splats,      &sim->hits,           &sim->bounced,        &sim->bounced_hits,
        &sim->returning,   &sim->returning_hits, &sim->mirrors,        &sim->parts,
        &sim->materials,   &sim->no_triangles,   &sim->volume_inverse, &sim->volume_ratio,
        &sim->parcels,     &sim->accumulator,    &sim->saturated,      &sim->results};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
        asdic_buffer_destroy(buffers[i]);
    }
    asdic_kernel_destroy(&sim->sample);
    asdic_kernel_destroy(&sim->shade);
    asdic_kernel_destroy(&sim->collect);
    asdic_kernel_destroy(&sim->suffix);
    asdic_kernel_destroy(&sim->reduce);
    asdic_kernel_destroy(&sim->survey);
    asdic_kernel_destroy(&sim->connect);
    asdic_kernel_destroy(&sim->bounce);
    asdic_beam_fan_finish(&sim->fan, sim->device);
    asdic_quadrature_finish(&sim->quadrature);
    asdic_points_finish(sim);
    asdic_tracer_destroy(&sim->tracer);
    asdic_placement_destroy(&sim->placement);
    free(sim->receivers);
    free(sim->host_materials);
    free(sim->ping);
    free(sim->bin_table);
    free(sim->bin_loss);
    free(sim->bin_volume);
    free(sim->host_results);
    free(sim->stated);
    asdic_pair_destroy(&sim->pair);
    free(sim->smear_scratch);
    free(sim);
    *pointer = NULL;
}

asdic_buffer *asdic_simulator_triangles(const asdic_simulator *sim) {
    return sim->tracer ? asdic_tracer_triangles(sim->tracer) : sim->no_triangles;
}

size_t asdic_simulator_bin_count(const asdic_simulator *sim) {
    return sim ? sim->bins : 0;
}
