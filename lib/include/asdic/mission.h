/*
 * A mission: everything a scene file says, and running it ping by ping into a run folder.
 */
#ifndef ASDIC_MISSION_H
#define ASDIC_MISSION_H

#include <asdic/expected.h>
#include <asdic/plan.h>
#include <asdic/scan.h>
#include <asdic/sweep.h>
#include <asdic/team.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_mission asdic_mission;

/* Reads a scene file (YAML 1.1 or JSON; "-" is stdin), its meshes, grids and tracks. All errors
 * are reported through the context's log, one message each with file, line, column, key, value,
 * limit and remedy; the context's error then counts them: ASDIC_ERROR_INPUT. */
ASDIC_API asdic_status asdic_mission_load(asdic_context *ctx, const char *path,
                                          asdic_mission **out);

/* A value of a scene file by its path, as error messages print paths. */
typedef struct asdic_setting {
    const char *key;   /* "sonar.receivers[0].pitch_deg" */
    const char *value; /* a number, a word, a list or map: "[0, 1]", "{preset: steel}" */
} asdic_setting;

/* The same with SETTINGS in place of what the file says, one after the other, but first the wholes
 * `sonar` and `environment`, what names a file, and the salinity that a cast is read by; keys that
 * it lacks are added, entries of lists must be there. Such a mission is for asdic_roc_compute and
 * the like: asdic_mission_run refuses it, since a run's folder keeps the file's text. */
ASDIC_API asdic_status asdic_mission_load_with(asdic_context *ctx, const char *path,
                                               const asdic_setting *settings, size_t count,
                                               asdic_mission **out);

/* Which run of a trial is drawn. */
typedef struct asdic_draw {
    uint64_t seed, run;
} asdic_draw;

/* The mission of one run of the scene's `trial` section: what `draws` say is drawn at random, from
 * DRAW alone, and stands in place of what the file says. Text and hash of such a mission are those
 * of the scene as drawn, without `trial`, so that it is run and kept like any other (paths in it
 * stay relative to the file). SETTINGS, COUNT of them, are put over both, but for what is drawn of
 * their parts. Without a `trial` section every run is the scene itself.
 *
 *     for (draw.run = 0; draw.run < runs; draw.run++) {
 *         asdic_mission_load_run(ctx, "scene.yaml", NULL, 0, &draw, &mission);
 *         ... asdic_mission_run(ctx, mission, ...), asdic_mission_drawn(mission, i) ...
 *         asdic_mission_destroy(&mission);
 *     } */
ASDIC_API asdic_status asdic_mission_load_run(asdic_context *ctx, const char *path,
                                              const asdic_setting *settings, size_t count,
                                              const asdic_draw *draw, asdic_mission **out);

/* Reports what is wrong with the files that choices of MISSION's draws name, each opened once and
 * none kept, as asdic_mission_load does of those that the scene itself names. */
ASDIC_API asdic_status asdic_mission_check_draws(asdic_context *ctx, const asdic_mission *mission);

/* A mesh in memory, by the name that a scene gives in place of a file's. World axes, metres: the
 * scene's scale and z_up are not read. */
typedef struct asdic_named_mesh {
    const char *name;
    const asdic_mesh *mesh; /* copied */
} asdic_named_mesh;

/* A scene in memory. NAME stands for its path: files that it names are relative to that folder. */
typedef struct asdic_scene_text {
    const char *text; /* as in a scene file: YAML 1.1 or JSON */
    size_t length;    /* bytes of it */
    const char *name;
    const asdic_named_mesh *meshes;
    size_t mesh_count;
} asdic_scene_text;

/* asdic_mission_load of a scene in memory. Its runs keep the text, not the meshes: who reads such a
 * run, asdic_run_detect for one, does without the scene. */
ASDIC_API asdic_status asdic_mission_load_text(asdic_context *ctx, const asdic_scene_text *scene,
                                               asdic_mission **out);
ASDIC_API void asdic_mission_destroy(asdic_mission **mission);

/* What was drawn, key by key; a list's entry that was left out is `none`, and what belongs to it is
 * empty. A key and value of NULL behind the last. */
ASDIC_API asdic_setting asdic_mission_drawn(const asdic_mission *mission, size_t index);

/* What the file describes. Valid until the mission is destroyed. */
ASDIC_API const asdic_environment *asdic_mission_environment(const asdic_mission *mission);
ASDIC_API const asdic_sonar *asdic_mission_sonar(const asdic_mission *mission);
ASDIC_API const asdic_scene *asdic_mission_scene(const asdic_mission *mission);
ASDIC_API asdic_sampling *asdic_mission_sampling(asdic_mission *mission); /* may be changed */
ASDIC_API size_t asdic_mission_ping_count(const asdic_mission *mission);

