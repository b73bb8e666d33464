/*
 * Terrain as pixels: coloured by depth, shaded as if lit from the north-west.
 */
#ifndef ASDIC_OUT_RASTER_RELIEF_H
#define ASDIC_OUT_RASTER_RELIEF_H

#include "base/relief.h"
#include "raster.h"

/* Least and greatest depth of the bottom's cells within the limits, never equal; false where there is
 * none. */
bool asdic_relief_span(const asdic_relief *relief, double west_m, double east_m, double south_m,
                       double north_m, double *low_m, double *high_m);

typedef struct asdic_relief_look {
    double low_m, high_m;     /* least and greatest depth shown, low_m < high_m */
    uint32_t bottom_rgb[256]; /* from the greatest depth to the least */
    uint32_t object_rgb;
    uint32_t empty_rgb; /* where there is nothing */
} asdic_relief_look;

/* One pixel per cell. */
asdic_status asdic_raster_relief(asdic_context *ctx, const asdic_relief *relief,
                                 const asdic_relief_look *look, asdic_raster *out);

#endif
