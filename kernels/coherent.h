/*
 * Coherent pings: the pressure at the elements of an array, from scatterers that stay where they are in the
 * world. What host and device share: the structs, and the formulas of phase, pulse and chance.
 *
 * A scatterer at P with the amplitude a (its square is the energy E of an echo at an element; its sign, that
 * of both faces' lobes) and the circular Gaussian factor z gives element e the pressure, as baseband,
 *
 *     p_e(r) = a z s(r - (t + r_e) / 2) exp(-2 pi i (t + r_e) / lambda),
 *
 * t the way from the transmitter, at the array's centre, to P and r_e that from P to the element; r is the
 * range of a sample, c / 2 times its time (D. C. Brown, S. F. Johnson, D. R. Olson, "A point-based
 * scattering model for the incoherent component of the scattered field", J. Acoust. Soc. Am. 141, EL210
 * (2017)). Phases are counted in turns.
 *
 * What smooth pieces send goes with the frequency, as areas do: physical optics has f / c of an area. To first order
 * a (1 + g (f - f0) / f0), over the pulse's band
 *
 *     s(x) + i g lambda / (4 pi) s'(x),  x = (t + r_e) / 2 - r,
 *
 * as f - f0 is -i c / (4 pi) times the derivative by r; g = 1 of an area whose phase is even.
 */
#ifndef ASDIC_KERNEL_COHERENT_H
#define ASDIC_KERNEL_COHERENT_H

#include "random.h"
#include "types.h"

/* A patch has at most this many scatterers. */
#define DEV_PATCH_SCATTERERS 64
/* Samples of a gate, by which scatterers are sorted; gates that a work-item sums. */
#define DEV_GATE_SAMPLES 16
#define DEV_OWN_GATES(width) ((width) > 1 ? 16 : 1)
/* The gate of what is not heard. */
#define NO_GATE 0xffffffffu
/* Kinds of scatterers beside DEV_KIND_*. */
#define DEV_KIND_POINT 4
#define DEV_KIND_WATER 5
/* How a piece of surface returns: by its law, by physical optics of its area, or of the area that it is an edge of. */
#define DEV_FORM_ROUGH 0
#define DEV_FORM_FACE 1
#define DEV_FORM_EDGE 2

/* A piece of surface, a piece of a shell of water, or a point, with COUNT scatterers. */
typedef struct dev_patch {
    /* Scene frame. Of a point: corner, and in edge1 what single precision leaves of it. Of a shell of water: by range, m, and by
     * the azimuth about the transmitter, rad, corner where it begins and edge1 how far it goes; in corner[2] how tall, in
     * wavelengths, what hears it is. Of an edge: edge1 runs along it, edge2 from its corner to the middle of the face. */
    float corner[3], edge1[3], edge2[3];
    /* Of each scatterer: m2; of an edge m; of a shell sr m; of a point its target strength, m2. */
    float share;
    dev_uint first, count;
    dev_uint triangle; /* ~0u: none */
    dev_uint kind;     /* DEV_KIND_* */
    dev_uint folded;   /* 1: the triangle between the edges; 0: the parallelogram */
    dev_uint form;     /* DEV_FORM_* */
    dev_uint key[2];   /* the same for the same piece, from ping to ping */
    dev_uint start[2]; /* where its lattice begins */
} dev_patch;           /* 80 bytes */

/* Ways there and back by each plane that mirrors: one leg by way of it, the other, both. */
#define DEV_MIRROR_WAYS 3u

/* A scatterer as elements hear it; array frame: x out of the face, y along the line, z the third. */
typedef struct dev_echo {
    float y;          /* along the line, m */
    float range_m;    /* from the array's centre */
    float way_m;      /* half the way transmitter, point, centre */
    float re, im;     /* pressure at the centre, a source of 1 uPa at 1 m */
    float tilt, bend; /* at an element y along the line it is 1 + tilt y + bend y^2 of that */
    float rise;       /* its pulse is s + i rise s', by lengths of the pulse */
} dev_echo;           /* 32 bytes */

