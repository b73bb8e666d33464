#include "run_picture.h"

#include "base/context.h"
#include "out/digits.h"
#include "out/draw.h"
#include "run_facts.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>

/* Where the sampling's error may be taken for structure of the sea floor. */
static void add_error(asdic_render *r) {
    char error_db[ASDIC_DIGITS_SIZE];
    double rms_db = r->summary->statistics.errors.rms_db;
    size_t used = strlen(r->note);
    if (rms_db > ASDIC_ROUGH_DB) {
        asdic_digits_print(error_db, "%.1f", rms_db);
        snprintf(r->note + used, sizeof r->note - used,
                 "  \u00b7  stated error %s dB r.m.s.: take more rays", error_db);
    }
}

/* Subtitle and note of every picture, and the text chunks in its file. */
void asdic_render_describe(asdic_render *r) {
    char rays[ASDIC_DIGITS_SIZE];
    const asdic_sampling *sampling = &r->info.sampling;
    asdic_picture_subtitle(r->info.sonar, r->run->facts.bin_length_m, r->facts);
    asdic_digits_grouped(rays, sampling->rays);
    if (sampling->coherent) { /* which draw no rays */
        snprintf(r->note, sizeof r->note, "coherent, about %s scatterers a ping", rays);
    } else {
        snprintf(r->note, sizeof r->note, "%s rays a ping, %s sampling", rays,
                 asdic_run_sampler_name(sampling->sampler));
    }
    size_t used = strlen(r->note);
    snprintf(r->note + used, sizeof r->note - used, ", seed %llu",
             (unsigned long long)sampling->seed);
    add_error(r);
    asdic_digits_natural(r->seed, sampling->seed);
    asdic_digits_print(r->low, "%g", r->options.db_low);
    asdic_digits_print(r->high, "%g", r->options.db_high);
    asdic_draw_gain(r->gain, r->options.tvg_db_per_decade, r->options.tvg_db_per_m);
    const char *texts[] = {"Software",     "asdic",
                           "version",      r->run->facts.version,
                           "scene",        r->info.scene_name,
                           "scene_sha256", r->info.scene_hash,
                           "seed",         r->seed,
                           "db_low",       r->low,
                           "db_high",      r->high,
                           "colormap",     asdic_colormap_name(r->options.colormap),
                           "gain",         r->gain,
                           "Description",  r->facts};
    _Static_assert(sizeof texts + 5 * sizeof *texts <= sizeof r->texts, "room for one more text");
    memcpy(r->texts, texts, sizeof texts);
}

void asdic_render_note_ascope(const asdic_render *r, bool has_expected,
                              char note[ASDIC_ASCOPE_NOTE_SIZE]) {
    const bool *has = r->summary->statistics.has;
    const char *parts = has[ASDIC_OBJECT] && has[ASDIC_MULTIPATH] ? "; object, multipath: simulated"
                        : has[ASDIC_OBJECT]                       ? "; object: simulated"
                        : has[ASDIC_MULTIPATH]                    ? "; multipath: simulated"
                                                                  : "";
    snprintf(note, ASDIC_ASCOPE_NOTE_SIZE, "%s  \u00b7  %s%s", r->note,
             !has_expected ? "no expected curve: the bottom is a mesh or grid; all curves are "
                             "simulated"
             : strcmp(r->run->facts.bottom, ASDIC_RUN_BOTTOM_NONE) == 0
                 ? "expected: no bottom, no objects, by quadrature"
                 : "expected: flat bottom, no objects, by quadrature",
             has_expected ? parts : "");
}

asdic_picture_options asdic_render_picture(asdic_render *r, const char *title, const char *key,
                                           const char *value) {
    size_t i = 0;
    snprintf(r->heading, sizeof r->heading, "%s\n%s", title, r->facts);
    while (r->texts[i] && strcmp(r->texts[i], "Title") != 0) {
        i += 2;
    }
    r->texts[i] = "Title";
    r->texts[i + 1] = title;
    r->texts[i + 2] = key;
    r->texts[i + 3] = value;
    return (asdic_picture_options){.db_low = r->options.db_low,
                                   .db_high = r->options.db_high,
                                   .colormap = r->options.colormap,
                                   .tvg_db_per_decade = r->options.tvg_db_per_decade,
                                   .tvg_db_per_m = r->options.tvg_db_per_m,
                                   .title = r->heading,
                                   .note = r->note,
                                   .texts = r->texts,
                                   .format = r->options.format};
}

asdic_file_name asdic_render_path(const asdic_render *r, const char *stem, const char *name) {
    static const char *const extensions[] = {[ASDIC_PICTURE_BY_NAME] = "png",
                                             [ASDIC_PICTURE_PNG] = "png",
                                             [ASDIC_PICTURE_PDF] = "pdf",
                                             [ASDIC_PICTURE_SVG] = "svg"};
    const char *chosen = r->options.path;
    if (chosen) {
        asdic_file_name out;
        snprintf(out.text, sizeof out.text, "%s", strcmp(chosen, "-") ? chosen : "/dev/stdout");
        return out;
    }
    char own[ASDIC_NAME_SIZE + 32];
    bool is_raw = strcmp(stem, "raw_") == 0;
    snprintf(own, sizeof own, "%s%s.%s", stem, name,
             is_raw ? "png" : extensions[r->options.format]);
    /* A beam's name may hold any character: those that are not plain become underscores. */
    for (char *c = own + strlen(stem); *c; c++) {
        bool is_plain = isalnum((unsigned char)*c) || strchr("._-", *c) || (*c & 0x80);
        *c = is_plain ? *c : '_';
    }
    return asdic_file_in(r->run->folder, own);
}
