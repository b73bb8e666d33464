#include "canvas.h"

#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "base/words.h"
#include "draw.h"
#include "file.h"
#include "png_file.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#define NOTE_RGB 0x606060u
#define PIXELS_PER_M 8200.0 /* about 208 dpi: 1400 pixels are 17 cm */

/* Points (1/72 inch) per pixel of a vector file, for the same 17 cm. */
#define POINTS_PER_PX (72.0 / 0.0254 / PIXELS_PER_M)

static bool has_suffix(const char *path, const char *suffix) {
    size_t n = strlen(path), m = strlen(suffix);
    return n >= m && strcasecmp(path + n - m, suffix) == 0;
}

static cairo_status_t write_vector(void *closure, const unsigned char *data, unsigned length) {
    return fwrite(data, 1, length, closure) == length ? CAIRO_STATUS_SUCCESS
                                                      : CAIRO_STATUS_WRITE_ERROR;
}

static asdic_status open_vector(asdic_canvas *c, const char *path) {
    TRY(asdic_file_create(c->ctx, path, &c->vector_file));
    FILE *stream = asdic_file_stream(c->vector_file);
    double width = c->width * POINTS_PER_PX, height = c->height * POINTS_PER_PX;
    c->surface = c->format == ASDIC_PICTURE_PDF
                     ? cairo_pdf_surface_create_for_stream(write_vector, stream, width, height)
                     : cairo_svg_surface_create_for_stream(write_vector, stream, width, height);
    return ASDIC_OK;
}

asdic_status asdic_canvas_init(asdic_context *ctx, const char *path, double width, double height,
                               uint32_t background_rgb, asdic_canvas *out) {
    asdic_picture_format format = out->format;
    if (format == ASDIC_PICTURE_BY_NAME) {
        format = has_suffix(path, ".pdf")   ? ASDIC_PICTURE_PDF
                 : has_suffix(path, ".svg") ? ASDIC_PICTURE_SVG
                                            : ASDIC_PICTURE_PNG;
    }
    *out =
        (asdic_canvas){.ctx = ctx, .width = ceil(width), .height = ceil(height), .format = format};
    if (format != ASDIC_PICTURE_PNG) {
        TRY(open_vector(out, path));
    } else {
        out->surface =
            cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)out->width, (int)out->height);
    }
    out->cr = cairo_create(out->surface);
    if (cairo_status(out->cr) != CAIRO_STATUS_SUCCESS) {
        asdic_canvas_finish(out);
        return asdic_fail_memory(ctx, "a picture");
    }
    if (out->vector_file) {
        cairo_scale(out->cr, POINTS_PER_PX, POINTS_PER_PX);
    }
    asdic_canvas_color(out, background_rgb);
    cairo_paint(out->cr);
    return ASDIC_OK;
}

/* cairo keeps 0xXXRRGGBB words; libpng wants bytes. */
static asdic_status save_png(asdic_canvas *c, const char *path, const char *const *texts) {
    asdic_raster raster;
    TRY(asdic_raster_init(c->ctx, (size_t)c->width, (size_t)c->height, &raster));
    cairo_surface_flush(c->surface);
    const uint8_t *data = cairo_image_surface_get_data(c->surface);
    size_t stride = (size_t)cairo_image_surface_get_stride(c->surface);
    for (size_t y = 0; y < raster.height; y++) {
        const uint32_t *row = (const uint32_t *)(const void *)(data + y * stride);
        for (size_t x = 0; x < raster.width; x++) {
            asdic_raster_set(&raster, x, y, row[x]);
        }
    }
    asdic_png png = {.width = raster.width,
                     .height = raster.height,
                     .rgb = raster.rgb,
                     .pixels_per_m = PIXELS_PER_M,
                     .texts = texts};
    asdic_status status = asdic_png_write(c->ctx, path, &png);
    asdic_raster_finish(&raster);
    return status;
}

