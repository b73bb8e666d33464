/*
 * Every range against exact arithmetic, where rounding and the widened triangles of kernels/intersect.h
 * do harm: from inside the boxes of large triangles, along their faces, in their planes, at their corners,
 * slivers, far from the origin. The argument `full` casts more rays.
 */
#include "trace_rig.h"

#include "exact_ray.h"

#include <stdlib.h>
#include <string.h>

#define MOST 48   /* triangles of a scene */
#define PACKET 64 /* rays that start together */
#define RAYS (128 * PACKET)
#define SCENES 320
#define SCENES_FULL 4000

/* What kernels/intersect.h promises, relative to its R. */
#define TOLERANCE 0x1p-21L
#define WIDER 1e-4L

static test_device rig;
static int scenes = SCENES;

/* ---- numbers -------------------------------------------------------------------------------- */

static int pick(uint64_t *seed, int count) {
    return (int)(trace_rig_random(seed) * count);
}

/* Any order of magnitude between LOW and HIGH as likely. */
static double magnitude(uint64_t *seed, double low, double high) {
    return low * pow(high / low, trace_rig_random(seed));
}

static double signed_magnitude(uint64_t *seed, double low, double high) {
    return pick(seed, 2) ? magnitude(seed, low, high) : -magnitude(seed, low, high);
}

/* ---- scenes --------------------------------------------------------------------------------- */

static dev_triangle triangle_at(const double at[3], double v[3][3]) {
    float corner[3][3];
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 3; k++) {
            corner[c][k] = exact_snap(at[k] + v[c][k], EXACT_LENGTH);
        }
    }
    return trace_rig_triangle(corner[0], corner[1], corner[2]);
}

/* Two triangles from four corners in turn. */
static void quad_at(const double at[3], double v[4][3], dev_triangle *out) {
    double second[3][3];
    memcpy(second[0], v[2], sizeof v[2]);
    memcpy(second[1], v[3], sizeof v[3]);
    memcpy(second[2], v[0], sizeof v[0]);
    out[0] = triangle_at(at, v);
    out[1] = triangle_at(at, second);
}

/* Large sloping rectangles, level along one axis. */
static size_t ramps(uint64_t *seed, const double at[3], dev_triangle *out) {
    double size = magnitude(seed, 1.0, 200.0);
    for (int i = 0; i < 4; i++) {
        int up = pick(seed, 3);
        double v[4][3], long_m = size * magnitude(seed, 0.3, 1.0),
                        wide_m = size * magnitude(seed, 0.3, 1.0),
                        slope = magnitude(seed, 0.05, 2.0);
        double off = size * trace_rig_random_signed(seed);
        for (int c = 0; c < 4; c++) {
            double along = c == 1 || c == 2 ? long_m : -long_m;
            v[c][up] = off + 0.5 * slope * along;
            v[c][(up + 1) % 3] = along;
            v[c][(up + 2) % 3] = c >= 2 ? wide_m : -wide_m;
        }
        quad_at(at, v, &out[2 * i]);
    }
    return 8;
}

