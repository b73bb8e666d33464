/*
 * The output for the bins that the detector marks: plots for the tracker, rows of detections.csv
 * and tracks.csv, and the occupancy map.
 */
#include "detect_job.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/try.h"
#include "base/vec.h"
#include "detect/evidence.h"
#include "mission/mission.h"
#include "out/csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- plots ------------------------------------------------------------------------------------ */

/* Half-widths to standard deviations: a uniform spread. */
#define UNIFORM (1.0 / 3.4641016151377544)

/* The bin of greatest likelihood among the consecutive detections that begin at FIRST; *END is
 * behind the last. */
static size_t peak(const asdic_detect_job *job, const double *llr, size_t first, size_t *end) {
    size_t last = (first / job->info.bins + 1) * job->info.bins, best = first, i = first;
    for (; i < last && job->detected[i]; i++) {
        best = llr[i] > llr[best] ? i : best;
    }
    *end = i;
    return best;
}

void asdic_detect_spread(const asdic_detect_job *job, double width_rad, double plane_m,
                         double *along_m, double *across_m) {
    const asdic_sonar *sonar = job->info.sonar;
    *along_m =
        UNIFORM * fmax(sonar->bin_length_m, 0.5 * job->sound_speed_mps / sonar->bandwidth_hz);
    *across_m = fmax(UNIFORM * plane_m * width_rad, *along_m);
}

static asdic_plot_point plot_of(const asdic_detect_job *job, const asdic_record *record,
                                size_t cell) {
    size_t beam = cell / job->info.bins;
    asdic_vec3 at = asdic_detect_position(job, record, beam, cell % job->info.bins);
    double north = at.x - record->pose.position_m.x, east = at.y - record->pose.position_m.y;
    double plane = hypot(north, east), along, across;
    double c = plane > 0.0 ? north / plane : 1.0, s = plane > 0.0 ? east / plane : 0.0;
    double width = asdic_beam_width_rad(job->info.sonar, beam, job->sound_speed_mps);
    asdic_detect_spread(job, width, plane, &along, &across);
    return (asdic_plot_point){.north_m = at.x,
                              .east_m = at.y,
                              .variance_nn_m2 = pow(c * along, 2) + pow(s * across, 2),
                              .variance_ee_m2 = pow(s * along, 2) + pow(c * across, 2),
                              .variance_ne_m2 = c * s * (along * along - across * across),
                              .label = job->label[cell]};
}

/* Whether two plots of one ping may be one target: nearer than three standard deviations. */
static bool overlap(const asdic_plot_point *a, const asdic_plot_point *b) {
    double nn = a->variance_nn_m2 + b->variance_nn_m2, ee = a->variance_ee_m2 + b->variance_ee_m2;
    double ne = a->variance_ne_m2 + b->variance_ne_m2;
    double n = a->north_m - b->north_m, e = a->east_m - b->east_m;
    double distance2 = (ee * n * n - 2.0 * ne * n * e + nn * e * e) / (nn * ee - ne * ne);
    return distance2 < 9.0;
}

void asdic_detect_find_plots(asdic_detect_job *job, const asdic_record *record) {
    const double *llr = asdic_scan_get(job->scan).llr;
    size_t cells = job->info.beams * job->info.bins, end = 0;
    job->plot_count = 0;
    for (size_t i = 0; i < cells; i = job->detected[i] ? end : i + 1) {
        if (!job->detected[i]) {
            continue;
        }
        size_t at = peak(job, llr, i, &end);
        asdic_plot_point plot = plot_of(job, record, at);
        bool is_new = true;
        for (size_t k = 0; k < job->plot_count && is_new; k++) {
            is_new = !overlap(&job->plots[k], &plot);
            if (!is_new && llr[at] > llr[job->plot_cell[k]]) {
                job->plots[k] = plot;
                job->plot_cell[k] = at;
            }
            job->plot_bins[k] += is_new ? 0 : end - i;
        }
        if (is_new) {
            job->plot_cell[job->plot_count] = at;
            job->plot_bins[job->plot_count] = end - i;
            job->plots[job->plot_count++] = plot;
        }
    }
    for (size_t k = 0; k < job->plot_count; k++) {
        double bins = (double)job->plot_bins[k];
        bool is_false = job->truth[job->plot_cell[k]] == ASDIC_TRUTH_NONE;
        job->false_plots += is_false ? 1.0 : 0.0;
        job->false_bins += is_false ? bins : 0.0;
        job->false_squares += is_false ? bins * bins : 0.0;
    }
}

