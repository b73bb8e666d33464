#include "commands.h"
#include "progress.h"

#include <stdlib.h>
#include <string.h>

/* The options of the command line; false when something is wrong with them. */
static bool read_options(cli *c, asdic_dataset_options *o, cli_part *part) {
    uint64_t frames = o->frames, first = 0;
    cli_integer(c, "number", 1, 999999, &frames);
    cli_integer(c, "seed", 0, UINT64_MAX, &o->seed);
    cli_number(c, "threshold", 1e-3, 1.0, &o->threshold);
    cli_number(c, "radius", 16.0, 8192.0, &o->radius_px);
    cli_number_range(c, "range-db", -300.0, 400.0, &o->low_db, &o->high_db);
    *part = cli_share(c, "shard");
    o->side_lobes = cli_given(c, "side-lobes");
    cli_mode(c, &o->force, &o->resume);
    o->frames = frames;
    cli_take_part(*part, &first, &frames);
    o->first = (size_t)first;
    o->end = (size_t)frames;
    return !cli_bad_usage(c);
}

static asdic_status make(cli *c, const asdic_dataset_options *o) {
    asdic_device **devices = NULL;
    size_t count = 0;
    TRY(cli_open_devices(c, &devices, &count));
    cli_progress progress = cli_progress_begin(c);
    cli_progress_watch(&progress);
    asdic_status status = asdic_dataset_make(cli_context(c), cli_operand(c, 0), devices[0], o);
    cli_progress_end(&progress);
    asdic_devices_close(&devices, count);
    return status;
}

static int run(cli *c) {
    asdic_dataset_options o = asdic_dataset_options_default();
    cli_part part;
    if (!read_options(c, &o, &part)) {
        return CLI_USAGE;
    }
    if (strcmp(cli_operand(c, 0), "-") == 0) {
        return cli_usage(c, "the scene is read for every frame; it must be a file");
    }
    char *folder = cli_output(c, "dataset", part, "");
    o.folder = folder;
    if (folder && o.first == o.end) {
        int code = cli_leave_empty(c, "frames", o.frames, folder);
        free(folder);
        return code;
    }
    asdic_status status = folder ? make(c, &o) : ASDIC_ERROR_MEMORY;
    if (!status) {
        size_t frames = o.end - o.first;
        cli_note(c, "%zu frame%s in %s", frames, cli_plural(frames), o.folder);
    }
    free(folder);
    return cli_end(c, status);
}

static const cli_option options[] = {
    {"number", 'n', "N", "frames of the whole set (default 1000)"},
    {"output", 'o', "DIR", "folder to write to (default dataset_NAME)"},
    {"seed", 0, "S", "seed of the drawings (default 1)"},
    {"threshold", 0, "SHARE",
     "an object's share of a bin from which on the bin is its (default 0.5)"},
    {"side-lobes", 0, NULL, "label objects also where beams hear them by side lobes alone"},
    {"radius", 0, "PIXELS", "the range in polar pictures (default 512)"},
    {"range-db", 0, "LOW:HIGH",
     "levels from black to white, with gain (default: the first frame's)"},
    {"shard", 0, "K/N", "make the K-th of N parts; 'asdic merge' joins them"},
    {"resume", 'r', NULL, "make what is missing of a set that is there, or more of it"},
    {"force", 'f', NULL, "replace a set that is there"},
    {0},
};

const cli_command cli_dataset_command = {
    .name = "dataset",
    .operands = "SCENE.yaml",
    .min_operands = 1,
    .max_operands = 1,
    .summary = "make labelled frames of scenes drawn at random",
    .details =
        "Draws the scene as its 'trial' section says, one ping for each frame, and writes levels, "
        "pictures by bearing and polar, masks of the objects, boxes and polygons (COCO, YOLO), and "
        "a manifest. A frame depends on scene, seed, options and its number alone; one whose draw "
        "puts the sonar below the bottom is void, and passed over. What the files hold stands in "
        "docs/dataset.md.",
    .examples = "asdic dataset scene.yaml -n 100 -o frames\n"
                "asdic dataset scene.yaml -n 10000 -o frames --resume\n"
                "asdic dataset scene.yaml -n 10000 --shard 1/2 -o part1",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_INTERRUPTIBLE,
    .run = run,
};