typedef enum asdic_csv_form { ASDIC_CSV_LONG, ASDIC_CSV_WIDE, ASDIC_CSV_NONE } asdic_csv_form;

/* Places of bits in asdic_output_options.images. */
typedef enum asdic_image {
    ASDIC_IMAGE_WATERFALL, /* a beam's levels over range and time */
    ASDIC_IMAGE_ASCOPE,    /* a ping's levels over range, simulated against expected */
    ASDIC_IMAGE_FAN,       /* a ping's levels over range and bearing */
    ASDIC_IMAGE_OVERVIEW,  /* the strongest level of each ping and beam, and its range */
    ASDIC_IMAGE_PLAN       /* the mission from above */
} asdic_image;

/* "waterfall" and the like, as a scene file's output.images; NULL when out of range. */
ASDIC_API const char *asdic_image_name(asdic_image image);

/* A format in which a run is written beside its tables: "npy", "netcdf" and so on, the key of a
 * scene file's output; NULL behind the last. */
ASDIC_API const char *asdic_format_name(size_t index);

typedef struct asdic_output_options {
    asdic_csv_form csv;
    unsigned formats; /* 1u << place of asdic_format_name */
    unsigned images;  /* 1u << ASDIC_IMAGE_... */
} asdic_output_options;

/* What the file asks of detectors and of runs. Valid until the mission is destroyed. */
ASDIC_API const asdic_detector *asdic_mission_detector(const asdic_mission *mission);
ASDIC_API const asdic_output_options *asdic_mission_output(const asdic_mission *mission);

/* The name of the scene in the file PATH: its last part without extension, with '_' for each byte
 * that is no text in UTF-8, or "scene" for "-", the standard input. To be freed with free(); NULL
 * when memory is short. */
ASDIC_API char *asdic_scene_name(const char *path);

/* Whether the file PATH is SCENE, or one that a value of that scene file names: what is written
 * there would be lost to the next who reads the scene. */
ASDIC_API bool asdic_scene_reads(const char *scene, const char *path);

/* Where the mission came from: the path as given, the text in UTF-8, and the SHA-256 of the file's
 * bytes in hexadecimal. */
ASDIC_API const char *asdic_mission_path(const asdic_mission *mission);
ASDIC_API const char *asdic_mission_text(const asdic_mission *mission);
ASDIC_API const char *asdic_mission_hash(const asdic_mission *mission);

/* An object, or the bottom, as it was read: its name ("" of the bottom), its geometry in its own
 * frame (no triangles: a point), where that was put, and the box round it there. */
typedef struct asdic_mission_object {
    char name[ASDIC_NAME_SIZE];
    asdic_mesh_info mesh;
    asdic_pose pose;
    asdic_vec3 min_m, max_m; /* world */
    asdic_material material;
    bool moves; /* along a track of its own; pose and box are those of the first ping */
} asdic_mission_object;

/* Objects in the order of the file; a bottom from a mesh or grid comes before them. */
ASDIC_API size_t asdic_mission_object_count(const asdic_mission *mission);
ASDIC_API const asdic_mission_object *asdic_mission_get_object(const asdic_mission *mission,
                                                               size_t index);

/* The flat scene that ping INDEX would see without objects: the bottom at its height straight below
 * the vehicle. */
ASDIC_API asdic_flat_scene asdic_mission_flat_scene(const asdic_mission *mission, size_t index);

/* Depth of the highest bottom at POSITION's north and east; INFINITY where there is none. */
ASDIC_API double asdic_mission_bottom_m(const asdic_scene *scene, asdic_vec3 position_m);

/* Pose of the sonar and time at ping INDEX; INDEX < ping_count. TIME_S may be NULL. */
ASDIC_API asdic_pose asdic_mission_pose(const asdic_mission *mission, size_t index, double *time_s);

/* How often simulating COUNT pings from FIRST on, or those that there are, learns where rays
 * matter. */
ASDIC_API size_t asdic_mission_lessons(const asdic_mission *mission, size_t first, size_t count);

/* How a scanned sonar's head turns; and the vehicle's pose, in which the head is not turned. The
 * same as asdic_mission_pose where nothing scans. */
ASDIC_API asdic_sweep asdic_mission_sweep(const asdic_mission *mission);
ASDIC_API asdic_pose asdic_mission_vehicle_pose(const asdic_mission *mission, size_t index,
                                                double *time_s);

