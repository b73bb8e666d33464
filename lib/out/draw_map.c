#include "canvas.h"
#include "draw.h"

#include <math.h>

#define LEAST_PX 300.0 /* room for the axes of a narrow map */

typedef struct page {
    asdic_box box, bar; /* the box has the map's shape */
    asdic_plot_axis east, north, value;
    asdic_box legend;
    double width, height;
} page;

static page lay_out(const asdic_map *map, const asdic_raster *raster,
                    const asdic_picture_options *options) {
    page p = {.east = {.label = "east (m)",
                       .low = map->east_m,
                       .high = map->east_m + (double)map->columns * map->cell_m},
              .north = {.label = "north (m)",
                        .low = map->north_m,
                        .high = map->north_m + (double)map->rows * map->cell_m},
              .value = {.label = map->label, .low = options->db_low, .high = options->db_high}};
    double shorter = (double)(raster->width < raster->height ? raster->width : raster->height);
    double longer = (double)(raster->width < raster->height ? raster->height : raster->width);
    double stretch = fmin(fmax(LEAST_PX / shorter, 760.0 / longer), fmax(1400.0 / longer, 1.0));
    stretch = fmin(stretch, 900.0 / (double)raster->height);
    p.box.w = floor((double)raster->width * stretch);
    p.box.h = floor((double)raster->height * stretch);
    p.box.x = ASDIC_MARGIN_PX + ceil(asdic_canvas_axis_y_room(&p.north, p.box.h));
    p.bar = (asdic_box){.x = p.box.x + p.box.w + 28.0, .w = ASDIC_BAR_PX, .h = p.box.h};
    p.width = fmax(p.bar.x + p.bar.w + asdic_canvas_axis_y_room(&p.value, p.box.h) +
                       2.0 * ASDIC_MARGIN_PX,
                   700.0);
    p.legend = (asdic_box){p.box.x, ASDIC_MARGIN_PX + asdic_canvas_title_room(options->title),
                           p.width - p.box.x - ASDIC_MARGIN_PX, 0.0};
    p.legend.h = asdic_canvas_legend(NULL, p.legend, map->lines, map->line_count);
    p.box.y = ceil(p.legend.y + p.legend.h + (map->line_count ? 12.0 : 0.0));
    p.bar.y = p.box.y;
    p.height = p.box.y + p.box.h + 4.0 * ASDIC_TEXT_PX + ASDIC_MARGIN_PX +
               asdic_canvas_note_room(options->note, p.box.x, p.width);
    return p;
}

static void draw_line(asdic_canvas *c, const page *p, const asdic_series *line) {
    cairo_save(c->cr);
    cairo_rectangle(c->cr, p->box.x, p->box.y, p->box.w, p->box.h);
    cairo_clip(c->cr);
    asdic_canvas_curve(c, p->box, &p->east, &p->north, line);
    size_t count = line->count;
    while (count > 0 && !(isfinite(line->x[count - 1]) && isfinite(line->y[count - 1]))) {
        count--;
    }
    if (count > 0) { /* where it ends */
        cairo_new_path(c->cr);
        asdic_canvas_color(c, line->rgb);
        cairo_arc(c->cr, p->box.x + p->box.w * asdic_axis_share(&p->east, line->x[count - 1]),
                  p->box.y + p->box.h * (1.0 - asdic_axis_share(&p->north, line->y[count - 1])),
                  3.0 + 1.5 * line->width, 0.0, 6.2831853);
        cairo_fill(c->cr);
    }
    cairo_restore(c->cr);
}

asdic_status asdic_draw_map(asdic_context *ctx, const char *path, const asdic_map *map,
                            const asdic_raster *raster, const asdic_picture_options *options) {
    asdic_canvas canvas = {.format = options->format};
    page p = lay_out(map, raster, options);
    asdic_status status = asdic_canvas_init(ctx, path, p.width, p.height, ASDIC_PAPER_RGB, &canvas);
    if (!status) {
        asdic_canvas_raster(&canvas, raster, p.box);
        for (size_t i = 0; i < map->line_count; i++) {
            draw_line(&canvas, &p, &map->lines[i]);
        }
        asdic_canvas_axis_x(&canvas, p.box, &p.east, false);
        asdic_canvas_axis_y(&canvas, p.box, &p.north, false, false);
        asdic_canvas_scale(&canvas, p.bar, &p.value, options->colormap, false);
        asdic_canvas_frame(&canvas, p.box);
        asdic_canvas_legend(&canvas, p.legend, map->lines, map->line_count);
        asdic_canvas_frame_text(&canvas, p.box.x, options->title, options->note);
        status = asdic_canvas_save(&canvas, path, options->texts);
    }
    asdic_canvas_finish(&canvas);
    return status;
}
