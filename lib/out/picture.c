#include "draw.h"

#include "base/context.h"
#include "base/try.h"
#include "digits.h"
#include "png_file.h"
#include "raster.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

asdic_picture_options asdic_picture_options_default(void) {
    return (asdic_picture_options){
        .db_low = -160.0, .db_high = -60.0, .colormap = ASDIC_COLORMAP_VIRIDIS};
}

static asdic_status check_format(asdic_context *ctx, const asdic_picture_options *o) {
    return (unsigned)o->format <= ASDIC_PICTURE_SVG
               ? ASDIC_OK
               : asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no format %d of pictures", (int)o->format);
}

asdic_status asdic_picture_check(asdic_context *ctx, const asdic_picture_options *o) {
    if (!isfinite(o->db_high - o->db_low) || o->db_high - o->db_low < 1e-3) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "level window %g..%g dB is empty; give low < high", o->db_low,
                          o->db_high);
    }
    if (!isfinite(o->tvg_db_per_decade) || !isfinite(o->tvg_db_per_m)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "time-varied gain must be finite");
    }
    if (!asdic_colormap_name(o->colormap)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "no colour map %d", (int)o->colormap);
    }
    return check_format(ctx, o);
}

static bool is_length(double length_m) {
    return length_m > 0.0 && isfinite(length_m);
}

static asdic_status check_waterfall(asdic_context *ctx, const asdic_waterfall *w,
                                    const asdic_picture_options *options) {
    if (!w->levels_db || w->pings == 0 || w->bins == 0 || !is_length(w->bin_length_m)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "nothing to draw: %zu pings of %zu bins of %g m", w->pings, w->bins,
                          w->bin_length_m);
    }
    if (!isfinite(w->first_time_s) || !isfinite(w->ping_period_s) || w->ping_period_s < 0.0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "pings from %g s on, every %g s",
                          w->first_time_s, w->ping_period_s);
    }
    return asdic_picture_check(ctx, options);
}

void asdic_picture_subtitle(const asdic_sonar *sonar, double bin_length_m, char *text) {
    char frequency[ASDIC_DIGITS_SIZE], bandwidth[ASDIC_DIGITS_SIZE], bin[ASDIC_DIGITS_SIZE];
    char source[ASDIC_DIGITS_SIZE];
    if (!sonar || !text) {
        if (text) {
            *text = 0;
        }
        return;
    }
    asdic_digits_print(frequency, "%g", sonar->frequency_hz / 1000.0);
    asdic_digits_print(bandwidth, "%.4g", sonar->bandwidth_hz / 1000.0);
    asdic_digits_print(bin, "%.4g", bin_length_m);
    asdic_digits_print(source, "%.5g", sonar->source_level_db);
    snprintf(
        text, ASDIC_SUBTITLE_SIZE,
        sonar->source_level_db == 0.0 && !sonar->noise_enabled /* which is absolute */
            ? "%s kHz, bandwidth %s kHz  \u00b7  bins of %s m  \u00b7  levels re an SL of %s dB"
            : "%s kHz, bandwidth %s kHz  \u00b7  bins of %s m  \u00b7  source level %s dB re "
              "1 \u00b5Pa at 1 m",
        frequency, bandwidth, bin, source);
}

/* With a separator between statements. */
void asdic_draw_note_add(char note[ASDIC_NOTE_SIZE], const char *statement) {
    size_t used = strlen(note);
    snprintf(note + used, ASDIC_NOTE_SIZE - used, "%s%s", used ? ASDIC_NOTE_PART : "", statement);
}

void asdic_draw_gain(char text[ASDIC_GAIN_SIZE], double db_per_decade, double db_per_m) {
    char spread[ASDIC_DIGITS_SIZE], loss[ASDIC_DIGITS_SIZE];
    asdic_digits_print(spread, "%.4g", db_per_decade);
    asdic_digits_print(loss, "%.4g", db_per_m);
    snprintf(text, ASDIC_GAIN_SIZE, "%s log r + %s r dB", spread, loss);
}

void asdic_draw_note(char note[ASDIC_NOTE_SIZE], const asdic_picture_options *options,
                     const asdic_decimator *levels) {
    char text[128], gain[ASDIC_GAIN_SIZE];
    note[0] = 0;
    if (options->note) {
        asdic_draw_note_add(note, options->note);
    }
    if (options->tvg_db_per_decade != 0.0 || options->tvg_db_per_m != 0.0) {
        asdic_draw_gain(gain, options->tvg_db_per_decade, options->tvg_db_per_m);
        snprintf(text, sizeof text, "time-varied gain for display: %s", gain);
        asdic_draw_note_add(note, text);
    }
    if (levels && (levels->row_group > 1 || levels->column_group > 1)) {
        snprintf(text, sizeof text, "each pixel is the mean energy of %zu ping%s \u00d7 %zu bin%s",
                 levels->row_group, levels->row_group > 1 ? "s" : "", levels->column_group,
                 levels->column_group > 1 ? "s" : "");
        asdic_draw_note_add(note, text);
    }
}

