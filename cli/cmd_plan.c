/*
 * asdic plan: what a scene needs, what it will cost, how exact it will be.
 */
#include "commands.h"
#include "json.h"
#include "progress.h"
#include "remarks.h"

#include <math.h>
#include <string.h>

typedef struct forecast {
    bool known, asked;               /* ASKED: the scene or the user says how rays bend */
    double plan_s;                   /* which terms and rays it takes: a run finds that, too */
    double first_s, learn_s, ping_s; /* kernels and upload; a lesson; every ping */
    double write_s;                  /* every ping into the files */
    size_t lessons;
    asdic_run_errors errors; /* stated */
} forecast;

/* Shoots the mission's first ping a few times: the forecast is a measurement. */
static asdic_status shoot(cli_progress *progress, asdic_simulator *sim, const asdic_pose *pose,
                          asdic_ping *ping, forecast *f) {
    enum { PINGS = 5 };
    double start = cli_clock_s();
    TRY(asdic_simulator_learn(sim, pose, 0)); /* compiles */
    f->first_s += cli_clock_s() - start;
    start = cli_clock_s();
    TRY(asdic_simulator_learn(sim, pose, 0));
    f->learn_s = cli_clock_s() - start;
    f->ping_s = INFINITY;
    for (size_t k = 0; k < PINGS; k++) {
        start = cli_clock_s();
        cli_progress_step(progress, "pings measured", k, PINGS);
        TRY(asdic_simulator_ping(sim, pose, 0, ping));
        f->ping_s = fmin(f->ping_s, cli_clock_s() - start);
    }
    f->known = true;
    return ASDIC_OK;
}

static asdic_status measure(cli *c, asdic_mission *mission, asdic_device *device,
                            cli_progress *progress, forecast *f) {
    asdic_context *ctx = cli_context(c);
    const asdic_sonar *sonar = asdic_mission_sonar(mission);
    asdic_pose pose = asdic_mission_pose(mission, 0, NULL);
    asdic_simulator *sim = NULL;
    asdic_ping *ping = NULL;
    double start = cli_clock_s();
    TRY(asdic_simulator_create(ctx, device, asdic_mission_scene(mission),
                               asdic_mission_environment(mission), sonar,
                               asdic_mission_sampling(mission), pose.position_m.z, &sim));
    asdic_status status =
        asdic_ping_create(ctx, sonar->receiver_count, asdic_simulator_bin_count(sim), &ping);
    f->first_s = cli_clock_s() - start;
    f->lessons = asdic_mission_lessons(mission, 0, asdic_mission_ping_count(mission));
    status = status ? status : shoot(progress, sim, &pose, ping, f);
    status = status ? status : asdic_ping_get_errors(ctx, ping, &f->errors);
    status = status ? status : asdic_mission_time_writing(ctx, mission, ping, &f->write_s);
    asdic_ping_destroy(&ping);
    asdic_simulator_destroy(&sim);
    return status;
}

static double mission_seconds(const forecast *f, const asdic_mission *mission) {
    size_t pings = asdic_mission_ping_count(mission);
    return f->plan_s + f->first_s + (double)f->lessons * f->learn_s +
           (double)pings * (f->ping_s + f->write_s);
}

static void print_bound(const asdic_plan_row *row, char *text, size_t size) {
    if (row->bound_db == 0.0) {
        snprintf(text, size, "exact");
    } else if (isinf(row->bound_db)) {
        snprintf(text, size, "-");
    } else {
        snprintf(text, size, "%.2g dB", row->bound_db);
    }
}

/* What rays follow of the sound speed, and what simpler forms would change. */
static void print_refraction(const asdic_mission *mission, const asdic_refraction_plan *refraction,
                             bool asked) {
    static const char *const words[] = {"all layers", "one layer", "straight"};
    if (refraction->layer_to_m == 0.0) {
        return;
    }
    printf("\nrays: %s%s; %s\n", words[asdic_mission_environment(mission)->refraction],
           asked ? ", as asked for" : "", refraction->reason);
}