/* Boxes along the axes: one round the middle, two anywhere. */
static size_t boxes(uint64_t *seed, const double at[3], dev_triangle *out) {
    static const int face[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                   {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    for (int i = 0; i < 3; i++) {
        double lo[3], hi[3];
        for (int k = 0; k < 3; k++) {
            double half = magnitude(seed, 0.5, 100.0);
            lo[k] = i == 0 ? -half : 30.0 * trace_rig_random_signed(seed);
            hi[k] = lo[k] + 2.0 * half;
        }
        for (int f = 0; f < 6; f++) {
            double v[4][3];
            for (int c = 0; c < 4; c++) {
                for (int k = 0; k < 3; k++) {
                    v[c][k] = face[f][c] >> k & 1 ? hi[k] : lo[k];
                }
            }
            quad_at(at, v, &out[12 * i + 2 * f]);
        }
    }
    return 36;
}

/* Up to a million times as long as wide; every fourth along an axis or level. */
static size_t slivers(uint64_t *seed, const double at[3], dev_triangle *out) {
    double size = magnitude(seed, 1.0, 200.0);
    for (int i = 0; i < 16; i++) {
        double v[3][3], wide_m = size * magnitude(seed, 1e-6, 0.1), share = trace_rig_random(seed);
        int level = i % 4 ? 3 : pick(seed, 3), also = pick(seed, 2) ? 3 : (level + 1) % 3;
        for (int k = 0; k < 3; k++) {
            double along = size * trace_rig_random_signed(seed);
            along = k == level || k == also ? 0.0 : along;
            v[0][k] = size * trace_rig_random_signed(seed);
            v[1][k] = v[0][k] + along;
            v[2][k] = v[0][k] + share * along + wide_m * trace_rig_random_signed(seed);
        }
        out[i] = triangle_at(at, v);
    }
    return 16;
}

/* Triangles of all sizes; half of them lie across an axis. */
static size_t soup(uint64_t *seed, const double at[3], dev_triangle *out) {
    for (int i = 0; i < 24; i++) {
        double v[3][3], size = magnitude(seed, 0.1, 50.0);
        for (int k = 0; k < 3; k++) {
            double centre = 20.0 * trace_rig_random_signed(seed);
            for (int c = 0; c < 3; c++) {
                v[c][k] = centre + (i % 6 == k ? 0.0 : size * trace_rig_random_signed(seed));
            }
        }
        out[i] = triangle_at(at, v);
    }
    return 24;
}

/* ---- rays ----------------------------------------------------------------------------------- */

/* Sixty-four rays at one triangle: from one point, or from many nearby. */
typedef struct packet {
    const dev_triangle *triangles, *own;
    size_t count;
    double lo[3], hi[3], size; /* its own triangle's */
    double origin[3], direction[3];
    double spread, drift; /* of directions, and of origins in metres */
    int axis;
} packet;

static double coordinate(const dev_triangle *t, int corner, int k) {
    return (corner == 0 ? t->v0 : corner == 1 ? t->v1 : t->v2)[k];
}

static packet packet_begin(uint64_t *seed, const dev_triangle *triangles, size_t count) {
    packet p = {.triangles = triangles,
                .own = &triangles[pick(seed, (int)count)],
                .count = count,
                .spread = magnitude(seed, 1e-7, 1.0),
                .axis = pick(seed, 3)};
    for (int k = 0; k < 3; k++) {
        double a = p.own->v0[k], b = p.own->v1[k], c = p.own->v2[k];
        p.lo[k] = fmin(fmin(a, b), c);
        p.hi[k] = fmax(fmax(a, b), c);
        p.size = fmax(p.size, p.hi[k] - p.lo[k]);
        p.origin[k] = p.lo[k] + trace_rig_random(seed) * (p.hi[k] - p.lo[k]);
        p.direction[k] = trace_rig_random_signed(seed);
    }
    p.drift = pick(seed, 3) == 0 ? p.size * magnitude(seed, 1e-7, 1e-2) : 0.0;
    return p;
}

/* Within the triangle's box or just outside, near one of its faces and all but parallel to it. */
static void along_a_face(uint64_t *seed, packet *p) {
    int k = p->axis;
    p->origin[k] =
        (pick(seed, 2) ? p->hi[k] : p->lo[k]) + p->size * signed_magnitude(seed, 1e-8, 1e-2);
    p->direction[k] = pick(seed, 8) ? signed_magnitude(seed, 1e-8, 0.1) : 0.0;
    if (pick(seed, 4) == 0) {
        p->direction[(k + 1) % 3] *= magnitude(seed, 1e-8, 0.1);
    }
}

static void from_anywhere(uint64_t *seed, packet *p) {
    for (int k = 0; k < 3; k++) {
        p->origin[k] = p->lo[k] + (3.0 * trace_rig_random(seed) - 1.0) * p->size;
    }
}

static void from_own_plane(uint64_t *seed, packet *p) {
    double u = 2.0 * trace_rig_random(seed) - 0.5, v = 2.0 * trace_rig_random(seed) - 0.5;
    for (int k = 0; k < 3; k++) {
        double a = coordinate(p->own, 0, k);
        p->origin[k] = a + u * (coordinate(p->own, 1, k) - a) + v * (coordinate(p->own, 2, k) - a);
    }
    if (pick(seed, 3)) {
        p->origin[p->axis] += p->size * signed_magnitude(seed, 1e-9, 1e-3);
    }
}

static void keep_direction(uint64_t *seed, const packet *p, const double from[3], double d[3]) {
    (void)from;
    for (int k = 0; k < 3; k++) {
        d[k] = p->direction[k] * (1.0 + p->spread * trace_rig_random_signed(seed));
    }
}

static void turn_direction(uint64_t *seed, const packet *p, const double from[3], double d[3]) {
    (void)from;
    for (int k = 0; k < 3; k++) {
        d[k] = p->direction[k] + p->spread * trace_rig_random_signed(seed);
    }
}

/* At a corner of any triangle, or at a point of an edge. */
static void to_a_corner(uint64_t *seed, const packet *p, const double from[3], double d[3]) {
    const dev_triangle *t = &p->triangles[pick(seed, (int)p->count)];
    int c = pick(seed, 3);
    double share = pick(seed, 2) ? trace_rig_random(seed) : 0.0;
    for (int k = 0; k < 3; k++) {
        double a = coordinate(t, c, k), b = coordinate(t, (c + 1) % 3, k);
        d[k] = a + share * (b - a) - from[k];
    }
}

/* At a point of the packet's triangle, or just beside. */
static void to_own_triangle(uint64_t *seed, const packet *p, const double from[3], double d[3]) {
    double u = trace_rig_random(seed), v = trace_rig_random(seed) * (1.0 - u);
    double beside = pick(seed, 2) ? 1e-3 * p->spread * p->size : 0.0;
    for (int k = 0; k < 3; k++) {
        double a = coordinate(p->own, 0, k);
        d[k] = a + u * (coordinate(p->own, 1, k) - a) + v * (coordinate(p->own, 2, k) - a) -
               from[k] + beside * trace_rig_random_signed(seed);
    }
}

static const struct {
    const char *name;
    void (*place)(uint64_t *seed, packet *p);
    void (*aim)(uint64_t *seed, const packet *p, const double from[3], double d[3]);
} kinds[] = {
    {"along a face", along_a_face, keep_direction},
    {"at corners and edges", from_anywhere, to_a_corner},
    {"in a plane", from_own_plane, to_own_triangle},
    {"anywhere", from_anywhere, turn_direction},
};
#define KINDS (sizeof kinds / sizeof *kinds)

static void fill_packet(uint64_t *seed, const dev_triangle *triangles, size_t count,
                        dev_ray rays[PACKET]) {
    packet p = packet_begin(seed, triangles, count);
    size_t kind = (size_t)pick(seed, (int)KINDS);
    kinds[kind].place(seed, &p);
    for (int i = 0; i < PACKET; i++) {
        double from[3], d[3];
        for (int k = 0; k < 3; k++) {
            from[k] =
                exact_snap(p.origin[k] + p.drift * trace_rig_random_signed(seed), EXACT_LENGTH);
        }
        kinds[kind].aim(seed, &p, from, d);
        d[2] = d[0] == 0.0 && d[1] == 0.0 && d[2] == 0.0 ? 1.0 : d[2];
        rays[i] = trace_rig_ray(from, d);
        rays[i].source = (uint32_t)kind;
        for (int k = 0; k < 3; k++) {
            rays[i].direction[k] = exact_snap(rays[i].direction[k], EXACT_DIRECTION);
        }
    }
}

/* ---- judgement ------------------------------------------------------------------------------ */

/* Distances relative to R. */
typedef struct verdict {
    size_t rays, hits;
    size_t off;           /* hits farther than TOLERANCE from their triangles */
    size_t missed;        /* rays that miss a triangle, or meet one behind it */
    long double farthest; /* hit from its triangle */
    long double inside; /* most that a ray, seen to miss, keeps from a triangle's edges or plane */
} verdict;

/* Whether the hit is behind T's, or there is none, although the ray meets T. */
static bool passed_by(const dev_ray *ray, const dev_hit *hit, const dev_triangle *t,
                      long double reach, verdict *v) {
    exact_meeting m = exact_meet(ray, t);
    if (!m.inside || hit->t_m <= m.range + TOLERANCE * reach / m.sine) {
        return false;
    }
    long double clearance = fminl(exact_clearance(ray, t), m.range * m.sine) / reach;
    v->inside = fmaxl(v->inside, clearance);
    return clearance > TOLERANCE;
}

static void judge(const asdic_scene *scene, const dev_ray *ray, const dev_hit *hit, verdict *v) {
    long double reach = scene->bvh.extent_m;
    reach += fmaxf(fmaxf(fabsf(ray->origin[0]), fabsf(ray->origin[1])), fabsf(ray->origin[2]));
    v->rays++;
    if (hit->triangle != ~0u) {
        const dev_triangle *t = &scene->triangles[hit->triangle];
        long double off = exact_distance(ray, t, WIDER, hit->t_m) / reach;
        v->hits++;
        v->off += off > TOLERANCE;
        v->farthest = fmaxl(v->farthest, off);
    }
    bool missed = false;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        missed |= passed_by(ray, hit, &scene->triangles[i], reach, v);
    }
    v->missed += missed;
}

/* Scenes of one shape, every fourth up to 100 km from the origin. */
static void try_shape(const char *name,
                      size_t (*make)(uint64_t *seed, const double at[3], dev_triangle *out)) {
    verdict verdicts[KINDS] = {{0}};
    dev_ray *rays = calloc(RAYS, sizeof *rays);
    dev_hit *hits = calloc(RAYS, sizeof *hits), *every = calloc(RAYS, sizeof *every);
    assert_true(rays && hits && every);
    uint64_t seed = 1;
    for (int i = 0; i < scenes / 4; i++) {
        dev_triangle triangles[MOST];
        double at[3], away = i % 4 == 3 ? magnitude(&seed, 1e3, 1e5) : 0.0;
        for (int k = 0; k < 3; k++) {
            at[k] = away * trace_rig_random_signed(&seed);
        }
        size_t count = make(&seed, at, triangles);
        for (int n = 0; n < RAYS; n += PACKET) {
            fill_packet(&seed, triangles, count, &rays[n]);
        }
        asdic_scene *scene = trace_rig_scene(&rig, triangles, count);
        trace_rig_run_all_forms(&rig, scene, rays, RAYS, hits);
        if (i % 16 == 0) { /* what no node's box may hide */
            trace_rig_run_all_blocks(&rig, scene, rays, RAYS, every);
            assert_memory_equal(hits, every, RAYS * sizeof *hits);
        }
        for (int n = 0; n < RAYS; n++) {
            judge(scene, &rays[n], &hits[n], &verdicts[rays[n].source]);
        }
        asdic_scene_destroy(&scene);
    }
    free(rays);
    free(hits);
    free(every);
    size_t wrong = 0;
    for (size_t k = 0; k < KINDS; k++) {
        verdict *v = &verdicts[k];
        print_message(
            "%-8s %-20s %7zu rays %7zu hits: off by %.3Lg of 2^-21 R at most, %zu by more "
            "than that; %zu missed (others by %.3Lg of it at most)\n",
            name, kinds[k].name, v->rays, v->hits, v->farthest / TOLERANCE, v->off, v->missed,
            v->inside / TOLERANCE);
        assert_true(v->hits > v->rays / 2000); /* the rays are worth something */
        wrong += v->off + v->missed;
    }
    assert_int_equal(wrong, 0);
}

static void ranges_of_ramps(void **state) {
    (void)state;
    try_shape("ramps", ramps);
}

static void ranges_of_boxes(void **state) {
    (void)state;
    try_shape("boxes", boxes);
}

static void ranges_of_slivers(void **state) {
    (void)state;
    try_shape("slivers", slivers);
}

static void ranges_of_soup(void **state) {
    (void)state;
    try_shape("soup", soup);
}

int main(int argc, char **argv) {
    scenes = argc > 1 && strcmp(argv[1], "full") == 0 ? SCENES_FULL : SCENES;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ranges_of_ramps),
        cmocka_unit_test(ranges_of_boxes),
        cmocka_unit_test(ranges_of_slivers),
        cmocka_unit_test(ranges_of_soup),
    };
    rig = test_device_open_or_skip();
    return test_device_end(&rig, cmocka_run_group_tests(tests, NULL, NULL));
}
