#include "mesh_rig.h"

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

void mesh_rig_open(mesh_rig *rig) {
    memset(rig, 0, sizeof *rig);
    assert_int_equal(asdic_context_create(&rig->ctx), ASDIC_OK);
    snprintf(rig->folder, sizeof rig->folder, "asdic-mesh-XXXXXX");
    assert_non_null(mkdtemp(rig->folder));
}

void mesh_rig_close(mesh_rig *rig) {
    if (rig->path[0]) {
        unlink(rig->path);
    }
    rmdir(rig->folder);
    asdic_context_destroy(&rig->ctx);
}

const char *mesh_rig_write_bytes(mesh_rig *rig, const char *name, const void *data, size_t bytes) {
    if (rig->path[0]) {
        unlink(rig->path);
    }
    snprintf(rig->path, sizeof rig->path, "%s/%s", rig->folder, name);
    FILE *file = fopen(rig->path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, bytes, file), bytes);
    assert_int_equal(fclose(file), 0);
    return rig->path;
}

const char *mesh_rig_write(mesh_rig *rig, const char *name, const char *text) {
    return mesh_rig_write_bytes(rig, name, text, strlen(text));
}

asdic_mesh *mesh_rig_load(const mesh_rig *rig) {
    asdic_mesh *mesh = NULL;
    asdic_status status = asdic_mesh_load(rig->ctx, rig->path, 1.0, false, &mesh);
    if (status != ASDIC_OK) {
        assert_null(mesh);
        assert_int_equal(status, ASDIC_ERROR_INPUT);
        assert_non_null(strstr(asdic_context_error(rig->ctx), rig->path));
    }
    return mesh;
}

void mesh_rig_expect(const mesh_rig *rig, size_t triangles, size_t dropped) {
    asdic_mesh *mesh = mesh_rig_load(rig);
    if (!mesh) {
        print_error("%s\n", asdic_context_error(rig->ctx));
    }
    assert_non_null(mesh);
    assert_int_equal(asdic_mesh_get_info(mesh).triangles, triangles);
    assert_int_equal(asdic_mesh_get_info(mesh).dropped, dropped);
    asdic_mesh_destroy(&mesh);
}

void mesh_rig_refuse(const mesh_rig *rig, const char *part) {
    asdic_mesh *mesh = mesh_rig_load(rig);
    if (mesh) {
        print_error("%s was read\n", rig->path);
    } else if (!strstr(asdic_context_error(rig->ctx), part)) {
        print_error("'%s' lacks '%s'\n", asdic_context_error(rig->ctx), part);
    }
    assert_null(mesh);
    assert_non_null(strstr(asdic_context_error(rig->ctx), part));
}

bool mesh_rig_reads_files(mesh_rig *rig) {
    asdic_mesh *mesh = NULL;
    mesh_rig_write(rig, "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    bool reads = asdic_mesh_load(rig->ctx, rig->path, 1.0, false, &mesh) != ASDIC_ERROR_UNSUPPORTED;
    asdic_mesh_destroy(&mesh);
    if (!reads) {
        print_message("skipped: %s\n", asdic_context_error(rig->ctx));
    }
    return reads;
}
