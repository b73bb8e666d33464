/*
 * Whole files into memory.
 */
#ifndef ASDIC_BASE_FILE_READ_H
#define ASDIC_BASE_FILE_READ_H

#include <asdic/context.h>

/* Reads all of PATH ("-": standard input) into *DATA, which has a zero byte behind its *BYTES and
 * is freed with free(). ASDIC_ERROR_INPUT when it cannot be read, is a directory, or is longer
 * than LIMIT_BYTES. */
asdic_status asdic_file_read(asdic_context *ctx, const char *path, size_t limit_bytes, char **data,
                             size_t *bytes);

#endif
