"""Every public function with NULL, zeros, NaN and huge numbers: a status, never a crash.

A C program is made from the headers: it calls each function in a child process of its own, with
arguments of four kinds, and once for each of its pointers, which alone is NULL. A function that returns a
status refuses what it cannot work on; the place for what it would have made then holds NULL, whatever it
held before. One that returns something else returns nothing of nothing: zeros, NULL.
"""
import functools
import os
import pathlib
import re
import subprocess
import tempfile

import tap

ROOT = pathlib.Path(__file__).resolve().parents[2]
INCLUDE = ROOT / "lib" / "include"
LIBRARY = pathlib.Path(os.environ["ASDIC_LIBRARY"])

# What may be given nothing and still be right.
FINE = {"asdic_context_create": {"huge"}, "asdic_device_list": {"huge"},
        "asdic_scene_create": {"huge"}}

ARGUMENT = 1  # ASDIC_ERROR_ARGUMENT
# What may alone be NULL. The handles that are given with it are none, and it goes on to the first of these.
OPTIONAL = {("asdic_devices_open", 1), ("asdic_run_detect", 3), ("asdic_scan_ping", 3), ("asdic_scan_ping", 4)}
# What a handle is asked for before the others are looked at.
BEHIND = {("asdic_simulator_profile", 1), ("asdic_simulator_profile", 3)}

PROGRAM = r"""
#define _GNU_SOURCE
#include <asdic/asdic.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
static char room[8][1 << 16];
static void *place; /* for what is made */
static asdic_context *ctx;
static int is_something(const void *got, size_t size) {
    static const char zeros[1 << 16];
    return memcmp(got, zeros, size) != 0;
}
%s
typedef struct entry { const char *name; int (*call)(int kind); } entry;
static const entry entries[] = {
%s
}, makers[] = {
%s
}, alone[] = {
%s
};
int main(void) {
    static const char *const kinds[] = {"nothing", "context", "nan", "huge"};
    asdic_context_create(&ctx);
    for (size_t i = 0; i < sizeof entries / sizeof *entries; i++) {
        for (int kind = 0; kind < 4; kind++) {
            int state;
            fflush(stdout);
            pid_t child = fork();
            if (child == 0) {
                alarm(20);
                _exit(entries[i].call(kind));
            }
            waitpid(child, &state, 0);
            printf("%%s %%s %%s %%d\n", entries[i].name, kinds[kind],
                   WIFSIGNALED(state) ? "signal" : "status",
                   WIFSIGNALED(state) ? WTERMSIG(state) : WEXITSTATUS(state));
        }
    }
    for (size_t i = 0; i < sizeof alone / sizeof *alone; i++) {
        int state;
        fflush(stdout);
        pid_t child = fork();
        if (child == 0) {
            alarm(20);
            _exit(alone[i].call(0));
        }
        waitpid(child, &state, 0);
        printf("%%s alone %%d %%d\n", alone[i].name, WIFSIGNALED(state) ? WTERMSIG(state) : 0,
               WIFSIGNALED(state) ? 0 : WEXITSTATUS(state));
    }
    for (size_t i = 0; i < sizeof makers / sizeof *makers; i++) {
        place = room;
        int status = makers[i].call(0);
        printf("%%s makes %%d %%s\n", makers[i].name, status, place ? "something" : "NULL");
    }
}
"""


# Of the functions without a status, those that ask one of these; the others are arithmetic on
# what the caller fills in, many times a ping.
ASKS = re.compile(r"asdic_((mission|scene|mesh|run|environment|sonar|context|colormap|dataset|device|law|simulator"
                  r"|trial)_|(scan|tracker)_get$|view_(is_over|is_paused|get_\w+|title|press)$|\w+_destroy$)")

TOLD = re.compile(r"asdic_(mission|scene|mesh|run|colormap|dataset|device|law|simulator|trial)_|asdic_(scan|tracker|view)_(get|is|title|press)")
# What has no zeros to tell of nothing: its header says INFINITY or NAN.
NO_ZEROS = {"asdic_mission_bottom_m", "asdic_mission_uncertainty", "asdic_run_get_errors",
            "asdic_scene_altitude_m",
            # a loop ends
            "asdic_view_is_over"}


