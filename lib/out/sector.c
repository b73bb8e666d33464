#include "raster.h"

#include "base/context.h"
#include "base/vec.h"
#include "decimate.h"

#include <math.h>
#include <stdlib.h>

/* Half the width of a beam without neighbours. */
#define LONE_BEAM_RAD (ASDIC_PI / 180.0)

/* Half-way bearings between neighbours; the outer beams are as wide outside as inside. */
static double edge_of(const asdic_fan *fan, size_t edge) {
    const double *bearing = fan->bearing_rad;
    size_t n = fan->beams;
    if (n == 1) {
        return bearing[0] + (edge == 0 ? -LONE_BEAM_RAD : LONE_BEAM_RAD);
    }
    if (edge == 0) {
        return bearing[0] - 0.5 * (bearing[1] - bearing[0]);
    }
    if (edge == n) {
        return bearing[n - 1] + 0.5 * (bearing[n - 1] - bearing[n - 2]);
    }
    return 0.5 * (bearing[edge - 1] + bearing[edge]);
}

asdic_sector asdic_sector_of(const asdic_fan *fan, double radius_px) {
    asdic_sector s = {.radius_px = radius_px,
                      .low_rad = fmax(edge_of(fan, 0), -ASDIC_PI),
                      .high_rad = fmin(edge_of(fan, fan->beams), ASDIC_PI)};
    /* The box holds the apex, both ends of the arc, and the axes that the arc crosses. */
    const double candidates[] = {s.low_rad, s.high_rad,     -ASDIC_PI, -0.5 * ASDIC_PI,
                                 0.0,       0.5 * ASDIC_PI, ASDIC_PI};
    double left = 0.0, right = 0.0, up = 0.0, down = 0.0;
    for (size_t i = 0; i < sizeof candidates / sizeof *candidates; i++) {
        double bearing = candidates[i];
        if (bearing < s.low_rad || bearing > s.high_rad) {
            continue;
        }
        left = fmax(left, -sin(bearing));
        right = fmax(right, sin(bearing));
        up = fmax(up, cos(bearing));
        down = fmax(down, -cos(bearing));
    }
    /* A millionth of a pixel absorbs rounding, as of sin(pi). */
    s.apex_x_px = ceil(left * radius_px - 1e-6);
    s.apex_y_px = ceil(up * radius_px - 1e-6);
    s.width = (size_t)fmax(1.0, s.apex_x_px + ceil(right * radius_px - 1e-6));
    s.height = (size_t)fmax(1.0, s.apex_y_px + ceil(down * radius_px - 1e-6));
    return s;
}

/* Beam whose half-way edges enclose BEARING; BEAMS when outside. */
static size_t find_beam(const double *edges, size_t beams, double bearing) {
    if (bearing < edges[0] || bearing > edges[beams]) {
        return beams;
    }
    size_t low = 0, high = beams; /* edges[low] <= bearing <= edges[high] */
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (edges[middle] <= bearing) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

/* The cell at pixel (X, Y) of a sector whose beams end at EDGES; UINT32_MAX outside. */
static uint32_t cell_at(const asdic_fan *fan, const asdic_sector *sector, const double *edges,
                        size_t x, size_t y, double *share) {
    double ahead = sector->apex_y_px - ((double)y + 0.5);
    double starboard = (double)x + 0.5 - sector->apex_x_px;
    *share = hypot(ahead, starboard) / sector->radius_px;
    size_t bin = (size_t)(*share * (double)fan->bins);
    size_t beam = find_beam(edges, fan->beams, atan2(starboard, ahead));
    return bin < fan->bins && beam < fan->beams ? (uint32_t)(beam * fan->bins + bin) : UINT32_MAX;
}

asdic_status asdic_sector_cells(asdic_context *ctx, const asdic_fan *fan,
                                const asdic_sector *sector, uint32_t **cells) {
    double share, *edges = malloc((fan->beams + 1) * sizeof *edges);
    *cells = malloc(sector->width * sector->height * sizeof **cells);
    for (size_t i = 0; edges && i <= fan->beams; i++) {
        edges[i] = edge_of(fan, i);
    }
    for (size_t at = 0; edges && *cells && at < sector->width * sector->height; at++) {
        (*cells)[at] = cell_at(fan, sector, edges, at % sector->width, at / sector->width, &share);
    }
    bool good = edges && *cells;
    free(edges);
    return good ? ASDIC_OK : asdic_fail_memory(ctx, "a picture's pixels");
}

static void paint(const asdic_fan *fan, const asdic_sector *sector, const double *edges,
                  const asdic_picture_options *options, uint32_t background_rgb,
                  asdic_raster *out) {
    double max_range_m = (double)fan->bins * fan->bin_length_m;
    for (size_t y = 0; y < sector->height; y++) {
        for (size_t x = 0; x < sector->width; x++) {
            double share;
            uint32_t cell = cell_at(fan, sector, edges, x, y, &share), rgb = background_rgb;
            if (cell != UINT32_MAX) {
                rgb = asdic_raster_color(options, fan->levels_db[cell], share * max_range_m,
                                         background_rgb);
            }
            asdic_raster_set(out, x, y, rgb);
        }
    }
}

asdic_status asdic_raster_fan(asdic_context *ctx, const asdic_fan *fan, const asdic_sector *sector,
                              const asdic_picture_options *options, uint32_t background_rgb,
                              asdic_raster *out) {
    asdic_decimator thin = {0};
    double *edges = NULL;
    asdic_status status = asdic_raster_init(ctx, sector->width, sector->height, out);
    if (status != ASDIC_OK) {
        goto done;
    }
    edges = malloc((fan->beams + 1) * sizeof *edges);
    if (!edges) {
        status = asdic_fail_memory(ctx, "bearings");
        goto done;
    }
    for (size_t i = 0; i <= fan->beams; i++) {
        edges[i] = edge_of(fan, i);
    }
    status = asdic_decimator_init(ctx, fan->beams, fan->bins, fan->beams,
                                  (size_t)ceil(sector->radius_px), &thin);
    if (status != ASDIC_OK) {
        goto done;
    }
    for (size_t beam = 0; beam < fan->beams; beam++) {
        asdic_decimator_add(&thin, fan->levels_db + beam * fan->bins);
    }
    asdic_decimator_end(&thin);
    asdic_fan shown = *fan;
    shown.levels_db = thin.levels_db;
    shown.bins = thin.columns;
    shown.bin_length_m *= (double)thin.column_group;
    paint(&shown, sector, edges, options, background_rgb, out);
done:
    asdic_decimator_finish(&thin);
    free(edges);
    if (status != ASDIC_OK) {
        asdic_raster_finish(out);
    }
    return status;
}
