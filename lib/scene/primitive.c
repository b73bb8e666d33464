/*
 * Primitives, centred at the origin, facets wound counter-clockwise seen from outside.
 */
#include "mesh_build.h"

#include "base/try.h"

#include "../base/context.h"
#include "../base/vec.h"

#define MIN_SEGMENTS 3
#define MAX_SEGMENTS 4096

/* Fills a freshly allocated mesh one vertex and one facet at a time. */
typedef struct writer {
    asdic_mesh *mesh;
    size_t vertices, facets;
} writer;

static uint32_t put_vertex(writer *w, double x, double y, double z) {
    double *v = &w->mesh->vertices_m[3 * w->vertices];
    v[0] = x;
    v[1] = y;
    v[2] = z;
    return (uint32_t)w->vertices++;
}

static void put_facet(writer *w, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t *f = &w->mesh->indices[3 * w->facets++];
    f[0] = a;
    f[1] = b;
    f[2] = c;
}

static void put_quad(writer *w, uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    put_facet(w, a, b, c);
    put_facet(w, a, c, d);
}

static asdic_status check_length(asdic_context *ctx, const char *what, double length_m) {
    if (!(length_m > 0.0) || length_m > ASDIC_MESH_LIMIT_M) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s %g m is out of range (0, %g]", what,
                          length_m, ASDIC_MESH_LIMIT_M);
    }
    return ASDIC_OK;
}

static asdic_status check_segments(asdic_context *ctx, unsigned segments) {
    if (segments < MIN_SEGMENTS || segments > MAX_SEGMENTS) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%u segments are out of range [%d, %d]",
                          segments, MIN_SEGMENTS, MAX_SEGMENTS);
    }
    return ASDIC_OK;
}

static asdic_status complete(asdic_context *ctx, writer *w, asdic_mesh **out) {
    asdic_status status = asdic_mesh_complete_exact(ctx, w->mesh, "primitive");
    if (status != ASDIC_OK) {
        asdic_mesh_destroy(&w->mesh);
    }
    *out = w->mesh;
    return status;
}

asdic_status asdic_mesh_box(asdic_context *ctx, asdic_vec3 size_m, asdic_mesh **out) {
    if (!out) {
        return asdic_fail_null(ctx, __func__);
    }
    writer w = {0};
    *out = NULL;
    TRY(check_length(ctx, "the box's x size", size_m.x));
    TRY(check_length(ctx, "the box's y size", size_m.y));
    TRY(check_length(ctx, "the box's z size", size_m.z));
    TRY(asdic_mesh_allocate(ctx, 8, 12, &w.mesh));
    for (int i = 0; i < 8; i++) { /* bit 0: +x, bit 1: +y, bit 2: +z */
        put_vertex(&w, (i & 1 ? 0.5 : -0.5) * size_m.x, (i & 2 ? 0.5 : -0.5) * size_m.y,
                   (i & 4 ? 0.5 : -0.5) * size_m.z);
    }
    put_quad(&w, 0, 4, 6, 2); /* -x */
    put_quad(&w, 1, 3, 7, 5); /* +x */
    put_quad(&w, 0, 1, 5, 4); /* -y */
    put_quad(&w, 2, 6, 7, 3); /* +y */
    put_quad(&w, 0, 2, 3, 1); /* -z */
    put_quad(&w, 4, 5, 7, 6); /* +z */
    return complete(ctx, &w, out);
}

/* Parallels of a sphere between its poles. */
static size_t sphere_rings(unsigned segments) {
    return segments / 2 < 2 ? 1 : segments / 2 - 1;
}

size_t asdic_sphere_triangles(unsigned segments) {
    return 2 * sphere_rings(segments) * segments;
}

size_t asdic_cylinder_triangles(unsigned segments) {
    return 4 * (size_t)segments;
}

