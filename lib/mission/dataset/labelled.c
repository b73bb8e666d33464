#include "labelled.h"

#include "base/context.h"
#include "base/decibel.h"
#include "base/file_read.h"
#include "base/try.h"
#include "outline.h"
#include "out/file.h"
#include "out/grey_png.h"
#include "out/npy.h"
#include "out/raster.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char *const asdic_form_names[ASDIC_FORM_COUNT] = {"polar", "bearing"};

const asdic_frame_folder asdic_frame_folders[ASDIC_FRAME_FOLDERS] = {
    {"frames", "txt"},           {"levels", "npy"},         {"polar", NULL},
    {"polar/images", "png"},     {"polar/images16", "png"}, {"polar/masks", "png"},
    {"polar/labels", "txt"},     {"bearing", NULL},         {"bearing/images", "png"},
    {"bearing/images16", "png"}, {"bearing/masks", "png"},  {"bearing/labels", "txt"},
};

asdic_file_name asdic_frame_path(const char *folder, const char *sub, size_t index,
                                 const char *extension) {
    asdic_file_name out;
    snprintf(out.text, sizeof out.text, "%s/%s/%06zu.%s", folder, sub, index, extension);
    return out;
}

void asdic_frame_remove(const char *folder, size_t index) {
    for (size_t i = 0; i < ASDIC_FRAME_FOLDERS; i++) {
        const asdic_frame_folder *sub = &asdic_frame_folders[i];
        if (sub->extension) {
            unlink(asdic_frame_path(folder, sub->name, index, sub->extension).text);
        }
    }
}

/* --- where bins lie --------------------------------------------------------------------------- */

static asdic_status map_bearing(asdic_context *ctx, const asdic_sonar *sonar, size_t bins,
                                asdic_frame_map *map) {
    size_t beams = sonar->receiver_count;
    *map = (asdic_frame_map){beams, bins, malloc(beams * bins * sizeof *map->cells)};
    for (size_t y = 0; map->cells && y < bins; y++) {
        for (size_t x = 0; x < beams; x++) { /* the farthest bin on top */
            size_t beam = asdic_beam_from_port(sonar->receivers, beams, x);
            map->cells[y * beams + x] = (uint32_t)(beam * bins + bins - 1 - y);
        }
    }
    return map->cells ? ASDIC_OK : asdic_fail_memory(ctx, "a picture's pixels");
}

static asdic_status map_polar(asdic_context *ctx, const asdic_sonar *sonar, size_t bins,
                              double radius_px, asdic_frame_map *map) {
    size_t beams = sonar->receiver_count, good = asdic_beams_in_fan(sonar);
    if (good < beams) {
        return asdic_fail(ctx, ASDIC_ERROR_INPUT,
                          "receiver %zu is not in the order of bearings, or looks straight up or "
                          "down: a data set needs a fan of beams from one side to the other",
                          good);
    }
    double *bearing_rad = malloc(beams * sizeof *bearing_rad);
    asdic_status status = bearing_rad ? ASDIC_OK : asdic_fail_memory(ctx, "bearings");
    for (size_t b = 0; !status && b < beams; b++) {
        bearing_rad[b] = sonar->receivers[b].yaw_rad;
    }
    if (!status) {
        const asdic_fan fan = {.bearing_rad = bearing_rad, .beams = beams, .bins = bins};
        asdic_sector sector = asdic_sector_of(&fan, radius_px);
        *map = (asdic_frame_map){sector.width, sector.height, NULL};
        status = asdic_sector_cells(ctx, &fan, &sector, &map->cells);
    }
    free(bearing_rad);
    return status;
}

asdic_status asdic_frame_maps_init(asdic_context *ctx, const asdic_sonar *sonar, size_t bins,
                                   double radius_px, asdic_frame_map maps[ASDIC_FORM_COUNT]) {
    memset(maps, 0, ASDIC_FORM_COUNT * sizeof *maps);
    TRY(map_polar(ctx, sonar, bins, radius_px, &maps[ASDIC_FORM_POLAR]));
    return map_bearing(ctx, sonar, bins, &maps[ASDIC_FORM_BEARING]);
}

