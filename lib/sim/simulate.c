/*
 * Pings: draw, trace and shade their rays, turn sums into levels. Pings of few rays go through every
 * step together: one launch of a kernel then has work enough for the device, and they share its cost.
 */
#include "simulator.h"

#include <asdic/plan.h>

#include "base/clock.h"
#include "base/context.h"
#include "base/try.h"
#include "coherent.h"
#include "points.h"
#include "pulse.h"
#include "truth.h"

#define COUNT(args) (sizeof(args) / sizeof *(args))

/* Ends a phase of a ping that is profiled: waits for the device, adds the time. */
static asdic_status end_phase(asdic_simulator *sim, asdic_phase phase) {
    if (!sim->profile.seconds) {
        return ASDIC_OK;
    }
    asdic_status status = asdic_device_finish(sim->device);
    double now_s = asdic_clock_s();
    sim->profile.seconds[phase] += now_s - sim->profile.from_s;
    sim->profile.from_s = now_s;
    return status;
}

/* Slots of a batch of rays of one ping; all pings of a batch of pings have as many. */
static size_t batch_slots(const asdic_simulator *sim) {
    const dev_ping *ping = sim->shots[0].ping;
    return (size_t)ping->batch.groups * ping->batch.per_group;
}

/* A work-item takes a piece of the slots, as in mirror_ray.h. Pieces, and work-items of a work-group. */
static size_t piece_count(const asdic_simulator *sim) {
    size_t piece = sim->setup.layout.width == 1 ? 1 : 64;
    return (batch_slots(sim) + piece - 1) / piece;
}

static size_t piece_local(const asdic_simulator *sim) {
    size_t local = sim->setup.layout.local;
    return sim->setup.layout.width == 1 ? local : local < 8 ? 1 : local / 8;
}

/* The tracer chooses its form by measuring on this many rays. */
#define ENOUGH_RAYS 8192u

/* Traces the rays of COUNT pings. The tracer's choice of a form rests on those of one ping, or a few. */
static asdic_status run_tracer(asdic_simulator *sim, asdic_buffer *rays, asdic_buffer *hits,
                               size_t count, uint32_t leg) {
    uint32_t slots = (uint32_t)batch_slots(sim);
    return asdic_tracer_run(sim->tracer, rays, hits, (uint32_t)count * slots,
                            slots > ENOUGH_RAYS ? slots : ENOUGH_RAYS, leg);
}

/* Kernels need something to point at. */
static asdic_buffer *truth_cells(const asdic_simulator *sim) {
    return sim->truth.asked ? sim->truth.cell_buffer : sim->buffers.no_triangles;
}

/* Rays through layers that start together: from the sonar, from mirrors, from what those showed. */
typedef struct leg_set {
    bool from_sonar;
    asdic_buffer *starts, *rays, *legs, *hits; /* RAYS: the legs in hand, may be STARTS */
    uint32_t *foreseen;
} leg_set;

/* Traces rays from layer to layer until all have ended. For as many legs as the rays before had none is waited
 * for; one that has no ray left does no harm. */
static asdic_status run_legs(asdic_simulator *sim, const leg_set *set, size_t count) {
    uint32_t layers = (uint32_t)sim->setup.layer_count, from_sonar = set->from_sonar;
    uint32_t active[MOST_LEGS] = {1}, last = 0;
    const asdic_buffers *buffers = &sim->buffers;
    TRY(asdic_buffer_zero(buffers->active, sizeof active));
    for (uint32_t leg = 0; leg < MOST_LEGS && active[last]; leg++) {
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(buffers->pings),
                                   ASDIC_ARG_BUFFER(buffers->layers),
                                   ASDIC_ARG_VALUE(layers),
                                   ASDIC_ARG_VALUE(leg),
                                   ASDIC_ARG_VALUE(from_sonar),
                                   ASDIC_ARG_BUFFER(set->starts),
                                   ASDIC_ARG_BUFFER(set->rays),
                                   ASDIC_ARG_BUFFER(set->legs),
                                   ASDIC_ARG_BUFFER(buffers->leg_hits),
                                   ASDIC_ARG_BUFFER(set->hits),
                                   ASDIC_ARG_BUFFER(buffers->active)};
        TRY(asdic_kernel_run_rows(sim->kernels.advance, args, COUNT(args), piece_count(sim),
                                  piece_local(sim), count));
        if (leg >= *set->foreseen) {
            last = leg;
            TRY(asdic_buffer_read(buffers->active, 0, (last + 1) * sizeof *active, active));
        }
        if (active[last] && sim->tracer) {
            TRY(run_tracer(sim, set->rays, buffers->leg_hits, count, leg));
        }
    }
    for (*set->foreseen = 0; *set->foreseen < last && active[*set->foreseen];) {
        ++*set->foreseen;
    }
    return ASDIC_OK;
}

