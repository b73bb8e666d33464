/* How the time of a ping grows, as a picture. */
#include "bench.h"

#include <math.h>

static void widen(const double *values, size_t count, double *low, double *high) {
    for (size_t i = 0; i < count; i++) {
        *low = fmin(*low, values[i]);
        *high = fmax(*high, values[i]);
    }
}

asdic_status bench_scaling_picture(const cli *c, const char *path, const char *title,
                                   const char *abscissa, asdic_series *curves, size_t count) {
    static const uint32_t colors[] = {0x0072b2, 0x009e73, 0xd55e00, 0xcc79a7};
    double low_x = INFINITY, high_x = 0.0, low_y = INFINITY, high_y = 0.0;
    for (size_t i = 0; i < count; i++) {
        widen(curves[i].x, curves[i].count, &low_x, &high_x);
        widen(curves[i].y, curves[i].count, &low_y, &high_y);
        curves[i].rgb = colors[i % (sizeof colors / sizeof colors[0])];
        curves[i].width = 1.5;
    }
    const asdic_plot panel = {
        .x = {abscissa, 0.7 * low_x, 1.4 * high_x, true},
        /* whole decades, so that the axis has marks */
        .y = {"milliseconds per ping", pow(10.0, floor(log10(0.9 * low_y))),
              pow(10.0, ceil(log10(1.1 * high_y))), true},
        .series = curves,
        .series_count = count};
    asdic_picture_options options = asdic_picture_options_default();
    options.title = title;
    return asdic_picture_plot(cli_context(c), path, &panel, 1, &options);
}
