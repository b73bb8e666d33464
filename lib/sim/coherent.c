#include "coherent.h"

#include <asdic/plan.h>

#include "aim.h"
#include "base/context.h"
#include "base/memory_left.h"
#include "base/try.h"
#include "base/vec.h"
#include "noise_level.h"
#include "patches.h"
#include "pulse.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(args) (sizeof(args) / sizeof *(args))

/* Samples of a pulse. Its edges are half as long: with four, what beams make of an echo errs by -0.9 to 0.4 dB with its
 * place, with six by -0.18 to 0.12 dB, with eight by 0.06 dB at most. */
#define SAMPLES_OF_PULSE 8.0
/* Blocks of scatterers that are sorted at the same time. */
#define FEW_BLOCKS 32u
#define MANY_BLOCKS 1024u

/* Of a scatterer in all buffers, with the room to grow. */
#define SLOT_BYTES 160u

/* Buffers that hold something for every scatterer. */
typedef struct slot_buffers {
    asdic_buffer *places, *owner, *rays, *hits, *echoes, *gates, *sorted;
    size_t capacity;
} slot_buffers;

struct asdic_coherent {
    asdic_kernel *place, *shade, *count, *offset, *begin, *sort, *elements, *beams;
    asdic_buffer *told, *patches, *counts, *first, *weights, *steer, *pressure, *looks;
    slot_buffers slots;
    size_t patch_capacity;
    asdic_patches found;
    asdic_coherent_grid grid;
    dev_coherent now;
    float *steering; /* of beams */
    float *heard;    /* of beams, by looks */
    double weights2; /* sum of the weights' squares */
    /* As now.noise, which makes beams' bins as loud as those of intensities: of an element by itself, which hears the band. */
    float element_noise;
};

static double half_line_m(const asdic_array *array) {
    return 0.5 * array->spacing_m * (double)(array->elements - 1);
}

/* The looks of a bin are as far apart as a pulse is long, so that together they take in as much of an echo wherever it
 * is, and share little. */
asdic_coherent_grid asdic_coherent_grid_of(const asdic_sonar *sonar, double sound_speed_mps,
                                           size_t bins) {
    asdic_coherent_grid g;
    g.cell_m = 0.5 * sound_speed_mps / sonar->bandwidth_hz;
    unsigned looks = asdic_sonar_looks(sonar, sound_speed_mps);
    g.look_m = sonar->bin_length_m / looks;
    g.pulse_m = looks > 1 ? g.look_m : fmax(g.cell_m, g.look_m);
    g.sample_m = g.pulse_m / SAMPLES_OF_PULSE;
    g.samples = (size_t)ceil((double)bins * sonar->bin_length_m / g.sample_m - 1e-6);
    g.looks = bins * looks;
    return g;
}

/* How far off a scatterer is heard at an element, and the element in a beam's look. */
static double reach_m(const asdic_sonar *sonar, const asdic_coherent_grid *grid) {
    return 2.0 * (double)PULSE_REACH * grid->pulse_m + half_line_m(&sonar->array);
}

asdic_reach asdic_reach_of(const asdic_sonar *sonar, const asdic_sampling *sampling,
                           double sound_speed_mps) {
    asdic_reach r = {.bins = asdic_sonar_bin_count(sonar, sound_speed_mps)};
    if (sampling->coherent) {
        asdic_coherent_grid grid = asdic_coherent_grid_of(sonar, sound_speed_mps, r.bins);
        double reach = reach_m(sonar, &grid), blanking = sonar->blanking_m;
        r.margin = (size_t)ceil(reach / sonar->bin_length_m);
        r.from_m = fmax(blanking - reach, 0.5 * blanking);
    } else {
        r.margin = asdic_pulse_margin(sonar, sound_speed_mps, r.bins);
        r.from_m = asdic_pulse_from_m(sonar, sound_speed_mps);
    }
    r.to_m = (double)(r.bins + r.margin) * sonar->bin_length_m;
    return r;
}

asdic_status asdic_coherent_check(asdic_context *ctx, const asdic_sonar *sonar,
                                  const asdic_sampling *sampling) {
    const asdic_array *a = &sonar->array;
    if (!sampling->coherent) {
        return ASDIC_OK;
    }
    if (a->elements == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "coherent pings need an array of elements: give the sonar one");
    }
    return ASDIC_OK;
}

