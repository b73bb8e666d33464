"""The Python package of the build folder, for tests; without it, or numpy, they end with 77."""
import os
import sys

try:
    import numpy  # pylint: disable=unused-import
    import asdic
except ImportError as error:
    print(f"1..0 # SKIP {error}")
    sys.exit(77)

import tap

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))


def need_device():
    """Skips the test where no OpenCL device is usable."""
    if not any(device.usable for device in asdic.devices()):
        raise tap.Skip("there is no OpenCL device")


def raises(kind, part, function, *args, **keys):
    """FUNCTION raises exactly KIND, with PART in its sentence; returns the exception."""
    try:
        result = function(*args, **keys)
    except Exception as error:  # pylint: disable=broad-except
        tap.equal(type(error), kind, f"{error!r}: kind")
        tap.contains(str(error), part)
        return error
    raise AssertionError(f"nothing was raised, but {result!r} came back")


def pool(**sections):
    """A small scene: a ball over sand, two beams, cheap."""
    keys = {"bottom": {"depth_m": 12, "type": "sand"},
            "sonar": {"frequency_khz": 100, "bandwidth_khz": 10, "ping_rate_hz": 20, "source_level_db": 200,
                      "bin_length_m": 1, "receivers": [{"name": "forward"}, {"name": "down", "pitch_deg": 45}]},
            "mission": {"pose": {"position_m": [0, 0, 5]}, "pings": 3},
            "sampling": {"rays": 1000, "seed": 7}, "output": {"csv": "none", "images": []}, **sections}
    scene = asdic.Scene(**keys)
    scene.add("ball", sphere={"radius_m": 1}, position_m=(20, 0, 6), material={"impedance_mrayl": 45})
    return scene
