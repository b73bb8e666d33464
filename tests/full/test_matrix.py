"""The same bytes whatever way they come about, a hundred times; and how far kinds of devices differ.

Each round draws a number of threads, a limit of work-groups, a kernel, devices of one kind, and whether
the mission runs whole, in shards that are merged, or in parts that are resumed. ASDIC_ROUNDS is how
many (default 100).
"""
import glob
import os
import random
import shutil
import signal
import subprocess
import time

import program
import tap
from levels import COMPONENTS, read_bins
from program import Folder, asdic
from run_folder import PAIR, same, scene

ROUNDS = int(os.environ.get("ASDIC_ROUNDS", "100"))
FAULT = os.environ["OPENCL_FAULT_LIBRARY"]
PINGS = 40
THREADS = ("1", "2")
WORK_GROUPS = (1, 3, 16, 64, 4096)
KERNELS = ("auto", "wide8", "pkt16", "frustum64", "scalar")
DEVICES = ("pthread", "pthread pthread")
WAYS = ("whole", "shards", "resumed")
MOST_DB = 1e-3
FAINT_DB = 50  # a part of a level that is fainter by so much changes it by 4e-5 dB at most


def whole(folder, path, options, env):
    asdic("run", path, "-o", folder / "r", *options, **env).check(code=0)


def shards(folder, path, options, env):
    parts = [folder / f"part{k}" for k in (1, 2, 3)]
    for k, part in enumerate(parts, 1):
        asdic("run", path, "-o", part, "--shard", f"{k}/3", *options, **env).check(code=0)
    asdic("merge", *reversed(parts), "-o", folder / "r").check(code=0)
    for part in parts:
        shutil.rmtree(part)


def resumed(folder, path, options, env):
    """Asked to stop when some pings are there, at most twice; then to the end."""
    luck = random.Random(str(options))
    command = [program.PATH, "run", path, "-o", folder / "r", *options]
    for how in ([], ["--resume"]):
        child = subprocess.Popen([*command, *how], env=program.environment(env),
                                 stderr=subprocess.DEVNULL)
        time.sleep(luck.uniform(0.05, 0.4))
        child.send_signal(signal.SIGINT)
        tap.equal(child.wait() in (0, 130, -2), True, f"exit code {child.returncode}")
        if not os.path.exists(folder / "r/run.json"):
            shutil.rmtree(folder / "r", ignore_errors=True)
            break
    again = ["--resume"] if os.path.exists(folder / "r") else []
    asdic(*command[1:], *again, **env).check(code=0)


def test_same_bytes_every_way():
    program.need_device()
    luck, told = random.Random(9), {}
    with Folder() as folder:
        path = scene(folder, pings=PINGS, rays=1500)
        asdic("run", path, "-o", folder / "reference").check(code=0)
        for number in range(ROUNDS):
            draw = (WAYS[number % 3], luck.choice(THREADS), luck.choice(WORK_GROUPS),
                    luck.choice(KERNELS), luck.choice(DEVICES))
            way, threads, group, kernel, devices = draw
            env = {"POCL_MAX_PTHREAD_COUNT": threads, "POCL_DEVICES": devices,
                   "LD_PRELOAD": FAULT, "OPENCL_WORK_GROUP": str(group)}
            try:
                globals()[way](folder, path, ["--kernel", kernel, "--device", "all"], env)
                same(folder, "reference", "r")
            except AssertionError as error:
                raise AssertionError(f"round {number}, {draw}: {error}") from error
            shutil.rmtree(folder / "r")
            for value in draw:
                told[value] = told.get(value, 0) + 1
        print(f"# {ROUNDS} rounds with equal bytes: "
              + ", ".join(f"{value} {told[value]}" for value in sorted(told, key=str)))


def oclgrind(folder):
    """The environment of Oclgrind's device alone, or None."""
    found = glob.glob("/usr/lib/*/liboclgrind-rt-icd.so")
    if not found:
        return None
    os.mkdir(folder / "vendors")
    with open(folder / "vendors/oclgrind.icd", "w", encoding="ascii") as icd:
        icd.write(found[0] + "\n")
    # Without the switch Oclgrind 21.10 lacks intrinsics of inlining.
    env = {"OCL_ICD_VENDORS": folder / "vendors", "OCLGRIND_BUILD_OPTIONS": "-cl-opt-disable"}
    return env if "Oclgrind" in asdic("devices", **env).out else None


def largest_db(one, other):
    """Between two tables: levels, and parts of them that are not faint."""
    largest = 0.0
    for beam, rows in one.items():
        for a, b in zip(rows, other[beam], strict=True):
            for name in ["level", *COMPONENTS]:
                x, y = a[f"{name}_db"], b[f"{name}_db"]
                if max(x or -999, y or -999) < a["level_db"] - FAINT_DB:
                    continue
                if (x is None) != (y is None):
                    raise AssertionError(f"{beam}: {name}_db is {x} and {y} in {a}")
                largest = max(largest, abs(x - y) if x is not None else 0.0)
    return largest


def test_kinds_of_devices_differ_little():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=4, rays=256, receivers=PAIR)
        kinds = {"pthread": {"POCL_DEVICES": "pthread"}, "basic": {"POCL_DEVICES": "basic"},
                 "oclgrind": oclgrind(folder)}
        tables = {}
        for kind, env in kinds.items():
            if env:
                asdic("run", path, "-o", folder / kind, **env).check(code=0)
                tables[kind] = read_bins(folder / kind)
        for kind, table in tables.items():
            difference = largest_db(tables["pthread"], table)
            print(f"# pthread and {kind}: {difference:.3g} dB at most")
            tap.equal(difference <= MOST_DB, True, f"{difference} dB between pthread and {kind}")


tap.main(globals())
