/* What bounds each phase of a ping: its time beside what the device can do (ceilings.c), and how that changes
 * with rays and triangles. Six beams of 1,000 bins with one bounce, over a floor of a million triangles. */
#include "bench_pings.h"
#include "kinds.h"

#include <math.h>

#define BINS 1000
#define FEW 5000
#define SHARED 20000 /* rays of all beams */
#define EACH 120000  /* 20,000 of each beam */

const bench_column roofline_columns[] = {{"phase", "phase", 8, 0, 0.0},
                                         {"phase_s", "ms", 7, 2, 1e3},
                                         {"fixed_s", "fixed", 7, 2, 1e3},
                                         {"small_mesh_s", "1e4 tri.", 8, 2, 1e3},
                                         {"phase_of_120000_s", "6 x 20k", 8, 2, 1e3},
                                         {"bytes", "MB", 6, 2, 1e-6},
                                         {"flops", "Mflop", 7, 1, 1e-6},
                                         {"memory_share", "memory %", 8, 1, 100.0},
                                         {"arithmetic_share", "arithm. %", 9, 1, 100.0},
                                         {NULL, NULL, 0, 0, 0.0}};

/* What a ray has the device do. BYTES are what kernels must read and write of it in buffers (ping_types.h: a ray has
 * 32, a hit 8, a triangle 80, an arrival 48); the tree is left out, of which caches hold what rays share. FLOPS are
 * what Oclgrind 21.10 counts more for 2,048 rays than for 1,024 (--inst-counts, one ray a work-item, fma() for
 * fused(), over the floor of 10,000 triangles): sums, products, quotients and roots, multiply-adds twice; lanes of
 * a vector that do nothing, comparing and choosing are left out. */
static const struct {
    asdic_phase phase;
    double bytes, flops;
} works[] = {
    {ASDIC_PHASE_SAMPLE, 32 + 4 + 4, 1044},
    {ASDIC_PHASE_TRACE, 32 + 8, 516},
    {ASDIC_PHASE_SHADE, 32 + 4 + 4 + 8 + 80 + 48 + 32 + 16, 649},
    {ASDIC_PHASE_BOUNCE, /* the mirror rays' trace, connect, the trace home, bounce */
     (32 + 8) + (32 + 8 + 80 + 16 + 32) + (32 + 8) + (32 + 4 + 32 + 8 + 32 + 8 + 16 + 80 + 2 * 48),
     402 + 10 + 12 + 15},
    {ASDIC_PHASE_COLLECT, 3 * 48, 340}, /* six beams */
};

#define WORKS (sizeof works / sizeof *works)

typedef struct rates {
    bench_rate few, shared, each, small;
} rates;

static asdic_status measure_floor(bench *b, size_t triangles, const uint32_t *rays,
                                  bench_rate *const *out, size_t count) {
    asdic_scene *scene = NULL;
    asdic_status status = bench_terrain(cli_context(b->c), triangles, 0, &scene);
    for (size_t i = 0; !status && i < count; i++) {
        bench_case of = {.scene = scene, .bins = BINS, .rays = rays[i], .pings = b->quick ? 8 : 48};
        status = bench_pings_measure(b, b->device, &of, out[i]);
    }
    asdic_scene_destroy(&scene);
    return status;
}

static void add_phase(bench *b, size_t i, const rates *r, const bench_ceilings *most) {
    const asdic_phase p = works[i].phase;
    double s = r->shared.least_s[p], bytes = SHARED * works[i].bytes,
           flops = SHARED * works[i].flops;
    /* What would be left without rays: launches, waiting, the host's work. */
    double fixed_s = fmax(r->few.least_s[p] - (s - r->few.least_s[p]) * FEW / (SHARED - FEW), 0.0);
    const bench_cell cells[] = {BENCH_TEXT(asdic_phase_name(p)),
                                BENCH_NUMBER(s),
                                BENCH_NUMBER(fixed_s),
                                BENCH_NUMBER(r->small.least_s[p]),
                                BENCH_NUMBER(r->each.least_s[p]),
                                BENCH_NUMBER(bytes),
                                BENCH_NUMBER(flops),
                                BENCH_NUMBER(bytes / s / most->bytes_per_s),
                                BENCH_NUMBER(flops / s / most->flops_per_s)};
    bench_add(b, cells);
}

asdic_status roofline(bench *b) {
    static const uint32_t large[] = {FEW, SHARED, EACH}, small[] = {SHARED};
    bench_ceilings most;
    rates r;
    bench_rate *const of_large[] = {&r.few, &r.shared, &r.each}, *const of_small[] = {&r.small};
    TRY(bench_ceilings_measure(b->device, &most));
    TRY(measure_floor(b, bench_floors[b->quick ? 1 : 2], large, of_large, 3));
    TRY(measure_floor(b, bench_floors[0], small, of_small, 1));
    for (size_t i = 0; i < WORKS; i++) {
        add_phase(b, i, &r, &most);
    }
    bench_say(b, "the device moves %.1f GB/s and makes %.0f Gflop/s\n", 1e-9 * most.bytes_per_s,
              1e-9 * most.flops_per_s);
    bench_say(b, "pings a second: %.1f with %d rays, %.1f with %d\n", 1.0 / r.shared.ping_s, SHARED,
              1.0 / r.each.ping_s, EACH);
    return ASDIC_OK;
}
