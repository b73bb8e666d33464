/*
 * What the kinds of `asdic bench` share: what is asked for, a clock, medians, output files.
 */
#ifndef ASDIC_CLI_BENCH_H
#define ASDIC_CLI_BENCH_H

#include "cli.h"

typedef struct bench_options {
    bool quick, json, first;
    uint64_t threads;          /* 0: not given */
    const char *kernel;        /* NULL: not given */
    const char *csv, *picture; /* NULL: none */
} bench_options;

/* Each prints its table, or JSON, and returns an exit code. Operand 0 is the kind itself. */
int bench_error(cli *c, const bench_options *options);
int bench_fan(cli *c, const bench_options *options);
int bench_honest(cli *c, const bench_options *options);
int bench_loop(cli *c, const bench_options *options);
int bench_pings(cli *c, const bench_options *options);
int bench_rays(cli *c, const bench_options *options);

/* Monotonic, s. */
double bench_now_s(void);

/* Tells PoCL, which reads it when it starts, how many threads to take: those of --threads, else as the
 * environment says, else OTHERWISE (0: as many as it likes). Returns the number, 0 if it is PoCL's. */
unsigned bench_limit_threads(const bench_options *options, unsigned otherwise);

/* Processor time of the process (all its threads), s: what one thread needs, whoever else runs. */
double bench_processor_s(void);

/* Sorts VALUES; NAN of none. */
double bench_median(double *values, size_t count);

/* CURVES (at most 4; x, y in ms a ping, count and label are given) over two logarithmic axes. */
asdic_status bench_scaling_picture(const cli *c, const char *path, const char *title,
                                   const char *abscissa, asdic_series *curves, size_t count);

/* A shipped scene or mesh ("scenes/bench_flat.yaml"): in the folder that the environment's
 * ASDIC_DATA names, in the installed share/asdic, or in the source tree's data. False when it is
 * nowhere; OUT then holds the last place looked at. */
bool bench_find_data(const char *name, char *out, size_t size);

/* A text file that appears under its own name only when it is complete. NULL after a message. */
FILE *bench_begin_file(const cli *c, const char *path);
/* Closes and renames it. */
int bench_end_file(const cli *c, FILE *file, const char *path);

#endif
