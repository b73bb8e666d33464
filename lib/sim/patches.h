/*
 * Where the scatterers of a coherent ping are: pieces of every surface that the sonar may hear, of the water,
 * and points. A piece is the same, and so are its scatterers, wherever the sonar is; how finely surfaces are
 * cut follows from the distance, and from where transmitter and beams look.
 */
#ifndef ASDIC_SIM_PATCHES_H
#define ASDIC_SIM_PATCHES_H

#include "planes.h"
#include "simulator.h"

#include "../../kernels/coherent.h"

typedef struct asdic_patches {
    dev_patch *items;
    size_t count, capacity;
    size_t slots;        /* scatterers of all patches */
    size_t smooth;       /* of these, of smooth bodies */
    size_t most;         /* no patch is added to more slots than these; 0: any number */
    double per_m2;       /* scatterers on a square metre at 1 m, in the transmitter's beam */
    asdic_planes planes; /* of smooth bodies, from the first ping on */
    bool out_of_memory;
} asdic_patches;

/* Finds the patches for SHOT, about as many scatterers as sampling.rays. */
asdic_status asdic_patches_find(const asdic_simulator *sim, const asdic_ping_shot *shot,
                                asdic_patches *out);

/* The depths of the planes by way of which scatterers are heard; returns how many there are. */
size_t asdic_patches_mirrors(const asdic_simulator *sim, double depth_m[2]);

void asdic_patches_finish(asdic_patches *patches);

#endif
