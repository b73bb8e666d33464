#include "camera.h"

#include "base/context.h"

#include <math.h>
#include <stdlib.h>

asdic_status asdic_relief_init(asdic_context *ctx, size_t cells, asdic_relief *out) {
    *out = (asdic_relief){.cells = cells};
    out->depth_m = calloc(cells * cells, sizeof *out->depth_m);
    out->is_object = calloc(cells * cells, sizeof *out->is_object);
    return out->depth_m && out->is_object ? ASDIC_OK : asdic_fail_memory(ctx, "a relief");
}

void asdic_relief_finish(asdic_relief *relief) {
    free(relief->depth_m);
    free(relief->is_object);
    *relief = (asdic_relief){0};
}

/* Plumb lines from above everything there is. */
static void aim(const asdic_scene *scene, const asdic_relief *r, dev_ray *rays) {
    double above_m = fmin(0.0, scene->min_m.z) - 1.0, below_m = fmax(scene->max_m.z, above_m) + 1.0;
    for (size_t i = 0; i < r->cells * r->cells; i++) {
        double north_m = r->north_m + ((double)(i / r->cells) + 0.5) * r->cell_m;
        double east_m = r->east_m + ((double)(i % r->cells) + 0.5) * r->cell_m;
        rays[i] = (dev_ray){.origin = {(float)(north_m - scene->origin_m.x),
                                       (float)(east_m - scene->origin_m.y),
                                       (float)(above_m - scene->origin_m.z)},
                            .t_max = (float)(below_m - above_m),
                            .direction = {0.0f, 0.0f, 1.0f}};
    }
}

static void take(const asdic_scene *scene, const dev_ray *rays, const dev_hit *hits,
                 asdic_relief *r) {
    double plane_m = scene->has_bottom_plane ? scene->bottom_plane_depth_m : NAN;
    for (size_t i = 0; i < r->cells * r->cells; i++) {
        double depth_m = plane_m;
        r->is_object[i] = false;
        if (hits && hits[i].triangle != ~0u) {
            double z = (double)rays[i].origin[2] + (double)hits[i].t_m + scene->origin_m.z;
            if (!(depth_m < z)) {
                unsigned part = scene->triangles[hits[i].triangle].part;
                depth_m = z;
                r->is_object[i] = scene->parts[part].kind == DEV_KIND_OBJECT;
            }
        }
        r->depth_m[i] = (float)depth_m;
    }
}

asdic_status asdic_relief_trace(asdic_context *ctx, const asdic_simulator *sim,
                                asdic_relief *relief) {
    size_t count = relief->cells * relief->cells, slots = (count + 63) / 64 * 64;
    asdic_buffer *ray_buffer = NULL, *hit_buffer = NULL;
    asdic_status status = ASDIC_OK;
    if (!sim->tracer) {
        take(sim->scene, NULL, NULL, relief);
        return ASDIC_OK;
    }
    dev_ray *rays = calloc(slots, sizeof *rays);
    dev_hit *hits = calloc(slots, sizeof *hits);
    if (!rays || !hits) {
        status = asdic_fail_memory(ctx, "a relief's rays");
        goto done;
    }
    aim(sim->scene, relief, rays);
    status = asdic_buffer_create(sim->device, slots * sizeof *rays, rays, &ray_buffer);
    status =
        status ? status : asdic_buffer_create(sim->device, slots * sizeof *hits, NULL, &hit_buffer);
    status =
        status ? status : asdic_tracer_run(sim->tracer, ray_buffer, hit_buffer, (uint32_t)count);
    status = status ? status : asdic_buffer_read(hit_buffer, 0, count * sizeof *hits, hits);
    if (!status) {
        take(sim->scene, rays, hits, relief);
    }
done:
    asdic_buffer_destroy(&ray_buffer);
    asdic_buffer_destroy(&hit_buffer);
    free(rays);
    free(hits);
    return status;
}
