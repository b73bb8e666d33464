/*
 * Object File Format: a keyword, three counts, a line per vertex, a line per facet.
 */
#include "mesh_scan.h"

#include "../base/context.h"

#include <string.h>

/* The next line with something on it beside a comment. */
static bool next_content(const asdic_mesh_scan *scan, asdic_line *line) {
    while (asdic_line_next(scan, line)) {
        const char *comment = memchr(line->at, '#', (size_t)(line->end - line->at));
        asdic_line content = *line;
        content.end = comment ? comment : line->end;
        asdic_line_skip_blanks(&content);
        if (content.at < content.end) {
            line->at = content.at;
            return true;
        }
    }
    return false;
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

static asdic_status scan_counts(asdic_mesh_scan *scan, asdic_line *line, long long *vertices,
                                long long *facets) {
    long long edges;
    if (!next_content(scan, line) || !take_keyword(line)) {
        return asdic_mesh_scan_fail(scan, line->number,
                                    "does not start with OFF (or COFF, NOFF, STOFF)");
    }
    asdic_line_skip_blanks(line);
    if (asdic_line_take_word(line, "BINARY")) {
        return asdic_mesh_scan_fail(scan, line->number, "binary OFF is not read; save it as text");
    }
    if (line->at == line->end && !next_content(scan, line)) {
        return asdic_mesh_scan_fail(scan, line->number, "ends before its counts");
    }
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
    return ASDIC_OK;
}

static asdic_status scan_vertices(asdic_mesh_scan *scan, asdic_line *line, long long vertices) {
    size_t capacity = 0;
    for (long long i = 0; i < vertices; i++) {
        double v[3];
        if (!next_content(scan, line)) {
            return asdic_mesh_scan_fail(scan, line->number, "ends after %lld of %lld vertices", i,
                                        vertices);
        }
        for (int k = 0; k < 3; k++) {
            if (!asdic_line_take_number(scan, line, &v[k])) {
                return asdic_mesh_scan_fail(scan, line->number,
                                            "coordinate %d of vertex %lld is not a finite number",
                                            k + 1, i);
            }
        }
        asdic_status status = asdic_mesh_scan_add_vertex(scan, v, &capacity);
        if (status != ASDIC_OK) {
            return status;
        }
    }
    return ASDIC_OK;
}

static asdic_status scan_facets(asdic_mesh_scan *scan, asdic_line *line, long long facets) {
    for (long long i = 0; i < facets; i++) {
        long long corners, vertex;
        if (!next_content(scan, line)) {
            return asdic_mesh_scan_fail(scan, line->number, "ends after %lld of %lld facets", i,
                                        facets);
        }
        if (!asdic_line_take_integer(line, &corners) || corners < 3) {
            return asdic_mesh_scan_fail(scan, line->number,
                                        "facet %lld does not start with 3 or more corners", i);
        }
        scan->facet_hash = asdic_mesh_scan_hash(scan->facet_hash, (uint64_t)corners);
        for (long long k = 0; k < corners; k++) {
            if (!asdic_line_take_integer(line, &vertex) || vertex < 0 ||
                vertex >= (long long)scan->vertices) {
                return asdic_mesh_scan_fail(scan, line->number,
                                            "corner %lld of facet %lld names no vertex", k, i);
            }
            scan->facet_hash = asdic_mesh_scan_hash(scan->facet_hash, (uint64_t)vertex);
        }
        scan->facets++;
    }
    return ASDIC_OK;
}

asdic_status asdic_mesh_scan_off(asdic_mesh_scan *scan) {
    asdic_line line = {0};
    long long vertices, facets;
    scan->format = ASDIC_MESH_OFF;
    asdic_status status = scan_counts(scan, &line, &vertices, &facets);
    status = status ? status : scan_vertices(scan, &line, vertices);
    return status ? status : scan_facets(scan, &line, facets);
}
