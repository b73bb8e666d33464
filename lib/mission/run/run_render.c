
#include "base/context.h"
#include "base/try.h"
#include "out/raster.h"
#include "run_picture.h"
#include "run_section.h"

#include <math.h>

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

static bool wants(const asdic_render *r, asdic_image image) {
    return (r->images & 1u << image) != 0;
}

/* The pictures that show many pings. */
static asdic_status render_many(asdic_render *r) {
    if (wants(r, ASDIC_IMAGE_WATERFALL)) {
        TRY(asdic_render_waterfalls(r));
    }
    if (wants(r, ASDIC_IMAGE_OVERVIEW)) {
        TRY(asdic_render_overview(r));
    }
    if (wants(r, ASDIC_IMAGE_PLAN)) {
        TRY(asdic_render_chart(r));
    }
    return r->options.raw ? asdic_render_raw(r) : ASDIC_OK;
}

/* The first ping worth a picture: of a scan the one that ends the first turn. */
static size_t first_shown(const asdic_render *r) {
    size_t last = r->info.pings - 1, turn = r->run->settings.sweep.directions;
    return turn == 0 ? 0 : turn - 1 < last ? turn - 1 : last;
}

/* A-scope and fan of the ping with INDEX within the run. */
static asdic_status render_ping(asdic_render *r, size_t index) {
    asdic_record record;
    if (wants(r, ASDIC_IMAGE_ASCOPE) && index > 0 && isnan(r->residual_db)) {
        TRY(asdic_run_read(r->run, 0, &record));
        TRY(asdic_render_scale_ascopes(r, &record));
    }
    TRY(asdic_run_read(r->run, index, &record));
    if (wants(r, ASDIC_IMAGE_ASCOPE)) {
        TRY(asdic_render_ascope(r, &record));
    }
    return wants(r, ASDIC_IMAGE_FAN) ? asdic_render_fan(r, &record) : ASDIC_OK;
}

static asdic_status render_frames(asdic_render *r) {
    for (size_t i = 0; i < r->info.pings; i++) {
        TRY(asdic_step(r->ctx, "frames", i, r->info.pings));
        TRY(render_ping(r, i));
        if (!r->frame(r->frame_user, r->options.path)) {
            break;
        }
    }
    return ASDIC_OK;
}

static asdic_status render_pings(asdic_render *r) {
    size_t first = first_shown(r), last = r->info.pings - 1;
    if (r->frame) {
        return render_frames(r);
    }
    if (r->options.ping != SIZE_MAX) {
        size_t index = r->options.ping - r->info.first_ping;
        if (r->options.ping < r->info.first_ping || index > last) {
            return asdic_fail(r->ctx, ASDIC_ERROR_ARGUMENT, "no ping %zu; there are %zu to %zu",
                              r->options.ping, r->info.first_ping, r->info.first_ping + last);
        }
        return render_ping(r, index);
    }
    TRY(render_ping(r, first));
    return last > first ? render_ping(r, last) : ASDIC_OK;
}

bool asdic_render_can_fan(const asdic_settings *settings) {
    asdic_section section;
    return asdic_beams_make_fan(&settings->sonar) || settings->sweep.directions >= 3 ||
           asdic_section_of(&settings->sonar, &section);
}

/* Drops the pictures for which the scene has no beams, or which this build cannot draw; the others
 * are drawn. A user who asks for one by name is warned. */
static void drop_impossible(asdic_render *r) {
    if ((r->images & 1u << ASDIC_IMAGE_FAN) && !asdic_render_can_fan(&r->run->settings)) {
        asdic_log(r->ctx, r->options.images ? ASDIC_LOG_WARNING : ASDIC_LOG_INFO,
                  "no fan picture: it needs three beams or more in the order of their bearings or "
                  "in an upright plane, or a scan");
        r->images &= ~(1u << ASDIC_IMAGE_FAN);
    }
    const unsigned over_time = 1u << ASDIC_IMAGE_WATERFALL | 1u << ASDIC_IMAGE_OVERVIEW;
    if ((r->images & over_time) && r->info.pings == 1) {
        asdic_log(r->ctx, r->options.images ? ASDIC_LOG_WARNING : ASDIC_LOG_INFO,
                  "no waterfall, no overview: they need two pings or more");
        r->images &= ~over_time;
    }
    const unsigned lines =
        1u << ASDIC_IMAGE_ASCOPE | 1u << ASDIC_IMAGE_OVERVIEW | 1u << ASDIC_IMAGE_PLAN;
    if ((r->images & lines) && !asdic_picture_annotated()) {
        asdic_log(r->ctx, ASDIC_LOG_WARNING,
                  "no A-scope, overview or plan view: built without cairo");
        r->images &= ~lines;
    }
}