typedef struct dev_coherent {
    float low[3];                       /* what single precision leaves of dev_ping.origin */
    float rows[9];                      /* world to array */
    float turns_per_m, turns_per_m_low; /* 1 / lambda as a sum */
    float element_h_wl, element_v_wl;
    float spacing_m;
    float sample_m;  /* from one sample to the next */
    float pulse_m;   /* length of the pulse */
    float margin_m;  /* what a scatterer's way may differ by between elements, and half the pulse */
    float look_m;    /* from one look to the next */
    float noise;     /* r.m.s. of a sample's */
    dev_uint deaf;   /* samples, the first, that hear no echo */
    float water_lin; /* s_V */
    dev_uint elements, lanes; /* LANES: elements, rounded up to whole vectors */
    dev_uint samples, gates;
    dev_uint patches, scatterers;
    dev_uint slots;        /* scatterers, once for each pair of ways there and back */
    dev_uint blocks;       /* of slots, that are sorted at the same time */
    dev_uint beams, looks; /* LOOKS: of a beam in all bins */
    dev_uint formed;       /* of these, the first, that are formed */
    dev_uint mirrored[2];  /* kinds of the planes that mirror, DEV_KIND_*; 0: none */
} dev_coherent;

/* ---- Sums of two floats, HIGH + LOW, good to some 2^-46 ---- */

typedef struct two {
    real high, low;
} two;

FORMULA two two_sum(real a, real b) {
    real s = a + b, t = s - a;
    two out = {s, (a - (s - t)) + (b - t)};
    return out;
}

/* The exact product (T. J. Dekker, "A floating-point technique for extending the available precision",
 * Numer. Math. 18, 224 (1971)); products must not be contracted. */
