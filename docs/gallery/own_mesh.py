"""A mesh of one's own: a tyre of steel on sand, from numpy arrays.  python3 own_mesh.py [PICTURE [RAYS]]"""
import sys

import matplotlib.pyplot as plt
import numpy as np

import asdic

picture, rays = (sys.argv[1:] + ["own_mesh.png", "400000"][len(sys.argv) - 1:])[:2]


def torus(radius, thickness, around=96, across=32):
    """Vertices [n, 3] and triangles [m, 3], facets outwards."""
    u, v = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = 2 * np.pi * u / around, 2 * np.pi * v / across
    ring = radius + thickness * np.cos(b)
    vertices = np.stack([ring * np.cos(a), ring * np.sin(a), thickness * np.sin(b)], axis=-1).reshape(-1, 3)

    def corner(i, k):
        return i % around * across + k % across
    first = [corner(u, v), corner(u + 1, v), corner(u + 1, v + 1)]
    second = [corner(u, v), corner(u + 1, v + 1), corner(u, v + 1)]
    return vertices, np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in (first, second)])


scene = asdic.Scene(
    bottom={"depth_m": 10, "type": "sand"},
    sonar={"frequency_khz": 700, "bandwidth_khz": 40, "ping_rate_hz": 20, "max_range_m": 16, "source_level_db": 200,
           "bin_length_m": 0.05, "speckle": "rayleigh",
           "transmitter": {"pitch_deg": 20, "length_h_m": 0.001, "length_v_m": 0.004},
           "receivers": {"fan": {"count": 256, "sector_deg": 60, "pitch_deg": 20, "length_h_m": 0.2, "length_v_m": 0.004}}},
    mission={"pose": {"position_m": [0, 0, 6]}})
scene.add_mesh(*torus(1.5, 0.45), material="steel", name="tyre", position_m=(10, 0, 9.0), rotation_deg=(0, 60, 20))

ping = asdic.Simulator(scene, rays=int(rays)).ping(0, 0, 6)
ax = asdic.plot.fan(ping, vmin=70, vmax=130, cmap="copper")
ax.set_title("a tyre leans on the sand, and hides some of it")
plt.gcf().set_size_inches(6, 5)
plt.savefig(picture, dpi=80, bbox_inches="tight")
