#include <asdic/common.h>

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

size_t asdic_utf8_character(const char *text, size_t left) {
    const unsigned char *p = (const unsigned char *)text;
    if (!p || left == 0) {
        return 0;
    }
    if (*p < 0x80) {
        return 1;
    }
    size_t size = *p >= 0xf0 ? 4 : *p >= 0xe0 ? 3 : 2;
    if (*p < 0xc2 || *p > 0xf4 || size > left) {
        return 0;
    }
    uint32_t code = *p & (0x7fu >> size);
    for (size_t i = 1; i < size; i++) {
        if ((p[i] & 0xc0) != 0x80) {
            return 0;
        }
        code = code << 6 | (p[i] & 0x3fu);
    }
    bool is_short = size == 3 ? code < 0x800 : size == 4 && (code < 0x10000 || code > 0x10ffff);
    return is_short || (code >= 0xd800 && code < 0xe000) ? 0 : size;
}

size_t asdic_utf8_mark(const char *text, size_t left) {
    static const char mark[] = {'\xef', '\xbb', '\xbf'};
    return text && left >= sizeof mark && memcmp(text, mark, sizeof mark) == 0 ? sizeof mark : 0;
}