static asdic_status create_kernels(asdic_simulator *sim, asdic_coherent *c) {
    char options[96];
    snprintf(options, sizeof options, "-D ASDIC_WIDTH=%u -D ASDIC_HAS_MESH=%d",
             sim->setup.layout.width, sim->tracer ? 1 : 0);
    const struct {
        const char *name;
        asdic_kernel **kernel;
    } wanted[] = {{"coherent_place", &c->place},       {"coherent_shade", &c->shade},
                  {"coherent_count", &c->count},       {"coherent_offset", &c->offset},
                  {"coherent_first", &c->begin},       {"coherent_sort", &c->sort},
                  {"coherent_elements", &c->elements}, {"coherent_beams", &c->beams}};
    for (size_t i = 0; i < COUNT(wanted); i++) {
        TRY(asdic_kernel_create(sim->device, "coherent.cl", options, wanted[i].name,
                                wanted[i].kernel));
    }
    return ASDIC_OK;
}

/* What stays from ping to ping. */
static void describe(const asdic_simulator *sim, asdic_coherent *c,
                     const asdic_water_column *water) {
    const asdic_sonar *sonar = &sim->setup.sonar;
    const asdic_array *array = &sonar->array;
    const asdic_scene *scene = sim->setup.scene;
    size_t width = sim->setup.layout.width;
    double strength = asdic_volume_strength_lin(&sim->setup.env, sonar);
    double speed_mps = water->sound_speed_mps;
    c->grid = asdic_coherent_grid_of(sonar, speed_mps, asdic_simulator_bin_count(sim));
    size_t samples = asdic_coherent_grid_of(sonar, speed_mps, sim->setup.bins).samples;
    c->now = (dev_coherent){
        .spacing_m = (float)array->spacing_m,
        .sample_m = (float)c->grid.sample_m,
        .pulse_m = (float)c->grid.pulse_m,
        .margin_m = (float)(PULSE_REACH * c->grid.pulse_m + 0.5 * half_line_m(array)),
        .look_m = (float)c->grid.look_m,
        .water_lin = (float)strength,
        .elements = (dev_uint)array->elements,
        .lanes = (dev_uint)((array->elements + width - 1) / width * width),
        .samples = (dev_uint)samples,
        .gates = (dev_uint)((samples + DEV_GATE_SAMPLES - 1) / DEV_GATE_SAMPLES),
        .blocks = width > 1 ? FEW_BLOCKS : MANY_BLOCKS,
        .beams = (dev_uint)sonar->receiver_count,
        .looks = (dev_uint)c->grid.looks,
        .mirrored = {scene->has_surface ? DEV_KIND_SURFACE : DEV_KIND_BOTTOM, DEV_KIND_BOTTOM},
    };
}

static asdic_status make_weights(asdic_simulator *sim, asdic_coherent *c) {
    const asdic_array *array = &sim->setup.sonar.array;
    double *exact = malloc(array->elements * sizeof *exact);
    float *weights = calloc(c->now.lanes, sizeof *weights); /* 0 beyond the elements */
    asdic_status status = ASDIC_OK;
    if (!exact || !weights) {
        status = asdic_fail_memory(sim->ctx, "an array");
        goto end;
    }
    asdic_array_weights(array, exact);
    for (size_t e = 0; e < array->elements; e++) {
        weights[e] = (float)exact[e];
        c->weights2 += exact[e] * exact[e];
    }
    status = asdic_buffer_create(sim->device, c->now.lanes * sizeof *weights, weights, &c->weights);
end:
    free(exact);
    free(weights);
    return status;
}

