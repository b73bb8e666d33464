/*
 * An output file that appears complete or not at all: written as NAME.part, renamed on commit.
 * Devices and pipes ("/dev/stdout") cannot be renamed over and are written directly. Whatever
 * else bears either name, a link or a pipe, is replaced and not followed; a .part file that another
 * process is writing is left to it.
 */
#ifndef ASDIC_OUT_FILE_H
#define ASDIC_OUT_FILE_H

#include "base/text.h"

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

/* Whether another process holds the lock of the file PATH, which it is writing. */
bool asdic_file_is_being_written(const char *path);

/* Opens PATH anew with FLAGS (open's) and locks it, in the place of what has that name. -1 with
 * errno: EBUSY while another process writes it. */
int asdic_file_open_new(const char *path, int flags);

/* Creates FOLDER where it is not there. */
asdic_status asdic_folder_make(asdic_context *ctx, const char *folder);

/* "cannot write PATH", with the reason, an errno. */
asdic_status asdic_file_fail(asdic_context *ctx, const char *path, int error);

/* Writes LENGTH bytes as the whole file. */
asdic_status asdic_file_write_all(asdic_context *ctx, const char *path, const void *bytes,
                                  size_t length);

/* The same without waiting for the disk, for data sets of many small files. */
asdic_status asdic_file_write_soon(asdic_context *ctx, const char *path, const void *bytes,
                                   size_t length);

/* Writes TEXT, of WHAT, as the whole file, SOON as asdic_file_write_soon does. TEXT is empty afterwards. */
asdic_status asdic_file_write_text(asdic_context *ctx, const char *path, asdic_text *text,
                                   const char *what, bool soon);

/* Whether both paths lead to one file or folder, which is there. */
bool asdic_file_is_same(const char *a, const char *b);

/* What a file's bytes come to. */
typedef struct asdic_sum {
    uint64_t bytes;
    uint32_t crc32; /* as zlib's */
} asdic_sum;

/* ASDIC_ERROR_INPUT when the file cannot be read. */
asdic_status asdic_file_sum(asdic_context *ctx, const char *path, asdic_sum *out);

#endif
