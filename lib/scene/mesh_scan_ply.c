/*
 * PLY, text or binary of either byte order: the header's counts are checked against the size of
 * the file before anything is allocated, then every element is walked. Coordinates and corners alone
 * are kept in the text for OpenMesh, which reads a list beside the corners as corners.
 */
#include "mesh_scan_ply.h"

#include "base/hash.h"
#include "base/try.h"

#include "../base/context.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What the integers hold: in text, more makes OpenMesh's stream fail for good. */
static const double type_limits[][2] = {
    [PLY_INT8] = {-128.0, 127.0},
    [PLY_UINT8] = {0.0, 255.0},
    [PLY_INT16] = {-32768.0, 32767.0},
    [PLY_UINT16] = {0.0, 65535.0},
    [PLY_INT32] = {-2147483648.0, 2147483647.0},
    [PLY_UINT32] = {0.0, 4294967295.0},
};

static const size_t type_bytes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};

/* What the counts need at least, in double so that nothing can overflow. */
static asdic_status check_counts(const ply_file *ply) {
    double needed = 0.0, left = (double)(ply->scan->text + ply->scan->size - ply->at);
    long long vertices = 0, facets = 0;
    for (size_t e = 0; e < ply->element_count; e++) {
        const ply_element *element = &ply->elements[e];
        double bytes = 0.0;
        bool axes[3] = {false, false, false}, corners = false;
        for (size_t p = 0; p < element->property_count; p++) {
            const ply_property *property = &element->properties[p];
            bytes += ply->text         ? 2.0
                     : property->count ? (double)type_bytes[property->count]
                                       : (double)type_bytes[property->type];
            corners |= property->corners;
            if (property->axis >= 0) {
                axes[property->axis] = true;
            }
            if (property->axis >= 0 && property->type < PLY_FLOAT && !ply->text) {
                return asdic_mesh_scan_fail(ply->scan, 0,
                                            "coordinates are whole numbers, which OpenMesh reads "
                                            "from text only; write them as float");
            }
        }
        if ((element->vertex && !(axes[0] && axes[1] && axes[2])) || (element->face && !corners)) {
            return asdic_mesh_scan_fail(ply->scan, 0,
                                        "vertices need x, y, z and faces need vertex_indices");
        }
        if (bytes <= 0.0 && element->count > 0) {
            return asdic_mesh_scan_fail(ply->scan, 0, "an element has no properties");
        }
        needed += bytes * (double)element->count;
        vertices += element->vertex ? element->count : 0;
        facets += element->face ? element->count : 0;
    }
    if (vertices == 0 || facets == 0) {
        return asdic_mesh_scan_fail(ply->scan, 0, "%lld vertices and %lld faces: nothing to see",
                                    vertices, facets);
    }
    if (needed > left + 1.0) { /* the last line of a text may lack its end */
        return asdic_mesh_scan_fail(
            ply->scan, 0, "its header needs at least %.0f bytes of data, but there are %.0f",
            needed, left);
    }
    return ASDIC_OK;
}

static double binary_value(const ply_file *ply, ply_type type, const char *at) {
    unsigned char b[8];
    size_t n = type_bytes[type];
    for (size_t i = 0; i < n; i++) { /* least significant byte first */
        b[i] = (unsigned char)at[ply->big_endian ? n - 1 - i : i];
    }
    uint64_t bits = 0;
    for (size_t i = 0; i < n; i++) {
        bits |= (uint64_t)b[i] << 8 * i;
    }
    float f;
    double d;
    uint32_t low = (uint32_t)bits;
    switch (type) {
    case PLY_INT8:
        return (int8_t)bits;
    case PLY_INT16:
        return (int16_t)bits;
    case PLY_INT32:
        return (int32_t)bits;
    case PLY_FLOAT:
        memcpy(&f, &low, sizeof f);
        return f;
    case PLY_DOUBLE:
        memcpy(&d, &bits, sizeof d);
        return d;
    default:
        return (double)bits;
    }
}

/* Goes to where the next value begins, in text maybe some lines on. */
static bool find_value(ply_file *ply) {
    if (!ply->text) {
        return true;
    }
    asdic_line_skip_blanks(&ply->line);
    while (ply->line.at >= ply->line.end) {
        if (!asdic_line_next(ply->scan, &ply->line)) {
            return false;
        }
        asdic_line_skip_blanks(&ply->line);
    }
    return true;
}

