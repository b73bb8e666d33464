#include "file_read.h"

#include "context.h"
#include "grow.h"
#include "try.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Most files are read in as much, B. */
#define FIRST_READ 65536

/* Reads FILE to its end; a byte more than LIMIT_BYTES is enough to know that it is too long. */
static asdic_status read_stream(asdic_context *ctx, const char *name, FILE *file,
                                size_t limit_bytes, char **data, size_t *bytes) {
    asdic_status status = ASDIC_OK;
    size_t capacity = 0, length = 0;
    char *buffer = NULL;
    for (;;) {
        if (!asdic_reserve(&buffer, length > 0 ? length + 2 : FIRST_READ, &capacity, 1)) {
            status = asdic_fail_memory(ctx, "a file's text");
            goto fail;
        }
        size_t got = fread(buffer + length, 1, capacity - length - 1, file);
        length += got;
        if (length > limit_bytes) {
            status =
                asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: longer than %zu bytes", name, limit_bytes);
            goto fail;
        }
        if (got == 0) {
            break;
        }
    }
    if (ferror(file)) {
        status = asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: cannot read: %s", name, strerror(errno));
        goto fail;
    }
    buffer[length] = '\0';
    *data = buffer;
    *bytes = length;
    return ASDIC_OK;
fail:
    free(buffer);
    return status;
}

/* A stream of PATH, opened with FLAGS more. */
static asdic_status open_stream(asdic_context *ctx, const char *path, int flags, FILE **out) {
    int fd = open(path, O_RDONLY | O_CLOEXEC | flags);
    *out = fd >= 0 ? fdopen(fd, "rb") : NULL;
    if (*out) {
        return ASDIC_OK;
    }
    asdic_status status =
        asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: cannot open: %s", path, strerror(errno));
    if (fd >= 0) {
        close(fd);
    }
    return status;
}

asdic_status asdic_file_open(asdic_context *ctx, const char *path, FILE **out) {
    struct stat info;
    TRY(open_stream(ctx, path, O_NONBLOCK, out)); /* a pipe would wait for its writer */
    bool is_known = fstat(fileno(*out), &info) == 0;
    if (is_known && S_ISREG(info.st_mode)) {
        return ASDIC_OK;
    }
    asdic_status status = asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: %s", path,
                                     !is_known               ? strerror(errno)
                                     : S_ISDIR(info.st_mode) ? "cannot read: Is a directory"
                                                             : "not a regular file");
    fclose(*out);
    *out = NULL;
    return status;
}

asdic_status asdic_file_read(asdic_context *ctx, const char *path, size_t limit_bytes, char **data,
                             size_t *bytes) {
    FILE *file;
    TRY(asdic_file_open(ctx, path, &file));
    asdic_status status = read_stream(ctx, path, file, limit_bytes, data, bytes);
    fclose(file);
    return status;
}

asdic_status asdic_file_read_piped(asdic_context *ctx, const char *path, size_t limit_bytes,
                                   char **data, size_t *bytes) {
    FILE *file;
    if (strcmp(path, "-") == 0) {
        return read_stream(ctx, "standard input", stdin, limit_bytes, data, bytes);
    }
    TRY(open_stream(ctx, path, 0, &file));
    asdic_status status = read_stream(ctx, path, file, limit_bytes, data, bytes);
    fclose(file);
    return status;
}
