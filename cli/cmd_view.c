#include "commands.h"
#include "view.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const cli_option options[] = {
    {"y4m", 0, "FILE", "write frames as a Y4M video, - for standard output; no display needed"},
    {"snapshot", 0, "N", "write N frames, evenly over the mission, as PNG; no display needed"},
    {"output", 'o', "DIR", "where recordings and snapshots go; default of these: view_NAME"},
    {"pings", 0, "N", "end after N pings, or with the mission"},
    {"keys", 0, "T:KEY,...",
     "press keys at seconds after the first ping: 2:up,4:right,9:r; without a display none that "
     "pauses"},
    {"rays", 0, "N", "rays per ping, instead of the scene's"},
    {"least-rays", 0, "N",
     "the floor of rays when the machine cannot follow; default: 80 a beam, 2000 at least"},
    {"size", 0, "WxH", "pixels of a frame; default 1280x720"},
    {"db-range", 0, "LOW:HIGH",
     "window of levels, dB; default: that of a run's pictures, of the first ping"},
    {"colormap", 0, "NAME", "viridis, cividis, inferno, gray or copper; default inferno"},
    {"force", 'f', NULL, "replace a video or snapshots that exist"},
    {NULL, 0, NULL, NULL},
};

typedef struct request {
    asdic_view_options options;
    uint64_t snapshots, pings, rays; /* 0: not given */
    const char *y4m;
} request;

static bool read_size(cli *c, asdic_view_options *o) {
    const char *text = cli_text(c, "size");
    size_t width = text ? strspn(text, "0123456789") : 0;
    char rest;
    if (text && (width == 0 || text[width] != 'x' || !isdigit((unsigned char)text[width + 1]) ||
                 sscanf(text, "%5ux%5u%c", &o->width, &o->height, &rest) != 2)) {
        cli_usage(c, "option '--size': '%s' is not WIDTHxHEIGHT", text);
        return false;
    }
    return true;
}

static bool read_request(cli *c, request *r) {
    uint64_t least = 0;
    *r = (request){.options = asdic_view_options_default(), .y4m = cli_text(c, "y4m")};
    cli_integer(c, "snapshot", 1, 10000, &r->snapshots);
    cli_integer(c, "pings", 1, 1000000000, &r->pings);
    cli_integer(c, "rays", 64, 1u << 22, &r->rays);
    cli_integer(c, "least-rays", 64, 1u << 22, &least);
    cli_number_range(c, "db-range", -400.0, 400.0, &r->options.db_low, &r->options.db_high);
    r->options.least_rays = (uint32_t)least;
    r->options.real_time = !r->y4m && !r->snapshots;
    cli_colormap(c, &r->options.colormap);
    if (r->y4m && r->snapshots) {
        cli_usage(c, "--y4m and --snapshot are two ways to do without a display; give one");
        return false;
    }
    if (!r->options.real_time && least > 0) {
        cli_usage(c, "--least-rays goes with a display; without one all rays are cast");
        return false;
    }
    return read_size(c, &r->options) && !cli_bad_usage(c);
}

static int show(view_job *job, const request *r, size_t mission_pings, const char *folder) {
    /* A mission that leads somewhere ends the view, unless keys steer. */
    bool ends = mission_pings > 1 && job->key_count == 0;
    size_t pings = r->pings && !(ends && r->pings > mission_pings) ? r->pings : mission_pings;
    job->pings = job->is_offline ? pings : r->pings ? r->pings : SIZE_MAX;
    if (r->snapshots > pings) {
        return cli_usage(job->c, "--snapshot %llu: pings in the mission: %zu%s",
                         (unsigned long long)r->snapshots, pings,
                         ends ? "" : "; --pings gives more");
    }
    if (r->y4m) {
        return view_stream(job, r->y4m);
    }
    if (r->snapshots) {
        return view_snapshots(job, r->snapshots, pings, folder, cli_given(job->c, "force"));
    }
    __typeof__(view_window) *window = cli_module(job->c, "window", "view_window");
    return window ? window(job) : CLI_FAILED;
}

/* A recording reports last, whatever ended the view. */
static int wind_up(view_job *job, int code) {
    asdic_status status = asdic_view_stop(job->view);
    return status ? cli_end(job->c, status) : code;
}

static int view_mission(cli *c, const request *r, asdic_mission *mission, asdic_device *device) {
    view_job job = {.c = c,
                    .rate_hz = asdic_mission_sonar(mission)->ping_rate_hz,
                    .is_offline = r->y4m || r->snapshots};
    asdic_view_options o = r->options;
    char *folder = cli_output(c, "view", (cli_part){1, 1}, "");
    int code = CLI_FAILED;
    o.folder = folder;
    if (cli_text(c, "keys") && !view_read_keys(&job, cli_text(c, "keys"))) {
        code = CLI_USAGE;
    } else {
        asdic_status status =
            folder ? asdic_view_create(cli_context(c), mission, device, &o, &job.view)
                   : ASDIC_ERROR_MEMORY;
        code = status ? cli_end(c, status)
                      : wind_up(&job, show(&job, r, asdic_mission_ping_count(mission), folder));
    }
    asdic_view_destroy(&job.view);
    free(job.keys);
    free(job.key_text);
    free(folder);
    return code;
}

static int run(cli *c) {
    request r;
    asdic_mission *mission = NULL;
    asdic_device **devices = NULL;
    size_t count = 0;
    if (!read_request(c, &r)) {
        return CLI_USAGE;
    }
    asdic_status status = cli_load_rays(c, r.rays, &mission);
    status = status ? status : cli_open_devices(c, &devices, &count);
    int code = status ? cli_end(c, status) : view_mission(c, &r, mission, devices[0]);
    asdic_devices_close(&devices, count);
    asdic_mission_destroy(&mission);
    return code;
}

const cli_command cli_view_command = {
    .name = "view",
    .operands = "SCENE.yaml",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "see a mission as it happens, and steer the vehicle",
    .details =
        "A window with the fan or the waterfall, an A-scope with the expected curve, the scene "
        "from a "
        "camera behind the vehicle, and the plan. The mission flies until a key steers. Keys: "
        "arrows "
        "for speed and rudder, pageup and pagedown for the planes, h to hold the depth, x for "
        "rudder "
        "amidships, a to give the helm back; space pauses, . makes a single ping, r records; b and "
        "g "
        "choose the beam, v fan or waterfall, c the colours, t a gain, [ ] - = the window of "
        "levels; o "
        "and p make less or more wind, 1 to 4 the bottom mud, sand, gravel or rock, k and l change "
        "the "
        "source level, n and m the rays; q ends.\n\n"
        "Pings happen at ping_rate_hz of simulated time. When the machine cannot follow, rays are "
        "lowered to --least-rays and bins shown as one, then time is stretched; it is written "
        "above.\n\n"
        "A recording is a folder DIR/000, 001, ... for each stretch with the same choices: "
        "scene.yaml "
        "and track.csv, and what a run leaves. `asdic run scene.yaml` gives the same bytes, "
        "for which a scanned head begins each anew at its first direction.\n\n"
        "Without a display, --y4m writes the frames as video (asdic view SCENE.yaml --y4m - | "
        "ffplay "
        "-), --snapshot some of them as DIR/view_<ping>.png, both as fast as they come, with all "
        "rays.",
    .examples = "asdic view scene.yaml\n"
                "asdic view scene.yaml --y4m - | ffplay -\n"
                "asdic view scene.yaml --keys 2:up,4:right,9:r --snapshot 5 -o frames",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_INTERRUPTIBLE,
    .run = run,
};
