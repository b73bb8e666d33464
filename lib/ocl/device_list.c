#include "opencl.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* More than any driver's list of extensions. */
#define TEXT_BYTES 16384

/* Empty where the driver gives no answer, or one that is too long. */
static void get_text(cl_device_id id, cl_device_info what, char *out, size_t size) {
    char text[TEXT_BYTES + 1] = "";
    out[0] = '\0';
    if (clGetDeviceInfo(id, what, TEXT_BYTES, text, NULL) == CL_SUCCESS) {
        snprintf(out, size, "%s", text + strspn(text, " ")); /* some drivers pad names */
    }
}

static bool has_extension(cl_device_id id, const char *name) {
    char text[TEXT_BYTES];
    get_text(id, CL_DEVICE_EXTENSIONS, text, sizeof text);
    size_t length = strlen(name);
    for (const char *p = text; (p = strstr(p, name)) != NULL; p += length) {
        if ((p == text || p[-1] == ' ') && (p[length] == '\0' || p[length] == ' ')) {
            return true;
        }
    }
    return false;
}

/* The type is a set of bits: Oclgrind, which runs on the processor, sets all of them. */
static asdic_device_kind kind_of(cl_device_type type) {
    if (type & CL_DEVICE_TYPE_CPU) {
        return ASDIC_DEVICE_CPU;
    }
    if (type & CL_DEVICE_TYPE_GPU) {
        return ASDIC_DEVICE_GPU;
    }
    if (type & CL_DEVICE_TYPE_ACCELERATOR) {
        return ASDIC_DEVICE_ACCELERATOR;
    }
    return ASDIC_DEVICE_OTHER;
}

static bool host_is_little_endian(void) {
    const uint16_t one = 1;
    return *(const unsigned char *)&one == 1;
}

static void judge(cl_device_id id, asdic_device_info *info) {
    unsigned major = 0, minor = 0;
    cl_bool little = CL_TRUE;
    char profile[64];
    const char *why = NULL;

    clGetDeviceInfo(id, CL_DEVICE_ENDIAN_LITTLE, sizeof little, &little, NULL);
    get_text(id, CL_DEVICE_PROFILE, profile, sizeof profile);
    if (sscanf(info->version, "OpenCL %u.%u", &major, &minor) != 2 || major * 10 + minor < 12) {
        why = "its OpenCL is older than 1.2";
    } else if (!info->available) {
        why = "its driver says it is not available";
    } else if (!info->has_compiler) {
        why = "it has no compiler for OpenCL C";
    } else if ((little == CL_TRUE) != host_is_little_endian()) {
        why = "its byte order differs from this machine's";
    } else if (strcmp(profile, "EMBEDDED_PROFILE") == 0 && !has_extension(id, "cles_khr_int64")) {
        why = "it has no 64-bit integers (embedded profile without cles_khr_int64)";
    }
    info->usable = why == NULL;
    snprintf(info->unusable_why, sizeof info->unusable_why, "%s", why ? why : "");
}

