#include "commands.h"
#include "progress.h"
#include "team.h"
#include "trial_rule.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define MOST_WORKERS 256
/* Where --tolerance gives up. */
#define MOST_RAYS (1u << 20)

typedef struct request {
    asdic_trial_options options;
    uint64_t workers;
    char *key; /* of --vary */
    const char *values[ASDIC_TRIAL_MOST_VARIANTS];
    cli_part part;
    double tolerance_db; /* NAN: none asked for */
    const char *program;
    double timeout_s;
    const char *replay;
    uint64_t replay_run, replay_variant;
} request;

/* RUN or RUN:VARIANT. */
static bool read_replay(cli *c, request *r) {
    static const char *const others[] = {"shard", "resume", "workers", "json", NULL};
    const char *end;
    r->replay = cli_text(c, "replay");
    if (!r->replay) {
        return true;
    }
    for (size_t i = 0; others[i]; i++) {
        if (cli_given(c, others[i])) {
            cli_usage(c, "--replay goes without --%s: it is one run, in a run folder", others[i]);
            return false;
        }
    }
    bool good = cli_read_integer(r->replay, &r->replay_run, &end);
    if (good && *end == ':') {
        good = cli_read_integer(end + 1, &r->replay_variant, &end);
    }
    if (!good || *end || r->replay_variant >= r->options.variants.count) {
        cli_usage(c, "option '--replay': '%s' is no RUN or RUN:VARIANT, with variants 0 to %zu",
                  r->replay, r->options.variants.count - 1);
        return false;
    }
    if (cli_given(c, "runs") && r->replay_run >= r->options.runs) {
        cli_usage(c, "option '--replay': run %llu is none of the %llu runs, 0 to %llu",
                  (unsigned long long)r->replay_run, (unsigned long long)r->options.runs,
                  (unsigned long long)r->options.runs - 1);
        return false;
    }
    return true;
}

static bool read_request(cli *c, request *r) {
    uint64_t rays = 0;
    *r = (request){.options = asdic_trial_options_default(),
                   .tolerance_db = NAN,
                   .timeout_s = 10.0,
                   .program = cli_text(c, "rule")};
    asdic_trial_options *o = &r->options;
    cli_integer(c, "runs", 1, 1000000000, &o->runs);
    cli_integer(c, "seed", 0, UINT64_MAX, &o->seed);
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    r->workers = processors < 1              ? 1
                 : processors > MOST_WORKERS ? MOST_WORKERS
                                             : (uint64_t)processors;
    cli_integer(c, "workers", 1, MOST_WORKERS, &r->workers);
    cli_integer(c, "rays", 64, 1u << 28, &rays);
    cli_number(c, "tolerance", 1e-2, 20.0, &r->tolerance_db);
    r->part = cli_share(c, "shard");
    cli_number(c, "rule-timeout", 0.01, 86400.0, &r->timeout_s);
    o->scene = cli_operand(c, 0);
    o->rays = (uint32_t)rays;
    cli_mode(c, &o->force, &o->resume);
    if (cli_bad_usage(c) ||
        !cli_vary(c, ASDIC_TRIAL_MOST_VARIANTS, &r->key, r->values, &o->variants.count)) {
        return false;
    }
    o->variants.key = r->key;
    o->variants.values = r->values;
    if (strcmp(o->scene, "-") == 0) {
        cli_usage(c, "the scene is read for every run; it must be a file");
        return false;
    }
    if (cli_given(c, "rule-timeout") && !r->program) {
        cli_usage(c, "--rule-timeout needs --rule PROGRAM");
        return false;
    }
    if (r->program && !trial_program_exists(r->program)) {
        cli_usage(c, "option '--rule': there is no program '%s'; give a path, or a name in PATH",
                  r->program);
        return false;
    }
    uint64_t from = 0, to = o->runs;
    cli_take_part(r->part, &from, &to);
    o->first = from;
    o->count = to - from;
    return read_replay(c, r);
}

