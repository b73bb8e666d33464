/*
 * What a scene file says without its geometry: water, sonar, sampling, detector, output. It can be
 * read from the text that a run folder keeps, where meshes and tracks may be gone.
 */
#ifndef ASDIC_MISSION_MISSION_SETTINGS_H
#define ASDIC_MISSION_MISSION_SETTINGS_H

#include "out/record.h"

#include <asdic/mission.h>

struct asdic_scene_file;

typedef struct asdic_settings {
    asdic_environment environment;
    asdic_beam *receivers;
    asdic_sonar sonar; /* borrows receivers */
    asdic_sweep sweep;
    asdic_sampling sampling;
    asdic_rays_over rays_over;
    uint32_t auto_rays;   /* what `rays: auto` came to; 0: the file gives a number */
    bool keeps_all_terms; /* whatever the plan says */
    int refraction;       /* as asked for: asdic_refraction, or negative: as planned */
    asdic_detector detector;
    asdic_output_options output;
    bool has_source_level;     /* the file gives one */
    bool leaves_csv_out;       /* because of its large pings: the file does not say which CSV */
    asdic_record_form records; /* in pings.npy */
    bool elements;             /* elements.npy */
} asdic_settings;

/* What FILE says. OUT is to be finished in any case. */
asdic_status asdic_settings_take(asdic_context *ctx, const struct asdic_scene_file *file,
                                 asdic_settings *out);

/* From a scene file's TEXT, which errors call NAME. */
asdic_status asdic_settings_read(asdic_context *ctx, const char *name, const char *text,
                                 asdic_settings *out);

/* Says what a format that they ask for lacks to be written here, and how to get that; false: nothing. */
bool asdic_settings_lack(const asdic_settings *settings, char text[ASDIC_REMARK_SIZE]);

/* Whether the rays are still those that asdic chose. */
static inline bool asdic_settings_rays_are_auto(const asdic_settings *s) {
    return s->sampling.rays == s->auto_rays;
}

/* Safe on zeros. */
void asdic_settings_finish(asdic_settings *settings);

#endif
