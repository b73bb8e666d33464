#include "smooth.h"

#include "base/try.h"

#include "moving.h"
#include "patch.h"

#include "laws/scatterer.h"

#include "../../kernels/smooth.h"
#include "../base/context.h"
#include "../base/vec.h"

#include <stdlib.h>

/* Facets that meet at a sharper angle than 35 degrees meet at an edge; below it they stand for one
 * curved surface. A round body of 16 facets turns by 32 from one to the next but one. */
#define CREASE_COSINE 0.819
/* A patch this much larger than its neighbour is a flat face with a rounded edge: it stays flat. */
#define FACE_RATIO 4.0
/* A surface that bends this much more one way than the other is straight the other way. */
#define STRAIGHT 1e-4

uint32_t asdic_smooth_pack(asdic_vec3 n) {
    double sum = fabs(n.x) + fabs(n.y) + fabs(n.z);
    double x = n.x / sum, y = n.y / sum;
    if (n.z < 0.0) { /* the lower half is folded outwards */
        double fold = x;
        x = (1.0 - fabs(y)) * (fold < 0.0 ? -1.0 : 1.0);
        y = (1.0 - fabs(fold)) * (y < 0.0 ? -1.0 : 1.0);
    }
    uint32_t low = (uint16_t)(int16_t)lround(x * OCTAHEDRON_STEPS);
    uint32_t high = (uint16_t)(int16_t)lround(y * OCTAHEDRON_STEPS);
    return low | high << 16;
}

/* Weight of a facet's normal at one of its corners, sin / (|a| |b|) of the edges a and b that meet
 * there: exact where the vertices lie on a sphere (N. Max, "Weights for computing vertex normals
 * from facet normals", J. Graphics Tools 4(2), 1999). */
static double corner_weight(const asdic_surface *s, uint32_t corner) {
    size_t facet = 3 * (size_t)(corner / 3);
    asdic_vec3 p = asdic_surface_corner(s, corner);
    asdic_vec3 a = asdic_vec3_sub(asdic_surface_corner(s, facet + (corner + 1) % 3), p);
    asdic_vec3 b = asdic_vec3_sub(asdic_surface_corner(s, facet + (corner + 2) % 3), p);
    double aa = asdic_vec3_dot(a, a), bb = asdic_vec3_dot(b, b);
    return aa * bb > 0.0 ? asdic_vec3_length(asdic_vec3_cross(a, b)) / (aa * bb) : 0.0;
}

/* The surface's normal at a corner of FACET; *BENT when another patch has a part in it. */
static asdic_vec3 corner_normal(const asdic_surface *s, uint32_t facet, uint32_t corner,
                                bool *bent) {
    asdic_vec3 own = asdic_surface_normal(s, facet), sum = {0.0, 0.0, 0.0};
    uint32_t vertex = s->vertex[corner], first = s->first[vertex], end = s->first[vertex + 1];
    double least_m2 = s->patches[s->patch[facet]].area_m2 / FACE_RATIO;
    if (end - first > ASDIC_MOST_CORNERS) {
        return own;
    }
    for (uint32_t i = first; i < end; i++) {
        uint32_t other = s->touching[i] / 3;
        asdic_vec3 normal = asdic_surface_normal(s, other);
        bool patch = s->patch[other] != s->patch[facet];
        if (patch && (asdic_vec3_dot(own, normal) < CREASE_COSINE ||
                      s->patches[s->patch[other]].area_m2 < least_m2)) {
            continue;
        }
        *bent |= patch;
        double weight = corner_weight(s, s->touching[i]);
        sum = asdic_vec3_add(sum, asdic_vec3_scale(normal, weight));
    }
    double length = asdic_vec3_length(sum);
    return length > 0.0 ? asdic_vec3_scale(sum, 1.0 / length) : own;
}

