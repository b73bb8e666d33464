#include "run_elements.h"

#include "base/context.h"
#include "base/text.h"
#include "base/try.h"
#include "out/npy.h"
#include "run_folder.h"
#include "sim/coherent.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct asdic_elements {
    asdic_context *ctx;
    asdic_elements_shape shape;
    char *path, *part;
    int fd;
    uint64_t header, size;
};

asdic_elements_shape asdic_elements_shape_of(const asdic_settings *settings, size_t pings,
                                             size_t bins, double sound_speed_mps) {
    if (!settings->elements) {
        return (asdic_elements_shape){0};
    }
    asdic_coherent_grid grid = asdic_coherent_grid_of(&settings->sonar, sound_speed_mps, bins);
    return (asdic_elements_shape){pings, settings->sonar.array.elements, grid.samples};
}

uint64_t asdic_elements_bytes(const asdic_elements_shape *shape) {
    return (uint64_t)shape->elements * shape->samples * 2 * sizeof(float);
}

static asdic_status fail_io(const asdic_elements *e, const char *path, const char *what) {
    return asdic_fail(e->ctx, ASDIC_ERROR_IO, "cannot %s '%s': %s", what, path, strerror(errno));
}

/* The header for SHAPE, and its length. */
static size_t make_header(const asdic_elements_shape *shape, char header[ASDIC_NPY_HEADER_SIZE]) {
    char rest[64];
    snprintf(rest, sizeof rest, "%zu, %zu", shape->elements, shape->samples);
    return asdic_npy_header(header, "'<c8'", shape->pings, rest);
}

static asdic_status write_at(asdic_elements *e, const void *bytes, uint64_t size, uint64_t at) {
    const char *from = bytes;
    while (size > 0) {
        ssize_t written = pwrite(e->fd, from, size, (off_t)at);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            return fail_io(e, e->part, "write");
        }
        from += written;
        size -= (uint64_t)written;
        at += (uint64_t)written;
    }
    e->size = at > e->size ? at : e->size;
    return ASDIC_OK;
}

static asdic_status open_finished(asdic_elements *e) {
    char header[ASDIC_NPY_HEADER_SIZE];
    e->header = make_header(&e->shape, header);
    e->fd = open(e->path, O_RDONLY | O_CLOEXEC);
    return e->fd >= 0 ? ASDIC_OK : fail_io(e, e->path, "open");
}

static asdic_status open_part(asdic_elements *e, bool goes_on) {
    char header[ASDIC_NPY_HEADER_SIZE];
    struct stat st;
    if (goes_on && access(e->part, F_OK) != 0) {
        rename(e->path, e->part); /* a finished run some of whose pings are made again */
    }
    int flags = O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | (goes_on ? 0 : O_TRUNC);
    e->fd = open(e->part, flags, 0666);
    if (e->fd < 0 || fstat(e->fd, &st) != 0) {
        return fail_io(e, e->part, "open");
    }
    e->size = (uint64_t)st.st_size;
    e->header = make_header(&e->shape, header);
    return write_at(e, header, e->header, 0);
}

asdic_status asdic_elements_open(asdic_context *ctx, const char *folder, asdic_store_mode mode,
                                 const asdic_elements_shape *shape, asdic_elements **out) {
    *out = NULL;
    if (shape->elements == 0) {
        return ASDIC_OK;
    }
    asdic_elements *e = *out = calloc(1, sizeof *e);
    if (!e) {
        return asdic_fail_memory(ctx, ASDIC_ELEMENTS_NAME);
    }
    *e = (asdic_elements){.ctx = ctx, .shape = *shape, .fd = -1};
    e->path = asdic_folder_file(folder, ASDIC_ELEMENTS_NAME);
    e->part = asdic_folder_file(folder, ASDIC_ELEMENTS_NAME ".part");
    asdic_status status = !e->path || !e->part       ? asdic_fail_memory(ctx, "a file name")
                          : mode == ASDIC_STORE_READ ? open_finished(e)
                                                     : open_part(e, mode == ASDIC_STORE_RESUME);
    if (status) {
        asdic_elements_close(out);
    }
    return status;
}

asdic_elements_shape asdic_elements_shape_now(const asdic_elements *e) {
    return e ? e->shape : (asdic_elements_shape){0};
}

static uint64_t offset_of(const asdic_elements *e, size_t index) {
    return e->header + index * asdic_elements_bytes(&e->shape);
}

bool asdic_elements_has(const asdic_elements *e, size_t index) {
    return !e || e->size >= offset_of(e, index + 1);
}

bool asdic_elements_complete(const char *folder, const asdic_elements_shape *shape) {
    char header[ASDIC_NPY_HEADER_SIZE];
    struct stat st;
    if (shape->elements == 0) {
        return true;
    }
    char *path = asdic_folder_file(folder, ASDIC_ELEMENTS_NAME);
    uint64_t size = make_header(shape, header) + shape->pings * asdic_elements_bytes(shape);
    bool whole = path && stat(path, &st) == 0 && (uint64_t)st.st_size == size;
    free(path);
    return whole;
}

asdic_status asdic_elements_write(asdic_elements *e, size_t index, const float *pressure) {
    return e ? write_at(e, pressure, asdic_elements_bytes(&e->shape), offset_of(e, index))
             : ASDIC_OK;
}

asdic_status asdic_elements_read(asdic_elements *e, size_t index, float *pressure) {
    char *to = (char *)pressure;
    uint64_t size = asdic_elements_bytes(&e->shape), at = offset_of(e, index);
    while (size > 0) {
        ssize_t got = pread(e->fd, to, size, (off_t)at);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            return fail_io(e, e->path, "read");
        }
        to += got;
        size -= (uint64_t)got;
        at += (uint64_t)got;
    }
    return ASDIC_OK;
}

asdic_status asdic_elements_commit(asdic_elements *e) {
    if (!e) {
        return ASDIC_OK;
    }
    if (ftruncate(e->fd, (off_t)offset_of(e, e->shape.pings)) != 0 || fsync(e->fd) != 0 ||
        rename(e->part, e->path) != 0) {
        return fail_io(e, e->part, "write");
    }
    return ASDIC_OK;
}

void asdic_elements_close(asdic_elements **elements) {
    asdic_elements *e = elements ? *elements : NULL;
    if (e) {
        if (e->fd >= 0) {
            close(e->fd);
        }
        free(e->path);
        free(e->part);
        free(e);
        *elements = NULL;
    }
}
