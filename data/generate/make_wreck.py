#!/usr/bin/env python3
"""Makes meshes/wreck.ply: a coaster of 44 m, broken in two. Usage: make_wreck.py [FOLDER]

The origin is amidships at the keel, the bow points north, z is up. The scene gives it its place
and its list.
"""
import math
import os

import place
import ply

LENGTH_M, HALF_BEAM_M, HEIGHT_M = 44.0, 4.0, 5.5


class Mesh:
    def __init__(self):
        self.vertices, self.triangles = [], []

    def quad(self, a, b, c, d):
        """Corners counterclockwise seen from outside; two equal corners make a triangle."""
        first = len(self.vertices)
        self.vertices += [a, b, c, d]
        if a != b and b != c:
            self.triangles.append((first, first + 1, first + 2))
        if c != d and d != a:
            self.triangles.append((first, first + 2, first + 3))

    def box(self, lo, hi, turn=lambda p: p):
        x, y, z = zip(lo, hi)
        for corners in ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2),
                        (1, 3, 7, 5)):
            self.quad(*(turn((x[c & 1], y[c >> 1 & 1], z[c >> 2])) for c in corners))

    def tube(self, start, end, radius, sides=10):
        """An upright or leaning mast."""
        def ring(at):
            return [(at[0] + radius * math.cos(2 * math.pi * k / sides),
                     at[1] + radius * math.sin(2 * math.pi * k / sides), at[2])
                    for k in range(sides)]
        low, high = ring(start), ring(end)
        for k in range(sides):
            n = (k + 1) % sides
            self.quad(low[k], low[n], high[n], high[k])
            self.quad(high[k], high[n], end, end)
            self.quad(low[n], low[k], start, start)


def half_width(north, height):
    """Half the hull's width at a station and a height above the keel."""
    t = 2 * north / LENGTH_M
    bow = max(0.0, 1 - max(0.0, (t - 0.35) / 0.65) ** 2)
    stern = max(0.0, 1 - 0.45 * max(0.0, (-t - 0.6) / 0.4) ** 2)
    section = (height / HEIGHT_M) ** (0.22 + 0.5 * (1 - bow))
    return HALF_BEAM_M * bow * stern * section


def hull(mesh, south, north, stations=26, levels=12):
    """The shell between two stations, its deck, and a bulkhead where it is broken off."""
    def point(i, j, side):
        at = south + (north - south) * i / stations
        sheer = 0.9 * max(0.0, 2 * at / LENGTH_M) ** 2
        height = HEIGHT_M * j / levels
        # Dents: the plating is not fair any more.
        dent = 0.10 * math.sin(1.9 * i + 0.8 * j + side) * math.sin(math.pi * j / levels)
        width = max(half_width(at, height) + (dent if 0 < i < stations else 0.0), 0.0)
        return (side * width + 0.0, at, height + sheer * j / levels)

    for i in range(stations):
        for j in range(levels):
            a, b = point(i, j, 1), point(i + 1, j, 1)
            c, d = point(i + 1, j + 1, 1), point(i, j + 1, 1)
            mesh.quad(a, b, c, d)
            a, b = point(i, j, -1), point(i + 1, j, -1)
            c, d = point(i + 1, j + 1, -1), point(i, j + 1, -1)
            mesh.quad(b, a, d, c)
        port, far = point(i, levels, -1), point(i + 1, levels, -1)
        mesh.quad(port, point(i, levels, 1), point(i + 1, levels, 1), far)
    for end, flip in ((0, False), (stations, True)):
        for j in range(levels):
            ring = [point(end, j, -1), point(end, j, 1), point(end, j + 1, 1),
                    point(end, j + 1, -1)]
            mesh.quad(*(reversed(ring) if flip else ring))


def main():
    mesh = Mesh()
    hull(mesh, -22.0, 3.0)
    hull(mesh, 6.5, 21.6, stations=18)
    deck = HEIGHT_M
    mesh.box((-3.0, -20.0, deck), (3.0, -12.0, deck + 2.6))        # deck house
    mesh.box((-2.4, -18.5, deck + 2.6), (2.4, -13.0, deck + 5.0))  # bridge
    mesh.tube((0, -19.0, deck + 2.6), (0.3, -19.0, deck + 6.0), 0.8)  # funnel
    mesh.box((-2.6, -9.0, deck), (2.6, -3.0, deck + 1.0))          # hatch coaming
    mesh.box((-2.6, 9.0, deck), (2.6, 14.0, deck + 1.0))
    mesh.tube((0, -1.0, deck), (1.2, -0.5, deck + 7.5), 0.28)      # masts
    mesh.tube((0, 16.5, deck), (0.0, 16.5, deck + 5.0), 0.25)
    # Plating and cargo fallen out of the break.
    for k in range(9):
        turn = 0.9 * k

        def placed(p, turn=turn, k=k):
            c, s = math.cos(turn), math.sin(turn)
            x, y = 5.5 * math.cos(2.4 * k), 4.7 + 3.0 * math.sin(2.4 * k)
            return (x + c * p[0] - s * p[1], y + s * p[0] + c * p[1], p[2] + 0.15 * k % 0.7)
        mesh.box((-0.9, -0.5, 0.0), (0.9, 0.5, 0.5 + 0.08 * k), placed)
    path = place.path('meshes', 'wreck.ply')
    ply.write(path, mesh.vertices, mesh.triangles,
              'asdic data/generate/make_wreck.py: bow north, up, m')
    print(f'{path}: {len(mesh.triangles)} triangles, '
          f'{os.path.getsize(path)} bytes')


if __name__ == '__main__':
    main()