/* Solves the symmetric 3 x 3 system A x = B by Cramer's rule; false when it is singular. */
static bool solve3(const double a[3][3], const double b[3], double x[3]) {
    double c0 = a[1][1] * a[2][2] - a[1][2] * a[2][1];
    double c1 = a[1][2] * a[2][0] - a[1][0] * a[2][2];
    double c2 = a[1][0] * a[2][1] - a[1][1] * a[2][0];
    double det = a[0][0] * c0 + a[0][1] * c1 + a[0][2] * c2;
    if (!(fabs(det) > 0.0)) {
        return false;
    }
    x[0] = (b[0] * c0 + b[1] * (a[0][2] * a[2][1] - a[0][1] * a[2][2]) +
            b[2] * (a[0][1] * a[1][2] - a[0][2] * a[1][1])) /
           det;
    x[1] = (b[0] * c1 + b[1] * (a[0][0] * a[2][2] - a[0][2] * a[2][0]) +
            b[2] * (a[0][2] * a[1][0] - a[0][0] * a[1][2])) /
           det;
    x[2] = (b[0] * c2 + b[1] * (a[0][1] * a[2][0] - a[0][0] * a[2][1]) +
            b[2] * (a[0][0] * a[1][1] - a[0][1] * a[1][0])) /
           det;
    return true;
}

/* Larger radius of curvature, from how the corner normals differ along the edges (S. Rusinkiewicz,
 * "Estimating curvatures and their derivatives on triangle meshes", 3DPVT 2004); 0 where the
 * surface is straight one way. */
static double larger_radius(const asdic_surface *s, uint32_t facet, const asdic_vec3 normals[3]) {
    asdic_vec3 n = asdic_surface_normal(s, facet), p[3];
    for (int k = 0; k < 3; k++) {
        p[k] = asdic_surface_corner(s, 3 * (size_t)facet + k);
    }
    asdic_vec3 u = asdic_vec3_sub(p[1], p[0]);
    u = asdic_vec3_scale(u, 1.0 / asdic_vec3_length(u));
    asdic_vec3 v = asdic_vec3_cross(n, u);
    double a[3][3] = {{0}}, b[3] = {0}, x[3]; /* of the tensor (x0, x1; x1, x2) */
    for (int k = 0; k < 3; k++) {
        asdic_vec3 edge = asdic_vec3_sub(p[(k + 1) % 3], p[k]);
        asdic_vec3 turn = asdic_vec3_sub(normals[(k + 1) % 3], normals[k]);
        double eu = asdic_vec3_dot(edge, u), ev = asdic_vec3_dot(edge, v);
        double tu = asdic_vec3_dot(turn, u), tv = asdic_vec3_dot(turn, v);
        a[0][0] += eu * eu;
        a[0][1] += eu * ev;
        a[1][1] += eu * eu + ev * ev;
        a[1][2] += eu * ev;
        a[2][2] += ev * ev;
        b[0] += tu * eu;
        b[1] += tu * ev + tv * eu;
        b[2] += tv * ev;
    }
    a[1][0] = a[0][1];
    a[2][1] = a[1][2];
    if (!solve3((const double(*)[3])a, b, x)) {
        return 0.0;
    }
    double mean = 0.5 * (x[0] + x[2]), root = hypot(0.5 * (x[0] - x[2]), x[1]);
    double least = fmin(fabs(mean + root), fabs(mean - root));
    double most = fmax(fabs(mean + root), fabs(mean - root));
    return least > STRAIGHT * most ? 1.0 / least : 0.0;
}

