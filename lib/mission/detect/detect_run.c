/*
 * The detector applied to the pings of a run.
 */
#include "detect_job.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/number.h"
#include "base/try.h"
#include "detect/law.h"
#include "mission/mission.h"
#include "sim/expected.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* An echo that is weaker than this, re all else in its bin, does not count as one. */
#define FAINT_LIN 0.01
/* Attitudes of which the beams' profiles are kept, some 40 kB a beam. */
#define ATTITUDES 4
/* Attitudes of a straight leg differ by rounding. A beam of half a degree falls by up to 3 dB a mrad where it still
 * hears: this step is worth 0.003 dB. */
#define STEP_RAD 1e-6
/* Levels over a plane take some 6 ms of a processor a beam and attitude; a ping of 16 beams is simulated in less. Of
 * more beams a background is simulated where levels would take longer than a minute. */
#define FEW_BEAMS 16
#define MOST_ATTITUDES 10000

asdic_detect_options asdic_detect_options_default(void) {
    return (asdic_detect_options){.cfar = asdic_cfar_default(),
                                  .truth_snr_db = 0.0,
                                  .tracker = asdic_tracker_options_default()};
}

/* The ping's intensities, and the truth about each bin. */
static void read_truth(asdic_detect_job *job, const asdic_record *record) {
    double least = pow(10.0, 0.1 * job->options->truth_snr_db);
    for (size_t i = 0; i < job->info.beams * job->info.bins; i++) {
        double object = asdic_detect_lin(record->level_db[ASDIC_OBJECT][i]);
        double ghost = asdic_detect_lin(record->level_db[ASDIC_MULTIPATH][i]);
        job->intensity_lin[i] = asdic_detect_lin(record->level_db[ASDIC_TOTAL][i]);
        job->noise_lin[i] = asdic_detect_lin(record->level_db[ASDIC_NOISE][i]);
        double rest = asdic_detect_lin(record->level_db[ASDIC_BOTTOM][i]) +
                      asdic_detect_lin(record->level_db[ASDIC_SURFACE][i]) +
                      asdic_detect_lin(record->level_db[ASDIC_VOLUME][i]) + job->noise_lin[i];
        job->rest_lin[i] = rest;
        job->object_lin[i] = object + ghost;
        job->truth[i] = object > 0.0 && object >= least * (rest + ghost)  ? ASDIC_TRUTH_OBJECT
                        : ghost > 0.0 && ghost >= least * (rest + object) ? ASDIC_TRUTH_GHOST
                        : object + ghost > FAINT_LIN * rest               ? ASDIC_TRUTH_FAINT
                                                                          : ASDIC_TRUTH_NONE;
    }
    for (size_t i = 0; i < job->info.beams * job->info.bins; i++) {
        bool is_object = job->truth[i] == ASDIC_TRUTH_OBJECT;
        job->label[i] =
            is_object ? (long)asdic_namer_find(job->namer, i / job->info.bins, i % job->info.bins)
                      : -1;
    }
}

/* What is expected over a plane: a function of depth, altitude, roll and pitch alone, the same for pings at which
 * these are. */
static asdic_status expect(asdic_detect_job *job, const asdic_record *record) {
    asdic_flat_scene flat = asdic_run_flat_scene(job->run, record);
    asdic_expected_place place = asdic_expected_place_on_grid(&flat, &record->pose, 0.0, STEP_RAD);
    if (asdic_expected_is_near(&place, &job->place, 0.0, 0.0)) {
        return ASDIC_OK;
    }
    job->place = place;
    return asdic_expected_compute_among(job->ctx, job->shelf, &place, 0.0, job->info.environment,
                                        job->info.sonar, job->expected);
}

/* The null hypothesis of the run's ping INDEX, and how far the level of a bin may be from it by the
 * sampling of either. MEAN_LIN is NULL with CFAR. */
