/*
 * A committed scene seen from above.
 */
#ifndef ASDIC_SCENE_CHART_H
#define ASDIC_SCENE_CHART_H

#include "base/relief.h"

#include <asdic/scene.h>

/* Fills RELIEF's depths with those of the bottom's highest place at each cell's centre; where RELIEF
 * tells objects apart, of objects that stay where they are as well. */
void asdic_chart_relief(const asdic_scene *scene, asdic_relief *relief);

/* Outlines of all objects, in the order of the scene: one convex ring for each piece of a mesh whose
 * pieces lie apart, several for a piece that bends, a point for a point. Freed with free(). */
asdic_status asdic_chart_outlines(asdic_context *ctx, const asdic_scene *scene, asdic_outline **out,
                                  size_t *count);

#endif
