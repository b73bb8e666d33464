#include "crease.h"

#include "bend.h"
#include "fold.h"

#include "../base/vec.h"

/* A patch this much larger than its neighbour may be a flat face with a rounded edge, which stays flat. */
#define FACE_RATIO 4.0
/* It is where the neighbour bends this much faster. On a ball all facets bend alike. */
#define BEND_RATIO 2.0
/* A face is cut into two triangles at least, unless it is one. What is cut into more than one across the way in which
 * it would bend is one for certain: facets of a curved surface turn from one to the next. */
#define SOME_FACETS 1.5
/* What lies ahead over a bevel goes on turning about its edge; the cap of a round body's end, beside fine strips, has
 * its normal along that, with this cosine or more. */
#define ASIDE 0.5

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
        asdic_corners around = asdic_surface_around(s, at);
        for (uint32_t i = 0; i < around.count; i++) {
            uint32_t next = around.at[i] / 3;
            asdic_vec3 normal = asdic_surface_normal(s, next);
            if (asdic_vec3_dot(own, normal) < s->crease_cosine &&
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
    const asdic_patch *face = &s->patches[s->patch[facet]];
    asdic_vec3 own = asdic_surface_normal(s, facet), normal = asdic_surface_normal(s, other);
    asdic_vec3 turn = asdic_vec3_sub(normal, asdic_vec3_scale(own, asdic_vec3_dot(own, normal)));
    asdic_vec3 way = asdic_vec3_sub(sum_of_corners(s, other), sum_of_corners(s, facet));
    if (asdic_patch_width(face, turn) > SOME_FACETS * asdic_surface_width(s, facet, turn) ||
        (face->area_m2 > SOME_FACETS * asdic_surface_area(s, facet) &&
         is_bevel(s, facet, corner, way))) {
        return true;
    }
    asdic_bend there = asdic_bend_of(s, other, s->round + 3 * (size_t)other);
    asdic_bend here = asdic_bend_of(s, facet, s->round + 3 * (size_t)facet);
    return asdic_bend_along(&there, way) > BEND_RATIO * asdic_bend_along(&here, way);
}

/* Whether the surface that FACET stands for goes on in the facet that has CORNER, where both touch. */
static bool goes_on(const asdic_surface *s, uint32_t facet, uint32_t corner) {
    uint32_t own = s->patch[facet], other = s->patch[corner / 3];
    return own == other ||
           (asdic_vec3_dot(asdic_surface_normal(s, facet), asdic_surface_normal(s, corner / 3)) >=
                s->crease_cosine &&
            !(s->round && s->patches[other].area_m2 < s->patches[own].area_m2 / FACE_RATIO &&
              begins_edge(s, facet, corner)));
}

/* Whether a patch AROUND a vertex keeps flat at an edge below the crease angle. */
static bool has_end(const asdic_surface *s, asdic_corners around) {
    for (uint32_t i = 0; i < around.count; i++) {
        if (s->patches[s->patch[around.at[i] / 3]].ends) {
            return true;
        }
    }
    return false;
}

/* Whether the surface comes into the facet of corner AT from one of those that REACHED. */
static bool is_reached(const asdic_surface *s, asdic_corners around, const bool *reached,
                       uint32_t at) {
    for (uint32_t i = 0; i < around.count; i++) {
        uint32_t from = around.at[i] / 3;
        if (reached[i] && goes_on(s, from, at) &&
            !asdic_fold_parts(s, s->patch[from], s->patch[at / 3])) {
            return true;
        }
    }
    return false;
}

/* Those of the corners AROUND to which the surface goes on from FACET over no edge at which a face ends. */
static void reach(const asdic_surface *s, asdic_corners around, uint32_t facet, bool *reached) {
    for (uint32_t i = 0; i < around.count; i++) {
        reached[i] = s->patch[around.at[i] / 3] == s->patch[facet];
    }
    for (bool more = true; more;) {
        more = false;
        for (uint32_t i = 0; i < around.count; i++) {
            if (!reached[i] && goes_on(s, facet, around.at[i]) &&
                is_reached(s, around, reached, around.at[i])) {
                reached[i] = more = true;
            }
        }
    }
}

/* Whether PATCH is a wall beside what rounds its edge AROUND a vertex. */
static bool is_wall(const asdic_surface *s, asdic_corners around, uint32_t patch) {
    bool wall = false;
    for (uint32_t i = 0; s->patches[patch].ends && !wall && i < around.count; i++) {
        wall = asdic_fold_is_straight(s, patch, s->patch[around.at[i] / 3]);
    }
    return wall;
}

/* Of the COUNT corners KEPT, of those AROUND, those of walls from which the surface does not go on into FACET: what rounds
 * their edge begins along them. All, where there are none. */
static uint32_t keep_walls(const asdic_surface *s, asdic_corners around, uint32_t facet,
                           uint32_t *kept, uint32_t count) {
    uint32_t walls = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t from = s->patch[kept[i] / 3];
        if (is_wall(s, around, from) && asdic_fold_parts(s, from, s->patch[facet])) {
            uint32_t other = kept[walls];
            kept[walls++] = kept[i];
            kept[i] = other;
        }
    }
    return walls > 0 ? walls : count;
}

