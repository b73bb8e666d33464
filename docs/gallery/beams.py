"""A beamformer of one's own, of pressures at the elements of an array.  python3 beams.py [PICTURE [RAYS]]"""
import sys

import matplotlib.pyplot as plt
import numpy as np

import asdic

picture, rays = (sys.argv[1:] + ["beams.png", "50000"][len(sys.argv) - 1:])[:2]

POINTS = [(25, -11), (31, 4), (18, 8)]
scene = asdic.Scene(
    environment={"sound_speed_mps": 1500, "wind_speed_kn": 5},
    bottom={"depth_m": 12, "type": "sand"},
    sonar={"frequency_khz": 100, "bandwidth_khz": 10, "bin_length_m": 0.075, "max_range_m": 40, "source_level_db": 200,
           "transmitter": {"length_h_m": 0.01, "length_v_m": 0.05},
           "array": {"elements": 48, "element": {"length_v_m": 0.05}, "beams": {"count": 2, "sector_deg": 90}}},
    mission={"pose": {"position_m": [0, 0, 7]}},
    sampling={"coherent": True})
for number, (north, east) in enumerate(POINTS):
    scene.add(f"p{number}", point={"target_strength_db": 0}, position_m=(north, east, 7))
ping = asdic.Simulator(scene, rays=int(rays)).ping(0, 0, 7)
ranges = (np.arange(ping.pressure.shape[1]) + 0.5) * ping.sample_m


def form_beams(pressure, bearings, weights):
    """Levels [bearing, sample], dB re 1 uPa, of elements half a wavelength apart."""
    number = np.arange(len(pressure)) - 0.5 * (len(pressure) - 1)
    steering = np.exp(-1j * np.pi * np.outer(np.sin(np.radians(bearings)), number))
    return 20 * np.log10(np.abs(steering @ (pressure * (weights / weights.sum())[:, None])) + 1e-9)


bearings = np.linspace(-45, 45, 361)
elements = len(ping.pressure)
figure, axes = plt.subplots(1, 2, figsize=(9, 4.5), sharey=True, layout="constrained")
for ax, (name, weights) in zip(axes, {"all elements alike": np.ones(elements), "Hamming": np.hamming(elements)}.items()):
    level = form_beams(ping.pressure, bearings, weights)
    level = level[:, :len(ranges) // 5 * 5].reshape(len(bearings), -1, 5).max(axis=2)  # the loudest of five: a pixel
    north, east = (np.outer(turn(np.radians(bearings)), ranges[2::5][:level.shape[1]]) for turn in (np.cos, np.sin))
    image = ax.pcolormesh(east, north, level, vmin=60, vmax=140, shading="gouraud")
    ax.set(title=name, xlabel="east, m", aspect="equal")
axes[0].set_ylabel("north, m")
figure.colorbar(image, ax=axes, label="dB re 1 µPa", shrink=0.6)
figure.savefig(picture, dpi=65)

level = form_beams(ping.pressure, bearings, np.ones(elements))
for x, y in POINTS:
    sample = int(np.argmin(np.abs(ranges - np.hypot(x, y))))
    print(f"{np.degrees(np.arctan2(y, x)):.1f} degrees: found at {bearings[np.argmax(level[:, sample])]:.1f}")