/* What the rays from mirrors meet, or those home. Through layers, the legs in hand lie where nothing is needed. */
static asdic_status trace_bounces(asdic_simulator *sim, asdic_buffer *rays, asdic_buffer *hits,
                                  size_t count) {
    asdic_buffers *buffers = &sim->buffers;
    bool home = rays == buffers->returning;
    if (sim->kernels.advance) {
        const leg_set set = {false,
                             rays,
                             home ? buffers->rays : buffers->returning,
                             home ? buffers->returning_legs : buffers->bounced_legs,
                             hits,
                             &sim->legs_foreseen[home ? 2 : 1]};
        return run_legs(sim, &set, count);
    }
    return sim->tracer ? run_tracer(sim, rays, hits, count, 0) : ASDIC_OK;
}

/* What mirror rays meet, the way back, the deposit. */
static asdic_status run_bounces(asdic_simulator *sim, size_t count) {
    asdic_buffer *triangles = asdic_simulator_triangles(sim);
    uint32_t layers = (uint32_t)sim->setup.layer_count;
    asdic_kernel_arg connect[] = {ASDIC_ARG_BUFFER(sim->buffers.pings),
                                  ASDIC_ARG_BUFFER(sim->buffers.bounced),
                                  ASDIC_ARG_BUFFER(sim->buffers.hits),
                                  ASDIC_ARG_BUFFER(sim->buffers.bounced_hits),
                                  ASDIC_ARG_BUFFER(triangles),
                                  ASDIC_ARG_BUFFER(sim->buffers.parts),
                                  ASDIC_ARG_BUFFER(sim->buffers.materials),
                                  ASDIC_ARG_BUFFER(sim->buffers.mirrors),
                                  ASDIC_ARG_BUFFER(sim->buffers.returning),
                                  ASDIC_ARG_BUFFER(sim->buffers.layers),
                                  ASDIC_ARG_VALUE(layers),
                                  ASDIC_ARG_BUFFER(sim->buffers.bounced_legs),
                                  ASDIC_ARG_BUFFER(sim->buffers.returning_legs)};
    asdic_kernel_arg bounce[] = {ASDIC_ARG_BUFFER(sim->buffers.pings),
                                 ASDIC_ARG_BUFFER(sim->buffers.rays),
                                 ASDIC_ARG_BUFFER(sim->buffers.solid_angles),
                                 ASDIC_ARG_BUFFER(sim->buffers.splats),
                                 ASDIC_ARG_BUFFER(sim->buffers.hits),
                                 ASDIC_ARG_BUFFER(sim->buffers.bounced),
                                 ASDIC_ARG_BUFFER(sim->buffers.bounced_hits),
                                 ASDIC_ARG_BUFFER(sim->buffers.returning),
                                 ASDIC_ARG_BUFFER(sim->buffers.returning_hits),
                                 ASDIC_ARG_BUFFER(sim->buffers.mirrors),
                                 ASDIC_ARG_BUFFER(triangles),
                                 ASDIC_ARG_BUFFER(sim->buffers.parts),
                                 ASDIC_ARG_BUFFER(sim->buffers.materials),
                                 ASDIC_ARG_BUFFER(sim->buffers.arrivals),
                                 ASDIC_ARG_BUFFER(sim->buffers.accumulator),
                                 ASDIC_ARG_BUFFER(sim->buffers.saturated),
                                 ASDIC_ARG_BUFFER(sim->truth.table_buffer),
                                 ASDIC_ARG_BUFFER(truth_cells(sim)),
                                 ASDIC_ARG_BUFFER(sim->buffers.legs),
                                 ASDIC_ARG_BUFFER(sim->buffers.bounced_legs),
                                 ASDIC_ARG_BUFFER(sim->buffers.returning_legs)};
    size_t pieces = piece_count(sim), local = piece_local(sim);
    const asdic_kernels *kernels = &sim->kernels;
    const asdic_buffers *buffers = &sim->buffers;
    TRY(trace_bounces(sim, buffers->bounced, buffers->bounced_hits, count));
    TRY(asdic_kernel_run_rows(kernels->connect, connect, COUNT(connect), pieces, local, count));
    TRY(trace_bounces(sim, buffers->returning, buffers->returning_hits, count));
    return asdic_kernel_run_rows(kernels->bounce, bounce, COUNT(bounce), pieces, local, count);
}

