#include "file.h"

#include "base/context.h"
#include "base/try.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

struct asdic_file {
    asdic_context *ctx;
    FILE *stream;
    char *path;
    char *part; /* NULL: written directly to PATH */
    bool soon;  /* the disk is not waited for */
};

static bool is_folder(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 && S_ISDIR(st.st_mode);
}

/* Renaming over a terminal, a pipe or /dev/full would replace it. */
static bool is_special(const char *path) {
    struct stat st;
    return stat(path, &st) == 0 && !S_ISREG(st.st_mode) && !S_ISDIR(st.st_mode);
}

/* Standard output as the caller opened it, redirected or not. Opening /dev/stdout instead would
 * truncate a file that the caller appends to; renaming over it would replace the device for
 * everybody. */
static FILE *open_stdout(void) {
    int fd = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
    FILE *stream = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (!stream && fd >= 0) {
        close(fd);
        errno = EBADF; /* not open for writing: stdio reports that differently */
    }
    return stream;
}

bool asdic_file_is_being_written(const char *path) {
    struct stat st;
    if (lstat(path, &st) != 0 || !S_ISREG(st.st_mode)) {
        return false;
    }
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    bool is_locked = fd >= 0 && flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    if (fd >= 0) {
        close(fd);
    }
    return is_locked;
}