void asdic_frame_maps_finish(asdic_frame_map maps[ASDIC_FORM_COUNT]) {
    for (int form = 0; form < ASDIC_FORM_COUNT; form++) {
        free(maps[form].cells);
        maps[form].cells = NULL;
    }
}

/* --- files ------------------------------------------------------------------------------------ */

static asdic_status write_png(asdic_context *ctx, const char *path, const asdic_grey *image) {
    size_t length = 0;
    unsigned char *bytes = asdic_grey_png(image, &length);
    asdic_status status = bytes ? asdic_file_write_soon(ctx, path, bytes, length)
                                : asdic_fail_memory(ctx, "a picture");
    free(bytes);
    return status;
}

static asdic_status write_levels(asdic_context *ctx, const asdic_labelled *f,
                                 const float *levels_db) {
    char header[ASDIC_NPY_HEADER_SIZE], rest[32];
    size_t cells = f->ping->beams * f->ping->bins;
    snprintf(rest, sizeof rest, "%zu", f->ping->bins);
    size_t length = asdic_npy_header(header, "'<f4'", f->ping->beams, rest);
    char *whole = malloc(length + cells * sizeof *levels_db);
    if (!whole) {
        return asdic_fail_memory(ctx, "levels");
    }
    memcpy(whole, header, length);
    memcpy(whole + length, levels_db, cells * sizeof *levels_db);
    asdic_status status =
        asdic_file_write_soon(ctx, asdic_frame_path(f->folder, "levels", f->index, "npy").text,
                              whole, length + cells * sizeof *levels_db);
    free(whole);
    return status;
}

/* What every bin shows: greys 1 to 65535 from LOW to HIGH, 0 where there is no energy; the object's class. */
typedef struct shown {
    uint16_t *grey, *number;
    uint8_t *seen;
} shown;

/* The class of the object that bin AT shows; 0: none. */
static uint16_t class_at(const asdic_labelled *f, size_t at) {
    const asdic_ping_truth *truth = f->ping->truth;
    size_t beams = f->ping->beams, beam = at / f->ping->bins;
    int object = truth->object[at];
    bool is_shown = object > 0 && (double)truth->object_share[at] >= f->threshold &&
                    (!f->heard || f->heard[((size_t)object - 1) * beams + beam]);
    return is_shown ? f->classes[object] : 0;
}

static void show(const asdic_labelled *f, const float *levels_db, shown *s) {
    size_t bins = f->ping->bins;
    double scale = 65534.0 / (f->high_db - f->low_db);
    for (size_t at = 0; at < f->ping->beams * bins; at++) {
        double level = (double)levels_db[at] + (double)f->gain_db[at % bins];
        double grey = fmin(fmax((level - f->low_db) * scale, 0.0), 65534.0);
        s->grey[at] = isnan(level) ? 0 : (uint16_t)(1.0 + rint(grey));
        s->number[at] = class_at(f, at);
    }
}

/* VALUES of the bins as pixels. */
static void lay_out(const asdic_frame_map *map, const uint16_t *values, uint16_t *pixels) {
    for (size_t i = 0; i < map->width * map->height; i++) {
        pixels[i] = map->cells[i] == UINT32_MAX ? 0 : values[map->cells[i]];
    }
}

/* PIXELS in eight bits: greys 1 to 65535 as the nearest of 1 to 255, 0 as 0; numbers as they are. */
static void to_bytes(const uint16_t *pixels, size_t count, bool greys, uint8_t *bytes) {
    for (size_t i = 0; i < count; i++) {
        bool is_grey = greys && pixels[i] > 0;
        bytes[i] = (uint8_t)(is_grey ? 1 + ((pixels[i] - 1) * 254u + 32767u) / 65534u : pixels[i]);
    }
}

/* The file of KIND of a frame's FORM. */
static asdic_file_name path_of(const asdic_labelled *f, asdic_view_form form, const char *kind,
                               const char *extension) {
    char sub[32];
    snprintf(sub, sizeof sub, "%s/%s", asdic_form_names[form], kind);
    return asdic_frame_path(f->folder, sub, f->index, extension);
}

