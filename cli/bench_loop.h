/*
 * `asdic bench loop`, inside: its two scenes, files that live as long as the measurement.
 */
#ifndef ASDIC_CLI_BENCH_LOOP_H
#define ASDIC_CLI_BENCH_LOOP_H

#include "bench.h"

#define BENCH_LOOP_SCENES 2

typedef struct bench_folder {
    char path[256]; /* "": none */
    char scenes[BENCH_LOOP_SCENES][320];
} bench_folder;

/* A temporary folder with a sea floor of a million triangles and a scene for each setting: six beams
 * and 256, 20,000 rays, pings at 10 Hz along a line. False after a message. */
bool bench_folder_make(cli *c, bench_folder *folder);
void bench_folder_remove(bench_folder *folder);

#endif
