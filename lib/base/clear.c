#include "clear.h"

#include "widest.h"

#include <stdbool.h>
#include <string.h>

WIDEST static bool is_clear(const unsigned char *at, size_t bytes) {
    unsigned char any = 0;
    for (size_t n = 0; n < bytes; n++) {
        any |= at[n];
    }
    return any == 0;
}

void asdic_clear(void *at, size_t bytes) {
    if (!is_clear(at, bytes)) {
        memset(at, 0, bytes);
    }
}
