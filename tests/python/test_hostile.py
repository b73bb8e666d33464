"""Bad input, and objects used in ways nobody should: one clear exception each, and no crash."""
import copy
import gc
import os
import pickle
import subprocess
import sys
import tempfile
import threading

from package import need_device, pool, raises
from run_folder import flip
import tap

import numpy as np
import asdic
from asdic._native import ffi, lib

CORNERS = [[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]
FACET = [[0, 1, 2]]


def test_arrays_that_are_no_mesh():
    scene = asdic.Scene()
    bad = np.array(CORNERS)
    bad[1, 2] = np.nan
    for kind, part, corners, facets in (
            (asdic.ArgumentError, "vertices have the shape (3, 2); it must be (n, 3)", [[0, 0]] * 3, FACET),
            (asdic.ArgumentError, "vertices have the shape (9,)", np.zeros(9), FACET),
            (asdic.ArgumentError, "triangles have the shape (1, 4)", CORNERS, [[0, 1, 2, 0]]),
            (asdic.ArgumentError, "triangles have the shape (0,)", CORNERS, []),
            (TypeError, "vertices are of type <U1; they must be numbers", [["a", "b", "c"]], FACET),
            (TypeError, "vertices are of type complex128", np.zeros((3, 3), complex), FACET),
            (TypeError, "triangles are of type float64; they must be integers", CORNERS, [[0.0, 1.0, 2.0]]),
            (TypeError, "triangles are of type bool", CORNERS, [[True, False, True]]),
            (asdic.ArgumentError, "a triangle has the corner 3, but there are 3 vertices", CORNERS, [[0, 1, 3]]),
            (asdic.ArgumentError, "a triangle has the corner -1", CORNERS, [[0, 1, -1]]),
            (asdic.ArgumentError, "a triangle has the corner 4294967296", CORNERS, [[0, 1, 1 << 32]]),
            (asdic.InputError, "vertex 1 (1, 0, nan) is not finite; repair the mesh", bad, FACET),
            (asdic.InputError, "vertex 1 (1, 0, nan)", np.ma.masked_array(CORNERS, np.isnan(bad)), FACET),
            (asdic.InputError, "check the units", np.array(CORNERS) * 1e30, FACET)):
        error = raises(kind, part, scene.add_mesh, corners, facets)
        tap.equal(len(str(error).splitlines()), 1, f"one sentence: {error}")
    tap.equal(len(scene.objects), 0, "nothing of them is kept")
    raises(asdic.ArgumentError, "vertices are rows of different lengths", scene.add_mesh, [[0, 0, 0], [1, 0]], FACET)
    raises(asdic.ArgumentError, "triangles have masked corners", scene.add_mesh, CORNERS,
           np.ma.masked_array(FACET * 2, [[False] * 3, [False, False, True]]))
    for kind, part, north, depth in (
            (TypeError, "depth_m are of type <U4; they must be numbers", [0, 1], [["deep", "1"], ["2", "3"]]),
            (TypeError, "depth_m are of type complex128", [0, 1], np.ones((2, 2), complex)),
            (TypeError, "depth_m are of type timedelta64[s]", [0, 1], np.ones((2, 2), "m8[s]")),
            (TypeError, "north_m are of type <U1", ["a", "b"], np.ones((2, 2))),
            (asdic.ArgumentError, "depth_m are rows of different lengths", [0, 1], [[1, 2], [3]]),
            (asdic.ArgumentError, "north_m is 5 throughout; a grid has two lines or more", [5, 5], np.ones((2, 2)))):
        raises(kind, part, scene.set_terrain, north, [0, 1], depth)
    tap.equal(scene.bottom, None, "no bottom")
    raises(asdic.ArgumentError, "depth_m has the shape (2, 3)", scene.set_terrain, [0, 1, 2], [0, 1], np.zeros((2, 3)))
    for hole in np.nan, np.inf:
        raises(asdic.ArgumentError, f"north_m is {hole} in places; only depth_m has holes", scene.set_terrain, [0, hole, 2],
               [0, 1], np.zeros((3, 2)))
    raises(asdic.ArgumentError, "east_m goes to and fro", scene.set_terrain, [1, 0], [0, 2, 1], np.zeros((2, 3)))
    raises(asdic.ArgumentError, "depth_m is -20 to -15 m, above the sea surface; depths are positive down",
           scene.set_terrain, [0, 1], [0, 1], [[-20, -15], [-20, np.nan]])


def test_arrays_of_every_kind_that_hold_a_mesh():
    """Other types, strides and orders are copied into what the library takes."""
    wide = np.zeros((3, 6), np.float32)
    wide[:, ::2] = CORNERS
    for corners, facets in ((CORNERS, FACET), (np.array(CORNERS, "f4"), np.array(FACET, "u1")),
                            (wide[:, ::2], np.array(FACET, "i8")), (np.asfortranarray(CORNERS), FACET),
                            (np.array(CORNERS, ">f8"), np.array(FACET, ">i4")), (np.array(CORNERS, "i2"), FACET)):
        asdic.Scene().add_mesh(corners, facets)


def test_scenes():
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        none = os.path.join(folder, "none.yaml")
        for function in (asdic.simulate, asdic.Simulator, asdic.expect, asdic.plan):
            raises(asdic.InputError, "none.yaml: cannot open: No such file or directory", function, none)
        raises(asdic.InputError, folder, asdic.Run, folder)
        path = os.path.join(folder, "scene.yaml")
        with open(path, "w", encoding="ascii") as file:
            file.write("version: 1\nsonar: {frequency_kHz: 100}\nbottom: {depth_m: -1}\n")
        error = raises(asdic.InputError, "unknown key 'frequency_kHz'", asdic.plan, path)
        tap.equal(len(error.messages) >= 2, True, "all errors at once")
        tap.contains(str(error), "'depth_m' = -1 is out of range")
    raises(TypeError, "scene is a int; it must be the path of a scene file or an asdic.Scene", asdic.simulate, 7)
    raises(asdic.ArgumentError, "zero byte", asdic.plan, "a\0b")
    error = raises(asdic.InputError, "'sonar'", asdic.plan, asdic.Scene())
    tap.equal(error.status, int(lib.ASDIC_ERROR_INPUT), "status")
    raises(asdic.InputError, "'frequency_khz' = 9000.0 is out of range", asdic.plan,
           pool(sonar={"frequency_khz": np.float64(9000), "source_level_db": 0, "receivers": [{"name": "a"}]}))
    raises(asdic.InputError, "'depth_m' = NaN is not a finite number", asdic.plan, pool(bottom={"depth_m": float("nan")}))
    raises(TypeError, "a scene cannot hold a set", asdic.plan, pool(bottom={"depth_m": {1}}))
    raises(asdic.InputError, "unknown key 'deph_m'; did you mean 'depth_m'?", asdic.plan, pool(bottom={"deph_m": 3}))
    scene = pool()
    scene.add("wall", box={"size_m": [1, 1, 1]}, position_m=(1, 2), material="stel")
    raises(asdic.InputError, "stel", asdic.plan, scene)


FULL = """
import resource, sys
sys.path[:0] = sys.argv[1:2]
from package import pool
import asdic
scene = pool(mission={"pose": {"position_m": [0, 0, 5]}, "pings": 40})
scene.sonar = {**scene.sonar, "bin_length_m": 0.01}
scene.add_mesh([[0, 0, 0]] * 100 + [[0, 1, 0], [1, 0, 0], [0, 0, 1]], [[100, 101, 102]] * 200, position_m=(30, 0, 6))
asdic.simulate(scene, "whole")  # the driver compiles; its files are smaller
for limit, act in ((4 << 20, lambda: asdic.simulate(scene, "full")), (2048, lambda: scene.save("saved"))):
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    try:
        act()
    except asdic.FileError as error:
        print(str(error).replace(chr(10), " "))
"""


def test_full_disk():
    """One error each that names the file, as where there is no room; what was there stays."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        done = subprocess.run([sys.executable, "-W", "ignore", "-c", FULL, os.path.dirname(os.path.abspath(__file__))],
                              cwd=folder, capture_output=True, text=True, timeout=100, check=False)
        tap.equal((done.returncode, done.stderr), (0, ""), "it ends by itself")
        run, saved = done.stdout.splitlines()
        for said, name in ((run, "full"), (saved, "saved")):
            tap.contains(said, "File too large")
            tap.contains(said, name)
        whole = os.path.join(folder, "whole")
        tap.equal(asdic.Run(whole).level_db.shape[:2], (40, 2), "what was there")
        tap.equal(asdic.Run(os.fsencode(whole)).folder, whole, "the folder of a path of bytes")


def test_words_and_numbers():
    scene = pool()
    raises(TypeError, "unexpected keyword argument 'ray'", asdic.simulate, scene, ray=1000)
    raises(TypeError, "unexpected keyword argument 'depth'", asdic.Scene, depth=3)
    raises(asdic.ArgumentError, "rays = 1 is out of range [64, 268435456]", asdic.simulate, scene, rays=1)
    raises(TypeError, "rays = 1000.0 is not an integer", asdic.simulate, scene, rays=1000.0)
    raises(asdic.ArgumentError, "sampler = 'best' is none of adaptive, beam, uniform-sphere", asdic.simulate, scene,
           sampler="best")
    raises(TypeError, "sampler = ['beam'] is no text; it must be one of adaptive, beam, uniform-sphere", asdic.simulate, scene,
           sampler=["beam"])
    for device in 0, False, 1:
        raises(TypeError, f"device is a {type(device).__name__}; it must be text", asdic.simulate, scene, device=device)
        raises(TypeError, "it must be text", asdic.Simulator, scene, device=device)
    for add in scene.add_mesh, scene.set_bottom:
        raises(TypeError, "material = 3 is neither a word, as 'steel', nor the keys of a scene file's material", add, CORNERS,
               FACET, material=3)
    raises(asdic.ArgumentError, "is no row of pings", asdic.simulate, scene, pings=slice(0, 3, 2))
    raises(asdic.ArgumentError, "among the 3 there are", asdic.simulate, scene, pings=range(2, 9))
    raises(TypeError, "pings is a int", asdic.simulate, scene, pings=2)
    raises(asdic.ArgumentError, "ping = 3 is out of range [0, 2]", asdic.expect, scene, 3)
    raises(asdic.ArgumentError, "variant = 'best'", asdic.expect, scene, variant="best")
    raises(asdic.ArgumentError, "give the object", asdic.roc, scene)
    raises(asdic.ArgumentError, "", asdic.roc, scene, object="wreck")
    raises(asdic.ArgumentError, "target = 'swerling9' is none of swerling0, swerling1", asdic.roc, scene, object="ball",
           target="swerling9")
    for one in {"bearing_deg": 3}, {"target_strength_db": -20}:
        raises(asdic.ArgumentError, "are those of a point at range_m", asdic.roc, scene, object="ball", **one)
    raises(asdic.ArgumentError, "absorbtion", asdic.model, "absorbtion", f_khz=1)
    raises(asdic.ArgumentError, "f_kHz", asdic.model, "absorption", f_kHz=1)


def test_text_that_is_none():
    """Half of a pair of surrogates, which no file and no terminal can have."""
    half, scene = "\ud800", pool()
    scene.objects[0]["name"] = half
    for function, *args in ((asdic.plan, scene), (asdic.simulate, scene), (scene.saved_json,), (asdic.plan, half),
                            (asdic.Run, half), (asdic.model, half), (asdic.Scene.open, half)):
        raises(asdic.ArgumentError, "has '\\ud800' in it, which no file can hold", function, *args)
    raises(asdic.ArgumentError, "which no file can hold", asdic.model, "absorption", f_khz=half)
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        raises(asdic.ArgumentError, "which no file can hold", scene.save, os.path.join(folder, "saved"))
        tap.equal(os.listdir(folder), [], "nothing was written")


def test_places_where_nothing_can_be_saved():
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        path = os.path.join(folder, "file")
        with open(path, "w", encoding="ascii"):
            pass
        for place, why in ((path, "File exists"), (os.path.join(path, "below"), "Not a directory"), ("/proc/none", "No such")):
            error = raises(asdic.FileError, why, pool().save, place)
            tap.contains(str(error), f"the scene cannot be saved in '{place}': ")
            raises(asdic.FileError, place, asdic.simulate, pool(), place)


def test_vehicles_in_the_bottom():
    """From there a sonar would hear a sea without a bottom."""
    need_device()
    sonar = asdic.Simulator(pool())
    sonar.ping(0, 0, 12)
    raises(asdic.ArgumentError, "z = 12.1 m, below the bottom at 12 m", sonar.ping, 0, 0, 12.1)
    raises(asdic.ArgumentError, "below the bottom", sonar.pings, [[0, 0, 5], [0, 0, 13]])
    tap.equal(sonar.index, 1, "nothing of it was simulated")
    hill = pool()
    hill.set_terrain([-50, 0, 50], [-50, 0, 50], [[12, 12, 12], [12, 4, 12], [12, 12, 12]])
    hill.mission = {"pose": {"position_m": [0, 0, 2]}}
    over = asdic.Simulator(hill)
    over.ping(40, 40, 8)
    raises(asdic.ArgumentError, "below the bottom at 4 m", over.ping, 0, 0, 4.5)
    over.ping(80, 0, 30)  # beyond the terrain there is none


def test_devices():
    for selector in ("9:9", "name:none such", "nonsense"):
        try:
            asdic.simulate(pool(), device=selector)
        except (asdic.DeviceError, asdic.ArgumentError) as error:
            tap.contains(str(error), selector.rpartition(":")[2].split()[0])
            continue
        raise AssertionError(f"{selector} is a device")
    done = subprocess.run([sys.executable, "-c", "import asdic\nfrom package import pool\ntry:\n  asdic.simulate(pool())\n"
                           "except asdic.DeviceError as error:\n  print(error)"], capture_output=True, text=True,
                          check=True, env={**os.environ, "OCL_ICD_VENDORS": "/nonexistent", "PYTHONPATH":
                                           os.environ["PYTHONPATH"] + os.pathsep + os.path.dirname(__file__)})
    tap.contains(done.stdout, "OpenCL")


def test_kernel_cache_that_cannot_be_written():
    """Devices are found all the same, with a remark."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        env = {name: value for name, value in os.environ.items() if name not in ("POCL_CACHE_DIR", "XDG_CACHE_HOME")}
        for act in ("asdic.devices()", "[asdic.model('transmission-loss', d_m=9, alpha_db_per_km=9, device='auto')]"):
            done = subprocess.run([sys.executable, "-c", f"import asdic; print(len({act}))"], capture_output=True, text=True,
                                  check=False, env={**env, "HOME": "/dev/null", "TMPDIR": folder})
            tap.equal((done.returncode, int(done.stdout or 0) > 0), (0, True), done.stderr)
            tap.contains(done.stderr, "Remark: compiled kernels cannot be kept in '/dev/null/.cache/pocl/kcache' (Not a "
                         f"directory); they are kept in '{folder}/asdic-kernels-")


def test_output_that_exists():
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        out = os.path.join(folder, "run")
        asdic.simulate(pool(), out, pings=slice(0, 1))
        raises(asdic.ExistsError, out, asdic.simulate, pool(), out)
        raises(asdic.ExistsError, "use force=True to replace it, resume=True to continue it", asdic.simulate, pool(), out)
        tap.equal(issubclass(asdic.ExistsError, FileExistsError), True, "as Python calls it")
        tap.equal(len(asdic.simulate(pool(), out, force=True)), 3, "replaced")
        tap.equal(len(asdic.simulate(pool(), out, resume=True)), 3, "resumed")
        raises(asdic.FileError, "/proc/run", asdic.simulate, pool(), "/proc/run")
        path = pool().save(os.path.join(folder, "saved"))
        raises(asdic.FileError, "/proc/run", asdic.simulate, path, "/proc/run")
        other = pool(bottom={"depth_m": 13})
        raises(asdic.InputError, "is not the scene to be resumed", asdic.simulate, other, out, resume=True)
        raises(asdic.ExistsError, out, asdic.simulate, other, out)
        mine = os.path.join(folder, "scene.json")
        with open(mine, "w", encoding="utf-8") as file:
            file.write("precious")
        raises(asdic.ExistsError, mine, asdic.simulate, other, folder)
        with open(mine, encoding="utf-8") as file:
            tap.equal(file.read(), "precious", "another's file of that name")
        broken = os.path.join(folder, "broken")
        raises(asdic.InputError, "depth_m", asdic.simulate, pool(bottom={"depth_m": -13}), broken)
        tap.equal(os.path.exists(broken), False, "nothing is written of a scene with errors")
        with open(os.path.join(out, "pings.npy"), "r+b") as file:
            file.truncate(200)
        raises(asdic.InputError, "pings.npy", asdic.Run, out)


def contents(folder):
    """The files of a folder, by name."""
    found = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), "rb") as file:
            found[name] = file.read()
    return found


