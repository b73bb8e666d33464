/*
 * Formats of a run's levels beside its tables. A format is a file, format_NAME.c, that defines its
 * row asdic_format_NAME and the scene key's text asdic_format_doc_NAME, and a line in meson.build,
 * which makes ASDIC_FORMATS. The key in `output:`, what it checks, what --force replaces and what a
 * resumed or merged run writes again follow from the row.
 */
#ifndef ASDIC_OUT_FORMAT_H
#define ASDIC_OUT_FORMAT_H

#include "asdic_config.h"
#include "record.h"

#include <asdic/sweep.h>

/* What a file says once. */
typedef struct asdic_format_about {
    const asdic_sonar *sonar;
    asdic_sweep sweep;
    double sound_speed_mps, absorption_db_per_km; /* at the first ping's depth */
    const asdic_environment *environment;         /* whose profile or gradient bends rays */
    size_t pings, bins;
    const char *scene_name, *scene_hash, *version;
    uint64_t seed;
    bool truth; /* records have it */
} asdic_format_about;

/* A file appears under its name on commit, complete, or not at all. */
typedef struct asdic_format {
    const char *file;   /* its name in the run folder */
    size_t level_bytes; /* that it takes for each bin of each beam and ping, at most */
    /* Beside that, for each ping; left out: nothing. */
    size_t (*ping_bytes)(const asdic_sonar *sonar, const asdic_sweep *sweep);
    /* What is lacking to write it, and how to get that; NULL: nothing. Left out: never anything. */
    const char *(*missing)(void);
    asdic_status (*open)(asdic_context *ctx, const char *path, const asdic_format_about *about,
                         void **out);
    /* The next ping. */
    asdic_status (*write)(void *file, const asdic_record *record);
    /* After the last ping; *FILE becomes NULL either way. */
    asdic_status (*commit)(void **file);
    /* Removes what was written; nothing of NULL. */
    void (*discard)(void **file);
} asdic_format;

#define ASDIC_FORMAT_NUMBER(name) ASDIC_FORMAT_##name,
enum { ASDIC_FORMATS(ASDIC_FORMAT_NUMBER) ASDIC_FORMAT_COUNT };
#undef ASDIC_FORMAT_NUMBER

#define ASDIC_FORMAT_ROW(name)                                                                     \
    extern const asdic_format asdic_format_##name;                                                 \
    extern const char asdic_format_doc_##name[];
ASDIC_FORMATS(ASDIC_FORMAT_ROW)
#undef ASDIC_FORMAT_ROW

extern const asdic_format *const asdic_formats[ASDIC_FORMAT_COUNT];

/* --- a format that is written in a process of its own, for libraries that a full disk brings down: what is left of
 * them then ends with that process, and the caller goes on with a sentence --- */

/* As asdic_format's, of the file that FORMAT's functions write there. A failed write is told at the next one or
 * on commit. */
asdic_status asdic_format_process_open(asdic_context *ctx, const asdic_format *format,
                                       const char *path, const asdic_format_about *about,
                                       void **out);
asdic_status asdic_format_process_write(void *file, const asdic_record *record);
asdic_status asdic_format_process_commit(void **file);
void asdic_format_process_discard(void **file);

#endif
