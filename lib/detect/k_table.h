/*
 * K speckle's tail and density as a table over intensity re the mean and the noise's share, of one number of looks
 * and one shape: as integrals over the texture they take some 10 us each.
 *
 * What is tabled are logarithms, over ln(intensity / mean) and ln(noise / clutter), with polynomials of the fifth
 * degree between nodes. A tail of 1e-12 and more is within 4e-5 of its integral. A node is computed when it is first
 * asked for, and does not depend on when that is.
 */
#ifndef ASDIC_DETECT_K_TABLE_H
#define ASDIC_DETECT_K_TABLE_H

#include <asdic/scan.h>

typedef struct asdic_k_table asdic_k_table;

/* Makes *TABLE, which may be NULL, that of LAW's looks and shape, unless it is. NULL where speckle is Rayleigh, of
 * more than 64 looks, which take too many nodes, and for so few BINS that these are computed sooner. */
asdic_status asdic_k_table_fit(asdic_context *ctx, const asdic_background *law, size_t bins,
                               asdic_k_table **table);
void asdic_k_table_destroy(asdic_k_table **table);

/* asdic_detect_pd and asdic_detect_llr, with a target of Swerling II, over a background whose looks and shape are the
 * TABLE's. Outside the table, or without one, they are computed. */
double asdic_k_table_pd(asdic_k_table *table, const asdic_background *b, double target_lin,
                        double threshold_lin);
double asdic_k_table_llr(asdic_k_table *table, const asdic_background *b, double target_lin,
                         double intensity_lin);

/* ln of the density of an intensity by A re that by B, both with the looks and shape of the TABLE. */
double asdic_k_table_ratio(asdic_k_table *table, const asdic_background *a,
                           const asdic_background *b, double intensity_lin);

#endif