def test_a_failed_call_changes_nothing():
    """Neither an old run, which keeps its scene and goes on, nor a folder that was not there."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        out, fresh = (os.path.join(folder, name) for name in ("run", "fresh"))
        scene, other = pool(), pool(bottom={"depth_m": 13})
        other.add_mesh(np.array(CORNERS) + [9, 0, 6], FACET, name="facet")
        reads = pool(mission={"track": os.path.join(out, "track.csv")})
        asdic.simulate(scene, out)
        before = contents(out)

        def stop(*_):
            raise OverflowError("enough")
        for kind, keys in ((asdic.ArgumentError, {"rays": 1}), (asdic.ArgumentError, {"sampler": "best"}),
                           (TypeError, {"seed": 0.5}), (asdic.ArgumentError, {"pings": slice(9, 12)}),
                           (TypeError, {"pings": 3}), (asdic.DeviceError, {"device": "name:none such"}),
                           (asdic.ArgumentError, {"tolerance_db": float("nan")}),
                           (OverflowError, {"tolerance_db": 0.5, "progress": stop})):
            raises(kind, "", asdic.simulate, other, out, force=True, **keys)
            tap.equal(contents(out) == before, True, f"the old run after {keys}")
            raises(kind, "", asdic.simulate, other, fresh, **keys)
            tap.equal(os.path.exists(fresh), False, f"a folder after {keys}")
        # What the library refuses with the scene in its place: a track that the run would write over.
        raises(asdic.ExistsError, "which the scene reads", asdic.simulate, reads, out, force=True)
        tap.equal(contents(out) == before, True, "the old run")
        tap.equal(len(asdic.simulate(scene, out, resume=True)), 3, "it goes on")
        raises(asdic.FileError, "File name too long", asdic.simulate, scene, os.path.join(folder, "f" * 300))
        tap.equal(len(asdic.simulate(other, fresh)), 3, "the corrected call")
        tap.equal(set(asdic.detect(fresh).classes["name"]) >= {"ball", "facet"}, True, "objects keep their names")


def test_damaged_runs():
    """Each file's bytes are checked when it is first looked at: one error, as the program's, and no number of a bad ping."""
    need_device()
    array = {"frequency_khz": 100, "ping_rate_hz": 20, "source_level_db": 200, "bin_length_m": 1,
             "array": {"elements": 8, "beams": {"count": 3, "sector_deg": 30}}}
    output = {"csv": "none", "images": [], "records": "compact"}
    coherent = pool(sonar=array, sampling={"rays": 64, "coherent": True}, output={**output, "elements": True})
    levels = lambda run: run.level_db, lambda run: run.parts["noise"], lambda run: run.times, lambda run: run.records
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        for scene, name, looks in ((pool(output={**output, "truth": True}), "pings.npy", levels),
                                   (pool(output={**output, "truth": True}), "truth.npy", [lambda run: run.truth]),
                                   (coherent, "elements.npy", [lambda run: run.pressure])):
            first = asdic.simulate(scene, folder, pings=slice(1, 3), force=True)
            tap.equal([len(look(first)) for look in looks], [2] * len(looks), "a whole run")
            path = os.path.join(folder, name)
            size, says = os.path.getsize(path), "damaged: ping 2 is not as it was written"
            for at in 100, 3:  # among numbers, and in the sum
                flip(path, size - at)
                run = asdic.Run(folder)
                tap.equal((len(run), ": 2 pings" in repr(run), run.info["seed"]), (2, True, first.info["seed"]), "it opens")
                for look in [*looks, *looks]:
                    raises(asdic.InputError, f"'{path}' is {'missing or damaged' if name == 'elements.npy' else says}; "
                           "'asdic run' with --resume mends the run", look, run)
                flip(path, size - at)
            tap.equal(len(looks[0](asdic.Run(folder))), 2, "whole again")


def test_a_run_that_was_replaced():
    """Says so: its levels are those of its file, which is gone, and the rest would be the new run's."""
    need_device()
    output = {"csv": "none", "images": [], "truth": True}
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        run = asdic.simulate(pool(output=output), folder)
        levels, seed = run.level_db.copy(), run.info["seed"]
        same = asdic.Run(folder)
        run.detect()
        expected = same.expect(1).level_db
        tap.equal((len(same.truth), len(expected)), (3, 2), "a run that is there")
        other = asdic.simulate(pool(output=output), folder, force=True, seed=99, pings=slice(0, 2))
        for look in (run.detect, lambda: run.truth, lambda: asdic.detect(run), lambda: run.pressure):
            raises(asdic.InputError, f"'{folder}' was written anew since this run was opened; open it again "
                   "by asdic.Run", look)
        tap.equal((run.info["seed"], np.array_equal(run.level_db, levels, equal_nan=True)), (seed, True), "its own")
        tap.equal(np.array_equal(run.expect(1).level_db, expected, equal_nan=True), True, "what was expected of it")
        tap.equal((other.info["seed"], len(asdic.Run(folder).truth)), (99, 2), "the new one")


