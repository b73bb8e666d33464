#include <asdic/rays.h>

#include "tracer.h"

#include "base/try.h"

#include "../base/context.h"

#include <stdlib.h>
#include <string.h>

#define MOST_RAYS ((size_t)1 << 28)

_Static_assert(sizeof(asdic_ray) == sizeof(dev_ray), "a ray is the device's");
_Static_assert(sizeof(asdic_ray_hit) == sizeof(dev_hit), "a hit is the device's");

struct asdic_caster {
    asdic_context *ctx;
    asdic_device *device;
    asdic_tracer *tracer;
    asdic_buffer *rays, *hits;
    size_t count;
};

asdic_status asdic_caster_create(asdic_context *ctx, asdic_device *device, const asdic_scene *scene,
                                 const char *kernel, asdic_caster **out) {
    if (!device || !scene || !out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_caster_create: NULL argument");
    }
    asdic_caster *c = *out = calloc(1, sizeof *c);
    if (!c) {
        return asdic_fail_memory(ctx, "a caster of rays");
    }
    c->ctx = ctx;
    c->device = device;
    asdic_status status = asdic_tracer_create(device, scene, &c->tracer);
    if (!status && kernel) {
        status = asdic_tracer_set_kernel(c->tracer, kernel);
    }
    if (status) {
        asdic_caster_destroy(out);
    }
    return status;
}

void asdic_caster_destroy(asdic_caster **caster) {
    if (caster && *caster) {
        asdic_buffer_destroy(&(*caster)->rays);
        asdic_buffer_destroy(&(*caster)->hits);
        asdic_tracer_destroy(&(*caster)->tracer);
        free(*caster);
        *caster = NULL;
    }
}

asdic_status asdic_caster_load(asdic_caster *c, const asdic_ray *rays, size_t count) {
    if (!c || !rays || count == 0 || count > MOST_RAYS) {
        return asdic_fail(c ? c->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_caster_load: %zu rays; 1 to %zu are allowed", count, MOST_RAYS);
    }
    asdic_tracer_forget(c->tracer);
    asdic_buffer_destroy(&c->rays);
    asdic_buffer_destroy(&c->hits);
    c->count = 0;
    TRY(asdic_buffer_create(c->device, count * sizeof *rays, rays, &c->rays));
    TRY(asdic_buffer_create(c->device, count * sizeof(asdic_ray_hit), NULL, &c->hits));
    c->count = count;
    return ASDIC_OK;
}

static asdic_status check_loaded(const asdic_caster *c) {
    return c && c->count > 0 ? ASDIC_OK
                             : asdic_fail(c ? c->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                                          "no rays are loaded: call asdic_caster_load first");
}

asdic_status asdic_caster_cast(asdic_caster *c) {
    TRY(check_loaded(c));
    uint32_t count = (uint32_t)c->count;
    TRY(asdic_tracer_run(c->tracer, c->rays, c->hits, count, count));
    return asdic_device_finish(c->device);
}

asdic_status asdic_caster_read(asdic_caster *c, asdic_ray_hit *hits) {
    TRY(check_loaded(c));
    return asdic_buffer_read(c->hits, 0, c->count * sizeof *hits, hits);
}

const char *asdic_caster_kernel(const asdic_caster *c) {
    if (!c) {
        return NULL;
    }
    return asdic_tracer_form(c->tracer, c->rays);
}

const char *asdic_ray_kernel_name(size_t index) {
    return asdic_tracer_kernel_name(index);
}

asdic_status asdic_scene_triangle(const asdic_scene *scene, size_t index, float corners_m[9]) {
    if (!scene || !corners_m) {
        return asdic_fail_null(scene ? scene->ctx : NULL, __func__);
    }
    if (!scene->committed || index >= scene->triangle_count) {
        return asdic_fail(scene->ctx, ASDIC_ERROR_ARGUMENT, "triangle %zu of a scene of %zu%s",
                          index, scene->triangle_count,
                          scene->committed ? "" : " that is not committed");
    }
    const dev_triangle *t = &scene->triangles[index];
    memcpy(corners_m, t->v0, sizeof t->v0);
    memcpy(corners_m + 3, t->v1, sizeof t->v1);
    memcpy(corners_m + 6, t->v2, sizeof t->v2);
    return ASDIC_OK;
}
