/*
 * run.json: what was run, and how it went.
 */
#ifndef ASDIC_MISSION_RUN_FACTS_H
#define ASDIC_MISSION_RUN_FACTS_H

#include "base/arena.h"
#include "out/file.h"

#include <asdic/mission.h>
#include <asdic/plan.h>
#include <asdic/run.h>
#include <stddef.h>

/* States of a run: interrupted runs are valid but not whole. */
#define ASDIC_RUN_RUNNING "running"
#define ASDIC_RUN_STOPPED "interrupted"
#define ASDIC_RUN_COMPLETE "complete"

#define ASDIC_RUN_BOTTOM_PLANE "plane"
#define ASDIC_RUN_BOTTOM_MESH "mesh"
#define ASDIC_RUN_BOTTOM_NONE "none"

struct asdic_statistics;

/* A file of the run, as it was when run.json was written. */
#define ASDIC_RUN_FILES 16
typedef struct asdic_run_file {
    char name[32];
    asdic_sum sum;
} asdic_run_file;

/* What elements.npy leaves to be said, the wavelength where the mission begins; 0: there is no such file. */
typedef struct asdic_run_elements {
    double spacing_m, sample_m, wavelength_m;
} asdic_run_elements;

/* Strings are borrowed: from the mission while running, from an arena when read. */
typedef struct asdic_run_facts {
    const char *version; /* of asdic */
    const char *state;   /* ASDIC_RUN_... */
    const char *scene_path, *scene_hash, *scene_text;
    const char
        *geometry_hash; /* of the triangles: meshes may change while the scene file does not */
    bool has_surface;
    const char *bottom; /* ASDIC_RUN_BOTTOM_... */
    asdic_material bottom_law, surface_law;
    asdic_uncertainty uncertainty; /* written, and read again where it stands */
    asdic_sampling sampling;
    asdic_refraction refraction;     /* the form that rays followed ... */
    double layer_from_m, layer_to_m; /* ... and where one layer was fitted */
    asdic_remarks remarks;           /* on the laws that were used */
    asdic_plan plan;                 /* of the whole mission, whatever part of it this run is */
    size_t first_ping, pings_planned, pings;
    size_t whole_first_ping, whole_pings; /* that these are a part of, or they themselves */
    size_t beams, bins;
    double bin_length_m;
    asdic_run_elements elements;
    asdic_sweep sweep; /* not read back: it is in the scene's text */
    const char **devices;
    size_t device_count;
    uint64_t rays_traced, saturated;
    asdic_run_times times; /* of the last call that worked on the run */
    double rays_per_s;
    asdic_run_errors errors;               /* NAN: no ping yet, or a run that says no such figure */
    asdic_run_file files[ASDIC_RUN_FILES]; /* beside pings.npy, whose records have their own sums */
    size_t file_count;
    const char **pictures; /* names; `render` may have drawn them anew since */
    size_t picture_count;
} asdic_run_facts;

asdic_status asdic_run_facts_write(asdic_context *ctx, const char *folder,
                                   const asdic_run_facts *facts);

/* Where TEXT, a run.json, states the sum of what stands before it, sets that right. */
void asdic_run_facts_sign(char *text, size_t length);

/* Lists DEVICE, unless it is listed; its name is ARENA's then. False when memory is short. */
bool asdic_run_facts_add_device(asdic_run_facts *facts, asdic_arena *arena, const char *device);

/* Fills in the figures of STATISTICS, which must be ended. */
void asdic_run_facts_statistics(asdic_run_facts *facts, const struct asdic_statistics *statistics);

/* ASDIC_ERROR_INPUT when there is no run.json or it is not one. */
asdic_status asdic_run_facts_read(asdic_context *ctx, const char *folder, asdic_arena *arena,
                                  asdic_run_facts *facts);

/* The first property that must be the same to continue or to join two runs and is not; NULL when
 * there is none. */
const char *asdic_run_facts_differ(const asdic_run_facts *a, const asdic_run_facts *b);

/* Names as scene files write them. */
const char *asdic_run_sampler_name(asdic_sampler sampler);

/* --- words and keys of run.json, which is written and read by them --- */

/* Components whose laws may state how far they err. */
typedef struct asdic_run_uncertain_key {
    const char *name;
    asdic_component component;
} asdic_run_uncertain_key;

#define ASDIC_RUN_TIME_COUNT 7
#define ASDIC_RUN_UNCERTAIN_COUNT 3
#define ASDIC_RUN_SAMPLER_COUNT (ASDIC_SAMPLER_UNIFORM_SPHERE + 1)
#define ASDIC_RUN_MULTIPATH_COUNT (ASDIC_MULTIPATH_BOUNDARIES + 1)
extern const char *const asdic_run_sampler_names[ASDIC_RUN_SAMPLER_COUNT];
extern const char *const asdic_run_multipath_names[ASDIC_RUN_MULTIPATH_COUNT];
extern const char *const asdic_run_time_names[ASDIC_RUN_TIME_COUNT];
extern const asdic_run_uncertain_key asdic_run_uncertain_keys[ASDIC_RUN_UNCERTAIN_COUNT];

/* The time that has the name INDEX. */
double *asdic_run_time(asdic_run_times *times, size_t index);

/* Whether TEXT, a run.json, states the sum of what stands before it. */
bool asdic_run_facts_signed(char *text, size_t length);

#endif
