#include "raster.h"

#include "base/context.h"
#include "base/try.h"
#include "colormap.h"
#include "png_file.h"

#include <math.h>
#include <stdlib.h>

#define EMPTY_RGB 0xffffffu /* no energy: paper */

asdic_status asdic_raster_init(asdic_context *ctx, size_t width, size_t height, asdic_raster *out) {
    *out = (asdic_raster){.width = width, .height = height};
    out->rgb = width <= UINT32_MAX ? calloc(height, 3 * width) : NULL; /* no size overflows */
    return out->rgb ? ASDIC_OK : asdic_fail_memory(ctx, "a picture");
}

void asdic_raster_finish(asdic_raster *raster) {
    free(raster->rgb);
    *raster = (asdic_raster){0};
}

void asdic_raster_set(asdic_raster *raster, size_t x, size_t y, uint32_t rgb) {
    uint8_t *pixel = raster->rgb + 3 * (y * raster->width + x);
    pixel[0] = (uint8_t)(rgb >> 16);
    pixel[1] = (uint8_t)(rgb >> 8);
    pixel[2] = (uint8_t)rgb;
}

unsigned asdic_raster_index(const asdic_picture_options *options, double level_db) {
    double share = (level_db - options->db_low) / (options->db_high - options->db_low);
    double step = floor(256.0 * share);
    return step < 0.0 ? 0 : step > 255.0 ? 255 : (unsigned)step;
}

double asdic_raster_gain(const asdic_picture_options *options, double level_db, double range_m) {
    if (!isfinite(level_db)) {
        return NAN;
    }
    if (options->tvg_db_per_decade != 0.0) {
        level_db += options->tvg_db_per_decade * log10(range_m);
    }
    return level_db + options->tvg_db_per_m * range_m;
}

uint32_t asdic_raster_color(const asdic_picture_options *options, double level_db, double range_m,
                            uint32_t empty_rgb) {
    double shown_db = asdic_raster_gain(options, level_db, range_m);
    return isfinite(shown_db)
               ? asdic_colormap_rgb(options->colormap, asdic_raster_index(options, shown_db))
               : empty_rgb;
}

asdic_status asdic_raster_levels(asdic_context *ctx, const asdic_waterfall *image,
                                 const asdic_picture_options *options, asdic_raster *out) {
    TRY(asdic_raster_init(ctx, image->bins, image->pings, out));
    for (size_t ping = 0; ping < image->pings; ping++) {
        for (size_t bin = 0; bin < image->bins; bin++) {
            double range_m = ((double)bin + 0.5) * image->bin_length_m;
            double level_db = image->levels_db[ping * image->bins + bin];
            asdic_raster_set(out, bin, ping,
                             asdic_raster_color(options, level_db, range_m, EMPTY_RGB));
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_raster_write(asdic_context *ctx, const char *path, const asdic_raster *raster,
                                const char *const *texts) {
    asdic_png png = {
        .width = raster->width, .height = raster->height, .rgb = raster->rgb, .texts = texts};
    return asdic_png_write(ctx, path, &png);
}

static int by_level(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

asdic_status asdic_raster_window(asdic_context *ctx, const float *levels_db, size_t count,
                                 double *low_db, double *high_db) {
    float *sorted_db = malloc(count * sizeof *sorted_db);
    size_t there = 0;
    if (!sorted_db) {
        return asdic_fail_memory(ctx, "a window of levels");
    }
    for (size_t i = 0; i < count; i++) {
        if (isfinite(levels_db[i])) {
            sorted_db[there++] = levels_db[i];
        }
    }
    qsort(sorted_db, there, sizeof *sorted_db, by_level);
    *low_db = -70.0;
    *high_db = 0.0;
    if (there > 0) {
        *low_db = 10.0 * floor(0.1 * (double)sorted_db[there / 20]);
        *high_db = 10.0 * ceil(0.1 * (double)sorted_db[there * 995 / 1000]);
        *high_db = fmax(*high_db, *low_db + 30.0);
    }
    free(sorted_db);
    return ASDIC_OK;
}
