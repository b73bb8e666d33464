/*
 * Output: pictures. Every file is written as NAME.part and renamed when complete.
 *
 * Levels are dB re 1 uPa; NAN or -INFINITY where there is no energy. The colour window is always
 * given, never derived from one picture, so that pictures can be compared. Annotated pictures need
 * cairo; without it waterfalls and fans are written as the plain raster and line plots fail with
 * ASDIC_ERROR_UNSUPPORTED. A path that ends in .pdf or .svg gives that format (cairo), but of the
 * plain raster and of raw greys, which are PNG whatever the options say.
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

ASDIC_API const char *asdic_colormap_name(asdic_colormap map); /* NULL when out of range */
ASDIC_API bool asdic_colormap_find(const char *name, asdic_colormap *out);

/* Whether axes and titles can be drawn (built with cairo). */
ASDIC_API bool asdic_picture_annotated(void);

/* How a picture is written. Vector files need cairo. */
typedef enum asdic_picture_format {
    ASDIC_PICTURE_BY_NAME, /* PDF or SVG when the path ends so, else PNG */
    ASDIC_PICTURE_PNG,
    ASDIC_PICTURE_PDF,
    ASDIC_PICTURE_SVG
} asdic_picture_format;

typedef struct asdic_picture_options {
    double db_low, db_high; /* window of the colour scale or of a level axis */
    asdic_colormap colormap;
    /* Time-varied gain, for display only and stated on the picture; 0: none. */
    double tvg_db_per_decade, tvg_db_per_m;
    const char *title; /* NULL: none; a second line is a subtitle */
    const char *note;  /* small line below the picture; NULL: none */
    /* PNG text chunks, in a PDF title and keywords: key, value, ..., NULL; may be NULL.
     * A key without a value ends them. */
    const char *const *texts;
    asdic_picture_format format;
} asdic_picture_options;

/* -160..-60 dB, viridis, no gain, no title. */
ASDIC_API asdic_picture_options asdic_picture_options_default(void);

/* What the levels of a picture hang on, for its subtitle: "750 kHz, bandwidth 186 kHz, bins of
 * 0.1 m, source level 200 dB re 1 uPa at 1 m"; where the source level is 0 dB and there is no
 * noise, which is absolute, that levels are re it. TEXT has room for ASDIC_SUBTITLE_SIZE
 * characters; empty without a sonar. */
#define ASDIC_SUBTITLE_SIZE 256
ASDIC_API void asdic_picture_subtitle(const asdic_sonar *sonar, double bin_length_m, char *text);

/* One beam over time. LEVELS_DB[ping * bins + bin]. */
typedef struct asdic_waterfall {
    const float *levels_db;
    size_t pings, bins;
    double bin_length_m;
    double first_time_s, ping_period_s; /* period 0: the time axis counts pings */
} asdic_waterfall;

/* Range to the right, time down with the first ping at the top. More pings or bins than a page
 * resolves are averaged in energy, and the picture says so. */
ASDIC_API asdic_status asdic_picture_waterfall(asdic_context *ctx, const char *path,
                                               const asdic_waterfall *waterfall,
                                               const asdic_picture_options *options);

/* One ping over bearing. LEVELS_DB[beam * bins + bin], BEARING_RAD positive to starboard, ascending
 * or descending throughout. A polar sector: apex at the bottom centre, ahead up, starboard right.
 * Of a section the bearings are clockwise on the page from straight up, so that pi is below the
 * apex, and directions are labelled by their angle below the level. */
typedef struct asdic_fan {
    const float *levels_db;
    const double *bearing_rad;
    size_t beams, bins;
    double bin_length_m;
    bool is_section;
} asdic_fan;

ASDIC_API asdic_status asdic_picture_fan(asdic_context *ctx, const char *path, const asdic_fan *fan,
                                         const asdic_picture_options *options);

/* The plain raster: one pixel per level in 8-bit colour, white where there is no energy. */
ASDIC_API asdic_status asdic_picture_raster(asdic_context *ctx, const char *path,
                                            const asdic_waterfall *waterfall,
                                            const asdic_picture_options *options);

/* 16-bit grey: 1..65535 linear in dB over the window, 0 where there is no energy. */
ASDIC_API asdic_status asdic_picture_raw(asdic_context *ctx, const char *path,
                                         const asdic_waterfall *waterfall,
                                         const asdic_picture_options *options);

typedef enum asdic_line_style {
    ASDIC_LINE_SOLID,
    ASDIC_LINE_DASHED,
    ASDIC_LINE_DOTTED,
    ASDIC_LINE_DASH_DOT
} asdic_line_style;

/* A curve; points that are not finite interrupt it. */
typedef struct asdic_series {
    const char *label; /* in the legend; NULL: not there */
    const double *x, *y;
    size_t count;
    uint32_t rgb; /* 0xRRGGBB */
    double width; /* 1: a thin line */
    asdic_line_style style;
} asdic_series;

typedef struct asdic_plot_axis {
    const char *label;
    double low, high; /* low < high; both positive when logarithmic */
    bool logarithmic;
    const char *const *names; /* of 1, 2, ..., the only ticks, in place of numbers; NULL: none */
    size_t name_count;
} asdic_plot_axis;

/* A panel of curves; several are stacked and get one legend. */
typedef struct asdic_plot {
    const char *title; /* NULL: none */
    asdic_plot_axis x, y;
    const asdic_series *series;
    size_t series_count;
} asdic_plot;

/* Line plots; of OPTIONS only title, note, texts and format are used. */
ASDIC_API asdic_status asdic_picture_plot(asdic_context *ctx, const char *path,
                                          const asdic_plot *panels, size_t panel_count,
                                          const asdic_picture_options *options);

/* A map fixed in the world, seen from above. VALUES[row * columns + column]: rows go north, columns
 * east; NAN: unknown. */
typedef struct asdic_map {
    const float *values;
    size_t rows, columns;
    double north_m, east_m, cell_m; /* south-western corner; side of a cell */
    const char *label;              /* of the values; NULL: none */
    const asdic_series *lines;      /* drawn over it: x east, y north, metres; may be NULL */
    size_t line_count;
} asdic_map;

/* North up, east to the right, both to one scale; OPTIONS->db_low..db_high is the window of the
 * values. Of more cells than a page resolves each pixel shows the greatest value, and the picture
 * says so. */
ASDIC_API asdic_status asdic_picture_map(asdic_context *ctx, const char *path, const asdic_map *map,
                                         const asdic_picture_options *options);

/* Echo level over range of one beam; a NULL array is left out of the picture. */
typedef struct asdic_ascope {
    const char *title; /* of the panel, "beam 'forward'" */
    size_t bins;
    double bin_length_m;
    const float *simulated_db; /* thin black */
    const float *total_db;     /* expected total: broad grey */
    const float *bottom_db;    /* dashed */
    const float *surface_db;   /* dotted */
    const float *volume_db;    /* dash-dot */
    const float *noise_db;     /* thin */
    const float *object_db;    /* solid */
    const float *multipath_db; /* solid */
} asdic_ascope;

/* One panel per beam (1..8), ordinate OPTIONS->db_low..db_high. */
ASDIC_API asdic_status asdic_picture_ascope(asdic_context *ctx, const char *path,
                                            const asdic_ascope *beams, size_t beam_count,
                                            const asdic_picture_options *options);

#ifdef __cplusplus
}
#endif

#endif
