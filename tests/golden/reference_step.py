#!/usr/bin/env python3
"""Reference levels for a rise of the sea floor: a vertical wall with a plateau behind it.

Usage: reference_step.py [--montecarlo RAYS] [-o step_expected.json]      (needs numpy)

The expected energy of each bin and beam is integrated over what the sonar sees: the lower plane
up to the wall, the wall, the plateau, the sea surface, and the water in front of all of them. On a
ring of constant slant range d the area element is exact:

    horizontal plane at height h      dA = d dd dphi              r = sqrt(d^2 - h^2)
    wall x = X                        dA = d dd dpsi              rho = sqrt(d^2 - X^2)

so that every integral is one over range and one over an angle with known limits (energy =
loss x beam_t x beam_r x s(grazing) x dA; volume = s_V x loss x beams x d^2 dd dOmega). All surfaces
follow the SEARAY bottom law. Direct echoes only, no noise. The error is estimated by repeating
everything with 1.5 times the nodes; --montecarlo checks the visibility rules with random rays.
"""
import argparse
import math

import numpy as np

from reference_laws import SCENARIO, Water, gauss, panels, to_db, write_json

WALL_X_M = 35.0
RISE_M = 2.0
BEAMS = {'forward': 0.0, 'down': 20.0, 'up': -20.0}  # the receiver's pitch; the transmitter's is 0
COMPONENTS = ('bottom', 'surface', 'volume', 'object')