/* --- rows ------------------------------------------------------------------------------------- */

static asdic_status check_name(const asdic_detect_job *job, const char *path) {
    if (!path) {
        return asdic_fail_memory(job->ctx, "a file name");
    }
    if (!job->options->force && access(path, F_OK) == 0) {
        return asdic_fail(job->ctx, ASDIC_ERROR_EXISTS, "'%s' exists; --force replaces it", path);
    }
    return ASDIC_OK;
}

static asdic_status open_file(asdic_detect_job *job, const char *path, const char *header,
                              asdic_file **out) {
    TRY(check_name(job, path));
    TRY(asdic_file_create(job->ctx, path, out));
    fputs(header, asdic_file_stream(*out));
    return ASDIC_OK;
}

/* detections.mcap, where the scene asks for run.mcap. */
static asdic_status open_messages(asdic_detect_job *job, const char *path) {
    const asdic_settings *settings = &job->run->settings;
    const asdic_format_about about = {.sonar = job->info.sonar,
                                      .sweep = settings->sweep,
                                      .sound_speed_mps = job->sound_speed_mps,
                                      .bins = job->info.bins,
                                      .scene_name = job->info.scene_name,
                                      .scene_hash = job->info.scene_hash,
                                      .seed = job->info.sampling.seed};
    if (!(settings->output.formats & 1u << ASDIC_FORMAT_mcap)) {
        return ASDIC_OK;
    }
    TRY(check_name(job, path));
    return asdic_mcap_recording_open(job->ctx, path, &about, 1u << ASDIC_ROS_DETECTIONS,
                                     &job->messages);
}

asdic_status asdic_detect_open_files(asdic_detect_job *job) {
    const char *folder = job->run->folder;
    TRY(open_file(job, asdic_file_in(folder, "detections.csv").text,
                  "ping,time_s,beam,bin,range_m,x_m,y_m,z_m,level_db,background_db,llr,posterior,"
                  "pd,truth\n",
                  &job->detections));
    TRY(open_file(job, asdic_file_in(folder, "tracks.csv").text,
                  "ping,time_s,track,confirmed,hit,x_m,y_m,vx_mps,vy_mps,sd_x_m,"
                  "sd_y_m,truth\n",
                  &job->tracks));
    return open_messages(job, asdic_file_in(folder, "detections.mcap").text);
}

asdic_vec3 asdic_detect_position(const asdic_detect_job *job, const asdic_record *record,
                                 size_t beam, size_t bin) {
    asdic_vec3 axis = asdic_beam_axis(&job->info.sonar->receivers[beam], &record->pose);
    double range_m = ((double)bin + 0.5) * job->info.sonar->bin_length_m;
    return asdic_vec3_add(record->pose.position_m, asdic_vec3_scale(axis, range_m));
}

asdic_status asdic_detect_write_rows(asdic_detect_job *job, const asdic_record *record) {
    asdic_scan_result result = asdic_scan_get(job->scan);
    FILE *out = asdic_file_stream(job->detections);
    char beam[2 * ASDIC_NAME_SIZE + 3], name[2 * ASDIC_NAME_SIZE + 3], pd[32];
    for (size_t i = 0; i < job->info.beams * job->info.bins; i++) {
        if (!job->detected[i]) {
            continue;
        }
        size_t b = i / job->info.bins, n = i % job->info.bins;
        asdic_vec3 at = asdic_detect_position(job, record, b, n);
        asdic_csv_field(beam, job->info.sonar->receivers[b].name);
        asdic_csv_field(name, asdic_detect_class_of(job, i)->name);
        pd[0] = 0;
        if (job->truth[i] == ASDIC_TRUTH_OBJECT) {
            snprintf(pd, sizeof pd, "%.9g", asdic_detect_bin_pd(job, i));
        }
        fprintf(out, "%llu,%.15g,%s,%zu,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%s,%s\n",
                (unsigned long long)record->ping, record->time_s, beam, n,
                ((double)n + 0.5) * job->info.sonar->bin_length_m, at.x, at.y, at.z,
                (double)record->level_db[ASDIC_TOTAL][i], asdic_level_db(result.background_lin[i]),
                result.llr[i], asdic_detect_posterior(result.llr[i], job->detector.prior), pd,
                name);
    }
    return job->messages ? asdic_mcap_recording_add(job->messages, record, job->detected)
                         : ASDIC_OK;
}

