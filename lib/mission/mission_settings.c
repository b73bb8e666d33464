#include "mission_settings.h"

#include "base/context.h"
#include "base/number.h"
#include "base/try.h"
#include "mission/scene_file/scene_file.h"
#include "out/format.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Pings of more bins of all beams are large: some 100 bytes a row of bins.csv are 5 MB. */
#define MOST_CELLS ((size_t)50000)
/* Near enough to count bins by. */
#define SOUND_SPEED_MPS 1500.0

/* What the file writes where it does not say. It depends on the file alone, so that parts of a
 * mission agree. */
static void choose_output(const asdic_scene_file *file, asdic_settings *out) {
    int64_t pings = file->mission.pings;
    bool is_scanned = out->sweep.directions > 1; /* a turn of the head, where there is no number */
    bool is_one_ping = file->mission.pose.node && (pings == 1 || (pings == 0 && !is_scanned));
    size_t cells = out->sonar.receiver_count * asdic_sonar_bin_count(&out->sonar, SOUND_SPEED_MPS);
    bool is_large = cells > MOST_CELLS && !is_one_ping;
    if (file->output.records == FILE_AUTO) {
        out->records = is_large ? ASDIC_RECORD_COMPACT : ASDIC_RECORD_FULL;
    }
    if (file->output.csv != FILE_AUTO) {
        return;
    }
    out->leaves_csv_out = is_large;
    out->output.csv = is_large ? ASDIC_CSV_NONE : ASDIC_CSV_LONG;
    if (is_large && out->output.formats == 0 && !file->output.truth) {
        out->output.formats = 1u << ASDIC_FORMAT_npy_float16;
    }
}

asdic_status asdic_settings_take(asdic_context *ctx, const asdic_scene_file *file,
                                 asdic_settings *out) {
    *out = (asdic_settings){
        .environment = asdic_scene_file_environment(file),
        .sonar = asdic_scene_file_sonar(file),
        .sweep = asdic_scene_file_sweep(file),
        .sampling = {.rays = (uint32_t)file->sampling.rays,
                     .sampler = (asdic_sampler)file->sampling.sampler,
                     .multipath = (asdic_multipath)file->sampling.multipath,
                     .seed = (uint64_t)file->sampling.seed,
                     .coherent = file->sampling.coherent},
        .has_source_level = asdic_yaml_child(file->sonar.node, "source_level_db") != NULL,
        .keeps_all_terms = file->model.terms == FILE_TERMS_ALL,
        .refraction = file->model.refraction,
        .detector = {.target = (asdic_target)file->detector.target,
                     .pfa = file->detector.pfa,
                     .prior = file->detector.prior,
                     .snr_db = file->detector.snr_db,
                     .cost_ratio = file->detector.cost_ratio},
        .records = (asdic_record_form)file->output.records,
        .elements = file->output.elements,
        .output = {.csv = (asdic_csv_form)file->output.csv, .images = file->output.images}};
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT; i++) {
        out->output.formats |= file->output.formats[i] ? 1u << i : 0u;
    }
    out->sampling.truth = file->output.truth;
    choose_output(file, out);
    out->receivers = calloc(out->sonar.receiver_count + 1, sizeof *out->receivers);
    if (!out->receivers) {
        return asdic_fail_memory(ctx, "the receivers");
    }
    asdic_scene_file_receivers(file, out->receivers);
    out->sonar.receivers = out->receivers;
    return ASDIC_OK;
}

static asdic_status read_text(asdic_context *ctx, const char *text, asdic_arena *arena,
                              asdic_problems *problems, asdic_settings *out) {
    asdic_scene_file file;
    if (!asdic_scene_file_parse(text, strlen(text), arena, problems, &file)) {
        return asdic_fail_memory(ctx, "a scene's settings");
    }
    TRY(asdic_settings_take(ctx, &file, out));
    return asdic_problems_report(problems, ctx);
}

asdic_status asdic_settings_read(asdic_context *ctx, const char *name, const char *text,
                                 asdic_settings *out) {
    asdic_arena arena = {0};
    asdic_problems problems = {.name = name};
    locale_t before = asdic_c_locale_enter();
    *out = (asdic_settings){0};
    asdic_status status = read_text(ctx, text, &arena, &problems, out);
    if (status) {
        asdic_settings_finish(out);
    }
    asdic_problems_finish(&problems);
    asdic_arena_finish(&arena);
    asdic_c_locale_leave(before);
    return status;
}

void asdic_settings_finish(asdic_settings *settings) {
    free(settings->receivers);
    *settings = (asdic_settings){0};
}

bool asdic_settings_lack(const asdic_settings *settings, char text[ASDIC_REMARK_SIZE]) {
    const char *missing = NULL;
    for (size_t i = 0; i < ASDIC_FORMAT_COUNT && !missing; i++) {
        bool is_wanted = settings->output.formats & 1u << i;
        if (is_wanted && asdic_formats[i]->missing && (missing = asdic_formats[i]->missing())) {
            snprintf(text, ASDIC_REMARK_SIZE,
                     "the scene asks for 'output: {%s: true}', but %s, or use false",
                     asdic_format_name(i), missing);
        }
    }
    return missing != NULL;
}
