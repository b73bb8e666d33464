/*
 * A scene on a device, and rays through it.
 *
 * The kernels exist in several forms that give the same bytes and differ in speed: `wide8` every
 * ray by itself against eight boxes, `pkt16` sixteen neighbouring rays together, `frustum64`
 * sixty-four rays from one point, `scalar` one ray a work-item without vectors (GPUs). `auto` takes
 * scalar on a GPU; elsewhere it measures the others on the first large set of rays in a buffer, and
 * remembers the fastest for that buffer. Until then it takes wide8, for which the least is compiled.
 */
#ifndef ASDIC_SCENE_TRACER_H
#define ASDIC_SCENE_TRACER_H

#include "placement.h"

#include "../ocl/ocl.h"

typedef struct asdic_tracer asdic_tracer;

/* Uploads the committed SCENE, which must outlive the tracer, and builds the kernels. */
asdic_status asdic_tracer_create(asdic_device *device, const asdic_scene *scene,
                                 asdic_tracer **out);
void asdic_tracer_destroy(asdic_tracer **tracer);

/* Chooses the form by name; "auto" in a new tracer. */
asdic_status asdic_tracer_set_kernel(asdic_tracer *tracer, const char *name);

/* The names for set_kernel one after the other, "auto" left out; NULL at the end. */
const char *asdic_tracer_kernel_name(size_t index);

/* The form that was set, or chosen for the rays in this buffer; "auto" where none is chosen yet. */
const char *asdic_tracer_form(const asdic_tracer *tracer, const asdic_buffer *rays);

/* Measures no form before RAYS more were cast: where few are cast, the driver shall not compile forms that
 * could not repay it. */
void asdic_tracer_wait(asdic_tracer *tracer, uint64_t rays);

/* Forgets what was chosen for any buffer. */
void asdic_tracer_forget(asdic_tracer *tracer);

/* Enqueues COUNT rays (dev_ray, scene frame) and their hits (dev_hit). Neighbours in the buffer
 * should be neighbours in direction: order changes the speed, never a hit. The first SAMPLE of them
 * stand for all where a form has to be chosen for this buffer, and for this LEG of its rays. */
asdic_status asdic_tracer_run(asdic_tracer *tracer, asdic_buffer *rays, asdic_buffer *hits,
                              uint32_t count, uint32_t sample, uint32_t leg);

/* Uploads the changes in PLACEMENT, of the tracer's scene, after MOVABLE has moved. */
asdic_status asdic_tracer_move(asdic_tracer *tracer, const asdic_placement *placement,
                               size_t movable);

/* The same after all movables have. */
asdic_status asdic_tracer_move_all(asdic_tracer *tracer, const asdic_placement *placement);

/* dev_triangle by triangle id. */
asdic_buffer *asdic_tracer_triangles(asdic_tracer *tracer);

#endif
