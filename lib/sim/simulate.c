/*
 * Pings: draw, trace and shade their rays, turn sums into levels. Pings of few rays go through every
 * step together, as a volley: a launch then has work enough for the device, and its cost is shared.
 */
#include "simulator.h"

#include <asdic/plan.h>

#include "base/context.h"
#include "bin_laws.h"
#include "noise_level.h"
#include "points.h"
#include "pulse.h"

#include <math.h>

#define COUNT(args) (sizeof(args) / sizeof *(args))

/* Work-items that take a piece of the slots each, as in mirror_ray.h, and how many a work-group. */
static size_t piece_count(const asdic_simulator *sim) {
    size_t piece = sim->layout.width == 1 ? 1 : 64;
    return ((size_t)sim->ping->groups * sim->ping->per_group + piece - 1) / piece;
}

static size_t piece_local(const asdic_simulator *sim) {
    size_t local = sim->layout.local;
    return sim->layout.width == 1 ? local : local < 8 ? 1 : local / 8;
}

/* So many rays are enough to choose a form of the ray kernel on. */
#define ENOUGH_RAYS 8192u

/* The rays of COUNT pings; those of the first, or of some, stand for all. */
static asdic_status run_tracer(asdic_simulator *sim, asdic_buffer *rays, asdic_buffer *hits,
                               size_t count) {
    uint32_t slots = sim->ping->groups * sim->ping->per_group;
    return asdic_tracer_run(sim->tracer, rays, hits, (uint32_t)count * slots,
                            slots > ENOUGH_RAYS ? slots : ENOUGH_RAYS);
}

/* What mirror rays meet, the way back, the deposit. */
static asdic_status run_bounces(asdic_simulator *sim, size_t count) {
    asdic_buffer *triangles = asdic_simulator_triangles(sim);
    asdic_kernel_arg connect[] = {
        ASDIC_ARG_BUFFER(sim->ping_buffer),  ASDIC_ARG_BUFFER(sim->bounced),
        ASDIC_ARG_BUFFER(sim->bounced_hits), ASDIC_ARG_BUFFER(triangles),
        ASDIC_ARG_BUFFER(sim->parts),        ASDIC_ARG_BUFFER(sim->materials),
        ASDIC_ARG_BUFFER(sim->mirrors),      ASDIC_ARG_BUFFER(sim->returning)};
    asdic_kernel_arg bounce[] = {
        ASDIC_ARG_BUFFER(sim->ping_buffer),    ASDIC_ARG_BUFFER(sim->rays),
        ASDIC_ARG_BUFFER(sim->solid_angles),   ASDIC_ARG_BUFFER(sim->bounced),
        ASDIC_ARG_BUFFER(sim->bounced_hits),   ASDIC_ARG_BUFFER(sim->returning),
        ASDIC_ARG_BUFFER(sim->returning_hits), ASDIC_ARG_BUFFER(sim->mirrors),
        ASDIC_ARG_BUFFER(triangles),           ASDIC_ARG_BUFFER(sim->parts),
        ASDIC_ARG_BUFFER(sim->materials),      ASDIC_ARG_BUFFER(sim->parcels),
        ASDIC_ARG_BUFFER(sim->accumulator),    ASDIC_ARG_BUFFER(sim->saturated)};
    size_t pieces = piece_count(sim), local = piece_local(sim);
    asdic_status status = ASDIC_OK;
    if (sim->tracer) {
        status = run_tracer(sim, sim->bounced, sim->bounced_hits, count);
    }
    if (!status) {
        status = asdic_kernel_run_rows(sim->connect, connect, COUNT(connect), pieces, local, count);
    }
    if (!status && sim->tracer) {
        status = run_tracer(sim, sim->returning, sim->returning_hits, count);
    }
    if (!status) {
        status = asdic_kernel_run_rows(sim->bounce, bounce, COUNT(bounce), pieces, local, count);
    }
    return status;
}

/* COUNT pings with their apertures; of later batches, the ping alone has changed. */
static asdic_status upload_pings(asdic_simulator *sim, size_t count) {
    size_t bytes =
        sim->pings->batch_first == 0 ? count * asdic_simulator_ping_bytes(sim) : sizeof(dev_ping);
    /* What a batch is told changes only when a further one follows: nothing else needs waiting for. */
    asdic_status status = sim->pings->last_batch
                              ? asdic_buffer_send(sim->ping_buffer, bytes, sim->pings)
                              : asdic_buffer_write(sim->ping_buffer, 0, bytes, sim->pings);
    if (!status && !sim->table_uploaded) {
        status = asdic_buffer_send(sim->table_buffer, sizeof sim->table, sim->table);
        sim->table_uploaded = status == ASDIC_OK;
    }
    return status;
}

