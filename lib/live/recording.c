#include "recording.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/file_name.h"
#include "base/try.h"
#include "mission/mission.h"
#include "mission/run/run_job.h"
#include "mission/track/track.h"
#include "out/file.h"
#include "out/record.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MOST_NUMBERS 1000

struct asdic_recording {
    asdic_context *ctx;
    const asdic_mission *mission;
    asdic_device *device;
    char *folder;
    unsigned number;
    asdic_file *track;
    FILE *spool;     /* records; an unnamed file that vanishes with the process */
    void *bytes;     /* one record */
    float *pressure; /* at the elements, behind each record; NULL: not recorded */
    size_t record_bytes, pressure_bytes, pings, beams, bins;
};

static asdic_status fail_io(asdic_recording *r, const char *what) {
    return asdic_fail(r->ctx, ASDIC_ERROR_IO, "cannot write %s of recording '%s': %s", what,
                      r->folder, strerror(errno));
}

static asdic_status make_folder(asdic_recording *r, const char *parent) {
    TRY(asdic_folder_make(r->ctx, parent));
    for (r->number = 0; r->number < MOST_NUMBERS; r->number++) {
        free(r->folder);
        if (asprintf(&r->folder, "%s/%03u", parent, r->number) < 0) {
            r->folder = NULL;
            return asdic_fail_memory(r->ctx, "a recording's name");
        }
        if (mkdir(r->folder, 0777) == 0) {
            return ASDIC_OK;
        }
        if (errno != EEXIST) {
            return asdic_fail(r->ctx, ASDIC_ERROR_IO, "cannot create folder '%s': %s", r->folder,
                              strerror(errno));
        }
    }
    return asdic_fail(r->ctx, ASDIC_ERROR_EXISTS, "'%s' holds %d recordings; give another folder",
                      parent, MOST_NUMBERS);
}

static void finish(asdic_recording **recording) {
    asdic_recording *r = *recording;
    asdic_file_discard(&r->track);
    if (r->spool) {
        fclose(r->spool);
    }
    free(r->bytes);
    free(r->pressure);
    free(r->folder);
    free(r);
    *recording = NULL;
}

static asdic_status open_files(asdic_recording *r) {
    TRY(asdic_mission_write_scene(r->ctx, r->mission, asdic_file_in(r->folder, "scene.yaml").text,
                                  "track.csv"));
    TRY(asdic_file_create(r->ctx, asdic_file_in(r->folder, "track.csv").text, &r->track));
    asdic_track_file_begin(r->track, &r->mission->settings.sweep);
    r->spool = tmpfile();
    return r->spool ? ASDIC_OK : fail_io(r, "the pings");
}

asdic_status asdic_recording_begin(asdic_context *ctx, const asdic_mission *mission,
                                   asdic_device *device, const char *parent,
                                   asdic_recording **out) {
    *out = NULL;
    asdic_recording *r = calloc(1, sizeof *r);
    if (!r) {
        return asdic_fail_memory(ctx, "a recording");
    }
    r->ctx = ctx;
    r->mission = mission;
    r->device = device;
    asdic_status status = make_folder(r, parent);
    status = status ? status : open_files(r);
    if (status) {
        finish(&r);
    }
    *out = r;
    return status;
}

/* Room for a ping as large as PING. */
static asdic_status make_room(asdic_recording *r, const asdic_loop_ping *ping) {
    const asdic_ping *parts = ping->parts;
    r->beams = ping->beams;
    r->bins = ping->bins;
    r->record_bytes = asdic_record_bytes(r->beams, r->bins);
    r->pressure_bytes = parts->pressure ? parts->elements * parts->samples * 2 * sizeof(float) : 0;
    r->bytes = malloc(r->record_bytes);
    r->pressure = r->pressure_bytes ? malloc(r->pressure_bytes) : NULL;
    return r->bytes && (r->pressure || !r->pressure_bytes) ? ASDIC_OK
                                                           : asdic_fail_memory(r->ctx, "a record");
}

