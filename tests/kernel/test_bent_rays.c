/*
 * Hits of bent rays on terrain against the equation of rays, integrated by steps of Runge and Kutta across a
 * field of heights, which knows of no circles. And rays at the corners of that field.
 *
 *   test_bent_rays [CELLS]   along a side of the terrain: 708 make a million triangles
 */
#define ASDIC_BENT 1
#include "asserts.h"
#include "test_device.h"

#include "../../kernels/ray.h"

#include <asdic/asdic.h>

#include <math.h>
#include <stdlib.h>

#define SPEED 1480.0 /* m/s at the depth of the terrain's middle */
#define RAYS 1500
#define REACH 220.0

static test_device t;
static unsigned most_cells = 250;

static double draw(unsigned *state) {
    *state = *state * 1664525u + 1013904223u;
    return *state * 0x1p-32;
}

/* Heights over squares of CELL, z down about 0, a corner of the first at -SIDE / 2. */
typedef struct terrain {
    unsigned cells;
    double cell_m, half_m;
    float *z; /* (cells + 1)^2, x major */
} terrain;

static terrain rough_terrain(unsigned cells, double cell_m) {
    terrain r = {cells, cell_m, 0.5 * cells * cell_m, NULL};
    unsigned seed = 7, n = cells + 1;
    r.z = malloc((size_t)n * n * sizeof *r.z);
    for (unsigned i = 0; i < n * n; i++) {
        double x = (double)(i / n) * cell_m, y = (double)(i % n) * cell_m;
        r.z[i] = (float)(1.5 * sin(0.043 * x) * cos(0.031 * y) + 0.5 * sin(0.21 * x + 0.17 * y) +
                         0.1 * cell_m * draw(&seed));
    }
    return r;
}

static double height(const terrain *r, unsigned i, unsigned j) {
    return (double)r->z[i * (r->cells + 1) + j];
}

/* Each square is cut from (i + 1, j) to (i, j + 1). */
static asdic_scene *scene_of(const terrain *r) {
    unsigned n = r->cells + 1, squares = r->cells * r->cells;
    double *v = malloc((size_t)n * n * 3 * sizeof *v);
    uint32_t *index = malloc((size_t)squares * 6 * sizeof *index);
    for (unsigned i = 0; i < n * n; i++) {
        v[3 * i] = (double)(i / n) * r->cell_m - r->half_m;
        v[3 * i + 1] = (double)(i % n) * r->cell_m - r->half_m;
        v[3 * i + 2] = (double)r->z[i];
    }
    for (unsigned s = 0; s < squares; s++) {
        uint32_t a = s / r->cells * n + s % r->cells, b = a + n;
        const uint32_t corners[6] = {a, b, a + 1, b, b + 1, a + 1};
        for (int k = 0; k < 6; k++) {
            index[6 * s + (unsigned)k] = corners[k];
        }
    }
    asdic_mesh *mesh = NULL;
    asdic_scene *scene = NULL;
    assert_ok(t.ctx, asdic_mesh_from_triangles(t.ctx, v, (size_t)n * n, index, 2 * squares, &mesh));
    assert_ok(t.ctx, asdic_scene_create(t.ctx, &scene));
    assert_ok(t.ctx,
              asdic_scene_add_bottom(scene, mesh, (asdic_pose){0}, asdic_material_bottom(2.0)));
    assert_ok(t.ctx, asdic_scene_commit(scene));
    asdic_mesh_destroy(&mesh);
    free(index);
    free(v);
    return scene;
}

/* How far (x, y, z) lies above the terrain; INFINITY beyond its edges. */
static double above(const terrain *r, const double x[3]) {
    double u = (x[0] + r->half_m) / r->cell_m, v = (x[1] + r->half_m) / r->cell_m;
    if (!(u >= 0.0 && v >= 0.0 && u < r->cells && v < r->cells)) {
        return INFINITY;
    }
    unsigned i = (unsigned)u, j = (unsigned)v;
    double a = u - i, b = v - j, z;
    if (a + b <= 1.0) {
        z = height(r, i, j) * (1.0 - a - b) + height(r, i + 1, j) * a + height(r, i, j + 1) * b;
    } else {
        z = height(r, i + 1, j + 1) * (a + b - 1.0) + height(r, i + 1, j) * (1.0 - b) +
            height(r, i, j + 1) * (1.0 - a);
    }
    return z - x[2];
}

