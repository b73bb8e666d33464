#include "commands.h"
#include "json.h"
#include "progress.h"
#include "roc_print.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct request {
    asdic_detect_options options;
    asdic_detector detector;
} request;

static const char *const cfars[] = {"ca", "os", NULL};
static const char *const backgrounds[] = {"auto", "flat", "simulated", "cfar", NULL};

/* What was typed in the place of the scene's. A threshold replaces the scene's, of whichever kind that is. */
static void read_detector(cli *c, asdic_detector *d) {
    int target = (int)d->target;
    cli_choice(c, "target", cli_target_names, &target);
    cli_number(c, "pfa", ASDIC_DETECTOR_MIN_PFA, ASDIC_DETECTOR_MAX_PFA, &d->pfa);
    cli_number(c, "prior", ASDIC_DETECTOR_MIN_PRIOR, ASDIC_DETECTOR_MAX_PRIOR, &d->prior);
    cli_number(c, "snr", ASDIC_DETECTOR_MIN_SNR_DB, ASDIC_DETECTOR_MAX_SNR_DB, &d->snr_db);
    d->cost_ratio = cli_given(c, "pfa") ? (double)NAN : d->cost_ratio;
    cli_number(c, "cost", ASDIC_DETECTOR_MIN_COST, ASDIC_DETECTOR_MAX_COST, &d->cost_ratio);
    d->target = (asdic_target)target;
}

static bool read_request(cli *c, request *r) {
    int cfar = 0, background = 0;
    *r = (request){.options = asdic_detect_options_default(), .detector = {0}};
    uint64_t cells = r->options.cfar.cells, guard = r->options.cfar.guard;
    read_detector(c, &r->detector);
    cli_choice(c, "cfar", cfars, &cfar);
    cli_choice(c, "background", backgrounds, &background);
    cli_integer(c, "cfar-cells", 1, 256, &cells);
    cli_integer(c, "cfar-guard", 0, 256, &guard);
    cli_number(c, "truth", ASDIC_DETECTOR_MIN_SNR_DB, ASDIC_DETECTOR_MAX_SNR_DB,
               &r->options.truth_snr_db);
    cli_number(c, "cell", ASDIC_DETECT_MIN_CELL_M, ASDIC_DETECT_MAX_CELL_M, &r->options.cell_m);
    cli_number(c, "speed", 0.001, 100.0, &r->options.tracker.speed_mps);
    if (cli_given(c, "cost") && cli_given(c, "pfa")) {
        cli_usage(c, "--cost and --pfa are two thresholds; give one of them");
        return false;
    }
    r->options.has_cfar = cli_given(c, "cfar");
    r->options.cfar.kind = (asdic_cfar_kind)cfar;
    r->options.cfar.cells = (unsigned)cells;
    r->options.cfar.guard = (unsigned)guard;
    r->options.force = cli_given(c, "force");
    r->options.background = (asdic_background_source)background;
    r->options.device = cli_device(c);
    if (r->options.has_cfar && background != 0 && background != ASDIC_BACKGROUND_CFAR) {
        cli_usage(c, "--cfar is a background of its own; leave --background %s out",
                  backgrounds[background]);
        return false;
    }
    r->options.has_cfar = r->options.has_cfar || background == ASDIC_BACKGROUND_CFAR;
    if (!r->options.has_cfar && (cli_given(c, "cfar-cells") || cli_given(c, "cfar-guard"))) {
        cli_usage(c, "--cfar-cells and --cfar-guard go with --cfar");
        return false;
    }
    return !cli_bad_usage(c);
}

/* The scene's detector, with what was typed. */
static asdic_status choose_detector(cli *c, const char *folder, request *r) {
    asdic_run *run = NULL;
    TRY(asdic_run_open(cli_context(c), folder, &run));
    r->detector = *asdic_run_get_info(run).detector;
    read_detector(c, &r->detector);
    r->options.detector = &r->detector;
    asdic_run_close(&run);
    return ASDIC_OK;
}

/* What the rows are that name no object; only of those that are there. */
static void explain_classes(const asdic_detect_report *r) {
    static const char *const words[] = {
        [ASDIC_TRUTH_GHOST] = "ghost: what stands out came by way of a mirror; nothing is there",
        [ASDIC_TRUTH_FAINT] =
            "faint: an echo is in the bin, but does not stand out of what else is",
        [ASDIC_TRUTH_NONE] = "none: no echo to speak of; every detection is a false alarm; "
                             "there are fewer in shadows"};
    for (size_t i = 0; i < r->class_count; i++) {
        asdic_truth truth = r->classes[i].truth;
        if (r->classes[i].bins > 0 && truth != ASDIC_TRUTH_OBJECT) {
            printf("  %s\n", words[truth]);
        }
    }
}

