#include "run_records.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/try.h"
#include "out/file.h"
#include "out/npy.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

struct asdic_records {
    asdic_context *ctx;
    asdic_file_name path, part;
    char *dtype, *rest;
    int fd;
    bool is_part;
    size_t record_bytes, header_bytes, count;
};

static asdic_status fail_io(asdic_records *r, const char *verb) {
    return asdic_fail(r->ctx, ASDIC_ERROR_IO, "cannot %s '%s': %s", verb,
                      r->is_part ? r->part.text : r->path.text, strerror(errno));
}

static bool write_at(int fd, const void *bytes, size_t length, size_t offset) {
    const char *from = bytes;
    while (length > 0) {
        ssize_t written = pwrite(fd, from, length, (off_t)offset);
        if (written < 0 && errno == EINTR) {
            continue;
        }
        if (written <= 0) {
            errno = written == 0 ? ENOSPC : errno;
            return false;
        }
        from += written;
        offset += (size_t)written;
        length -= (size_t)written;
    }
    return true;
}

static bool read_at(int fd, void *bytes, size_t length, size_t offset) {
    char *to = bytes;
    while (length > 0) {
        ssize_t got = pread(fd, to, length, (off_t)offset);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got <= 0) {
            errno = got == 0 ? EIO : errno;
            return false;
        }
        to += got;
        offset += (size_t)got;
        length -= (size_t)got;
    }
    return true;
}

static asdic_status write_header(asdic_records *r, size_t count) {
    char header[ASDIC_NPY_HEADER_SIZE];
    size_t length = asdic_npy_header(header, r->dtype, count, r->rest);
    return write_at(r->fd, header, length, 0) ? ASDIC_OK : fail_io(r, "write");
}

/* Takes the number of whole records from the size of the file, which must be a plain one. */
static asdic_status count_records(asdic_records *r, size_t *bytes) {
    struct stat st;
    if (fstat(r->fd, &st) != 0) {
        return fail_io(r, "read");
    }
    if (!S_ISREG(st.st_mode)) {
        errno = EINVAL;
        return fail_io(r, "read");
    }
    *bytes = (size_t)st.st_size;
    r->count = *bytes < r->header_bytes ? 0 : (*bytes - r->header_bytes) / r->record_bytes;
    return ASDIC_OK;
}