static asdic_status create_buffers(asdic_simulator *sim, asdic_coherent *c) {
    const dev_coherent *n = &c->now;
    const struct {
        size_t bytes;
        asdic_buffer **buffer;
    } wanted[] = {
        {sizeof *n, &c->told},
        {(size_t)n->gates * n->blocks * sizeof(uint32_t), &c->counts},
        {((size_t)n->gates + 1) * sizeof(uint32_t), &c->first},
        {(size_t)n->beams * sizeof(float), &c->steer},
        {(size_t)n->lanes * n->samples * 2 * sizeof(float), &c->pressure},
        {(size_t)n->beams * n->looks * 2 * sizeof(float), &c->looks},
    };
    for (size_t i = 0; i < COUNT(wanted); i++) {
        TRY(asdic_buffer_create(sim->device, wanted[i].bytes, NULL, wanted[i].buffer));
    }
    return ASDIC_OK;
}

static asdic_status furnish(asdic_simulator *sim, const asdic_water_column *water,
                            asdic_coherent *c) {
    describe(sim, c, water);
    const dev_coherent *n = &c->now;
    c->steering = calloc(n->beams, sizeof *c->steering);
    c->heard = calloc((size_t)n->beams * n->looks, 2 * sizeof *c->heard);
    if (!c->steering || !c->heard) {
        return asdic_fail_memory(sim->ctx, "the beams of an array");
    }
    TRY(make_weights(sim, c));
    TRY(create_kernels(sim, c));
    return create_buffers(sim, c);
}

/* Pairs of ways there and back: the straight one, and those by way of the planes that mirror. */
static size_t ways_of(const asdic_simulator *sim) {
    double depth_m[2];
    return 1 + DEV_MIRROR_WAYS * asdic_patches_mirrors(sim, depth_m);
}

/* Whether what is LEFT suffices. SMOOTH: of the scatterers, those of smooth bodies. */
static asdic_status check_memory(const asdic_simulator *sim, size_t scatterers, size_t smooth,
                                 uint64_t left) {
    char what[64];
    snprintf(what, sizeof what, "a ping of %zu scatterers or more needs", scatterers);
    const char *remedy =
        2 * smooth > scatterers
            ? "make smooth bodies smaller, give them slopes, or lower the frequency"
        : scatterers > sim->setup.sampling.rays
            ? "hear less far, or with fewer elements, beams or less bandwidth"
            : "use fewer rays";
    return asdic_memory_check(sim->ctx, (uint64_t)scatterers * ways_of(sim) * SLOT_BYTES, left,
                              what, remedy);
}

/* Finds the scatterers, as long as there is room for them: of a large smooth wall there may be billions. */
static asdic_status find_scatterers(asdic_simulator *sim, const asdic_ping_shot *shot,
                                    asdic_coherent *c) {
    uint64_t left = asdic_memory_left(), each = ways_of(sim) * SLOT_BYTES;
    c->found.most = (size_t)(left / each) + c->slots.capacity;
    TRY(asdic_patches_find(sim, shot, &c->found));
    return c->found.slots > c->found.most ? check_memory(sim, c->found.slots, c->found.smooth, left)
                                          : ASDIC_OK;
}

asdic_status asdic_coherent_create(asdic_simulator *sim, const asdic_water_column *water,
                                   asdic_coherent **out) {
    if (sim->setup.bend_per_m != 0.0 || sim->setup.layer_count > 0) {
        return asdic_fail(sim->ctx, ASDIC_ERROR_ARGUMENT,
                          "coherent pings need one sound speed at all depths; the water's changes "
                          "with depth: leave refraction out of the model");
    }
    TRY(check_memory(sim, sim->setup.sampling.rays, 0, asdic_memory_left()));
    *out = calloc(1, sizeof **out);
    return *out ? furnish(sim, water, *out) : asdic_fail_memory(sim->ctx, "a coherent ping");
}

static void destroy_slots(slot_buffers *s) {
    asdic_buffer **buffers[] = {&s->places, &s->owner, &s->rays,  &s->hits,
                                &s->echoes, &s->gates, &s->sorted};
    for (size_t i = 0; i < COUNT(buffers); i++) {
        asdic_buffer_destroy(buffers[i]);
    }
    s->capacity = 0;
}

