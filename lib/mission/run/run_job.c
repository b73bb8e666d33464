#include "run_job.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/file_name.h"
#include "base/number.h"
#include "base/sha256.h"
#include "base/try.h"
#include "mission/mission.h"
#include "run_chart_data.h"
#include "run_check.h"
#include "run_folder.h"
#include "run_picture.h"
#include "run_files.h"
#include "sim/coherent.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* --- what is to be run ------------------------------------------------------------------------ */

static asdic_status check_range(asdic_run_job *job) {
    const asdic_run_options *o = job->options;
    size_t pings = asdic_mission_ping_count(job->mission);
    if (!o->folder || !o->folder[0]) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT, "a run needs a folder to write to");
    }
    if (o->count == 0) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "a run of no pings from ping %zu on; SIZE_MAX asks for all", o->first);
    }
    if (o->first >= pings) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "no ping to run: ping %zu asked for, but the mission has pings 0..%zu",
                          o->first, pings - 1);
    }
    if (o->count != SIZE_MAX && o->count > pings - o->first) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "%zu pings from ping %zu on go beyond the mission's %zu pings (0..%zu)",
                          o->count, o->first, pings, pings - 1);
    }
    TRY(asdic_folder_check_mode(job->ctx, o->force, o->resume));
    asdic_run_facts *f = &job->facts;
    f->first_ping = o->first;
    f->pings_planned = o->count < pings - o->first ? o->count : pings - o->first;
    f->whole_first_ping = o->of_count ? o->of_first : f->first_ping;
    f->whole_pings = o->of_count ? o->of_count : f->pings_planned;
    if (f->whole_first_ping > f->first_ping || f->whole_pings > pings - f->whole_first_ping ||
        f->first_ping + f->pings_planned > f->whole_first_ping + f->whole_pings) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "pings %zu to %zu are no part of %zu pings from ping %zu on",
                          f->first_ping, f->first_ping + f->pings_planned - 1, f->whole_pings,
                          f->whole_first_ping);
    }
    return ASDIC_OK;
}

static const char *bottom_of(const asdic_mission *mission) {
    if (asdic_mission_bottom_mesh(mission)) {
        return ASDIC_RUN_BOTTOM_MESH;
    }
    return asdic_scene_get_info(asdic_mission_scene(mission)).has_bottom_plane
               ? ASDIC_RUN_BOTTOM_PLANE
               : ASDIC_RUN_BOTTOM_NONE;
}

/* The scene's path as it is from any folder. */
static const char *path_from_root(asdic_run_job *job) {
    const char *path = asdic_mission_path(job->mission);
    char *here = path[0] == '/' || strcmp(path, "-") == 0 ? NULL : getcwd(NULL, 0), *whole = NULL;
    if (here && asprintf(&whole, "%s/%s", here, path) >= 0) {
        path = asdic_arena_string(&job->arena, whole, strlen(whole));
        free(whole);
    }
    free(here);
    return path;
}

/* The simulation follows the plan from here on. */
static asdic_status plan(asdic_run_job *job) {
    asdic_run_facts *f = &job->facts;
    double begin_s = asdic_clock_s();
    TRY(asdic_mission_refract_as_needed(job->ctx, job->mission));
    TRY(asdic_mission_plan(job->ctx, job->mission, &f->plan));
    f->times.plan_s = asdic_clock_s() - begin_s;
    asdic_mission_sampling(job->mission)->left_out = f->plan.left_out;
    f->sampling = *asdic_mission_sampling(job->mission);
    const asdic_environment *env = asdic_mission_environment(job->mission);
    f->refraction = env->refraction;
    f->layer_from_m = env->layer_from_m;
    f->layer_to_m = env->layer_to_m;
    return ASDIC_OK;
}

