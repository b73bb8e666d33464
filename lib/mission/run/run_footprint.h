/*
 * The areas where beams meet the bottom, seen from above.
 */
#ifndef ASDIC_MISSION_RUN_FOOTPRINT_H
#define ASDIC_MISSION_RUN_FOOTPRINT_H

#include "out/draw_chart.h"
#include "sim/layers.h"

#include <asdic/sonar.h>

typedef struct asdic_seafloor {
    const asdic_relief *relief; /* no columns: none */
    double plane_depth_m;       /* of a flat bottom; INFINITY: none */
} asdic_seafloor;

/* Depth of the bottom at a place; INFINITY where there is none. */
double asdic_seafloor_depth_m(const asdic_seafloor *ground, double north_m, double east_m);

typedef struct asdic_swath {
    const asdic_beam *beams; /* one, or several side by side that make one area */
    size_t count;
    double wavelength_m, range_m;
    const asdic_layers *layers; /* of water that bends rays; NULL: they are straight */
    bool is_rough;              /* a beam alone has five directions across in place of seventeen */
} asdic_swath;

/* As few beams as these have each an area of its own. */
#define ASDIC_SWATH_APART 8

/* Sets SWATH's beams: those of SONAR from the one at INDEX on that make one area. Of more than ASDIC_SWATH_APART beams
 * these are all of a fan; else those at ascending bearings whose lobes touch, for an outline round others would enclose
 * what no beam sees. SWATH's wavelength counts. */
void asdic_swath_take(asdic_swath *swath, const asdic_sonar *sonar, size_t index);

/* Outline of the area where the main lobes (half power, one way) meet the bottom within the range,
 * for a vehicle at POSE. Lobes that do not meet it are drawn themselves, dashed, out to the range.
 * OUT's coordinates are freed by _finish. */
asdic_status asdic_footprint_find(asdic_context *ctx, const asdic_swath *swath,
                                  const asdic_pose *pose, const asdic_seafloor *ground,
                                  asdic_chart_area *out);
void asdic_footprint_finish(asdic_chart_area *area);

#endif
