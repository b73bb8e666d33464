/*
 * OpenCL devices: list them, choose them, open them.
 *
 * A selector is what `--device` takes: "auto" (a GPU if there is one, else an accelerator, else a
 * CPU; of several the one with the most compute units), "all", "cpu", "gpu", "acc", "P:D"
 * (platform:device as listed), "P:D,P:D", or "name:TEXT" (case-insensitive part of the device's or
 * platform's name). Nothing is required of a device beyond OpenCL 1.2 and single precision; what it
 * lacks is worked around and listed here.
 */
#ifndef ASDIC_DEVICE_H
#define ASDIC_DEVICE_H

#include <asdic/context.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_device asdic_device;

typedef enum asdic_device_kind {
    ASDIC_DEVICE_CPU,
    ASDIC_DEVICE_GPU,
    ASDIC_DEVICE_ACCELERATOR,
    ASDIC_DEVICE_OTHER
} asdic_device_kind;

typedef struct asdic_device_info {
    unsigned platform, device; /* the P:D of the selector */
    asdic_device_kind kind;
    char name[256], vendor[256], platform_name[256], driver[256], version[128];
    unsigned compute_units;
    size_t max_work_group;
    uint64_t global_bytes, local_bytes, max_alloc_bytes;
    bool has_fp64, has_int64_atomics, available, has_compiler;
    bool usable;            /* OpenCL >= 1.2, available, with a compiler, this byte order */
    char unusable_why[160]; /* "" when usable */
} asdic_device_info;

/* All devices of all platforms in the order of the OpenCL loader. *OUT is freed by
 * asdic_device_info_free. No platform at all is ASDIC_OK with *COUNT = 0. */
ASDIC_API asdic_status asdic_device_list(asdic_context *ctx, asdic_device_info **out,
                                         size_t *count);
ASDIC_API void asdic_device_info_free(asdic_device_info **infos);

/* PoCL shows no device, or compiles no kernel, where it cannot keep what it compiles: below
 * POCL_CACHE_DIR, else XDG_CACHE_HOME, else HOME. Where that is so, sets POCL_CACHE_DIR to a folder
 * of the user's own among the temporary files, with a warning. Before the first device is listed or
 * opened, and before other threads that read the environment. */
ASDIC_API void asdic_kernel_cache_prepare(asdic_context *ctx);

/* Opens every device the selector matches (NULL means "auto"). *OUT is an array of *COUNT devices,
 * closed and freed together by asdic_devices_close. ASDIC_ERROR_DEVICE when nothing matches or
 * nothing is usable, with the packages to install when there is no platform. */
ASDIC_API asdic_status asdic_devices_open(asdic_context *ctx, const char *selector,
                                          asdic_device ***out, size_t *count);
/* What was created on a device is to be destroyed before. */
ASDIC_API void asdic_devices_close(asdic_device ***devices, size_t count);

/* Splits an opened CPU-like device into COUNT equal sub-devices where the platform can
 * (clCreateSubDevices); ASDIC_ERROR_UNSUPPORTED where it cannot. Freed by asdic_devices_close. */
ASDIC_API asdic_status asdic_device_split(asdic_device *device, size_t count, asdic_device ***out);

/* Valid until the device is closed; NULL for NULL. */
ASDIC_API const asdic_device_info *asdic_device_get_info(const asdic_device *device);

#ifdef __cplusplus
}
#endif

#endif
