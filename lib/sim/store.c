/*
 * The memory of a simulator, on the host and on its device.
 */
#include "simulator.h"

#include "base/context.h"
#include "base/try.h"
#include "pulse.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

size_t asdic_simulator_ping_bytes(const asdic_simulator *sim) {
    return sizeof(dev_ping) + (sim->setup.sonar.receiver_count + 1) * sizeof(dev_beam);
}

/* Sums, one word of cut deposits, spreads, in whole words; of a fan: sums as floats. */
size_t asdic_simulator_results_bytes(const asdic_simulator *sim) {
    if (sim->fan.many) {
        return sim->setup.sonar.receiver_count * sim->fan.sums * sim->fan.row * sizeof(float);
    }
    return (sim->setup.components * sim->setup.cells + 1 + (sim->setup.cells + 1) / 2) *
           sizeof(int64_t);
}

size_t asdic_simulator_per_group(const asdic_simulator *sim, size_t rays) {
    size_t most = asdic_simulator_batch_slots(sim), step = sim->setup.groups == 1 ? 64 : 16;
    rays = rays < most ? rays : most;
    return ((rays + sim->setup.groups - 1) / sim->setup.groups + step - 1) / step * step;
}

size_t asdic_simulator_batch_slots(const asdic_simulator *sim) {
    size_t slots = sim->fan.many ? ASDIC_FAN_BATCH : sim->setup.layout.batch_slots;
    return slots > ASDIC_PILOT_RAYS ? slots : ASDIC_PILOT_RAYS;
}

static size_t pilot_slots(const asdic_simulator *sim) {
    return sim->setup.groups * asdic_simulator_per_group(sim, ASDIC_PILOT_RAYS);
}

/* Echoes and water of every pilot ray in every picked receiver. */
static size_t pilot_energy_bytes(const asdic_simulator *sim) {
    return pilot_slots(sim) * asdic_simulator_picked(sim) * DEV_PILOT_ENERGIES * sizeof(float);
}

static asdic_status create_wide(asdic_simulator *sim) {
    sim->host.wide = calloc(sim->setup.ping_batch, sizeof(asdic_ping *));
    if (!sim->host.wide) {
        return asdic_fail_memory(sim->ctx, "a simulator");
    }
    for (size_t k = 0; k < sim->setup.ping_batch; k++) {
        TRY(asdic_ping_create(sim->ctx, sim->setup.sonar.receiver_count, sim->setup.bins,
                              &sim->host.wide[k]));
    }
    return ASDIC_OK;
}

asdic_status asdic_store_create_host(asdic_simulator *sim) {
    size_t beams = sim->setup.sonar.receiver_count, bins = sim->setup.bins,
           pings = sim->setup.ping_batch;
    asdic_arena *a = &sim->host.memory;
    sim->setup.receivers = asdic_arena_alloc(a, beams * sizeof *sim->setup.receivers);
    sim->host.pings = asdic_arena_alloc(a, pings * asdic_simulator_ping_bytes(sim));
    sim->shots = asdic_arena_alloc(a, pings * sizeof *sim->shots);
    sim->host.bin_tables = asdic_arena_alloc(a, pings * 2 * bins * sizeof *sim->host.bin_tables);
    sim->host.water = asdic_arena_alloc(a, pings * 2 * bins * sizeof *sim->host.water);
    sim->learnt.stated = asdic_arena_alloc(a, sim->setup.cells * sizeof *sim->learnt.stated);
    sim->host.scratch = asdic_arena_alloc(a, sim->setup.threads * asdic_pulse_scratch(bins) *
                                                 sizeof *sim->host.scratch);
    sim->host.pilot_rays = asdic_arena_alloc(a, pilot_slots(sim) * sizeof *sim->host.pilot_rays);
    sim->host.pilot_energies = asdic_arena_alloc(a, pilot_energy_bytes(sim));
    if (a->is_short) {
        return asdic_fail_memory(sim->ctx, "a simulator");
    }
    for (size_t k = 0; k < pings; k++) {
        double *tables = sim->host.bin_tables + k * 2 * bins;
        sim->shots[k] = (asdic_ping_shot){
            .ping = (dev_ping *)((char *)sim->host.pings + k * asdic_simulator_ping_bytes(sim)),
            .tables_np_per_m = -1.0,
            .loss = tables,
            .volume = tables + bins,
            .for_device = sim->host.water + k * 2 * bins,
        };
    }
    memcpy(sim->setup.receivers, sim->setup.sonar.receivers, beams * sizeof *sim->setup.receivers);
    sim->setup.sonar.receivers = sim->setup.receivers;
    return sim->setup.margin > 0 && !sim->setup.sampling.coherent ? create_wide(sim) : ASDIC_OK;
}

