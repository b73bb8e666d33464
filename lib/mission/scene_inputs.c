#include "scene_inputs.h"

#include "base/context.h"
#include "base/file_read.h"
#include "base/sha256.h"
#include "base/try.h"
#include "mission/scene_file/scene_file.h"
#include "out/file.h"

#include <asdic/mission.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct inputs {
    asdic_context *ctx;
    const char *scene;
    asdic_scene_file_visit visit;
    void *user;
    bool is_whole; /* the scene file itself, too */
    asdic_arena arena;
    asdic_problems problems; /* told when the mission was loaded */
    asdic_text hashes;
} inputs;

static asdic_status add_bytes(inputs *in, const void *bytes, size_t length) {
    char hex[65];
    asdic_sha256_hex(bytes, length, hex);
    asdic_text_add(&in->hashes, hex);
    return in->hashes.failed ? asdic_fail_memory(in->ctx, "the hash of a scene") : ASDIC_OK;
}

static asdic_status add_hash(void *user, const char *path) {
    inputs *in = user;
    char *bytes = NULL;
    size_t length = 0;
    TRY(asdic_file_read(in->ctx, path, SIZE_MAX, &bytes, &length));
    asdic_status status = add_bytes(in, bytes, length);
    free(bytes);
    return status;
}

/* The file called NAME, if there is one. */
static asdic_status add_file(inputs *in, const char *name) {
    const char *slash = *name != '/' ? strrchr(in->scene, '/') : NULL;
    int folder = slash ? (int)(slash - in->scene) + 1 : 0;
    char path[4096];
    struct stat st;
    int size = snprintf(path, sizeof path, "%.*s%s", folder, in->scene, name);
    bool is_file = (size_t)size < sizeof path && stat(path, &st) == 0 && S_ISREG(st.st_mode);
    return is_file ? in->visit(in->user, path) : ASDIC_OK;
}

/* Files that any value names, whatever is drawn: choices hold names too. */
static asdic_status add_files(inputs *in, const asdic_yaml_node *node) {
    if (node->kind == ASDIC_YAML_SCALAR) {
        return node->length > 0 ? add_file(in, node->text) : ASDIC_OK;
    }
    for (const asdic_yaml_node *child = node->first; child; child = child->next) {
        TRY(add_files(in, child));
    }
    return ASDIC_OK;
}

static asdic_status add_scene(inputs *in, const char *bytes, size_t size) {
    size_t length = 0;
    asdic_yaml_node *root = NULL;
    char *text = asdic_text_to_utf8(bytes, size, &length);
    bool good = text && asdic_yaml_read(text, length, &in->arena, &in->problems, &root);
    free(text);
    asdic_status status = good ? ASDIC_OK : asdic_fail_memory(in->ctx, "a scene's files");
    if (!status && in->is_whole) {
        status = add_bytes(in, bytes, size);
    }
    if (!status && root) {
        status = add_files(in, root);
    }
    asdic_problems_finish(&in->problems);
    asdic_arena_finish(&in->arena);
    return status;
}

static asdic_status add_inputs(inputs *in) {
    char *bytes = NULL;
    size_t size = 0;
    TRY(asdic_file_read_piped(in->ctx, in->scene, SIZE_MAX, &bytes, &size));
    asdic_status status = add_scene(in, bytes, size);
    free(bytes);
    return status;
}

asdic_status asdic_scene_visit_files(asdic_context *ctx, const char *scene, const char *text,
                                     asdic_scene_file_visit visit, void *user) {
    inputs in = {
        .ctx = ctx, .scene = scene, .visit = visit, .user = user, .problems = {.name = scene}};
    return add_scene(&in, text, strlen(text));
}

static asdic_status find(void *path, const char *file) {
    return asdic_file_is_same(path, file) ? ASDIC_ERROR_EXISTS : ASDIC_OK;
}

bool asdic_scene_reads(const char *scene, const char *path) {
    struct stat there, read;
    if (!scene || !path || stat(path, &there) != 0 || stat(scene, &read) != 0 ||
        !S_ISREG(read.st_mode)) {
        return false;
    }
    char *file = strdup(path);
    inputs in = {.scene = scene, .visit = find, .user = file, .problems = {.name = scene}};
    bool is_read = file && (find(file, scene) || add_inputs(&in) == ASDIC_ERROR_EXISTS);
    free(file);
    return is_read;
}

asdic_status asdic_scene_files_hash(asdic_context *ctx, const char *scene,
                                    const char *const *values, size_t count, asdic_text *out) {
    inputs in = {.ctx = ctx, .scene = scene, .visit = add_hash, .problems = {.name = scene}};
    in.user = &in;
    asdic_status status = add_inputs(&in);
    for (size_t i = 0; !status && i < count; i++) {
        status = values[i][0] ? add_file(&in, values[i]) : ASDIC_OK;
    }
    if (!status) {
        asdic_text_add_bytes(out, in.hashes.data, in.hashes.length);
    }
    asdic_text_finish(&in.hashes);
    return status;
}

asdic_status asdic_scene_inputs_hash(asdic_context *ctx, const char *scene, char hex[65]) {
    inputs in = {.ctx = ctx,
                 .scene = scene,
                 .visit = add_hash,
                 .is_whole = true,
                 .problems = {.name = scene}};
    in.user = &in;
    asdic_status status = add_inputs(&in);
    if (!status && in.hashes.length == 64) {
        memcpy(hex, in.hashes.data, 65); /* of the scene file alone */
    } else if (!status) {
        asdic_sha256_hex(in.hashes.data, in.hashes.length, hex);
    }
    asdic_text_finish(&in.hashes);
    return status;
}
