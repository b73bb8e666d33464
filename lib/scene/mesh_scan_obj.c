/*
 * Wavefront OBJ: `v` and `f` lines; everything else is not geometry.
 */
#include "mesh_polygon.h"

#include "base/grow.h"
#include "base/hash.h"
#include "base/try.h"
#include "mesh_scan.h"

#include "../base/context.h"

#include <stdlib.h>
#include <string.h>

typedef struct obj_state {
    size_t vertex_capacity;
    long long highest; /* largest vertex number used so far, and where */
    size_t highest_line;
    size_t outlines_capacity;
    uint32_t facet[ASDIC_POLYGON_MAX_CORNERS]; /* the current facet, indices from 0 */
    uint32_t kept[ASDIC_POLYGON_MAX_CORNERS];  /* what OpenMesh keeps of it */
} obj_state;

static asdic_status scan_vertex(asdic_mesh_scan *scan, asdic_line *line, obj_state *state) {
    double v[3];
    for (int k = 0; k < 3; k++) {
        if (!asdic_line_take_number(scan, line, &v[k])) {
            return asdic_mesh_scan_fail(
                scan, line->number, "coordinate %d of this vertex is not a finite number", k + 1);
        }
    }
    return asdic_mesh_scan_add_vertex(scan, v, &state->vertex_capacity);
}

static void skip_word(asdic_line *line) {
    while (line->at < line->end && *line->at != ' ' && *line->at != '\t' && *line->at != '\r') {
        line->at++;
    }
}

/* One corner: the vertex's number, counted from 1 or, negative, back from the last one. */
static asdic_status scan_corner(asdic_mesh_scan *scan, asdic_line *line, obj_state *state,
                                size_t corner) {
    long long number, known = (long long)scan->vertices;
    if (corner == ASDIC_POLYGON_MAX_CORNERS) {
        return asdic_mesh_scan_fail(scan, line->number,
                                    "a facet with more than %d corners; triangulate it",
                                    ASDIC_POLYGON_MAX_CORNERS);
    }
    if (!asdic_line_take_integer(line, &number) || number == 0 || number < -known) {
        return asdic_mesh_scan_fail(scan, line->number, "corner %zu of this facet names no vertex",
                                    corner + 1);
    }
    state->facet[corner] = (uint32_t)(number < 0 ? known + number : number - 1);
    if (number > state->highest) {
        state->highest = number;
        state->highest_line = line->number;
    }
    skip_word(line); /* texture and normal: /2/3 */
    asdic_line_skip_blanks(line);
    return ASDIC_OK;
}

/* OpenMesh drops a corner that names a vertex again, and what has then no three corners. */
static size_t drop_repeated(const uint32_t *facet, size_t corners, uint32_t *out) {
    size_t kept = 0;
    for (size_t i = 0; i < corners; i++) {
        size_t j = 0;
        while (j < kept && out[j] != facet[i]) {
            j++;
        }
        if (j == kept) {
            out[kept++] = facet[i];
        }
    }
    return kept;
}

/* Such a corner may lead to a hole and back: the outline is kept as it stands. */
static asdic_status keep_outline(asdic_mesh_scan *scan, obj_state *state, size_t corners) {
    size_t needed = scan->outlines_size + 2 + corners;
    if (!asdic_reserve(&scan->outlines, needed, &state->outlines_capacity,
                       sizeof *scan->outlines)) {
        return asdic_fail_memory(scan->ctx, "the facets of an OBJ file");
    }
    uint32_t *out = scan->outlines + scan->outlines_size;
    out[0] = (uint32_t)(scan->facets - scan->degenerate);
    out[1] = (uint32_t)corners;
    memcpy(out + 2, state->facet, corners * sizeof *out);
    scan->outlines_size = needed;
    return ASDIC_OK;
}

static asdic_status count_facet(asdic_mesh_scan *scan, obj_state *state, size_t corners) {
    size_t kept = drop_repeated(state->facet, corners, state->kept);
    if (kept < 3) {
        scan->facets++;
        scan->degenerate++;
        return ASDIC_OK;
    }
    if (kept < corners) {
        TRY(keep_outline(scan, state, corners));
    }
    scan->facets++;
    scan->facet_hash = asdic_hash_fold(scan->facet_hash, kept);
    for (size_t i = 0; i < kept; i++) {
        scan->facet_hash = asdic_hash_fold(scan->facet_hash, state->kept[i]);
    }
    return ASDIC_OK;
}

static asdic_status scan_facet(asdic_mesh_scan *scan, asdic_line *line, obj_state *state) {
    size_t corners = 0;
    asdic_line_skip_blanks(line);
    while (line->at < line->end && *line->at != '#') {
        TRY(scan_corner(scan, line, state, corners++));
    }
    if (corners < 3) {
        return asdic_mesh_scan_fail(scan, line->number, "a facet with %zu corners; 3 are needed",
                                    corners);
    }
    return count_facet(scan, state, corners);
}

static bool ends_in_backslash(const asdic_line *line) {
    const char *last = line->end;
    while (last > line->at && (last[-1] == '\r' || last[-1] == ' ')) {
        last--;
    }
    return last > line->at && last[-1] == '\\';
}

static asdic_status scan_lines(asdic_mesh_scan *scan, obj_state *state) {
    asdic_line line = {0};
    while (asdic_line_next(scan, &line)) {
        asdic_line_skip_blanks(&line);
        if (line.at == line.end || *line.at == '#') {
            continue;
        }
        if (ends_in_backslash(&line)) {
            return asdic_mesh_scan_fail(
                scan, line.number, "continued by '\\', which the reader loses; join the lines");
        }
        asdic_status status = ASDIC_OK;
        if (asdic_line_take_word(&line, "v")) {
            status = scan_vertex(scan, &line, state);
        } else if (asdic_line_take_word(&line, "f")) {
            status = scan_facet(scan, &line, state);
        }
        if (status != ASDIC_OK) {
            return status;
        }
    }
    return ASDIC_OK;
}

static asdic_status check_whole(const asdic_mesh_scan *scan, const obj_state *state) {
    if (scan->vertices == 0 || scan->facets == 0) {
        return asdic_mesh_scan_fail(scan, 0, "%zu vertices ('v' lines) and %zu facets ('f' lines)",
                                    scan->vertices, scan->facets);
    }
    if (state->highest > (long long)scan->vertices) {
        return asdic_mesh_scan_fail(scan, state->highest_line,
                                    "this facet names vertex %lld, but there are %zu",
                                    state->highest, scan->vertices);
    }
    return ASDIC_OK;
}

asdic_status asdic_mesh_scan_obj(asdic_mesh_scan *scan) {
    scan->format = ASDIC_MESH_OBJ;
    obj_state *state = calloc(1, sizeof *state);
    if (!state) {
        return asdic_fail_memory(scan->ctx, "the facets of an OBJ file");
    }
    asdic_status status = scan_lines(scan, state);
    status = status ? status : check_whole(scan, state);
    free(state);
    return status;
}
