"""Which default test runs which line of lib, kernels and cli, as gcov tells; kept from one call to the next.

A line is a number of a source as it was when it was measured. Kernels run on the device, where gcov does not
look; there a test counts that runs the line of lib which asks for a program with that file.
"""
import hashlib
import json
import os
import re
import subprocess


def digest(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def spans(lines):
    """Sorted numbers as [first, last] pairs."""
    found = []
    for line in sorted(lines):
        if found and found[-1][1] + 1 == line:
            found[-1][1] = line
        else:
            found.append([line, line])
    return found


class Coverage:
    def __init__(self, tree, build, kept):
        """Of the sources in TREE, built in BUILD with --coverage; KEPT is the file that remembers."""
        self.tree, self.build, self.kept = tree, build, kept
        empty = {"sources": {}, "code": {}, "tests": {}}
        self.known = json.loads(kept.read_text()) if kept.exists() else empty
        self.forget_changed()
        self.ran = {name: {path: {n for first, last in some for n in range(first, last + 1)}
                           for path, some in of["lines"].items()}
                    for name, of in self.known["tests"].items()}  # fmt: skip

    def forget_changed(self):
        """Lines of sources that are other ones now: every test counts for these."""
        for path, was in list(self.known["sources"].items()):
            file = self.tree / path
            if not file.exists() or digest(file.read_text()) != was:
                del self.known["sources"][path]

    # ---- Measuring ----

    def clear(self):
        for path in self.build.rglob("*.gcda"):
            path.unlink()

    def measured(self, name, text):
        """Whether the test NAME, whose source is TEXT, has been measured."""
        return self.known["tests"].get(name, {}).get("digest") == digest(text)

    def failed(self, name, text):
        """Whether it failed on the unchanged tree."""
        return self.known.get("failed", {}).get(name) == digest(text)

    def keep_failed(self, name, text):
        self.known.setdefault("failed", {})[name] = digest(text)
        self.kept.write_text(json.dumps(self.known))

    def keep(self, name, text, seconds):
        """What the test that has just run has left, and its processor time."""
        ran = self._collect()
        self.ran[name] = ran
        self.known["tests"][name] = {
            "digest": digest(text), "seconds": seconds,
            "lines": {path: spans(lines) for path, lines in ran.items()},
        }  # fmt: skip
        self.kept.write_text(json.dumps(self.known))

    def seconds(self, name):
        return self.known["tests"][name]["seconds"]

    def _collect(self):
        ran = {}
        data = sorted(self.build.rglob("*.gcda"))
        for at in range(0, len(data), 200):
            some = [str(path) for path in data[at : at + 200]]
            out = subprocess.run(["gcov", "--json-format", "--stdout", *some], cwd=self.build,
                                 stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False).stdout  # fmt: skip
            for line in out.splitlines():
                for file in json.loads(line)["files"]:
                    self._add(file, ran)
        return ran

    def _add(self, file, ran):
        path = os.path.relpath(self.build / file["file"], self.tree)
        if not path.startswith(("lib/", "kernels/", "cli/")) or not (self.tree / path).exists():
            return
        if path not in self.known["sources"]:
            self.known["sources"][path] = digest((self.tree / path).read_text())
        code = set(self.known["code"].get(path, []))
        for line in file["lines"]:
            code.add(line["line_number"])
            if line["count"]:
                ran.setdefault(path, set()).add(line["line_number"])
        self.known["code"][path] = sorted(code)

    # ---- Asking ----

    def _statement(self, path, line):
        """The line of code that LINE belongs to: itself, or the one that its statement begins in. None where
        it is none, as in a table."""
        code = set(self.known["code"].get(path, []))
        texts = (self.tree / path).read_text().splitlines()
        while line > 0 and line not in code:
            above = texts[line - 2].split("//")[0].rstrip() if line > 1 else ""
            if not above or above.endswith((";", "{", "}")) and not above.endswith("= {"):
                return None
            line -= 1
        return line or None

    def runs(self, path, line):
        """Names of the tests that run it; None where that is not known."""
        if path.startswith("kernels/"):
            return self._runs_kernel(path, line)
        return self._runs_host(path, line)

    def _runs_host(self, path, line):
        if path not in self.known["sources"]:
            return None
        line = self._statement(path, line)
        if line is None:
            return None
        return self._counted(path, line) | self._counted(path, self._before(path, line))

    def _counted(self, path, line):
        return {name for name, ran in self.ran.items() if line in ran.get(path, ())}

    def _before(self, path, line):
        """The last line before LINE that a test runs, of the same function; else LINE. What the compiler moves
        or merges, as an `int i = 0`, has no count of its own, or that of another program alone."""
        texts = (self.tree / path).read_text().splitlines()
        ran = set().union(*(of.get(path, set()) for of in self.ran.values()))
        for before in range(line - 1, 0, -1):
            if before in ran:
                return before
            if texts[before - 1] == "}":
                break
        return line

    def _runs_kernel(self, path, line):
        """Also those on the host that include it."""
        found = self._runs_host(path, line) or set()
        for entry in (self.tree / "kernels").glob("*.cl"):
            if os.path.basename(path) not in self._included(entry):
                continue
            for file in (self.tree / "lib").rglob("*.c"):
                for number, text in enumerate(file.read_text().splitlines(), 1):
                    if f'"{entry.name}"' in text:
                        tests = self._runs_host(str(file.relative_to(self.tree)), number)
                        found |= self.building() if tests is None else tests
        return found

    def _included(self, entry):
        found, ahead = set(), [entry.name]
        while ahead:
            name = ahead.pop()
            if name not in found:
                found.add(name)
                ahead += re.findall(r'^#include "([^"]+)"', (self.tree / "kernels" / name).read_text(), re.M)
        return found

    def building(self):
        """Tests that build any program for a device."""
        path = "lib/ocl/program.c"
        for number, text in enumerate((self.tree / path).read_text().splitlines(), 1):
            if "clBuildProgram(" in text:
                return self._runs_host(path, number) or set(self.ran)
        return set(self.ran)

    def unrun(self):
        """{path: [[first, last], ...]}: lines of code that no test runs."""
        found = {}
        for path, code in self.known["code"].items():
            ran = set().union(*(of.get(path, set()) for of in self.ran.values()))
            missing = spans(set(code) - ran)
            if missing and path in self.known["sources"]:
                found[path] = missing
        return found
