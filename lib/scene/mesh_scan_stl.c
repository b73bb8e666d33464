/*
 * STL, binary (84 bytes and 50 per facet, exactly) or text.
 */
#include "mesh_scan.h"

#include "../base/context.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#define HEADER_BYTES 84
#define FACET_BYTES 50

static uint32_t little_endian(const char *bytes) {
    const unsigned char *b = (const unsigned char *)bytes;
    return b[0] | (uint32_t)b[1] << 8 | (uint32_t)b[2] << 16 | (uint32_t)b[3] << 24;
}

/* A facet with two equal corners, as single precision sees them. */
static bool has_equal_corners(const float v[3][3]) {
    for (int i = 0; i < 3; i++) {
        const float *a = v[i], *b = v[(i + 1) % 3];
        if (a[0] == b[0] && a[1] == b[1] && a[2] == b[2]) {
            return true;
        }
    }
    return false;
}

static asdic_status scan_binary(asdic_mesh_scan *scan, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        const char *facet = scan->text + HEADER_BYTES + (size_t)FACET_BYTES * i;
        float v[3][3];
        for (int k = 0; k < 9; k++) {
            uint32_t bits = little_endian(facet + 12 + 4 * k); /* after the normal */
            memcpy(&v[k / 3][k % 3], &bits, sizeof bits);
            if (!isfinite(v[k / 3][k % 3])) {
                return asdic_mesh_scan_fail(scan, 0, "corner %d of facet %u is not finite", k / 3,
                                            i);
            }
        }
        scan->degenerate += has_equal_corners(v);
    }
    scan->facets = count;
    return ASDIC_OK;
}

/* OpenMesh keeps single precision; a corner that it moves by more than 1e-5 of the mesh's size
 * would change the shape. */
typedef struct precision {
    double lo[3], hi[3], error;
} precision;

static void note_corner(precision *p, const double v[3]) {
    for (int k = 0; k < 3; k++) {
        p->lo[k] = fmin(p->lo[k], v[k]);
        p->hi[k] = fmax(p->hi[k], v[k]);
        p->error = fmax(p->error, fabs((double)(float)v[k] - v[k]));
    }
}

static asdic_status check_precision(const asdic_mesh_scan *scan, const precision *p) {
    double across = fmax(p->hi[0] - p->lo[0], fmax(p->hi[1] - p->lo[1], p->hi[2] - p->lo[2]));
    if (p->error > 1e-5 * across) {
        return asdic_mesh_scan_fail(
            scan, 0,
            "%g across, but so far from 0 that single precision, all an STL has, moves corners by "
            "%g; subtract an offset, or use OBJ, OFF or PLY",
            across, p->error);
    }
    return ASDIC_OK;
}

/* One "vertex" line, the CORNER-th of its facet. */
static asdic_status scan_corner(asdic_mesh_scan *scan, asdic_line *line, size_t corner,
                                float v[3][3], precision *p) {
    double read[3];
    for (int k = 0; k < 3; k++) {
        if (!asdic_line_take_number(scan, line, &read[k])) {
            return asdic_mesh_scan_fail(scan, line->number, "coordinate %d is not a finite number",
                                        k + 1);
        }
        v[corner][k] = (float)read[k];
    }
    note_corner(p, read);
    return ASDIC_OK;
}

static asdic_status scan_text(asdic_mesh_scan *scan) {
    asdic_line line = {0};
    size_t corners = 0; /* of the current facet */
    float v[3][3];
    precision p = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, 0.0};
    while (asdic_line_next(scan, &line)) {
        asdic_status status = ASDIC_OK;
        if (asdic_line_take_word(&line, "vertex")) {
            status = corners < 3 ? scan_corner(scan, &line, corners++, v, &p)
                                 : asdic_mesh_scan_fail(scan, line.number, "a fourth corner");
        } else if (asdic_line_take_word(&line, "endfacet")) {
            if (corners != 3) {
                return asdic_mesh_scan_fail(scan, line.number, "a facet of %zu corners", corners);
            }
            scan->facets++;
            scan->degenerate += has_equal_corners(v);
            corners = 0;
        }
        if (status != ASDIC_OK) {
            return status;
        }
    }
    if (scan->facets == 0 || corners != 0) {
        return asdic_mesh_scan_fail(scan, line.number, "ends after %zu facets and %zu corners",
                                    scan->facets, corners);
    }
    return check_precision(scan, &p);
}

/* Whether the file is text that begins as an STL does. */
static bool begins_solid(const asdic_mesh_scan *scan) {
    return strncasecmp(scan->text + strspn(scan->text, " \t\r\n"), "solid", 5) == 0;
}

/* The words in lower case, as the scan and OpenMesh look for them. */
static void lower(asdic_mesh_scan *scan) {
    for (char *at = scan->text; *at; at++) {
        *at = (char)(*at >= 'A' && *at <= 'Z' ? *at - 'A' + 'a' : *at);
    }
}

asdic_status asdic_mesh_scan_stl(asdic_mesh_scan *scan) {
    uint32_t count = 0;
    size_t needed = 0;
    if (scan->size >= HEADER_BYTES) {
        count = little_endian(scan->text + HEADER_BYTES - 4);
        needed = HEADER_BYTES + (size_t)FACET_BYTES * count;
        if (scan->size == needed) {
            scan->format = ASDIC_MESH_STL_BINARY;
            return count > 0 ? scan_binary(scan, count)
                             : asdic_mesh_scan_fail(scan, 0, "a binary STL without facets");
        }
    }
    bool text = !memchr(scan->text, '\0', scan->size);
    if (text && begins_solid(scan)) {
        scan->format = ASDIC_MESH_STL_ASCII;
        lower(scan);
        return scan_text(scan);
    }
    if (text || scan->size < HEADER_BYTES) {
        return asdic_mesh_scan_fail(
            scan, 0, "%zu bytes are neither a binary STL nor a text one, which begins with 'solid'",
            scan->size);
    }
    char wrong[64] = "cut short or damaged";
    if (scan->size > needed) {
        snprintf(wrong, sizeof wrong, "%zu bytes too many", scan->size - needed);
    }
    return asdic_mesh_scan_fail(
        scan, 0, "a binary STL of %u facets has %zu bytes, this file has %zu: %s; save it anew",
        count, needed, scan->size, wrong);
}
