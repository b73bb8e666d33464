/*
 * A scene as sound sees it in water whose sound speed changes evenly with depth: its triangles lifted, so that
 * rays are straight (kernels/lift.h). Shading goes on with the true triangles, under the same ids.
 */
#ifndef ASDIC_SCENE_LIFTED_H
#define ASDIC_SCENE_LIFTED_H

#include "scene.h"

#include "../../kernels/ping_types.h"

/* The height of a lifted corner, in the scene frame; BEND_PER_M: over the sound speed at that frame's zero. The
 * same corner gives the same bits wherever it is met. */
static inline float asdic_lifted_z(double bend_per_m, const double v[3]) {
    return (float)(v[2] + 0.5 * bend_per_m * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
}

/* A triangle on a layer's plane belongs to both layers; more than ADVANCE_ROOM of advance.cl, m. */
#define ASDIC_LAYER_OVERLAP_M 1e-2

/* Steps in which the origin of what is lifted in layers follows the sonar where nothing stays (placement.h), m. */
#define ASDIC_LAYERED_STEP_M 256.0

/* A view of the committed SCENE, which must outlive it, with a hierarchy of lifted triangles: for tracers and
 * placements. A flat triangle lifts to a curved one, of which an edge of length L leaves out at most
 * L^2 |BEND_PER_M| / 8: edges of what stays are halved until that is below 2 mm, or there are
 * four million pieces in all layers. Of a scene that keeps its ground, the lifted ground is kept too, until other
 * layers are asked for. */
asdic_status asdic_scene_lift(const asdic_scene *scene, double bend_per_m, asdic_scene **lifted);

/* The same in COUNT layers, from the top down: each triangle once in every layer that it reaches. LAYERS must outlive
 * it, too. Of a moving object there are as many copies as it can reach layers at a time; a placement finds the layers
 * that they are in. */
asdic_status asdic_scene_lift_layers(const asdic_scene *scene, const dev_layer *layers,
                                     size_t count, asdic_scene **lifted);
void asdic_scene_unlift(asdic_scene **lifted);

#endif