/* Uploads COUNT pings with their apertures; for later batches of rays the first ping alone, which has
 * changed. */
static asdic_status upload_pings(asdic_simulator *sim, size_t count) {
    const dev_ping *first = sim->shots[0].ping;
    asdic_buffer *buffer = sim->buffers.pings;
    size_t bytes =
        first->batch.first == 0 ? count * asdic_simulator_ping_bytes(sim) : sizeof(dev_ping);
    /* The host changes this memory again only when a further batch follows: then wait for the transfer. */
    TRY(first->batch.last ? asdic_buffer_send(buffer, bytes, first)
                          : asdic_buffer_write(buffer, 0, bytes, first));
    if (!sim->learnt.table_uploaded) {
        TRY(asdic_buffer_send(sim->buffers.table, sizeof sim->learnt.table, sim->learnt.table));
        sim->learnt.table_uploaded = true;
    }
    return ASDIC_OK;
}

asdic_status asdic_simulator_draw(asdic_simulator *sim, size_t count) {
    TRY(upload_pings(sim, count));
    asdic_kernel_arg sample[] = {ASDIC_ARG_BUFFER(sim->buffers.pings),
                                 ASDIC_ARG_BUFFER(sim->buffers.table),
                                 ASDIC_ARG_BUFFER(sim->learnt.faces.face_buffer),
                                 ASDIC_ARG_BUFFER(asdic_simulator_triangles(sim)),
                                 ASDIC_ARG_BUFFER(sim->buffers.rays),
                                 ASDIC_ARG_BUFFER(sim->buffers.solid_angles),
                                 ASDIC_ARG_BUFFER(sim->buffers.splats)};
    TRY(asdic_kernel_run_rows(sim->kernels.sample, sample, COUNT(sample),
                              batch_slots(sim) / sim->setup.layout.width, sim->setup.layout.local,
                              count));
    TRY(end_phase(sim, ASDIC_PHASE_SAMPLE));
    if (sim->kernels.advance) {
        const leg_set set = {true,
                             sim->buffers.rays,
                             sim->buffers.rays,
                             sim->buffers.legs,
                             sim->buffers.hits,
                             &sim->legs_foreseen[0]};
        TRY(run_legs(sim, &set, count));
    } else if (sim->tracer) {
        TRY(run_tracer(sim, sim->buffers.rays, sim->buffers.hits, count, 0));
    }
    return end_phase(sim, ASDIC_PHASE_TRACE);
}