/* Of the trial, with the shard, or of the run that is flown again. */
static char *output_folder(const cli *c, const request *r) {
    char run[24];
    snprintf(run, sizeof run, "_%llu", (unsigned long long)r->replay_run);
    return r->replay ? cli_output(c, "run", (cli_part){1, 1}, run)
                     : cli_output(c, "trial", r->part, "");
}

/* --- the table --------------------------------------------------------------------------------- */

static void print_figure(const asdic_trial_figure *f, int digits) {
    if (!isfinite(f->value)) { /* no run could be flown */
        printf(" %9s %18s", "-", "-");
        return;
    }
    printf(" %9.*f %8.*f..%-8.*f", digits, f->value, digits, f->low, digits, f->high);
}

static void print_variant(const asdic_trial *trial, size_t v, int wide) {
    asdic_trial_result r = asdic_trial_get(trial, v);
    printf("%-*s %8llu", wide, asdic_trial_variant_name(trial, v), (unsigned long long)r.runs);
    print_figure(&r.collision, 4);
    print_figure(&r.needless_per_km, 3);
    if (isfinite(r.least_clearance_m)) {
        printf(" %9.2f\n", r.least_clearance_m);
    } else {
        printf(" %9s\n", "-");
    }
}

static void print_causes(const asdic_trial *trial, size_t v, int wide) {
    asdic_trial_result r = asdic_trial_get(trial, v);
    printf("%-*s %8llu %9llu %10llu %14llu %6llu %6llu %7llu %9.2f\n", wide,
           asdic_trial_variant_name(trial, v), (unsigned long long)r.outcomes[ASDIC_TRIAL_HIT],
           (unsigned long long)r.causes[ASDIC_TRIAL_NOT_SEEN],
           (unsigned long long)r.causes[ASDIC_TRIAL_SEEN_LATE],
           (unsigned long long)r.causes[ASDIC_TRIAL_COULD_NOT_TURN],
           (unsigned long long)r.outcomes[ASDIC_TRIAL_LATE],
           (unsigned long long)r.outcomes[ASDIC_TRIAL_VOID],
           (unsigned long long)r.outcomes[ASDIC_TRIAL_BROKEN], r.km);
}

static void print_difference(const asdic_trial *trial, size_t v, int wide) {
    asdic_trial_result r = asdic_trial_get(trial, v);
    if (!isfinite(r.difference.value)) { /* no run was flown by both */
        printf("%-*s %9s %17s %12s\n", wide, asdic_trial_variant_name(trial, v), "-", "-", "-");
        return;
    }
    printf("%-*s %+9.4f %+8.4f..%+.4f %12.2g", wide, asdic_trial_variant_name(trial, v),
           r.difference.value, r.difference.low, r.difference.high, r.mcnemar);
    if (isfinite(r.paired_share)) {
        printf(" %17.0f %%", 100.0 * r.paired_share);
    }
    printf("\n");
}

static void print_table(const asdic_trial *trial) {
    size_t count = asdic_trial_variant_count(trial);
    int wide = 8;
    for (size_t v = 0; v < count; v++) {
        int length = (int)strlen(asdic_trial_variant_name(trial, v));
        wide = length > wide ? length : wide;
    }
    printf("%-*s %8s %9s %18s %9s %18s %9s\n", wide, "design", "runs", "collision", "95 % bounds",
           "needless", "per km, bounds", "nearest m");
    for (size_t v = 0; v < count; v++) {
        print_variant(trial, v, wide);
    }
    printf("\n%-*s %8s %9s %10s %14s %6s %6s %7s %9s\n", wide, "design", "hits", "not seen",
           "seen late", "could not turn", "late", "void", "broken", "km");
    for (size_t v = 0; v < count; v++) {
        print_causes(trial, v, wide);
    }
    if (count > 1) {
        printf("\n%-*s %9s %17s %12s %19s\n", wide, "less the first", "collision", "95 % bounds",
               "by chance", "runs, of unpaired");
    }
    for (size_t v = 1; v < count; v++) {
        print_difference(trial, v, wide);
    }
}

