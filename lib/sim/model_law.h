/*
 * Scattering laws as `asdic model` asks for them, one angle at a time.
 */
#ifndef ASDIC_SIM_MODEL_LAW_H
#define ASDIC_SIM_MODEL_LAW_H

#include "laws/tabulate.h"

#include <asdic/device.h>

/* What a device reads from the table that begins at word AT of TABLES, for COUNT grazing angles, linear;
 * WIDTH (1, 8, 16) angles a work-item. */
asdic_status asdic_law_table_read(asdic_device *device, const asdic_law_words *tables, dev_uint at,
                                  unsigned width, const double *grazing_rad, size_t count,
                                  double *out);

/* Strength, dB, of MATERIAL in WATER at GRAZING_DEG. DEVICE NULL: in double on the host; else from a
 * table there. */
asdic_status asdic_law_strength_db(asdic_context *ctx, asdic_device *device,
                                   const asdic_material *material, const asdic_law_water *water,
                                   double grazing_deg, double *out);

/* Loss, dB, of one reflection by the smooth face of MATERIAL, whose law has such a row. */
asdic_status asdic_law_loss_db(asdic_context *ctx, asdic_device *device,
                               const asdic_material *material, const asdic_law_water *water,
                               double grazing_deg, double *out);

#endif
