/*
 * One ping: draw, trace and shade its rays, turn sums into levels.
 */
#include "simulator.h"

#include <asdic/plan.h>

#include "base/context.h"
#include "noise_level.h"
#include "points.h"
#include "speckle.h"

#include "../../kernels/backscatter.h"

#include <math.h>
#include <string.h>

/* Per bin: TL d^2 and the water's integral; what turns a part of that integral into a share of the
 * bin, and water quanta into the bin's TL d^2. Pings at one depth share them. */
static asdic_status tabulate_bins(asdic_simulator *sim, const asdic_water_column *water) {
    if (sim->tabulated_absorption == water->absorption_np_per_m) {
        return ASDIC_OK;
    }
    double strength = pow(10.0, 0.1 * volume_backscatter_db(sim->env.particle_strength_db,
                                                            sim->sonar.frequency_hz / 1e3));
    float *inverse = sim->bin_table, *ratio = sim->bin_table + sim->bins;
    for (size_t n = 0; n < sim->bins; n++) {
        double loss = asdic_water_column_loss(water, sim->sonar.bin_length_m, n);
        double center = ((double)n + 0.5) * sim->sonar.bin_length_m;
        double volume =
            asdic_water_column_volume(water, sim->sonar.bin_length_m, sim->sonar.blanking_m, n);
        /* The device works relative to the bin's centre: integral of d^-2 exp(-2 k (d - d_n)). */
        double local = volume / (loss * center * center);
        inverse[n] = local > 0.0 && isfinite(local) ? (float)(1.0 / local) : 0.0f;
        ratio[n] = isfinite(volume) ? (float)(strength * volume / loss) : 0.0f;
        sim->bin_loss[n] = loss;
        sim->bin_volume[n] = strength * volume;
    }
    size_t bytes = sim->bins * sizeof(float);
    asdic_status status = asdic_buffer_write(sim->volume_inverse, 0, bytes, inverse);
    if (!status) {
        status = asdic_buffer_write(sim->volume_ratio, 0, bytes, ratio);
    }
    sim->tabulated_absorption = status ? -1.0 : water->absorption_np_per_m;
    return status;
}

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

/* What mirror rays meet, the way back, the deposit. */
static asdic_status run_bounces(asdic_simulator *sim) {
    const dev_ping *ping = sim->ping;
    size_t slots = (size_t)ping->groups * ping->per_group;
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
        status = asdic_tracer_run(sim->tracer, sim->bounced, sim->bounced_hits, slots);
    }
    if (!status) {
        status = asdic_kernel_run(sim->connect, connect, COUNT(connect), pieces, local);
    }
    if (!status && sim->tracer) {
        status = asdic_tracer_run(sim->tracer, sim->returning, sim->returning_hits, slots);
    }
    if (!status) {
        status = asdic_kernel_run(sim->bounce, bounce, COUNT(bounce), pieces, local);
    }
    return status;
}

/* The ping with its apertures; of later batches, the ping alone has changed. */
static asdic_status upload_ping(asdic_simulator *sim) {
    size_t bytes = sizeof(dev_ping);
    if (sim->ping->batch_first == 0) {
        bytes += (sim->sonar.receiver_count + 1) * sizeof(dev_beam);
    }
    /* What a batch is told changes only when a further one follows: nothing else needs waiting for. */
    asdic_status status = sim->ping->last_batch
                              ? asdic_buffer_send(sim->ping_buffer, bytes, sim->ping)
                              : asdic_buffer_write(sim->ping_buffer, 0, bytes, sim->ping);
    if (!status && !sim->table_uploaded) {
        status = asdic_buffer_write(sim->table_buffer, 0, sizeof sim->table, sim->table);
        sim->table_uploaded = status == ASDIC_OK;
    }
    return status;
}