static bool print_file(const char *folder, const char *name) {
    char *path = NULL;
    FILE *file = asprintf(&path, "%s/%s", folder, name) < 0 ? NULL : fopen(path, "r");
    char buffer[4096];
    for (size_t got; file && (got = fread(buffer, 1, sizeof buffer, file)) > 0;) {
        fwrite(buffer, 1, got, stdout);
    }
    free(path);
    return file && fclose(file) == 0;
}

/* --- flying ------------------------------------------------------------------------------------ */

typedef struct report {
    cli_progress progress;
    uint64_t pings;
} report;

static void note_progress(void *user, uint64_t done, uint64_t all, uint64_t pings) {
    report *r = user;
    cli_progress_step(&r->progress, "runs", done, all);
    r->pings = pings;
}

/* The figures of a trial that is complete. Draws that cannot be flown, and rules that fail, are said
 * and counted: the second kind ends the program with a failure. */
static int tell(cli *c, const char *folder) {
    asdic_trial *trial = NULL;
    asdic_status status = asdic_trial_open(cli_context(c), folder, &trial);
    int code = cli_end(c, status);
    uint64_t voids = 0, broken = 0, flown = 0;
    for (size_t v = 0; v < asdic_trial_variant_count(trial); v++) {
        asdic_trial_result r = asdic_trial_get(trial, v);
        voids += r.outcomes[ASDIC_TRIAL_VOID];
        broken += r.outcomes[ASDIC_TRIAL_BROKEN];
        flown += r.runs;
    }
    if (!status && cli_given(c, "json")) {
        code = print_file(folder, "trial.json") ? CLI_OK : CLI_FAILED;
    } else if (!status) {
        print_table(trial);
    }
    if (voids > 0) {
        cli_warning_always(
            c,
            "%llu runs are void: what is drawn puts the vehicle into the bottom or an "
            "object; they are left out of all shares",
            (unsigned long long)voids);
    }
    if (!status && broken > 0) {
        cli_error(c,
                  "the rule failed in %llu runs, which are left out of all shares; trial.csv has "
                  "their numbers",
                  (unsigned long long)broken);
        code = CLI_FAILED;
    } else if (!status && flown == 0) {
        cli_error(c, "no run could be flown; change what 'trial: {draws: ...}' draws");
        code = CLI_FAILED;
    }
    asdic_trial_close(&trial);
    return code;
}

static asdic_status fly_on(cli *c, request *r, asdic_device **devices, size_t count) {
    asdic_trial_options *o = &r->options;
    report seen = {.progress = cli_progress_begin(c)};
    o->progress = note_progress;
    o->user = &seen;
    asdic_status status = asdic_trial_fly(cli_context(c), devices, count, o);
    cli_progress_end(&seen.progress);
    if (!status && seen.pings > 0 && !cli_team_is_worker(o->team)) {
        cli_note(c, "%s: %llu ping%s", o->folder, (unsigned long long)seen.pings,
                 cli_plural(seen.pings));
    }
    return status;
}

/* Flies one run again, and simulates its pings into the run folder. */
static asdic_status replay_on(cli *c, request *r, asdic_device **devices, size_t count) {
    asdic_trial_run flown;
    char *scene = NULL;
    asdic_status status = asdic_trial_replay(cli_context(c), devices[0], &r->options, r->replay_run,
                                             (size_t)r->replay_variant, r->options.folder, &flown);
    asdic_mission *mission = NULL;
    if (!status && asprintf(&scene, "%s/scene.yaml", r->options.folder) < 0) {
        scene = NULL;
        status = ASDIC_ERROR_MEMORY;
    }
    status = status ? status : asdic_mission_load(cli_context(c), scene, &mission);
    if (!status) {
        asdic_run_options options = asdic_run_options_default();
        options.folder = r->options.folder;
        options.force = options.own_track = true; /* the replay looked; its track is there */
        status = asdic_mission_run(cli_context(c), mission, devices, count, &options);
    }
    if (!status) {
        const char *cause = asdic_trial_cause_name(flown.cause);
        cli_note(c, "%s: run %llu, %s%s%s%s%s, %zu ping%s; 'asdic view %s/scene.yaml' shows it",
                 r->options.folder, (unsigned long long)r->replay_run,
                 asdic_trial_outcome_name(flown.outcome), *flown.what ? " of " : "", flown.what,
                 *cause ? ", " : "", cause, flown.pings, cli_plural(flown.pings),
                 r->options.folder);
    }
    asdic_mission_destroy(&mission);
    free(scene);
    return status;
}

