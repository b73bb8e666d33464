/*
 * A trial as a whole: runs dealt to workers, rows taken in order.
 *
 * A run costs seconds and nothing it needs is shared but the scene file, so that workers ask for one
 * run of one variant at a time. Several processes (a team) fly a part each, in folders of their own
 * which are named by its runs, and the first one joins them. What was stopped goes on with the rows
 * of all such folders, however many processes it has now.
 */
#include "trial_folder.h"
#include "trial_run.h"

#include "base/context.h"
#include "base/file_name.h"
#include "base/number.h"
#include "base/sha256.h"
#include "base/share.h"
#include "base/try.h"
#include "base/words.h"
#include "mission/run/run_folder.h"
#include "mission/run/run_workers.h"
#include "mission/run/team_message.h"
#include "mission/scene_inputs.h"
#include "out/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Workers where no device is given, since the sonar is ideal. */
#define MOST_BLIND 64

typedef struct flown {
    char *row; /* NULL: not yet */
    uint64_t pings;
} flown;

typedef struct fleet {
    asdic_context *ctx;
    const asdic_trial_options *options, *whole; /* of this process's part, and of all */
    const trial_facts *facts;                   /* of the part */
    uint64_t first,
        jobs; /* of this part: run and variant of job j are first + j / variants, j % variants */
    asdic_device **devices;
    size_t worker_count;
    char scene_hash[65]; /* of the scene's text when the trial began */
    FILE *out;
    pthread_mutex_t lock; /* guards what follows */
    uint64_t next, taken; /* job to be dealt, row to be written */
    uint64_t pings;
    flown *rows; /* of all jobs; an earlier call's are there before any is dealt */
    asdic_status status;
    char why[512]; /* with it */
} fleet;

typedef struct worker {
    fleet *fleet;
    size_t number;
    pthread_t thread;
    bool has_thread;
    asdic_eye eye;
    asdic_mission *before; /* of the last run: its geometry may be that of the next */
} worker;

asdic_trial_options asdic_trial_options_default(void) {
    return (asdic_trial_options){
        .runs = 1000, .seed = 1, .count = UINT64_MAX, .variants = {.count = 1}};
}

/* --- a run ------------------------------------------------------------------------------------- */

/* The scene is read for every run: one that is edited meanwhile is not flown on. */
static asdic_status check_scene(const fleet *f, const asdic_mission *mission) {
    return strcmp(mission->file_hash, f->scene_hash) == 0
               ? ASDIC_OK
               : asdic_fail(f->ctx, ASDIC_ERROR_INPUT,
                            "%s has changed since its trial began; put it back and go on with "
                            "--resume, or begin anew with --force",
                            f->options->scene);
}

static asdic_status fly(worker *w, uint64_t job, asdic_text *row, uint64_t *pings) {
    const asdic_trial_options *o = w->fleet->options;
    uint64_t run = w->fleet->first + job / o->variants.count;
    size_t variant = job % o->variants.count;
    asdic_mission *mission = NULL;
    asdic_trial_run outcome;
    char why[ASDIC_TRIAL_WHY];
    asdic_status status = asdic_trial_load(w->fleet->ctx, o, run, variant, w->before, &mission);
    asdic_mission_destroy(&w->before);
    status = status ? status : check_scene(w->fleet, mission);
    if (status) {
        asdic_mission_destroy(&mission);
        return status;
    }
    const asdic_trial_job one = {mission, o->seed, run, w->number, o->rule, NULL};
    status = asdic_trial_run_one(&w->eye, &one, &outcome, why);
    if (!status) {
        asdic_trial_print_row(mission, run, variant, &outcome, row);
        *pings = outcome.pings;
        if (why[0]) {
            asdic_log(w->fleet->ctx, ASDIC_LOG_WARNING, "run %llu is %s: %s",
                      (unsigned long long)run, asdic_trial_outcome_name(outcome.outcome), why);
        }
    }
    w->before = mission;
    return !status && row->failed ? asdic_fail_memory(w->fleet->ctx, "a row") : status;
}

/* --- dealing ----------------------------------------------------------------------------------- */