static asdic_status write_grey(asdic_context *ctx, const asdic_labelled *f, asdic_view_form form,
                               const char *kind, unsigned bits, const void *values) {
    const asdic_frame_map *map = &f->maps[form];
    const asdic_grey image = {map->width, map->height, bits, values};
    return write_png(ctx, path_of(f, form, kind, "png").text, &image);
}

/* Boxes and polygons of MASK, COCO's to RECORD and YOLO's to a file. */
static asdic_status write_labels(asdic_context *ctx, const asdic_labelled *f, asdic_view_form form,
                                 const asdic_mask *mask, uint8_t *seen, asdic_text *record) {
    asdic_text yolo = {0};
    asdic_box *boxes = calloc(f->class_count + 1, sizeof *boxes);
    if (!boxes) {
        return asdic_fail_memory(ctx, "boxes");
    }
    asdic_mask_boxes(mask, f->class_count, boxes);
    for (size_t i = 1; i <= f->class_count; i++) {
        const asdic_box *b = &boxes[i];
        if (b->pixels == 0) {
            continue;
        }
        double wide = (double)(b->right - b->left), high = (double)(b->bottom - b->top);
        double w = (double)mask->width, h = (double)mask->height;
        asdic_text_format(&yolo, "%zu %.6f %.6f %.6f %.6f\n", i - 1,
                          ((double)b->left + 0.5 * wide) / w, ((double)b->top + 0.5 * high) / h,
                          wide / w, high / h);
        asdic_text_format(record,
                          "%c\"image_id\":%zu,\"category_id\":%zu,\"iscrowd\":0,\"area\":%zu,"
                          "\"bbox\":[%zu,%zu,%zu,%zu],\"segmentation\":[",
                          form == ASDIC_FORM_POLAR ? 'P' : 'B', f->index, i, b->pixels, b->left,
                          b->top, b->right - b->left, b->bottom - b->top);
        asdic_mask_polygons(mask, b, (uint16_t)i, seen, record);
        asdic_text_add(record, "]}\n");
    }
    free(boxes);
    yolo.failed |= record->failed;
    return asdic_file_write_text(ctx, path_of(f, form, "labels", "txt").text, &yolo, "labels",
                                 true);
}

static asdic_status write_form(asdic_context *ctx, const asdic_labelled *f, asdic_view_form form,
                               const shown *s, uint16_t *pixels, asdic_text *record) {
    const asdic_frame_map *map = &f->maps[form];
    size_t count = map->width * map->height;
    uint8_t *bytes = (uint8_t *)(pixels + count);
    lay_out(map, s->grey, pixels);
    to_bytes(pixels, count, true, bytes);
    TRY(write_grey(ctx, f, form, "images", 8, bytes));
    TRY(write_grey(ctx, f, form, "images16", 16, pixels));
    lay_out(map, s->number, pixels);
    to_bytes(pixels, count, false, bytes);
    bool small = f->class_count < 256;
    TRY(write_grey(ctx, f, form, "masks", small ? 8 : 16, small ? (void *)bytes : (void *)pixels));
    const asdic_mask mask = {map->width, map->height, pixels};
    return write_labels(ctx, f, form, &mask, s->seen, record);
}

/* A record's first line: the bytes of the frame's files, then of what follows in the record. The disk is not waited
 * for: after a power cut a record may be there, and what was written before it not. */
static asdic_status add_sizes(asdic_context *ctx, const char *folder, size_t index, size_t rest,
                              asdic_text *record) {
    struct stat st;
    asdic_text_add(record, "S");
    for (size_t i = 1; i < ASDIC_FRAME_FOLDERS; i++) {
        const asdic_frame_folder *sub = &asdic_frame_folders[i];
        if (sub->extension) {
            const asdic_file_name path = asdic_frame_path(folder, sub->name, index, sub->extension);
            if (access(path.text, R_OK) != 0 || stat(path.text, &st) != 0) {
                return asdic_fail(ctx, ASDIC_ERROR_INPUT, "%s: cannot open: %s", path.text,
                                  strerror(errno));
            }
            asdic_text_format(record, "%lld ", (long long)st.st_size);
        }
    }
    asdic_text_format(record, "%zu\n", rest);
    return record->failed ? asdic_fail_memory(ctx, "a frame's record") : ASDIC_OK;
}

