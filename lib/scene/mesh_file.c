/*
 * A mesh from a file: scan it, let OpenMesh read it, compare the two, cut polygons into triangles.
 */
#include "mesh_build.h"

#include "base/hash.h"
#include "base/try.h"
#include "mesh_openmesh.h"
#include "mesh_polygon.h"

#include "../base/context.h"

#include <math.h>
#include <string.h>

static uint64_t hash_facets(const asdic_polygons *p) {
    uint64_t hash = 0;
    for (size_t f = 0; f < p->facet_count; f++) {
        const uint32_t *corners = &p->corners[p->first[f]];
        size_t count = p->first[f + 1] - p->first[f];
        hash = asdic_hash_fold(hash, count);
        for (size_t i = 0; i < count; i++) {
            hash = asdic_hash_fold(hash, corners[i]);
        }
    }
    return hash;
}

static asdic_status check_counts(const asdic_mesh_scan *scan, const asdic_polygons *p) {
    bool stl = scan->vertices_m == NULL; /* OpenMesh welds its corners */
    if (p->facet_count > scan->facets || p->facet_count < scan->facets - scan->degenerate ||
        (!stl && p->vertex_count != scan->vertices)) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT,
                          "%s: holds %zu vertices and %zu facets, but OpenMesh reads %zu and %zu; "
                          "write it anew in a plain layout (one vertex or facet a line)",
                          scan->path, scan->vertices, scan->facets, p->vertex_count,
                          p->facet_count);
    }
    if (!stl && hash_facets(p) != scan->facet_hash) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT,
                          "%s: OpenMesh reads other facets than the file holds; write it anew in a "
                          "plain layout (one vertex or facet a line, no colours)",
                          scan->path);
    }
    for (size_t i = 0; i < p->corner_count; i++) {
        if (p->corners[i] >= p->vertex_count) {
            return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT,
                              "%s: a facet names vertex %u, but there are %zu", scan->path,
                              p->corners[i], p->vertex_count);
        }
    }
    return ASDIC_OK;
}

/* Both readings must give the same vertex; the double one is kept. */
static asdic_status take_vertices(const asdic_mesh_scan *scan, const asdic_polygons *p,
                                  double *out_m) {
    for (size_t i = 0; i < 3 * p->vertex_count; i++) {
        double read = p->vertices_m[i], scanned = scan->vertices_m ? scan->vertices_m[i] : read;
        if (!(fabs(read - scanned) <= 2.4e-7 * fabs(scanned) + 1e-37)) {
            return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT,
                              "%s: vertex %zu has %.9g where OpenMesh reads %.9g", scan->path,
                              i / 3, scanned, read);
        }
        out_m[i] = scanned;
    }
    return ASDIC_OK;
}

static asdic_status triangulate_facet(const asdic_mesh_scan *scan, size_t facet, uint32_t *corners,
                                      size_t count, asdic_mesh *mesh) {
    uint32_t *out = &mesh->indices[3 * mesh->triangle_count];
    size_t written = 1;
    if (count > ASDIC_POLYGON_MAX_CORNERS) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT,
                          "%s: facet %zu has %zu corners, more than %d; triangulate it", scan->path,
                          facet, count, ASDIC_POLYGON_MAX_CORNERS);
    }
    if (count == 3) {
        memcpy(out, corners, 3 * sizeof *corners);
    } else if (!asdic_polygon_triangulate(mesh->vertices_m, corners, count, out, &written)) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT,
                          "%s: the outline of facet %zu (%zu corners) crosses itself; "
                          "triangulate it",
                          scan->path, facet, count);
    }
    mesh->dropped += written == 0;
    mesh->triangle_count += written;
    return ASDIC_OK;
}

static asdic_status triangulate(const asdic_mesh_scan *scan, asdic_polygons *p, asdic_mesh *mesh) {
    size_t at = 0; /* of the next outline */
    mesh->triangle_count = 0;
    mesh->dropped = scan->facets - p->facet_count;
    for (size_t f = 0; f < p->facet_count; f++) {
        uint32_t *outline = at < scan->outlines_size ? &scan->outlines[at] : NULL;
        if (outline && outline[0] == f) {
            TRY(triangulate_facet(scan, f, outline + 2, outline[1], mesh));
            at += 2 + outline[1];
        } else {
            TRY(triangulate_facet(scan, f, &p->corners[p->first[f]], p->first[f + 1] - p->first[f],
                                  mesh));
        }
    }
    return ASDIC_OK;
}

static void place(asdic_mesh *mesh, double scale, bool z_up) {
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        double *v = &mesh->vertices_m[3 * i];
        double x = scale * v[0], y = scale * v[1], z = scale * v[2];
        v[0] = z_up ? y : x;
        v[1] = z_up ? x : y;
        v[2] = z_up ? -z : z;
    }
}

static asdic_status build(const asdic_mesh_scan *scan, asdic_polygons *p, asdic_mesh **out) {
    TRY(check_counts(scan, p));
    /* every facet has 3 corners or more */
    size_t triangles = p->corner_count + scan->outlines_size - 2 * p->facet_count;
    TRY(asdic_mesh_allocate(scan->ctx, p->vertex_count, triangles, out));
    TRY(take_vertices(scan, p, (*out)->vertices_m));
    return triangulate(scan, p, *out);
}

static asdic_status read_mesh(asdic_mesh_scan *scan, asdic_polygons *polygons, double scale,
                              bool z_up, asdic_mesh **mesh) {
    TRY(asdic_openmesh_read(scan, polygons));
    TRY(build(scan, polygons, mesh));
    place(*mesh, scale, z_up);
    return asdic_mesh_complete(scan->ctx, *mesh, scan->path);
}

asdic_status asdic_mesh_load(asdic_context *ctx, const char *path, double scale, bool z_up,
                             asdic_mesh **out) {
    if (!ASDIC_PLACE(out) || !path) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a mesh needs a path and a place");
    }
    if (!(scale > 0.0) || !isfinite(scale)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "%s: scale %g is not positive", path, scale);
    }
    asdic_mesh_scan scan;
    asdic_polygons polygons = {0};
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_scan_file(ctx, path, &scan);
    status = status ? status : read_mesh(&scan, &polygons, scale, z_up, &mesh);
    if (status) {
        asdic_mesh_destroy(&mesh);
    }
    asdic_polygons_finish(&polygons);
    asdic_mesh_scan_finish(&scan);
    *out = mesh;
    return status;
}