/* Moves SIMULATOR's objects to where those that move are at ping INDEX, on the clock of the pings'
 * times. Before a ping, and before learning for one; does nothing where nothing moves. */
ASDIC_API asdic_status asdic_mission_place(const asdic_mission *mission, asdic_simulator *simulator,
                                           size_t index);

/* The pose of object OBJECT (as in asdic_mission_get_object) at ping INDEX. */
ASDIC_API asdic_pose asdic_mission_object_pose(const asdic_mission *mission, size_t object,
                                               size_t index);

/* What may be tried while a mission is flown, without another scene file. */
typedef struct asdic_choices {
    double wind_speed_kn;   /* 0..60 */
    asdic_material bottom;  /* of every bottom, not of objects; without a law where there is none */
    double source_level_db; /* dB re 1 uPa at 1 m */
    uint32_t rays;          /* 64..2^28 */
    uint64_t seed;
} asdic_choices;

/* As the file says, or as they were chosen last. */
ASDIC_API asdic_choices asdic_mission_get_choices(const asdic_mission *mission);

/* Changes the mission; simulators that are created afterwards follow, others stay as they are.
 * Nothing may work with the mission meanwhile. While more than rays and seed differ from
 * the file's, asdic_mission_run refuses it, since a run's folder keeps the file's text: run what
 * asdic_mission_write_scene writes. ASDIC_ERROR_ARGUMENT when a choice is out of range: nothing has
 * changed then. */
ASDIC_API asdic_status asdic_mission_choose(asdic_context *ctx, asdic_mission *mission,
                                            const asdic_choices *choices);

/* Writes a scene file of the mission as chosen, flown along the track file TRACK (relative to
 * PATH's folder), with nothing left out of the model, and refraction as it
 * is now where the scene leaves it to the plan; a layer is fitted anew to the track's depths. Files
 * that the scene names become absolute. */
ASDIC_API asdic_status asdic_mission_write_scene(asdic_context *ctx, const asdic_mission *mission,
                                                 const char *path, const char *track);

/* Writes the vehicle's pose at every ping as a track, CSV as a scene's `track` reads it. */
ASDIC_API asdic_status asdic_mission_write_track(asdic_context *ctx, const asdic_mission *mission,
                                                 const char *path);

/* Laws that a mission uses outside the range that their sources state, then rays too few for its
 * sonar, shadows, meshes that may be of plates or round, and a sonar that is hardly meant, a
 * sentence each: levels are computed all the same, and run.json keeps the sentences. Last a format
 * that cannot be written here, without which no run into a folder begins. Of too many the last
 * laws are missing. */
#define ASDIC_MOST_REMARKS 8
#define ASDIC_REMARK_SIZE 256
typedef struct asdic_remarks {
    size_t count;
    bool lacks_format; /* the last is what asdic_mission_run into a new folder fails with */
    char text[ASDIC_MOST_REMARKS][ASDIC_REMARK_SIZE];
} asdic_remarks;
ASDIC_API asdic_remarks asdic_mission_remarks(const asdic_mission *mission);

/* How far levels may lie from those at sea because of the scattering laws alone, dB either way, as
 * the sources of the laws say; NAN where they do not. Of several objects that with the most. */
typedef struct asdic_uncertainty {
    double db[ASDIC_COMPONENT_COUNT];
} asdic_uncertainty;
ASDIC_API asdic_uncertainty asdic_mission_uncertainty(const asdic_mission *mission);

/* "full", "layer", "off"; NULL when out of range. */
ASDIC_API const char *asdic_refraction_name(asdic_refraction form);

/* Which form of refraction a mission needs: the simplest that changes no level by more than
 * ASDIC_REFRACTION_NEGLIGIBLE_DB. */
#define ASDIC_REFRACTION_NEGLIGIBLE_DB 0.05

typedef struct asdic_refraction_plan {
    asdic_refraction needed;
    double off_db, layer_db;         /* bound on what straight rays, or one layer, change */
    double layer_from_m, layer_to_m; /* depths between which it is fitted; 0, 0: nothing bends */
    char reason[200];
} asdic_refraction_plan;

/* Compares the forms by what is expected, over a flat bottom, at up to five places of the mission:
 * its shallowest and deepest, its first, middle and last; of up to three beams. The bound is 1.25
 * times the largest change of a total level there, noise included where the sonar has it, that no
 * shift of echoes by up to 1/40 of a bin in each form makes up for, or of
 * the echo from the middle of one of up to 32 objects, in the beam that hears it best; INFINITY
 * where a form moves an object out of a shadow, or into one. Echoes over mirrors are not compared:
 * one that begins at a bin's edge comes a bin earlier or later by however little rays bend. */
