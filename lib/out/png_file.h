/*
 * PNG files through libpng: 8-bit RGB or 16-bit grey, with text chunks.
 */
#ifndef ASDIC_OUT_PNG_FILE_H
#define ASDIC_OUT_PNG_FILE_H

#include <asdic/context.h>

typedef struct asdic_png {
    size_t width, height;
    const uint8_t *rgb; /* width * height * 3, or NULL */
    /* When RGB is NULL: fills ROW (WIDTH greys in host byte order) with row Y, from the top on. A
     * failure ends the file. */
    asdic_status (*grey_row)(void *user, size_t y, uint16_t *row);
    void *user;
    double pixels_per_m;      /* print resolution; 0: not said */
    const char *const *texts; /* key, value, ..., NULL; may be NULL. UTF-8 */
} asdic_png;

asdic_status asdic_png_write(asdic_context *ctx, const char *path, const asdic_png *png);

/* ASDIC_ERROR_INPUT unless PATH is a PNG file from its signature to its end, every chunk with its
 * sum. */
asdic_status asdic_png_check(asdic_context *ctx, const char *path);

#endif
