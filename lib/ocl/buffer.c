#include "opencl.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>

/* Kernels need something to point at. */
#define SMALLEST_BYTES 16

/* From this size on, a buffer of a device that shares the host's memory lies in huge pages:
 * otherwise a walk through tens of megabytes of a tree misses the address cache at every step. */
#define HUGE_BUFFER_BYTES ((size_t)4 << 20)
#define HUGE_PAGE_BYTES ((size_t)2 << 20)

static void CL_CALLBACK free_pages(cl_mem mem, void *pages) {
    (void)mem;
    free(pages);
}

/* NULL where huge pages do not apply or are not available; the caller then lets OpenCL allocate. */
static cl_mem create_in_huge_pages(const asdic_device *device, size_t bytes) {
    void *pages = NULL;
    cl_int code;
    if (bytes < HUGE_BUFFER_BYTES || device->info.kind != ASDIC_DEVICE_CPU ||
        posix_memalign(&pages, HUGE_PAGE_BYTES, bytes) != 0) {
        return NULL;
    }
    madvise(pages, bytes, MADV_HUGEPAGE); /* only a hint: without it the buffer is slower */
    cl_mem mem =
        clCreateBuffer(device->cl, CL_MEM_READ_WRITE | CL_MEM_USE_HOST_PTR, bytes, pages, &code);
    if (code != CL_SUCCESS) {
        free(pages);
        return NULL;
    }
    if (clSetMemObjectDestructorCallback(mem, free_pages, pages) != CL_SUCCESS) {
        clReleaseMemObject(mem);
        free(pages);
        return NULL;
    }
    return mem;
}

/* "1.5 MiB"; of less "3.25 KiB" */
static const char *size_text(double bytes, char text[32]) {
    bool is_small = bytes < 1048576.0;
    snprintf(text, 32, is_small ? "%.4g KiB" : "%.1f MiB", bytes / (is_small ? 1024.0 : 1048576.0));
    return text;
}

asdic_status asdic_buffer_create(asdic_device *device, size_t bytes, const void *data,
                                 asdic_buffer **out) {
    const asdic_device_info *info = &device->info;
    cl_int code = CL_SUCCESS;
    char text[64], all[32], wanted[32];

    *out = NULL;
    size_text((double)bytes, wanted);
    if (bytes > info->max_alloc_bytes) {
        return asdic_fail(device->ctx, ASDIC_ERROR_MEMORY,
                          "device '%s' allows %s in one buffer, %s are needed; "
                          "use fewer rays or triangles, or another device",
                          info->name, size_text((double)info->max_alloc_bytes, all), wanted);
    }
    asdic_buffer *buffer = calloc(1, sizeof *buffer);
    if (!buffer) {
        return asdic_fail_memory(device->ctx, "a buffer");
    }
    buffer->device = device;
    buffer->bytes = bytes;
    buffer->mem = create_in_huge_pages(device, bytes);
    if (!buffer->mem) {
        buffer->mem = clCreateBuffer(device->cl, CL_MEM_READ_WRITE,
                                     bytes < SMALLEST_BYTES ? SMALLEST_BYTES : bytes, NULL, &code);
    }
    if (code != CL_SUCCESS) {
        free(buffer);
        return asdic_fail(device->ctx, ASDIC_ERROR_MEMORY,
                          "device '%s' with %s of memory cannot allocate %s: %s", info->name,
                          size_text((double)info->global_bytes, all), wanted,
                          asdic_cl_error_text(code, text));
    }
    if (data && bytes > 0) {
        asdic_status status = asdic_buffer_write(buffer, 0, bytes, data);
        if (status != ASDIC_OK) {
            asdic_buffer_destroy(&buffer);
            return status;
        }
    }
    *out = buffer;
    return ASDIC_OK;
}

void asdic_buffer_destroy(asdic_buffer **buffer) {
    if (buffer && *buffer) {
        clReleaseMemObject((*buffer)->mem);
        free(*buffer);
        *buffer = NULL;
    }
}

