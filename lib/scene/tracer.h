/*
 * A scene on a device, and rays through it.
 */
#ifndef ASDIC_SCENE_TRACER_H
#define ASDIC_SCENE_TRACER_H

#include "scene.h"

#include "../ocl/ocl.h"

typedef struct asdic_tracer asdic_tracer;

/* Uploads the committed SCENE, which must outlive the tracer, and builds the kernels. */
asdic_status asdic_tracer_create(asdic_device *device, const asdic_scene *scene,
                                 asdic_tracer **out);
void asdic_tracer_destroy(asdic_tracer **tracer);

/* Enqueues COUNT rays (dev_ray, scene frame) and their hits (dev_hit). */
asdic_status asdic_tracer_run(asdic_tracer *tracer, asdic_buffer *rays, asdic_buffer *hits,
                              uint32_t count);

/* dev_triangle by triangle id. */
asdic_buffer *asdic_tracer_triangles(asdic_tracer *tracer);

#endif
