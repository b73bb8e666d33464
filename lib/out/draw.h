/*
 * The pictures themselves, on checked arguments; with cairo annotated, else the plain raster.
 */
#ifndef ASDIC_OUT_DRAW_H
#define ASDIC_OUT_DRAW_H

#include "decimate.h"
#include "raster.h"

#include <asdic/output.h>

/* A page of a waterfall: at most this many rows and columns of levels. */
#define ASDIC_WATERFALL_MAX_ROWS 1000
#define ASDIC_WATERFALL_MAX_COLUMNS 1200

/* What a caller may ask of a picture; and of curves, COUNT of them. */
asdic_status asdic_picture_check(asdic_context *ctx, const asdic_picture_options *options);
asdic_status asdic_picture_check_series(asdic_context *ctx, const asdic_series *series,
                                        size_t count);

/* LEVELS holds the averaged levels of WATERFALL, whose own levels are not read. */
asdic_status asdic_draw_waterfall(asdic_context *ctx, const char *path,
                                  const asdic_waterfall *waterfall, const asdic_decimator *levels,
                                  const asdic_picture_options *options);
asdic_status asdic_draw_fan(asdic_context *ctx, const char *path, const asdic_fan *fan,
                            const asdic_picture_options *options);
/* The panels of asdic_picture_ascope, whose legend has each curve that a beam has an array of, empty or not,
 * and whose differences are shown to RESIDUAL_DB either way: what pictures of several pings have in common. */
asdic_status asdic_draw_ascope(asdic_context *ctx, const char *path, const asdic_ascope *beams,
                               size_t beam_count, double residual_db,
                               const asdic_picture_options *options);
/* What holds 95 % of each beam's differences, at a round number; 0 without any. */
asdic_status asdic_ascope_residual_db(asdic_context *ctx, const asdic_ascope *beams,
                                      size_t beam_count, double *residual_db);
asdic_status asdic_draw_plot(asdic_context *ctx, const char *path, const asdic_plot *panels,
                             size_t panel_count, const asdic_picture_options *options);

/* A row of a raw picture: 1..65535 over the window, 0 without energy. */
void asdic_draw_grey(const asdic_picture_options *options, const float *levels_db, size_t bins,
                     double bin_length_m, uint16_t *grey);

/* RASTER shows MAP, its north-western cell in the first pixel. */
asdic_status asdic_draw_map(asdic_context *ctx, const char *path, const asdic_map *map,
                            const asdic_raster *raster, const asdic_picture_options *options);

/* "level window -160..-60 dB, + 30 log r + 0.02 r dB gain for display, ..., NOTE" */
#define ASDIC_NOTE_SIZE 512
void asdic_draw_note(char note[ASDIC_NOTE_SIZE], const asdic_picture_options *options,
                     const asdic_decimator *levels);
/* Between its statements. */
#define ASDIC_NOTE_PART "  \u00b7  "
/* A bearing on a fan's page as its label says it: from -180, which is 180, to 180; of a section the
 * angle below the level. */
double asdic_fan_shown_deg(bool is_section, double bearing_deg);

/* "30 log r + 0.02 r dB" */
#define ASDIC_GAIN_SIZE 80
void asdic_draw_gain(char text[ASDIC_GAIN_SIZE], double db_per_decade, double db_per_m);

/* One statement more. */
void asdic_draw_note_add(char note[ASDIC_NOTE_SIZE], const char *statement);

#endif