/* How many pictures there will be. */
static size_t count_pictures(const asdic_render *r) {
    bool has_two = r->options.ping == SIZE_MAX && first_shown(r) < r->info.pings - 1;
    size_t pings = has_two && !r->frame ? 2 : 1;
    return (wants(r, ASDIC_IMAGE_WATERFALL) + r->options.raw) * r->plan.beam_count +
           wants(r, ASDIC_IMAGE_OVERVIEW) + wants(r, ASDIC_IMAGE_PLAN) +
           (wants(r, ASDIC_IMAGE_ASCOPE) + wants(r, ASDIC_IMAGE_FAN)) * pings;
}

/* A beam or ping that is chosen must be that of a picture which is asked for by name, a window or gain of any that is
 * drawn. */
static asdic_status check_choice(const asdic_render *r) {
    const unsigned ascope = 1u << ASDIC_IMAGE_ASCOPE, fan = 1u << ASDIC_IMAGE_FAN;
    unsigned of_beam = ascope | 1u << ASDIC_IMAGE_WATERFALL;
    of_beam |= r->run->settings.sweep.directions > 0 ? fan : 0;
    if (r->options.images && r->options.beam && !r->options.raw && !(r->options.images & of_beam)) {
        return asdic_fail(r->ctx, ASDIC_ERROR_ARGUMENT,
                          "beam '%s': waterfalls, A-scopes, raw pictures and the fan of a scan are "
                          "of one beam; none of them is asked for",
                          r->options.beam);
    }
    if (r->options.images && r->options.ping != SIZE_MAX && !(r->options.images & (ascope | fan))) {
        return asdic_fail(r->ctx, ASDIC_ERROR_ARGUMENT,
                          "ping %zu: A-scopes and fans are of one ping; neither is asked for",
                          r->options.ping);
    }
    bool has_gain = r->options.tvg_db_per_decade != 0.0 || r->options.tvg_db_per_m != 0.0;
    if (r->images == 1u << ASDIC_IMAGE_PLAN && !r->options.raw &&
        (has_gain || !isnan(r->options.db_low))) {
        return asdic_fail(r->ctx, ASDIC_ERROR_ARGUMENT,
                          "a %s is of pictures of levels; a plan has none",
                          has_gain ? "gain" : "window");
    }
    return ASDIC_OK;
}

static asdic_status check_output(const asdic_render *r) {
    size_t count = count_pictures(r);
    bool is_vector =
        r->options.format == ASDIC_PICTURE_PDF || r->options.format == ASDIC_PICTURE_SVG;
    if ((unsigned)r->options.format > ASDIC_PICTURE_SVG ||
        !asdic_colormap_name(r->options.colormap)) {
        return asdic_fail(r->ctx, ASDIC_ERROR_ARGUMENT, "no format %d or no colour map %d",
                          (int)r->options.format, (int)r->options.colormap);
    }
    if (is_vector && !asdic_picture_annotated()) {
        return asdic_fail(
            r->ctx, ASDIC_ERROR_UNSUPPORTED,
            "no PDF or SVG: built without cairo; install libcairo2-dev and build again");
    }
    if ((r->options.path || r->options.images) && count == 0) {
        return asdic_fail(r->ctx, ASDIC_ERROR_ARGUMENT,
                          "none of the pictures asked for can be drawn of this run; choose another "
                          "kind");
    }
    if (r->options.path && count != 1) {
        return asdic_fail(r->ctx, ASDIC_ERROR_ARGUMENT,
                          "one picture can go to '%s', but these are %zu; choose one kind, and one "
                          "beam or ping of it",
                          r->options.path, count);
    }
    return ASDIC_OK;
}

