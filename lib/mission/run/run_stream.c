#include "run_stream.h"

#include "base/context.h"

#include <stdlib.h>

asdic_status asdic_run_stream(asdic_run_job *job) {
    const asdic_output_options *output = asdic_mission_output(job->mission);
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
    status = asdic_job_simulate(job);
    asdic_status closed = asdic_csv_commit(&job->csv); /* whole rows, also when interrupted */
    return status == ASDIC_OK ? closed : status;
}
