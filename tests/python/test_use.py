"""What users of the Python package do, against what the library and the program give."""
import csv
import faulthandler
import gc
import json
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time
import warnings
import weakref
from unittest import mock

from package import ROOT, need_device, pool, raises
import tap

import numpy as np
import asdic
from asdic._native import ffi, lib


def same(a, b, what):
    tap.equal(np.array_equal(a, b, equal_nan=True), True, what)


def test_run_is_the_programs():
    """The same scene by `asdic run`: levels and errors, and the table."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        path = os.path.join(folder, "scene.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(pool().to_json())
        out = os.path.join(folder, "out")
        subprocess.run([os.environ["ASDIC"], "run", "-q", path, "-o", out], check=True)
        program, here = asdic.Run(out), asdic.simulate(pool())
        tap.equal(here.level_db.shape, (3, 2, 37), "ping, beam, bin")
        same(here.level_db, program.level_db, "levels")
        same(here.stderr_db, program.stderr_db, "errors")
        for name in here.parts:
            same(here.parts[name], program.parts[name], name)
        tap.equal(set(here.parts), {"bottom", "surface", "volume", "object", "multipath", "noise"}, "parts")
        subprocess.run([os.environ["ASDIC"], "expect", "-q", path, "-o", os.path.join(folder, "e.csv")], check=True)
        expected = asdic.expect(path)
        same(here.expect(1).level_db, expected.level_db, "the run's expectation")
        with open(os.path.join(folder, "e.csv"), encoding="ascii", newline="") as file:
            for row, level in zip(csv.DictReader(file), expected.level_db.ravel(), strict=True):
                said = float(row["total_db"] or "nan")
                tap.equal(abs(said - level) < 1e-3 or said != said and level != level, True, f"{row}: {level}")


def test_simulator_gives_the_missions_bytes():
    need_device()
    scene = pool()
    run = asdic.simulate(scene)
    with asdic.Simulator(scene) as sonar:
        for k, ping in enumerate(sonar.fly()):
            same(ping.level_db, run.level_db[k], f"levels of ping {k}")
            same(ping.parts["object"], run.parts["object"][k], f"objects of ping {k}")
            tap.equal((ping.index, ping.time, ping.altitude), (k, 0.05 * k, 7.0), "facts")
        tap.equal(sonar.index, 3, "pings")
        same(sonar.ranges, run.ranges, "ranges")
        tap.equal(list(sonar.beams["name"]), ["forward", "down"], "beams")


def test_errors_of_bins_without_energy():
    """Unknown, of pings as of runs."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-"):
        scene = asdic.Scene.open(os.path.join(ROOT, "data", "scenes", "scenario2_summer.yaml"))
        scene.model, scene.output = {"terms": "all", "refraction": "full"}, {"csv": "none", "images": []}
        run = asdic.simulate(scene, rays=2000, pings=slice(0, 1))
        with asdic.Simulator(scene, rays=2000) as sonar:
            ping = next(sonar.fly())
            same(ping.level_db, run.level_db[0], "levels")
            same(ping.stderr_db, run.stderr_db[0], "errors")
            tap.equal(bool(np.isnan(ping.stderr_db).any()), True, "bins without energy")
            again = sonar.ping(0, 0, 5, out=ping)
            same(np.isnan(again.stderr_db), again.intensity["total"] == 0, "of memory that is used again")


def test_pings_of_many_poses():
    """In one call, the pings that they are one by one, over blocks of learning; of a scanned head too."""
    need_device()
    head = asdic.Scene.open(os.path.join(ROOT, "data", "scenes", "sonar_ping360.yaml"))
    for scene, rays in ((pool(), 500), (head, 500)):
        poses = np.array([[0.5 * k, 0.1 * k, 5, 1, 2, 3 * k] for k in range(40)])
        with asdic.Simulator(scene, rays=rays) as many, asdic.Simulator(scene, rays=rays) as single:
            found = many.pings(poses[:3]) + many.pings(poses[3:])
            tap.equal(len(found), 40, "pings")
            for ping, pose in zip(found, poses.tolist(), strict=True):
                one = single.ping(*pose)
                same(ping.level_db, one.level_db, f"levels of ping {one.index}")
                tap.equal((ping.index, ping.time, ping.pose, ping.altitude), (one.index, one.time, one.pose, one.altitude),
                          "facts")
            same(many.pings([[1, 2, 5]])[0].level_db, single.ping(1, 2, 5).level_db, "without attitude")
            tap.equal((many.pings([]), many.pings(np.empty((0, 6)))), ([], []), "no poses")


def test_simulator_keeps_the_missions_clock():
    """A mission that begins at 30 s, of a fish that swims 100 m/s: as the run has it, flown, and in one call."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        for name, row in (("way.csv", "{0},{1},1,5,0,2,0"), ("fish.csv", "{0},{2},0,5,0,0,0")):
            with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                file.write("time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + "".join(
                    row.format(t, 0.5 * (t - 30), 100 * (t - 30) + 10) + "\n" for t in (30, 31)))
        scene = pool(mission={"track": os.path.join(folder, "way.csv"), "pings": 4},
                     model={"terms": "all", "refraction": "full"})
        scene.objects = [{"name": "fish", "point": 0, "track": os.path.join(folder, "fish.csv")}]
        run = asdic.simulate(scene)
        tap.equal(np.allclose(run.times, [30, 30.05, 30.1, 30.15]), True, f"times {run.times}")
        heard = [int(np.flatnonzero(np.isfinite(levels[0]))[0]) for levels in run.parts["object"]]
        tap.equal(heard, sorted(set(heard)), "bins of the fish")
        poses = np.hstack([run.positions, np.degrees(run.attitudes)])
        for pings in (list(asdic.Simulator(scene).fly()), asdic.Simulator(scene).pings(poses)):
            for k, ping in enumerate(pings):
                same(ping.level_db, run.level_db[k], f"levels of ping {k}")
                tap.equal(abs(ping.time - run.times[k]) < 1e-9, True, f"time {ping.time} of ping {k}")


def test_simulator_goes_where_no_mission_does():
    """What its scene's mission never hears is there; rays are those of `asdic serve` where the scene leaves them."""
    need_device()
    near = {**pool().sonar, "max_range_m": 6}
    tap.equal([t.kept for t in asdic.plan(pool(sonar=near)).terms if t.name == "bottom"], [False], "left out of a run")
    sonar = asdic.Simulator(pool(sonar=near))
    tap.equal(bool(np.isfinite(sonar.ping(0, 0, 8).parts["bottom"][1]).any()), True, "the bottom 4 m below")
    fan = {**pool().sonar, "receivers": {"fan": {"count": 256, "sector_deg": 120, "length_h_m": 1, "length_v_m": 0.05}}}
    tap.equal(asdic.plan(pool(sonar=fan, sampling={})).rays.rays > 20000, True, "rays of a run")
    tap.equal(asdic.Simulator(pool(sonar=fan, sampling={})).rays, 20000, "rays of a simulator")


