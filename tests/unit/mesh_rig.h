/*
 * A context and a scratch folder for tests that write and read small files.
 */
#ifndef ASDIC_TESTS_MESH_RIG_H
#define ASDIC_TESTS_MESH_RIG_H

#include "asserts.h"

#include <asdic/asdic.h>

typedef struct mesh_rig {
    asdic_context *ctx;
    char folder[64];
    char path[128]; /* of the file written last */
} mesh_rig;

void mesh_rig_open(mesh_rig *rig);
void mesh_rig_close(mesh_rig *rig);

/* Whether asdic was built with OpenMesh; says so if not. */
bool mesh_rig_reads_files(mesh_rig *rig);

/* Writes a file of BYTES bytes and returns its path; the file before it is removed. */
const char *mesh_rig_write_bytes(mesh_rig *rig, const char *name, const void *data, size_t bytes);
const char *mesh_rig_write(mesh_rig *rig, const char *name, const char *text);

/* Loads the file written last; NULL after a refusal, whose sentence must name the file. */
asdic_mesh *mesh_rig_load(const mesh_rig *rig);

/* The file written last must load with these counts. */
void mesh_rig_expect(const mesh_rig *rig, size_t triangles, size_t dropped);

/* The file written last must be refused with ASDIC_ERROR_INPUT and a sentence that holds PART. */
void mesh_rig_refuse(const mesh_rig *rig, const char *part);

#endif
