#!/usr/bin/env python3
"""Reference levels over a flat bottom in water whose sound speed changes with depth.

Usage: reference_bent.py [--rays N] [CASE ...] > bent_hard.h      (needs numpy)

A fan of rays is followed by a Runge-Kutta integrator of fourth order through

    dr/dt = c cos a,  dz/dt = c sin a,  da/dt = -c'(z) cos a,  dL/dt = c

whose steps end on the planes of the profile; it knows nothing of arcs, of Snell's constant nor of
derivatives of rays. Two neighbours bound a tube of rays: the area in which it meets a boundary gives
its cross-section there; in the water it is the distance between two rays that hardly differ, across
their direction, times the horizontal distance, per steradian between them:

    S = cross-section c_s / c                      spreading of intensity, both ways the same
    dE = G s loss^2 / S^2 dA  or  dV               G: two-way pattern summed over azimuth

Energy is put into the bins that the tube crosses in a step, in proportion. A ray ends at the first
boundary. Near a caustic S is at least 1 % of the square of the range (20 dB of gain).
"""
import argparse
import math

import numpy as np

from reference_laws import SCENARIO, Water, gauss, to_db

LEAST_SPREAD = 1e-2
NEAR_RAD = 1e-7
BIN_M, BINS, BLANKING_M = 1.0, 74, 0.5

LAKE = [[0, 1521], [4, 1518], [7, 1485], [12, 1473], [30, 1473]]

# Depth and sound speed of the points, depth of the sonar, depth of the bottom.
CASES = {
    'linear_down': ([[0, 1491.4], [60, 1479.4]], 7, 12),
    'two_layers': ([[0, 1495], [8, 1495], [20, 1483]], 7, 12),
    'thermocline': ([[0, 1520], [4, 1520], [6, 1470], [30, 1470]], 3, 12),
    'upward': ([[0, 1480], [60, 1540]], 7, 12),
    'inside': ([[0, 1510], [5, 1510], [9, 1480], [30, 1480]], 7, 12),
    'below': ([[0, 1510], [3, 1510], [5, 1480], [30, 1480]], 7, 12),
    'channel': ([[0, 1500], [7, 1480], [20, 1500]], 7, 12),
    'knee': (LAKE, 4, 12),
    'foot': (LAKE, 7, 12),
}


class Profile:
    def __init__(self, points, floor_m):
        z, c = np.array(points, float).T
        self.planes = np.concatenate([[0.0], z[(z > 0) & (z < floor_m)], [floor_m]])
        self.z, self.c = z, c
        mid = (self.planes[1:] + self.planes[:-1]) / 2
        self.slope = np.array([self.gradient(m) for m in mid])
        self.base = np.interp(mid, z, c) - self.slope * mid

    def gradient(self, z_m):
        i = np.searchsorted(self.z, z_m)
        inside = 0 < i < len(self.z)
        return (self.c[i] - self.c[i - 1]) / (self.z[i] - self.z[i - 1]) if inside else 0.0