/* What PNG has text chunks for. */
static void describe_pdf(asdic_canvas *c, const char *const *texts) {
    char words[1024] = "";
    for (size_t i = 0; texts && texts[i] && texts[i + 1]; i += 2) {
        size_t used = strlen(words);
        if (strcmp(texts[i], "Title") == 0) {
            cairo_pdf_surface_set_metadata(c->surface, CAIRO_PDF_METADATA_TITLE, texts[i + 1]);
        } else if (strcmp(texts[i], "Description") == 0) {
            cairo_pdf_surface_set_metadata(c->surface, CAIRO_PDF_METADATA_SUBJECT, texts[i + 1]);
        } else {
            snprintf(words + used, sizeof words - used, "%s%s: %s", used ? "; " : "", texts[i],
                     texts[i + 1]);
        }
    }
    cairo_pdf_surface_set_metadata(c->surface, CAIRO_PDF_METADATA_KEYWORDS, words);
}

asdic_status asdic_canvas_save(asdic_canvas *c, const char *path, const char *const *texts) {
    if (!c->vector_file) {
        return save_png(c, path, texts);
    }
    if (c->format == ASDIC_PICTURE_PDF) {
        describe_pdf(c, texts);
    }
    cairo_surface_finish(c->surface);
    return asdic_file_commit(&c->vector_file);
}

void asdic_canvas_finish(asdic_canvas *c) {
    if (c->cr) {
        cairo_destroy(c->cr);
    }
    if (c->surface) {
        cairo_surface_finish(c->surface); /* may still write to the stream */
        cairo_surface_destroy(c->surface);
    }
    asdic_file_discard(&c->vector_file);
    *c = (asdic_canvas){0};
}

void asdic_canvas_color(asdic_canvas *c, uint32_t rgb) {
    cairo_set_source_rgb(c->cr, (rgb >> 16) / 255.0, (rgb >> 8 & 255) / 255.0, (rgb & 255) / 255.0);
}

static void set_font(cairo_t *cr, double size_px, bool bold) {
    cairo_select_font_face(cr, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                           bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cr, size_px);
}

#define LONGEST_TEXT 1024
#define SMALLEST_PX 10.0 /* of what is made to fit */

/* TEXT without bytes that are no text in UTF-8, as of a character that was cut, behind which cairo
 * would draw nothing. */
static const char *clean(const char *text, char room[LONGEST_TEXT]) {
    size_t left = strlen(text), used = 0;
    while (left > 0 && used + 4 < LONGEST_TEXT) {
        size_t size = asdic_utf8_character(text, left);
        memcpy(room + used, text, size);
        used += size;
        text += size ? size : 1;
        left -= size ? size : 1;
    }
    room[used] = '\0';
    return room;
}

double asdic_canvas_text_width(const char *text, double size_px) {
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1);
    cairo_t *cr = cairo_create(surface);
    cairo_text_extents_t extents;
    char room[LONGEST_TEXT];
    set_font(cr, size_px, false);
    cairo_text_extents(cr, clean(text, room), &extents);
    cairo_destroy(cr);
    cairo_surface_destroy(surface);
    return extents.x_advance;
}

void asdic_canvas_text(asdic_canvas *c, asdic_lettering where, const char *text) {
    cairo_font_extents_t font;
    cairo_text_extents_t extents;
    char room[LONGEST_TEXT];
    text = clean(text, room);
    cairo_save(c->cr);
    set_font(c->cr, where.size_px, where.bold);
    cairo_text_extents(c->cr, text, &extents);
    cairo_font_extents(c->cr, &font);
    cairo_translate(c->cr, where.x, where.y);
    if (where.upwards) {
        cairo_rotate(c->cr, -0.5 * ASDIC_PI);
    }
    /* Capitals are about 0.75 of the ascent: centre and top are theirs, so that labels of one
     * row keep a common baseline. */
    cairo_move_to(c->cr, -where.align_x * extents.x_advance, where.align_y * 0.75 * font.ascent);
    cairo_show_text(c->cr, text);
    cairo_restore(c->cr);
    cairo_new_path(c->cr); /* the current point would start the next line */
}

static double width_of(asdic_canvas *c, const asdic_lettering *where, const char *text) {
    cairo_text_extents_t extents;
    char room[LONGEST_TEXT];
    cairo_save(c->cr);
    set_font(c->cr, where->size_px, where->bold);
    cairo_text_extents(c->cr, clean(text, room), &extents);
    cairo_restore(c->cr);
    return extents.x_advance;
}

