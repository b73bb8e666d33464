/* Scenes beside Embree: a sea floor of a kilometre, a body over a flat one, a small one. */
#include "beside.h"

#include <math.h>
#include <stdlib.h>

#define PI 3.14159265358979323846

/* A mesh as it grows. */
typedef struct shape {
    double *vertices_m;
    uint32_t *indices;
    size_t vertices, triangles;
} shape;

static uint32_t add_vertex(shape *s, double x, double y, double z) {
    double *v = &s->vertices_m[3 * s->vertices];
    v[0] = x;
    v[1] = y;
    v[2] = z;
    return (uint32_t)s->vertices++;
}

static void add_triangle(shape *s, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *index = &s->indices[3 * s->triangles++];
    index[0] = a;
    index[1] = b;
    index[2] = c;
}

/* A bumpy ball of RINGS x 2 RINGS facets round (X, 0, Z). */
static void add_ball(shape *s, unsigned rings, double radius_m, double x, double z) {
    unsigned round = 2 * rings;
    uint32_t first = (uint32_t)s->vertices;
    for (unsigned i = 0; i <= rings; i++) {
        for (unsigned j = 0; j < round; j++) {
            double theta = PI * i / rings, phi = 2.0 * PI * j / round;
            double bumps = 0.1 * sin(7.0 * theta) * cos(5.0 * phi) +
                           0.02 * sin(40.0 * theta) * sin(33.0 * phi);
            double r = radius_m * (1.0 + bumps);
            add_vertex(s, x + r * sin(theta) * cos(phi), r * sin(theta) * sin(phi),
                       z + r * cos(theta));
        }
    }
    for (unsigned i = 0; i < rings; i++) {
        for (unsigned j = 0; j < round; j++) {
            uint32_t a = first + i * round + j, b = first + i * round + (j + 1) % round;
            if (i > 0) {
                add_triangle(s, a, a + round, b);
            }
            if (i + 1 < rings) {
                add_triangle(s, a + round, b + round, b);
            }
        }
    }
}

/* A level floor of SIDE_M, CELLS x CELLS squares. */
static void add_floor(shape *s, unsigned cells, double side_m, double depth_m) {
    uint32_t first = (uint32_t)s->vertices;
    for (unsigned i = 0; i <= cells; i++) {
        for (unsigned j = 0; j <= cells; j++) {
            add_vertex(s, side_m * (1.0 * i / cells - 0.5), side_m * (1.0 * j / cells - 0.5),
                       depth_m);
        }
    }
    for (unsigned i = 0; i < cells; i++) {
        for (unsigned j = 0; j < cells; j++) {
            uint32_t a = first + i * (cells + 1) + j, b = a + cells + 1;
            add_triangle(s, a, b, a + 1);
            add_triangle(s, b, b + 1, a + 1);
        }
    }
}

static asdic_status commit_shape(const bench *b, const shape *s, asdic_scene **out) {
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_from_triangles(cli_context(b->c), s->vertices_m, s->vertices,
                                                    s->indices, s->triangles, &mesh);
    if (!status) {
        status = bench_ray_scene_commit(b, mesh, out);
    }
    asdic_mesh_destroy(&mesh);
    return status;
}

/* A ball of RINGS over a floor of CELLS. */
static asdic_status make_body(const bench *b, unsigned rings, unsigned cells, asdic_scene **out) {
    size_t most = (size_t)(rings + 1) * 2 * rings + (size_t)(cells + 1) * (cells + 1);
    shape s = {.vertices_m = malloc(3 * most * sizeof(double)),
               .indices = malloc(6 * most * sizeof(uint32_t))};
    asdic_status status = ASDIC_ERROR_MEMORY;
    if (s.vertices_m && s.indices) {
        bool small = rings < 100;
        add_ball(&s, rings, small ? 4.0 : 6.0, small ? 20.0 : 30.0, small ? 8.0 : 15.0);
        add_floor(&s, cells, small ? 200.0 : 400.0, small ? 12.0 : 20.0);
        status = commit_shape(b, &s, out);
    }
    free(s.vertices_m);
    free(s.indices);
    return status;
}

asdic_status beside_scene(const bench *b, size_t index, bench_ray_scene *out) {
    *out = (bench_ray_scene){.scene = NULL};
    if (index == 0) {
        return bench_ray_scene_terrain(b, out);
    }
    bool small = index == 2;
    snprintf(out->name, sizeof out->name, "%s", small ? "small" : "object");
    TRY(small ? make_body(b, 20, 10, &out->scene)
              : make_body(b, b->quick ? 100 : 158, 1, &out->scene));
    if (small) {
        bench_ray_scene_look(out, (asdic_vec3){0.0, 0.0, 4.0}, 0.2);
    } else {
        bench_ray_scene_look(out, (asdic_vec3){5.0, 0.0, 5.0}, 0.3);
    }
    return ASDIC_OK;
}

float *beside_corners(const bench_ray_scene *s, size_t *count) {
    *count = asdic_scene_get_info(s->scene).triangles;
    float *corners = malloc((9 * *count + 1) * sizeof *corners);
    for (size_t i = 0; corners && i < *count; i++) {
        asdic_scene_triangle(s->scene, i, &corners[9 * i]);
    }
    return corners;
}
