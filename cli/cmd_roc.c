#include "commands.h"
#include "progress.h"
#include "roc_print.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct request {
    asdic_roc_options options;
    char *vary;            /* KEY=a,b,c, cut into pieces; NULL: none */
    const char *key;       /* of it */
    roc_variants variants; /* values are the names */
    char *labels[ROC_MOST_VARIANTS];
    char facts[ROC_MOST_VARIANTS][ASDIC_SUBTITLE_SIZE]; /* of each variant's picture */
} request;

/* What was typed in the place of the scene's. */
static void read_detector(cli *c, asdic_roc_options *o) {
    int target = (int)o->target;
    cli_choice(c, "target", cli_target_names, &target);
    cli_number(c, "pfa", ASDIC_DETECTOR_MIN_PFA, ASDIC_DETECTOR_MAX_PFA, &o->pfa);
    o->target = (asdic_target)target;
}

static bool read_request(cli *c, request *r) {
    uint64_t ping = 0;
    *r = (request){.options = asdic_roc_options_default()};
    r->options.target_strength_db = 0.0;
    cli_number(c, "range", 0.01, 1e5, &r->options.range_m);
    double bearing_deg = 0.0;
    cli_number(c, "bearing", -180.0, 180.0, &bearing_deg);
    r->options.bearing_rad = bearing_deg * CLI_PI / 180.0;
    cli_number(c, "strength", -200.0, 100.0, &r->options.target_strength_db);
    read_detector(c, &r->options);
    cli_integer(c, "trials", 1000, 100000000, &r->options.trials);
    cli_integer(c, "seed", 0, UINT64_MAX, &r->options.seed);
    cli_integer(c, "ping", 0, SIZE_MAX - 1, &ping);
    r->options.object = cli_text(c, "object");
    r->options.beam = cli_text(c, "beam");
    r->options.ping = (size_t)ping;
    if (r->options.object && cli_given(c, "range")) {
        cli_usage(c, "--object and --range are two targets; give one of them");
        return false;
    }
    if (!cli_given(c, "range") && (cli_given(c, "strength") || cli_given(c, "bearing"))) {
        cli_usage(c, "--strength and --bearing are those of a target at --range");
        return false;
    }
    if (cli_bad_usage(c) ||
        !cli_vary(c, ROC_MOST_VARIANTS, &r->vary, r->variants.names, &r->variants.count)) {
        return false;
    }
    r->key = r->vary;
    if (r->vary && strcmp(cli_operand(c, 0), "-") == 0) {
        cli_usage(c, "the scene is read for every design of --vary; it must be a file");
        return false;
    }
    return true;
}

/* Takes what was not typed from the scene; without a target, its first object. */
static asdic_status complete(cli *c, const asdic_mission *mission, request *r) {
    const asdic_detector *detector = asdic_mission_detector(mission);
    r->options.target = detector->target;
    r->options.pfa = detector->pfa;
    read_detector(c, &r->options);
    for (size_t i = 0;
         !r->options.object && !cli_given(c, "range") && i < asdic_mission_object_count(mission);
         i++) {
        const asdic_mission_object *o = asdic_mission_get_object(mission, i);
        if (o->name[0]) {
            r->options.object = o->name;
        }
    }
    if (!r->options.object && !cli_given(c, "range")) {
        cli_usage(c, "the scene has no object; give --range, and the --strength of a target there");
        return ASDIC_ERROR_ARGUMENT;
    }
    return ASDIC_OK;
}

/* A design that hears nothing may still be compared. */
static void warn_of_chance(cli *c, const request *r, const asdic_roc *roc, size_t index) {
    if (roc->remark[0] && r->key) {
        cli_warning(c, "%s=%s: %s", r->key, r->variants.names[index], roc->remark);
    } else if (roc->remark[0]) {
        cli_warning(c, "%s", roc->remark);
    }
}

