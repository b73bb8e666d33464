#include "opencl.h"

#include <stdlib.h>
#include <time.h>

/* Of 0.1 ms each, for commands that are done; those that are not are not waited for. */
#define MOST_PAUSES 200

void asdic_device_may_compile(asdic_device *device) {
    if (!device->may_compile) {
        device->may_compile = true;
        asdic_context_compile_begin(device->ctx);
    }
}

void asdic_device_has_compiled(asdic_device *device) {
    if (device->may_compile) {
        device->may_compile = false;
        asdic_context_compile_end(device->ctx);
    }
}

/* Every command holds its queue. PoCL's threads let go of a command after they have said that it is done, and
 * crash where the process ends in between. */
static void await_release(cl_command_queue queue) {
    const struct timespec pause = {.tv_nsec = 100000};
    cl_uint holders = 1;
    for (int i = 0; i < MOST_PAUSES; i++) {
        cl_int code =
            clGetCommandQueueInfo(queue, CL_QUEUE_REFERENCE_COUNT, sizeof holders, &holders, NULL);
        if (code != CL_SUCCESS || holders <= 1) {
            return;
        }
        nanosleep(&pause, NULL);
    }
}

static void device_destroy(asdic_device **device) {
    if (!device || !*device) {
        return;
    }
    asdic_programs_destroy(&(*device)->programs);
    if ((*device)->queue) {
        await_release((*device)->queue);
        clReleaseCommandQueue((*device)->queue);
    }
    if ((*device)->cl) {
        clReleaseContext((*device)->cl);
    }
    asdic_device_has_compiled(*device);
    if ((*device)->is_sub_device) {
        clReleaseDevice((*device)->id);
    }
    free(*device);
    *device = NULL;
}

/* The result owns a sub-device's ID, also when this fails. */
static asdic_status device_create(asdic_context *ctx, cl_device_id id,
                                  const asdic_device_info *info, bool is_sub_device,
                                  asdic_device **out) {
    cl_int code;
    char text[64];
    asdic_device *device = calloc(1, sizeof *device);

    *out = NULL;
    if (!device) {
        if (is_sub_device) {
            clReleaseDevice(id);
        }
        return asdic_fail_memory(ctx, "a device");
    }
    device->ctx = ctx;
    device->info = *info;
    device->id = id;
    device->is_sub_device = is_sub_device;
    device->cl = clCreateContext(NULL, 1, &id, NULL, NULL, &code);
    if (device->cl) {
        device->queue = clCreateCommandQueue(device->cl, id, 0, &code);
    }
    if (!device->queue) {
        device_destroy(&device);
        return asdic_fail(ctx, ASDIC_ERROR_DEVICE, "device %u:%u (%s) cannot be opened: %s",
                          info->platform, info->device, info->name,
                          asdic_cl_error_text(code, text));
    }
    *out = device;
    return ASDIC_OK;
}

asdic_status asdic_devices_open(asdic_context *ctx, const char *selector, asdic_device ***out,
                                size_t *count) {
    asdic_listed *list = NULL;
    size_t *chosen = NULL;
    size_t listed = 0, chosen_count = 0;

    if (!ASDIC_PLACE(out) || !count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_devices_open needs OUT and COUNT");
    }
    *count = 0;
    asdic_status status = asdic_listed_create(ctx, &list, &listed);
    if (status != ASDIC_OK) {
        goto done;
    }
    chosen = calloc(listed + 1, sizeof *chosen);
    if (!chosen) {
        status = asdic_fail_memory(ctx, "a list of devices");
        goto done;
    }
    status = asdic_listed_select(ctx, list, listed, selector, chosen, &chosen_count);
    if (status != ASDIC_OK) {
        goto done;
    }
    *out = calloc(chosen_count, sizeof **out);
    if (!*out) {
        status = asdic_fail_memory(ctx, "a list of devices");
        goto done;
    }
    *count = chosen_count;
    for (size_t i = 0; i < chosen_count && status == ASDIC_OK; i++) {
        const asdic_listed *item = &list[chosen[i]];
        status = asdic_driver_is_pocl(&item->info) ? asdic_cache_check_room(ctx) : ASDIC_OK;
        status = status ? status : device_create(ctx, item->id, &item->info, false, &(*out)[i]);
    }
    if (status != ASDIC_OK) {
        asdic_devices_close(out, *count);
        *count = 0;
    }
done:
    free(chosen);
    free(list);
    return status;
}

