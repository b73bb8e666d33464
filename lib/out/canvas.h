/*
 * A page drawn with cairo, shared by all annotated pictures. libpng writes the pixels, so that text
 * chunks are possible; .pdf and .svg paths give vector files.
 */
#ifndef ASDIC_OUT_CANVAS_H
#define ASDIC_OUT_CANVAS_H

#include "axis.h"
#include "raster.h"

#include <cairo.h>

/* Sizes in pixels; a picture of 1400 is 17 cm wide in print. */
#define ASDIC_TEXT_PX 18.0
#define ASDIC_TITLE_PX 22.0
#define ASDIC_NOTE_PX 14.0
#define ASDIC_MARGIN_PX 20.0
#define ASDIC_BAR_PX 24.0 /* width of a colour scale */

#define ASDIC_PAPER_RGB 0xffffffu
#define ASDIC_INK_RGB 0x202020u

typedef struct asdic_canvas {
    asdic_context *ctx;
    cairo_surface_t *surface;
    cairo_t *cr;
    asdic_picture_format format;
    struct asdic_file *vector_file; /* PDF, SVG */
    double width, height;
} asdic_canvas;

typedef struct asdic_box {
    double x, y, w, h;
} asdic_box;

/* OUT is all zeros but for its FORMAT. */
asdic_status asdic_canvas_init(asdic_context *ctx, const char *path, double width, double height,
                               uint32_t background_rgb, asdic_canvas *out);
/* Writes the file. */
asdic_status asdic_canvas_save(asdic_canvas *canvas, const char *path, const char *const *texts);
void asdic_canvas_finish(asdic_canvas *canvas);

/* Width of TEXT without a canvas, to lay one out. */
double asdic_canvas_text_width(const char *text, double size_px);

void asdic_canvas_color(asdic_canvas *canvas, uint32_t rgb);

/* ALIGN_X: 0 left, 0.5 centred, 1 right of X; ALIGN_Y: 0 baseline on Y, 0.5 centred, 1 below. */
typedef struct asdic_lettering {
    double x, y, align_x, align_y, size_px;
    bool bold, upwards;
} asdic_lettering;

void asdic_canvas_text(asdic_canvas *canvas, asdic_lettering where, const char *text);

/* Makes the text smaller, down to 10 pixels, until it fits MAX_WIDTH_PX. */
void asdic_canvas_text_fit(asdic_canvas *canvas, asdic_lettering where, const char *text,
                           double max_width_px);

/* Height that TITLE needs at the top of a page, 0 when it is NULL. A second line is a subtitle. */
double asdic_canvas_title_room(const char *title);

/* Height that NOTE needs at the bottom of a page of WIDTH from X on, 0 when it is NULL or empty. Its
 * statements, parted by ASDIC_NOTE_PART, take as many rows as they need. */
double asdic_canvas_note_room(const char *note, double x, double width);

/* The page's TITLE at its top and NOTE at its bottom, both from X on; either may be NULL. */
void asdic_canvas_frame_text(asdic_canvas *canvas, double x, const char *title, const char *note);

/* Pixels without smoothing, stretched into BOX. */
void asdic_canvas_raster(asdic_canvas *canvas, const asdic_raster *raster, asdic_box box);

void asdic_canvas_line(asdic_canvas *canvas, double x0, double y0, double x1, double y1);

/* A line of one pixel round BOX. */
void asdic_canvas_frame(asdic_canvas *canvas, asdic_box box);

/* Colour, width and dashes of a curve; NULL: a solid line of one pixel again. */
void asdic_canvas_set_style(asdic_canvas *canvas, const asdic_series *series);

/* A curve within BOX, which has these axes. What lies outside is the caller's to clip. */
void asdic_canvas_curve(asdic_canvas *canvas, asdic_box box, const asdic_plot_axis *x_axis,
                        const asdic_plot_axis *y_axis, const asdic_series *series);

/* Labelled entries side by side at the top of BOX, as wide as it, in as many rows as they need;
 * with CANVAS NULL only measures. Returns the height. */
double asdic_canvas_legend(asdic_canvas *canvas, asdic_box box, const asdic_series *entries,
                           size_t count);

/* Ticks and labels below BOX / left of BOX; GRID draws light lines across. */
void asdic_canvas_axis_x(asdic_canvas *canvas, asdic_box box, const asdic_plot_axis *axis,
                         bool grid);
void asdic_canvas_axis_y(asdic_canvas *canvas, asdic_box box, const asdic_plot_axis *axis,
                         bool down, bool grid);
/* The axis of levels with what is added for display; that of PINGS, by number unless PERIOD_S is known. */
asdic_plot_axis asdic_canvas_level_axis(const asdic_picture_options *options);
asdic_plot_axis asdic_canvas_time_axis(double pings, double first_s, double period_s);
/* The side of each of COUNT cells in a row: whole pixels keep the raster crisp. */
double asdic_canvas_pixels_each(size_t count, double fill_px, double most_px,
                                double least_total_px);
/* Width that an ordinate's labels and title need left of its box. */
double asdic_canvas_axis_y_room(const asdic_plot_axis *axis, double height_px);

/* A colour scale along AXIS in BOX, low at the bottom (or, DOWN, at the top) with labels to its
 * right. Low is the map's first colour, unless DOWN: then high is. */
void asdic_canvas_scale(asdic_canvas *canvas, asdic_box box, const asdic_plot_axis *axis,
                        asdic_colormap map, bool down);

/* The scale of levels; _room is what its labels need beside the box. */
void asdic_canvas_color_bar(asdic_canvas *canvas, asdic_box box,
                            const asdic_picture_options *options);
double asdic_canvas_color_bar_room(const asdic_picture_options *options, double height_px);

#endif