def test_scanned_head_turns():
    """A scan's ping is that of a mission: the head's own direction."""
    need_device()
    scene = pool(sonar={"frequency_khz": 100, "bandwidth_khz": 10, "ping_rate_hz": 20, "source_level_db": 200,
                        "bin_length_m": 1, "receivers": [{"name": "head"}],
                        "scan": {"sector_deg": 360, "step_deg": 90}},
                 mission={"pose": {"position_m": [0, 0, 5]}, "pings": 4})
    run = asdic.simulate(scene)
    for k, ping in enumerate(asdic.Simulator(scene).fly()):
        same(ping.level_db, run.level_db[k], f"ping {k}")
        tap.equal(abs(ping.pose.yaw_rad - run.attitudes[k, 2]) < 1e-12, True, f"the head at ping {k}")
    try:
        data = run.to_xarray()
    except ImportError:
        return
    looks = (data.bearing + np.degrees(data.yaw)).isel(beam=0) % 360
    tap.equal(sorted(np.round(looks.values).tolist()), [0, 90, 180, 270], "where the beam looks at each ping")
    tap.equal(data.bearing.attrs["long_name"], "to starboard of yaw, of a scanned sonar its head's", "what a bearing is of")


def box(size):
    """Corners and triangles of a box round the origin, facets outwards."""
    corners = np.array([[x, y, z] for x in (-.5, .5) for y in (-.5, .5) for z in (-.5, .5)]) * size
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return corners, np.array([t for a, b, c, d in faces for t in ((a, b, c), (a, c, d))])


def test_scene_of_a_file():
    """Opened, it is the file's; what is added is there beside it; files it names are found from anywhere."""
    need_device()
    scenes = os.path.join(ROOT, "data", "scenes")
    with open(os.path.join(scenes, "survey.yaml"), encoding="utf-8") as file:
        tap.contains(file.read(), "track: ../")
    for name in sorted(os.listdir(scenes)):
        path = os.path.join(scenes, name)
        if name.endswith(".yaml"):
            tap.equal(asdic.plan(asdic.Scene.open(path)).terms, asdic.plan(path).terms, name)
    ball = {"name": "ball", "sphere": {"radius_m": 1}, "position_m": [20, 0, 6], "material": {"impedance_mrayl": 45}}
    listed = asdic.Scene(**{name: getattr(pool(), name) for name in ("bottom", "sonar", "mission")}, objects=[ball])
    tap.equal(listed.objects, pool().objects, "objects as a list")
    scene = asdic.Scene.open(os.path.join(scenes, "scenario2.yaml"))
    one = asdic.simulate(os.path.join(scenes, "scenario2.yaml"), rays=2000)
    same(asdic.simulate(scene, rays=2000).level_db, one.level_db, "levels")
    scene.sampling = {**scene.sampling, "seed": 5}
    scene.add("wall", box={"size_m": [1, 20, 4]}, position_m=(40, 0, 8), material="steel")
    tap.equal(np.array_equal(asdic.simulate(scene, rays=2000).level_db, one.level_db, equal_nan=True), False, "changed")
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        path = os.path.join(folder, "scene.yaml")
        for line, value in {"off": False, "yes": True, "1.": 1.0, "+2.5e1": 25.0, "007": "007", "1_0": "1_0", "~": None,
                            "sand": "sand", "'12'": "12", "18446744073709551615": 18446744073709551615,
                            "0.1": 0.1, "{}": {}, "[]": []}.items():
            with open(path, "w", encoding="utf-8") as file:
                file.write(f"sampling: {{key: {line}}}\n")
            tap.equal(asdic.Scene.open(path).sampling["key"], value, line)
        with open(path, "w", encoding="utf-8") as file:
            file.write("bottom: {grid: g.asc}\nobjects: [{name: mesh, mesh: /x.ply}]\n"
                       "draws: [{key: 'objects[0].mesh', choice: [y.ply, {file: z.ply}]},\n"
                       "        {key: 'objects[1]', choice: [none, {mesh: {file: {choice: [v.ply, w.ply]}}}]}]\n")
        scene, at = asdic.Scene.open(path), lambda name: os.path.join(os.path.realpath(folder), name)
        tap.equal(scene.bottom, {"grid": at("g.asc")}, "a grid's short form")
        tap.equal(scene.objects, [{"name": "mesh", "mesh": "/x.ply"}], "a mesh's")
        draws = json.loads(scene.to_json())["draws"]
        tap.equal(draws[0]["choice"], [at("y.ply"), {"file": at("z.ply")}], "choices")
        tap.equal(draws[1]["choice"], ["none", {"mesh": {"file": {"choice": [at("v.ply"), at("w.ply")]}}}], "in choices")


def test_scene_names_files():
    """Those of the working folder, wherever the scene is saved."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        before = os.getcwd()
        os.chdir(folder)
        try:
            for name, x_m in (("a \N{FISH} \xe4.csv", 10.5), ("out/a \N{FISH} \xe4.csv", 30)):
                os.makedirs("out", exist_ok=True)
                with open(name, "w", encoding="utf-8") as file:
                    file.write("time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                               f"0,{x_m},0,5,0,0,0\n9,{x_m},0,5,0,0,0\n")
            scene = pool()
            scene.objects = [{"name": "fish", "point": 0, "track": "a \N{FISH} \xe4.csv"}]
            run = asdic.simulate(scene, "out")
            tap.equal(run.ranges[np.nanargmax(run.parts["object"][0, 0])], 10.5, "where the fish is, m")
            same(asdic.simulate(scene, "out", resume=True).level_db, run.level_db, "resumed")
        finally:
            os.chdir(before)


def test_truth():
    """Of pings and runs: the same bytes, and shares that sum to one."""
    need_device()
    scene = pool(output={"csv": "none", "images": [], "truth": True})
    run = asdic.simulate(scene)
    with asdic.Simulator(scene) as sonar, asdic.Simulator(pool(), truth=True) as asked, asdic.Simulator(pool()) as other:
        for k, (ping, second) in enumerate(zip(sonar.fly(), asked.fly(), strict=True)):
            tap.equal(set(ping.truth), set(run.truth.dtype.names) & set(ping.truth), "names")
            for name, values in ping.truth.items():
                same(values, run.truth[name][k], f"{name} of ping {k}")
                same(values, second.truth[name], name)
            shares = sum(ping.truth[name] for name in ("direct", "by_surface", "by_bottom", "by_object", "noise"))
            tap.equal(abs(shares - 1).max() < 1e-5, True, "shares sum to one")
            tap.equal((ping.truth["object"] == 1).any(), True, "the ball is seen")
            plain = next(other.fly())
            same(plain.level_db, ping.level_db, "levels")
            tap.equal(plain.truth, None, "nobody asked")
        raises(asdic.ArgumentError, "without truth", other.ping, 0, 0, 5, out=ping)
        raises(asdic.ArgumentError, "with truth", sonar.ping, 0, 0, 5, out=plain)
    raises(asdic.InputError, "truth: true", lambda: asdic.simulate(pool()).truth)


def test_pressure_at_elements():
    """Of coherent pings, as the run's file has it."""
    need_device()
    scene = asdic.Scene.open(os.path.join(ROOT, "data", "scenes", "array.yaml"))
    scene.output = {"csv": "none", "images": [], "elements": True}
    run = asdic.simulate(scene, rays=2000, pings=slice(0, 1))
    with asdic.Simulator(scene, rays=2000) as sonar:
        ping = next(sonar.fly())
        same(ping.pressure, run.pressure[0], "pressure")
        tap.equal((ping.pressure.dtype, ping.pressure.shape[0]), (np.dtype("c8"), sonar.sonar.array.elements), "elements")
        tap.equal(0 < ping.sample_m <= ping.bin_length_m, True, "samples")
        same(ping.level_db, run.level_db[0], "levels")
        raises(asdic.ArgumentError, "samples of pressure", sonar.ping, 0, 0, 5, out=asdic.expect(scene))