void asdic_coherent_destroy(asdic_coherent **pointer) {
    asdic_coherent *c = pointer ? *pointer : NULL;
    if (!c) {
        return;
    }
    asdic_kernel **kernels[] = {&c->place, &c->shade, &c->count,    &c->offset,
                                &c->begin, &c->sort,  &c->elements, &c->beams};
    asdic_buffer **buffers[] = {&c->told,    &c->patches, &c->counts,   &c->first,
                                &c->weights, &c->steer,   &c->pressure, &c->looks};
    for (size_t i = 0; i < COUNT(kernels); i++) {
        asdic_kernel_destroy(kernels[i]);
    }
    for (size_t i = 0; i < COUNT(buffers); i++) {
        asdic_buffer_destroy(buffers[i]);
    }
    destroy_slots(&c->slots);
    asdic_patches_finish(&c->found);
    free(c->steering);
    free(c->heard);
    free(c);
    *pointer = NULL;
}

/* Room for as many scatterers and patches as were found, and some more; buffers for none, too. */
static asdic_status make_room(asdic_simulator *sim, asdic_coherent *c) {
    slot_buffers *s = &c->slots;
    if (!c->patches || c->found.count > c->patch_capacity) {
        asdic_buffer_destroy(&c->patches);
        c->patch_capacity = c->found.count + c->found.count / 2;
        TRY(asdic_buffer_create(sim->device, c->patch_capacity * sizeof(dev_patch), NULL,
                                &c->patches));
    }
    if (s->places && c->found.slots <= s->capacity) {
        return ASDIC_OK;
    }
    destroy_slots(s);
    TRY(check_memory(sim, c->found.slots, c->found.smooth, asdic_memory_left()));
    size_t room = c->found.slots + c->found.slots / 8, traced = sim->tracer ? room : 0;
    size_t heard = room * ways_of(sim);
    const struct {
        size_t bytes;
        asdic_buffer **buffer;
    } wanted[] = {
        {room * 4 * sizeof(float), &s->places}, {room * sizeof(uint32_t), &s->owner},
        {traced * sizeof(dev_ray), &s->rays},   {traced * sizeof(dev_hit), &s->hits},
        {heard * sizeof(dev_echo), &s->echoes}, {heard * sizeof(uint32_t), &s->gates},
        {heard * sizeof(dev_echo), &s->sorted},
    };
    for (size_t i = 0; i < COUNT(wanted); i++) {
        TRY(asdic_buffer_create(sim->device, wanted[i].bytes, NULL, wanted[i].buffer));
    }
    s->capacity = room;
    return ASDIC_OK;
}

/* What makes an element's noise in a sample, as loud as the noise in LENGTH_M of a bin of which a beam holds a SHARE. The
 * pulse's energy on the grid is its length over a sample's. */
static float noise_of(const asdic_simulator *sim, const asdic_water_column *water,
                      const asdic_coherent *c, double share, double length_m) {
    const asdic_sonar *sonar = &sim->setup.sonar;
    double bin = asdic_noise_element_lin(&sim->setup.env, sonar, share, water->sound_speed_mps);
    return (float)sqrt(bin * length_m / sonar->bin_length_m * c->grid.sample_m / c->grid.pulse_m /
                       asdic_simulator_source_lin(sim, water));
}

/* What changes with the pose. */
static asdic_status tell(asdic_simulator *sim, asdic_coherent *c, const asdic_ping_shot *shot) {
    dev_coherent *n = &c->now;
    const asdic_array *array = &sim->setup.sonar.array;
    double wavelength_m = shot->water.wavelength_m;
    dev_beam element = asdic_aim_beam(&array->element, &shot->pose, wavelength_m);
    asdic_vec3 at = asdic_vec3_sub(shot->pose.position_m, sim->placement->origin_m);
    const double exact[3] = {at.x, at.y, at.z};
    for (int axis = 0; axis < 3; axis++) {
        n->low[axis] = (float)(exact[axis] - (double)shot->ping->origin[axis]);
    }
    memcpy(n->rows, element.rows, sizeof n->rows);
    n->turns_per_m = (float)(1.0 / wavelength_m);
    n->turns_per_m_low = (float)(1.0 / wavelength_m - (double)n->turns_per_m);
    n->element_h_wl = element.length_h_wl;
    n->element_v_wl = element.length_v_wl;
    n->noise = noise_of(sim, &shot->water, c, c->weights2, c->grid.pulse_m);
    c->element_noise = noise_of(sim, &shot->water, c, 1.0, c->grid.cell_m);
    n->patches = (dev_uint)c->found.count;
    n->scatterers = (dev_uint)c->found.slots;
    n->slots = (dev_uint)(c->found.slots * ways_of(sim));
    const dev_beam *beams = asdic_shot_beams(shot) + 1;
    for (size_t b = 0; b < n->beams; b++) {
        const float *axis = beams[b].rows, *line = n->rows + 3;
        c->steering[b] = axis[0] * line[0] + axis[1] * line[1] + axis[2] * line[2];
    }
    TRY(asdic_buffer_write(c->told, 0, sizeof *n, n));
    TRY(asdic_buffer_write(c->steer, 0, n->beams * sizeof(float), c->steering));
    TRY(asdic_buffer_write(c->patches, 0, c->found.count * sizeof(dev_patch), c->found.items));
    return asdic_buffer_write(sim->buffers.pings, 0, asdic_simulator_ping_bytes(sim), shot->ping);
}

