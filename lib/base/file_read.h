/*
 * Whole files into memory.
 */
#ifndef ASDIC_BASE_FILE_READ_H
#define ASDIC_BASE_FILE_READ_H

#include <asdic/context.h>

#include <stdio.h>

/* Opens PATH, to be closed with fclose(). ASDIC_ERROR_INPUT when it cannot be opened or is not a
 * regular file: a pipe may have no writer, a device no end. */
asdic_status asdic_file_open(asdic_context *ctx, const char *path, FILE **out);

/* Reads all of the regular file PATH into *DATA, which has a zero byte behind its *BYTES and is
 * freed with free(). ASDIC_ERROR_INPUT when it cannot be read, or is longer than LIMIT_BYTES. */
asdic_status asdic_file_read(asdic_context *ctx, const char *path, size_t limit_bytes, char **data,
                             size_t *bytes);

/* The same of what a user names himself and may pipe: "-" is the standard input, and a pipe waits for
 * its writer. */
asdic_status asdic_file_read_piped(asdic_context *ctx, const char *path, size_t limit_bytes,
                                   char **data, size_t *bytes);

#endif
