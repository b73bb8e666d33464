/*
 * Glints: spots of smooth bodies that mirror the sonar, or show it another's, which few rays find. They get rays of their
 * own.
 */
#ifndef ASDIC_SIM_GLINTS_H
#define ASDIC_SIM_GLINTS_H

#include "faces.h"

/* A spot of a body: a point from the middle of its part, the normal, two axes along the surface, and how the normal turns
 * along these, 1/m: of the first to the first, of either to the other, of the second to the second; and the most that it
 * turns in any direction. */
typedef struct asdic_spot {
    size_t part;
    asdic_vec3 offset_m, normal, axes[2];
    double bend[3], steepest;
} asdic_spot;

/* From the sonar over a mirror to a target and straight home, or, where it RETURNS, by the way it came; or STRAIGHT to the
 * target, which is the mirror as well, and back. */
typedef struct asdic_glint {
    asdic_spot mirror, target;
    bool returns, straight;
    double slope_ms;   /* of the target's lobe */
    asdic_vec3 seen_m; /* the mirror's spot, from the middle of its part */
    asdic_vec3 from_m; /* whence it was found */
    double score;
} asdic_glint;

typedef struct asdic_glint_list {
    asdic_glint glint[DEV_MAX_CONES]; /* loudest first */
    size_t count;
} asdic_glint_list;

typedef struct asdic_glints {
    asdic_glint_list own, between; /* of one body, of two */
} asdic_glints;

/* The glints of objects of PLACEMENT, and where they are MIRRORS those between two, that are seen best from POSITION_M by
 * EYE. */
asdic_status asdic_glints_find(asdic_glints *glints, const asdic_placement *placement,
                               asdic_vec3 position_m, const asdic_eye *eye, bool mirrors);

struct asdic_passage; /* passage.h */

/* Gives those of GLINTS for which PING, whose other cones are there, has room cones, where they are now, seen from
 * POSITION_M by WAY, the straight one of asdic_passages_find; takes their rays from the background. */
void asdic_glints_place(const asdic_glints *glints, const asdic_part *parts, asdic_vec3 position_m,
                        const struct asdic_passage *way, dev_ping *ping);

#endif