/* A place on a ray: point, direction, and the speed at its start times the travel time. */
typedef struct travel {
    double x[3], u[3], range;
} travel;

/* d/dl: du/dl = (u (u . grad c) - grad c) / c. */
static travel rate(const travel *at, double g, double start) {
    double c = SPEED + g * at->x[2];
    travel d = {.range = start / c};
    for (int k = 0; k < 3; k++) {
        d.x[k] = at->u[k];
        d.u[k] = (at->u[k] * g * at->u[2] - (k == 2 ? g : 0.0)) / c;
    }
    return d;
}

static travel moved(const travel *at, const travel *d, double step) {
    travel to = *at;
    for (int k = 0; k < 3; k++) {
        to.x[k] += step * d->x[k];
        to.u[k] += step * d->u[k];
    }
    to.range += step * d->range;
    return to;
}

static travel stepped(const travel *at, double g, double start, double step) {
    travel a = rate(at, g, start), to = moved(at, &a, 0.5 * step);
    travel b = rate(&to, g, start);
    to = moved(at, &b, 0.5 * step);
    travel c = rate(&to, g, start);
    to = moved(at, &c, step);
    travel d = rate(&to, g, start);
    to = moved(at, &a, step / 6.0);
    to = moved(&to, &b, step / 3.0);
    to = moved(&to, &c, step / 3.0);
    return moved(&to, &d, step / 6.0);
}

static travel begin(const asdic_ray *own) {
    travel at = {.range = 0.0};
    for (int k = 0; k < 3; k++) {
        at.x[k] = (double)own->origin_m[k];
        at.u[k] = (double)own->direction[k];
    }
    return at;
}

/* The range at which the ray first comes below the terrain; INFINITY: not within REACH. */
static double reference(const terrain *r, const asdic_ray *own, double g, double step) {
    travel at = begin(own);
    double start = SPEED + g * at.x[2];
    while (at.range < REACH) {
        travel to = stepped(&at, g, start, step);
        if (above(r, to.x) < 0.0) {
            double low = 0.0, high = step;
            for (int i = 0; i < 45; i++) {
                double middle = 0.5 * (low + high);
                to = stepped(&at, g, start, middle);
                *(above(r, to.x) < 0.0 ? &high : &low) = middle;
            }
            return to.range;
        }
        at = to;
    }
    return INFINITY;
}

/* How far off the terrain the ray is at a range. */
static double off_surface(const terrain *r, const asdic_ray *own, double g, double range) {
    enum { STEPS = 500 };
    travel at = begin(own);
    double start = SPEED + g * at.x[2];
    for (int i = 0; i < STEPS; i++) { /* what is left of the range, in what is left of the steps */
        double speed = SPEED + g * at.x[2];
        at = stepped(&at, g, start, (range - at.range) / (STEPS - i) * speed / start);
    }
    assert_close(at.range, range, 1e-5);
    return fabs(above(r, at.x));
}

/* Downwards, level, upwards; some exactly so. */
static void draw_rays(asdic_vec3 origin_m, asdic_ray *rays) {
    unsigned seed = 3;
    for (int i = 0; i < RAYS; i++) {
        double e = i % 50 == 0   ? 0.0
                   : i % 50 == 1 ? 1.5707963267948966
                                 : -0.06 + 0.4 * pow(draw(&seed), 3.0);
        double phi = 6.283185307179586 * draw(&seed), m = i % 50 == 1 ? 0.0 : cos(e);
        float d[3] = {(float)(m * cos(phi)), (float)(m * sin(phi)), (float)sin(e)};
        rays[i] = (asdic_ray){.origin_m = {(float)(3.3 - origin_m.x), (float)(-2.1 - origin_m.y),
                                           (float)(-5.5 - origin_m.z)},
                              .longest_m = (float)REACH,
                              .direction = {d[0], d[1], d[2]}};
    }
}

typedef struct off {
    double most_m; /* off the terrain */
    int met, late, apart;
} off;