class Fan:
    """Rays as arrays: r, z, cosine and sine of the angle, length; and the layer of each."""

    def __init__(self, profile, depth_m, angle):
        self.p = profile
        n = len(angle)
        self.y = np.array([np.zeros(n), np.full(n, float(depth_m)), np.cos(angle), np.sin(angle),
                           np.zeros(n)])
        at = np.searchsorted(profile.planes, depth_m + 1e-9 * np.sign(angle)) - 1
        self.layer = np.clip(at, 0, len(profile.slope) - 1)
        self.over = np.zeros(n, bool)     # ended on a boundary
        self.time = np.zeros(n)           # when

    def derivative(self, y, layer):
        slope = self.p.slope[layer]
        c = self.p.base[layer] + slope * y[1]
        return np.array([c * y[2], c * y[3], slope * y[2] * y[3], -slope * y[2] * y[2], c])

    def rk4(self, y, layer, h):
        a = self.derivative(y, layer)
        b = self.derivative(y + 0.5 * h * a, layer)
        c = self.derivative(y + 0.5 * h * b, layer)
        d = self.derivative(y + h * c, layer)
        return y + h / 6 * (a + 2 * b + 2 * c + d)

    def step(self, h, now):
        """One step of H; rays that leave their layer stop on its plane and go on in the next."""
        left = np.where(self.over, 0.0, h)
        moving = np.flatnonzero(~self.over)
        while len(moving):
            y, layer, part = self.y[:, moving], self.layer[moving], left[moving]
            new = self.rk4(y, layer, part)
            top, bottom = self.p.planes[layer], self.p.planes[layer + 1]
            out = (new[1] < top) | (new[1] > bottom)
            stay = moving[~out]
            self.y[:, stay] = new[:, ~out]
            left[stay] = 0.0
            moving = moving[out]
            if not len(moving):
                break
            y, layer, part = y[:, out], layer[out], part[out]
            down = new[1][out] > bottom[out]
            plane = np.where(down, bottom[out], top[out])
            lo, hi = np.zeros(len(moving)), part.copy()
            for _ in range(46):
                mid = (lo + hi) / 2
                z = self.rk4(y, layer, mid)[1]
                passed = np.where(down, z > plane, z < plane)
                hi, lo = np.where(passed, mid, hi), np.where(passed, lo, mid)
            new = self.rk4(y, layer, hi)
            new[1] = plane
            self.y[:, moving] = new
            left[moving] -= hi
            layer = layer + np.where(down, 1, -1)
            ended = (layer < 0) | (layer >= len(self.p.slope))
            self.layer[moving] = np.clip(layer, 0, len(self.p.slope) - 1)
            self.over[moving[ended]] = True
            self.time[moving[ended]] = now + h - left[moving[ended]]
            left[moving[ended]] = 0.0
            moving = moving[~ended]


def share(begin, end):
    """Which bins, and which part of the way from BEGIN to END (m) lies in each of two."""
    begin = np.minimum(begin, end)
    n = np.floor(begin / BIN_M + 1e-12).astype(int)
    first = np.clip(((n + 1) * BIN_M - begin) / np.maximum(end - begin, 1e-300), 0, 1)
    return n, first


def add(levels, begin, end, energy):
    """ENERGY spread evenly over ranges BEGIN to END, within two bins."""
    lo, hi = np.minimum(begin, end), np.maximum(begin, end)
    cut = np.clip((hi - np.maximum(lo, BLANKING_M)) / np.maximum(hi - lo, 1e-300), 0, 1)
    energy, lo = energy * cut, np.maximum(lo, BLANKING_M)
    n, first = share(lo, hi)
    for bins, part in ((n, first), (n + 1, 1 - first)):
        good = (bins >= 0) & (bins < len(levels))
        np.add.at(levels, bins[good], (energy * part)[good])


def add_long(levels, begin, end, energy):
    """The same over as many bins as it takes."""
    pieces = np.maximum(1, np.ceil(np.abs(end - begin) / (0.5 * BIN_M))).astype(int)
    for k in range(pieces.max(initial=0)):
        some = pieces > k
        step = (end - begin)[some] / pieces[some]
        add(levels, begin[some] + k * step, begin[some] + (k + 1) * step,
            energy[some] / pieces[some])


def ring(water, angle):
    """Two-way pattern of both beams, level, summed over azimuth."""
    phi, weight = gauss(0.0, math.pi / 2, 160)
    total = np.zeros(len(angle))
    for p, w in zip(phi, weight):
        ux, uy, uz = np.cos(angle) * math.cos(p), np.cos(angle) * math.sin(p), np.sin(angle)
        total += 2 * w * water.beam(ux, uy, uz, 0.0) ** 2
    return total