static asdic_status compute_on(cli *c, request *r, asdic_mission *mission, asdic_device *device,
                               size_t index) {
    asdic_context *ctx = cli_context(c);
    roc_variants *v = &r->variants;
    request own = *r;
    TRY(complete(c, mission, &own));
    TRY(asdic_roc_compute(ctx, mission, device, &own.options, &v->rocs[index]));
    warn_of_chance(c, r, v->rocs[index], index);
    const asdic_sonar *sonar = asdic_mission_sonar(mission);
    asdic_picture_subtitle(sonar, sonar->bin_length_m, r->facts[index]);
    /* "pitch_deg = 10" of "sonar.receivers[0].pitch_deg" */
    const char *dot = r->key ? strrchr(r->key, '.') : NULL, *key = dot ? dot + 1 : r->key;
    if (asprintf(&r->labels[index], "%s%s%s", key ? key : "",
                 r->key               ? " = "
                 : own.options.object ? own.options.object
                                      : "target",
                 r->key ? v->names[index] : "") < 0) {
        r->labels[index] = NULL;
        return ASDIC_ERROR_MEMORY;
    }
    if (!r->key) {
        v->names[0] = r->labels[0];
    }
    return index > 0 ? asdic_roc_compare(ctx, v->rocs[0], v->rocs[index], &v->differences[index])
                     : ASDIC_OK;
}

static asdic_status compute(cli *c, request *r, asdic_device *device, size_t index) {
    asdic_mission *mission = NULL;
    asdic_setting setting = {r->key, r->variants.names[index]};
    TRY(asdic_mission_load_with(cli_context(c), cli_operand(c, 0), &setting, r->key ? 1 : 0,
                                &mission));
    asdic_status status = compute_on(c, r, mission, device, index);
    asdic_mission_destroy(&mission);
    return status;
}

/* FOLDER/NAME, which must not exist yet. */
static bool out_path(cli *c, const char *folder, const char *name, char **path) {
    if (asprintf(path, "%s/%s", folder, name) < 0) {
        *path = NULL;
        cli_error(c, "out of memory");
        return false;
    }
    if (!cli_given(c, "force") && access(*path, F_OK) == 0) {
        cli_error(c, "'%s' exists; --force replaces it", *path);
        return false;
    }
    return cli_may_write(c, *path);
}

/* The scene and what is detected where; below, what all levels hang on, of the first variant where
 * that varies. */
static asdic_status draw(cli *c, const request *r, const char *path, const char *const *names) {
    const roc_variants *v = &r->variants;
    const asdic_roc *first = v->rocs[0];
    char title[512 + ASDIC_SUBTITLE_SIZE];
    char *scene = asdic_scene_name(cli_operand(c, 0));
    bool is_one = true;
    for (size_t i = 1; i < v->count; i++) {
        is_one = is_one && strcmp(r->facts[i], r->facts[0]) == 0;
    }
    snprintf(title, sizeof title, "%s: %s%s at %.4g m, beam \u2018%s\u2019, %u look%s\n%s%s",
             scene ? scene : "", r->key ? r->key : names[0], r->key ? ", the first" : "",
             first->range_m, first->beam, first->background.looks,
             cli_plural(first->background.looks), is_one ? "" : "the first: ", r->facts[0]);
    free(scene);
    return asdic_roc_draw(cli_context(c), path, title, names, v->rocs, v->count);
}

static asdic_status write_files(cli *c, request *r, char *const paths[3]) {
    const char *names[ROC_MOST_VARIANTS];
    roc_variants *v = &r->variants;
    for (size_t i = 0; i < v->count; i++) {
        names[i] = r->labels[i];
    }
    TRY(asdic_roc_write_csv(cli_context(c), paths[0], paths[1], names, v->rocs, v->count));
    return asdic_picture_annotated() ? draw(c, r, paths[2], names) : ASDIC_OK;
}

static asdic_status compute_all(cli *c, request *r) {
    asdic_device **devices = NULL;
    size_t count = 0;
    TRY(cli_open_devices(c, &devices, &count));
    asdic_status status = ASDIC_OK;
    cli_progress progress = cli_progress_begin(c);
    cli_progress_watch(&progress);
    for (size_t i = 0; i < r->variants.count && !status; i++) {
        status = compute(c, r, devices[0], i);
    }
    cli_progress_end(&progress);
    asdic_devices_close(&devices, count);
    return status;
}