asdic_status asdic_simulator_draw(asdic_simulator *sim, size_t count) {
    const dev_ping *ping = sim->pings;
    asdic_status status = upload_pings(sim, count);
    if (status) {
        return status;
    }
    size_t slots = (size_t)ping->groups * ping->per_group;
    asdic_kernel_arg sample[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                                 ASDIC_ARG_BUFFER(sim->table_buffer),
                                 ASDIC_ARG_BUFFER(sim->faces.face_buffer),
                                 ASDIC_ARG_BUFFER(asdic_simulator_triangles(sim)),
                                 ASDIC_ARG_BUFFER(sim->rays),
                                 ASDIC_ARG_BUFFER(sim->solid_angles),
                                 ASDIC_ARG_BUFFER(sim->splats)};
    status = asdic_kernel_run_rows(sim->sample, sample, COUNT(sample), slots / sim->layout.width,
                                   sim->layout.local, count);
    if (!status) {
        status = asdic_simulator_end_phase(sim, ASDIC_PHASE_SAMPLE);
    }
    if (!status && sim->tracer) {
        status = run_tracer(sim, sim->rays, sim->hits, count);
    }
    return status ? status : asdic_simulator_end_phase(sim, ASDIC_PHASE_TRACE);
}

static asdic_status run_batch(asdic_simulator *sim, size_t count) {
    asdic_status status = asdic_simulator_draw(sim, count);
    if (status) {
        return status;
    }
    asdic_buffer *triangles = asdic_simulator_triangles(sim);
    asdic_kernel_arg shade[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                                ASDIC_ARG_BUFFER(sim->rays),
                                ASDIC_ARG_BUFFER(sim->solid_angles),
                                ASDIC_ARG_BUFFER(sim->splats),
                                ASDIC_ARG_BUFFER(sim->faces.density_buffer),
                                ASDIC_ARG_BUFFER(sim->hits),
                                ASDIC_ARG_BUFFER(triangles),
                                ASDIC_ARG_BUFFER(sim->parts),
                                ASDIC_ARG_BUFFER(sim->materials),
                                ASDIC_ARG_BUFFER(sim->water_tables),
                                ASDIC_ARG_BUFFER(sim->parcels),
                                ASDIC_ARG_BUFFER(sim->accumulator),
                                ASDIC_ARG_BUFFER(sim->saturated),
                                ASDIC_ARG_BUFFER(sim->bounced),
                                ASDIC_ARG_BUFFER(sim->mirrors)};
    status = asdic_kernel_run_rows(sim->shade, shade, COUNT(shade), piece_count(sim),
                                   piece_local(sim), count);
    if (!status) {
        status = asdic_simulator_end_phase(sim, ASDIC_PHASE_SHADE);
    }
    if (!status && sim->has_mirrors) {
        status = run_bounces(sim, count);
    }
    status = status ? status : asdic_simulator_end_phase(sim, ASDIC_PHASE_BOUNCE);
    if (!status && sim->collect) {
        const dev_ping *ping = sim->pings;
        asdic_kernel_arg collect[] = {
            ASDIC_ARG_BUFFER(sim->ping_buffer),  ASDIC_ARG_BUFFER(sim->parcels),
            ASDIC_ARG_BUFFER(sim->accumulator),  ASDIC_ARG_BUFFER(sim->saturated),
            ASDIC_ARG_BUFFER(sim->water_tables), ASDIC_ARG_BUFFER(sim->totals)};
        status = asdic_kernel_run_rows(sim->collect, collect, COUNT(collect), ping->blocks / 2, 1,
                                       count);
        status = status ? status : asdic_simulator_end_phase(sim, ASDIC_PHASE_COLLECT);
    }
    if (!status && sim->fan.many) {
        status = asdic_beam_fan_project(&sim->fan, sim->ping, sim->ping_buffer, sim->parcels,
                                        sim->results, (float *)sim->host_results);
        status = status ? status : asdic_simulator_end_phase(sim, ASDIC_PHASE_COLLECT);
    }
    return status;
}

