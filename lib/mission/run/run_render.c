#include "run_render.h"

#include "base/context.h"
#include "out/digits.h"
#include "run_folder.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

asdic_render_options asdic_render_options_default(void) {
    return (asdic_render_options){
        .db_low = NAN, .db_high = NAN, .colormap = ASDIC_COLORMAP_VIRIDIS, .ping = SIZE_MAX};
}

const char *asdic_image_name(asdic_image image) {
    static const char *const names[] = {[ASDIC_IMAGE_WATERFALL] = "waterfall",
                                        [ASDIC_IMAGE_ASCOPE] = "ascope",
                                        [ASDIC_IMAGE_FAN] = "fan",
                                        [ASDIC_IMAGE_OVERVIEW] = "overview",
                                        [ASDIC_IMAGE_PLAN] = "plan"};
    return (unsigned)image < sizeof names / sizeof *names ? names[image] : NULL;
}

static void resolve_window(asdic_render *r) {
    r->has_window = !isnan(r->options.db_low) && !isnan(r->options.db_high);
    if (isnan(r->options.db_low)) {
        r->options.db_low = r->summary->statistics.shown_low_db;
    }
    if (isnan(r->options.db_high)) {
        r->options.db_high = r->summary->statistics.shown_high_db;
    }
}

/* "20000" as "20,000". */
static void group_digits(char out[40], uint64_t value) {
    char digits[ASDIC_DIGITS_SIZE];
    size_t length = asdic_digits_natural(digits, value), n = 0;
    for (size_t i = 0; i < length; i++) {
        out[n++] = digits[i];
        if (i + 1 < length && (length - i - 1) % 3 == 0) {
            out[n++] = ',';
        }
    }
    out[n] = 0;
}

/* What stands below every picture and in its text chunks. */
void asdic_render_describe(asdic_render *r) {
    char frequency[ASDIC_DIGITS_SIZE], rays[40], spread[ASDIC_DIGITS_SIZE], loss[ASDIC_DIGITS_SIZE];
    const asdic_sampling *sampling = &r->info.sampling;
    asdic_digits_print(frequency, "%g", r->info.sonar->frequency_hz / 1000.0);
    group_digits(rays, sampling->rays);
    snprintf(r->note, sizeof r->note, "%s kHz  \u00b7  %s rays a ping, %s sampling, seed %llu",
             frequency, rays, asdic_run_sampler_name(sampling->sampler),
             (unsigned long long)sampling->seed);
    asdic_digits_natural(r->seed, sampling->seed);
    asdic_digits_print(r->low, "%g", r->options.db_low);
    asdic_digits_print(r->high, "%g", r->options.db_high);
    asdic_digits_print(spread, "%.4g", r->options.tvg_db_per_decade);
    asdic_digits_print(loss, "%.4g", r->options.tvg_db_per_m);
    snprintf(r->gain, sizeof r->gain, "%s log r + %s r dB", spread, loss);
    const char *texts[] = {"Software",     "asdic",
                           "version",      r->run->facts.version,
                           "scene",        r->info.scene_name,
                           "scene_sha256", r->info.scene_hash,
                           "seed",         r->seed,
                           "db_low",       r->low,
                           "db_high",      r->high,
                           "colormap",     asdic_colormap_name(r->options.colormap),
                           "gain",         r->gain};
    _Static_assert(sizeof texts + 5 * sizeof *texts <= sizeof r->texts, "room for one more text");
    memcpy(r->texts, texts, sizeof texts);
}

asdic_picture_options asdic_render_picture(asdic_render *r, const char *title, const char *key,
                                           const char *value) {
    size_t i = 0;
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
                                   .title = title,
                                   .note = r->note,
                                   .texts = r->texts,
                                   .format = r->options.format};
}

char *asdic_render_path(const asdic_render *r, const char *stem, const char *name) {
    static const char *const extensions[] = {[ASDIC_PICTURE_BY_NAME] = "png",
                                             [ASDIC_PICTURE_PNG] = "png",
                                             [ASDIC_PICTURE_PDF] = "pdf",
                                             [ASDIC_PICTURE_SVG] = "svg"};
    if (r->options.path) {
        return strdup(strcmp(r->options.path, "-") == 0 ? "/dev/stdout" : r->options.path);
    }
    bool is_raw = strcmp(stem, "raw_") == 0;
    return asdic_folder_path(r->run->folder, stem, name,
                             is_raw ? "png" : extensions[r->options.format]);
}

bool asdic_render_has_fan(const asdic_sonar *sonar) {
    for (size_t i = 1; i < sonar->receiver_count; i++) {
        if (!(sonar->receivers[i].yaw_rad > sonar->receivers[i - 1].yaw_rad)) {
            return false;
        }
    }
    return sonar->receiver_count >= 3;
}

/* A-scope and fan of the ping with INDEX within the run. */
static asdic_status render_ping(asdic_render *r, size_t index) {
    asdic_record record;
    asdic_status status = asdic_run_read(r->run, index, &record);
    if (status == ASDIC_OK && (r->images & 1u << ASDIC_IMAGE_ASCOPE)) {
        status = asdic_render_ascope(r, &record);
    }
    if (status == ASDIC_OK && (r->images & 1u << ASDIC_IMAGE_FAN)) {
        status = asdic_render_fan(r, &record);
    }
    return status;
}

static asdic_status render_pings(asdic_render *r) {
    size_t last = r->info.pings - 1;
    if (r->options.ping != SIZE_MAX) {
        size_t index = r->options.ping - r->info.first_ping;
        if (r->options.ping < r->info.first_ping || index > last) {
            return asdic_fail(r->ctx, ASDIC_ERROR_ARGUMENT, "no ping %zu; there are %zu to %zu",
                              r->options.ping, r->info.first_ping, r->info.first_ping + last);
        }
        return render_ping(r, index);
    }
    asdic_status status = render_ping(r, 0);
    return status == ASDIC_OK && last > 0 ? render_ping(r, last) : status;
}

