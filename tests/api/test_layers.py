"""A file of the library includes only its own folder and those below it: lib/README.md, Layers."""
import os
import re
import sys

import tap

LIB = sys.argv.pop(1)

# What each folder may see beside itself and `base`.
BELOW = {
    "base": [],
    "ocl": [],
    "laws": [],
    "scene": ["laws", "ocl"],
    "sim": ["laws", "ocl", "scene"],
    "detect": ["sim"],
    "out": [],
    "mission/track": ["out"],
    "mission/scene_file": ["mission/track", "laws", "out", "scene", "sim"],
    "mission": ["mission/scene_file", "mission/track", "laws", "out", "scene", "sim", "detect"],
    "mission/run": ["mission", "mission/scene_file", "mission/track", "out", "scene", "sim"],
    "mission/dataset": ["mission/run", "mission", "mission/scene_file", "out", "scene", "sim"],
    "mission/detect": ["mission/run", "mission", "mission/scene_file", "mission/track", "out",
                       "detect", "laws", "scene", "sim"],
}
BELOW["live"] = [folder for folder in BELOW if folder != "base"]
BELOW["trial"] = BELOW["live"] + ["live"]
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def sources():
    for folder, _, names in os.walk(LIB):
        inside = os.path.relpath(folder, LIB)
        if inside.split(os.sep)[0] in ("include", "python"):
            continue
        for name in names:
            if name.endswith((".c", ".cc", ".h")):
                yield inside, name


def folder_of(inside, name):
    """Where an include leads, as the compiler finds it: beside the file, else from lib/."""
    for start in (os.path.join(LIB, inside), LIB):
        path = os.path.normpath(os.path.join(start, name))
        if os.path.isfile(path):
            return os.path.relpath(os.path.dirname(path), LIB)
    return None


def test_no_include_leads_up():
    files = 0
    wrong = []
    for inside, name in sources():
        files += 1
        allowed = [inside, "base", "../kernels", *BELOW.get(inside, [])]
        with open(os.path.join(LIB, inside, name), encoding="utf-8") as file:
            for included in INCLUDE.findall(file.read()):
                folder = folder_of(inside, included)
                if folder is not None and folder not in allowed:
                    wrong.append(f"{inside}/{name} includes {included}")
    tap.equal(files > 100, True, "sources are found")
    tap.equal(wrong, [], "includes that lead up")


def test_every_folder_has_a_layer():
    folders = {inside for inside, _ in sources()}
    tap.equal(sorted(folders), sorted(BELOW), "folders")


def test_file_names_are_unique():
    names = sorted(name for _, name in sources())
    twice = sorted({name for name in names if names.count(name) > 1})
    tap.equal(twice, [], "names of files in two folders")


tap.main(globals())
