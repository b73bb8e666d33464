/* Coherent pings at the array: the sums at every element (coherent_elements), and the beams that
 * are formed of them (coherent_beams). */
#include "coherent.h"
#include "echo.h"

/* ---- At the elements ---- */

/* Samples that a work-item sums. On a GPU few, that stay in registers: every index into them is
 * known to the compiler. Elsewhere many, as a work-item looks at all echoes that reach into its
 * samples. */
#define OWN_SAMPLES (DEV_GATE_SAMPLES * DEV_OWN_GATES(ASDIC_WIDTH))

/* What bounds of samples have to spare, in samples, for rounding. */
#define SPARE 0.01f

/* Loops over own samples from FROM on, short of TO. */
#if ASDIC_WIDTH == 1
#define EVERY_SAMPLE _Pragma("unroll")
#define FIRST(from) 0
#define LAST(to) OWN_SAMPLES
#else
#define EVERY_SAMPLE
#define FIRST(from) (from)
#define LAST(to) (to)
#endif

/* Sums at ASDIC_WIDTH elements. */
typedef struct own_sums {
    real re[OWN_SAMPLES], im[OWN_SAMPLES];
} own_sums;

/* What echoes are added with. */
typedef struct listener {
    real y;        /* of the elements, along the line, m */
    float begin_m; /* where the first own sample is */
    float lead_m;  /* from where an echo reaches to the mean of the ways to both ends */
    float step;    /* from sample to sample, in lengths of the pulse */
    float turns_per_m, pulses_per_m, samples_per_m, sample_m;
    int begin; /* the first own sample */
    int taps;  /* samples that an echo reaches, at most */
} listener;

/* Where elements FIRST and on lie on the line. */
static real elements_at(__global const dev_coherent *c, uint first) {
    real y = R(0.0);
    LANES {
        AT(y, float) = ((float)(first + lane) - 0.5f * (float)(c->elements - 1u)) * c->spacing_m;
    }
    return y;
}

/* From one element of a vector to another the way changes by their distance at most. With what it
 * is at both ends that bounds it in between. */
static listener listener_of(__global const dev_coherent *c, uint element, uint begin) {
    listener l;
    float span = (float)(ASDIC_WIDTH - 1) * c->spacing_m, reach = PULSE_REACH * c->pulse_m;
    l.y = elements_at(c, element);
    l.begin_m = ((float)(begin) + 0.5f) * c->sample_m;
    l.lead_m = reach + 0.25f * span + SPARE * c->sample_m;
    l.step = c->sample_m / c->pulse_m;
    l.sample_m = c->sample_m;
    l.begin = (int)(begin);
    l.turns_per_m = c->turns_per_m;
    l.pulses_per_m = 1.0f / c->pulse_m;
    l.samples_per_m = 1.0f / c->sample_m;
    l.taps = (int)((2.0f * reach + 0.5f * span) * l.samples_per_m + 2.0f * SPARE) + 1;
    return l;
}

/* An echo as elements hear it, X behind sample NEAREST, and the samples that it reaches: FROM on and short of TO. */
typedef struct arrival {
    phasor echo;
    real x;
    float rise;
    int nearest, from, to;
} arrival;

/* Adds an echo to sample N. */
static void add_tap(const listener *l, const arrival *a, int n, own_sums *sums) {
    if (n >= a->from && n < a->to) {
        real x = a->x - (real)((float)(n - a->nearest) * l->step), s = pulse_at(x, R(1.0));
        sums->re[n] = r_fma(s, a->echo.re, sums->re[n]);
        sums->im[n] = r_fma(s, a->echo.im, sums->im[n]);
        if (a->rise != 0.0f) {
            real slope = (real)(a->rise) * pulse_slope(x);
            sums->re[n] = r_fma(-slope, a->echo.im, sums->re[n]);
            sums->im[n] = r_fma(slope, a->echo.re, sums->im[n]);
        }
    }
}

/* Adds ECHO to the samples that it reaches: as many for every echo, which is quicker than no more
 * than needed. */
