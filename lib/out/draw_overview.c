#include "canvas.h"

#include "base/try.h"
#include "colormap.h"
#include "draw.h"
#include "overview.h"

#include <math.h>
#include <stdio.h>

#define GAP_PX 28.0
#define PANEL_PX 480.0
#define MOST_NAMES 16 /* more beams are numbered */

typedef struct page {
    asdic_box box[2], bar[2];
    asdic_plot_axis beams, time, scale[2];
    double width, height;
} page;

static page lay_out(const asdic_overview *o, const asdic_overview_axes *axes,
                    const asdic_picture_options *options, const char *note) {
    double pings = (double)(o->rows * o->ping_group), beams = (double)(o->columns * o->beam_group);
    page p = {.beams = {.label = "beam", .low = -0.5, .high = beams - 0.5},
              .time = asdic_canvas_time_axis(pings, axes->first_time_s, axes->ping_period_s),
              .scale = {asdic_canvas_level_axis(options),
                        {.label = "range (m)", .high = (double)o->bins * o->bin_length_m}}};
    double wide =
        (double)o->columns * asdic_canvas_pixels_each(o->columns, PANEL_PX, PANEL_PX, 0.0);
    double high = (double)o->rows * asdic_canvas_pixels_each(o->rows, 720.0, 240.0, 0.0);
    double x = ASDIC_MARGIN_PX + ceil(asdic_canvas_axis_y_room(&p.time, high));
    for (int i = 0; i < 2; i++) {
        p.box[i] = (asdic_box){
            x, ASDIC_MARGIN_PX + asdic_canvas_title_room(options->title) + 1.6 * ASDIC_TEXT_PX,
            wide, high};
        p.bar[i] = (asdic_box){x + wide + GAP_PX, p.box[i].y, ASDIC_BAR_PX, high};
        x = p.bar[i].x + ASDIC_BAR_PX + ceil(asdic_canvas_axis_y_room(&p.scale[i], high)) + GAP_PX +
            (i == 0 ? ceil(asdic_canvas_axis_y_room(&p.time, high)) : 0.0);
    }
    p.width = x - GAP_PX + ASDIC_MARGIN_PX;
    p.height = p.box[0].y + high + 4.0 * ASDIC_TEXT_PX + ASDIC_MARGIN_PX +
               asdic_canvas_note_room(note, p.box[0].x, p.width);
    return p;
}

static asdic_status draw_panel(asdic_canvas *c, asdic_box box, const asdic_overview *o,
                               const double *values, const asdic_plot_axis *scale,
                               asdic_colormap map) {
    asdic_raster raster;
    TRY(asdic_raster_init(c->ctx, o->columns, o->rows, &raster));
    for (size_t i = 0; i < o->rows * o->columns; i++) {
        double share = (values[i] - scale->low) / (scale->high - scale->low);
        uint32_t rgb = ASDIC_PAPER_RGB;
        if (!isnan(share)) {
            rgb = asdic_colormap_rgb(map, (unsigned)fmin(fmax(256.0 * share, 0.0), 255.0));
        }
        asdic_raster_set(&raster, i % o->columns, i / o->columns, rgb);
    }
    asdic_canvas_raster(c, &raster, box);
    asdic_raster_finish(&raster);
    return ASDIC_OK;
}

#define LEAST_PX 10.0   /* of a name, as asdic_canvas_text_fit makes it */
#define NAME_GAP_PX 8.0 /* between neighbours: 000 and 001 are not to be read as 000001 */

static double name_room(asdic_box box, const asdic_overview *o) {
    return box.w / (double)o->beams - NAME_GAP_PX;
}

/* Whether there are names that can be told apart below the columns; else these are numbered. */
static bool has_names(asdic_box box, const asdic_overview *o, const char *const *names) {
    bool fit = names && o->beams <= MOST_NAMES;
    for (size_t i = 0; fit && i < o->beams; i++) {
        fit = asdic_canvas_text_width(names[i], LEAST_PX) <= name_room(box, o);
    }
    return fit;
}