/* The first and the last of TEXT, about KEPT bytes in all, with an ellipsis between. */
static void cut_middle(const char *text, size_t kept, char out[LONGEST_TEXT]) {
    size_t length = strlen(text), begin = asdic_words_cut(text, length, kept / 2);
    const char *end = text + length - kept / 2;
    while (((unsigned char)*end & 0xc0) == 0x80) { /* within a character */
        end++;
    }
    snprintf(out, LONGEST_TEXT, "%.*s\u2026%s", (int)begin, text, end);
}

void asdic_canvas_text_fit(asdic_canvas *c, asdic_lettering where, const char *text,
                           double max_width_px) {
    char cut[LONGEST_TEXT];
    double width_px = width_of(c, &where, text);
    while (width_px > max_width_px &&
           where.size_px > SMALLEST_PX) { /* letters do not shrink evenly */
        double next_px = floor(where.size_px * max_width_px / width_px);
        where.size_px = fmax(SMALLEST_PX, fmin(next_px, where.size_px - 1.0));
        width_px = width_of(c, &where, text);
    }
    if (width_px > max_width_px) {
        size_t fits = 0, kept = strlen(text);
        while (kept - fits > 1) { /* between what fits and what does not */
            size_t middle = (fits + kept) / 2;
            cut_middle(text, middle, cut);
            *(width_of(c, &where, cut) > max_width_px ? &kept : &fits) = middle;
        }
        cut_middle(text, fits, cut);
        text = cut;
    }
    asdic_canvas_text(c, where, text);
}

double asdic_canvas_title_room(const char *title) {
    if (!title) {
        return 0.0;
    }
    return 1.7 * ASDIC_TITLE_PX + (strchr(title, '\n') ? 1.3 * ASDIC_NOTE_PX : 0.0);
}

/* Length of NOTE's first row: the statements that fit ROOM_PX, one at least. */
static size_t row_length(const char *note, double room_px) {
    char row[1024];
    size_t best = 0;
    for (const char *at = note; at;) {
        const char *end = strstr(at, ASDIC_NOTE_PART);
        size_t length = end ? (size_t)(end - note) : strlen(note);
        snprintf(row, sizeof row, "%.*s", (int)length, note);
        if (best > 0 && asdic_canvas_text_width(row, ASDIC_NOTE_PX) > room_px) {
            break;
        }
        best = length;
        at = end ? end + strlen(ASDIC_NOTE_PART) : NULL;
    }
    return best;
}

/* Height of the rows of NOTE; draws them on CANVAS, the last at its bottom, unless that is NULL. */
static double draw_note(asdic_canvas *c, double x, const char *note, double room_px) {
    const double row_px = 1.6 * ASDIC_NOTE_PX;
    char row[1024];
    size_t length = note ? row_length(note, room_px) : 0;
    if (length == 0) {
        return 0.0;
    }
    bool is_last = note[length] == 0;
    double below =
        is_last ? 0.0 : draw_note(c, x, note + length + strlen(ASDIC_NOTE_PART), room_px);
    if (c) {
        snprintf(row, sizeof row, "%.*s", (int)length, note);
        asdic_canvas_text_fit(c,
                              (asdic_lettering){.x = x,
                                                .y = c->height - ASDIC_MARGIN_PX - below,
                                                .size_px = ASDIC_NOTE_PX},
                              row, room_px);
    }
    return below + row_px;
}

double asdic_canvas_note_room(const char *note, double x, double width) {
    return draw_note(NULL, x, note, width - x - ASDIC_MARGIN_PX);
}

static void draw_title(asdic_canvas *c, double x, const char *title, double room) {
    char first[512];
    const char *second = strchr(title, '\n');
    size_t length = second ? (size_t)(second - title) : strlen(title);
    snprintf(first, sizeof first, "%.*s", (int)length, title);
    asdic_lettering where = {
        .x = x, .y = ASDIC_MARGIN_PX, .align_y = 1.0, .size_px = ASDIC_TITLE_PX, .bold = true};
    asdic_canvas_color(c, ASDIC_INK_RGB);
    asdic_canvas_text_fit(c, where, first, room);
    if (second) {
        where = (asdic_lettering){.x = x,
                                  .y = ASDIC_MARGIN_PX + 1.35 * ASDIC_TITLE_PX,
                                  .align_y = 1.0,
                                  .size_px = ASDIC_NOTE_PX};
        asdic_canvas_color(c, NOTE_RGB);
        asdic_canvas_text_fit(c, where, second + 1, room);
    }
}

