/*
 * PLY, text or binary of either byte order: the header's counts are checked against the size of
 * the file before anything is allocated, then every element is walked.
 */
#include "mesh_scan.h"

#include "../base/context.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MAX_ELEMENTS 16
#define MAX_PROPERTIES 64

typedef enum ply_type {
    PLY_NONE,
    PLY_INT8,
    PLY_UINT8,
    PLY_INT16,
    PLY_UINT16,
    PLY_INT32,
    PLY_UINT32,
    PLY_FLOAT,
    PLY_DOUBLE
} ply_type;

static const struct {
    const char *name;
    ply_type type;
} type_names[] = {
    {"char", PLY_INT8},   {"int8", PLY_INT8},     {"uchar", PLY_UINT8},   {"uint8", PLY_UINT8},
    {"short", PLY_INT16}, {"int16", PLY_INT16},   {"ushort", PLY_UINT16}, {"uint16", PLY_UINT16},
    {"int", PLY_INT32},   {"int32", PLY_INT32},   {"uint", PLY_UINT32},   {"uint32", PLY_UINT32},
    {"float", PLY_FLOAT}, {"float32", PLY_FLOAT}, {"double", PLY_DOUBLE}, {"float64", PLY_DOUBLE},
};

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

typedef struct ply_property {
    ply_type count; /* PLY_NONE: a scalar */
    ply_type type;
    int axis;     /* 0, 1, 2 for x, y, z of a vertex; else -1 */
    bool corners; /* the list of a facet's vertices */
} ply_property;

typedef struct ply_element {
    bool vertex, face;
    long long count;
    ply_property properties[MAX_PROPERTIES];
    size_t property_count;
} ply_element;

typedef struct ply_file {
    asdic_mesh_scan *scan;
    bool text, big_endian;
    ply_element elements[MAX_ELEMENTS];
    size_t element_count;
    const char *at;  /* reading position in the body */
    asdic_line line; /* the same for text */
} ply_file;

static ply_type take_type(asdic_line *line) {
    for (size_t i = 0; i < sizeof type_names / sizeof *type_names; i++) {
        if (asdic_line_take_word(line, type_names[i].name)) {
            return type_names[i].type;
        }
    }
    return PLY_NONE;
}

/* The name of an element or property. */
static void skip_word(asdic_line *line) {
    asdic_line_skip_blanks(line);
    while (line->at < line->end && *line->at != ' ' && *line->at != '\t' && *line->at != '\r') {
        line->at++;
    }
}

/* OpenMesh reads on in the next line when one is short, and into it when one is long. */
static asdic_status check_line_end(const ply_file *ply, asdic_line *line) {
    asdic_line_skip_blanks(line);
    return line->at == line->end
               ? ASDIC_OK
               : asdic_mesh_scan_fail(
                     ply->scan, line->number, "'%.*s' follows a complete line of the header",
                     (int)(line->end - line->at < 60 ? line->end - line->at : 60), line->at);
}

static asdic_status header_property(ply_file *ply, asdic_line *line) {
    ply_element *element = ply->element_count ? &ply->elements[ply->element_count - 1] : NULL;
    if (!element || element->property_count == MAX_PROPERTIES) {
        return asdic_mesh_scan_fail(ply->scan, line->number,
                                    "a property outside an element, or more than %d of them",
                                    MAX_PROPERTIES);
    }
    ply_property property = {.axis = -1};
    if (asdic_line_take_word(line, "list")) {
        property.count = take_type(line);
        if (property.count == PLY_NONE || property.count >= PLY_FLOAT) {
            return asdic_mesh_scan_fail(ply->scan, line->number, "unknown type of a list's length");
        }
        if (element->vertex) {
            return asdic_mesh_scan_fail(ply->scan, line->number,
                                        "a list among a vertex's properties is not read");
        }
    }
    property.type = take_type(line);
    if (property.type == PLY_NONE) {
        return asdic_mesh_scan_fail(ply->scan, line->number, "unknown type of a property");
    }
    static const char *const axes[] = {"x", "y", "z"};
    for (int k = 0; k < 3 && element->vertex; k++) {
        if (asdic_line_take_word(line, axes[k])) {
            property.axis = k;
        }
    }
    property.corners = element->face && property.count != PLY_NONE &&
                       (asdic_line_take_word(line, "vertex_indices") ||
                        asdic_line_take_word(line, "vertex_index"));
    if (property.axis < 0 && !property.corners) {
        asdic_line_skip_blanks(line);
        if (line->at == line->end) {
            return asdic_mesh_scan_fail(ply->scan, line->number, "this property has no name");
        }
        skip_word(line);
    }
    element->properties[element->property_count++] = property;
    return check_line_end(ply, line);
}

