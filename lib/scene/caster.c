#include <asdic/rays.h>

/* Bent rays; without a bend they are straight. */
#define ASDIC_BENT 1

#include "lifted.h"
#include "tracer.h"

#include "base/try.h"

#include "../../kernels/ray.h"

#include "../base/context.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_RAYS ((size_t)1 << 28)
/* Of water, with a margin where it is carried on to a depth that it does not have. */
#define LEAST_MPS 1000.0
#define MOST_MPS 2000.0
#define MOST_PER_S 30.0

_Static_assert(sizeof(asdic_ray) == sizeof(dev_ray), "a ray is the device's");
_Static_assert(sizeof(asdic_ray_hit) == sizeof(dev_hit), "a hit is the device's");

struct asdic_caster {
    asdic_context *ctx;
    asdic_device *device;
    const asdic_scene *scene;
    asdic_scene *lifted; /* NULL: rays are straight */
    asdic_tracer *tracer;
    asdic_buffer *rays, *hits;
    asdic_ray *loaded; /* as they came, where they bend */
    size_t count;
    bool is_cast; /* the rays that are loaded */
};

asdic_status asdic_caster_create(asdic_context *ctx, asdic_device *device, const asdic_scene *scene,
                                 const char *kernel, asdic_caster **out) {
    if (!ASDIC_PLACE(out) || !device || !scene) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_caster_create: NULL argument");
    }
    asdic_caster *c = *out = calloc(1, sizeof *c);
    if (!c) {
        return asdic_fail_memory(ctx, "a caster of rays");
    }
    c->ctx = ctx;
    c->device = device;
    c->scene = scene;
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
        asdic_scene_unlift(&(*caster)->lifted);
        free((*caster)->loaded);
        free(*caster);
        *caster = NULL;
    }
}

static void forget_rays(asdic_caster *c) {
    asdic_tracer_forget(c->tracer);
    asdic_buffer_destroy(&c->rays);
    asdic_buffer_destroy(&c->hits);
    free(c->loaded);
    c->loaded = NULL;
    c->count = 0;
    c->is_cast = false;
}

asdic_status asdic_caster_bend(asdic_caster *c, double speed_mps, double gradient_per_s) {
    if (!c || !(speed_mps >= LEAST_MPS && speed_mps <= MOST_MPS) ||
        !(fabs(gradient_per_s) <= MOST_PER_S)) {
        return asdic_fail(c ? c->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_caster_bend: %g m/s (%g to %g) and %g 1/s (at most %g)", speed_mps,
                          LEAST_MPS, MOST_MPS, gradient_per_s, MOST_PER_S);
    }
    asdic_scene *lifted = NULL;
    asdic_tracer *tracer = NULL;
    asdic_status status = ASDIC_OK;
    if (gradient_per_s != 0.0) {
        status = asdic_scene_lift(c->scene, gradient_per_s / speed_mps, &lifted);
    }
    if (!status) {
        status = asdic_tracer_create(c->device, lifted ? lifted : c->scene, &tracer);
    }
    status = status ? status : asdic_tracer_set_kernel(tracer, asdic_tracer_form(c->tracer, NULL));
    if (status) {
        asdic_tracer_destroy(&tracer);
        asdic_scene_unlift(&lifted);
        return status;
    }
    forget_rays(c);
    asdic_tracer_destroy(&c->tracer);
    asdic_scene_unlift(&c->lifted);
    c->tracer = tracer;
    c->lifted = lifted;
    return ASDIC_OK;
}

static ray ray_of(const asdic_caster *c, const asdic_ray *own) {
    const float *o = own->origin_m, *d = own->direction;
    return ray_start(
        (triple){o[0], o[1], o[2]}, (triple){d[0], d[1], d[2]},
        (ray_medium){c->lifted->bend_per_m, 1.0 + c->lifted->bend_per_m * (double)o[2]});
}

/* Lifts COUNT rays, and keeps them. */
static asdic_status lift_rays(asdic_caster *c, const asdic_ray *rays, size_t count,
                              asdic_ray **lifted) {
    asdic_ray *to = *lifted = malloc(count * sizeof *to);
    c->loaded = malloc(count * sizeof *c->loaded);
    if (!to || !c->loaded) {
        return asdic_fail_memory(c->ctx, "rays that bend");
    }
    memcpy(c->loaded, rays, count * sizeof *rays);
    for (size_t i = 0; i < count; i++) {
        ray r = ray_of(c, &rays[i]);
        ray_medium water = {c->lifted->bend_per_m, 1.0};
        triple from = ray_lift(r.from, water), along = ray_traced(&r, water);
        double longest = isinf(rays[i].longest_m) ? INFINITY : ray_at_range(&r, rays[i].longest_m);
        to[i] = (asdic_ray){{(float)from.x, (float)from.y, (float)from.z},
                            (float)longest,
                            {(float)along.x, (float)along.y, (float)along.z},
                            0.0f};
    }
    return ASDIC_OK;
}

/* The range at which a ray meets TRIANGLE as it is, near where it met it lifted. */
static float unlifted_range(const asdic_caster *c, size_t nth, const asdic_ray_hit *hit) {
    const dev_triangle *t = &c->scene->triangles[hit->triangle];
    ray r = ray_of(c, &c->loaded[nth]);
    triple corner = {t->v0[0], t->v0[1], t->v0[2]};
    triple normal = {t->normal[0], t->normal[1], t->normal[2]};
    return (float)ray_range(&r, ray_onto(&r, hit->range_m, corner, normal));
}

asdic_status asdic_caster_load(asdic_caster *c, const asdic_ray *rays, size_t count) {
    if (!c || !rays || count == 0 || count > MOST_RAYS) {
        return asdic_fail(c ? c->ctx : NULL, ASDIC_ERROR_ARGUMENT,
                          "asdic_caster_load: %zu rays; 1 to %zu are allowed", count, MOST_RAYS);
    }
    forget_rays(c);
    asdic_ray *lifted = NULL;
    asdic_status status = c->lifted ? lift_rays(c, rays, count, &lifted) : ASDIC_OK;
    if (!status) {
        status =
            asdic_buffer_create(c->device, count * sizeof *rays, lifted ? lifted : rays, &c->rays);
    }
    free(lifted);
    TRY(status);
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
    TRY(asdic_tracer_run(c->tracer, c->rays, c->hits, count, count, 0));
    TRY(asdic_device_finish(c->device));
    c->is_cast = true;
    return ASDIC_OK;
}

asdic_status asdic_caster_read(asdic_caster *c, asdic_ray_hit *hits) {
    TRY(check_loaded(c));
    if (!hits || !c->is_cast) {
        return asdic_fail(c->ctx, ASDIC_ERROR_ARGUMENT,
                          "no hits to read, or no place for them: call asdic_caster_cast first");
    }
    TRY(asdic_buffer_read(c->hits, 0, c->count * sizeof *hits, hits));
    for (size_t i = 0; c->lifted && i < c->count; i++) {
        if (hits[i].triangle != ASDIC_NO_TRIANGLE) {
            hits[i].range_m = unlifted_range(c, i, &hits[i]);
        }
    }
    return ASDIC_OK;
}

const char *asdic_caster_kernel(const asdic_caster *c) {
    return c ? asdic_tracer_form(c->tracer, c->rays) : "auto";
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
