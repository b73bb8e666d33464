#include "run_files.h"

#include "base/context.h"
#include "out/file.h"
#include "out/netcdf_run.h"
#include "out/npy.h"
#include "run_folder.h"
#include "run_open.h"

#include <stdio.h>
#include <stdlib.h>

struct asdic_files {
    size_t cells;
    asdic_file *levels;   /* NULL: not asked for */
    asdic_netcdf *netcdf; /* the same */
};

static asdic_status create_levels(asdic_context *ctx, const char *folder,
                                  const asdic_run_facts *facts, asdic_file **out) {
    char header[ASDIC_NPY_HEADER_SIZE], rest[64];
    char *path = asdic_folder_path(folder, "levels", "", "npy");
    asdic_status status =
        path ? asdic_file_create(ctx, path, out) : asdic_fail_memory(ctx, "levels.npy");
    free(path);
    if (status == ASDIC_OK) {
        snprintf(rest, sizeof rest, "%zu, %zu", facts->beams, facts->bins);
        size_t length = asdic_npy_header(header, "'<f4'", facts->pings_planned, rest);
        fwrite(header, 1, length, asdic_file_stream(*out));
    }
    return status;
}

static asdic_status create_netcdf(asdic_context *ctx, const char *folder,
                                  const asdic_mission *settings, const asdic_run_facts *facts,
                                  double depth_m, asdic_netcdf **out) {
    const asdic_sonar *sonar = asdic_mission_sonar(settings);
    const asdic_environment *env = asdic_mission_environment(settings);
    char *path = asdic_folder_path(folder, "run", "", "nc");
    char *name = asdic_run_scene_name(facts->scene_path);
    asdic_netcdf_about about = {.sonar = sonar,
                                .sound_speed_mps = asdic_environment_sound_speed_mps(env, depth_m),
                                .absorption_db_per_km = asdic_environment_absorption_db_per_km(
                                    env, sonar->frequency_hz, depth_m),
                                .pings = facts->pings_planned,
                                .bins = facts->bins,
                                .scene_name = name,
                                .scene_hash = facts->scene_hash,
                                .version = facts->version,
                                .seed = facts->sampling.seed};
    asdic_status status = path && name ? asdic_netcdf_create(ctx, path, &about, out)
                                       : asdic_fail_memory(ctx, "run.nc");
    free(name);
    free(path);
    return status;
}

asdic_status asdic_files_create(asdic_context *ctx, const char *folder,
                                const asdic_mission *settings, const asdic_run_facts *facts,
                                double depth_m, asdic_files **out) {
    const asdic_output_options *output = asdic_mission_output(settings);
    *out = NULL;
    if (!output->npy && !output->netcdf) {
        return ASDIC_OK;
    }
    asdic_files *f = calloc(1, sizeof *f);
    if (!f) {
        return asdic_fail_memory(ctx, "a run's files");
    }
    f->cells = facts->beams * facts->bins;
    asdic_status status = ASDIC_OK;
    if (output->npy) {
        status = create_levels(ctx, folder, facts, &f->levels);
    }
    if (status == ASDIC_OK && output->netcdf) {
        status = create_netcdf(ctx, folder, settings, facts, depth_m, &f->netcdf);
    }
    if (status != ASDIC_OK) {
        asdic_files_discard(&f);
    }
    *out = f;
    return status;
}

asdic_status asdic_files_add(asdic_files *f, const asdic_record *record) {
    if (f && f->levels) {
        fwrite(record->level_db[ASDIC_TOTAL], sizeof(float), f->cells,
               asdic_file_stream(f->levels));
    }
    return f && f->netcdf ? asdic_netcdf_add(f->netcdf, record) : ASDIC_OK;
}

asdic_status asdic_files_commit(asdic_files **files) {
    asdic_files *f = *files;
    asdic_status status = f && f->levels ? asdic_file_commit(&f->levels) : ASDIC_OK;
    if (status == ASDIC_OK && f && f->netcdf) {
        status = asdic_netcdf_commit(&f->netcdf);
    }
    asdic_files_discard(files);
    return status;
}

void asdic_files_discard(asdic_files **files) {
    if (*files) {
        asdic_file_discard(&(*files)->levels);
        asdic_netcdf_discard(&(*files)->netcdf);
        free(*files);
        *files = NULL;
    }
}

asdic_status asdic_files_check(asdic_context *ctx, const asdic_mission *settings) {
    if (asdic_mission_output(settings)->netcdf && !asdic_netcdf_available()) {
        return asdic_fail(ctx, ASDIC_ERROR_UNSUPPORTED,
                          "the scene asks for 'output: {netcdf: true}', but this build has no "
                          "netCDF; install libnetcdf-dev and build again, or use false");
    }
    return ASDIC_OK;
}
