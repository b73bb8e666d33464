#include "border.h"

#include "base/grow.h"
#include "planes.h"

#include <stdlib.h>

static int compare(asdic_vec3 a, asdic_vec3 b) {
    double x = a.x - b.x, y = a.y - b.y, z = a.z - b.z, first = x != 0.0 ? x : y != 0.0 ? y : z;
    return (first > 0.0) - (first < 0.0);
}

bool asdic_border_add(asdic_border *b, const asdic_piece *side) {
    if (!asdic_grow(&b->sides, b->count, &b->capacity, sizeof *b->sides)) {
        return false;
    }
    asdic_piece *own = &b->sides[b->count++];
    *own = *side;
    if (compare(side->edge1, (asdic_vec3){0.0, 0.0, 0.0}) <
        0) { /* runs upwards, whichever face's it is */
        own->corner = asdic_vec3_add(side->corner, side->edge1);
        own->edge1 = asdic_vec3_scale(side->edge1, -1.0);
        own->edge2 = asdic_vec3_sub(side->edge2, side->edge1);
    }
    return true;
}

/* Corners are of single precision, and halves of them exact: what is in one place has the same numbers. */
static int by_place(const void *left, const void *right) {
    const asdic_piece *a = left, *b = right;
    int order = compare(a->corner, b->corner);
    return order ? order : compare(a->edge1, b->edge1);
}

static int by_place_and_name(const void *left, const void *right) {
    const asdic_piece *a = left, *b = right;
    int order = by_place(a, b);
    for (int i = 0; i < 3 && order == 0; i++) {
        order = (a->name[i] > b->name[i]) - (a->name[i] < b->name[i]);
    }
    return order;
}

/* Whether the faces of A and B, which are in one place, go on into each other. */
static bool go_on(const asdic_piece *a, const asdic_piece *b, const asdic_placement *placement) {
    bool apart = asdic_vec3_dot(asdic_vec3_cross(a->edge1, a->edge2),
                                asdic_vec3_cross(b->edge1, b->edge2)) < 0.0;
    return apart && asdic_planes_agree(asdic_placement_triangle(placement, a->triangle),
                                       asdic_placement_triangle(placement, b->triangle));
}

void asdic_border_join(asdic_border *b, const asdic_placement *placement) {
    size_t kept = 0;
    if (b->count > 0) {
        qsort(b->sides, b->count, sizeof *b->sides, by_place_and_name);
    }
    for (size_t i = 0; i < b->count; i++) {
        size_t k = kept;
        while (k > 0 && by_place(&b->sides[k - 1], &b->sides[i]) == 0 &&
               !go_on(&b->sides[k - 1], &b->sides[i], placement)) {
            k--;
        }
        if (k > 0 && by_place(&b->sides[k - 1], &b->sides[i]) == 0) {
            b->sides[k - 1] = b->sides[--kept];
        } else {
            b->sides[kept++] = b->sides[i];
        }
    }
    b->count = kept;
}
