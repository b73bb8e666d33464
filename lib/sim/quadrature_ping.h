/*
 * Pings of a flat scene without objects, by quadrature instead of rays.
 */
#ifndef ASDIC_SIM_QUADRATURE_PING_H
#define ASDIC_SIM_QUADRATURE_PING_H

#include <asdic/ping.h>

/* Depths and attitudes that are remembered. */
#define ASDIC_QUADRATURE_VIEWS 8

typedef struct asdic_quadrature_cache {
    asdic_ping *pings[ASDIC_QUADRATURE_VIEWS]; /* NULL: not computed */
    asdic_pose poses[ASDIC_QUADRATURE_VIEWS];
    size_t next; /* to be replaced */
} asdic_quadrature_cache;

/* Whether the scene holds and the sampling asks for only what the quadrature knows, from depths and altitudes in the
 * water. */
bool asdic_quadrature_knows(const asdic_scene *scene, const asdic_environment *env,
                            const asdic_sampling *sampling, double depth_m, double altitude_m);

/* The same depth, roll and pitch: over a flat scene the rest makes no difference. */
bool asdic_quadrature_same_view(const asdic_pose *a, const asdic_pose *b);

void asdic_quadrature_finish(asdic_quadrature_cache *cache);

/* A ping without pulse and speckle; its bytes depend on the view alone. */
asdic_status asdic_quadrature_ping(asdic_simulator *sim, const asdic_pose *pose, asdic_ping *out);

#endif