/* Whether the file that FD has open still bears the name PATH. */
static bool is_named(int fd, const char *path) {
    struct stat opened, named;
    return fstat(fd, &opened) == 0 && lstat(path, &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

/* Removes what bears the name PATH, a file only while it is locked: nobody writes it, nor puts another in its place
 * meanwhile. False with errno where that cannot be. */
static bool remove_left(const char *path) {
    struct stat st;
    int fd = -1;
    if (lstat(path, &st) != 0 ||
        (S_ISREG(st.st_mode) &&
         (fd = open(path, O_WRONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK)) < 0 &&
         errno == ENOENT)) {
        return errno == ENOENT; /* it is gone: what comes in its place is another's */
    }
    bool is_busy = fd >= 0 ? flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK
                           : asdic_file_is_being_written(path);
    bool is_other = fd >= 0 && !is_named(fd, path); /* another process was quicker */
    bool is_removed = !is_busy && (is_other || unlink(path) == 0 || errno == ENOENT);
    int error = is_busy ? EBUSY : errno;
    if (fd >= 0) {
        close(fd);
    }
    errno = error;
    return is_removed;
}

int asdic_file_open_new(const char *path, int flags) {
    int fd = -1;
    do {
        fd = open(path, flags | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
    } while (fd < 0 && errno == EEXIST && remove_left(path));
    /* Where the file system has locks; gone when closed. Another process may have taken it for left before. */
    if (fd >= 0 &&
        ((flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) || !is_named(fd, path))) {
        close(fd);
        errno = EBUSY;
        fd = -1;
    }
    return fd;
}

static FILE *open_part(const char *path) {
    int fd = asdic_file_open_new(path, O_WRONLY);
    FILE *stream = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (!stream && fd >= 0) {
        close(fd);
        errno = ENOMEM;
    }
    return stream;
}

asdic_status asdic_file_fail(asdic_context *ctx, const char *path, int error) {
    return asdic_fail(ctx, ASDIC_ERROR_IO, "cannot write '%s': %s", path,
                      error == EBUSY ? "another process is writing it just now" : strerror(error));
}

asdic_status asdic_folder_make(asdic_context *ctx, const char *folder) {
    if (mkdir(folder, 0777) == 0 || errno == EEXIST) {
        return ASDIC_OK;
    }
    int error = errno;
    return asdic_fail(ctx, ASDIC_ERROR_IO, "cannot create folder '%s': %s%s", folder,
                      strerror(error),
                      error == ENOENT ? "; create the folder that it is to be in first" : "");
}

static void file_free(asdic_file **file) {
    if (!file || !*file) {
        return;
    }
    free((*file)->path);
    free((*file)->part);
    free(*file);
    *file = NULL;
}

asdic_status asdic_file_create(asdic_context *ctx, const char *path, asdic_file **out) {
    *out = NULL;
    asdic_status status = ASDIC_OK;
    asdic_file *file = calloc(1, sizeof *file);
    if (!file) {
        return asdic_fail_memory(ctx, "a file name");
    }
    file->ctx = ctx;
    file->path = strdup(path);
    bool is_stdout = strcmp(path, "/dev/stdout") == 0;
    bool is_direct = is_stdout || is_special(path);
    if (is_folder(path)) { /* to rename a file to "." would say that it is busy */
        status = asdic_file_fail(ctx, path, EISDIR);
        goto fail;
    }
    if (!is_direct && asprintf(&file->part, "%s.part", path) < 0) {
        file->part = NULL;
    }
    if (!file->path || (!is_direct && !file->part)) {
        status = asdic_fail_memory(ctx, "a file name");
        goto fail;
    }
    const char *opened = file->part ? file->part : path;
    file->stream = is_stdout    ? open_stdout()
                   : file->part ? open_part(file->part)
                                : fopen(path, "wbe");
    if (!file->stream) {
        status = asdic_file_fail(ctx, opened, errno);
        goto fail;
    }
    *out = file;
    return ASDIC_OK;
fail:
    file_free(&file);
    return status;
}

FILE *asdic_file_stream(asdic_file *file) {
    return file->stream;
}

/* Why an earlier write failed. The stream does not keep the reason, so one more byte is written
 * where that does no harm. */
static int earlier_error(const asdic_file *file) {
    struct stat st;
    int fd = fileno(file->stream);
    bool is_harmless = file->part || (fstat(fd, &st) == 0 && !S_ISREG(st.st_mode));
    return is_harmless && write(fd, "", 1) < 0 ? errno : EIO;
}

/* The first error of the stream, then of the disk: a full disk may show only at the flush. The file
 * gets its name while it is locked: nobody else writes the .part file meanwhile. */
static int file_close(asdic_file *file) {
    int error = 0;
    if (ferror(file->stream)) {
        error = earlier_error(file);
    } else if (fflush(file->stream) != 0) {
        error = errno;
    }
    if (!error && file->part && !file->soon && fsync(fileno(file->stream)) != 0) {
        error = errno;
    }
    if (!error && file->part && !is_named(fileno(file->stream), file->part)) {
        error = EBUSY;
    } else if (file->part && (error || rename(file->part, file->path) != 0)) {
        error = error ? error : errno;
        unlink(file->part);
    }
    if (fclose(file->stream) != 0 && !error) {
        error = errno;
    }
    file->stream = NULL;
    return error;
}

asdic_status asdic_file_commit(asdic_file **file) {
    int error = file_close(*file);
    asdic_status status = error ? asdic_file_fail((*file)->ctx, (*file)->path, error) : ASDIC_OK;
    file_free(file);
    return status;
}

void asdic_file_discard(asdic_file **file) {
    if (!file || !*file) {
        return;
    }
    if ((*file)->part && is_named(fileno((*file)->stream), (*file)->part)) {
        unlink((*file)->part);
    }
    fclose((*file)->stream);
    file_free(file);
}

static asdic_status write_whole(asdic_context *ctx, const char *path, const void *bytes,
                                size_t length, bool soon) {
    asdic_file *file;
    TRY(asdic_file_create(ctx, path, &file));
    file->soon = soon;
    fwrite(bytes, 1, length, file->stream);
    return asdic_file_commit(&file);
}

asdic_status asdic_file_write_all(asdic_context *ctx, const char *path, const void *bytes,
                                  size_t length) {
    return write_whole(ctx, path, bytes, length, false);
}

asdic_status asdic_file_write_soon(asdic_context *ctx, const char *path, const void *bytes,
                                   size_t length) {
    return write_whole(ctx, path, bytes, length, true);
}

asdic_status asdic_file_write_text(asdic_context *ctx, const char *path, asdic_text *text,
                                   const char *what, bool soon) {
    asdic_status status =
        text->failed ? asdic_fail_memory(ctx, what)
                     : write_whole(ctx, path, text->length ? text->data : "", text->length, soon);
    asdic_text_finish(text);
    return status;
}

bool asdic_file_is_same(const char *a, const char *b) {
    struct stat first, second;
    return stat(a, &first) == 0 && stat(b, &second) == 0 && first.st_dev == second.st_dev &&
           first.st_ino == second.st_ino;
}

asdic_status asdic_file_sum(asdic_context *ctx, const char *path, asdic_sum *out) {
    unsigned char bytes[1 << 15];
    int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    ssize_t got = -1;
    *out = (asdic_sum){0};
    while (fd >= 0 && (got = read(fd, bytes, sizeof bytes)) != 0) {
        if (got < 0 && errno != EINTR) {
            break;
        }
        if (got > 0) {
            out->bytes += (uint64_t)got;
            out->crc32 = (uint32_t)crc32_z(out->crc32, bytes, (size_t)got);
        }
    }
    int error = errno;
    if (fd >= 0) {
        close(fd);
    }
    return got == 0
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_INPUT, "cannot read '%s': %s", path, strerror(error));
}