/* TURNED: where the corners' normals go in double, three a facet; or NULL. */
static void smooth_facet(const asdic_surface *s, uint32_t facet, asdic_vec3 *turned) {
    dev_triangle *t = &s->facets[facet];
    const asdic_patch *patch = &s->patches[s->patch[facet]];
    asdic_vec3 normals[3];
    bool bent = false;
    for (uint32_t k = 0; k < 3; k++) {
        normals[k] = corner_normal(s, facet, 3 * facet + k, &bent);
    }
    t->flat_m2 = (float)patch->area_m2;
    if (!bent) {
        return;
    }
    for (int k = 0; k < 3; k++) {
        asdic_vec3 own = asdic_vec3_scale(normals[k], s->side[facet]); /* to the facet's side */
        t->corner_normals[k] = asdic_smooth_pack(own);
        if (turned) {
            turned[3 * (size_t)facet + k] = own;
        }
    }
    t->flat_m2 = (float)patch->length2_m2;
    t->radius_m = (float)larger_radius(s, facet, normals);
}

/* Room for the normals of a part that moves; NULL for one that stays. */
static asdic_status reserve_normals(asdic_scene *scene, size_t part, asdic_movable **out) {
    *out = NULL;
    for (size_t i = 0; i < scene->movable_count && !*out; i++) {
        *out = scene->movables[i].part == part ? &scene->movables[i] : NULL;
    }
    if (!*out) {
        return ASDIC_OK;
    }
    free((*out)->normals); /* of a commit that failed */
    (*out)->normals = calloc(9 * (*out)->count + 1, sizeof(double));
    return (*out)->normals ? ASDIC_OK : asdic_fail_memory(scene->ctx, "a moving object's normals");
}

/* Turns normals from the world to the mesh's frame. */
static void turn_back(const asdic_movable *m, const asdic_vec3 *world) {
    asdic_mat3 turn = asdic_mat3_of(&m->anchor);
    for (size_t i = 0; i < 3 * m->count; i++) {
        asdic_vec3 n = asdic_mat3_apply_inverse(turn, world[i]);
        m->normals[3 * i] = n.x;
        m->normals[3 * i + 1] = n.y;
        m->normals[3 * i + 2] = n.z;
    }
}

/* Smooths the facets of a part, whose SURFACE begins with triangle BEGIN. */
static asdic_status smooth_part(asdic_scene *scene, size_t begin, asdic_surface *surface) {
    asdic_movable *moving;
    size_t number = scene->triangles[begin].part;
    TRY(reserve_normals(scene, number, &moving));
    asdic_vec3 *turned = moving ? calloc(3 * moving->count, sizeof *turned) : NULL;
    if (moving && !turned) {
        return asdic_fail_memory(scene->ctx, "a moving object's normals");
    }
    asdic_status status =
        asdic_surface_find_patches(scene->ctx, 2.0 * scene->parts[number].radius_m, surface);
    for (uint32_t facet = 0; !status && facet < surface->count; facet++) {
        smooth_facet(surface, facet, turned);
    }
    if (moving && !status) {
        turn_back(moving, turned);
    }
    free(turned);
    return status;
}

/* Rims of an object, triangles BEGIN to END; what is CURVED is smoothed as well. */
static asdic_status finish_part(asdic_scene *scene, size_t begin, size_t end, bool curved) {
    asdic_surface surface;
    asdic_status status =
        asdic_surface_init(scene->ctx, scene->corners_m + 9 * begin, scene->triangles + begin,
                           (uint32_t)(end - begin), &surface);
    if (!status && curved) {
        status = smooth_part(scene, begin, &surface);
    }
    asdic_surface_finish(&surface);
    return status;
}

asdic_status asdic_scene_smooth(asdic_scene *scene) {
    for (size_t begin = scene->built, end; begin < scene->triangle_count; begin = end) {
        /* A part's triangles lie together, in the order in which they were added. */
        uint32_t number = scene->triangles[begin].part;
        for (end = begin; end < scene->triangle_count && scene->triangles[end].part == number;) {
            scene->triangles[end++].corner_normals[0] = DEV_FLAT;
        }
        const asdic_part *part = &scene->parts[number];
        bool curved = scene->materials[part->material].law->formula == DEV_LAW_FACET;
        if (curved || part->kind == DEV_KIND_OBJECT) {
            TRY(finish_part(scene, begin, end, curved));
        }
    }
    return ASDIC_OK;
}