static bool take_value(ply_file *ply, ply_type type, double *out) {
    if (!ply->text) {
        const char *end = ply->scan->text + ply->scan->size;
        if ((size_t)(end - ply->at) < type_bytes[type]) {
            return false;
        }
        *out = binary_value(ply, type, ply->at);
        ply->at += type_bytes[type];
        return isfinite(*out);
    }
    if (!find_value(ply)) {
        return false;
    }
    if (type < PLY_FLOAT) {
        long long value;
        if (!asdic_line_take_integer(&ply->line, &value)) {
            return false;
        }
        *out = (double)value;
        return *out >= type_limits[type][0] && *out <= type_limits[type][1] &&
               strchr(" \t\r\n", *ply->line.at); /* the end of the text as well */
    }
    return asdic_line_take_number(ply->scan, &ply->line, out) &&
           (type == PLY_DOUBLE || fabs(*out) <= FLT_MAX);
}

/* Keeps the values from FROM to the reading position; a blank, in text, ends them. It takes the place of
 * one that was read, or of a line's end, which is found again without it. */
static void keep_values(ply_file *ply, const char *from) {
    asdic_ply_keep(ply, from, ply->text ? ply->line.at : ply->at);
    if (ply->text && ply->to < ply->scan->text + ply->scan->size) {
        *ply->to++ = ' ';
    }
}

/* Says what is wrong with the element that is read, and with which VALUE; NAN: with none. */
static asdic_status refuse(const ply_file *ply, const char *flaw, double value) {
    const ply_element *element = ply->element;
    const char *what = element->vertex ? "vertex" : element->face ? "face" : "element";
    size_t line = ply->text ? ply->line.number : 0;
    return isnan(value) ? asdic_mesh_scan_fail(ply->scan, line, "%s %lld of %lld %s", what,
                                               ply->index, element->count, flaw)
                        : asdic_mesh_scan_fail(ply->scan, line, "%s %lld of %lld %s: %.9g", what,
                                               ply->index, element->count, flaw, value);
}

/* The values of one property; V receives a coordinate. */
static asdic_status walk_property(ply_file *ply, const ply_property *property, double v[3]) {
    static const char no_number[] = "is cut short, or holds no finite number of its type";
    const double vertices = (double)ply->scan->vertices;
    double value, count = 1.0;
    if (!find_value(ply)) {
        return refuse(ply, no_number, NAN);
    }
    const char *from = ply->text ? ply->line.at : ply->at;
    if (property->count != PLY_NONE && !take_value(ply, property->count, &count)) {
        return refuse(ply, no_number, NAN);
    }
    uint64_t *hash = &ply->scan->facet_hash;
    if (property->corners) {
        if (count < 3.0) {
            return refuse(ply, "has fewer than 3 corners", count);
        }
        *hash = asdic_hash_fold(*hash, (uint64_t)count);
    }
    for (double i = 0.0; i < count; i += 1.0) {
        if (!take_value(ply, property->type, &value)) {
            return refuse(ply, no_number, NAN);
        }
        if (property->corners && (value < 0.0 || value >= vertices || value != floor(value))) {
            return refuse(ply, "names a vertex that is not there", value);
        }
        if (property->axis >= 0) {
            v[property->axis] = value;
        }
        if (property->corners) {
            *hash = asdic_hash_fold(*hash, (uint64_t)value);
        }
    }
    if (asdic_ply_keeps(property)) {
        keep_values(ply, from);
    }
    return ASDIC_OK;
}

static asdic_status walk_element(ply_file *ply, const ply_element *element) {
    size_t capacity = 0;
    ply->element = element;
    if (element->vertex && ply->scan->vertices > 0) {
        return asdic_mesh_scan_fail(ply->scan, 0, "declares its vertices twice");
    }
    if (element->face && ply->scan->vertices == 0) {
        return asdic_mesh_scan_fail(ply->scan, 0, "has its faces before its vertices");
    }
    for (ply->index = 0; ply->index < element->count; ply->index++) {
        double v[3] = {0.0, 0.0, 0.0};
        for (size_t p = 0; p < element->property_count; p++) {
            TRY(walk_property(ply, &element->properties[p], v));
        }
        TRY(element->vertex ? asdic_mesh_scan_add_vertex(ply->scan, v, &capacity) : ASDIC_OK);
        ply->scan->facets += element->face;
    }
    return ASDIC_OK;
}

static asdic_status walk(ply_file *ply) {
    TRY(asdic_ply_scan_header(ply));
    TRY(check_counts(ply));
    for (size_t e = 0; e < ply->element_count; e++) {
        TRY(walk_element(ply, &ply->elements[e]));
    }
    *ply->to = 0;
    ply->scan->size = (size_t)(ply->to - ply->scan->text);
    return ASDIC_OK;
}

asdic_status asdic_mesh_scan_ply(asdic_mesh_scan *scan) {
    scan->format = ASDIC_MESH_PLY;
    ply_file *ply = calloc(1, sizeof *ply);
    if (!ply) {
        return asdic_fail_memory(scan->ctx, "a PLY header");
    }
    ply->scan = scan;
    asdic_status status = walk(ply);
    free(ply);
    return status;
}