static asdic_status find_background(asdic_detect_job *job, size_t index, const asdic_record *record,
                                    const double **mean_lin) {
    size_t cells = job->info.beams * job->info.bins;
    *mean_lin = NULL;
    for (size_t i = 0; i < cells; i++) {
        job->error_db[i] = isnan(record->stderr_db[i]) ? 0.0f : record->stderr_db[i];
    }
    memcpy(job->fixed_lin, job->noise_lin, cells * sizeof *job->fixed_lin);
    if (job->expected) {
        TRY(expect(job, record));
        *mean_lin = job->expected->intensity_lin[ASDIC_TOTAL];
    }
    if (job->backdrop) {
        const double *mirrored_lin;
        TRY(asdic_backdrop_read(job->backdrop, index, mean_lin, &mirrored_lin));
        asdic_backdrop_add_error(job->backdrop, job->error_db);
        for (size_t i = 0; i < cells; i++) {
            job->fixed_lin[i] += mirrored_lin[i];
        }
    }
    return ASDIC_OK;
}

static asdic_status take_ping(asdic_detect_job *job, size_t index, const asdic_record *record) {
    const double *mean = NULL;
    job->sound_speed_mps =
        asdic_environment_sound_speed_mps(job->info.environment, record->pose.position_m.z);
    TRY(asdic_namer_begin_ping(job->namer, record));
    read_truth(job, record);
    asdic_scan_set_sound_speed(job->scan, job->sound_speed_mps);
    const asdic_background law =
        asdic_background_of(job->info.sonar, job->sound_speed_mps, 1.0, 0.0);
    size_t bins = job->info.pings * job->info.beams * job->info.bins;
    asdic_k_table **table = &job->k_tables[law.looks % 2];
    TRY(asdic_k_table_fit(job->ctx, &law, bins, table));
    job->k_table = *table;
    TRY(find_background(job, index, record, &mean));
    TRY(asdic_scan_detect(job->scan, job->intensity_lin, mean, job->fixed_lin, job->error_db));
    asdic_scan_result result = asdic_scan_get(job->scan);
    for (size_t i = 0; i < job->info.beams * job->info.bins; i++) {
        job->detected[i] = job->intensity_lin[i] > result.threshold_lin[i]; /* not when NAN */
    }
    asdic_detect_count(job, record);
    TRY(asdic_detect_write_rows(job, record));
    asdic_detect_find_plots(job, record);
    if (job->map) {
        TRY(asdic_detect_add_to_map(job, record));
    }
    TRY(asdic_tracker_update(job->tracker, record->time_s, job->plots, job->plot_count));
    job->track_north_m[job->pings_done] = record->pose.position_m.x;
    job->track_yaw_rad[job->pings_done] = record->pose.yaw_rad;
    job->track_east_m[job->pings_done++] = record->pose.position_m.y;
    return asdic_detect_write_tracks(job, record);
}

static asdic_status allocate(asdic_detect_job *job) {
    size_t cells = job->info.beams * job->info.bins;
    asdic_arena *a = &job->memory;
    job->intensity_lin = asdic_arena_alloc(a, 5 * cells * sizeof *job->intensity_lin);
    job->truth = asdic_arena_alloc(a, cells * sizeof *job->truth);
    job->label = asdic_arena_alloc(a, cells * sizeof *job->label);
    job->detected = asdic_arena_alloc(a, cells * sizeof *job->detected);
    job->error_db = asdic_arena_alloc(a, cells * sizeof *job->error_db);
    job->plots = asdic_arena_alloc(a, cells * sizeof *job->plots);
    job->plot_cell = asdic_arena_alloc(a, 2 * cells * sizeof *job->plot_cell);
    size_t sights = asdic_namer_count(job->namer) * job->info.beams;
    job->sight_ping = asdic_arena_alloc(a, sights * sizeof *job->sight_ping);
    job->sight_hit = asdic_arena_alloc(a, sights * sizeof *job->sight_hit);
    job->sight_most = asdic_arena_alloc(a, sights * sizeof *job->sight_most);
    job->track_north_m = asdic_arena_alloc(a, 3 * job->info.pings * sizeof *job->track_north_m);
    if (a->is_short) {
        return asdic_fail_memory(job->ctx, "detections");
    }
    job->plot_bins = job->plot_cell + cells;
    job->noise_lin = job->intensity_lin + cells;
    job->rest_lin = job->noise_lin + cells;
    job->object_lin = job->rest_lin + cells;
    job->fixed_lin = job->object_lin + cells;
    job->track_east_m = job->track_north_m + job->info.pings;
    job->track_yaw_rad = job->track_east_m + job->info.pings;
    return ASDIC_OK;
}

