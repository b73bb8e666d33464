#include "raster.h"

#include "base/context.h"
#include "base/vec.h"
#include "decimate.h"

#include <math.h>
#include <stdlib.h>

/* Half the width of a beam without neighbours. */
#define LONE_BEAM_RAD (ASDIC_PI / 180.0)

/* Steeper than 80 degrees a beam has hardly a bearing. */
#define STEEP_RAD (80.0 / 180.0 * ASDIC_PI)

bool asdic_beams_descend(const asdic_beam *beams, size_t count) {
    return count > 1 && beams[1].yaw_rad < beams[0].yaw_rad;
}

size_t asdic_beams_in_fan(const asdic_sonar *sonar) {
    bool is_down = asdic_beams_descend(sonar->receivers, sonar->receiver_count);
    size_t i = 0;
    for (; i < sonar->receiver_count; i++) {
        const asdic_beam *beam = &sonar->receivers[i];
        if (fabs(beam->pitch_rad) > STEEP_RAD ||
            (i > 0 &&
             !(is_down ? beam->yaw_rad < beam[-1].yaw_rad : beam->yaw_rad > beam[-1].yaw_rad))) {
            break;
        }
    }
    return i;
}

size_t asdic_beam_from_port(const asdic_beam *beams, size_t count, size_t i) {
    return asdic_beams_descend(beams, count) ? count - 1 - i : i;
}

bool asdic_beams_make_fan(const asdic_sonar *sonar) {
    return sonar->receiver_count >= 3 && asdic_beams_in_fan(sonar) == sonar->receiver_count;
}

/* A STEP between the outer beams' bearings and their neighbours', or the smaller one over the seam of a fan that goes
 * round: where they meet there, they meet half-way. */
static double outer_step(const asdic_fan *fan, double step) {
    double gap = 2.0 * ASDIC_PI - fabs(fan->bearing_rad[fan->beams - 1] - fan->bearing_rad[0]);
    return gap >= 0.0 && gap < (1.0 - 1e-9) * fabs(step) ? copysign(gap, step) : step;
}

/* Half-way bearings between neighbours; the outer beams are as wide outside as inside. */
static double edge_of(const asdic_fan *fan, size_t edge) {
    const double *bearing = fan->bearing_rad;
    size_t n = fan->beams;
    if (n == 1) {
        return bearing[0] + (edge == 0 ? -LONE_BEAM_RAD : LONE_BEAM_RAD);
    }
    if (edge == 0) {
        return bearing[0] - 0.5 * outer_step(fan, bearing[1] - bearing[0]);
    }
    if (edge == n) {
        return bearing[n - 1] + 0.5 * outer_step(fan, bearing[n - 1] - bearing[n - 2]);
    }
    return 0.5 * (bearing[edge - 1] + bearing[edge]);
}

void asdic_fan_edges(const asdic_fan *fan, double *edges) {
    for (size_t i = 0; i <= fan->beams; i++) {
        edges[i] = edge_of(fan, i);
    }
}

/* Makes the box that holds what lies along BEARING on the circle of radius 1: LEFT, RIGHT, UP, DOWN. */
static void widen(double box[4], double bearing) {
    box[0] = fmax(box[0], -sin(bearing));
    box[1] = fmax(box[1], sin(bearing));
    box[2] = fmax(box[2], cos(bearing));
    box[3] = fmax(box[3], -cos(bearing));
}

asdic_sector asdic_sector_of(const asdic_fan *fan, double radius_px) {
    double first = edge_of(fan, 0), last = edge_of(fan, fan->beams);
    double low = fmin(first, last), high = fmax(first, last);
    double middle = 0.5 * (low + high), half = fmin(0.5 * (high - low), ASDIC_PI);
    asdic_sector s = {.radius_px = radius_px, .low_rad = low, .high_rad = high};
    if (half > (1.0 - 1e-9) * ASDIC_PI) { /* once round */
        half = ASDIC_PI;
        s.low_rad = middle - half;
        s.high_rad = middle + half;
    }
    /* The box holds the apex, both ends of the arc, and the axes that the arc crosses. */
    const double quarter = 0.5 * ASDIC_PI;
    double box[4] = {0.0, 0.0, 0.0, 0.0};
    widen(box, s.low_rad);
    widen(box, s.high_rad);
    for (double i = ceil(s.low_rad / quarter); i * quarter <= s.high_rad; i += 1.0) {
        widen(box, i * quarter);
    }
    double left = box[0], right = box[1], up = box[2], down = box[3];
    /* A millionth of a pixel absorbs rounding, as of sin(pi). */
    s.apex_x_px = ceil(left * radius_px - 1e-6);
    s.apex_y_px = ceil(up * radius_px - 1e-6);
    s.width = (size_t)fmax(1.0, s.apex_x_px + ceil(right * radius_px - 1e-6));
    s.height = (size_t)fmax(1.0, s.apex_y_px + ceil(down * radius_px - 1e-6));
    return s;
}

size_t asdic_fan_beam(const double *edges, size_t beams, double bearing) {
    size_t port = edges[0] < edges[beams] ? 0 : beams, starboard = beams - port;
    while (bearing < edges[port]) {
        bearing += 2.0 * ASDIC_PI;
    }
    while (bearing > edges[starboard]) {
        bearing -= 2.0 * ASDIC_PI;
    }
    if (bearing < edges[port]) {
        return beams;
    }
    while (port + 1 != starboard &&
           starboard + 1 != port) { /* the bearing is between these edges */
        size_t middle = (port + starboard) / 2;
        if (edges[middle] <= bearing) {
            port = middle;
        } else {
            starboard = middle;
        }
    }
    return port < starboard ? port : starboard;
}

/* The cell at pixel (X, Y) of a sector whose beams end at EDGES; UINT32_MAX outside. */
static uint32_t cell_at(const asdic_fan *fan, const asdic_sector *sector, const double *edges,
                        size_t x, size_t y, double *share) {
    double ahead = sector->apex_y_px - ((double)y + 0.5);
    double starboard = (double)x + 0.5 - sector->apex_x_px;
    *share = hypot(ahead, starboard) / sector->radius_px;
    size_t bin = (size_t)(*share * (double)fan->bins);
    size_t beam = asdic_fan_beam(edges, fan->beams, atan2(starboard, ahead));
    return bin < fan->bins && beam < fan->beams ? (uint32_t)(beam * fan->bins + bin) : UINT32_MAX;
}

asdic_status asdic_sector_cells(asdic_context *ctx, const asdic_fan *fan,
                                const asdic_sector *sector, uint32_t **cells) {
    double share, *edges = malloc((fan->beams + 1) * sizeof *edges);
    *cells = malloc(sector->width * sector->height * sizeof **cells);
    if (edges) {
        asdic_fan_edges(fan, edges);
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
    asdic_fan_edges(fan, edges);
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
