"""The wall that tests of trials fly towards."""
import csv
import json
import os
import subprocess

import program
import tap

HULL, REACH, BIN, FRONT = 0.2, 20.0, 0.5, 59.0  # m: the radius, how far the rule looks, a bin, where the wall begins
WALL = """
version: 1
bottom: {depth_m: 20, type: sand}
objects:
  - {name: wall, box: {size_m: [2, 400, 40]}, position_m: [60, 0, 10]}
sonar:
  frequency_khz: 100
  ping_rate_hz: 1
  source_level_db: 200
  max_range_m: 40
  bin_length_m: 0.5
  speckle: rayleigh
  receivers: [{name: forward, length_h_m: 0.05, length_v_m: 0.05}]
mission:
  waypoints: {points_m: [[0, 0, 10], [100, 0, 10]], speed_mps: 1.5, turn_radius_m: 5, response_s: 1}
detector: {pfa: 1.0e-4}
sampling: {rays: 1000}
trial:
  hull_radius_m: 0.2
  time_s: 45
  rule: {manoeuvre: turn, turn_deg: 150, reach_m: 20, hold_s: 1000}
"""
IDEAL = WALL + "  ideal: {pd: PD}\n"
# The same in deep water and from pings at which the wall is in sight soon: quick.
LEAD = 20
CLOSE = IDEAL.replace("depth_m: 20", "depth_m: 200").replace("[[0, 0, 10]", f"[[{LEAD * 1.5}, 0, 10]").replace(
    "time_s: 45", f"time_s: {45 - LEAD}")


def fly(folder, path, runs, *options):
    command = [program.PATH, "trial", path, "--runs", str(runs), "-o", folder / "out", "-f", "--json"]
    done = subprocess.run(command + [str(option) for option in options], capture_output=True,
                          check=False, timeout=1500)
    tap.equal(done.returncode, 0, done.stderr)
    return json.loads(done.stdout)["variants"]


def rows(folder, name="out"):
    with open(os.path.join(folder / name, "trial.csv"), encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))
