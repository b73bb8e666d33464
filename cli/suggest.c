#include "cli_state.h"

#include <string.h>

#define LONGEST 40

static size_t smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

/* Letters to insert, delete or replace (Levenshtein 1966). */
static size_t distance(const char *a, const char *b) {
    size_t row[LONGEST + 1];
    size_t length_b = strlen(b);
    for (size_t j = 0; j <= length_b; j++) {
        row[j] = j;
    }
    for (size_t i = 0; a[i]; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < length_b; j++) {
            size_t replaced = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            row[j + 1] = smaller(replaced, smaller(row[j], row[j + 1]) + 1);
        }
    }
    return row[length_b];
}

const char *cli_nearest(const char *text, const char *const *words, size_t count) {
    const char *best = NULL;
    size_t best_distance = 0;
    if (strlen(text) > LONGEST) {
        return NULL;
    }
    for (size_t i = 0; i < count; i++) {
        if (strlen(words[i]) > LONGEST) {
            continue;
        }
        size_t d = distance(text, words[i]);
        /* At most a third of the letters differ, or two are swapped in a short word. */
        if (d <= smaller(strlen(words[i]) / 3 + 1, 3) && (!best || d < best_distance)) {
            best = words[i];
            best_distance = d;
        }
    }
    return best;
}