/* Fills the facts that are known before the first ping. */
static asdic_status describe(asdic_run_job *job) {
    asdic_run_facts *f = &job->facts;
    const asdic_mission *m = job->mission;
    const asdic_sonar *sonar = asdic_mission_sonar(m);
    TRY(plan(job));
    double speed_mps = asdic_mission_speed_mps(m);
    f->version = asdic_version();
    f->state = ASDIC_RUN_RUNNING;
    f->scene_path = path_from_root(job);
    if (!f->scene_path) {
        return asdic_fail_memory(job->ctx, "the scene's path");
    }
    f->scene_hash = asdic_mission_hash(m);
    f->scene_text = asdic_mission_text(m);
    f->geometry_hash = job->inputs_hash;
    f->has_surface = asdic_scene_get_info(asdic_mission_scene(m)).has_surface;
    f->bottom = bottom_of(m);
    asdic_flat_scene flat = asdic_mission_flat_scene(m, f->first_ping);
    f->bottom_law = flat.bottom;
    f->surface_law = flat.surface;
    f->uncertainty = asdic_mission_uncertainty(m);
    f->remarks = asdic_mission_remarks(m);
    f->beams = sonar->receiver_count;
    f->bins = asdic_sonar_bin_count(sonar, speed_mps);
    f->bin_length_m = sonar->bin_length_m;
    if (m->settings.elements) {
        asdic_coherent_grid grid = asdic_coherent_grid_of(sonar, speed_mps, f->bins);
        f->elements = (asdic_run_elements){sonar->array.spacing_m, grid.sample_m,
                                           speed_mps / sonar->frequency_hz};
    }
    f->sweep = m->settings.sweep;
    f->errors = (asdic_run_errors){NAN, NAN, NAN};
    f->rays_per_s = NAN;
    return asdic_mission_inputs_hash(job->ctx, m, job->inputs_hash);
}

void asdic_job_hash(const asdic_run_job *job, char hex[65]) {
    char text[512];
    const asdic_run_facts *f = &job->facts;
    const asdic_sampling *s = &f->sampling;
    int length = snprintf(text, sizeof text, "%s %s %s %zu+%zu %zu*%zu %u %d %d %llu %u",
                          f->version, f->scene_hash, f->geometry_hash, f->first_ping,
                          f->pings_planned, f->beams, f->bins, s->rays, (int)s->sampler,
                          (int)s->multipath, (unsigned long long)s->seed, s->left_out);
    asdic_sha256_hex(text, (size_t)length, hex);
}

/* Lists the devices of an earlier call that this one does not use, then this call's. */
static asdic_status list_devices(asdic_run_job *job, const asdic_run_facts *earlier) {
    asdic_run_facts *f = &job->facts;
    size_t most = job->device_count + earlier->device_count;
    f->devices = asdic_arena_alloc(&job->arena, most * sizeof *f->devices);
    if (!f->devices) {
        return asdic_fail_memory(job->ctx, "device names");
    }
    for (size_t i = 0; i < earlier->device_count; i++) {
        bool is_used = false;
        for (size_t k = 0; k < job->device_count; k++) {
            const char *name = asdic_device_get_info(job->devices[k])->name;
            is_used = is_used || strcmp(name, earlier->devices[i]) == 0;
        }
        if (!is_used) {
            f->devices[f->device_count++] = earlier->devices[i];
        }
    }
    for (size_t k = 0; k < job->device_count; k++) {
        f->devices[f->device_count++] = asdic_device_get_info(job->devices[k])->name;
    }
    return ASDIC_OK;
}

static asdic_status compare(asdic_run_job *job, const asdic_run_facts *earlier) {
    const asdic_run_facts *f = &job->facts;
    const char *difference = asdic_run_facts_differ(f, earlier);
    if (!difference &&
        (f->first_ping != earlier->first_ping || f->pings_planned != earlier->pings_planned)) {
        difference = "range of pings";
    }
    if (difference) {
        return asdic_fail(job->ctx, ASDIC_ERROR_EXISTS,
                          "'%s' holds a run with another %s; it cannot be resumed, --force "
                          "replaces it",
                          job->options->folder, difference);
    }
    return ASDIC_OK;
}

asdic_status asdic_job_describe(asdic_run_job *job) {
    TRY(check_range(job));
    if (job->mission->settings.elements && job->options->team) {
        return asdic_fail(job->ctx, ASDIC_ERROR_UNSUPPORTED,
                          "'output: {elements: true}' is not possible where several processes "
                          "share a run; use --shard and 'asdic merge'");
    }
    locale_t before = asdic_c_locale_enter(); /* run.json keeps remarks and reasons */
    asdic_status status = describe(job);
    asdic_c_locale_leave(before);
    return status;
}

/* --- the beginning ---------------------------------------------------------------------------- */

static asdic_status open_store(asdic_run_job *job, asdic_store_mode mode) {
    const asdic_run_facts *f = &job->facts;
    const asdic_store_shape shape = {
        .first_ping = f->first_ping,
        .layout = asdic_store_layout(&job->mission->settings, f->beams, f->bins, f->plan.left_out)};
    return asdic_store_open(job->ctx, job->options->folder, mode, &shape, &job->store);
}

