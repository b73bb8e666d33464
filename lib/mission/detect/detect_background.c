#include "detect_background.h"

#include "base/clock.h"
#include "base/context.h"
#include "base/file_name.h"
#include "base/sha256.h"
#include "base/try.h"
#include "mission/mission.h"
#include "mission/run/run_workers.h"
#include "out/file.h"
#include "out/npy.h"
#include "out/record.h"
#include "sim/variates.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

/* The background's rays over the run's: enough for a median error of GOOD_DB, within limits. A
 * vehicle at rest needs one ping, which may cost more. Of coherent pings, which have scatterers instead, over those
 * that intensities would take. */
#define GOOD_DB 0.25
#define MOST_TIMES 4.0
#define MOST_TIMES_AT_REST 64.0
#define MOST_RAYS ((uint32_t)1 << 23)
/* A bin that few rays reach may have missed its rare strong echoes, and then states too small an
 * error: variances are means over so many bins on either side. */
#define NEIGHBOURS 4
/* ... whole of echoes that so many rays make, or fewer. */
#define FEW_RAYS 30.0
/* Errors are counted in steps; larger ones in the last. */
#define ERROR_STEP_DB 0.01
#define ERROR_STEPS 4000

/* A ping of background.npy or parts.npy; arrays follow, float32 [beam, bin]: levels and their error, dB; then the
 * CRC-32 of all before it. */
typedef struct head {
    uint64_t key, ping;
} head;

/* What is kept of each kind, in which file. */
#define MOST_PARTS 5
static const struct {
    const char *file, *what;
    size_t count;
    asdic_component parts[MOST_PARTS];
} kinds[] = {
    [ASDIC_BACKDROP_EMPTY] = {"background.npy",
                              "the background",
                              2,
                              {ASDIC_TOTAL, ASDIC_MULTIPATH}},
    [ASDIC_BACKDROP_PARTS] = {"parts.npy",
                              "what coherent pings are made of",
                              MOST_PARTS,
                              {ASDIC_BOTTOM, ASDIC_SURFACE, ASDIC_VOLUME, ASDIC_OBJECT,
                               ASDIC_MULTIPATH}},
};

struct asdic_backdrop {
    asdic_run *run;
    asdic_backdrop_kind kind;
    const asdic_detect_options *options;
    asdic_file_name path;
    uint64_t key; /* of the run, its scene, and the number of rays */
    /* Another than the run's: where no object is, its rays would err as the run's do, and thresholds that allow for
     * both errors would let too few false alarms through. */
    uint64_t seed;
    uint32_t rays;
    size_t cells, pings, record_bytes, header_bytes;
    char header[ASDIC_NPY_HEADER_SIZE];
    FILE *file;
    asdic_file *part; /* while it is made */
    double begin_s;
    uint64_t rays_done;
    char *bytes;                      /* a record */
    double *mean_lin, *variance_lin2; /* of the record; the variance of its own rays alone */
    double *mirrored_lin;             /* what of the mean came by way of mirrors */
    double *missed_lin2; /* the variance that each bin's neighbours take for what they missed */
    size_t read;         /* the ping in them; SIZE_MAX: none */
    uint64_t errors[ERROR_STEPS], error_count; /* of the bins that were read */
};

/* --- the file --------------------------------------------------------------------------------- */

static bool is_at_rest(asdic_run *run) {
    asdic_record record;
    size_t count = asdic_store_count(run->store);
    asdic_pose first;
    for (size_t i = 0; i < count; i++) {
        if (asdic_run_read(run, i, &record) != ASDIC_OK) {
            return false;
        }
        first = i == 0 ? record.pose : first;
        if (memcmp(&first, &record.pose, sizeof first) != 0) {
            return false;
        }
    }
    return true;
}

static uint32_t rays_of(const asdic_run *run, bool at_rest) {
    const asdic_run_facts *facts = &run->facts;
    double error = facts->errors.median_db, most = at_rest ? MOST_TIMES_AT_REST : MOST_TIMES;
    uint32_t own = facts->sampling.rays;
    if (facts->sampling.coherent) {
        double speed_mps = asdic_environment_sound_speed_mps(&run->settings.environment, 0.0);
        asdic_rays_over over = strcmp(facts->bottom, ASDIC_RUN_BOTTOM_MESH) == 0
                                   ? ASDIC_OVER_MESHES
                                   : ASDIC_OVER_PLANES;
        own = asdic_rays_auto(&run->settings.sonar, speed_mps, over);
        error = asdic_rays_error_db(&run->settings.sonar, speed_mps, over, own);
    }
    double times = isfinite(error) ? pow(error / GOOD_DB, 2) : most;
    double rays = fmin(fmax(times, 1.0), most) * (double)own;
    return (uint32_t)fmin(rays, fmax(MOST_RAYS, (double)own));
}

