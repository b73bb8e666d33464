#include "text.h"

#include "grow.h"
#include "number.h"

#include <asdic/common.h>

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Room for MORE bytes and the terminating zero. */
static bool reserve(asdic_text *text, size_t more) {
    size_t need = text->length + more + 1;
    text->failed = text->failed || !asdic_reserve(&text->data, need, &text->capacity, 1);
    return !text->failed;
}

void asdic_text_add_bytes(asdic_text *text, const char *bytes, size_t count) {
    if (!reserve(text, count)) {
        return;
    }
    if (count > 0) {
        memcpy(text->data + text->length, bytes, count);
    }
    text->length += count;
    text->data[text->length] = '\0';
}

void asdic_text_add(asdic_text *text, const char *string) {
    asdic_text_add_bytes(text, string, strlen(string));
}

void asdic_text_format(asdic_text *text, const char *format, ...) {
    locale_t before =
        asdic_c_locale_enter(); /* files have a decimal point wherever they are read */
    va_list args, again;
    va_start(args, format);
    va_copy(again, args);
    int count = vsnprintf(NULL, 0, format, args);
    if (count >= 0 && reserve(text, (size_t)count)) {
        vsnprintf(text->data + text->length, (size_t)count + 1, format, again);
        text->length += (size_t)count;
    }
    va_end(again);
    va_end(args);
    asdic_c_locale_leave(before);
}

/* The character of SIZE bytes at C. What JSON allows and YAML does not is escaped. */
static void add_character(asdic_text *text, const char *c, size_t size) {
    if (*c == '"' || *c == '\\') {
        asdic_text_format(text, "\\%c", *c);
    } else if (*c == '\n') {
        asdic_text_add(text, "\\n");
    } else if (size == 1 && ((unsigned char)*c < 0x20 || *c == 0x7f)) {
        asdic_text_format(text, "\\u%04x", (unsigned)*c);
    } else if (size == 2 && (unsigned char)c[0] == 0xc2 && (unsigned char)c[1] < 0xa0) {
        asdic_text_format(text, "\\u%04x", (unsigned)(unsigned char)c[1]);
    } else {
        asdic_text_add_bytes(text, c, size);
    }
}

void asdic_text_add_json(asdic_text *text, const char *string) {
    const char *end = string + strlen(string);
    asdic_text_add(text, "\"");
    for (const char *c = string; c < end;) {
        size_t size = asdic_utf8_character(c, (size_t)(end - c));
        if (size) {
            add_character(text, c, size);
        } else {
            asdic_text_add(text, "\\ufffd");
        }
        c += size ? size : 1;
    }
    asdic_text_add(text, "\"");
}

char *asdic_text_take(asdic_text *text) {
    if (!text->data && !text->failed) {
        asdic_text_add(text, "");
    }
    char *data = text->failed ? NULL : text->data;
    if (!data) {
        free(text->data);
    }
    *text = (asdic_text){0};
    return data;
}

void asdic_text_finish(asdic_text *text) {
    free(text->data);
    *text = (asdic_text){0};
}