/* SEGMENTS meridians and half as many parallels, poles on the z axis. */
asdic_status asdic_mesh_sphere(asdic_context *ctx, double radius_m, unsigned segments,
                               asdic_mesh **out) {
    if (!out) {
        return asdic_fail_null(ctx, __func__);
    }
    writer w = {0};
    size_t rings = sphere_rings(segments);
    *out = NULL;
    TRY(check_length(ctx, "the sphere's radius", radius_m));
    TRY(check_segments(ctx, segments));
    TRY(asdic_mesh_allocate(ctx, 2 + rings * segments, asdic_sphere_triangles(segments), &w.mesh));
    uint32_t north = put_vertex(&w, 0.0, 0.0, radius_m);
    for (size_t ring = 1; ring <= rings; ring++) {
        double polar = ASDIC_PI * (double)ring / (double)(rings + 1);
        for (unsigned s = 0; s < segments; s++) {
            double azimuth = 2.0 * ASDIC_PI * s / segments;
            put_vertex(&w, radius_m * sin(polar) * cos(azimuth),
                       radius_m * sin(polar) * sin(azimuth), radius_m * cos(polar));
        }
    }
    uint32_t south = put_vertex(&w, 0.0, 0.0, -radius_m);
    for (unsigned s = 0; s < segments; s++) {
        uint32_t here = 1 + s, next = 1 + (s + 1) % segments;
        put_facet(&w, north, here, next);
        for (size_t ring = 1; ring < rings; ring++) {
            put_quad(&w, here, here + segments, next + segments, next);
            here += segments;
            next += segments;
        }
        put_facet(&w, here, south, next);
    }
    return complete(ctx, &w, out);
}

asdic_status asdic_mesh_cylinder(asdic_context *ctx, double radius_m, double length_m,
                                 unsigned segments, asdic_mesh **out) {
    if (!out) {
        return asdic_fail_null(ctx, __func__);
    }
    writer w = {0};
    *out = NULL;
    TRY(check_length(ctx, "the cylinder's radius", radius_m));
    TRY(check_length(ctx, "the cylinder's length", length_m));
    TRY(check_segments(ctx, segments));
    TRY(asdic_mesh_allocate(ctx, 2 + 2 * (size_t)segments, asdic_cylinder_triangles(segments),
                            &w.mesh));
    uint32_t port = put_vertex(&w, 0.0, -0.5 * length_m, 0.0);
    uint32_t starboard = put_vertex(&w, 0.0, 0.5 * length_m, 0.0);
    for (unsigned s = 0; s < segments; s++) {
        double angle = 2.0 * ASDIC_PI * s / segments;
        double z = radius_m * cos(angle), x = radius_m * sin(angle);
        put_vertex(&w, x, -0.5 * length_m, z);
        put_vertex(&w, x, 0.5 * length_m, z);
    }
    for (unsigned s = 0; s < segments; s++) {
        uint32_t here = 2 + 2 * s, next = 2 + 2 * ((s + 1) % segments);
        put_quad(&w, here, next, next + 1, here + 1);
        put_facet(&w, port, next, here);
        put_facet(&w, starboard, here + 1, next + 1);
    }
    return complete(ctx, &w, out);
}

asdic_status asdic_mesh_plate(asdic_context *ctx, double width_m, double height_m,
                              asdic_mesh **out) {
    if (!out) {
        return asdic_fail_null(ctx, __func__);
    }
    writer w = {0};
    *out = NULL;
    TRY(check_length(ctx, "the plate's width", width_m));
    TRY(check_length(ctx, "the plate's height", height_m));
    TRY(asdic_mesh_allocate(ctx, 4, 2, &w.mesh));
    put_vertex(&w, 0.0, -0.5 * width_m, -0.5 * height_m);
    put_vertex(&w, 0.0, 0.5 * width_m, -0.5 * height_m);
    put_vertex(&w, 0.0, 0.5 * width_m, 0.5 * height_m);
    put_vertex(&w, 0.0, -0.5 * width_m, 0.5 * height_m);
    put_quad(&w, 0, 1, 2, 3);
    return complete(ctx, &w, out);
}
