"""The shared library exports the public functions and nothing else, and says which interface it has."""
import glob
import os
import re
import shutil
import subprocess
import sys

import tap

LIBRARY, INCLUDE = sys.argv.pop(1), sys.argv.pop(1)


def exported():
    if not shutil.which("nm"):
        raise tap.Skip("there is no nm")
    done = subprocess.run(["nm", "-D", "--defined-only", LIBRARY], capture_output=True, text=True,
                          check=True)
    return {line.split()[-1].split("@")[0] for line in done.stdout.splitlines()}


def declared():
    """Names that the public headers mark with ASDIC_API."""
    names = set()
    for path in glob.glob(os.path.join(INCLUDE, "asdic", "*.h")):
        with open(path, encoding="utf-8") as file:
            names.update(re.findall(r"^ASDIC_API[^;{]*?\b(asdic_\w+)\(", file.read(), re.MULTILINE))
    return names


def test_only_public_names_are_exported():
    tap.equal(sorted(exported() - declared()), [])


def test_every_declared_function_is_there():
    tap.equal(len(declared()) > 40, True, "declarations are found")
    tap.equal(sorted(declared() - exported()), [])


def test_soname_has_the_interface():
    if not shutil.which("readelf"):
        raise tap.Skip("there is no readelf")
    done = subprocess.run(["readelf", "-d", LIBRARY], capture_output=True, text=True, check=True)
    tap.equal(re.findall(r"SONAME.*\[(.*)\]", done.stdout), ["libasdic.so.0"])


tap.main(globals())
