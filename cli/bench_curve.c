/* Error and time of one sampler over numbers of rays. */
#include "bench_error.h"

#include <math.h>
#include <stdlib.h>

/* Pings are shot for so long before any counts. */
#define WARM_UP_S 0.2
/* A bin that a ping left empty counts as this much too low. */
#define EMPTY_DB (-100.0)

const char *bench_sampler_name(asdic_sampler sampler) {
#define SAMPLER_NAME(sampler, name) [sampler] = name,
    static const char *const names[] = {ASDIC_SAMPLERS(SAMPLER_NAME)};
    return names[sampler];
}

/* Sums over the pings of one point. */
typedef struct tally {
    double squares, far_squares, honest_squares, far_honest_squares, most_db;
    size_t count, far_count, honest_count, far_honest_count;
    double *ratios, *ratio_squares; /* per cell: sums of estimate / truth */
    double *ping_s, *learn_s;       /* by blocks: of a ping, of learning */
    size_t pings, blocks;
} tally;

static void add_ping(tally *t, const bench_scene *s, const asdic_ping *ping) {
    for (size_t beam = 0; beam < s->beams; beam++) {
        for (size_t bin = s->first_bin; bin < s->bins; bin++) {
            size_t at = beam * s->bins + bin;
            double truth = s->reference_lin[at], estimate = ping->intensity_lin[ASDIC_TOTAL][at];
            if (!(truth > 0.0)) {
                continue;
            }
            double off_db = fmax(10.0 * log10(estimate / truth), EMPTY_DB);
            t->ratios[at] += estimate / truth;
            t->ratio_squares[at] += estimate / truth * (estimate / truth);
            t->squares += off_db * off_db;
            t->count++;
            t->most_db = fmax(t->most_db, fabs(off_db));
            if (bin >= s->far_bin) {
                t->far_squares += off_db * off_db;
                t->far_count++;
            }
            double stated_db = ping->stderr_db[at];
            if (stated_db > 0.0) {
                double honest = off_db * off_db / (stated_db * stated_db);
                t->honest_squares += honest;
                t->honest_count++;
                t->far_honest_squares += bin >= s->far_bin ? honest : 0.0;
                t->far_honest_count += bin >= s->far_bin;
            }
        }
    }
}

static double root_mean(double squares, size_t count) {
    return count ? sqrt(squares / (double)count) : NAN;
}

/* One learnt block's pings, handed over as a mission does: all together. */
static asdic_status shoot_block(const bench *b, asdic_simulator *sim, const bench_scene *s,
                                size_t block, size_t pings, asdic_ping *const *out, tally *t) {
    uint64_t first = (uint64_t)block * ASDIC_LEARN_BLOCK;
    asdic_pose poses[ASDIC_LEARN_BLOCK];
    for (size_t k = 0; k < pings; k++) {
        poses[k] = s->pose;
    }
    TRY(bench_interrupted(b));
    double began = cli_clock_s();
    TRY(asdic_simulator_learn(sim, &s->pose, first));
    double learnt = cli_clock_s();
    TRY(asdic_simulator_pings(sim, poses, first, pings, out));
    t->ping_s[t->blocks] = (cli_clock_s() - learnt) / (double)pings;
    t->learn_s[t->blocks++] = learnt - began;
    for (size_t k = 0; k < pings; k++) {
        add_ping(t, s, out[k]);
    }
    t->pings += pings;
    return ASDIC_OK;
}

/* RMS over bins of the mean estimate's error, less what the pings' spread explains of it. */
static double bias_db(const tally *t, const bench_scene *s) {
    double sum = 0.0, n = (double)t->pings;
    size_t count = 0;
    for (size_t i = 0; i < s->beams * s->bins; i++) {
        if (t->ratios[i] > 0.0) {
            double mean = t->ratios[i] / n;
            double variance = fmax(t->ratio_squares[i] / n - mean * mean, 0.0) / (n - 1.0);
            double off_db = 10.0 * log10(mean),
                   spread_db = 10.0 / log(10.0) * sqrt(variance) / mean;
            sum += off_db * off_db - spread_db * spread_db;
            count++;
        }
    }
    return root_mean(fmax(sum, 0.0), count);
}

static void finish_point(tally *t, const bench_scene *s, bench_point *point) {
    double ping_s = bench_median(t->ping_s, t->blocks);
    double learn_s = bench_median(t->learn_s, t->blocks) / ASDIC_LEARN_BLOCK;
    point->pings = t->pings;
    point->rms_db = root_mean(t->squares, t->count);
    point->far_rms_db = root_mean(t->far_squares, t->far_count);
    point->most_db = t->most_db;
    point->honesty = root_mean(t->honest_squares, t->honest_count);
    point->far_honesty = root_mean(t->far_honest_squares, t->far_honest_count);
    point->bias_db = bias_db(t, s);
    point->ping_s = ping_s + learn_s;
    point->learn_share = learn_s / point->ping_s;
}

