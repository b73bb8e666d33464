"""Every scene of data/scenes on Mesa's Rusticl with llvmpipe beside PoCL."""
import ctypes
import os
import pathlib
import re
import shutil
import time

import program
import tap
from program import Folder, asdic

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
LIBRARY = "libRusticlOpenCL.so.1"


def drivers(folder):
    """The environment of PoCL and Rusticl together."""
    try:
        ctypes.CDLL(LIBRARY)
    except OSError as error:
        raise tap.Skip(f"there is no {LIBRARY}") from error
    os.mkdir(folder / "vendors")
    for path in pathlib.Path("/etc/OpenCL/vendors").glob("pocl.icd"):
        shutil.copy(path, folder / "vendors")
    with open(folder / "vendors/rusticl.icd", "w", encoding="ascii") as icd:
        icd.write(LIBRARY + "\n")
    env = {"OCL_ICD_VENDORS": folder / "vendors", "RUSTICL_ENABLE": "llvmpipe"}
    listed = asdic("devices", **env).check(code=0).out
    if "rusticl" not in listed or "pthread" not in listed:
        raise tap.Skip("PoCL and Rusticl do not show together")
    return env


def test_auto_and_all_take_the_quick_one():
    program.need_device()
    with Folder() as folder:
        env = drivers(folder)
        star = [line for line in asdic("devices", **env).out.splitlines() if line.startswith("* ") and ":" in line]
        tap.equal(len(star), 1, "devices that auto takes")
        tap.lacks(star[0], "rusticl")
        done = asdic("run", DATA / "scenes/scenario1.yaml", "-o", folder / "out", "--device", "all",
                     **env).check(code=0)
        tap.contains(done.err, "is left out of 'all'")


def test_kernels_that_it_cannot_compile_are_refused():
    program.need_device()
    with Folder() as folder:
        env = drivers(folder)
        done = asdic("run", DATA / "scenes/scenario2.yaml", "-o", folder / "out", "--kernel",
                     "pkt16", "--device", "name:rusticl", **env)
        tap.contains(done.err, "cannot compile ray kernel 'pkt16'")


def test_scenes():
    """Two compilers, vectors of eight here and single rays there: the same bytes."""
    program.need_device()
    with Folder() as folder:
        env = drivers(folder)
        shutil.copytree(DATA, folder / "data")
        different = []
        for path in sorted(pathlib.Path(folder / "data/scenes").glob("*.yaml")):
            text = re.sub(r"^output: .*\n", "", path.read_text(encoding="utf-8"), flags=re.M)
            path.write_text(text + "\noutput: {csv: long}\n", encoding="utf-8")
            tables, seconds = {}, {}
            for device in ("pthread", "rusticl"):
                begin = time.monotonic()
                asdic("run", path, "-o", folder / device, "--force", "-q", "--pings", "0:1",
                      "--device", f"name:{device}", most_s=600, **env).check(code=0)
                seconds[device] = time.monotonic() - begin
                tables[device] = pathlib.Path(folder / device, "bins.csv").read_bytes()
            print(f"# {path.stem}: {seconds['rusticl']:.1f} s, PoCL {seconds['pthread']:.1f} s", flush=True)
            if tables["pthread"] != tables["rusticl"]:
                different.append(path.stem)
        tap.equal(different, [], "scenes with other bytes on Rusticl")


tap.main(globals())