static asdic_status reduce_groups(asdic_simulator *sim, size_t count) {
    asdic_status status = ASDIC_OK;
    if (sim->suffix) { /* else collect has done it */
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                                   ASDIC_ARG_BUFFER(sim->accumulator)};
        status = asdic_kernel_run_rows(sim->suffix, args, COUNT(args),
                                       (size_t)sim->groups * sim->sonar.receiver_count,
                                       sim->layout.local, count);
    }
    if (status) {
        return status;
    }
    asdic_kernel_arg args[] = {
        ASDIC_ARG_BUFFER(sim->ping_buffer),  ASDIC_ARG_BUFFER(sim->accumulator),
        ASDIC_ARG_BUFFER(sim->water_tables), ASDIC_ARG_BUFFER(sim->saturated),
        ASDIC_ARG_BUFFER(sim->totals),       ASDIC_ARG_BUFFER(sim->results)};
    size_t run = sim->layout.width == 1 ? 1 : 4 * sim->layout.width; /* as in reduce.cl */
    return asdic_kernel_run_rows(sim->reduce, args, COUNT(args),
                                 (sim->bins * sim->fixed.columns + run - 1) / run,
                                 sim->layout.local, count);
}

static asdic_status reduce(asdic_simulator *sim, size_t count) {
    if (sim->fan.many) { /* asdic_simulator_convert waits for it, tile by tile */
        return ASDIC_OK;
    }
    asdic_status status = reduce_groups(sim, count);
    return status ? status
                  : asdic_buffer_read(sim->results, 0, count * asdic_simulator_results_bytes(sim),
                                      sim->host_results);
}

double asdic_simulator_source_lin(const asdic_simulator *sim, const asdic_water_column *water) {
    double source = pow(10.0, sim->sonar.source_level_db / 10.0);
    /* The paper prints 2 d - 1 metres of absorption where 2 (d - 1) is meant: one metre more. */
    bool printed = sim->env.variant == ASDIC_VARIANT_PRINTED;
    return printed ? source * exp(-water->absorption_np_per_m) : source;
}

/* Rays to sums. A ping that fails half-way leaves an accumulator that must be cleared. */
static asdic_status run_batches(asdic_simulator *sim, size_t count) {
    asdic_status status = ASDIC_OK;
    if (!sim->accumulator_clear) {
        status = asdic_buffer_zero(sim->accumulator, asdic_buffer_bytes(sim->accumulator));
        if (!status) {
            status = asdic_buffer_zero(sim->saturated, asdic_buffer_bytes(sim->saturated));
        }
        if (!status) {
            status = asdic_buffer_zero(sim->totals, asdic_buffer_bytes(sim->totals));
        }
    }
    sim->accumulator_clear = false;
    size_t rays_per_group = (sim->sampling.rays + sim->groups - 1) / sim->groups;
    for (size_t first = 0; !status && first < rays_per_group; first += sim->per_group) {
        for (size_t k = 0; k < count; k++) {
            asdic_simulator_select(sim, k);
            sim->ping->batch_first = (dev_uint)first;
            sim->ping->last_batch = first + sim->per_group >= rays_per_group;
        }
        status = run_batch(sim, count);
    }
    if (!status) {
        status = reduce(sim, count);
    }
    if (!status) {
        status = asdic_simulator_end_phase(sim, ASDIC_PHASE_REDUCE);
    }
    return status;
}

static asdic_water_column water_at(const asdic_simulator *sim, const asdic_pose *pose) {
    return asdic_water_column_at(&sim->env, &sim->sonar, pose->position_m.z);
}

/* Tells the device of SHOTS what does not fit a dev_ping. */
static asdic_status tabulate(asdic_simulator *sim, const asdic_ping_shot *shots, size_t count) {
    bool changed = false;
    for (size_t k = 0; k < count; k++) {
        asdic_water_column water = water_at(sim, &shots[k].pose);
        asdic_simulator_select(sim, k);
        changed |= asdic_bin_laws_tabulate(sim, &water);
    }
    return changed ? asdic_buffer_send(sim->water_tables,
                                       count * 2 * sim->bins * sizeof *sim->water, sim->water)
                   : ASDIC_OK;
}

