#include "smooth.h"

#include "base/try.h"

#include "bend.h"
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
/* A patch this much larger than its neighbour may be a flat face with a rounded edge, which stays flat. */
#define FACE_RATIO 4.0
/* It is where the neighbour bends this much faster. On a ball all facets bend alike. */
#define BEND_RATIO 2.0
/* It is for certain where it is cut into facets so much smaller; of roundings to SAME_PLANE a curved
 * surface has patches of several as well. */
#define MANY_FACETS 4.0
/* A face is cut into two triangles at least, unless it is one. */
#define SOME_FACETS 1.5
/* What lies ahead over a bevel goes on turning about its edge; the cap of a round body's end, beside fine strips, has its
 * normal along that, with this cosine or more. */
#define ASIDE 0.5

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

static double facet_m2(const asdic_surface *s, uint32_t facet) {
    asdic_vec3 p = asdic_surface_corner(s, 3 * (size_t)facet);
    asdic_vec3 a = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)facet + 1), p);
    asdic_vec3 b = asdic_vec3_sub(asdic_surface_corner(s, 3 * (size_t)facet + 2), p);
    return 0.5 * asdic_vec3_length(asdic_vec3_cross(a, b));
}

static asdic_vec3 sum_of_corners(const asdic_surface *s, uint32_t facet) {
    asdic_vec3 sum = asdic_surface_corner(s, 3 * (size_t)facet);
    sum = asdic_vec3_add(sum, asdic_surface_corner(s, 3 * (size_t)facet + 1));
    return asdic_vec3_add(sum, asdic_surface_corner(s, 3 * (size_t)facet + 2));
}

/* Whether what lies over an edge from FACET touches the facet that has CORNER, ahead of it on the WAY. */
static bool is_bevel(const asdic_surface *s, uint32_t facet, uint32_t corner, asdic_vec3 way) {
    asdic_vec3 own = asdic_surface_normal(s, facet), from = sum_of_corners(s, corner / 3);
    asdic_vec3 edge = asdic_vec3_cross(own, asdic_surface_normal(s, corner / 3));
    double aside = ASIDE * asdic_vec3_length(edge);
    for (uint32_t k = 1; k < 3; k++) {
        uint32_t at = s->vertex[3 * (size_t)(corner / 3) + (corner + k) % 3];
        uint32_t first = s->first[at], end = s->first[at + 1];
        for (uint32_t i = first; i < end && end - first <= ASDIC_MOST_CORNERS; i++) {
            uint32_t next = s->touching[i] / 3;
            asdic_vec3 normal = asdic_surface_normal(s, next);
            if (asdic_vec3_dot(own, normal) < CREASE_COSINE &&
                fabs(asdic_vec3_dot(edge, normal)) < aside &&
                asdic_vec3_dot(way, asdic_vec3_sub(sum_of_corners(s, next), from)) > 0.0) {
                return true;
            }
        }
    }
    return false;
}

/* Whether the much smaller facet that has CORNER begins the bevelled or rounded edge of the flat face
 * that FACET is, or is cut from. */
static bool begins_edge(const asdic_surface *s, uint32_t facet, uint32_t corner) {
    uint32_t other = corner / 3;
    double face_m2 = s->patches[s->patch[facet]].area_m2, own_m2 = facet_m2(s, facet);
    asdic_vec3 way = asdic_vec3_sub(sum_of_corners(s, other), sum_of_corners(s, facet));
    if (face_m2 > MANY_FACETS * own_m2 ||
        (face_m2 > SOME_FACETS * own_m2 && is_bevel(s, facet, corner, way))) {
        return true;
    }
    asdic_bend there = asdic_bend_of(s, other, s->round + 3 * (size_t)other);
    asdic_bend here = asdic_bend_of(s, facet, s->round + 3 * (size_t)facet);
    return asdic_bend_along(&there, way) > BEND_RATIO * asdic_bend_along(&here, way);
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
                      (s->round && s->patches[s->patch[other]].area_m2 < least_m2 &&
                       begins_edge(s, facet, s->touching[i])))) {
            continue;
        }
        *bent |= patch;
        double weight = corner_weight(s, s->touching[i]);
        sum = asdic_vec3_add(sum, asdic_vec3_scale(normal, weight));
    }
    double length = asdic_vec3_length(sum);
    return length > 0.0 ? asdic_vec3_scale(sum, 1.0 / length) : own;
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
    asdic_bend bend = asdic_bend_of(s, facet, normals);
    t->radius_m = (float)asdic_bend_larger_radius(&bend);
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

/* Corner normals as if no patch were a face with a rounded edge. */
static asdic_status find_round(asdic_context *ctx, asdic_surface *s) {
    asdic_vec3 *round = malloc(3 * (size_t)s->count * sizeof *round);
    if (!round) {
        return asdic_fail_memory(ctx, "the corner normals of an object");
    }
    for (uint32_t corner = 0; corner < 3 * s->count; corner++) {
        bool bent = false;
        round[corner] = corner_normal(s, corner / 3, corner, &bent);
    }
    s->round = round;
    return ASDIC_OK;
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
    status = status ? status : find_round(scene->ctx, surface);
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
