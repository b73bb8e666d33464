"""Programs that are not ours. A test is skipped where one is not installed."""
import os
import shutil
import subprocess

import tap

SYSTEM_PYTHON = "/usr/bin/python3"  # Debian's, which has Debian's numpy


def tool(*arguments, cwd, stdin=""):
    """Standard output of a foreign program, which must be content."""
    if not shutil.which(arguments[0]):
        raise tap.Skip(f"no {arguments[0]}")
    done = subprocess.run(arguments, cwd=cwd, input=stdin, capture_output=True, text=True,
                          timeout=60, check=False, env={**os.environ, "LC_ALL": "C"})
    if done.returncode:
        raise AssertionError(f"{arguments}: {done.returncode}: {done.stderr or done.stdout}")
    return done.stdout


def numpy(script, cwd, also=""):
    """Output of SCRIPT in a Python that has numpy and ALSO, "xarray, ..."."""
    modules = "numpy" + (", " + also if also else "")
    done = subprocess.run([SYSTEM_PYTHON, "-c", f"import sys\ntry:\n import {modules}\n"
                           "except ImportError:\n sys.exit(77)\n" + script],
                          cwd=cwd, capture_output=True, text=True, timeout=120, check=False)
    if done.returncode == 77:
        raise tap.Skip("no " + modules)
    if done.returncode:
        raise AssertionError(done.stderr)
    return done.stdout