static asdic_status header_element(ply_file *ply, asdic_line *line) {
    if (ply->element_count == MAX_ELEMENTS) {
        return asdic_mesh_scan_fail(ply->scan, line->number, "more than %d elements", MAX_ELEMENTS);
    }
    ply_element *element = &ply->elements[ply->element_count++];
    element->vertex = asdic_line_take_word(line, "vertex");
    element->face = !element->vertex && asdic_line_take_word(line, "face");
    if (!element->vertex && !element->face) { /* another name */
        skip_word(line);
    }
    if (!asdic_line_take_integer(line, &element->count) || element->count < 0) {
        return asdic_mesh_scan_fail(ply->scan, line->number, "this element has no count");
    }
    return check_line_end(ply, line);
}

static asdic_status header_format(ply_file *ply, asdic_line *line) {
    ply->text = asdic_line_take_word(line, "ascii");
    ply->big_endian = asdic_line_take_word(line, "binary_big_endian");
    if (!ply->text && !ply->big_endian && !asdic_line_take_word(line, "binary_little_endian")) {
        return asdic_mesh_scan_fail(ply->scan, line->number, "unknown PLY format");
    }
    if (!asdic_line_take_word(line, "1.0")) {
        return asdic_mesh_scan_fail(ply->scan, line->number, "the version of PLY is not 1.0");
    }
    return check_line_end(ply, line);
}

/* Some writers forget the word "comment"; OpenMesh reads on forever at such a line. */
static asdic_status make_comment(const ply_file *ply, const asdic_line *line) {
    static const char word[] = "comment ";
    size_t left = (size_t)(line->end - line->at);
    if (left == 0) {
        return ASDIC_OK;
    }
    if (left < sizeof word - 2) {
        return asdic_mesh_scan_fail(ply->scan, line->number, "unknown line in the header");
    }
    memcpy(ply->scan->text + (line->at - ply->scan->text), word,
           left < sizeof word - 1 ? left : sizeof word - 1);
    return ASDIC_OK;
}

/* A vertical tab ends a word for OpenMesh, which reads on forever behind "element v\ve 0". */
static asdic_status check_characters(const ply_file *ply, const asdic_line *line) {
    for (const char *at = line->at; at < line->end; at++) {
        unsigned char byte = (unsigned char)*at;
        if (byte < ' ' && byte != '\t' && byte != '\r') {
            return asdic_mesh_scan_fail(ply->scan, line->number,
                                        "a control character (%d) in the header", byte);
        }
    }
    return ASDIC_OK;
}

/* The line at FROM, up to TO, becomes the second of the text, where OpenMesh takes whatever stands
 * there for the format; comments that stood before it move down. */
static asdic_status lift_format(ply_file *ply, const char *from, const char *to) {
    char *second = (char *)memchr(ply->scan->text, '\n', ply->scan->size) + 1;
    size_t length = (size_t)(to - from);
    char *copy = malloc(length + 1);
    if (!copy) {
        return asdic_fail_memory(ply->scan->ctx, "a line of a mesh file");
    }
    memcpy(copy, from, length);
    memmove(second + length, second, (size_t)(from - second));
    memcpy(second, copy, length);
    free(copy);
    return ASDIC_OK;
}