/* The number under which a background of these pings is known. */
static uint64_t key_of(const asdic_backdrop *b) {
    const asdic_run_facts *f = &b->run->facts;
    const asdic_sampling *s = &f->sampling;
    char text[512], hex[65];
    int length = snprintf(
        text, sizeof text, "%d %s %s %s %zu+%zu %zu*%zu %u %d %d %llu %u %d %.17g %.17g",
        (int)b->kind, f->version, f->scene_hash, f->geometry_hash, f->first_ping, b->pings,
        f->beams, f->bins, b->rays, (int)s->sampler, (int)s->multipath, (unsigned long long)b->seed,
        s->left_out, (int)f->refraction, f->layer_from_m, f->layer_to_m);
    asdic_sha256_hex(text, (size_t)length, hex);
    hex[16] = 0;
    return strtoull(hex, NULL, 16);
}

static uint32_t sum_of(const asdic_backdrop *b) {
    return (uint32_t)crc32_z(0, (const unsigned char *)b->bytes,
                             b->record_bytes - sizeof(uint32_t));
}

/* Reads ping INDEX into BYTES; false where it is not there as it was written, or another run's. */
static bool read_record(asdic_backdrop *b, size_t index) {
    head h;
    off_t at = (off_t)(b->header_bytes + index * b->record_bytes);
    if (fseeko(b->file, at, SEEK_SET) != 0 || fread(b->bytes, b->record_bytes, 1, b->file) != 1) {
        return false;
    }
    uint32_t sum;
    memcpy(&h, b->bytes, sizeof h);
    memcpy(&sum, b->bytes + b->record_bytes - sizeof sum, sizeof sum);
    return h.key == b->key && h.ping == b->run->facts.first_ping + index && sum == sum_of(b);
}

/* Whether the folder holds the whole background of this run. */
static bool find(asdic_backdrop *b) {
    b->file = fopen(b->path.text, "rbe");
    bool is_there = b->file != NULL;
    for (size_t i = 0; i < b->pings && is_there; i++) {
        is_there = read_record(b, i);
    }
    if (!is_there && b->file) {
        fclose(b->file);
        b->file = NULL;
    }
    return is_there;
}

/* --- simulation ------------------------------------------------------------------------------- */

static void report(const asdic_backdrop *b, size_t done) {
    asdic_run_progress now = {.pings_done = done,
                              .pings_total = b->pings,
                              .rays = b->rays_done,
                              .elapsed_s = asdic_clock_s() - b->begin_s};
    if (b->options->progress) {
        b->options->progress(b->options->user, &now);
    }
}

/* Of the record in hand, the levels of its part K; behind the last, their errors. */
static float *levels_of(const asdic_backdrop *b, size_t k) {
    return (float *)(b->bytes + sizeof(head)) + k * b->cells;
}

static asdic_status take(void *user, size_t ping, const asdic_ping *result) {
    asdic_backdrop *b = user;
    head h = {.key = b->key, .ping = ping};
    memcpy(b->bytes, &h, sizeof h);
    for (size_t k = 0; k < kinds[b->kind].count; k++) {
        const double *lin = result->intensity_lin[kinds[b->kind].parts[k]];
        float *level = levels_of(b, k);
        for (size_t i = 0; i < b->cells; i++) {
            level[i] = lin[i] > 0.0 ? (float)(10.0 * log10(lin[i])) : NAN;
        }
    }
    memcpy(levels_of(b, kinds[b->kind].count), result->stderr_db, b->cells * sizeof(float));
    uint32_t sum = sum_of(b);
    memcpy(b->bytes + b->record_bytes - sizeof sum, &sum, sizeof sum);
    fwrite(b->bytes, b->record_bytes, 1, asdic_file_stream(b->part)); /* commit tells of errors */
    b->rays_done += result->rays;
    report(b, ping + 1 - b->run->facts.first_ping);
    return ASDIC_OK;
}

static asdic_status simulate_on(asdic_backdrop *b, asdic_mission *mission, asdic_device **devices,
                                size_t device_count) {
    const asdic_run_facts *facts = &b->run->facts;
    asdic_work_result result;
    asdic_work work = {.mission = mission,
                       .devices = devices,
                       .device_count = device_count,
                       .first = facts->first_ping,
                       .end = facts->first_ping + b->pings,
                       .bins = facts->bins,
                       .take = take,
                       .user = b};
    mission->settings.sampling = facts->sampling;
    mission->settings.sampling.coherent = false;
    mission->settings.sampling.rays = b->rays;
    mission->settings.sampling.seed = b->seed;
    mission->settings.sonar.speckle = ASDIC_SPECKLE_NONE;
    mission->settings.environment = b->run->settings.environment; /* rays bend as the run's */
    TRY(asdic_file_create(b->run->ctx, b->path.text, &b->part));
    fwrite(b->header, b->header_bytes, 1, asdic_file_stream(b->part));
    report(b, 0);
    TRY(asdic_workers_run(b->run->ctx, &work, &result));
    return asdic_file_commit(&b->part);
}