static asdic_status run_shade(asdic_simulator *sim, size_t count) {
    asdic_kernel_arg shade[] = {ASDIC_ARG_BUFFER(sim->buffers.pings),
                                ASDIC_ARG_BUFFER(sim->buffers.rays),
                                ASDIC_ARG_BUFFER(sim->buffers.legs),
                                ASDIC_ARG_BUFFER(sim->buffers.solid_angles),
                                ASDIC_ARG_BUFFER(sim->buffers.splats),
                                ASDIC_ARG_BUFFER(sim->learnt.faces.density_buffer),
                                ASDIC_ARG_BUFFER(sim->buffers.hits),
                                ASDIC_ARG_BUFFER(asdic_simulator_triangles(sim)),
                                ASDIC_ARG_BUFFER(sim->buffers.parts),
                                ASDIC_ARG_BUFFER(sim->buffers.materials),
                                ASDIC_ARG_BUFFER(sim->buffers.water_tables),
                                ASDIC_ARG_BUFFER(sim->buffers.arrivals),
                                ASDIC_ARG_BUFFER(sim->buffers.accumulator),
                                ASDIC_ARG_BUFFER(sim->buffers.saturated),
                                ASDIC_ARG_BUFFER(sim->buffers.bounced),
                                ASDIC_ARG_BUFFER(sim->buffers.mirrors),
                                ASDIC_ARG_BUFFER(sim->buffers.bounced_legs),
                                ASDIC_ARG_BUFFER(sim->truth.table_buffer),
                                ASDIC_ARG_BUFFER(truth_cells(sim))};
    return asdic_kernel_run_rows(sim->kernels.shade, shade, COUNT(shade), piece_count(sim),
                                 piece_local(sim), count);
}

/* The water that rays through layers cross. */
static asdic_status run_volume(asdic_simulator *sim, size_t count) {
    uint32_t layers = (uint32_t)sim->setup.layer_count;
    asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(sim->buffers.pings),
                               ASDIC_ARG_BUFFER(sim->buffers.layers),
                               ASDIC_ARG_VALUE(layers),
                               ASDIC_ARG_BUFFER(sim->buffers.legs),
                               ASDIC_ARG_BUFFER(sim->buffers.solid_angles),
                               ASDIC_ARG_BUFFER(sim->buffers.splats),
                               ASDIC_ARG_BUFFER(sim->buffers.water_tables),
                               ASDIC_ARG_BUFFER(sim->buffers.arrivals),
                               ASDIC_ARG_BUFFER(sim->buffers.accumulator),
                               ASDIC_ARG_BUFFER(sim->buffers.saturated),
                               ASDIC_ARG_BUFFER(sim->truth.table_buffer),
                               ASDIC_ARG_BUFFER(truth_cells(sim))};
    return asdic_kernel_run_rows(sim->kernels.volume, args, COUNT(args), piece_count(sim),
                                 piece_local(sim), count);
}

static asdic_status run_collect(asdic_simulator *sim, size_t count) {
    asdic_kernel_arg collect[] = {
        ASDIC_ARG_BUFFER(sim->buffers.pings),        ASDIC_ARG_BUFFER(sim->buffers.arrivals),
        ASDIC_ARG_BUFFER(sim->buffers.accumulator),  ASDIC_ARG_BUFFER(sim->buffers.saturated),
        ASDIC_ARG_BUFFER(sim->buffers.water_tables), ASDIC_ARG_BUFFER(sim->buffers.totals),
        ASDIC_ARG_BUFFER(sim->truth.table_buffer),   ASDIC_ARG_BUFFER(truth_cells(sim))};
    return asdic_kernel_run_rows(sim->kernels.collect, collect, COUNT(collect),
                                 sim->shots[0].ping->sums.blocks / 2, 1, count);
}

static asdic_status run_batch(asdic_simulator *sim, size_t count) {
    TRY(asdic_simulator_draw(sim, count));
    TRY(run_shade(sim, count));
    if (sim->kernels.volume) {
        TRY(run_volume(sim, count));
    }
    TRY(end_phase(sim, ASDIC_PHASE_SHADE));
    if (sim->setup.has_mirrors) {
        TRY(run_bounces(sim, count));
    }
    TRY(end_phase(sim, ASDIC_PHASE_BOUNCE));
    if (sim->kernels.collect) {
        TRY(run_collect(sim, count));
    }
    if (sim->fan.many) {
        TRY(asdic_beam_fan_project(sim, truth_cells(sim)));
    }
    return sim->kernels.collect || sim->fan.many ? end_phase(sim, ASDIC_PHASE_COLLECT) : ASDIC_OK;
}

