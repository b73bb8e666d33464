#include "opencl.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "kernel_text.h"

static char *read_file(const char *path) {
    char *text = NULL;
    FILE *file = fopen(path, "rb");
    if (!file) {
        return NULL;
    }
    if (fseek(file, 0, SEEK_END) == 0) {
        long size = ftell(file);
        rewind(file);
        text = size >= 0 ? malloc((size_t)size + 1) : NULL;
        if (text && fread(text, 1, (size_t)size, file) == (size_t)size) {
            text[size] = '\0';
        } else {
            free(text);
            text = NULL;
        }
    }
    fclose(file);
    return text;
}

/* Includes are left to the device's compiler; #line gives the entry its name in messages. */
static asdic_status from_folder(asdic_context *ctx, const char *folder, const char *file,
                                char **text, char **options) {
    char *path = NULL, *body = NULL;
    asdic_status status = ASDIC_OK;

    /* Compilers differ in how they unquote options; none minds a plain path. */
    if (folder[strcspn(folder, " \t\"\\")] != '\0') {
        return asdic_fail(ctx, ASDIC_ERROR_DEVICE,
                          "ASDIC_KERNEL_DIR '%s' has a blank, quote or backslash", folder);
    }
    if (asprintf(&path, "%s/%s", folder, file) < 0) {
        return asdic_fail_memory(ctx, "a path");
    }
    body = read_file(path);
    if (!body) {
        status = asdic_fail(ctx, ASDIC_ERROR_DEVICE, "cannot read kernel source '%s': %s", path,
                            strerror(errno));
    } else if (asprintf(text, "#line 1 \"kernels/%s\"\n%s", file, body) < 0) {
        *text = NULL;
        status = asdic_fail_memory(ctx, "a kernel source");
    } else if (asprintf(options, "-I %s", folder) < 0) {
        free(*text);
        *text = *options = NULL;
        status = asdic_fail_memory(ctx, "compiler options");
    }
    free(body);
    free(path);
    return status;
}

asdic_status asdic_kernel_source(asdic_context *ctx, const char *file, char **text,
                                 char **options) {
    const char *folder = getenv("ASDIC_KERNEL_DIR");

    *text = *options = NULL;
    if (folder && folder[0]) {
        return from_folder(ctx, folder, file, text, options);
    }
    for (const asdic_kernel_text *entry = asdic_kernel_texts; entry->file; entry++) {
        if (strcmp(entry->file, file) == 0) {
            *text = strdup(entry->text);
            *options = strdup("");
            if (!*text || !*options) {
                free(*text);
                free(*options);
                *text = *options = NULL;
                return asdic_fail_memory(ctx, "a kernel source");
            }
            return ASDIC_OK;
        }
    }
    return asdic_fail(ctx, ASDIC_ERROR_DEVICE, "there is no kernel source '%s' in the library",
                      file);
}