/* Of the pressures that the run writes. */
static asdic_elements_shape elements_of(const asdic_run_job *job) {
    const asdic_settings *settings = &job->mission->settings;
    return asdic_elements_shape_of(settings, job->facts.pings_planned, job->facts.bins,
                                   asdic_mission_speed_mps(job->mission));
}

static asdic_status open_elements(asdic_run_job *job, bool goes_on) {
    asdic_store_mode mode = goes_on ? ASDIC_STORE_RESUME : ASDIC_STORE_CREATE;
    job->elements_shape = elements_of(job);
    return asdic_elements_open(job->ctx, job->options->folder, mode, &job->elements_shape,
                               &job->elements);
}

static void warn_of_damage(asdic_context *ctx) {
    asdic_log(ctx, ASDIC_LOG_WARNING, "%s; made again", asdic_context_error(ctx));
}

/* Finds the pings whose records are whole; every other is to be made. After an interruption the rest
 * is taken to be whole, unread: the run ends before it uses them. */
static void find_whole(asdic_run_job *job) {
    size_t stored = asdic_store_count(job->store), planned = job->facts.pings_planned;
    size_t failed = 0, told = job->damaged;
    job->to_make = planned;
    for (size_t i = 0; i < stored && i < planned; i++) {
        bool is_read = !asdic_context_interrupted(job->ctx);
        asdic_status status = is_read ? asdic_store_read(job->store, i, job->bytes) : ASDIC_OK;
        bool has_elements = !job->elements || i < asdic_records_count(job->elements);
        job->is_there[i] = status == ASDIC_OK && has_elements;
        job->to_make -= job->is_there[i];
        failed += status != ASDIC_OK;
        if (status != ASDIC_OK && failed == 1 && told == 0) {
            warn_of_damage(job->ctx);
        }
    }
    job->damaged = failed;
    if (failed > 1 && told == 0) {
        asdic_log(job->ctx, ASDIC_LOG_WARNING, "'%s': %zu more of its pings are damaged",
                  job->options->folder, failed - 1);
    }
}

/* Sets *ARE_WHOLE where a run that ended has the elements that it wrote. Nothing says which pings of a
 * damaged file are good: it is removed, so that all are made again. */
static asdic_status check_elements(asdic_run_job *job, const asdic_run_facts *earlier,
                                   bool *are_whole) {
    asdic_elements_shape shape = elements_of(job);
    asdic_status status =
        asdic_run_check(job->ctx, job->options->folder, earlier, ASDIC_RUN_ELEMENTS);
    if (status == ASDIC_ERROR_INPUT) {
        *are_whole = false;
        unlinkat(dirfd(job->lock), ASDIC_ELEMENTS_NAME, 0);
        return ASDIC_OK;
    }
    *are_whole = asdic_elements_complete(job->ctx, job->options->folder, &shape);
    return status;
}

/* Whether a run that ended has still all that it wrote; a warning says what not. */
static asdic_status check_complete(asdic_run_job *job, const asdic_run_facts *earlier) {
    bool are_whole = false; /* the elements */
    TRY(check_elements(job, earlier, &are_whole));
    asdic_status status = open_store(job, ASDIC_STORE_READ);
    if (status == ASDIC_ERROR_MEMORY) {
        return status;
    }
    if (status == ASDIC_OK) {
        find_whole(job);
        asdic_store_close(&job->store);
        if (asdic_context_interrupted(job->ctx)) {
            return asdic_fail(job->ctx, ASDIC_ERROR_INTERRUPTED,
                              "interrupted while the pings in '%s' were checked; --resume goes on",
                              job->options->folder);
        }
        if (job->damaged == 0 && job->to_make > 0) {
            status = asdic_fail(job->ctx, ASDIC_ERROR_INPUT, "'%s' lacks %zu of %zu pings",
                                job->options->folder, job->to_make, job->facts.pings_planned);
        }
    }
    if (status == ASDIC_OK && !are_whole) {
        status =
            asdic_fail(job->ctx, ASDIC_ERROR_INPUT,
                       "'%s/" ASDIC_ELEMENTS_NAME "' is missing or damaged", job->options->folder);
    }
    if (status == ASDIC_OK && job->damaged == 0) {
        status = asdic_run_check(job->ctx, job->options->folder, earlier, ASDIC_RUN_ALL);
    }
    if (status == ASDIC_ERROR_MEMORY) {
        return status;
    }
    if (status != ASDIC_OK) {
        warn_of_damage(job->ctx);
    }
    job->is_complete = status == ASDIC_OK && job->damaged == 0;
    return ASDIC_OK;
}