FORMULA two two_product(real a, real b) {
    const real split = R(4097.0);
    real ca = split * a, cb = split * b;
    real ah = ca - (ca - a), bh = cb - (cb - b), al = a - ah, bl = b - bh, p = a * b;
    two out = {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
    return out;
}

FORMULA two two_add(two a, two b) {
    two s = two_sum(a.high, b.high);
    return two_sum(s.high, s.low + (a.low + b.low));
}

FORMULA two two_multiply(two a, two b) {
    two p = two_product(a.high, b.high);
    return two_sum(p.high, p.low + (a.high * b.low + a.low * b.high));
}

/* Length of a vector. */
FORMULA two two_length(two x, two y, two z) {
    two square = two_add(two_multiply(x, x), two_add(two_multiply(y, y), two_multiply(z, z)));
    real root = sqrt(r_max(square.high, R(1e-30)));
    two back = two_product(root, root);
    real rest = ((square.high - back.high) - back.low) + square.low;
    return two_sum(root, rest / (R(2.0) * root));
}

/* Turns, less the whole ones: within +-1/2. */
FORMULA real two_turns(two length_m, two turns_per_m) {
    two turns = two_multiply(length_m, turns_per_m);
    real left = (turns.high - r_rint(turns.high)) + turns.low;
    return left - r_rint(left);
}

/* ---- Phase, pulse, chance ---- */

typedef struct phasor {
    real re, im;
} phasor;

/* exp(2 pi i TURNS), |TURNS| below 2^22. On a device the series of sine and cosine of half the angle, 2e-7. */
FORMULA phasor phasor_of(real turns) {
#ifdef __OPENCL_C_VERSION__
    real whole_turns =
        (turns + R(12582912.0)) - R(12582912.0); /* rounds: 1.5 * 2^23 has no fraction */
    real x = R_PI * (turns - whole_turns), q = x * x;
    real s = r_fma(q, R(-2.50521084e-8), R(2.75573192e-6)),
         c = r_fma(q, R(2.0876757e-9), R(-2.75573192e-7));
    s = r_fma(q, s, R(-1.98412698e-4));
    c = r_fma(q, c, R(2.48015873e-5));
    s = r_fma(q, s, R(8.33333333e-3));
    c = r_fma(q, c, R(-1.38888889e-3));
    s = r_fma(q, s, R(-0.166666667));
    c = r_fma(q, c, R(4.16666667e-2));
    s = x * r_fma(q, s, R(1.0));
    c = r_fma(q, c, R(-0.5));
    c = r_fma(q, c, R(1.0));
    phasor out = {r_fma(R(-2.0) * s, s, R(1.0)), R(2.0) * s * c};
#else
    phasor out = {r_sinpi(2.0 * turns + 0.5), r_sinpi(2.0 * turns)};
#endif
    return out;
}

FORMULA phasor phasor_times(phasor a, phasor b) {
    phasor out = {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
    return out;
}

/* R / |R| of a fluid bottom: Rayleigh's coefficient of mirror.h, in which losses make n^2 = (index (1 - i loss))^2, as time
 * goes with exp(i omega t), and the root P = p - i q. R = (m sin - P) / (m sin + P) has the phase of
 * m^2 sin^2 - |P|^2 + 2 i m q sin; towards grazing it is -1. */
FORMULA phasor fluid_reflection_phase(real sin_grazing, real density_ratio, real index,
                                      real loss_ratio) {
    real s = r_min(r_max(sin_grazing, R(1.0e-6)), R(1.0)), m = density_ratio * s,
         n2 = index * index;
    real re = n2 * (R(1.0) - loss_ratio) * (R(1.0) + loss_ratio) - (R(1.0) - s) * (R(1.0) + s);
    real im = R(2.0) * n2 * loss_ratio, size = sqrt(re * re + im * im); /* of P^2 */
    real larger = sqrt(r_max(R(0.5) * (size + r_abs(re)), R(1.0e-30)));
    real q = choose(re < R(0.0), larger, R(0.5) * im / larger);
    phasor out = {m * m - size, R(2.0) * m * q};
    real length = sqrt(out.re * out.re + out.im * out.im);
    mask nothing = length <= R(0.0);
    out.re = choose(nothing, R(1.0), out.re / r_max(length, R(1.0e-30)));
    out.im /= r_max(length, R(1.0e-30));
    return out;
}

/* What the way to an element at Y on the line is longer than that to the centre: r_e - r_0, without the
 * difference of large numbers. The scatterer is RANGE from the centre and ALONG the line. */
FORMULA real element_longer(real y, real along, real range) {
    real square = y * (y - R(2.0) * along);
    real there = sqrt(r_max(range * range + square, R(0.0)));
    return square / r_max(there + range, R(1e-6));
}

/* How far on an edge of the pulse X, in its lengths, is: 0 outside of it, 1 in its middle half. */
FORMULA real pulse_edge(real x) {
    return r_max(r_min(R(1.5) - R(2.0) * r_abs(x), R(1.0)), R(0.0));
}

/* The pulse after compression: an amplitude of 1 over its middle half, and edges of half its LENGTH each,
 * that reach a quarter beyond. Squares of two edges that overlap add up to 1, so that the integral of
 * s^2 is LENGTH and samples LENGTH apart take the whole of every echo: within 0.4 % wherever the echo is, and
 * 0.02 % on average, besides what beams lose between their samples. Of the polynomials of order 4 with level ends
 * this does it best. */
FORMULA real pulse_at(real x, real per_length) {
    real u = pulse_edge(x * per_length);
    real s = R(6.33333333) + u * (R(-8.66666667) + u * R(3.33333333));
    return u * u * s;
}

/* Its derivative by X, which is in its lengths. */
FORMULA real pulse_slope(real x) {
    real u = pulse_edge(x);
    real s = R(12.66666667) + u * (R(-26.0) + u * R(13.33333333));
    return choose(x < R(0.0), R(2.0), R(-2.0)) * u * s;
}

/* Half of what the pulse reaches over, in lengths. */
#define PULSE_REACH 0.75f

/* A circular complex Gaussian variate of unit variance from two random numbers. */
FORMULA phasor gaussian_of(natural a, natural b) {
    real size = sqrt(-log(random_uniform(a)));
    phasor turn = phasor_of(random_uniform(b));
    phasor out = {size * turn.re, size * turn.im};
    return out;
}

/* Number K < 64 of a patch, as fractions of its edges, 2^-32 each, from START on: a rank-1 lattice sequence of
 * base 2 (F. J. Hickernell, H. S. Hong, P. L'Ecuyer, C. Lemieux, SIAM J. Sci. Comput. 22, 1117 (2000)).
 * Every 2^n first numbers are a lattice that goes on in the neighbouring patch of the same START. With five
 * scatterers in a resolution cell its energy then varies by some 0.4 % (variance), where independent places make it
 * 10 %. 13 had the least of five generators that were tried, over two headings. */
FORMULA uint lattice_first(uint start, uint k) {
    uint back = (k & 1u) << 5 | (k & 2u) << 3 | (k & 4u) << 1 | (k & 8u) >> 1 | (k & 16u) >> 3 |
                (k & 32u) >> 5;
    return start + (back << 26);
}

FORMULA uint lattice_second(uint start, uint k) {
    return start + 13u * lattice_first(0u, k);
}

#endif
