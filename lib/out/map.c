#include "draw.h"

#include "base/context.h"
#include "base/try.h"
#include "colormap.h"

#include <math.h>
#include <stdio.h>

#define MOST_PX 1000
#define UNKNOWN_RGB 0xffffffu

/* Cells a side that a pixel shows. */
static size_t group_of(const asdic_map *map) {
    size_t longer = map->rows > map->columns ? map->rows : map->columns;
    return (longer + MOST_PX - 1) / MOST_PX;
}

/* The greatest value of a block of cells; NAN when all are unknown. */
static double greatest(const asdic_map *map, size_t row, size_t column, size_t group) {
    double best = NAN;
    for (size_t r = row; r < row + group && r < map->rows; r++) {
        for (size_t c = column; c < column + group && c < map->columns; c++) {
            double value = map->values[r * map->columns + c];
            best = isnan(best) || value > best ? value : best;
        }
    }
    return best;
}

static asdic_status paint(asdic_context *ctx, const asdic_map *map,
                          const asdic_picture_options *options, asdic_raster *out) {
    size_t group = group_of(map);
    size_t rows = (map->rows + group - 1) / group, columns = (map->columns + group - 1) / group;
    size_t longer = rows > columns ? rows : columns, scale = MOST_PX / longer;
    scale = scale < 1 ? 1 : scale;
    TRY(asdic_raster_init(ctx, columns * scale, rows * scale, out));
    for (size_t y = 0; y < rows * scale; y++) {
        size_t row = rows - 1 - y / scale; /* north up */
        for (size_t x = 0; x < columns * scale; x++) {
            double value = greatest(map, row * group, x / scale * group, group);
            asdic_raster_set(out, x, y,
                             isnan(value) ? UNKNOWN_RGB
                                          : asdic_colormap_rgb(options->colormap,
                                                               asdic_raster_index(options, value)));
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_picture_map(asdic_context *ctx, const char *path, const asdic_map *map,
                               const asdic_picture_options *options) {
    if (!path || !map || !options) {
        return asdic_fail_null(ctx, __func__);
    }
    if (!map->values || map->rows == 0 || map->columns == 0 ||
        map->columns > SIZE_MAX / sizeof *map->values / map->rows || !(map->cell_m > 0.0) ||
        !isfinite(map->cell_m) || !isfinite(map->north_m) || !isfinite(map->east_m)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "nothing to draw: a map of %zu x %zu cells of %g m from (%g, %g) m on",
                          map->rows, map->columns, map->cell_m, map->north_m, map->east_m);
    }
    TRY(asdic_picture_check(ctx, options));
    TRY(asdic_picture_check_series(ctx, map->lines, map->line_count));
    size_t group = group_of(map);
    /* Whole blocks: what the picture covers to the north and east. */
    asdic_map shown = *map;
    shown.cell_m = map->cell_m * (double)group;
    shown.rows = (map->rows + group - 1) / group;
    shown.columns = (map->columns + group - 1) / group;
    asdic_picture_options noted = *options;
    char note[ASDIC_NOTE_SIZE] = "", text[128];
    if (group > 1) {
        snprintf(text, sizeof text, "each pixel is the greatest of %zu \u00d7 %zu cells", group,
                 group);
        if (options->note) {
            asdic_draw_note_add(note, options->note);
        }
        asdic_draw_note_add(note, text);
        noted.note = note;
    }
    asdic_raster raster = {0};
    asdic_status status = paint(ctx, map, options, &raster);
    status = status ? status : asdic_draw_map(ctx, path, &shown, &raster, &noted);
    asdic_raster_finish(&raster);
    return status;
}
