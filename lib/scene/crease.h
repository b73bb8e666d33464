/*
 * Where the curved surface that facets stand for goes on from one to the next, and where it ends at an edge.
 */
#ifndef ASDIC_SCENE_CREASE_H
#define ASDIC_SCENE_CREASE_H

#include "patch.h"

/* Those of the corners AROUND a vertex into whose facets the surface goes on from FACET, in KEPT, which has room for
 * all. */
asdic_corners asdic_crease_within(const asdic_surface *surface, asdic_corners around,
                                  uint32_t facet, uint32_t *kept);

/* Whether the normals AROUND a vertex are so near one another that no two facets meet at an edge. */
bool asdic_crease_is_smooth(const asdic_surface *surface, asdic_corners around);

/* Whether the patches AROUND a vertex are so alike that none is a face beside its rounded edge. */
bool asdic_crease_is_even(const asdic_surface *surface, asdic_corners around);

/* Whether the surface goes on from each facet AROUND a vertex into each other. */
bool asdic_crease_is_whole(const asdic_surface *surface, asdic_corners around);

/* Whether another patch has a part in FACET's surface. */
bool asdic_crease_is_bent(const asdic_surface *surface, uint32_t facet);

#endif
