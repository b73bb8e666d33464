#include "tracer.h"

#include "base/try.h"

#include "../base/clock.h"
#include "../base/context.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Below this number of rays a measurement tells little and costs more than it can gain. */
#define MEASURE_RAYS 2048
/* Runs of each form: at least the first, and up to the second while they take less than this in
 * all. */
#define LEAST_RUNS 3
#define MOST_RUNS 8
#define MEASURE_S 0.02
/* Legs of rays through layers that have choices of their own: the first ones meet little, those that follow most
 * of the scene. Later ones go with the last of these. */
#define CHOICE_LEGS 8u
/* Buffers and legs for which the choice is kept; more than a simulator has. */
#define MAX_CHOICES 24

enum { FORM_WIDE8, FORM_PKT16, FORM_FRUSTUM64, FORM_SCALAR, FORM_COUNT, FORM_AUTO = FORM_COUNT };

/* Local sizes are fixed, because each size is compiled anew by some drivers. */
static const struct {
    const char *name, *file, *kernel;
    uint32_t rays; /* per work-item */
    bool told;     /* this number is the kernel's last argument */
    size_t local;
} forms[FORM_COUNT] = {
    [FORM_WIDE8] = {"wide8", "trace.cl", "trace_wide8", 64, false, 8},
    [FORM_PKT16] = {"pkt16", "trace_packets.cl", "trace_packets", 16, true, 16},
    [FORM_FRUSTUM64] = {"frustum64", "trace_packets.cl", "trace_packets", 64, true, 16},
    [FORM_SCALAR] = {"scalar", "trace_scalar.cl", "trace_scalar", 1, false, 64},
};

typedef struct choice {
    const asdic_buffer *rays;
    uint32_t leg;
    int form;
} choice;

struct asdic_tracer {
    asdic_device *device;
    asdic_buffer *nodes, *blocks, *triangles;
    asdic_kernel *kernels[FORM_COUNT]; /* built when first used */
    char options[64];
    uint32_t root;
    float extent_m;
    int form;      /* as set, or FORM_AUTO */
    uint64_t wait; /* so many rays to be cast yet before forms are measured */
    choice choices[MAX_CHOICES];
    size_t choice_count;
};

/* Few sizes give few programs: the smallest power of two that a walk of the tree cannot fill. */
static unsigned stack_entries(const asdic_bvh *bvh) {
    unsigned entries = 64;
    while (entries < 7 * bvh->depth + 8) {
        entries *= 2;
    }
    return entries;
}

static asdic_status upload(asdic_tracer *t, const asdic_scene *scene) {
    const asdic_bvh *bvh = &scene->bvh;
    TRY(asdic_buffer_create(t->device, bvh->node_count * sizeof *bvh->nodes, bvh->nodes,
                            &t->nodes));
    TRY(asdic_buffer_create(t->device, bvh->block_count * sizeof *bvh->blocks, bvh->blocks,
                            &t->blocks));
    return asdic_buffer_create(t->device, scene->triangle_count * sizeof *scene->triangles,
                               scene->triangles, &t->triangles);
}

/* What `auto` takes without measuring. */
static int plain_form(const asdic_tracer *t) {
    const asdic_device_info *info = asdic_device_get_info(t->device);
    bool scalar = info->kind == ASDIC_DEVICE_GPU || asdic_driver_refuses_vectors(info);
    return scalar ? FORM_SCALAR : FORM_WIDE8;
}

static asdic_status need_kernel(asdic_tracer *t, int form) {
    return t->kernels[form] ? ASDIC_OK
                            : asdic_kernel_create(t->device, forms[form].file, t->options,
                                                  forms[form].kernel, &t->kernels[form]);
}

asdic_status asdic_tracer_create(asdic_device *device, const asdic_scene *scene,
                                 asdic_tracer **out) {
    asdic_context *ctx = asdic_device_context(device);
    *out = NULL;
    if (!scene->committed) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "the scene is not committed");
    }
    asdic_tracer *t = calloc(1, sizeof *t);
    if (!t) {
        return asdic_fail_memory(ctx, "a tracer");
    }
    t->device = device;
    t->root = scene->bvh.root;
    t->extent_m = scene->bvh.extent_m;
    t->form = FORM_AUTO;
    snprintf(t->options, sizeof t->options, "-D TRACE_STACK=%u", stack_entries(&scene->bvh));
    asdic_status status = upload(t, scene);
    status = status ? status : need_kernel(t, plain_form(t));
    if (status) {
        asdic_tracer_destroy(&t);
    }
    *out = t;
    return status;
}

