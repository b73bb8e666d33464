#include "npy.h"

#include <stdio.h>
#include <string.h>

#define PREFIX 10 /* "\x93NUMPY", version, length of the rest */
#define COUNT_DIGITS 20

size_t asdic_npy_header(char header[ASDIC_NPY_HEADER_SIZE], const char *dtype, size_t count,
                        const char *shape_rest) {
    char *text = header + PREFIX;
    const size_t room = ASDIC_NPY_HEADER_SIZE - PREFIX;
    int length = snprintf(text, room, "{'descr': %s, 'fortran_order': False, 'shape': (%zu, %s), }",
                          dtype, count, shape_rest);
    int digits = snprintf(NULL, 0, "%zu", count);
    size_t longest = (size_t)(length + COUNT_DIGITS - digits);
    size_t total = (PREFIX + longest + 1 + 63) / 64 * 64;
    if (total > ASDIC_NPY_HEADER_SIZE) {
        return 0;
    }
    memset(text + length, ' ', total - PREFIX - (size_t)length);
    header[total - 1] = '\n';
    memcpy(header, "\x93NUMPY\x01", 7);
    header[7] = 0;
    header[8] = (char)((total - PREFIX) & 255);
    header[9] = (char)((total - PREFIX) >> 8);
    return total;
}