/* Writes the rows whose turn it is; the lock is held. */
static void take_rows(fleet *f) {
    int error = 0;
    while (f->taken < f->jobs && f->rows[f->taken].row) {
        flown *r = &f->rows[f->taken++];
        f->pings += r->pings;
        if (fputs(r->row, f->out) < 0) {
            error = errno;
        }
        free(r->row);
        r->row = NULL;
        if (f->options->progress) {
            f->options->progress(f->options->user, f->taken, f->jobs, f->pings);
        }
    }
    if (fflush(f->out) != 0 && !error) {
        error = errno;
    }
    if (error && !f->status) {
        f->status = asdic_file_fail(f->ctx, "trial.part.csv", error);
        asdic_context_copy_error(f->ctx, f->why, sizeof f->why);
    }
}

/* The next job without a row, of `jobs` when there is none; the lock is held. */
static uint64_t deal(fleet *f) {
    f->next = f->next < f->taken ? f->taken : f->next;
    while (f->next < f->jobs && f->rows[f->next].row) {
        f->next++;
    }
    return f->next < f->jobs ? f->next++ : f->jobs;
}

static void *work(void *argument) {
    worker *w = argument;
    fleet *f = w->fleet;
    pthread_mutex_lock(&f->lock);
    for (uint64_t job; !f->status && (job = deal(f)) < f->jobs;) {
        pthread_mutex_unlock(&f->lock);
        asdic_text row = {0};
        uint64_t pings = 0;
        locale_t before = asdic_c_locale_enter();
        asdic_status status =
            asdic_context_interrupted(f->ctx)
                ? asdic_fail(f->ctx, ASDIC_ERROR_INTERRUPTED, "interrupted; --resume goes on")
                : fly(w, job, &row, &pings);
        asdic_c_locale_leave(before);
        pthread_mutex_lock(&f->lock);
        if (status && !f->status) {
            f->status = status;
            asdic_context_copy_error(f->ctx, f->why, sizeof f->why);
        }
        if (!status) {
            f->rows[job] = (flown){asdic_text_take(&row), pings};
            take_rows(f);
        }
        asdic_text_finish(&row);
    }
    pthread_mutex_unlock(&f->lock);
    return NULL;
}

static asdic_status work_all(fleet *f) {
    worker *workers = calloc(f->worker_count, sizeof *workers);
    if (!workers) {
        return asdic_fail_memory(f->ctx, "a trial");
    }
    for (size_t i = 0; i < f->worker_count; i++) {
        worker *w = &workers[i];
        w->fleet = f;
        w->number = i;
        w->eye.lookout.ctx = f->ctx;
        w->eye.device = f->devices ? f->devices[i] : NULL;
        w->has_thread = i > 0 && pthread_create(&w->thread, NULL, work, w) == 0;
    }
    work(&workers[0]);
    for (size_t i = 0; i < f->worker_count; i++) {
        if (workers[i].has_thread) {
            pthread_join(workers[i].thread, NULL);
        }
        asdic_eye_finish(&workers[i].eye);
        asdic_mission_destroy(&workers[i].before);
    }
    free(workers);
    return f->status ? asdic_fail(f->ctx, f->status, "%s", f->why) : ASDIC_OK;
}

/* --- what is flown ----------------------------------------------------------------------------- */

/* What makes figures other than they seem; of several variants each is told once. */
typedef struct remarks {
    bool means, lookout[ASDIC_LOOKOUT_WARNINGS];
} remarks;

static void warn_of(asdic_context *ctx, const asdic_mission *m, remarks *told) {
    if (m->settings.sonar.speckle == ASDIC_SPECKLE_NONE && !m->settings.sampling.coherent &&
        !told->means) {
        asdic_log(ctx, ASDIC_LOG_WARNING,
                  "the trial's scene has 'speckle: none': levels are means, of which none is a "
                  "false alarm by chance; 'speckle: rayleigh' draws them");
        told->means = true;
    }
    asdic_lookout_warn(ctx, m, told->lookout);
}

/* The hash of each variant: of its run 0, with what that includes, and of its section `trial`; and of all files
 * that are named. SCENE_HASH: of the scene's file. */