static asdic_status scan_header(ply_file *ply) {
    asdic_line line = {0};
    bool format = false;
    if (!asdic_line_next(ply->scan, &line) || !asdic_line_take_word(&line, "ply")) {
        return asdic_mesh_scan_fail(ply->scan, 1, "does not start with 'ply'");
    }
    const char *text_end = ply->scan->text + ply->scan->size;
    while (asdic_line_next(ply->scan, &line)) {
        const char *from = line.at;
        asdic_status status = check_characters(ply, &line);
        if (status != ASDIC_OK) {
            return status;
        }
        if (asdic_line_take_word(&line, "end_header")) {
            if (!format) {
                break;
            }
            ply->at = line.end < text_end ? line.end + 1 : line.end;
            ply->line = line;
            return ASDIC_OK;
        }
        if (asdic_line_take_word(&line, "format")) {
            status = format ? asdic_mesh_scan_fail(ply->scan, line.number, "a second format")
                            : header_format(ply, &line);
            if (status == ASDIC_OK && line.end < text_end) {
                status = lift_format(ply, from, line.end + 1);
            }
            format = true;
        } else if (asdic_line_take_word(&line, "element")) {
            status = header_element(ply, &line);
        } else if (asdic_line_take_word(&line, "property")) {
            status = header_property(ply, &line);
        } else if (!asdic_line_take_word(&line, "comment") &&
                   !asdic_line_take_word(&line, "obj_info")) {
            status = make_comment(ply, &line);
        }
        if (status != ASDIC_OK) {
            return status;
        }
    }
    return asdic_mesh_scan_fail(ply->scan, line.number, "the header has no format or no end");
}

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
    asdic_line_skip_blanks(&ply->line);
    while (ply->line.at >= ply->line.end) {
        if (!asdic_line_next(ply->scan, &ply->line)) {
            return false;
        }
        asdic_line_skip_blanks(&ply->line);
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

/* The values of one property; V receives a coordinate. Returns false at the first bad value. */
static bool walk_property(ply_file *ply, const ply_property *property, double v[3],
                          long long vertices) {
    double value, count = 1.0;
    if (property->count != PLY_NONE && !take_value(ply, property->count, &count)) {
        return false;
    }
    uint64_t *hash = &ply->scan->facet_hash;
    if (property->corners) {
        if (count < 3.0) {
            return false;
        }
        *hash = asdic_mesh_scan_hash(*hash, (uint64_t)count);
    }
    for (double i = 0.0; i < count; i += 1.0) {
        if (!take_value(ply, property->type, &value) ||
            (property->corners &&
             (value < 0.0 || value >= (double)vertices || value != floor(value)))) {
            return false;
        }
        if (property->axis >= 0) {
            v[property->axis] = value;
        }
        if (property->corners) {
            *hash = asdic_mesh_scan_hash(*hash, (uint64_t)value);
        }
    }
    return true;
}

static asdic_status walk_element(ply_file *ply, const ply_element *element) {
    size_t capacity = 0;
    const char *what = element->vertex ? "vertex" : element->face ? "face" : "element";
    if (element->vertex && ply->scan->vertices > 0) {
        return asdic_mesh_scan_fail(ply->scan, 0, "declares its vertices twice");
    }
    if (element->face && ply->scan->vertices == 0) {
        return asdic_mesh_scan_fail(ply->scan, 0, "has its faces before its vertices");
    }
    for (long long i = 0; i < element->count; i++) {
        double v[3] = {0.0, 0.0, 0.0};
        for (size_t p = 0; p < element->property_count; p++) {
            if (!walk_property(ply, &element->properties[p], v, (long long)ply->scan->vertices)) {
                return asdic_mesh_scan_fail(
                    ply->scan, ply->text ? ply->line.number : 0,
                    "%s %lld of %lld is cut short, not finite, or names a vertex that is not there",
                    what, i, element->count);
            }
        }
        asdic_status status =
            element->vertex ? asdic_mesh_scan_add_vertex(ply->scan, v, &capacity) : ASDIC_OK;
        if (status != ASDIC_OK) {
            return status;
        }
        ply->scan->facets += element->face;
    }
    return ASDIC_OK;
}

asdic_status asdic_mesh_scan_ply(asdic_mesh_scan *scan) {
    scan->format = ASDIC_MESH_PLY;
    ply_file *ply = calloc(1, sizeof *ply);
    if (!ply) {
        return asdic_fail_memory(scan->ctx, "a PLY header");
    }
    ply->scan = scan;
    asdic_status status = scan_header(ply);
    status = status ? status : check_counts(ply);
    for (size_t e = 0; e < ply->element_count && status == ASDIC_OK; e++) {
        status = walk_element(ply, &ply->elements[e]);
    }
    free(ply);
    return status;
}
