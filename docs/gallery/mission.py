"""A moving vehicle's pings as an xarray.Dataset.  python3 mission.py [PICTURE [RAYS]]"""
import sys

import matplotlib.pyplot as plt

import asdic

picture, rays = (sys.argv[1:] + ["mission.png", "20000"][len(sys.argv) - 1:])[:2]

scene = asdic.Scene(
    bottom={"depth_m": 15, "type": "mud"},
    sonar={"frequency_khz": 200, "bandwidth_khz": 10, "ping_rate_hz": 4, "max_range_m": 60, "source_level_db": 205,
           "bin_length_m": 0.5, "speckle": "rayleigh",
           "receivers": {"fan": {"count": 5, "sector_deg": 60, "length_h_m": 0.05, "length_v_m": 0.03}}},
    mission={"waypoints": {"points_m": [[0, 0, 8], [60, 0, 8], [80, 40, 8]], "speed_mps": 2}},
    output={"csv": "none", "images": []})
for k, (x, y) in enumerate([(45, 4), (75, -3), (85, 22), (100, 45)]):
    scene.add(f"pile{k}", cylinder={"radius_m": 0.5, "length_m": 15}, position_m=(x, y, 7.5), rotation_deg=(90, 0, 0),
              material="concrete")

data = asdic.simulate(scene, rays=int(rays)).to_xarray()
ahead = data.level.isel(beam=2).swap_dims(ping="time")

figure, (left, right) = plt.subplots(1, 2, figsize=(8, 4), layout="constrained")
ahead.plot(ax=left, x="range", y="time", vmin=40, vmax=130, cbar_kwargs={"label": "level, dB re 1 µPa"})
left.set(xlabel="range, m", ylabel="time, s", title="the middle beam")
strongest = data.object.max("range")
points = right.scatter(data.east, data.north, c=strongest.max("beam"), s=8, vmin=60, vmax=130)
right.set(xlabel="east, m", ylabel="north, m", aspect="equal", title="the track")
figure.colorbar(points, ax=right, label="strongest pile, dB re 1 µPa")
figure.savefig(picture, dpi=80)
