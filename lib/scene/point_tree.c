/*
 * J. L. Bentley, "Multidimensional binary search trees used for associative searching", CACM 18(9), 1975: the middle
 * point parts the others along an axis, and so on with the next axis on either side.
 */
#include "point_tree.h"

#include <math.h>

/* So few points are met one by one. */
#define FEW 8
/* Of the reach, against roundings. */
#define SLACK 1.01

static double along(asdic_vec3 v, int axis) {
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* Puts the point of rank MIDDLE along AXIS in its place, and the others on their side of it (C. A. R. Hoare, "Algorithm
 * 65: FIND", CACM 4(7), 1961). Pivots are drawn: where a round body's points go to and fro the middle one would be the
 * largest again and again. */
static void part(asdic_point_place *points, ptrdiff_t middle, ptrdiff_t count, int axis) {
    uint32_t draw = 1;
    for (ptrdiff_t low = 0, high = count - 1; low < high;) {
        draw = draw * 1664525u + 1013904223u;
        ptrdiff_t i = low, k = high,
                  drawn = low + (ptrdiff_t)((uint64_t)draw * (uint64_t)(high - low) >> 32);
        double pivot = along(points[drawn].at_m, axis);
        while (i <= k) {
            while (along(points[i].at_m, axis) < pivot) {
                i++;
            }
            while (along(points[k].at_m, axis) > pivot) {
                k--;
            }
            if (i <= k) {
                asdic_point_place swapped = points[i];
                points[i++] = points[k];
                points[k--] = swapped;
            }
        }
        low = k < middle ? i : low;
        high = middle < i ? k : high;
    }
}

static void plant(asdic_point_place *points, size_t count, int axis) {
    for (; count > FEW; axis = (axis + 1) % 3) {
        size_t middle = count / 2;
        part(points, (ptrdiff_t)middle, (ptrdiff_t)count, axis);
        plant(points, middle, (axis + 1) % 3);
        points += middle + 1;
        count -= middle + 1;
    }
}

void asdic_point_tree_plant(asdic_point_place *points, size_t count) {
    plant(points, count, 0);
}

/* Meets what is near the segment from BEGIN to STOP, shares of its length, in a tree of COUNT that AXIS parts. */
static void search_part(const asdic_point_search *q, const asdic_point_place *points, size_t count,
                        int axis, double begin, double stop) {
    if (begin > stop) {
        return;
    }
    if (count <= FEW) {
        for (size_t i = 0; i < count; i++) {
            q->meet(q->caller, &points[i]);
        }
        return;
    }
    size_t middle = count / 2, rest = count - middle - 1;
    const asdic_point_place *upper = points + middle + 1;
    q->meet(q->caller, &points[middle]);
    /* Where the segment is as far beyond the middle as reach goes, and before it; infinite where it is there nowhere, or
     * everywhere. */
    double way_m = along(q->way_m, axis) + 0.0, reach_m = SLACK * q->reach_m; /* -0 is 0 */
    double apart_m = along(points[middle].at_m, axis) - along(q->from_m, axis);
    double beyond = (apart_m + reach_m) / way_m, before = (apart_m - reach_m) / way_m;
    axis = (axis + 1) % 3;
    if (way_m >= 0.0) {
        search_part(q, points, middle, axis, begin, fmin(stop, beyond));
        search_part(q, upper, rest, axis, fmax(begin, before), stop);
    } else {
        search_part(q, points, middle, axis, fmax(begin, beyond), stop);
        search_part(q, upper, rest, axis, begin, fmin(stop, before));
    }
}

void asdic_point_tree_search(const asdic_point_place *points, size_t count,
                             const asdic_point_search *search) {
    search_part(search, points, count, 0, 0.0, 1.0);
}