/* Notes whether TRACK is confirmed, and whether an object's. */
static asdic_status note(asdic_detect_job *job, const asdic_track_state *track) {
    if (track->id >= job->track_capacity) {
        size_t room = 2 * (size_t)track->id + 64;
        uint8_t *larger = realloc(job->track_seen, room);
        if (!larger) {
            return asdic_fail_memory(job->ctx, "tracks");
        }
        memset(larger + job->track_capacity, 0, room - job->track_capacity);
        job->track_seen = larger;
        job->track_capacity = room;
    }
    job->track_seen[track->id] |=
        4u | (track->confirmed ? 1u : 0u) | (track->confirmed && track->label >= 0 ? 2u : 0u);
    return ASDIC_OK;
}

asdic_status asdic_detect_write_tracks(asdic_detect_job *job, const asdic_record *record) {
    size_t count = 0;
    const asdic_track_state *tracks = asdic_tracker_get(job->tracker, &count);
    FILE *out = asdic_file_stream(job->tracks);
    char name[2 * ASDIC_NAME_SIZE + 3];
    for (size_t i = 0; i < count; i++) {
        const asdic_track_state *t = &tracks[i];
        bool has_name = t->label >= 0;
        asdic_csv_field(name, has_name ? asdic_namer_name(job->namer, (size_t)t->label) : "none");
        fprintf(out, "%llu,%.15g,%u,%d,%d,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%s\n",
                (unsigned long long)record->ping, record->time_s, t->id, t->confirmed, t->hit,
                t->north_m, t->east_m, t->north_mps, t->east_mps, t->sd_north_m, t->sd_east_m,
                name);
        TRY(note(job, t));
    }
    return ASDIC_OK;
}

/* --- map -------------------------------------------------------------------------------------- */

/* Log-odds are clipped here: e^10 to 1. */
#define LIMIT 10.0
/* Directions in which the map's edge is sought: 0.13 % of the reach are missed at most, mostly less than a cell. */
#define STEP_RAD 0.1
/* Cells that nobody gave a side: this long at least, and hardly more than so many; more no picture shows. */
#define LEAST_CELL_M 0.5
#define ENOUGH_CELLS 4e6

static void find_floor(const asdic_mission *mission, asdic_occupancy *map) {
    for (size_t i = 0; i < map->rows * map->columns; i++) {
        asdic_vec3 at = {map->north_m + ((double)(i / map->columns) + 0.5) * map->cell_m,
                         map->east_m + ((double)(i % map->columns) + 0.5) * map->cell_m, 0.0};
        double depth = asdic_scene_altitude_m(asdic_mission_scene(mission), at);
        map->floor_depth_m[i] = isfinite(depth) ? (float)depth : NAN;
    }
}

/* The side of a cell of a map NORTH_M by EAST_M. */
static double cell_of(const asdic_detect_job *job, double north_m, double east_m) {
    double cell = job->options->cell_m;
    if (cell == 0.0) {
        cell = fmax(0.5 * job->info.sonar->bin_length_m, LEAST_CELL_M);
        while (north_m * east_m > ENOUGH_CELLS * cell * cell) {
            cell *= 2.0;
        }
    }
    return cell;
}

