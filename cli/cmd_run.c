#include "commands.h"
#include "progress.h"
#include "remarks.h"
#include "team.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SAMPLER_NAME(sampler, name) [sampler] = name,
static const char *const samplers[] = {ASDIC_SAMPLERS(SAMPLER_NAME) NULL};
static const char *const kernels[] = {"auto", "wide8", "pkt16", "frustum64", "scalar", NULL};

/* Where --tolerance gives up. */
#define MOST_RAYS (1u << 22)

typedef struct request {
    const char *scene;
    char *folder;              /* "-": the rows of bins.csv alone, to the standard output */
    asdic_tolerance tolerance; /* stderr_db NAN: none asked for */
    uint64_t first, end;       /* pings */
    cli_part part;
    bool force, resume;
} request;

static bool is_stream(const char *folder) {
    return strcmp(folder, "-") == 0;
}

/* What the options say in the place of the scene. */
static void read_sampling(cli *c, asdic_sampling *sampling) {
    uint64_t rays = sampling->rays;
    int sampler = (int)sampling->sampler, kernel = 0;
    cli_integer(c, "rays", 64, 1u << 28, &rays);
    cli_choice(c, "sampler", samplers, &sampler);
    cli_choice(c, "kernel", kernels, &kernel);
    cli_integer(c, "seed", 0, UINT64_MAX, &sampling->seed);
    sampling->rays = (uint32_t)rays;
    sampling->sampler = (asdic_sampler)sampler;
    sampling->kernel = (asdic_ray_kernel)kernel;
}

static bool read_request(cli *c, request *r) {
    double percent = 99.0;
    asdic_sampling sampling = asdic_sampling_default();
    *r = (request){.scene = cli_operand(c, 0),
                   .end = UINT64_MAX,
                   .tolerance = {.stderr_db = NAN, .most_rays = MOST_RAYS}};
    read_sampling(c, &sampling);
    cli_number(c, "tolerance", 1e-4, 20.0, &r->tolerance.stderr_db);
    cli_number(c, "tolerance-percent", 1.0, 100.0, &percent);
    r->tolerance.share = percent / 100.0;
    cli_index_range(c, "pings", &r->first, &r->end);
    r->part = cli_share(c, "shard");
    cli_mode(c, &r->force, &r->resume);
    if (cli_given(c, "tolerance-percent") && isnan(r->tolerance.stderr_db)) {
        cli_usage(c, "--tolerance-percent needs --tolerance DB");
        return false;
    }
    return !cli_bad_usage(c);
}

/* The pings of --pings, of these the part of --shard, which may have none. False where the mission lacks them. */
static bool choose_pings(cli *c, const request *r, size_t pings, asdic_run_options *options) {
    uint64_t first = r->first, end = r->end < pings ? r->end : pings;
    if (r->first >= pings || (r->end != UINT64_MAX && r->end > pings)) {
        cli_usage(c, "--pings goes beyond the mission's %zu ping%s (0..%zu)", pings,
                  cli_plural(pings), pings - 1);
        return false;
    }
    options->of_first = first;
    options->of_count = end - first;
    cli_take_part(r->part, &first, &end);
    options->first = first;
    options->count = end - first;
    return true;
}

/* Which bins stay above the tolerance. */
static void say_rough(const cli *c, const asdic_sonar *sonar, const asdic_tolerance *wanted,
                      const asdic_ray_budget *found) {
    if (found->rough_count == 0) {
        return;
    }
    (found->is_kept ? cli_note : cli_warning)(
        c, "%zu of %zu bins above the noise, in %zu pings, stay above %g dB%s; the roughest:",
        found->rough_count, found->judged, found->pings, wanted->stderr_db,
        found->is_kept ? "" : " with the most rays there are");
    for (size_t i = 0; i < found->rough_count && i < ASDIC_ROUGH_BINS; i++) {
        const asdic_rough_bin *b = &found->rough[i];
        cli_note(c, "  ping %zu, beam '%s', bin %zu (%g m): %.3g dB", b->ping,
                 sonar->receivers[b->beam].name, b->bin,
                 ((double)b->bin + 0.5) * sonar->bin_length_m, b->stderr_db);
    }
}

