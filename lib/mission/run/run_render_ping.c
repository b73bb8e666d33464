#include "run_picture.h"

#include "base/context.h"
#include "base/try.h"
#include "out/digits.h"
#include "out/draw.h"
#include "out/polar.h"
#include "run_section.h"
#include "sim/expected.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Curves that lie below the window of the total (one of several mechanisms) are worth seeing. */
#define ASCOPE_BELOW_DB 20.0
/* A peak must not touch the frame. */
#define ASCOPE_ABOVE_DB 2.0

/* "NAME: ping 17, t = 1.7 s" and the number for the text chunk. */
static void name_ping(const asdic_render *r, const asdic_record *record, char title[256],
                      char number[ASDIC_DIGITS_SIZE]) {
    char time_s[ASDIC_DIGITS_SIZE];
    asdic_digits_natural(number, record->ping);
    asdic_digits_time(time_s, record->time_s);
    snprintf(title, 256, "%s: ping %s, t = %s s", r->info.scene_name, number, time_s);
}

/* Expected levels of the panels' beams, [component][panel * bins + bin]. */
typedef struct expectation {
    asdic_ping *ping; /* NULL: there is none */
    float *level_db[ASDIC_COMPONENT_COUNT];
} expectation;

static void expectation_finish(expectation *e) {
    asdic_ping_destroy(&e->ping);
    free(e->level_db[0]);
}

/* The expected levels of COUNT beams without objects; none when the bottom is a mesh or grid. */
static asdic_status expect(asdic_render *r, const asdic_record *record, size_t count,
                           expectation *out) {
    asdic_beam beams[ASDIC_RENDER_PANELS];
    asdic_sonar sonar = *r->info.sonar;
    size_t cells = count * r->info.bins;
    *out = (expectation){0};
    if (strcmp(r->run->facts.bottom, ASDIC_RUN_BOTTOM_MESH) == 0) {
        return ASDIC_OK;
    }
    for (size_t k = 0; k < count; k++) {
        beams[k] = r->info.sonar->receivers[r->plan.beams[k]];
    }
    sonar.receivers = beams;
    sonar.receiver_count = count;
    TRY(asdic_ping_create(r->ctx, count, r->info.bins, &out->ping));
    out->level_db[0] = malloc(ASDIC_COMPONENT_COUNT * cells * sizeof(float));
    if (!out->level_db[0]) {
        return asdic_fail_memory(r->ctx, "expected levels");
    }
    asdic_expected_place place = {asdic_run_flat_scene(r->run, record), record->pose};
    TRY(asdic_expected_compute_among(r->ctx, r->shelf, &place, 0.0, r->info.environment, &sonar,
                                     out->ping));
    for (size_t c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        out->level_db[c] = out->level_db[0] + c * cells;
        for (size_t i = 0; i < cells; i++) {
            out->level_db[c][i] = (float)asdic_level_db(out->ping->intensity_lin[c][i]);
        }
    }
    return ASDIC_OK;
}

/* Of a component that has no level in any ping, or is not kept, no curve. */
static const float *if_there(const asdic_render *r, asdic_component part, const float *level_db) {
    return r->summary->statistics.has[part] && !r->plan.lacks_parts ? level_db : NULL;
}

/* The panel shows the expected mechanisms, or the simulated ones when there is no expectation; the same ones
 * whichever ping it is of. */
