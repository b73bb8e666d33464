#include "commands.h"
#include "progress.h"
#include "remarks.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const cli_option options[] = {
    {"output", 'o', "FILE.csv", "where the levels go, else expected_SCENE.csv; '-' is stdout"},
    {"variant", 0, "WORD", "corrected or printed, else as the scene says"},
    {"refraction", 0, "WORD", "full, layer or off, else as the scene says"},
    {"ping", 0, "N", "the pose of this ping, else 0"},
    {"picture", 0, "FILE",
     "draw the levels too (of more than 8 beams the middle one): .png, .pdf or .svg"},
    {"force", 'f', NULL, "overwrite what exists"},
    {NULL, 0, NULL, NULL},
};

/* One ping of a mission without objects. */
typedef struct expect_scene {
    asdic_environment env;
    asdic_sonar sonar;
    asdic_flat_scene flat;
    asdic_pose pose;
    size_t bins;
    const char *file;
} expect_scene;

/* Levels of one component of one beam as the pictures take them. */
static void to_db(const asdic_ping *ping, asdic_component component, size_t beam, float *out) {
    for (size_t n = 0; n < ping->bins; n++) {
        out[n] = (float)asdic_level_db(ping->intensity_lin[component][beam * ping->bins + n]);
    }
}

/* The mechanisms lie below the total. */
#define BELOW_DB 10.0

static asdic_status draw(cli *c, const char *path, const char *name, const asdic_sonar *sonar,
                         const asdic_ping *ping) {
    enum { MOST_BEAMS = 8, CURVES = 5 };
    static const asdic_component shown[CURVES] = {ASDIC_TOTAL, ASDIC_BOTTOM, ASDIC_SURFACE,
                                                  ASDIC_VOLUME, ASDIC_NOISE};
    asdic_ascope panels[MOST_BEAMS] = {{0}};
    char titles[MOST_BEAMS][ASDIC_NAME_SIZE + 16];
    /* Of more beams than have panels the middle one. */
    bool is_middle = ping->beams > MOST_BEAMS;
    size_t beams = is_middle ? 1 : ping->beams, first_beam = is_middle ? (ping->beams - 1) / 2 : 0;
    asdic_picture_options look = asdic_picture_options_default();
    float *levels = malloc(beams * CURVES * ping->bins * sizeof *levels);
    double top = -INFINITY, bottom = INFINITY;
    char heading[512], facts[ASDIC_SUBTITLE_SIZE], low[16], high[16];
    const char *const texts[] = {"Title", heading, "db_low", low, "db_high", high, NULL};
    asdic_picture_subtitle(sonar, ping->bin_length_m, facts);
    if (!levels) {
        return ASDIC_ERROR_MEMORY;
    }
    for (size_t b = 0; b < beams; b++) {
        float *first = levels + b * CURVES * ping->bins;
        for (int k = 0; k < CURVES; k++) {
            to_db(ping, shown[k], first_beam + b, first + (size_t)k * ping->bins);
        }
        snprintf(titles[b], sizeof titles[b], "beam \u2018%s\u2019",
                 sonar->receivers[first_beam + b].name);
        panels[b] =
            (asdic_ascope){.title = titles[b],
                           .bins = ping->bins,
                           .bin_length_m = ping->bin_length_m,
                           .total_db = first,
                           .bottom_db = first + ping->bins,
                           .surface_db = first + 2 * ping->bins,
                           .volume_db = first + 3 * ping->bins,
                           .noise_db = sonar->noise_enabled ? first + 4 * ping->bins : NULL};
        for (size_t n = 0; n < ping->bins; n++) {
            top = first[n] > top ? first[n] : top;
            bottom = isfinite(first[n]) && first[n] < bottom ? first[n] : bottom;
        }
    }
    look.db_high = isfinite(top) ? 10.0 * ceil(0.1 * top) : 0.0;
    look.db_low = isfinite(bottom) ? 10.0 * floor(0.1 * bottom) - BELOW_DB : -80.0;
    snprintf(heading, sizeof heading, "%s: expected levels without objects\n%s", name, facts);
    look.note = is_middle ? "the middle beam; the table has all" : NULL;
    look.title = heading;
    look.texts = texts;
    snprintf(low, sizeof low, "%.0f", look.db_low);
    snprintf(high, sizeof high, "%.0f", look.db_high);
    asdic_status status = asdic_picture_ascope(cli_context(c), path, panels, beams, &look);
    free(levels);
    return status;
}