def prototypes():
    """(result, name, [parameter type, ...]) of every public function that promises it."""
    found = []
    for header in sorted((INCLUDE / "asdic").glob("*.h")):
        text = re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.S)
        text = re.sub(r"^#.*$", "", text, flags=re.M)
        for match in re.finditer(r"ASDIC_API\s([^;]*);", text):
            words = " ".join(match.group(1).split())
            result, name, parameters = re.match(r"(.*?)(\w+)\((.*)\)$", words).groups()
            if result.strip() != "asdic_status" and not ASKS.match(name):
                continue
            types = []
            for parameter in parameters.split(", "):
                array = parameter.endswith("]")
                kind = re.sub(r"\w+(\[\w*\])?$", "", parameter).strip()
                if kind and parameter != "void":
                    types.append(kind + (" *" if array else ""))
            found.append((result.strip(), name, types))
    return found


def argument(number, kind):
    """C expressions for the four kinds of one parameter."""
    if kind == "asdic_context *":
        return ["NULL", "ctx", "ctx", "ctx"]
    if "(" in kind or kind == "asdic_log_fn":
        return ["NULL"] * 4
    if kind == "double":
        return ["0.0", "0.0", "NAN", "1e308"]
    if kind in ("float", "size_t", "uint32_t", "uint64_t", "unsigned", "bool", "int"):
        return ["0", "0", "0", f"({kind})-1"]
    if kind == "const char *":
        return ["NULL", "NULL", '"/nonexistent/x.yaml"', '"/nonexistent/x.yaml"']
    if kind.endswith("*") and not kind.startswith("const "):
        opaque = kind in OPAQUE
        return ["NULL", "NULL", "NULL", "NULL" if opaque else f"(void *)room[{number % 8}]"]
    if kind.endswith("*"):
        return ["NULL"] * 4
    if kind.startswith("asdic_") and kind in VALUES:
        return [f"zero_{kind}", f"zero_{kind}", f"nan_{kind}", f"nan_{kind}"]
    return ["0", "0", "0", f"({kind})99"]  # an enumeration


OPAQUE = {f"{name} *" for header in (INCLUDE / "asdic").glob("*.h")
          for name in re.findall(r"typedef struct (asdic_\w+) \1;", header.read_text())}
OPAQUE.add("asdic_team *")  # functions of the caller's
CALLBACKS = {name for header in (INCLUDE / "asdic").glob("*.h")
             for name in re.findall(r"typedef [^;{]*\(\*(asdic_\w+)\)", header.read_text())}
VALUES = {"asdic_vec3", "asdic_pose", "asdic_material"}


def source():
    calls, entries = [], []
    for kind in sorted(VALUES):
        calls.append(f"static {kind} zero_{kind}, nan_{kind};")
    for result, name, types in prototypes():
        columns = [argument(i, kind) for i, kind in enumerate(types)]
        lines = []
        for k in range(4):
            call = f"{name}({', '.join(column[k] for column in columns)})"
            lines.append(f"    case {k}: " + (f"return (int){call};" if result == "asdic_status"
                                              else f"(void){call}; return 0;" if result == "void"
                                              else f"{{ {result} got = {call}; return is_something(&got, "
                                                   "sizeof got); }"))
        calls.append(f"static int call_{name}(int kind) {{\n    memset(&nan_asdic_pose, 0xff, "
                     "sizeof nan_asdic_pose);\n    memset(&nan_asdic_vec3, 0xff, sizeof "
                     "nan_asdic_vec3);\n    switch (kind) {\n" + "\n".join(lines)
                     + "\n    }\n    return 0;\n}")
        entries.append(f'    {{"{name}", call_{name}}},')
    makers = []
    for name, types in makers_of_objects():
        given = ["(void *)&place" if kind.endswith("**") else argument(i, kind)[1] for i, kind in enumerate(types)]
        calls.append(f"static int make_{name}(int kind) {{\n    (void)kind;\n"
                     f"    return (int){name}({', '.join(given)});\n}}")
        makers.append(f'    {{"{name}", make_{name}}},')
    alone = []
    for name, types, without in lone_nulls():
        given = ["NULL" if i == without else some(i, kind) for i, kind in enumerate(types)]
        calls.append(f"static int alone_{name}_{without}(int kind) {{\n    (void)kind;\n"
                     f"    return (int){name}({', '.join(given)});\n}}")
        alone.append(f'    {{"{name} {without}", alone_{name}_{without}}},')
    return PROGRAM % ("\n".join(calls), "\n".join(entries), "\n".join(makers), "\n".join(alone))


