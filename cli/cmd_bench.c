#include "bench.h"
#include "commands.h"

static const cli_option options[] = {
    {"output", 'o', "FILE.csv", "write the figures as CSV too; - in place of the table"},
    {"picture", 0, "FILE", "error, pings: draw the curves too: .png, .pdf or .svg"},
    {"quick", 0, NULL, "a rougher answer in a fraction of the time"},
    {"threads", 0, "N", "threads of a processor as device; of rays 1 unless given"},
    {"kernel", 0, "NAME",
     "auto, wide8, pkt16, frustum64 or scalar: the ray kernel that 'rays' times; auto: the "
     "fastest"},
    {"force", 'f', NULL, "overwrite what exists"},
    {NULL, 0, NULL, NULL},
};

static const char *const shipped[] = {"scenes/bench_flat.yaml", "scenes/bench_step.yaml",
                                      "scenes/bench_sphere.yaml", "scenes/bench_terrain.yaml",
                                      NULL};
static const char *const shipped_missions[] = {"scenes/mission.yaml", "scenes/mission_fan.yaml",
                                               NULL};

static int run(cli *c) {
    static const bench_kind kinds[] = {
        {"error", bench_error_columns, bench_error, shipped, 0, CLI_ANY_NUMBER, 0, BENCH_MOST_DRAWN,
         false},
        {"honest", bench_honest_columns, bench_honest, NULL, 1, CLI_ANY_NUMBER, 0, 0, false},
        {"loop", bench_loop_columns, bench_loop, shipped_missions, 0, CLI_ANY_NUMBER, 0, 0, false},
        {"pings", bench_pings_columns, bench_pings, NULL, 0, CLI_ANY_NUMBER, 0, CLI_ANY_NUMBER,
         false},
        {"rays", bench_rays_columns, bench_rays, NULL, 0, CLI_ANY_NUMBER, 1, 0, true},
        {NULL, NULL, NULL, NULL, 0, 0, 0, 0, false},
    };
    return bench_run(c, kinds);
}

const cli_command cli_bench_command = {
    .name = "bench",
    .operands = "error|honest|loop|pings|rays [SCENE.yaml|MESH ...]",
    .min_operands = 1,
    .max_operands = CLI_ANY_NUMBER,
    .summary = "measure speed against error, pings or rays per second, or latency",
    .details =
        "error: how far pings are from the truth, and what they cost, for every sampler.\n\n"
        "honest: whether the errors that bins state hold in the scenes named.\n\n"
        "loop: how many pings a second there can be, and how late levels come.\n\n"
        "pings: pings a second, and where the time of a ping goes.\n\n"
        "rays: how many rays a second find their nearest hit in a mesh.\n\n"
        "Without a scene all but honest take scenes of their own. The columns are explained in "
        "docs/accuracy.md.",
    .examples = "asdic bench error --quick --picture error.png\n"
                "asdic bench loop scene.yaml\n"
                "asdic bench rays floor.ply --threads 2",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_HAS_JSON | CLI_INTERRUPTIBLE,
    .run = run,
};