/* The sums of the volley's NTH ping to levels. */
static asdic_status convert(asdic_simulator *sim, size_t nth, const asdic_pose *pose,
                            asdic_ping *out) {
    asdic_water_column water = water_at(sim, pose);
    asdic_simulator_select(sim, nth);
    asdic_noise_levels(&sim->env, &sim->sonar, water.sound_speed_mps, out);
    out->bin_length_m = sim->sonar.bin_length_m;
    out->rays = sim->sampling.rays;
    return asdic_simulator_convert(sim, asdic_simulator_source_lin(sim, &water), out);
}

asdic_status asdic_simulator_simulate(asdic_simulator *sim, const asdic_ping_shot *shots,
                                      size_t count, asdic_ping *const *out) {
    for (size_t k = 0; k < count; k++) {
        asdic_simulator_select(sim, k);
        asdic_simulator_describe(sim, &shots[k].pose, shots[k].index, shots[k].stream,
                                 sim->sampling.rays);
    }
    asdic_status status = tabulate(sim, shots, count);
    if (!status) {
        status = run_batches(sim, count);
    }
    for (size_t k = 0; !status && k < count; k++) {
        status = convert(sim, k, &shots[k].pose, out[k]);
    }
    sim->accumulator_clear = status == ASDIC_OK;
    for (size_t k = 0; status && k < count; k++) {
        sim->laws[k].absorption_np_per_m = -1.0; /* the device may not know them */
    }
    return status;
}

/* To what rays brought: points, then the pulse's length. */
static asdic_status finish_rays(asdic_simulator *sim, const asdic_pose *pose, asdic_ping *out) {
    asdic_water_column water = water_at(sim, pose);
    asdic_status status = asdic_points_add(sim, pose, &water, out);
    if (!status) {
        asdic_pulse_smear(&sim->sonar, water.sound_speed_mps, sim->smear_scratch, out);
    }
    return status;
}

/* COUNT pings, a volley at most. */
static asdic_status shoot(asdic_simulator *sim, const asdic_pose *poses, uint64_t first,
                          size_t count, asdic_ping *const *out) {
    bool rays = !(sim->sampling.left_out & (1u << ASDIC_TERM_RAYS));
    asdic_status status = ASDIC_OK;
    if (rays) {
        asdic_ping_shot shots[ASDIC_LEARN_BLOCK];
        for (size_t k = 0; k < count; k++) {
            shots[k] = (asdic_ping_shot){poses[k], first + k, ASDIC_STREAM_PING};
        }
        status = asdic_simulator_simulate(sim, shots, count, out);
    }
    for (size_t k = 0; !status && k < count; k++) {
        asdic_simulator_select(sim, k);
        status = rays ? finish_rays(sim, &poses[k], out[k])
                      : asdic_quadrature_ping(sim, &poses[k], out[k]);
        if (!status) {
            asdic_speckle_apply(sim->speckle, water_at(sim, &poses[k]).sound_speed_mps,
                                sim->sampling.seed, first + k, out[k]);
        }
    }
    return status;
}

static asdic_status check_ping(const asdic_simulator *sim, const asdic_pose *pose,
                               const asdic_ping *out) {
    if (!out) {
        return asdic_fail_null(sim->ctx, "asdic_simulator_pings");
    }
    if (out->beams != sim->sonar.receiver_count || out->bins != sim->bins) {
        return asdic_fail(sim->ctx, ASDIC_ERROR_ARGUMENT,
                          "the ping holds %zu beams x %zu bins, the simulator makes %zu x %zu",
                          out->beams, out->bins, sim->sonar.receiver_count, sim->bins);
    }
    return asdic_pose_check(sim->ctx, pose);
}

asdic_status asdic_simulator_pings(asdic_simulator *sim, const asdic_pose *poses, uint64_t first,
                                   size_t count, asdic_ping *const *out) {
    if (!sim || !poses || !out) {
        return asdic_fail_null(sim ? sim->ctx : NULL, __func__);
    }
    asdic_status status = ASDIC_OK;
    for (size_t k = 0; !status && k < count; k++) {
        status = check_ping(sim, &poses[k], out[k]);
    }
    for (size_t k = 0; !status && k < count; k += sim->volley) {
        size_t left = count - k;
        status = shoot(sim, poses + k, first + k, left < sim->volley ? left : sim->volley, out + k);
    }
    return status;
}

asdic_status asdic_simulator_ping(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                  asdic_ping *out) {
    return asdic_simulator_pings(sim, pose, index, 1, &out);
}

size_t asdic_simulator_volley(const asdic_simulator *sim) {
    return sim ? sim->volley : 0;
}