/* Damaged pings of such a run are made again as they were. */
static bool was_complete(const asdic_run_facts *earlier) {
    return strcmp(earlier->state, ASDIC_RUN_COMPLETE) == 0;
}

/* Reads what an earlier call left in the folder, which must be of the same run. */
static asdic_status read_earlier(asdic_run_job *job, asdic_run_facts *earlier) {
    TRY(asdic_run_facts_read(job->ctx, job->options->folder, &job->arena, earlier));
    TRY(compare(job, earlier));
    return was_complete(earlier) ? check_complete(job, earlier) : ASDIC_OK;
}

/* What would fail only once the folder is changed. */
static asdic_status check_files(const asdic_run_job *job) {
    TRY(asdic_files_check(job->ctx, &job->mission->settings));
    return asdic_run_check_room(job->ctx, job->mission, job->options);
}

/* Opens the store of a new run or of the one to be resumed. */
static asdic_status open_run(asdic_run_job *job) {
    const char *folder = job->options->folder;
    asdic_run_facts earlier = {0};
    bool goes_on = job->options->resume && asdic_folder_has_run(folder);
    if (!goes_on) {
        TRY(check_files(job));
    }
    if (job->options->force) {
        TRY(asdic_folder_spare(job->ctx, folder, asdic_mission_path(job->mission),
                               asdic_mission_text(job->mission),
                               job->options->own_track ? "track.csv" : ""));
    }
    TRY(asdic_folder_hold(job->ctx, folder, &job->lock));
    TRY(goes_on ? read_earlier(job, &earlier)
                : asdic_folder_prepare(job->ctx, folder, job->options->force, true));
    if (job->is_complete) {
        return ASDIC_OK;
    }
    if (goes_on) {
        TRY(check_files(job));
    }
    TRY(list_devices(job, &earlier));
    TRY(asdic_run_facts_write(job->ctx, folder, &job->facts));
    TRY(open_store(job, goes_on ? ASDIC_STORE_RESUME : ASDIC_STORE_CREATE));
    TRY(asdic_store_cut(job->store, job->facts.pings_planned));
    TRY(open_elements(job, goes_on));
    find_whole(job);
    /* One that was complete, whose mending was interrupted, has all its records, damaged ones too. */
    bool grows = goes_on && !was_complete(&earlier) &&
                 asdic_store_count(job->store) < job->facts.pings_planned;
    return grows ? asdic_folder_drop_found(job->ctx, folder, job->lock) : ASDIC_OK;
}

/* Writes the poses of the vehicle at the run's pings. */
static asdic_status write_track(asdic_run_job *job) {
    return asdic_mission_write_pings(job->ctx, job->mission, job->facts.first_ping,
                                     job->facts.pings_planned,
                                     asdic_file_in(job->options->folder, "track.csv").text);
}

static asdic_status open_files(asdic_run_job *job) {
    const char *folder = job->options->folder;
    asdic_pose first = asdic_mission_pose(job->mission, job->facts.first_ping, NULL);
    TRY(write_track(job));
    TRY(asdic_chart_data_write(job->ctx, job->mission, folder));
    return asdic_files_create(job->ctx, folder, &job->mission->settings, &job->facts,
                              first.position_m.z, &job->files);
}

asdic_status asdic_job_begin(asdic_run_job *job) {
    TRY(asdic_job_describe(job));
    job->bytes = malloc(asdic_record_bytes(job->facts.beams, job->facts.bins));
    job->is_there = calloc(job->facts.pings_planned, sizeof *job->is_there);
    if (!job->bytes || !job->is_there) {
        return asdic_fail_memory(job->ctx, "a record");
    }
    TRY(open_run(job));
    if (job->is_complete) {
        return ASDIC_OK;
    }
    double begin_s = asdic_clock_s();
    asdic_status status = open_files(job);
    job->facts.times.write_s += asdic_clock_s() - begin_s;
    TRY(status);
    return asdic_summary_create_all(job->ctx, &job->mission->settings, &job->facts, &job->summary);
}

