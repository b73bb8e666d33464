#include "opencl.h"

#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>

/* Kernels need something to point at. */
#define SMALLEST_BYTES 16

/* From this size on, a buffer of a device that shares the host's memory lies in pages of the host's, from which
 * nothing need be copied; of larger ones in huge pages: otherwise a walk through tens of megabytes of a tree misses
 * the address cache at every step. */
#define PAGE_BYTES ((size_t)4096)
#define HUGE_BUFFER_BYTES ((size_t)4 << 20)
#define HUGE_PAGE_BYTES ((size_t)2 << 20)

static void CL_CALLBACK free_pages(cl_mem mem, void *pages) {
    (void)mem;
    free(pages);
}

/* NULL where pages do not apply or are not available; the caller then lets OpenCL allocate. */
static cl_mem create_in_pages(const asdic_device *device, size_t bytes, void **memory) {
    void *pages = NULL;
    cl_int code;
    bool huge = bytes >= HUGE_BUFFER_BYTES;
    if (bytes < PAGE_BYTES || device->info.kind != ASDIC_DEVICE_CPU ||
        posix_memalign(&pages, huge ? HUGE_PAGE_BYTES : PAGE_BYTES, bytes) != 0) {
        return NULL;
    }
    if (huge) {
        madvise(pages, bytes, MADV_HUGEPAGE); /* only a hint: without it the buffer is slower */
    }
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
    *memory = pages;
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
    buffer->mem = create_in_pages(device, bytes, &buffer->memory);
    buffer->is_shared = buffer->mem != NULL;
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
        free((*buffer)->is_shared ? NULL : (*buffer)->memory);
        free(*buffer);
        *buffer = NULL;
    }
}

size_t asdic_buffer_bytes(const asdic_buffer *buffer) {
    return buffer->bytes;
}

void *asdic_buffer_memory(asdic_buffer *buffer) {
    if (!buffer->memory) {
        buffer->memory = malloc(buffer->bytes);
    }
    return buffer->memory;
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

/* To its own memory nothing need be copied: what is mapped has the latest. */
static cl_int enqueue_read(const asdic_buffer *buffer, cl_bool wait, size_t offset, size_t bytes,
                           void *data, cl_event *event, void **mapped) {
    cl_command_queue queue = buffer->device->queue;
    cl_int code;
    if (!buffer->is_shared || data != (char *)buffer->memory + offset) {
        return clEnqueueReadBuffer(queue, buffer->mem, wait, offset, bytes, data, 0, NULL, event);
    }
    *mapped = clEnqueueMapBuffer(queue, buffer->mem, wait, CL_MAP_READ, offset, bytes, 0, NULL,
                                 event, &code);
    return code;
}

/* The host is done with what was MAPPED of BUFFER, if anything was. */
static cl_int unmap(const asdic_buffer *buffer, void *mapped) {
    return mapped
               ? clEnqueueUnmapMemObject(buffer->device->queue, buffer->mem, mapped, 0, NULL, NULL)
               : CL_SUCCESS;
}

asdic_status asdic_buffer_read(asdic_buffer *buffer, size_t offset, size_t bytes, void *data) {
    void *mapped = NULL;
    asdic_status status = check_range(buffer, offset, bytes);
    if (status != ASDIC_OK || bytes == 0) {
        return status;
    }
    cl_int code = enqueue_read(buffer, CL_TRUE, offset, bytes, data, NULL, &mapped);
    asdic_device_has_compiled(buffer->device);
    code = code == CL_SUCCESS ? unmap(buffer, mapped) : code;
    return code == CL_SUCCESS ? ASDIC_OK : asdic_cl_fail(buffer->device, code, "read a buffer");
}

asdic_status asdic_buffer_fetch(asdic_buffer *buffer, size_t offset, size_t bytes, void *data,
                                asdic_fetch *out) {
    cl_event event = NULL;
    *out = (asdic_fetch){.buffer = buffer};
    asdic_status status = check_range(buffer, offset, bytes);
    if (status != ASDIC_OK || bytes == 0) {
        return status;
    }
    cl_int code = enqueue_read(buffer, CL_FALSE, offset, bytes, data, &event, &out->mapped);
    out->event = event;
    return code == CL_SUCCESS ? ASDIC_OK : asdic_cl_fail(buffer->device, code, "read a buffer");
}

static cl_int end_fetch(asdic_fetch *fetch) {
    cl_event event = (cl_event)fetch->event;
    if (!event) {
        return CL_SUCCESS;
    }
    cl_int code = clWaitForEvents(1, &event), unmapped = unmap(fetch->buffer, fetch->mapped);
    asdic_device_has_compiled(fetch->buffer->device);
    clReleaseEvent(event);
    fetch->event = fetch->mapped = NULL;
    return code == CL_SUCCESS ? unmapped : code;
}

asdic_status asdic_fetch_wait(asdic_fetch *fetch) {
    cl_int code = end_fetch(fetch);
    return code == CL_SUCCESS ? ASDIC_OK
                              : asdic_cl_fail(fetch->buffer->device, code, "read a buffer");
}

void asdic_fetch_abandon(asdic_fetch *fetch) {
    end_fetch(fetch);
}