def some(number, kind):
    """A C expression for a parameter that is there, though what it points to is all zeros."""
    if kind == "const char *":
        return '"/nonexistent/x.yaml"'
    if kind in CALLBACKS:
        return f"({kind})abort"
    if kind.endswith("*"):
        return "ctx" if "asdic_context" in kind else f"(void *)room[{number % 8}]"
    if kind in ("double", "float", "size_t", "uint32_t", "uint64_t", "unsigned", "bool", "int"):
        return "1"
    return argument(number, kind)[0]


def lone_nulls():
    """(name, parameter types, the one that is NULL) of the functions that need two pointers or more."""
    found = []
    for result, name, types in prototypes():
        needed = [i for i, kind in enumerate(types) if kind in CALLBACKS or
                  kind.endswith("*") and "asdic_context" not in kind and kind != "void *"]
        if result == "asdic_status" and len(needed) > 1:
            found += [(name, types, i) for i in needed if (name, i) not in OPTIONAL | BEHIND]
    return found


def makers_of_objects():
    """(name, parameter types) of the functions that put an object into a place and cannot of nothing."""
    return [(name, types) for result, name, types in prototypes() if result == "asdic_status"
            and any(re.fullmatch(r"(asdic_\w+|char) \*\*\*?", kind) for kind in types)
            and name not in FINE and not any(kind == "asdic_device **" for kind in types)]


@functools.lru_cache(maxsize=None)
def results():
    with tempfile.TemporaryDirectory() as folder:
        program, code = pathlib.Path(folder, "misuse"), pathlib.Path(folder, "misuse.c")
        code.write_text(source())
        subprocess.run(["cc", "-w", f"-I{INCLUDE}", code, "-o", program, LIBRARY,
                        f"-Wl,-rpath,{LIBRARY.parent}", "-lm"], check=True)
        done = subprocess.run([program], check=True, capture_output=True, text=True, timeout=110)
    return [line.split() for line in done.stdout.splitlines()]


def test_nothing_crashes():
    rows = [row for row in results() if row[1] != "makes" and row[2] != "alone"]
    tap.equal(len(rows), 4 * len(prototypes()), "number of calls")
    crashed = [f"{name}({kind}): signal {code}" for name, kind, how, code in rows
               if how == "signal"]
    tap.equal(crashed, [], "crashes")
    has_status = {name for result, name, _ in prototypes() if result == "asdic_status"}
    taken = [f"{name}({kind})" for name, kind, _, code in rows
             if name in has_status and code == "0" and kind not in FINE.get(name, {})]
    tap.equal(taken, [], "accepted though there was nothing to work on")


def test_each_pointer_is_asked_for():
    """One that alone is NULL is an argument that is wrong: where others are there, too."""
    rows = [row for row in results() if row[2] == "alone"]
    tap.equal((len(rows), len(rows) > 200), (len(lone_nulls()), True), "number of calls")
    wrong = [f"{name}({number}): signal {signal}, status {status}" for name, number, _, signal, status in rows
             if (signal, status) != ("0", str(ARGUMENT))]
    tap.equal(wrong, [], "pointers that are not asked for")


def test_nothing_has_nothing():
    """As context.h says; a number of what is not there would be taken for an answer."""
    of = {name for result, name, types in prototypes() if result not in ("asdic_status", "void")
          and TOLD.match(name) and any(kind.endswith("*") for kind in types)} - NO_ZEROS  # fmt: skip
    asked = [(name, code) for name, kind, _, code, *_ in results() if name in of and kind == "nothing"]
    tap.equal(len(asked) >= 30, True, f"{len(asked)} functions that tell something")
    tap.equal([name for name, code in asked if code != "0"], [], "had something of nothing")


def test_what_fails_makes_nothing():
    rows = [row for row in results() if row[1] == "makes"]
    tap.equal(len(rows) >= 20, True, f"{len(rows)} functions that make something")
    tap.equal([name for name, _, status, place in rows if status == "0" or place != "NULL"], [],
              "made something of nothing")


tap.main(globals())
