"""What a program was compiled against stays: every declaration of the public headers that
interface.txt holds is there, to the letter.

    test_interface.py INCLUDE RECORD            new declarations are allowed, others are not
    test_interface.py INCLUDE RECORD --write    records the headers as they are

A declaration that went or changed (a function, the fields of a struct, the values of an enum) breaks
programs that were compiled before: mend the header, or raise soversion in lib/meson.build and record
the interface anew. Before version 1 recording it is enough: the commit shows what changed.
"""
import glob
import os
import re
import shutil
import subprocess
import sys

import tap

INCLUDE, RECORD = sys.argv.pop(1), sys.argv.pop(1)


def declarations():
    """Of the headers: functions, types, enums, constants; without comments, each on a line."""
    compiler = os.environ.get("CC", "cc").split()
    if not shutil.which(compiler[0]):
        raise tap.Skip(f"there is no {compiler[0]}")
    found = set()
    for path in sorted(glob.glob(os.path.join(INCLUDE, "asdic", "*.h"))):
        done = subprocess.run([*compiler, "-std=c11", "-E", "-I", INCLUDE, path], check=True,
                              capture_output=True, text=True)
        lines, ours = [], False
        for line in done.stdout.splitlines():
            marker = re.match(r'# \d+ "([^"]*)"', line)
            if marker:
                ours = marker.group(1) == path
            elif ours:
                lines.append(line)
        text = re.sub(r"__attribute__\(\(visibility\(\"default\"\)\)\)", "", " ".join(lines))
        text = re.sub(r"\s+", " ", text)
        depth, start = 0, 0
        for place, letter in enumerate(text):
            depth += (letter == "{") - (letter == "}")
            if letter == ";" and depth == 0:
                found.add(text[start:place].strip())
                start = place + 1
        with open(path, encoding="utf-8") as file:
            found.update(re.sub(r"\s+", " ", re.sub(r"/\*.*", "", line)).strip()
                         for line in file if re.match(r"#define ASDIC_\w+ \S", line)
                         and "VERSION" not in line and "ASDIC_API" not in line)
    return found


def test_what_was_recorded_is_still_there():
    with open(RECORD, encoding="utf-8") as file:
        recorded = set(file.read().splitlines())
    tap.equal(len(recorded) > 200, True, "declarations are recorded")
    now = declarations()
    for line in sorted(now - recorded):
        print(f"# new: {line}")
    tap.equal(sorted(recorded - now), [], "declarations that went or changed")


if sys.argv[1:] == ["--write"]:
    with open(RECORD, "w", encoding="utf-8") as file:
        file.write("".join(line + "\n" for line in sorted(declarations())))
else:
    tap.main(globals())