/* Devices opened as often as there are workers: what the host does for a ping takes longer than what
 * a device does. */
typedef struct workforce {
    asdic_device **opened[MOST_WORKERS];
    size_t times, each; /* devices that are opened at a time */
    asdic_device **all;
} workforce;

static asdic_status recruit(cli *c, size_t workers, workforce *w) {
    do {
        TRY(cli_open_devices(c, &w->opened[w->times], &w->each));
        w->times++;
    } while (w->times * w->each < workers && w->times < MOST_WORKERS);
    w->all = malloc(w->times * w->each * sizeof(asdic_device *));
    for (size_t i = 0; w->all && i < w->times * w->each; i++) {
        w->all[i] = w->opened[i / w->each][i % w->each];
    }
    return w->all ? ASDIC_OK : ASDIC_ERROR_MEMORY;
}

static void dismiss(workforce *w) {
    for (size_t i = 0; i < w->times; i++) {
        asdic_devices_close(&w->opened[i], w->each);
    }
    free(w->all);
}

/* The rays that --tolerance takes along the way of run 0 of each design, the most of them. */
static asdic_status find_rays(cli *c, request *r, asdic_device *device) {
    asdic_trial_options *o = &r->options;
    const asdic_trial_options asked = *o;
    const asdic_tolerance wanted = {r->tolerance_db, 0.99, MOST_RAYS};
    size_t pings = 0;
    for (size_t v = 0; v < o->variants.count; v++) {
        asdic_ray_budget found;
        TRY(asdic_trial_find_rays(cli_context(c), device, &asked, v, &wanted, &found));
        o->rays = found.rays > o->rays ? found.rays : o->rays;
        pings += found.pings;
        if (found.judged == 0) {
            cli_warning_always(
                c,
                "tolerance %g dB: no bin is above the noise along the way of run 0, so that "
                "none can keep it; the search ends at its first %u rays per ping",
                wanted.stderr_db, found.rays);
        } else if (!found.is_kept) {
            cli_warning_always(
                c,
                "%u rays per ping do not keep %g dB: %zu of %zu bins in %zu pings stay "
                "above it, the worst bin has %.3g dB",
                found.rays, wanted.stderr_db, found.rough_count, found.judged, found.pings,
                found.worst_db);
        }
    }
    cli_note(c, "tolerance %g dB: %u rays per ping, by %zu ping%s along the way of run 0",
             wanted.stderr_db, o->rays, pings, cli_plural(pings));
    return ASDIC_OK;
}

static int fly(cli *c, request *r, asdic_team *team) {
    workforce w = {.times = 0};
    r->options.team = team;
    asdic_status status = recruit(c, r->replay ? 1 : r->workers, &w);
    if (!status && !isnan(r->tolerance_db)) {
        status = find_rays(c, r, *w.all);
    }
    size_t count = w.times * w.each;
    asdic_trial_rule rule = {.decide = trial_programs_decide, .name = r->program};
    trial_programs *programs = NULL;
    if (!status && r->program) {
        programs = trial_programs_begin(r->program, count, r->timeout_s);
        rule.user = programs;
        r->options.rule = &rule;
        status = programs ? ASDIC_OK : ASDIC_ERROR_MEMORY;
    }
    if (!status) {
        status = (r->replay ? replay_on : fly_on)(c, r, w.all, count);
    }
    trial_programs_end(&programs);
    dismiss(&w);
    if (status || r->replay || cli_team_is_worker(team)) {
        return cli_end(c, status);
    }
    return tell(c, r->options.folder);
}

