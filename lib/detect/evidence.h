/*
 * What a ping says of an object in every direction and at every range.
 *
 * Directions lie on arcs through the axes of beams of one elevation, a quarter of a beam's width
 * apart. In each, all beams that hear it are asked at once: for an object of strength S, beam b
 * expects its background mu_b and S times its two-way pattern there, G_b, so that the likelihood
 * ratio is
 *
 *     L(S) = prod_b [p(z_b | mu_b + S G_b) / p(z_b | mu_b)]^w_b
 *
 * with echoes of independent looks (Swerling II). Beams that overlap hear in part the same:
 * w_b = 1 / sum_b' R_b(axis of b'), the correlation of intensities in a diffuse field being the
 * receiver's pattern at the other's axis; a product with weights that add to one over equal looks
 * has a mean of 1 at most without an object (composite likelihood: Varin, Reid & Firth, Statistica
 * Sinica 21, 5 (2011)). The strength S is as likely the detector's, S0, as above it, there with the
 * density S0 / S^2; L(S) is that narrow in ln S that its greatest value stands for its mean.
 *
 * An echo that stands 15 dB above the background is heard beyond the beams that look to it. The
 * directions that its loudest beam hears are therefore compared by the same beams, all that hear one
 * of them, with G_b down into their side lobes.
 *
 * An echo that is found is then part of the background of all directions farther than a beam's
 * width from its own, by its pattern there: side lobes are explained by the echo in the main lobe
 * (CLEAN: Hogbom, Astron. Astrophys. Suppl. 15, 417 (1974)).
 */
#ifndef ASDIC_DETECT_EVIDENCE_H
#define ASDIC_DETECT_EVIDENCE_H

#include "k_table.h"

#include <asdic/scan.h>

/* Greatest ln of a ratio of likelihoods that exp can hold; round a stronger echo all are less by as much. */
#define ASDIC_RATIO_MOST_LN 600.0

/* A direction of an arc. */
typedef struct asdic_heading {
    double elevation_rad, half_height_rad; /* positive down; half the vertical width */
    double slope, slope_low, slope_high;   /* down over away: on the arc, at its edges */
    double width_rad;                      /* half-power width of the beam that hears it best */
    size_t hearing, hearing_count;         /* in asdic_evidence.hearings; 0: not heard */
} asdic_heading;

typedef struct asdic_hearing {
    size_t beam;
    double gain_lin; /* of the pattern there, re the axis of the beam that hears it best */
    double weight;
} asdic_hearing;

typedef struct asdic_evidence {
    size_t arcs, azimuths, bins;
    double step_rad;         /* azimuth k is k steps from north */
    asdic_heading *headings; /* [arc * azimuths + azimuth] */
    asdic_hearing *hearings;
    size_t hearing_count, hearing_room;
    double *ratio; /* [heading * bins + bin], of likelihoods; NAN: nothing known; not set where not
                    * heard */
} asdic_evidence;

/* As asdic_beam_width_rad, in the vertical. */
double asdic_beam_height_rad(const asdic_sonar *sonar, size_t receiver, double sound_speed_mps);

/* Where in the plane a beam along AXIS is asked. */
typedef struct asdic_hearing_range {
    double plane_share; /* of the slant range, at most; 0: it is not asked */
    double aside_rad;   /* to either side of the axis */
} asdic_hearing_range;

asdic_hearing_range asdic_evidence_range(const asdic_sonar *sonar, size_t receiver, asdic_vec3 axis,
                                         double sound_speed_mps);

/* K_TABLE is of LOOK's law, or NULL. */
asdic_status asdic_evidence_create(asdic_context *ctx, const asdic_look *look,
                                   asdic_k_table *k_table, asdic_evidence *out);
void asdic_evidence_finish(asdic_evidence *footprint);

/* asdic_occupancy_add with a TABLE, or NULL, of LOOK's law. */
asdic_status asdic_occupancy_add_tabled(asdic_context *ctx, asdic_occupancy *map,
                                        const asdic_look *look, asdic_k_table *table);

#endif
