/*
 * A format that is written in a process of its own, for libraries that a full disk brings down: what
 * is left of them then ends with that process, and the caller goes on with a sentence.
 */
#ifndef ASDIC_OUT_FORMAT_PROCESS_H
#define ASDIC_OUT_FORMAT_PROCESS_H

#include "format.h"

/* As asdic_format's, of the file that FORMAT's functions write there. A failed write is told at the next one or
 * on commit. */
asdic_status asdic_format_process_open(asdic_context *ctx, const asdic_format *format,
                                       const char *path, const asdic_format_about *about,
                                       void **out);
asdic_status asdic_format_process_write(void *file, const asdic_record *record);
asdic_status asdic_format_process_commit(void **file);
void asdic_format_process_discard(void **file);

#endif