/* Opens the run and chooses the detector. */
static asdic_status open_run(asdic_detect_job *job, const char *folder) {
    TRY(asdic_run_open(job->ctx, folder, &job->run));
    job->info = asdic_run_get_info(job->run);
    job->detector = job->options->detector ? *job->options->detector : job->run->settings.detector;
    job->place.flat.depth_m = NAN;
    if (job->info.pings == 0) {
        return asdic_fail(job->ctx, ASDIC_ERROR_INPUT, "'%s' holds no ping yet", folder);
    }
    if (job->run->settings.records == ASDIC_RECORD_LEVELS) {
        return asdic_fail(job->ctx, ASDIC_ERROR_INPUT,
                          "'%s' keeps levels alone, and detection needs their parts; run the scene "
                          "with 'output: {records: compact}'",
                          folder);
    }
    asdic_record first;
    TRY(asdic_run_read(job->run, 0, &first));
    job->sound_speed_mps =
        asdic_environment_sound_speed_mps(job->info.environment, first.pose.position_m.z);
    return ASDIC_OK;
}

static asdic_status simulate_background(asdic_detect_job *job) {
    if (!job->mission) {
        return asdic_fail(job->ctx, ASDIC_ERROR_INPUT,
                          "no background can be simulated: scene '%s', with its meshes and tracks, "
                          "is not there as it was when it was run",
                          job->run->facts.scene_path);
    }
    return asdic_backdrop_open(job->run, ASDIC_BACKDROP_EMPTY, job->options,
                               &job->report->background_s, &job->backdrop);
}

/* Coherent pings do not say what they are made of. */
static asdic_status find_parts(asdic_detect_job *job) {
    double simulated_s;
    if (!job->run->facts.sampling.coherent) {
        return ASDIC_OK;
    }
    if (!job->mission) {
        return asdic_fail(job->ctx, ASDIC_ERROR_INPUT,
                          "coherent pings do not say what is in a bin, and it cannot be simulated: "
                          "scene '%s', with its meshes and tracks, is not there as it was when it "
                          "was run",
                          job->run->facts.scene_path);
    }
    return asdic_backdrop_open(job->run, ASDIC_BACKDROP_PARTS, job->options, &simulated_s,
                               &job->parts);
}

/* Whether the first ping's bottom and surface mirror what they scatter. */
static asdic_status find_mirrors(asdic_detect_job *job, bool *mirrors) {
    asdic_record first;
    TRY(asdic_run_read(job->run, 0, &first));
    asdic_flat_scene flat = asdic_run_flat_scene(job->run, &first);
    *mirrors = asdic_flat_scene_mirrors(&flat, &job->run->facts.sampling);
    return ASDIC_OK;
}

/* The attitude at PING, as a place without a depth. */
static asdic_expected_place attitude_at(const asdic_detect_job *job, size_t ping) {
    const asdic_pose pose =
        asdic_mission_pose(job->mission, job->run->facts.first_ping + ping, NULL);
    const asdic_flat_scene any = {0};
    return asdic_expected_place_on_grid(&any, &pose, 0.0, STEP_RAD);
}

/* Whether so many attitudes follow each other that levels over a plane take longer than simulating them. */
static bool turns_often(const asdic_detect_job *job) {
    size_t attitudes = 1, most = MOST_ATTITUDES / job->info.beams;
    if (!job->mission || job->info.beams < FEW_BEAMS) {
        return false;
    }
    asdic_expected_place before = attitude_at(job, 0);
    for (size_t i = 1; i < job->info.pings && attitudes <= most; i++) {
        asdic_expected_place now = attitude_at(job, i);
        attitudes += !asdic_expected_is_near(&before, &now, 0.0, 0.0);
        before = now;
    }
    return attitudes > most;
}

/* Simulates the background over a plane, which can be computed as well: without a device it is. */
static asdic_status try_to_simulate(asdic_detect_job *job) {
    asdic_log(job->ctx, ASDIC_LOG_NOTE,
              "the background is simulated: so many beams and attitudes take longer to integrate; "
              "a flat background does, if it is asked for");
    asdic_status status = simulate_background(job);
    if (status == ASDIC_ERROR_DEVICE) {
        job->background = ASDIC_BACKGROUND_FLAT;
        status = ASDIC_OK;
    }
    return status;
}

/* Over a bottom that is no plane, or with mirrors, a background is simulated, where that can be; or where it is
 * quicker. */