static asdic_status run_scatterers(asdic_simulator *sim, asdic_coherent *c) {
    slot_buffers *s = &c->slots;
    asdic_buffer *ping = sim->buffers.pings;
    size_t width = sim->setup.layout.width, local = sim->setup.layout.local;
    asdic_kernel_arg place[] = {ASDIC_ARG_BUFFER(ping),       ASDIC_ARG_BUFFER(c->told),
                                ASDIC_ARG_BUFFER(c->patches), ASDIC_ARG_BUFFER(s->places),
                                ASDIC_ARG_BUFFER(s->owner),   ASDIC_ARG_BUFFER(s->rays)};
    TRY(asdic_kernel_run(c->place, place, COUNT(place), c->now.patches, local));
    if (sim->tracer && c->now.scatterers > 0) {
        TRY(asdic_tracer_run(sim->tracer, s->rays, s->hits, c->now.scatterers, c->now.scatterers,
                             0));
    }
    asdic_kernel_arg shade[] = {
        ASDIC_ARG_BUFFER(ping),
        ASDIC_ARG_BUFFER(c->told),
        ASDIC_ARG_BUFFER(c->patches),
        ASDIC_ARG_BUFFER(s->places),
        ASDIC_ARG_BUFFER(s->owner),
        ASDIC_ARG_BUFFER(s->hits),
        ASDIC_ARG_BUFFER(asdic_simulator_triangles(sim)),
        ASDIC_ARG_BUFFER(sim->buffers.parts),
        ASDIC_ARG_BUFFER(sim->buffers.materials),
        ASDIC_ARG_BUFFER(s->echoes),
        ASDIC_ARG_BUFFER(s->gates),
    };
    return asdic_kernel_run(c->shade, shade, COUNT(shade), (c->now.slots + width - 1) / width,
                            local);
}

/* Work-group size of kernels with few work-items, each of which has much to do: on processors one. */
static size_t few_local(const asdic_simulator *sim) {
    const asdic_layout *layout = &sim->setup.layout;
    return layout->width > 1 ? (layout->local + 15) / 16 : layout->local;
}

static asdic_status run_sort(asdic_simulator *sim, asdic_coherent *c) {
    slot_buffers *s = &c->slots;
    size_t local = few_local(sim);
    asdic_kernel_arg count[] = {ASDIC_ARG_BUFFER(c->told), ASDIC_ARG_BUFFER(s->gates),
                                ASDIC_ARG_BUFFER(c->counts)};
    asdic_kernel_arg offset[] = {ASDIC_ARG_BUFFER(c->told), ASDIC_ARG_BUFFER(c->counts),
                                 ASDIC_ARG_BUFFER(c->first)};
    asdic_kernel_arg begin[] = {ASDIC_ARG_BUFFER(c->told), ASDIC_ARG_BUFFER(c->first)};
    asdic_kernel_arg sort[] = {ASDIC_ARG_BUFFER(c->told),   ASDIC_ARG_BUFFER(s->gates),
                               ASDIC_ARG_BUFFER(c->counts), ASDIC_ARG_BUFFER(c->first),
                               ASDIC_ARG_BUFFER(s->echoes), ASDIC_ARG_BUFFER(s->sorted)};
    TRY(asdic_kernel_run(c->count, count, COUNT(count), c->now.blocks, local));
    TRY(asdic_kernel_run(c->offset, offset, COUNT(offset), c->now.gates, local));
    TRY(asdic_kernel_run(c->begin, begin, COUNT(begin), 1, 1));
    return asdic_kernel_run(c->sort, sort, COUNT(sort), c->now.blocks, local);
}

