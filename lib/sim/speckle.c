#include "speckle.h"

#include "base/bits.h"
#include "base/context.h"
#include "base/share.h"
#include "base/widest.h"
#include "coherence.h"
#include "pulse.h"
#include "texture.h"

#include "../../kernels/coherent.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Loops work on this many numbers at once. */
#define RUN 128u
/* Bins are drawn in blocks, so that all sources of a block stay in a processor's cache. A block draws a
 * pulse more than it has: it is therefore as long as a cell, at most this. */
#define MOST_BLOCK 4096.0
/* A pulse is that of coherent pings, 1.5 cells long, in steps of 1/16 of a cell or less. */
#define STEPS_OF_CELL 16.0
#define PULSE_CELLS (2.0 * (double)PULSE_REACH)
#define MOST_STEPS 48
/* White noise that is added, so that the spectrum vanishes nowhere. */
#define RIDGE 1e-3
/* Bins within 1/16 of a cell are taken as one: they share 0.99 of the pressure. */
#define SAME_CELL 16.0
/* Beams of a group, at least. */
#define LEAST_GROUP 32
/* A cell's number in a stream: its bin, and above that the look; looks are at most 1000. */
#define LOOK_SHIFT 22
#define TEXTURE_LOOK 1023u

/* The pulse along range: COUNT weights, each of the sum of STEP bins of white noise. */
typedef struct pulse {
    size_t count, step;
    float weight[MOST_STEPS];
    bool is_one; /* all bins are the same */
} pulse;

/* Where a thread draws a block. */
typedef struct scratch {
    bool *is_heard; /* sources that the beams in hand hear */
    float *noise;   /* of one source: a row of complex numbers */
    float *sources; /* [source][2][block] */
    double *drawn;  /* intensities of a beam's block */
} scratch;

struct asdic_speckle_field {
    asdic_sonar sonar; /* without receivers */
    asdic_coherence coherence;
    asdic_texture texture; /* of K */
    pulse pulse;
    size_t bins, block;
    scratch *scratch; /* of every thread */
    unsigned threads;
    size_t
        groups; /* of beams, where blocks are too few for the threads: their sources are drawn twice at the
                    * edges */
};

/* A stream of complex normal variates. */
typedef struct stream {
    uint32_t seed[2], index[2], look;
} stream;

/* What two bins D pulses apart share of the pressure: the integral of s(x) s(x + D). */
static double pulse_shared(double d) {
    const int steps = 600;
    double sum = 0.0, wide = PULSE_CELLS / steps;
    for (int i = 0; i < steps; i++) {
        double x = ((double)i + 0.5) * wide - 0.5 * PULSE_CELLS;
        sum += wide * pulse_at(x, 1.0) * pulse_at(x + d, 1.0);
    }
    return sum;
}

/* The filter whose output, of white noise, has the covariance C[0] to C[COUNT - 1] and none beyond: the last row of
 * the Cholesky factor of the covariance of many values (F. L. Bauer, Arch. Elektr. Uebertr. 9, 285 (1955)). */
static void factor(const double *c, size_t count, float *weight) {
    enum { ROWS = 400 };
    double row[MOST_STEPS][MOST_STEPS] = {{0}}; /* row n: what value n has of noise n, n - 1, ... */
    for (size_t n = 0; n < ROWS; n++) {
        double *own = row[n % count];
        for (size_t k = count; k-- > 0;) {
            const double *other = row[(n + count - k) % count];
            double left = k <= n ? c[k] : 0.0;
            for (size_t i = k + 1; i < count; i++) {
                left -= own[i] * (k > 0 ? other[i - k] : own[i]);
            }
            own[k] = k > 0 ? (k <= n ? left / other[0] : 0.0) : sqrt(left);
        }
    }
    for (size_t k = 0; k < count; k++) {
        weight[k] = (float)row[(ROWS - 1) % count][k];
    }
}