static void print_text(const asdic_mission *mission, const asdic_plan *plan,
                       const asdic_refraction_plan *refraction, const forecast *f) {
    uint32_t rays = asdic_mission_sampling((asdic_mission *)mission)->rays;
    size_t pings = asdic_mission_ping_count(mission);
    asdic_scene_info scene = asdic_scene_get_info(asdic_mission_scene(mission));
    printf("%-11s %-9s %-10s %s\n", "term", "", "bound", "why");
    for (int t = 0; t < ASDIC_TERM_COUNT; t++) {
        char bound[32];
        print_bound(&plan->rows[t], bound, sizeof bound);
        printf("%-11s %-9s %-10s %s\n", plan->rows[t].name,
               plan->rows[t].kept ? "kept" : "left out", bound, plan->rows[t].reason);
    }
    print_refraction(mission, refraction, f->asked);
    char phase[160];
    bool needed = asdic_mission_needs_phase(mission, phase, sizeof phase);
    bool coherent = asdic_mission_sampling((asdic_mission *)mission)->coherent;
    printf("\nphase: %s%s; %s\n", needed ? "needed" : "not needed",
           coherent ? ", and simulated"
           : needed ? ", yet pings add intensities"
                    : "",
           phase);
    printf("\n%zu ping%s of %u rays; %zu triangles, %.1f MB of hierarchy\n", pings,
           cli_plural(pings), rays, scene.triangles, 1e-6 * (double)scene.bvh_bytes);
    char size[CLI_SIZE_TEXT];
    printf("files: %s\n", cli_size(mission, pings, ".", size));
    char scan[CLI_SCAN_SIZE];
    cli_scan_words(mission, scan);
    if (*scan) {
        printf("scan: %s\n", scan);
    }
    if (f->known) {
        printf("measured here: %.0f ms to plan, first ping after %.0f ms, then %.2f ms each and "
               "%.2f ms to write it, and %.1f ms to learn, %zu time%s: about %.1f s in all\n",
               1e3 * f->plan_s, 1e3 * f->first_s, 1e3 * f->ping_s, 1e3 * f->write_s,
               1e3 * f->learn_s, f->lessons, cli_plural(f->lessons), mission_seconds(f, mission));
    }
    if (f->known && !asdic_mission_sampling((asdic_mission *)mission)->coherent) {
        char heard[64] = "no bin is above the noise";
        if (!isnan(f->errors.rms_db)) {
            snprintf(heard, sizeof heard, "%.2f dB r.m.s. in bins above the noise",
                     f->errors.rms_db);
        }
        printf(
            "stated standard error of the first ping: %s; of all, median %.3f dB, worst %.2f dB\n",
            heard, f->errors.median_db, f->errors.worst_db);
    }
}

static void print_json(const asdic_mission *mission, const asdic_plan *plan,
                       const asdic_refraction_plan *refraction, const forecast *f) {
    uint32_t rays = asdic_mission_sampling((asdic_mission *)mission)->rays;
    asdic_scene_info scene = asdic_scene_get_info(asdic_mission_scene(mission));
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_open(&j, "terms", '[');
    for (int t = 0; t < ASDIC_TERM_COUNT; t++) {
        json_open(&j, NULL, '{');
        json_text(&j, "name", plan->rows[t].name);
        json_bool(&j, "kept", plan->rows[t].kept);
        json_number(&j, "bound_db", plan->rows[t].bound_db);
        json_text(&j, "reason", plan->rows[t].reason);
        json_close(&j);
    }
    json_close(&j);
    char phase[160];
    json_open(&j, "phase", '{');
    json_bool(&j, "needed", asdic_mission_needs_phase(mission, phase, sizeof phase));
    json_bool(&j, "coherent", asdic_mission_sampling((asdic_mission *)mission)->coherent);
    json_text(&j, "reason", phase);
    json_close(&j);
    json_open(&j, "refraction", '{');
    json_text(&j, "needed", asdic_refraction_name(refraction->needed));
    json_number(&j, "off_db", refraction->off_db);
    json_number(&j, "layer_db", refraction->layer_db);
    json_text(&j, "reason", refraction->reason);
    json_close(&j);
    cli_json_remarks(&j, mission);
    cli_json_size(&j, mission);
    json_integer(&j, "pings", asdic_mission_ping_count(mission));
    json_integer(&j, "rays", rays);
    cli_json_scan(&j, mission);
    json_integer(&j, "triangles", scene.triangles);
    json_integer(&j, "bvh_bytes", scene.bvh_bytes);
    if (f->known) {
        json_open(&j, "forecast", '{');
        json_number(&j, "plan_ms", 1e3 * f->plan_s);
        json_number(&j, "first_ping_ms", 1e3 * f->first_s);
        json_number(&j, "ping_ms", 1e3 * f->ping_s);
        json_number(&j, "write_ms", 1e3 * f->write_s);
        json_number(&j, "learn_ms", 1e3 * f->learn_s);
        json_integer(&j, "lessons", f->lessons);
        json_number(&j, "mission_s", mission_seconds(f, mission));
        json_number(&j, "stderr_rms_db", f->errors.rms_db);
        json_number(&j, "stderr_median_db", f->errors.median_db);
        json_number(&j, "stderr_worst_db", f->errors.worst_db);
        json_close(&j);
    }
    json_close(&j);
}

