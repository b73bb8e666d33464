#include "run_stream.h"

#include "base/context.h"
#include "run_queue.h"

#include <stdlib.h>

static asdic_status take(void *user, size_t ping, const asdic_ping *result) {
    asdic_run_job *job = user;
    const asdic_run_options *o = job->options;
    asdic_record record;
    asdic_record_head head = asdic_job_head(job->mission, ping, result);
    asdic_record_pack(&head, result, job->bytes);
    asdic_record_view(job->bytes, job->facts.beams, job->facts.bins, &record);
    asdic_status status = asdic_csv_add(job->csv, &record);
    job->rays += result->rays;
    if (o->progress) {
        asdic_run_progress progress = {.pings_done = ping + 1 - job->facts.first_ping,
                                       .pings_total = job->facts.pings_planned,
                                       .rays = job->rays,
                                       .elapsed_s = asdic_clock_s() - job->begin_s};
        o->progress(o->user, &progress);
    }
    return status;
}

asdic_status asdic_run_stream(asdic_run_job *job) {
    const asdic_output_options *output = asdic_mission_output(job->mission);
    asdic_queue_result result;
    if (job->options->resume) {
        return asdic_fail(job->ctx, ASDIC_ERROR_ARGUMENT,
                          "what went to the standard output cannot be resumed; give a folder");
    }
    asdic_status status = asdic_job_describe(job);
    if (status != ASDIC_OK) {
        return status;
    }
    job->bytes = malloc(asdic_record_bytes(job->facts.beams, job->facts.bins));
    if (!job->bytes) {
        return asdic_fail_memory(job->ctx, "a record");
    }
    asdic_csv_form form = output->csv == ASDIC_CSV_WIDE ? ASDIC_CSV_WIDE : ASDIC_CSV_LONG;
    status = asdic_csv_create(job->ctx, "/dev/stdout", asdic_mission_sonar(job->mission),
                              job->facts.bins, form, &job->csv);
    if (status != ASDIC_OK) {
        return status;
    }
    char hash[65];
    asdic_job_hash(job, hash);
    job->begin_s = asdic_clock_s();
    asdic_queue_work work = {.mission = job->mission,
                             .devices = job->devices,
                             .device_count = job->device_count,
                             .first = job->facts.first_ping,
                             .end = job->facts.first_ping + job->facts.pings_planned,
                             .bins = job->facts.bins,
                             .take = take,
                             .team = job->options->team,
                             .run_hash = hash,
                             .user = job};
    status = asdic_queue_run(job->ctx, &work, &result);
    asdic_status closed = asdic_csv_commit(&job->csv); /* whole rows, also when interrupted */
    return status == ASDIC_OK ? closed : status;
}