static asdic_status reduce_groups(asdic_simulator *sim, size_t count) {
    const asdic_setup *setup = &sim->setup;
    if (sim->kernels.suffix) { /* else collect has done it */
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(sim->buffers.pings),
                                   ASDIC_ARG_BUFFER(sim->buffers.accumulator)};
        TRY(asdic_kernel_run_rows(sim->kernels.suffix, args, COUNT(args),
                                  (size_t)setup->groups * setup->sonar.receiver_count,
                                  setup->layout.local, count));
    }
    asdic_kernel_arg args[] = {
        ASDIC_ARG_BUFFER(sim->buffers.pings),        ASDIC_ARG_BUFFER(sim->buffers.accumulator),
        ASDIC_ARG_BUFFER(sim->buffers.water_tables), ASDIC_ARG_BUFFER(sim->buffers.saturated),
        ASDIC_ARG_BUFFER(sim->buffers.totals),       ASDIC_ARG_BUFFER(sim->buffers.results)};
    size_t run = setup->layout.width == 1 ? 1 : 4 * setup->layout.width; /* as in reduce.cl */
    return asdic_kernel_run_rows(sim->kernels.reduce, args, COUNT(args),
                                 (setup->bins * setup->ping.sums.columns + run - 1) / run,
                                 setup->layout.local, count);
}

static asdic_status reduce(asdic_simulator *sim, size_t count) {
    if (sim->fan.many) { /* asdic_simulator_convert waits for it, tile by tile */
        return ASDIC_OK;
    }
    TRY(reduce_groups(sim, count));
    return asdic_buffer_read(sim->buffers.results, 0, count * asdic_simulator_results_bytes(sim),
                             sim->host.results);
}

double asdic_simulator_source_lin(const asdic_simulator *sim, const asdic_water_column *water) {
    return asdic_water_column_source_lin(water, &sim->setup.env, &sim->setup.sonar);
}

/* A ping that fails half-way leaves sums behind. */
static asdic_status clear_sums(asdic_simulator *sim) {
    asdic_buffers *buffers = &sim->buffers;
    if (!buffers->accumulator_clear) {
        TRY(asdic_buffer_zero(buffers->accumulator, asdic_buffer_bytes(buffers->accumulator)));
        TRY(asdic_buffer_zero(buffers->saturated, asdic_buffer_bytes(buffers->saturated)));
        TRY(asdic_buffer_zero(buffers->totals, asdic_buffer_bytes(buffers->totals)));
    }
    return ASDIC_OK;
}

/* The rays of COUNT shots to sums. */
static asdic_status run_batches(asdic_simulator *sim, size_t count) {
    TRY(clear_sums(sim));
    size_t groups = sim->setup.groups, step = sim->setup.per_group;
    size_t rays_per_group = (sim->setup.sampling.rays + groups - 1) / groups;
    for (size_t first = 0; first < rays_per_group; first += step) {
        for (size_t k = 0; k < count; k++) {
            sim->shots[k].ping->batch.first = (dev_uint)first;
            sim->shots[k].ping->batch.last = first + step >= rays_per_group;
        }
        TRY(run_batch(sim, count));
    }
    TRY(reduce(sim, count));
    return end_phase(sim, ASDIC_PHASE_REDUCE);
}

/* Tells the device what does not fit a dev_ping. */
static asdic_status tabulate(asdic_simulator *sim, size_t count) {
    bool changed = false;
    for (size_t k = 0; k < count; k++) {
        changed |= asdic_shot_tabulate(sim, &sim->shots[k]);
    }
    return changed ? asdic_buffer_send(sim->buffers.water_tables,
                                       count * 2 * sim->setup.bins * sizeof *sim->host.water,
                                       sim->host.water)
                   : ASDIC_OK;
}