/* The first COUNT samples of every element, of which the first DEAF hear no echo. */
static asdic_status run_elements(asdic_simulator *sim, asdic_coherent *c, float noise,
                                 dev_uint deaf, size_t count) {
    size_t width = sim->setup.layout.width, own = DEV_OWN_GATES(width) * DEV_GATE_SAMPLES;
    size_t shares = (count + own - 1) / own;
    asdic_kernel_arg elements[] = {ASDIC_ARG_BUFFER(sim->buffers.pings), ASDIC_ARG_BUFFER(c->told),
                                   ASDIC_ARG_BUFFER(c->slots.sorted), ASDIC_ARG_BUFFER(c->first),
                                   ASDIC_ARG_BUFFER(c->pressure)};
    TRY(asdic_buffer_write(c->told, offsetof(dev_coherent, noise), sizeof noise, &noise));
    TRY(asdic_buffer_write(c->told, offsetof(dev_coherent, deaf), sizeof deaf, &deaf));
    return asdic_kernel_run(c->elements, elements, COUNT(elements), shares * (c->now.lanes / width),
                            few_local(sim));
}

/* The first COUNT looks of every beam. */
static asdic_status run_beams(asdic_simulator *sim, asdic_coherent *c, dev_uint count) {
    size_t width = sim->setup.layout.width;
    asdic_kernel_arg beams[] = {ASDIC_ARG_BUFFER(c->told), ASDIC_ARG_BUFFER(c->weights),
                                ASDIC_ARG_BUFFER(c->steer), ASDIC_ARG_BUFFER(c->pressure),
                                ASDIC_ARG_BUFFER(c->looks)};
    TRY(asdic_buffer_write(c->told, offsetof(dev_coherent, formed), sizeof count, &count));
    return asdic_kernel_run(c->beams, beams, COUNT(beams),
                            c->now.beams * (((size_t)count + width - 1) / width), few_local(sim));
}

/* How many steps, of STEP_M, have their middle before the end of the blanking. */
static dev_uint deaf_steps(const asdic_sonar *sonar, double step_m) {
    return (dev_uint)ceil(fmax(sonar->blanking_m / step_m - 0.5 - 1e-6, 0.0));
}

/* Samples that looks before the blanking's end take in. */
static size_t early_samples(const asdic_simulator *sim, const asdic_coherent *c) {
    const asdic_sonar *sonar = &sim->setup.sonar;
    double reach = ceil(reach_m(sonar, &c->grid) / c->grid.sample_m);
    size_t count = deaf_steps(sonar, c->grid.sample_m) + (size_t)reach;
    return count < c->now.samples ? count : c->now.samples;
}

/* Pressures of beams. Looks before the blanking's end hear noise alone. Those behind it are formed of all samples, those
 * from before it, too, at elements that a wave from aside comes to early: as loud as beams of intensities. */
static asdic_status form_beams(asdic_simulator *sim, asdic_coherent *c) {
    dev_uint deaf = deaf_steps(&sim->setup.sonar, c->grid.look_m);
    dev_uint looks = deaf < c->now.looks ? deaf : c->now.looks;
    size_t early = early_samples(sim, c);
    TRY(run_elements(sim, c, c->now.noise, 0, c->now.samples));
    TRY(run_beams(sim, c, c->now.looks));
    TRY(looks > 0 ? run_elements(sim, c, c->now.noise, (dev_uint)early, early) : ASDIC_OK);
    return looks > 0 ? run_beams(sim, c, looks) : ASDIC_OK;
}