def test_arrays_that_are_no_poses():
    need_device()
    with asdic.Simulator(pool()) as sonar:
        raises(asdic.ArgumentError, "(2,)", sonar.pings, [1.0, 2.0])
        raises(asdic.ArgumentError, "(1, 4)", sonar.pings, [[0, 0, 5, 0]])
        raises(TypeError, "poses are of type <U1; they must be numbers", sonar.pings, [["a", "b", "c"]])
        raises(asdic.ArgumentError, "pose 1 is [0.0, nan, 5.0]", sonar.pings, [[0, 0, 5], [0, np.nan, 5]])
        raises(asdic.ArgumentError, "pose 0 is [0.0, 0.0, nan]", sonar.pings, np.ma.masked_equal([[0, 0, 7], [0, 0, 5]], 7))
        raises(asdic.ArgumentError, "pose 0 is", sonar.pings, [[0, 0, -1.0]])
        raises(asdic.ArgumentError, "poses are rows of different lengths", sonar.pings, [[0, 0, 5], [0, 0]])
        tap.equal((sonar.pings(np.empty((0, 3))), sonar.index), ([], 0), "nothing")


def test_poses():
    need_device()
    sonar = asdic.Simulator(pool())
    raises(asdic.ArgumentError, "x = nan is not finite", sonar.ping, float("nan"), 0, 5)
    raises(asdic.ArgumentError, "a pose is not finite or beyond 1e+07", sonar.ping, 1e100, 0, 5)
    raises(asdic.ArgumentError, "depth, 3e+286 m, is out of range", asdic.Simulator, pool(), depth_m=3e286)
    raises(TypeError, "y = 'east' is not a number", sonar.ping, 0, "east", 5)
    raises(TypeError, "x = '1' is not a number", sonar.ping, "1", 0, 5)
    raises(TypeError, "x = True is not a number", sonar.ping, True, 0, 5)
    raises(asdic.ArgumentError, "x = inf is not finite", sonar.ping, 10**400, 0, 5)
    raises(asdic.ArgumentError, "z = -5 m is no depth of a vehicle: z is positive down", sonar.ping, 0, 0, -5)
    raises(TypeError, "unexpected keyword argument 'heading'", sonar.ping, 0, 0, 5, heading=3)
    raises(asdic.ArgumentError, "out = 3 is no ping of this simulator", sonar.ping, 0, 0, 5, out=3)
    raises(asdic.ArgumentError, "nothing", sonar.move, "nothing", 0, 0, 0)
    tap.equal(sonar.index, 0, "no ping was counted")
    tap.equal(sonar.ping(0, 0, 5).index, 0, "and it works on")