/* The sums of SHOT to levels. */
static asdic_status convert(asdic_simulator *sim, const asdic_ping_shot *shot, asdic_ping *out) {
    out->bin_length_m = sim->setup.sonar.bin_length_m;
    out->rays = sim->setup.sampling.rays;
    return asdic_simulator_convert(sim, shot, asdic_simulator_source_lin(sim, &shot->water), out);
}

static asdic_status run_shots(asdic_simulator *sim, size_t count, asdic_ping *const *out) {
    TRY(tabulate(sim, count));
    TRY(asdic_truth_begin(sim, count, out));
    TRY(run_batches(sim, count));
    TRY(asdic_truth_fetch(sim));
    for (size_t k = 0; k < count; k++) {
        TRY(convert(sim, &sim->shots[k], out[k]));
    }
    return ASDIC_OK;
}

asdic_status asdic_simulator_simulate(asdic_simulator *sim, size_t count, asdic_ping *const *out) {
    asdic_status status = run_shots(sim, count, out);
    sim->buffers.accumulator_clear = status == ASDIC_OK;
    for (size_t k = 0; status && k < count; k++) {
        sim->shots[k].tables_np_per_m = -1.0; /* the device may not have them */
    }
    return status;
}

asdic_status asdic_simulator_settle(asdic_simulator *sim, asdic_status status) {
    if (status) {
        asdic_device_abandon(sim->device);
        asdic_beam_fan_abandon(&sim->fan);
    }
    return status;
}

/* COUNT pings from their rays, setup.ping_batch at most; speckle included. */
static asdic_status simulate_rays(asdic_simulator *sim, const asdic_pose *poses, uint64_t first,
                                  size_t count, asdic_ping *const *out) {
    for (size_t k = 0; k < count; k++) {
        asdic_shot_aim(sim, &sim->shots[k], &poses[k], first + k, ASDIC_STREAM_PING,
                       sim->setup.sampling.rays);
    }
    asdic_ping *const *raw = sim->host.wide ? sim->host.wide : out;
    for (size_t k = 0; k < count; k++) {
        raw[k]->truth = out[k]->truth; /* asks for it; it is filled after the pulse */
    }
    asdic_status status = asdic_simulator_simulate(sim, count, raw);
    for (size_t k = 0; sim->host.wide && k < count; k++) {
        raw[k]->truth = NULL;
    }
    TRY(status);
    for (size_t k = 0; k < count; k++) {
        const asdic_ping_shot *shot = &sim->shots[k];
        TRY(asdic_points_add(sim, shot, raw[k]));
        asdic_pulse_smear(&sim->setup.sonar, shot->water.sound_speed_mps, sim->setup.threads,
                          sim->host.scratch, raw[k], out[k]);
        asdic_truth_end(sim, k, out[k]);
        asdic_speckle_apply(sim->speckle, shot->water.sound_speed_mps, sim->setup.sampling.seed,
                            shot->index, out[k]);
    }
    return ASDIC_OK;
}

/* The same where a plan left rays out. */
static asdic_status integrate(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                              asdic_ping *out) {
    TRY(asdic_quadrature_ping(sim, pose, out));
    double c_mps = asdic_environment_sound_speed_mps(&sim->setup.env, pose->position_m.z);
    asdic_speckle_apply(sim->speckle, c_mps, sim->setup.sampling.seed, index, out);
    return ASDIC_OK;
}

static asdic_status shoot(asdic_simulator *sim, const asdic_pose *poses, uint64_t first,
                          size_t count, asdic_ping *const *out) {
    for (size_t k = 0; sim->coherent && k < count; k++) {
        TRY(asdic_coherent_ping(sim, &poses[k], first + k, out[k]));
    }
    if (sim->coherent) {
        return ASDIC_OK;
    }
    if (!(sim->setup.sampling.left_out & (1u << ASDIC_TERM_RAYS))) {
        return simulate_rays(sim, poses, first, count, out);
    }
    for (size_t k = 0; k < count; k++) {
        TRY(integrate(sim, &poses[k], first + k, out[k]));
    }
    return ASDIC_OK;
}

