#include "fault.h"

#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#include <errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>

static atomic_long left;  /* calls until the one that fails; 0 or less: none will */
static atomic_long alive; /* OpenCL objects made and not released */
static atomic_bool pending;
static fault_kind armed;

void fault_arm(fault_kind kind, long nth) {
    armed = kind;
    atomic_store(&left, nth);
}

bool fault_disarm(void) {
    return atomic_exchange(&left, 0) < 0;
}

bool fault_pending(void) {
    return atomic_load(&pending);
}

long fault_alive(void) {
    return atomic_load(&alive);
}

/* Counts below zero once the call has come, so that it fails once. */
static bool fails(fault_kind kind) {
    long now = atomic_load(&left);
    if (kind != armed || now == 0) {
        return false;
    }
    if (atomic_fetch_sub(&left, 1) == 1) {
        atomic_store(&left, -1);
        return true;
    }
    return false;
}

/* ---- memory --------------------------------------------------------------------------------- */

/* Declared and defined; CALL is what the real one is called with. */
#define ALLOCATION(result, name, parameters, call, failure)                                        \
    result __real_##name parameters;                                                               \
    result __wrap_##name parameters;                                                               \
    result __wrap_##name parameters {                                                              \
        if (fails(FAULT_ALLOCATION)) {                                                             \
            errno = ENOMEM;                                                                        \
            return failure;                                                                        \
        }                                                                                          \
        return __real_##name call;                                                                 \
    }

ALLOCATION(void *, malloc, (size_t size), (size), NULL)
ALLOCATION(void *, calloc, (size_t count, size_t size), (count, size), NULL)
ALLOCATION(void *, realloc, (void *old, size_t size), (old, size), NULL)
ALLOCATION(char *, strdup, (const char *text), (text), NULL)
ALLOCATION(char *, strndup, (const char *text, size_t size), (text, size), NULL)
ALLOCATION(int, posix_memalign, (void **out, size_t align, size_t size), (out, align, size), ENOMEM)
ALLOCATION(int, vasprintf, (char **out, const char *format, va_list args), (out, format, args), -1)

int __wrap_asprintf(char **out, const char *format, ...) __attribute__((format(printf, 2, 3)));
int __wrap_asprintf(char **out, const char *format, ...) {
    va_list args;
    va_start(args, format);
    int length = __wrap_vasprintf(out, format, args);
    va_end(args);
    return length;
}

/* ---- threads -------------------------------------------------------------------------------- */

int __real_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *),
                          void *argument);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *),
                          void *argument);
int __wrap_pthread_create(pthread_t *thread, const pthread_attr_t *attributes, void *(*run)(void *),
                          void *argument) {
    return fails(FAULT_THREAD) ? EAGAIN : __real_pthread_create(thread, attributes, run, argument);
}

/* ---- OpenCL: what allocates answers that it could not, what works that the device is gone ---- */

#define NOTED_CALL(name, parameters, call, note)                                                   \
    cl_int __real_##name parameters;                                                               \
    cl_int __wrap_##name parameters;                                                               \
    cl_int __wrap_##name parameters {                                                              \
        if (fails(FAULT_OPENCL)) {                                                                 \
            return CL_OUT_OF_RESOURCES;                                                            \
        }                                                                                          \
        note;                                                                                      \
        return __real_##name call;                                                                 \
    }

#define CALL(name, parameters, call) NOTED_CALL(name, parameters, call, (void)0)

/* A command, after which the host has WAITED for all before it, or not. */
#define COMMAND(name, parameters, call, waited)                                                    \
    NOTED_CALL(name, parameters, call, atomic_store(&pending, !(waited)))

#define CREATION(result, name, parameters, call)                                                   \
    result __real_##name parameters;                                                               \
    result __wrap_##name parameters;                                                               \
    result __wrap_##name parameters {                                                              \
        if (fails(FAULT_OPENCL)) {                                                                 \
            *code = CL_OUT_OF_HOST_MEMORY;                                                         \
            return NULL;                                                                           \
        }                                                                                          \
        result made = __real_##name call;                                                          \
        atomic_fetch_add(&alive, made ? 1 : 0);                                                    \
        return made;                                                                               \
    }

/* The library retains nothing: what it releases is gone. */
#define RELEASE(name, type)                                                                        \
    cl_int __real_##name(type object);                                                             \
    cl_int __wrap_##name(type object);                                                             \
    cl_int __wrap_##name(type object) {                                                            \
        atomic_fetch_sub(&alive, 1);                                                               \
        return __real_##name(object);                                                              \
    }

