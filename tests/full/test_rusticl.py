"""Every scene of data/scenes on Mesa's Rusticl with llvmpipe beside PoCL."""
import ctypes
import os
import pathlib
import re
import shutil
import time

import program
import tap
from levels import read_bins
from program import Folder, asdic

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
LIBRARY = "libRusticlOpenCL.so.1"
MOST_DB = 1e-3
MESH_DB = 0.1


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


def level_differences(one, other):
    """Of every bin, ascending, dB."""
    result = []
    for beam, rows in one.items():
        for a, b in zip(rows, other[beam], strict=True):
            x, y = a["level_db"], b["level_db"]
            tap.equal(x is None, y is None, f"empty: {beam}, bin {a['bin']}")
            result.append(abs(x - y) if x is not None else 0.0)
    return sorted(result)


def test_scenes():
    """On flat bottoms every bin is the same. Where there are meshes and objects, edges and neighbouring bins
    part rays by their last digit, which this driver rounds in its own way: most bins are the same."""
    program.need_device()
    with Folder() as folder:
        env = drivers(folder)
        shutil.copytree(DATA, folder / "data")
        wrong = []
        for path in sorted(pathlib.Path(folder / "data/scenes").glob("*.yaml")):
            text = re.sub(r"^output: .*\n", "", path.read_text(encoding="utf-8"), flags=re.M)
            path.write_text(text + "\noutput: {csv: long}\n", encoding="utf-8")
            is_flat = "mesh" not in text and "objects" not in text
            tables, seconds = {}, {}
            for device in ("pthread", "rusticl"):
                begin = time.monotonic()
                asdic("run", path, "-o", folder / device, "--force", "-q", "--pings", "0:1",
                      "--device", f"name:{device}", **env).check(code=0)
                seconds[device] = time.monotonic() - begin
                tables[device] = read_bins(folder / device)
            off = level_differences(tables["pthread"], tables["rusticl"])
            median, most_of, most = off[len(off) // 2], off[len(off) * 99 // 100], off[-1]
            print(f"# {path.stem}: median {median:.2g} dB, of 99 % below {most_of:.2g} dB, most "
                  f"{most:.2g} dB; {seconds['rusticl']:.1f} s, PoCL {seconds['pthread']:.1f} s",
                  flush=True)
            if median > MOST_DB or most_of > MESH_DB or (is_flat and most > MOST_DB):
                wrong.append(f"{path.stem}: {median:.3g}, {most_of:.3g}, {most:.3g} dB")
        tap.equal(wrong, [], "scenes that differ")


tap.main(globals())
