"""Every kernel in every specialisation is OpenCL C 1.2 without a warning, by clang alone, for devices
without double precision; none asks for local memory, of which a device may have little."""
import itertools
import os
import shutil
import subprocess
import sys

import tap

KERNELS = sys.argv.pop(1)

# Helpers that one specialisation does not need are no fault of a shared header.
STRICT = ["-x", "cl", "-cl-std=CL1.2", "-Xclang", "-finclude-default-header", "-fsyntax-only",
          "-Xclang", "-cl-ext=-cl_khr_fp64,-__opencl_c_fp64",
          "-Wall", "-Wextra", "-Wshadow", "-Werror", "-Wno-unused-parameter",
          "-Wno-unused-function"]

PING = {"ASDIC_WIDTH": (1, 8, 16), "ASDIC_DEPOSIT": (0, 1, 2), "ASDIC_HAS_MESH": (0, 1),
        "ASDIC_COMMON_AXIS": (0, 1), "ASDIC_HAS_WATER": (0, 1)}
COHERENT = {"ASDIC_WIDTH": (1, 8, 16), "ASDIC_HAS_MESH": (0, 1)}
SPECIALISATIONS = {
    "ping.cl": {**PING, "ASDIC_HAS_MIRRORS": (0, 1), "ASDIC_BENT": (0, 1, 2)},
    "fan.cl": {"ASDIC_WIDTH": (1, 16), "ASDIC_COMPONENTS": (3, 4, 5), "ASDIC_COMMON_AXIS": (0, 1),
               "ASDIC_HAS_MIRRORS": (0, 1)},
    "coherent.cl": COHERENT,
    "scatterers.cl": COHERENT,
    "gates.cl": COHERENT,
    "array.cl": COHERENT,
    "trace.cl": {"TRACE_STACK": (64,)},
    "trace_packets.cl": {"TRACE_STACK": (64,)},
    "camera.cl": {},
    "law.cl": {},
    "model.cl": {},
}


def lint(name):
    if not shutil.which("clang"):
        raise tap.Skip("there is no clang")
    choices = SPECIALISATIONS.get(name, PING)
    for values in itertools.product(*choices.values()):
        defines = [f"-D{key}={value}" for key, value in zip(choices, values)]
        done = subprocess.run(["clang", *STRICT, *defines, os.path.join(KERNELS, name)],
                              capture_output=True, text=True, check=False)
        if done.returncode:
            raise AssertionError(f"{' '.join(defines)}: {done.stderr}")


def test_no_local_memory():
    for name in os.listdir(KERNELS):
        if name.endswith((".cl", ".h")):
            with open(os.path.join(KERNELS, name), encoding="utf-8") as file:
                tap.lacks(file.read(), "__local")


def add_test(name):
    globals()[f"test_{name}"] = lambda: lint(name)


for entry in sorted(os.listdir(KERNELS)):
    if entry.endswith(".cl"):
        add_test(entry)

tap.main(globals())