def test_own_mesh_is_the_box():
    """A box from arrays against the scene file's own: bytes but for the order of corners."""
    need_device()
    by_arrays, by_keys = (pool() for _ in range(2))
    for scene in (by_arrays, by_keys):
        scene.objects.clear()
    by_keys.add("thing", box={"size_m": [1, 8, 3]}, position_m=(15, 0, 6), material="concrete")
    tap.equal(by_arrays.add_mesh(*box([1, 8, 3]), "concrete", position_m=(15, 0, 6)), "object0", "name")
    a, b = (asdic.simulate(scene) for scene in (by_arrays, by_keys))
    tap.equal(float(np.nanmax(np.abs(a.level_db - b.level_db))) < 1e-3, True, "levels")
    tap.equal(float(np.nanmax(a.parts["object"])) > 50, True, "the box is heard")
    # In memory, as simulators take it, and as it was saved: the same bytes, and names for detectors.
    ping = next(asdic.Simulator(by_arrays).fly())
    same(ping.level_db, a.level_db[0], "from memory and from the folder")
    tap.equal(a.detect().classes["name"][0], "object0", "a detector knows the object")
    out = os.path.join(a.folder, "again")
    subprocess.run([os.environ["ASDIC"], "run", "-q", os.path.join(a.folder, "scene.json"), "-o", out], check=True)
    same(asdic.Run(out).level_db, a.level_db, "the program runs what was saved")


def test_names_of_their_own():
    """Objects without a name get one that no other has, also when some were taken out."""
    scene = asdic.Scene()
    names = [scene.add_mesh(*box([1, 1, 1])) for _ in range(3)]
    tap.equal(names, ["object0", "object1", "object2"], "in turn")
    scene.objects.pop(0)
    scene.add("object4", point=0)
    tap.equal([scene.add_mesh(*box([1, 1, 1])) for _ in range(2)], ["object3", "object5"], "free ones")
    tap.equal(len({one["name"] for one in scene.objects}), 5, "names")


