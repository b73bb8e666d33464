#include "draw_chart_page.h"

#include "raster_relief.h"

#include <math.h>

#define MOST_WIDE_PX 1100.0
#define MOST_HIGH_PX 860.0
#define LEAST_PX 320.0
#define LEAST_SHARE 0.6

typedef asdic_chart_page page;

static void take_in(page *p, double north_m, double east_m) {
    p->west_m = fmin(p->west_m, east_m);
    p->east_m = fmax(p->east_m, east_m);
    p->south_m = fmin(p->south_m, north_m);
    p->north_m = fmax(p->north_m, north_m);
}

/* A point that is at most NEAR_M outside what is SEEN. */
static void take_in_near(page *p, const page *seen, double near_m, double north_m, double east_m) {
    if (east_m > seen->west_m - near_m && east_m < seen->east_m + near_m &&
        north_m > seen->south_m - near_m && north_m < seen->north_m + near_m) {
        take_in(p, north_m, east_m);
    }
}

/* Track and areas, and the objects among them or just beside. */
static void find_extent(page *p, const asdic_chart *chart) {
    p->west_m = p->south_m = INFINITY;
    p->east_m = p->north_m = -INFINITY;
    for (size_t i = 0; i < chart->track_count; i++) {
        take_in(p, chart->north_m[i], chart->east_m[i]);
    }
    for (size_t i = 0; i < chart->area_count; i++) {
        for (size_t k = 0; k < chart->areas[i].count; k++) {
            take_in(p, chart->areas[i].north_m[k], chart->areas[i].east_m[k]);
        }
    }
    double span_m = fmax(p->east_m - p->west_m, p->north_m - p->south_m);
    double near_m = fmax(0.15 * span_m, 1.0);
    page seen = *p;
    for (size_t i = 0; i < chart->outline_count; i++) {
        const asdic_outline *o = &chart->outlines[i];
        for (size_t k = 0; k < o->count; k++) {
            take_in_near(p, &seen, near_m, o->north_m[k], o->east_m[k]);
        }
    }
    for (size_t i = 0; i < chart->route_count; i++) {
        const asdic_route *r = &chart->routes[i];
        for (size_t k = 0; k < r->count; k++) {
            take_in_near(p, &seen, near_m, r->points[k].north_m, r->points[k].east_m);
        }
    }
}

/* Room at the edges, and neither side so short that the page's texts would not fit. */
static void widen(page *p) {
    double wide_m = p->east_m - p->west_m, high_m = p->north_m - p->south_m;
    double span_m = fmax(fmax(wide_m, high_m), 1.0);
    double add_x_m = 0.5 * fmax(LEAST_SHARE * span_m - wide_m, 0.0) + 0.06 * span_m;
    double add_y_m = 0.5 * fmax(LEAST_SHARE * span_m - high_m, 0.0) + 0.06 * span_m;
    p->west_m -= add_x_m;
    p->east_m += add_x_m;
    p->south_m -= add_y_m;
    p->north_m += add_y_m;
}

static void add_entry(page *p, asdic_series entry) {
    if (p->entry_count < ASDIC_CHART_LEGEND) {
        p->entries[p->entry_count++] = entry;
    }
}

static void list_entries(page *p, const asdic_chart *chart) {
    add_entry(p, (asdic_series){
                     .label = asdic_track_moves(chart->north_m, chart->east_m, chart->track_count)
                                  ? "track"
                                  : "vehicle",
                     .rgb = ASDIC_CHART_TRACK_RGB,
                     .width = 2.0});
    if (chart->outline_count > 0) {
        add_entry(p,
                  (asdic_series){.label = "objects", .rgb = ASDIC_CHART_OBJECT_RGB, .width = 1.2});
    }
    if (chart->route_count > 0) {
        add_entry(p, (asdic_series){.label = "their way",
                                    .rgb = ASDIC_CHART_OBJECT_RGB,
                                    .width = 1.2,
                                    .style = ASDIC_LINE_DASHED});
    }
    for (size_t i = 0; i < chart->area_count; i++) {
        const asdic_chart_area *area = &chart->areas[i];
        if (area->label) {
            add_entry(p,
                      (asdic_series){.label = area->label,
                                     .rgb = area->rgb,
                                     .width = 1.5,
                                     .style = area->dashed ? ASDIC_LINE_DASHED : ASDIC_LINE_SOLID});
        }
    }
}

void asdic_chart_page_init(page *p, const asdic_chart *chart,
                           const asdic_picture_options *options) {
    *p = (page){0};
    find_extent(p, chart);
    widen(p);
    double wide_m = p->east_m - p->west_m, high_m = p->north_m - p->south_m;
    p->px_per_m = fmin(MOST_WIDE_PX / wide_m, MOST_HIGH_PX / high_m);
    p->x = (asdic_plot_axis){.label = "east (m)", .low = p->west_m, .high = p->east_m};
    p->y = (asdic_plot_axis){.label = "north (m)", .low = p->south_m, .high = p->north_m};
    p->box.w = fmax(floor(wide_m * p->px_per_m), LEAST_PX);
    p->box.h = fmax(floor(high_m * p->px_per_m), LEAST_PX);
    p->box.x = ASDIC_MARGIN_PX + ceil(asdic_canvas_axis_y_room(&p->y, p->box.h));
    bool has_depth = asdic_relief_span(chart->relief, p->west_m, p->east_m, p->south_m, p->north_m,
                                       &p->depth.low, &p->depth.high);
    double beside = 0.0;
    p->depth.label = "depth (m)";
    if (has_depth) {
        p->bar = (asdic_box){.w = ASDIC_BAR_PX, .h = p->box.h};
        beside = 28.0 + ASDIC_BAR_PX + asdic_canvas_axis_y_room(&p->depth, p->bar.h);
    }
    list_entries(p, chart);
    p->legend = (asdic_box){p->box.x, ASDIC_MARGIN_PX + asdic_canvas_title_room(options->title),
                            p->box.w + beside, 0.0};
    p->legend.h = asdic_canvas_legend(NULL, p->legend, p->entries, p->entry_count);
    p->box.y = ceil(p->legend.y + p->legend.h + 12.0);
    p->bar.x = p->box.x + p->box.w + 28.0;
    p->bar.y = p->box.y;
    p->width = p->box.x + p->box.w + beside + 2.0 * ASDIC_MARGIN_PX;
    p->height = p->box.y + p->box.h + 4.0 * ASDIC_TEXT_PX + ASDIC_MARGIN_PX +
                asdic_canvas_note_room(options->note, p->box.x, p->width);
}
