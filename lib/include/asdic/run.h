/*
 * A run folder: what a mission left behind, read ping by ping, drawn and joined.
 *
 * pings.npy holds everything in binary, one structured record per ping (numpy.load reads it);
 * bins.csv says the same in text; run.json describes the run and keeps the scene file's text.
 */
#ifndef ASDIC_RUN_H
#define ASDIC_RUN_H

#include <asdic/mission.h>
#include <asdic/output.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct asdic_run asdic_run;

typedef struct asdic_run_info {
    size_t first_ping;    /* of the mission; pings count from there */
    size_t pings;         /* that are there */
    size_t pings_planned; /* fewer are there when the run was stopped */
    size_t beams, bins;
    const asdic_sonar *sonar; /* beam names and aims; borrowed from the run */
    const asdic_environment *environment;
    const asdic_detector *detector; /* of the scene */
    asdic_sampling sampling;
    bool has_surface;
    asdic_material bottom;               /* of its law, see asdic/law.h */
    const char *scene_name, *scene_hash; /* borrowed */
    asdic_uncertainty uncertainty;       /* of its scattering laws */
} asdic_run_info;

/* One ping of a run, in dB re 1 uPa; NAN where there is no energy. */
typedef struct asdic_record {
    uint64_t ping; /* number in the mission */
    double time_s;
    asdic_pose pose;   /* of the sonar: the vehicle's, with a scanned head turned */
    double altitude_m; /* above the bottom straight below; INFINITY where there is none */
    uint64_t rays, saturated;
    const float *level_db[ASDIC_COMPONENT_COUNT]; /* [beam * bins + bin] */
    const float *stderr_db;
    asdic_ping_truth truth; /* NULLs in a run without `output: {truth: true}` */
} asdic_record;

/* ASDIC_ERROR_INPUT when FOLDER is not a run folder, or one that was damaged. */
ASDIC_API asdic_status asdic_run_open(asdic_context *ctx, const char *folder, asdic_run **out);
ASDIC_API void asdic_run_close(asdic_run **run);
ASDIC_API asdic_run_info asdic_run_get_info(const asdic_run *run);

/* The errors that all bins of a run state together, dB; NAN where it says none. */
typedef struct asdic_run_errors {
    double median_db, worst_db;
    double rms_db; /* of the bins whose echo is above the noise */
} asdic_run_errors;

ASDIC_API asdic_run_errors asdic_run_get_errors(const asdic_run *run);
/* What a run of PING alone would state. */
ASDIC_API asdic_status asdic_ping_get_errors(asdic_context *ctx, const asdic_ping *ping,
                                             asdic_run_errors *out);

/* Record INDEX, counted from 0 within the folder. RECORD's arrays are valid until the next read. */
ASDIC_API asdic_status asdic_run_read(asdic_run *run, size_t index, asdic_record *record);

/* The flat scene below a ping's vehicle, as asdic_expected_compute wants it. */
ASDIC_API asdic_flat_scene asdic_run_flat_scene(const asdic_run *run, const asdic_record *record);

typedef struct asdic_render_options {
    unsigned images;        /* 1u << ASDIC_IMAGE_...; 0: those the scene asks for */
    double db_low, db_high; /* NAN: from the run, rounded to 10 dB */
    asdic_colormap colormap;
    double tvg_db_per_decade, tvg_db_per_m;
    const char *beam; /* NULL: those a report would show */
    size_t ping;      /* in the mission; SIZE_MAX: first (of a scan: first turn's end) and last */
    bool raw;         /* 16-bit grey waterfalls as well, one pixel per bin */
    asdic_picture_format format; /* of all but raw ones; by name: PNG */
    /* NULL: into the folder. Else the one picture there is to draw goes there, "-" being the
     * standard output; ASDIC_ERROR_ARGUMENT when there are several. */
    const char *path;
} asdic_render_options;

/* The pictures and the ping that the scene asks for, in viridis, the window from the run. */
ASDIC_API asdic_render_options asdic_render_options_default(void);

/* Draws a run's pictures into its folder: waterfall_<beam>.png, ascope_<ping>.png,
 * fan_<ping>.png, overview.png, plan.png, raw_<beam>.png. */
ASDIC_API asdic_status asdic_run_render(asdic_context *ctx, const char *folder,
                                        const asdic_render_options *options);

/* Takes the frame at PATH; false ends the frames. */
typedef bool (*asdic_frame)(void *user, const char *path);

/* Draws one picture of every ping, all of one size: the fan, or the A-scope if OPTIONS->images is
 * that. Each goes to OPTIONS->path in the place of the one before, and FRAME is called with that
 * path; it returns false to stop, which is no error here. OPTIONS->ping is not read. */
ASDIC_API asdic_status asdic_run_render_frames(asdic_context *ctx, const char *folder,
                                               const asdic_render_options *options,
                                               asdic_frame frame, void *user);

/* Lays the fans of all pings on one map, north up, into the PNG file OPTIONS->path, and beside it
 * the world file .pgw, which GIS programs place it by (x east, y north, metres). A cell of CELL_M
 * (0: as long as a bin, or larger) has the mean intensity of the pings that saw it, white where
 * none did. Places are taken to lie as deep as the run's terrain or its flat bottom, and rays to be
 * straight and as fast as at the sonar. Levels have the gain that OPTIONS give, else 30 log r +
 * 2 alpha r. */
ASDIC_API asdic_status asdic_run_mosaic(asdic_context *ctx, const char *folder, double cell_m,
                                        const asdic_render_options *options);

/* Joins runs of consecutive parts of one mission, given in any order, into OUT_FOLDER: the same
 * bytes (but run.json's times) as one run of all. ASDIC_ERROR_INPUT when they are of different
 * missions, leave gaps, or lack pings that one of them is a part of (asdic_run_options),
 * ASDIC_ERROR_EXISTS when OUT_FOLDER holds a run and FORCE is false. */
ASDIC_API asdic_status asdic_run_merge(asdic_context *ctx, const char *const *folders, size_t count,
                                       const char *out_folder, bool force);

#ifdef __cplusplus
}
#endif

#endif
