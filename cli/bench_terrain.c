/* A rough sea floor of any size: a sum of waves whose heights fall with their lengths. */
#include "bench_pings.h"

#include <math.h>
#include <stdlib.h>

#define SIDE_M 1000.0
#define DEPTH_M 200.0
#define OCTAVES 9

double bench_height_m(double x, double y) {
    double sum = 0.0, length_m = 250.0, high_m = 12.0;
    for (int k = 0; k < OCTAVES; k++) {
        /* Directions a golden angle apart never line up. */
        double angle = 2.39996 * k, u = x * cos(angle) + y * sin(angle);
        double v = y * cos(angle) - x * sin(angle);
        sum += high_m * sin(6.2832 * u / length_m + k) * cos(6.2832 * v / (1.3 * length_m));
        length_m *= 0.55;
        high_m *= 0.5;
    }
    return sum;
}

static void fill(size_t cells, double *vertices, uint32_t *indices) {
    size_t side = cells + 1, n = 0;
    for (size_t i = 0; i < side * side; i++) {
        double x = SIDE_M * ((double)(i / side) / (double)cells - 0.5);
        double y = SIDE_M * ((double)(i % side) / (double)cells - 0.5);
        vertices[3 * i] = x;
        vertices[3 * i + 1] = y;
        vertices[3 * i + 2] = DEPTH_M - bench_height_m(x, y) + bench_height_m(-0.4 * SIDE_M, 0.0);
    }
    for (size_t i = 0; i < cells * cells; i++) {
        uint32_t a = (uint32_t)(i / cells * side + i % cells), b = a + (uint32_t)side;
        const uint32_t corners[6] = {a, b, a + 1, b, b + 1, a + 1};
        for (int k = 0; k < 6; k++) {
            indices[n++] = corners[k];
        }
    }
}

static asdic_status make_scene(const asdic_mesh *mesh, unsigned threads, asdic_scene *scene) {
    asdic_scene_set_surface(scene, false);
    asdic_scene_set_threads(scene, threads);
    TRY(asdic_scene_add_bottom(scene, mesh, (asdic_pose){{0.0, 0.0, 0.0}, 0.0, 0.0, 0.0},
                               asdic_material_facet(6.0, 1e-3, 0.3)));
    return asdic_scene_commit(scene);
}

asdic_status bench_terrain(asdic_context *ctx, size_t triangles, unsigned threads,
                           asdic_scene **out) {
    size_t cells = (size_t)fmax(floor(sqrt(0.5 * (double)triangles)), 1.0);
    size_t points = (cells + 1) * (cells + 1);
    double *vertices = malloc(3 * points * sizeof *vertices);
    uint32_t *indices = malloc(6 * cells * cells * sizeof *indices);
    asdic_mesh *mesh = NULL;
    *out = NULL;
    asdic_status status = vertices && indices ? asdic_scene_create(ctx, out) : ASDIC_ERROR_MEMORY;
    if (!status) {
        fill(cells, vertices, indices);
        status =
            asdic_mesh_from_triangles(ctx, vertices, points, indices, 2 * cells * cells, &mesh);
    }
    status = status ? status : make_scene(mesh, threads, *out);
    if (status) {
        asdic_scene_destroy(out);
    }
    asdic_mesh_destroy(&mesh);
    free(vertices);
    free(indices);
    return status;
}
