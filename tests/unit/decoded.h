/*
 * Pictures, read back.
 */
#ifndef ASDIC_TEST_DECODED_H
#define ASDIC_TEST_DECODED_H

#include "asserts.h"

#include <png.h>
#include <stdlib.h>
#include <unistd.h>

/* Decodes a PNG file and deletes it; the caller frees. */
static inline uint8_t *decode(const char *path, uint32_t format, size_t *width, size_t *height) {
    png_image image = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_file(&image, path));
    image.format = format;
    uint8_t *pixels = malloc(PNG_IMAGE_SIZE(image));
    assert_non_null(pixels);
    assert_true(png_image_finish_read(&image, NULL, pixels, 0, NULL));
    *width = image.width;
    *height = image.height;
    assert_int_equal(unlink(path), 0);
    return pixels;
}

static inline uint32_t pixel(const uint8_t *rgb, size_t width, size_t x, size_t y) {
    const uint8_t *p = rgb + 3 * (y * width + x);
    return (uint32_t)p[0] << 16 | (uint32_t)p[1] << 8 | p[2];
}

/* How many pixels of a PNG file, which is deleted, are of this colour. */
static inline size_t count_pixels(const char *path, uint32_t rgb, size_t *width, size_t *height) {
    uint8_t *pixels = decode(path, PNG_FORMAT_RGB, width, height);
    size_t count = 0;
    for (size_t i = 0; i < *width * *height; i++) {
        count += pixel(pixels, *width, i % *width, i / *width) == rgb;
    }
    free(pixels);
    return count;
}

#endif
