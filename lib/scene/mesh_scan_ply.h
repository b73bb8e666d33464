/*
 * What the two halves of the PLY scan share: mesh_scan_ply_header.c reads the header,
 * mesh_scan_ply.c walks what it announces.
 */
#ifndef ASDIC_SCENE_MESH_SCAN_PLY_H
#define ASDIC_SCENE_MESH_SCAN_PLY_H

#include "mesh_scan.h"

#define PLY_MAX_ELEMENTS 16
#define PLY_MAX_PROPERTIES 64

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

typedef struct ply_property {
    ply_type count; /* PLY_NONE: a scalar */
    ply_type type;
    int axis;     /* 0, 1, 2 for x, y, z of a vertex; else -1 */
    bool corners; /* the list of a facet's vertices */
} ply_property;

typedef struct ply_element {
    bool vertex, face;
    long long count;
    ply_property properties[PLY_MAX_PROPERTIES];
    size_t property_count;
} ply_element;

typedef struct ply_file {
    asdic_mesh_scan *scan;
    bool text, big_endian;
    ply_element elements[PLY_MAX_ELEMENTS];
    size_t element_count;
    const ply_element *element; /* that is read ... */
    long long index;            /* ... and how many of it before */
    const char *at;             /* reading position in the body */
    asdic_line line;            /* the same for text */
    char *to; /* the end of the text that is kept for OpenMesh, which never overtakes */
} ply_file;

/* Fills PLY, which has its scan and else zeros, as the header says, and finds where the body
 * begins. Of the header, what a mesh needs is kept. */
asdic_status asdic_ply_scan_header(ply_file *ply);

/* Whether OpenMesh gets the property: a coordinate, or a facet's corners. */
bool asdic_ply_keeps(const ply_property *property);

/* Keeps the bytes from FROM to TO. */
void asdic_ply_keep(ply_file *ply, const char *from, const char *to);

#endif