asdic_status asdic_recording_add(asdic_recording *r, const asdic_loop_ping *ping) {
    const asdic_sweep *sweep = &r->mission->settings.sweep;
    asdic_pose pose = asdic_sweep_sonar(sweep, &ping->pose, ping->ping);
    asdic_record_head head = {
        .ping = ping->ping,
        .time_s = ping->time_s,
        .position_m = {pose.position_m.x, pose.position_m.y, pose.position_m.z},
        .attitude_rad = {pose.roll_rad, pose.pitch_rad, pose.yaw_rad},
        .altitude_m = ping->altitude_m,
        .rays = ping->parts->rays,
        .saturated = ping->parts->saturated};
    if (!r->bytes) {
        TRY(make_room(r, ping));
    }
    asdic_record_pack(&head, ping->parts, r->bytes);
    asdic_track_file_add(r->track, sweep, ping->ping, ping->time_s, &ping->pose);
    if (fwrite(r->bytes, r->record_bytes, 1, r->spool) != 1 ||
        (r->pressure && fwrite(ping->parts->pressure, r->pressure_bytes, 1, r->spool) != 1)) {
        return fail_io(r, "a ping");
    }
    r->pings++;
    return ASDIC_OK;
}

/* Copies every record into the run's files, as a run writes its pings. */
static asdic_status copy_records(asdic_recording *r, asdic_run_job *job) {
    rewind(r->spool);
    if (job->facts.bins != r->bins || job->facts.beams != r->beams ||
        job->facts.pings_planned != r->pings) {
        return asdic_fail(r->ctx, ASDIC_ERROR_IO,
                          "recording '%s' holds %zu pings of %zu bins, its scene asks for %zu of "
                          "%zu",
                          r->folder, r->pings, r->bins, job->facts.pings_planned, job->facts.bins);
    }
    for (size_t i = 0; i < r->pings; i++) {
        if (fread(r->bytes, r->record_bytes, 1, r->spool) != 1 ||
            (r->pressure && fread(r->pressure, r->pressure_bytes, 1, r->spool) != 1)) {
            return fail_io(r, "a ping");
        }
        if (r->pressure && job->elements) {
            TRY(asdic_records_write(job->elements, i, r->pressure));
        }
        TRY(asdic_job_take(job, r->bytes));
    }
    return ASDIC_OK;
}

static asdic_status run_job(asdic_recording *r, asdic_run_job *job) {
    TRY(asdic_job_begin(job));
    TRY(copy_records(r, job));
    return asdic_job_end(job, true);
}

static asdic_status write_run(asdic_recording *r) {
    asdic_mission *mission = NULL;
    asdic_run_options options = asdic_run_options_default();
    asdic_status status =
        asdic_mission_load(r->ctx, asdic_file_in(r->folder, "scene.yaml").text, &mission);
    options.folder = r->folder;
    options.force = options.own_track = true; /* it is there already */
    asdic_run_job job = {.ctx = r->ctx,
                         .mission = mission,
                         .devices = &r->device,
                         .device_count = 1,
                         .options = &options,
                         .begin_s = asdic_clock_s()};
    if (!status) {
        status = run_job(r, &job);
        asdic_job_finish(&job);
    }
    asdic_mission_destroy(&mission);
    return status;
}

static void remove_empty(asdic_recording *r) {
    asdic_file_discard(&r->track);
    unlink(asdic_file_in(r->folder, "scene.yaml").text);
    rmdir(r->folder);
}

asdic_status asdic_recording_end(asdic_recording **recording) {
    asdic_recording *r = *recording;
    if (!r) {
        return ASDIC_OK;
    }
    asdic_status status = ASDIC_OK;
    if (r->pings == 0) {
        remove_empty(r);
    } else {
        status = asdic_file_commit(&r->track);
        status = status ? status : write_run(r);
    }
    finish(recording);
    return status;
}

unsigned asdic_recording_number(const asdic_recording *recording) {
    return recording->number;
}

size_t asdic_recording_pings(const asdic_recording *recording) {
    return recording->pings;
}
