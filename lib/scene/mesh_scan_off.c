/*
 * Object File Format: a keyword, three counts, a line per vertex, a line per facet. Comments,
 * colours and normals are cut out of the text during the scan: OpenMesh 9 loses its place at some
 * of them and may then read on for minutes.
 */
#include "mesh_scan.h"

#include "base/hash.h"
#include "base/try.h"

#include "../base/context.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Whether something but a comment is left of the line; then it begins there. */
static bool has_content(asdic_line *line) {
    asdic_line_skip_blanks(line);
    return line->at < line->end && *line->at != '#';
}

static bool next_content(const asdic_mesh_scan *scan, asdic_line *line) {
    while (asdic_line_next(scan, line)) {
        if (has_content(line)) {
            return true;
        }
    }
    return false;
}

/* The text that is kept, in place: it never overtakes what was read. */
typedef struct off_text {
    asdic_mesh_scan *scan;
    char *to;
} off_text;

/* Keeps a line's text from FROM to where it was read to. */
static void keep(off_text *text, const char *from, const char *to) {
    size_t length = (size_t)(to - from);
    memmove(text->to, from, length);
    text->to += length;
    if (text->to < text->scan->text + text->scan->size) {
        *text->to++ = '\n';
    }
}

/* A coordinate; OpenMesh reads single precision. */
static bool take_coordinate(const asdic_mesh_scan *scan, asdic_line *line, double *out) {
    return asdic_line_take_number(scan, line, out) && fabs(*out) <= FLT_MAX;
}

/* "OFF" after any of ST, C, N: texture, colour and normal columns follow the coordinates. */
static bool take_keyword(asdic_line *line) {
    static const char *const keywords[] = {"OFF",   "COFF",   "NOFF",   "CNOFF",
                                           "STOFF", "STCOFF", "STNOFF", "STCNOFF"};
    for (size_t i = 0; i < sizeof keywords / sizeof *keywords; i++) {
        if (asdic_line_take_word(line, keywords[i])) {
            return true;
        }
    }
    return false;
}

static asdic_status scan_counts(off_text *text, asdic_line *line, long long *vertices,
                                long long *facets) {
    asdic_mesh_scan *scan = text->scan;
    long long edges;
    if (!next_content(scan, line) || !take_keyword(line)) {
        return asdic_mesh_scan_fail(scan, line->number,
                                    "does not start with OFF (or COFF, NOFF, STOFF)");
    }
    asdic_line_skip_blanks(line);
    if (asdic_line_take_word(line, "BINARY")) {
        return asdic_mesh_scan_fail(scan, line->number, "binary OFF is not read; save it as text");
    }
    keep(text, "OFF", &"OFF"[3]);
    if (!has_content(line) && !next_content(scan, line)) {
        return asdic_mesh_scan_fail(scan, line->number, "ends before its counts");
    }
    const char *from = line->at;
    if (!asdic_line_take_integer(line, vertices) || !asdic_line_take_integer(line, facets) ||
        !asdic_line_take_integer(line, &edges)) {
        return asdic_mesh_scan_fail(scan, line->number,
                                    "the numbers of vertices, facets and edges are expected here");
    }
    /* The shortest vertex is "0 0 0", the shortest facet "3 0 1 2", each with a line end. */
    if (*vertices <= 0 || *facets <= 0 || (size_t)*vertices > scan->size / 6 ||
        (size_t)*facets > scan->size / 8) {
        return asdic_mesh_scan_fail(scan, line->number,
                                    "%lld vertices and %lld facets do not fit %zu bytes", *vertices,
                                    *facets, scan->size);
    }
    keep(text, from, line->at);
    return ASDIC_OK;
}

static asdic_status scan_vertices(off_text *text, asdic_line *line, long long vertices) {
    asdic_mesh_scan *scan = text->scan;
    size_t capacity = 0;
    for (long long i = 0; i < vertices; i++) {
        double v[3];
        if (!next_content(scan, line)) {
            return asdic_mesh_scan_fail(scan, line->number, "ends after %lld of %lld vertices", i,
                                        vertices);
        }
        const char *from = line->at;
        for (int k = 0; k < 3; k++) {
            if (!take_coordinate(scan, line, &v[k])) {
                return asdic_mesh_scan_fail(scan, line->number,
                                            "coordinate %d of vertex %lld is not a finite number",
                                            k + 1, i);
            }
        }
        keep(text, from, line->at);
        TRY(asdic_mesh_scan_add_vertex(scan, v, &capacity));
    }
    return ASDIC_OK;
}

static asdic_status scan_facets(off_text *text, asdic_line *line, long long facets) {
    asdic_mesh_scan *scan = text->scan;
    for (long long i = 0; i < facets; i++) {
        long long corners, vertex;
        if (!next_content(scan, line)) {
            return asdic_mesh_scan_fail(scan, line->number, "ends after %lld of %lld facets", i,
                                        facets);
        }
        const char *from = line->at;
        if (!asdic_line_take_integer(line, &corners) || corners < 3) {
            return asdic_mesh_scan_fail(scan, line->number,
                                        "facet %lld does not start with 3 or more corners", i);
        }
        scan->facet_hash = asdic_hash_fold(scan->facet_hash, (uint64_t)corners);
        for (long long k = 0; k < corners; k++) {
            if (!asdic_line_take_integer(line, &vertex) || vertex < 0 ||
                vertex >= (long long)scan->vertices) {
                return asdic_mesh_scan_fail(scan, line->number,
                                            "corner %lld of facet %lld names no vertex", k, i);
            }
            scan->facet_hash = asdic_hash_fold(scan->facet_hash, (uint64_t)vertex);
        }
        keep(text, from, line->at);
        scan->facets++;
    }
    return ASDIC_OK;
}

asdic_status asdic_mesh_scan_off(asdic_mesh_scan *scan) {
    asdic_line line = {0};
    long long vertices, facets;
    scan->format = ASDIC_MESH_OFF;
    off_text text = {.scan = scan, .to = scan->text};
    TRY(scan_counts(&text, &line, &vertices, &facets));
    TRY(scan_vertices(&text, &line, vertices));
    TRY(scan_facets(&text, &line, facets));
    *text.to = 0;
    scan->size = (size_t)(text.to - scan->text);
    return ASDIC_OK;
}
