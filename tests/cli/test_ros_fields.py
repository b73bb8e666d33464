"""data/examples/projected_sonar_image.py: pings through ctypes as a ROS message's fields, against what
asdic run writes of the same scene."""
import csv
import importlib.util
import math
import os
import struct
import subprocess
import sys
import types

import program
import tap
from program import Folder, asdic
from run_folder import data, scene

CLIENT = os.path.join(os.path.dirname(__file__), *[".."] * 2, "data", "examples",
                      "projected_sonar_image.py")
LIBRARY = os.environ["LIBASDIC"]
FAN = ("    fan: {count: 12, sector_deg: 90, length_h_m: 0.1, length_v_m: 0.05}\n"
       "  transmitter: {length_h_m: 0.01, length_v_m: 0.04}")

spec = importlib.util.spec_from_file_location("client", CLIENT)
client = importlib.util.module_from_spec(spec)
sys.dont_write_bytecode = True
spec.loader.exec_module(client)


def need_library():
    with open(LIBRARY, "rb") as file:
        if b"__asan_init" in file.read():
            raise tap.Skip("an instrumented library cannot be loaded into Python")


def messages(folder, **options):
    program.need_device()
    need_library()
    path = scene(folder, pings=3, receivers=FAN)
    return path, list(client.pings(path, LIBRARY, **options))


def test_levels_are_those_of_the_run():
    with Folder() as folder:
        path, found = messages(folder)
        asdic("run", path, "-o", folder / "r").check(code=0)
        rows = list(csv.DictReader(data(folder, "r", "bins.csv").decode().splitlines()))
        tap.equal(len(found), 3, "pings")
        for ping, fields in enumerate(found):
            image, ranges = fields["image"], fields["ranges"]
            tap.equal((image["dtype"], image["beam_count"], image["is_bigendian"]), (8, 12, False))
            tap.equal(len(image["data"]), 4 * 12 * len(ranges), "bytes")
            levels = struct.unpack(f"<{12 * len(ranges)}f", image["data"])
            of_ping = [r for r in rows if r["ping"] == str(ping)]
            tap.equal(len(of_ping), len(levels), "levels")
            for row in of_ping:
                bin_, beam = int(row["bin"]), int(row["beam"])
                level = levels[bin_ * 12 + beam]
                near = math.isnan(level) if row["level_db"] == "" else \
                    abs(level - float(row["level_db"])) < 2e-3
                if not near or abs(ranges[bin_] - float(row["range_m"])) > 1e-9:
                    raise AssertionError((row, level, ranges[bin_]))
            stamp = fields["header"]["stamp"]
            tap.equal(stamp["sec"] + stamp["nanosec"] / 1e9, 0.05 * ping, "stamp")


def test_geometry():
    with Folder() as folder:
        fields = messages(folder, count=1)[1][0]
        bearings = [math.degrees(math.atan2(-d["y"], d["z"])) for d in fields["beam_directions"]]
        tap.equal([round(b, 6) for b in (bearings[0], bearings[-1])], [-41.25, 41.25],
                  "port first, positive to starboard")
        tap.equal({round(math.hypot(d["x"], d["y"], d["z"]), 12) for d in fields["beam_directions"]},
                  {1.0}, "length")
        info = fields["ping_info"]
        tap.equal((info["frequency"], len(info["rx_beamwidths"]), len(info["tx_beamwidths"])),
                  (1e5, 12, 12))
        wavelength_m = info["sound_speed"] / 1e5
        # Half power: sin(x) / x is 0.70711 at x = pi L sin(theta) / wavelength.
        for width, length_m in ((info["rx_beamwidths"][0], 0.1), (info["tx_beamwidths"][0], 0.04)):
            x = math.pi * length_m * math.sin(width / 2) / wavelength_m
            tap.equal(round((math.sin(x) / x) ** 2, 5), 0.5, "power at the beam's edge")


def test_bytes_for_viewers():
    with Folder() as folder:
        _, floats = messages(folder, count=1)
        _, small = messages(folder, count=1, window_db=(60, 120))
        tap.equal((small[0]["image"]["dtype"], len(small[0]["image"]["data"]) * 4),
                  (0, len(floats[0]["image"]["data"])))
        levels = struct.unpack(f"<{len(small[0]['image']['data'])}f", floats[0]["image"]["data"])
        for level, grey in zip(levels, small[0]["image"]["data"]):
            expected = 0 if math.isnan(level) else 255 * min(max((level - 60) / 60, 0), 1)
            if abs(grey - expected) > 0.51:
                raise AssertionError((level, grey))


def test_fields_fill_a_message():
    """Stand-ins for ROS's classes: attributes that exist, and nothing else."""
    class Vector3:
        def __init__(self, x, y, z):
            self.x, self.y, self.z = x, y, z

    class Part:
        def __init__(self, **parts):
            self.__dict__.update(parts)

        def __setattr__(self, name, value):
            if name not in self.__dict__:
                raise AttributeError(name)
            self.__dict__[name] = value

    sys.modules["geometry_msgs"] = types.ModuleType("geometry_msgs")
    sys.modules["geometry_msgs.msg"] = sys.modules["geometry_msgs"].msg = types.ModuleType("msg")
    sys.modules["geometry_msgs.msg"].Vector3 = Vector3
    target = Part(header=Part(stamp=Part(sec=0, nanosec=0), frame_id=""),
                  ping_info=Part(frequency=0, sound_speed=0, tx_beamwidths=[], rx_beamwidths=[]),
                  beam_directions=[], ranges=[],
                  image=Part(is_bigendian=True, dtype=0, beam_count=0, data=b""))
    with Folder() as folder:
        client.fill(target, messages(folder, count=1)[1][0])
    tap.equal((target.header.frame_id, target.image.beam_count, len(target.beam_directions)),
              ("sonar", 12, 12))
    tap.equal(target.beam_directions[0].y > 0, True, "the first beam looks to port")


def test_script_says_what_is_strongest():
    with Folder() as folder:
        path = messages(folder, count=0)[0]
        done = subprocess.run([sys.executable, CLIENT, path, LIBRARY, "2"], check=True,
                              capture_output=True, text=True, timeout=60)
        tap.equal(len(done.stdout.splitlines()), 2, "lines")
        tap.contains(done.stdout, "t = 0.05 s: ")
        done = subprocess.run([sys.executable, CLIENT, folder / "none.yaml", LIBRARY], check=False,
                              capture_output=True, text=True, timeout=60)
        tap.equal(done.returncode, 1)
        tap.contains(done.stderr, "none.yaml")


tap.main(globals())