static asdic_status check_ping(const asdic_simulator *sim, const asdic_pose *pose,
                               const asdic_ping *out) {
    if (!out) {
        return asdic_fail_null(sim->ctx, "asdic_simulator_pings");
    }
    size_t bins = asdic_simulator_bin_count(sim);
    if (out->beams != sim->setup.sonar.receiver_count || out->bins != bins) {
        return asdic_fail(sim->ctx, ASDIC_ERROR_ARGUMENT,
                          "the ping holds %zu beams x %zu bins, the simulator makes %zu x %zu",
                          out->beams, out->bins, sim->setup.sonar.receiver_count, bins);
    }
    if (out->truth && !sim->setup.sampling.truth) {
        return asdic_fail(sim->ctx, ASDIC_ERROR_ARGUMENT,
                          "the ping has truth, the simulator was made without: set 'truth' of its "
                          "asdic_sampling");
    }
    TRY(asdic_pose_check(sim->ctx, pose));
    return asdic_simulator_check_depth(sim->ctx, pose->position_m.z);
}

/* How many of the COUNT pings at POSES go to the device at once: they see what moves in one frame. */
static size_t count_together(const asdic_simulator *sim, const asdic_pose *poses, size_t count) {
    asdic_sonar_frame frame = asdic_simulator_frame(sim, poses[0].position_m);
    size_t together = 1;
    while (together < count && together < sim->setup.ping_batch) {
        asdic_sonar_frame next = asdic_simulator_frame(sim, poses[together].position_m);
        if (next.origin_m.x != frame.origin_m.x || next.origin_m.y != frame.origin_m.y ||
            next.reach_m != frame.reach_m) {
            break;
        }
        together++;
    }
    return together;
}

asdic_status asdic_simulator_pings(asdic_simulator *sim, const asdic_pose *poses, uint64_t first,
                                   size_t count, asdic_ping *const *out) {
    if (!sim || !poses || !out) {
        return asdic_fail_null(sim ? sim->ctx : NULL, __func__);
    }
    for (size_t k = 0; k < count; k++) {
        TRY(check_ping(sim, &poses[k], out[k]));
    }
    for (size_t k = 0, together; k < count; k += together) {
        together = count_together(sim, poses + k, count - k);
        TRY(asdic_simulator_center(sim, poses[k].position_m));
        TRY(asdic_simulator_settle(sim, shoot(sim, poses + k, first + k, together, out + k)));
    }
    return ASDIC_OK;
}

asdic_status asdic_simulator_ping(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                  asdic_ping *out) {
    return asdic_simulator_pings(sim, pose, index, 1, &out);
}

size_t asdic_simulator_ping_batch(const asdic_simulator *sim) {
    return sim ? sim->setup.ping_batch : 0;
}

const char *asdic_phase_name(asdic_phase phase) {
    static const char *const names[ASDIC_PHASE_COUNT] = {"sample",  "trace",  "shade", "bounce",
                                                         "collect", "reduce", "levels"};
    return phase < ASDIC_PHASE_COUNT ? names[phase] : "?";
}

asdic_status asdic_simulator_profile(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                     asdic_ping *ping, double *seconds) {
    if (!sim || !seconds) {
        return asdic_fail(sim ? sim->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_simulator_profile: NULL argument");
    }
    sim->profile.seconds = seconds;
    sim->profile.from_s = asdic_clock_s();
    asdic_status status = asdic_simulator_ping(sim, pose, index, ping);
    asdic_status ended = end_phase(sim, ASDIC_PHASE_LEVELS);
    sim->profile.seconds = NULL;
    return status ? status : ended;
}
