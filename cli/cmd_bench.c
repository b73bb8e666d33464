#include "bench.h"
#include "commands.h"

#include <string.h>

static const cli_option options[] = {
    {"output", 'o', "FILE.csv", "write the figures as CSV too"},
    {"picture", 0, "FILE", "error, fan, pings: draw the curves too: .png, .pdf or .svg"},
    {"quick", 0, NULL, "a rougher answer in a fraction of the time"},
    {"threads", 0, "N", "rays, pings: threads of the device; of rays 1 unless given"},
    {"first", 0, NULL, "pings: only one ping, as a program's first"},
    {"kernel", 0, "NAME", "rays: a form of the ray kernel instead of the fastest"},
    {NULL, 0, NULL, NULL},
};

static int run(cli *c) {
    static const struct {
        const char *name;
        int (*run)(cli *c, const bench_options *options);
    } kinds[] = {{"error", bench_error}, {"fan", bench_fan},     {"honest", bench_honest},
                 {"loop", bench_loop},   {"pings", bench_pings}, {"rays", bench_rays}};
    bench_options given = {.quick = cli_given(c, "quick"),
                           .first = cli_given(c, "first"),
                           .json = cli_given(c, "json"),
                           .csv = cli_text(c, "output"),
                           .kernel = cli_text(c, "kernel"),
                           .picture = cli_text(c, "picture")};
    cli_integer(c, "threads", 1, 64, &given.threads);
    if (cli_bad_usage(c)) {
        return CLI_USAGE;
    }
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        if (strcmp(cli_operand(c, 0), kinds[i].name) == 0) {
            return kinds[i].run(c, &given);
        }
    }
    return cli_usage(c, "'%s' is not error, fan, honest, loop, pings or rays", cli_operand(c, 0));
}

const cli_command cli_bench_command = {
    .name = "bench",
    .operands = "error|fan|honest|loop|pings|rays [SCENE.yaml|MESH ...]",
    .min_operands = 1,
    .max_operands = CLI_ANY_NUMBER,
    .summary = "measure speed against error, pings or rays per second, or latency",
    .details =
        "error: how far pings are from the truth, and what they cost, for every sampler over many "
        "numbers of rays. Noise and speckle are off. The truth is the quadrature of `asdic expect` "
        "where the scene is flat, else the mean of pings with 1e8 rays in all, whose own spread is "
        "printed. 'bias' is what is left of the error in the mean of a row's pings; 'true/stated' "
        "is the r.m.s. of the error over stderr_db, 1 if that is honest, 'far' the same in the "
        "last third of the bins; 'ms/ping' is a learnt block's time by its pings, handed over "
        "together as missions do; 'learn %' is the time of pilots and of the pings that calibrate "
        "stderr_db; the last lines tell what stating errors costs, and what the same range in "
        "2,048 bins instead of 150, both measured by turns. Without a scene the four benchmark "
        "scenes are taken. The factor compares the rays and the time that an error of 1 dB takes "
        "with the paper's uniform sphere.\n\n"
        "fan: 6 to 1,024 beams from 20,000 rays over a flat bottom, rays aimed at each of six, "
        "shared "
        "over the sector by more; and 512 beams from 25,000, which err as six do. With the error "
        "per "
        "beam of twelve of them against the quadrature, and 'x first' from the least time of a "
        "ping, "
        "which others on the machine disturb least; then 512 beams of 114 rays each, 60 m of "
        "range, over a rough floor of triangles: the published case of Project DAVE, 1.7 s a ping "
        "when first published and 36 ms since, both on CUDA cards. It has cells of 25 mm; the last "
        "row has bins of 0.1 m.\n\n"
        "honest: whether the errors that bins state hold in the scenes named: of three seeds, each "
        "a "
        "learnt block's first eight pings at the scene's rays, the r.m.s. of true over stated "
        "error "
        "(1 if honest), also of all three, and the share of bins that err by more than five stated "
        "errors. The truth is that of 'bench error'; its own standard error is printed and "
        "counted.\n\n"
        "pings: the paper's case, six beams and 20,000 rays with one bounce, over rough floors of "
        "1e4 to 4e6 triangles and for 150 to 4,000 bins, on one compute unit of the device (a "
        "thread of "
        "a processor) and on all; 'mission' counts learning, phases are timed by themselves. "
        "'create' "
        "and 'first' are a simulator's making and its first ping: in the first rows they have "
        "kernels "
        "to compile, or to fetch from PoCL's cache, and everywhere ray kernels to choose between. "
        "Then how the time grows, and how long a program takes from its start "
        "to its first ping: cold, with kernels to compile, and warm, with PoCL's cache of them.\n\n"
        "loop: pose in, levels out. How many pings a second there can be, one after the other, and "
        "at the scene's ping rate the latency from pose to levels: median, 99th percentile, worst, "
        "and how many pings took longer than their period; then the frames a second of `asdic "
        "view`, pings "
        "included. Without a scene: six beams with "
        "multipath over every surface, and a fan of 256, both with 20,000 rays over a floor of a "
        "million triangles at 10 pings a second.\n\n"
        "rays: the nearest hits of eight sets of rays in three scenes, or in the meshes named: "
        "cones and "
        "whole spheres from one point, in Morton order of direction and in none, their mirror "
        "rays, and "
        "rays aimed exactly at vertices, of which those are 'missed' that slip through where exact "
        "arithmetic finds surface all round them. At a silhouette a rounded direction may pass "
        "beside it ('passed') or, by less than rounding, inside ('grazed'). A program that was "
        "built with -Dembree=enabled casts the same rays with Intel Embree in between, on as "
        "many threads, and prints how many times faster "
        "asdic is ('ratio'), on how many rays the two disagree, and how long each takes to "
        "build its hierarchy. One thread is timed by the processor's clock.\n\n"
        "Timings are medians on this machine as it is: close other programs.",
    .examples = "asdic bench error --quick --picture error.png\n"
                "asdic bench loop scene.yaml\n"
                "asdic bench rays floor.ply --threads 2",
    .options = options,
    .traits = CLI_HAS_DEVICE | CLI_HAS_JSON | CLI_INTERRUPTIBLE,
    .run = run,
};