static asdic_status upload_copy(asdic_tracer *t, const asdic_placement *p, size_t copy) {
    const asdic_movable *m = &p->scene->movables[copy];
    const size_t node = sizeof *p->nodes, block = sizeof *p->blocks;
    TRY(asdic_buffer_write(t->nodes, m->first_node * node, m->node_count * node,
                           p->nodes + m->first_node));
    return asdic_buffer_write(t->blocks, m->first_block * block, m->block_count * block,
                              p->blocks + m->first_block);
}

asdic_status asdic_tracer_move(asdic_tracer *t, const asdic_placement *p, size_t movable) {
    const asdic_scene *scene = p->scene;
    size_t copies = asdic_scene_copies(scene), first = movable * copies;
    const asdic_movable *m = &scene->movables[first];
    const size_t node = sizeof *p->nodes, triangle = sizeof *p->triangles;
    TRY(asdic_buffer_write(t->nodes, 0, (scene->movable_count + 1) * node, p->nodes));
    for (size_t i = first; i < first + copies; i++) {
        TRY(upload_copy(t, p, i));
    }
    TRY(asdic_buffer_write(t->triangles, m->first * triangle, m->count * triangle,
                           p->triangles + p->first[first]));
    t->extent_m = p->extent_m;
    return ASDIC_OK;
}

asdic_status asdic_tracer_move_all(asdic_tracer *t, const asdic_placement *p) {
    for (size_t i = 0; i < p->scene->movable_count / asdic_scene_copies(p->scene); i++) {
        TRY(asdic_tracer_move(t, p, i));
    }
    return ASDIC_OK;
}

void asdic_tracer_destroy(asdic_tracer **tracer) {
    if (!tracer || !*tracer) {
        return;
    }
    asdic_tracer *t = *tracer;
    for (int form = 0; form < FORM_COUNT; form++) {
        asdic_kernel_destroy(&t->kernels[form]);
    }
    asdic_buffer_destroy(&t->triangles);
    asdic_buffer_destroy(&t->blocks);
    asdic_buffer_destroy(&t->nodes);
    free(t);
    *tracer = NULL;
}

asdic_status asdic_tracer_set_kernel(asdic_tracer *t, const char *name) {
    if (strcmp(name, "auto") == 0) {
        t->form = FORM_AUTO;
        return ASDIC_OK;
    }
    for (int form = 0; form < FORM_COUNT; form++) {
        if (strcmp(name, forms[form].name) == 0) {
            if (form != FORM_SCALAR &&
                asdic_driver_refuses_vectors(asdic_device_get_info(t->device))) {
                return asdic_fail(asdic_device_context(t->device), ASDIC_ERROR_UNSUPPORTED,
                                  "the driver of device '%s' cannot compile ray kernel '%s'; use "
                                  "auto or scalar",
                                  asdic_device_get_info(t->device)->name, name);
            }
            t->form = form;
            return need_kernel(t, form);
        }
    }
    return asdic_fail(
        asdic_device_context(t->device), ASDIC_ERROR_ARGUMENT,
        "'%s' is not a form of the ray kernel; use auto, wide8, pkt16, frustum64 or scalar", name);
}

const char *asdic_tracer_kernel_name(size_t index) {
    return index < FORM_COUNT ? forms[index].name : NULL;
}

const char *asdic_tracer_form(const asdic_tracer *t, const asdic_buffer *rays) {
    for (size_t i = 0; t->form == FORM_AUTO && i < t->choice_count; i++) {
        if (t->choices[i].rays == rays) {
            return forms[t->choices[i].form].name;
        }
    }
    return t->form == FORM_AUTO ? "auto" : forms[t->form].name;
}

void asdic_tracer_wait(asdic_tracer *t, uint64_t rays) {
    t->wait = rays;
}

void asdic_tracer_forget(asdic_tracer *t) {
    t->choice_count = 0;
}

