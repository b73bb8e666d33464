#include "cli_state.h"

#include <string.h>

#define LONGEST 40

static size_t smaller(size_t a, size_t b) {
    return a < b ? a : b;
}

/* Letters to insert, delete or replace, or to swap with their neighbours (Damerau 1964). */
static size_t distance(const char *a, const char *b) {
    size_t rows[3][LONGEST + 1], length_a = strlen(a), length_b = strlen(b);
    for (size_t i = 0; i <= length_a; i++) {
        size_t *row = rows[i % 3], *last = rows[(i + 2) % 3], *before = rows[(i + 1) % 3];
        row[0] = i;
        for (size_t j = 1; j <= length_b; j++) {
            if (i == 0) {
                row[j] = j;
                continue;
            }
            row[j] =
                smaller(last[j - 1] + (a[i - 1] != b[j - 1]), smaller(last[j], row[j - 1]) + 1);
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
                row[j] = smaller(row[j], before[j - 2] + 1);
            }
        }
    }
    return rows[length_a % 3][length_b];
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
        size_t most = smaller(strlen(words[i]) / 3 + 1, 3);
        /* A letter and a third may differ, but never more than half: of a short word little would be left. */
        if (d <= most && 2 * d <= strlen(words[i]) && (!best || d < best_distance)) {
            best = words[i];
            best_distance = d;
        }
    }
    return best;
}