static asdic_status choose_background(asdic_detect_job *job) {
    asdic_background_source wanted =
        job->options->has_cfar ? ASDIC_BACKGROUND_CFAR : job->options->background;
    if ((unsigned)wanted > ASDIC_BACKGROUND_CFAR) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT, "no background of kind %d", (int)wanted);
    }
    bool is_auto = wanted == ASDIC_BACKGROUND_AUTO;
    bool is_plane = strcmp(job->run->facts.bottom, ASDIC_RUN_BOTTOM_MESH) != 0, mirrors = false;
    TRY(find_mirrors(job, &mirrors));
    bool is_known = is_plane && !mirrors;
    job->background = !is_auto   ? wanted
                      : is_known ? ASDIC_BACKGROUND_FLAT
                                 : ASDIC_BACKGROUND_SIMULATED;
    if (wanted == ASDIC_BACKGROUND_FLAT && mirrors) {
        asdic_log(job->ctx, ASDIC_LOG_WARNING,
                  "a flat background knows no 'multipath: boundaries', whose echoes pass for "
                  "targets; a simulated background knows them");
    }
    if (is_auto && !is_known && !job->mission) {
        job->background = ASDIC_BACKGROUND_CFAR;
    }
    if (is_auto && is_known && turns_often(job)) {
        job->background = ASDIC_BACKGROUND_SIMULATED;
        TRY(try_to_simulate(job));
    } else if (job->background == ASDIC_BACKGROUND_SIMULATED) {
        TRY(simulate_background(job));
    }
    if (job->background == ASDIC_BACKGROUND_FLAT) {
        TRY(asdic_ping_create(job->ctx, job->info.beams, job->info.bins, &job->expected));
        TRY(asdic_ring_shelf_create(job->ctx, ATTITUDES, &job->shelf));
    }
    job->report->background = job->background;
    job->report->by_cfar = job->background == ASDIC_BACKGROUND_CFAR;
    if (asdic_detect_is_unknown(job)) {
        asdic_log(job->ctx, ASDIC_LOG_WARNING,
                  "thresholds of CFAR are those of Rayleigh speckle; K speckle exceeds them more "
                  "often than P_FA says, and how often is not predicted");
    }
    const asdic_cfar *cfar = job->report->by_cfar ? &job->options->cfar : NULL;
    TRY(asdic_scan_create(job->ctx, job->info.sonar, job->sound_speed_mps, job->info.bins,
                          &job->detector, cfar, &job->scan));
    asdic_scan_set_coherent(job->scan, job->info.sampling.coherent);
    return ASDIC_OK;
}

/* Loads the run's scene again, if it and all that it reads are as they were. */
static asdic_status load_scene(asdic_detect_job *job) {
    const asdic_run_facts *facts = &job->run->facts;
    char hex[65];
    TRY(asdic_mission_load_same(job->ctx, facts->scene_path, facts->scene_hash, &job->mission));
    if (!job->mission) {
        return ASDIC_OK;
    }
    TRY(asdic_mission_inputs_hash(job->ctx, job->mission, hex));
    if (strcmp(hex, facts->geometry_hash) != 0) {
        asdic_mission_destroy(&job->mission);
    }
    return ASDIC_OK;
}

/* What a run's detection needs before its first ping. Files and map are opened before a background is
 * simulated, which takes time: they may be refused. */
static asdic_status begin(asdic_detect_job *job, const char *folder) {
    TRY(open_run(job, folder));
    TRY(load_scene(job));
    TRY(asdic_namer_create(job->run, job->mission, &job->namer));
    TRY(asdic_tracker_create(job->ctx, &job->options->tracker, &job->tracker));
    TRY(allocate(job));
    TRY(asdic_detect_report_create(job));
    TRY(asdic_detect_open_files(job));
    TRY(asdic_detect_create_map(job));
    TRY(find_parts(job));
    return choose_background(job);
}

static void finish(asdic_detect_job *job) {
    asdic_file_discard(&job->detections);
    asdic_file_discard(&job->tracks);
    asdic_mcap_recording_discard(&job->messages);
    asdic_occupancy_destroy(&job->map);
    asdic_tracker_destroy(&job->tracker);
    asdic_namer_destroy(&job->namer);
    asdic_scan_destroy(&job->scan);
    asdic_k_table_destroy(&job->k_tables[0]);
    asdic_k_table_destroy(&job->k_tables[1]);
    asdic_backdrop_close(&job->backdrop);
    asdic_backdrop_close(&job->parts);
    asdic_ping_destroy(&job->expected);
    asdic_ring_shelf_destroy(&job->shelf);
    asdic_detect_report_destroy(&job->report);
    asdic_mission_destroy(&job->mission);
    asdic_run_close(&job->run);
    free(job->track_seen);
    asdic_arena_finish(&job->memory);
}