static asdic_status run_form(asdic_tracer *t, int form, asdic_buffer *rays, asdic_buffer *hits,
                             uint32_t count) {
    asdic_kernel_arg args[] = {
        ASDIC_ARG_BUFFER(t->nodes),   ASDIC_ARG_BUFFER(t->blocks),
        ASDIC_ARG_BUFFER(rays),       ASDIC_ARG_BUFFER(hits),
        ASDIC_ARG_VALUE(count),       ASDIC_ARG_VALUE(t->root),
        ASDIC_ARG_VALUE(t->extent_m), ASDIC_ARG_VALUE(forms[form].rays),
    };
    size_t items = (count + forms[form].rays - 1) / forms[form].rays;
    TRY(need_kernel(t, form));
    return asdic_kernel_run(t->kernels[form], args,
                            sizeof args / sizeof *args - (forms[form].told ? 0 : 1), items,
                            forms[form].local);
}

/* How long FORM takes by what it has SPENT_S of the processors' time: other load hardly shows in that. Work-groups
 * that are no multiple of the device's units leave some idle at the end. */
static double form_time_s(const asdic_tracer *t, int form, uint32_t count, double spent_s) {
    unsigned units = asdic_device_get_info(t->device)->compute_units;
    size_t rays = forms[form].rays * forms[form].local, groups = (count + rays - 1) / rays;
    return spent_s * (double)((groups + units - 1) / units) / (double)groups;
}

/* The fastest form on these rays; the hits are right whichever ran last. */
static asdic_status measure(asdic_tracer *t, asdic_buffer *rays, asdic_buffer *hits, uint32_t count,
                            int *fastest) {
    double least_s = INFINITY, spent_s = 0.0;
    /* The forms take turns, so that other load meets all of them alike. */
    for (int run = 0; run <= LEAST_RUNS || (run <= MOST_RUNS && spent_s < MEASURE_S); run++) {
        for (int form = FORM_WIDE8; form <= FORM_FRUSTUM64; form++) {
            TRY(asdic_device_finish(t->device));
            double start_s = asdic_clock_s(), busy_s = asdic_processor_s();
            TRY(run_form(t, form, rays, hits, count));
            TRY(asdic_device_finish(t->device));
            double taken_s = form_time_s(t, form, count, asdic_processor_s() - busy_s);
            spent_s += run > 0 ? asdic_clock_s() - start_s : 0.0; /* the first run compiles */
            if (run > 0 && taken_s < least_s) {
                least_s = taken_s;
                *fastest = form;
            }
        }
    }
    return ASDIC_OK;
}

static asdic_status choose(asdic_tracer *t, asdic_buffer *rays, asdic_buffer *hits, uint32_t count,
                           uint32_t leg, int *form) {
    *form = plain_form(t);
    for (size_t i = 0; i < t->choice_count; i++) {
        if (t->choices[i].rays == rays && t->choices[i].leg == leg) {
            *form = t->choices[i].form;
            return ASDIC_OK;
        }
    }
    bool scalar = *form == FORM_SCALAR;
    if ((!scalar && count < MEASURE_RAYS) || t->choice_count == MAX_CHOICES) {
        return ASDIC_OK;
    }
    if (!scalar && t->wait > 0) {
        return ASDIC_OK;
    }
    if (!scalar) {
        TRY(measure(t, rays, hits, count, form));
    }
    t->choices[t->choice_count++] = (choice){rays, leg, *form};
    asdic_log(asdic_device_context(t->device), ASDIC_LOG_DEBUG,
              "ray kernel: %s for %u rays, leg %u", forms[*form].name, count, leg);
    return ASDIC_OK;
}

asdic_status asdic_tracer_run(asdic_tracer *t, asdic_buffer *rays, asdic_buffer *hits,
                              uint32_t count, uint32_t sample, uint32_t leg) {
    int form = t->form;
    if (form == FORM_AUTO) {
        leg = leg < CHOICE_LEGS ? leg : CHOICE_LEGS - 1;
        TRY(choose(t, rays, hits, sample < count ? sample : count, leg, &form));
    }
    t->wait -= count < t->wait ? count : t->wait;
    return run_form(t, form, rays, hits, count);
}

asdic_buffer *asdic_tracer_triangles(asdic_tracer *tracer) {
    return tracer->triangles;
}
