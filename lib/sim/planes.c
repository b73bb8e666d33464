#include "planes.h"

#include "base/vec.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Triangles lie in one plane when their normals agree to this: what is left out is 80 dB below the edge of either. */
#define SAME_PLANE 1e-4
/* Normals of slivers are roundings. They lie in a plane whose corners they leave by this share of the largest coordinate. */
#define ROUNDING 2.4e-7

/* A side of a face by its ends, the lower first. */
typedef struct side {
    float end[2][3];
    uint32_t number; /* as of asdic_planes.beyond */
} side;

static asdic_vec3 vec_of(const float v[3]) {
    return (asdic_vec3){v[0], v[1], v[2]};
}

bool asdic_planes_agree(const dev_triangle *a, const dev_triangle *b) {
    asdic_vec3 cross = asdic_vec3_cross(vec_of(a->normal), vec_of(b->normal));
    return a->part == b->part && asdic_vec3_length(cross) < SAME_PLANE;
}

static int compare_ends(const float *a, const float *b, int count) {
    for (int i = 0; i < count; i++) {
        if (a[i] != b[i]) {
            return a[i] < b[i] ? -1 : 1;
        }
    }
    return 0;
}

static int by_place(const void *left, const void *right) {
    const side *a = left, *b = right;
    int order = compare_ends(a->end[0], b->end[0], 6);
    return order ? order : (a->number > b->number) - (a->number < b->number);
}

static const float *corner_of(const dev_triangle *t, uint32_t k) {
    const float *const corner[3] = {t->v0, t->v1, t->v2};
    return corner[k % 3];
}

/* The sides of smooth faces; how many. */
static size_t list_sides(const asdic_placement *placement, const bool *smooth, side *sides) {
    size_t count = 0;
    for (size_t i = 0; i < placement->scene->triangle_count; i++) {
        const dev_triangle *t = asdic_placement_triangle(placement, i);
        for (uint32_t k = 0; smooth[t->part] && k < 3; k++) {
            const float *a = corner_of(t, k), *b = corner_of(t, k + 1);
            bool turned = compare_ends(a, b, 3) > 0;
            side *s = &sides[count++];
            s->number = (uint32_t)(3 * i) + k;
            memcpy(s->end[turned], a, sizeof s->end[0]);
            memcpy(s->end[!turned], b, sizeof s->end[0]);
        }
    }
    return count;
}

/* Whether the faces of two sides in one place go on into each other. */
static bool go_on(const asdic_placement *placement, const side *a, const side *b) {
    const dev_triangle *s = asdic_placement_triangle(placement, a->number / 3);
    const dev_triangle *t = asdic_placement_triangle(placement, b->number / 3);
    asdic_vec3 from = vec_of(a->end[0]), along = asdic_vec3_sub(vec_of(a->end[1]), from);
    asdic_vec3 p = asdic_vec3_sub(vec_of(corner_of(s, a->number % 3 + 2)), from);
    asdic_vec3 q = asdic_vec3_sub(vec_of(corner_of(t, b->number % 3 + 2)), from);
    asdic_vec3 m = asdic_vec3_cross(along, p), n = asdic_vec3_cross(along, q);
    double larger = fmax(asdic_vec3_length(m), asdic_vec3_length(n));
    /* Times the larger, how far the lower's corner is off the other's plane. */
    double apart = fabs(asdic_vec3_dot(m, q));
    bool flat = s->part == t->part && apart <= ROUNDING * placement->extent_m * larger;
    return asdic_vec3_dot(m, n) < 0.0 && (flat || asdic_planes_agree(s, t));
}

/* Sides in one place, from FIRST to END: each is one of two faces at most. */
static void pair_sides(const asdic_placement *placement, const side *first, const side *end,
                       uint32_t *beyond) {
    for (const side *a = first; a < end; a++) {
        for (const side *b = first; b < a && beyond[a->number] == ASDIC_NO_FACE; b++) {
            if (beyond[b->number] == ASDIC_NO_FACE && go_on(placement, a, b)) {
                beyond[a->number] = b->number / 3;
                beyond[b->number] = a->number / 3;
            }
        }
    }
}

/* The lowest face of the plane of FACE. */
static uint32_t root_of(uint32_t *root, uint32_t face) {
    while (root[face] != face) {
        root[face] = root[root[face]];
        face = root[face];
    }
    return face;
}

static void join_faces(const asdic_planes *p, uint32_t *root) {
    for (size_t i = 0; i < 3 * p->count; i++) {
        if (p->beyond[i] != ASDIC_NO_FACE) {
            uint32_t a = root_of(root, (uint32_t)(i / 3)), b = root_of(root, p->beyond[i]);
            root[a > b ? a : b] = a > b ? b : a;
        }
    }
}

