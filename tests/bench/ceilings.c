/* What a device can do: how fast it moves memory (the triad of McCalpin's STREAM) and how many multiply-adds it
 * makes a second, each by a kernel that does nothing else. */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "kinds.h"

#include <math.h>

#define VECTORS                                                                                    \
    ((size_t)1 << 20) /* of 16 floats in each of three arrays: 64 MB, beyond any cache */
#define ROUNDS 4096u
#define ITEMS ((size_t)512)
static const size_t LOCAL_SIZE = 16;
#define RUNS 32 /* the least counts: other load hardly shows */

/* How many multiply-adds do not wait for each other: eight keep two units busy where a register holds sixteen
 * floats; where it holds eight they are too many for the registers, and five do. */
static const struct {
    const char *kernel;
    double count;
} chains[] = {{"chains5", 5.0}, {"chains8", 8.0}};

static const char ceilings[] =
    "#ifdef __clang__\n"
    "#pragma clang diagnostic ignored \"-Wpsabi\"\n"
    "#endif\n"
    "__kernel void triad(__global float16 *a, __global const float16 *b,\n"
    "                    __global const float16 *c, float k) {\n"
    "    size_t i = get_global_id(0);\n"
    "    a[i] = b[i] + k * c[i];\n"
    "}\n"
    "#define NEXT(n) x[n] = fma(x[n], k, k);\n"
    "#define CHAINS(N, NEXTS) \\\n"
    "    __kernel void chains##N(__global float16 *a, float k, uint rounds) { \\\n"
    "        size_t i = get_global_id(0); \\\n"
    "        float16 x[N], sum = 0.0f; \\\n"
    "        for (int n = 0; n < N; n++) { x[n] = (float16)((float)i + (float)n); } \\\n"
    "        for (uint round = 0; round < rounds; round++) { NEXTS } \\\n"
    "        for (int n = 0; n < N; n++) { sum += x[n]; } \\\n"
    "        a[i] = sum; \\\n"
    "    }\n"
    "CHAINS(5, NEXT(0) NEXT(1) NEXT(2) NEXT(3) NEXT(4))\n"
    "CHAINS(8, NEXT(0) NEXT(1) NEXT(2) NEXT(3) NEXT(4) NEXT(5) NEXT(6) NEXT(7))\n";

typedef struct machine {
    cl_device_id device;
    cl_context context;
    cl_command_queue queue;
    cl_program program;
    cl_mem arrays[3];
} machine;

/* The device of the loader's list; of its units as many as INFO says, for a part of it was asked for. */
static cl_device_id find(const asdic_device_info *info) {
    cl_platform_id platforms[32];
    cl_device_id devices[32], part;
    cl_uint count = 0, units = 0;
    if (clGetPlatformIDs(32, platforms, &count) != CL_SUCCESS || info->platform >= count ||
        clGetDeviceIDs(platforms[info->platform], CL_DEVICE_TYPE_ALL, 32, devices, &count) !=
            CL_SUCCESS ||
        info->device >= count) {
        return NULL;
    }
    cl_device_id whole = devices[info->device];
    clGetDeviceInfo(whole, CL_DEVICE_MAX_COMPUTE_UNITS, sizeof units, &units, NULL);
    const cl_device_partition_property by[] = {CL_DEVICE_PARTITION_BY_COUNTS,
                                               (cl_device_partition_property)info->compute_units,
                                               CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
    return units == info->compute_units ||
                   clCreateSubDevices(whole, by, 1, &part, NULL) != CL_SUCCESS
               ? whole
               : part;
}

static bool open_machine(const asdic_device_info *info, machine *m) {
    const char *text = ceilings;
    cl_int code = CL_SUCCESS;
    m->device = find(info);
    m->context = m->device ? clCreateContext(NULL, 1, &m->device, NULL, NULL, &code) : NULL;
    m->queue = m->context ? clCreateCommandQueue(m->context, m->device, 0, &code) : NULL;
    m->program = m->queue ? clCreateProgramWithSource(m->context, 1, &text, NULL, &code) : NULL;
    if (!m->program ||
        clBuildProgram(m->program, 1, &m->device, "-cl-std=CL1.2", NULL, NULL) != CL_SUCCESS) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        const float zero = 0.0f;
        size_t bytes = VECTORS * sizeof(cl_float16);
        m->arrays[k] = clCreateBuffer(m->context, CL_MEM_READ_WRITE, bytes, NULL, &code);
        if (!m->arrays[k] || clEnqueueFillBuffer(m->queue, m->arrays[k], &zero, sizeof zero, 0,
                                                 bytes, 0, NULL, NULL) != CL_SUCCESS) {
            return false;
        }
    }
    return clFinish(m->queue) == CL_SUCCESS;
}

