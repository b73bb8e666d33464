#include "patch.h"

#include "../base/context.h"
#include "../base/vec.h"

#include <stdlib.h>

/* Facets count as coplanar when their normals agree to this, and their planes to this much of the
 * part's radius. */
#define SAME_PLANE 1e-3

typedef struct facet {
    uint32_t part;
    int32_t plane[4]; /* rounded normal and offset */
    double area_m2;
} facet;

static asdic_vec3 corner(const float v[3]) {
    return (asdic_vec3){v[0], v[1], v[2]};
}

static facet facet_of(const asdic_scene *scene, const dev_triangle *t) {
    asdic_vec3 a = corner(t->v0), normal = corner(t->normal);
    asdic_vec3 cross =
        asdic_vec3_cross(asdic_vec3_sub(corner(t->v1), a), asdic_vec3_sub(corner(t->v2), a));
    const asdic_part *part = &scene->parts[t->part];
    asdic_vec3 center = asdic_vec3_sub(part->center_m, scene->origin_m);
    double offset = asdic_vec3_dot(asdic_vec3_sub(a, center), normal) / fmax(part->radius_m, 1e-6);
    facet f = {.part = t->part, .area_m2 = 0.5 * asdic_vec3_length(cross)};
    f.plane[0] = (int32_t)lround(normal.x / SAME_PLANE);
    f.plane[1] = (int32_t)lround(normal.y / SAME_PLANE);
    f.plane[2] = (int32_t)lround(normal.z / SAME_PLANE);
    f.plane[3] = (int32_t)lround(offset / SAME_PLANE);
    return f;
}

static int compare_planes(const void *a, const void *b) {
    const facet *x = a, *y = b;
    if (x->part != y->part) {
        return x->part < y->part ? -1 : 1;
    }
    for (int i = 0; i < 4; i++) {
        if (x->plane[i] != y->plane[i]) {
            return x->plane[i] < y->plane[i] ? -1 : 1;
        }
    }
    return 0;
}

asdic_status asdic_scene_patch_areas(const asdic_scene *scene, double *areas_m2) {
    facet *facets = malloc((scene->triangle_count + 1) * sizeof *facets);
    if (!facets) {
        return asdic_fail_memory(scene->ctx, "the flat patches of a scene");
    }
    size_t count = 0;
    for (size_t i = 0; i < scene->triangle_count; i++) {
        const asdic_part *part = &scene->parts[scene->triangles[i].part];
        if (scene->materials[part->material].law == ASDIC_LAW_FACET) {
            facets[count++] = facet_of(scene, &scene->triangles[i]);
        }
    }
    qsort(facets, count, sizeof *facets, compare_planes);
    for (size_t p = 0; p < scene->part_count; p++) {
        areas_m2[p] = 0.0;
    }
    double area = 0.0;
    for (size_t i = 0; i < count; i++) {
        bool same = i > 0 && compare_planes(&facets[i - 1], &facets[i]) == 0;
        area = facets[i].area_m2 + (same ? area : 0.0);
        areas_m2[facets[i].part] = fmax(areas_m2[facets[i].part], area);
    }
    free(facets);
    return ASDIC_OK;
}