def test_saved_meshes_stay():
    """One that is added to an opened scene takes no other's place, and a run is resumed with its own meshes alone."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        scene, at = pool(), np.array([-120.0, 120.0])
        scene.add_mesh(*box([1, 8, 3]), name="large", position_m=(15, 0, 6))
        alone = asdic.Scene.open(scene.save(folder))
        alone.add_mesh(*box([.1, .1, .1]), name="small", position_m=(10, 4, 6))
        both = asdic.Scene.open(alone.save(folder))
        first, second = (one.objects[1]["mesh"]["file"] for one in (scene, both))
        tap.equal(os.path.basename(second), first, "the large mesh's file")
        tap.equal(len({one["mesh"]["file"] for one in both.objects[1:]}), 2, "files")
        out = os.path.join(folder, "run")
        scene.set_terrain(at, at, np.full((2, 2), 12.0))
        run = asdic.simulate(scene, out)
        scene.set_terrain(at, at, np.full((2, 2), 20.0))
        raises(asdic.InputError, "not the scene to be resumed", asdic.simulate, scene, out, resume=True)
        scene.set_terrain(at, at, np.full((2, 2), 12.0))
        same(asdic.simulate(scene, out, resume=True).level_db, run.level_db, "resumed")


def test_meshes_go_with_what_names_them():
    """A loop over shapes saves and keeps the shape that the scene has; one that is put back is there again."""
    need_device()
    scene, at = pool(bottom=None), np.array([-120.0, 120.0])
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        gone = None
        for depth in range(12, 32):
            scene.set_terrain(at, at, np.full((2, 2), float(depth)))
            if depth == 12:
                first = dict(scene.bottom)
            if depth == 13:
                gone = weakref.ref(next(iter(scene._meshes.values())))
        scene.save(folder)
        tap.equal(len([name for name in os.listdir(folder) if name.endswith(".ply")]), 1, "meshes of twenty terrains")
        tap.equal((gone(), len(scene._meshes)), (None, 1), "and none is left of the others")
        deep = asdic.simulate(scene)
        scene.bottom = first
        tap.equal(len(scene._meshes), 1, "what somebody kept")
        tap.equal(np.array_equal(asdic.simulate(scene).altitudes, deep.altitudes - 19), True, "is the bottom again")
        copied = asdic.Scene.open(scene.save(folder))
        tap.equal(copied._meshes, {}, "of a file")


def test_terrain_is_the_plane():
    """A flat grid of depths gives the levels of the plane, as well as rays sample it."""
    need_device()
    grid = pool(bottom=None, sampling={"rays": 20000})
    plane = pool(sampling={"rays": 20000})
    for scene in (grid, plane):
        scene.objects.clear()
    at = np.linspace(-120, 120, 7)
    grid.set_terrain(at, at, np.full((7, 7), 12.0))
    a, b = asdic.simulate(grid), asdic.simulate(plane)
    difference = np.abs(a.level_db - b.level_db)[0, :, 8:]
    tap.equal(float(np.median(difference)) < 0.3, True, f"median difference {np.median(difference)} dB")


def test_terrain_has_holes():
    """Where depths are NAN; of a cell with three corners half stays, as of grids in files, and faces look up."""
    depth = np.random.default_rng(3).uniform(10, 11, (9, 12))
    depth[np.random.default_rng(4).random(depth.shape) < 0.3] = np.nan
    scene = pool(bottom=None)
    scene.set_terrain(np.arange(9.0), np.arange(12.0), depth)
    [mesh] = scene._meshes.values()
    corners, faces = mesh.corners, mesh.indices
    tap.equal(len(corners), int(np.isfinite(depth).sum()), "a vertex a depth")
    a, b, c = (corners[faces[:, k], :2] for k in range(3))
    turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    tap.equal(np.unique(turn).tolist(), [-1.0], "twice the area, all to one side")
    there = np.isfinite(depth).astype(int)
    of_cell = there[:-1, :-1] + there[1:, :-1] + there[1:, 1:] + there[:-1, 1:]
    tap.equal(len(faces), int(np.sum(2 * (of_cell == 4) + (of_cell == 3))), "faces")
    cells = np.floor((corners[faces, :2].mean(axis=1))).astype(int)
    tap.equal(len(np.unique(cells, axis=0)), int(np.sum(of_cell >= 3)), "cells")
    masked = pool(bottom=None)
    masked.set_terrain(np.arange(9.0), np.arange(12.0), np.ma.masked_array(np.where(there, depth, -32768), there == 0))
    tap.equal(masked._meshes.keys(), scene._meshes.keys(), "masked ones are holes too")
    raises(asdic.ArgumentError, "depth_m is NAN", scene.set_terrain, [0, 1], [0, 1], [[1, np.nan], [np.nan, 1]])


def test_arrays_are_views_that_keep_their_owner():
    need_device()
    sonar = asdic.Simulator(pool())
    ping = sonar.ping(0, 0, 5)
    energy = ping.intensity["total"]
    struct = ping._struct  # pylint: disable=protected-access
    tap.equal(energy.ctypes.data, int(ffi.cast("uintptr_t", struct.intensity_lin[lib.ASDIC_TOTAL])), "address")
    level = ping.level_db.copy()
    del ping, sonar, struct
    gc.collect()
    with np.errstate(divide="ignore"):
        again = np.where(energy > 0, 10 * np.log10(energy), np.nan)
    tap.equal(float(np.nanmax(np.abs(again - level))) < 1e-5, True, "the memory outlives ping and simulator")
    curve = asdic.roc(pool(), object="ball", trials=1000)
    points, struct = curve.points, curve._handle.pointer  # pylint: disable=protected-access
    tap.equal(points.ctypes.data, int(ffi.cast("uintptr_t", struct.points)), "a curve's address")
    tap.equal((points.flags.writeable, points.flags.owndata), (False, False), "flags")
    kept = weakref.ref(curve._handle)  # pylint: disable=protected-access
    del curve, struct
    gc.collect()
    tap.equal((kept() is not None, float(points["design_pfa"][0]) > 0), (True, True), "an array keeps its owner")
    del points
    gc.collect()
    tap.equal(kept(), None, "nothing keeps it any longer")
    run = asdic.simulate(pool())
    tap.equal(isinstance(run.records, np.memmap), True, "a run's records lie in its file")
    tap.equal(np.shares_memory(run.level_db, run.records), True, "and its levels in the records")
    folder, levels = run.folder, run.level_db
    del run
    gc.collect()
    tap.equal((os.path.exists(folder), float(np.nanmax(levels)) > 0), (False, True), "temporary; the array stays")


def stay(folder):
    """The file of a track that stays 10 m north of the origin."""
    path = os.path.join(folder, "track.csv")
    with open(path, "w", encoding="utf-8") as file:
        file.write("time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,10,0,5,0,0,0\n100,10,0,5,0,0,0\n")
    return path


def test_objects_are_moved():
    """A point goes where it is put and stays there, on a track or not: it is heard at that range alone."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        path = stay(folder)
        for place in ({"track": path}, {"position_m": [10, 0, 5]}):
            scene = pool()
            scene.objects = [{"name": "fish", "point": 0, **place}]
            sonar = asdic.Simulator(scene)
            for at in (10, 20, 20):
                if at == 20:
                    sonar.move("fish", 20, 0, 5)
                heard = np.flatnonzero(np.isfinite(sonar.ping(0, 0, 5).parts["object"][0]))
                tap.equal(abs(sonar.ranges[heard] - at).max() < 2, True, f"{place}: bins {heard}, expected {at} m")


