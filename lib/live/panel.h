/*
 * What the panels of a frame share: colours, text, boxes. A panel draws itself into its box from the
 * view's state and changes nothing else.
 */
#ifndef ASDIC_LIVE_PANEL_H
#define ASDIC_LIVE_PANEL_H

#include "out/canvas.h"
#include "view_state.h"

#define PANEL_NIGHT_RGB 0x0b0f14u
#define PANEL_BACK_RGB 0x121820u
#define PANEL_EDGE_RGB 0x2a3440u
#define PANEL_LINE_RGB 0x3d4a58u
#define PANEL_DIM_RGB 0x8796a5u
#define PANEL_INK_RGB 0xd9e2eau
#define PANEL_AMBER_RGB 0xffb454u
#define PANEL_CYAN_RGB 0x5ccfe6u
#define PANEL_RED_RGB 0xf2655cu

/* Text sizes at a height of 720 pixels. */
#define PANEL_TEXT_PX 12.5
#define PANEL_SMALL_PX 11.0

typedef struct panel {
    asdic_canvas *canvas;
    asdic_box box;
    double scale; /* of text: the frame's size over 1280 x 720 */
} panel;

/* Background, edge, and a heading in the upper left corner; a NULL heading: none. */
void panel_begin(const panel *p, const char *heading);

/* WHERE in pixels of the frame; the size is scaled. */
void panel_text(const panel *p, asdic_lettering where, uint32_t rgb, const char *text);

/* Ranges under BOX, each with a line down to it through the box, or with a mark below. */
void panel_ranges(const panel *p, asdic_box box, const asdic_plot_axis *range, bool has_lines);

/* A dark plate under a text that lies on a picture. */
void panel_plate(const panel *p, double x, double y, double w, double h);

void panel_sonar(const panel *p, const asdic_view *view);
void panel_ascope(const panel *p, const asdic_view *view);
void panel_chase(const panel *p, const asdic_view *view);
void panel_plan(const panel *p, const asdic_view *view);
void panel_status(const panel *p, const asdic_view *view);

/* The fan and the waterfall; panel_sonar chooses between them. */
void panel_fan(const panel *p, const asdic_view *view);
void panel_waterfall(const panel *p, const asdic_view *view);

/* The colour scale in BOX, its labels to the right. */
void panel_color_bar(const panel *p, asdic_box box, const asdic_picture_options *look);

/* "10 log r"-like words about a time-varied gain; "" without one. */
void panel_gain_words(const asdic_picture_options *look, char words[48]);

#endif
