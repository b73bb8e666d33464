#include "opencl.h"

#include "base/clock.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A program from the cache is there in less. */
#define CACHED_S 0.4

static void program_destroy(asdic_program **program) {
    if (!program || !*program) {
        return;
    }
    if ((*program)->id) {
        clReleaseProgram((*program)->id);
    }
    free((*program)->file);
    free((*program)->options);
    free(*program);
    *program = NULL;
}

void asdic_programs_destroy(asdic_program **programs) {
    while (*programs) {
        asdic_program *next = (*programs)->next;
        program_destroy(programs);
        *programs = next;
    }
}

/* The compiler's log; the caller frees it; NULL when there is none. */
static char *build_log(const asdic_device *device, cl_program program) {
    size_t size = 0;
    if (clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, 0, NULL, &size) !=
            CL_SUCCESS ||
        size == 0) {
        return NULL;
    }
    char *log = calloc(size + 1, 1);
    if (log && clGetProgramBuildInfo(program, device->id, CL_PROGRAM_BUILD_LOG, size, log, NULL) !=
                   CL_SUCCESS) {
        free(log);
        log = NULL;
    }
    return log;
}

/* The line that says what is wrong: the first with "error", else the first. */
static int telling_line(const char *log, const char **line) {
    const char *at = strstr(log, "error");
    if (!at) {
        at = log + strspn(log, "\n ");
    }
    while (at > log && at[-1] != '\n') {
        at--;
    }
    *line = at;
    return (int)strcspn(at, "\n");
}

static asdic_status build_failed(const asdic_device *device, const asdic_program *program,
                                 cl_int code) {
    char text[64];
    const char *line = "";
    char *log = build_log(device, program->id);
    int length = log ? telling_line(log, &line) : 0;

    if (length > 0) {
        asdic_log(device->ctx, ASDIC_LOG_DEBUG, "%s", log);
        asdic_fail(device->ctx, ASDIC_ERROR_DEVICE,
                   "%.*s (kernels/%s with '%s' does not compile on device '%s')", length, line,
                   program->file, program->options, device->info.name);
    } else {
        asdic_fail(device->ctx, ASDIC_ERROR_DEVICE,
                   "kernels/%s with '%s' does not compile on device '%s', which gives no reason: "
                   "%s",
                   program->file, program->options, device->info.name,
                   asdic_cl_error_text(code, text));
    }
    free(log);
    return ASDIC_ERROR_DEVICE;
}

/* A program that was SECONDS in the building, however busy the machine, came from no cache; the rest of the
 * kernels, which PoCL makes when they first run, will take a multiple of that. Said once a device. */
static void note_compiling(asdic_device *device, double seconds) {
    if (seconds > CACHED_S && !device->is_compiling_told) {
        device->is_compiling_told = true;
        asdic_log(device->ctx, ASDIC_LOG_NOTE,
                  "compiling kernels for device '%s'; later runs find them in its cache",
                  device->info.name);
    }
}

/* What makes quotients and roots those of IEEE 754, where that is not so anyway, or nothing: so rounded, a ray
 * meets the same on every kind of device. */
static const char *rounding_option(const asdic_device *device) {
    cl_device_fp_config config = 0;
    clGetDeviceInfo(device->id, CL_DEVICE_SINGLE_FP_CONFIG, sizeof config, &config, NULL);
    return config & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT ? "-cl-fp32-correctly-rounded-divide-sqrt"
                                                        : "";
}

static asdic_status build(asdic_device *device, asdic_program *program) {
    char *text = NULL, *source_options = NULL, *all_options = NULL;
    cl_int code = CL_SUCCESS;
    asdic_status status = asdic_kernel_source(device->ctx, program->file, &text, &source_options);
    if (status != ASDIC_OK) {
        return status;
    }
    if (asprintf(&all_options, "-cl-std=CL1.2 %s %s %s", rounding_option(device), source_options,
                 program->options) < 0) {
        all_options = NULL;
        status = asdic_fail_memory(device->ctx, "compiler options");
        goto done;
    }
    asdic_log(device->ctx, ASDIC_LOG_DEBUG, "compiling kernels/%s (%s) for device '%s'",
              program->file, all_options, device->info.name);
    const char *texts[] = {text};
    program->id = clCreateProgramWithSource(device->cl, 1, texts, NULL, &code);
    if (code != CL_SUCCESS) {
        status = asdic_cl_fail(device, code, "create a program");
        goto done;
    }
    int lock = asdic_build_lock(device);
    double begin_s = asdic_clock_s(), busy_s = asdic_processor_s();
    code = clBuildProgram(program->id, 1, &device->id, all_options, NULL, NULL);
    asdic_build_unlock(lock);
    note_compiling(device, fmin(asdic_clock_s() - begin_s, asdic_processor_s() - busy_s));
    if (code != CL_SUCCESS) {
        status = build_failed(device, program, code);
    }
done:
    free(all_options);
    free(source_options);
    free(text);
    return status;
}

asdic_status asdic_program_get(asdic_device *device, const char *file, const char *options,
                               cl_program *out) {
    *out = NULL;
    for (asdic_program *p = device->programs; p; p = p->next) {
        if (strcmp(p->file, file) == 0 && strcmp(p->options, options) == 0) {
            *out = p->id;
            return ASDIC_OK;
        }
    }
    asdic_program *program = calloc(1, sizeof *program);
    if (program) {
        program->file = strdup(file);
        program->options = strdup(options);
    }
    if (!program || !program->file || !program->options) {
        program_destroy(&program);
        return asdic_fail_memory(device->ctx, "a program");
    }
    asdic_status status = build(device, program);
    if (status != ASDIC_OK) {
        program_destroy(&program);
        return status;
    }
    program->next = device->programs;
    device->programs = program;
    *out = program->id;
    return ASDIC_OK;
}