asdic_status asdic_picture_waterfall(asdic_context *ctx, const char *path,
                                     const asdic_waterfall *waterfall,
                                     const asdic_picture_options *options) {
    if (!path || !waterfall || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    TRY(check_waterfall(ctx, waterfall, options));
    asdic_decimator levels;
    TRY(asdic_decimator_init(ctx, waterfall->pings, waterfall->bins, ASDIC_WATERFALL_MAX_ROWS,
                             ASDIC_WATERFALL_MAX_COLUMNS, &levels));
    for (size_t ping = 0; ping < waterfall->pings; ping++) {
        asdic_decimator_add(&levels, waterfall->levels_db + ping * waterfall->bins);
    }
    asdic_decimator_end(&levels);
    asdic_status status = asdic_draw_waterfall(ctx, path, waterfall, &levels, options);
    asdic_decimator_finish(&levels);
    return status;
}

/* As of poses: farther on a double tells no directions apart. */
#define MOST_BEARING_RAD 1e7

asdic_status asdic_picture_fan(asdic_context *ctx, const char *path, const asdic_fan *fan,
                               const asdic_picture_options *options) {
    if (!path || !fan || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    if (!fan->levels_db || !fan->bearing_rad || fan->beams == 0 || fan->bins == 0 ||
        !is_length(fan->bin_length_m)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "nothing to draw: %zu beams of %zu bins of %g m", fan->beams, fan->bins,
                          fan->bin_length_m);
    }
    const double *at_rad = fan->bearing_rad;
    bool descends = fan->beams > 1 && at_rad[1] < at_rad[0];
    for (size_t i = 0; i < fan->beams; i++) {
        if (!(fabs(at_rad[i]) <= MOST_BEARING_RAD)) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "beam %zu lies at %g rad, beyond %g", i,
                              at_rad[i], MOST_BEARING_RAD);
        }
        if (i > 0 && !(descends ? at_rad[i] < at_rad[i - 1] : at_rad[i] > at_rad[i - 1])) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                              "a fan needs bearings that ascend or that descend, but beam %zu lies "
                              "at %g and beam %zu at %g rad",
                              i - 1, at_rad[i - 1], i, at_rad[i]);
        }
    }
    TRY(asdic_picture_check(ctx, options));
    return asdic_draw_fan(ctx, path, fan, options);
}

asdic_status asdic_picture_raster(asdic_context *ctx, const char *path,
                                  const asdic_waterfall *waterfall,
                                  const asdic_picture_options *options) {
    if (!path || !waterfall || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    asdic_raster raster;
    TRY(check_waterfall(ctx, waterfall, options));
    TRY(asdic_raster_levels(ctx, waterfall, options, &raster));
    asdic_status status = asdic_raster_write(ctx, path, &raster, options->texts);
    asdic_raster_finish(&raster);
    return status;
}

/* 0 is kept for "no energy", so that the window maps to 1..65535. */
static uint16_t grey_of(const asdic_picture_options *options, double shown_db) {
    if (!isfinite(shown_db)) {
        return 0;
    }
    double share = (shown_db - options->db_low) / (options->db_high - options->db_low);
    return (uint16_t)(1.0 + rint(65534.0 * fmin(fmax(share, 0.0), 1.0)));
}

void asdic_draw_grey(const asdic_picture_options *options, const float *levels_db, size_t bins,
                     double bin_length_m, uint16_t *grey) {
    for (size_t i = 0; i < bins; i++) {
        double range_m = ((double)i + 0.5) * bin_length_m;
        grey[i] = grey_of(options, asdic_raster_gain(options, (double)levels_db[i], range_m));
    }
}

typedef struct raw_rows {
    const asdic_waterfall *waterfall;
    const asdic_picture_options *options;
} raw_rows;

static asdic_status raw_row(void *user, size_t ping, uint16_t *grey) {
    const raw_rows *rows = user;
    const asdic_waterfall *w = rows->waterfall;
    asdic_draw_grey(rows->options, w->levels_db + ping * w->bins, w->bins, w->bin_length_m, grey);
    return ASDIC_OK;
}

asdic_status asdic_picture_raw(asdic_context *ctx, const char *path,
                               const asdic_waterfall *waterfall,
                               const asdic_picture_options *options) {
    if (!path || !waterfall || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    TRY(check_waterfall(ctx, waterfall, options));
    raw_rows rows = {waterfall, options};
    asdic_png png = {.width = waterfall->bins,
                     .height = waterfall->pings,
                     .grey_row = raw_row,
                     .user = &rows,
                     .texts = options->texts};
    return asdic_png_write(ctx, path, &png);
}

asdic_status asdic_picture_check_series(asdic_context *ctx, const asdic_series *series,
                                        size_t count) {
    for (size_t i = 0; i < count; i++) {
        if (!series || (series[i].count > 0 && (!series[i].x || !series[i].y)) ||
            !(series[i].width >= 0.0 && isfinite(series[i].width)) ||
            (unsigned)series[i].style > ASDIC_LINE_DASH_DOT) {
            return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "curve %zu lacks points, width or style",
                              i);
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_picture_plot(asdic_context *ctx, const char *path, const asdic_plot *panels,
                                size_t panel_count, const asdic_picture_options *options) {
    if (!path || !panels || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    if (panel_count == 0) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "nothing to draw: no panel");
    }
    for (size_t i = 0; i < panel_count; i++) {
        TRY(asdic_picture_check_series(ctx, panels[i].series, panels[i].series_count));
        const asdic_plot_axis axes[2] = {panels[i].x, panels[i].y};
        for (int k = 0; k < 2; k++) {
            if (!(axes[k].low < axes[k].high) || !isfinite(axes[k].high - axes[k].low) ||
                (axes[k].logarithmic && axes[k].low <= 0.0) ||
                (axes[k].name_count > 0 && !axes[k].names)) {
                return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                                  "panel %zu: axis '%s' from %g to %g is empty", i,
                                  axes[k].label ? axes[k].label : "", axes[k].low, axes[k].high);
            }
        }
    }
    TRY(check_format(ctx, options));
    return asdic_draw_plot(ctx, path, panels, panel_count, options);
}