static void add_echo(const listener *l, __global const dev_echo *echo, own_sums *sums) {
    real longer = element_longer(l->y, (real)(echo->y), (real)(echo->range_m));
    float ends = ((float *)&longer)[0] + ((float *)&longer)[ASDIC_WIDTH - 1];
    float way = echo->way_m - l->begin_m;
    float before = (way + 0.25f * ends - l->lead_m) * l->samples_per_m;
    if (before < (float)(-1 - l->taps) || before > (float)(OWN_SAMPLES)) {
        return;
    }
    int from = (int)(before + 1024.0f) - 1023; /* truncation goes down */
    int to = min(from + l->taps, OWN_SAMPLES);
    from = max(from, 0);
    /* From the sample nearest to the echo, whichever work-item asks: the same bits for all. */
    int nearest = (int)(echo->way_m * l->samples_per_m);
    float rest = fused(-((float)(nearest) + 0.5f), l->sample_m, echo->way_m);
    nearest -= l->begin;
    phasor turn = phasor_of(-longer * (real)(l->turns_per_m));
    real size = r_fma(l->y, r_fma(l->y, (real)(echo->bend), (real)(echo->tilt)), R(1.0));
    real re = size * (turn.re * echo->re - turn.im * echo->im);
    real im = size * (turn.re * echo->im + turn.im * echo->re);
    real x = (R(0.5) * longer + rest) * (real)(l->pulses_per_m);
    arrival a = {{re, im}, x, echo->rise, nearest, from, to};
#if ASDIC_WIDTH == 1
    /* No loop: llvmpipe leaves all loops of a work-item, that over echoes too, after 65,535 rounds. */
#define FOUR_TAPS(n)                                                                               \
    add_tap(l, &a, n, sums);                                                                       \
    add_tap(l, &a, (n) + 1, sums);                                                                 \
    add_tap(l, &a, (n) + 2, sums);                                                                 \
    add_tap(l, &a, (n) + 3, sums);
    FOUR_TAPS(0)
    FOUR_TAPS(4)
    FOUR_TAPS(8)
    FOUR_TAPS(12)
#else
    for (int n = from; n < to; n++) {
        add_tap(l, &a, n, sums);
    }
#endif
}

/* Noise of a sample at elements FIRST and on, before it is filtered. */
static phasor draw_noise(__global const dev_ping *ping, uint sample, uint first) {
    natural element = (natural)(0u);
    LANES {
        AT(element, uint) = first + lane;
    }
    /* A stream of its own for each ping: it takes the place of a purpose's upper bits. */
    random4 draw = random_draw(element, sample, ping->ping[0], RANDOM_ELEMENT + 8u * ping->ping[1],
                               ping->seed[0], ping->seed[1]);
    return gaussian_of(draw.v[0], draw.v[1]);
}

/* Noise in the pulse's band: white noise through the pulse. */
static void add_noise(__global const dev_ping *ping, __global const dev_coherent *c, uint first,
                      uint begin, own_sums *sums) {
    int reach = (int)(PULSE_REACH * c->pulse_m / c->sample_m);
    float per = c->sample_m / c->pulse_m;
    for (int n = -reach; n < OWN_SAMPLES + reach; n++) {
        phasor white = draw_noise(ping, (uint)((int)(begin) + n + reach), first);
        int from = max(n - reach, 0), to = min(n + reach + 1, OWN_SAMPLES);
        EVERY_SAMPLE
        for (int k = FIRST(from); k < LAST(to); k++) {
            if (k >= from && k < to) {
                real s = pulse_at((real)((float)(k - n)), (real)(per)) * c->noise;
                sums->re[k] += s * white.re;
                sums->im[k] += s * white.im;
            }
        }
    }
}

/* One work-item per DEV_OWN_GATES gates and ASDIC_WIDTH elements. PRESSURE [sample][re,
 * im][element]. */
__kernel void coherent_elements(__global const dev_ping *ping, __global const dev_coherent *c,
                                __global const dev_echo *sorted, __global const uint *first,
                                __global real *pressure) {
    uint groups = c->lanes / ASDIC_WIDTH, item = (uint)(get_global_id(0)), group = item % groups;
    uint gate = item / groups * DEV_OWN_GATES(ASDIC_WIDTH);
    if (gate >= c->gates) {
        return;
    }
    own_sums sums;
    EVERY_SAMPLE
    for (int n = 0; n < OWN_SAMPLES; n++) {
        sums.re[n] = sums.im[n] = R(0.0);
    }
    uint begin = gate * DEV_GATE_SAMPLES;
    listener l = listener_of(c, group * ASDIC_WIDTH, begin);
    uint reach = (uint)(c->margin_m / (c->sample_m * DEV_GATE_SAMPLES)) + 1u;
    uint from = gate > reach ? gate - reach : 0u;
    uint to = min(gate + DEV_OWN_GATES(ASDIC_WIDTH) + reach, c->gates);
    for (uint at = first[from]; at < first[to]; at++) {
        add_echo(&l, sorted + at, &sums);
    }
    EVERY_SAMPLE
    for (uint n = 0; n < OWN_SAMPLES; n++) {
        if (begin + n < c->deaf) {
            sums.re[n] = sums.im[n] = R(0.0);
        }
    }
    if (c->noise > 0.0f) {
        add_noise(ping, c, group * ASDIC_WIDTH, begin, &sums);
    }
    EVERY_SAMPLE
    for (uint n = 0; n < OWN_SAMPLES; n++) {
        if (begin + n < c->samples) {
            __global real *row = pressure + (size_t)(begin + n) * 2u * groups + group;
            row[0] = sums.re[n];
            row[groups] = sums.im[n];
        }
    }
}

