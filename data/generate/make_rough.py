#!/usr/bin/env python3
"""Makes meshes/rough.ply: a rough, self-shadowing sea floor around 12 m depth, for
scenes/bench_terrain.yaml. Usage: make_rough.py [FOLDER]"""
import os

import place
import ply
import seafloor

CELL_M = 0.8


def depth_m(north, east):
    """Twelve metres on average; near the sonar calm enough that the altitude is 5 m +- 0.3 m."""
    calm = seafloor.ramp((north**2 + east**2) ** 0.5, 4.0, 15.0)
    return 12.0 - (0.25 + 0.75 * calm) * 1.1 * seafloor.fractal(north, east, 14.0, 4, 0.5, 200)


def main():
    rows = [[(e * CELL_M, n * CELL_M, -depth_m(n * CELL_M, e * CELL_M)) for e in range(-96, 97)]
            for n in range(-6, 97)]
    vertices, triangles = ply.sheet(rows)
    path = place.path('meshes', 'rough.ply')
    ply.write(path, vertices, triangles, 'asdic data/generate/make_rough.py: east, north, up, m')
    print(f'{path}: {len(triangles)} triangles, {os.path.getsize(path)} bytes')


if __name__ == '__main__':
    main()
