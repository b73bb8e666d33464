/*
 * Preloaded before the OpenCL loader: makes one device fail half-way, or small.
 *
 *     LD_PRELOAD=libopencl_fault.so OPENCL_FAULT=DEVICE:CALL:AFTER:CODE
 *
 * The DEVICE-th device that is opened (from 0) answers CODE to CALL, which is "kernel" (enqueue one),
 * "read", "write", "build" or "buffer", from the AFTER-th such call on. Until then the others are
 * slow, so that they do not do its work. CODE 0: the call first hangs for a minute, as a compiler may,
 * and says so.
 *
 * With OPENCL_WORK_GROUP=N no kernel may run in work-groups of more than N.
 */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SLOW_US 2000
#define HANG_S 60

#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>

#define MAX_DEVICES 16

typedef struct opened {
    cl_context context;
    cl_command_queue queue;
    cl_device_id device;
} opened;

static opened devices[MAX_DEVICES];
static int device_count;

static void *next(const char *name) {
    return dlsym(RTLD_NEXT, name);
}

/* CODE when the fault is due: CALL on device INDEX. */
static cl_int fault(int index, const char *call) {
    static int calls;
    const char *text = getenv("OPENCL_FAULT");
    char name[16] = "";
    int device, after, code;
    if (!text || sscanf(text, "%d:%15[a-z]:%d:%d", &device, name, &after, &code) != 4) {
        return CL_SUCCESS;
    }
    if (device != index && __atomic_load_n(&calls, __ATOMIC_RELAXED) <= after) {
        usleep(SLOW_US);
    }
    if (device != index || strcmp(name, call) != 0) {
        return CL_SUCCESS;
    }
    bool due = __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED) > after;
    if (due && code == 0) {
        fputs("opencl_fault: hangs\n", stderr);
        sleep(HANG_S);
    }
    return due ? code : CL_SUCCESS;
}

static int by_queue(cl_command_queue queue) {
    int i = 0;
    while (i < device_count && devices[i].queue != queue) {
        i++;
    }
    return i;
}

CL_API_ENTRY cl_command_queue CL_API_CALL clCreateCommandQueue(
    cl_context context, cl_device_id device, cl_command_queue_properties properties, cl_int *code) {
    cl_command_queue (*real)(cl_context, cl_device_id, cl_command_queue_properties, cl_int *) =
        next("clCreateCommandQueue");
    cl_command_queue queue = real(context, device, properties, code);
    if (queue && device_count < MAX_DEVICES) {
        devices[device_count++] = (opened){context, queue, device};
    }
    return queue;
}

CL_API_ENTRY cl_int CL_API_CALL clBuildProgram(cl_program program, cl_uint count,
                                               const cl_device_id *ids, const char *options,
                                               void(CL_CALLBACK *notify)(cl_program, void *),
                                               void *user) {
    cl_int (*real)(cl_program, cl_uint, const cl_device_id *, const char *,
                   void (*)(cl_program, void *), void *) = next("clBuildProgram");
    cl_context context = NULL;
    clGetProgramInfo(program, CL_PROGRAM_CONTEXT, sizeof context, &context, NULL);
    for (int i = 0; i < device_count; i++) {
        cl_int code = devices[i].context == context ? fault(i, "build") : CL_SUCCESS;
        if (code != CL_SUCCESS) {
            return code;
        }
    }
    return real(program, count, ids, options, notify, user);
}

CL_API_ENTRY cl_mem CL_API_CALL clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size,
                                               void *host, cl_int *code) {
    cl_mem (*real)(cl_context, cl_mem_flags, size_t, void *, cl_int *) = next("clCreateBuffer");
    for (int i = 0; i < device_count; i++) {
        cl_int wrong = devices[i].context == context ? fault(i, "buffer") : CL_SUCCESS;
        if (wrong != CL_SUCCESS) {
            *code = wrong;
            return NULL;
        }
    }
    return real(context, flags, size, host, code);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel,
                                                       cl_uint dimensions, const size_t *offset,
                                                       const size_t *global, const size_t *local,
                                                       cl_uint waits, const cl_event *list,
                                                       cl_event *event) {
    cl_int (*real)(cl_command_queue, cl_kernel, cl_uint, const size_t *, const size_t *,
                   const size_t *, cl_uint, const cl_event *, cl_event *) =
        next("clEnqueueNDRangeKernel");
    cl_int code = fault(by_queue(queue), "kernel");
    return code != CL_SUCCESS
               ? code
               : real(queue, kernel, dimensions, offset, global, local, waits, list, event);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueReadBuffer(cl_command_queue queue, cl_mem buffer,
                                                    cl_bool blocking, size_t offset, size_t size,
                                                    void *to, cl_uint waits, const cl_event *list,
                                                    cl_event *event) {
    cl_int (*real)(cl_command_queue, cl_mem, cl_bool, size_t, size_t, void *, cl_uint,
                   const cl_event *, cl_event *) = next("clEnqueueReadBuffer");
    cl_int code = fault(by_queue(queue), "read");
    return code != CL_SUCCESS ? code
                              : real(queue, buffer, blocking, offset, size, to, waits, list, event);
}

CL_API_ENTRY cl_int CL_API_CALL clEnqueueWriteBuffer(cl_command_queue queue, cl_mem buffer,
                                                     cl_bool blocking, size_t offset, size_t size,
                                                     const void *from, cl_uint waits,
                                                     const cl_event *list, cl_event *event) {
    cl_int (*real)(cl_command_queue, cl_mem, cl_bool, size_t, size_t, const void *, cl_uint,
                   const cl_event *, cl_event *) = next("clEnqueueWriteBuffer");
    cl_int code = fault(by_queue(queue), "write");
    return code != CL_SUCCESS
               ? code
               : real(queue, buffer, blocking, offset, size, from, waits, list, event);
}

CL_API_ENTRY cl_int CL_API_CALL clGetKernelWorkGroupInfo(cl_kernel kernel, cl_device_id device,
                                                         cl_kernel_work_group_info what,
                                                         size_t size, void *to, size_t *got) {
    cl_int (*real)(cl_kernel, cl_device_id, cl_kernel_work_group_info, size_t, void *, size_t *) =
        next("clGetKernelWorkGroupInfo");
    const char *limit = getenv("OPENCL_WORK_GROUP");
    cl_int code = real(kernel, device, what, size, to, got);
    if (code == CL_SUCCESS && limit && to && what == CL_KERNEL_WORK_GROUP_SIZE &&
        *(size_t *)to > strtoul(limit, NULL, 10)) {
        *(size_t *)to = strtoul(limit, NULL, 10);
    }
    return code;
}