static asdic_status show(cli *c, asdic_mission *mission) {
    asdic_device **devices = NULL;
    size_t count = 0;
    asdic_plan plan;
    asdic_refraction_plan refraction;
    forecast f = {.asked = !asdic_mission_plans_refraction(mission)};
    double start = cli_clock_s();
    TRY(asdic_mission_refraction(cli_context(c), mission, &refraction));
    if (!f.asked) { /* terms and rays as the run has them */
        asdic_mission_refract(mission, refraction.needed);
    }
    TRY(asdic_mission_plan(cli_context(c), mission, &plan));
    f.plan_s = cli_clock_s() - start;
    if (cli_text(c, "picture")) {
        TRY(asdic_mission_draw_rays(cli_context(c), mission, 0, cli_text(c, "picture")));
    }
    if (!cli_given(c, "no-forecast")) {
        TRY(cli_open_devices(c, &devices, &count));
        asdic_mission_sampling(mission)->left_out = plan.left_out;
        cli_progress progress = cli_progress_begin(c);
        asdic_status status = measure(c, mission, devices[0], &progress, &f);
        cli_progress_end(&progress);
        asdic_devices_close(&devices, count);
        TRY(status);
    }
    if (!cli_given(c, "json")) {
        cli_remark(c, cli_operand(c, 0), mission, false);
        cli_remark_csv(c, cli_operand(c, 0), mission);
    }
    (cli_given(c, "json") ? print_json : print_text)(mission, &plan, &refraction, &f);
    return ASDIC_OK;
}

static int run(cli *c) {
    asdic_mission *mission = NULL;
    if (!cli_picture_is_apart(c, NULL)) {
        return CLI_USAGE;
    }
    asdic_status status = asdic_mission_load(cli_context(c), cli_operand(c, 0), &mission);
    if (!status && !cli_refract(c, mission)) {
        asdic_mission_destroy(&mission);
        return CLI_USAGE;
    }
    if (!status && !cli_may_write(c, cli_text(c, "picture"))) {
        asdic_mission_destroy(&mission);
        return CLI_FAILED;
    }
    status = status ? status : show(c, mission);
    asdic_mission_destroy(&mission);
    return cli_end(c, status);
}

static const cli_option options[] = {
    {"no-forecast", 0, NULL, "leave out the measured forecast; needs no device"},
    {"refraction", 0, "WORD", "full, layer or off, else as the scene says"},
    {"picture", 0, "FILE", "draw rays of the first ping over depth and range: .png, .pdf or .svg"},
    {"force", 'f', NULL, "overwrite that file"},
    {NULL, 0, NULL, NULL},
};

const cli_command cli_plan_command = {
    .name = "plan",
    .operands = "SCENE.yaml",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "say what a scene needs: terms kept or left out, time, error",
    .details = "Every term of the model is kept or left out, with the reason and a proven bound in "
               "dB on what leaving it out changes in any bin; 'asdic run' follows the plan. Of "
               "water whose sound speed changes with depth it says whether straight rays or one "
               "fitted layer would do, and by how much they change what is expected. The "
               "forecast of time and error is measured on the mission's first ping.",
    .examples = "asdic plan scene.yaml\n"
                "asdic plan scene.yaml --no-forecast --json",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_HAS_JSON | CLI_STOPS_SOON,
    .run = run,
};
