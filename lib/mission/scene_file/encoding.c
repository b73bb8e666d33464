#include "encoding.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* CODE as UTF-8; returns the number of bytes. Lone surrogates become three bytes that no reader of
 * UTF-8 accepts. */
static size_t put_utf8(uint32_t code, char *out) {
    if (code < 0x80) {
        out[0] = (char)code;
        return 1;
    }
    size_t bytes = code < 0x800 ? 2 : code < 0x10000 ? 3 : 4;
    static const unsigned char lead[] = {0, 0, 0xc0, 0xe0, 0xf0};
    for (size_t i = bytes - 1; i > 0; i--) {
        out[i] = (char)(0x80 | (code & 0x3f));
        code >>= 6;
    }
    out[0] = (char)(lead[bytes] | code);
    return bytes;
}

static size_t utf16_to_utf8(const unsigned char *bytes, size_t size, int big_endian, char *out) {
    size_t length = 0;
    for (size_t i = 0; i + 1 < size; i += 2) {
        uint32_t unit = (uint32_t)bytes[i + !big_endian] << 8 | bytes[i + big_endian];
        if (unit >= 0xd800 && unit < 0xdc00 && i + 3 < size) {
            uint32_t low = (uint32_t)bytes[i + 2 + !big_endian] << 8 | bytes[i + 2 + big_endian];
            if (low >= 0xdc00 && low < 0xe000) {
                unit = 0x10000 + ((unit - 0xd800) << 10) + (low - 0xdc00);
                i += 2;
            }
        }
        length += put_utf8(unit, out + length);
    }
    return length;
}

char *asdic_text_to_utf8(const char *bytes, size_t size, size_t *length) {
    const unsigned char *b = (const unsigned char *)bytes;
    /* Two bytes of UTF-16 make at most three of UTF-8. */
    char *out = malloc(size + size / 2 + 4);
    if (!out) {
        return NULL;
    }
    if (size >= 2 && ((b[0] == 0xff && b[1] == 0xfe) || (b[0] == 0xfe && b[1] == 0xff))) {
        *length = utf16_to_utf8(b + 2, size - 2, b[0] == 0xfe, out);
    } else {
        size_t mark = size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
        *length = size - mark;
        memcpy(out, bytes + mark, *length);
    }
    out[*length] = '\0';
    return out;
}
