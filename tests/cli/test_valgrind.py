"""The program under valgrind: no invalid access, nothing uninitialised, nothing lost; and the queue of
pings under helgrind: no race. With the argument 'full' also what needs a device, which takes minutes.

What other libraries do is left out: valgrind.supp here.
"""
import os
import pathlib
import shutil
import subprocess
import sys

import program
import tap
from program import Folder
from run_folder import same, scene

HERE = pathlib.Path(__file__).resolve().parent
FULL = "full" in sys.argv and not sys.argv.remove("full")
IDEAL = """version: 1
bottom: {depth_m: 20}
sonar: {frequency_khz: 100, ping_rate_hz: 1, speckle: rayleigh, receivers: [{name: a}]}
mission: {waypoints: {points_m: [[0, 0, 10], [9, 0, 10]], speed_mps: 3}}
trial: {time_s: 3, ideal: {pd: 0.5}}
"""
MEMCHECK = ["--leak-check=full", "--errors-for-leak-kinds=definite"]


def valgrind(*command, tool="memcheck", options=()):
    """Runs COMMAND; any finding makes the exit code 99."""
    if not shutil.which("valgrind"):
        raise tap.Skip("there is no valgrind")
    if program.is_sanitized():
        raise tap.Skip("valgrind does not run what sanitizers watch")
    done = subprocess.run(["valgrind", f"--tool={tool}", "-q", "--error-exitcode=99", *options,
                           f"--suppressions={HERE / 'valgrind.supp'}", *map(str, command)],
                          capture_output=True, text=True, check=False)
    tap.equal(done.returncode, 0, f"exit code of {command} ({done.stderr[-4000:]})")


def check(*arguments):
    valgrind(program.PATH, *arguments, options=MEMCHECK)


def test_expect_and_check():
    with Folder() as folder:
        path = scene(folder)
        check("expect", path, "-o", folder / "expected.csv")
        check("check", path)
        # The picture of a trial; to fly it opens devices.
        program.asdic("trial", folder.write("ideal.yaml", IDEAL), "--runs", 1, "-o", folder / "t").check(code=0)
        check("merge", folder / "t", "-o", folder / "merged")


def test_queue_of_pings_has_no_race():
    valgrind(os.environ["TEST_RUN"], "devices_do_not_change_a_byte", tool="helgrind")


def every_command():
    meshes = HERE.parents[1] / "data" / "meshes"
    with Folder() as folder:
        path = scene(folder, pings=3, rays=200)
        check("help")
        check("schema")
        check("check", "--json", meshes / "rocks.ply", meshes / "wreck.ply")
        check("model", "absorption", "f_khz=100", "t_degc=10", "s_ppt=35", "z_m=3", "ph=8")
        program.need_device()
        check("run", path, "-o", folder / "r")
        program.asdic("run", path, "-o", folder / "whole").check(code=0)
        same(folder, "whole", "r")
        check("run", path, "-o", folder / "r", "--resume")
        check("render", folder / "r")
        check("detect", folder / "r")


if FULL:
    globals().pop("test_expect_and_check")
    globals().pop("test_queue_of_pings_has_no_race")
    test_every_command = every_command
tap.main(globals())