static asdic_status open_finished(asdic_records *r) {
    char expected[ASDIC_NPY_HEADER_SIZE], found[ASDIC_NPY_HEADER_SIZE];
    size_t bytes = 0;
    r->fd = open(r->path.text, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (r->fd < 0) {
        return fail_io(r, "read");
    }
    TRY(count_records(r, &bytes));
    asdic_npy_header(expected, r->dtype, r->count, r->rest);
    if (bytes == r->header_bytes + r->count * r->record_bytes &&
        read_at(r->fd, found, r->header_bytes, 0) &&
        memcmp(found, expected, r->header_bytes) == 0) {
        return ASDIC_OK;
    }
    return asdic_fail(r->ctx, ASDIC_ERROR_INPUT,
                      "'%s' is damaged, or of another run or version (%zu bytes, records of %zu "
                      "bytes after a header of %zu)",
                      r->path.text, bytes, r->record_bytes, r->header_bytes);
}

/* A file to which records are added must be the folder's own. */
static asdic_status refuse_link(asdic_records *r, const char *path) {
    struct stat st;
    if (lstat(path, &st) != 0 || (S_ISREG(st.st_mode) && st.st_nlink == 1)) {
        return ASDIC_OK;
    }
    return asdic_fail(r->ctx, ASDIC_ERROR_IO,
                      "'%s' is a link%s; a run writes into its own folder only, so put the file "
                      "itself there",
                      path, S_ISLNK(st.st_mode) ? "" : ", or no plain file");
}

/* The header is written again on commit: what the records are is known, and each has its sum. */
static asdic_status open_left(asdic_records *r) {
    size_t bytes = 0;
    TRY(refuse_link(r, r->part.text));
    TRY(refuse_link(r, r->path.text));
    /* A finished file becomes the .part again until it is committed. */
    if (access(r->part.text, F_OK) != 0 && rename(r->path.text, r->part.text) != 0 &&
        errno != ENOENT) {
        return fail_io(r, "write");
    }
    r->fd = open(r->part.text, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (r->fd < 0) {
        return fail_io(r, "write");
    }
    flock(r->fd, LOCK_EX | LOCK_NB); /* gone when closed */
    TRY(count_records(r, &bytes));
    return r->count == 0 ? write_header(r, 0) : ASDIC_OK;
}

static asdic_status open_file(asdic_records *r, asdic_store_mode mode) {
    if (mode == ASDIC_STORE_READ) {
        return open_finished(r);
    }
    r->is_part = true;
    if (mode == ASDIC_STORE_RESUME) {
        return open_left(r);
    }
    r->fd = asdic_file_open_new(r->part.text, O_RDWR);
    return r->fd < 0 ? asdic_file_fail(r->ctx, r->part.text, errno) : write_header(r, 0);
}

asdic_status asdic_records_open(asdic_context *ctx, const char *folder, asdic_store_mode mode,
                                const asdic_records_shape *shape, asdic_records **out) {
    char header[ASDIC_NPY_HEADER_SIZE], part[64];
    *out = NULL;
    asdic_records *r = calloc(1, sizeof *r);
    if (!r) {
        return asdic_fail_memory(ctx, shape->name);
    }
    snprintf(part, sizeof part, "%s.part", shape->name);
    *r = (asdic_records){.ctx = ctx,
                         .path = asdic_file_in(folder, shape->name),
                         .part = asdic_file_in(folder, part),
                         .dtype = strdup(shape->dtype),
                         .rest = strdup(shape->rest),
                         .fd = -1,
                         .record_bytes = shape->bytes,
                         .header_bytes = asdic_npy_header(header, shape->dtype, 0, shape->rest)};
    bool has_memory = r->dtype && r->rest;
    asdic_status status = has_memory ? open_file(r, mode) : asdic_fail_memory(ctx, shape->name);
    if (status != ASDIC_OK) {
        asdic_records_close(&r);
    }
    *out = r;
    return status;
}

size_t asdic_records_count(const asdic_records *r) {
    return r->count;
}

const char *asdic_records_path(const asdic_records *r) {
    return r->is_part ? r->part.text : r->path.text;
}

static size_t offset_of(const asdic_records *r, size_t index) {
    return r->header_bytes + index * r->record_bytes;
}

asdic_status asdic_records_write(asdic_records *r, size_t index, const void *record) {
    if (!write_at(r->fd, record, r->record_bytes, offset_of(r, index))) {
        return fail_io(r, "write");
    }
    r->count = index < r->count ? r->count : index + 1;
    return ASDIC_OK;
}

asdic_status asdic_records_read(asdic_records *r, size_t index, void *record) {
    return read_at(r->fd, record, r->record_bytes, offset_of(r, index)) ? ASDIC_OK
                                                                        : fail_io(r, "read");
}

asdic_status asdic_records_cut(asdic_records *r, size_t count) {
    r->count = count < r->count ? count : r->count;
    return ftruncate(r->fd, (off_t)offset_of(r, r->count)) == 0 ? ASDIC_OK : fail_io(r, "write");
}

asdic_status asdic_records_commit(asdic_records *r) {
    r->is_part = true;
    TRY(asdic_records_cut(r, r->count)); /* drops an incomplete record */
    TRY(write_header(r, r->count));
    if (fsync(r->fd) != 0 || rename(r->part.text, r->path.text) != 0) {
        return fail_io(r, "write");
    }
    r->is_part = false;
    return ASDIC_OK;
}

void asdic_records_close(asdic_records **records) {
    asdic_records *r = records ? *records : NULL;
    if (!r) {
        return;
    }
    if (r->fd >= 0) {
        close(r->fd);
    }
    free(r->dtype);
    free(r->rest);
    free(r);
    *records = NULL;
}
