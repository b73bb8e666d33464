/*
 * An output file that appears complete or not at all: written as NAME.part, renamed on commit.
 * Devices and pipes ("/dev/stdout") cannot be renamed over and are written directly. Links that
 * bear either name are replaced, not followed.
 */
#ifndef ASDIC_OUT_FILE_H
#define ASDIC_OUT_FILE_H

#include <asdic/context.h>

#include <stdio.h>

typedef struct asdic_file asdic_file;

asdic_status asdic_file_create(asdic_context *ctx, const char *path, asdic_file **out);

/* Buffered and writable until commit or discard; errors are collected and reported by commit. */
FILE *asdic_file_stream(asdic_file *file);

/* Flushes to the disk, closes and renames; on failure the .part file is removed. *FILE becomes
 * NULL either way. */
asdic_status asdic_file_commit(asdic_file **file);

/* Closes and removes the .part file. NULL-safe. */
void asdic_file_discard(asdic_file **file);

bool asdic_file_is_link(const char *path); /* itself; not where it leads to */

/* Removes PATH where it is a link, so that opening it does not write to another file. */
void asdic_file_unlink_link(const char *path);

/* Writes LENGTH bytes as the whole file. */
asdic_status asdic_file_write_all(asdic_context *ctx, const char *path, const void *bytes,
                                  size_t length);

#endif