def test_objects_added_with_a_track():
    """They are where their track says; a place given beside it is refused, as in a file."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        path = stay(folder)
        wall = np.array([[0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1]]), np.array([[0, 1, 2], [0, 2, 3]])
        for add in (lambda scene, **place: scene.add("thing", point=0, track=path, **place),
                    lambda scene, **place: scene.add_mesh(*wall, name="thing", track=path, **place)):
            scene = pool()
            add(scene)
            sonar = asdic.Simulator(scene)
            for at in (10, 20):
                if at == 20:
                    sonar.move("thing", 20, 0, 5)
                energy = sonar.ping(0, 0, 5).intensity["object"][0]
                tap.equal(abs(sonar.ranges[np.argmax(energy)] - at) < 1, True, f"{scene.objects}: heard at {at} m")
            add(scene, position_m=(10, 0, 5))
            raises(asdic.InputError, "'position_m' has no effect beside 'track'", asdic.Simulator, scene)


def test_memory_used_again():
    need_device()
    sonar = asdic.Simulator(pool())
    first = sonar.ping(0, 0, 5)
    levels, energy = first.level_db, first.intensity["total"]
    for several in first.intensity, first.parts:
        raises(TypeError, "take one by its name", np.log10, several)
    second = sonar.ping(3, 0, 5, yaw=20, out=first)
    tap.equal((second is first, second.index, np.array_equal(levels, second.level_db)), (True, 1, False), "out")
    tap.equal(energy.ctypes.data, second.intensity["total"].ctypes.data, "memory")
    alike = asdic.Simulator(pool(sonar={**pool().sonar, "receivers": [{"name": "a"}, {"name": "b"}]}))
    other = sonar.ping(0, 0, 5, out=alike.ping(0, 0, 5))
    tap.equal(list(other.beams["name"]), ["forward", "down"], "another sonar's memory, this one's beams")


def test_levels_of_memory_used_again_are_of_the_new_ping():
    """Ten times the logarithm of its energies, by `parts` asked for anew and by one that was kept, of all that they
    made of the ping before."""
    need_device()
    sonar = asdic.Simulator(pool())
    ping = sonar.ping(0, 0, 5)
    kept = ping.parts
    before = {name: kept[name].copy() for name in kept}
    sonar.ping(0, 0, 9, yaw=30, out=ping)
    for name in before:
        energy = ping.intensity[name]
        wanted = 10 * np.log10(energy, out=np.full(energy.shape, np.nan), where=energy > 0)
        for levels in ping.parts, kept:
            tap.equal(np.allclose(levels[name], wanted, rtol=0, atol=1e-3, equal_nan=True), True, name)
    tap.equal(np.allclose(before["bottom"], ping.parts["bottom"], rtol=0, atol=1, equal_nan=True), False, "another place")


def test_detections():
    need_device()
    run = asdic.simulate(pool())
    raises(asdic.ArgumentError, "cfar is a background of its own", run.detect, cfar="ca", background="flat")
    for option in "cfar_cells", "cfar_guard":
        raises(asdic.ArgumentError, "cfar_cells and cfar_guard go with cfar", run.detect, **{option: 4})
        raises(asdic.ArgumentError, option, run.detect, cfar="os", **{option: 257})
    raises(asdic.ArgumentError, "speed -1 m/s", run.detect, speed_mps=-1)
    for name, value in ("pfa", .9), ("prior", .9999), ("snr_db", 60.1), ("cost_ratio", 1e-9):  # as in a scene file
        raises(asdic.ArgumentError, f"'{name}' = {value:g} is out of range", run.detect, **{name: value})
    raises(asdic.ArgumentError, "cells of 1e+09 m", run.detect, cell_m=1e9)
    raises(asdic.ArgumentError, "a P_FA of 0.9 (in [1e-12, 0.5])", asdic.roc, pool(), range_m=20, target_strength_db=-10,
           pfa=.9)
    found = run.detect(pfa=1e-3)
    tap.equal(found.report.pings, 3, "pings")
    tap.equal(found.classes["name"][0], "ball", "classes")
    tap.equal({(row["object"], row["beam"]) for row in found.sights} <= {("ball", name) for name in run.names}, True, "sights")
    tap.equal(len(found.sights) > 0, True, "a sight")
    tap.equal([table.dtype[name].kind for table, name in ((found.classes, "name"), (found.sights, "beam"), (run.beams, "name"))],
              ["U"] * 3, "text everywhere")
    tap.equal(len(found.table), found.report.detections, "rows")
    tap.equal(float(found.table["range_m"][0]) > 0, True, "numbers")
    tap.equal({name: found.table.dtype[name].kind for name in ("ping", "bin", "beam", "truth", "range_m", "pd")},
              {"ping": "i", "bin": "i", "beam": "U", "truth": "U", "range_m": "f", "pd": "f"}, "kinds of columns")
    raises(asdic.ExistsError, "detections.csv", run.detect)
    alone = asdic.simulate(pool()).detect()
    gc.collect()
    tap.equal(len(alone.table), alone.report.detections, "detections keep their run")
    own = asdic.detect(run.folder, pfa=1e-2, force=True)
    tap.equal(own.report.detector.pfa, 1e-2, "a P_FA of one's own")
    fewer = run.detect(pfa=1e-5, force=True)
    tap.equal(fewer.report.detections < own.report.detections, True, "another detection")
    for one in (own, fewer):
        tap.equal(len(one.table), one.report.detections, "rows of its own table")


def test_detections_of_beams_that_are_numbers():
    """A fan's beams are 000, 001, ...; objects may be called so, and a table may be empty: names stay text."""
    need_device()
    scene = pool(sonar={**pool().sonar, "receivers": {"fan": {"count": 3, "sector_deg": 60}}})
    scene.objects[0]["name"] = "1e3"
    run = asdic.simulate(scene)
    table = run.detect(pfa=0.1).table
    tap.equal(set(table["beam"]) <= set(run.names) and len(table) > 0, True, f"beams {set(table['beam'])}")
    tap.equal({"1e3"} & set(table["truth"]), {"1e3"}, "the object's name")
    none = run.detect(pfa=1e-12, snr_db=60.0, force=True).table[:0]
    tap.equal(none.dtype["ping"].kind + none.dtype["beam"].kind, "iU", "kinds without rows")


def test_curve_over_range():
    need_device()
    curve = asdic.roc(pool(), object="ball", trials=20000)
    tap.equal(bool(np.all(np.diff(curve.points["design_pfa"]) > 0)), True, "ascending")
    inside = (curve.points["closed_pd"] > curve.points["pd"]["low"] - 1e-3) & \
        (curve.points["closed_pd"] < curve.points["pd"]["high"] + 1e-3)
    tap.equal(float(np.mean(inside)) > 0.9, True, "the closed form lies within the bounds")
    tap.equal((len(curve.none), len(curve.present)), (20000, 20000), "draws")
    tap.equal(bool(np.mean(curve.present) > np.mean(curve.none)), True, "the target is louder")


def test_what_is_detected_by_chance_is_said():
    """Behind the vehicle as often as nothing is."""
    need_device()
    for bearing_deg, told in ((170.0, True), (0.0, False)):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            curve = asdic.roc(pool(), range_m=5.0, target_strength_db=-30.0 if told else 0.0, bearing_deg=bearing_deg, trials=1000)
        tap.equal((curve.info.closed_area < 0.501, bool(curve.info.remark)), (told, told), f"at {bearing_deg} degrees")
        tap.equal(["nothing is" in str(w.message) for w in said], [True] * told, "a remark")


def test_curve_is_the_programs():
    """By the scene's detector where nothing is said, and by what is said in its place."""
    need_device()
    scene = pool(detector={"target": "swerling0", "pfa": 1e-2})
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        path = scene.save(folder)
        for options, keys in (((), {}), (("--target", "swerling3", "--pfa", "0.1"), {"target": "swerling3", "pfa": 0.1})):
            done = subprocess.run([os.environ["ASDIC"], "roc", "-qf", path, "--json", "--object", "ball", "--trials", "2000",
                                   *options, "-o", os.path.join(folder, "roc")], check=True, capture_output=True, text=True)
            [said], here = json.loads(done.stdout), asdic.roc(scene, object="ball", trials=2000, **keys).info
            for name in ("pfa", "closed_pd", "closed_area", "snr_db", "range_m"):
                tap.equal(getattr(here, name), said[name], name)
            tap.equal((here.pd.value, here.area.high), (said["pd"]["value"], said["area"]["high"]), "what was drawn")


def test_formulas_and_plan():
    """Absorption by hand: Francois & Garrison as `asdic model` has it."""
    keys = {"f_khz": 100, "t_degc": 10, "s_ppt": 35, "z_m": 10, "ph": 8}
    done = subprocess.run([os.environ["ASDIC"], "model", "absorption", *(f"{k}={v}" for k, v in keys.items())],
                          check=True, capture_output=True, text=True)
    tap.equal(f"{asdic.model('absorption', **keys):.6g}", f"{float(done.stdout.split()[0]):.6g}", "dB/km")
    class Number(float):
        """As numpy's, which says what it is from version 2 on."""

        def __repr__(self):
            return f"np.float64({float(self)})"
    tap.equal(asdic.model("absorption", **{k: Number(v) for k, v in keys.items()}), asdic.model("absorption", **keys),
              "numbers out of arrays")
    tap.equal({"absorption", "sound-speed"} <= {formula.name for formula in asdic.formulas()}, True, "names")
    found = asdic.plan(pool())
    tap.equal([term.kept for term in found.terms if term.name == "objects"], [True], "the ball is kept")
    tap.equal((found.rays.rays, found.refraction.needed), (1000, "off"), "rays, refraction")
    tap.equal("sonar" in asdic.schema()["properties"], True, "schema")