asdic_status asdic_simulator_draw(asdic_simulator *sim) {
    const dev_ping *ping = sim->ping;
    asdic_status status = upload_ping(sim);
    if (status) {
        return status;
    }
    size_t slots = (size_t)ping->groups * ping->per_group;
    asdic_kernel_arg sample[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                                 ASDIC_ARG_BUFFER(sim->table_buffer), ASDIC_ARG_BUFFER(sim->rays),
                                 ASDIC_ARG_BUFFER(sim->solid_angles),
                                 ASDIC_ARG_BUFFER(sim->splats)};
    status = asdic_kernel_run(sim->sample, sample, COUNT(sample), slots / sim->layout.width,
                              sim->layout.local);
    if (!status) {
        status = asdic_simulator_end_phase(sim, ASDIC_PHASE_SAMPLE);
    }
    if (!status && sim->tracer) {
        status = asdic_tracer_run(sim->tracer, sim->rays, sim->hits, slots);
    }
    return status ? status : asdic_simulator_end_phase(sim, ASDIC_PHASE_TRACE);
}

static asdic_status run_batch(asdic_simulator *sim) {
    const dev_ping *ping = sim->ping;
    asdic_status status = asdic_simulator_draw(sim);
    if (status) {
        return status;
    }
    asdic_buffer *triangles = sim->tracer ? asdic_tracer_triangles(sim->tracer) : sim->no_triangles;
    asdic_kernel_arg shade[] = {
        ASDIC_ARG_BUFFER(sim->ping_buffer),    ASDIC_ARG_BUFFER(sim->rays),
        ASDIC_ARG_BUFFER(sim->solid_angles),   ASDIC_ARG_BUFFER(sim->splats),
        ASDIC_ARG_BUFFER(sim->hits),           ASDIC_ARG_BUFFER(triangles),
        ASDIC_ARG_BUFFER(sim->parts),          ASDIC_ARG_BUFFER(sim->materials),
        ASDIC_ARG_BUFFER(sim->volume_inverse), ASDIC_ARG_BUFFER(sim->parcels),
        ASDIC_ARG_BUFFER(sim->accumulator),    ASDIC_ARG_BUFFER(sim->saturated),
        ASDIC_ARG_BUFFER(sim->bounced),        ASDIC_ARG_BUFFER(sim->mirrors)};
    status = asdic_kernel_run(sim->shade, shade, COUNT(shade), piece_count(sim), piece_local(sim));
    if (!status) {
        status = asdic_simulator_end_phase(sim, ASDIC_PHASE_SHADE);
    }
    if (!status && sim->has_mirrors) {
        status = run_bounces(sim);
    }
    status = status ? status : asdic_simulator_end_phase(sim, ASDIC_PHASE_BOUNCE);
    if (!status && sim->collect) {
        asdic_kernel_arg collect[] = {
            ASDIC_ARG_BUFFER(sim->ping_buffer), ASDIC_ARG_BUFFER(sim->parcels),
            ASDIC_ARG_BUFFER(sim->accumulator), ASDIC_ARG_BUFFER(sim->saturated)};
        status = asdic_kernel_run(sim->collect, collect, COUNT(collect), ping->groups, 1);
        status = status ? status : asdic_simulator_end_phase(sim, ASDIC_PHASE_COLLECT);
    }
    return status;
}

static asdic_status reduce_groups(asdic_simulator *sim) {
    asdic_status status = ASDIC_OK;
    if (sim->suffix) { /* else collect has done it */
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                                   ASDIC_ARG_BUFFER(sim->accumulator)};
        status = asdic_kernel_run(sim->suffix, args, COUNT(args),
                                  (size_t)sim->ping->groups * sim->ping->beams, sim->layout.local);
    }
    if (status) {
        return status;
    }
    asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(sim->ping_buffer),
                               ASDIC_ARG_BUFFER(sim->accumulator),
                               ASDIC_ARG_BUFFER(sim->volume_ratio),
                               ASDIC_ARG_BUFFER(sim->saturated), ASDIC_ARG_BUFFER(sim->results)};
    size_t run = sim->layout.width == 1 ? 1 : 4 * sim->layout.width; /* as in reduce.cl */
    return asdic_kernel_run(sim->reduce, args, COUNT(args),
                            (sim->bins * sim->fixed.columns + run - 1) / run, sim->layout.local);
}