void asdic_canvas_frame_text(asdic_canvas *c, double x, const char *title, const char *note) {
    double room = c->width - x - ASDIC_MARGIN_PX;
    if (title) {
        draw_title(c, x, title, room);
    }
    asdic_canvas_color(c, NOTE_RGB);
    draw_note(c, x, note, room);
}

void asdic_canvas_raster(asdic_canvas *c, const asdic_raster *raster, asdic_box box) {
    cairo_surface_t *image =
        cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)raster->width, (int)raster->height);
    uint8_t *data = cairo_image_surface_get_data(image);
    if (data) {
        size_t stride = (size_t)cairo_image_surface_get_stride(image);
        for (size_t y = 0; y < raster->height; y++) {
            uint32_t *row = (uint32_t *)(void *)(data + y * stride);
            const uint8_t *rgb = raster->rgb + 3 * y * raster->width;
            for (size_t x = 0; x < raster->width; x++) {
                row[x] =
                    (uint32_t)rgb[3 * x] << 16 | (uint32_t)rgb[3 * x + 1] << 8 | rgb[3 * x + 2];
            }
        }
        cairo_surface_mark_dirty(image);
        cairo_save(c->cr);
        cairo_translate(c->cr, box.x, box.y);
        cairo_scale(c->cr, box.w / (double)raster->width, box.h / (double)raster->height);
        cairo_set_source_surface(c->cr, image, 0.0, 0.0);
        cairo_pattern_set_filter(cairo_get_source(c->cr), CAIRO_FILTER_NEAREST);
        /* Without padding a pixel stretched over a page fades at its edges. */
        cairo_pattern_set_extend(cairo_get_source(c->cr), CAIRO_EXTEND_PAD);
        cairo_rectangle(c->cr, 0.0, 0.0, (double)raster->width, (double)raster->height);
        cairo_fill(c->cr);
        cairo_restore(c->cr);
    }
    cairo_surface_destroy(image);
}

void asdic_canvas_line(asdic_canvas *c, double x0, double y0, double x1, double y1) {
    cairo_move_to(c->cr, x0, y0);
    cairo_line_to(c->cr, x1, y1);
    cairo_stroke(c->cr);
}

void asdic_canvas_frame(asdic_canvas *c, asdic_box box) {
    cairo_new_path(c->cr);
    asdic_canvas_color(c, ASDIC_INK_RGB);
    cairo_set_line_width(c->cr, 1.0);
    cairo_rectangle(c->cr, box.x - 0.5, box.y - 0.5, box.w + 1.0, box.h + 1.0);
    cairo_stroke(c->cr);
}

/* --- legends ---------------------------------------------------------------------------------------- */

#define SAMPLE_PX 36.0 /* an entry's piece of line */
#define BESIDE_PX 10.0 /* from there to its name */
#define APART_PX 24.0
#define ROW_PX (1.5 * ASDIC_TEXT_PX)

void asdic_canvas_set_style(asdic_canvas *c, const asdic_series *series) {
    if (!series) {
        cairo_set_dash(c->cr, NULL, 0, 0.0);
        cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_BUTT);
        cairo_set_line_width(c->cr, 1.0);
        return;
    }
    double w = 1.5 * series->width;
    const double dashed[] = {5.0 * w, 3.0 * w};
    const double dotted[] = {0.0, 2.5 * w};
    const double dash_dot[] = {6.0 * w, 2.5 * w, 1.2 * w, 2.5 * w};
    cairo_set_line_width(c->cr, w);
    cairo_set_line_join(c->cr, CAIRO_LINE_JOIN_ROUND);
    cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_BUTT);
    asdic_canvas_color(c, series->rgb);
    switch (series->style) {
    case ASDIC_LINE_SOLID:
        cairo_set_dash(c->cr, NULL, 0, 0.0);
        break;
    case ASDIC_LINE_DASHED:
        cairo_set_dash(c->cr, dashed, 2, 0.0);
        break;
    case ASDIC_LINE_DOTTED: /* round caps of dashes without length are dots */
        cairo_set_line_cap(c->cr, CAIRO_LINE_CAP_ROUND);
        cairo_set_dash(c->cr, dotted, 2, 0.0);
        break;
    case ASDIC_LINE_DASH_DOT:
        cairo_set_dash(c->cr, dash_dot, 4, 0.0);
        break;
    }
}

