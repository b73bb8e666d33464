/*
 * Terrain as pixels: coloured by depth, shaded as if lit from the north-west.
 */
#ifndef ASDIC_OUT_RASTER_RELIEF_H
#define ASDIC_OUT_RASTER_RELIEF_H

#include "base/relief.h"
#include "raster.h"

/* Least and greatest depth of the cells within the limits, never equal; false where there is none. */
bool asdic_relief_span(const asdic_relief *relief, double west_m, double east_m, double south_m,
                       double north_m, double *low_m, double *high_m);

/* One pixel per cell; the map's last colour is the least depth. */
asdic_status asdic_raster_relief(asdic_context *ctx, const asdic_relief *relief, double low_m,
                                 double high_m, asdic_colormap map, uint32_t empty_rgb,
                                 asdic_raster *out);

#endif
