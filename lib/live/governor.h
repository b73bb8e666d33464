/*
 * The ping clock of a view: pings happen at their rate of simulated time. Where a machine cannot
 * follow, rays per ping are lowered to a floor; if that is not enough, time stretches. Rays come
 * back when the machine can follow again.
 */
#ifndef ASDIC_LIVE_GOVERNOR_H
#define ASDIC_LIVE_GOVERNOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct asdic_governor {
    double period_s;
    uint32_t wanted, least, rays;
    bool follows;          /* false: the number of rays is fixed */
    double busy_s, wall_s; /* summed since rays changed */
    size_t steps;
    double stretch; /* of the last steps */
} asdic_governor;

/* The floor of rays below which a picture breaks: so many a beam, or a fan of many beams is dashes. */
#define ASDIC_GOVERNOR_RAYS_A_BEAM 40u
#define ASDIC_GOVERNOR_LEAST_RAYS 2000u
uint32_t asdic_governor_floor(size_t beams);

void asdic_governor_init(asdic_governor *governor, double period_s, uint32_t wanted, uint32_t least,
                         bool follows);

/* The user wants another number of rays. */
void asdic_governor_want(asdic_governor *governor, uint32_t rays);

/* Reports a step that worked for BUSY_S and began WALL_S after the one before (0: the first, or
 * after a pause). True when the number of rays changed. */
bool asdic_governor_note(asdic_governor *governor, double busy_s, double wall_s);

uint32_t asdic_governor_rays(const asdic_governor *governor);

/* Seconds on the wall per second simulated; 1 within 3 %. */
double asdic_governor_stretch(const asdic_governor *governor);

#endif
