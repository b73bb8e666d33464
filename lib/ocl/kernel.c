#include "opencl.h"

#include "base/try.h"

#include <stdlib.h>
#include <stdio.h>

struct asdic_kernel {
    asdic_device *device;
    cl_kernel id;
    size_t max_work_group;
    bool has_run;
    char name[64]; /* for messages */
};

static size_t max_work_group(const asdic_kernel *kernel) {
    size_t sizes[16] = {0};
    size_t limit = 1, bytes = 0;
    cl_device_id id = kernel->device->id;
    if (clGetKernelWorkGroupInfo(kernel->id, id, CL_KERNEL_WORK_GROUP_SIZE, sizeof limit, &limit,
                                 NULL) != CL_SUCCESS ||
        limit == 0) {
        limit = 1;
    }
    /* The first dimension has a limit of its own. */
    if (clGetDeviceInfo(id, CL_DEVICE_MAX_WORK_ITEM_SIZES, sizeof sizes, sizes, &bytes) ==
            CL_SUCCESS &&
        bytes >= sizeof sizes[0] && sizes[0] > 0 && sizes[0] < limit) {
        limit = sizes[0];
    }
    return limit;
}

static asdic_status create_kernel(asdic_device *device, const char *file, const char *options,
                                  const char *name, asdic_kernel **out) {
    cl_program program = NULL;
    cl_int code = CL_SUCCESS;
    char text[64];

    *out = NULL;
    TRY(asdic_program_get(device, file, options, &program));
    asdic_kernel *kernel = calloc(1, sizeof *kernel);
    if (!kernel) {
        return asdic_fail_memory(device->ctx, "a kernel");
    }
    kernel->device = device;
    snprintf(kernel->name, sizeof kernel->name, "%s", name);
    kernel->id = clCreateKernel(program, name, &code);
    if (code != CL_SUCCESS) {
        free(kernel);
        return asdic_fail(device->ctx, ASDIC_ERROR_DEVICE,
                          "device '%s': no kernel '%s' in kernels/%s: %s", device->info.name, name,
                          file, asdic_cl_error_text(code, text));
    }
    kernel->max_work_group = max_work_group(kernel);
    *out = kernel;
    return ASDIC_OK;
}

asdic_status asdic_kernel_create(asdic_device *device, const char *file, const char *options,
                                 const char *name, asdic_kernel **out) {
    bool others_may = device->may_compile; /* which is over when they have run */
    asdic_device_may_compile(device);
    asdic_status status = create_kernel(device, file, options, name, out);
    if (!others_may) {
        asdic_device_has_compiled(device);
    }
    return status;
}

void asdic_kernel_destroy(asdic_kernel **kernel) {
    if (kernel && *kernel) {
        clReleaseKernel((*kernel)->id);
        free(*kernel);
        *kernel = NULL;
    }
}

size_t asdic_kernel_max_work_group(const asdic_kernel *kernel) {
    return kernel->max_work_group;
}

static cl_int set_argument(asdic_kernel *kernel, cl_uint index, const asdic_kernel_arg *arg) {
    if (arg->buffer) {
        return clSetKernelArg(kernel->id, index, sizeof arg->buffer->mem, &arg->buffer->mem);
    }
    return clSetKernelArg(kernel->id, index, arg->bytes, arg->value);
}

asdic_status asdic_kernel_run(asdic_kernel *kernel, const asdic_kernel_arg *args, size_t count,
                              size_t global, size_t local) {
    return asdic_kernel_run_rows(kernel, args, count, global, local, 1);
}

asdic_status asdic_kernel_run_rows(asdic_kernel *kernel, const asdic_kernel_arg *args, size_t count,
                                   size_t global, size_t local, size_t rows) {
    asdic_device *device = kernel->device;
    char what[128];

    for (size_t i = 0; i < count; i++) {
        cl_int code = set_argument(kernel, (cl_uint)i, &args[i]);
        if (code != CL_SUCCESS) {
            snprintf(what, sizeof what, "set argument %zu of kernel '%s'", i, kernel->name);
            return asdic_cl_fail(device, code, what);
        }
    }
    if (global == 0) {
        return ASDIC_OK; /* OpenCL 1.2 refuses an empty range */
    }
    if (local > kernel->max_work_group) {
        local = kernel->max_work_group;
    }
    if (local > 0) {
        global = (global + local - 1) / local * local;
    }
    if (!kernel->has_run) {
        kernel->has_run = true;
        asdic_device_may_compile(device);
    }
    const size_t range[2] = {global, rows}, group[2] = {local, 1};
    cl_int code = clEnqueueNDRangeKernel(device->queue, kernel->id, rows > 1 ? 2 : 1, NULL, range,
                                         local > 0 ? group : NULL, 0, NULL, NULL);
    if (code != CL_SUCCESS) {
        snprintf(what, sizeof what, "run kernel '%s'", kernel->name);
        return asdic_cl_fail(device, code, what);
    }
    return ASDIC_OK;
}
