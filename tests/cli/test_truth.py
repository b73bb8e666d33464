"""What bins hold, through runs: truth.npy, resumed and joined, levels that stay, netCDF, names in
detections."""
import json
import os
import subprocess

import program
import tap
from foreign import numpy
from program import Folder, asdic

SCENE = """version: 1
bottom: {depth_m: 10, type: sand}
objects:
  - {name: near, sphere: {radius_m: 0.8}, position_m: [9, 0, 9.2], material: {lambert_db: -8}}
  - {name: far, box: {size_m: [1, 1, 1]}, position_m: [9.5, 2, 9], material: {lambert_db: -8}}
sonar:
  frequency_khz: 100
  ping_rate_hz: 20
  source_level_db: 200
  bandwidth_khz: 5
  bin_length_m: 0.25
  receivers: [{name: a}, {name: b, yaw_deg: 15}]
  speckle: rayleigh
mission: {pose: {position_m: [0, 0, 7]}, pings: 4}
sampling: {rays: 2000}
output: {npy: true, netcdf: true, truth: true}
"""


def data(folder, name):
    with open(folder / name, "rb") as file:
        return file.read()


def write(folder):
    path = folder.write("t.yaml", SCENE)
    if "no netCDF" in asdic("run", path, "-o", folder / "probe", "--pings", "0:1").err:
        path = folder.write("t.yaml", SCENE.replace("netcdf: true, ", ""))
    return path


def test_runs_keep_it():
    program.need_device()
    with Folder() as folder:
        path = write(folder)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        plain = folder.write("plain.yaml", folder.read("t.yaml").replace(", truth: true", ""))
        asdic("run", plain, "-o", folder / "plain").check(code=0)
        tap.equal(data(folder, "plain/levels.npy") == data(folder, "whole/levels.npy"), True, "levels")
        tap.equal(os.path.exists(folder / "plain/truth.npy"), False, "truth that nobody asked for")
        whole = data(folder, "whole/truth.npy")
        for k in (1, 2):
            asdic("run", path, "--shard", f"{k}/2", "-o", folder / f"p{k}").check(code=0)
        asdic("merge", folder / "p1", folder / "p2", "-o", folder / "m").check(code=0)
        tap.equal(data(folder, "m/truth.npy") == whole, True, "joined")
        os.remove(folder / "whole/truth.npy")
        asdic("run", path, "-o", folder / "whole", "--resume").check(code=0)
        tap.equal(data(folder, "whole/truth.npy") == whole, True, "resumed")
        done = asdic("detect", folder / "whole", "--json").check(code=0)
        tap.contains(done.out, '"near"')
        tap.contains(done.out, '"far"')
        numpy("""
import numpy as np
t, p = np.load("whole/truth.npy"), np.load("whole/pings.npy")
assert t.shape == (4,) and t["strongest"].shape == (4, 2, p["level_db"].shape[2])
total = sum(t[n].astype(float) for n in ("direct", "by_surface", "by_bottom", "by_object", "noise"))
assert abs(total - 1).max() < 1e-5
assert {1, 2, -1} <= set(np.unique(t["strongest"]))
own = 10 ** (p["object_db"] / 10)
rest = sum(np.nan_to_num(10 ** (p[n] / 10)) for n in
           ("bottom_db", "surface_db", "volume_db", "object_db", "multipath_db", "noise_db"))
share = np.nan_to_num(own / rest)
assert (t["object_share"] <= share + 1e-5).all() and (t["object_share"] >= share / 2 - 1e-5).all()
assert (t["strongest"][t["object_share"] > 0.5] > 0).all()
assert (t["object"][t["object_share"] == 0] == 0).all() and (t["object_share"] == 0).any()
assert (t["ping"] == p["ping"]).all() and not set(t.dtype.names) & set(p.dtype.names) - {"ping", "crc32"}
# Right below the sonar the bottom is 3 m away, and what comes back from farther comes from less far down.
down = t["depression_rad"][:, :, [13, 30, 60]]
assert (np.diff(down, axis=2) < 0).all() or not np.isfinite(down).all()
""", folder / ".")
        if os.path.exists(folder / "whole/run.nc") and os.path.exists("/usr/bin/ncdump"):
            dump = subprocess.run(["/usr/bin/ncdump", "-h", folder / "whole/run.nc"],
                                  capture_output=True, text=True, check=True).stdout
            tap.contains(dump, "short strongest(ping_time, beam, ")
            tap.contains(dump, 'depression_rad:units = "rad"')