/* Where a ray grazes an edge, the two may meet its two sides: both on the terrain, but centimetres apart. */
static void judge(const terrain *r, double g, const asdic_ray *own, double range, off *o) {
    double should = reference(r, own, g, 0.04);
    if (fabs(range - should) > 0.02 && !(isinf(range) && isinf(should))) {
        should = reference(r, own, g, 0.001); /* finer: the steps went over what sticks out */
    }
    if (isinf(range) && isinf(should)) {
        return;
    }
    o->met++;
    o->late += !(fabs(range - should) < 1e-3);
    o->apart += !(fabs(range - should) < 0.1);
    o->most_m = isinf(range) ? INFINITY : fmax(o->most_m, off_surface(r, own, g, range));
}

static off compare(const terrain *r, double g, const char *kernel) {
    asdic_scene *scene = scene_of(r);
    asdic_caster *caster = NULL;
    asdic_ray rays[RAYS];
    asdic_ray_hit hits[RAYS];
    off o = {0.0, 0, 0, 0};
    asdic_scene_info info = asdic_scene_get_info(scene);
    const double shift[3] = {info.origin_m.x, info.origin_m.y, info.origin_m.z};
    draw_rays(info.origin_m, rays);
    assert_ok(t.ctx, asdic_caster_create(t.ctx, t.device, scene, kernel, &caster));
    assert_ok(t.ctx, asdic_caster_bend(caster, SPEED + g * info.origin_m.z, g));
    assert_ok(t.ctx, asdic_caster_load(caster, rays, RAYS));
    assert_ok(t.ctx, asdic_caster_cast(caster));
    assert_ok(t.ctx, asdic_caster_read(caster, hits));
    for (int i = 0; i < RAYS; i++) {
        for (int k = 0; k < 3; k++) {
            rays[i].origin_m[k] = (float)((double)rays[i].origin_m[k] + shift[k]);
        }
        judge(r, g, &rays[i], (double)hits[i].range_m, &o);
    }
    asdic_caster_destroy(&caster);
    asdic_scene_destroy(&scene);
    return o;
}

static void hits_solve_the_equation(void **state) {
    /* Corners are floats without rounding, here as in the scene. */
    static const struct {
        double cell_m, gradient_per_s, most_m;
    } cases[] = {{0.0, -1.0, 1e-3},  {0.0, 1.0, 1e-3},  {0.0, 0.1, 1e-3},
                 {0.0, -1e-6, 1e-3}, {5.0, -1.0, 3e-3}, {5.0, 1.0, 3e-3}};
    (void)state;
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        double cell_m =
            cases[k].cell_m > 0.0 ? cases[k].cell_m : rint(420.0 / most_cells * 32.0) / 32.0;
        terrain r = rough_terrain((unsigned)(420.0 / cell_m + 0.5), cell_m);
        off o = compare(&r, cases[k].gradient_per_s, k % 2 ? "wide8" : "scalar");
        print_message(
            "%u triangles, cells of %.2g m, %g 1/s: %d hits within %.2g mm of the terrain, "
            "%d of them more than 1 mm of range apart, %d more than 0.1 m\n",
            2 * r.cells * r.cells, cell_m, cases[k].gradient_per_s, o.met, 1e3 * o.most_m, o.late,
            o.apart);
        assert_true(o.met > RAYS / 5 && o.most_m < cases[k].most_m);
        assert_true(o.late < 5 && o.apart == 0);
        free(r.z);
    }
}

/* The lifted triangles leave no gaps either: rays at their corners meet something there or before, from so high
 * above that none passes over a crest. */
