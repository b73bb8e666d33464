#include "netcdf_file.h"

#include "asdic_config.h"
#include "base/context.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

bool asdic_nc_check(asdic_nc *nc, int code) {
    if (nc->failure == NC_NOERR) {
        nc->failure = code;
    }
    return nc->failure == NC_NOERR;
}

/* It stays: HDF5 cleans up at the end of the process. */
static void *open_library(void) {
    return dlopen(ASDIC_NETCDF, RTLD_NOW);
}

const char *asdic_nc_missing(void) {
    return open_library() ? NULL : ASDIC_NETCDF " cannot be loaded; install " ASDIC_NETCDF_PACKAGE;
}

static asdic_status load(asdic_nc *nc) {
    void *library = open_library();
#define FIND(name)                                                                                 \
    nc->call.name = library ? (__typeof__(nc->call.name))dlsym(library, "nc_" #name) : NULL;       \
    if (!nc->call.name) {                                                                          \
        return asdic_fail(nc->ctx, ASDIC_ERROR_UNSUPPORTED,                                        \
                          "cannot write '%s' without netCDF: %s", nc->path, dlerror());            \
    }
    ASDIC_NC_FUNCTIONS(FIND)
#undef FIND
    return ASDIC_OK;
}

/* Makes the file NC->part. netCDF 4.9 takes a backslash for a slash; such a folder is named by number. */
static int create(asdic_nc *nc) {
    const char *slash = strrchr(nc->part, '/'), *backslash = strchr(nc->part, '\\');
    char *folder = NULL, *part = NULL;
    int code = NC_NOERR;
    if (unlink(nc->part) != 0 && errno != ENOENT) {
        return errno;
    }
    if (!slash || !backslash || backslash > slash) {
        return nc->call.create(nc->part, NC_NETCDF4 | NC_NOCLOBBER, &nc->id);
    }
    folder = strndup(nc->part, (size_t)(slash - nc->part) + 1);
    nc->folder = folder ? open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;
    if (nc->folder < 0) {
        code = folder ? errno : NC_ENOMEM;
        nc->folder = 0;
    } else if (asprintf(&part, "/proc/self/fd/%d%s", nc->folder, slash) < 0) {
        part = NULL;
        code = NC_ENOMEM;
    }
    code = code ? code : nc->call.create(part, NC_NETCDF4 | NC_NOCLOBBER, &nc->id);
    free(folder);
    free(part);
    return code;
}

asdic_status asdic_nc_create(asdic_context *ctx, const char *path, asdic_nc *out) {
    *out = (asdic_nc){.ctx = ctx, .path = strdup(path)};
    asdic_status loaded = out->path ? load(out) : ASDIC_OK;
    if (loaded != ASDIC_OK) {
        asdic_nc_discard(out);
        return loaded;
    }
    if (!out->path || asprintf(&out->part, "%s.part", path) < 0) {
        out->part = NULL;
        asdic_nc_discard(out);
        return asdic_fail_memory(ctx, "a file name");
    }
    int code = create(out);
    if (!asdic_nc_check(out, code)) {
        asdic_status status = asdic_nc_status(out);
        asdic_nc_discard(out);
        return status;
    }
    return ASDIC_OK;
}

int asdic_nc_group(asdic_nc *nc, int parent, const char *name) {
    int id = -1;
    if (nc->failure == NC_NOERR) {
        asdic_nc_check(nc, nc->call.def_grp(parent, name, &id));
    }
    return id;
}

int asdic_nc_dimension(asdic_nc *nc, int group, const char *name, size_t length) {
    int id = -1;
    if (nc->failure == NC_NOERR) {
        asdic_nc_check(nc, nc->call.def_dim(group, name, length, &id));
    }
    return id;
}

void asdic_nc_texts(asdic_nc *nc, int group, int variable, const asdic_nc_attribute *attributes) {
    for (; attributes->name && nc->failure == NC_NOERR; attributes++) {
        asdic_nc_check(nc, nc->call.put_att_text(group, variable, attributes->name,
                                                 strlen(attributes->value), attributes->value));
    }
}

int asdic_nc_variable(asdic_nc *nc, int group, const char *name, nc_type type, int rank,
                      const int *dimensions, const char *long_name, const char *units) {
    int id = -1;
    if (nc->failure != NC_NOERR ||
        !asdic_nc_check(nc, nc->call.def_var(group, name, type, rank, dimensions, &id))) {
        return -1;
    }
    const asdic_nc_attribute texts[] = {
        {"long_name", long_name}, {units ? "units" : NULL, units}, {NULL, NULL}};
    asdic_nc_texts(nc, group, id, texts);
    return id;
}

asdic_status asdic_nc_status(const asdic_nc *nc) {
    if (nc->failure == NC_NOERR) {
        return ASDIC_OK;
    }
    /* Codes above zero are the system's. */
    return asdic_fail(nc->ctx, nc->failure == NC_ENOMEM ? ASDIC_ERROR_MEMORY : ASDIC_ERROR_IO,
                      "cannot write '%s': %s%s", nc->part ? nc->part : nc->path,
                      nc->call.strerror(nc->failure),
                      nc->failure == NC_EHDFERR ? "; the disk may be full" : "");
}

/* The file gets its name only after its bytes are on the disk. */
static int sync_file(const char *path) {
    int fd = open(path, O_RDONLY | O_CLOEXEC);
    int error = fd < 0 || fsync(fd) != 0 ? errno : 0;
    if (fd >= 0) {
        close(fd);
    }
    return error;
}

asdic_status asdic_nc_commit(asdic_nc *nc) {
    if (nc->failure == NC_NOERR && asdic_nc_check(nc, nc->call.close(nc->id)) &&
        asdic_nc_check(nc, sync_file(nc->part)) && rename(nc->part, nc->path) != 0) {
        nc->failure = errno;
    }
    asdic_status status = asdic_nc_status(nc);
    if (status == ASDIC_OK) {
        free(nc->part);
        nc->part = NULL;
    }
    asdic_nc_discard(nc);
    return status;
}

void asdic_nc_discard(asdic_nc *nc) {
    if (nc->part) {
        unlink(nc->part);
    }
    if (nc->folder > 0) {
        close(nc->folder);
    }
    free(nc->part);
    free(nc->path);
    *nc = (asdic_nc){0};
}