/* BLOCKS of IN_BLOCK pings, after the simulator and the machine are warm: the first ping compiles
 * for its sizes, and a machine that rested is slow to wake. */
static asdic_status shoot(const bench *b, asdic_simulator *sim, const bench_scene *s, size_t blocks,
                          size_t in_block, asdic_ping *const *pings, tally *t) {
    double began = cli_clock_s();
    do {
        TRY(asdic_simulator_ping(sim, &s->pose, 0, pings[0]));
    } while (cli_clock_s() - began < WARM_UP_S);
    for (size_t k = 0; k < blocks; k++) {
        TRY(shoot_block(b, sim, s, k, in_block, pings, t));
    }
    return ASDIC_OK;
}

static asdic_status create_pings(const bench *b, const bench_scene *s, size_t count,
                                 asdic_ping **pings) {
    for (size_t k = 1; k < count; k++) {
        TRY(asdic_ping_create(cli_context(b->c), s->beams, s->bins, &pings[k]));
    }
    return ASDIC_OK;
}

static asdic_status measure_point(const bench *b, const bench_scene *s, asdic_sampler sampler,
                                  const bench_effort *effort, bench_point *point) {
    asdic_sampling sampling = *asdic_mission_sampling(s->mission);
    sampling.sampler = sampler;
    sampling.rays = point->rays;
    size_t in_block = (size_t)(effort->point_rays / point->rays) / effort->blocks;
    in_block = in_block < 2 ? 2 : in_block > ASDIC_LEARN_BLOCK ? ASDIC_LEARN_BLOCK : in_block;
    size_t blocks = (size_t)(effort->point_rays / point->rays) / in_block;
    blocks = blocks < 1 ? 1 : blocks > effort->blocks ? effort->blocks : blocks;
    tally t = {.ping_s = calloc(blocks, sizeof(double)),
               .learn_s = calloc(blocks, sizeof(double)),
               .ratios = calloc(s->beams * s->bins, sizeof(double)),
               .ratio_squares = calloc(s->beams * s->bins, sizeof(double))};
    asdic_simulator *sim = NULL;
    asdic_ping *pings[ASDIC_LEARN_BLOCK] = {NULL};
    bool room = t.ping_s && t.learn_s && t.ratios && t.ratio_squares;
    asdic_status status = room ? create_pings(b, s, in_block, pings) : ASDIC_ERROR_MEMORY;
    status = status ? status : bench_scene_simulator(b, s, &sampling, &sim, &pings[0]);
    status = status ? status : shoot(b, sim, s, blocks, in_block, pings, &t);
    if (!status) {
        finish_point(&t, s, point);
    }
    free(t.ping_s);
    free(t.learn_s);
    free(t.ratios);
    free(t.ratio_squares);
    for (size_t k = 0; k < in_block; k++) {
        asdic_ping_destroy(&pings[k]);
    }
    asdic_simulator_destroy(&sim);
    return status;
}

/* Where the line through log (x, y) of two points meets log Y; and the other way round. */
static double between(double x0, double y0, double x1, double y1, double x) {
    double t = (log(x) - log(x0)) / (log(x1) - log(x0));
    return exp(log(y0) + t * (log(y1) - log(y0)));
}

void bench_find_1db(bench_curve *curve) {
    curve->rays_1db = curve->seconds_1db = NAN;
    for (size_t i = 1; i < curve->count; i++) {
        const bench_point *a = &curve->points[i - 1], *b = &curve->points[i];
        if (a->rms_db > 1.0 && b->rms_db <= 1.0) {
            curve->rays_1db = between(a->rms_db, a->rays, b->rms_db, b->rays, 1.0);
            curve->seconds_1db = between(a->rays, a->ping_s, b->rays, b->ping_s, curve->rays_1db);
        }
    }
}

asdic_status bench_curve_measure(const bench *b, const bench_scene *scene,
                                 const bench_effort *effort, bench_curve *out) {
    /* Powers of four, and the paper's 20,000. */
    static const uint32_t few[] = {64, 256, 1024, 4096, 20000, 65536, 0};
    static const uint32_t more[] = {1024, 4096, 20000, 65536, 262144, 0};
    static const uint32_t most[] = {20000, 65536, 262144, 1048576, 4194304, 0};
    const uint32_t *rays = out->sampler == ASDIC_SAMPLER_ADAPTIVE ? few
                           : out->sampler == ASDIC_SAMPLER_BEAM   ? more
                                                                  : most;
    for (out->count = 0; *rays; rays++, out->count++) {
        bench_point *point = &out->points[out->count];
        point->rays = *rays;
        TRY(measure_point(b, scene, out->sampler, effort, point));
    }
    bench_find_1db(out);
    return ASDIC_OK;
}
