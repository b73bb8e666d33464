#include "commands.h"
#include "progress.h"
#include "render_video.h"

#include <math.h>
#include <string.h>
#include <strings.h>

/* Names of pictures in a list with commas, as bits. */
static bool read_images(cli *c, unsigned *images) {
    const char *text = cli_text(c, "images"), *name;
    if (!text) {
        return true;
    }
    do {
        size_t length = strcspn(text, ",");
        int i = 0;
        while ((name = asdic_image_name((asdic_image)i)) &&
               (strlen(name) != length || strncmp(name, text, length) != 0)) {
            i++;
        }
        if (!name) {
            cli_usage(c, "no picture '%.*s'; there are waterfall, ascope, fan, overview and plan",
                      (int)length, text);
            return false;
        }
        *images |= 1u << i;
        text += length + (text[length] == ',');
    } while (*text);
    return true;
}

/* Sonar operators' gain: K log r for the spreading, 2 alpha r for the absorption both ways. */
static asdic_status set_gain(cli *c, const char *folder, double db_per_decade,
                             asdic_render_options *options) {
    asdic_run *run = NULL;
    asdic_record record;
    asdic_status status = asdic_run_open(cli_context(c), folder, &run);
    if (status == ASDIC_OK && asdic_run_get_info(run).pings > 0) {
        status = asdic_run_read(run, 0, &record);
        if (status == ASDIC_OK) {
            asdic_run_info info = asdic_run_get_info(run);
            options->tvg_db_per_decade = db_per_decade;
            options->tvg_db_per_m =
                2e-3 * asdic_environment_absorption_db_per_km(
                           info.environment, info.sonar->frequency_hz, record.pose.position_m.z);
        }
    }
    asdic_run_close(&run);
    return status;
}

/* Whether a picture that goes to PATH is no PNG. */
static bool is_vector(const char *path, asdic_picture_format format) {
    const char *ending = path + cli_stem(path);
    bool says_so = strcasecmp(ending, ".pdf") == 0 || strcasecmp(ending, ".svg") == 0;
    return format == ASDIC_PICTURE_BY_NAME ? says_so : format != ASDIC_PICTURE_PNG;
}

/* Whether the name of PATH promises another format than FORMATS[FORMAT]. */
static bool contradicts(const char *path, const char *const *formats, int format) {
    const char *ending = path ? path + cli_stem(path) : "";
    bool found = false;
    for (int i = ASDIC_PICTURE_PNG; *ending && formats[i]; i++) {
        found |= i != format && strcasecmp(ending + 1, formats[i]) == 0;
    }
    return found && format != ASDIC_PICTURE_BY_NAME;
}

/* Whether the mosaic MOSAIC goes with the other options. */
static bool check_mosaic(cli *c, const char *mosaic) {
    static const char *const others[] = {"output", "video",  "images", "beam",
                                         "ping",   "format", "raw",    NULL};
    if (!mosaic && cli_given(c, "cell")) {
        cli_usage(c, "--cell goes with --mosaic");
        return false;
    }
    for (size_t i = 0; mosaic && others[i]; i++) {
        if (cli_given(c, others[i])) {
            cli_usage(c, "--mosaic goes without --%s: it is one PNG of all beams and pings",
                      others[i]);
            return false;
        }
    }
    const char *ending = mosaic ? mosaic + cli_stem(mosaic) : "";
    if (mosaic && (cli_is_stdout(mosaic) || (*ending && strcasecmp(ending, ".png") != 0))) {
        cli_usage(c, "--mosaic '%s': a PNG file with a world file beside it, so a name in .png",
                  mosaic);
        return false;
    }
    return true;
}

/* Whether the mosaic PATH, and the world file that comes with it, may be written. */
static bool may_write_mosaic(cli *c, const char *path) {
    char world[4096];
    if (!path) {
        return true;
    }
    snprintf(world, sizeof world, "%.*s.pgw", (int)cli_stem(path), path);
    return cli_may_write(c, path) && cli_may_write(c, world);
}

