#!/usr/bin/env python3
"""Reference levels for a sphere hanging on the beam axis over a flat bottom.

Usage: reference_sphere.py [-o sphere_expected.json]      (needs numpy)

The sphere's near side is cut into rings about the axis. With D the distance of its centre, a its
radius and d the slant range, a ring has the area dA = 2 pi (a / D) d dd exactly, lies at the angle
w off the axis with cos w = (d^2 + D^2 - a^2) / (2 d D), and is met at the incidence i from the
normal with cos i = (D^2 - a^2 - d^2) / (2 a d). It scatters by the facet law of kernels/target.h.
The water behind the sphere's limb is shadowed; its shadow cone (half a degree) meets neither bottom
nor surface within range, so these are those of the flat scene. Direct echoes only, no noise.
"""
import argparse
import math

import numpy as np

from reference_laws import SCENARIO, Water, gauss, panels, to_db, write_json
from reference_step import Step

DISTANCE_M = 30.0
RADIUS_M = 0.25
MATERIAL = dict(impedance_mrayl=45.0, roughness_rms_mm=0.2, slope_rms=0.2)
WATER_DENSITY_KG_M3 = 1025.0


def facet(water, cos_i):
    """Backscatter of a rough facet per unit area: R^2 [rho Kirchhoff lobe + (1 - rho) Lambert]."""
    ratio = MATERIAL['impedance_mrayl'] / (1e-6 * WATER_DENSITY_KG_M3 * water.c_mps)
    reflection = ((ratio - 1) / (ratio + 1)) ** 2
    k_s = 2 * math.pi / water.wavelength_m * MATERIAL['roughness_rms_mm'] / 1000
    slope = MATERIAL['slope_rms'] ** 2
    cos2 = cos_i**2
    rho = np.exp(-4 * k_s**2 * cos2)
    lobe = np.exp(-(1 / cos2 - 1) / slope) / (4 * math.pi * slope * cos2**2)
    return reflection * (rho * lobe + (1 - rho) * cos2 / math.pi)


def on_axis_gain(water, off_axis):
    """Transmit times receive pattern averaged over the circle at OFF_AXIS from the axis."""
    turn, w = gauss(0.0, math.pi / 2, 24)
    sine = np.sin(off_axis)[..., None]
    ux = np.cos(off_axis)[..., None] + 0 * turn
    one_way = water.beam(ux, sine * np.cos(turn), sine * np.sin(turn), 0.0)
    return (w * one_way**2).sum(-1) / (math.pi / 2)


def off_axis(d):
    cosine = (d**2 + DISTANCE_M**2 - RADIUS_M**2) / (2 * d * DISTANCE_M)
    return np.arccos(np.minimum(cosine, 1.0))


def sphere(water, lo, hi, nodes):
    """Energy of the part of the near side between the ranges LO and HI."""
    limb = math.sqrt(DISTANCE_M**2 - RADIUS_M**2)
    lo, hi = max(lo, DISTANCE_M - RADIUS_M), min(hi, limb)
    if hi <= lo:
        return 0.0
    t, w = gauss(0.0, 1.0, nodes)  # d falls towards the limb: smooth its square root
    d, w = hi - (hi - lo) * (1 - t) ** 2, w * 2 * (1 - t) * (hi - lo)
    cos_i = (DISTANCE_M**2 - RADIUS_M**2 - d**2) / (2 * RADIUS_M * d)
    area = 2 * math.pi * RADIUS_M / DISTANCE_M * d
    return (w * area * water.two_way(d) * facet(water, np.maximum(cos_i, 1e-9))
            * on_axis_gain(water, off_axis(d))).sum()


def shadow(water, lo, hi, nodes):
    """Energy of the water that the sphere displaces or hides between the ranges LO and HI."""
    limb = math.sqrt(DISTANCE_M**2 - RADIUS_M**2)
    lo = max(lo, DISTANCE_M - RADIUS_M)
    if hi <= lo:
        return 0.0
    d, w = panels(lo, hi, [limb], nodes)
    edge = np.where(d < limb, off_axis(d), math.asin(RADIUS_M / DISTANCE_M))
    angle, wa = gauss(np.zeros_like(edge), edge, nodes)
    cone = (wa * 2 * math.pi * np.sin(angle) * on_axis_gain(water, angle)).sum(-1)
    return (w * d**2 * water.two_way(d) * water.volume_per_m * cone).sum()


def levels(par, nodes):
    step = Step(par, 0.0, 0.0, nodes)
    result = step.bins()
    width = par['bin_length_m']
    for i in range(len(result['object'])):
        result['object'][i] = sphere(step.water, i * width, (i + 1) * width, 2 * nodes)
        result['volume'][i] -= shadow(step.water, i * width, (i + 1) * width, nodes)
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.split('\n')[0])
    parser.add_argument('-o', default='sphere_expected.json')
    args = parser.parse_args()
    lam = Water(SCENARIO).c_mps / 450e3
    par = dict(SCENARIO, frequency_khz=450.0, length_h_m=10 * lam, length_v_m=5 * lam)
    value, coarse = levels(par, 36), levels(par, 24)
    total, other = sum(value.values()), sum(coarse.values())
    used = total > 0
    worst = np.abs(other[used] / total[used] - 1).max()
    strength = value['object'].sum() / Water(par).two_way(DISTANCE_M - RADIUS_M)
    print(f'target strength {10 * math.log10(strength):.2f} dB; '
          f'largest difference between the two quadratures: {worst:.2g}')
    write_json(args.o, {
        'about': 'Expected levels per range bin over a flat bottom with a steel sphere on the beam '
                 'axis, dB re 1 uPa at SL 0, direct echoes only, no noise; written by '
                 'reference_sphere.py. Bin i covers [i, i+1) x bin_length_m; an empty bin is null.',
        'parameters': dict(par, distance_m=DISTANCE_M, radius_m=RADIUS_M, **MATERIAL,
                           water_density_kg_m3=WATER_DENSITY_KG_M3),
        'rel_err_max': float(f'{worst:.2g}'),
        **{f'{part}_db': to_db(value[part]) for part in value}, 'total_db': to_db(total)})


if __name__ == '__main__':
    main()
