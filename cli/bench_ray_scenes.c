/* The scenes of `asdic bench rays`: a sea floor of a kilometre, a body over a flat one, a small one. */
#include "bench_pings.h"
#include "bench_rays.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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

static asdic_status commit_mesh(cli *c, const asdic_mesh *mesh, unsigned threads,
                                asdic_scene **out) {
    asdic_status status = asdic_scene_create(cli_context(c), out);
    if (!status) {
        asdic_scene_set_surface(*out, false);
        asdic_scene_set_threads(*out, threads);
        status = asdic_scene_add_bottom(*out, mesh, (asdic_pose){{0.0, 0.0, 0.0}, 0.0, 0.0, 0.0},
                                        asdic_material_bottom(2.0));
    }
    return status ? status : asdic_scene_commit(*out);
}

static asdic_status commit_shape(cli *c, const shape *s, unsigned threads, asdic_scene **out) {
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_from_triangles(cli_context(c), s->vertices_m, s->vertices,
                                                    s->indices, s->triangles, &mesh);
    status = status ? status : commit_mesh(c, mesh, threads, out);
    asdic_mesh_destroy(&mesh);
    return status;
}

/* A ball of RINGS over a floor of CELLS. */
static asdic_status make_body(cli *c, unsigned rings, unsigned cells, unsigned threads,
                              asdic_scene **out) {
    size_t most = (size_t)(rings + 1) * 2 * rings + (size_t)(cells + 1) * (cells + 1);
    shape s = {.vertices_m = malloc(3 * most * sizeof(double)),
               .indices = malloc(6 * most * sizeof(uint32_t))};
    asdic_status status = ASDIC_ERROR_MEMORY;
    if (s.vertices_m && s.indices) {
        bool small = rings < 100;
        add_ball(&s, rings, small ? 4.0 : 6.0, small ? 20.0 : 30.0, small ? 8.0 : 15.0);
        add_floor(&s, cells, small ? 200.0 : 400.0, small ? 12.0 : 20.0);
        status = commit_shape(c, &s, threads, out);
    }
    free(s.vertices_m);
    free(s.indices);
    return status;
}

/* At world position AT_M, the cones PITCH_RAD down. */
static void look(bench_ray_scene *s, asdic_vec3 at_m, double pitch_rad) {
    asdic_vec3 o = asdic_scene_get_info(s->scene).origin_m;
    const double at[3] = {at_m.x - o.x, at_m.y - o.y, at_m.z - o.z};
    const double towards[3] = {cos(pitch_rad), 0.0, sin(pitch_rad)};
    for (int k = 0; k < 3; k++) {
        s->from_m[k] = (float)at[k];
        s->towards[k] = (float)towards[k];
    }
}

asdic_status bench_ray_scene_make(cli *c, size_t index, bool quick, unsigned threads,
                                  bench_ray_scene *out) {
    static const char *const names[BENCH_RAY_SCENES] = {"terrain", "object", "small"};
    *out = (bench_ray_scene){.scene = NULL};
    snprintf(out->name, sizeof out->name, "%s", names[index]);
    asdic_status status;
    if (index == 0) {
        status = bench_terrain(cli_context(c), quick ? 20000 : 1000000, threads, &out->scene);
    } else if (index == 1) {
        status = make_body(c, quick ? 100 : 158, 1, threads, &out->scene);
    } else {
        status = make_body(c, 20, 10, threads, &out->scene);
    }
    if (status) {
        asdic_scene_destroy(&out->scene);
        return status;
    }
    if (index == 0) {
        double altitude = asdic_scene_altitude_m(out->scene, (asdic_vec3){0.0, 0.0, 0.0});
        look(out, (asdic_vec3){0.0, 0.0, altitude - BENCH_ALTITUDE_M}, 0.6);
    } else if (index == 1) {
        look(out, (asdic_vec3){5.0, 0.0, 5.0}, 0.3);
    } else {
        look(out, (asdic_vec3){0.0, 0.0, 4.0}, 0.2);
    }
    return ASDIC_OK;
}

asdic_status bench_ray_scene_load(cli *c, const char *path, unsigned threads,
                                  bench_ray_scene *out) {
    asdic_mesh *mesh = NULL;
    *out = (bench_ray_scene){.scene = NULL};
    const char *slash = strrchr(path, '/');
    snprintf(out->name, sizeof out->name, "%.63s", slash ? slash + 1 : path);
    asdic_status status = asdic_mesh_load(cli_context(c), path, 1.0, false, &mesh);
    status = status ? status : commit_mesh(c, mesh, threads, &out->scene);
    if (status) {
        asdic_scene_destroy(&out->scene);
    } else {
        asdic_mesh_info info = asdic_mesh_get_info(mesh);
        asdic_vec3 size = {info.max_m.x - info.min_m.x, info.max_m.y - info.min_m.y,
                           info.max_m.z - info.min_m.z};
        double across = sqrt(size.x * size.x + size.y * size.y + size.z * size.z);
        asdic_vec3 at = {0.5 * (info.min_m.x + info.max_m.x) - 0.4 * across * cos(0.6),
                         0.5 * (info.min_m.y + info.max_m.y),
                         0.5 * (info.min_m.z + info.max_m.z) - 0.4 * across * sin(0.6)};
        look(out, at, 0.6);
    }
    asdic_mesh_destroy(&mesh);
    return status;
}

float *bench_ray_scene_corners(const bench_ray_scene *s, size_t *count) {
    *count = asdic_scene_get_info(s->scene).triangles;
    float *corners = malloc((9 * *count + 1) * sizeof *corners);
    for (size_t i = 0; corners && i < *count; i++) {
        asdic_scene_triangle(s->scene, i, &corners[9 * i]);
    }
    return corners;
}