/* Finds the number of rays that --tolerance needs; prints it, and what it costs PINGS pings from FIRST on. */
static asdic_status keep_tolerance(cli *c, asdic_mission *mission, asdic_device *device,
                                   const asdic_tolerance *wanted, size_t first, size_t pings) {
    asdic_ray_budget found;
    size_t all = asdic_mission_ping_count(mission);
    TRY(asdic_mission_refract_as_needed(cli_context(c), mission));
    TRY(asdic_mission_find_rays(cli_context(c), mission, device, wanted, &found));
    if (found.judged == 0) {
        cli_warning_always(
            c,
            "tolerance %g dB: no bin is above the noise in the %zu of %zu pings looked at, so that "
            "none can keep it; the %u rays per ping stay as they are",
            wanted->stderr_db, found.pings, all, found.rays);
    } else {
        double kept = 1.0 - (double)found.rough_count / (double)found.judged;
        cli_note(c,
                 "tolerance %g dB: %u rays per ping keep it in %.4g %% of bins, worst bin %.3g dB, "
                 "in the %zu of %zu pings looked at",
                 wanted->stderr_db, found.rays, 100.0 * kept, found.worst_db, found.pings, all);
    }
    double lessons = (double)asdic_mission_lessons(mission, first, pings);
    double seconds = found.ping_s * (double)pings + found.learn_s * lessons;
    cli_note(c, "  %zu %s about %.3g %s on one device", pings,
             pings == 1 ? "ping takes" : "pings take", seconds < 120.0 ? seconds : seconds / 60.0,
             seconds < 120.0 ? "s" : "minutes");
    say_rough(c, asdic_mission_sonar(mission), wanted, &found);
    return ASDIC_OK;
}

/* "14.20 s: devices 13.10 s, writing 0.50 s, drawing 0.30 s (the last two 6 %)" */
static void say_times(const cli *c, const asdic_run_times *t) {
    cli_note(c, "%.2f s: devices %.2f s, writing %.2f s, drawing %.2f s (the last two %.0f %%)",
             t->whole_s, t->devices_s, t->write_s, t->pictures_s,
             100.0 * (t->write_s + t->pictures_s) / t->whole_s);
}

/* "stated error 0.41 dB r.m.s. in bins above the noise (median 0.2, worst 3.1)" */
static void say_errors(cli *c, const char *folder) {
    asdic_run *run = NULL;
    if (is_stream(folder) || asdic_run_open(cli_context(c), folder, &run) != ASDIC_OK) {
        return;
    }
    asdic_run_errors e = asdic_run_get_errors(run);
    if (!isnan(e.rms_db)) {
        cli_note(c,
                 "stated error %.2g dB r.m.s. in bins above the noise; of all, median %.2g, worst "
                 "%.2g%s",
                 e.rms_db, e.median_db, e.worst_db,
                 e.rms_db > ASDIC_ROUGH_DB ? ": take more rays, --rays N" : "");
    } else if (!isnan(e.median_db)) {
        cli_note(c, "no bin is above the noise; of all, stated error median %.2g dB, worst %.2g",
                 e.median_db, e.worst_db);
    }
    asdic_run_close(&run);
}

static void summarise(cli *c, const asdic_mission *mission, const asdic_run_options *options,
                      const cli_progress *progress) {
    char rate[16], speed[32] = "";
    double rays_per_s = cli_progress_rays_per_s(progress);
    const asdic_run_progress *last = &progress->last;
    if (options->times->simulate_s == 0.0) {
        cli_note(c, "%s: %s", options->folder,
                 options->times->write_s == 0.0 ? "complete already"
                                                : "complete; its files are written again");
        return;
    }
    if (rays_per_s > 0.0) {
        cli_progress_short(rate, rays_per_s);
        snprintf(speed, sizeof speed, ", %srays/s", rate);
    }
    const char *where = is_stream(options->folder) ? "standard output" : options->folder;
    cli_note(c, "%s: %zu ping%s, %zu beam%s, %.2f s%s", where, last->pings_total,
             cli_plural(last->pings_total), asdic_mission_sonar(mission)->receiver_count,
             cli_plural(asdic_mission_sonar(mission)->receiver_count), last->elapsed_s, speed);
    say_times(c, options->times);
    say_errors(c, options->folder);
}

static asdic_status simulate(cli *c, asdic_mission *mission, const asdic_tolerance *tolerance,
                             const asdic_run_options *wanted) {
    asdic_device **devices = NULL;
    size_t count = 0;
    asdic_run_options options = *wanted;
    cli_progress progress = cli_progress_begin(c); /* only process 0 reports progress */
    asdic_status status = cli_open_devices(c, &devices, &count);
    if (status != ASDIC_OK) {
        return status;
    }
    asdic_run_times times = {0};
    options.times = &times;
    options.progress = cli_progress_report;
    options.user = &progress;
    cli_progress_watch(&progress);
    if (!isnan(tolerance->stderr_db) && !cli_team_is_worker(options.team)) {
        status = keep_tolerance(c, mission, devices[0], tolerance, options.first, options.count);
    }
    if (status == ASDIC_OK) {
        status = asdic_mission_run(cli_context(c), mission, devices, count, &options);
    }
    cli_progress_end(&progress);
    if (status == ASDIC_OK) {
        summarise(c, mission, &options, &progress);
    }
    asdic_devices_close(&devices, count);
    return status;
}