double asdic_canvas_legend(asdic_canvas *c, asdic_box box, const asdic_series *entries,
                           size_t count) {
    double x = box.x;
    unsigned rows = 0;
    for (size_t i = 0; i < count; i++) {
        const asdic_series *entry = &entries[i];
        if (!entry->label) {
            continue;
        }
        double wide = SAMPLE_PX + BESIDE_PX + asdic_canvas_text_width(entry->label, ASDIC_TEXT_PX);
        rows = rows ? rows : 1;
        if (x > box.x && x + wide > box.x + box.w) {
            rows++;
            x = box.x;
        }
        if (c) {
            double y = box.y + ((double)rows - 0.5) * ROW_PX;
            asdic_canvas_set_style(c, entry);
            asdic_canvas_line(c, x, y, x + SAMPLE_PX, y);
            asdic_canvas_set_style(c, NULL);
            asdic_canvas_color(c, ASDIC_INK_RGB);
            asdic_canvas_text_fit(c,
                                  (asdic_lettering){.x = x + SAMPLE_PX + BESIDE_PX,
                                                    .y = y,
                                                    .align_y = 0.5,
                                                    .size_px = ASDIC_TEXT_PX},
                                  entry->label, box.w - SAMPLE_PX - BESIDE_PX);
        }
        x += wide + APART_PX;
    }
    return rows * ROW_PX;
}

/* --- curves ----------------------------------------------------------------------------------------- */

static bool is_drawable(const asdic_plot_axis *axis, double value) {
    return isfinite(value) && !(axis->logarithmic && value <= 0.0);
}

static bool is_point(const asdic_plot_axis *x, const asdic_plot_axis *y, const asdic_series *series,
                     size_t i) {
    return i < series->count && is_drawable(x, series->x[i]) && is_drawable(y, series->y[i]);
}

/* A point without neighbours is drawn as a dot of this radius. */
#define LONE_PX 2.0

/* Apart from the current path. */
static void dot(asdic_canvas *c, double x, double y, uint32_t rgb) {
    cairo_path_t *path = cairo_copy_path(c->cr);
    cairo_new_path(c->cr);
    asdic_canvas_color(c, rgb);
    cairo_arc(c->cr, x, y, LONE_PX, 0.0, 2.0 * ASDIC_PI);
    cairo_fill(c->cr);
    cairo_append_path(c->cr, path);
    cairo_path_destroy(path);
}

/* Where a path crosses itself is searched for in a time that grows faster than its length: a solid
 * line, which does not show it, is stroked in pieces of so many points. */
#define PIECE_POINTS 256

static void stroke(asdic_canvas *c, const asdic_series *series) {
    asdic_canvas_set_style(c, series);
    cairo_stroke(c->cr);
    asdic_canvas_set_style(c, NULL);
}

void asdic_canvas_curve(asdic_canvas *c, asdic_box box, const asdic_plot_axis *x_axis,
                        const asdic_plot_axis *y_axis, const asdic_series *series) {
    bool drawing = false;
    size_t points = 0;
    cairo_new_path(c->cr);
    for (size_t i = 0; i < series->count; i++) {
        if (!is_point(x_axis, y_axis, series, i)) {
            drawing = false;
            continue;
        }
        double x = box.x + box.w * asdic_axis_share(x_axis, series->x[i]);
        double y = box.y + box.h * (1.0 - asdic_axis_share(y_axis, series->y[i]));
        /* cairo's coordinates are 24-bit: far outside they would wrap round. */
        x = fmin(fmax(x, box.x - box.w), box.x + 2.0 * box.w);
        y = fmin(fmax(y, box.y - box.h), box.y + 2.0 * box.h);
        if (drawing) {
            cairo_line_to(c->cr, x, y);
            if (++points % PIECE_POINTS == 0 && series->style == ASDIC_LINE_SOLID) {
                stroke(c, series);
                cairo_move_to(c->cr, x, y);
            }
        } else if (is_point(x_axis, y_axis, series, i + 1)) {
            cairo_move_to(c->cr, x, y);
        } else {
            dot(c, x, y, series->rgb);
        }
        drawing = true;
    }
    stroke(c, series);
}
