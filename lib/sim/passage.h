/*
 * The ways that sound may take between the sonar and what lies in the water: straight, and by way
 * of planes that mirror.
 */
#ifndef ASDIC_SIM_PASSAGE_H
#define ASDIC_SIM_PASSAGE_H

#include "eigenray.h"
#include "simulator.h"

/* The water that rays meet on their way, and the planes between which they keep. By way of a plane
 * that mirrors, they go on in its image: to the image of where they end, with nothing but the
 * layers in their way. */
typedef struct asdic_passage {
    asdic_path by;
    const asdic_scatterer *mirror; /* NULL: none */
    double plane_m, top_m, bottom_m;
    asdic_layers layers;
} asdic_passage;

#define ASDIC_MOST_PASSAGES 3

/* Whether Z lies in the water; a sonar out of it sees nothing of what is in it, and the reverse. */
bool asdic_passage_in_water(const asdic_scene *scene, double z_m);

/* From a sonar FROM_M deep: straight first, then by way of the surface and by way of the bottom
 * plane, where they mirror; returns how many. */
size_t asdic_passages_find(const asdic_simulator *sim, double from_m,
                           asdic_passage ways[ASDIC_MOST_PASSAGES]);

/* How deep what lies Z_M deep is for rays that take WAY. */
double asdic_passage_depth_m(const asdic_passage *way, double z_m);

/* The rays by WAY from FROM_M deep to TO_M deep (asdic_passage_depth_m), ACROSS_M away, that of the least spreading first;
 * returns how many. */
size_t asdic_passage_rays(const asdic_passage *way, double from_m, double to_m, double across_m,
                          asdic_eigenray rays[ASDIC_MOST_EIGENRAYS]);

/* Leaves of COUNT of them those that sound of WAVELENGTH_M tells apart; returns how many. */
size_t asdic_passage_waves(const asdic_passage *way, double from_m, double across_m,
                           double wavelength_m, asdic_eigenray *rays, size_t count);

/* --- pairs of ways: where several rays come to a body through layers, what goes out by each of them comes home by all.
 * Rays of a ping go home as they came; what they bring of such a body is louder by what comes home by the others --- */

/* Sets the pairs of PING, which is aimed from POSITION_M with BEAMS (transmitter first): of the parts that
 * asdic_cones_pick finds, by WAY, the straight one of asdic_passages_find. */
void asdic_pairs_place(const asdic_part *parts, size_t part_count, asdic_vec3 position_m,
                       const dev_beam *beams, const asdic_passage *way, dev_ping *ping);

#endif
