/*
 * The layout of a chart: the area of the world that it shows, and where on the page.
 */
#ifndef ASDIC_OUT_DRAW_CHART_PAGE_H
#define ASDIC_OUT_DRAW_CHART_PAGE_H

#include "canvas.h"
#include "draw_chart.h"

#define ASDIC_CHART_OBJECT_RGB 0x101010u
#define ASDIC_CHART_TRACK_RGB 0xd55e00u /* Okabe & Ito's vermilion */

#define ASDIC_CHART_LEGEND 20

typedef struct asdic_chart_page {
    double west_m, east_m, south_m, north_m; /* shown */
    double px_per_m;
    asdic_box box, bar, legend; /* bar: of depths, no width without them */
    asdic_plot_axis x, y, depth;
    double width, height;
    asdic_series entries[ASDIC_CHART_LEGEND];
    size_t entry_count;
} asdic_chart_page;

void asdic_chart_page_init(asdic_chart_page *page, const asdic_chart *chart,
                           const asdic_picture_options *options);

static inline double asdic_chart_x(const asdic_chart_page *p, double east_m) {
    return p->box.x + (east_m - p->west_m) * p->px_per_m;
}

static inline double asdic_chart_y(const asdic_chart_page *p, double north_m) {
    return p->box.y + (p->north_m - north_m) * p->px_per_m;
}

#endif