typedef void(CL_CALLBACK *on_program)(cl_program, void *);
typedef void(CL_CALLBACK *on_memory)(cl_mem, void *);
typedef void(CL_CALLBACK *on_context)(const char *, const void *, size_t, void *);

CALL(clGetPlatformIDs, (cl_uint n, cl_platform_id *ids, cl_uint *count), (n, ids, count))
CALL(clGetPlatformInfo, (cl_platform_id id, cl_platform_info what, size_t n, void *to, size_t *got),
     (id, what, n, to, got))
CALL(clGetDeviceIDs,
     (cl_platform_id platform, cl_device_type type, cl_uint n, cl_device_id *ids, cl_uint *count),
     (platform, type, n, ids, count))
CALL(clGetDeviceInfo, (cl_device_id id, cl_device_info what, size_t n, void *to, size_t *got),
     (id, what, n, to, got))
CALL(clCreateSubDevices,
     (cl_device_id id, const cl_device_partition_property *how, cl_uint n, cl_device_id *ids,
      cl_uint *count),
     (id, how, n, ids, count))
CALL(clBuildProgram,
     (cl_program program, cl_uint n, const cl_device_id *ids, const char *options, on_program fn,
      void *user),
     (program, n, ids, options, fn, user))
CALL(clGetProgramBuildInfo,
     (cl_program program, cl_device_id id, cl_program_build_info what, size_t n, void *to,
      size_t *got),
     (program, id, what, n, to, got))
CALL(clGetKernelWorkGroupInfo,
     (cl_kernel kernel, cl_device_id id, cl_kernel_work_group_info what, size_t n, void *to,
      size_t *got),
     (kernel, id, what, n, to, got))
CALL(clSetKernelArg, (cl_kernel kernel, cl_uint index, size_t size, const void *value),
     (kernel, index, size, value))
CALL(clSetMemObjectDestructorCallback, (cl_mem memory, on_memory fn, void *user),
     (memory, fn, user))
COMMAND(clEnqueueWriteBuffer,
        (cl_command_queue queue, cl_mem memory, cl_bool wait, size_t offset, size_t n,
         const void *from, cl_uint events, const cl_event *list, cl_event *event),
        (queue, memory, wait, offset, n, from, events, list, event), wait)
COMMAND(clEnqueueReadBuffer,
        (cl_command_queue queue, cl_mem memory, cl_bool wait, size_t offset, size_t n, void *to,
         cl_uint events, const cl_event *list, cl_event *event),
        (queue, memory, wait, offset, n, to, events, list, event), wait)
COMMAND(clEnqueueFillBuffer,
        (cl_command_queue queue, cl_mem memory, const void *pattern, size_t size, size_t offset,
         size_t n, cl_uint events, const cl_event *list, cl_event *event),
        (queue, memory, pattern, size, offset, n, events, list, event), false)
COMMAND(clEnqueueNDRangeKernel,
        (cl_command_queue queue, cl_kernel kernel, cl_uint dims, const size_t *offset,
         const size_t *global, const size_t *local, cl_uint events, const cl_event *list,
         cl_event *event),
        (queue, kernel, dims, offset, global, local, events, list, event), false)
COMMAND(clFinish, (cl_command_queue queue), (queue), true)

CREATION(cl_context, clCreateContext,
         (const cl_context_properties *how, cl_uint n, const cl_device_id *ids, on_context fn,
          void *user, cl_int *code),
         (how, n, ids, fn, user, code))
CREATION(cl_command_queue, clCreateCommandQueue,
         (cl_context context, cl_device_id id, cl_command_queue_properties how, cl_int *code),
         (context, id, how, code))
CREATION(cl_mem, clCreateBuffer,
         (cl_context context, cl_mem_flags flags, size_t n, void *memory, cl_int *code),
         (context, flags, n, memory, code))
CREATION(cl_program, clCreateProgramWithSource,
         (cl_context context, cl_uint n, const char **texts, const size_t *lengths, cl_int *code),
         (context, n, texts, lengths, code))
CREATION(cl_kernel, clCreateKernel, (cl_program program, const char *name, cl_int *code),
         (program, name, code))

RELEASE(clReleaseContext, cl_context)
RELEASE(clReleaseCommandQueue, cl_command_queue)
RELEASE(clReleaseMemObject, cl_mem)
RELEASE(clReleaseProgram, cl_program)
RELEASE(clReleaseKernel, cl_kernel)