size_t asdic_buffer_bytes(const asdic_buffer *buffer) {
    return buffer->bytes;
}

static asdic_status check_range(const asdic_buffer *buffer, size_t offset, size_t bytes) {
    if (offset > buffer->bytes || bytes > buffer->bytes - offset) {
        return asdic_fail(buffer->device->ctx, ASDIC_ERROR_ARGUMENT,
                          "%zu bytes at %zu do not fit a buffer of %zu", bytes, offset,
                          buffer->bytes);
    }
    return ASDIC_OK;
}

static asdic_status write_buffer(asdic_buffer *buffer, cl_bool wait, size_t offset, size_t bytes,
                                 const void *data) {
    asdic_status status = check_range(buffer, offset, bytes);
    if (status != ASDIC_OK || bytes == 0) {
        return status;
    }
    cl_int code = clEnqueueWriteBuffer(buffer->device->queue, buffer->mem, wait, offset, bytes,
                                       data, 0, NULL, NULL);
    return code == CL_SUCCESS ? ASDIC_OK : asdic_cl_fail(buffer->device, code, "write to a buffer");
}

asdic_status asdic_buffer_write(asdic_buffer *buffer, size_t offset, size_t bytes,
                                const void *data) {
    return write_buffer(buffer, CL_TRUE, offset, bytes, data);
}

asdic_status asdic_buffer_send(asdic_buffer *buffer, size_t bytes, const void *data) {
    return write_buffer(buffer, CL_FALSE, 0, bytes, data);
}

asdic_status asdic_buffer_zero(asdic_buffer *buffer, size_t bytes) {
    static const unsigned char zeros[16];
    asdic_status status = check_range(buffer, 0, bytes);
    if (status != ASDIC_OK || bytes == 0) {
        return status;
    }
    /* The size of a fill is a multiple of its pattern; long patterns fill faster. */
    size_t pattern = bytes % 16 == 0 ? 16 : bytes % 4 == 0 ? 4 : 1;
    cl_int code = clEnqueueFillBuffer(buffer->device->queue, buffer->mem, zeros, pattern, 0, bytes,
                                      0, NULL, NULL);
    return code == CL_SUCCESS ? ASDIC_OK : asdic_cl_fail(buffer->device, code, "clear a buffer");
}

static asdic_status read_buffer(asdic_buffer *buffer, size_t offset, size_t bytes, void *data,
                                cl_event *event) {
    asdic_status status = check_range(buffer, offset, bytes);
    if (status != ASDIC_OK || bytes == 0) {
        return status;
    }
    cl_int code =
        clEnqueueReadBuffer(buffer->device->queue, buffer->mem, event ? CL_FALSE : CL_TRUE, offset,
                            bytes, data, 0, NULL, event);
    if (!event) {
        asdic_device_has_compiled(buffer->device);
    }
    return code == CL_SUCCESS ? ASDIC_OK : asdic_cl_fail(buffer->device, code, "read a buffer");
}

asdic_status asdic_buffer_read(asdic_buffer *buffer, size_t offset, size_t bytes, void *data) {
    return read_buffer(buffer, offset, bytes, data, NULL);
}

asdic_status asdic_buffer_fetch(asdic_buffer *buffer, size_t offset, size_t bytes, void *data,
                                asdic_fetch **out) {
    cl_event event = NULL;
    asdic_status status = read_buffer(buffer, offset, bytes, data, &event);
    *out = (asdic_fetch *)event;
    return status;
}

asdic_status asdic_fetch_wait(asdic_device *device, asdic_fetch **fetch) {
    cl_event event = (cl_event)*fetch;
    if (!event) {
        return ASDIC_OK;
    }
    cl_int code = clWaitForEvents(1, &event);
    asdic_device_has_compiled(device);
    clReleaseEvent(event);
    *fetch = NULL;
    return code == CL_SUCCESS ? ASDIC_OK : asdic_cl_fail(device, code, "read a buffer");
}
