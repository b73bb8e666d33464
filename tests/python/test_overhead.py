"""What pings cost more in Python than in C: poses in, levels out, turn and turn about.

The loop in C is the library's own, asdic_simulator_pings and asdic_ping_levels, of as many poses a call as in
Python. Both draw the same rays and follow each other, so that what else runs on the machine slows down both; compared is
the processor time of the process, pair by pair. The median of the ratios has an interval from its order
statistics, which hold whatever the ratios' distribution is; pairs are added until it lies on one side of
the limit.
"""
import math
import os
import time

from package import ROOT, need_device
import tap

import numpy as np
import asdic
from asdic._native import ffi, lib

SCENE = os.path.join(ROOT, "data", "scenes", "scenario2.yaml")
LIMIT, MOST_SINGLE = 0.02, 0.1  # a single ping finds its Python code no longer in the processor's caches
PAIRS, MOST_PAIRS = 200, 2000


def processor_s(function):
    began = time.process_time()
    function()
    return time.process_time() - began


def median_interval(values):
    """The median, and where it lies with 99 %: ranks n / 2 -+ 2.576 sqrt(n) / 2 (binomial, p = 1/2)."""
    ordered, half = np.sort(values), 1.288 * math.sqrt(len(values))
    low, high = math.floor(len(values) / 2 - half), math.ceil(len(values) / 2 + half)
    return np.median(ordered), ordered[max(low, 0)], ordered[min(high, len(values) - 1)]


class Loops:
    """One simulator of RAYS, by Python and by C, COUNT pings a call."""

    def __init__(self, rays, count):
        self.sonar, self.poses = asdic.Simulator(SCENE, rays=rays), np.tile([0.0, 0.0, 7.0], (count, 1))
        self.rooms = self.sonar.pings(self.poses)
        self.simulator = self.sonar._handle.pointer  # pylint: disable=protected-access
        self.pose = ffi.new("asdic_pose[]", [{"position_m": (0, 0, 7)}] * count)
        self.pings = ffi.new("asdic_ping *[]", [room._struct for room in self.rooms])  # pylint: disable=protected-access
        self.levels = np.empty((count, *self.rooms[0].level_db.shape), np.float32)
        self.places = [ffi.from_buffer("float[]", levels) for levels in self.levels]

    def in_c(self):
        lib.asdic_simulator_pings(self.simulator, self.pose, 1, len(self.places), self.pings)
        for ping, place in zip(self.pings, self.places):
            lib.asdic_ping_levels(ping, lib.ASDIC_TOTAL, place)

    def in_python(self):
        self.sonar.index = 1  # neither loop learns, and both draw the same rays
        if len(self.poses) == 1:
            return [self.sonar.ping(0, 0, 7).level_db]
        return [ping.level_db for ping in self.sonar.pings(self.poses)]

    def pairs(self, count):
        """Processor time of calls by Python and by C, each first in every other pair."""
        times = np.empty((count, 2))
        for k in range(count):
            for which in ((0, 1), (1, 0))[k % 2]:
                times[k, which] = processor_s((self.in_python, self.in_c)[which])
        return times


def overhead(count, most, pairs):
    """The median share that Python adds to 20,000 rays a ping, COUNT pings a call."""
    loops = Loops(20000, count)
    loops.pairs(4)
    tap.equal(np.array_equal(loops.levels, loops.in_python(), equal_nan=True), True, "both simulate the same pings")
    times, low, high = np.empty((0, 2)), -1.0, 1.0
    while low < LIMIT < high and len(times) < most:
        times = np.concatenate([times, loops.pairs(pairs)])
        ratio, low, high = median_interval(times[:, 0] / times[:, 1] - 1)
    print(f"# 20,000 rays, {count} pings a call: {1e3 * np.median(times[:, 1]) / count:.2f} ms of processor time a ping in C, "
          f"in Python {100 * ratio:+.2f} % ({100 * low:+.2f} to {100 * high:+.2f} with 99 %, {len(times)} pairs)")
    return ratio


def test_overhead_is_below_two_per_cent():
    need_device()
    many, single = overhead(16, MOST_PAIRS // 16, PAIRS // 8), overhead(1, PAIRS, PAIRS)
    tap.equal(many < LIMIT, True, f"{100 * many:.2f} % is below {100 * LIMIT:.0f} %")
    tap.equal(single < MOST_SINGLE, True, f"{100 * single:.2f} % of single pings is below {100 * MOST_SINGLE:.0f} %")


tap.main(globals())
