/*
 * The benches that only this project needs, on the frame of `asdic bench`.
 */
#ifndef TESTS_BENCH_KINDS_H
#define TESTS_BENCH_KINDS_H

#include "bench.h"

asdic_status bend(bench *b);     /* bent rays beside straight ones */
asdic_status beside(bench *b);   /* rays beside Embree's */
asdic_status coherent(bench *b); /* coherent pings, by elements, samples and scatterers */
asdic_status cost(bench *b);     /* what stated errors and many bins cost */
asdic_status fan(bench *b);      /* many beams of the same rays; the published case to beat */
asdic_status growth(bench *b);   /* bench pings on the whole device and on one unit of it */
asdic_status latency(bench *b);  /* bench loop over a floor of a million triangles */
asdic_status roofline(bench *b); /* the phases of a ping beside what the device can do */
asdic_status truth(bench *b);    /* what it costs to tell what bins hold */
asdic_status start(bench *b);    /* from the start of a process to its first ping */
asdic_status first(bench *b);    /* that first ping, and no more */

/* What DEVICE does at best: bytes that it moves, floating-point operations (a multiply-add is two). */
typedef struct bench_ceilings {
    double bytes_per_s, flops_per_s;
} bench_ceilings;

asdic_status bench_ceilings_measure(asdic_device *device, bench_ceilings *out);

extern const bench_column bend_columns[], beside_columns[], coherent_columns[], cost_columns[],
    fan_columns[], roofline_columns[], start_columns[], first_columns[], truth_columns[];

#endif