def test_use_after_close():
    need_device()
    sonar = asdic.Simulator(pool())
    ping = sonar.ping(0, 0, 5)
    level = float(np.nanmax(ping.level_db))
    sonar.close()
    sonar.close()
    raises(asdic.ClosedError, "the simulator is closed", sonar.ping, 0, 0, 5)
    raises(asdic.ClosedError, "the simulator is closed", lambda: sonar.sonar)
    raises(asdic.ClosedError, "the simulator is closed", sonar.move, "ball", 0, 0, 5)
    tap.equal(float(np.nanmax(ping.parts["bottom"])) <= level, True, "a ping stays")
    with asdic.Simulator(pool()) as other:
        pass
    raises(asdic.ClosedError, "the simulator is closed", lambda: next(other.fly()))


def test_garbage_in_any_order():
    """Circles, and owners that go first: finalizers run children first."""
    need_device()
    for _ in range(3):
        sonar = asdic.Simulator(pool())
        sonar.myself, sonar.ping_of_mine = sonar, sonar.ping(0, 0, 5)
        energy = sonar.ping_of_mine.intensity["total"]
        del sonar
        gc.collect()
        tap.equal(float(energy.max()) > 0, True, "energies")
    scene = pool()
    scene.add_mesh(CORNERS, FACET, position_m=(10, 0, 5))
    sonar = asdic.Simulator(scene)
    del scene
    gc.collect()
    sonar.ping(0, 0, 5)
    generator = asdic.Simulator(pool()).fly()
    next(generator)
    gc.collect()
    next(generator)
    # Left to the interpreter's end: a simulator, its device, a run, a generator.
    globals()["left"] = (sonar, generator, asdic.simulate(pool()))