/* The pulse, for cells of CELL bins. Bins as long as a cell share nothing. */
static pulse pulse_of(double cell, size_t bins) {
    pulse p = {.count = 1, .step = 1, .weight = {1.0f}};
    double last = PULSE_CELLS * cell + (double)bins;
    p.is_one = cell > SAME_CELL * (double)bins || last > (double)(1u << LOOK_SHIFT);
    if (cell <= 1.0 || p.is_one) {
        return p;
    }
    p.step = (size_t)fmax(floor(cell / STEPS_OF_CELL), 1.0);
    double step = (double)p.step / cell, shared[MOST_STEPS] = {0.0};
    p.count = (size_t)ceil(PULSE_CELLS / step);
    for (size_t k = 0; k < p.count; k++) {
        shared[k] = pulse_shared((double)k * step);
    }
    shared[0] *= 1.0 + RIDGE;
    factor(shared, p.count, p.weight);
    for (size_t k = 0; k < p.count; k++) {
        p.weight[k] *= (float)(1.0 / sqrt((1.0 + RIDGE) * (double)p.step));
    }
    return p;
}

/* Bins beyond a block that it needs. */
static size_t beyond(const pulse *p) {
    return p->count * p->step - 1;
}

/* Length of a row of variates, which is drawn in whole runs. */
static size_t noise_length(const asdic_speckle_field *f) {
    return f->block + beyond(&f->pulse) + RUN;
}

static size_t blocks_of(const asdic_speckle_field *f) {
    return (f->bins + f->block - 1) / f->block;
}

/* Threads take blocks in turn: two for each keep all of them at work. */
static size_t groups_of(const asdic_speckle_field *f) {
    size_t wanted = f->threads > 1 ? (2 * f->threads - 1) / blocks_of(f) + 1 : 1;
    size_t most = f->coherence.receivers / LEAST_GROUP;
    return wanted < most ? wanted : most > 0 ? most : 1;
}

static bool make_scratch(asdic_speckle_field *f) {
    bool has_all = true;
    f->scratch = calloc(f->threads, sizeof *f->scratch);
    for (unsigned i = 0; f->scratch && i < f->threads; i++) {
        scratch *s = &f->scratch[i];
        s->is_heard = malloc(f->coherence.sources);
        s->noise = malloc(2 * noise_length(f) * sizeof *s->noise);
        s->sources = malloc(2 * f->coherence.sources * f->block * sizeof *s->sources);
        s->drawn = malloc(f->block * sizeof *s->drawn);
        has_all = has_all && s->is_heard && s->noise && s->sources && s->drawn;
    }
    return f->scratch && has_all;
}

asdic_status asdic_speckle_create(asdic_context *ctx, const asdic_sonar *sonar,
                                  double sound_speed_mps, size_t bins, unsigned threads,
                                  asdic_speckle_field **out) {
    *out = NULL;
    if (sonar->speckle == ASDIC_SPECKLE_NONE) {
        return ASDIC_OK;
    }
    asdic_speckle_field *f = calloc(1, sizeof *f);
    if (!f) {
        return asdic_fail_memory(ctx, "speckle");
    }
    asdic_status status =
        asdic_coherence_init(&f->coherence, ctx, sonar, sound_speed_mps / sonar->frequency_hz);
    if (status) {
        asdic_speckle_destroy(&f);
        return status;
    }
    double cell = asdic_pulse_bins(sonar, sound_speed_mps);
    double block = RUN * ceil(fmin(fmax(cell, 1.0), MOST_BLOCK) / RUN);
    f->sonar = *sonar;
    f->sonar.receivers = NULL;
    f->bins = bins;
    f->block = (size_t)block;
    f->pulse = pulse_of(cell, bins);
    f->threads = threads;
    f->groups = groups_of(f);
    bool has_texture =
        sonar->speckle != ASDIC_SPECKLE_K || asdic_texture_init(&f->texture, sonar->speckle_shape);
    if (!has_texture || !make_scratch(f)) {
        asdic_speckle_destroy(&f);
        return asdic_fail_memory(ctx, "speckle");
    }
    *out = f;
    return ASDIC_OK;
}

