/*
 * The settings of a mission, and where its files are.
 */
#include "mission_build.h"

#include "base/context.h"

#include <stdlib.h>
#include <string.h>

const char *asdic_mission_resolve(const mission_builder *b, const char *name) {
    const char *scene = b->mission->path;
    const char *slash = strrchr(scene, '/');
    size_t folder = *name != '/' && slash ? (size_t)(slash - scene) + 1 : 0;
    size_t length = strlen(name);
    char *path = asdic_arena_alloc(b->arena, folder + length + 1);
    if (path) {
        memcpy(path, scene, folder);
        memcpy(path + folder, name, length + 1);
    }
    return path;
}

asdic_status asdic_mission_file_problem(mission_builder *b, asdic_yaml_node *node,
                                        asdic_status status) {
    if (status == ASDIC_ERROR_MEMORY) {
        return status;
    }
    asdic_yaml_problem(b->problems, node, "%s", asdic_context_error(b->ctx));
    return ASDIC_OK;
}

asdic_status asdic_mission_build_settings(mission_builder *b) {
    const asdic_scene_file *file = b->file;
    asdic_mission *m = b->mission;
    m->environment = asdic_scene_file_environment(file);
    m->sonar = asdic_scene_file_sonar(file);
    m->receivers = calloc(m->sonar.receiver_count + 1, sizeof *m->receivers);
    if (!m->receivers) {
        return asdic_fail_memory(b->ctx, "the receivers");
    }
    asdic_scene_file_receivers(file, m->receivers);
    m->sonar.receivers = m->receivers;
    m->sampling = (asdic_sampling){
        .rays = (uint32_t)file->sampling.rays,
        .sampler = (asdic_sampler)file->sampling.sampler,
        .multipath = (asdic_multipath)file->sampling.multipath,
        .seed = (uint64_t)file->sampling.seed,
    };
    m->keeps_all_terms = file->model.terms == FILE_TERMS_ALL;
    m->detector = (asdic_detector){.target = (asdic_target)file->detector.target,
                                   .pfa = file->detector.pfa,
                                   .prior = file->detector.prior,
                                   .snr_db = file->detector.snr_db,
                                   .cost_ratio = file->detector.cost_ratio};
    m->output = (asdic_output_options){.csv = (asdic_csv_form)file->output.csv,
                                       .npy = file->output.npy,
                                       .netcdf = file->output.netcdf,
                                       .images = file->output.images};
    m->pose = asdic_scene_file_pose(file);
    return ASDIC_OK;
}
