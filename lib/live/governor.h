/*
 * The honest clock: pings happen at their rate of simulated time. When a machine cannot follow, rays
 * per ping are lowered, to a floor; what is still late stretches time. When it can again, rays come
 * back.
 */
#ifndef ASDIC_LIVE_GOVERNOR_H
#define ASDIC_LIVE_GOVERNOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct asdic_governor {
    double period_s;
    uint32_t wanted, least, rays;
    bool follows;          /* false: rays are what is wanted, whatever it takes */
    double busy_s, wall_s; /* summed since rays changed */
    size_t steps;
    double stretch; /* of the last steps */
} asdic_governor;

void asdic_governor_init(asdic_governor *governor, double period_s, uint32_t wanted, uint32_t least,
                         bool follows);

/* The user wants another number of rays. */
void asdic_governor_want(asdic_governor *governor, uint32_t rays);

/* A step worked for BUSY_S and began WALL_S after the one before it (0: it was the first, or came
 * after a pause). True when the rays changed. */
bool asdic_governor_note(asdic_governor *governor, double busy_s, double wall_s);

uint32_t asdic_governor_rays(const asdic_governor *governor);

/* Seconds on the wall per second simulated; 1 within 3 %. */
double asdic_governor_stretch(const asdic_governor *governor);

#endif