void asdic_devices_close(asdic_device ***devices, size_t count) {
    if (!devices || !*devices) {
        return;
    }
    for (size_t i = 0; i < count; i++) {
        device_destroy(&(*devices)[i]);
    }
    free(*devices);
    *devices = NULL;
}

/* Equal parts of UNITS compute units each: there may be more of them than asked for. */
static asdic_status partition(asdic_device *device, size_t count, cl_device_id **out,
                              cl_uint *got) {
    char text[64];
    size_t units = device->info.compute_units / count;
    cl_device_partition_property how[] = {CL_DEVICE_PARTITION_EQUALLY,
                                          (cl_device_partition_property)units, 0};
    cl_int code = CL_INVALID_DEVICE_PARTITION_COUNT;

    *out = NULL;
    *got = 0;
    if (units > 0) {
        code = clCreateSubDevices(device->id, how, 0, NULL, got);
    }
    if (code != CL_SUCCESS || *got < count) {
        return asdic_fail(device->ctx, ASDIC_ERROR_UNSUPPORTED,
                          "device '%s' with %u compute units cannot be split in %zu: %s",
                          device->info.name, device->info.compute_units, count,
                          asdic_cl_error_text(code, text));
    }
    *out = calloc(*got, sizeof **out);
    if (!*out) {
        return asdic_fail_memory(device->ctx, "a list of sub-devices");
    }
    code = clCreateSubDevices(device->id, how, *got, *out, NULL);
    if (code != CL_SUCCESS) {
        free(*out);
        *out = NULL;
        return asdic_cl_fail(device, code, "split the device");
    }
    return ASDIC_OK;
}

asdic_status asdic_device_split(asdic_device *device, size_t count, asdic_device ***out) {
    if (!ASDIC_PLACE(out) || !device) {
        return asdic_fail_null(device ? device->ctx : NULL, __func__);
    }
    cl_device_id *ids = NULL;
    cl_uint got = 0;

    if (count == 0) {
        return asdic_fail(device->ctx, ASDIC_ERROR_ARGUMENT, "a device cannot be split in 0");
    }
    asdic_device **parts = calloc(count, sizeof *parts);
    if (!parts) {
        return asdic_fail_memory(device->ctx, "a list of sub-devices");
    }
    asdic_status status = partition(device, count, &ids, &got);
    asdic_device_info info = device->info;
    info.compute_units = (unsigned)(device->info.compute_units / count);
    for (size_t i = 0; i < got && ids; i++) {
        if (i < count && status == ASDIC_OK) {
            status = device_create(device->ctx, ids[i], &info, true, &parts[i]);
        } else {
            clReleaseDevice(ids[i]);
        }
    }
    free(ids);
    if (status != ASDIC_OK) {
        asdic_devices_close(&parts, count);
        return status;
    }
    *out = parts;
    return ASDIC_OK;
}

const asdic_device_info *asdic_device_get_info(const asdic_device *device) {
    return device ? &device->info : NULL;
}

asdic_context *asdic_device_context(const asdic_device *device) {
    return device->ctx;
}

static cl_int finish(asdic_device *device) {
    cl_int code = clFinish(device->queue);
    asdic_device_has_compiled(device);
    return code;
}

void asdic_device_abandon(asdic_device *device) {
    finish(device);
}

asdic_status asdic_device_finish(asdic_device *device) {
    cl_int code = finish(device);
    return code == CL_SUCCESS ? ASDIC_OK : asdic_cl_fail(device, code, "finish its work");
}
