/*
 * Damage to texts, the same on every machine.
 */
#ifndef ASDIC_TESTS_DAMAGE_H
#define ASDIC_TESTS_DAMAGE_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

/* A small generator of its own, the same everywhere. */
static inline uint32_t draw(uint32_t *state) {
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

/* SIZE bytes of TEXT with some damage; returns the new size. OUT has room for twice as many. */
static inline size_t damage(const char *text, size_t size, uint32_t *state, char *out) {
    static const char *const bits[] = {"{",  "[",   "]",    "}",    ":",   "\n",   "- ",   "'",
                                       "\"", "&a ", "*a",   "!!x ", "? ",  "| ",   "> ",   "%",
                                       "#",  "\t",  "\xff", "\0",   "1e9", "-1",   "nan",  "~",
                                       ", ", "<<",  "---",  "...",  "999", "0.0.", "\xe2", "@"};
    memcpy(out, text, size);
    for (uint32_t n = 1 + draw(state) % 4; n > 0 && size > 0; n--) {
        size_t at = draw(state) % size, length = draw(state) % 24;
        const char *bit = bits[draw(state) % 32];
        switch (draw(state) % 5) {
        case 0: /* one byte other */
            out[at] = (char)draw(state);
            break;
        case 1: /* a stretch lost */
            length = length > size - at ? size - at : length;
            memmove(out + at, out + at + length, size - at - length);
            size -= length;
            break;
        case 2: /* something put in */
            length = *bit ? strlen(bit) : 1;
            memmove(out + at + length, out + at, size - at);
            memcpy(out + at, bit, length);
            size += length;
            break;
        case 3: /* a stretch doubled */
            length = length > size - at ? size - at : length;
            memmove(out + at + length, out + at, size - at);
            size += length;
            break;
        default: /* the end lost */
            size = draw(state) % 8 == 0 ? at : size;
        }
    }
    return size;
}

#endif