static asdic_status describe(asdic_context *ctx, const asdic_trial_options *o, trial_facts *facts,
                             asdic_text *header, bool *is_ideal, char scene_hash[65]) {
    asdic_text all = {0};
    remarks told = {false};
    char *name = asdic_scene_name(o->scene);
    asdic_status status = name ? ASDIC_OK : asdic_fail_memory(ctx, "a name");
    *facts = (trial_facts){.seed = o->seed,
                           .runs = o->runs,
                           .first = o->first,
                           .count = o->count,
                           .rays = o->rays,
                           .rule = o->rule ? strdup(o->rule->name ? o->rule->name : "") : NULL,
                           .variants = o->variants.count,
                           .key = o->variants.key ? strdup(o->variants.key) : NULL};
    int length = name ? (int)asdic_words_cut(name, strlen(name), sizeof facts->scene - 1) : 0;
    snprintf(facts->scene, sizeof facts->scene, "%.*s", length, name ? name : "");
    free(name);
    for (size_t v = 0; !status && v < o->variants.count; v++) {
        asdic_mission *mission = NULL;
        const char *key = o->variants.key ? o->variants.key : "";
        const char *value = o->variants.key ? o->variants.values[v] : "";
        facts->values[v] = strdup(value);
        status = facts->values[v] ? asdic_trial_load(ctx, o, 0, v, NULL, &mission)
                                  : asdic_fail_memory(ctx, "a trial");
        if (!status) {
            bool is_blind = mission->trial.is_ideal;
            *is_ideal = is_blind && (v == 0 || *is_ideal);
            asdic_text_format(&all, "%s %s %s %s\n", asdic_mission_hash(mission),
                              mission->trial_hash, key, value);
            if (!is_blind) {
                warn_of(ctx, mission, &told);
            }
            if (v == 0) {
                memcpy(scene_hash, mission->file_hash, sizeof mission->file_hash);
                asdic_trial_print_header(mission, header);
            }
        }
        asdic_mission_destroy(&mission);
    }
    if (!status && *is_ideal && o->rays > 0) {
        asdic_log(ctx, ASDIC_LOG_WARNING,
                  "the trial's sonar is 'ideal' and casts no rays: --rays and --tolerance change "
                  "nothing");
    }
    if (!status) { /* meshes, tracks, laws, whichever of them a run draws */
        status = asdic_scene_files_hash(ctx, o->scene, o->variants.values,
                                        o->variants.key ? o->variants.count : 0, &all);
    }
    bool is_short = (o->rule && !facts->rule) || (o->variants.key && !facts->key);
    if (!status && (all.failed || header->failed || is_short)) {
        status = asdic_fail_memory(ctx, "a trial");
    }
    if (!status) {
        asdic_sha256_hex(all.data, all.length, facts->hash);
    }
    asdic_text_finish(&all);
    return status;
}

static asdic_status check(asdic_context *ctx, asdic_trial_options *o) {
    bool has_values = o->variants.key ? o->variants.values != NULL : o->variants.count == 1;
    if (!o->scene || !o->folder || o->runs == 0 || !has_values || o->variants.count == 0 ||
        o->variants.count > ASDIC_TRIAL_MOST_VARIANTS) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT,
                          "a trial needs a scene, a folder, a run and 1 to %d variants, of a key "
                          "and its values where they are several",
                          ASDIC_TRIAL_MOST_VARIANTS);
    }
    bool is_rest = o->count == UINT64_MAX;
    if (o->first >= o->runs || (!is_rest && o->count > o->runs - o->first)) {
        return asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a trial of %llu runs has no run %llu",
                          (unsigned long long)o->runs,
                          (unsigned long long)(o->first + (is_rest ? 0 : o->count - 1)));
    }
    o->count = is_rest ? o->runs - o->first : o->count;
    return asdic_folder_check_mode(ctx, o->force, o->resume);
}

/* --- the folder -------------------------------------------------------------------------------- */

/* Removes a complete trial; trial.json, by which it is one, first. Also one UNDER_WAY. */
static void remove_files(const char *folder, bool under_way) {
    static const char *const names[] = {"trial.json",     "trial.csv",       "trial.png",
                                        "trial.part.csv", "trial.part.json", "trial.part.csv.part"};
    int folder_fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    for (int i = 0; folder_fd >= 0 && i < (under_way ? 6 : 3); i++) {
        unlinkat(folder_fd, names[i], 0);
    }
    if (folder_fd >= 0) {
        close(folder_fd);
    }
}

/* Reads what an earlier call left of COUNT runs from FIRST on, under way when PART: it must be of the trial of
 * FACTS. */