class Step:
    def __init__(self, par, beam_pitch_deg, rise_m, nodes):
        self.water = Water(par)
        self.h, self.hd = par['altitude_m'], par['depth_m']
        self.top = self.h - rise_m  # height of the sonar above the plateau
        self.rise = rise_m > 0
        self.pitch = math.radians(beam_pitch_deg)
        self.nodes = nodes
        tilt = abs(math.sin(math.pi / 2 - abs(self.pitch)))
        self.breaks = [self.h, self.hd, self.h / tilt, self.hd / tilt,
                       self.hd / self.water.surface_cap_sine()]
        if self.rise:
            self.breaks += [WALL_X_M, math.hypot(WALL_X_M, self.top),
                            math.hypot(WALL_X_M, self.h)]

    def front_limit(self, sin_e, cos_e):
        """Largest azimuth in front of both faces: cos(phi) > -tan(pitch) tan(e)."""
        bound = -math.tan(self.pitch) * sin_e / np.maximum(cos_e, 1e-300)
        return np.arccos(np.clip(bound, 0.0, 1.0))

    def gain(self, ux, uy, uz):
        return self.water.beam(ux, uy, uz, 0.0) * self.water.beam(ux, uy, uz, self.pitch)

    def ring(self, sin_e, phi_lo, phi_hi):
        """2 x the integral of both beams over azimuth, at sine of elevation SIN_E (down +)."""
        sin_e = np.asarray(sin_e, float)
        cos_e = np.sqrt(np.maximum(1 - sin_e**2, 0.0))
        hi = np.minimum(phi_hi, self.front_limit(sin_e, cos_e))
        lo = np.minimum(phi_lo, hi)
        total = 0.0
        for k in range(8):  # panels resolve the side lobes
            a, b = lo + (hi - lo) * k / 8, lo + (hi - lo) * (k + 1) / 8
            phi, w = gauss(a, b, self.nodes)
            s, c = sin_e[..., None], cos_e[..., None]
            total = total + (w * self.gain(c * np.cos(phi), c * np.sin(phi), s)).sum(-1)
        return 2 * total

    def wall_azimuth(self, radius):
        """Azimuth beyond which a circle of RADIUS is short of the wall."""
        if not self.rise:
            return np.zeros_like(radius)
        return np.arccos(np.minimum(WALL_X_M / np.maximum(radius, 1e-300), 1.0))

    def plane(self, d, height, law, phi_lo, phi_hi, down):
        keep = d > height
        sine = np.where(keep, height / d, 1.0)
        energy = d * self.water.two_way(d) * law(sine) * self.ring(down * sine, phi_lo, phi_hi)
        return np.where(keep, energy, 0.0)

    def bottom(self, d):
        azimuth = self.wall_azimuth(np.sqrt(np.maximum(d**2 - self.h**2, 0.0)))
        return self.plane(d, self.h, self.water.bottom, azimuth, math.pi / 2, +1)

    def surface(self, d):
        return self.plane(d, self.hd, self.water.surface, 0.0, math.pi / 2, -1)

    def plateau(self, d):
        azimuth = self.wall_azimuth(np.sqrt(np.maximum(d**2 - self.top**2, 0.0)))
        return self.plane(d, self.top, self.water.bottom, 0.0, azimuth, +1)

    def wall(self, d):
        """The wall between plateau and lower plane, in polar coordinates about its foot point
        ahead of the sonar: z = rho cos(psi) lies between the two heights."""
        rho = np.sqrt(np.maximum(d**2 - WALL_X_M**2, 1e-300))
        lo = np.arccos(np.minimum(self.h / rho, 1.0))
        hi = np.arccos(np.minimum(self.top / rho, 1.0))
        total = 0.0
        for k in range(4):
            psi, w = gauss(lo + (hi - lo) * k / 4, lo + (hi - lo) * (k + 1) / 4, self.nodes)
            dd, r = d[:, None], rho[:, None]
            gain = self.gain(WALL_X_M / dd + 0 * psi, r * np.sin(psi) / dd, r * np.cos(psi) / dd)
            total = total + (w * gain).sum(-1)
        return 2 * d * self.water.two_way(d) * self.water.bottom(WALL_X_M / d) * total

    def solid_angle(self, d):
        """Both beams over the directions whose first hit lies beyond range D."""
        up = -math.asin(min(self.hd / d, 1.0))
        top = math.asin(min(self.top / d, 1.0))
        down = math.asin(min(self.h / d, 1.0))
        limit = math.pi / 2 - abs(self.pitch)
        total = 0.0
        for lo, hi, shadowed in ((up, top, False), (top, down, True)):
            cuts = [lo] + [x for x in (-limit, 0.0, limit) if lo < x < hi] + [hi]
            for a, b in zip(cuts, cuts[1:]):
                # Square-root limits of the azimuth sit at +-limit: smooth both ends.
                t, w = gauss(0.0, 1.0, 3 * self.nodes)
                e = a + (b - a) * t**2 * (3 - 2 * t)
                w = w * (b - a) * 6 * t * (1 - t) * np.cos(e)
                azimuth = self.wall_azimuth(d * np.cos(e)) if shadowed and self.rise else 0.0
                total += (w * self.ring(np.sin(e), azimuth, math.pi / 2)).sum()
        return total

    def volume(self, d):
        omega = np.array([self.solid_angle(x) for x in d])
        return d**2 * self.water.two_way(d) * self.water.volume_per_m * omega

    def bins(self):
        par = self.water.par
        width = par['bin_length_m']
        count = int(self.water.d_max_m / width)  # whole bins
        smooth = Step(par, math.degrees(self.pitch), self.h - self.top, self.nodes // 2)
        result = {name: np.zeros(count) for name in COMPONENTS}
        for i in range(count):
            lo, hi = max(i * width, par['blanking_m']), (i + 1) * width
            if hi <= lo:
                continue
            d, w = panels(lo, hi, self.breaks, self.nodes)
            result['bottom'][i] = (w * self.bottom(d)).sum()
            result['surface'][i] = (w * self.surface(d)).sum()
            if self.rise and hi > WALL_X_M:
                keep = np.where(d > WALL_X_M, w, 0.0)
                result['object'][i] = (keep * (self.plateau(d) + self.wall(d))).sum()
            d, w = panels(lo, hi, self.breaks, 6)
            result['volume'][i] = (w * smooth.volume(d)).sum()
        return result


def first_hit(step, u):
    """Range, component and sine of grazing of each direction U (3, n), for the Monte Carlo."""
    ux, uy, uz = u
    with np.errstate(divide='ignore', invalid='ignore'):
        t_low = np.where(uz > 0, step.h / uz, np.inf)
        t_top = np.where(uz > 0, step.top / uz, np.inf)
        t_sea = np.where(uz < 0, step.hd / -uz, np.inf)
        t_wall = np.where(ux > 0, WALL_X_M / ux, np.inf) if step.rise else np.full_like(ux, np.inf)
    z_wall = t_wall * uz
    hits_wall = (z_wall >= step.top) & (z_wall <= step.h)
    over = step.rise & (uz > 0) & (np.where(uz > 0, t_top, 0.0) * ux >= WALL_X_M)
    t = np.where(hits_wall, t_wall, np.where(over, t_top, np.minimum(t_low, t_sea)))
    sine = np.where(hits_wall, ux, np.abs(uz))
    kind = np.where(hits_wall | over, 3, np.where(uz < 0, 1, 0))
    return t, kind, sine


def montecarlo(step, rays, seed):
    """Total energy per bin and its standard error, from random rays."""
    rng = np.random.default_rng(seed)
    width = step.water.par['bin_length_m']
    count = int(step.water.d_max_m / width)
    # Mixture: front half sphere, and a flat slab of elevations where the far bins live.
    half = rays // 2
    sin_e = np.concatenate([rng.uniform(-1, 1, half), rng.uniform(-0.3, 0.3, rays - half)])
    phi = rng.uniform(-math.pi / 2, math.pi / 2, rays)
    density = 0.5 / (2 * math.pi) + np.where(np.abs(sin_e) < 0.3, 0.5 / (0.6 * math.pi), 0.0)
    cos_e = np.sqrt(1 - sin_e**2)
    u = (cos_e * np.cos(phi), cos_e * np.sin(phi), sin_e)
    t, kind, sine = first_hit(step, u)
    t = np.minimum(t, 1e4)
    water = step.water
    law = np.where(kind == 1, water.surface(sine), water.bottom(sine))
    energy = step.gain(*u) * water.two_way(t) * law * t**2 / sine / density / rays
    index = np.minimum((t / width).astype(int), count)
    total = np.bincount(index, energy, count + 1)[:count]
    square = np.bincount(index, energy**2, count + 1)[:count]
    return total, np.sqrt(square)


def case(par, rise_m, rays):
    document = {'parameters': dict(par, rise_m=rise_m, wall_x_m=WALL_X_M if rise_m else None),
                'beams': {}}
    worst = 0.0
    for name, pitch in BEAMS.items():
        fine = Step(par, pitch, rise_m, 36)
        value = fine.bins()
        coarse = Step(par, pitch, rise_m, 24).bins()
        total = sum(value.values())
        for i in np.nonzero(total)[0]:
            worst = max(worst, abs(sum(coarse.values())[i] / total[i] - 1))
        beam = {f'{part}_db': to_db(value[part]) for part in COMPONENTS}
        document['beams'][name] = dict(pitch_deg=pitch, **beam, total_db=to_db(total))
        if rays:
            estimate, error = montecarlo(fine, rays, 1)
            surfaces = total - value['volume']
            used = (error > 0) & (error < 0.2 * surfaces)
            z = (estimate[used] - surfaces[used]) / error[used]
            print(f'{name}: {used.sum()} bins, chi^2 per bin {np.mean(z**2):.2f}, '
                  f'worst {np.abs(z).max():.1f} standard errors')
    water = Water(par)
    document['derived'] = dict(sound_speed_mps=water.c_mps, wavelength_m=water.wavelength_m,
                               alpha_db_per_km=water.alpha_db_per_km, d_max_m=water.d_max_m)
    document['rel_err_max'] = float(f'{worst:.2g}')
    print(f'largest difference between the two quadratures: {worst:.2g}')
    return document


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('--montecarlo', type=int, default=0, metavar='RAYS')
    parser.add_argument('-o', default='step_expected.json')
    args = parser.parse_args()
    lam = Water(SCENARIO).c_mps / 450e3
    bench = dict(SCENARIO, frequency_khz=450.0, length_h_m=10 * lam, length_v_m=5 * lam)
    write_json(args.o, {
        'about': 'Expected levels per range bin over a rise of the sea floor (a wall at 35 m, 2 m '
                 'high, plateau behind), dB re 1 uPa at SL 0, direct echoes only, no noise; '
                 'written by reference_step.py. Bin i covers [i, i+1) x bin_length_m; an empty '
                 'bin is null. rel_err_max bounds the relative quadrature error of the totals.',
        'flat': case(SCENARIO, 0.0, args.montecarlo),
        'scenario2': case(SCENARIO, RISE_M, args.montecarlo),
        'bench_flat': case(bench, 0.0, args.montecarlo),
        'bench_step': case(bench, RISE_M, args.montecarlo)})


if __name__ == '__main__':
    main()
