#!/usr/bin/env python3
"""Makes meshes/rocks.ply: boulders half sunk in the sea floor of the demonstration mission.
Usage: make_rocks.py [FOLDER]"""
import math
import os
import random

import place
import ply
import seafloor

# North, east and spread of each field in metres, number and largest radius of its boulders.
FIELDS = [(40.0, 6.0, 12.0, 14, 0.7), (92.0, -12.0, 14.0, 16, 1.0), (150.0, 4.0, 16.0, 18, 1.2),
          (78.0, 34.0, 12.0, 16, 1.1), (20.0, 30.0, 14.0, 12, 0.9)]


def icosphere(levels):
    """Unit sphere: an icosahedron whose facets are cut in four LEVELS times."""
    g = (1 + math.sqrt(5)) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
              (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    points = [tuple(v / math.hypot(1, g) for v in p) for p in points]
    facets = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
              (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
              (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(levels):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                total = [points[a][i] + points[b][i] for i in range(3)]
                norm = math.hypot(*total)
                middles[key] = len(points)
                points.append(tuple(v / norm for v in total))
            return middles[key]

        for a, b, c in facets:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        facets = finer
    return points, facets


def main():
    rng = random.Random(1)
    sphere, facets = icosphere(2)
    vertices, triangles = [], []
    for number, (north, east, spread, count, largest) in enumerate(FIELDS):
        for k in range(count):
            n, e = rng.gauss(north, spread / 2), rng.gauss(east, spread / 2)
            radius = largest * (0.3 + 0.7 * rng.random() ** 2)
            squash = [0.8 + 0.4 * rng.random() for _ in range(2)] + [0.6 + 0.3 * rng.random()]
            seed = 1000 + 100 * number + k
            first = len(vertices)
            top = -seafloor.depth_m(n, e) + 0.2 * radius
            for x, y, z in sphere:
                lump = 1 + 0.22 * seafloor.fractal(x * 2 + 7 * z, y * 2 - 5 * z, 1.5, 3, 0.5, seed)
                vertices.append((e + radius * lump * squash[0] * x,
                                 n + radius * lump * squash[1] * y,
                                 top + radius * lump * squash[2] * z))
            triangles += [tuple(first + i for i in facet) for facet in facets]
    path = place.path('meshes', 'rocks.ply')
    ply.write(path, vertices, triangles, 'asdic data/generate/make_rocks.py: east, north, up, m')
    print(f'{path}: {len(triangles)} triangles, {os.path.getsize(path)} bytes')


if __name__ == '__main__':
    main()