asdic_corners asdic_crease_within(const asdic_surface *s, asdic_corners around, uint32_t facet,
                                  uint32_t *kept) {
    bool reached[ASDIC_MOST_CORNERS], ends = has_end(s, around);
    uint32_t count = 0;
    if (ends) {
        reach(s, around, facet, reached);
    }
    for (uint32_t i = 0; i < around.count; i++) {
        kept[count] = around.at[i];
        count += ends ? reached[i] : goes_on(s, facet, around.at[i]);
    }
    return (asdic_corners){kept, ends ? keep_walls(s, around, facet, kept, count) : count};
}

bool asdic_crease_is_even(const asdic_surface *s, asdic_corners around) {
    double least_m2 = INFINITY, most_m2 = 0.0;
    for (uint32_t i = 0; i < around.count; i++) {
        double area_m2 = s->patches[s->patch[around.at[i] / 3]].area_m2;
        least_m2 = area_m2 < least_m2 ? area_m2 : least_m2;
        most_m2 = area_m2 > most_m2 ? area_m2 : most_m2;
    }
    return most_m2 <= FACE_RATIO * least_m2;
}

bool asdic_crease_is_smooth(const asdic_surface *s, asdic_corners around) {
    double half_cosine = sqrt(0.5 + 0.5 * s->crease_cosine);
    if (has_end(s, around)) {
        return false;
    }
    for (uint32_t i = 1; i < around.count; i++) {
        if (asdic_vec3_dot(asdic_surface_normal(s, around.at[0] / 3),
                           asdic_surface_normal(s, around.at[i] / 3)) < half_cosine) {
            return false;
        }
    }
    return true;
}

bool asdic_crease_is_whole(const asdic_surface *s, asdic_corners around) {
    if (asdic_crease_is_smooth(s, around) && asdic_crease_is_even(s, around)) {
        return true;
    }
    if (has_end(s, around)) {
        return false;
    }
    for (uint32_t i = 0; i < around.count; i++) {
        for (uint32_t j = 0; j < around.count; j++) {
            if (!goes_on(s, around.at[i] / 3, around.at[j])) {
                return false;
            }
        }
    }
    return true;
}

bool asdic_crease_is_bent(const asdic_surface *s, uint32_t facet) {
    uint32_t room[ASDIC_MOST_CORNERS];
    for (size_t k = 0; k < 3; k++) {
        asdic_corners around = asdic_surface_around(s, s->vertex[3 * (size_t)facet + k]);
        around = asdic_crease_within(s, around, facet, room);
        for (uint32_t i = 0; i < around.count; i++) {
            if (s->patch[around.at[i] / 3] != s->patch[facet]) {
                return true;
            }
        }
    }
    return false;
}