static asdic_status detect(asdic_detect_job *job) {
    double begin_s = asdic_clock_s();
    for (size_t i = 0; i < job->info.pings; i++) {
        asdic_record record;
        if (asdic_context_interrupted(job->ctx)) {
            return asdic_fail(job->ctx, ASDIC_ERROR_INTERRUPTED,
                              "interrupted after %zu of %zu pings; nothing was written", i,
                              job->info.pings);
        }
        TRY(asdic_run_read(job->run, i, &record));
        if (job->parts) {
            TRY(asdic_backdrop_tell(job->parts, i, &record));
        }
        TRY(take_ping(job, i, &record));
        asdic_run_progress now = {.pings_done = i + 1,
                                  .pings_total = job->info.pings,
                                  .elapsed_s = asdic_clock_s() - begin_s};
        if (job->options->progress) {
            job->options->progress(job->options->user, &now);
        }
    }
    TRY(asdic_detect_expect_tracks(job));
    TRY(asdic_file_commit(&job->detections));
    TRY(asdic_file_commit(&job->tracks));
    if (job->messages) {
        TRY(asdic_mcap_recording_commit(&job->messages));
    }
    return job->map ? asdic_detect_draw_map(job) : ASDIC_OK;
}

/* By how much thresholds are higher for the levels' sampling error, in the median bin. */
static asdic_status find_lift(asdic_detect_job *job) {
    asdic_detect_report *r = job->report;
    asdic_background law = asdic_background_of(job->info.sonar, job->sound_speed_mps, 1.0, 0.0);
    double stated_db = job->run->facts.errors.median_db;
    r->sampling_error_db = isnan(stated_db) ? 0.0 : stated_db; /* coherent pings state none */
    r->background_error_db = job->backdrop ? asdic_backdrop_error_db(job->backdrop) : 0.0;
    double error_db = hypot(r->sampling_error_db, r->background_error_db);
    asdic_background blurred = asdic_background_blurred(law, error_db);
    double before, after;
    TRY(asdic_detect_threshold(job->ctx, &law, r->detector.pfa, &before));
    TRY(asdic_detect_threshold(job->ctx, &blurred, r->detector.pfa, &after));
    if (isnan(r->detector.cost_ratio)) {
        r->sampling_lift_db = asdic_level_db(after / before);
    }
    return ASDIC_OK;
}

static asdic_status work(asdic_detect_job *job, const char *folder) {
    TRY(begin(job, folder));
    TRY(detect(job));
    return find_lift(job);
}

asdic_status asdic_run_detect(asdic_context *ctx, const char *folder,
                              const asdic_detect_options *options, asdic_detect_report **out) {
    asdic_detect_job job = {.ctx = ctx, .options = options};
    bool wants_report = ASDIC_PLACE(out);
    if (!folder || !options) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "asdic_run_detect: a folder and options");
    }
    double cell_m = options->cell_m, truth_db = options->truth_snr_db;
    if (cell_m != 0.0 && (cell_m < ASDIC_DETECT_MIN_CELL_M || cell_m > ASDIC_DETECT_MAX_CELL_M)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a map of cells of %g m: must be in [%g, %g]",
                          cell_m, ASDIC_DETECT_MIN_CELL_M, ASDIC_DETECT_MAX_CELL_M);
    }
    if (!(truth_db >= ASDIC_DETECTOR_MIN_SNR_DB && truth_db <= ASDIC_DETECTOR_MAX_SNR_DB)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "truth from %g dB: must be in [%g, %g]",
                          truth_db, ASDIC_DETECTOR_MIN_SNR_DB, ASDIC_DETECTOR_MAX_SNR_DB);
    }
    locale_t before = asdic_c_locale_enter();
    asdic_status status = work(&job, folder);
    if (status == ASDIC_OK && wants_report) {
        asdic_detect_finish_report(&job);
        *out = job.report;
        job.report = NULL;
    }
    finish(&job);
    asdic_c_locale_leave(before);
    return status;
}
