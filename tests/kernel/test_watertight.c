/*
 * No ray may slip between triangles that share an edge or a corner.
 */
#include "trace_rig.h"

#include <stdlib.h>
#include <string.h>

#define SIDE 200 /* cells of the terrain per side */
#define RAYS 200000

static test_device rig;

/* Height of a corner: hills of several wavelengths, and every eighth cell a terrace. */
static double terrain_z(int i, int j) {
    double z = 8.0 * sin(0.05 * i) * cos(0.07 * j) + 1.5 * sin(0.9 * i + 0.4 * j) +
               0.4 * sin(2.3 * i * 0.7 + 1.9 * j);
    return i / 8 % 4 == 0 ? 2.0 : z;
}

static void terrain_corner(int i, int j, double cell_m, float out[3]) {
    out[0] = (float)(cell_m * (i - SIDE / 2));
    out[1] = (float)(cell_m * (j - SIDE / 2));
    out[2] = (float)(100.0 + terrain_z(i, j));
}

/* JITTER_M moves each triangle's corners apart: files of unwelded triangles with rounded digits. */
static dev_triangle *terrain(double cell_m, double jitter_m, size_t *count) {
    dev_triangle *out = malloc(2 * SIDE * SIDE * sizeof *out);
    assert_non_null(out);
    uint64_t seed = 5;
    *count = 0;
    for (int i = 0; i < SIDE; i++) {
        for (int j = 0; j < SIDE; j++) {
            float v[4][3];
            terrain_corner(i, j, cell_m, v[0]);
            terrain_corner(i + 1, j, cell_m, v[1]);
            terrain_corner(i + 1, j + 1, cell_m, v[2]);
            terrain_corner(i, j + 1, cell_m, v[3]);
            for (int c = 0; c < 4; c++) {
                for (int k = 0; k < 3; k++) {
                    v[c][k] += (float)(jitter_m * trace_rig_random_signed(&seed));
                }
            }
            out[(*count)++] = trace_rig_triangle(v[0], v[1], v[2]);
            for (int k = 0; k < 3; k++) {
                v[2][k] += (float)(jitter_m * trace_rig_random_signed(&seed));
            }
            out[(*count)++] = trace_rig_triangle(v[2], v[3], v[0]);
        }
    }
    return out;
}

static size_t count_missed(const dev_triangle *triangles, size_t count, const dev_ray *rays) {
    dev_hit *hits = calloc(RAYS, sizeof *hits);
    assert_non_null(hits);
    asdic_scene *scene = trace_rig_scene(&rig, triangles, count);
    trace_rig_run_all_forms(&rig, scene, rays, RAYS, hits);
    size_t missed = 0;
    for (size_t i = 0; i < RAYS; i++) {
        missed += hits[i].triangle == ~0u;
    }
    asdic_scene_destroy(&scene);
    free(hits);
    return missed;
}

/* Rays from ORIGIN to inner corners of the terrain (every second one to the middle of an edge). */
static void aim_at_terrain(const double origin[3], double cell_m, dev_ray *rays) {
    uint64_t seed = 17;
    for (size_t n = 0; n < RAYS; n++) {
        int i = 1 + (int)(trace_rig_random(&seed) * (SIDE - 1));
        int j = 1 + (int)(trace_rig_random(&seed) * (SIDE - 1));
        int along = n % 2 ? (int)(trace_rig_random(&seed) * 3) : 3; /* x, y, diagonal, corner */
        float a[3], b[3];
        terrain_corner(i, j, cell_m, a);
        terrain_corner(i - (along == 0 || along == 2), j - (along == 1 || along == 2), cell_m, b);
        double share = n % 4 == 1 ? 0.5 : trace_rig_random(&seed), direction[3];
        for (int k = 0; k < 3; k++) {
            direction[k] = a[k] + share * ((double)b[k] - a[k]) - origin[k];
        }
        rays[n] = trace_rig_ray(origin, direction);
    }
}

static void terrain_is_closed(double cell_m, double jitter_m, const double origin[3]) {
    size_t count;
    dev_triangle *triangles = terrain(cell_m, jitter_m, &count);
    dev_ray *rays = calloc(RAYS, sizeof *rays);
    assert_non_null(rays);
    aim_at_terrain(origin, cell_m, rays);
    assert_int_equal(count_missed(triangles, count, rays), 0);
    free(rays);
    free(triangles);
}

static void corners_and_edges_of_terrain(void **state) {
    (void)state;
    const double above[3] = {3.3, -7.1, 0.0}, on_the_grid[3] = {0.0, 0.0, 50.0};
    terrain_is_closed(1.0, 0.0, above);
    terrain_is_closed(5.0, 0.0, on_the_grid);
}

static void grazing_rays(void **state) {
    (void)state;
    const double low[3] = {-90.0, 0.37, 89.5}, outside[3] = {-2000.0, 31.0, 20.0};
    terrain_is_closed(1.0, 0.0, low);
    terrain_is_closed(1.0, 0.0, outside);
}

static void corners_equal_to_seven_digits(void **state) {
    (void)state;
    const double above[3] = {3.3, -7.1, 0.0};
    terrain_is_closed(1.0, 1e-7, above);
}

static void corners_of_a_sphere_from_inside(void **state) {
    (void)state;
    asdic_mesh *mesh;
    asdic_scene *scene;
    assert_ok(rig.ctx, asdic_mesh_sphere(rig.ctx, 3.0, 90, &mesh));
    assert_int_equal(asdic_mesh_get_info(mesh).open_edges, 0);
    assert_ok(rig.ctx, asdic_scene_create(rig.ctx, &scene));
    asdic_pose far_away = {.position_m = {1e6, -4.5e6, 30.0}, .roll_rad = 0.3, .yaw_rad = 1.0};
    assert_ok(rig.ctx, asdic_scene_add_object(scene, "buoy", mesh, far_away,
                                              asdic_material_facet(45, 1e-3, 0.1)));
    assert_ok(rig.ctx, asdic_scene_commit(scene));
    dev_ray *rays = calloc(RAYS, sizeof *rays);
    assert_non_null(rays);
    uint64_t seed = 3;
    for (size_t n = 0; n < RAYS; n++) {
        const dev_triangle *t = &scene->triangles[n % scene->triangle_count];
        double share = n % 2 ? trace_rig_random(&seed) : 0.0, origin[3], direction[3];
        for (int k = 0; k < 3; k++) {
            origin[k] = 1.2 * trace_rig_random_signed(&seed);
            direction[k] = t->v0[k] + share * ((double)t->v1[k] - t->v0[k]) - origin[k];
        }
        rays[n] = trace_rig_ray(origin, direction);
    }
    assert_int_equal(count_missed(scene->triangles, scene->triangle_count, rays), 0);
    free(rays);
    asdic_scene_destroy(&scene);
    asdic_mesh_destroy(&mesh);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(corners_and_edges_of_terrain),
        cmocka_unit_test(grazing_rays),
        cmocka_unit_test(corners_equal_to_seven_digits),
        cmocka_unit_test(corners_of_a_sphere_from_inside),
    };
    rig = test_device_open_or_skip();
    return test_device_end(&rig, cmocka_run_group_tests(tests, NULL, NULL));
}