static void announce(const cli *c, const request *r, const asdic_mission *mission,
                     const asdic_run_options *options) {
    char size[CLI_SIZE_TEXT];
    if (!is_stream(options->folder) && !cli_team_is_worker(options->team)) {
        cli_remark_csv(c, r->scene, mission);
        cli_note(c, "%s: %s", options->folder,
                 cli_size(mission, options->count, options->folder, size));
    }
}

static int run_alone_or_in(cli *c, asdic_team *team) {
    request r;
    asdic_mission *mission = NULL;
    asdic_run_options options = asdic_run_options_default();
    int code = CLI_USAGE;
    if (!read_request(c, &r)) {
        return CLI_USAGE;
    }
    asdic_status status = asdic_mission_load(cli_context(c), r.scene, &mission);
    if (status != ASDIC_OK) {
        return cli_end(c, status);
    }
    read_sampling(c, asdic_mission_sampling(mission));
    if (!cli_refract(c, mission)) {
        goto done;
    }
    r.folder = cli_output(c, "run", r.part, "");
    if (!r.folder) {
        code = cli_end(c, ASDIC_ERROR_MEMORY);
        goto done;
    }
    if (cli_is_stdout(r.folder)) {
        strcpy(r.folder, "-");
    }
    cli_remark(c, r.scene, mission, !r.resume && !is_stream(r.folder));
    if (!choose_pings(c, &r, asdic_mission_ping_count(mission), &options)) {
        goto done;
    }
    options.folder = r.folder;
    if (options.count == 0) {
        code = cli_leave_empty(c, "pings", options.of_count, is_stream(r.folder) ? NULL : r.folder);
        goto done;
    }
    options.force = r.force;
    options.resume = r.resume;
    options.team = team;
    announce(c, &r, mission, &options);
    code = cli_end(c, simulate(c, mission, &r.tolerance, &options));
done:
    free(r.folder);
    asdic_mission_destroy(&mission);
    return code;
}

static int run(cli *c) {
    asdic_team *team = NULL;
    if (!cli_team_begin(c, &team)) {
        return CLI_USAGE;
    }
    bool is_worker = cli_team_is_worker(team);
    int code = run_alone_or_in(c, team);
    cli_team_end(c, &team);
    return is_worker ? CLI_OK : code;
}

static const cli_option options[] = {
    {"output", 'o', "DIR",
     "run folder; default: run_<name of the scene>; - writes bins.csv alone to standard output"},
    {"rays", 0, "N", "rays per ping, instead of the scene's"},
    {"tolerance", 0, "DB",
     "double the rays until one standard error of bins above the noise is at most this"},
    {"tolerance-percent", 0, "P", "... in this percentage of these bins; default 99"},
    {"sampler", 0, "NAME", "adaptive, beam or uniform-sphere (the paper's)"},
    {"kernel", 0, "NAME",
     "auto, wide8, pkt16, frustum64 or scalar: how rays are cast; auto takes the fastest; same "
     "bytes"},
    {"refraction", 0, "WORD",
     "full, layer (one, fitted) or off: how much of a sound-speed profile rays follow; default: as "
     "the scene says"},
    {"seed", 0, "N", "seed of the random directions, instead of the scene's"},
    {"pings", 0, "A[:B]", "pings A to B-1 only, counted from 0; A alone: that ping"},
    {"shard", 0, "K/N", "the K-th of N parts of the pings; 'asdic merge' joins the parts"},
    {"resume", 0, NULL,
     "go on with a run that was stopped, make again what of it is damaged; the files will be the "
     "same"},
    {"force", 'f', NULL, "replace a run that is there; begin also where its files may not fit"},
    {0},
};

const cli_command cli_run_command = {
    .name = "run",
    .operands = "SCENE.yaml",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "simulate every ping of a scene",
    .details =
        "Writes a run folder: bins.csv (one row per ping, beam and bin), pings.npy (the "
        "same in binary), the pictures that the scene asks for, and run.json (what was "
        "run, on what, how fast, how good; remarks where a law is used beyond the range that "
        "its source states). A run that was interrupted, or killed, is "
        "finished by --resume.\n\n"
        "--tolerance looks at up to 16 pings spread over the mission, the first and the last among "
        "them, and doubles the rays until 99 % of their bins above the noise keep it, or what "
        "--tolerance-percent says, at most 4194304 a ping. It prints the rays, the time that they "
        "will take, and the roughest of the "
        "bins that would need more.\n\n"
        "Where asdic was built with MPI, 'mpirun -n 4 --bind-to none asdic run ...' shares "
        "the pings among four processes, which may be on several machines that see the "
        "same files; one run folder is written, with the bytes of a single process.",
    .examples = "asdic run scene.yaml -o out\n"
                "asdic run scene.yaml --tolerance 0.5 --seed 7\n"
                "asdic run scene.yaml --shard 1/8 --resume\n"
                "asdic run scene.yaml -q -o - | head",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_INTERRUPTIBLE,
    .run = run,
};
