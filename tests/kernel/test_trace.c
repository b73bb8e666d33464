/*
 * The walk of the hierarchy against testing every block, and against double precision.
 */
#include "trace_rig.h"

#include <stdlib.h>
#include <string.h>

#define SOUP 600
#define RAYS 4096

static test_device rig;

/* Triangles of all sizes in a cube of 20 m; every 16th is degenerate, every 8th axis-aligned. */
static void random_soup(uint64_t seed, dev_triangle *soup, size_t count) {
    for (size_t i = 0; i < count; i++) {
        float v[3][3];
        double size = pow(10.0, 1.5 * trace_rig_random_signed(&seed));
        double centre[3];
        for (int k = 0; k < 3; k++) {
            centre[k] = 10.0 * trace_rig_random_signed(&seed);
        }
        for (int c = 0; c < 3; c++) {
            for (int k = 0; k < 3; k++) {
                bool flat = i % 8 == 3 && k == (int)(i / 8 % 3);
                v[c][k] = (float)(centre[k] + (flat ? 0.0 : size * trace_rig_random_signed(&seed)));
            }
        }
        if (i % 16 == 5) { /* a needle, or a point */
            memcpy(v[2], v[i % 32 == 5 ? 0 : 1], sizeof v[2]);
            memcpy(v[1], v[i % 64 == 5 ? 0 : 1], sizeof v[1]);
        }
        soup[i] = trace_rig_triangle(v[0], v[1], v[2]);
    }
}

/* A third towards random points, a third along axes, a third in the plane of a triangle. */
static void random_rays(uint64_t seed, const dev_triangle *soup, size_t soup_count, dev_ray *rays,
                        size_t count) {
    for (size_t i = 0; i < count; i++) {
        const dev_triangle *t = &soup[i % soup_count];
        double origin[3], direction[3];
        for (int k = 0; k < 3; k++) {
            origin[k] = 25.0 * trace_rig_random_signed(&seed);
            direction[k] = 10.0 * trace_rig_random_signed(&seed) - origin[k];
            if (i % 3 == 1) {
                direction[k] = k == (int)(i / 3 % 3) ? (i % 2 ? 1.0 : -1.0) : 0.0;
                origin[k] = i % 4 == 1 ? t->v0[k] - 30.0 * direction[k] : origin[k] * 0.4;
            } else if (i % 3 == 2) {
                direction[k] = 0.3 * t->v1[k] + 0.7 * t->v2[k] - t->v0[k];
                origin[k] = t->v0[k] - 5.0 * direction[k];
            }
        }
        if (direction[0] == 0.0 && direction[1] == 0.0 && direction[2] == 0.0) {
            direction[2] = 1.0;
        }
        rays[i] = trace_rig_ray(origin, direction);
        rays[i].t_max = i % 5 == 4 ? 20.0f : INFINITY;
    }
}

static void walk_equals_every_block(void **state) {
    (void)state;
    dev_triangle soup[SOUP];
    dev_ray *rays = calloc(RAYS, sizeof *rays);
    dev_hit *walked = calloc(RAYS, sizeof *walked), *all = calloc(RAYS, sizeof *all);
    assert_true(rays && walked && all);
    size_t met = 0;
    for (uint64_t seed = 1; seed <= 2; seed++) {
        random_soup(seed, soup, SOUP);
        random_rays(seed + 100, soup, SOUP, rays, RAYS);
        asdic_scene *scene = trace_rig_scene(&rig, soup, SOUP);
        trace_rig_run_all_forms(&rig, scene, rays, RAYS, walked);
        trace_rig_run_all_blocks(&rig, scene, rays, RAYS, all);
        for (size_t i = 0; i < RAYS; i++) {
            assert_memory_equal(&walked[i], &all[i], sizeof walked[i]);
            met += walked[i].triangle != ~0u;
            assert_true(walked[i].triangle == ~0u ? isinf(walked[i].t_m)
                                                  : walked[i].t_m <= rays[i].t_max);
        }
        asdic_scene_destroy(&scene);
    }
    assert_in_range(met, RAYS / 2, 2 * RAYS - 1); /* the rays are worth something */
    free(rays);
    free(walked);
    free(all);
}

/* Coherent rays, as a sonar casts them, over a bumpy bottom: the packets' own ground, with counts
 * that fill no packet, skipped rays, and rays that are no rays. */
