#!/usr/bin/env python3
"""Makes meshes/terrain.ply, the sea floor of the demonstration mission.
Usage: make_terrain.py [FOLDER]"""
import os

import place
import ply
import seafloor


def coordinates(lo, hi, fine_lo, fine_hi, fine_m, growth):
    """FINE_M apart between FINE_LO and FINE_HI, growing further apart outside."""
    count = round((fine_hi - fine_lo) / fine_m)
    values = [fine_lo + i * (fine_hi - fine_lo) / count for i in range(count + 1)]
    step = fine_m
    while values[-1] < hi:
        step *= growth
        values.append(min(values[-1] + step, hi))
    step = fine_m
    while values[0] > lo:
        step *= growth
        values.insert(0, max(values[0] - step, lo))
    return values


def main():
    norths = coordinates(-100.0, 310.0, 20.0, 215.0, 0.85, 1.02)
    easts = coordinates(-110.0, 140.0, -14.0, 46.0, 0.85, 1.04)
    rows = [[(e, n, -seafloor.depth_m(n, e)) for e in easts] for n in norths]
    vertices, triangles = ply.sheet(rows)
    path = place.path('meshes', 'terrain.ply')
    ply.write(path, vertices, triangles, 'asdic data/generate/make_terrain.py: east, north, up, m')
    print(f'{path}: {len(triangles)} triangles, {os.path.getsize(path)} bytes')


if __name__ == '__main__':
    main()
