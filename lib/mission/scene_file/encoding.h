/*
 * Text files as editors write them: UTF-8 with and without byte-order mark, UTF-16.
 */
#ifndef ASDIC_MISSION_ENCODING_H
#define ASDIC_MISSION_ENCODING_H

#include <stddef.h>

/* BYTES as UTF-8 without a byte-order mark, with a zero byte behind its *LENGTH bytes, to be freed
 * with free(); NULL when memory is short. UTF-16 is known by its byte-order mark; what is no valid
 * text passes through, for the reader of the text to refuse. */
char *asdic_text_to_utf8(const char *bytes, size_t size, size_t *length);

#endif