static asdic_status read_same(asdic_context *ctx, const char *folder, const trial_facts *facts,
                              uint64_t first, uint64_t count, bool part, asdic_trial **out) {
    TRY(asdic_trial_read(ctx, folder, part, out));
    const trial_facts *before = &(*out)->facts;
    if (asdic_trial_is_same(facts, before) && first == before->first && count == before->count) {
        return ASDIC_OK;
    }
    asdic_trial_close(out);
    return asdic_fail(ctx, ASDIC_ERROR_EXISTS,
                      "%s holds another trial: scene or its files, seed, runs, rays, rule or "
                      "variants differ; --force replaces it",
                      folder);
}

/* Whether nothing is left to be flown, since the folder holds the whole trial; it may be there only
 * when that is resumed. */
static asdic_status look_for_whole(asdic_context *ctx, const asdic_trial_options *o,
                                   const trial_facts *facts, bool *is_there) {
    asdic_trial *whole = NULL;
    *is_there = !o->force && asdic_trial_has(o->folder, "trial.json") &&
                !asdic_trial_has(o->folder, "trial.part.csv");
    if (*is_there && !o->resume) {
        return asdic_fail(ctx, ASDIC_ERROR_EXISTS, "'%s' holds a trial; --force replaces it",
                          o->folder);
    }
    asdic_status status =
        *is_there ? read_same(ctx, o->folder, facts, facts->first, facts->count, false, &whole)
                  : ASDIC_OK;
    asdic_trial_close(&whole);
    return status;
}

/* --- what earlier calls left -------------------------------------------------------------------- */

/* The folder in which a process of a team flies runs FIRST to END - 1. */
static char *part_folder(const char *folder, uint64_t first, uint64_t end) {
    char *path = NULL;
    return asprintf(&path, "%s/part_%llu_%llu", folder, (unsigned long long)first,
                    (unsigned long long)end) < 0
               ? NULL
               : path;
}

/* A folder with rows of runs FIRST to END - 1. */
typedef asdic_status (*part_visit)(fleet *f, const char *folder, uint64_t first, uint64_t end);

/* Calls VISIT for all part folders that begin with a run of F's part, or also those that overlap it. */
static asdic_status visit_parts(fleet *f, bool overlap, part_visit visit) {
    DIR *all = opendir(f->whole->folder);
    asdic_status status = ASDIC_OK;
    uint64_t own_end = f->first + f->options->count;
    for (struct dirent *entry; !status && all && (entry = readdir(all));) {
        unsigned long long first, end;
        int length = 0;
        if (sscanf(entry->d_name, "part_%llu_%llu%n", &first, &end, &length) != 2 ||
            entry->d_name[length] || first >= own_end ||
            (overlap ? end <= f->first : first < f->first)) {
            continue;
        }
        status = visit(f, asdic_file_in(f->whole->folder, entry->d_name).text, first, end);
    }
    if (all) {
        closedir(all);
    }
    return status;
}

/* The file FOLDER/trial.part.csv must not be one that another process writes to. */
static asdic_status check_idle(asdic_context *ctx, const char *folder) {
    const asdic_file_name csv = asdic_file_in(folder, "trial.part.csv");
    return asdic_file_is_being_written(csv.text) ? asdic_file_fail(ctx, csv.text, EBUSY) : ASDIC_OK;
}

static asdic_status remove_part(fleet *f, const char *folder, uint64_t first, uint64_t end) {
    (void)first;
    (void)end;
    TRY(check_idle(f->ctx, folder));
    remove_files(folder, true);
    rmdir(folder);
    return ASDIC_OK;
}

static asdic_status keep_rows(fleet *f, const asdic_trial *before) {
    size_t variants = f->options->variants.count;
    const char *at = before->body;
    for (size_t i = 0; i < before->row_count; i++) {
        const trial_row *row = &before->rows[i];
        const char *next = strchr(at, '\n') + 1;
        uint64_t job = (row->run - f->first) * variants + row->variant;
        if (row->run >= f->first && job < f->jobs && !f->rows[job].row) {
            f->rows[job].row = strndup(at, (size_t)(next - at));
            if (!f->rows[job].row) {
                return asdic_fail_memory(f->ctx, "a row");
            }
        }
        at = next;
    }
    return ASDIC_OK;
}