static void print_classes(const asdic_detect_report *r) {
    printf("%-24s %12s %12s %12s %10s\n", "truth", "bins", "detected", "predicted", "rate");
    for (size_t i = 0; i < r->class_count; i++) {
        const asdic_detect_class *k = &r->classes[i];
        if (k->bins == 0 && k->truth != ASDIC_TRUTH_NONE) {
            continue;
        }
        printf("%-24s %12llu %12llu ", k->name, (unsigned long long)k->bins,
               (unsigned long long)k->detected);
        if (isnan(k->expected)) {
            printf("%12s ", "");
        } else {
            printf("%12.1f ", k->expected);
        }
        printf("%10.3g\n", k->bins ? (double)k->detected / (double)k->bins : 0.0);
    }
    explain_classes(r);
    const asdic_detect_class *none = &r->classes[r->class_count - 1];
    if (r->is_sample && none->bins > 0) {
        printf("P_FA: ");
        if (!isnan(r->design_pfa)) {
            printf("design %.4g, ", r->design_pfa);
        }
        printf("measured %.4g, 99 %% bounds %.4g..%.4g\n", r->pfa.value, r->pfa.low, r->pfa.high);
    }
}

/* At most so many beams of an object are listed; of more, only the one in which it stands out
 * most. */
#define MOST_BEAMS 8

static void print_sight(const asdic_detect_sight *s, const char *beam) {
    printf("%-20s %-20s %5zu/%-5zu %6.4g m %6.1f dB %8.4f %7s", s->object, beam, s->pings_detected,
           s->pings_seen, s->range_m, s->snr_db, s->pd, s->detected ? "yes" : "no");
    if (!isnan(s->model_pd.low)) { /* over the error of the scattering laws */
        printf("   P_D %.4f..%.4f by laws", s->model_pd.low, s->model_pd.high);
    }
    printf("\n");
}

static void print_sights(const asdic_detect_report *r) {
    if (r->sight_count == 0) {
        return;
    }
    printf("\n%-20s %-20s %11s %8s %9s %8s %7s\n", "object", "beam", "pings", "best at", "snr",
           "P_D", "found");
    for (size_t i = 0, end; i < r->sight_count; i = end) {
        const asdic_detect_sight *best = &r->sights[i];
        for (end = i; end < r->sight_count && strcmp(r->sights[end].object, best->object) == 0;) {
            const asdic_detect_sight *next = &r->sights[end++];
            bool is_better =
                next->pd > best->pd || (next->pd == best->pd && next->snr_db > best->snr_db);
            best = is_better ? next : best;
        }
        if (end - i > MOST_BEAMS) {
            char beam[ASDIC_NAME_SIZE + 32];
            snprintf(beam, sizeof beam, "%s, best of %zu", best->beam, end - i);
            print_sight(best, beam);
            continue;
        }
        for (size_t k = i; k < end; k++) {
            print_sight(&r->sights[k], r->sights[k].beam);
        }
    }
}

static void print_report(const asdic_detect_report *r) {
    print_classes(r);
    print_sights(r);
    printf("\ntracks: %zu begun, %zu confirmed, %zu of these on objects", r->tracks,
           r->tracks_confirmed, r->tracks_of_objects);
    if (r->is_sample && !isnan(r->tracks_by_chance)) {
        printf("; of false alarms alone %.2g are to be expected", r->tracks_by_chance);
    }
    printf("\n");
}

static void print_json(const asdic_detect_report *r) {
    json j = json_begin(stdout);
    json_open(&j, NULL, '{');
    json_text(&j, "target", cli_target_names[r->detector.target]);
    json_number(&j, "pfa", r->detector.pfa);
    json_number(&j, "prior", r->detector.prior);
    json_number(&j, "snr_db", r->detector.snr_db);
    json_number(&j, "cost_ratio", r->detector.cost_ratio);
    json_bool(&j, "cfar", r->by_cfar);
    json_text(&j, "background", backgrounds[r->background]);
    json_number(&j, "background_error_db", r->background_error_db);
    json_number(&j, "background_s", r->background_s);
    json_bool(&j, "speckle", r->is_sample);
    json_number(&j, "sampling_error_db", r->sampling_error_db);
    json_number(&j, "sampling_lift_db", r->sampling_lift_db);
    json_integer(&j, "looks", r->looks);
    json_integer(&j, "pings", r->pings);
    json_integer(&j, "bins", r->bins);
    json_integer(&j, "detections", r->detections);
    json_number(&j, "pfa_design", r->design_pfa);
    json_estimate(&j, "pfa_measured", r->pfa);
    json_open(&j, "confusion", '[');
    for (size_t i = 0; i < r->class_count; i++) {
        json_open(&j, NULL, '{');
        json_text(&j, "truth", r->classes[i].name);
        json_integer(&j, "bins", r->classes[i].bins);
        json_integer(&j, "detected", r->classes[i].detected);
        json_number(&j, "predicted", r->classes[i].expected);
        json_close(&j);
    }
    json_close(&j);
    json_open(&j, "objects", '[');
    for (size_t i = 0; i < r->sight_count; i++) {
        const asdic_detect_sight *s = &r->sights[i];
        json_open(&j, NULL, '{');
        json_text(&j, "object", s->object);
        json_text(&j, "beam", s->beam);
        json_integer(&j, "pings_seen", s->pings_seen);
        json_integer(&j, "pings_detected", s->pings_detected);
        json_integer(&j, "ping", s->ping);
        json_number(&j, "range_m", s->range_m);
        json_number(&j, "snr_db", s->snr_db);
        json_number(&j, "pd", s->pd);
        json_band(&j, "model_pd", s->model_pd);
        json_bool(&j, "detected", s->detected);
        json_close(&j);
    }
    json_close(&j);
    json_open(&j, "tracks", '{');
    json_integer(&j, "begun", r->tracks);
    json_integer(&j, "confirmed", r->tracks_confirmed);
    json_integer(&j, "on_objects", r->tracks_of_objects);
    json_number(&j, "by_chance", r->tracks_by_chance);
    json_close(&j);
    json_close(&j);
}

