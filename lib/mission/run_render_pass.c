#include "run_render_pass.h"

#include "base/context.h"
#include "out/draw.h"

#include <stdlib.h>

static bool wants(const asdic_render *r, asdic_image image) {
    return (r->images & 1u << image) != 0;
}

static asdic_status begin(asdic_render *r, asdic_render_pass *pass) {
    asdic_status status = ASDIC_OK;
    *pass = (asdic_render_pass){0};
    for (size_t k = 0; wants(r, ASDIC_IMAGE_WATERFALL) && k < r->beam_count; k++) {
        status = asdic_decimator_init(r->ctx, r->info.pings, r->info.bins, ASDIC_WATERFALL_MAX_ROWS,
                                      ASDIC_WATERFALL_MAX_COLUMNS, &pass->waterfalls[k]);
        if (status != ASDIC_OK) {
            return status;
        }
    }
    if (wants(r, ASDIC_IMAGE_OVERVIEW)) {
        status = asdic_overview_init(r->ctx, r->info.pings, r->info.beams, r->info.bins,
                                     r->run->facts.bin_length_m, &pass->overview);
    }
    if (status == ASDIC_OK && wants(r, ASDIC_IMAGE_PLAN)) {
        pass->north_m = malloc((ASDIC_TRACK_POINTS + 1) * sizeof *pass->north_m);
        pass->east_m = malloc((ASDIC_TRACK_POINTS + 1) * sizeof *pass->east_m);
        if (!pass->north_m || !pass->east_m) {
            return asdic_fail_memory(r->ctx, "a track");
        }
    }
    return status;
}

/* Every so many pings, and the last. */
static void add_to_track(const asdic_render *r, asdic_render_pass *pass, size_t index,
                         const asdic_record *record) {
    size_t every = (r->info.pings - 1) / ASDIC_TRACK_POINTS + 1;
    if (index == 0) {
        pass->bottom_depth_m = record->pose.position_m.z + record->altitude_m;
    }
    if (index % every == 0 || index + 1 == r->info.pings) {
        pass->north_m[pass->track_count] = record->pose.position_m.x;
        pass->east_m[pass->track_count++] = record->pose.position_m.y;
    }
    pass->last_pose = record->pose;
}

static void add(const asdic_render *r, asdic_render_pass *pass, size_t index,
                const asdic_record *record, const asdic_picture_options *gain) {
    const float *levels_db = record->level_db[ASDIC_TOTAL];
    for (size_t k = 0; wants(r, ASDIC_IMAGE_WATERFALL) && k < r->beam_count; k++) {
        asdic_decimator_add(&pass->waterfalls[k], levels_db + r->beams[k] * r->info.bins);
    }
    if (wants(r, ASDIC_IMAGE_OVERVIEW)) {
        asdic_overview_add(&pass->overview, levels_db, record->level_db[ASDIC_NOISE], gain);
    }
    if (wants(r, ASDIC_IMAGE_PLAN)) {
        add_to_track(r, pass, index, record);
    }
}

/* Without any, the nearest reverberation would always be the strongest: unless a gain is asked for,
 * that which makes equal targets equal: 40 log r for the spreading both ways, and the absorption. */
static void set_gain(const asdic_render *r, asdic_render_pass *pass, const asdic_record *first) {
    const asdic_render_options *o = &r->options;
    bool is_given = o->tvg_db_per_decade != 0.0 || o->tvg_db_per_m != 0.0;
    double absorption_db_per_km = asdic_environment_absorption_db_per_km(
        r->info.environment, r->info.sonar->frequency_hz, first->pose.position_m.z);
    pass->overview_db_per_decade = is_given ? o->tvg_db_per_decade : 40.0;
    pass->overview_db_per_m = is_given ? o->tvg_db_per_m : 2e-3 * absorption_db_per_km;
}

asdic_status asdic_render_pass_run(asdic_render *r, asdic_render_pass *out) {
    asdic_picture_options gain = {0};
    asdic_status status = begin(r, out);
    for (size_t i = 0; i < r->info.pings && status == ASDIC_OK; i++) {
        asdic_record record;
        status = asdic_run_read(r->run, i, &record);
        if (status == ASDIC_OK && i == 0) {
            set_gain(r, out, &record);
            gain.tvg_db_per_decade = out->overview_db_per_decade;
            gain.tvg_db_per_m = out->overview_db_per_m;
        }
        if (status == ASDIC_OK) {
            add(r, out, i, &record, &gain);
        }
    }
    for (size_t k = 0; wants(r, ASDIC_IMAGE_WATERFALL) && k < r->beam_count; k++) {
        if (status == ASDIC_OK) {
            asdic_decimator_end(&out->waterfalls[k]);
        }
    }
    if (status != ASDIC_OK) {
        asdic_render_pass_finish(out);
    }
    return status;
}

void asdic_render_pass_finish(asdic_render_pass *pass) {
    for (size_t k = 0; k < ASDIC_RENDER_WATERFALLS; k++) {
        asdic_decimator_finish(&pass->waterfalls[k]);
    }
    asdic_overview_finish(&pass->overview);
    free(pass->north_m);
    free(pass->east_m);
    *pass = (asdic_render_pass){0};
}