ASDIC_API asdic_status asdic_mission_refraction(asdic_context *ctx, const asdic_mission *mission,
                                                asdic_refraction_plan *out);

/* Lets the mission's rays follow FORM from here on; a layer is fitted from its shallowest sonar to
 * its deepest bottom, or from 10 m above a sonar that lies on that. */
ASDIC_API void asdic_mission_refract(asdic_mission *mission, asdic_refraction form);

/* Whether its scene leaves the form to asdic_mission_refraction, and asdic_mission_refract was not
 * called. */
ASDIC_API bool asdic_mission_plans_refraction(const asdic_mission *mission);

/* asdic_mission_refract by what asdic_mission_refraction says is needed, where the scene leaves it
 * open; it takes no longer than the choice does. A run begins with it. */
ASDIC_API asdic_status asdic_mission_refract_as_needed(asdic_context *ctx, asdic_mission *mission);

/* Whether the mission's echoes interfere in a way that only coherent pings show: lobes of smooth
 * bodies, a target and its image in the surface (from the first ping's place), side lobes of a
 * shaded array, beams of a line that are cones. REASON, of SIZE bytes, says what. */
ASDIC_API bool asdic_mission_needs_phase(const asdic_mission *mission, char *reason, size_t size);

/* Draws rays of ping INDEX over range and depth, as far as its bins reach. */
ASDIC_API asdic_status asdic_mission_draw_rays(asdic_context *ctx, const asdic_mission *mission,
                                               size_t index, const char *path);

/* What the mission needs, over all its pings; asdic_mission_run follows it. */
ASDIC_API asdic_status asdic_mission_plan(asdic_context *ctx, const asdic_mission *mission,
                                          asdic_plan *out);

/* Bytes that a run writes for every ping: pings.npy, bins.csv (about) and the formats (netCDF
 * before compression). */
ASDIC_API uint64_t asdic_mission_ping_bytes(const asdic_mission *mission);
/* And for a run of PINGS in all, or of all there are where those are fewer; pictures and charts are
 * counted as they usually come out. */
ASDIC_API uint64_t asdic_mission_run_bytes(const asdic_mission *mission, size_t pings);

/* Whether bins.csv is not written because pings are large, the scene not asking for it. */
ASDIC_API bool asdic_mission_leaves_csv_out(const asdic_mission *mission);

/* What is free where FOLDER is, or would be; UINT64_MAX where the system does not tell. */
ASDIC_API uint64_t asdic_disk_free_bytes(const char *folder);
/* "8.4 MB"; returns TEXT. */
#define ASDIC_BYTES_TEXT 32
ASDIC_API const char *asdic_bytes_text(uint64_t bytes, char text[ASDIC_BYTES_TEXT]);

/* How long it takes to write PING, which is of this mission, into a run's files: measured in a
 * temporary folder. */
ASDIC_API asdic_status asdic_mission_time_writing(asdic_context *ctx, const asdic_mission *mission,
                                                  const asdic_ping *ping, double *seconds);

/* JSON Schema (draft 7) of the scene file, from the table that reads it: text that the caller frees
 * with free(). NULL when memory is short. */
ASDIC_API char *asdic_mission_schema(void);

/* What the scene file at PATH says, key by key, as JSON: for a program that goes on from it and
 * hands it to asdic_mission_load_text. *OUT is freed with free(). Syntax alone is judged. */
ASDIC_API asdic_status asdic_mission_file_json(asdic_context *ctx, const char *path, char **out);

/* Stated error, r.m.s., above which ripples of the sampling look like those of sand. */
#define ASDIC_ROUGH_DB 1.0

/* What a mission's rays come to, known without simulating. */
typedef struct asdic_ray_forecast {
    uint32_t rays;      /* per ping, as the mission will run */
    bool is_auto;       /* the scene leaves their number to asdic */
    uint32_t auto_rays; /* what asdic_rays_auto takes for it */
    double stderr_db;   /* stated error to expect, r.m.s.; NAN: none of coherent pings, or by other
                           samplers than the adaptive */
    bool is_rough;      /* that is above ASDIC_ROUGH_DB */
} asdic_ray_forecast;

ASDIC_API asdic_ray_forecast asdic_mission_ray_forecast(const asdic_mission *mission);

/* What the mission's first, middle or last ping takes, the most of them: finds the scatterers,
 * without a device. ASDIC_ERROR_ARGUMENT if pings are of intensities. */