static asdic_status simulate(asdic_backdrop *b) {
    asdic_context *ctx = b->run->ctx;
    asdic_mission *mission = NULL;
    asdic_device **devices = NULL;
    size_t count = 0;
    b->begin_s = asdic_clock_s();
    bool is_empty = b->kind == ASDIC_BACKDROP_EMPTY;
    asdic_log(ctx, ASDIC_LOG_INFO, "simulating %s: %zu ping%s of the scene%s, %u rays each",
              kinds[b->kind].what, b->pings, b->pings == 1 ? "" : "s",
              is_empty ? " without its objects" : " by intensities", b->rays);
    asdic_status status = (is_empty ? asdic_mission_load_empty
                                    : asdic_mission_load)(ctx, b->run->facts.scene_path, &mission);
    status = status ? status : asdic_devices_open(ctx, b->options->device, &devices, &count);
    status = status ? status : simulate_on(b, mission, devices, count);
    asdic_file_discard(&b->part);
    asdic_devices_close(&devices, count);
    asdic_mission_destroy(&mission);
    TRY(status);
    return find(b) ? ASDIC_OK
                   : asdic_fail(ctx, ASDIC_ERROR_IO, "'%s' cannot be read back", b->path.text);
}

/* --- use -------------------------------------------------------------------------------------- */

static asdic_status prepare(asdic_backdrop *b) {
    const asdic_run_facts *facts = &b->run->facts;
    char dtype[ASDIC_RECORD_DTYPE_SIZE];
    bool at_rest = b->kind == ASDIC_BACKDROP_EMPTY && is_at_rest(b->run); /* objects move */
    size_t arrays = kinds[b->kind].count + 1;
    b->pings = at_rest ? 1 : asdic_store_count(b->run->store);
    b->rays = rays_of(b->run, at_rest);
    b->seed = asdic_other_seed(facts->sampling.seed);
    b->cells = facts->beams * facts->bins;
    b->record_bytes = sizeof(head) + arrays * b->cells * sizeof(float) + sizeof(uint32_t);
    b->read = SIZE_MAX;
    b->key = key_of(b);
    int length = snprintf(dtype, sizeof dtype, "[('key', '<u8'), ('ping', '<u8'), ");
    for (size_t k = 0; k < arrays; k++) {
        const char *name = asdic_record_names[k < arrays - 1 ? (size_t)kinds[b->kind].parts[k]
                                                             : ASDIC_COMPONENT_COUNT];
        length += snprintf(dtype + length, sizeof dtype - (size_t)length,
                           "('%s', '<f4', (%zu, %zu)), ", name, facts->beams, facts->bins);
    }
    snprintf(dtype + length, sizeof dtype - (size_t)length, "('crc32', '<u4')]");
    b->header_bytes = asdic_npy_header(b->header, dtype, b->pings, "");
    b->path = asdic_file_in(b->run->folder, kinds[b->kind].file);
    b->bytes = malloc(b->record_bytes);
    b->mean_lin = malloc(b->cells * sizeof *b->mean_lin);
    b->mirrored_lin = malloc(b->cells * sizeof *b->mirrored_lin);
    b->variance_lin2 = malloc(b->cells * sizeof *b->variance_lin2);
    b->missed_lin2 = malloc(b->cells * sizeof *b->missed_lin2);
    return b->bytes && b->mean_lin && b->mirrored_lin && b->variance_lin2 && b->missed_lin2
               ? ASDIC_OK
               : asdic_fail_memory(b->run->ctx, "a background");
}

asdic_status asdic_backdrop_open(asdic_run *run, asdic_backdrop_kind kind,
                                 const asdic_detect_options *options, double *simulated_s,
                                 asdic_backdrop **out) {
    *out = NULL;
    *simulated_s = 0.0;
    asdic_backdrop *b = calloc(1, sizeof *b);
    if (!b) {
        return asdic_fail_memory(run->ctx, "a background");
    }
    b->run = run;
    b->kind = kind;
    b->options = options;
    asdic_status status = prepare(b);
    if (status == ASDIC_OK && !find(b)) {
        status = simulate(b);
        *simulated_s = asdic_clock_s() - b->begin_s;
    }
    if (status != ASDIC_OK) {
        asdic_backdrop_close(&b);
    }
    *out = b;
    return status;
}

