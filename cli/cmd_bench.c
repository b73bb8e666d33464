#include "bench.h"
#include "commands.h"

static const cli_option options[] = {
    {"output", 'o', "FILE.csv", "write the figures as CSV too"},
    {"picture", 0, "FILE", "error, pings: draw the curves too: .png, .pdf or .svg"},
    {"quick", 0, NULL, "a rougher answer in a fraction of the time"},
    {"threads", 0, "N", "threads of a processor as device; of rays 1 unless given"},
    {"kernel", 0, "NAME", "rays: a form of the ray kernel instead of the fastest"},
    {NULL, 0, NULL, NULL},
};

static const char *const shipped[] = {"scenes/bench_flat.yaml", "scenes/bench_step.yaml",
                                      "scenes/bench_sphere.yaml", "scenes/bench_terrain.yaml",
                                      NULL};
static const char *const shipped_missions[] = {"scenes/mission.yaml", "scenes/mission_fan.yaml",
                                               NULL};

static int run(cli *c) {
    static const bench_kind kinds[] = {
        {"error", bench_error_columns, bench_error, shipped, 0, CLI_ANY_NUMBER, 0, true},
        {"honest", bench_honest_columns, bench_honest, NULL, 1, CLI_ANY_NUMBER, 0, false},
        {"loop", bench_loop_columns, bench_loop, shipped_missions, 0, CLI_ANY_NUMBER, 0, false},
        {"pings", bench_pings_columns, bench_pings, NULL, 0, CLI_ANY_NUMBER, 0, true},
        {"rays", bench_rays_columns, bench_rays, NULL, 0, CLI_ANY_NUMBER, 1, false},
        {NULL, NULL, NULL, NULL, 0, 0, 0, false},
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
        "error: how far pings are from the truth and what they cost, for every sampler over many "
        "numbers of rays. Noise and speckle are off. The truth is the quadrature of `asdic expect` "
        "where the scene is flat, else the mean of pings with 1e8 rays in all, whose own spread is "
        "printed. 'bias' is the error that is left in the mean of a row's pings; 'true/stated' is "
        "the r.m.s. of the error over stderr_db, 1 if that is honest; 'far' is the same in the "
        "last "
        "third of the bins; 'ms/ping' is the time of a block of pings with its learning, by its "
        "pings; 'learn %' is the share of pilots and of the pings that calibrate stderr_db. "
        "Without "
        "a scene it takes the four benchmark scenes. The last lines compare the rays and the time "
        "that an error of 1 dB takes with the paper's uniform sphere.\n\n"
        "honest: whether the errors that bins state hold in the scenes named. It takes the first "
        "eight pings of a block for each of three seeds, at the scene's rays: the r.m.s. of true "
        "over stated error (1 if honest), the same of all seeds, and the share of bins that err by "
        "more than five stated errors. The truth is that of 'bench error'; its own standard error "
        "is printed and counted.\n\n"
        "pings: pings a second of the scenes named; without one, of six beams and 20,000 rays with "
        "one bounce over rough floors of 1e4 to 4e6 triangles, for 150 to 4,000 bins. 'mission' "
        "counts learning; the phases of a ping are timed by themselves. 'create' and 'first' are "
        "the making of a simulator and its first ping: the first rows have kernels to compile, or "
        "to fetch from PoCL's cache, and every row has a form of the ray kernel to choose.\n\n"
        "loop: pose in, levels out. How many pings a second there can be, one after the other, and "
        "at the scene's ping rate the latency from pose to levels: median, 99th percentile, worst, "
        "and how many pings took longer than their period; then the frames a second of `asdic "
        "view`, pings included. Without a scene it takes two shipped missions.\n\n"
        "rays: how many rays a second find their nearest hit in the meshes named, else in a rough "
        "floor of a million triangles: cones and whole spheres from one point, in Morton order of "
        "direction and in none. One thread is timed by the processor's clock.\n\n"
        "Times are medians on this machine as it is: close other programs.",
    .examples = "asdic bench error --quick --picture error.png\n"
                "asdic bench loop scene.yaml\n"
                "asdic bench rays floor.ply --threads 2",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_HAS_JSON | CLI_INTERRUPTIBLE,
    .run = run,
};
