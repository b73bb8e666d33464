#include "beam_fan.h"

#include "aim.h"
#include "base/context.h"
#include "base/try.h"
#include "simulator.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* With fewer receivers arrivals are added group by group (collect.cl), and the groups tell the error. */
#define LEAST_RECEIVERS 16
/* Bytes of a fan_entry and of a fan_list in fan_entry.h. */
#define ENTRY_BYTES 32
#define TRUTH_ENTRY_BYTES 40
#define LIST_BYTES 8
/* Blocks of rays that are sorted at the same time: some for each core of a processor, many for a GPU, fewer
 * where a table of blocks by bins would be large. */
#define FEW_BLOCKS 8
#define MANY_BLOCKS 256
#define MOST_COUNTS ((size_t)1 << 22)

static bool same(float a, float b) {
    return fabsf(a - b) < 1e-5f;
}

/* Whether RECEIVERS are of one height and differ in width, and in yaw about one axis, only. */
static bool have_common_axis(const asdic_beam *receivers, size_t count) {
    const asdic_pose level = {{0.0, 0.0, 0.0}, 0.0, 0.0, 0.0};
    dev_beam first = asdic_aim_beam(&receivers[0], &level, 1.0);
    for (size_t r = 1; r < count; r++) {
        dev_beam beam = asdic_aim_beam(&receivers[r], &level, 1.0);
        if (!same(beam.rows[6], first.rows[6]) || !same(beam.rows[7], first.rows[7]) ||
            !same(beam.rows[8], first.rows[8]) || beam.length_v_wl != first.length_v_wl) {
            return false;
        }
    }
    return true;
}

bool asdic_beam_fan_is_wanted(const asdic_sonar *sonar) {
    return sonar->receiver_count >= LEAST_RECEIVERS;
}

void asdic_beam_fan_plan(const asdic_sonar *sonar, asdic_beam_fan *fan) {
    fan->many = asdic_beam_fan_is_wanted(sonar);
    fan->common_axis = fan->many && have_common_axis(sonar->receivers, sonar->receiver_count);
}

asdic_status asdic_beam_fan_init(asdic_simulator *sim) {
    asdic_beam_fan *fan = &sim->fan;
    const asdic_setup *setup = &sim->setup;
    if (!fan->many) {
        return ASDIC_OK;
    }
    bool truth = setup->sampling.truth, layers = sim->kernels.volume != NULL;
    char options[160];
    bool wide = setup->layout.width > 1;
    size_t tiles = (setup->sonar.receiver_count + DEV_FAN_TILE - 1) / DEV_FAN_TILE;
    size_t most = MOST_COUNTS / setup->bins + 1, blocks = wide ? FEW_BLOCKS : MANY_BLOCKS;
    fan->blocks = (unsigned)(blocks < most ? blocks : most);
    fan->width = wide ? 16 : 1;
    snprintf(options, sizeof options,
             "-D ASDIC_WIDTH=%u -D ASDIC_COMPONENTS=%zu -D ASDIC_HAS_MIRRORS=%d "
             "-D ASDIC_COMMON_AXIS=%d -D ASDIC_LAYERS=%d%s",
             fan->width, setup->components, setup->has_mirrors, fan->common_axis, layers,
             truth ? " -D ASDIC_TRUTH=1" : "");
    const struct {
        const char *name;
        asdic_kernel **kernel;
    } kernels[] = {{"fan_count", &fan->count},
                   {"fan_place", &fan->place},
                   {"fan_scatter", &fan->scatter},
                   {"fan_runs", &fan->runs},
                   {"fan_project", &fan->project}};
    size_t entry = truth ? TRUTH_ENTRY_BYTES : ENTRY_BYTES;
    /* A mirror's arrivals are up to three entries more; those of water one a deposit. */
    size_t entries = (setup->has_mirrors ? 4 : 1) + (layers ? 4 * DEV_WATER_SETS : 0);
    const struct {
        size_t bytes;
        asdic_buffer **buffer;
    } buffers[] = {{setup->bins * fan->blocks * sizeof(uint32_t), &fan->counts},
                   {sizeof(uint32_t), &fan->made},
                   {setup->bins * LIST_BYTES, &fan->lists},
                   {setup->groups * setup->per_group * entries * entry, &fan->entries}};
    fan->fetches = calloc(2 * tiles, sizeof *fan->fetches);
    if (!fan->fetches || pthread_mutex_init(&fan->lock, NULL) != 0) {
        return asdic_fail_memory(sim->ctx, "a fan");
    }
    fan->tiles = tiles; /* and the lock is there */
    for (size_t i = 0; i < sizeof kernels / sizeof *kernels; i++) {
        TRY(asdic_kernel_create(sim->device, "fan.cl", options, kernels[i].name,
                                kernels[i].kernel));
    }
    for (size_t i = 0; i < sizeof buffers / sizeof *buffers; i++) {
        TRY(asdic_buffer_create(sim->device, buffers[i].bytes, NULL, buffers[i].buffer));
    }
    return ASDIC_OK;
}

void asdic_beam_fan_abandon(asdic_beam_fan *fan) {
    for (size_t i = 0; i < 2 * fan->tiles; i++) {
        asdic_fetch_abandon(&fan->fetches[i]);
    }
}

void asdic_beam_fan_finish(asdic_beam_fan *fan) {
    asdic_beam_fan_abandon(fan);
    free(fan->fetches);
    if (fan->tiles > 0) {
        pthread_mutex_destroy(&fan->lock);
    }
    asdic_kernel_destroy(&fan->count);
    asdic_kernel_destroy(&fan->place);
    asdic_kernel_destroy(&fan->scatter);
    asdic_kernel_destroy(&fan->runs);
    asdic_kernel_destroy(&fan->project);
    asdic_buffer_destroy(&fan->counts);
    asdic_buffer_destroy(&fan->made);
    asdic_buffer_destroy(&fan->lists);
    asdic_buffer_destroy(&fan->entries);
}

