/*
 * The pictures of a run, and what they share: options, notes, names of files.
 */
#ifndef ASDIC_MISSION_RUN_PICTURE_H
#define ASDIC_MISSION_RUN_PICTURE_H

#include "base/file_name.h"
#include "run_footprint.h"
#include "run_open.h"
#include "run_summary.h"
#include "sim/ring_shelf.h"

/* At most this many beams get a panel of an A-scope. */
#define ASDIC_RENDER_PANELS 4

#define ASDIC_RENDER_TEXTS 28

typedef struct asdic_render {
    asdic_context *ctx;
    asdic_run *run;
    asdic_run_info info;
    asdic_summary_plan plan;
    const asdic_summary *summary; /* of PLAN */
    asdic_render_options options; /* window resolved */
    bool has_window;              /* the options give one */
    double residual_db;           /* height of the A-scopes' last panel; NAN: not known yet */
    asdic_ring_shelf *shelf;      /* of what A-scopes expect */
    unsigned images;
    bool (*frame)(void *user, const char *path); /* of every ping; NULL: pictures, no frames */
    void *frame_user;
    char facts[ASDIC_SUBTITLE_SIZE]; /* the subtitle */
    char heading[512];               /* title and subtitle */
    char note[256], seed[32], low[32], high[32], gain[96];
    const char *texts[ASDIC_RENDER_TEXTS]; /* key, value, ... of every picture */
} asdic_render;

/* Fills note and texts from the options. A copy of RENDER must be described again. */
void asdic_render_describe(asdic_render *render);

#define ASDIC_ASCOPE_NOTE_SIZE 384

/* The note of an A-scope: which of its curves are expected ones, if any, and which are simulated. */
void asdic_render_note_ascope(const asdic_render *render, bool has_expected,
                              char note[ASDIC_ASCOPE_NOTE_SIZE]);

#define ASDIC_CHART_NOTE_SIZE 640

/* The note of a plan with COUNT AREAS of beams at PLACES: on what bottom they lie, and whether any is dashed. */
void asdic_render_note_chart(const asdic_render *render, const asdic_seafloor *ground,
                             const char *places, const asdic_chart_area *areas, size_t count,
                             char note[ASDIC_CHART_NOTE_SIZE]);

/* Options of one picture, with TITLE and two more text chunks: KEY and VALUE. */
asdic_picture_options asdic_render_picture(asdic_render *render, const char *title, const char *key,
                                           const char *value);

/* The path of the picture STEM NAME. */
asdic_file_name asdic_render_path(const asdic_render *render, const char *stem, const char *name);

/* Whether there is a fan picture: of beams that make a fan (out/raster.h), of those in an upright plane
 * (run_section.h), or of a head that scans. */
bool asdic_render_can_fan(const asdic_settings *settings);

/* run_render_waterfall.c: all pings of a beam; its bins one to one; the strongest of all beams. */
asdic_status asdic_render_waterfalls(asdic_render *render);
asdic_status asdic_render_raw(asdic_render *render);
asdic_status asdic_render_overview(const asdic_render *render);

/* run_render_ping.c: one ping. */
asdic_status asdic_render_ascope(asdic_render *render, const asdic_record *record);
/* Lets all A-scopes have the scale of differences that RECORD's has, as that of the first one drawn else is. */
asdic_status asdic_render_scale_ascopes(asdic_render *render, const asdic_record *record);
asdic_status asdic_render_fan(asdic_render *render, const asdic_record *record);

/* run_render_chart.c: the mission from above. */
asdic_status asdic_render_chart(asdic_render *render);

/* As asdic_run_render with SUMMARY, made while the run's pings came; NULL: made
 * from the folder. */
asdic_status asdic_run_render_summary(asdic_context *ctx, const char *folder,
                                      const asdic_render_options *options,
                                      const asdic_summary *summary);

#endif