/* The map covers all that beams are asked about along the track. */
asdic_status asdic_detect_create_map(asdic_detect_job *job) {
    if (isnan(job->options->cell_m)) {
        return ASDIC_OK;
    }
    double range_m = (double)job->info.bins * job->info.sonar->bin_length_m;
    asdic_vec3 low = {INFINITY, INFINITY, 0.0}, high = {-INFINITY, -INFINITY, 0.0};
    for (size_t i = 0; i < job->info.pings; i++) {
        asdic_record record;
        TRY(asdic_run_read(job->run, i, &record));
        for (size_t b = 0; b < job->info.beams; b++) {
            asdic_vec3 axis = asdic_beam_axis(&job->info.sonar->receivers[b], &record.pose);
            asdic_hearing_range heard =
                asdic_evidence_range(job->info.sonar, b, axis, job->sound_speed_mps);
            double reach_m = heard.plane_share * range_m, steps = ceil(heard.aside_rad / STEP_RAD);
            for (double k = -steps; k <= steps; k += 1.0) {
                double azimuth = atan2(axis.y, axis.x) + k / steps * heard.aside_rad;
                double north = record.pose.position_m.x + reach_m * cos(azimuth);
                double east = record.pose.position_m.y + reach_m * sin(azimuth);
                low.x = fmin(low.x, fmin(north, record.pose.position_m.x));
                low.y = fmin(low.y, fmin(east, record.pose.position_m.y));
                high.x = fmax(high.x, fmax(north, record.pose.position_m.x));
                high.y = fmax(high.y, fmax(east, record.pose.position_m.y));
            }
        }
    }
    double cell = cell_of(job, high.x - low.x, high.y - low.y);
    low.x = cell * floor(low.x / cell) - cell;
    low.y = cell * floor(low.y / cell) - cell;
    high.x += cell;
    high.y += cell;
    TRY(asdic_occupancy_create(job->ctx, low, high, cell, job->detector.prior, LIMIT, &job->map));
    if (job->mission) {
        find_floor(job->mission, job->map);
    }
    return ASDIC_OK;
}

asdic_status asdic_detect_add_to_map(asdic_detect_job *job, const asdic_record *record) {
    const asdic_look look = {.sonar = job->info.sonar,
                             .sound_speed_mps = job->sound_speed_mps,
                             .pose = record->pose,
                             .depth_m = job->run->facts.has_surface ? record->pose.position_m.z
                                                                    : (double)INFINITY,
                             .bins = job->info.bins,
                             .intensity_lin = job->intensity_lin,
                             .background_lin = asdic_scan_get(job->scan).background_lin,
                             .noise_lin = job->fixed_lin,
                             .snr_db = job->detector.snr_db};
    return asdic_occupancy_add_tabled(job->ctx, job->map, &look, job->k_table);
}

asdic_status asdic_detect_draw_map(asdic_detect_job *job) {
    char title[256 + ASDIC_SUBTITLE_SIZE], facts[ASDIC_SUBTITLE_SIZE], note[256];
    const char *texts[] = {"Software", "asdic", "scene_sha256", job->info.scene_hash, "Title",
                           title,      NULL};
    asdic_series way = {.label = "vehicle, ending at the dot",
                        .x = job->track_east_m,
                        .y = job->track_north_m,
                        .count = job->pings_done,
                        .rgb = 0xd55e00u,
                        .width = 1.6};
    asdic_map map = {.values = job->map->log_odds,
                     .rows = job->map->rows,
                     .columns = job->map->columns,
                     .north_m = job->map->north_m,
                     .east_m = job->map->east_m,
                     .cell_m = job->map->cell_m,
                     .label = "ln of the odds of a target",
                     .lines = &way,
                     .line_count = 1};
    asdic_picture_options options = asdic_picture_options_default();
    asdic_picture_subtitle(job->info.sonar, job->run->facts.bin_length_m, facts);
    snprintf(title, sizeof title, "%s: occupancy after %zu ping%s\n%s", job->info.scene_name,
             job->pings_done, job->pings_done == 1 ? "" : "s", facts);
    snprintf(
        note, sizeof note,
        "cells of %g m, clipped at %g  \u00b7  prior %g, targets from %g dB above the background on"
        "  \u00b7  white: not looked at",
        job->map->cell_m, LIMIT, job->detector.prior, job->detector.snr_db);
    options.db_low = -LIMIT;
    options.db_high = LIMIT;
    options.title = title;
    options.note = note;
    options.texts = texts;
    return asdic_picture_map(job->ctx, asdic_file_in(job->run->folder, "occupancy.png").text, &map,
                             &options);
}