def run(points, depth_m, floor_m, rays, dt):
    profile = Profile(points, floor_m)
    c_s = float(np.interp(depth_m, *np.array(points, float).T))
    water = Water(dict(SCENARIO))
    water.c_mps, water.wavelength_m = c_s, c_s / 1e5
    # Edges of tubes: denser about the horizontal, where far bins are; neither they nor the middles
    # of tubes are level, since on the axis of a channel such a ray would cross it without end.
    x = np.linspace(-1, 1, rays + 1)
    x[1:-1] += 0.5 / rays
    edge = math.pi / 2 * (0.15 * x + 0.85 * x**3)
    mid = (edge[1:] + edge[:-1]) / 2
    solid = np.sin(edge[1:]) - np.sin(edge[:-1])
    fan = Fan(profile, depth_m, edge)
    pairs = Fan(profile, depth_m, np.concatenate([mid - NEAR_RAD, mid + NEAR_RAD]))
    pattern = ring(water, mid)
    out = {k: np.zeros(BINS) for k in ('bottom', 'surface', 'volume')}
    range_m = BINS * BIN_M
    steps = int(math.ceil(1.08 * range_m / c_s / dt))  # the last bin takes rays from beyond
    alpha = water.alpha_db_per_km

    def loss(length):
        return 10 ** (-2 * (length - 1) * alpha / 1e4)

    def spreading():
        """S about the middle of each tube, its length and its speed at the present time."""
        low, high = np.split(pairs.y, 2, axis=1)
        dr, dz = high[0] - low[0], high[1] - low[1]
        cos, sin = high[2] + low[2], high[3] + low[3]
        width = np.abs(dz * cos - dr * sin) / np.hypot(cos, sin) / (2 * NEAR_RAD)
        c = np.interp((high[1] + low[1]) / 2, *np.array(points, float).T)
        return width * (high[0] + low[0]) / 2 / np.cos(mid) * c_s / c, (high[4] + low[4]) / 2, c

    for k in range(steps):
        now = k * dt
        fan.step(dt, now)
        pairs.step(dt, now)
        alive = ~(pairs.over[:len(mid)] | pairs.over[len(mid):])
        spread, length, c = spreading()
        d = c_s * (now + dt)
        level = c_s * dt * (c / c_s) ** 2 * loss(length) / np.maximum(
            spread, LEAST_SPREAD * d * d) * solid * pattern * water.volume_per_m
        # From the end of the step back to its middle: straight water falls as d^-2.
        level *= d * d / max((d - c_s * dt) * d, 1e-12)
        add(out['volume'], np.full(alive.sum(), c_s * now), np.full(alive.sum(), d), level[alive])
    for name, plane in (('surface', 0.0), ('bottom', floor_m)):
        y = fan.y
        a, b = slice(0, -1), slice(1, None)
        ends = fan.over & (np.abs(y[1] - plane) < 1e-6)
        pair = np.flatnonzero(ends[a] & ends[b])
        r0, r1 = y[0][a][pair], y[0][b][pair]
        t0, t1 = fan.time[a][pair], fan.time[b][pair]
        sine = np.abs((y[3][a][pair] + y[3][b][pair]) / 2)
        ground = np.abs(r1**2 - r0**2) / 2
        c_b = float(np.interp(plane, *np.array(points, float).T))
        spread = ground * sine / solid[pair] * c_s / c_b
        d = c_s * (t0 + t1) / 2
        spread = np.maximum(spread, LEAST_SPREAD * d * d)
        law = water.surface(sine) if name == 'surface' else water.bottom(sine)
        length = (y[4][a][pair] + y[4][b][pair]) / 2
        # dA = S c_b / c_s solid / sine: what stays finite at a fold.
        energy = (pattern[pair] * law * loss(length) / spread * c_b / c_s * solid[pair] / sine)
        add_long(out[name], c_s * t0, c_s * t1, energy)
    out['total'] = out['bottom'] + out['surface'] + out['volume']
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--rays', type=int, default=8000)
    parser.add_argument('--dt', type=float, default=2e-5)
    parser.add_argument('cases', nargs='*', default=list(CASES))
    args = parser.parse_args()
    for name in args.cases:
        levels = run(*CASES[name], args.rays, args.dt)
        print(f'static const double bent_{name}_db[{BINS}][4] = {{')
        for row in zip(*(to_db(levels[k]) for k in ('total', 'bottom', 'surface', 'volume'))):
            print('    {%s},' % ', '.join('NAN' if v is None else f'{v:.4f}' for v in row))
        print('};')


if __name__ == '__main__':
    main()
