/*
 * Ear clipping in the plane of the polygon's mean normal (M. E. Newell). OpenMesh and most
 * modellers fan polygons from the first corner, which covers the outside of concave ones.
 */
#include "mesh_polygon.h"

#include <math.h>
#include <string.h>

/* Of the square of the outline's extent: areas that are roundings, as those of vertices that are one (mesh_weld.c). */
#define FLAT_SHARE 0x1p-18

typedef struct outline {
    const double *vertices_m;
    uint32_t *corners;
    size_t count;
    int x, y;       /* the two axes kept */
    double sign;    /* of the outline's area in these axes */
    double flat_m2; /* twice an area that is a rounding */
} outline;

static const double *at(const outline *o, size_t i) {
    return &o->vertices_m[3 * (size_t)o->corners[i]];
}

/* Twice the area of corners a, b, c, positive where the outline turns its own way. */
static double turn(const outline *o, const double *a, const double *b, const double *c) {
    return o->sign *
           ((b[o->x] - a[o->x]) * (c[o->y] - a[o->y]) - (b[o->y] - a[o->y]) * (c[o->x] - a[o->x]));
}

static void remove_corner(outline *o, size_t i) {
    memmove(&o->corners[i], &o->corners[i + 1], (o->count - i - 1) * sizeof *o->corners);
    o->count--;
}

static bool same_place(const double *a, const double *b) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* A corner repeated at once is no edge, and one to which an edge leads and back is a spike without an area. */
static void drop_repeated(outline *o) {
    for (size_t i = 0, passed = 0; passed < o->count && o->count > 1;) {
        const double *a = at(o, i % o->count);
        if (same_place(a, at(o, (i + 1) % o->count))) {
            remove_corner(o, i % o->count);
            passed = 0;
        } else if (same_place(a, at(o, (i + 2) % o->count))) {
            remove_corner(o, (i + 1) % o->count);
            passed = 0;
        } else {
            i++;
            passed++;
        }
    }
}

/* An outline that is gone round again and again covers no more than once. */
static void drop_rounds(outline *o) {
    for (size_t once = 3; 2 * once <= o->count; once++) {
        if (o->count % once == 0 &&
            memcmp(o->corners, o->corners + once, (o->count - once) * sizeof *o->corners) == 0) {
            o->count = once;
        }
    }
}

/* Chooses the plane; false without an area. */
static bool choose_plane(outline *o) {
    double n[3] = {0.0, 0.0, 0.0}, extent_m = 0.0;
    const double *base = at(o, 0);
    for (size_t i = 0; i < o->count; i++) {
        const double *p = at(o, i), *q = at(o, (i + 1) % o->count);
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            extent_m = fmax(extent_m, fabs(p[k] - base[k]));
            n[k] += (p[a] - base[a]) * (q[b] - base[b]) - (p[b] - base[b]) * (q[a] - base[a]);
        }
    }
    int drop = fabs(n[0]) >= fabs(n[1]) && fabs(n[0]) >= fabs(n[2]) ? 0
               : fabs(n[1]) >= fabs(n[2])                           ? 1
                                                                    : 2;
    o->x = (drop + 1) % 3;
    o->y = (drop + 2) % 3;
    o->sign = n[drop] > 0.0 ? 1.0 : -1.0;
    o->flat_m2 = FLAT_SHARE * extent_m * extent_m;
    return n[drop] != 0.0;
}

/* Corner i can be cut off: it turns inward and no other corner lies in the triangle. */
static bool is_ear(const outline *o, size_t i) {
    const double *a = at(o, (i + o->count - 1) % o->count), *b = at(o, i);
    const double *c = at(o, (i + 1) % o->count);
    if (turn(o, a, b, c) <= 0.0) {
        return false;
    }
    for (size_t k = 0; k < o->count; k++) {
        const double *p = at(o, k);
        if (same_place(p, a) || same_place(p, b) || same_place(p, c)) {
            continue;
        }
        if (turn(o, a, b, p) >= 0.0 && turn(o, b, c, p) >= 0.0 && turn(o, c, a, p) >= 0.0) {
            return false;
        }
    }
    return true;
}

static void put(const outline *o, size_t i, uint32_t *triangles, size_t *written) {
    uint32_t *t = &triangles[3 * (*written)++];
    t[0] = o->corners[(i + o->count - 1) % o->count];
    t[1] = o->corners[i];
    t[2] = o->corners[(i + 1) % o->count];
}

/* Drops the flattest corner, which is on the straight line between its neighbours or back along itself, to
 * roundings; false when there is none. */
static bool drop_flat(outline *o) {
    size_t flattest = 0;
    double least_m2 = INFINITY;
    for (size_t i = 0; i < o->count; i++) {
        double turn_m2 = fabs(
            turn(o, at(o, (i + o->count - 1) % o->count), at(o, i), at(o, (i + 1) % o->count)));
        if (turn_m2 < least_m2) {
            flattest = i;
            least_m2 = turn_m2;
        }
    }
    if (least_m2 > o->flat_m2) {
        return false;
    }
    remove_corner(o, flattest);
    return true;
}

bool asdic_polygon_triangulate(const double *vertices_m, uint32_t *corners, size_t count,
                               uint32_t *triangles, size_t *written) {
    outline o = {.vertices_m = vertices_m, .corners = corners, .count = count};
    *written = 0;
    drop_repeated(&o);
    drop_rounds(&o);
    if (o.count < 3 || !choose_plane(&o)) {
        return true;
    }
    /* Beginning at corner 1 gives the usual fan from corner 0 for a convex polygon. */
    size_t i = 1, tried = 0;
    while (o.count > 3) {
        i %= o.count;
        if (is_ear(&o, i)) {
            put(&o, i, triangles, written);
            remove_corner(&o, i);
            tried = 0;
        } else if (++tried <= o.count) {
            i++;
        } else if (drop_flat(&o)) {
            tried = 0;
        } else {
            return false; /* every simple polygon has an ear: this one crosses itself */
        }
    }
    double last_m2 = turn(&o, at(&o, 0), at(&o, 1), at(&o, 2));
    if (last_m2 < 0.0) {
        return last_m2 >= -o.flat_m2;
    }
    put(&o, 1, triangles, written);
    return true;
}
