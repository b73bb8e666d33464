/*
 * The memory of a simulator, on the host and on its device.
 */
#include "simulator.h"

#include "base/context.h"
#include "pulse.h"

#include <stdlib.h>
#include <string.h>

size_t asdic_simulator_ping_bytes(const asdic_simulator *sim) {
    return sizeof(dev_ping) + (sim->sonar.receiver_count + 1) * sizeof(dev_beam);
}

/* Sums, one word of cut deposits, spreads, in whole words; of a fan: sums as floats. */
size_t asdic_simulator_results_bytes(const asdic_simulator *sim) {
    if (sim->fan.many) {
        return sim->components * sim->cells * sizeof(float);
    }
    return (sim->components * sim->cells + 1 + (sim->cells + 1) / 2) * sizeof(int64_t);
}

size_t asdic_simulator_per_group(const asdic_simulator *sim, size_t rays) {
    size_t most = asdic_simulator_batch_slots(sim), step = sim->groups == 1 ? 64 : 16;
    rays = rays < most ? rays : most;
    return ((rays + sim->groups - 1) / sim->groups + step - 1) / step * step;
}

size_t asdic_simulator_batch_slots(const asdic_simulator *sim) {
    size_t slots = sim->fan.many ? ASDIC_FAN_BATCH : sim->layout.batch_slots;
    return slots > ASDIC_PILOT_RAYS ? slots : ASDIC_PILOT_RAYS;
}

static size_t pilot_slots(const asdic_simulator *sim) {
    return sim->groups * asdic_simulator_per_group(sim, ASDIC_PILOT_RAYS);
}

/* Echo and water of every pilot ray in every picked receiver. */
static size_t survey_energy_bytes(const asdic_simulator *sim) {
    return pilot_slots(sim) * asdic_simulator_picked(sim) * 2 * sizeof(float);
}

void asdic_simulator_select(asdic_simulator *sim, size_t nth) {
    sim->nth = nth;
    sim->ping = (dev_ping *)((char *)sim->pings + nth * asdic_simulator_ping_bytes(sim));
}

asdic_status asdic_store_create_host(asdic_simulator *sim) {
    size_t beams = sim->sonar.receiver_count, bins = sim->bins, pings = sim->volley;
    sim->receivers = malloc(beams * sizeof *sim->receivers);
    sim->pings = calloc(pings, asdic_simulator_ping_bytes(sim));
    sim->laws = calloc(pings, sizeof *sim->laws);
    sim->bin_tables = calloc(pings * 2 * bins, sizeof *sim->bin_tables);
    sim->water = calloc(pings * 2 * bins, sizeof *sim->water);
    sim->host_results = malloc(pings * asdic_simulator_results_bytes(sim));
    sim->stated = malloc(sim->cells * sizeof *sim->stated);
    sim->smear_scratch = malloc(asdic_pulse_scratch(bins) * sizeof *sim->smear_scratch);
    sim->survey_rays = malloc(pilot_slots(sim) * sizeof *sim->survey_rays);
    sim->survey_energies = malloc(survey_energy_bytes(sim));
    if (!sim->receivers || !sim->pings || !sim->laws || !sim->bin_tables || !sim->water ||
        !sim->host_results || !sim->stated || !sim->smear_scratch || !sim->survey_rays ||
        !sim->survey_energies) {
        return asdic_fail_memory(sim->ctx, "a simulator");
    }
    for (size_t k = 0; k < pings; k++) {
        double *tables = sim->bin_tables + k * 2 * bins;
        sim->laws[k] = (asdic_bin_laws){-1.0, tables, tables + bins};
    }
    asdic_simulator_select(sim, 0);
    memcpy(sim->receivers, sim->sonar.receivers, beams * sizeof *sim->receivers);
    sim->sonar.receivers = sim->receivers;
    return ASDIC_OK;
}

asdic_status asdic_store_create_device(asdic_simulator *sim) {
    size_t pings = sim->volley, pilots = pilot_slots(sim),
           slots = pings * sim->groups * sim->per_group;
    slots = slots > pilots ? slots : pilots;
    size_t bounce_slots = sim->has_mirrors ? slots : 0;
    size_t sets =
        sim->layout.deposit == ASDIC_DEPOSIT_OWNED ? DEV_PARCEL_SETS(sim->has_mirrors) : 0;
    size_t totals =
        sim->collect ? pings * sim->groups * (size_t)sim->fixed.total_cells * sizeof(float) : 0;
    size_t accumulator = sim->fan.many ? 0
                                       : pings * sim->fixed.blocks *
                                             (size_t)sim->fixed.group_cells * sizeof(int64_t);
    bool adaptive = sim->sampling.sampler == ASDIC_SAMPLER_ADAPTIVE;
    const struct {
        size_t bytes;
        asdic_buffer **buffer;
    } wanted[] = {
        {pings * asdic_simulator_ping_bytes(sim), &sim->ping_buffer},
        {sizeof sim->table, &sim->table_buffer},
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
        {pings * 2 * sim->bins * sizeof(float), &sim->water_tables},
        {accumulator, &sim->accumulator},
        {totals, &sim->totals},
        {pings * asdic_simulator_results_bytes(sim), &sim->results},
        {pings * sizeof(uint32_t), &sim->saturated},
        {adaptive ? pilots * sizeof(dev_survey) : 0, &sim->survey_ray_buffer},
        {adaptive ? survey_energy_bytes(sim) : 0, &sim->survey_energy_buffer},
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

void asdic_store_destroy(asdic_simulator *sim) {
    asdic_buffer **buffers[] = {&sim->ping_buffer,
                                &sim->table_buffer,
                                &sim->rays,
                                &sim->solid_angles,
                                &sim->splats,
                                &sim->hits,
                                &sim->bounced,
                                &sim->bounced_hits,
                                &sim->returning,
                                &sim->returning_hits,
                                &sim->mirrors,
                                &sim->parts,
                                &sim->materials,
                                &sim->no_triangles,
                                &sim->water_tables,
                                &sim->parcels,
                                &sim->accumulator,
                                &sim->saturated,
                                &sim->results,
                                &sim->totals,
                                &sim->survey_ray_buffer,
                                &sim->survey_energy_buffer};
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
        asdic_buffer_destroy(buffers[i]);
    }
    free(sim->receivers);
    free(sim->scatterers);
    free(sim->pings);
    free(sim->laws);
    free(sim->bin_tables);
    free(sim->water);
    free(sim->host_results);
    free(sim->stated);
    free(sim->smear_scratch);
    free(sim->survey_rays);
    free(sim->survey_energies);
}