static int run(cli *c) {
    static const char *const formats[] = {
        [ASDIC_PICTURE_BY_NAME] = "auto", "png", "pdf", "svg", NULL};
    asdic_render_options options = asdic_render_options_default();
    const char *folder = cli_operand(c, 0);
    int format = ASDIC_PICTURE_BY_NAME;
    double gain = 0.0;
    uint64_t ping = SIZE_MAX;
    cli_number_range(c, "db-range", -500.0, 500.0, &options.db_low, &options.db_high);
    cli_colormap(c, &options.colormap);
    cli_choice(c, "format", formats, &format);
    cli_number(c, "tvg", 0.0, 100.0, &gain);
    cli_integer(c, "ping", 0, SIZE_MAX - 1, &ping);
    if (cli_bad_usage(c) || !read_images(c, &options.images)) {
        return CLI_USAGE;
    }
    options.beam = cli_text(c, "beam");
    options.ping = ping;
    options.raw = cli_given(c, "raw");
    options.format = (asdic_picture_format)format;
    options.path = cli_text(c, "output");
    const char *video = cli_text(c, "video");
    if (video && (options.path || options.raw || cli_given(c, "ping") || cli_given(c, "format"))) {
        return cli_usage(c, "--video goes without --output, --raw, --ping and --format");
    }
    if (video && options.images && options.images != 1u << ASDIC_IMAGE_FAN &&
        options.images != 1u << ASDIC_IMAGE_ASCOPE) {
        return cli_usage(c, "--video is of '--images fan' or '--images ascope'");
    }
    if (video && strlen(video + cli_stem(video)) < 2) {
        return cli_usage(c,
                         "--video '%s': a file, by whose ending ffmpeg knows what to write, as "
                         "fan.mp4",
                         video);
    }
    if (options.format == ASDIC_PICTURE_BY_NAME && !cli_is_picture(c, "output")) {
        return CLI_USAGE;
    }
    if (contradicts(options.path, formats, format)) {
        return cli_usage(c, "--format %s writes no such file as --output '%s'", formats[format],
                         options.path);
    }
    if (options.raw && options.path && is_vector(options.path, options.format)) {
        return cli_usage(c, "--raw pictures are PNG files");
    }
    const char *mosaic = cli_text(c, "mosaic");
    double cell_m = 0.0;
    cli_number(c, "cell", 1e-3, 1e6, &cell_m);
    if (cli_bad_usage(c) || !check_mosaic(c, mosaic)) {
        return CLI_USAGE;
    }
    if (!cli_may_write(c, options.path) || !cli_may_write(c, video) ||
        !may_write_mosaic(c, mosaic)) {
        return CLI_FAILED;
    }
    asdic_status status = cli_given(c, "tvg") ? set_gain(c, folder, gain, &options) : ASDIC_OK;
    if (status != ASDIC_OK) {
        return cli_end(c, status);
    }
    cli_progress progress = cli_progress_begin(c);
    cli_progress_watch(&progress);
    if (mosaic) {
        options.path = mosaic;
        status = asdic_run_mosaic(cli_context(c), folder, cell_m, &options);
    } else if (!video) {
        status = asdic_run_render(cli_context(c), folder, &options);
    }
    int code = video ? render_video(c, folder, &options, video) : CLI_OK;
    cli_progress_end(&progress);
    return video ? code : cli_end(c, status);
}

static const cli_option options[] = {
    {"images", 0, "LIST", "of waterfall, ascope, fan, overview, plan; default: those of the scene"},
    {"db-range", 0, "LO:HI", "window of the levels; default: that of the run, to 10 dB"},
    {"colormap", 0, "NAME", "viridis, cividis, inferno, gray or copper"},
    {"tvg", 0, "K", "show levels + K log r + 2 alpha r, alpha being the scene's absorption"},
    {"beam", 0, "NAME", "waterfall, A-scope and raw picture, and the fan of a scan, of this beam"},
    {"ping", 0, "N", "A-scope and fan of this ping, instead of the first and the last"},
    {"format", 0, "FORMAT", "auto, png, pdf or svg; auto: by the name of the file, else PNG"},
    {"output", 'o', "FILE",
     "write the one picture that the other options choose there; - is the standard output"},
    {"video", 0, "FILE",
     "a video, a frame for each ping: its fan, or --images ascope; with ffmpeg"},
    {"mosaic", 0, "FILE",
     "the fans of all pings on one map: a PNG, and a world file for GIS beside it"},
    {"cell", 0, "M", "side of the mosaic's cells; default: a bin's length"},
    {"force", 'f', NULL, "overwrite that file, and a mosaic's world file"},
    {"raw", 0, NULL, "16-bit grey pictures too, a pixel per bin: raw_<beam>.png"},
    {0},
};

const cli_command cli_render_command = {
    .name = "render",
    .operands = "DIR",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "draw the pictures of a run folder again",
    .details = "Pictures of the same names are replaced. Levels are never scaled picture by "
               "picture: those of one kind share a window, which stands in their text chunks. A "
               "gain is for display only and is written on the picture.",
    .examples = "asdic render out --db-range=-120:-40 --colormap inferno\n"
                "asdic render out --images fan --ping 30 --format pdf\n"
                "asdic render out --video fan.mp4\n"
                "asdic render out --mosaic floor.png --cell 0.25\n"
                "asdic render out --images plan -o chart.svg",
    .options = options,
    .traits = CLI_STOPS_SOON,
    .run = run,
};