static asdic_status write_record(asdic_context *ctx, const asdic_labelled *f, asdic_text *record) {
    const asdic_file_name path = asdic_frame_path(f->folder, "frames", f->index, "txt");
    return asdic_file_write_text(ctx, path.text, record, "a frame's record", true);
}

/* The record of a frame with pictures, of which FACTS tells. */
static asdic_status write_facts(asdic_context *ctx, const asdic_labelled *f,
                                const asdic_text *facts) {
    asdic_text record = {.failed = facts->failed};
    asdic_status status = add_sizes(ctx, f->folder, f->index, facts->length, &record);
    if (status) {
        asdic_text_finish(&record);
        return status;
    }
    asdic_text_add_bytes(&record, facts->data, facts->length);
    return write_record(ctx, f, &record);
}

/* The record of a frame without pictures; others' files must not seem to be its own. */
static asdic_status write_void(asdic_context *ctx, const asdic_labelled *f) {
    asdic_text record = {0};
    asdic_frame_remove(f->folder, f->index);
    asdic_text_format(&record, "V%s\n", f->facts);
    return write_record(ctx, f, &record);
}

/* Records of older sets have no line of sizes, void frames no files. */
asdic_status asdic_frame_check(asdic_context *ctx, const char *folder, size_t index) {
    char *text = NULL;
    size_t length = 0;
    asdic_text sizes = {0};
    TRY(asdic_file_read(ctx, asdic_frame_path(folder, "frames", index, "txt").text,
                        ASDIC_FRAME_MOST_BYTES, &text, &length));
    if (text[0] == 'V' && text[length - 1] == '\n') {
        free(text);
        return ASDIC_OK;
    }
    const char *end = strchr(text, '\n');
    size_t first = end ? (size_t)(end - text) + 1 : 0;
    asdic_status status = add_sizes(ctx, folder, index, length - first, &sizes);
    bool is_whole = !status && (text[0] == 'M' ||
                                (first == sizes.length && memcmp(text, sizes.data, first) == 0));
    asdic_text_finish(&sizes);
    free(text);
    return status || is_whole
               ? status
               : asdic_fail(ctx, ASDIC_ERROR_INPUT,
                            "frame %zu in '%s' is damaged: its files have not the sizes that its "
                            "record says; --resume makes it again",
                            index, folder);
}

static asdic_status write_all(asdic_context *ctx, const asdic_labelled *f, float *levels_db,
                              shown *s, uint16_t *pixels, asdic_text *record) {
    asdic_decibels(f->ping->intensity_lin[ASDIC_TOTAL], f->ping->beams * f->ping->bins, levels_db);
    TRY(write_levels(ctx, f, levels_db));
    show(f, levels_db, s);
    asdic_text_format(record, "M%s\n", f->facts);
    for (int form = 0; form < ASDIC_FORM_COUNT; form++) {
        TRY(write_form(ctx, f, (asdic_view_form)form, s, pixels, record));
    }
    return write_facts(ctx, f, record);
}

asdic_status asdic_frame_write(asdic_context *ctx, const asdic_labelled *frame) {
    if (!frame->ping) {
        return write_void(ctx, frame);
    }
    size_t cells = frame->ping->beams * frame->ping->bins, most = 0;
    for (int form = 0; form < ASDIC_FORM_COUNT; form++) {
        size_t count = frame->maps[form].width * frame->maps[form].height;
        most = count > most ? count : most;
    }
    asdic_text record = {0};
    float *levels_db = malloc(cells * sizeof *levels_db);
    shown s = {malloc(cells * sizeof *s.grey), malloc(cells * sizeof *s.number), calloc(most, 1)};
    uint16_t *pixels = malloc(most * 3);
    asdic_status status = levels_db && s.grey && s.number && s.seen && pixels
                              ? write_all(ctx, frame, levels_db, &s, pixels, &record)
                              : asdic_fail_memory(ctx, "a frame");
    asdic_text_finish(&record);
    free(levels_db);
    free(s.grey);
    free(s.number);
    free(s.seen);
    free(pixels);
    return status;
}