def test_xarray():
    need_device()
    try:
        import xarray  # pylint: disable=import-outside-toplevel
    except ImportError as error:
        raise tap.Skip(str(error)) from error
    run = asdic.simulate(pool())
    data = run.to_xarray()
    tap.equal(dict(data.sizes), {"ping": 3, "beam": 2, "range": 37}, "dims")
    tap.equal((data.level.attrs["units"], data.range.attrs["units"], data.time.attrs["units"]),
              ("dB re 1 uPa", "m", "s"), "units")
    same(data.level.sel(beam="down").values, run.level_db[:, 1], "levels of a beam")
    same(data.stderr.values, run.stderr_db, "errors")
    for name in run.parts:
        same(data[name].values, run.parts[name], name)
    tap.equal(np.shares_memory(data.level.values, run.records), True, "without a copy")
    small = asdic.simulate(pool(output={"csv": "none", "images": [], "records": "compact"})).to_xarray()
    tap.equal(str(small.stderr.dtype), "float16", "of a compact run")
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        try:
            small.to_netcdf(os.path.join(folder, "run.nc"))
        except ValueError as error:
            raise tap.Skip(str(error)) from error  # neither netCDF4 nor scipy
        with xarray.load_dataset(os.path.join(folder, "run.nc")) as kept:
            for name, values in small.items():
                same(kept[name].values, np.asarray(values, np.float32), f"{name} in a file")


def test_a_run_whose_folder_is_gone():
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        run = asdic.simulate(pool(), os.path.join(folder, "r"))
        levels = run.level_db.copy()
        os.remove(os.path.join(folder, "r", "run.json"))
        raises(asdic.InputError, "run.json: [Errno 2] No such file", run.detect)
        same(run.level_db, levels, "its levels")
        tap.equal((run.info["seed"], run.info["beams"]), (7, 2), "what run.json said")


def test_where_a_run_was():
    """Of a vehicle at rest that is turned about all axes: as its scene says."""
    need_device()
    beams = [{"name": "port", "yaw_deg": -20}, {"name": "ahead"}, {"name": "starboard", "yaw_deg": 10}]
    pose = {"position_m": [1, 2, 5], "roll_deg": 3, "pitch_deg": -4, "yaw_deg": 50}
    run = asdic.simulate(pool(sonar={**pool().sonar, "receivers": beams}, mission={"pose": pose, "pings": 3}))
    said = {"north": 1, "east": 2, "down": 5, "roll": np.radians(3), "pitch": np.radians(-4), "yaw": np.radians(50),
            "altitude": 7, "ping": [0, 1, 2], "time": [0, 0.05, 0.1], "bearing": [-20, 0, 10],
            "range": np.arange(37) + 0.5}
    here = {name: values for rows, names in ((run.positions, ("north", "east", "down")),
                                             (run.attitudes, ("roll", "pitch", "yaw")))
            for name, values in zip(names, rows.T, strict=True)}
    here |= {"altitude": run.altitudes, "ping": run.pings, "time": run.times, "bearing": run.bearings, "range": run.ranges}
    tap.equal((set(here), run.names), (set(said), ["port", "ahead", "starboard"]), "what is told, and of which beams")
    try:
        data = run.to_xarray()
    except ImportError:
        data = here
    later = asdic.simulate(pool(), pings=slice(1, 3))
    tap.equal((later.pings.tolist(), later.expect(1).index, later.expect(1).time), ([1, 2], 2, later.times[1]), "pings")
    raises(asdic.ArgumentError, "no row of pings", asdic.simulate, pool(), pings=range(1, 4))
    for name, values in said.items():
        for told in (here[name], np.asarray(data[name])):
            tap.equal(np.allclose(told, values, rtol=0, atol=1e-12), True, f"{name}: {told}, not {values}")


TEMPORARY = """
import os, sys, warnings
import asdic
from package import pool
run = asdic.simulate(pool())
folder = run.folder
del run
print(os.path.exists(folder))
try:
    asdic.simulate(pool(), rays=1)
except asdic.ArgumentError:
    pass
kept = asdic.simulate(pool())
print(len(repr(asdic.simulate(pool(), pings=slice(0, 1)))) > 0, os.listdir(os.environ["TMPDIR"]) != [])
"""


def test_temporary_runs_leave_nothing():
    """No folder, at the interpreter's end neither, and no warning."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        done = subprocess.run([sys.executable, "-X", "dev", "-W", "error::ResourceWarning", "-c", TEMPORARY],
                              env={**os.environ, "TMPDIR": folder, "PYTHONPATH": os.environ["PYTHONPATH"] + os.pathsep +
                                   os.path.dirname(__file__)}, capture_output=True, text=True, check=False, timeout=100)
        tap.equal((done.returncode, done.stdout, done.stderr), (0, "False\nTrue True\n", ""))
        tap.equal(os.listdir(folder), [], "what is left")


def test_one_ping_is_no_pings():
    need_device()
    run = asdic.simulate(pool(), pings=slice(0, 1))
    tap.equal(repr(run), f"<asdic.Run {run.folder}: 1 ping, 2 beams, 37 bins>", "a run")
    tap.contains(repr(run.detect(pfa=1e-9)), " of 1 ping>")


class OverAtOnce(threading.Thread):
    def start(self):
        super().start()
        self.join()


def test_progress():
    need_device()
    said, threads = [], set()

    def report(what, done, total):
        said.append((what, done, total))
        threads.add(threading.current_thread())
    asdic.simulate(pool(), progress=report)
    tap.equal((said[-1], threads), (("pings", 3, 3), {threading.current_thread()}), "in this thread, to the end")
    asdic.expect(pool(), progress=report)
    tap.equal(said[-1], ("beams", 2, 2), "expectations count beams")
    said.clear()
    with mock.patch.object(threading, "Thread", OverAtOnce):
        asdic.expect(pool(), progress=report)
    tap.equal(said, [("beams", 0, 2), ("beams", 2, 2)], "a call that is over before anyone looks")

    class Enough(Exception):
        pass

    def stop(*_):
        raise Enough("enough")
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        long = pool(mission={"pose": {"position_m": [0, 0, 5]}, "pings": 5000}, sampling={"rays": 20000})
        raises(Enough, "enough", asdic.simulate, long, os.path.join(folder, "run"), progress=stop)
        tap.equal(len(asdic.Run(os.path.join(folder, "run"))) < 5000, True, "what was simulated is a run")


INTERRUPTED = """
import os, signal, sys, threading
import asdic
from package import pool
long = pool(mission={"pose": {"position_m": [0, 0, 5]}, "pings": 100000})
begun = threading.Event()
threading.Thread(target=lambda: begun.wait() and os.kill(os.getpid(), signal.SIGINT), daemon=True).start()
try:
    asdic.simulate(long, sys.argv[1], progress=lambda what, done, total: done > 0 and begun.set())
