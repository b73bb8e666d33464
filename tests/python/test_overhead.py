"""What a ping costs more in Python than in C: pose in, levels out, turn and turn about.

The loop in C is the library's own, asdic_simulator_pings of one pose and asdic_ping_levels. The difference
is a fixed time a ping, so that it is measured where pings are shortest, and stated of a ping of 20,000 rays;
the ratio of the two loops at 20,000 rays is printed beside it, with the machine's noise in it. Times are
tenth percentiles.
"""
import os
import time

from package import ROOT, need_device
import tap

import numpy as np
import asdic
from asdic._native import ffi, lib

SCENE = os.path.join(ROOT, "data", "scenes", "scenario2.yaml")


def timed(function):
    began = time.perf_counter()
    function()
    return 1e6 * (time.perf_counter() - began)


def loops(rays, count):
    """Microseconds of a ping in C and in Python."""
    sonar = asdic.Simulator(SCENE, rays=rays)
    first = sonar.ping(0, 0, 7)
    simulator, room = sonar._handle.pointer, first._struct  # pylint: disable=protected-access
    tap.equal(lib.asdic_simulator_ping_batch(simulator) >= 1, True, "pings together")
    pose, pings = ffi.new("asdic_pose[]", [{"position_m": (0, 0, 7)}]), ffi.new("asdic_ping *[]", [room])
    levels = np.empty(first.level_db.shape, np.float32)
    place = ffi.from_buffer("float[]", levels)

    def in_c():
        lib.asdic_simulator_pings(simulator, pose, 1, 1, pings)
        lib.asdic_ping_levels(room, lib.ASDIC_TOTAL, place)

    def in_python():
        return sonar.ping(0, 0, 7).level_db
    c, python = [], []
    for _ in range(count):
        sonar.index = 1  # neither loop learns, and both draw the same rays
        c.append(timed(in_c))
        python.append(timed(in_python))
    tap.equal(np.array_equal(levels, in_python_levels(sonar), equal_nan=True), True, "both simulate the same ping")
    return np.percentile(c, 10), np.percentile(python, 10)


def in_python_levels(sonar):
    sonar.index = 1
    return sonar.ping(0, 0, 7).level_db


def test_overhead_is_below_two_per_cent():
    need_device()
    short_c, short_python = loops(64, 600)
    c, python = loops(20000, 200)
    fixed = short_python - short_c
    print(f"# Python adds {fixed:.0f} us to a ping: {100 * fixed / c:.2f} % of {c:.0f} us in C at 20,000 rays "
          f"(the loops themselves: {100 * (python / c - 1):+.2f} %)")
    tap.equal(fixed / c < 0.02, True, f"{100 * fixed / c:.2f} % is below 2 %")


tap.main(globals())
