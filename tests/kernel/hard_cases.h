/*
 * Cases that break simulators: each measures one error, which the table in test_hard_cases.c holds to
 * a tolerance.
 */
#ifndef ASDIC_TEST_HARD_CASES_H
#define ASDIC_TEST_HARD_CASES_H

#include "test_device.h"

#include <stdbool.h>

extern test_device hard_device;
extern bool hard_full; /* the full tier: ten times the rays */

/* hard_numbers.c: formulas and sums in single precision */
double hard_bottom_law(void);
double hard_surface_law(void);
double hard_patterns_beside_nulls(void);
double hard_facet_law(void);
double hard_zero_energy(void);
double hard_wrong_input(void);
double hard_one_bin(void);
double hard_same_bytes(void);
double hard_quiet_source(void);
double hard_dynamic_range(void);
double hard_faint_object(void);

/* hard_geometry.c: meshes */
double hard_shared_edges(void);
double hard_slivers(void);
double hard_far_coordinates(void);
double hard_limb(void);
double hard_wall_on_edge(void);
double hard_tiny_sphere(void);
double hard_inside_hull(void);

/* hard_planes.c: flat scenes against quadrature */
double hard_bin_edges(void);
double hard_zenith(void);
double hard_near_zenith(void);
double hard_nadir(void);
double hard_nulls(void);
double hard_below_a_metre(void);
double hard_long_bin(void);
double hard_on_the_bottom(void);
double hard_on_the_bottom_in_layers(void);
double hard_over_the_bottom_in_layers(void);
double hard_in_the_surface(void);
double hard_bent_off_the_bottom(void);
double hard_where_blanking_ends(void);
double hard_in_the_surface_in_layers(void);
double hard_between_layers(void);
double hard_every_attitude(void);
double hard_narrow_bins(void);
double hard_absorbed(void);
double hard_looking_back(void);
double hard_leaking_back(void);

#endif