/* Names below the columns, each in the room it has. */
static void name_beams(asdic_canvas *c, asdic_box box, const asdic_overview *o,
                       const char *const *names) {
    double each = box.w / (double)o->beams;
    for (size_t i = 0; i < o->beams; i++) {
        asdic_canvas_text_fit(c,
                              (asdic_lettering){.x = box.x + ((double)i + 0.5) * each,
                                                .y = box.y + box.h + 12.0,
                                                .align_x = 0.5,
                                                .align_y = 1.0,
                                                .size_px = ASDIC_TEXT_PX},
                              names[i], name_room(box, o));
    }
    asdic_canvas_text(c,
                      (asdic_lettering){.x = box.x + 0.5 * box.w,
                                        .y = box.y + box.h + 16.0 + 1.5 * ASDIC_TEXT_PX,
                                        .align_x = 0.5,
                                        .align_y = 1.0,
                                        .size_px = ASDIC_TEXT_PX},
                      "beam");
}

static void note_groups(char note[ASDIC_NOTE_SIZE], const asdic_overview *o,
                        const asdic_picture_options *options) {
    char above[128];
    asdic_draw_note(note, options, NULL);
    snprintf(above, sizeof above,
             "white: no echo %.0f dB above the noise or %.1f dB and its error above its "
             "neighbourhood",
             ASDIC_OVERVIEW_ABOVE_NOISE_DB, ASDIC_OVERVIEW_ABOVE_REST_DB);
    asdic_draw_note_add(note, above);
    if (o->ping_group > 1 || o->beam_group > 1) {
        char text[128];
        snprintf(text, sizeof text, "each pixel is the strongest of %zu ping%s \u00d7 %zu beam%s",
                 o->ping_group, o->ping_group > 1 ? "s" : "", o->beam_group,
                 o->beam_group > 1 ? "s" : "");
        asdic_draw_note_add(note, text);
    }
}

asdic_status asdic_draw_overview(asdic_context *ctx, const char *path,
                                 const asdic_overview *overview, const asdic_overview_axes *axes,
                                 const asdic_picture_options *options) {
    char note[ASDIC_NOTE_SIZE];
    asdic_canvas canvas = {.format = options->format};
    const double *values[2] = {overview->shown_db, overview->range_m};
    note_groups(note, overview, options);
    page p = lay_out(overview, axes, options, note);
    asdic_status status = asdic_canvas_init(ctx, path, p.width, p.height, ASDIC_PAPER_RGB, &canvas);
    for (int i = 0; i < 2 && status == ASDIC_OK; i++) {
        asdic_canvas_set_style(&canvas, NULL);
        status = draw_panel(&canvas, p.box[i], overview, values[i], &p.scale[i], options->colormap);
        asdic_canvas_color(&canvas, ASDIC_INK_RGB);
        if (has_names(p.box[i], overview, axes->names)) {
            name_beams(&canvas, p.box[i], overview, axes->names);
        } else {
            asdic_canvas_axis_x(&canvas, p.box[i], &p.beams, false);
        }
        asdic_canvas_frame(&canvas, p.box[i]);
        asdic_canvas_text(
            &canvas,
            (asdic_lettering){
                .x = p.box[i].x, .y = p.box[i].y - 10.0, .size_px = ASDIC_TEXT_PX, .bold = true},
            i == 0 ? "level of the strongest echo" : "range of the strongest echo");
        if (overview->pings > 1) {
            asdic_canvas_axis_y(&canvas, p.box[i], &p.time, true, false);
        }
        asdic_canvas_scale(&canvas, p.bar[i], &p.scale[i], options->colormap, false);
    }
    if (!status) {
        asdic_canvas_frame_text(&canvas, p.box[0].x, options->title, note);
        status = asdic_canvas_save(&canvas, path, options->texts);
    }
    asdic_canvas_finish(&canvas);
    return status;
}