def test_damage_is_noticed():
    program.need_device()
    with Folder() as folder:
        path = write(folder)
        asdic("run", path, "-o", folder / "run").check(code=0)
        whole = {name: data(folder, "run/" + name) for name in ("truth.npy", "pings.npy", "levels.npy")}
        each = (len(whole["truth.npy"]) - whole["truth.npy"].index(b"\n") - 1) // 4

        def again():
            told = asdic("run", path, "-o", folder / "run", "--resume").check(code=0).err
            for name, bytes_ in whole.items():
                tap.equal(data(folder, "run/" + name) == bytes_, True, name)
            return told

        for at in (-each - each // 2, -each - 2):  # a field and the sum of ping 2
            bad = bytearray(whole["truth.npy"])
            bad[at] ^= 4
            with open(folder / "run/truth.npy", "wb") as file:
                file.write(bad)
            for command in (["detect", folder / "run"], ["merge", folder / "run", "-o", folder / "m"]):
                done = asdic(*command).check(code=3)
                tap.contains(done.err, "truth.npy' is damaged: ping 2 is not as it was written")
            tap.contains(asdic("run", path, "-o", folder / "run", "--resume").check(code=0).err, "ping 2 is not")
            again()
        os.remove(folder / "run/truth.npy")
        tap.contains(asdic("render", folder / "run").check(code=3).err, "truth.npy")
        again()
        # Interrupted after the truth of two pings and the levels of three.
        for name, left in (("truth.npy", -2 * each + 100), ("pings.npy", -700)):
            os.remove(folder / ("run/" + name))
            with open(folder / ("run/" + name + ".part"), "wb") as file:
                file.write(whole[name][:left])
        tap.equal("truth.npy" in again(), False, "what was never written is not damaged")


SIDE_BY_SIDE = """version: 1
bottom: {{depth_m: 22, type: sand}}
objects:
{objects}
sonar:
  frequency_khz: 100
  bandwidth_khz: 5
  max_range_m: 60
  ping_rate_hz: 5
  source_level_db: 205
  bin_length_m: 0.6
  receivers: {{fan: {{count: 3, sector_deg: 50, length_h_m: 0.05, length_v_m: 0.05}}}}
  speckle: rayleigh
mission: {{pose: {{position_m: [0, 0, 9], pitch_deg: -4}}, pings: 10}}
sampling: {{rays: 20000}}
output: {{csv: none, images: []{truth}}}
"""


def test_echoes_have_the_names_of_what_is_loudest():
    """Without truth a name is a reckoning. A point beside a wall at a slant had none of 30 bins, one before a quiet box
    none, one in a box some of the box's."""
    program.need_device()
    fish = "{name: fish, point: %g, position_m: [%g, 0, 10]}"
    box = "{name: box, box: {size_m: [2, %g, 8]}, rotation_deg: [0, 0, %g], position_m: [%g, 0, 12], material: {%s}}"
    steel = "preset: steel, roughness_rms_mm: 0.05, slope_rms: 0.02"
    with Folder() as folder:
        for name, objects in (("slant", (fish % (-15, 28.9), box % (12, 40, 31, steel))),
                                    ("quiet", (fish % (-8, 30), box % (8, 0, 31.2, "lambert_db: -55"))),
                                    ("inside", (fish % (0, 31), box % (8, 0, 31, "lambert_db: -20")))):
            rows = []
            for truth in "", ", truth: true":
                folder.write("two.yaml", SIDE_BY_SIDE.format(objects="\n".join(f"  - {o}" for o in objects), truth=truth))
                done = asdic("detect", "two.yaml", "-o", folder / "two", "-f", "-q", "--json", "--cell", "4", cwd=folder.path)
                rows.append({row["truth"]: row["bins"] for row in json.loads(done.check(code=0).out)["confusion"]})
            tap.equal(rows[0], rows[1], f"{name}: bins with names")
            tap.equal(rows[0]["fish"] > 0, name != "inside", f"{name}: {rows[0]}")


tap.main(globals())
