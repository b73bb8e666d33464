/*
 * The mission from above.
 */
#include "base/context.h"
#include "base/try.h"
#include "base/vec.h"
#include "out/digits.h"
#include "out/raster.h"
#include "run_footprint.h"
#include "run_picture.h"
#include "run_chart_data.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Footprints are drawn at so many positions along the track. */
#define PLACES 3
#define MOST_APART ASDIC_SWATH_APART /* more beams are of one colour */

/* Okabe & Ito's colours but for the track's. */
static const uint32_t colors[MOST_APART] = {0x0072b2, 0x009e73, 0xcc79a7, 0xe69f00,
                                            0x56b4e9, 0x000000, 0xf0e442, 0x606060};

typedef struct sketch {
    asdic_chart_area *areas; /* PLACES times the beams */
    size_t area_count;
    char labels[MOST_APART][ASDIC_NAME_SIZE + 24];
    char places[96]; /* "pings 0, 300, 600" */
} sketch;

static void sketch_finish(sketch *s) {
    for (size_t i = 0; i < s->area_count; i++) {
        asdic_footprint_finish(&s->areas[i]);
    }
    free(s->areas);
}

/* BEAM in all directions of SWEEP, side by side; the caller frees. */
static asdic_beam *turned(const asdic_sweep *sweep, const asdic_beam *beam) {
    asdic_beam *beams = malloc(sweep->directions * sizeof *beams);
    for (size_t i = 0; beams && i < sweep->directions; i++) {
        beams[i] = *beam;
        beams[i].yaw_rad += asdic_sweep_bearing_rad(sweep, i);
    }
    return beams;
}

/* Where BEAM of a scanned sonar looks in a whole turn, at the place of RECORD. */
static asdic_status find_turn(asdic_render *r, asdic_swath swath, const asdic_beam *beam,
                              const asdic_record *record, const asdic_seafloor *ground,
                              asdic_chart_area *out) {
    const asdic_sweep *sweep = &r->run->settings.sweep;
    asdic_pose vehicle = asdic_sweep_vehicle(sweep, &record->pose, record->ping);
    asdic_beam *beams = turned(sweep, beam);
    if (!beams) {
        return asdic_fail_memory(r->ctx, "a footprint");
    }
    swath.beams = beams;
    swath.count = sweep->directions;
    asdic_status status = asdic_footprint_find(r->ctx, &swath, &vehicle, ground, out);
    free(beams);
    return status;
}

/* Adds the areas of all beams at one position. */
static asdic_status add_place(asdic_render *r, sketch *s, const asdic_record *record,
                              const asdic_seafloor *ground) {
    const asdic_sonar *sonar = r->info.sonar;
    double speed_mps =
        asdic_environment_sound_speed_mps(r->info.environment, record->pose.position_m.z);
    bool is_apart = sonar->receiver_count <= MOST_APART;
    bool is_scan = r->run->settings.sweep.directions > 0;
    asdic_layers layers;
    asdic_layers_of(r->info.environment, record->pose.position_m.z, &layers);
    asdic_swath swath = {.layers = asdic_environment_bends(r->info.environment) ? &layers : NULL,
                         .wavelength_m = speed_mps / sonar->frequency_hz,
                         .range_m = (double)r->info.bins * r->run->facts.bin_length_m};
    for (size_t k = 0; k < sonar->receiver_count; k += swath.count) {
        asdic_chart_area *area = &s->areas[s->area_count];
        asdic_swath_take(&swath, sonar, k);
        if (is_apart && is_scan) {
            TRY(find_turn(r, swath, swath.beams, record, ground, area));
        } else {
            TRY(asdic_footprint_find(r->ctx, &swath, &record->pose, ground, area));
        }
        area->rgb = colors[is_apart ? k : 0];
        if (s->area_count == k && (is_apart || k == 0)) { /* the first place names them */
            if (is_apart) {
                snprintf(s->labels[k], sizeof s->labels[k], "%sbeam \u2018%s\u2019",
                         is_scan ? "scan of " : "", sonar->receivers[k].name);
            } else {
                snprintf(s->labels[k], sizeof s->labels[k], "%s%zu beams",
                         asdic_beams_make_fan(sonar) ? "fan of " : "", sonar->receiver_count);
            }
            area->label = s->labels[k];
        }
        s->area_count++;
    }
    return ASDIC_OK;
}

