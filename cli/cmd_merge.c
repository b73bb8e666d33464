#include "commands.h"

#include <stdlib.h>

typedef asdic_status (*merge_function)(asdic_context *ctx, const char *const *folders, size_t count,
                                       const char *out_folder, bool force);

/* What joins parts like the one in FOLDER. */
static merge_function merge_by(const char *folder) {
    return asdic_trial_is_in(folder)     ? asdic_trial_merge
           : asdic_dataset_is_in(folder) ? asdic_dataset_merge
                                         : asdic_run_merge;
}

static int run(cli *c) {
    const char *folder = cli_text(c, "output");
    size_t count = cli_operand_count(c);
    if (!folder) {
        return cli_usage(c, "'merge' needs a folder to write to: -o DIR");
    }
    const char **folders = malloc(count * sizeof *folders);
    if (!folders) {
        cli_error(c, "out of memory");
        return CLI_FAILED;
    }
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        folders[kept] = cli_operand(c, i);
        if (!cli_is_left_empty(folders[kept])) {
            kept++;
        }
    }
    if (kept < count) {
        cli_note(c, "%zu of %zu folders are empty and passed over", count - kept, count);
    }
    bool force = cli_given(c, "force");
    asdic_status status =
        merge_by(folders[0])(cli_context(c), folders, kept ? kept : 1, folder, force);
    free(folders);
    return cli_end(c, status);
}

static const cli_option options[] = {
    {"output", 'o', "DIR", "folder of the whole run"},
    {"force", 'f', NULL, "replace a run that is there"},
    {0},
};

const cli_command cli_merge_command = {
    .name = "merge",
    .operands = "DIR...",
    .min_operands = 1,
    .max_operands = CLI_ANY_NUMBER,
    .summary = "join the parts of a run, a trial or a data set made with --shard or --pings",
    .details =
        "The parts may be given in any order; they must follow on each other without gaps, and of "
        "what --shard divided none may lack. A folder that is empty, as of a shard without pings, "
        "is passed over. "
        "The result has the same bytes as one run of all pings, but for the times in "
        "run.json.",
    .examples = "asdic run scene.yaml --shard 1/2 && asdic run scene.yaml --shard 2/2\n"
                "asdic merge run_scene_1_of_2 run_scene_2_of_2 -o run_scene",
    .options = options,
    .run = run,
};