except KeyboardInterrupt:
    run = asdic.Run(sys.argv[1])
    print("interrupted", 0 < len(run) < 100000)
    print(len(asdic.simulate(long, sys.argv[1] + "2", pings=slice(0, 2))))
"""


RAISED = """
import ctypes, os, signal, sys, threading, time
import asdic
from package import pool
class TimeUp(Exception):
    pass
def up(*_):
    raise TimeUp
signal.signal(signal.SIGALRM, up)
signal.signal(signal.SIGTERM, lambda *_: sys.exit(3))
how, folder = sys.argv[1:]
long = pool(mission={"pose": {"position_m": [0, 0, 5]}, "pings": 100000}, sampling={"rays": 1 << 21})
begun = threading.Event()
def hit(thread):
    begun.wait()
    for k in range(2):  # the second while the end of the call is waited for
        if how == "thread":
            ctypes.pythonapi.PyThreadState_SetAsyncExc(ctypes.c_ulong(thread.ident), ctypes.py_object(TimeUp))
        else:
            os.kill(os.getpid(), signal.SIGALRM if how == "alarm" else signal.SIGTERM)
        time.sleep(0.13)
def call():
    told = []
    for wait in (lambda: asdic.simulate(long, folder, progress=lambda what, done, _: done > 0 and begun.set()),
                 lambda: time.sleep(0.3)):
        try:
            wait()
        except (TimeUp, SystemExit) as error:
            told.append(type(error).__name__)
    print(told[0], [one.name for one in threading.enumerate() if one.name == "asdic"], flush=True)
waiting = threading.Thread(target=call) if how == "thread" else threading.main_thread()
threading.Thread(target=hit, args=(waiting,)).start()
if how == "thread":
    waiting.start()
    waiting.join()
else:
    call()
print(0 < len(asdic.Run(folder)) < 100000, len(asdic.simulate(long, folder, rays=1000, pings=slice(0, 2), force=True)))
"""


HELD_DOWN = """
import os, signal, threading, time
import asdic
signal.signal(signal.SIGTERM, signal.default_int_handler)
over, left, hits = time.monotonic() + 3, 0, 0
pid = os.getpid()
if os.fork() == 0:
    for k in range(300):
        time.sleep(0.003 + 0.0001 * (k * 37 % 50))
        os.kill(pid, signal.SIGTERM if k % 3 == 0 else signal.SIGINT)
    os._exit(0)
while hits < 300:
    try:
        hits = hits if time.monotonic() < over else 300
        asdic.model("sound-speed", t_degc=10, s_ppt=35, z_m=10)
    except KeyboardInterrupt:
        pass
    finally:
        try:
            hits += 1
            left += any(thread.name == "asdic" for thread in threading.enumerate())
        except KeyboardInterrupt:
            pass
for one in signal.SIGINT, signal.SIGTERM:
    signal.signal(one, signal.SIG_IGN)
print("left", left, flush=True)
os._exit(0)
"""


def test_ctrl_c_leaves_no_call_on_its_own():
    """Wherever it comes: a call that went on would work on memory that the interpreter frees."""
    done = subprocess.run([sys.executable, "-c", HELD_DOWN], capture_output=True, text=True, check=False, timeout=60)
    tap.equal((done.returncode, done.stdout.split()), (0, ["left", "0"]), done.stderr)


def test_what_nobody_wants_goes_at_once():
    """Without the garbage collector, which counts objects, not how large they are."""
    need_device()
    gc.collect()
    gc.disable()
    try:
        with asdic.Simulator(pool()) as sonar:
            ping = sonar.ping(0, 0, 5)
            parts = ping.parts
            tap.equal(parts["bottom"] is ping.parts["bottom"], True, "made once")
            tap.equal(ping.intensity["total"].shape, ping.level_db.shape)
            gone = weakref.ref(ping)
            del ping
            tap.equal(parts["surface"].shape, parts["bottom"].shape, "levels keep their ping")
            del parts
            tap.equal(gone(), None, "a ping whose parts were looked at")

        def stop(*_):
            raise OverflowError
        context = asdic._library.Context(stop)  # pylint: disable=protected-access
        gone = weakref.ref(context)
        try:
            context.run(lambda: context._done.append(("beams", 0, 1)) or time.sleep(0.2) or 0)  # pylint: disable=protected-access
        except OverflowError:
            del context
        tap.equal(gone(), None, "what a call that was stopped has used")
        run = asdic.simulate(pool())
        folder = run.folder
        tap.equal(run.parts["bottom"].ndim, 3)
        del run
        tap.equal(os.path.exists(folder), False, "the folder of a run whose parts were looked at")
    finally:
        gc.enable()


def test_ctrl_c():
    """A run of hours ends at the next ping, its folder is whole, and the interpreter goes on."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        path = os.environ["PYTHONPATH"] + os.pathsep + os.path.dirname(__file__)
        began = time.monotonic()
        done = subprocess.run([sys.executable, "-c", INTERRUPTED, os.path.join(folder, "run")],
                              env={**os.environ, "PYTHONPATH": path}, capture_output=True, text=True, check=False,
                              timeout=100)
        tap.equal((done.returncode, done.stdout.split()), (0, ["interrupted", "True", "2"]), done.stderr)
        tap.equal(time.monotonic() - began < 90, True, "at once")


def test_a_call_leaves_handlers_of_signals_alone():
    """Also of C code, also where what is put back raises at once; and what reports is left at once."""
    library = asdic._library  # pylint: disable=protected-access
    context, ours = library.Context(), (signal.SIGALRM, signal.SIGUSR1, signal.SIGUSR2)

    class Up(Exception):
        pass

    def up(*_):
        raise Up

    def set_and_hit(number, handler):
        kept(number, handler)
        if handler is up:
            os.kill(os.getpid(), number)

    def stay(*_):
        os.kill(os.getpid(), signal.SIGALRM)
        time.sleep(60)
    before, kept = {number: signal.signal(number, up) for number in ours}, signal.signal
    try:
        with tempfile.TemporaryFile() as file:
            faulthandler.register(signal.SIGUSR2, file)
            context.run(lambda: 0)
            os.kill(os.getpid(), signal.SIGUSR2)
            faulthandler.unregister(signal.SIGUSR2)
            tap.equal(os.fstat(file.fileno()).st_size > 0, True, "a handler of C is still there")
        with mock.patch.object(signal, "signal", set_and_hit):
            raises(Up, "", context.run, lambda: 0)
        tap.equal([signal.getsignal(number) for number in ours], [up] * 3, "all are the caller's again")
        slow, began = library.Context(stay), time.monotonic()
        raises(Up, "", slow.run, lambda: slow._done.append(("beams", 0, 1)) or time.sleep(0.3) or 0)  # pylint: disable=protected-access
        tap.equal(time.monotonic() - began < 30, True, "what reports is not waited for")
    finally:
        for number in ours:
            signal.signal(number, before[number])


