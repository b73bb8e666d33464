#include "tracer.h"

#include "../base/context.h"

#include <stdio.h>
#include <stdlib.h>

/* Fixed, because each size is compiled anew by some drivers. */
#define LOCAL_SIZE 64

struct asdic_tracer {
    asdic_device *device;
    asdic_buffer *nodes, *blocks, *triangles;
    asdic_kernel *kernel;
    uint32_t root;
    float extent_m;
};

/* Few sizes, hence few programs: the smallest power of two that a walk of the tree cannot fill. */
static unsigned stack_entries(const asdic_bvh *bvh) {
    unsigned entries = 64;
    while (entries < 7 * bvh->depth + 8) {
        entries *= 2;
    }
    return entries;
}

static asdic_status upload(asdic_tracer *t, const asdic_scene *scene) {
    const asdic_bvh *bvh = &scene->bvh;
    asdic_status status =
        asdic_buffer_create(t->device, bvh->node_count * sizeof *bvh->nodes, bvh->nodes, &t->nodes);
    status = status ? status
                    : asdic_buffer_create(t->device, bvh->block_count * sizeof *bvh->blocks,
                                          bvh->blocks, &t->blocks);
    return status ? status
                  : asdic_buffer_create(t->device, scene->triangle_count * sizeof *scene->triangles,
                                        scene->triangles, &t->triangles);
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
    char options[64];
    snprintf(options, sizeof options, "-D TRACE_STACK=%u", stack_entries(&scene->bvh));
    asdic_status status = upload(t, scene);
    status =
        status ? status : asdic_kernel_create(device, "trace.cl", options, "trace", &t->kernel);
    if (status != ASDIC_OK) {
        asdic_tracer_destroy(&t);
    }
    *out = t;
    return status;
}

void asdic_tracer_destroy(asdic_tracer **tracer) {
    if (!tracer || !*tracer) {
        return;
    }
    asdic_tracer *t = *tracer;
    asdic_kernel_destroy(&t->kernel);
    asdic_buffer_destroy(&t->triangles);
    asdic_buffer_destroy(&t->blocks);
    asdic_buffer_destroy(&t->nodes);
    free(t);
    *tracer = NULL;
}

asdic_status asdic_tracer_run(asdic_tracer *t, asdic_buffer *rays, asdic_buffer *hits,
                              uint32_t count) {
    asdic_kernel_arg args[] = {
        ASDIC_ARG_BUFFER(t->nodes),   ASDIC_ARG_BUFFER(t->blocks), ASDIC_ARG_BUFFER(rays),
        ASDIC_ARG_BUFFER(hits),       ASDIC_ARG_VALUE(count),      ASDIC_ARG_VALUE(t->root),
        ASDIC_ARG_VALUE(t->extent_m),
    };
    return asdic_kernel_run(t->kernel, args, sizeof args / sizeof *args, count, LOCAL_SIZE);
}

asdic_buffer *asdic_tracer_triangles(asdic_tracer *tracer) {
    return tracer->triangles;
}