typedef struct extent {
    asdic_vec3 normal_m2; /* of all faces */
    double area_m2;
    double long_m; /* how far it reaches from the first corner; without end: it bends */
    size_t faces;
} extent;

static void add_face(extent *plane, const dev_triangle *t, asdic_vec3 from) {
    asdic_vec3 a = vec_of(t->v0), b = asdic_vec3_sub(vec_of(t->v1), a);
    asdic_vec3 twice_m2 = asdic_vec3_cross(b, asdic_vec3_sub(vec_of(t->v2), a));
    bool turned = asdic_vec3_dot(twice_m2, plane->normal_m2) < 0.0;
    plane->normal_m2 =
        asdic_vec3_add(plane->normal_m2, asdic_vec3_scale(twice_m2, turned ? -0.5 : 0.5));
    plane->area_m2 += 0.5 * asdic_vec3_length(twice_m2);
    plane->faces++;
    for (uint32_t k = 0; k < 3; k++) {
        asdic_vec3 way = asdic_vec3_sub(vec_of(corner_of(t, k)), from);
        plane->long_m = fmax(plane->long_m, asdic_vec3_length(way));
    }
}

/* Far from the origin, where a rounding is as much as fine facets of a round body turn by, each neighbour goes on into the next,
 * and all of them round the body. */
static void drop_bent(extent *plane, const dev_triangle *t, asdic_vec3 from, double rounding_m) {
    double most_m = rounding_m + SAME_PLANE * plane->long_m;
    for (uint32_t k = 0; k < 3; k++) {
        asdic_vec3 way = asdic_vec3_sub(vec_of(corner_of(t, k)), from);
        double off = fabs(asdic_vec3_dot(way, plane->normal_m2));
        plane->long_m =
            off > most_m * asdic_vec3_length(plane->normal_m2) ? INFINITY : plane->long_m;
    }
}

/* How high planes are: as high as a square's triangles, its area by how far it reaches. */
static void measure(const asdic_placement *placement, uint32_t *root, extent *planes,
                    asdic_planes *out) {
    double rounding_m = ROUNDING * placement->extent_m;
    for (int bent = 0; bent < 2; bent++) {
        for (size_t i = 0; i < out->count; i++) {
            const dev_triangle *t = asdic_placement_triangle(placement, i);
            uint32_t at = root_of(root, (uint32_t)i);
            asdic_vec3 from = vec_of(asdic_placement_triangle(placement, at)->v0);
            if (bent) {
                drop_bent(&planes[at], t, from, rounding_m);
            } else {
                add_face(&planes[at], t, from);
            }
        }
    }
    for (size_t i = 0; i < out->count; i++) {
        const extent *e = &planes[root_of(root, (uint32_t)i)];
        out->height_m[i] = e->faces > 2 ? (float)(e->area_m2 / e->long_m) : 0.0f;
    }
}

bool asdic_planes_find(const asdic_placement *placement, const bool *smooth, asdic_planes *out) {
    size_t n = placement->scene->triangle_count;
    side *sides = malloc((3 * n + 1) * sizeof *sides);
    uint32_t *root = malloc((n + 1) * sizeof *root);
    extent *planes = calloc(n + 1, sizeof *planes);
    out->count = n;
    out->beyond = malloc((3 * n + 1) * sizeof *out->beyond);
    out->height_m = malloc((n + 1) * sizeof *out->height_m);
    out->form = malloc(n + 1);
    bool all = sides && root && planes && out->beyond && out->height_m && out->form;
    if (all) {
        memset(out->beyond, 0xff, 3 * n * sizeof *out->beyond);
        size_t count = list_sides(placement, smooth, sides);
        qsort(sides, count, sizeof *sides, by_place);
        for (size_t i = 0, end = 0; i < count; i = end) {
            while (end < count && compare_ends(sides[i].end[0], sides[end].end[0], 6) == 0) {
                end++;
            }
            pair_sides(placement, sides + i, sides + end, out->beyond);
        }
        for (size_t i = 0; i < n; i++) {
            root[i] = (uint32_t)i;
        }
        join_faces(out, root);
        measure(placement, root, planes, out);
    } else {
        asdic_planes_finish(out);
    }
    free(planes);
    free(root);
    free(sides);
    return all;
}

void asdic_planes_finish(asdic_planes *planes) {
    free(planes->beyond);
    free(planes->height_m);
    free(planes->form);
    *planes = (asdic_planes){0};
}
