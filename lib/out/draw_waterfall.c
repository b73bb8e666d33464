#include "canvas.h"
#include "draw.h"

#include <math.h>

typedef struct page {
    asdic_box box, bar;
    double width, height;
    asdic_plot_axis range, time;
} page;

static page lay_out(const asdic_waterfall *waterfall, const asdic_decimator *levels,
                    const asdic_picture_options *options, const char *note) {
    double covered = (double)(levels->rows * levels->row_group);
    page p = {
        .range = {.label = "range (m)",
                  .high =
                      (double)(levels->columns * levels->column_group) * waterfall->bin_length_m},
        .time = asdic_canvas_time_axis(covered, waterfall->first_time_s, waterfall->ping_period_s)};
    p.box.w =
        (double)levels->columns * asdic_canvas_pixels_each(levels->columns, 1200.0, 1200.0, 0.0);
    p.box.h = (double)levels->rows * asdic_canvas_pixels_each(levels->rows, 720.0, 40.0, 160.0);
    p.box.x = ASDIC_MARGIN_PX + ceil(asdic_canvas_axis_y_room(&p.time, p.box.h));
    p.box.y = ASDIC_MARGIN_PX + asdic_canvas_title_room(options->title);
    p.bar = (asdic_box){p.box.x + p.box.w + 28.0, p.box.y, ASDIC_BAR_PX, p.box.h};
    p.width = p.bar.x + p.bar.w + asdic_canvas_color_bar_room(options, p.bar.h) + ASDIC_MARGIN_PX;
    p.height = p.box.y + p.box.h + 4.0 * ASDIC_TEXT_PX + ASDIC_MARGIN_PX +
               asdic_canvas_note_room(note, p.box.x, p.width);
    return p;
}

static void decorate(asdic_canvas *c, const page *p, const asdic_picture_options *options,
                     const char *note, bool has_time) {
    asdic_canvas_axis_x(c, p->box, &p->range, false);
    if (has_time) {
        asdic_canvas_axis_y(c, p->box, &p->time, true, false);
    }
    asdic_canvas_frame(c, p->box);
    asdic_canvas_color_bar(c, p->bar, options);
    asdic_canvas_frame_text(c, p->box.x, options->title, note);
}

asdic_status asdic_draw_waterfall(asdic_context *ctx, const char *path,
                                  const asdic_waterfall *waterfall, const asdic_decimator *levels,
                                  const asdic_picture_options *options) {
    char note[ASDIC_NOTE_SIZE];
    asdic_canvas canvas = {.format = options->format};
    asdic_raster raster = {0};
    asdic_waterfall shown = asdic_decimator_image(levels, waterfall->bin_length_m);
    asdic_draw_note(note, options, levels);
    page p = lay_out(waterfall, levels, options, note);
    asdic_status status = asdic_raster_levels(ctx, &shown, options, &raster);
    status =
        status ? status : asdic_canvas_init(ctx, path, p.width, p.height, ASDIC_PAPER_RGB, &canvas);
    if (!status) {
        asdic_canvas_raster(&canvas, &raster, p.box);
        decorate(&canvas, &p, options, note, waterfall->pings > 1);
        status = asdic_canvas_save(&canvas, path, options->texts);
    }
    asdic_canvas_finish(&canvas);
    asdic_raster_finish(&raster);
    return status;
}
