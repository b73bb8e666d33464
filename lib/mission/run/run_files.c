#include "run_files.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/try.h"
#include "out/csv.h"
#include "out/format.h"

#include <stdlib.h>

struct asdic_files {
    asdic_csv *csv;                    /* NULL: not asked for */
    void *formats[ASDIC_FORMAT_COUNT]; /* the same */
};

static bool wants(const asdic_settings *settings, size_t format) {
    return (settings->output.formats & 1u << format) != 0;
}

asdic_status asdic_files_check(asdic_context *ctx, const asdic_settings *settings) {
    char text[ASDIC_REMARK_SIZE];
    return asdic_settings_lack(settings, text)
               ? asdic_fail(ctx, ASDIC_ERROR_UNSUPPORTED, "%s", text)
               : ASDIC_OK;
}

static asdic_status open_all(asdic_context *ctx, const char *folder, const asdic_settings *settings,
                             const asdic_format_about *about, asdic_files *files) {
    TRY(asdic_csv_create(ctx, asdic_file_in(folder, "bins.csv").text, &settings->sonar, about->bins,
                         settings->output.csv, &files->csv));
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT; i++) {
        if (wants(settings, i)) {
            const asdic_format *f = asdic_formats[i];
            TRY(f->open(ctx, asdic_file_in(folder, f->file).text, about, &files->formats[i]));
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_files_create(asdic_context *ctx, const char *folder,
                                const asdic_settings *settings, const asdic_run_facts *facts,
                                double depth_m, asdic_files **out) {
    const asdic_environment *env = &settings->environment;
    char *name = asdic_scene_name(facts->scene_path);
    asdic_format_about about = {.sonar = &settings->sonar,
                                .sweep = settings->sweep,
                                .sound_speed_mps = asdic_environment_sound_speed_mps(env, depth_m),
                                .absorption_db_per_km = asdic_environment_absorption_db_per_km(
                                    env, settings->sonar.frequency_hz, depth_m),
                                .environment = env,
                                .pings = facts->pings_planned,
                                .bins = facts->bins,
                                .scene_name = name,
                                .scene_hash = facts->scene_hash,
                                .version = facts->version,
                                .seed = facts->sampling.seed,
                                .truth = settings->sampling.truth};
    *out = calloc(1, sizeof **out);
    asdic_status status = name && *out ? open_all(ctx, folder, settings, &about, *out)
                                       : asdic_fail_memory(ctx, "a run's files");
    if (status) {
        asdic_files_destroy(out);
    }
    free(name);
    return status;
}

asdic_status asdic_files_create_stream(asdic_context *ctx, const asdic_settings *settings,
                                       size_t bins, asdic_files **out) {
    asdic_csv_form form = settings->output.csv == ASDIC_CSV_WIDE ? ASDIC_CSV_WIDE : ASDIC_CSV_LONG;
    *out = calloc(1, sizeof **out);
    asdic_status status =
        *out ? asdic_csv_create(ctx, "/dev/stdout", &settings->sonar, bins, form, &(*out)->csv)
             : asdic_fail_memory(ctx, "a run's files");
    if (status) {
        asdic_files_destroy(out);
    }
    return status;
}

asdic_status asdic_files_add(asdic_files *files, const asdic_record *record) {
    TRY(asdic_csv_add(files->csv, record));
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT; i++) {
        if (files->formats[i]) {
            TRY(asdic_formats[i]->write(files->formats[i], record));
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_files_commit(asdic_files *files, bool is_whole) {
    TRY(asdic_csv_commit(&files->csv));
    for (size_t i = 0; is_whole && i < ASDIC_FORMAT_COUNT; i++) {
        if (files->formats[i]) {
            TRY(asdic_formats[i]->commit(&files->formats[i]));
        }
    }
    return ASDIC_OK;
}

void asdic_files_destroy(asdic_files **files) {
    asdic_files *f = *files;
    if (!f) {
        return;
    }
    asdic_csv_discard(&f->csv);
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT; i++) {
        if (f->formats[i]) {
            asdic_formats[i]->discard(&f->formats[i]);
        }
    }
    free(f);
    *files = NULL;
}
