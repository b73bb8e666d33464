#include "run_summary.h"

#include "base/context.h"
#include "base/try.h"
#include "out/draw.h"
#include "run_section.h"
#include "sim/noise_level.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TWICE_DB 3.0103f

static bool wants(const asdic_summary *d, asdic_image image) {
    return (d->plan.images & 1u << image) != 0;
}

asdic_status asdic_find_beam(asdic_context *ctx, const asdic_sonar *sonar, const char *name,
                             size_t *beam) {
    for (*beam = 0; *beam < sonar->receiver_count; ++*beam) {
        if (strcmp(sonar->receivers[*beam].name, name) == 0) {
            return ASDIC_OK;
        }
    }
    return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                      "the sonar has no beam '%s'; there are '%s' to '%s'", name,
                      sonar->receivers[0].name, sonar->receivers[sonar->receiver_count - 1].name);
}

asdic_status asdic_summary_choose_beams(asdic_context *ctx, const char *name,
                                        asdic_summary_plan *plan) {
    const asdic_sonar *sonar = plan->sonar;
    plan->beam_count = 0;
    if (name) {
        plan->beam_count = 1;
        return asdic_find_beam(ctx, sonar, name, &plan->beams[0]);
    }
    if (sonar->receiver_count > ASDIC_SUMMARY_BEAMS) {
        plan->beams[plan->beam_count++] = asdic_beam_ahead(sonar);
        return ASDIC_OK;
    }
    while (plan->beam_count < sonar->receiver_count) {
        plan->beams[plan->beam_count] = plan->beam_count;
        plan->beam_count++;
    }
    return ASDIC_OK;
}

static asdic_status begin(asdic_context *ctx, asdic_summary *d) {
    const asdic_summary_plan *plan = &d->plan;
    const asdic_picture_options gain = {.tvg_db_per_decade = plan->tvg_db_per_decade,
                                        .tvg_db_per_m = plan->tvg_db_per_m};
    TRY(asdic_statistics_begin(ctx, &d->statistics));
    if (gain.tvg_db_per_decade != 0.0 || gain.tvg_db_per_m != 0.0) {
        TRY(asdic_statistics_set_gain(ctx, &d->statistics, plan->bins, plan->bin_length_m, &gain));
    }
    for (size_t k = 0; wants(d, ASDIC_IMAGE_WATERFALL) && k < plan->beam_count; k++) {
        TRY(asdic_decimator_init(ctx, plan->pings, plan->bins, ASDIC_WATERFALL_MAX_ROWS,
                                 ASDIC_WATERFALL_MAX_COLUMNS, &d->waterfalls[k]));
    }
    if (wants(d, ASDIC_IMAGE_OVERVIEW)) {
        TRY(asdic_overview_init(ctx, plan->pings, plan->sonar->receiver_count, plan->bins,
                                plan->bin_length_m, &d->overview));
    }
    if (plan->lacks_parts) {
        size_t cells = plan->sonar->receiver_count * plan->bins;
        d->noise_db = malloc(cells * sizeof *d->noise_db);
        d->echo_db = malloc(cells * sizeof *d->echo_db);
        if (!d->noise_db || !d->echo_db) {
            return asdic_fail_memory(ctx, "a ping's noise");
        }
    }
    if (wants(d, ASDIC_IMAGE_PLAN)) {
        d->north_m = malloc((ASDIC_TRACK_POINTS + 1) * sizeof *d->north_m);
        d->east_m = malloc((ASDIC_TRACK_POINTS + 1) * sizeof *d->east_m);
        if (!d->north_m || !d->east_m) {
            return asdic_fail_memory(ctx, "a track");
        }
    }
    return ASDIC_OK;
}

asdic_status asdic_summary_create(asdic_context *ctx, const asdic_summary_plan *plan,
                                  asdic_summary **out) {
    asdic_summary *d = *out = calloc(1, sizeof *d);
    if (!d) {
        return asdic_fail_memory(ctx, "a run's pictures");
    }
    d->plan = *plan;
    asdic_status status = begin(ctx, d);
    if (status) {
        asdic_summary_destroy(out);
    }
    return status;
}

asdic_status asdic_summary_create_all(asdic_context *ctx, const asdic_settings *settings,
                                      const asdic_run_facts *facts, asdic_summary **out) {
    asdic_summary_plan plan = {.sonar = &settings->sonar,
                               .environment = &settings->environment,
                               .pings = facts->pings_planned,
                               .bins = facts->bins,
                               .bin_length_m = facts->bin_length_m,
                               .lacks_parts = settings->records == ASDIC_RECORD_LEVELS,
                               .images = settings->output.images};
    TRY(asdic_summary_choose_beams(ctx, NULL, &plan));
    return asdic_summary_create(ctx, &plan, out);
}