static void close_machine(machine *m) {
    for (int k = 0; k < 3; k++) {
        m->arrays[k] ? clReleaseMemObject(m->arrays[k]) : 0;
    }
    m->program ? clReleaseProgram(m->program) : 0;
    m->queue ? clReleaseCommandQueue(m->queue) : 0;
    m->context ? clReleaseContext(m->context) : 0;
    m->device ? clReleaseDevice(m->device) : 0; /* only a part counts */
}

/* The least time of some runs, s; INFINITY where it cannot run. The first compiles. */
static double least_time(const machine *m, cl_kernel kernel, size_t items) {
    double least_s = INFINITY;
    for (int run = 0; kernel && run <= RUNS; run++) {
        double began = cli_clock_s();
        if (clEnqueueNDRangeKernel(m->queue, kernel, 1, NULL, &items, &LOCAL_SIZE, 0, NULL, NULL) !=
                CL_SUCCESS ||
            clFinish(m->queue) != CL_SUCCESS) {
            return INFINITY;
        }
        least_s = run > 0 ? fmin(least_s, cli_clock_s() - began) : INFINITY;
    }
    return least_s;
}

static double triad_bytes_per_s(const machine *m) {
    const float k = 0.5f;
    cl_kernel triad = clCreateKernel(m->program, "triad", NULL);
    for (cl_uint n = 0; triad && n < 3; n++) {
        clSetKernelArg(triad, n, sizeof m->arrays[n], &m->arrays[n]);
    }
    triad ? clSetKernelArg(triad, 3, sizeof k, &k) : 0;
    double s = least_time(m, triad, VECTORS);
    triad ? clReleaseKernel(triad) : 0;
    return 3.0 * VECTORS * sizeof(cl_float16) / s;
}

static double chains_flops_per_s(const machine *m, const char *name, double count) {
    const float k = 0.5f;
    const cl_uint rounds = ROUNDS;
    cl_kernel kernel = clCreateKernel(m->program, name, NULL);
    if (kernel) {
        clSetKernelArg(kernel, 0, sizeof m->arrays[0], &m->arrays[0]);
        clSetKernelArg(kernel, 1, sizeof k, &k);
        clSetKernelArg(kernel, 2, sizeof rounds, &rounds);
    }
    double s = least_time(m, kernel, ITEMS);
    kernel ? clReleaseKernel(kernel) : 0;
    return 2.0 * 16 * count * ROUNDS * ITEMS / s;
}

static void measure(const machine *m, bench_ceilings *out) {
    out->bytes_per_s = triad_bytes_per_s(m);
    for (size_t i = 0; i < sizeof chains / sizeof *chains; i++) {
        double flops_per_s = chains_flops_per_s(m, chains[i].kernel, chains[i].count);
        out->flops_per_s = fmax(out->flops_per_s, flops_per_s);
    }
}

asdic_status bench_ceilings_measure(asdic_device *device, bench_ceilings *out) {
    machine m = {0};
    *out = (bench_ceilings){0.0, 0.0};
    bool opened = open_machine(asdic_device_get_info(device), &m);
    if (opened) {
        measure(&m, out);
    }
    close_machine(&m);
    return out->bytes_per_s > 0.0 && out->flops_per_s > 0.0 ? ASDIC_OK : ASDIC_ERROR_DEVICE;
}
