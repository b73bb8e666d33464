#include "mesh_build.h"

#include "base/try.h"

#include "../base/context.h"
#include "../base/vec.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A facet whose height is below this share of its longest edge has no usable normal. */
#define DEGENERATE_HEIGHT 1e-12

asdic_vec3 asdic_mesh_vertex(const asdic_mesh *mesh, size_t index) {
    const double *v = &mesh->vertices_m[3 * index];
    return (asdic_vec3){v[0], v[1], v[2]};
}

static bool facet_is_degenerate(const asdic_mesh *mesh, const uint32_t *facet) {
    asdic_vec3 a = asdic_mesh_vertex(mesh, facet[0]);
    asdic_vec3 e1 = asdic_vec3_sub(asdic_mesh_vertex(mesh, facet[1]), a);
    asdic_vec3 e2 = asdic_vec3_sub(asdic_mesh_vertex(mesh, facet[2]), a);
    asdic_vec3 e3 = asdic_vec3_sub(e2, e1);
    double longest2 =
        fmax(asdic_vec3_dot(e1, e1), fmax(asdic_vec3_dot(e2, e2), asdic_vec3_dot(e3, e3)));
    return !(asdic_vec3_length(asdic_vec3_cross(e1, e2)) > DEGENERATE_HEIGHT * longest2);
}

static void drop_degenerate(asdic_mesh *mesh) {
    size_t kept = 0;
    for (size_t i = 0; i < mesh->triangle_count; i++) {
        if (facet_is_degenerate(mesh, &mesh->indices[3 * i])) {
            continue;
        }
        memmove(&mesh->indices[3 * kept], &mesh->indices[3 * i], 3 * sizeof *mesh->indices);
        kept++;
    }
    mesh->dropped += mesh->triangle_count - kept;
    mesh->triangle_count = kept;
}

static asdic_status check_numbers(asdic_context *ctx, const asdic_mesh *mesh, const char *name) {
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        asdic_vec3 v = asdic_mesh_vertex(mesh, i);
        if (!isfinite(v.x) || !isfinite(v.y) || !isfinite(v.z)) {
            return asdic_fail(ctx, ASDIC_ERROR_INPUT,
                              "%s: vertex %zu (%g, %g, %g) is not finite; repair the mesh", name, i,
                              v.x, v.y, v.z);
        }
        if (fmax(fabs(v.x), fmax(fabs(v.y), fabs(v.z))) > ASDIC_MESH_LIMIT_M) {
            return asdic_fail(ctx, ASDIC_ERROR_INPUT,
                              "%s: vertex %zu (%g, %g, %g) is beyond %g m; check the units", name,
                              i, v.x, v.y, v.z, ASDIC_MESH_LIMIT_M);
        }
    }
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        if (mesh->indices[i] >= mesh->vertex_count) {
            return asdic_fail(ctx, ASDIC_ERROR_INPUT,
                              "%s: facet %zu names vertex %u, but there are %zu", name, i / 3,
                              mesh->indices[i], mesh->vertex_count);
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_mesh_allocate(asdic_context *ctx, size_t vertex_count, size_t triangle_count,
                                 asdic_mesh **out) {
    *out = NULL;
    if (vertex_count > UINT32_MAX || triangle_count > UINT32_MAX / 3) {
        return asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                          "a mesh of %zu vertices and %zu triangles is beyond 2^32 indices",
                          vertex_count, triangle_count);
    }
    asdic_mesh *mesh = calloc(1, sizeof *mesh);
    if (mesh) {
        mesh->vertices_m = malloc((3 * vertex_count + 1) * sizeof *mesh->vertices_m);
        mesh->indices = malloc((3 * triangle_count + 1) * sizeof *mesh->indices);
    }
    if (!mesh || !mesh->vertices_m || !mesh->indices) {
        asdic_mesh_destroy(&mesh);
        return asdic_fail(ctx, ASDIC_ERROR_MEMORY,
                          "out of memory for a mesh of %zu vertices and %zu triangles",
                          vertex_count, triangle_count);
    }
    mesh->vertex_count = vertex_count;
    mesh->triangle_count = triangle_count;
    *out = mesh;
    return ASDIC_OK;
}

