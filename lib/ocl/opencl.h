/*
 * OpenCL itself and the struct behind asdic_device; only files of lib/ocl include this.
 */
#ifndef ASDIC_OCL_OPENCL_H
#define ASDIC_OCL_OPENCL_H

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "../base/context.h"
#include "ocl.h"

/* A program built for one device; kept until the device is closed. */
typedef struct asdic_program {
    char *file, *options;
    cl_program id;
    struct asdic_program *next;
} asdic_program;

struct asdic_device {
    asdic_context *ctx;
    asdic_device_info info;
    cl_device_id id;
    bool is_sub_device; /* id is ours to release */
    cl_context cl;
    cl_command_queue queue;
    asdic_program *programs;
    bool is_compiling_told;
    bool may_compile; /* told to the context */
};

struct asdic_buffer {
    asdic_device *device;
    cl_mem mem;
    void *memory;   /* of the host, for what is read; NULL: not yet */
    bool is_shared; /* the buffer lies in it */
    size_t bytes;   /* as asked for */
};

/* An OpenCL device as the loader lists it. */
typedef struct asdic_listed {
    cl_device_id id;
    asdic_device_info info;
} asdic_listed;

/* As asdic_device_list, with the identifiers; the caller frees *OUT. */
asdic_status asdic_listed_create(asdic_context *ctx, asdic_listed **out, size_t *count);

/* Puts the positions in LIST that SELECTOR (NULL: "auto") chooses, all usable, into CHOSEN, which
 * holds COUNT values, in the order in which they were asked for. */
asdic_status asdic_listed_select(asdic_context *ctx, const asdic_listed *list, size_t count,
                                 const char *selector, size_t *chosen, size_t *chosen_count);

/* Whether its driver is PoCL, which keeps what it compiles in files. */
bool asdic_driver_is_pocl(const asdic_device_info *info);

/* Whether the device's driver is known to be so slow that nobody should wait for it. */
bool asdic_driver_is_slow(const asdic_device_info *info);

/* "CL_OUT_OF_RESOURCES (-5)"; TEXT has room for 64 characters. */
const char *asdic_cl_error_text(cl_int code, char text[64]);

/* A call that failed while working: memory or a lost device. WHAT completes "device 'x': cannot". */
asdic_status asdic_cl_fail(const asdic_device *device, cl_int code, const char *what);

/* The folder in which PoCL keeps what it compiled, by the environment; false: it has none, or its
 * path is too long. */
#define ASDIC_CACHE_SIZE 4096
bool asdic_cache_folder(char path[ASDIC_CACHE_SIZE]);
/* NULL, or why it can neither be written to nor be made, or has no room. */
const char *asdic_cache_refusal(char path[ASDIC_CACHE_SIZE]);
/* Fails where compiled kernels have no room in it. */
asdic_status asdic_cache_check_room(asdic_context *ctx);

/* PoCL 3.1 replaces a program in its cache by removing and renaming, without a lock: of processes
 * that build the same program at once, one may find it missing, and fails or crashes
 * (github.com/pocl/pocl/issues/1480). Between these two calls no other asdic on this machine
 * builds; with other platforms, or where nothing can be locked, they do nothing. */
int asdic_build_lock(const asdic_device *device);
void asdic_build_unlock(int lock);

/* Around what the driver may compile in: making a kernel, and running it for the first
 * time until the device has finished, since PoCL compiles then. */
void asdic_device_may_compile(asdic_device *device);
void asdic_device_has_compiled(asdic_device *device);

/* The program of FILE built with OPTIONS, from the device's cache or new. */
asdic_status asdic_program_get(asdic_device *device, const char *file, const char *options,
                               cl_program *out);
void asdic_programs_destroy(asdic_program **programs);

/* Text of the kernel source FILE and the compiler options it needs; both are freed by the caller.
 * Embedded, unless ASDIC_KERNEL_DIR names a folder to read from while developing. */
asdic_status asdic_kernel_source(asdic_context *ctx, const char *file, char **text, char **options);

#endif