/* Keeps the rows in FOLDER that are of F's part. */
static asdic_status find_rows(fleet *f, const char *folder, uint64_t first, uint64_t end) {
    asdic_trial *before = NULL;
    bool is_part = asdic_trial_has(folder, "trial.part.csv");
    if (!is_part && !asdic_trial_has(folder, "trial.json")) {
        return ASDIC_OK;
    }
    TRY(check_idle(f->ctx, folder));
    if (!f->options->resume) {
        return asdic_fail(f->ctx, ASDIC_ERROR_EXISTS,
                          "'%s' holds a trial that was stopped; --resume goes on, --force begins "
                          "anew",
                          f->whole->folder);
    }
    TRY(read_same(f->ctx, folder, f->facts, first, end - first, is_part, &before));
    asdic_status status = keep_rows(f, before);
    asdic_trial_close(&before);
    return status;
}

static asdic_status find_all_rows(fleet *f) {
    const asdic_trial_options *whole = f->whole;
    if (asdic_trial_has(whole->folder, "trial.part.csv")) {
        TRY(find_rows(f, whole->folder, whole->first, whole->first + whole->count));
    }
    return visit_parts(f, true, find_rows);
}

/* --- a part ------------------------------------------------------------------------------------- */

/* Moves the rows before the first job that is left to be flown to ROWS. */
static void take_first_rows(fleet *f, asdic_text *rows) {
    for (; f->taken < f->jobs && f->rows[f->taken].row; f->taken++) {
        asdic_text_add(rows, f->rows[f->taken].row);
        free(f->rows[f->taken].row);
        f->rows[f->taken].row = NULL;
    }
}

static asdic_status fly_rest(fleet *f, const asdic_text *header) {
    const asdic_trial_options *o = f->options;
    asdic_text rows = {0};
    if (o->force) { /* what is there must not pass for what is begun */
        remove_files(o->folder, false);
        TRY(visit_parts(f, false, remove_part));
    } else {
        TRY(find_all_rows(f));
    }
    TRY(asdic_folder_make(f->ctx, o->folder));
    take_first_rows(f, &rows);
    asdic_status status =
        asdic_trial_begin(f->ctx, o->folder, f->facts, header, &rows, o->resume, &f->out);
    asdic_text_finish(&rows);
    TRY(status);
    status = work_all(f);
    if (status) {
        fclose(f->out); /* its rows are there */
        f->out = NULL;
        return status;
    }
    TRY(asdic_trial_end(f->ctx, o->folder, &f->out));
    return asdic_trial_settle(f->ctx, o->folder);
}

/* Flies what is left of the part that F's options say. */
static asdic_status fly_part(fleet *f, const trial_facts *facts, const asdic_text *header) {
    const asdic_trial_options *o = f->options;
    bool is_there = false;
    f->facts = facts;
    f->first = o->first;
    f->jobs = o->count * o->variants.count;
    f->next = f->taken = 0;
    TRY(look_for_whole(f->ctx, o, facts, &is_there));
    if (!is_there) {
        f->rows = calloc(f->jobs, sizeof *f->rows);
        asdic_status status = f->rows ? fly_rest(f, header) : asdic_fail_memory(f->ctx, "a trial");
        for (uint64_t i = 0; f->rows && i < f->jobs; i++) {
            free(f->rows[i].row);
        }
        free(f->rows);
        TRY(status);
    }
    return o->folder == f->whole->folder ? visit_parts(f, false, remove_part) : ASDIC_OK;
}

/* --- several processes ------------------------------------------------------------------------- */

/* Waits until each of the others has said how it fared: by its result, or by why it takes no part. What it says
 * after that is no news. */
static asdic_status hear(asdic_context *ctx, asdic_team *team, bool *heard) {
    asdic_status status = ASDIC_OK;
    for (unsigned left = team->size - 1; left > 0;) {
        asdic_message head;
        const void *payload;
        size_t bytes;
        unsigned from;
        TRY(asdic_message_receive(team, &from, &head, &payload, &bytes));
        if (head.kind == 0) {
            asdic_message_wait();
            continue;
        }
        bool is_result = head.kind == ASDIC_MESSAGE_RESULT;
        bool is_excuse = head.kind == ASDIC_MESSAGE_HELLO && bytes >= sizeof(asdic_message_hello);
        if (from >= team->size || heard[from] || (!is_result && !is_excuse)) {
            continue;
        }
        heard[from] = true;
        left--;
        if (head.status && !status) {
            const char *why = is_result ? payload : ((const asdic_message_hello *)payload)->why;
            int most = (int)(is_result ? bytes : ASDIC_MESSAGE_TEXT);
            status =
                asdic_fail(ctx, (asdic_status)head.status, "process %u: %.*s", from, most, why);
        }
    }
    return status;
}

