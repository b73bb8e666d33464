/* `asdic bench error`: the scenes one after another. */
#include "bench_error.h"

#include <stdlib.h>

#define DEFAULT_SCENES 4

bench_effort bench_effort_of(const bench_options *options) {
    if (options->quick) {
        return (bench_effort){.blocks = 4,
                              .point_rays = 1u << 20,
                              .reference_pings = 16,
                              .reference_rays = 1u << 18,
                              .cost_pairs = 9};
    }
    return (bench_effort){.blocks = 16,
                          .point_rays = 1u << 22,
                          .reference_pings = 96,
                          .reference_rays = 1u << 20,
                          .cost_pairs = 15};
}

static asdic_status measure(cli *c, asdic_device *device, const char *path,
                            const bench_effort *effort, bench_result *result) {
    static const asdic_sampler samplers[BENCH_SAMPLERS] = {
        ASDIC_SAMPLER_ADAPTIVE, ASDIC_SAMPLER_BEAM, ASDIC_SAMPLER_UNIFORM_SPHERE};
    asdic_status status = bench_scene_open(c, device, path, effort, &result->scene);
    for (size_t s = 0; !status && s < BENCH_SAMPLERS; s++) {
        status =
            bench_curve_measure(c, device, &result->scene, samplers[s], effort, &result->curves[s]);
    }
    if (!status) {
        status = bench_cost_errors(c, device, &result->scene, effort, &result->stated_cost);
    }
    if (!status) {
        status = bench_cost_bins(c, device, &result->scene, effort, &result->bins_cost);
    }
    return status;
}

/* The scenes asked for, or the shipped ones. False after a message. */
static bool scene_path(cli *c, size_t index, char *out, size_t size) {
    static const char *const shipped[DEFAULT_SCENES] = {
        "scenes/bench_flat.yaml", "scenes/bench_step.yaml", "scenes/bench_sphere.yaml",
        "scenes/bench_terrain.yaml"};
    if (cli_operand_count(c) > 1) {
        snprintf(out, size, "%s", cli_operand(c, index + 1));
        return true;
    }
    if (!bench_find_data(shipped[index], out, size)) {
        cli_error(c,
                  "cannot find the shipped scene '%s'; name scenes, or set ASDIC_DATA to the "
                  "folder that holds scenes/",
                  out);
        return false;
    }
    return true;
}

static int write_files(cli *c, const bench_options *options, const bench_result *results,
                       size_t count) {
    int code = CLI_OK;
    if (options->csv) {
        code = bench_error_csv(c, options->csv, results, count);
    }
    if (options->picture && code == CLI_OK) {
        code = cli_end(c, bench_error_picture(c, options->picture, results, count));
    }
    return code;
}

int bench_error(cli *c, const bench_options *options) {
    size_t wanted = cli_operand_count(c) > 1 ? cli_operand_count(c) - 1 : DEFAULT_SCENES;
    bench_effort effort = bench_effort_of(options);
    asdic_device **devices = NULL;
    size_t device_count = 0, count = 0;
    int code = CLI_OK;
    bench_result *results = calloc(wanted, sizeof *results);
    asdic_status status =
        results ? cli_open_devices(c, &devices, &device_count) : ASDIC_ERROR_MEMORY;
    if (status) {
        code = cli_end(c, status);
        goto done;
    }
    for (; count < wanted && code == CLI_OK; count++) {
        char path[4096];
        if (!scene_path(c, count, path, sizeof path)) {
            code = CLI_INPUT;
            break;
        }
        status = measure(c, devices[0], path, &effort, &results[count]);
        if (status) {
            bench_scene_finish(&results[count].scene);
            code = cli_end(c, status);
            break;
        }
        if (!options->json) {
            bench_error_print(&results[count], count == 0);
            fflush(stdout);
        }
    }
    if (options->json && count > 0) {
        bench_error_json(results, count, asdic_device_get_info(devices[0]));
    }
    if (code == CLI_OK) {
        code = write_files(c, options, results, count);
    }
done:
    for (size_t i = 0; i < count; i++) {
        bench_scene_finish(&results[i].scene);
    }
    free(results);
    asdic_devices_close(&devices, device_count);
    return code;
}