void asdic_speckle_destroy(asdic_speckle_field **field) {
    if (field && *field) {
        asdic_coherence_finish(&(*field)->coherence);
        asdic_texture_finish(&(*field)->texture);
        for (unsigned i = 0; (*field)->scratch && i < (*field)->threads; i++) {
            free((*field)->scratch[i].is_heard);
            free((*field)->scratch[i].noise);
            free((*field)->scratch[i].sources);
            free((*field)->scratch[i].drawn);
        }
        free((*field)->scratch);
        free(*field);
        *field = NULL;
    }
}

/* -ln of the uniform variate in (0, 1) that the upper 40 BITS make, to 1e-10: the logarithm of a
 * power of two, and 2 artanh s of the rest, between sqrt(1/2) and sqrt(2). No calls and no
 * branches, here and below, so that loops become vectors. */
static inline double exponential_of(uint64_t bits) {
    const uint64_t root_half = 0x3fe6a09e667f3bcdu, bias = 64;
    uint64_t u =
        asdic_bits_of(2.0 - asdic_double_of(0x3ff0000000000000u | (bits >> 24 << 12) | 0x800u));
    uint64_t over = u - root_half + (bias << 52);
    double power = asdic_double_of(0x4330000000000000u + (over >> 52)) - 0x1p52 - (double)bias;
    double m = asdic_double_of((over & 0x000fffffffffffffu) + root_half);
    double s = (m - 1.0) / (m + 1.0), q = s * s;
    double series = 2.0 / 7.0 + q * (2.0 / 9.0 + q * (2.0 / 11.0));
    double rest = s * (2.0 + q * (2.0 / 3.0 + q * (2.0 / 5.0 + q * series)));
    return -(power * 0.693147180559945309 + rest);
}

/* Sine and cosine of X within +-pi/2, to the last bits of a float. */
static inline float sine_of(float x) {
    float q = x * x;
    float rest = -1.98412698e-4f + q * (2.75573192e-6f - q * 2.50521084e-8f);
    return x * (1.0f + q * (-1.66666667e-1f + q * (8.33333333e-3f + q * rest)));
}

static inline float cosine_of(float x) {
    float q = x * x;
    float rest =
        -1.38888889e-3f + q * (2.48015873e-5f + q * (-2.75573192e-7f + q * 2.08767570e-9f));
    return 1.0f + q * (-0.5f + q * (4.16666667e-2f + q * rest));
}

/* Complex normal variates of unit mean square from the words HIGH and LOW (Box & Muller, Ann.
 * Math. Stat. 29, 610 (1958)): 40 bits for the intensity, 24 for the phase. */
WIDEST static void make_normal(const uint32_t *restrict high, const uint32_t *restrict low,
                               float *restrict re, float *restrict im) {
    for (unsigned i = 0; i < RUN; i++) {
        double intensity = exponential_of((uint64_t)high[i] << 32 | low[i]);
        uint32_t turn = low[i] << 8;
        float x = (float)(int32_t)(turn << 1) * 7.31459e-10f; /* pi / 2 over 2^31 */
        float radius = (float)sqrt(intensity);
        radius = turn >> 31 ? -radius : radius;
        re[i] = radius * cosine_of(x);
        im[i] = radius * sine_of(x);
    }
}

WIDEST static void draw_words(stream s, uint32_t source, uint32_t first, uint32_t words[4][RUN]) {
    uint32_t cell = s.look << LOOK_SHIFT | first, purpose = RANDOM_SPECKLE + (source << 4);
    for (uint32_t i = 0; i < RUN; i++) {
        random4 r = random_draw(cell + i, s.index[0], s.index[1], purpose, s.seed[0], s.seed[1]);
        for (int k = 0; k < 4; k++) {
            words[k][i] = r.v[k];
        }
    }
}