static void forms_agree_on_cones(void **state) {
    (void)state;
    enum { SIDE = 40, COUNT = 6001 };
    dev_triangle *bottom = malloc(2 * SIDE * SIDE * sizeof *bottom);
    dev_ray *rays = calloc(COUNT, sizeof *rays);
    dev_hit *hits = calloc(COUNT, sizeof *hits);
    assert_true(bottom && rays && hits);
    for (int i = 0; i < SIDE * SIDE; i++) {
        float v[4][3];
        for (int c = 0; c < 4; c++) {
            int x = i / SIDE + (c == 1 || c == 2), y = i % SIDE + (c >= 2);
            v[c][0] = (float)(x - SIDE / 2);
            v[c][1] = (float)(y - SIDE / 2);
            v[c][2] = 10.0f + (float)sin(0.8 * x) * (float)cos(0.5 * y);
        }
        bottom[2 * i] = trace_rig_triangle(v[0], v[1], v[2]);
        bottom[2 * i + 1] = trace_rig_triangle(v[2], v[3], v[0]);
    }
    asdic_scene *scene = trace_rig_scene(&rig, bottom, 2 * SIDE * SIDE);
    for (int kind = 0; kind < 7; kind++) {
        uint64_t seed = 21;
        for (int i = 0; i < COUNT; i++) {
            /* narrow, wide, across the axes and diagonals; moving origins, which end, whose directions are
             * long (rays that bend are lifted). Eight by eight rays make a packet of 64 that is narrow both ways. */
            double spread = kind == 0 ? 0.05 : kind == 1 ? 0.5 : 3.0;
            double origin[3] = {0.3, -0.2, 1.0};
            int row = i / 640 * 8 + i % 64 / 8, column = i / 64 % 10 * 8 + i % 8;
            double direction[3] = {spread * (row - 38.4) / 37.0 + (kind == 1 ? 0.6 : 0.0),
                                   spread * (column - 40.3) / 40.0, 1.0};
            for (int k = 0; k < 3; k++) {
                origin[k] += kind >= 3 ? 0.01 * kind * trace_rig_random_signed(&seed) : 0.0;
            }
            rays[i] = trace_rig_ray(origin, direction);
            rays[i].t_max = kind == 4 && i % 3 ? 0.0f
                            : kind == 5        ? 9.5f
                            : kind == 6        ? 6.3f
                                               : INFINITY;
            for (int k = 0; kind == 6 && k < 3; k++) {
                rays[i].direction[k] *= 1.5f;
            }
            if (kind == 5 && i % 50 == 7) {
                rays[i].direction[i % 3] = NAN;
            }
        }
        static const uint32_t counts[] = {COUNT, 1, 15, 16, 17, 63, 64, 65, 1000};
        for (size_t c = 0; c < sizeof counts / sizeof *counts; c++) {
            trace_rig_run_all_forms(&rig, scene, rays, counts[c], hits);
        }
        if (kind == 0) {
            assert_int_not_equal(hits[0].triangle, ~0u);
        }
    }
    asdic_scene_destroy(&scene);
    free(bottom);
    free(rays);
    free(hits);
}

/* Plane and barycentric coordinates in double; *MARGIN is the smallest of the three. */
static double meet(const dev_ray *r, const dev_triangle *t, double *margin) {
    double e1[3], e2[3], s[3], n[3], q[3];
    for (int k = 0; k < 3; k++) {
        e1[k] = (double)t->v1[k] - t->v0[k];
        e2[k] = (double)t->v2[k] - t->v0[k];
        s[k] = (double)t->v0[k] - r->origin[k];
    }
    for (int k = 0; k < 3; k++) {
        int a = (k + 1) % 3, b = (k + 2) % 3;
        n[k] = e1[a] * e2[b] - e1[b] * e2[a];
        q[k] = s[a] * r->direction[b] - s[b] * r->direction[a];
    }
    double det = 0.0, u = 0.0, v = 0.0, d = 0.0;
    for (int k = 0; k < 3; k++) {
        det += n[k] * r->direction[k];
        d += n[k] * s[k];
        u += q[k] * e2[k];
        v -= q[k] * e1[k];
    }
    u /= det;
    v /= det;
    *margin = det == 0.0 ? -1.0 : fmin(fmin(u, v), 1.0 - u - v);
    return d / det;
}