static asdic_ascope panel_of(const asdic_render *r, const asdic_record *record,
                             const expectation *expected, size_t k) {
    size_t bins = r->info.bins, first = r->plan.beams[k] * bins;
    asdic_ascope panel = {.bins = bins,
                          .bin_length_m = r->run->facts.bin_length_m,
                          .simulated_db = record->level_db[ASDIC_TOTAL] + first};
    /* Of both none is expected. */
    panel.object_db = if_there(r, ASDIC_OBJECT, record->level_db[ASDIC_OBJECT] + first);
    panel.multipath_db = if_there(r, ASDIC_MULTIPATH, record->level_db[ASDIC_MULTIPATH] + first);
    if (expected->ping) {
        panel.total_db = expected->level_db[ASDIC_TOTAL] + k * bins;
        panel.bottom_db =
            isfinite(record->altitude_m) ? expected->level_db[ASDIC_BOTTOM] + k * bins : NULL;
        panel.surface_db =
            r->run->facts.has_surface ? expected->level_db[ASDIC_SURFACE] + k * bins : NULL;
        panel.volume_db = expected->level_db[ASDIC_VOLUME] + k * bins;
        panel.noise_db =
            r->info.sonar->noise_enabled ? expected->level_db[ASDIC_NOISE] + k * bins : NULL;
    } else {
        panel.bottom_db = if_there(r, ASDIC_BOTTOM, record->level_db[ASDIC_BOTTOM] + first);
        panel.surface_db = if_there(r, ASDIC_SURFACE, record->level_db[ASDIC_SURFACE] + first);
        panel.volume_db = if_there(r, ASDIC_VOLUME, record->level_db[ASDIC_VOLUME] + first);
        panel.noise_db = if_there(r, ASDIC_NOISE, record->level_db[ASDIC_NOISE] + first);
    }
    return panel;
}

/* Every peak of the run's pings lies below it. */
static double highest_db(const asdic_statistics *s) {
    double round_db = 10.0 * ceil((s->most_db + ASCOPE_ABOVE_DB) / 10.0);
    return round_db > s->high_db ? round_db : s->high_db;
}

/* The panels of an A-scope. */
typedef struct scope {
    asdic_ascope panels[ASDIC_RENDER_PANELS];
    char titles[ASDIC_RENDER_PANELS][ASDIC_NAME_SIZE + 16];
    size_t count;
    expectation expected; /* to be finished */
} scope;

static asdic_status find_panels(asdic_render *r, const asdic_record *record, scope *s) {
    /* Of many beams the one that looks ahead: asdic_beam_ahead. */
    s->count = r->plan.beam_count <= ASDIC_RENDER_PANELS ? r->plan.beam_count : ASDIC_RENDER_PANELS;
    TRY(expect(r, record, s->count, &s->expected));
    for (size_t k = 0; k < s->count; k++) {
        snprintf(s->titles[k], sizeof s->titles[k], "beam \u2018%s\u2019",
                 r->info.sonar->receivers[r->plan.beams[k]].name);
        s->panels[k] = panel_of(r, record, &s->expected, k);
        s->panels[k].title = s->titles[k];
    }
    return isnan(r->residual_db)
               ? asdic_ascope_residual_db(r->ctx, s->panels, s->count, &r->residual_db)
               : ASDIC_OK;
}

asdic_status asdic_render_scale_ascopes(asdic_render *r, const asdic_record *record) {
    scope s;
    asdic_status status = find_panels(r, record, &s);
    expectation_finish(&s.expected);
    return status;
}

/* An A-scope shows levels without a gain, in a window of their own. */
asdic_status asdic_render_ascope(asdic_render *whole, const asdic_record *record) {
    scope s;
    char title[256], note[ASDIC_ASCOPE_NOTE_SIZE], number[ASDIC_DIGITS_SIZE];
    asdic_status status = find_panels(whole, record, &s);
    asdic_render own = *whole, *r = &own;
    size_t count = s.count;
    if (status != ASDIC_OK) {
        goto done;
    }
    name_ping(r, record, title, number);
    if (count > 1 && count < r->info.beams) { /* a panel alone says of which beam it is */
        size_t used = strlen(title);
        snprintf(title + used, sizeof title - used, ", %zu of %zu beams", count, r->info.beams);
    }
    own.options.tvg_db_per_decade = own.options.tvg_db_per_m = 0.0;
    if (!r->has_window) {
        own.options.db_low = r->summary->statistics.low_db - ASCOPE_BELOW_DB;
        own.options.db_high = highest_db(&r->summary->statistics);
    }
    asdic_render_describe(&own);
    asdic_picture_options options = asdic_render_picture(r, title, "ping", number);
    asdic_render_note_ascope(r, s.expected.ping != NULL, note);
    options.note = note;
    status = asdic_draw_ascope(r->ctx, asdic_render_path(r, "ascope_", number).text, s.panels,
                               count, r->residual_db, &options);
done:
    expectation_finish(&s.expected);
    return status;
}

