/*
 * Coherent pings at the array: the sums at every element (coherent_elements), and the beams that are formed of them
 * (coherent_beams).
 */
#include "coherent.h"
#include "echo.h"

/* ---- At the elements ---- */

/* Sums of DEV_GATE_SAMPLES samples at ASDIC_WIDTH elements. */
typedef struct gate_sums {
    real re[DEV_GATE_SAMPLES], im[DEV_GATE_SAMPLES];
} gate_sums;

/* Where elements FIRST and on lie on the line. */
static real elements_at(__global const dev_coherent *c, uint first) {
    real y = R(0.0);
    LANES {
        AT(y, float) = ((float)(first + lane) - 0.5f * (float)(c->elements - 1u)) * c->spacing_m;
    }
    return y;
}

/* The samples, counted from BEGIN, that an echo at ways from NEAR to FAR reaches. */
typedef struct taps {
    int from, to;
} taps;

static taps taps_of(__global const dev_coherent *c, float near, float far, float begin) {
    float reach = PULSE_REACH * c->pulse_m, per = 1.0f / c->sample_m;
    taps t = {max((int)(ceil((near - reach) * per - 0.5f - begin)), 0),
              min((int)(floor((far + reach) * per - 0.5f - begin)), DEV_GATE_SAMPLES - 1)};
    return t;
}

/* Adds an echo X from sample 0 to sample N, if that is not beyond TO. */
static void add_tap(__global const dev_coherent *c, real x, real per, phasor echo, int n, int to,
                    gate_sums *sums) {
    if (n <= to) {
        real s = pulse_at(x - (real)((float)(n)*c->sample_m), per);
        sums->re[n] += s * echo.re;
        sums->im[n] += s * echo.im;
    }
}

/* Adds ECHO to the samples from BEGIN on. Eight a round: llvmpipe leaves all loops of a work-item, those
 * over echoes too, after 65,535 rounds. */
static void add_echo(__global const dev_coherent *c, __global const dev_echo *echo, real y,
                     float begin, gate_sums *sums) {
    real longer = element_longer(y, (real)(echo->y), (real)(echo->range_m));
#if ASDIC_WIDTH == 1
    taps t = taps_of(c, echo->way_m + 0.5f * longer, echo->way_m + 0.5f * longer, begin);
#else
    /* The way is longest at one end of the vector, and within a sagitta shortest at the other. */
    float first = 0.5f * ((float *)&longer)[0], last = 0.5f * ((float *)&longer)[ASDIC_WIDTH - 1];
    float span = (float)(ASDIC_WIDTH - 1) * c->spacing_m;
    float sagitta = span * span / (8.0f * max(echo->range_m - span, 0.1f * span));
    taps t =
        taps_of(c, echo->way_m + min(first, last) - sagitta, echo->way_m + max(first, last), begin);
#endif
    phasor turn = phasor_of(-longer * (real)(c->turns_per_m));
    real re = turn.re * echo->re - turn.im * echo->im, im = turn.re * echo->im + turn.im * echo->re;
    real per = (real)(1.0f / c->pulse_m);
    real x = R(0.5) * longer + (echo->way_m - (begin + 0.5f) * c->sample_m);
    phasor turned = {re, im};
    for (int n = t.from; n <= t.to; n += 8) {
        add_tap(c, x, per, turned, n, t.to, sums);
        add_tap(c, x, per, turned, n + 1, t.to, sums);
        add_tap(c, x, per, turned, n + 2, t.to, sums);
        add_tap(c, x, per, turned, n + 3, t.to, sums);
        add_tap(c, x, per, turned, n + 4, t.to, sums);
        add_tap(c, x, per, turned, n + 5, t.to, sums);
        add_tap(c, x, per, turned, n + 6, t.to, sums);
        add_tap(c, x, per, turned, n + 7, t.to, sums);
    }
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
                      int begin, gate_sums *sums) {
    int reach = (int)(PULSE_REACH * c->pulse_m / c->sample_m);
    float per = c->sample_m / c->pulse_m;
    for (int n = -reach; n < DEV_GATE_SAMPLES + reach; n++) {
        phasor white = draw_noise(ping, (uint)(begin + n + reach), first);
        for (int k = max(n - reach, 0); k <= min(n + reach, DEV_GATE_SAMPLES - 1); k++) {
            real s = pulse_at((real)((float)(k - n)), (real)(per)) * c->noise;
            sums->re[k] += s * white.re;
            sums->im[k] += s * white.im;
        }
    }
}