static void remark_on_error(cli *c, const asdic_detect_report *r) {
    char what[80] = "";
    if (!isnan(r->detector.cost_ratio)) {
        snprintf(what, sizeof what, "; a threshold by cost does not allow for it");
    } else if (r->sampling_lift_db > 0.0) {
        snprintf(what, sizeof what, "; thresholds by P_FA are %.2g dB higher for it",
                 r->sampling_lift_db);
    }
    (r->sampling_error_db > 0.5 ? cli_warning : cli_note)(
        c,
        "the levels' sampling error, %.2g dB in the median bin, passes for targets%s. More rays "
        "lessen it (asdic run --tolerance)",
        r->sampling_error_db, what);
}

static void remark_on_background(cli *c, const asdic_detect_report *r, bool asked) {
    if (r->background == ASDIC_BACKGROUND_SIMULATED && r->background_s > 0.0) {
        cli_note(c,
                 "background: the scene without its objects, simulated in %.3g s, standard error "
                 "%.2g dB in the median bin; kept as background.npy",
                 r->background_s, r->background_error_db);
    } else if (r->background == ASDIC_BACKGROUND_SIMULATED) {
        cli_note(c, "background: background.npy, standard error %.2g dB in the median bin",
                 r->background_error_db);
    } else if (r->background == ASDIC_BACKGROUND_CFAR && !asked) {
        cli_warning_always(c,
                           "no background can be simulated, the scene file is not there as it was: "
                           "it is from neighbouring bins (--cfar ca)");
    }
    if (r->by_cfar && r->pfa.low > 2.0 * r->design_pfa) {
        cli_note(
            c,
            "%.2g of the bins that hold nothing are detected where thresholds are for %.2g: "
            "levels step from bin to bin, by spreading, slopes, edges and nulls of beams, which "
            "neighbours do not tell. Such bins stay, and so do the tracks on them",
            r->pfa.value, r->design_pfa);
    }
}

static asdic_status detect(cli *c, const char *folder, request *r) {
    asdic_detect_report *report = NULL;
    TRY(choose_detector(c, folder, r));
    cli_progress progress = cli_progress_begin(c);
    r->options.progress = cli_progress_report;
    r->options.user = &progress;
    cli_progress_watch(&progress);
    asdic_status status = asdic_run_detect(cli_context(c), folder, &r->options, &report);
    cli_progress_end(&progress);
    TRY(status);
    if (!report->is_sample) {
        cli_warning(c, "the scene has 'speckle: none': levels are means, of which none is a false "
                       "alarm by chance; 'speckle: rayleigh' draws them");
    }
    if (report->sampling_error_db > 0.1) {
        remark_on_error(c, report);
    }
    remark_on_background(c, report, r->options.has_cfar);
    if (report->bins == 0) {
        cli_warning_always(c, "nothing was decided: %s",
                           report->by_cfar ? "no bin has neighbours beyond its guard (--cfar-guard)"
                                           : "nothing is expected in any bin");
    }
    if (report->is_coherent) {
        cli_note(c, "coherent pings do not say what is in a bin: objects, boundaries and water are "
                    "those of the same scene by intensities, kept as parts.npy");
    } else if (isnan(report->tracks_by_chance) &&
               !isnan(report->classes[report->class_count - 1].expected)) {
        cli_note(
            c, "tracks are not for this sonar: its head turns by more than a beam in the pings by "
               "which a track is judged, so that few objects are confirmed, and are lost again");
    }
    (cli_given(c, "json") ? print_json : print_report)(report);
    cli_note(c, "%s: detections.csv (%llu), tracks.csv, occupancy.png", folder,
             (unsigned long long)report->detections);
    asdic_detect_report_destroy(&report);
    return ASDIC_OK;
}