static void no_corner_is_missed(void **state) {
    terrain r = rough_terrain(250, 1.6875);
    asdic_scene *scene = scene_of(&r);
    asdic_scene_info info = asdic_scene_get_info(scene);
    asdic_ray *rays = calloc((size_t)r.cells * r.cells, sizeof *rays);
    asdic_ray_hit *hits = calloc((size_t)r.cells * r.cells, sizeof *hits);
    (void)state;
    for (int k = 0; k < 4; k++) {
        double g = k % 2 ? 1.0 : -1.0;
        const ray_medium water = {g / SPEED, 1.0};
        const triple from = {3.3, -2.1, -150.5 - info.origin_m.z};
        asdic_caster *caster = NULL;
        size_t count = 0, missed = 0;
        for (unsigned i = 1; i < r.cells; i++) {
            for (unsigned j = 1; j < r.cells; j++) {
                triple to = {i * r.cell_m - r.half_m, j * r.cell_m - r.half_m,
                             height(&r, i, j) - info.origin_m.z};
                triple u = ray_between(from, to, water, 0.0).r.u;
                rays[count++] = (asdic_ray){{(float)from.x, (float)from.y, (float)from.z},
                                            INFINITY,
                                            {(float)u.x, (float)u.y, (float)u.z},
                                            0.0f};
            }
        }
        assert_ok(t.ctx, asdic_caster_create(t.ctx, t.device, scene, k / 2 ? "frustum64" : "wide8",
                                             &caster));
        assert_ok(t.ctx, asdic_caster_bend(caster, SPEED, g));
        assert_ok(t.ctx, asdic_caster_load(caster, rays, count));
        assert_ok(t.ctx, asdic_caster_cast(caster));
        assert_ok(t.ctx, asdic_caster_read(caster, hits));
        for (size_t i = 0; i < count; i++) {
            missed += hits[i].triangle == ASDIC_NO_TRIANGLE;
        }
        print_message("%g 1/s: %zu of %zu corners missed\n", g, missed, count);
        assert_true(missed == 0);
        asdic_caster_destroy(&caster);
    }
    asdic_scene_destroy(&scene);
    free(hits);
    free(rays);
    free(r.z);
}

/* Hits of rays that were not cast are none: neither those before the first cast, nor old ones. */
static void hits_are_of_rays_that_were_cast(void **state) {
    (void)state;
    asdic_scene *scene = NULL;
    asdic_mesh *box = NULL;
    asdic_caster *caster = NULL;
    asdic_ray_hit hit;
    const asdic_ray own = {{-5.0f, 0.0f, 0.0f}, INFINITY, {1.0f, 0.0f, 0.0f}, 0.0f};
    assert_ok(t.ctx, asdic_scene_create(t.ctx, &scene));
    assert_ok(t.ctx, asdic_mesh_box(t.ctx, (asdic_vec3){2.0, 2.0, 2.0}, &box));
    assert_ok(t.ctx, asdic_scene_add_object(scene, "box", box, (asdic_pose){.position_m = {0}},
                                            asdic_material_facet(45.0, 0.0, 0.0)));
    assert_ok(t.ctx, asdic_scene_commit(scene));
    assert_ok(t.ctx, asdic_caster_create(t.ctx, t.device, scene, "scalar", &caster));
    assert_status(t.ctx, asdic_caster_bend(caster, 999.0, 1.0), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_caster_bend(caster, SPEED, 30.1), ASDIC_ERROR_ARGUMENT);
    assert_status(t.ctx, asdic_caster_bend(caster, SPEED, NAN), ASDIC_ERROR_ARGUMENT);
    for (int bent = 0; bent < 2; bent++) {
        assert_ok(t.ctx, asdic_caster_bend(caster, SPEED, bent));
        assert_status(t.ctx, asdic_caster_cast(caster), ASDIC_ERROR_ARGUMENT);
        assert_ok(t.ctx, asdic_caster_load(caster, &own, 1));
        assert_status(t.ctx, asdic_caster_read(caster, &hit), ASDIC_ERROR_ARGUMENT);
        assert_ok(t.ctx, asdic_caster_cast(caster));
        assert_status(t.ctx, asdic_caster_read(caster, NULL), ASDIC_ERROR_ARGUMENT);
        assert_ok(t.ctx, asdic_caster_read(caster, &hit));
        assert_true(fabs((double)hit.range_m - 4.0) < 1e-3);
        assert_ok(t.ctx, asdic_caster_load(caster, &own, 1));
        assert_status(t.ctx, asdic_caster_read(caster, &hit), ASDIC_ERROR_ARGUMENT);
    }
    assert_string_equal(asdic_caster_kernel(NULL), "auto");
    asdic_caster_destroy(&caster);
    asdic_mesh_destroy(&box);
    asdic_scene_destroy(&scene);
}

int main(int argc, char **argv) {
    most_cells = argc > 1 ? (unsigned)atoi(argv[1]) : most_cells;
    t = test_device_open_or_skip();
    const struct CMUnitTest tests[] = {cmocka_unit_test(hits_solve_the_equation),
                                       cmocka_unit_test(no_corner_is_missed),
                                       cmocka_unit_test(hits_are_of_rays_that_were_cast)};
    return test_device_end(&t, cmocka_run_group_tests(tests, NULL, NULL));
}