/* One work-item per gate and ASDIC_WIDTH elements. PRESSURE [element][sample]. */
__kernel void coherent_elements(__global const dev_ping *ping, __global const dev_coherent *c,
                                __global const dev_echo *sorted, __global const uint *first,
                                __global float2 *pressure) {
    uint groups = c->lanes / ASDIC_WIDTH, item = (uint)(get_global_id(0));
    uint gate = item / groups, element = item % groups * ASDIC_WIDTH;
    if (gate >= c->gates) {
        return;
    }
    gate_sums sums;
    for (int n = 0; n < DEV_GATE_SAMPLES; n++) {
        sums.re[n] = sums.im[n] = R(0.0);
    }
    real y = elements_at(c, element);
    uint reach = (uint)(c->margin_m / (c->sample_m * DEV_GATE_SAMPLES)) + 1u;
    uint from = gate > reach ? gate - reach : 0u, to = min(gate + reach + 1u, c->gates);
    float begin = (float)(gate * DEV_GATE_SAMPLES);
    float near = begin * c->sample_m - c->margin_m;
    float far = (begin + DEV_GATE_SAMPLES) * c->sample_m + c->margin_m;
    for (uint at = first[from]; at < first[to]; at++) {
        if (sorted[at].way_m > near && sorted[at].way_m < far) {
            add_echo(c, sorted + at, y, begin, &sums);
        }
    }
    if (c->noise > 0.0f) {
        add_noise(ping, c, element, (int)(gate * DEV_GATE_SAMPLES), &sums);
    }
    for (uint n = 0; n < DEV_GATE_SAMPLES; n++) {
        uint sample = gate * DEV_GATE_SAMPLES + n;
        LANES {
            if (sample < c->samples && element + lane < c->elements) {
                pressure[(size_t)(element + lane) * c->samples + sample] =
                    (float2)(AT(sums.re[n], float), AT(sums.im[n], float));
            }
        }
    }
}

/* ---- Beams ---- */

/* Samples of an element between samples: the quintic through six neighbours (Lagrange), which leaves 1 % of a
 * pulse's energy out at worst. AT counts samples. */
static phasor between(__global const float2 *row, uint samples, real at) {
    real base = floor(at), f = at - base;
    real a = f + R(2.0), b = f + R(1.0), d = f - R(1.0), e = f - R(2.0), g = f - R(3.0);
    real weight[6] = {b * f * d * e * g * R(-0.00833333333), a * f * d * e * g * R(0.0416666667),
                      a * b * d * e * g * R(-0.0833333333),  a * b * f * e * g * R(0.0833333333),
                      a * b * f * d * g * R(-0.0416666667),  a * b * f * d * e * R(0.00833333333)};
    phasor out = {R(0.0), R(0.0)};
    for (int k = 0; k < 6; k++) {
        phasor p;
        LANES {
            int sample = (int)(AT(base, float)) + k - 2;
            float2 v = sample >= 0 && sample < (int)(samples) ? row[sample] : (float2)(0.0f);
            AT(p.re, float) = v.x;
            AT(p.im, float) = v.y;
        }
        out.re += weight[k] * p.re;
        out.im += weight[k] * p.im;
    }
    return out;
}

/* One work-item per beam and ASDIC_WIDTH looks. STEER: by beam, the direction cosine along the line; then
 * the elements' weights. Every look is focused at its range. */
__kernel void coherent_beams(__global const dev_coherent *c, __global const float *steer,
                             __global const float2 *pressure, __global float2 *out) {
    uint groups = (c->looks + ASDIC_WIDTH - 1u) / ASDIC_WIDTH, item = (uint)(get_global_id(0));
    uint beam = item / groups, first = item % groups * ASDIC_WIDTH;
    if (beam >= c->beams) {
        return;
    }
    real look = R(0.5);
    LANES {
        AT(look, float) += (float)(first + lane);
    }
    real range = look * c->look_m, re = R(0.0), im = R(0.0);
    for (uint e = 0; e < c->elements; e++) {
        real y = (real)(((float)(e)-0.5f * (float)(c->elements - 1u)) * c->spacing_m);
        real longer = element_longer(y, range * steer[beam], range);
        phasor turn = phasor_of(longer * (real)(c->turns_per_m));
        real at = (range + R(0.5) * longer) / (real)(c->sample_m) - R(0.5);
        phasor p = between(pressure + (size_t)(e)*c->samples, c->samples, at);
        real weight = (real)(steer[c->beams + e]);
        re += weight * (turn.re * p.re - turn.im * p.im);
        im += weight * (turn.re * p.im + turn.im * p.re);
    }
    LANES {
        if (first + lane < c->looks) {
            out[(size_t)(beam)*c->looks + first + lane] = (float2)(AT(re, float), AT(im, float));
        }
    }
}