static asdic_status add_areas(asdic_render *r, const asdic_seafloor *ground, sketch *s) {
    const asdic_summary *summary = r->summary;
    size_t last = r->info.pings - 1,
           places = asdic_track_moves(summary->north_m, summary->east_m, summary->track_count)
                        ? PLACES
                        : 1;
    places = places > r->info.pings ? r->info.pings : places;
    s->areas = calloc(PLACES * r->info.beams, sizeof *s->areas);
    if (!s->areas) {
        return asdic_fail_memory(r->ctx, "footprints");
    }
    snprintf(s->places, sizeof s->places, "ping%s", places > 1 ? "s" : "");
    for (size_t i = 0; i < places; i++) {
        asdic_record record;
        size_t index = places > 1 ? last * i / (places - 1) : 0, used = strlen(s->places);
        TRY(asdic_run_read(r->run, index, &record));
        snprintf(s->places + used, sizeof s->places - used, "%s %llu", i ? "," : "",
                 (unsigned long long)record.ping);
        TRY(add_place(r, s, &record, ground));
    }
    return ASDIC_OK;
}

static void describe_bottom(const asdic_render *r, const asdic_seafloor *ground, char text[64]) {
    if (strcmp(r->run->facts.bottom, ASDIC_RUN_BOTTOM_MESH) == 0) {
        snprintf(text, 64,
                 ground->relief->columns ? "relief lit from the north-west"
                                         : "no terrain within range");
    } else if (isfinite(ground->plane_depth_m)) {
        char digits[ASDIC_DIGITS_SIZE];
        asdic_digits_print(digits, "%.6g", ground->plane_depth_m);
        snprintf(text, 64, "flat bottom at %s m", digits);
    } else {
        snprintf(text, 64, "no bottom");
    }
}

void asdic_render_note_chart(const asdic_render *r, const asdic_seafloor *ground,
                             const char *places, const asdic_chart_area *areas, size_t count,
                             char note[ASDIC_CHART_NOTE_SIZE]) {
    char bottom[64];
    bool is_dashed = false;
    for (size_t i = 0; i < count; i++) {
        is_dashed = is_dashed || areas[i].dashed;
    }
    describe_bottom(r, ground, bottom);
    snprintf(note, ASDIC_CHART_NOTE_SIZE,
             "areas: half-power lobes on the bottom at %s%s  \u00b7  %s  \u00b7  %s", places,
             is_dashed ? "  \u00b7  dashed: none within range" : "", bottom, r->note);
}

static asdic_status draw(asdic_render *r, const asdic_chart_data *data,
                         const asdic_seafloor *ground, const sketch *s) {
    const asdic_summary *summary = r->summary;
    char title[256], note[ASDIC_CHART_NOTE_SIZE];
    uint64_t last = r->info.first_ping + r->info.pings - 1;
    asdic_chart chart = {
        .relief = &data->relief,
        .outlines = data->outlines,
        .outline_count = data->outline_count,
        .routes = data->routes,
        .route_count = data->route_count,
        .areas = s->areas,
        .area_count = s->area_count,
        .north_m = summary->north_m,
        .east_m = summary->east_m,
        .track_count = summary->track_count,
        .first_time_s = r->summary->statistics.first_time_s,
        .last_time_s = r->summary->statistics.last_time_s,
        .last_yaw_rad =
            asdic_sweep_vehicle(&r->run->settings.sweep, &summary->last_pose, last).yaw_rad};
    snprintf(title, sizeof title, "%s: plan view", r->info.scene_name);
    asdic_picture_options options = asdic_render_picture(r, title, "view", "plan");
    asdic_render_note_chart(r, ground, s->places, s->areas, s->area_count, note);
    options.note = note;
    return asdic_draw_chart(r->ctx, asdic_render_path(r, "plan", "").text, &chart, &options);
}

asdic_status asdic_render_chart(asdic_render *r) {
    const asdic_summary *summary = r->summary;
    asdic_chart_data data;
    sketch s = {0};
    bool is_plane = strcmp(r->run->facts.bottom, ASDIC_RUN_BOTTOM_PLANE) == 0;
    TRY(asdic_chart_data_read(r->ctx, r->run->folder, &data));
    asdic_seafloor ground = {.relief = &data.relief,
                             .plane_depth_m = is_plane ? summary->bottom_depth_m : INFINITY};
    asdic_chart_data_cut(&data, summary->statistics.first_time_s, summary->statistics.last_time_s);
    asdic_status status = add_areas(r, &ground, &s);
    status = status ? status : draw(r, &data, &ground, &s);
    sketch_finish(&s);
    asdic_chart_data_finish(&data);
    return status;
}