/* A row of complex numbers: real and imaginary parts. */
typedef struct row {
    float *re, *im;
} row;

/* Draws COUNT complex numbers of SOURCE from bin FIRST on, rounded up to whole runs. */
static void draw_row(stream s, uint32_t source, size_t first, size_t count, row out) {
    uint32_t words[4][RUN];
    for (size_t i = 0; i < count; i += RUN) {
        draw_words(s, source, (uint32_t)(first + i), words);
        make_normal(words[0], words[1], out.re + i, out.im + i);
    }
}

/* Replaces COUNT numbers by the sums of STEP that begin with each; STEP - 1 more follow them. */
static void sum_steps(float *x, size_t count, size_t step) {
    double sum = 0.0;
    for (size_t i = 0; i < step - 1; i++) {
        sum += (double)x[i];
    }
    for (size_t i = 0; i < count; i++) {
        double first = (double)x[i];
        sum += (double)x[i + step - 1];
        x[i] = (float)sum;
        sum -= first;
    }
}

/* COUNT bins, rounded up to whole runs, of the white noise X through the pulse. */
WIDEST static void filter(const pulse *p, const float *restrict x, size_t count,
                          float *restrict out) {
    for (size_t at = 0; at < count; at += RUN) {
        float sum[RUN] = {0};
        for (size_t k = 0; k < p->count; k++) {
            const float *from = x + at + k * p->step, weight = p->weight[k];
            for (size_t i = 0; i < RUN; i++) {
                sum[i] += weight * from[i];
            }
        }
        memcpy(out + at, sum, sizeof sum);
    }
}

/* Draws the sources that are heard, in the block of COUNT bins that begins at FIRST. */
static void draw_sources(const asdic_speckle_field *f, const scratch *with, stream s, size_t first,
                         size_t count) {
    const pulse *p = &f->pulse;
    size_t length = noise_length(f), runs = (count + RUN - 1) / RUN * RUN;
    row white = {with->noise, with->noise + length};
    for (size_t i = 0; i < f->coherence.sources; i++) {
        if (!with->is_heard[i]) {
            continue;
        }
        row out = {with->sources + 2 * i * f->block, with->sources + (2 * i + 1) * f->block};
        if (p->count == 1) {
            draw_row(s, (uint32_t)i, p->is_one ? 0 : first, p->is_one ? 1 : count, out);
            for (size_t k = 1; p->is_one && k < runs; k++) {
                out.re[k] = out.re[0];
                out.im[k] = out.im[0];
            }
            continue;
        }
        draw_row(s, (uint32_t)i, first, runs + beyond(p), white);
        sum_steps(white.re, runs + (p->count - 1) * p->step, p->step);
        sum_steps(white.im, runs + (p->count - 1) * p->step, p->step);
        filter(p, white.re, runs, out.re);
        filter(p, white.im, runs, out.im);
    }
}

/* Adds to INTENSITY the square of a receiver's pressure: TAPS of the SOURCES, BLOCK bins each,
 * from their bin AT on, of which COUNT, at most RUN, are wanted. */
WIDEST static void hear(const float *restrict sources, size_t block,
                        const uint32_t *restrict source, const float *restrict weight, size_t taps,
                        size_t count, double *restrict intensity) {
    float re[RUN] = {0}, im[RUN] = {0};
    for (size_t k = 0; k < taps; k++) {
        const float *from = sources + 2 * block * source[k], w = weight[k];
        for (size_t i = 0; i < RUN; i++) {
            re[i] += w * from[i];
        }
        for (size_t i = 0; i < RUN; i++) {
            im[i] += w * from[block + i];
        }
    }
    for (size_t i = 0; i < count; i++) {
        intensity[i] += (double)(re[i] * re[i] + im[i] * im[i]);
    }
}

