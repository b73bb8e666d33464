/*
 * Levels to pixels, without any drawing library: the same bytes on every machine.
 */
#ifndef ASDIC_OUT_RASTER_H
#define ASDIC_OUT_RASTER_H

#include <asdic/output.h>
#include <asdic/sonar.h>

typedef struct asdic_raster {
    size_t width, height;
    uint8_t *rgb; /* 3 * width * height, row by row from the top */
} asdic_raster;

asdic_status asdic_raster_init(asdic_context *ctx, size_t width, size_t height, asdic_raster *out);
void asdic_raster_finish(asdic_raster *raster);

void asdic_raster_set(asdic_raster *raster, size_t x, size_t y, uint32_t rgb);

/* Step of the colour scale, 0..255, of LEVEL_DB in the window; saturates at its ends. */
unsigned asdic_raster_index(const asdic_picture_options *options, double level_db);

/* The window of levels that shows COUNT of them: from the 5th to the 99.5th percentile, rounded
 * outwards to 10 dB, as the pictures of a run have it; at least 30 dB. */
asdic_status asdic_raster_window(asdic_context *ctx, const float *levels_db, size_t count,
                                 double *low_db, double *high_db);

/* The level to display at RANGE_M: with the time-varied gain; NAN where there is no energy. */
double asdic_raster_gain(const asdic_picture_options *options, double level_db, double range_m);

/* Colour of LEVEL_DB at RANGE_M, EMPTY_RGB where there is no energy. */
uint32_t asdic_raster_color(const asdic_picture_options *options, double level_db, double range_m,
                            uint32_t empty_rgb);

/* One pixel per level. */
asdic_status asdic_raster_levels(asdic_context *ctx, const asdic_waterfall *image,
                                 const asdic_picture_options *options, asdic_raster *out);

/* How many beams, from the first on, lie in a fan by bearing: their bearings ascend, or all
 * descend, and none looks straight up or down. */
size_t asdic_beams_in_fan(const asdic_sonar *sonar);

/* Whether the beams make a fan: three or more, and all lie in it. */
bool asdic_beams_make_fan(const asdic_sonar *sonar);

/* Whether the beams of a fan are listed from starboard to port. */
bool asdic_beams_descend(const asdic_beam *beams, size_t count);

/* The index of the beam of a fan that is number I, from 0, from port. */
size_t asdic_beam_from_port(const asdic_beam *beams, size_t count, size_t i);

/* Where a polar sector lies in its bounding box of pixels: ahead up, starboard right. */
typedef struct asdic_sector {
    double radius_px;         /* of the farthest bin's far end */
    double low_rad, high_rad; /* outer edges of the outer beams */
    double apex_x_px, apex_y_px;
    size_t width, height;
} asdic_sector;

asdic_sector asdic_sector_of(const asdic_fan *fan, double radius_px);

/* The beams' half-way bearings and the ends of the fan, EDGES[beams + 1], in the order of the
 * beams. */
void asdic_fan_edges(const asdic_fan *fan, double *edges);

/* The beam whose EDGES enclose BEARING, or that and whole turns; BEAMS where none does. */
size_t asdic_fan_beam(const double *edges, size_t beams, double bearing);

/* The cell beam * bins + bin of each pixel, UINT32_MAX outside; *CELLS is freed with free(). */
asdic_status asdic_sector_cells(asdic_context *ctx, const asdic_fan *fan,
                                const asdic_sector *sector, uint32_t **cells);

asdic_status asdic_raster_fan(asdic_context *ctx, const asdic_fan *fan, const asdic_sector *sector,
                              const asdic_picture_options *options, uint32_t background_rgb,
                              asdic_raster *out);

asdic_status asdic_raster_write(asdic_context *ctx, const char *path, const asdic_raster *raster,
                                const char *const *texts);

#endif
