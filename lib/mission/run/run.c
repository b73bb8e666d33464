/*
 * Running a mission: pings from the devices into pings.npy and bins.csv, then pictures and
 * run.json.
 */
#include "run_job.h"

#include "base/clock.h"
#include "base/context.h"
#include "mission/mission.h"
#include "base/try.h"
#include "run_folder.h"
#include "run_workers.h"

#include <string.h>
#include <unistd.h>

asdic_run_options asdic_run_options_default(void) {
    return (asdic_run_options){.count = SIZE_MAX};
}

static void report(const asdic_run_job *job, double since_s) {
    const asdic_run_options *o = job->options;
    if (o->progress) {
        asdic_run_progress progress = {.pings_done = job->kept,
                                       .pings_total = job->facts.pings_planned,
                                       .rays = job->rays,
                                       .elapsed_s = asdic_clock_s() - since_s};
        o->progress(o->user, &progress);
    }
}

/* The numbers that are stored with RESULT's levels. */
static asdic_record_head head_of(const asdic_mission *mission, size_t ping,
                                 const asdic_ping *result) {
    asdic_record_head head = {.ping = ping, .rays = result->rays, .saturated = result->saturated};
    asdic_pose pose = asdic_mission_pose(mission, ping, &head.time_s);
    head.position_m[0] = pose.position_m.x;
    head.position_m[1] = pose.position_m.y;
    head.position_m[2] = pose.position_m.z;
    head.attitude_rad[0] = pose.roll_rad;
    head.attitude_rad[1] = pose.pitch_rad;
    head.attitude_rad[2] = pose.yaw_rad;
    head.altitude_m = asdic_scene_altitude_m(asdic_mission_scene(mission), pose.position_m);
    return head;
}

typedef struct taker {
    asdic_run_job *job;
    asdic_work_result result;
} taker;

/* Takes the next ping. Of a long mission not all were tested when it was loaded. */
static asdic_status take(void *user, size_t ping, const asdic_ping *result) {
    taker *t = user;
    asdic_run_job *job = t->job;
    double begin_s = asdic_clock_s();
    char below[ASDIC_BELOW_BOTTOM_SIZE];
    if (asdic_mission_is_below_bottom(job->mission, ping, below)) {
        return asdic_fail(job->ctx, ASDIC_ERROR_INPUT, "%s", below);
    }
    asdic_record_head head = head_of(job->mission, ping, result);
    asdic_record_pack(&head, result, job->bytes);
    job->facts.times.write_s += asdic_clock_s() - begin_s;
    if (result->pressure) {
        TRY(asdic_records_write(job->elements, job->kept, result->pressure));
    }
    TRY(asdic_job_take(job, job->bytes));
    job->rays += result->rays;
    report(job, t->result.ready_s);
    return ASDIC_OK;
}

/* Lists a device of another process for run.json. */
static void name_device(void *user, const char *device) {
    asdic_run_job *job = ((taker *)user)->job;
    asdic_run_facts_add_device(&job->facts, &job->arena, device);
}

/* Simulates the next pings, to END. The other processes of a team help with the last ones only: they
 * begin once. */
static asdic_status simulate(asdic_run_job *job, size_t end) {
    taker t = {.job = job};
    char hash[65];
    asdic_job_hash(job, hash);
    double begin_s = asdic_clock_s();
    asdic_work work = {.mission = job->mission,
                       .devices = job->devices,
                       .device_count = job->device_count,
                       .first = job->facts.first_ping + job->kept,
                       .end = job->facts.first_ping + end,
                       .bins = job->facts.bins,
                       .elements = job->elements_shape,
                       .take = take,
                       .name = name_device,
                       .team = end == job->facts.pings_planned ? job->options->team : NULL,
                       .run_hash = hash,
                       .user = &t};
    report(job, begin_s);
    asdic_status status = asdic_workers_run(job->ctx, &work, &t.result);
    double end_s = asdic_clock_s();
    asdic_run_times *times = &job->facts.times;
    times->setup_s += t.result.ready_s - begin_s;
    times->simulate_s += end_s - t.result.ready_s;
    times->devices_s += t.result.devices_s;
    job->facts.rays_per_s = (double)job->rays / times->simulate_s;
    return status;
}

