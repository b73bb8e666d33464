"""Runs of run_folder's scene, each made once a program."""
import csv
import hashlib
import os
import shutil
import tempfile

import program
import tap
from program import asdic
from run_folder import data, scene

KEPT = tempfile.TemporaryDirectory(prefix="asdic-test-")  # pylint: disable=consider-using-with


def run_of(folder, pings=4, **changes):
    """A run 'r' of the pool, all formats; its levels from bins.csv in file order. Made once, and copied where it is
    asked for again."""
    program.need_device()
    path = scene(folder, pings=pings, rays=500)
    text = folder.read("pool.yaml")
    for old, new in changes.get("edits", {"{npy: true,": "{npy: true, netcdf: true,"}).items():
        tap.contains(text, old)
        text = text.replace(old, new)
    folder.write("pool.yaml", text)
    kept = os.path.join(KEPT.name, hashlib.sha256(text.encode()).hexdigest())
    if not os.path.exists(kept):
        make_run(folder, path, text)
        shutil.copytree(folder / "r", kept + "/r")
        shutil.copy(path, kept)
    shutil.copy(kept + "/pool.yaml", path)
    shutil.copytree(kept + "/r", folder / "r", dirs_exist_ok=True)
    return folder / "r"


def make_run(folder, path, text):
    done = asdic("run", path, "-o", folder / "r")
    if "this build has no netCDF" in done.err:
        folder.write("pool.yaml", text.replace("netcdf: true, ", "").replace(", netcdf: true", ""))
        done = asdic("run", path, "-o", folder / "r")
    elif "netcdf: true" in text:
        tap.equal(os.path.exists(folder / "r/run.nc"), True, "run.nc")
    done.check(code=0)


def rows_of(folder):
    return list(csv.DictReader(data(folder, "r", "bins.csv").decode().splitlines()))