static void hits_are_right(void **state) {
    (void)state;
    dev_triangle soup[SOUP];
    dev_ray *rays = calloc(RAYS, sizeof *rays);
    dev_hit *hits = calloc(RAYS, sizeof *hits);
    assert_true(rays && hits);
    random_soup(7, soup, SOUP);
    random_rays(8, soup, SOUP, rays, RAYS);
    asdic_scene *scene = trace_rig_scene(&rig, soup, SOUP);
    trace_rig_run_all_forms(&rig, scene, rays, RAYS, hits);
    for (size_t i = 0; i < RAYS; i += 3) { /* those towards random points: no knife edges */
        double nearest = rays[i].t_max;
        bool doubtful = false;
        for (size_t k = 0; k < SOUP; k++) {
            double margin, t = meet(&rays[i], &soup[k], &margin);
            doubtful |= t > 0.0 && t < nearest && fabs(margin) < 1e-4;
            nearest = margin >= 1e-4 && t > 0.0 && t < nearest ? t : nearest;
        }
        if (!doubtful) {
            double expected = nearest < rays[i].t_max ? nearest : INFINITY;
            assert_close(hits[i].t_m, expected, 1e-4 + 1e-5 * expected);
        }
    }
    asdic_scene_destroy(&scene);
    free(rays);
    free(hits);
}

/* The order in which triangles come, hence the shape of the tree and its leaves, must not show. */
static void order_does_not_matter(void **state) {
    (void)state;
    dev_triangle soup[SOUP], shuffled[SOUP];
    uint32_t from[SOUP];
    dev_ray *rays = calloc(RAYS, sizeof *rays);
    dev_hit *first = calloc(RAYS, sizeof *first), *second = calloc(RAYS, sizeof *second);
    assert_true(rays && first && second);
    random_soup(11, soup, SOUP);
    random_rays(12, soup, SOUP, rays, RAYS);
    uint64_t seed = 13;
    for (uint32_t i = 0; i < SOUP; i++) {
        uint32_t j = (uint32_t)(trace_rig_random(&seed) * (i + 1));
        from[i] = from[j];
        from[j] = i;
    }
    for (uint32_t i = 0; i < SOUP; i++) {
        shuffled[i] = soup[from[i]];
    }
    asdic_scene *a = trace_rig_scene(&rig, soup, SOUP);
    asdic_scene *b = trace_rig_scene(&rig, shuffled, SOUP);
    trace_rig_run_all_forms(&rig, a, rays, RAYS, first);
    trace_rig_run_all_forms(&rig, b, rays, RAYS, second);
    for (size_t i = 0; i < RAYS; i++) {
        assert_memory_equal(&first[i].t_m, &second[i].t_m, sizeof first[i].t_m);
    }
    asdic_scene_destroy(&a);
    asdic_scene_destroy(&b);
    free(rays);
    free(first);
    free(second);
}

static void empty_scene_and_skipped_rays(void **state) {
    (void)state;
    const float v[3][3] = {{-1, -1, 5}, {1, -1, 5}, {0, 2, 5}};
    dev_triangle one = trace_rig_triangle(v[0], v[1], v[2]);
    const double origin[3] = {0, 0, 0}, down[3] = {0, 0, 1};
    dev_ray rays[4];
    for (int i = 0; i < 4; i++) {
        rays[i] = trace_rig_ray(origin, down);
    }
    rays[1].t_max = 0.0f; /* skipped */
    rays[2].t_max = 4.99f;
    rays[3].t_max = 5.0f; /* the limit is inclusive */
    dev_hit hits[4];
    asdic_scene *scene = trace_rig_scene(&rig, &one, 0);
    trace_rig_run_all_forms(&rig, scene, rays, 4, hits);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(hits[i].triangle, ~0u);
        assert_true(isinf(hits[i].t_m));
    }
    asdic_scene_destroy(&scene);
    scene = trace_rig_scene(&rig, &one, 1);
    trace_rig_run_all_forms(&rig, scene, rays, 4, hits);
    assert_close(hits[0].t_m, 5.0, 0.0);
    assert_int_equal(hits[0].triangle, 0);
    assert_int_equal(hits[1].triangle, ~0u);
    assert_int_equal(hits[2].triangle, ~0u);
    assert_int_equal(hits[3].triangle, 0);
    asdic_scene_destroy(&scene);
}

/* Copies of one triangle, spread over ten leaves: the lowest id. */
static void ties_go_to_the_lowest_id(void **state) {
    (void)state;
    enum { COPIES = 37 };
    dev_triangle copies[COPIES];
    for (int i = 0; i < COPIES; i++) {
        const float v[3][3] = {{-2, -2, 5}, {2, -2, 5}, {0, 4, 5}};
        copies[i] = trace_rig_triangle(v[0], v[1], v[2]);
    }
    const double origin[3] = {0.1, 0.2, 0}, down[3] = {0, 0, 1};
    dev_ray ray = trace_rig_ray(origin, down);
    dev_hit hit;
    asdic_scene *scene = trace_rig_scene(&rig, copies, COPIES);
    trace_rig_run_all_forms(&rig, scene, &ray, 1, &hit);
    assert_int_equal(hit.triangle, 0);
    assert_close(hit.t_m, 5.0, 0.0);
    asdic_scene_destroy(&scene);
}

