#include "run_files.h"

#include "base/context.h"
#include "out/file.h"
#include "out/netcdf_run.h"
#include "out/npy.h"
#include "run_folder.h"
#include "run_open.h"

#include <stdio.h>
#include <stdlib.h>

static asdic_status write_levels(asdic_context *ctx, asdic_store *store, const char *folder,
                                 size_t beams, size_t bins) {
    char header[ASDIC_NPY_HEADER_SIZE], rest[64];
    char *path = asdic_folder_path(folder, "levels", "", "npy");
    asdic_file *file = NULL;
    void *bytes = malloc(asdic_store_record_bytes(store));
    asdic_status status =
        bytes && path ? asdic_file_create(ctx, path, &file) : asdic_fail_memory(ctx, "levels.npy");
    if (status != ASDIC_OK) {
        goto done;
    }
    snprintf(rest, sizeof rest, "%zu, %zu", beams, bins);
    size_t length = asdic_npy_header(header, "'<f4'", asdic_store_count(store), rest);
    fwrite(header, 1, length, asdic_file_stream(file));
    for (size_t i = 0; i < asdic_store_count(store) && status == ASDIC_OK; i++) {
        asdic_record record;
        status = asdic_store_read(store, i, bytes);
        if (status == ASDIC_OK) {
            asdic_record_view(bytes, beams, bins, &record);
            fwrite(record.level_db[ASDIC_TOTAL], sizeof(float), beams * bins,
                   asdic_file_stream(file));
        }
    }
    if (status == ASDIC_OK) {
        status = asdic_file_commit(&file);
    }
done:
    asdic_file_discard(&file);
    free(path);
    free(bytes);
    return status;
}

static asdic_status write_netcdf(asdic_context *ctx, asdic_store *store, const char *folder,
                                 const asdic_mission *settings, const asdic_run_facts *facts) {
    const asdic_sonar *sonar = asdic_mission_sonar(settings);
    const asdic_environment *env = asdic_mission_environment(settings);
    char *path = asdic_folder_path(folder, "run", "", "nc");
    char *name = asdic_run_scene_name(facts->scene_path);
    void *bytes = malloc(asdic_store_record_bytes(store));
    asdic_netcdf *file = NULL;
    asdic_record record;
    asdic_status status = bytes && path && name ? asdic_store_read(store, 0, bytes)
                                                : asdic_fail_memory(ctx, "run.nc");
    if (status != ASDIC_OK) {
        goto done;
    }
    asdic_record_view(bytes, facts->beams, facts->bins, &record);
    double depth_m = record.pose.position_m.z;
    asdic_netcdf_about about = {.sonar = sonar,
                                .sound_speed_mps = asdic_environment_sound_speed_mps(env, depth_m),
                                .absorption_db_per_km = asdic_environment_absorption_db_per_km(
                                    env, sonar->frequency_hz, depth_m),
                                .pings = asdic_store_count(store),
                                .bins = facts->bins,
                                .scene_name = name,
                                .scene_hash = facts->scene_hash,
                                .version = facts->version,
                                .seed = facts->sampling.seed};
    status = asdic_netcdf_create(ctx, path, &about, &file);
    for (size_t i = 0; i < about.pings && status == ASDIC_OK; i++) {
        status = asdic_store_read(store, i, bytes);
        if (status == ASDIC_OK) {
            asdic_record_view(bytes, facts->beams, facts->bins, &record);
            status = asdic_netcdf_add(file, &record);
        }
    }
    if (status == ASDIC_OK) {
        status = asdic_netcdf_commit(&file);
    }
done:
    asdic_netcdf_discard(&file);
    free(bytes);
    free(name);
    free(path);
    return status;
}

asdic_status asdic_files_write(asdic_context *ctx, asdic_store *store, const char *folder,
                               const asdic_mission *settings, const asdic_run_facts *facts) {
    const asdic_output_options *output = asdic_mission_output(settings);
    asdic_status status = ASDIC_OK;
    if (output->npy) {
        status = write_levels(ctx, store, folder, facts->beams, facts->bins);
    }
    if (status == ASDIC_OK && output->netcdf) {
        status = write_netcdf(ctx, store, folder, settings, facts);
    }
    return status;
}

asdic_status asdic_files_check(asdic_context *ctx, const asdic_mission *settings) {
    if (asdic_mission_output(settings)->netcdf && !asdic_netcdf_available()) {
        return asdic_fail(ctx, ASDIC_ERROR_UNSUPPORTED,
                          "the scene asks for 'output: {netcdf: true}', but this build has no "
                          "netCDF; install libnetcdf-dev and build again, or use false");
    }
    return ASDIC_OK;
}