static void hear_beam(const asdic_speckle_field *f, const scratch *with, size_t beam, size_t count,
                      double *intensity) {
    const asdic_coherence *c = &f->coherence;
    size_t first = c->first[beam], taps = c->first[beam + 1] - first;
    for (size_t at = 0; at < count; at += RUN) {
        size_t left = count - at;
        hear(with->sources + at, f->block, c->source + first, c->weight + first, taps,
             left < RUN ? left : RUN, intensity + at);
    }
}

/* Turns TOTAL of COUNT bins, so far a sum over LOOKS, into intensities: times what is expected, and times
 * TEXTURE unless NULL. */
static void scale_beam(double *const *part, size_t first, size_t count, double looks,
                       const asdic_texture *texture, const double *drawn) {
    for (size_t i = first; i < first + count; i++) {
        double mean = part[ASDIC_BOTTOM][i] + part[ASDIC_SURFACE][i] + part[ASDIC_VOLUME][i];
        double fixed = part[ASDIC_OBJECT][i] + part[ASDIC_MULTIPATH][i] + part[ASDIC_NOISE][i];
        mean *= texture ? asdic_texture_of(texture, drawn[i - first]) : 1.0;
        part[ASDIC_TOTAL][i] = (mean + fixed) * part[ASDIC_TOTAL][i] / looks;
    }
}

/* A ping to which speckle is applied. */
typedef struct drawing {
    const asdic_speckle_field *field;
    asdic_ping *ping;
    stream stream;
    unsigned looks;
} drawing;

/* Notes the sources of beams FROM to TO. */
static void mark_sources(const asdic_coherence *c, size_t from, size_t to, bool *is_heard) {
    memset(is_heard, 0, c->sources);
    for (size_t k = c->first[from]; k < c->first[to]; k++) {
        is_heard[c->source[k]] = true;
    }
}

/* Draws part AT of a ping: a group of beams in a block of bins. */
static void draw_part(void *user, unsigned worker, size_t at, size_t end) {
    const drawing *d = user;
    const asdic_speckle_field *f = d->field;
    const scratch *with = &f->scratch[worker];
    const asdic_texture *texture = f->sonar.speckle == ASDIC_SPECKLE_K ? &f->texture : NULL;
    double *const *part = d->ping->intensity_lin;
    size_t beams = d->ping->beams, group = at % f->groups, first = at / f->groups * f->block;
    size_t from = beams * group / f->groups, to = beams * (group + 1) / f->groups;
    size_t left = f->bins - first, count = left < f->block ? left : f->block;
    stream s = d->stream;
    (void)end;
    mark_sources(&f->coherence, from, to, with->is_heard);
    for (size_t b = from; b < to; b++) {
        memset(part[ASDIC_TOTAL] + b * f->bins + first, 0, count * sizeof *part[ASDIC_TOTAL]);
    }
    for (s.look = 0; s.look < d->looks; s.look++) {
        draw_sources(f, with, s, first, count);
        for (size_t b = from; b < to; b++) {
            hear_beam(f, with, b, count, part[ASDIC_TOTAL] + b * f->bins + first);
        }
    }
    if (texture) {
        s.look = TEXTURE_LOOK;
        draw_sources(f, with, s, first, count);
    }
    for (size_t b = from; b < to; b++) {
        memset(with->drawn, 0, count * sizeof *with->drawn);
        if (texture) {
            hear_beam(f, with, b, count, with->drawn);
        }
        scale_beam(part, b * f->bins + first, count, d->looks, texture, with->drawn);
    }
}

void asdic_speckle_apply(asdic_speckle_field *f, double sound_speed_mps, uint64_t seed,
                         uint64_t index, asdic_ping *ping) {
    if (f) {
        drawing d = {.field = f,
                     .ping = ping,
                     .stream = {.seed = {(uint32_t)seed, (uint32_t)(seed >> 32)},
                                .index = {(uint32_t)index, (uint32_t)(index >> 32)}},
                     .looks = asdic_sonar_looks(&f->sonar, sound_speed_mps)};
        asdic_share(f->threads, blocks_of(f) * f->groups, 1, draw_part, &d);
    }
}