/* Runs a scene into FOLDER first. */
static asdic_status simulate(cli *c, const char *scene, const char *folder) {
    asdic_mission *mission = NULL;
    asdic_device **devices = NULL;
    size_t count = 0;
    asdic_run_options options = asdic_run_options_default();
    cli_progress progress = cli_progress_begin(c);
    asdic_status status = asdic_mission_load(cli_context(c), scene, &mission);
    status = status ? status : cli_open_devices(c, &devices, &count);
    if (status == ASDIC_OK) {
        options.folder = folder;
        options.force = cli_given(c, "force");
        options.progress = cli_progress_report;
        options.user = &progress;
        status = asdic_mission_run(cli_context(c), mission, devices, count, &options);
        cli_progress_end(&progress);
    }
    asdic_devices_close(&devices, count);
    asdic_mission_destroy(&mission);
    return status;
}

static int run(cli *c) {
    request r;
    struct stat st;
    const char *operand = cli_operand(c, 0);
    if (!read_request(c, &r)) {
        return CLI_USAGE;
    }
    if (stat(operand, &st) == 0 && S_ISDIR(st.st_mode)) {
        if (cli_given(c, "output")) {
            return cli_usage(c,
                             "--output goes with a scene; a run's detections stay in its folder");
        }
        return cli_end(c, detect(c, operand, &r));
    }
    char *folder = cli_output(c, "run", (cli_part){1, 1}, "");
    asdic_status status = folder ? simulate(c, operand, folder) : ASDIC_ERROR_MEMORY;
    status = status ? status : detect(c, folder, &r);
    free(folder);
    return cli_end(c, status);
}

static const cli_option options[] = {
    {"output", 'o', "DIR", "with a scene: its run folder; default: run_<name of the scene>"},
    {"target", 0, "NAME", "swerling0, swerling1, swerling2 or swerling3, instead of the scene's"},
    {"pfa", 0, "P", "probability of false alarm per bin, instead of the scene's"},
    {"prior", 0, "P", "prior probability of a target in a bin, instead of the scene's"},
    {"snr", 0, "DB", "strength of the target that likelihood ratios assume, re the background"},
    {"cost", 0, "RATIO",
     "cost of a miss over that of a false alarm: the threshold that costs least, instead of --pfa"},
    {"cfar", 0, "KIND",
     "ca or os: background from neighbouring bins, their mean or their third quartile"},
    {"background", 0, "KIND",
     "auto, flat (a plane below the vehicle), simulated (the scene without its objects; "
     "background.npy keeps it) or cfar; auto: flat, simulated over a bottom from a mesh or grid, "
     "with multipath over boundaries, and of many beams in many attitudes"},
    {"cfar-cells", 0, "N",
     "bins on either side, else 8; of bins shorter than a pulse those a pulse apart"},
    {"cfar-guard", 0, "N", "such bins left out next to the bin, else 2"},
    {"truth", 0, "DB",
     "an object is in a bin when its echo is so strong re all else there, else 0"},
    {"cell", 0, "M", "side of the map's cells, else half a bin, 0.5 m at least"},
    {"speed", 0, "MPS",
     "how fast objects go that are tracked, a standard deviation north and east, else 0.5"},
    {"force", 'f', NULL, "replace the detections, or the run, that are there"},
    {0},
};

const cli_command cli_detect_command = {
    .name = "detect",
    .operands = "DIR|SCENE.yaml",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "detect, map and track what is in a run's pings",
    .details =
        "A bin is detected when its intensity exceeds the threshold for the false-alarm "
        "probability. The threshold stands over the level expected without objects: over a bottom "
        "from a mesh or grid, and with multipath over boundaries, that of a simulation, which "
        "takes up to four times as long as the run "
        "and is kept in its folder; with --cfar over the neighbouring bins. Writes into the run "
        "folder "
        "detections.csv (log-likelihood ratio, posterior probability, position on the "
        "beam's axis, and the object there), occupancy.png (log-odds of all pings in a map "
        "fixed in the world) and tracks.csv (nearest-neighbour Kalman tracks); where the scene has "
        "output: {mcap: true}, detections.mcap too, as messages of ROS 2. Prints the "
        "confusion table, and the number of tracks that false alarms alone should confirm; where "
        "the sources of the scattering laws say how far they err, an object's P_D over that "
        "error.\n\n"
        "A scene file is simulated first, as by 'asdic run'.",
    .examples = "asdic run scene.yaml -o out && asdic detect out\n"
                "asdic detect scene.yaml --cfar os --pfa 1e-4 --cell 1",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_HAS_JSON | CLI_INTERRUPTIBLE,
    .run = run,
};