static asdic_status place_results(asdic_simulator *sim) {
    sim->host.results = asdic_buffer_memory(sim->buffers.results);
    if (!sim->host.results) {
        return asdic_fail_memory(sim->ctx, "a simulator");
    }
    for (size_t k = 0; k < sim->setup.ping_batch; k++) {
        sim->shots[k].sums = sim->host.results + k * asdic_simulator_results_bytes(sim);
    }
    return ASDIC_OK;
}

asdic_status asdic_store_create_device(asdic_simulator *sim) {
    size_t pings = sim->setup.ping_batch, pilots = pilot_slots(sim),
           slots = pings * sim->setup.groups * sim->setup.per_group;
    slots = slots > pilots ? slots : pilots;
    size_t bounce_slots = sim->setup.has_mirrors ? slots : 0;
    size_t leg_bytes = sim->kernels.advance ? DEV_LEG_FLOATS * sizeof(float) : 0;
    size_t sets = sim->setup.layout.deposit == ASDIC_DEPOSIT_COLLECT
                      ? DEV_ARRIVAL_SETS(sim->setup.has_mirrors, sim->kernels.volume)
                      : 0;
    size_t totals =
        sim->kernels.collect
            ? pings * sim->setup.groups * (size_t)sim->setup.ping.sums.total_cells * sizeof(float)
            : 0;
    size_t accumulator = sim->fan.many
                             ? 0
                             : pings * sim->setup.ping.sums.blocks *
                                   (size_t)sim->setup.ping.sums.group_cells * sizeof(int64_t);
    bool adaptive = sim->setup.sampling.sampler == ASDIC_SAMPLER_ADAPTIVE;
    const struct {
        size_t bytes;
        asdic_buffer **buffer;
    } wanted[] = {
        {pings * asdic_simulator_ping_bytes(sim), &sim->buffers.pings},
        {sizeof sim->learnt.table, &sim->buffers.table},
        {slots * sizeof(dev_ray), &sim->buffers.rays},
        {slots * leg_bytes, &sim->buffers.legs},
        {sim->kernels.advance && sim->tracer ? slots * sizeof(dev_hit) : 0, &sim->buffers.leg_hits},
        {sim->kernels.advance ? MOST_LEGS * sizeof(uint32_t) : 0, &sim->buffers.active},
        {slots * sizeof(float), &sim->buffers.solid_angles},
        {slots * sizeof(float), &sim->buffers.splats},
        {sim->tracer || sim->kernels.advance ? slots * sizeof(dev_hit) : 0, &sim->buffers.hits},
        {bounce_slots * sizeof(dev_ray), &sim->buffers.bounced},
        {bounce_slots * sizeof(dev_hit), &sim->buffers.bounced_hits},
        {bounce_slots * sizeof(dev_ray), &sim->buffers.returning},
        {bounce_slots * sizeof(dev_hit), &sim->buffers.returning_hits},
        {bounce_slots * 4 * sizeof(float), &sim->buffers.mirrors},
        {bounce_slots * leg_bytes, &sim->buffers.bounced_legs},
        {bounce_slots * leg_bytes, &sim->buffers.returning_legs},
        {sets * slots * sizeof(dev_arrival), &sim->buffers.arrivals},
        {0, &sim->buffers.no_triangles},
        {pings * 2 * sim->setup.bins * sizeof(float), &sim->buffers.water_tables},
        {accumulator, &sim->buffers.accumulator},
        {totals, &sim->buffers.totals},
        {pings * asdic_simulator_results_bytes(sim), &sim->buffers.results},
        {pings * sizeof(uint32_t), &sim->buffers.saturated},
        {adaptive ? pilots * sizeof(dev_pilot) : 0, &sim->buffers.pilot_rays},
        {adaptive ? pilot_energy_bytes(sim) : 0, &sim->buffers.pilot_energies},
    };
    for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++) {
        TRY(asdic_buffer_create(sim->device, wanted[i].bytes, NULL, wanted[i].buffer));
    }
    TRY(asdic_buffer_create(sim->device, sim->setup.layer_count * sizeof(dev_layer),
                            sim->setup.layers, &sim->buffers.layers));
    return place_results(sim);
}

void asdic_store_destroy(asdic_simulator *sim) {
    asdic_buffer **first = (asdic_buffer **)&sim->buffers;
    for (size_t i = 0; i < offsetof(asdic_buffers, accumulator_clear) / sizeof *first; i++) {
        asdic_buffer_destroy(&first[i]);
    }
    for (size_t k = 0; sim->host.wide && k < sim->setup.ping_batch; k++) {
        asdic_ping_destroy(&sim->host.wide[k]);
    }
    free(sim->host.wide);
    free(sim->setup.scatterers);
    asdic_arena_finish(&sim->host.memory);
}