/* The beams' looks to energies of bins. */
static void sum_looks(const asdic_simulator *sim, const asdic_coherent *c, double source_lin,
                      asdic_ping *out) {
    size_t looks = c->grid.looks / out->bins, cells = out->beams * out->bins;
    double unit = source_lin * c->grid.look_m / c->grid.pulse_m;
    double noise = sim->setup.sonar.noise_enabled ? (double)c->now.noise : 0.0;
    double level = noise * noise * source_lin * c->weights2 * c->grid.pulse_m / c->grid.sample_m *
                   out->bin_length_m / c->grid.pulse_m;
    for (int k = 0; k < ASDIC_COMPONENT_COUNT; k++) {
        memset(out->intensity_lin[k], 0, cells * sizeof(double));
    }
    for (size_t cell = 0; cell < cells; cell++) {
        out->stderr_db[cell] = NAN; /* none is known */
        const float *y = c->heard + 2 * looks * cell;
        double sum = 0.0;
        for (size_t k = 0; k < looks; k++) {
            sum += (double)y[2 * k] * y[2 * k] + (double)y[2 * k + 1] * y[2 * k + 1];
        }
        out->intensity_lin[ASDIC_TOTAL][cell] = unit * sum;
        out->intensity_lin[ASDIC_NOISE][cell] = level;
    }
}

/* Pressures re 1 uPa by element and sample, with the noise that elements hear. */
static asdic_status fetch_elements(asdic_simulator *sim, asdic_coherent *c, double source_lin,
                                   asdic_ping *out) {
    const dev_coherent *n = &c->now;
    if (!out->pressure) {
        return ASDIC_OK;
    }
    const size_t samples = c->grid.samples;
    if (out->elements != n->elements || out->samples != samples) {
        return asdic_fail(sim->ctx, ASDIC_ERROR_ARGUMENT,
                          "the ping has room for %zu elements x %zu samples, the simulator makes "
                          "%u x %zu",
                          out->elements, out->samples, n->elements, samples);
    }
    size_t bytes = samples * 2 * n->lanes * sizeof(float);
    float *rows = malloc(bytes), unit = (float)sqrt(source_lin);
    if (!rows) {
        return asdic_fail_memory(sim->ctx, "pressures at elements");
    }
    dev_uint deaf = deaf_steps(&sim->setup.sonar, c->grid.sample_m);
    size_t anew = c->element_noise == n->noise ? early_samples(sim, c) : samples;
    asdic_status status = run_elements(sim, c, c->element_noise, deaf, anew);
    status = status ? status : asdic_buffer_read(c->pressure, 0, bytes, rows);
    for (size_t s = 0; !status && s < samples; s++) {
        const float *re = rows + 2 * s * n->lanes, *im = re + n->lanes;
        for (size_t e = 0; e < n->elements; e++) {
            float *to = out->pressure + 2 * (e * samples + s);
            to[0] = re[e] * unit;
            to[1] = im[e] * unit;
        }
    }
    free(rows);
    out->sample_m = c->grid.sample_m;
    return status;
}

asdic_status asdic_coherent_ping(asdic_simulator *sim, const asdic_pose *pose, uint64_t index,
                                 asdic_ping *out) {
    asdic_coherent *c = sim->coherent;
    asdic_ping_shot *shot = &sim->shots[0];
    asdic_shot_aim(sim, shot, pose, index, ASDIC_STREAM_PING, sim->setup.sampling.rays);
    TRY(find_scatterers(sim, shot, c));
    TRY(make_room(sim, c));
    TRY(tell(sim, c, shot));
    TRY(run_scatterers(sim, c));
    TRY(run_sort(sim, c));
    TRY(form_beams(sim, c));
    TRY(asdic_buffer_read(c->looks, 0, (size_t)c->now.beams * c->now.looks * 2 * sizeof(float),
                          c->heard));
    double source_lin = asdic_simulator_source_lin(sim, &shot->water);
    out->bin_length_m = sim->setup.sonar.bin_length_m;
    out->rays = c->found.slots;
    out->saturated = 0;
    sum_looks(sim, c, source_lin, out);
    return fetch_elements(sim, c, source_lin, out);
}

/* Of the ways by mirrors so many are heard, and sorted and summed: others lead to the plane itself, or beyond the range. */
#define HEARD_BY_MIRRORS 0.25

static double heard_ways(const asdic_simulator *sim) {
    return 1.0 + HEARD_BY_MIRRORS * (double)(ways_of(sim) - 1);
}

