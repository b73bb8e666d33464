/* The header of a PLY, line by line; what OpenMesh reads differently is refused or rewritten. */
#include "mesh_scan_ply.h"

#include "../base/context.h"

#include <stdlib.h>
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

asdic_status asdic_ply_scan_header(ply_file *ply) {
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
