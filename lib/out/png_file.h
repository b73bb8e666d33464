/*
 * PNG files through libpng: 8-bit RGB or 16-bit grey, with text chunks.
 */
#ifndef ASDIC_OUT_PNG_FILE_H
#define ASDIC_OUT_PNG_FILE_H

#include <asdic/context.h>

typedef struct asdic_png {
    size_t width, height;
    const uint8_t *rgb;       /* width * height * 3, or NULL */
    const uint16_t *grey;     /* width * height in host byte order, when RGB is NULL */
    double pixels_per_m;      /* print resolution; 0: not said */
    const char *const *texts; /* key, value, ..., NULL; may be NULL. UTF-8 */
} asdic_png;

asdic_status asdic_png_write(asdic_context *ctx, const char *path, const asdic_png *png);

#endif
