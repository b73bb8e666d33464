/*
 * OpenCL for the rest of the library: buffers, kernels, enqueue, wait. cl.h and its error codes
 * stay inside lib/ocl.
 *
 * All work goes through one in-order queue per device; calls do not block unless they say so. One
 * device must not be used from two threads at once; different devices may.
 */
#ifndef ASDIC_OCL_OCL_H
#define ASDIC_OCL_OCL_H

#include <asdic/device.h>

typedef struct asdic_buffer asdic_buffer;
typedef struct asdic_kernel asdic_kernel;

/* A reading under way; all NULL: none. */
typedef struct asdic_fetch {
    asdic_buffer *buffer;
    void *event, *mapped;
} asdic_fetch;

/* BYTES 0 gives a buffer of 16 bytes (kernels need something to point at). DATA may be NULL.
 * Beyond CL_DEVICE_MAX_MEM_ALLOC_SIZE: ASDIC_ERROR_MEMORY with both numbers. */
asdic_status asdic_buffer_create(asdic_device *device, size_t bytes, const void *data,
                                 asdic_buffer **out);
void asdic_buffer_destroy(asdic_buffer **buffer);
size_t asdic_buffer_bytes(const asdic_buffer *buffer);
/* The host's memory for what is read from BUFFER, which owns it; NULL: there is not enough. Where device and host share
 * memory the buffer lies in it, and what is read to the place that it has there is not copied: it is valid until the
 * device changes it. */
void *asdic_buffer_memory(asdic_buffer *buffer);

/* The host memory may be reused when the call returns. */
asdic_status asdic_buffer_write(asdic_buffer *buffer, size_t offset, size_t bytes,
                                const void *data);
/* The same from the buffer's beginning without waiting: DATA must not change until the device has
 * finished. */
asdic_status asdic_buffer_send(asdic_buffer *buffer, size_t bytes, const void *data);
asdic_status asdic_buffer_zero(asdic_buffer *buffer, size_t bytes);
/* Blocks until everything enqueued before has finished. */
asdic_status asdic_buffer_read(asdic_buffer *buffer, size_t offset, size_t bytes, void *data);
/* The same without waiting: DATA is valid after asdic_fetch_wait, which must be called for every
 * OUT, before its buffer goes. */
asdic_status asdic_buffer_fetch(asdic_buffer *buffer, size_t offset, size_t bytes, void *data,
                                asdic_fetch *out);
/* Blocks, and ends FETCH, also when it fails. Waits for nothing where there is none. */
asdic_status asdic_fetch_wait(asdic_fetch *fetch);
/* The same where nobody wants the data any more: no failure is told. */
void asdic_fetch_abandon(asdic_fetch *fetch);

/* Kernel NAME of the embedded source FILE ("trace.cl"), built with OPTIONS ("-D X=1 ..."; "" for
 * none). Programs are cached per device and (file, options); each call gives a kernel object of
 * its own. A compile error becomes ASDIC_ERROR_DEVICE with the compiler's log, whose lines name
 * kernels/FILE:LINE. */
asdic_status asdic_kernel_create(asdic_device *device, const char *file, const char *options,
                                 const char *name, asdic_kernel **out);
void asdic_kernel_destroy(asdic_kernel **kernel);

/* One argument of a call: a buffer, a value, or local memory. */
typedef struct asdic_kernel_arg {
    asdic_buffer *buffer; /* not NULL: a buffer */
    const void *value;    /* not NULL: BYTES bytes by value */
    size_t bytes;         /* value NULL and buffer NULL: local memory of this size */
} asdic_kernel_arg;

#define ASDIC_ARG_BUFFER(b) ((asdic_kernel_arg){.buffer = (b)})
#define ASDIC_ARG_VALUE(v) ((asdic_kernel_arg){.value = &(v), .bytes = sizeof(v)})
#define ASDIC_ARG_LOCAL(n) ((asdic_kernel_arg){.bytes = (n)})

/* Enqueues COUNT arguments and a one-dimensional range; GLOBAL is rounded up to a multiple of
 * LOCAL (kernels test their index). LOCAL 0 lets the device choose; LOCAL above what device or
 * kernel allows is lowered to it. */
asdic_status asdic_kernel_run(asdic_kernel *kernel, const asdic_kernel_arg *args, size_t count,
                              size_t global, size_t local);

/* The same ROWS times at once; get_group_id(1) tells a row from the others. LOCAL is not 0. */
asdic_status asdic_kernel_run_rows(asdic_kernel *kernel, const asdic_kernel_arg *args, size_t count,
                                   size_t global, size_t local, size_t rows);

/* Largest work-group this kernel can have on its device. */
size_t asdic_kernel_max_work_group(const asdic_kernel *kernel);

/* Blocks until the queue is empty; reports failures of what was enqueued. */
asdic_status asdic_device_finish(asdic_device *device);
/* The same where nobody wants the results any more: no failure is told. */
void asdic_device_abandon(asdic_device *device);

/* Whether the driver's compiler is known to fail at kernels with vectors. */
bool asdic_driver_refuses_vectors(const asdic_device_info *info);

asdic_context *asdic_device_context(const asdic_device *device);

#endif
