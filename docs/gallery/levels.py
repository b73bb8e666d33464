"""Levels with their standard errors, against what is expected.  python3 levels.py [PICTURE [RAYS]]"""
import sys

import matplotlib.pyplot as plt
import numpy as np

import asdic

picture, rays = (sys.argv[1:] + ["levels.png", "400"][len(sys.argv) - 1:])[:2]

scene = asdic.Scene(
    bottom={"depth_m": 12, "type": "sand"},
    sonar={"frequency_khz": 100, "bandwidth_khz": 10, "ping_rate_hz": 10, "source_level_db": 200,
           "receivers": [{"name": "forward"}, {"name": "down", "pitch_deg": 20}]},
    mission={"pose": {"position_m": [0, 0, 7]}})
expected, ping = asdic.expect(scene), asdic.Simulator(scene, rays=int(rays)).ping(0, 0, 7)

figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(7, 5), height_ratios=(3, 1))
asdic.plot.ascope(ping, "forward", expected=expected, ax=above)
for name in ("bottom", "surface", "volume"):
    above.plot(expected.ranges, expected.parts[name][0], ":", linewidth=1, label=name)
above.set(xlabel="", ylim=(80, 125), title=f"{rays} rays; dotted: what each mechanism is expected to give")
above.legend(ncols=3, fontsize="small")

off = (ping.level_db - expected.level_db)[0] / np.maximum(ping.stderr_db[0], 1e-6)
below.plot(ping.ranges, off, ".", markersize=3)
below.axhspan(-2, 2, alpha=0.2)
below.set(xlabel="range, m", ylabel="errors off", ylim=(-5, 5))
figure.savefig(picture, dpi=80, bbox_inches="tight")
