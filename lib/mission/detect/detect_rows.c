#include "detect_job.h"

#include "base/context.h"
#include "base/vec.h"
#include "out/csv.h"
#include "mission/run/run_folder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static asdic_status open_file(asdic_detect_job *job, const char *name, const char *header,
                              asdic_file **out) {
    char *path = asdic_folder_path(job->run->folder, name, "", "csv");
    if (!path) {
        return asdic_fail_memory(job->ctx, "a file name");
    }
    asdic_status status = ASDIC_OK;
    if (!job->options->force && access(path, F_OK) == 0) {
        status = asdic_fail(job->ctx, ASDIC_ERROR_EXISTS, "'%s' exists; --force replaces it", path);
    }
    if (status == ASDIC_OK) {
        status = asdic_file_create(job->ctx, path, out);
    }
    if (status == ASDIC_OK) {
        fputs(header, asdic_file_stream(*out));
    }
    free(path);
    return status;
}

asdic_status asdic_detect_open_files(asdic_detect_job *job) {
    asdic_status status =
        open_file(job, "detections",
                  "ping,time_s,beam,bin,range_m,x_m,y_m,z_m,level_db,background_db,llr,posterior,"
                  "pd,truth\n",
                  &job->detections);
    return status ? status
                  : open_file(job, "tracks",
                              "ping,time_s,track,confirmed,hit,x_m,y_m,vx_mps,vy_mps,sd_x_m,"
                              "sd_y_m,truth\n",
                              &job->tracks);
}

asdic_vec3 asdic_detect_position(const asdic_detect_job *job, const asdic_record *record,
                                 size_t beam, size_t bin) {
    asdic_vec3 axis = asdic_beam_axis(&job->info.sonar->receivers[beam], &record->pose);
    double range_m = ((double)bin + 0.5) * job->info.sonar->bin_length_m;
    return asdic_vec3_add(record->pose.position_m, asdic_vec3_scale(axis, range_m));
}

const char *asdic_detect_truth_name(const asdic_detect_job *job, size_t cell) {
    switch (job->truth[cell]) {
    case ASDIC_TRUTH_OBJECT:
        return asdic_namer_name(job->namer, (size_t)job->label[cell]);
    case ASDIC_TRUTH_GHOST:
        return "ghost";
    case ASDIC_TRUTH_FAINT:
        return "faint";
    case ASDIC_TRUTH_NONE:
        break;
    }
    return "none";
}

void asdic_detect_write_rows(asdic_detect_job *job, const asdic_record *record) {
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
        asdic_csv_field(name, asdic_detect_truth_name(job, i));
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
}

/* Notes what became of a track. */
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
    asdic_status status = ASDIC_OK;
    for (size_t i = 0; i < count && status == ASDIC_OK; i++) {
        const asdic_track_state *t = &tracks[i];
        bool has_name = t->label >= 0;
        asdic_csv_field(name, has_name ? asdic_namer_name(job->namer, (size_t)t->label) : "none");
        fprintf(out, "%llu,%.15g,%u,%d,%d,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%s\n",
                (unsigned long long)record->ping, record->time_s, t->id, t->confirmed, t->hit,
                t->north_m, t->east_m, t->north_mps, t->east_mps, t->sd_north_m, t->sd_east_m,
                name);
        status = note(job, t);
    }
    return status;
}
