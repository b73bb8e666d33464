"""Kernels under Oclgrind: no access out of bounds, no race, nothing uninitialised.

Oclgrind's exit code stays 0, so its log is read. It is slow: the work is kept small.
"""
import os
import shutil
import subprocess
import sys
import tempfile

import tap

PROGRAM = os.environ["ASDIC"]
UNIT, SCENE = sys.argv.pop(1), sys.argv.pop(1)


def under_oclgrind(*command, checks=("--data-races", "--uninitialized")):
    """Runs COMMAND; -cl-opt-disable because Oclgrind 21.10 lacks intrinsics of inlining."""
    if not shutil.which("oclgrind"):
        raise tap.Skip("there is no oclgrind")
    with tempfile.TemporaryDirectory() as folder:
        log = os.path.join(folder, "log")
        done = subprocess.run(["oclgrind", "--build-options", "-cl-opt-disable", *checks,
                               "--max-errors", "5", "--log", log, *command], check=False,
                              capture_output=True, text=True, timeout=900)
        text = ""
        if os.path.exists(log):
            with open(log, encoding="utf-8") as file:
                text = file.read()
    tap.equal(text, "", "Oclgrind's log")
    tap.equal(done.returncode, 0, f"exit code ({done.stderr[-2000:]})")
    return done.stdout


def test_buffers_and_simple_kernels():
    tap.contains(under_oclgrind(UNIT), "[       OK ] kernel_computes")


def test_whole_ping():
    """A mesh, both planes, every kernel of a ping: sampling, tracing, mirrors, receiving.

    Without --uninitialized, on which Oclgrind 21.10 itself crashes here."""
    with tempfile.TemporaryDirectory() as folder:
        under_oclgrind(PROGRAM, "run", SCENE, "-o", os.path.join(folder, "run"),
                       checks=("--data-races",))


def test_every_ray_kernel():
    """Packets of sixteen and sixty-four, and one ray a work-item: what the first run did not take."""
    for kernel in ("pkt16", "frustum64", "scalar"):
        with tempfile.TemporaryDirectory() as folder:
            under_oclgrind(PROGRAM, "run", SCENE, "--kernel", kernel, "-o",
                           os.path.join(folder, "run"), checks=("--data-races",))


tap.main(globals())
