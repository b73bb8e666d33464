#!/usr/bin/env python3
"""Turn kernel sources into one C file that holds their text.

Every entry (*.cl) is flattened: each `#include "x.h"` is replaced by the file, once, and #line
directives keep the names, so that a compiler on a user's board says kernels/trace.cl:42.
Includes of the form <x.h> are left alone (they are for the host).
"""
import argparse
import os
import re
import sys

INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"')
OPEN = re.compile(r"^\s*#\s*if")
CLOSE = re.compile(r"^\s*#\s*endif")


class EmbedError(Exception):
    pass


class Flattener:
    """One entry and what it includes."""

    def __init__(self, root):
        self.root = os.path.abspath(root)
        self.lines = []
        self.seen = set()
        self.files = []  # in order of inclusion, for the depfile

    def shown(self, path):
        return "kernels/" + os.path.relpath(path, self.root).replace(os.sep, "/")

    def find(self, name, includer, number):
        for folder in (os.path.dirname(includer), self.root):
            path = os.path.normpath(os.path.join(folder, name))
            if os.path.isfile(path):
                return path
        raise EmbedError(f'{self.shown(includer)}:{number}: error: cannot find "{name}"')

    def add(self, path):
        self.seen.add(path)
        self.files.append(path)
        self.lines.append(f'#line 1 "{self.shown(path)}"')
        guard = 1 if path.endswith(".h") else 0
        depth = 0
        with open(path, encoding="utf-8") as file:
            for number, line in enumerate(file.read().splitlines(), 1):
                depth += bool(OPEN.match(line)) - bool(CLOSE.match(line))
                match = INCLUDE.match(line)
                if not match:
                    self.lines.append(line)
                    continue
                # A file is placed once, where it is met first: under a condition it could vanish.
                if depth > guard:
                    raise EmbedError(f"{self.shown(path)}:{number}: error: #include under #if")
                found = self.find(match.group(1), path, number)
                if found not in self.seen:
                    self.add(found)
                self.lines.append(f'#line {number + 1} "{self.shown(path)}"')


def c_string(line):
    out = []
    for byte in line.encode("utf-8"):
        char = chr(byte)
        if char in '"\\?':  # ? because of trigraphs
            out.append("\\" + char)
        elif 32 <= byte < 127:
            out.append(char)
        else:
            out.append(f"\\{byte:03o}")
    return '"' + "".join(out) + '\\n"'


def c_file(entries):
    """ENTRIES: (name, lines) pairs."""
    out = ["/* Made by kernels/embed.py. */", '#include "ocl/kernel_text.h"', ""]
    out.append('#pragma GCC diagnostic ignored "-Woverlength-strings"')
    out.append("const asdic_kernel_text asdic_kernel_texts[] = {")
    for name, lines in entries:
        out.append(f'{{"{name}",')
        out += [c_string(line) for line in lines]
        out.append("},")
    out += ["{0, 0},", "};", ""]
    return "\n".join(out)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--root", required=True, help="the kernels folder")
    parser.add_argument("--output", required=True, help="C file to write")
    parser.add_argument("--depfile", help="make-style dependencies to write")
    parser.add_argument("entries", nargs="*", help="*.cl files")
    args = parser.parse_args()

    entries, files = [], []
    try:
        for entry in map(os.path.abspath, args.entries):
            flat = Flattener(args.root)
            flat.add(entry)
            entries.append((os.path.relpath(entry, flat.root).replace(os.sep, "/"), flat.lines))
            files += flat.files
    except EmbedError as error:
        sys.exit(str(error))
    with open(args.output, "w", encoding="utf-8") as out:
        out.write(c_file(entries))
    if args.depfile:
        with open(args.depfile, "w", encoding="utf-8") as out:
            names = sorted({name.replace(" ", "\\ ") for name in files})
            out.write(args.output + ": " + " ".join(names) + "\n")


if __name__ == "__main__":
    main()
