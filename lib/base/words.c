#include "words.h"

#include "number.h"

#include <string.h>

#define LONGEST_WORD 64

bool asdic_words_number(const char *text, double *out) {
    double value;
    if (asdic_number_parse(text, strlen(text), &value)) {
        return false;
    }
    *out = value;
    return true;
}

static char lower(char c) {
    return (char)(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}

/* Edits (insert, delete, replace, swap of neighbours) that turn A into B; Damerau 1964. */
static size_t edits(const char *a, size_t na, const char *b, size_t nb) {
    size_t row[3][LONGEST_WORD + 1];
    for (size_t j = 0; j <= nb; j++) {
        row[0][j] = j;
    }
    for (size_t i = 1; i <= na; i++) {
        size_t *now = row[i % 3], *last = row[(i - 1) % 3], *before = row[(i + 1) % 3];
        now[0] = i;
        for (size_t j = 1; j <= nb; j++) {
            size_t best = last[j - 1] + (lower(a[i - 1]) != lower(b[j - 1]));
            best = last[j] + 1 < best ? last[j] + 1 : best;
            best = now[j - 1] + 1 < best ? now[j - 1] + 1 : best;
            if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                lower(a[i - 2]) == lower(b[j - 1]) && before[j - 2] + 1 < best) {
                best = before[j - 2] + 1;
            }
            now[j] = best;
        }
    }
    return row[na % 3][nb];
}

size_t asdic_words_nearest(const char *text, const char *const *names, size_t count) {
    size_t best = count, best_edits = 0;
    size_t length = strlen(text);
    for (size_t i = 0; i < count && length <= LONGEST_WORD; i++) {
        size_t name_length = strlen(names[i]);
        if (name_length > LONGEST_WORD) {
            continue;
        }
        size_t n = edits(text, length, names[i], name_length);
        size_t longer = length > name_length ? length : name_length;
        if (3 * n <= longer && (best == count || n < best_edits)) {
            best = i;
            best_edits = n;
        }
    }
    return best;
}

size_t asdic_words_cut(const char *text, size_t length, size_t most) {
    if (length <= most) {
        return length;
    }
    while (most > 0 && ((unsigned char)text[most] & 0xc0) == 0x80) {
        most--;
    }
    return most;
}
