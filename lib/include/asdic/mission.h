/*
 * A mission: everything a scene file says, and running it ping by ping into a run folder.
 */
#ifndef ASDIC_MISSION_H
#define ASDIC_MISSION_H

#include <asdic/expected.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_mission asdic_mission;

/* Reads a scene file (YAML 1.1 or JSON; "-" is stdin), its meshes, grids and tracks. All errors
 * are reported through the context's log, one message each with file, line, column, key, value,
 * limit and remedy; the context's error then counts them. */
ASDIC_API asdic_status asdic_mission_load(asdic_context *ctx, const char *path,
                                          asdic_mission **out);
ASDIC_API void asdic_mission_destroy(asdic_mission **mission);

/* What the file describes. Valid until the mission is destroyed. */
ASDIC_API const asdic_environment *asdic_mission_environment(const asdic_mission *mission);
ASDIC_API const asdic_sonar *asdic_mission_sonar(const asdic_mission *mission);
ASDIC_API const asdic_scene *asdic_mission_scene(const asdic_mission *mission);
ASDIC_API asdic_sampling *asdic_mission_sampling(asdic_mission *mission); /* may be changed */
ASDIC_API size_t asdic_mission_ping_count(const asdic_mission *mission);

/* Pose and time of ping INDEX; INDEX < ping_count. */
ASDIC_API asdic_pose asdic_mission_pose(const asdic_mission *mission, size_t index,
                                        double *time_s);

/* JSON Schema (draft 7) of the scene file, from the table that reads it. Static text is built
 * once per call; the caller frees it with free(). NULL when memory is short. */
ASDIC_API char *asdic_mission_schema(void);

typedef struct asdic_run_progress {
    size_t pings_done, pings_total;
    uint64_t rays;
    double elapsed_s;
} asdic_run_progress;

typedef struct asdic_run_options {
    const char *folder;   /* output folder, created */
    bool force, resume;   /* overwrite, or continue */
    size_t first, count;  /* pings to run; count SIZE_MAX: to the end */
    void (*progress)(void *user, const asdic_run_progress *progress); /* may be NULL */
    void *user;
} asdic_run_options;

ASDIC_API asdic_run_options asdic_run_options_default(void);

/* Runs pings on the given devices and writes the run folder. */
ASDIC_API asdic_status asdic_mission_run(asdic_context *ctx, asdic_mission *mission,
                                         asdic_device **devices, size_t device_count,
                                         const asdic_run_options *options);

#ifdef __cplusplus
}
#endif

#endif