static void describe(cl_device_id id, asdic_device_info *info) {
    cl_device_type type = 0;
    cl_uint units = 0;
    cl_ulong global = 0, local = 0, alloc = 0;
    cl_bool available = CL_FALSE, compiler = CL_FALSE;

    get_text(id, CL_DEVICE_NAME, info->name, sizeof info->name);
    get_text(id, CL_DEVICE_VENDOR, info->vendor, sizeof info->vendor);
    get_text(id, CL_DRIVER_VERSION, info->driver, sizeof info->driver);
    get_text(id, CL_DEVICE_VERSION, info->version, sizeof info->version);
    clGetDeviceInfo(id, CL_DEVICE_TYPE, sizeof type, &type, NULL);
    clGetDeviceInfo(id, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
    clGetDeviceInfo(id, CL_DEVICE_MAX_WORK_GROUP_SIZE, sizeof info->max_work_group,
                    &info->max_work_group, NULL);
    clGetDeviceInfo(id, CL_DEVICE_GLOBAL_MEM_SIZE, sizeof global, &global, NULL);
    clGetDeviceInfo(id, CL_DEVICE_LOCAL_MEM_SIZE, sizeof local, &local, NULL);
    clGetDeviceInfo(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE, sizeof alloc, &alloc, NULL);
    clGetDeviceInfo(id, CL_DEVICE_AVAILABLE, sizeof available, &available, NULL);
    clGetDeviceInfo(id, CL_DEVICE_COMPILER_AVAILABLE, sizeof compiler, &compiler, NULL);
    info->kind = kind_of(type);
    info->compute_units = units;
    info->global_bytes = global;
    info->local_bytes = local;
    info->max_alloc_bytes = alloc;
    info->available = available == CL_TRUE;
    info->has_compiler = compiler == CL_TRUE;
    info->has_fp64 = has_extension(id, "cl_khr_fp64");
    info->has_int64_atomics = has_extension(id, "cl_khr_int64_base_atomics");
    judge(id, info);
}

/* Adds the devices of one platform; a platform that fails to answer has none. */
static asdic_status add_platform(asdic_context *ctx, cl_platform_id platform, unsigned number,
                                 asdic_listed **list, size_t *count) {
    cl_uint found = 0;
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, NULL, &found) != CL_SUCCESS || !found) {
        return ASDIC_OK;
    }
    cl_device_id *ids = calloc(found, sizeof *ids);
    asdic_listed *more = realloc(*list, (*count + found) * sizeof **list);
    if (more) {
        *list = more;
    }
    if (!ids || !more) {
        free(ids);
        return asdic_fail_memory(ctx, "the list of OpenCL devices");
    }
    if (clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, found, ids, NULL) != CL_SUCCESS) {
        found = 0;
    }
    for (cl_uint i = 0; i < found; i++) {
        asdic_listed *item = &(*list)[(*count)++];
        memset(item, 0, sizeof *item);
        item->id = ids[i];
        item->info.platform = number;
        item->info.device = i;
        clGetPlatformInfo(platform, CL_PLATFORM_NAME, sizeof item->info.platform_name - 1,
                          item->info.platform_name, NULL);
        describe(ids[i], &item->info);
    }
    free(ids);
    return ASDIC_OK;
}

/* Adds the devices of every platform, in the loader's order. */
static asdic_status add_platforms(asdic_context *ctx, asdic_listed **list, size_t *count) {
    asdic_status status = ASDIC_OK;
    cl_uint platform_count = 0;

    /* Without a platform the loader answers with an error of its own (-1001). */
    if (clGetPlatformIDs(0, NULL, &platform_count) != CL_SUCCESS || platform_count == 0) {
        return ASDIC_OK;
    }
    cl_platform_id *platforms = calloc(platform_count, sizeof *platforms);
    if (!platforms) {
        return asdic_fail_memory(ctx, "the list of OpenCL platforms");
    }
    if (clGetPlatformIDs(platform_count, platforms, NULL) != CL_SUCCESS) {
        platform_count = 0;
    }
    for (cl_uint i = 0; i < platform_count && status == ASDIC_OK; i++) {
        status = add_platform(ctx, platforms[i], i, list, count);
    }
    free(platforms);
    return status;
}

asdic_status asdic_listed_create(asdic_context *ctx, asdic_listed **out, size_t *count) {
    /* The one lock of the process: drivers set themselves up when they are first asked, and PoCL 3.1 does so
     * without a lock of its own; of two threads that ask at once, one finds no device or both crash. */
    static pthread_mutex_t first_use = PTHREAD_MUTEX_INITIALIZER;

    *out = NULL;
    *count = 0;
    pthread_mutex_lock(&first_use);
    asdic_status status = add_platforms(ctx, out, count);
    pthread_mutex_unlock(&first_use);
    if (status != ASDIC_OK) {
        free(*out);
        *out = NULL;
        *count = 0;
    }
    return status;
}

asdic_status asdic_device_list(asdic_context *ctx, asdic_device_info **out, size_t *count) {
    asdic_listed *list = NULL;
    size_t listed = 0;

    if (!out || !count) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_device_list needs OUT and COUNT");
    }
    *out = NULL;
    *count = 0;
    asdic_status status = asdic_listed_create(ctx, &list, &listed);
    if (status != ASDIC_OK || listed == 0) {
        return status;
    }
    *out = calloc(listed, sizeof **out);
    if (!*out) {
        free(list);
        return asdic_fail_memory(ctx, "the list of OpenCL devices");
    }
    for (size_t i = 0; i < listed; i++) {
        (*out)[i] = list[i].info;
    }
    *count = listed;
    free(list);
    return ASDIC_OK;
}

void asdic_device_info_free(asdic_device_info **infos) {
    if (infos) {
        free(*infos);
        *infos = NULL;
    }
}