/* Reads all records once, for what is to be drawn. */
static asdic_status gather(asdic_render *r, asdic_summary **out) {
    TRY(asdic_summary_create(r->ctx, &r->plan, out));
    for (size_t i = 0; i < r->info.pings; i++) {
        asdic_record record;
        TRY(asdic_step(r->ctx, "pings read", i, r->info.pings));
        TRY(asdic_run_read(r->run, i, &record));
        asdic_summary_add(*out, &record);
    }
    asdic_summary_end(*out);
    return ASDIC_OK;
}

/* Chooses the pictures to draw, and the beams. */
static asdic_status plan(asdic_render *r) {
    r->info = asdic_run_get_info(r->run);
    r->images = r->run->settings.output.images;
    if (r->options.images ||
        (r->options.raw && r->options.path)) { /* those, or the raw one alone */
        r->images = r->options.images;
    }
    if (r->info.pings == 0) {
        return asdic_fail(r->ctx, ASDIC_ERROR_INPUT, "'%s' holds no ping to draw", r->run->folder);
    }
    TRY(check_choice(r));
    drop_impossible(r);
    r->plan = (asdic_summary_plan){.sonar = r->info.sonar,
                                   .environment = r->info.environment,
                                   .pings = r->info.pings,
                                   .bins = r->info.bins,
                                   .bin_length_m = r->run->facts.bin_length_m,
                                   .lacks_parts = r->run->settings.records == ASDIC_RECORD_LEVELS,
                                   .images = r->images,
                                   .tvg_db_per_decade = r->options.tvg_db_per_decade,
                                   .tvg_db_per_m = r->options.tvg_db_per_m};
    TRY(asdic_summary_choose_beams(r->ctx, r->options.beam, &r->plan));
    return check_output(r);
}

/* Attitudes whose beams A-scopes keep. */
#define ATTITUDES 16

/* Draws the run in FOLDER. OWN receives the summary that is made here when R has none. */
static asdic_status draw(asdic_render *r, const char *folder, asdic_summary **own) {
    TRY(asdic_run_open(r->ctx, folder, &r->run));
    TRY(plan(r));
    TRY(asdic_ring_shelf_create(r->ctx, ATTITUDES, &r->shelf));
    if (!r->summary) {
        TRY(gather(r, own));
        r->summary = *own;
    }
    resolve_window(r);
    asdic_render_describe(r);
    TRY(render_many(r));
    return render_pings(r);
}

static asdic_status render(asdic_render *r, const char *folder) {
    asdic_summary *own = NULL;
    asdic_status status = draw(r, folder, &own);
    asdic_ring_shelf_destroy(&r->shelf);
    asdic_summary_destroy(&own);
    asdic_run_close(&r->run);
    return status;
}

asdic_status asdic_run_render_summary(asdic_context *ctx, const char *folder,
                                      const asdic_render_options *options,
                                      const asdic_summary *summary) {
    asdic_render r = {.ctx = ctx, .options = *options, .summary = summary, .residual_db = NAN};
    return render(&r, folder);
}

asdic_status asdic_run_render_frames(asdic_context *ctx, const char *folder,
                                     const asdic_render_options *options, asdic_frame frame,
                                     void *user) {
    if (!folder || !options || !options->path || !frame) {
        return asdic_fail_null(ctx, __func__);
    }
    const unsigned fan = 1u << ASDIC_IMAGE_FAN, ascope = 1u << ASDIC_IMAGE_ASCOPE;
    if (options->images && options->images != fan && options->images != ascope) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a frame is the fan or the A-scope of a ping, and nothing else");
    }
    asdic_render r = {
        .ctx = ctx, .options = *options, .frame = frame, .frame_user = user, .residual_db = NAN};
    r.options.ping = SIZE_MAX;
    r.options.raw = false;
    r.options.images = options->images ? options->images : fan;
    return render(&r, folder);
}

asdic_status asdic_run_render(asdic_context *ctx, const char *folder,
                              const asdic_render_options *options) {
    return folder && options ? asdic_run_render_summary(ctx, folder, options, NULL)
                             : asdic_fail_null(ctx, __func__);
}
