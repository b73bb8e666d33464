#include "outline.h"

#include <string.h>

void asdic_mask_boxes(const asdic_mask *mask, size_t count, asdic_box *boxes) {
    memset(boxes, 0, (count + 1) * sizeof *boxes);
    for (size_t y = 0; y < mask->height; y++) {
        const uint16_t *row = mask->number + y * mask->width;
        for (size_t x = 0; x < mask->width; x++) {
            if (row[x] == 0 || row[x] > count) {
                continue;
            }
            asdic_box *b = &boxes[row[x]];
            if (b->pixels++ == 0) {
                *b = (asdic_box){1, x, y, x + 1, y + 1};
            }
            b->left = x < b->left ? x : b->left;
            b->right = x + 1 > b->right ? x + 1 : b->right;
            b->bottom = y + 1;
        }
    }
}

static bool is_in(const asdic_mask *mask, uint16_t number, long x, long y) {
    return x >= 0 && y >= 0 && x < (long)mask->width && y < (long)mask->height &&
           mask->number[(size_t)y * mask->width + (size_t)x] == number;
}

/* Directions along pixels' edges: right, down, left, up. With the object on the right hand, the pixel ahead of the
 * corner (x, y) lies at AHEAD on the left and at BESIDE on the right. */
static const int step_x[4] = {1, 0, -1, 0}, step_y[4] = {0, 1, 0, -1};
static const int ahead_x[4] = {0, 0, -1, -1}, ahead_y[4] = {-1, 0, 0, -1};
static const int beside_x[4] = {0, -1, -1, 0}, beside_y[4] = {0, 0, -1, -1};

static size_t least(size_t a, long b) {
    return (size_t)b < a ? (size_t)b : a;
}

static size_t most(size_t a, long b) {
    return (size_t)b > a ? (size_t)b : a;
}

/* Round the part whose topmost, then leftmost pixel is (LEFT, TOP), clockwise; only corners are told. Pixels that
 * touch at a corner alone are apart. Returns the part's box. */
static asdic_box trace(const asdic_mask *mask, uint16_t number, long left, long top,
                       asdic_text *out) {
    long x = left, y = top;
    int way = 0;
    asdic_box box = {0, (size_t)left, (size_t)top, (size_t)left, (size_t)top};
    asdic_text_format(out, "[%ld,%ld", x, y);
    do {
        x += step_x[way];
        y += step_y[way];
        box.left = least(box.left, x);
        box.right = most(box.right, x);
        box.bottom = most(box.bottom, y);
        bool right = is_in(mask, number, x + beside_x[way], y + beside_y[way]);
        bool on = is_in(mask, number, x + ahead_x[way], y + ahead_y[way]);
        int turn = !right ? 1 : on ? 3 : 0;
        way = (way + turn) % 4;
        if (turn != 0 && !(x == left && y == top)) {
            asdic_text_format(out, ",%ld,%ld", x, y);
        }
    } while (!(x == left && y == top && way == 0));
    asdic_text_add(out, "]");
    return box;
}

/* Marks the part in BOX that hangs together with (X, Y), by growing marks until none is added. */
static void mark(const asdic_mask *mask, const asdic_box *box, uint16_t number, size_t x, size_t y,
                 uint8_t *seen) {
    bool grows = true;
    seen[y * mask->width + x] = 2;
    for (int pass = 0; grows; pass++) {
        grows = false;
        for (size_t i = 0; i < box->bottom - box->top; i++) {
            size_t v = pass % 2 ? box->bottom - 1 - i : box->top + i;
            for (size_t k = 0; k < 2 * (box->right - box->left); k++) {
                size_t wide = box->right - box->left;
                size_t u = k < wide ? box->left + k : box->right - 1 - (k - wide);
                size_t at = v * mask->width + u;
                if (mask->number[at] != number || seen[at] == 2) {
                    continue;
                }
                bool near = (u > box->left && seen[at - 1] == 2) ||
                            (u + 1 < box->right && seen[at + 1] == 2) ||
                            (v > box->top && seen[at - mask->width] == 2) ||
                            (v + 1 < box->bottom && seen[at + mask->width] == 2);
                seen[at] = near ? 2 : seen[at];
                grows = grows || near;
            }
        }
    }
}

void asdic_mask_polygons(const asdic_mask *mask, const asdic_box *box, uint16_t number,
                         uint8_t *seen, asdic_text *out) {
    bool is_first = true;
    for (size_t y = box->top; y < box->bottom; y++) {
        for (size_t x = box->left; x < box->right; x++) {
            size_t at = y * mask->width + x;
            if (mask->number[at] != number || seen[at] != 0) {
                continue;
            }
            asdic_text_add(out, is_first ? "" : ",");
            is_first = false;
            asdic_box part = trace(mask, number, (long)x, (long)y, out);
            mark(mask, &part, number, x, y, seen);
        }
    }
    for (size_t y = box->top; y < box->bottom; y++) {
        memset(seen + y * mask->width + box->left, 0, box->right - box->left);
    }
}