/* Takes all pings in turn: those that are there, and those that are made now. */
static asdic_status take_all(asdic_run_job *job) {
    size_t planned = job->facts.pings_planned;
    while (job->kept < planned && !asdic_context_interrupted(job->ctx)) {
        size_t end = job->kept;
        while (end < planned && !job->is_there[end]) {
            end++;
        }
        TRY(end == job->kept ? asdic_job_take_again(job) : simulate(job, end));
    }
    return asdic_context_interrupted(job->ctx)
               ? asdic_fail(job->ctx, ASDIC_ERROR_INTERRUPTED, "interrupted at ping %zu",
                            job->facts.first_ping + job->kept)
               : ASDIC_OK;
}

/* Adds to the context's sentence what is kept and how to continue. */
static asdic_status explain(asdic_run_job *job, asdic_status status) {
    if (access(job->options->folder, F_OK) != 0) {
        return asdic_fail(job->ctx, status, "%s; '%s' has been removed, and with it its pings",
                          asdic_context_error(job->ctx), job->options->folder);
    }
    return asdic_fail(job->ctx, status, "%s; %zu of %zu pings are kept in '%s', --resume goes on",
                      asdic_context_error(job->ctx), asdic_job_stored(job),
                      job->facts.pings_planned, job->options->folder);
}

/* Ends the run after the pings, whether all are there or not. */
static asdic_status wind_up(asdic_run_job *job, asdic_status status) {
    if (status == ASDIC_OK) {
        status = asdic_job_end(job, true);
        return status == ASDIC_OK ? status : explain(job, status);
    }
    if (status != ASDIC_ERROR_INTERRUPTED && asdic_job_stored(job) == 0) {
        /* No device did anything: there is nothing to keep. */
        asdic_folder_remove(job->options->folder);
        return status;
    }
    status = explain(job, status);
    if (status == ASDIC_ERROR_IO) {
        return status; /* the disk is full or gone: what was appended stays as it is */
    }
    TRY(asdic_job_end(job, false));
    return status;
}

static asdic_status run_into_folder(asdic_run_job *job) {
    TRY(asdic_job_begin(job));
    return job->is_complete ? ASDIC_OK : wind_up(job, take_all(job));
}

/* The rows of bins.csv to the standard output, as they come. */
static asdic_status run_to_stream(asdic_run_job *job) {
    if (job->options->resume) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "what went to the standard output cannot be resumed; give a folder");
    }
    TRY(asdic_job_begin_stream(job));
    asdic_status status = simulate(job, job->facts.pings_planned);
    asdic_status closed =
        asdic_files_commit(job->files, false); /* whole rows, also when interrupted */
    return status == ASDIC_OK ? closed : status;
}

asdic_status asdic_mission_run(asdic_context *ctx, asdic_mission *mission, asdic_device **devices,
                               size_t device_count, const asdic_run_options *options) {
    if (mission && (mission->is_varied || mission->is_chosen)) {
        return asdic_fail(ctx, ASDIC_ERROR_UNSUPPORTED,
                          "a mission with settings or choices that its text does not say cannot be "
                          "run; write them into a scene file");
    }
    if (!mission || !options || !asdic_devices_are_there(devices, device_count)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "asdic_mission_run: a mission, options and a device are needed");
    }
    asdic_run_job job = {.ctx = ctx,
                         .mission = mission,
                         .devices = devices,
                         .device_count = device_count,
                         .options = options,
                         .begin_s = asdic_clock_s()};
    bool is_worker = options->team && options->team->rank > 0;
    bool is_stream = options->folder && strcmp(options->folder, "-") == 0;
    asdic_status status = is_worker   ? asdic_team_worker_run(&job)
                          : is_stream ? run_to_stream(&job)
                                      : run_into_folder(&job);
    if (options->times) {
        *options->times = job.facts.times;
        options->times->whole_s = asdic_clock_s() - job.begin_s;
    }
    asdic_job_finish(&job);
    return status;
}
