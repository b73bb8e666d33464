/*
 * A text that grows. Memory failures are remembered and answered once, by asdic_text_take.
 */
#ifndef ASDIC_BASE_TEXT_H
#define ASDIC_BASE_TEXT_H

#include <stdbool.h>
#include <stddef.h>

/* Zero-initialised is empty. DATA is NULL or ends in a zero byte that LENGTH does not count. */
typedef struct asdic_text {
    char *data;
    size_t length, capacity;
    bool failed;
} asdic_text;

void asdic_text_add(asdic_text *text, const char *string);
/* BYTES may be NULL where COUNT is 0. */
void asdic_text_add_bytes(asdic_text *text, const char *bytes, size_t count);
void asdic_text_format(asdic_text *text, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* STRING as a JSON string, quotes included, with U+FFFD for each byte that is no text in UTF-8. */
void asdic_text_add_json(asdic_text *text, const char *string);

/* The text, to be freed with free(); NULL when memory was short. TEXT is empty afterwards. */
char *asdic_text_take(asdic_text *text);
void asdic_text_finish(asdic_text *text);

#endif
