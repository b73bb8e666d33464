"""What pings cost more in Python than in C: poses in, levels out, turn and turn about.

The loop in C is the library's own, asdic_simulator_pings and asdic_ping_levels, of as many poses a call as in
Python. Both draw the same rays and follow each other, so that what else runs on the machine slows down both; compared is
the processor time of the process, pair by pair. The median of the ratios has an interval from its order
statistics, which hold whatever the ratios' distribution is; pairs are added until it lies on one side of
the limit.

After a single ping Python's own code is no longer in the processor's caches, and the less so the more runs beside:
single pings are compared by the quickest twentieth of the calls of each loop, which were left alone. Machines differ
by more than the limit, from 1 to 3 % of one ping: five times as much is allowed, and the share is printed.
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
LIMIT = 0.02
PAIRS, MOST_PAIRS = 25, 125  # of 16 pings a call
SINGLE_PAIRS, MOST_SINGLE_PAIRS, QUICKEST = 250, 1000, 0.05


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


def loops_of(count):
    """20,000 rays a ping, COUNT pings a call."""
    loops = Loops(20000, count)
    loops.pairs(4)
    tap.equal(np.array_equal(loops.levels, loops.in_python(), equal_nan=True), True, "both simulate the same pings")
    return loops


def test_overhead_of_many_pings_a_call():
    """The median share that Python adds."""
    need_device()
    loops, times, low, high = loops_of(16), np.empty((0, 2)), -1.0, 1.0
    while low < LIMIT < high and len(times) < MOST_PAIRS:
        times = np.concatenate([times, loops.pairs(PAIRS)])
        ratio, low, high = median_interval(times[:, 0] / times[:, 1] - 1)
    print(f"# 16 pings a call: {1e3 * np.median(times[:, 1]) / 16:.2f} ms of processor time a ping in C, in Python "
          f"{100 * ratio:+.2f} % ({100 * low:+.2f} to {100 * high:+.2f} with 99 %, {len(times)} pairs)")
    tap.equal(ratio < LIMIT, True, f"{100 * ratio:.2f} % is below {100 * LIMIT:.0f} %")


def test_overhead_of_single_pings():
    """The share that Python adds to the quickest."""
    need_device()
    loops, times, ratio = loops_of(1), np.empty((0, 2)), 1.0
    while ratio >= LIMIT and len(times) < MOST_SINGLE_PAIRS:
        times = np.concatenate([times, loops.pairs(SINGLE_PAIRS)])
        python_s, c_s = np.quantile(times, QUICKEST, axis=0)
        ratio = python_s / c_s - 1
    print(f"# single pings: {1e3 * c_s:.2f} ms of processor time in C, in Python {100 * ratio:+.2f} %, by the quickest of "
          f"{len(times)} pairs; the median of all pairs is {100 * np.median(times[:, 0] / times[:, 1] - 1):+.2f} %")
    tap.equal(ratio < 5 * LIMIT, True, f"{100 * ratio:.2f} % is below {500 * LIMIT:.0f} %")


tap.main(globals())