def test_what_is_raised_waits_for_the_end():
    """By the handler of any signal, twice, and by another thread: the call is over then, and the folder can be used."""
    need_device()
    path = os.environ["PYTHONPATH"] + os.pathsep + os.path.dirname(__file__)
    for how, name in ("alarm", "TimeUp"), ("term", "SystemExit"), ("thread", "TimeUp"):
        with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
            done = subprocess.run([sys.executable, "-c", RAISED, how, folder], env={**os.environ, "PYTHONPATH": path},
                                  capture_output=True, text=True, check=False, timeout=100)
            tap.equal((done.returncode, done.stdout.split()), (0, [name, "[]", "True", "2"]), f"{how}: {done.stderr}")


def test_ping_leaves_the_interpreter_to_others():
    """Another thread counts while a ping is simulated."""
    need_device()
    sonar = asdic.Simulator(pool(), rays=500000)
    sonar.ping(0, 0, 5)
    counts, over = [0], threading.Event()

    def count():
        while not over.is_set():
            counts[0] += 1
            time.sleep(0.001)
    thread = threading.Thread(target=count)
    thread.start()
    before, began = counts[0], time.monotonic()
    sonar.ping(0, 0, 5)
    during, took = counts[0] - before, time.monotonic() - began
    over.set()
    thread.join()
    tap.equal(during > 3, True, f"{during} counts in the {took:.3f} s of a ping")


def test_pictures():
    need_device()
    try:
        import matplotlib.pyplot as plt  # pylint: disable=import-outside-toplevel
    except ImportError as error:
        raise tap.Skip(str(error)) from error
    run = asdic.simulate(pool())
    raises(asdic.ArgumentError, "the same bearing", asdic.plot.fan, run)  # two beams ahead: a picture of no width
    tap.equal(plt.gcf().axes, [], "nothing is drawn then")
    beside = asdic.simulate(pool(sonar={**pool().sonar, "receivers": [{"name": "a", "yaw_deg": 20}, {"name": "b"}]}))
    axes = asdic.plot.fan(beside, vmin=0, vmax=200)
    tap.equal(axes.get_xlabel(), "starboard, m", "fan")
    # From 10 degrees to port, half a step beyond the beam ahead, to 30 degrees to starboard.
    low, high = np.degrees(np.arctan(np.divide(*np.array(axes.collections[0].get_coordinates())[[0, -1], -1].T)))
    tap.equal((round(low), round(high)), (-10, 30), "its edges")
    same(np.ma.filled(axes.collections[0].get_array(), np.nan).ravel(), beside.level_db[0, ::-1].ravel(), "its levels")
    plt.close("all")
    same(np.ma.filled(asdic.plot.fan(beside, 2).collections[0].get_array(), np.nan).ravel(),
         beside.level_db[2, ::-1].ravel(), "another ping's levels")
    plt.close("all")
    looks = (160, 170, 180, -170, -160)  # astern: no beam looks ahead, and nothing is drawn there
    astern = asdic.simulate(pool(sonar={**pool().sonar, "receivers": [{"yaw_deg": yaw} for yaw in looks]}))
    mesh = asdic.plot.fan(astern).collections[0]
    tap.equal(float(np.max(mesh.get_coordinates()[..., 1])) <= 0, True, "nothing ahead")
    same(np.ma.filled(mesh.get_array(), np.nan).ravel(), astern.level_db[0].ravel(), "from port to starboard")
    plt.close("all")
    axes, expected = asdic.plot.ascope(run, "down", ping=2, expected=run.expect(2)), run.expect(2)
    tap.equal(axes.get_ylabel(), "level, dB re 1 µPa", "A-scope")
    points, curve = axes.lines[0], axes.lines[-1]
    for line, levels in ((points, run.level_db[2, 1]), (curve, expected.level_db[1])):
        same(line.get_xdata(), run.ranges, "ranges")
        same(np.asarray(line.get_ydata(), np.float32), levels, "levels")
    bars = np.array([bar[:, 1] for bar in axes.collections[0].get_segments() if len(bar)])
    there = np.isfinite(run.level_db[2, 1])
    bar = run.stderr_db[2, 1].astype(float)[there]
    tap.equal(bool(np.allclose(np.ptp(bars, axis=1)[-len(bar):], 2 * bar, atol=1e-4)), True, "bars of one error up and down")
    plt.close("all")
    for draw in (asdic.plot.fan, asdic.plot.waterfall):
        draw(beside, shading="auto", cmap="gray")
        plt.close("all")
    axes = asdic.plot.waterfall(run, 1)
    tap.equal(axes.get_ylabel(), "time, s", "waterfall")
    same(np.ma.filled(axes.collections[0].get_array(), np.nan).ravel(), run.level_db[:, 1].ravel(), "its levels")
    corners = np.array(axes.collections[0].get_coordinates())
    tap.equal(np.round(corners[[0, -1], [0, -1]], 9).tolist(),
              np.round([[0, run.times[0] - 0.5 * np.diff(run.times)[0]],
                        [run.ranges[-1] + run.ranges[0], run.times[-1] + 0.5 * np.diff(run.times)[0]]], 9).tolist(), "edges")
    plt.close("all")
    curve = asdic.roc(pool(), object="ball", trials=1000)
    axes = asdic.plot.roc(curve)
    tap.equal(axes.get_xlabel(), "$P_{FA}$", "curve")
    same(axes.lines[0].get_xdata(), curve.points["design_pfa"], "P_FA")
    same(axes.lines[0].get_ydata(), curve.points["closed_pd"], "closed form")
    bounds = axes.collections[0].get_paths()[0].vertices[:, 1]
    tap.equal((bounds.min(), bounds.max()), (curve.points["pd"]["low"].min(), curve.points["pd"]["high"].max()), "bounds")
    raises(KeyError, "'aft' is none of forward, down", asdic.plot.ascope, run, "aft")
    plt.close("all")
    coherent = asdic.Scene.open(os.path.join(ROOT, "data", "scenes", "array.yaml"))
    coherent.output = {"csv": "none", "images": []}
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        axes = asdic.plot.ascope(asdic.simulate(coherent, rays=2000, pings=slice(0, 1)))
    tap.equal((len(axes.collections), axes.get_legend_handles_labels()[1]), (0, ["simulated"]), "no bars of errors that nobody states")
    plt.close("all")


def test_everything_says_what_it_is():
    for name in asdic.__all__:
        if name != "plot":
            tap.equal(bool(getattr(asdic, name).__doc__), True, f"asdic.{name} has a docstring")
    tap.equal(asdic.__version__, ffi.string(lib.asdic_version()).decode(), "version")
    tap.equal(os.path.exists(os.path.join(os.path.dirname(asdic.__file__), "py.typed")), True, "typed")
    tap.equal(os.path.realpath(asdic.__file__).startswith(ROOT), True, "the tree's package")


tap.main(globals())
