/* The header of a PLY, line by line; what OpenMesh reads differently is refused, and what a mesh does
 * not need is cut out of the text: OpenMesh loses its place at lists, and at what stands before corners. */
#include "mesh_scan_ply.h"

#include "base/try.h"

#include "../base/context.h"

#include <string.h>

static const struct {
    const char *name;
    ply_type type;
} type_names[] = {
    {"char", PLY_INT8},   {"int8", PLY_INT8},     {"uchar", PLY_UINT8},   {"uint8", PLY_UINT8},
    {"short", PLY_INT16}, {"int16", PLY_INT16},   {"ushort", PLY_UINT16}, {"uint16", PLY_UINT16},
    {"int", PLY_INT32},   {"int32", PLY_INT32},   {"uint", PLY_UINT32},   {"uint32", PLY_UINT32},
    {"float", PLY_FLOAT}, {"float32", PLY_FLOAT}, {"double", PLY_DOUBLE}, {"float64", PLY_DOUBLE},
};

bool asdic_ply_keeps(const ply_property *property) {
    return property->axis >= 0 || property->corners;
}

void asdic_ply_keep(ply_file *ply, const char *from, const char *to) {
    memmove(ply->to, from, (size_t)(to - from));
    ply->to += to - from;
}

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

/* OpenMesh continues in the next line when one is short, and into it when one is long. */
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
    if (!element || element->property_count == PLY_MAX_PROPERTIES) {
        return asdic_mesh_scan_fail(ply->scan, line->number,
                                    "a property outside an element, or more than %d of them",
                                    PLY_MAX_PROPERTIES);
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
    if (property.corners && property.count != PLY_UINT8 && property.count != PLY_INT32) {
        return asdic_mesh_scan_fail(ply->scan, line->number,
                                    "OpenMesh reads how many corners a facet has as uchar or int "
                                    "only; write it so");
    }
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
    if (ply->element_count == PLY_MAX_ELEMENTS) {
        return asdic_mesh_scan_fail(ply->scan, line->number, "more than %d elements",
                                    PLY_MAX_ELEMENTS);
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

/* Some writers forget the word "comment". */
static asdic_status check_comment(const ply_file *ply, const asdic_line *line) {
    size_t left = (size_t)(line->end - line->at);
    return left == 0 || left >= strlen("comment")
               ? ASDIC_OK
               : asdic_mesh_scan_fail(ply->scan, line->number, "unknown line in the header");
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

/* The format becomes the second line of what is kept, where OpenMesh takes whatever stands there for
 * it; a line of the file that says it has no fewer bytes. */
static void keep_format(ply_file *ply) {
    const char *line = ply->text         ? "format ascii 1.0\n"
                       : ply->big_endian ? "format binary_big_endian 1.0\n"
                                         : "format binary_little_endian 1.0\n";
    char *second = (char *)memchr(ply->scan->text, '\n', ply->scan->size) + 1;
    size_t length = strlen(line);
    memmove(second + length, second, (size_t)(ply->to - second));
    memcpy(second, line, length);
    ply->to += length;
}

/* A line of the header but the first. *KEPT: it goes to OpenMesh as it is. */
static asdic_status header_line(ply_file *ply, asdic_line *line, bool *format, bool *kept) {
    if (asdic_line_take_word(line, "format")) {
        if (*format) {
            return asdic_mesh_scan_fail(ply->scan, line->number, "a second format");
        }
        *format = true;
        return header_format(ply, line);
    }
    if (asdic_line_take_word(line, "element")) {
        TRY(header_element(ply, line));
        const ply_element *element = &ply->elements[ply->element_count - 1];
        *kept = element->vertex || element->face;
        return ASDIC_OK;
    }
    if (asdic_line_take_word(line, "property")) {
        TRY(header_property(ply, line));
        const ply_element *element = &ply->elements[ply->element_count - 1];
        *kept = asdic_ply_keeps(&element->properties[element->property_count - 1]);
        return ASDIC_OK;
    }
    return asdic_line_take_word(line, "comment") || asdic_line_take_word(line, "obj_info")
               ? ASDIC_OK
               : check_comment(ply, line);
}

asdic_status asdic_ply_scan_header(ply_file *ply) {
    asdic_line line = {0};
    bool format = false;
    if (!asdic_line_next(ply->scan, &line) || !asdic_line_take_word(&line, "ply")) {
        return asdic_mesh_scan_fail(ply->scan, 1, "does not start with 'ply'");
    }
    const char *text_end = ply->scan->text + ply->scan->size;
    ply->to = ply->scan->text + (line.end + 1 - ply->scan->text);
    while (asdic_line_next(ply->scan, &line)) {
        const char *from = line.at, *to = line.end < text_end ? line.end + 1 : line.end;
        TRY(check_characters(ply, &line));
        if (asdic_line_take_word(&line, "end_header")) {
            if (!format) {
                break;
            }
            asdic_ply_keep(ply, from, to);
            ply->at = to;
            ply->line = line;
            ply->line.at = line.end; /* a carriage return before it may have moved */
            return ASDIC_OK;
        }
        bool kept = false, had_format = format;
        TRY(header_line(ply, &line, &format, &kept));
        if (format && !had_format && line.end < text_end) {
            keep_format(ply);
        } else if (kept) {
            asdic_ply_keep(ply, from, to);
        }
    }
    return asdic_mesh_scan_fail(ply->scan, line.number, "the header has no format or no end");
}