/* ---- Beams ---- */

/* Samples that a beam takes in on either side of a time between samples. */
#define NEIGHBOURS 3.0f

/* The weight of a sample X samples away: least squares over pulses of eight samples, wherever they
 * lie and are asked for. A beam errs by -33 dB of a pulse's amplitude at most, on its edges, and by
 * -45 dB r.m.s. over the pulse; the looks at an echo add up to its energy within 0.06 dB. A
 * constant is kept within 2e-4. */
static real between(real x) {
    real v = r_max(r_fma(x * x, R(-0.111111111), R(1.0)), R(0.0));
    real h = r_fma(v, R(25.73856), R(-48.17445));
    h = r_fma(v, h, R(33.3339));
    h = r_fma(v, h, R(-11.68097));
    h = r_fma(v, h, R(1.476785));
    h = r_fma(v, h, R(0.2997759));
    return v * v * h;
}

/* The pressures at elements, delayed and turned towards a beam: the sum over a vector of elements.
 * */
static phasor listen(__global const dev_coherent *c, __global const real *pressure, uint group,
                     float range, float along) {
    uint groups = c->lanes / ASDIC_WIDTH;
    float samples_per_m = 1.0f / c->sample_m, span = (float)(ASDIC_WIDTH - 1) * c->spacing_m;
    real longer =
        element_longer(elements_at(c, group * ASDIC_WIDTH), (real)(range * along), (real)(range));
    float ends = ((float *)&longer)[0] + ((float *)&longer)[ASDIC_WIDTH - 1];
    float at = range * samples_per_m - 0.5f;
    int from =
        (int)(at + 0.25f * (ends - span) * samples_per_m - NEIGHBOURS - SPARE + 1024.0f) - 1023;
    int to = min(from + (int)(2.0f * (NEIGHBOURS + SPARE) + 0.5f * span * samples_per_m) + 1,
                 (int)(c->samples));
    from = max(from, 0);
    real x = longer * (real)(0.5f * samples_per_m);
    phasor sum = {R(0.0), R(0.0)};
    for (int n = from; n < to; n++) {
        __global const real *row = pressure + (size_t)(n)*2u * groups + group;
        real h = between(x + (real)(at - (float)(n)));
        sum.re = r_fma(h, row[0], sum.re);
        sum.im = r_fma(h, row[groups], sum.im);
    }
    phasor turn = phasor_of(longer * (real)(c->turns_per_m)), out;
    out.re = turn.re * sum.re - turn.im * sum.im;
    out.im = turn.re * sum.im + turn.im * sum.re;
    return out;
}

/* A look is eight sums, each of every eighth element: the same on every device. */
#define PARTS (8 / ASDIC_WIDTH)

/* One work-item per beam and ASDIC_WIDTH looks. WEIGHTS of elements, 0 of those that are not there;
 * STEER, the direction cosine of beams along the line. Every look is focused at its range. */
__kernel void coherent_beams(__global const dev_coherent *c, __global const real *weights,
                             __global const float *steer, __global const real *pressure,
                             __global float2 *out) {
    uint item = (uint)(get_global_id(0)), beam = item % c->beams, groups = c->lanes / ASDIC_WIDTH;
    uint begin = item / c->beams * ASDIC_WIDTH, end = min(begin + ASDIC_WIDTH, c->formed);
    for (uint look = begin; look < end; look++) {
        phasor sums[PARTS];
        _Pragma("unroll") for (uint part = 0; part < PARTS; part++) {
            sums[part].re = sums[part].im = R(0.0);
        }
        for (uint first = 0; first < groups; first += PARTS) {
            _Pragma("unroll") for (uint part = 0; part < PARTS; part++) {
                uint group = min(first + part, groups - 1u);
                real weight = first + part < groups ? weights[group] : R(0.0);
                phasor p =
                    listen(c, pressure, group, ((float)(look) + 0.5f) * c->look_m, steer[beam]);
                sums[part].re = r_fma(weight, p.re, sums[part].re);
                sums[part].im = r_fma(weight, p.im, sums[part].im);
            }
        }
        float2 all = (float2)(0.0f);
        _Pragma("unroll") for (uint part = 0; part < PARTS; part++) {
            LANES {
                all += (float2)(AT(sums[part].re, float), AT(sums[part].im, float));
            }
        }
        out[(size_t)(beam)*c->looks + look] = all;
    }
}
