#include "run_job.h"

#include "base/clock.h"
#include "base/context.h"
#include "run_render.h"

#include <stdlib.h>

static void conclude(asdic_run_job *job) {
    asdic_run_facts *f = &job->facts;
    asdic_digest_end(job->digest);
    f->pings = asdic_store_count(job->store);
    asdic_run_facts_survey(f, &job->digest->survey);
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
        status = asdic_run_render_digest(job->ctx, job->options->folder, &options, job->digest);
    }
    job->facts.times.pictures_s += asdic_clock_s() - begin_s;
    return status;
}

static asdic_status write_facts(asdic_run_job *job) {
    job->facts.times.whole_s = asdic_clock_s() - job->begin_s;
    return asdic_run_facts_write(job->ctx, job->options->folder, &job->facts);
}

asdic_status asdic_job_end(asdic_run_job *job, bool is_whole) {
    double begin_s = asdic_clock_s();
    asdic_status status = asdic_store_commit(job->store);
    if (status == ASDIC_OK) {
        status = asdic_csv_commit(&job->csv);
    }
    if (status == ASDIC_OK) {
        conclude(job);
    }
    if (status == ASDIC_OK && is_whole) {
        status = asdic_files_commit(&job->files);
    }
    job->facts.times.write_s += asdic_clock_s() - begin_s;
    /* Not complete before the pictures are there: --resume then draws what is missing. */
    job->facts.state = ASDIC_RUN_STOPPED;
    if (status == ASDIC_OK) {
        status = write_facts(job);
    }
    if (status != ASDIC_OK || !is_whole) {
        return status;
    }
    status = draw(job);
    job->facts.state = ASDIC_RUN_COMPLETE;
    return status == ASDIC_OK ? write_facts(job) : status;
}

void asdic_job_finish(asdic_run_job *job) {
    asdic_csv_discard(&job->csv);
    asdic_files_discard(&job->files);
    asdic_store_close(&job->store);
    asdic_digest_destroy(&job->digest);
    asdic_arena_finish(&job->arena);
    free(job->bytes);
}
