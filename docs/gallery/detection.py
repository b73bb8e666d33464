"""How far a target is detected, for targets of three strengths.  python3 detection.py [PICTURE [TRIALS]]"""
import sys

import matplotlib.pyplot as plt

import asdic

picture, trials = (sys.argv[1:] + ["detection.png", "200000"][len(sys.argv) - 1:])[:2]

scene = asdic.Scene(
    bottom={"depth_m": 30, "type": "gravel"},
    sonar={"frequency_khz": 200, "bandwidth_khz": 10, "ping_rate_hz": 5, "source_level_db": 205, "speckle": "rayleigh",
           "transmitter": {"length_h_m": 0.05, "length_v_m": 0.05},
           "receivers": [{"name": "forward", "length_h_m": 0.1, "length_v_m": 0.05}]},
    mission={"pose": {"position_m": [0, 0, 10]}})

for strength_db in (-45, -35, -25):
    curve = asdic.roc(scene, range_m=40, target_strength_db=strength_db, pfa=1e-4, trials=int(trials))
    reach = curve.reach
    line, = plt.plot(reach["range_m"], reach["closed_pd"], label=f"target of {strength_db} dB re 1 m²")
    plt.fill_between(reach["range_m"], reach["pd"]["low"], reach["pd"]["high"], color=line.get_color(), alpha=0.3)
plt.xlabel("range, m")
plt.ylabel("probability of detection at a $P_{FA}$ of $10^{-4}$")
plt.title("closed form; shaded: 99 % bounds of what was drawn")
plt.legend()
plt.gcf().set_size_inches(7, 4)
plt.savefig(picture, dpi=80, bbox_inches="tight")