void asdic_summary_destroy(asdic_summary **summary) {
    asdic_summary *d = *summary;
    if (!d) {
        return;
    }
    asdic_statistics_finish(&d->statistics);
    for (size_t k = 0; k < ASDIC_SUMMARY_BEAMS; k++) {
        asdic_decimator_finish(&d->waterfalls[k]);
    }
    asdic_overview_finish(&d->overview);
    free(d->noise_db);
    free(d->echo_db);
    free(d->north_m);
    free(d->east_m);
    free(d);
    *summary = NULL;
}

/* Every so many pings, and the last. */
static void add_to_track(asdic_summary *d, const asdic_record *record) {
    size_t every = (d->plan.pings - 1) / ASDIC_TRACK_POINTS + 1;
    if (d->added == 0) {
        d->bottom_depth_m = record->pose.position_m.z + record->altitude_m;
    }
    if (d->added % every == 0 || d->added + 1 == d->plan.pings) {
        d->north_m[d->track_count] = record->pose.position_m.x;
        d->east_m[d->track_count++] = record->pose.position_m.y;
    }
    d->last_pose = record->pose;
}

/* Without a gain the nearest reverberation would always be the strongest. Unless one is asked for,
 * the gain is the one that makes equal targets equal: 40 log r for the spreading both ways, and
 * the absorption. */
static void set_gain(asdic_summary *d, const asdic_record *first) {
    const asdic_summary_plan *p = &d->plan;
    bool is_given = p->tvg_db_per_decade != 0.0 || p->tvg_db_per_m != 0.0;
    double absorption_db_per_km = asdic_environment_absorption_db_per_km(
        p->environment, p->sonar->frequency_hz, first->pose.position_m.z);
    d->overview_db_per_decade = is_given ? p->tvg_db_per_decade : 40.0;
    d->overview_db_per_m = is_given ? p->tvg_db_per_m : 2e-3 * absorption_db_per_km;
    asdic_overview_set_gain(&d->overview, d->overview_db_per_decade, d->overview_db_per_m);
}

/* RECORD with what a summary asks of the parts that it lacks: the noise, which is known without it, and
 * one echo, there where it makes the level twice the noise. A level that is drawn at random may be
 * that by noise alone, and is an echo as in the overview. */
static asdic_record with_parts(asdic_summary *d, const asdic_record *record) {
    const asdic_summary_plan *p = &d->plan;
    asdic_record whole = *record;
    double speed_mps = asdic_environment_sound_speed_mps(p->environment, record->pose.position_m.z);
    float above_db =
        p->sonar->speckle == ASDIC_SPECKLE_NONE ? TWICE_DB : (float)ASDIC_OVERVIEW_ABOVE_NOISE_DB;
    for (size_t i = 0; i < p->sonar->receiver_count * p->bins; i++) {
        const asdic_beam *beam = &p->sonar->receivers[i / p->bins];
        float level_db = record->level_db[ASDIC_TOTAL][i];
        if (i % p->bins == 0) {
            d->noise_db[i] =
                (float)asdic_level_db(asdic_noise_lin(p->environment, p->sonar, beam, speed_mps));
        } else {
            d->noise_db[i] = d->noise_db[i - 1];
        }
        d->echo_db[i] = level_db < d->noise_db[i] + above_db ? NAN : level_db;
    }
    whole.level_db[ASDIC_NOISE] = d->noise_db;
    whole.level_db[ASDIC_BOTTOM] = d->echo_db;
    return whole;
}

void asdic_summary_add(asdic_summary *d, const asdic_record *record) {
    asdic_record whole;
    if (!d) {
        return;
    }
    if (d->plan.lacks_parts) {
        whole = with_parts(d, record);
        record = &whole;
    }
    const float *levels_db = record->level_db[ASDIC_TOTAL];
    asdic_statistics_add(&d->statistics, record, d->plan.sonar->receiver_count * d->plan.bins);
    for (size_t k = 0; wants(d, ASDIC_IMAGE_WATERFALL) && k < d->plan.beam_count; k++) {
        asdic_decimator_add(&d->waterfalls[k], levels_db + d->plan.beams[k] * d->plan.bins);
    }
    if (wants(d, ASDIC_IMAGE_OVERVIEW)) {
        if (d->added == 0) {
            set_gain(d, record);
        }
        asdic_overview_add(&d->overview, levels_db, record->level_db[ASDIC_NOISE],
                           record->stderr_db);
    }
    if (wants(d, ASDIC_IMAGE_PLAN)) {
        add_to_track(d, record);
    }
    d->added++;
}

void asdic_summary_end(asdic_summary *d) {
    asdic_statistics_end(&d->statistics);
    for (size_t k = 0; wants(d, ASDIC_IMAGE_WATERFALL) && k < d->plan.beam_count; k++) {
        asdic_decimator_end(&d->waterfalls[k]);
    }
}
