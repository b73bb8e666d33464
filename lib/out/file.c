#include "file.h"

#include "base/context.h"
#include "base/try.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct asdic_file {
    asdic_context *ctx;
    FILE *stream;
    char *path;
    char *part; /* NULL: written directly to PATH */
};

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

bool asdic_file_is_link(const char *path) {
    struct stat st;
    return lstat(path, &st) == 0 && S_ISLNK(st.st_mode);
}

void asdic_file_unlink_link(const char *path) {
    if (asdic_file_is_link(path)) {
        unlink(path);
    }
}

/* Opens the .part file; a link of that name is replaced. */
static FILE *open_part(const char *path) {
    asdic_file_unlink_link(path);
    int fd = open(path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
    FILE *stream = fd >= 0 ? fdopen(fd, "wb") : NULL;
    if (!stream && fd >= 0) {
        close(fd);
        errno = ENOMEM;
    }
    return stream;
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
        status = asdic_fail(ctx, ASDIC_ERROR_IO, "cannot write '%s': %s", opened, strerror(errno));
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

/* The first error of the stream, then of the disk: a full disk may show only at the flush. */
static int file_close(asdic_file *file) {
    int error = 0;
    if (ferror(file->stream)) {
        error = earlier_error(file);
    } else if (fflush(file->stream) != 0) {
        error = errno;
    }
    if (!error && file->part && fsync(fileno(file->stream)) != 0) {
        error = errno;
    }
    if (fclose(file->stream) != 0 && !error) {
        error = errno;
    }
    file->stream = NULL;
    return error;
}

asdic_status asdic_file_commit(asdic_file **file) {
    asdic_file *f = *file;
    asdic_status status = ASDIC_OK;
    int error = file_close(f);
    if (!error && f->part && rename(f->part, f->path) != 0) {
        error = errno;
    }
    if (error) {
        status =
            asdic_fail(f->ctx, ASDIC_ERROR_IO, "cannot write '%s': %s", f->path, strerror(error));
        if (f->part) {
            unlink(f->part);
        }
    }
    file_free(file);
    return status;
}

void asdic_file_discard(asdic_file **file) {
    if (!file || !*file) {
        return;
    }
    fclose((*file)->stream);
    if ((*file)->part) {
        unlink((*file)->part);
    }
    file_free(file);
}

asdic_status asdic_file_write_all(asdic_context *ctx, const char *path, const void *bytes,
                                  size_t length) {
    asdic_file *file;
    TRY(asdic_file_create(ctx, path, &file));
    fwrite(bytes, 1, length, file->stream);
    return asdic_file_commit(&file);
}
