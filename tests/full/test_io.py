"""Every system call by which a run writes fails once, in a run of its own: a full disk, a broken
disk, a quota. strace puts the error in. The exit code is 1, one sentence names the file, and
--resume finishes to the bytes of an undisturbed run. ASDIC_IO_STEP takes every so many-th call.
"""
import os
import re
import shutil
import subprocess

import program
import tap
from program import Folder, asdic
from run_folder import same, scene

STEP = int(os.environ.get("ASDIC_IO_STEP", "1"))
ERRORS = {"write": ("ENOSPC", "EIO"), "pwrite64": ("ENOSPC", "EDQUOT"), "fsync": ("EIO",),
          "rename": ("EACCES",), "ftruncate": ("EIO",), "mkdir": ("EROFS",)}
FILES = ["", "/run.json", "/run.json.part", "/pings.npy", "/pings.npy.part", "/bins.csv",
         "/bins.csv.part", "/levels.npy", "/levels.npy.part", "/waterfall_forward.png",
         "/waterfall_forward.png.part", "/ascope_0.png", "/ascope_0.png.part"]


def traced(folder, run, call, inject, *command):
    """Exit code, stderr, and whether the fault was put in."""
    log = folder / "log"
    done = subprocess.run(
        ["strace", "-f", "--seccomp-bpf", "-o", log, "-e", f"trace={call}",
         "-e", f"inject={call}:{inject}", *sum((["-P", folder / run + f] for f in FILES), []),
         program.PATH, *command], capture_output=True, text=True, check=False, timeout=300)
    with open(log, encoding="utf-8", errors="replace") as text:
        return done.returncode, done.stderr, "(INJECTED)" in text.read()


def need_strace():
    program.need_device()
    if not shutil.which("strace"):
        raise tap.Skip("there is no strace")
    done = subprocess.run(["strace", "-o", "/dev/null", "true"], check=False, capture_output=True)
    if done.returncode != 0:
        raise tap.Skip("strace may not trace here")


def each_call(call, error):
    """How often CALL could fail in a run."""
    need_strace()
    with Folder() as folder:
        path = scene(folder, pings=3, rays=200)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        count = 0
        for nth in range(1, 1000, STEP):
            shutil.rmtree(folder / "r", ignore_errors=True)
            code, err, was_injected = traced(folder, "r", call, f"error={error}:when={nth}",
                                             "run", path, "-o", folder / "r")
            if not was_injected:
                tap.equal(code, 0, f"exit code ({err})")
                break
            count += 1
            tap.equal(code, 1, f"exit code when {call} {nth} fails ({err})")
            lines = [line for line in err.strip().splitlines() if " a ping, " not in line]
            tap.equal(len(lines), 1, f"sentences ({err})")
            tap.equal(bool(re.match(r"error: .*'.*/r[/'].*", lines[0])), True, lines[0])
            asdic("run", path, "-o", folder / "r", "--resume").check(code=0)
            same(folder, "whole", "r")
        tap.equal(count > 0, True, f"{call} failed at least once")
        print(f"# {call}: {error} at each of {count} calls")


def short(call, inject):
    """A call that is interrupted, which is no error, or does half of its work."""
    need_strace()
    with Folder() as folder:
        path = scene(folder, pings=3, rays=200)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        code, err, was_injected = traced(folder, "r", call, inject, "run", path, "-o", folder / "r")
        tap.equal(was_injected, True, "injected")
        tap.equal(code, 0, f"exit code ({err})")
        same(folder, "whole", "r")


def add_tests():
    for call, errors in ERRORS.items():
        for error in errors:
            globals()[f"test_{call}_{error}"] = lambda c=call, e=error: each_call(c, e)
    globals()["test_interrupted_writes"] = lambda: short("pwrite64", "error=EINTR:when=2+3")


add_tests()
tap.main(globals())
