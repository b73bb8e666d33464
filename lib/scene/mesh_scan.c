#include "mesh_scan.h"

#include "base/try.h"

#include "../base/context.h"
#include "base/file_read.h"
#include "base/grow.h"
#include "base/number.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

asdic_status asdic_mesh_scan_fail(const asdic_mesh_scan *scan, size_t line, const char *format,
                                  ...) {
    char text[512];
    va_list args;
    va_start(args, format);
    asdic_c_print(text, sizeof text, format, args);
    va_end(args);
    if (line == 0) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT, "%s: %s", scan->path, text);
    }
    return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT, "%s:%zu: %s", scan->path, line, text);
}

bool asdic_line_next(const asdic_mesh_scan *scan, asdic_line *line) {
    const char *end = scan->text + scan->size;
    const char *at = line->number == 0 ? scan->text : line->end;
    if (line->number > 0 && at < end) {
        at++; /* the line's own end */
    }
    if (at >= end) {
        return false;
    }
    const char *stop = memchr(at, '\n', (size_t)(end - at));
    line->at = at;
    line->end = stop ? stop : end;
    line->number++;
    return true;
}

void asdic_line_skip_blanks(asdic_line *line) {
    while (line->at < line->end && (*line->at == ' ' || *line->at == '\t' || *line->at == '\r')) {
        line->at++;
    }
}

static bool at_word_end(const asdic_line *line, const char *at) {
    return at >= line->end || *at == ' ' || *at == '\t' || *at == '\r';
}

bool asdic_line_take_word(asdic_line *line, const char *word) {
    size_t length = strlen(word);
    asdic_line_skip_blanks(line);
    if ((size_t)(line->end - line->at) < length || memcmp(line->at, word, length) != 0 ||
        !at_word_end(line, line->at + length)) {
        return false;
    }
    line->at += length;
    return true;
}

bool asdic_line_take_number(const asdic_mesh_scan *scan, asdic_line *line, double *out) {
    asdic_line_skip_blanks(line);
    if (line->at >= line->end) {
        return false;
    }
    char *stop;
    double value = strtod_l(line->at, &stop, scan->c_locale);
    if (stop == line->at || stop > line->end || !at_word_end(line, stop) || !isfinite(value) ||
        memchr(line->at, 'x', (size_t)(stop - line->at)) ||
        memchr(line->at, 'X', (size_t)(stop - line->at))) { /* C++ streams read no 0x10 */
        return false;
    }
    line->at = stop;
    *out = value;
    return true;
}

bool asdic_line_take_integer(asdic_line *line, long long *out) {
    asdic_line_skip_blanks(line);
    if (line->at >= line->end) {
        return false;
    }
    char *stop;
    errno = 0;
    long long value = strtoll(line->at, &stop, 10);
    if (stop == line->at || stop > line->end || errno != 0) {
        return false;
    }
    line->at = stop;
    *out = value;
    return true;
}

asdic_status asdic_mesh_scan_add_vertex(asdic_mesh_scan *scan, const double v[3],
                                        size_t *capacity) {
    if (!asdic_grow(&scan->vertices_m, scan->vertices, capacity, 3 * sizeof *v)) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_MEMORY, "%s: out of memory for %zu vertices",
                          scan->path, scan->vertices + 1);
    }
    memcpy(&scan->vertices_m[3 * scan->vertices++], v, 3 * sizeof *v);
    return ASDIC_OK;
}

static asdic_status read_stream(asdic_mesh_scan *scan, FILE *file) {
    struct stat info;
    if (fstat(fileno(file), &info) != 0) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_IO, "%s: %s", scan->path, strerror(errno));
    }
    scan->text = malloc((size_t)info.st_size + 1);
    if (!scan->text) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_MEMORY, "%s: out of memory for %lld bytes",
                          scan->path, (long long)info.st_size);
    }
    scan->size = fread(scan->text, 1, (size_t)info.st_size, file);
    if (ferror(file)) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_IO, "%s: cannot read: %s", scan->path,
                          strerror(errno));
    }
    scan->text[scan->size] = '\0';
    if (scan->size == 0) {
        return asdic_fail(scan->ctx, ASDIC_ERROR_INPUT, "%s: the file is empty", scan->path);
    }
    if (strncmp(scan->text, "version https://git-lfs", 23) == 0) {
        return asdic_mesh_scan_fail(
            scan, 0, "a pointer of Git LFS in place of the file; 'git lfs pull' fetches it");
    }
    return ASDIC_OK;
}

/* A zero byte would end strings early; UTF-16 has them, too. Editors of Windows put a mark before text in
 * UTF-8; the first systems of Apple ended lines by CR alone. */
asdic_status asdic_mesh_scan_take_text(asdic_mesh_scan *scan) {
    if (memchr(scan->text, '\0', scan->size)) {
        return asdic_mesh_scan_fail(scan, 0,
                                    "binary or UTF-16 where text is expected; save it as UTF-8");
    }
    size_t mark = asdic_utf8_mark(scan->text, scan->size);
    scan->size -= mark;
    memmove(scan->text, scan->text + mark, scan->size + 1);
    bool has_lines = memchr(scan->text, '\n', scan->size) != NULL;
    for (size_t i = 0; !has_lines && i < scan->size; i++) {
        scan->text[i] = scan->text[i] == '\r' ? '\n' : scan->text[i];
    }
    return ASDIC_OK;
}

asdic_status asdic_mesh_scan_open(asdic_context *ctx, const char *path, asdic_mesh_scan *out) {
    *out = (asdic_mesh_scan){.ctx = ctx, .path = path};
    out->c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!out->c_locale) {
        return asdic_fail_memory(ctx, "the C locale");
    }
    FILE *file;
    TRY(asdic_file_open(ctx, path, &file));
    asdic_status status = read_stream(out, file);
    fclose(file);
    return status;
}

asdic_status asdic_mesh_scan_file(asdic_context *ctx, const char *path, asdic_mesh_scan *out) {
    static const struct {
        const char *extension;
        bool text;
        asdic_status (*scan)(asdic_mesh_scan *);
    } formats[] = {
        {"obj", true, asdic_mesh_scan_obj},
        {"off", true, asdic_mesh_scan_off},
        {"ply", false, asdic_mesh_scan_ply},
        {"stl", false, asdic_mesh_scan_stl},
    };
    *out = (asdic_mesh_scan){.ctx = ctx, .path = path};
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof formats / sizeof *formats; i++) {
        if (strcasecmp(dot + 1, formats[i].extension) != 0) {
            continue;
        }
        TRY(asdic_mesh_scan_open(ctx, path, out));
        if (formats[i].text) {
            TRY(asdic_mesh_scan_take_text(out));
        }
        return formats[i].scan(out);
    }
    return asdic_fail(ctx, ASDIC_ERROR_INPUT,
                      "%s: '%s' is not a mesh format; use .obj, .off, .ply or .stl", path,
                      dot ? dot : "");
}

void asdic_mesh_scan_finish(asdic_mesh_scan *scan) {
    if (scan->c_locale) {
        freelocale(scan->c_locale);
    }
    free(scan->text);
    free(scan->vertices_m);
    free(scan->outlines);
    *scan = (asdic_mesh_scan){0};
}
