"""A fan of 256 beams over terrain: hills and ripples from numpy.  python3 terrain.py [PICTURE [RAYS]]"""
import sys

import matplotlib.pyplot as plt
import numpy as np

import asdic

picture, rays = (sys.argv[1:] + ["terrain.png", "400000"][len(sys.argv) - 1:])[:2]

north, east = np.linspace(0, 80, 161), np.linspace(-70, 70, 281)
x, y = np.meshgrid(north, east, indexing="ij")
depth = 20 - 5 * np.exp(-((x - 42) ** 2 + (y - 14) ** 2) / 40) - 4 * np.exp(-((x - 30) ** 2 + (y + 12) ** 2) / 25)
depth += 0.25 * np.sin(2 * np.pi * (x + 0.4 * y) / 5)

scene = asdic.Scene(
    sonar={"frequency_khz": 300, "bandwidth_khz": 20, "ping_rate_hz": 10, "max_range_m": 60, "source_level_db": 210,
           "bin_length_m": 0.25, "speckle": "rayleigh",
           "transmitter": {"pitch_deg": 12, "length_h_m": 0.002, "length_v_m": 0.01},
           "receivers": {"fan": {"count": 256, "sector_deg": 120, "pitch_deg": 12, "length_h_m": 0.2, "length_v_m": 0.01}}},
    mission={"pose": {"position_m": [0, 0, 12]}})
scene.set_terrain(north, east, depth, material="gravel")

ping = asdic.Simulator(scene, rays=int(rays)).ping(0, 0, 12)
ax = asdic.plot.fan(ping, vmin=75, vmax=130, cmap="copper")
ax.set_title("two hills, their shadows, and ripples of 5 m")
plt.gcf().set_size_inches(7, 4.5)
plt.savefig(picture, dpi=80, bbox_inches="tight")