/* Draws FAN as the picture of RECORD's ping; of a section, SIDE is on its right. */
static asdic_status draw_fan(asdic_render *r, const asdic_record *record, const char *title,
                             const asdic_fan *fan, const char *side) {
    char number[ASDIC_DIGITS_SIZE];
    asdic_digits_natural(number, record->ping);
    char note[sizeof r->note + 64];
    asdic_picture_options options = asdic_render_picture(r, title, "ping", number);
    if (side) {
        snprintf(note, sizeof note, "%s on the right, angles below the level  \u00b7  %s", side,
                 r->note);
        options.note = note;
    }
    return asdic_picture_fan(r->ctx, asdic_render_path(r, "fan_", number).text, fan, &options);
}

static asdic_status render_beams(asdic_render *r, const asdic_record *record, const char *title) {
    asdic_section section;
    bool is_section = asdic_section_of(r->info.sonar, &section);
    double *bearing_rad = malloc(r->info.beams * sizeof *bearing_rad);
    if (!bearing_rad) {
        return asdic_fail_memory(r->ctx, "a fan picture");
    }
    asdic_section_bearings(is_section ? &section : NULL, r->info.sonar, bearing_rad);
    asdic_fan fan = {.levels_db = record->level_db[ASDIC_TOTAL],
                     .bearing_rad = bearing_rad,
                     .beams = r->info.beams,
                     .bins = r->info.bins,
                     .bin_length_m = r->run->facts.bin_length_m,
                     .is_section = is_section};
    const char *side = !is_section ? NULL : section.is_starboard ? "starboard" : "ahead";
    asdic_status status = draw_fan(r, record, title, &fan, side);
    free(bearing_rad);
    return status;
}

/* What a scanned sonar's screen shows after RECORD's ping: of every direction the echo that was
 * received last, in the beam that a report shows. */
static asdic_status render_scan(asdic_render *r, const asdic_record *record, const char *title) {
    const asdic_sweep *sweep = &r->run->settings.sweep;
    size_t beam = r->plan.beams[0], at = (size_t)record->ping - r->info.first_ping;
    size_t oldest = 2 * sweep->directions; /* pings ago, of the way back and forth */
    asdic_polar polar;
    asdic_status status = asdic_polar_init(r->ctx, sweep, r->info.sonar->receivers[beam].yaw_rad,
                                           r->info.bins, &polar);
    for (size_t i = at > oldest ? at - oldest : 0; i <= at && !status; i++) {
        asdic_record earlier;
        status = asdic_run_read(r->run, i, &earlier);
        if (!status) {
            asdic_polar_add(&polar, earlier.ping,
                            earlier.level_db[ASDIC_TOTAL] + beam * r->info.bins);
        }
    }
    if (!status) {
        asdic_fan fan = asdic_polar_fan(&polar, r->run->facts.bin_length_m);
        status = draw_fan(r, record, title, &fan, NULL);
    }
    asdic_polar_finish(&polar);
    return status;
}

asdic_status asdic_render_fan(asdic_render *r, const asdic_record *record) {
    char title[256], number[ASDIC_DIGITS_SIZE];
    name_ping(r, record, title, number);
    if (r->run->settings.sweep.directions == 0) {
        return render_beams(r, record, title);
    }
    size_t used = strlen(title);
    if (r->info.beams > 1) {
        snprintf(title + used, sizeof title - used, ", beam \u2018%s\u2019 of a scan",
                 r->info.sonar->receivers[r->plan.beams[0]].name);
    }
    return render_scan(r, record, title);
}
