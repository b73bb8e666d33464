"""Kernels under Oclgrind: no access out of bounds, no race, nothing uninitialised; and the same
intensities whatever the layout of the work.

Oclgrind's exit code stays 0, so its log is read. It is slow: the work is kept small, and the default
tier has test_a_ping alone.
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile

import tap

PROGRAM = os.environ["ASDIC"]
UNIT, LONE_RUN, KERNELS = sys.argv.pop(1), sys.argv.pop(1), sys.argv.pop(1)

WIDE8, PKT16, FRUSTUM64, SCALAR = range(1, 5)  # asdic_ray_kernel
OWNED, ATOMIC64, ATOMIC32 = range(3)           # asdic_deposit

APERTURE = {"length_h_m": 0.05, "length_v_m": 0.05}
STEEL = {"impedance_mrayl": 45, "roughness_rms_mm": 0.2, "slope_rms": 0.2}
SMOOTH = {"impedance_mrayl": 45, "roughness_rms_mm": 0.2, "slope_rms": 0}
FLOOR_OFF = """OFF
9 8 0
-20 -20 11.5\n-20 0 12\n-20 20 11.8\n0 -20 12\n0 0 11.6\n0 20 12\n20 -20 11.7\n20 0 12\n20 20 11.9
3 0 1 3\n3 1 4 3\n3 1 2 4\n3 2 5 4\n3 3 4 6\n3 4 7 6\n3 4 5 7\n3 5 8 7
"""
BOX = {"name": "box", "box": {"size_m": [4, 4, 2]}, "position_m": [10, 0, 11],
       "material": {"type": "rock"}}
PLATE = {"name": "plate", "plate": {"size_m": [2, 2]}, "position_m": [7, 1, 9],
         "rotation_deg": [0, 60, 0], "material": STEEL}
BALL = {"name": "ball", "sphere": {"radius_m": 0.8}, "position_m": [6, -1, 8], "material": STEEL}
BUOY = {"name": "buoy", "point": {"target_strength_db": -20}, "position_m": [8, 0, 6]}


def scene(objects=(), beams=2, sampling=(), **more):
    """As little as reaches what it is about."""
    receivers = [{"name": f"beam{k}", "yaw_deg": 20 * k, **APERTURE} for k in range(beams)]
    if beams > 8:
        receivers = {"fan": {"count": beams, "sector_deg": 90, **APERTURE}}
    return {"version": 1,
            "environment": {"temperature_degc": 10, "wind_speed_kn": 10, "particle_density": "low"},
            "surface": {"enabled": True}, "bottom": {"depth_m": 12, "type": "sand"},
            "objects": list(objects),
            "sonar": {"frequency_khz": 100, "bandwidth_khz": 10, "ping_rate_hz": 50,
                      "source_level_db": 200, "bin_length_m": 0.5, "blanking_m": 0.5,
                      "transmitter": APERTURE, "receivers": receivers},
            "mission": {"pose": {"position_m": [0, 0, 7]}, "pings": 1},
            "sampling": {"rays": 72, "multipath": "off", **dict(sampling)}, **more}




def array_scene():
    """Coherent pings: a plate whose phase counts, a rough one, bottom, surface, water, both mirrors."""
    coherent = scene([{**PLATE, "plate": {"size_m": [0.06, 0.04]}, "material": SMOOTH},
                      {**PLATE, "name": "rough", "position_m": [6, -1, 8]}],
                     sampling={**BOUNDARIES, "coherent": True, "rays": 64})
    sonar = coherent["sonar"]
    del sonar["receivers"], sonar["ping_rate_hz"]
    sonar.update(frequency_khz=20, bandwidth_khz=0.75, bin_length_m=1, max_range_m=9,
                 array={"elements": 3, "beams": {"count": 2, "sector_deg": 40},
                        "element": {"length_v_m": 0.05}})
    return coherent


FIRST, BOUNDARIES = {"multipath": "first"}, {"multipath": "boundaries"}
SCENES = {
    "flat": scene(),
    "three_beams": scene([BALL], beams=3),
    "mesh": scene([BOX], bottom={"mesh": {"file": "floor.off", "z_up": False}, "type": "sand"}),
    "mirrors": scene([BOX, PLATE, BALL], sampling=FIRST),
    "boundaries": scene([PLATE], sampling=BOUNDARIES, beams=9),
    "fan": scene([BOX, PLATE], sampling=FIRST, beams=24),
    "fan_flat": scene(beams=24),
    "point": scene([BOX, BUOY], sampling=FIRST),
    "beam_sampler": scene([BALL], sampling={"sampler": "beam"}),
    "array": array_scene(),
    "sphere_sampler": scene([BALL], sampling={"sampler": "uniform-sphere"}),
}
# Rays a work-item, and the ways to add that go with them: of processors, of GPUs.
LAYOUTS = ((8, OWNED, 16), (16, OWNED, 4), (1, ATOMIC32, 64), (1, ATOMIC64, 8), (1, OWNED, 1))


# Oclgrind 21.10 takes the upper half of a vector of sixteen for uninitialised, and crashes where one is
# joined of several, also in kernels of one line. These say the same lane by lane.
EACH = "for (int k = 0; k < 8; k++) ((float *)&{})[{}] = ((float *)&{})[{}];"


def joined(*parts):
    """What fan_sums.h joins of several, e.g. a.s01, and the same of single lanes."""
    lanes = [f"{name}.s{digit}" for name, digits in (part.split(".s") for part in parts) for digit in digits]
    return "fan_sums.h", f"(real)({', '.join(parts)})", f"(real)({', '.join(lanes)})"


LANE_BY_LANE = (
    joined("a.s01", "b.s01", "a.s45", "b.s45", "a.s89", "b.s89", "a.scd", "b.scd"),
    joined("a.s23", "b.s23", "a.s67", "b.s67", "a.sab", "b.sab", "a.sef", "b.sef"),
    *(joined(*(f"{name}.s{four}" for name in "abcd")) for four in ("0123", "4567", "89ab", "cdef")),
    ("lanes.h", "bits8(m.lo) | bits8(m.hi) << 8", "bits8(m.lo) | bits8(((int8 *)&m)[1]) << 8"),
    ("trace_lanes.h", "LESSER(v.lo, v.hi)", "LESSER(v.lo, ((float8 *)&v)[1])"),
    ("trace_lanes.h", "out.c[i] = (float16)(a.even, b.even);",
     EACH.format("out.c[i]", "k", "a", "2 * k") + EACH.format("out.c[i]", "8 + k", "b", "2 * k")),
    ("trace_lanes.h", "out.c[4 + i] = (float16)(a.odd, b.odd);",
     EACH.format("out.c[4 + i]", "k", "a", "2 * k + 1")
     + EACH.format("out.c[4 + i]", "8 + k", "b", "2 * k + 1")),
    ("trace_lanes.h", "low.even = t_m.lo;", EACH.format("low", "2 * k", "t_m", "k")),
    ("trace_lanes.h", "low.odd = id.lo;", EACH.format("low", "2 * k + 1", "id", "k")),
    ("trace_lanes.h", "high.even = t_m.hi;", EACH.format("high", "2 * k", "t_m", "8 + k")),
    ("trace_lanes.h", "high.odd = id.hi;", EACH.format("high", "2 * k + 1", "id", "8 + k")),
    ("trace_bundle.h", "(float16)(c.xxxx, c.yyyy, c.zzzz, c.wwww)", "c.xxxxyyyyzzzzwwww"),
    ("trace_bundle.h", "(float16)(h.xxxx, h.yyyy, h.zzzz, h.wwww)", "h.xxxxyyyyzzzzwwww"),
)


def write_kernels(folder):
    """A copy of the kernels that Oclgrind can follow."""
    copy = os.path.join(folder, "kernels")
    shutil.copytree(KERNELS, copy)
    for name, text, lanes in LANE_BY_LANE:
        path = os.path.join(copy, name)
        with open(path, encoding="utf-8") as file:
            before = file.read()
        tap.equal(before.count(text), 1, f"how often '{text}' is in {name}")
        with open(path, "w", encoding="utf-8") as file:
            file.write(before.replace(text, lanes))
    return copy


def under_oclgrind(*command, checks=("--data-races", "--uninitialized"), **env):
    """Runs COMMAND; -cl-opt-disable because Oclgrind 21.10 lacks intrinsics of inlining."""
    if not shutil.which("oclgrind"):
        raise tap.Skip("there is no oclgrind")
    with tempfile.TemporaryDirectory() as folder:
        log = os.path.join(folder, "log")
        done = subprocess.run(["oclgrind", "--build-options", "-cl-opt-disable", *checks,
                               "--max-errors", "5", "--log", log, *command], check=False,
                              capture_output=True, text=True, timeout=900, env={**os.environ, **env})
        text = ""
        if os.path.exists(log):
            with open(log, encoding="utf-8") as file:
                text = file.read()
    tap.equal(text, "", f"Oclgrind's log of {' '.join(map(str, command))}")
    tap.equal(done.returncode, 0, f"exit code ({done.stderr[-2000:]})")
    return done.stdout


def write_scene(folder, name):
    files = {"floor.off": FLOOR_OFF, "scene.yaml": json.dumps(SCENES[name])}
    for file_name, text in files.items():
        with open(os.path.join(folder, file_name), "w", encoding="utf-8") as file:
            file.write(text)
    return os.path.join(folder, "scene.yaml")


def ping(name, kernel, layout):
    with tempfile.TemporaryDirectory() as folder:
        path = write_scene(folder, name)
        return under_oclgrind(LONE_RUN, path, *map(str, (kernel, *layout)),
                              ASDIC_KERNEL_DIR=write_kernels(folder))


def test_buffers_and_simple_kernels():
    tap.contains(under_oclgrind(UNIT), "[       OK ] kernel_computes")


def check_ping(name, kernel):
    printed = ping(name, kernel, LAYOUTS[0])
    tap.equal(max(map(float.fromhex, printed.split())) > 0, True, "something comes back")


def test_a_ping():
    check_ping("point", FRUSTUM64)


def test_a_fan():
    check_ping("fan_flat", WIDE8)


def test_every_way_to_trace():
    """Alone, in packets of sixteen and sixty-four, one ray a work-item: the same intensities."""
    for name in ("mirrors", "mesh"):
        found = {ping(name, kernel, LAYOUTS[0])
                 for kernel in (WIDE8, PKT16, FRUSTUM64, SCALAR)}
        tap.equal(len(found), 1, f"kinds of intensities of {name}")


def check_layouts(name):
    """Rays a work-item change last bits; how they add, and the size of work-groups, nothing."""
    found = {}
    for number, layout in enumerate(LAYOUTS):
        kernel = (WIDE8, PKT16, SCALAR, FRUSTUM64)[number % 4]
        found.setdefault(layout[0], set()).add(ping(name, kernel, layout))
    for width, printed in found.items():
        tap.equal(len(printed), 1, f"kinds of intensities of {name}, {width} rays together")


for scene_name in SCENES:
    globals()[f"test_{scene_name}_in_every_layout"] = lambda name=scene_name: check_layouts(name)


def test_a_run():
    """The program itself. Without --uninitialized, on which Oclgrind 21.10 crashes where threads
    write to it."""
    with tempfile.TemporaryDirectory() as folder:
        under_oclgrind(PROGRAM, "run", write_scene(folder, "mirrors"), "-o",
                       os.path.join(folder, "run"), checks=("--data-races",))


tap.main(globals())