void asdic_backdrop_close(asdic_backdrop **backdrop) {
    asdic_backdrop *b = backdrop ? *backdrop : NULL;
    if (!b) {
        return;
    }
    if (b->file) {
        fclose(b->file);
    }
    free(b->bytes);
    free(b->mean_lin);
    free(b->mirrored_lin);
    free(b->variance_lin2);
    free(b->missed_lin2);
    free(b);
    *backdrop = NULL;
}

/* What bins beside one of this mean and variance may have missed. An echo known to a share of 1 / sqrt(N) is made of
 * some N rays: a bin that none of them reached misses about 1 / N of it. */
static double missed_of(double mean_lin, double variance_lin2) {
    double mean2 = mean_lin * mean_lin;
    return mean2 > 0.0 ? variance_lin2 * fmin(FEW_RAYS * variance_lin2 / mean2, 1.0) : 0.0;
}

static void take_record(asdic_backdrop *b) {
    const float *level = levels_of(b, 0), *mirrored = levels_of(b, 1), *error = levels_of(b, 2);
    for (size_t i = 0; i < b->cells; i++) {
        bool is_known = !isnan(level[i]);
        b->mean_lin[i] = asdic_detect_lin(level[i]);
        b->mirrored_lin[i] = asdic_detect_lin(mirrored[i]);
        double share = isnan(error[i]) ? 0.0 : (double)error[i] * 0.1 * log(10.0);
        b->variance_lin2[i] = pow(share * b->mean_lin[i], 2);
        b->missed_lin2[i] = missed_of(b->mean_lin[i], b->variance_lin2[i]);
        if (is_known && !isnan(error[i])) {
            b->errors[(size_t)fmin(error[i] / ERROR_STEP_DB, ERROR_STEPS - 1)]++;
            b->error_count++;
        }
    }
}

double asdic_backdrop_error_db(const asdic_backdrop *b) {
    uint64_t below = 0;
    for (size_t i = 0; i < ERROR_STEPS; i++) {
        below += b->errors[i];
        if (2 * below > b->error_count) {
            return ERROR_STEP_DB * ((double)i + 0.5);
        }
    }
    return 0.0;
}

/* The standard error of bin N of the beam that begins at FIRST, as a share of its mean. */
static double error_share(const asdic_backdrop *b, size_t first, size_t n) {
    size_t bins = b->run->facts.bins;
    size_t low = n > NEIGHBOURS ? n - NEIGHBOURS : 0;
    size_t end = n + NEIGHBOURS + 1 < bins ? n + NEIGHBOURS + 1 : bins;
    double sum = 0.0, mean = b->mean_lin[first + n], own = b->variance_lin2[first + n];
    for (size_t k = low; k < end; k++) {
        sum += k == n ? own : b->missed_lin2[first + k];
    }
    return mean > 0.0 ? sqrt(fmax(own, sum / (double)(end - low))) / mean : 0.0;
}

/* Reads the record of the run's ping INDEX, where it is not the one in hand. */
static asdic_status need_record(asdic_backdrop *b, size_t index) {
    index = b->pings == 1 ? 0 : index;
    if (b->read == index) {
        return ASDIC_OK;
    }
    if (!read_record(b, index)) {
        return asdic_fail(b->run->ctx, ASDIC_ERROR_INPUT,
                          "'%s' is damaged; remove it, it is made again", b->path.text);
    }
    b->read = index;
    if (b->kind == ASDIC_BACKDROP_EMPTY) {
        take_record(b);
    }
    return ASDIC_OK;
}

asdic_status asdic_backdrop_read(asdic_backdrop *b, size_t index, const double **mean_lin,
                                 const double **mirrored_lin) {
    TRY(need_record(b, index));
    *mean_lin = b->mean_lin;
    *mirrored_lin = b->mirrored_lin;
    return ASDIC_OK;
}

asdic_status asdic_backdrop_tell(asdic_backdrop *b, size_t index, asdic_record *record) {
    TRY(need_record(b, index));
    for (size_t k = 0; k < kinds[b->kind].count; k++) {
        record->level_db[kinds[b->kind].parts[k]] = levels_of(b, k);
    }
    return ASDIC_OK;
}

bool asdic_flat_scene_mirrors(const asdic_flat_scene *flat, const asdic_sampling *sampling) {
    return sampling->multipath == ASDIC_MULTIPATH_BOUNDARIES &&
           (flat->has_surface || flat->has_bottom);
}

void asdic_backdrop_add_error(const asdic_backdrop *b, float *error_db) {
    size_t bins = b->run->facts.bins;
    double db = 10.0 / log(10.0), times = (double)b->rays / (double)b->run->facts.sampling.rays;
    for (size_t i = 0; i < b->cells; i++) {
        double own = db * error_share(b, i - i % bins, i % bins);
        double run = fmax((double)error_db[i], own * sqrt(times));
        error_db[i] = (float)hypot(own, run);
    }
}
