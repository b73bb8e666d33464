#include "trace_rig.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

asdic_scene *trace_rig_scene(const test_device *rig, const dev_triangle *triangles, size_t count) {
    asdic_scene *scene;
    assert_ok(rig->ctx, asdic_scene_create(rig->ctx, &scene));
    scene->triangles = malloc((count + 1) * sizeof *triangles);
    assert_non_null(scene->triangles);
    memcpy(scene->triangles, triangles, count * sizeof *triangles);
    scene->triangle_count = count;
    assert_ok(rig->ctx, asdic_bvh_build(rig->ctx, triangles, NULL, count, 1, &scene->bvh));
    scene->committed = true;
    return scene;
}

void trace_rig_run(const test_device *rig, const asdic_scene *scene, const char *form,
                   const dev_ray *rays, uint32_t count, dev_hit *hits) {
    asdic_device *device = rig->device;
    asdic_tracer *tracer;
    asdic_buffer *ray_buffer, *hit_buffer;
    assert_ok(rig->ctx, asdic_tracer_create(device, scene, &tracer));
    assert_ok(rig->ctx, asdic_tracer_set_kernel(tracer, form));
    assert_ok(rig->ctx, asdic_buffer_create(device, count * sizeof *rays, rays, &ray_buffer));
    assert_ok(rig->ctx, asdic_buffer_create(device, count * sizeof *hits, NULL, &hit_buffer));
    assert_ok(rig->ctx, asdic_tracer_run(tracer, ray_buffer, hit_buffer, count, count, 0));
    assert_ok(rig->ctx, asdic_buffer_read(hit_buffer, 0, count * sizeof *hits, hits));
    asdic_buffer_destroy(&hit_buffer);
    asdic_buffer_destroy(&ray_buffer);
    asdic_tracer_destroy(&tracer);
}

void trace_rig_run_all_forms(const test_device *rig, const asdic_scene *scene, const dev_ray *rays,
                             uint32_t count, dev_hit *hits) {
    dev_hit *again = malloc(count * sizeof *again);
    assert_non_null(again);
    trace_rig_run(rig, scene, "wide8", rays, count, hits);
    for (size_t form = 0; asdic_tracer_kernel_name(form); form++) {
        memset(again, 0, count * sizeof *again);
        trace_rig_run(rig, scene, asdic_tracer_kernel_name(form), rays, count, again);
        for (uint32_t i = 0; i < count; i++) {
            if (memcmp(&hits[i], &again[i], sizeof *hits) != 0) {
                print_error("%s: ray %u of %u hits %u at %.9g, wide8 hits %u at %.9g\n",
                            asdic_tracer_kernel_name(form), i, count, again[i].triangle,
                            again[i].t_m, hits[i].triangle, hits[i].t_m);
                fail();
            }
        }
    }
    free(again);
}

void trace_rig_run_all_blocks(const test_device *rig, const asdic_scene *scene, const dev_ray *rays,
                              uint32_t count, dev_hit *hits) {
    dev_hit *found = malloc(count * sizeof *found);
    assert_non_null(found);
    for (uint32_t i = 0; i < count; i++) {
        hits[i] = (dev_hit){INFINITY, ~0u};
    }
    asdic_scene lone = *scene;
    for (uint32_t b = 0; b < scene->bvh.block_count; b++) {
        lone.bvh.root = DEV_LEAF | b;
        trace_rig_run(rig, &lone, "wide8", rays, count, found);
        for (uint32_t i = 0; i < count; i++) {
            if (found[i].t_m < hits[i].t_m ||
                (found[i].t_m == hits[i].t_m && found[i].triangle < hits[i].triangle)) {
                hits[i] = found[i];
            }
        }
    }
    free(found);
}

dev_triangle trace_rig_triangle(const float v0[3], const float v1[3], const float v2[3]) {
    dev_triangle t = {.normal = {0.0f, 0.0f, 1.0f}};
    memcpy(t.v0, v0, sizeof t.v0);
    memcpy(t.v1, v1, sizeof t.v1);
    memcpy(t.v2, v2, sizeof t.v2);
    return t;
}

/* splitmix64, Steele, Lea and Flood 2014. */
double trace_rig_random(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

double trace_rig_random_signed(uint64_t *state) {
    return 2.0 * trace_rig_random(state) - 1.0;
}

dev_ray trace_rig_ray(const double origin[3], const double direction[3]) {
    double length = sqrt(direction[0] * direction[0] + direction[1] * direction[1] +
                         direction[2] * direction[2]);
    dev_ray ray = {.t_max = INFINITY};
    for (int k = 0; k < 3; k++) {
        ray.origin[k] = (float)origin[k];
        ray.direction[k] = (float)(direction[k] / length);
    }
    return ray;
}
