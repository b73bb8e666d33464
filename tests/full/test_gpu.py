"""Kernels in the form for GPUs, compiled for some by clang and libclc without a device.

    test_gpu.py KERNELS DEVICES.md      all compile; memory and waves; the tables in DEVICES.md are true
    test_gpu.py KERNELS --table         prints these tables

What a kernel takes is the most over its specialisations. Waves are how many groups of work-items a unit of
an AMD GPU runs at a time with these registers: at most 10 of gfx906, 16 of gfx1030. What NVIDIA's
registers come to only NVIDIA's own assembler knows; a kernel's local memory is seen.
"""
import functools
import os
import re
import subprocess
import sys
import tempfile

import tap

KERNELS, PAGE = sys.argv.pop(1), sys.argv.pop(1)

LIBCLC = "/usr/lib/clc"
# As drivers for OpenCL compile: functions become part of the kernels that call them.
AMD = ["-mllvm", "-amdgpu-early-inline-all=true", "-mllvm", "-amdgpu-function-calls=false"]
TARGETS = {
    "gfx906": (["-target", "amdgcn--amdhsa", "-mcpu=gfx906", *AMD], "amdgcn--amdhsa.bc"),
    "gfx1030": (["-target", "amdgcn--amdhsa", "-mcpu=gfx1030", *AMD], "amdgcn--amdhsa.bc"),
    # The driver offers 64-bit atomics, clang does not know.
    "nvptx64": (["-target", "nvptx64--nvidiacl", "-Xclang", "-target-cpu", "-Xclang", "sm_70",
                 "-Xclang", "-cl-ext=+cl_khr_int64_base_atomics",
                 "-mllvm", "-inline-threshold=100000"], "nvptx64--nvidiacl.bc"),
}

# As lib/sim and lib/scene specialise them for a GPU: atomics add, or the fan keeps arrivals.
PING = [{"ASDIC_DEPOSIT": deposit, "ASDIC_COMMON_AXIS": axis, "ASDIC_HAS_MESH": mesh,
         "ASDIC_HAS_MIRRORS": mirrors, "ASDIC_HAS_WATER": 1}
        for deposit, axis in ((0, 0), (0, 1), (1, 0), (2, 0)) for mesh in (0, 1)
        for mirrors in (0, 1)]
FULL = {"ASDIC_HAS_MESH": 1, "ASDIC_HAS_MIRRORS": 1, "ASDIC_HAS_WATER": 1}
FAN = {"ASDIC_COMPONENTS": 5, "ASDIC_HAS_MIRRORS": 1}
PROGRAMS = {
    "camera.cl": [{}],
    "draw.cl": [{"ASDIC_HAS_MESH": mesh} for mesh in (0, 1)],
    "fan.cl": [{"ASDIC_COMPONENTS": components, "ASDIC_COMMON_AXIS": axis, "ASDIC_HAS_MIRRORS": 1}
               for components in (3, 5) for axis in (0, 1)],
    "law.cl": [{}],
    "model.cl": [{}],
    "ping.cl": PING,
    "reduce.cl": [{"ASDIC_DEPOSIT": deposit} for deposit in (0, 1, 2)],
    "trace_scalar.cl": [{"TRACE_STACK": 64}, {"TRACE_STACK": 128}],
}
# The other forms: where rays are bent by one gradient or by layers, where truths of bins are kept, where
# pings are coherent. Rows of their own in the table.
OTHERS = {
    "coherent.cl": [{"ASDIC_HAS_MESH": mesh} for mesh in (0, 1)],
    "draw.cl": [{"ASDIC_HAS_MESH": 1, "ASDIC_BENT": bent} for bent in (1, 2)],
    "fan.cl": [{**FAN, "ASDIC_COMMON_AXIS": axis, "ASDIC_LAYERS": layers, "ASDIC_TRUTH": truth}
               for axis in (0, 1) for layers, truth in ((1, 0), (0, 1), (1, 1))],
    "ping.cl": [{**FULL, "ASDIC_DEPOSIT": deposit, "ASDIC_COMMON_AXIS": 0, "ASDIC_BENT": bent, "ASDIC_TRUTH": truth}
                for deposit in (0, 1, 2) for bent, truth in ((1, 0), (2, 0), (0, 1), (2, 1))],
}
# Groups of a processor's arrivals are added one by one; no GPU runs it.
NEVER = {"collect"}

STACK_BYTES = 256  # of the walk through the tree, which is all that may lie outside registers
LEAST_WAVES = {"trace_scalar": 4, "advance": 4}  # of what follows rays; others: 3