/* A scene that asks for pictures it has no beams for, or a build that cannot draw lines, still
 * gets the others; who asks for them by name is told. */
static void drop_impossible(asdic_render *r) {
    bool has_fan = asdic_render_has_fan(r->info.sonar);
    if ((r->images & 1u << ASDIC_IMAGE_FAN) && !has_fan) {
        asdic_log(r->ctx, r->options.images ? ASDIC_LOG_WARNING : ASDIC_LOG_INFO,
                  "no fan picture: it needs three beams or more at ascending bearings");
        r->images &= ~(1u << ASDIC_IMAGE_FAN);
    }
    const unsigned lines =
        1u << ASDIC_IMAGE_ASCOPE | 1u << ASDIC_IMAGE_OVERVIEW | 1u << ASDIC_IMAGE_PLAN;
    if ((r->images & lines) && !asdic_picture_annotated()) {
        asdic_log(r->ctx, ASDIC_LOG_WARNING,
                  "no A-scope, overview or plan view: built without cairo");
        r->images &= ~lines;
    }
}

static bool wants(const asdic_render *r, asdic_image image) {
    return (r->images & 1u << image) != 0;
}

/* How many pictures there will be. */
static size_t count_pictures(const asdic_render *r) {
    size_t pings = r->options.ping == SIZE_MAX && r->info.pings > 1 ? 2 : 1;
    return (wants(r, ASDIC_IMAGE_WATERFALL) + r->options.raw) * r->plan.beam_count +
           wants(r, ASDIC_IMAGE_OVERVIEW) + wants(r, ASDIC_IMAGE_PLAN) +
           (wants(r, ASDIC_IMAGE_ASCOPE) + wants(r, ASDIC_IMAGE_FAN)) * pings;
}

static asdic_status check_output(const asdic_render *r) {
    size_t count = count_pictures(r);
    bool is_vector =
        r->options.format == ASDIC_PICTURE_PDF || r->options.format == ASDIC_PICTURE_SVG;
    if (is_vector && !asdic_picture_annotated()) {
        return asdic_fail(
            r->ctx, ASDIC_ERROR_UNSUPPORTED,
            "no PDF or SVG: built without cairo; install libcairo2-dev and build again");
    }
    if (r->options.path && count != 1) {
        return asdic_fail(r->ctx, ASDIC_ERROR_ARGUMENT,
                          "one picture can go to '%s', but these are %zu; choose one kind, and one "
                          "beam or ping of it",
                          r->options.path, count);
    }
    return ASDIC_OK;
}

/* All records once, for what is to be drawn. */
static asdic_status gather(asdic_render *r, asdic_summary **out) {
    asdic_status status = asdic_summary_create(r->ctx, &r->plan, out);
    for (size_t i = 0; i < r->info.pings && status == ASDIC_OK; i++) {
        asdic_record record;
        status = asdic_run_read(r->run, i, &record);
        if (status == ASDIC_OK) {
            asdic_summary_add(*out, &record);
        }
    }
    if (status == ASDIC_OK) {
        asdic_summary_end(*out);
    }
    return status;
}

/* What there is to draw, and of which beams. */
static asdic_status plan(asdic_render *r) {
    r->info = asdic_run_get_info(r->run);
    r->images = r->run->settings.output.images;
    if (r->options.images || (r->options.raw && r->options.path)) { /* that, or the raw one alone */
        r->images = r->options.images;
    }
    if (r->info.pings == 0) {
        return asdic_fail(r->ctx, ASDIC_ERROR_INPUT, "'%s' holds no ping to draw", r->run->folder);
    }
    drop_impossible(r);
    r->plan = (asdic_summary_plan){.sonar = r->info.sonar,
                                   .environment = r->info.environment,
                                   .pings = r->info.pings,
                                   .bins = r->info.bins,
                                   .bin_length_m = r->run->facts.bin_length_m,
                                   .images = r->images,
                                   .tvg_db_per_decade = r->options.tvg_db_per_decade,
                                   .tvg_db_per_m = r->options.tvg_db_per_m};
    asdic_status status = asdic_summary_choose_beams(r->ctx, r->options.beam, &r->plan);
    return status == ASDIC_OK ? check_output(r) : status;
}

static asdic_status draw(asdic_render *r) {
    resolve_window(r);
    asdic_render_describe(r);
    asdic_status status = asdic_render_many(r);
    return status == ASDIC_OK ? render_pings(r) : status;
}

asdic_status asdic_run_render_summary(asdic_context *ctx, const char *folder,
                                      const asdic_render_options *options,
                                      const asdic_summary *summary) {
    asdic_render r = {.ctx = ctx, .options = *options, .summary = summary};
    asdic_summary *own = NULL;
    asdic_status status = asdic_run_open(ctx, folder, &r.run);
    if (status == ASDIC_OK) {
        status = plan(&r);
    }
    if (status == ASDIC_OK && !summary) {
        status = gather(&r, &own);
        r.summary = own;
    }
    if (status == ASDIC_OK) {
        status = draw(&r);
    }
    asdic_summary_destroy(&own);
    asdic_run_close(&r.run);
    return status;
}

asdic_status asdic_run_render(asdic_context *ctx, const char *folder,
                              const asdic_render_options *options) {
    return folder && options ? asdic_run_render_summary(ctx, folder, options, NULL)
                             : asdic_fail_null(ctx, __func__);
}
