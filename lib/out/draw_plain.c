/*
 * Pictures of a build without cairo: the plain raster.
 */
#include "draw.h"
#include "draw_chart.h"
#include "overview.h"

#include "base/context.h"
#include "base/try.h"
#include "raster.h"

bool asdic_picture_annotated(void) {
    return false;
}

asdic_status asdic_draw_waterfall(asdic_context *ctx, const char *path,
                                  const asdic_waterfall *waterfall, const asdic_decimator *levels,
                                  const asdic_picture_options *options) {
    asdic_waterfall shown = asdic_decimator_image(levels, waterfall->bin_length_m);
    return asdic_picture_raster(ctx, path, &shown, options);
}

asdic_status asdic_draw_fan(asdic_context *ctx, const char *path, const asdic_fan *fan,
                            const asdic_picture_options *options) {
    asdic_raster raster;
    asdic_sector sector = asdic_sector_of(fan, 700.0);
    TRY(asdic_raster_fan(ctx, fan, &sector, options, 0xffffffu, &raster));
    asdic_status status = asdic_raster_write(ctx, path, &raster, options->texts);
    asdic_raster_finish(&raster);
    return status;
}

static asdic_status fail_plain(asdic_context *ctx, const char *path) {
    return asdic_fail(
        ctx, ASDIC_ERROR_UNSUPPORTED,
        "cannot draw '%s': built without cairo; install libcairo2-dev and build again", path);
}

asdic_status asdic_draw_plot(asdic_context *ctx, const char *path, const asdic_plot *panels,
                             size_t panel_count, const asdic_picture_options *options) {
    (void)panels;
    (void)panel_count;
    (void)options;
    return fail_plain(ctx, path);
}

asdic_status asdic_draw_chart(asdic_context *ctx, const char *path, const asdic_chart *chart,
                              const asdic_picture_options *options) {
    (void)chart;
    (void)options;
    return fail_plain(ctx, path);
}

asdic_status asdic_draw_overview(asdic_context *ctx, const char *path,
                                 const asdic_overview *overview, const asdic_overview_axes *axes,
                                 const asdic_picture_options *options) {
    (void)overview;
    (void)axes;
    (void)options;
    return fail_plain(ctx, path);
}

asdic_status asdic_draw_map(asdic_context *ctx, const char *path, const asdic_map *map,
                            const asdic_raster *raster, const asdic_picture_options *options) {
    (void)map;
    return asdic_raster_write(ctx, path, raster, options->texts);
}
