#include "raster_relief.h"

#include "base/try.h"

#include <math.h>

/* Light from the north-west, half up, as on printed maps. */
#define LIGHT_NORTH 0.5
#define LIGHT_WEST 0.5
#define LIGHT_UP 0.7071067811865476
/* Shade of ground that is turned away from the light. */
#define DARKEST 0.6
/* Slopes are exaggerated until their root mean square is this, so that a smooth bed shows its form. */
#define SHOWN_SLOPE 0.5
#define MOST_EXAGGERATION 20.0

/* Whether cell I is a place of the bottom. */
static bool is_bottom(const asdic_relief *r, size_t i) {
    return isfinite(r->depth_m[i]) && !(r->is_object && r->is_object[i]);
}

bool asdic_relief_span(const asdic_relief *r, double west_m, double east_m, double south_m,
                       double north_m, double *low_m, double *high_m) {
    *low_m = INFINITY;
    *high_m = -INFINITY;
    for (size_t i = 0; i < r->rows * r->columns; i++) {
        double x = r->west_m + ((double)(i % r->columns) + 0.5) * r->cell_m;
        double y = r->south_m + ((double)(r->rows - 1 - i / r->columns) + 0.5) * r->cell_m;
        if (is_bottom(r, i) && x > west_m && x < east_m && y > south_m && y < north_m) {
            *low_m = fmin(*low_m, (double)r->depth_m[i]);
            *high_m = fmax(*high_m, (double)r->depth_m[i]);
        }
    }
    if (*low_m > *high_m) {
        return false;
    }
    if (*high_m - *low_m < 0.1) { /* flat: a window of centimetres would show nothing */
        double middle_m = 0.5 * (*low_m + *high_m);
        *low_m = middle_m - 0.05;
        *high_m = middle_m + 0.05;
    }
    return true;
}

static double depth_at(const asdic_relief *r, size_t row, size_t column, double otherwise) {
    double depth_m = (double)r->depth_m[row * r->columns + column];
    return isfinite(depth_m) ? depth_m : otherwise;
}

/* How fast the ground rises towards north and west at a cell. */
static void slopes(const asdic_relief *r, size_t row, size_t column, double *north, double *west) {
    double here = (double)r->depth_m[row * r->columns + column];
    size_t up = row > 0 ? row - 1 : row, down = row + 1 < r->rows ? row + 1 : row;
    size_t left = column > 0 ? column - 1 : column;
    size_t right = column + 1 < r->columns ? column + 1 : column;
    double span_y = fmax((double)(down - up), 1.0), span_x = fmax((double)(right - left), 1.0);
    *north =
        (depth_at(r, down, column, here) - depth_at(r, up, column, here)) / (span_y * r->cell_m);
    *west = (depth_at(r, row, right, here) - depth_at(r, row, left, here)) / (span_x * r->cell_m);
}

static double exaggeration_of(const asdic_relief *r) {
    double sum = 0.0, count = 0.0, north, west;
    for (size_t i = 0; i < r->rows * r->columns; i++) {
        if (is_bottom(r, i)) {
            slopes(r, i / r->columns, i % r->columns, &north, &west);
            sum += north * north + west * west;
            count += 1.0;
        }
    }
    double rms = count > 0.0 ? sqrt(sum / count) : 0.0;
    return rms * MOST_EXAGGERATION < SHOWN_SLOPE ? MOST_EXAGGERATION : SHOWN_SLOPE / rms;
}

/* Lambert's law; flat ground keeps its colour. */
static double shade_of(double north, double west) {
    double cosine = (LIGHT_UP - LIGHT_NORTH * north - LIGHT_WEST * west) /
                    sqrt(1.0 + north * north + west * west);
    return fmin(fmax(cosine / LIGHT_UP, DARKEST), 1.25);
}

static uint32_t shaded(uint32_t rgb, double shade) {
    uint32_t out = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
        double channel = (double)(rgb >> shift & 255) * shade;
        out |= (uint32_t)fmin(channel + 0.5, 255.0) << shift;
    }
    return out;
}

asdic_status asdic_raster_relief(asdic_context *ctx, const asdic_relief *r,
                                 const asdic_relief_look *look, asdic_raster *out) {
    TRY(asdic_raster_init(ctx, r->columns, r->rows, out));
    double exaggeration = exaggeration_of(r);
    for (size_t i = 0; i < r->rows * r->columns; i++) {
        size_t row = i / r->columns, column = i % r->columns;
        uint32_t rgb = look->empty_rgb;
        if (isfinite(r->depth_m[i])) {
            double share = (look->high_m - (double)r->depth_m[i]) / (look->high_m - look->low_m);
            unsigned step = (unsigned)(255.0 * fmin(fmax(share, 0.0), 1.0) + 0.5);
            double north, west, steeper = is_bottom(r, i) ? exaggeration : 1.0;
            slopes(r, row, column, &north, &west);
            rgb = is_bottom(r, i) ? look->bottom_rgb[step] : look->object_rgb;
            rgb = shaded(rgb, shade_of(north * steeper, west * steeper));
        }
        asdic_raster_set(out, column, row, rgb);
    }
    return ASDIC_OK;
}
