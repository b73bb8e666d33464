/*
 * The pings of a mission, learnt, on the thread that opened the device, in a layout of the caller's:
 * Oclgrind 21.10 cannot look for uninitialised values where another thread writes to it.
 *
 *     lone_run SCENE KERNEL WIDTH DEPOSIT LOCAL
 *
 * prints the intensity of every ping, component, beam and bin, exactly. KERNEL counts as
 * asdic_ray_kernel, DEPOSIT as asdic_deposit.
 */
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include "sim/simulator.h"

#include <asdic/asdic.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* In place of the library's: what is filled counts as uninitialised in Oclgrind 21.10, even in a kernel
 * that does nothing but add to a buffer of zeros; what is written does not. */
CL_API_ENTRY cl_int CL_API_CALL clEnqueueFillBuffer(cl_command_queue queue, cl_mem buffer,
                                                    const void *pattern, size_t pattern_bytes,
                                                    size_t offset, size_t bytes, cl_uint waits,
                                                    const cl_event *list, cl_event *event) {
    char *filled = malloc(bytes);
    if (!filled) {
        return CL_OUT_OF_HOST_MEMORY;
    }
    for (size_t at = 0; at < bytes; at += pattern_bytes) {
        memcpy(filled + at, pattern, pattern_bytes);
    }
    cl_int code =
        clEnqueueWriteBuffer(queue, buffer, CL_TRUE, offset, bytes, filled, waits, list, event);
    free(filled);
    return code;
}

static void print_ping(const asdic_ping *ping) {
    for (int c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        for (size_t n = 0; n < ping->beams * ping->bins; n++) {
            printf("%a\n", ping->intensity_lin[c][n]);
        }
    }
}

static asdic_status shoot(asdic_simulator *sim, const asdic_mission *mission, asdic_ping *ping) {
    asdic_status status = ASDIC_OK;
    for (size_t k = 0; !status && k < asdic_mission_ping_count(mission); k++) {
        asdic_pose pose = asdic_mission_pose(mission, k, NULL);
        status = asdic_mission_place(mission, sim, k);
        status = status ? status : asdic_simulator_learn(sim, &pose, k);
        status = status ? status : asdic_simulator_ping(sim, &pose, k, ping);
        if (!status) {
            print_ping(ping);
        }
    }
    return status;
}

static asdic_status simulate(asdic_context *ctx, asdic_device *device, asdic_mission *mission,
                             char **arguments) {
    asdic_sampling sampling = *asdic_mission_sampling(mission);
    sampling.kernel = (asdic_ray_kernel)atoi(arguments[0]);
    asdic_layout layout = asdic_layout_default(asdic_device_get_info(device));
    layout.width = (unsigned)atoi(arguments[1]);
    layout.deposit = (asdic_deposit)atoi(arguments[2]);
    layout.local = (size_t)atoi(arguments[3]);
    const asdic_sonar *sonar = asdic_mission_sonar(mission);
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    asdic_status status = asdic_simulator_create_with(ctx, device, asdic_mission_scene(mission),
                                                      asdic_mission_environment(mission), sonar,
                                                      &sampling, depth_m, &layout, &sim);
    status = status ? status
                    : asdic_ping_create(ctx, sonar->receiver_count, asdic_simulator_bin_count(sim),
                                        &ping);
    status = status ? status : shoot(sim, mission, ping);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return status;
}

int main(int argc, char **argv) {
    asdic_context *ctx = NULL;
    asdic_device **devices = NULL;
    asdic_mission *mission = NULL;
    size_t count = 0;
    asdic_status status = argc == 6 ? asdic_context_create(&ctx) : ASDIC_ERROR_ARGUMENT;
    status = status ? status : asdic_devices_open(ctx, "auto", &devices, &count);
    status = status ? status : asdic_mission_load(ctx, argv[1], &mission);
    status = status ? status : simulate(ctx, devices[0], mission, argv + 2);
    if (status) {
        fprintf(stderr, "%s\n", ctx ? asdic_context_error(ctx) : "give a scene and a layout");
    }
    asdic_mission_destroy(&mission);
    asdic_devices_close(&devices, count);
    asdic_context_destroy(&ctx);
    return status != ASDIC_OK;
}
