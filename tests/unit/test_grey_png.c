/*
 * Grey pictures of data sets, in memory: as another reader of PNG finds them.
 */
#include "asserts.h"

#include "out/grey_png.h"

#include <png.h>
#include <stdio.h>
#include <stdlib.h>

/* Noise, which grows when packed, and one grey, which does not. */
static void greys_read_back(void **state) {
    (void)state;
    enum { WIDE = 50, HIGH = 40, MOST = WIDE * HIGH };
    uint32_t random = 12345;
    for (int i = 0; i < 4; i++) {
        const unsigned bits = i % 2 ? 16 : 8;
        uint8_t small[MOST];
        uint16_t large[MOST];
        for (size_t k = 0; k < MOST; k++) {
            random = random * 1664525u + 1013904223u;
            large[k] = i < 2 ? (uint16_t)(random >> 16) : 0x1234;
            small[k] = (uint8_t)large[k];
        }
        const asdic_grey image = {.width = WIDE,
                                  .height = HIGH,
                                  .bits = bits,
                                  .values = bits == 8 ? (const void *)small : large};
        size_t length = 0;
        unsigned char *bytes = asdic_grey_png(&image, &length);
        assert_non_null(bytes);
        FILE *file = fmemopen(bytes, length, "rb");
        png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
        png_infop info = png_create_info_struct(png);
        png_init_io(png, file);
        png_read_png(png, info, PNG_TRANSFORM_IDENTITY, NULL);
        assert_true(png_get_image_width(png, info) == WIDE &&
                    png_get_image_height(png, info) == HIGH);
        assert_int_equal(png_get_bit_depth(png, info), bits);
        assert_int_equal(png_get_color_type(png, info), PNG_COLOR_TYPE_GRAY);
        png_bytepp rows = png_get_rows(png, info);
        for (size_t k = 0; k < MOST; k++) {
            const uint8_t *p = rows[k / WIDE] + k % WIDE * bits / 8;
            assert_int_equal(bits == 8 ? *p : p[0] << 8 | p[1], bits == 8 ? small[k] : large[k]);
        }
        png_destroy_read_struct(&png, &info, NULL);
        assert_memory_equal(bytes + length - 12, "\0\0\0\0IEND\xae\x42\x60\x82", 12);
        fclose(file);
        free(bytes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(greys_read_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