ASDIC_API asdic_status asdic_mission_forecast_coherent(asdic_context *ctx,
                                                       const asdic_mission *mission,
                                                       asdic_coherent_forecast *out);

/* Why a tolerance cannot be kept: a bin's stated error, dB. */
typedef struct asdic_rough_bin {
    size_t ping, beam, bin;
    double stderr_db;
} asdic_rough_bin;

#define ASDIC_ROUGH_BINS 8

/* How exact levels shall be. */
typedef struct asdic_tolerance {
    double stderr_db;   /* one standard error of a bin's level at most this */
    double share;       /* in this share of the bins whose echo is above the noise, 0 to 1 */
    uint32_t most_rays; /* per ping, where the search ends */
} asdic_tolerance;

/* How many rays a tolerance takes. */
typedef struct asdic_ray_budget {
    uint32_t rays;      /* per ping */
    bool is_kept;       /* false: most_rays do not keep the tolerance, or no bin counts */
    size_t pings;       /* looked at, 16 at most: spread over the mission, whatever part is run */
    double worst_db;    /* largest stated error in a bin that counts */
    double ping_s;      /* what the quickest of them took, one device at work and nothing learnt */
    double learn_s;     /* and the quickest learning, once in ASDIC_LEARN_BLOCK pings */
    size_t judged;      /* bins that count; 0: the search ended with the rays it began with */
    size_t rough_count; /* of these, bins above the tolerance */
    asdic_rough_bin rough[ASDIC_ROUGH_BINS]; /* the roughest first; empty when all bins keep it */
} asdic_ray_budget;

/* Doubles the mission's rays until TOLERANCE is kept or its most rays are reached; sets the
 * mission's rays to what it found. The answer depends on the mission and the kind of device alone,
 * so that parts of a mission agree. Rays bend as the mission's do now: where it plans refraction,
 * through all layers. ASDIC_ERROR_ARGUMENT with coherent pings, whose errors are not stated. */
ASDIC_API asdic_status asdic_mission_find_rays(asdic_context *ctx, asdic_mission *mission,
                                               asdic_device *device,
                                               const asdic_tolerance *tolerance,
                                               asdic_ray_budget *out);

typedef struct asdic_run_progress {
    size_t pings_done, pings_total;
    uint64_t rays;
    double elapsed_s;
} asdic_run_progress;

/* Where the time of a call went. Writing and drawing go on while devices work: parts overlap. */
typedef struct asdic_run_times {
    double plan_s;     /* how far rays bend chosen, and which terms are needed */
    double setup_s;    /* from the first ping's start until the first device was ready */
    double simulate_s; /* from then until the last ping was written */
    double devices_s;  /* this process's devices at work on pings, summed over them */
    double write_s;    /* files but pictures */
    double pictures_s; /* what they show gathered, and drawn */
    double whole_s;    /* by the clock */
} asdic_run_times;

typedef struct asdic_run_options {
    const char *folder; /* output folder, created */
    bool force, resume; /* overwrite, or continue: one of them, or neither */
    bool own_track;     /* with FORCE: the scene's track is FOLDER/track.csv, written again alike */
    size_t first, count;       /* pings to run; count SIZE_MAX: to the end */
    size_t of_first, of_count; /* that they are a part of, joined by no less; of_count 0: none */
    asdic_team *team;          /* the processes that share the work; NULL: this one alone */
    void (*progress)(void *user, const asdic_run_progress *progress); /* may be NULL */
    void *user;
    asdic_run_times *times; /* filled when a run is complete; may be NULL */
} asdic_run_options;

/* All pings; no folder, which must be given; neither force nor resume; by this process alone. */
ASDIC_API asdic_run_options asdic_run_options_default(void);

/* Runs pings on the given devices and writes the run folder. In a team, all processes call it with
 * the same mission and the same pings: process 0 writes, the others return when it is done with
 * them. ASDIC_ERROR_ARGUMENT: the mission has no such pings, or both force and resume are set;
 * ASDIC_ERROR_IO: without force, also where the disk has too little room; ASDIC_ERROR_EXISTS: the
 * folder holds a run, and neither force nor resume was asked for, or one of another scene or
 * sampling, which cannot be resumed, or a file that the scene reads, of a name that a run writes
 * there; ASDIC_ERROR_INPUT: what it says of its run is damaged, or a ping is below the bottom;
 * ASDIC_ERROR_INTERRUPTED: what is written is valid. */
ASDIC_API asdic_status asdic_mission_run(asdic_context *ctx, asdic_mission *mission,
                                         asdic_device **devices, size_t device_count,
                                         const asdic_run_options *options);

#ifdef __cplusplus
}
#endif

#endif
