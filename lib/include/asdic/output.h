/*
 * Output: CSV bins and pictures. Every file is written as NAME.part and renamed when complete.
 */
#ifndef ASDIC_OUTPUT_H
#define ASDIC_OUTPUT_H

#include <asdic/ping.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum asdic_colormap {
    ASDIC_COLORMAP_VIRIDIS,
    ASDIC_COLORMAP_CIVIDIS,
    ASDIC_COLORMAP_INFERNO,
    ASDIC_COLORMAP_GRAY,
    ASDIC_COLORMAP_COPPER,
    ASDIC_COLORMAP_COUNT
} asdic_colormap;

typedef struct asdic_picture_options {
    double db_low, db_high; /* window of the colour scale */
    asdic_colormap colormap;
    double tvg_db_per_decade; /* 0: none. Time-varied gain, for display only, stated on the picture */
    double tvg_db_per_m;
    const char *title;        /* NULL: none */
    const char *const *texts; /* PNG text chunks: key, value, key, value, ..., NULL; may be NULL */
} asdic_picture_options;

ASDIC_API asdic_picture_options asdic_picture_options_default(void);

/* Waterfall: LEVELS_DB[ping * bins + bin], NAN or -INFINITY where there is no energy; range to the
 * right, time down with the first ping at the top. */
ASDIC_API asdic_status asdic_picture_waterfall(asdic_context *ctx, const char *path,
                                               const float *levels_db, size_t pings, size_t bins,
                                               double bin_length_m, double ping_period_s,
                                               const asdic_picture_options *options);

#ifdef __cplusplus
}
#endif

#endif
