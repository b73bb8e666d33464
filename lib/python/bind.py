"""Writes the C source of asdic._native: the public headers, as cffi compiles them into a Python module.

    bind.py OUT.c DEPFILE INCLUDE COMPILER...

The headers are the only description of the interface: functions, structs and enums come from what the
preprocessor leaves of asdic/asdic.h, constants from its macros. cffi has the C compiler compare sizes.
"""
import os
import re
import subprocess
import sys

import cffi

# What the library calls back. They are told apart by name in asdic/_library.py.
CALLBACKS = """
extern "Python" void asdic_python_log(void *user, asdic_log_level level, const char *message);
extern "Python" void asdic_python_progress(void *user, const char *what, size_t done, size_t total);
extern "Python" void asdic_python_run_progress(void *user, const asdic_run_progress *progress);
"""

# What takes the interpreter many steps, and every ping needs: a ping in a piece of memory (the struct, energies, one
# mechanism behind the other, then errors), a pose of angles in degrees, the bottom below, and the ping of a vehicle there, whose
# sonar a head turns.
STEPS = {
    "asdic_ping *asdic_python_lay(double *memory, size_t beams, size_t bins)": """{
    asdic_ping *ping = (asdic_ping *)memory;
    *ping = (asdic_ping){.beams = beams, .bins = bins};
    memory += (sizeof *ping + sizeof *memory - 1) / sizeof *memory;
    for (size_t c = 0; c < ASDIC_COMPONENT_COUNT; c++) {
        ping->intensity_lin[c] = memory + c * beams * bins;
    }
    ping->stderr_db = (float *)(memory + ASDIC_COMPONENT_COUNT * beams * bins);
    return ping;
}""",
    "asdic_pose asdic_python_place(const asdic_sweep *sweep, uint64_t index, double x, double y, double z, double roll, "
    "double pitch, double yaw)": """{
    const double degree = 3.14159265358979323846 / 180.0;
    asdic_pose pose = {{x, y, z}, roll * degree, pitch * degree, yaw * degree};
    return sweep->directions ? asdic_sweep_sonar(sweep, &pose, index) : pose;
}""",
    "double asdic_python_bottom(const asdic_scene *scene, double x, double y)": """{
    return asdic_mission_bottom_m(scene, (asdic_vec3){x, y, 0.0});
}""",
}

INTEGER = re.compile(r"\(?-?(0[xX][0-9a-fA-F]+|\d+)[uUlL]*\)?")
REAL = re.compile(r"-?\d+(\.\d*)?([eE][-+]?\d+)?")


def preprocessed(compiler, include, out, depfile):
    """asdic/asdic.h with its macros in place and listed, and where each line came from."""
    header = os.path.join(include, "asdic", "asdic.h")
    command = [*compiler, "-std=c11", "-E", "-dD", "-MD", "-MF", depfile, "-MT", out, "-I", include, header]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def ours(text, include):
    """The lines of TEXT that stand in headers below INCLUDE."""
    folder, inside = os.path.realpath(include) + os.sep, False
    for line in text.splitlines():
        marker = re.match(r'# \d+ "([^"]*)"', line)
        if marker:
            inside = os.path.realpath(marker.group(1)).startswith(folder)
        elif inside:
            yield line


def definitions(text, include):
    """The declarations for cffi."""
    lines = []
    for line in ours(text, include):
        macro = re.match(r"#define (ASDIC_\w+) (\S+)\s*$", line)
        if macro and INTEGER.fullmatch(macro.group(2)):
            lines.append(f"#define {macro.group(1)} ...")
        elif macro and REAL.fullmatch(macro.group(2)):
            lines.append(f"static const double {macro.group(1)};")
        elif not line.startswith("#"):
            lines.append(re.sub(r"__attribute__\s*\(\(.*?\)\)\s", "", line))
    lines.append(CALLBACKS + ";\n".join(STEPS) + ";\nvoid free(void *);"
                 "struct sigaction { ...; };"
                 "int sigaction(int, const struct sigaction *, struct sigaction *);")
    return "\n".join(lines)


def main():
    out, depfile, include, *compiler = sys.argv[1:]
    builder = cffi.FFI()
    builder.cdef(definitions(preprocessed(compiler, include, out, depfile), include))
    builder.set_source("asdic._native", "#include <asdic/asdic.h>\n#include <signal.h>\n#include <stdlib.h>\n" +
                       "\n".join(f"static {head} {body}" for head, body in STEPS.items()))
    builder.emit_c_code(out)


if __name__ == "__main__":
    main()
