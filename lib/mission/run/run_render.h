/*
 * Drawing a run: what its pictures share.
 */
#ifndef ASDIC_MISSION_RUN_RENDER_H
#define ASDIC_MISSION_RUN_RENDER_H

#include "run_summary.h"
#include "run_open.h"

/* At most this many beams get a panel of an A-scope. */
#define ASDIC_RENDER_PANELS 4

#define ASDIC_RENDER_TEXTS 24

typedef struct asdic_render {
    asdic_context *ctx;
    asdic_run *run;
    asdic_run_info info;
    asdic_summary_plan plan;
    const asdic_summary *summary; /* of PLAN */
    asdic_render_options options; /* window resolved */
    bool has_window;              /* it was asked for */
    unsigned images;
    char note[256], seed[32], low[32], high[32], gain[96];
    const char *texts[ASDIC_RENDER_TEXTS]; /* key, value, ... of every picture */
} asdic_render;

/* As asdic_run_render with DIGEST, what was gathered while the run's pings came; NULL: from the folder. */
asdic_status asdic_run_render_summary(asdic_context *ctx, const char *folder,
                                      const asdic_render_options *options,
                                      const asdic_summary *summary);

/* Fills note and texts from the options; to be repeated in a copy. */
void asdic_render_describe(asdic_render *render);

/* Options of one picture, with TITLE and two more text chunks: KEY and VALUE. */
asdic_picture_options asdic_render_picture(asdic_render *render, const char *title, const char *key,
                                           const char *value);

/* Where to write the picture STEM NAME; freed with free(). */
char *asdic_render_path(const asdic_render *render, const char *stem, const char *name);

/* Those that show many pings: waterfalls, raw ones, overview, chart. */
asdic_status asdic_render_many(asdic_render *render);
asdic_status asdic_render_ascope(const asdic_render *render, const asdic_record *record);
asdic_status asdic_render_fan(asdic_render *render, const asdic_record *record);

asdic_status asdic_render_chart(asdic_render *render);

/* Whether the beams make a fan: three or more, aimed at ascending bearings. */
bool asdic_render_has_fan(const asdic_sonar *sonar);

#endif