asdic_status asdic_job_begin_stream(asdic_run_job *job) {
    TRY(asdic_job_describe(job));
    if (job->mission->settings.elements) {
        return asdic_fail(job->ctx, ASDIC_ERROR_UNSUPPORTED,
                          "'output: {elements: true}' needs a run folder: give one with -o, or use "
                          "false");
    }
    job->bytes = malloc(asdic_record_bytes(job->facts.beams, job->facts.bins));
    if (!job->bytes) {
        return asdic_fail_memory(job->ctx, "a record");
    }
    return asdic_files_create_stream(job->ctx, &job->mission->settings, job->facts.bins,
                                     &job->files);
}

/* --- ping by ping ----------------------------------------------------------------------------- */

static asdic_status keep(asdic_run_job *job, const void *bytes) {
    asdic_record record;
    double begin_s = asdic_clock_s();
    asdic_record_view(bytes, job->facts.beams, job->facts.bins, &record);
    asdic_status status = asdic_files_add(job->files, &record);
    double written_s = asdic_clock_s();
    asdic_summary_add(job->summary, &record);
    job->facts.times.write_s += written_s - begin_s;
    job->facts.times.pictures_s += asdic_clock_s() - written_s;
    job->kept++;
    return status;
}

asdic_status asdic_job_take_again(asdic_run_job *job) {
    TRY(asdic_store_read(job->store, job->kept, job->bytes));
    return keep(job, job->bytes);
}

asdic_status asdic_job_take(asdic_run_job *job, void *bytes) {
    double begin_s = asdic_clock_s();
    if (job->store) {
        TRY(asdic_store_write(job->store, job->kept, bytes));
        job->to_make--;
    }
    job->facts.times.write_s += asdic_clock_s() - begin_s;
    return keep(job, bytes);
}

size_t asdic_job_stored(const asdic_run_job *job) {
    return job->facts.pings_planned - job->to_make;
}

/* --- the end ---------------------------------------------------------------------------------- */

static void conclude(asdic_run_job *job) {
    asdic_run_facts *f = &job->facts;
    asdic_summary_end(job->summary);
    f->pings = job->kept;
    asdic_run_facts_statistics(f, &job->summary->statistics);
    if (f->saturated > 0) {
        asdic_log(job->ctx, ASDIC_LOG_WARNING,
                  "%llu echoes were too strong for the accumulator and were cut",
                  (unsigned long long)f->saturated);
    }
}

static asdic_status draw(asdic_run_job *job) {
    asdic_render_options options = asdic_render_options_default();
    double begin_s = asdic_clock_s();
    asdic_status status = ASDIC_OK;
    if (asdic_mission_output(job->mission)->images != 0) {
        status = asdic_run_render_summary(job->ctx, job->options->folder, &options, job->summary);
    }
    job->facts.times.pictures_s += asdic_clock_s() - begin_s;
    return status;
}

static asdic_status write_facts(asdic_run_job *job) {
    job->facts.times.whole_s = asdic_clock_s() - job->begin_s;
    return asdic_run_facts_write(job->ctx, job->options->folder, &job->facts);
}

static asdic_status commit(asdic_run_job *job, bool is_whole) {
    TRY(asdic_store_commit(job->store));
    TRY(asdic_files_commit(job->files, is_whole));
    TRY(is_whole && job->elements ? asdic_records_commit(job->elements) : ASDIC_OK);
    conclude(job);
    return asdic_run_check_note(job->ctx, job->options->folder, &job->arena, &job->facts);
}

asdic_status asdic_job_end(asdic_run_job *job, bool is_whole) {
    double begin_s = asdic_clock_s();
    asdic_status status = commit(job, is_whole);
    job->facts.times.write_s += asdic_clock_s() - begin_s;
    TRY(status);
    /* The run is complete only with its pictures: --resume draws what is missing. */
    job->facts.state = ASDIC_RUN_STOPPED;
    TRY(write_facts(job));
    if (!is_whole) {
        return ASDIC_OK;
    }
    TRY(draw(job));
    TRY(asdic_folder_pictures(job->ctx, job->options->folder, &job->arena, &job->facts.pictures,
                              &job->facts.picture_count));
    job->facts.state = ASDIC_RUN_COMPLETE;
    return write_facts(job);
}

void asdic_job_finish(asdic_run_job *job) {
    asdic_files_destroy(&job->files);
    asdic_records_close(&job->elements);
    asdic_store_close(&job->store);
    asdic_summary_destroy(&job->summary);
    asdic_arena_finish(&job->arena);
    free(job->bytes);
    free(job->is_there);
    if (job->lock) {
        closedir(job->lock);
    }
}
