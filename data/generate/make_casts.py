#!/usr/bin/env python3
"""Makes casts/*.csv: temperature and salinity over depth of three waters. Usage: make_casts.py [FOLDER]

They are shapes, not measurements: a mixed layer, a step of the form

    q(z) = q_deep + (q_top - q_deep) (1 - tanh((z - middle) / scale)) / 2

and what lies below it. That a summer thermocline falls by 1 degC and more each metre, from about 20 degC
to 5 or 6 degC in lakes of temperate climates, is R. G. Wetzel, "Limnology", 3rd ed. 2001, ch. 6; that
salinity steps by tens of ppt over a few metres where a river runs out over the sea is K. R. Dyer,
"Estuaries", 2nd ed. 1997, ch. 2. Rows are kept where straight lines between them would miss the sound
speed (Medwin 1975) by more than 0.5 m/s.
"""
import math

import place

STEP_M, DEEPEST_M, MISS_MPS = 0.25, 40.0, 0.5


def step(z, top, deep, middle, scale):
    return deep + (top - deep) * (1 - math.tanh((z - middle) / scale)) / 2


CASTS = {
    # Mixed by wind and cooling to the bottom: only pressure bends rays, up, by 0.016 1/s.
    'winter.csv': lambda z: (6.0, 34.0),
    'lake_summer.csv': lambda z: (step(z, 20.0, 6.0, 7.0, 2.5), 0.2),
    # Fresh and warm above, salt and cool below: the sound speed rises with depth.
    'estuary.csv': lambda z: (step(z, 16.0, 13.0, 4.0, 1.2), step(z, 6.0, 31.0, 4.0, 1.2)),
}


def sound_speed_mps(t, s, z):
    """Medwin 1975."""
    return (1449.2 + 4.6 * t - 0.055 * t**2 + 0.00029 * t**3 + (1.34 - 0.010 * t) * (s - 35)
            + 0.016 * z)


def thin(rows, speeds):
    """The rows that straight lines need (Douglas and Peucker 1973, along the speed)."""
    (a, *_), (b, *_) = rows[0], rows[-1]
    miss = [abs(c - speeds[0] - (speeds[-1] - speeds[0]) * (row[0] - a) / (b - a))
            for row, c in zip(rows, speeds)]
    worst = max(range(len(rows)), key=miss.__getitem__)
    if miss[worst] <= MISS_MPS:
        return [rows[0], rows[-1]]
    return (thin(rows[:worst + 1], speeds[:worst + 1])[:-1]
            + thin(rows[worst:], speeds[worst:]))


def main():
    for name, water in CASTS.items():
        depths = [STEP_M * i for i in range(int(DEEPEST_M / STEP_M) + 1)]
        rows = [(z, *water(z)) for z in depths]
        kept = thin(rows, [sound_speed_mps(t, s, z) for z, t, s in rows])
        with open(place.path('casts', name), 'w', encoding='ascii') as out:
            out.write('depth_m,temperature_degc,salinity_ppt\n')
            for z, t, s in kept:
                out.write(f'{z:g},{t:.2f},{s:.2f}\n')


if __name__ == '__main__':
    main()