def options(target):
    arguments, bitcode = TARGETS[target]
    return ["-x", "cl", "-cl-std=CL1.2", "-O3", "-nogpulib", "-Xclang", "-finclude-default-header",
            "-Xclang", "-mlink-builtin-bitcode", "-Xclang", os.path.join(LIBCLC, bitcode),
            "-Wno-linker-warnings", "-DASDIC_WIDTH=1", "-S", *arguments]


@functools.lru_cache
def compiler():
    """The clang that libclc, which is bitcode, is for."""
    for clang in ("clang-15", "clang-14", "clang"):
        with tempfile.TemporaryDirectory() as folder:
            source = os.path.join(folder, "empty.cl")
            with open(source, "w", encoding="utf-8") as file:
                file.write("__kernel void empty(__global float *x) { *x = sin(*x); }\n")
            try:
                done = subprocess.run([clang, *options("gfx906"), source, "-o", os.devnull],
                                      capture_output=True, check=False)
            except FileNotFoundError:
                continue
            if done.returncode == 0:
                return clang
    raise tap.Skip("there is no clang with a libclc of its version")


def assembly(target, program, defines):
    command = [compiler(), *options(target), *(f"-D{k}={v}" for k, v in defines.items()),
               os.path.join(KERNELS, program), "-o", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise AssertionError(f"{target}: {program} with {defines}: {done.stderr}")
    return done.stdout


def kernels_in(target, text):
    """Of each kernel in TEXT: name, (registers, bytes outside them, waves)."""
    if target == "nvptx64":
        for name, body in re.findall(r"\.entry (\w+)\((.*?)\n}", text, re.S):
            depot = re.search(r"__local_depot\d+\[(\d+)\]", body)
            yield name, (0, int(depot[1]) if depot else 0, 0)
        return
    names = re.findall(r"\.amdhsa_kernel (\w+)", text)
    infos = text.split("; Kernel info:")[1:]
    tap.equal(len(infos), len(names), "kernels")
    for name, info in zip(names, infos):
        yield name, tuple(int(re.search(rf"; {word}: (\d+)", info)[1])
                          for word in ("NumVgprs", "ScratchSize", "Occupancy"))


@functools.lru_cache
def measured(others=False):
    """{kernel: {target: (registers, bytes, waves)}}, the worst of all specialisations."""
    worst = {}
    for target in TARGETS:
        for program, choices in (OTHERS if others else PROGRAMS).items():
            for defines in choices:
                for name, (registers, size, waves) in kernels_in(
                        target, assembly(target, program, defines)):
                    if name in NEVER:
                        continue
                    of = worst.setdefault(name, {})
                    seen = of.get(target, (0, 0, waves))
                    of[target] = (max(registers, seen[0]), max(size, seen[1]),
                                  min(waves, seen[2]))
    return worst


def table(others=False):
    lines = ["| kernel | gfx906: registers, scratch, waves | gfx1030 | nvptx64: local memory |",
             "|---|---|---|---|"]
    for name, of in sorted(measured(others).items()):
        amd = ["%d, %d B, %d" % of[target] for target in ("gfx906", "gfx1030")]
        lines.append(f"| `{name}` | {amd[0]} | {amd[1]} | {of['nvptx64'][1]} B |")
    return "\n".join(lines)


def test_every_program_is_compiled():
    entries = {name for name in os.listdir(KERNELS) if name.endswith(".cl")}
    parts = {"advance.cl", "array.cl", "collect.cl", "gates.cl", "multipath.cl", "pilot.cl", "sample.cl",
             "scatterers.cl", "shade.cl", "volume.cl"}
    vectors = {"trace.cl", "trace_packets.cl"}  # for processors
    tap.equal(set(PROGRAMS) | set(OTHERS), entries - parts - vectors, "programs")


def both():
    """Kernels with what they take, of all forms."""
    yield from measured().items()
    yield from measured(others=True).items()


def test_only_the_stack_of_the_trace_lies_outside_registers():
    for name, of in both():
        for target, (_, size, _) in of.items():
            limit = STACK_BYTES if name == "trace_scalar" else 0
            assert size <= limit, f"{name} takes {size} B on {target}, at most {limit}"


def test_waves():
    for name, of in both():
        for target in ("gfx906", "gfx1030"):
            least = LEAST_WAVES.get(name, 3)
            assert of[target][2] >= least, f"{name} has {of[target][2]} waves on {target}"


def test_table_is_that_of_the_page():
    with open(PAGE, encoding="utf-8") as file:
        text = file.read()
    version = subprocess.run([compiler(), "--version"], capture_output=True, text=True,
                             check=True).stdout.split()[3]
    if f"clang {version}" not in text:
        raise tap.Skip(f"the page's table is of another clang than {version}")
    tap.contains(text, table())
    tap.contains(text, table(others=True))


if PAGE == "--table":
    print(table(), table(others=True), sep="\n\n")
else:
    tap.main(globals())
