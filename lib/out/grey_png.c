#include "grey_png.h"

#include <zlib.h>

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static void put32(unsigned char *at, uint32_t value) {
    for (int k = 0; k < 4; k++) {
        at[k] = (unsigned char)(value >> (24 - 8 * k));
    }
}

/* A chunk of LENGTH bytes, which lie at AT + 8 already; where the next one begins. */
static unsigned char *end_chunk(unsigned char *at, const char type[5], size_t length) {
    put32(at, (uint32_t)length);
    memcpy(at + 4, type, 4);
    put32(at + 8 + length, (uint32_t)crc32_z(0, at + 4, length + 4));
    return at + length + 12;
}

/* Rows as PNG has them: a filter's number, here none, and greys, big-endian. */
static unsigned char *rows_of(const asdic_grey *image, size_t *length) {
    size_t row = image->width * image->bits / 8 + 1;
    unsigned char *rows = malloc(row * image->height);
    *length = row * image->height;
    for (size_t y = 0; rows && y < image->height; y++) {
        unsigned char *to = rows + y * row;
        *to++ = 0;
        if (image->bits == 8) {
            memcpy(to, (const uint8_t *)image->values + y * image->width, image->width);
            continue;
        }
        const uint16_t *from = (const uint16_t *)image->values + y * image->width;
        for (size_t x = 0; x < image->width; x++) {
            to[2 * x] = (unsigned char)(from[x] >> 8);
            to[2 * x + 1] = (unsigned char)from[x];
        }
    }
    return rows;
}

/* Runs and single bytes alone are looked for: levels are noise, which longer matches hardly shorten. */
static bool deflate_into(const unsigned char *rows, size_t length, unsigned char *to, size_t room,
                         size_t *taken) {
    z_stream z = {.next_in = (unsigned char *)(uintptr_t)rows, .avail_in = (uInt)length};
    z.next_out = to;
    z.avail_out = (uInt)room;
    if (deflateInit2(&z, 1, Z_DEFLATED, 15, 9, Z_RLE) != Z_OK) {
        return false;
    }
    bool done = deflate(&z, Z_FINISH) == Z_STREAM_END;
    *taken = z.total_out;
    deflateEnd(&z);
    return done;
}

unsigned char *asdic_grey_png(const asdic_grey *image, size_t *length) {
    static const unsigned char signature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    size_t raw = 0, packed = 0;
    unsigned char *rows = rows_of(image, &raw);
    size_t room = raw + raw / 8 + 1024;
    unsigned char *file = rows ? malloc(room + 64) : NULL, *at = file;
    if (!file) {
        free(rows);
        return NULL;
    }
    memcpy(at, signature, 8);
    at += 8;
    put32(at + 8, (uint32_t)image->width);
    put32(at + 12, (uint32_t)image->height);
    memcpy(at + 16, (const unsigned char[]){(unsigned char)image->bits, 0, 0, 0, 0}, 5);
    at = end_chunk(at, "IHDR", 13);
    bool done = deflate_into(rows, raw, at + 8, room, &packed);
    free(rows);
    if (!done) {
        free(file);
        return NULL;
    }
    at = end_chunk(at, "IDAT", packed);
    at = end_chunk(at, "IEND", 0);
    *length = (size_t)(at - file);
    return file;
}