/* A tracer that is to choose, and what it says. */
typedef struct choices {
    asdic_tracer *tracer;
    asdic_scene *scene;
    asdic_buffer *rays, *hits;
    int chosen, compiled; /* forms; programs for packets */
} choices;

static void count_choice(void *user, asdic_log_level level, const char *message) {
    choices *c = user;
    (void)level;
    c->chosen += strncmp(message, "ray kernel: ", 12) == 0;
    c->compiled += strncmp(message, "compiling kernels/trace_packets.cl", 34) == 0;
}

static void start_choices(choices *c) {
    static dev_ray rays[RAYS];
    const float v[3][3] = {{-2, -2, 5}, {2, -2, 5}, {0, 4, 5}};
    const double origin[3] = {0, 0, 0}, down[3] = {0, 0, 1};
    dev_triangle one = trace_rig_triangle(v[0], v[1], v[2]);
    *c = (choices){.scene = trace_rig_scene(&rig, &one, 1)};
    /* A device of its own: nothing is compiled for it yet. */
    asdic_devices_close(&rig.devices, rig.count);
    assert_ok(rig.ctx,
              asdic_devices_open(rig.ctx, getenv("ASDIC_DEVICE"), &rig.devices, &rig.count));
    asdic_device *device = rig.device = rig.devices[0];
    for (int i = 0; i < RAYS; i++) {
        rays[i] = trace_rig_ray(origin, down);
    }
    assert_ok(rig.ctx, asdic_tracer_create(device, c->scene, &c->tracer));
    assert_ok(rig.ctx, asdic_buffer_create(device, sizeof rays, rays, &c->rays));
    assert_ok(rig.ctx, asdic_buffer_create(device, RAYS * sizeof(dev_hit), NULL, &c->hits));
    asdic_context_set_log(rig.ctx, ASDIC_LOG_DEBUG, count_choice, c);
}

static void cast_once(choices *c, uint32_t leg) {
    assert_ok(rig.ctx, asdic_tracer_run(c->tracer, c->rays, c->hits, RAYS, RAYS, leg));
}

static void end_choices(choices *c) {
    asdic_context_set_log(rig.ctx, ASDIC_LOG_ERROR, NULL, NULL);
    asdic_buffer_destroy(&c->hits);
    asdic_buffer_destroy(&c->rays);
    asdic_tracer_destroy(&c->tracer);
    asdic_scene_destroy(&c->scene);
}

/* Through layers the same buffer holds other rays at each leg: a form is chosen for each of the first ones, once. */
static void legs_choose_for_themselves(void **state) {
    (void)state;
    static const uint32_t legs[] = {0, 1, 1, 0, 70, 200};
    choices c;
    start_choices(&c);
    for (size_t i = 0; i < sizeof legs / sizeof *legs; i++) {
        cast_once(&c, legs[i]);
    }
    assert_int_equal(c.chosen, 3);
    end_choices(&c);
}

/* A driver without a cache compiles what casts few rays, and the rest once there were many. */
static void few_rays_do_not_choose(void **state) {
    (void)state;
    enum { FEW = 10 };
    choices c;
    start_choices(&c);
    asdic_tracer_wait(c.tracer, FEW * RAYS);
    for (int i = 0; i < FEW; i++) {
        cast_once(&c, 0);
    }
    assert_int_equal(c.chosen, 0);
    assert_int_equal(c.compiled, 0);
    cast_once(&c, 0);
    cast_once(&c, 0);
    assert_int_equal(c.chosen, 1);
    assert_true(c.compiled > 0 || strcmp(asdic_tracer_form(c.tracer, c.rays), "scalar") == 0);
    end_choices(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walk_equals_every_block),
        cmocka_unit_test(forms_agree_on_cones),
        cmocka_unit_test(hits_are_right),
        cmocka_unit_test(order_does_not_matter),
        cmocka_unit_test(empty_scene_and_skipped_rays),
        cmocka_unit_test(ties_go_to_the_lowest_id),
        cmocka_unit_test(legs_choose_for_themselves),
        cmocka_unit_test(few_rays_do_not_choose),
    };
    rig = test_device_open_or_skip();
    return test_device_end(&rig, cmocka_run_group_tests(tests, NULL, NULL));
}
