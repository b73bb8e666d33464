"""Every kernel in every specialisation is OpenCL C 1.2 without a warning, by clang alone, for devices
without double precision; none asks for local memory, of which a device may have little, and none changes
an argument that is a structure: Mesa's Rusticl gives the callee the caller's own."""
import itertools
import json
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
    "draw.cl": {"ASDIC_WIDTH": (1, 8, 16), "ASDIC_HAS_MESH": (0, 1), "ASDIC_BENT": (0, 1, 2)},
    "reduce.cl": {"ASDIC_WIDTH": (1, 8, 16), "ASDIC_DEPOSIT": (0, 1, 2)},
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


# Chosen not by a specialisation but by what a mission asks for.
WITH_TRUTH = ["-DASDIC_TRUTH=1", "-DASDIC_LAYERS=1"]


def clang(name, *more):
    if not shutil.which("clang"):
        raise tap.Skip("there is no clang")
    return subprocess.run(["clang", *STRICT, *more, os.path.join(KERNELS, name)],
                          capture_output=True, text=True, check=False)


def defines_of(name):
    choices = SPECIALISATIONS.get(name, PING)
    return [[f"-D{key}={value}" for key, value in zip(choices, values)]
            for values in itertools.product(*choices.values())]


def lint(name):
    for defines in defines_of(name):
        done = clang(name, *defines)
        if done.returncode:
            raise AssertionError(f"{' '.join(defines)}: {done.stderr}")


def variable_of(node):
    """Of what variable NODE, the left side of an assignment, is a part; None where it points."""
    kind = node["kind"]
    if kind == "DeclRefExpr":
        return node["referencedDecl"]["id"]
    if kind == "MemberExpr" and node["isArrow"] or node.get("castKind") == "LValueToRValue":
        return None
    parts = ("MemberExpr", "ArraySubscriptExpr", "ParenExpr", "ImplicitCastExpr",
             "ExtVectorElementExpr")
    return variable_of(node["inner"][0]) if kind in parts else None


def assigned(node):
    """The variables that NODE and what is in it assign to."""
    if node["kind"] in ("BinaryOperator", "CompoundAssignOperator"):
        opcode = node["opcode"]
        if opcode.endswith("=") and opcode not in ("==", "!=", "<=", ">="):
            yield variable_of(node["inner"][0])
    elif node["kind"] == "UnaryOperator" and node["opcode"] in ("++", "--"):
        yield variable_of(node["inner"][0])
    for inner in node.get("inner", []):
        if inner:
            yield from assigned(inner)


def changed_arguments(tree):
    """FUNCTION(ARGUMENT) of every structure handed over by value and assigned to."""
    for function in tree["inner"]:
        if function["kind"] != "FunctionDecl":
            continue
        inner = function.get("inner", [])
        given = {}
        for one in inner:
            if one["kind"] == "ParmVarDecl":
                type_of = one["type"].get("desugaredQualType", one["type"]["qualType"])
                if "struct " in type_of and "*" not in type_of:
                    given[one["id"]] = one["name"]
        for variable in set(assigned({"kind": "", "inner": inner})) & set(given):
            yield f"{function['name']}({given[variable]})"


def keeps_arguments(name):
    kinds = defines_of(name)
    for defines in (kinds[0], kinds[-1], WITH_TRUTH + ["-DASDIC_HAS_MIRRORS=1"]):
        tree = clang(name, *defines, "-Xclang", "-ast-dump=json").stdout
        found = sorted(changed_arguments(json.loads(tree)))
        if found:
            raise AssertionError(f"{' '.join(defines)}: changed: {', '.join(found)}")


def test_no_local_memory():
    for name in os.listdir(KERNELS):
        if name.endswith((".cl", ".h")):
            with open(os.path.join(KERNELS, name), encoding="utf-8") as file:
                tap.lacks(file.read(), "__local")


def add_tests(name):
    globals()[f"test_{name}"] = lambda: lint(name)
    globals()[f"test_arguments_{name}"] = lambda: keeps_arguments(name)


for entry in sorted(os.listdir(KERNELS)):
    if entry.endswith(".cl"):
        add_tests(entry)

tap.main(globals())
