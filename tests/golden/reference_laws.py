"""Formulas shared by the reference calculations: the water, the scattering laws, the beams.

Written from the published formulas, apart from the C code, so that each can check the other.
Everything is in double precision, linear energy re 1 uPa^2 at a source level of 0 dB.

Frame: the sonar at the origin looking along x, y to starboard, z DOWN; a beam's pitch is
positive downwards.
"""
import json
import math
import re

import numpy as np

# The paper's first scenario, with the values it leaves open chosen as in data/scenes.
SCENARIO = dict(frequency_khz=100.0, length_h_m=0.05, length_v_m=0.05, temperature_degc=10.0,
                salinity_ppt=35.0, ph=8.0, wind_speed_kn=10.0, particle_strength_db=-90.0,
                bottom_type=2.0, altitude_m=5.0, depth_m=7.0, max_depth_m=12.0,
                ping_rate_hz=10.0, bin_length_m=0.5, blanking_m=0.5)


def sound_speed_mps(t_degc, s_ppt, z_m):
    """Medwin 1975."""
    return (1449.2 + 4.6 * t_degc - 0.055 * t_degc**2 + 0.00029 * t_degc**3
            + (1.34 - 0.010 * t_degc) * (s_ppt - 35) + 0.016 * z_m)


def absorption_db_per_km(f_khz, t_degc, s_ppt, z_m, ph):
    """Francois & Garrison 1982, with their own sound speed; T <= 20 degC."""
    c = 1412 + 3.21 * t_degc + 1.19 * s_ppt + 0.0167 * z_m
    kelvin = t_degc + 273
    f1 = 2.8 * math.sqrt(s_ppt / 35) * 10 ** (4 - 1245 / kelvin)
    boric = 8.86 / c * 10 ** (0.78 * ph - 5) * f1 / (f1**2 + f_khz**2)
    f2 = 8.17 * 10 ** (8 - 1990 / kelvin) / (1 + 0.0018 * (s_ppt - 35))
    p2 = 1 - 1.37e-4 * z_m + 6.2e-9 * z_m**2
    sulphate = 21.44 * s_ppt / c * (1 + 0.025 * t_degc) * p2 * f2 / (f2**2 + f_khz**2)
    a3 = 4.937e-4 - 2.59e-5 * t_degc + 9.11e-7 * t_degc**2 - 1.5e-8 * t_degc**3
    p3 = 1 - 3.83e-5 * z_m + 4.9e-10 * z_m**2
    return (boric + sulphate + a3 * p3) * f_khz**2


class Water:
    """Everything about the medium and the aperture that the integrals need."""

    def __init__(self, par):
        self.par = par
        self.c_mps = sound_speed_mps(par['temperature_degc'], par['salinity_ppt'], par['depth_m'])
        self.wavelength_m = self.c_mps / (1000 * par['frequency_khz'])
        self.alpha_db_per_km = absorption_db_per_km(
            par['frequency_khz'], par['temperature_degc'], par['salinity_ppt'],
            par['max_depth_m'], par['ph'])
        self.d_max_m = self.c_mps / (2 * par['ping_rate_hz'])
        self.volume_per_m = 10 ** ((par['particle_strength_db']
                                    + 7 * math.log10(par['frequency_khz'])) / 10)

    def two_way(self, d_m):
        """Two-way loss as a factor: 40 log d + 2 (d - 1) alpha."""
        return d_m**-4.0 * 10 ** (-2 * (d_m - 1) * self.alpha_db_per_km / 1e4)

    def bottom(self, sin_grazing, bottom_type=None):
        """SEARAY bottom backscatter per unit area."""
        bt = self.par['bottom_type'] if bottom_type is None else bottom_type
        sine = np.clip(sin_grazing, 1e-12, 1.0)
        cos2 = 1 - sine**2
        gamma = 1 + 125 * np.exp(-2.64 * (bt - 1.75) ** 2 - 50 / bt * cos2 / sine**2)
        beta = gamma * (sine + 0.19) ** (bt * cos2**8)
        f = self.par['frequency_khz']
        return 3.03 * beta * f ** (3.2 - 0.8 * bt) * 10 ** (2.8 * bt - 12) + 10**-4.42

    def surface_law(self, sin_grazing):
        """Sea surface backscatter per unit area as published; diverges at the zenith."""
        wind = self.par['wind_speed_kn']
        f = self.par['frequency_khz'] + 0.1
        sine = np.clip(sin_grazing, 0.0, 1.0)
        cosine = np.sqrt(np.maximum(1 - sine**2, 1e-30))
        beta = 4 * (wind + 2) / (wind + 1) + (2.5 * f ** (-1 / 3) - 4) * cosine**0.125
        return 10**-5.05 * (1 + wind) ** 2 * f ** (wind / 150) * (sine / cosine) ** beta

    def surface_cap(self):
        """Kirchhoff value 1 / (4 pi m) at the zenith, mean-square slope m of Cox & Munk 1954."""
        return 1 / (4 * math.pi * (0.003 + 0.00512 * self.par['wind_speed_kn'] * 0.514444))

    def surface(self, sin_grazing):
        return np.minimum(self.surface_law(sin_grazing), self.surface_cap())

    def surface_cap_sine(self):
        """Sine of the grazing angle at which the cap begins to act."""
        lo, hi = 0.5, 1.0
        for _ in range(52):
            middle = (lo + hi) / 2
            lo, hi = (middle, hi) if self.surface_law(middle) < self.surface_cap() else (lo, middle)
        return hi

    def beam(self, ux, uy, uz, pitch_rad):
        """One-way power pattern of a rectangular piston; nothing behind the face."""
        cos_p, sin_p = math.cos(pitch_rad), math.sin(pitch_rad)
        vx, vz = cos_p * ux + sin_p * uz, -sin_p * ux + cos_p * uz
        amplitude = (np.sinc(self.par['length_h_m'] / self.wavelength_m * uy)
                     * np.sinc(self.par['length_v_m'] / self.wavelength_m * vz))
        return np.where(vx > 0, amplitude**2, 0.0)


def gauss(a, b, n):
    """Gauss-Legendre nodes and weights on [a, b]; a, b may be arrays (nodes in the last axis)."""
    x, w = np.polynomial.legendre.leggauss(n)
    half = (np.asarray(b) - np.asarray(a)) / 2
    return np.asarray(a)[..., None] + half[..., None] * (x + 1), half[..., None] * w


def panels(lo, hi, breaks, n):
    """Nodes and weights on [lo, hi] cut at BREAKS; d = a + (b - a) t^2 in each panel removes the
    square-root behaviour that geometry shows just beyond a break."""
    cuts = [lo] + [b for b in sorted(breaks) if lo < b < hi] + [hi]
    nodes, weights = [], []
    for a, b in zip(cuts, cuts[1:]):
        t, w = gauss(0.0, 1.0, n)
        nodes.append(a + (b - a) * t**2)
        weights.append((b - a) * 2 * t * w)
    return np.concatenate(nodes), np.concatenate(weights)


def to_db(values):
    """Levels for JSON: dB with 6 decimals, null where there is no energy."""
    return [round(10 * math.log10(v), 6) if v > 0 else None for v in values]


def write_json(path, document):
    """Indented, but each list of numbers on one line."""
    text = re.sub(r'\[[^][{}]*\]', lambda m: re.sub(r'\s+', ' ', m.group()),
                  json.dumps(document, indent=1))
    with open(path, 'w', encoding='ascii') as out:
        out.write(text + '\n')