static asdic_status reduce(asdic_simulator *sim) {
    if (sim->fan.cells) { /* asdic_simulator_convert waits for it, tile by tile */
        return asdic_beam_fan_project(&sim->fan, sim->ping, sim->ping_buffer, sim->accumulator,
                                      sim->saturated, sim->results, sim->host_results);
    }
    asdic_status status = reduce_groups(sim);
    return status ? status
                  : asdic_buffer_read(sim->results, 0, asdic_simulator_results_bytes(sim),
                                      sim->host_results);
}

double asdic_simulator_source_lin(const asdic_simulator *sim, const asdic_water_column *water) {
    double source = pow(10.0, sim->sonar.source_level_db / 10.0);
    /* The paper prints 2 d - 1 metres of absorption where 2 (d - 1) is meant: one metre more. */
    bool printed = sim->env.variant == ASDIC_VARIANT_PRINTED;
    return printed ? source * exp(-water->absorption_np_per_m) : source;
}

/* Rays to sums. A ping that fails half-way leaves an accumulator that must be cleared. */
static asdic_status run_batches(asdic_simulator *sim) {
    asdic_status status = ASDIC_OK;
    if (!sim->accumulator_clear) {
        status = asdic_buffer_zero(sim->accumulator, asdic_buffer_bytes(sim->accumulator));
        if (!status) {
            status = asdic_buffer_zero(sim->saturated, sizeof(uint32_t));
        }
    }
    sim->accumulator_clear = false;
    size_t rays_per_group = (sim->sampling.rays + sim->groups - 1) / sim->groups;
    for (size_t first = 0; !status && first < rays_per_group; first += sim->per_group) {
        sim->ping->batch_first = (dev_uint)first;
        sim->ping->last_batch = first + sim->per_group >= rays_per_group;
        status = run_batch(sim);
    }
    if (!status) {
        status = reduce(sim);
    }
    if (!status) {
        status = asdic_simulator_end_phase(sim, ASDIC_PHASE_REDUCE);
    }
    sim->accumulator_clear = status == ASDIC_OK;
    return status;
}

asdic_status asdic_simulator_simulate(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                      uint32_t stream, asdic_ping *out) {
    asdic_water_column water = asdic_water_column_at(&sim->env, &sim->sonar, pose->position_m.z);
    asdic_simulator_describe(sim, pose, index, stream, sim->sampling.rays);
    asdic_status status = tabulate_bins(sim, &water);
    if (!status) {
        status = run_batches(sim);
    }
    if (status) {
        return status;
    }
    asdic_noise_levels(&sim->env, &sim->sonar, water.sound_speed_mps, out);
    status = asdic_simulator_convert(sim, asdic_simulator_source_lin(sim, &water), out);
    sim->accumulator_clear = status == ASDIC_OK;
    out->bin_length_m = sim->sonar.bin_length_m;
    out->rays = sim->sampling.rays;
    return status;
}

asdic_status asdic_simulator_ping(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                  asdic_ping *out) {
    if (!sim || !pose || !out) {
        return asdic_fail(sim ? sim->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_simulator_ping: NULL argument");
    }
    if (out->beams != sim->sonar.receiver_count || out->bins != sim->bins) {
        return asdic_fail(sim->ctx, ASDIC_ERROR_ARGUMENT,
                          "the ping holds %zu beams x %zu bins, the simulator makes %zu x %zu",
                          out->beams, out->bins, sim->sonar.receiver_count, sim->bins);
    }
    asdic_status status = asdic_pose_check(sim->ctx, pose);
    if (status) {
        return status;
    }
    bool rays = !(sim->sampling.left_out & (1u << ASDIC_TERM_RAYS));
    status = rays ? asdic_simulator_simulate(sim, pose, index, ASDIC_STREAM_PING, out)
                  : asdic_quadrature_ping(sim, pose, out);
    asdic_water_column water = asdic_water_column_at(&sim->env, &sim->sonar, pose->position_m.z);
    if (!status) {
        status = asdic_points_add(sim, pose, &water, out);
    }
    if (!status) {
        asdic_pulse_smear(&sim->sonar, water.sound_speed_mps, sim->smear_scratch, out);
        asdic_speckle_apply(&sim->sonar, water.sound_speed_mps, sim->sampling.seed, index, out);
    }
    return status;
}
