#include "run_store.h"

#include "base/context.h"
#include "base/try.h"
#include "out/file.h"
#include "out/npy.h"
#include "out/record.h"
#include "run_folder.h"

#include <asdic/plan.h>

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

struct asdic_store {
    asdic_context *ctx;
    char *path, *part;
    int fd;
    bool is_part;
    asdic_store_shape shape;
    void *stored; /* a record as in the file */
    size_t record_bytes, header_bytes, count;
    char dtype[ASDIC_RECORD_DTYPE_SIZE];
};

static asdic_status fail_io(asdic_store *store, const char *verb) {
    return asdic_fail(store->ctx, ASDIC_ERROR_IO, "cannot %s '%s': %s", verb,
                      store->is_part ? store->part : store->path, strerror(errno));
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

static asdic_status write_header(asdic_store *store, size_t count) {
    char header[ASDIC_NPY_HEADER_SIZE];
    size_t length = asdic_npy_header(header, store->dtype, count, "");
    return write_at(store->fd, header, length, 0) ? ASDIC_OK : fail_io(store, "write");
}

/* Takes the number of whole records from the size of the file, which must be a plain one. */
static asdic_status count_records(asdic_store *store, size_t *bytes) {
    struct stat st;
    if (fstat(store->fd, &st) != 0) {
        return fail_io(store, "read");
    }
    if (!S_ISREG(st.st_mode)) {
        errno = EINVAL;
        return fail_io(store, "read");
    }
    *bytes = (size_t)st.st_size;
    store->count =
        *bytes < store->header_bytes ? 0 : (*bytes - store->header_bytes) / store->record_bytes;
    return ASDIC_OK;
}

static asdic_status open_finished(asdic_store *store) {
    char expected[ASDIC_NPY_HEADER_SIZE], found[ASDIC_NPY_HEADER_SIZE];
    size_t bytes = 0;
    store->fd = open(store->path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (store->fd < 0) {
        return fail_io(store, "read");
    }
    TRY(count_records(store, &bytes));
    asdic_npy_header(expected, store->dtype, store->count, "");
    if (bytes == store->header_bytes + store->count * store->record_bytes &&
        read_at(store->fd, found, store->header_bytes, 0) &&
        memcmp(found, expected, store->header_bytes) == 0) {
        return ASDIC_OK;
    }
    return asdic_fail(store->ctx, ASDIC_ERROR_INPUT,
                      "'%s' is damaged, or of another run or version (%zu bytes, records of %zu "
                      "bytes after a header of %zu); 'asdic run' with --resume makes again what "
                      "is missing",
                      store->path, bytes, store->record_bytes, store->header_bytes);
}

/* A file to which records are added must be the folder's own. */
static asdic_status refuse_link(asdic_store *store, const char *path) {
    struct stat st;
    if (lstat(path, &st) != 0 || (S_ISREG(st.st_mode) && st.st_nlink == 1)) {
        return ASDIC_OK;
    }
    return asdic_fail(store->ctx, ASDIC_ERROR_IO,
                      "'%s' is a link%s; a run writes into its own folder only, so put the file "
                      "itself there",
                      path, S_ISLNK(st.st_mode) ? "" : ", or no plain file");
}

/* The header is written again on commit: what the records are is known, and each has its sum. */
static asdic_status open_left(asdic_store *store) {
    size_t bytes = 0;
    TRY(refuse_link(store, store->part));
    TRY(refuse_link(store, store->path));
    /* A finished file becomes the .part again until it is committed. */
    if (access(store->part, F_OK) != 0 && rename(store->path, store->part) != 0 &&
        errno != ENOENT) {
        return fail_io(store, "write");
    }
    store->fd = open(store->part, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
    if (store->fd < 0) {
        return fail_io(store, "write");
    }
    flock(store->fd, LOCK_EX | LOCK_NB); /* gone when closed */
    TRY(count_records(store, &bytes));
    return store->count == 0 ? write_header(store, 0) : ASDIC_OK;
}

static asdic_status open_file(asdic_store *store, asdic_store_mode mode) {
    if (mode == ASDIC_STORE_READ) {
        return open_finished(store);
    }
    store->is_part = true;
    if (mode == ASDIC_STORE_RESUME) {
        return open_left(store);
    }
    store->fd = asdic_file_open_new(store->part, O_RDWR);
    return store->fd < 0 ? asdic_file_fail(store->ctx, store->part, errno) : write_header(store, 0);
}

asdic_record_layout asdic_store_layout(const asdic_settings *settings, size_t beams, size_t bins,
                                       unsigned left_out) {
    static const asdic_term terms[ASDIC_COMPONENT_COUNT] = {
        [ASDIC_BOTTOM] = ASDIC_TERM_BOTTOM, [ASDIC_SURFACE] = ASDIC_TERM_SURFACE,
        [ASDIC_VOLUME] = ASDIC_TERM_VOLUME, [ASDIC_OBJECT] = ASDIC_TERM_OBJECTS,
        [ASDIC_NOISE] = ASDIC_TERM_NOISE,   [ASDIC_MULTIPATH] = ASDIC_TERM_MULTIPATH};
    asdic_record_layout layout = {
        .beams = beams, .bins = bins, .form = settings->records, .truth = settings->sampling.truth};
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        bool is_kept = c != ASDIC_TOTAL && !(left_out & 1u << terms[c]);
        layout.parts |= is_kept ? 1u << c : 0u;
    }
    return layout;
}

asdic_status asdic_store_open(asdic_context *ctx, const char *folder, asdic_store_mode mode,
                              const asdic_store_shape *shape, asdic_store **out) {
    char header[ASDIC_NPY_HEADER_SIZE];
    *out = NULL;
    asdic_store *store = calloc(1, sizeof *store);
    if (!store) {
        return asdic_fail_memory(ctx, "a run's records");
    }
    store->ctx = ctx;
    store->fd = -1;
    store->path = asdic_folder_file(folder, "pings.npy");
    store->part = asdic_folder_file(folder, "pings.npy.part");
    store->shape = *shape;
    store->record_bytes = asdic_record_stored_bytes(&shape->layout);
    store->stored = malloc(store->record_bytes);
    asdic_record_dtype(store->dtype, &shape->layout);
    store->header_bytes = asdic_npy_header(header, store->dtype, 0, "");
    bool has_memory = store->path && store->part && store->stored;
    asdic_status status =
        has_memory ? open_file(store, mode) : asdic_fail_memory(ctx, "a run's file name");
    if (status != ASDIC_OK) {
        asdic_store_close(&store);
    }
    *out = store;
    return status;
}

size_t asdic_store_count(const asdic_store *store) {
    return store->count;
}

static size_t offset_of(const asdic_store *store, size_t index) {
    return store->header_bytes + index * store->record_bytes;
}

asdic_status asdic_store_write(asdic_store *store, size_t index, void *bytes) {
    asdic_record_store(&store->shape.layout, bytes, store->stored);
    if (!write_at(store->fd, store->stored, store->record_bytes, offset_of(store, index))) {
        return fail_io(store, "write");
    }
    store->count = index < store->count ? store->count : index + 1;
    asdic_record_restore(&store->shape.layout, store->stored, bytes);
    return ASDIC_OK;
}

asdic_status asdic_store_read(asdic_store *store, size_t index, void *bytes) {
    uint64_t ping = store->shape.first_ping + index;
    if (!read_at(store->fd, store->stored, store->record_bytes, offset_of(store, index))) {
        return fail_io(store, "read");
    }
    if (!asdic_record_is_whole(store->stored, store->record_bytes, ping)) {
        return asdic_fail(store->ctx, ASDIC_ERROR_INPUT,
                          "'%s' is damaged: ping %llu is not as it was written; 'asdic run' with "
                          "--resume makes it again",
                          store->is_part ? store->part : store->path, (unsigned long long)ping);
    }
    asdic_record_restore(&store->shape.layout, store->stored, bytes);
    return ASDIC_OK;
}

asdic_status asdic_store_cut(asdic_store *store, size_t count) {
    if (count < store->count) {
        store->count = count;
    }
    return ftruncate(store->fd, (off_t)offset_of(store, store->count)) == 0
               ? ASDIC_OK
               : fail_io(store, "write");
}

asdic_status asdic_store_commit(asdic_store *store) {
    store->is_part = true;
    TRY(asdic_store_cut(store, store->count)); /* drops an incomplete record */
    TRY(write_header(store, store->count));
    if (fsync(store->fd) != 0 || rename(store->part, store->path) != 0) {
        return fail_io(store, "write");
    }
    store->is_part = false;
    return ASDIC_OK;
}

void asdic_store_close(asdic_store **store) {
    if (!store || !*store) {
        return;
    }
    if ((*store)->fd >= 0) {
        close((*store)->fd);
    }
    free((*store)->path);
    free((*store)->part);
    free((*store)->stored);
    free(*store);
    *store = NULL;
}
