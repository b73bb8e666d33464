"""A vehicle with a controller of its own finds its way between piles.  python3 avoid.py [PICTURE [RAYS]]"""
import sys

import matplotlib.pyplot as plt
import numpy as np

import asdic

picture, rays = (sys.argv[1:] + ["avoid.png", "4000"][len(sys.argv) - 1:])[:2]

piles = [(25, 1), (42, -6), (45, 9), (60, -1), (75, 7), (78, -9), (95, 1)]
scene = asdic.Scene(
    bottom={"depth_m": 20, "type": "mud"},
    sonar={"frequency_khz": 200, "bandwidth_khz": 10, "ping_rate_hz": 5, "max_range_m": 30, "source_level_db": 205,
           "bin_length_m": 0.25, "transmitter": {"length_h_m": 0.003, "length_v_m": 0.05},
           "receivers": {"fan": {"count": 31, "sector_deg": 120, "length_h_m": 0.1, "length_v_m": 0.05}}},
    mission={"pose": {"position_m": [0, 0, 8]}})
quiet = asdic.expect(scene).level_db
for x, y in piles:
    scene.add(f"pile{x}", cylinder={"radius_m": 1, "length_m": 20}, position_m=(x, y, 10), rotation_deg=(90, 0, 0),
              material="concrete")

sonar = asdic.Simulator(scene, rays=int(rays))
bearings, track = np.radians(sonar.bearings), []
x, y, yaw, speed, step = 0.0, 0.0, 0.0, 2.0, 0.4
while x < 110 and len(track) < 250:
    track.append((x, y))
    ping = sonar.ping(x, y, 8, yaw=np.degrees(yaw))
    heard = (ping.level_db > quiet + 10) & (ping.ranges < 22) & (ping.ranges > 1)
    heard &= ping.level_db > ping.level_db.max(axis=0) - 15        # not by a side lobe
    nearest = np.where(heard, ping.ranges, 22).min(axis=1)         # free way of each beam
    clear = np.array([np.min(nearest[np.abs(bearings - b) < 0.5]) for b in bearings])
    goal = -np.arctan2(y, 25) - yaw                                # back to the line north
    steer = bearings[np.argmax(clear - 8 * np.abs(bearings - goal))]
    yaw += np.clip(steer, -0.25, 0.25)
    x, y = x + speed * step * np.cos(yaw), y + speed * step * np.sin(yaw)

north, east = np.transpose(track)
closest = min(np.hypot(north - x, east - y).min() for x, y in piles)
plt.figure(figsize=(8, 3))
plt.plot(north, east, ".-", markersize=3)
for x, y in piles:
    plt.gca().add_patch(plt.Circle((x, y), 1, color="tab:orange"))
plt.gca().set(xlabel="north, m", ylabel="east, m", aspect="equal",
              title=f"{len(track)} pings; never nearer than {closest:.1f} m to the middle of a pile")
plt.gca().invert_yaxis()  # from above, as a map: starboard of the way north is down
plt.savefig(picture, dpi=80, bbox_inches="tight")
print(f"{len(track)} pings, {north[-1]:.0f} m north, never nearer than {closest:.1f} m")
