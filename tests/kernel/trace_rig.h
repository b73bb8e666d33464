/*
 * A scene of float triangles and rays through it, for the tests of tracing.
 */
#ifndef ASDIC_TESTS_TRACE_RIG_H
#define ASDIC_TESTS_TRACE_RIG_H

#include "asserts.h"
#include "test_device.h"

#include "lib/scene/tracer.h"

/* A committed scene that owns a copy of COUNT triangles as they are, not recentred. */
asdic_scene *trace_rig_scene(const test_device *rig, const dev_triangle *triangles, size_t count);

/* The nearest hits by walking the hierarchy, with the named form of the kernel. */
void trace_rig_run(const test_device *rig, const asdic_scene *scene, const char *form,
                   const dev_ray *rays, uint32_t count, dev_hit *hits);

/* The same with the plain form, after every other one has given the same bytes. */
void trace_rig_run_all_forms(const test_device *rig, const asdic_scene *scene, const dev_ray *rays,
                             uint32_t count, dev_hit *hits);

/* The nearest hits by testing every block alone, without a node: what run must equal. */
void trace_rig_run_all_blocks(const test_device *rig, const asdic_scene *scene, const dev_ray *rays,
                              uint32_t count, dev_hit *hits);

dev_triangle trace_rig_triangle(const float v0[3], const float v1[3], const float v2[3]);

/* Deterministic numbers: [0, 1) and [-1, 1). */
double trace_rig_random(uint64_t *state);
double trace_rig_random_signed(uint64_t *state);

dev_ray trace_rig_ray(const double origin[3], const double direction[3]);

#endif