def test_two_threads():
    """Two simulators work at once, and one lets its callers in one by one: the bytes are those of one thread."""
    need_device()
    alone = [ping.level_db for ping in asdic.Simulator(pool()).fly()]
    results, errors = {}, []

    def work(name):
        try:
            results[name] = [ping.level_db for ping in asdic.Simulator(pool()).fly()]
        except Exception as error:  # pylint: disable=broad-except # for the main thread to tell
            errors.append(error)
    threads = [threading.Thread(target=work, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    tap.equal(errors, [], "errors")
    for levels in results.values():
        for a, b in zip(alone, levels, strict=True):
            tap.equal(np.array_equal(a, b, equal_nan=True), True, "levels")
    shared, numbers = asdic.Simulator(pool()), []
    threads = [threading.Thread(target=lambda: numbers.append(shared.ping(0, 0, 5).index)) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    tap.equal(sorted(numbers), [0, 1, 2, 3], "numbers of pings")


LEFT = """
import atexit, threading
atexit.register(lambda: print("at the end", energy.max() > 0, ping.altitude, round(abs(ping.pose.yaw_rad), 3)))
import asdic
from package import pool
scanned = pool(sonar={**pool().sonar, "receivers": [{"name": "head"}], "scan": {"sector_deg": 360, "step_deg": 90}})
scanned.set_terrain([-50, 0, 50], [-50, 0, 50], [[12] * 3] * 3)
ping = asdic.Simulator(scanned, rays=64).ping(0, 0, 5)
energy = ping.intensity["total"]
sonar, began = asdic.Simulator(pool(), rays=200000), threading.Event()
def work():
    while True:
        sonar.ping(0, 0, 5)
        began.set()
threading.Thread(target=work, daemon=True).start()
began.wait()
"""


def test_end_while_a_thread_pings():
    """The interpreter ends in the middle of a daemon's ping; pings are there to the very end."""
    need_device()
    done = subprocess.run([sys.executable, "-c", LEFT], capture_output=True, text=True, check=False, timeout=100,
                          env={**os.environ, "MALLOC_PERTURB_": "165", "PYTHONPATH": os.environ["PYTHONPATH"] + os.pathsep +
                               os.path.dirname(__file__)})
    tap.equal((done.returncode, done.stdout), (0, "at the end True 7.0 3.142\n"), done.stderr)


def test_fork():
    """In a forked process nothing hangs or crashes: what is of the parent says so, and arrays are there."""
    need_device()
    sonar, scene = asdic.Simulator(pool()), pool()
    scene.add_mesh(CORNERS, FACET, position_m=(10, 0, 5))
    ping = sonar.ping(0, 0, 5)
    energy = ping.intensity["total"]
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        said = []
        for function in (lambda: sonar.ping(0, 0, 5), lambda: asdic.Simulator(pool()), lambda: asdic.plan(scene)):
            try:
                function()
                said.append("nothing")
            except asdic.Error as error:
                said.append(f"{type(error).__name__} {'spawn' in str(error)}")
        said.append(str(float(energy.max()) > 0))
        del ping, sonar
        gc.collect()
        os.write(writer, "; ".join(said).encode())
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader) as file:
        said = file.read()
    tap.equal(os.waitpid(child, 0)[1], 0, "the child's end")
    tap.equal(said, "ClosedError True; DeviceError True; ClosedError True; True", "what the child heard")
    tap.equal(sonar.ping(0, 0, 5).index, 1, "the parent works on")


FORKED = """
import os, sys
import asdic
from package import pool
{use}
if os.fork() == 0:
    try:
        {then}
        print("did", flush=True)
    except asdic.DeviceError as error:
        print("spawn" in str(error), *["flat"] * ("background='flat'" in str(error)), flush=True)
    os._exit(0)
sys.exit(os.wait()[1])
"""


def test_fork_after_whatever_uses_opencl():
    """The child says so, in place of waiting for threads that it has not; after what does not use it, it works."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        flat, hills = (os.path.join(folder, name) for name in ("flat", "hills"))
        asdic.simulate(pool(), flat)
        hilly = pool()
        hilly.set_terrain([-50, 0, 50], [-50, 0, 50], [[12, 12, 12], [12, 11, 12], [12, 12, 12]])
        asdic.simulate(hilly, hills)
        simulate = "asdic.simulate(pool())"
        for use, then, said in (
                ("asdic.devices()", simulate, "True"), ("asdic.devices()", "asdic.devices()", "True"),
                (f"asdic.detect({flat!r})", simulate, "did"), (f"asdic.detect({hills!r}, background='cfar')", simulate, "did"),
                ("", f"asdic.detect({hills!r}, force=True)", "did"), (simulate, f"asdic.detect({hills!r}, force=True)", "True flat"),
                (simulate, f"asdic.detect({hills!r}, background='flat', force=True)", "did"),
                (f"asdic.detect({hills!r}, force=True)", simulate, "True")):
            path = os.environ["PYTHONPATH"] + os.pathsep + os.path.dirname(__file__)
            done = subprocess.run([sys.executable, "-c", FORKED.format(use=use, then=then)], capture_output=True, text=True,
                                  check=False, timeout=60, env={**os.environ, "PYTHONPATH": path})
            tap.equal((done.returncode, done.stdout.split()), (0, said.split()), f"{use}; {then}: {done.stderr}")


def test_what_other_processes_take():
    """Scenes, with their meshes, and runs; of the rest one sentence says that it is of this process."""
    need_device()
    scene = pool()
    scene.add_mesh(np.array(CORNERS) + [9, 0, 6], FACET, name="facet")
    for twin in pickle.loads(pickle.dumps(scene)), copy.deepcopy(scene):
        tap.equal(twin.to_json(), scene.to_json())
        with asdic.Simulator(twin, rays=200) as one, asdic.Simulator(scene, rays=200) as other:
            tap.equal(one.ping(0, 0, 5).intensity["object"].tobytes(), other.ping(0, 0, 5).intensity["object"].tobytes())
            raises(TypeError, "of this process and cannot be copied or pickled", pickle.dumps, one)
            raises(TypeError, "its arrays can, as level_db", pickle.dumps, one.ping(0, 0, 5))
            raises(TypeError, "its arrays can, as level_db", copy.copy, one.ping(0, 0, 5))
    twin.add_mesh(CORNERS, FACET)
    tap.equal(len(scene.objects) + 1, len(twin.objects), "a copy's objects are its own")
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        run = asdic.simulate(scene, folder, pings=range(1))
        tap.equal(pickle.loads(pickle.dumps(run)).level_db.tobytes(), run.level_db.tobytes())
        raises(TypeError, "give simulate a folder", pickle.dumps, asdic.simulate(scene, pings=range(1)))
        raises(TypeError, "the detect_report is of this process", pickle.dumps, run.detect())


def test_what_a_stopped_run_lacks():
    need_device()

    def stop(what, done, _):
        if what == "pings" and done > 0:
            raise OverflowError("enough")

    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        scene = pool(mission={"pose": {"position_m": [0, 0, 5]}, "pings": 2000}, output={"truth": True, "images": []})
        raises(OverflowError, "enough", asdic.simulate, scene, folder, progress=stop)
        run = asdic.Run(folder)
        tap.equal(0 < len(run) < 2000, True, f"{len(run)} pings")
        tap.equal((len(run.truth), len(run.level_db)), (len(run), len(run)))
        raises(asdic.InputError, "true}, and it comes with the last ping, before which this run was stopped",
               lambda: run.pressure)
        long = pool(sampling={"rays": 1 << 26}, output={"truth": True})
        raises(ZeroDivisionError, "", asdic.simulate, long, folder, progress=lambda *_: 1 // 0, force=True)
        run = asdic.Run(folder)
        tap.equal((len(run), len(run.truth), len(run.level_db)), (0, 0, 0), "stopped before the first ping")
        whole = asdic.simulate(scene, folder, pings=range(2), force=True)
        error = raises(asdic.InputError, "elements.npy is not there", lambda: whole.pressure)
        tap.equal("stopped" in str(error), False, error)


def test_remarks_are_warnings():
    import warnings  # pylint: disable=import-outside-toplevel
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        asdic.model("absorption", f_khz=100, t_degc=10, s_ppt=35, z_m=9000, ph=8)
    tap.equal(["z_m" in str(w.message) for w in said if issubclass(w.category, asdic.Remark)], [True], "a remark")


def test_remarks_are_of_the_callers_line():
    """Of each: where warnings are told once a line, none hides another's."""
    need_device()
    import warnings  # pylint: disable=import-outside-toplevel
    keys = {"f_khz": 100, "t_degc": 10, "s_ppt": 35, "z_m": 9000, "ph": 8}
    scene = pool(sampling={"rays": 64})
    scene.add("far", point=-20, position_m=[900, 0, 5])
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("default")
        asdic.model("absorption", **keys)
        asdic.model("absorption", **keys)
        asdic.plan(scene)
        asdic.simulate(scene)
        asdic.Simulator(scene)
    told = [w for w in said if issubclass(w.category, asdic.Remark)]
    tap.equal({w.filename for w in told}, {__file__}, "files")
    tap.equal(len({w.lineno for w in told}) >= 4, True, f"lines {[(w.lineno, str(w.message)) for w in told]}")


def test_a_scene_from_arrays_warns_once():
    need_device()
    import warnings  # pylint: disable=import-outside-toplevel
    scene = pool(sampling={"rays": 64})
    scene.add("far", point=-20, position_m=[900, 0, 5])
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        asdic.simulate(scene)
    told = [str(w.message) for w in said if issubclass(w.category, asdic.Remark)]
    tap.equal(sum("beyond the maximum range" in message for message in told), 1, f"{told}")


def test_no_tolerance_is_kept_by_no_bin():
    """Nor by coherent pings, which state no error."""
    need_device()
    import warnings  # pylint: disable=import-outside-toplevel
    sonar = {"frequency_khz": 100, "ping_rate_hz": 20, "source_level_db": 20, "receivers": [{"name": "a"}]}
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        asdic.simulate(pool(sonar=sonar), rays=64, tolerance_db=0.5)
    tap.contains("".join(str(w.message) for w in said),
                 "no bin is above the noise, so that none can keep 0.5 dB; the 64 rays a ping stay")
    del sonar["receivers"]
    array = pool(sonar={**sonar, "array": {"elements": 8, "beams": {"count": 3, "sector_deg": 30}}},
                 sampling={"rays": 64, "coherent": True})
    raises(asdic.ArgumentError, "cannot be kept with 'sampling: {coherent: true}'",
           lambda: asdic.simulate(array, tolerance_db=0.5))


def test_nothing_is_left_behind():
    """Handles are destroyed: a thousand pings cost no more memory than one."""
    need_device()

    def kilobytes():
        with open("/proc/self/status", encoding="ascii") as file:
            return next(int(line.split()[1]) for line in file if line.startswith("VmRSS"))
    sonar = asdic.Simulator(pool(), rays=64)
    for _ in range(50):
        sonar.ping(0, 0, 5)
    before = kilobytes()
    for _ in range(1000):
        sonar.ping(0, 0, 5)
    tap.equal(kilobytes() - before < 3000, True, f"{kilobytes() - before} KiB more after 1,000 pings")
    tap.equal(ffi.sizeof("asdic_ping") > 0, True, "sizes")


tap.main(globals())