const float *asdic_beam_fan_row(const asdic_beam_fan *fan, const void *results, size_t beam,
                                size_t sum) {
    return (const float *)results + (beam * fan->sums + sum) * fan->row;
}

/* Sorts arrivals into lists of entries, a list for every bin. */
static asdic_status sort(asdic_simulator *sim) {
    const asdic_beam_fan *fan = &sim->fan;
    asdic_buffer *pings = sim->buffers.pings, *arrivals = sim->buffers.arrivals;
    size_t bins = sim->setup.bins;
    dev_uint blocks = fan->blocks;
    size_t local = fan->width > 1 ? 1 : 64;
    asdic_kernel_arg count[] = {ASDIC_ARG_BUFFER(pings), ASDIC_ARG_BUFFER(arrivals),
                                ASDIC_ARG_BUFFER(fan->counts), ASDIC_ARG_BUFFER(fan->made),
                                ASDIC_ARG_VALUE(blocks)};
    asdic_kernel_arg place[] = {ASDIC_ARG_BUFFER(pings), ASDIC_ARG_BUFFER(fan->counts),
                                ASDIC_ARG_BUFFER(fan->lists), ASDIC_ARG_BUFFER(fan->made),
                                ASDIC_ARG_VALUE(blocks)};
    asdic_kernel_arg scatter[] = {ASDIC_ARG_BUFFER(pings), ASDIC_ARG_BUFFER(arrivals),
                                  ASDIC_ARG_BUFFER(fan->counts), ASDIC_ARG_BUFFER(fan->entries),
                                  ASDIC_ARG_VALUE(blocks)};
    asdic_kernel_arg runs[] = {ASDIC_ARG_BUFFER(pings), ASDIC_ARG_BUFFER(fan->entries),
                               ASDIC_ARG_BUFFER(fan->lists)};
    TRY(asdic_kernel_run(fan->count, count, 5, blocks, local));
    TRY(asdic_kernel_run(fan->place, place, 5, bins, 64));
    TRY(asdic_kernel_run(fan->scatter, scatter, 5, blocks, local));
    return fan->width > 1 ? asdic_kernel_run(fan->runs, runs, 3, bins, local) : ASDIC_OK;
}

/* To BUFFER's memory on the host. */
static asdic_status fetch_part(asdic_buffer *buffer, size_t offset, size_t bytes,
                               asdic_fetch *fetch) {
    char *memory = asdic_buffer_memory(buffer);
    return asdic_buffer_fetch(buffer, offset, bytes, memory + offset, fetch);
}

asdic_status asdic_beam_fan_project(asdic_simulator *sim, asdic_buffer *truth) {
    asdic_beam_fan *fan = &sim->fan;
    const dev_ping *ping = sim->shots[0].ping;
    asdic_buffer *pings = sim->buffers.pings, *results = sim->buffers.results;
    size_t rows = fan->sums * fan->row, truth_bytes = sim->truth.bytes / fan->tiles;
    bool wide = fan->width > 1;
    size_t items = wide ? (ping->bins + 15) / 16 : ping->bins * (size_t)DEV_FAN_TILE;
    dev_uint add = ping->batch.first != 0;
    atomic_store(&fan->fetched, 0);
    TRY(sort(sim));
    for (dev_uint tile = 0; tile < fan->tiles; tile++) {
        asdic_kernel_arg args[] = {ASDIC_ARG_BUFFER(pings),
                                   ASDIC_ARG_BUFFER(fan->entries),
                                   ASDIC_ARG_BUFFER(fan->lists),
                                   ASDIC_ARG_BUFFER(results),
                                   ASDIC_ARG_VALUE(tile),
                                   ASDIC_ARG_VALUE(add),
                                   ASDIC_ARG_BUFFER(sim->truth.table_buffer),
                                   ASDIC_ARG_BUFFER(truth)};
        TRY(asdic_kernel_run(fan->project, args, 8, items, wide ? 1 : 64));
        size_t first = (size_t)tile * DEV_FAN_TILE, left = ping->beams - first;
        size_t bytes = (left < DEV_FAN_TILE ? left : DEV_FAN_TILE) * rows * sizeof(float);
        if (ping->batch.last) {
            TRY(fetch_part(results, first * rows * sizeof(float), bytes, &fan->fetches[tile]));
            TRY(fetch_part(truth, tile * truth_bytes, truth_bytes,
                           &fan->fetches[fan->tiles + tile]));
        }
    }
    return ASDIC_OK;
}

/* The lock is held. */
static asdic_status wait_in_order(asdic_beam_fan *fan, size_t tile) {
    for (size_t at = atomic_load(&fan->fetched); at <= tile; at++) {
        /* The later one first: a thread then sleeps once. */
        TRY(asdic_fetch_wait(&fan->fetches[fan->tiles + at]));
        TRY(asdic_fetch_wait(&fan->fetches[at]));
        atomic_store(&fan->fetched, at + 1);
    }
    return ASDIC_OK;
}

asdic_status asdic_beam_fan_wait(asdic_beam_fan *fan, size_t tile) {
    if (tile < atomic_load(&fan->fetched)) {
        return ASDIC_OK;
    }
    pthread_mutex_lock(&fan->lock);
    asdic_status status = wait_in_order(fan, tile);
    pthread_mutex_unlock(&fan->lock);
    return status;
}