static int run(cli *c) {
    request r = {.key = NULL};
    asdic_team *team = NULL;
    int code = CLI_USAGE;
    if (!cli_team_begin(c, &team)) {
        return CLI_USAGE;
    }
    bool is_worker = cli_team_is_worker(team);
    if (read_request(c, &r) && !(r.replay && is_worker)) { /* one run is one process's */
        char *folder = output_folder(c, &r);
        r.options.folder = folder;
        code = !folder                ? CLI_FAILED
               : r.options.count == 0 ? cli_leave_empty(c, "runs", r.options.runs, folder)
                                      : fly(c, &r, team);
        free(folder);
    }
    free(r.key);
    cli_team_end(c, &team);
    return is_worker ? CLI_OK : code;
}

static const cli_option options[] = {
    {"output", 'o', "DIR",
     "where trial.csv, trial.json and trial.png go; default: trial_<name of the scene>"},
    {"runs", 0, "N", "runs of each design, else 1000"},
    {"seed", 0, "N", "of all draws and pings, else 1; designs share them"},
    {"vary", 0, "KEY=A,B,..",
     "a design for each value of this key of the scene, as sonar.file=one.yaml,three.yaml; also "
     "lists and maps, as 'mission.waypoints.current_mps=[0,0],[1,0]'"},
    {"rays", 0, "N", "rays per ping, instead of the scene's; of 'auto' 4096"},
    {"tolerance", 0, "DB",
     "as many rays per ping as keep the stated error of 99 % of the bins below this along the way "
     "of run 0, from --rays on"},
    {"workers", 0, "N", "runs that are flown at a time, else one for each processor"},
    {"rule", 0, "PROGRAM",
     "let this command, run by the shell, decide: it reads pings as 'asdic serve --detect' writes "
     "them, and answers each with a line"},
    {"rule-timeout", 0, "S", "the longest that it may take for an answer, else 10 s"},
    {"replay", 0, "RUN[:V]",
     "fly one run of the trial again, of design V (from 0), into a run folder"},
    {"shard", 0, "K/N", "the K-th of N parts of the runs; 'asdic merge' joins the parts"},
    {"resume", 0, NULL, "go on with a trial that was stopped; the files will be the same"},
    {"force", 'f', NULL, "replace a trial that is there"},
    {0},
};

const cli_command cli_trial_command = {
    .name = "trial",
    .operands = "SCENE.yaml",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "how often a vehicle with this sonar hits something, and turns from nothing",
    .details =
        "Flies the scene's waypoints many times. Every run draws what 'trial: {draws: ...}' says; "
        "at each ping the vehicle pings, detects ('detector'), and holds on, climbs or turns by "
        "'trial: {rule: ...}'. A run ends at the last waypoint, when time is over, or where the "
        "hull's radius meets a triangle on the way from ping to ping.\n\n"
        "Prints the probability of a collision with its interval, by Clopper and Pearson, needless "
        "manoeuvres per kilometre, and how collisions came about: not seen; seen late, where the "
        "same manoeuvre begun at the rule's reach would have cleared it; could not turn. With "
        "--vary all designs fly the same runs, and the difference from the first has an interval "
        "of its own (Tango) and McNemar's test.\n\n"
        "A rule's answer is a JSON object: {} holds on, {\"z_m\": 5} and {\"yaw_deg\": 40} fly "
        "that depth and heading until the next ping. A program that crashes, answers nonsense "
        "(also names of which none is known, {\"turn\": true}) or takes too long breaks the run: "
        "it is counted, and the program is started anew.",
    .examples = "asdic trial scene.yaml --runs 10000 --vary trial.rule.reach_m=10,20 -o out\n"
                "asdic trial scene.yaml --runs 10000 --replay 17 -o run17\n"
                "asdic view run17/scene.yaml",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_HAS_JSON | CLI_INTERRUPTIBLE,
    .run = run,
};