static asdic_status compute(cli *c, const char *path, const expect_scene *scene, asdic_ping *ping) {
    asdic_context *ctx = cli_context(c);
    const char *picture = cli_text(c, "picture");
    cli_progress progress = cli_progress_begin(c);
    cli_progress_watch(&progress);
    asdic_status computed =
        asdic_expected_compute(ctx, &scene->flat, &scene->env, &scene->sonar, &scene->pose, ping);
    cli_progress_end(&progress);
    TRY(computed);
    TRY(asdic_expected_write_csv(ctx, path, &scene->sonar, ping));
    if (picture) {
        char *name = asdic_scene_name(scene->file);
        asdic_status status = draw(c, picture, name ? name : "", &scene->sonar, ping);
        free(name);
        TRY(status);
    }
    if (!cli_is_stdout(path)) {
        cli_note(c, "%s: %zu beam%s, %zu bins", path, ping->beams, cli_plural(ping->beams),
                 ping->bins);
    }
    return ASDIC_OK;
}

/* How far the levels may lie from those at sea, as far as the sources of the laws say. */
static void note_uncertainty(cli *c, const asdic_uncertainty *uncertainty) {
    static const struct {
        const char *name;
        asdic_component component;
    } parts[] = {{"bottom", ASDIC_BOTTOM}, {"surface", ASDIC_SURFACE}};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
        double db = uncertainty->db[parts[i].component];
        if (!isnan(db)) {
            cli_note(c, "model_uncertainty_db: %s %g", parts[i].name, db);
        }
    }
}

static int write_levels(cli *c, const expect_scene *scene) {
    asdic_ping *ping = NULL;
    char *path = cli_output(c, "expected", (cli_part){1, 1}, ".csv");
    const char *picture = cli_text(c, "picture");
    int code = CLI_FAILED;
    if (!path) {
        code = cli_end(c, ASDIC_ERROR_MEMORY);
    } else if (!cli_picture_is_apart(c, path)) {
        code = CLI_USAGE;
    } else if (cli_may_write(c, path) && cli_may_write(c, picture)) {
        asdic_status status =
            asdic_ping_create(cli_context(c), scene->sonar.receiver_count, scene->bins, &ping);
        code = cli_end(c, status ? status : compute(c, path, scene, ping));
    }
    asdic_ping_destroy(&ping);
    free(path);
    return code;
}

static int run_on(cli *c, asdic_mission *mission, uint64_t index) {
    static const char *const variants[] = {"corrected", "printed", NULL};
    expect_scene scene = {.env = *asdic_mission_environment(mission),
                          .sonar = *asdic_mission_sonar(mission)};
    int variant = (int)scene.env.variant;
    cli_choice(c, "variant", variants, &variant);
    if (cli_bad_usage(c)) {
        return CLI_USAGE;
    }
    size_t pings = asdic_mission_ping_count(mission);
    if (index >= pings) {
        return cli_usage(c, "--ping %llu: the mission has %zu ping%s (0..%zu)",
                         (unsigned long long)index, pings, cli_plural(pings), pings - 1);
    }
    scene.file = cli_operand(c, 0);
    scene.env.variant = (asdic_variant)variant;
    scene.flat = asdic_mission_flat_scene(mission, index);
    scene.pose = asdic_mission_pose(mission, index, NULL);
    /* The number of bins belongs to the mission's first depth, as in a run. */
    double depth_m = asdic_mission_pose(mission, 0, NULL).position_m.z;
    scene.bins =
        asdic_sonar_bin_count(&scene.sonar, asdic_environment_sound_speed_mps(&scene.env, depth_m));
    asdic_uncertainty uncertainty = asdic_mission_uncertainty(mission);
    note_uncertainty(c, &uncertainty);
    return write_levels(c, &scene);
}

static int run(cli *c) {
    asdic_mission *mission = NULL;
    uint64_t index = 0;
    cli_integer(c, "ping", 0, UINT64_MAX, &index);
    if (cli_bad_usage(c)) {
        return CLI_USAGE;
    }
    asdic_status status = asdic_mission_load(cli_context(c), cli_operand(c, 0), &mission);
    if (status == ASDIC_OK && !cli_refract(c, mission)) {
        asdic_mission_destroy(&mission);
        return CLI_USAGE;
    }
    int code = status == ASDIC_OK ? run_on(c, mission, index) : cli_end(c, status);
    asdic_mission_destroy(&mission);
    return code;
}

const cli_command cli_expect_command = {
    .name = "expect",
    .operands = "SCENE.yaml",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "expected level per beam and bin without objects, by quadrature",
    .details =
        "The null hypothesis: bottom, surface, volume and noise over a flat bottom at the depth "
        "straight below the vehicle, in double precision. Objects and speckle are left out.\n\n"
        "The printed variant takes absorption and transmission loss as the paper prints them, as "
        "simulated pings do; kernels/README.md lists the paper's slips and what each changes.\n\n"
        "Where the source of a scattering law says how far it errs, model_uncertainty_db is told, "
        "dB either way.",
    .examples = "asdic expect scene.yaml -o - | head\n"
                "asdic expect scene.yaml --picture expected.png",
    .options = options,
    .traits = CLI_STOPS_SOON,
    .run = run,
};