/* Of a mesh whose numbers are good. */
static asdic_status drop_and_count(asdic_context *ctx, asdic_mesh *mesh, const char *name) {
    drop_degenerate(mesh);
    TRY(asdic_mesh_drop_copies(ctx, mesh));
    if (mesh->triangle_count == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: no facet with an area (%zu without)", name,
                          mesh->dropped);
    }
    return asdic_mesh_count_open_edges(ctx, mesh);
}

asdic_status asdic_mesh_complete(asdic_context *ctx, asdic_mesh *mesh, const char *name) {
    TRY(check_numbers(ctx, mesh, name));
    TRY(asdic_mesh_weld(ctx, mesh));
    return drop_and_count(ctx, mesh, name);
}

asdic_status asdic_mesh_complete_exact(asdic_context *ctx, asdic_mesh *mesh, const char *name) {
    TRY(check_numbers(ctx, mesh, name));
    return drop_and_count(ctx, mesh, name);
}

asdic_status asdic_mesh_from_triangles(asdic_context *ctx, const double *vertices_m,
                                       size_t vertex_count, const uint32_t *indices,
                                       size_t triangle_count, asdic_mesh **out) {
    asdic_mesh *mesh;
    if (!out) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no place for the mesh was given");
    }
    *out = NULL;
    if (!vertices_m || !indices) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a mesh needs vertices and indices");
    }
    TRY(asdic_mesh_allocate(ctx, vertex_count, triangle_count, &mesh));
    memcpy(mesh->vertices_m, vertices_m, 3 * vertex_count * sizeof *vertices_m);
    memcpy(mesh->indices, indices, 3 * triangle_count * sizeof *indices);
    asdic_status status = asdic_mesh_complete(ctx, mesh, "mesh");
    if (status != ASDIC_OK) {
        asdic_mesh_destroy(&mesh);
    }
    *out = mesh;
    return status;
}

void asdic_mesh_destroy(asdic_mesh **mesh) {
    if (mesh && *mesh) {
        free((*mesh)->vertices_m);
        free((*mesh)->indices);
        free(*mesh);
        *mesh = NULL;
    }
}

void asdic_mesh_hint_at_units(asdic_mesh_info *info, bool body, bool ground) {
    info->hint[0] = '\0';
    double wide = fmax(info->max_m.x - info->min_m.x, info->max_m.y - info->min_m.y);
    double high = info->max_m.z - info->min_m.z, across = fmax(wide, high);
    if (ground && high > wide) {
        snprintf(info->hint, sizeof info->hint,
                 "%.3g m wide, but %.4g m high: degrees? (metres are needed)", wide, high);
    } else if (across > (body ? 200.0 : 20000.0)) {
        snprintf(info->hint, sizeof info->hint, "%.4g m across: millimetres? (scale 0.001)",
                 across);
    } else if (across < 0.5) {
        snprintf(info->hint, sizeof info->hint, "%.3g m across: not metres? (set a scale)", across);
    }
}

asdic_mesh_info asdic_mesh_get_info(const asdic_mesh *mesh) {
    if (!mesh) {
        return (asdic_mesh_info){0};
    }
    asdic_mesh_info info = {.triangles = mesh->triangle_count,
                            .vertices = mesh->vertex_count,
                            .dropped = mesh->dropped,
                            .copies = mesh->copies,
                            .open_edges = mesh->open_edges};
    asdic_vec3 lo = {INFINITY, INFINITY, INFINITY}, hi = {-INFINITY, -INFINITY, -INFINITY};
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        asdic_vec3 v = asdic_mesh_vertex(mesh, mesh->indices[i]);
        lo = (asdic_vec3){fmin(lo.x, v.x), fmin(lo.y, v.y), fmin(lo.z, v.z)};
        hi = (asdic_vec3){fmax(hi.x, v.x), fmax(hi.y, v.y), fmax(hi.z, v.z)};
    }
    info.min_m = lo;
    info.max_m = hi;
    /* a bottom is a sheet */
    asdic_mesh_hint_at_units(&info, mesh->open_edges == 0, mesh->is_grid);
    return info;
}