static asdic_status tell(cli *c, request *r, const char *folder, char *const paths[3]) {
    TRY(write_files(c, r, paths));
    (cli_given(c, "json") ? roc_print_json : roc_print_table)(&r->variants);
    cli_note(c, "%s: roc.csv, roc_range.csv%s", folder,
             asdic_picture_annotated() ? ", roc.png" : "");
    return ASDIC_OK;
}

/* Whether the folder can be made is told before the work, and it is made after it: a signal leaves
 * none behind. */
static int judge(cli *c, request *r, const char *folder) {
    static const char *const files[3] = {"roc.csv", "roc_range.csv", "roc.png"};
    char *paths[3] = {NULL, NULL, NULL};
    int code = CLI_FAILED;
    bool is_new, is_good = cli_make_folder(c, folder, &is_new);
    for (int i = 0; i < 3 && is_good; i++) {
        is_good = out_path(c, folder, files[i], &paths[i]);
    }
    if (is_new) {
        rmdir(folder);
    }
    if (is_good) {
        asdic_status status = compute_all(c, r);
        if (cli_bad_usage(c)) {
            code = CLI_USAGE;
        } else if (status != ASDIC_OK || cli_make_folder(c, folder, &is_new)) {
            code = cli_end(c, status == ASDIC_OK ? tell(c, r, folder, paths) : status);
        }
        if (code != CLI_OK && is_new) {
            rmdir(folder);
        }
    }
    for (int i = 0; i < 3; i++) {
        free(paths[i]);
    }
    return code;
}

static int run(cli *c) {
    request r;
    int code = CLI_USAGE;
    if (read_request(c, &r)) {
        char *folder = cli_output(c, "roc", (cli_part){1, 1}, "");
        code = folder ? judge(c, &r, folder) : CLI_FAILED;
        free(folder);
    }
    for (size_t i = 0; i < ROC_MOST_VARIANTS; i++) {
        asdic_roc_destroy(&r.variants.rocs[i]);
        free(r.labels[i]);
    }
    free(r.vary);
    return code;
}

static const cli_option options[] = {
    {"output", 'o', "DIR",
     "where roc.csv, roc_range.csv and roc.png go; default: roc_<name of the "
     "scene>"},
    {"object", 0, "NAME", "detect this object, where it stands out most; default: the first"},
    {"range", 0, "M", "detect a point at this range instead, level with the vehicle"},
    {"bearing", 0, "DEG", "its bearing, to starboard of the bow, else 0"},
    {"strength", 0, "DB", "its target strength, dB re 1 m^2, else 0"},
    {"beam", 0, "NAME", "in this beam; default: that in which the target stands out most"},
    {"ping", 0, "N", "from where the vehicle is at this ping, else 0"},
    {"target", 0, "NAME",
     "swerling0, swerling1, swerling2 or swerling3: how the echo fluctuates; default: the scene's"},
    {"pfa", 0, "P", "P_FA at which P_D is compared; default: the scene's"},
    {"trials", 0, "N", "draws with and draws without the target, else 1000000"},
    {"seed", 0, "N", "of the draws, else 1; variants share them"},
    {"vary", 0, "KEY=A,B,..",
     "a curve for each value of this key of the scene, as sonar.receivers[0].pitch_deg=0,10,20"},
    {"force", 'f', NULL, "replace files that are there"},
    {0},
};

const cli_command cli_roc_command = {
    .name = "roc",
    .operands = "SCENE.yaml",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "probability of detection against that of false alarm",
    .details = "Simulates one ping for the mean intensities, then draws speckle, noise and the "
               "target's fluctuation round them, and counts. The closed form is printed beside. "
               "The background is the level expected without objects; over a bottom that is not a "
               "plane, the rest of the ping. A scene without speckle gets Rayleigh speckle.\n\n"
               "With --vary designs are compared: all use the same random numbers, so that the "
               "difference of their areas has much narrower bounds than the areas.\n\n"
               "Where the source of a scattering law says how far it errs (model_uncertainty_db in "
               "run.json), P_D is told over that error, too: background louder and target weaker, "
               "and the other way round, at the same P_FA. Designs are compared under the same "
               "error.",
    .examples = "asdic roc scene.yaml --object rise\n"
                "asdic roc scene.yaml --range 60 --vary sonar.receivers[0].pitch_deg=0,10,20",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_HAS_JSON | CLI_STOPS_SOON,
    .run = run,
};