/* Bytes of COUNT patches and of their SLOTS that are used, on host and device. */
static uint64_t bytes_of(const asdic_simulator *sim, size_t count, size_t slots) {
    size_t traced = sim->setup.scene->triangle_count > 0 ? sizeof(dev_ray) + sizeof(dev_hit) : 0;
    size_t place = 4 * sizeof(float) + sizeof(uint32_t) + traced;
    size_t shaded = ways_of(sim) * (sizeof(dev_echo) + sizeof(uint32_t));
    double each = (double)(place + shaded) + heard_ways(sim) * (double)sizeof(dev_echo);
    return (uint64_t)(1.125 * (double)slots * each) + 3 * count * sizeof(dev_patch);
}

/* Processor time, s: of a scatterer to be placed, to be traced, and to be shaded for a pair of ways; of its sum with a sample of an
 * element; of a sample of an element in a beam; of a sample's noise. Measured on an AMD EPYC with AVX-512, busy with other work. */
#define PLACE_S 150e-9
#define TRACE_S 50e-9
#define SHADE_S 100e-9
#define ECHO_SAMPLE_S 0.48e-9
#define BEAM_SAMPLE_S 0.4e-9
#define NOISE_SAMPLE_S 20e-9

/* Of a ping with so many SLOTS. */
static double processor_s_of(const asdic_simulator *sim, const asdic_coherent_grid *grid,
                             double slots) {
    const asdic_sonar *sonar = &sim->setup.sonar;
    double elements = (double)sonar->array.elements, beams = (double)sonar->receiver_count;
    double samples = (double)grid->samples, looks = (double)grid->looks;
    double reach = 2.0 * (double)PULSE_REACH * SAMPLES_OF_PULSE + 1.0;
    double place_s = PLACE_S + (sim->setup.scene->triangle_count > 0 ? TRACE_S : 0.0);
    return slots * (place_s + (double)ways_of(sim) * SHADE_S +
                    heard_ways(sim) * elements * reach * ECHO_SAMPLE_S) +
           beams * looks * elements * SAMPLES_OF_PULSE * BEAM_SAMPLE_S +
           (sonar->noise_enabled ? samples * elements * NOISE_SAMPLE_S : 0.0);
}

asdic_status asdic_coherent_foresee(asdic_simulator *sim, const asdic_pose *pose,
                                    asdic_coherent_forecast *out) {
    asdic_ping_shot *shot = &sim->shots[0];
    asdic_patches found = {.most = (size_t)(asdic_memory_left() / (ways_of(sim) * SLOT_BYTES))};
    asdic_shot_aim(sim, shot, pose, 0, ASDIC_STREAM_PING, sim->setup.sampling.rays);
    asdic_coherent_grid grid = asdic_coherent_grid_of(
        &sim->setup.sonar, shot->water.sound_speed_mps, asdic_simulator_bin_count(sim));
    asdic_status status = asdic_patches_find(sim, shot, &found);
    *out = (asdic_coherent_forecast){
        .scatterers = found.slots,
        .bytes = bytes_of(sim, found.count, found.slots),
        .fits = found.slots <= found.most,
        .processor_s = processor_s_of(sim, &grid, (double)found.slots),
    };
    asdic_patches_finish(&found);
    return status;
}

asdic_status asdic_coherent_echoes(asdic_simulator *sim, dev_echo **echoes, size_t *count) {
    asdic_coherent *c = sim->coherent;
    uint32_t end = 0;
    TRY(asdic_buffer_read(c->first, c->now.gates * sizeof end, sizeof end, &end));
    *count = end;
    *echoes = malloc((end + 1) * sizeof **echoes);
    return *echoes ? asdic_buffer_read(c->slots.sorted, 0, end * sizeof **echoes, *echoes)
                   : asdic_fail_memory(sim->ctx, "scatterers");
}

const dev_coherent *asdic_coherent_told(const asdic_coherent *coherent) {
    return &coherent->now;
}

size_t asdic_simulator_sample_count(const asdic_simulator *sim) {
    return sim && sim->coherent ? sim->coherent->grid.samples : 0;
}
