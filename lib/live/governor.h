/*
 * The ping clock of a view: pings happen at their rate of simulated time. Where a machine cannot
 * follow, rays per ping are lowered, and as many bins shown as one as keep the picture whole; at a
 * floor of rays time stretches. Rays come back when the machine can follow again.
 */
#ifndef ASDIC_LIVE_GOVERNOR_H
#define ASDIC_LIVE_GOVERNOR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct asdic_governor {
    double period_s;
    uint32_t wanted, least, rays;
    bool follows;  /* false: the number of rays is fixed */
    double busy_s; /* summed since rays changed */
    size_t steps;
    double stretch; /* of the last steps */
} asdic_governor;

/* A beam of so many bins, or more that are shown as so many, needs so many rays; of fewer, a fan of
 * many beams is dashes. Measured on 512 beams of 496 bins over sand, r.m.s. error of what is shown:
 * 20,480 rays 5.7 dB, four bins as one 1.7 dB; 40,960 rays 3.2 dB and 0.42 dB; 200,000 rays
 * 0.28 dB. */
#define ASDIC_GOVERNOR_BINS 120u
#define ASDIC_GOVERNOR_RAYS_A_BEAM 80u
#define ASDIC_GOVERNOR_LEAST_RAYS 2000u

/* The floor of rays, and the rays with which every bin can be shown. */
uint32_t asdic_governor_floor(size_t beams);
uint32_t asdic_governor_enough(size_t beams, size_t bins);

/* How many bins of a ping of RAYS are shown as one, their mean: a power of two. */
size_t asdic_governor_joined(uint32_t rays, size_t beams, size_t bins);

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