static asdic_status hear_all(asdic_context *ctx, asdic_team *team) {
    bool *heard = calloc(team->size, sizeof *heard);
    asdic_status status = heard ? hear(ctx, team, heard) : asdic_fail_memory(ctx, "a team");
    free(heard);
    return status;
}

/* This process's part in a folder of its own; process 0 joins them all. */
static asdic_status fly_in_team(fleet *f, trial_facts *facts, const asdic_text *header) {
    const asdic_trial_options *whole = f->whole;
    asdic_team *team = whole->team;
    asdic_trial_options mine = *whole;
    uint64_t from = whole->count * team->rank / team->size;
    uint64_t to = whole->count * (team->rank + 1) / team->size;
    bool is_whole = false;
    TRY(asdic_folder_make(f->ctx, whole->folder));
    TRY(look_for_whole(f->ctx, whole, facts, &is_whole));
    if (is_whole) {
        return team->rank == 0 ? fly_part(f, facts, header) : ASDIC_OK;
    }
    if (whole->count < team->size) {
        return asdic_fail(f->ctx, ASDIC_ERROR_ARGUMENT, "%llu runs for %u processes",
                          (unsigned long long)whole->count, team->size);
    }
    if (whole->force && team->rank == 0) {
        TRY(check_idle(f->ctx, whole->folder));
        remove_files(whole->folder, true);
    }
    mine.first = facts->first = whole->first + from;
    mine.count = facts->count = to - from;
    mine.folder = part_folder(whole->folder, mine.first, mine.first + mine.count);
    if (!mine.folder) {
        return asdic_fail_memory(f->ctx, "a team");
    }
    f->options = &mine;
    asdic_status status = fly_part(f, facts, header);
    f->options = whole;
    free((char *)mine.folder);
    if (team->rank > 0) {
        char why[ASDIC_MESSAGE_TEXT] = "";
        asdic_context_copy_error(f->ctx, why, sizeof why);
        const asdic_message head = {.kind = ASDIC_MESSAGE_RESULT, .status = (int32_t)status};
        asdic_status sent = asdic_message_send(team, 0, &head, why, strlen(why));
        return status ? status : sent;
    }
    asdic_status others = hear_all(f->ctx, team);
    TRY(status ? status : others);
    asdic_trial_options all = *whole; /* whose rows are all there */
    all.force = false;
    all.resume = true;
    facts->first = whole->first;
    facts->count = whole->count;
    f->options = &all;
    status = fly_part(f, facts, header);
    f->options = whole;
    return status;
}

/* --- the calls --------------------------------------------------------------------------------- */

static size_t count_blind(void) {
    unsigned processors = asdic_processors();
    return processors > MOST_BLIND ? MOST_BLIND : processors;
}

asdic_status asdic_trial_fly(asdic_context *ctx, asdic_device **devices, size_t device_count,
                             const asdic_trial_options *options) {
    if (!options) {
        return asdic_fail_null(ctx, __func__);
    }
    asdic_trial_options o = *options;
    trial_facts facts = {.key = NULL};
    asdic_text header = {0};
    bool is_ideal = false;
    TRY(check(ctx, &o));
    fleet f = {.ctx = ctx, .options = &o, .whole = &o, .lock = PTHREAD_MUTEX_INITIALIZER};
    asdic_status status = asdic_trial_check_draws(ctx, &o);
    status = status ? status : describe(ctx, &o, &facts, &header, &is_ideal, f.scene_hash);
    if (!status && !is_ideal && !asdic_devices_are_there(devices, device_count)) {
        status = asdic_fail(ctx, ASDIC_ERROR_ARGUMENT, "a trial that pings needs a device");
    }
    f.devices = is_ideal ? NULL : devices;
    f.worker_count = device_count > 0 ? device_count : count_blind();
    if (!status) {
        status = o.team ? fly_in_team(&f, &facts, &header) : fly_part(&f, &facts, &header);
    }
    pthread_mutex_destroy(&f.lock);
    asdic_trial_facts_finish(&facts);
    asdic_text_finish(&header);
    return status;
}
