"""Puts slips into lib, kernels and cli, one at a time, and tells which of them the tests notice.

    ./dev mutate [--count N] [--seed S] [--under FOLDER] [--quick SECONDS] [--most SECONDS] [--harmless FILE]
    ./dev mutate --list [--count N] [--seed S] [--under FOLDER] [--harmless FILE]
    ./dev mutate --unrun

A copy of the tree is built in build/mutate, once, and once more to measure which default test runs which
line (about three times what the tests take; with --quick of the quick ones only). Each slip is compiled there;
one that does not compile, or leaves all object files as they were, does not count. Then the default tests that
run its line follow, up to the first failure: those first that have noticed a slip of the file, then those that
name what the file defines, the quick before the slow. What no quick test notices waits for others, which then
run through the slow tests together; when those fail, half of them at a time. With --most a slip gets no more
tests, in that order, than take so long together. --list shows the slips that would be drawn first, and tries
none; --unrun lists the lines that no default test runs.

Slips known to change nothing that matters stand in harmless.txt, each with its reason; they are not tried.
The report tells by folder how many of the others were noticed. Exit code 1: fewer than 95 of 100 were.
"""
import argparse
import fnmatch
import hashlib
import json
import os
import pathlib
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import time

import slips
from coverage import Coverage

ROOT = pathlib.Path(__file__).resolve().parents[2]
WORK = ROOT / "build" / "mutate"
TREE, BUILD, COVERED = WORK / "tree", WORK / "build", WORK / "coverage"
LUCKY = WORK / "noticed.json"  # {path: {test: how many slips of it this test noticed first}}
FOLDERS = ("lib", "kernels", "cli")
SLOWEST_S = 600.0  # a processor's, of any default test
SLOWER = 4.0  # than without measuring its coverage a test takes, at most
QUICK_S = 5.0  # a processor's, of one test; those that take longer run for several slips together
TOGETHER = 8
LEAST_S = {True: 240.0, False: 10.0}  # a processor's, to every test; whether a driver compiles changed kernels
LINKER = {"CC_LD": "lld", "CXX_LD": "lld"} if shutil.which("ld.lld") else {}  # tests are linked often
LIBRARY = ("lib/libasdic.a", "cli/asdic")  # what every slip is compiled into
WANTED = 0.95
NOT_OK = re.compile(r"^not ok \d", re.MULTILINE)


def run(command, **more):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **more)


# ---- The copy ----


def copy_tree():
    """The tracked files as they are now; those that did not change keep their times."""
    listed = run(["git", "-C", ROOT, "ls-files", "-z"]).stdout.split("\0")
    listed = [name for name in listed if name and (ROOT / name).is_file()]
    for name in listed:
        source, target = ROOT / name, TREE / name
        if not target.exists() or target.read_bytes() != source.read_bytes():
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(source, target)
    for path in [p for p in TREE.rglob("*") if p.is_file()]:
        if str(path.relative_to(TREE)) not in set(listed):
            path.unlink()


def configure(build, *options):
    """Makes BUILD of the copy, empty yet."""
    if not (build / "build.ninja").exists():
        done = run(["meson", "setup", build, TREE, *options], env={**os.environ, **LINKER})
        if done.returncode:
            sys.exit(done.stdout)


def compile_clean(build):
    print(f"mutate: compiling the unchanged tree in {build.name}", flush=True)
    done = run(["ninja", "-C", build])
    if done.returncode:
        sys.exit("mutate: the unchanged tree does not compile: " + done.stdout[-2000:])


def compiled(targets=()):
    """Whether ninja can make TARGETS, else everything."""
    return run(["ninja", "-C", BUILD, *targets]).returncode == 0


def objects():
    """What every slip of lib and cli is compiled into."""
    return [path for made in ("lib/libasdic*.p", "cli/asdic.p") for path in BUILD.glob(f"{made}/*.o")]


def code_of(path):
    """A digest of an object file's machine code."""
    bare = WORK / "bare.o"
    run(["objcopy", "--strip-debug", path, bare])
    return hashlib.sha256(bare.read_bytes()).hexdigest()


# ---- Tests ----


class Test:
    def __init__(self, entry, built, build):
        self.build = build
        self.name, self.command = entry["name"], entry["cmd"]
        self.environment = dict(os.environ, **entry["env"])
        self.folder = entry["workdir"] or build
        used = {built[of] for of in entry["depends"]} | set(self.command) & set(built.values())
        self.targets = sorted(os.path.relpath(path, build) for path in used)
        sources = [a for a in self.command if a.endswith(".py")] or [self.command[0]]
        self.text = self._source(pathlib.Path(sources[-1]))
        self.seconds, self.output = None, ""

    def _source(self, path):
        if path.suffix != ".py":
            path = TREE / path.relative_to(self.build).with_suffix(".c")
        return path.read_text() if path.exists() else ""

    def passes(self, processor_s):
        """Also False when it takes longer, or twelve times as long by the clock. Afterwards output is what it said."""
        most = int(processor_s) + 1

        def limit():
            resource.setrlimit(resource.RLIMIT_CPU, (most, most))

        process = subprocess.Popen(self.command, env=self.environment, cwd=self.folder, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   stdin=subprocess.DEVNULL, start_new_session=True, errors="replace",
                                   preexec_fn=limit)  # fmt: skip
        try:
            self.output, _ = process.communicate(timeout=12.0 * most)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            self.output, _ = process.communicate()
            return False
        return process.returncode in (0, 77) and not NOT_OK.search(self.output)

    def measure(self, coverage, most_s):
        """Its time and lines; whether it passes, at the second attempt at the latest. Nothing, where it takes
        longer than MOST_S."""
        for _ in range(2):
            coverage.clear()
            before = os.times()
            good = self.passes(most_s)
            after = os.times()
            self.seconds = (after.children_user - before.children_user
                            + after.children_system - before.children_system)  # fmt: skip
            if good:
                coverage.keep(self.name, self.text, self.seconds)
                return
            if most_s < SLOWEST_S and self.seconds >= most_s:
                return
        coverage.keep_failed(self.name, self.text)
        print(f"mutate: '{self.name}' fails on the unchanged tree and is left out:\n{self.output[-1000:]}",
              flush=True)  # fmt: skip


def introspect(what, build):
    return json.loads(subprocess.run(["meson", "introspect", what, build], check=True,
                                     stdout=subprocess.PIPE).stdout)  # fmt: skip


def default_tests(build):
    built = {target["id"]: target["filename"][0] for target in introspect("--targets", build)}
    return [Test(entry, built, build) for entry in introspect("--tests", build)
            if not any(suite.endswith(":full") for suite in entry["suite"])]  # fmt: skip


def measure(most_s=SLOWEST_S):
    """The coverage of every default test that takes at most MOST_S; of those that were measured before, when
    they are the same."""
    configure(COVERED, "-Dbuildtype=plain", "-Doptimization=1", "-Db_coverage=true")
    coverage = Coverage(TREE, COVERED, WORK / "coverage.json")
    fresh = [test for test in default_tests(COVERED) if not coverage.measured(test.name, test.text)
             and not coverage.failed(test.name, test.text)]  # fmt: skip
    if fresh:
        compile_clean(COVERED)
        print(f"mutate: measuring {len(fresh)} tests on the unchanged tree", flush=True)
    for test in sorted(fresh, key=lambda test: test.command[-1].endswith(".py")):  # one at a time
        test.measure(coverage, most_s)
    return coverage


def first_failure(tests, since, least_s):
    """The name of the first that fails, or cannot be linked, of those that what was written SINCE goes into."""
    for test in tests:
        if test.targets:
            good = compiled(test.targets)
            if good and max((BUILD / path).stat().st_mtime for path in test.targets) < since:
                continue
            if not good or not test.passes(least_s + 10.0 * test.seconds):
                return test.name
    return None


def in_order(tests, path, source, lucky):
    """Those first that LUCKY says to have noticed slips of the file, then those that name most of what it
    defines, the others by their time."""
    defined = set(re.findall(r"^\w[\w \*]*?\b(\w+)\(", source, re.MULTILINE))
    words = set(pathlib.Path(path).stem.split("_")) - {"cmd"}

    def rank(test):
        names = len(defined & set(re.findall(r"\w+", test.text))) + 3 * len(words & set(test.name.split("_")))
        return -lucky.get(test.name, 0), -min(names, 8), test.seconds

    return sorted(tests, key=rank)


def within(tests, most_s):
    """Of tests in their order those that take MOST_S together; one too long for what is left is left out."""
    found, left_s = [], most_s
    for test in tests:
        if test.seconds <= left_s:
            found.append(test)
            left_s -= test.seconds
    return found


# ---- Slips ----


def read_harmless(path):
    """Slips known to change nothing: patterns of path, line, old, new and nth; and why, by tabs."""
    known = []
    for number, line in enumerate(path.read_text().splitlines(), 1):
        if line and not line.startswith("#"):
            fields = line.split("\t")
            if len(fields) != 6 or not fields[5].strip():
                sys.exit(f"{path}:{number}: has {len(fields)} fields, and needs six: "
                         "path, line, old, new, nth, reason")  # fmt: skip
            known.append(fields[:5])
    return known


def is_harmless(slip, known):
    return any(all(fnmatch.fnmatchcase(value, pattern) for value, pattern in zip(slip.key(), one)) for one in known)


def wilson(noticed, tried):
    """The 95 % interval of a share, after Wilson, J. Am. Stat. Assoc. 22 (1927) 209: that of slips not drawn."""
    z2 = 1.959964**2
    middle = noticed + z2 / 2.0
    spread = (z2 * (noticed * (tried - noticed) / tried + z2 / 4.0)) ** 0.5 if tried else 0.0
    return ((middle - spread) / (tried + z2), (middle + spread) / (tried + z2)) if tried else (0.0, 1.0)


def folder_of(path):
    parts = path.split("/")
    return "/".join(parts[:2]) if parts[0] == "lib" else parts[0]


def draw(count, seed, under):
    """For each folder how many slips to try, COUNT in all, by its size and three at least; and its slips in
    the order to try them, one a line: some do not compile."""
    by_folder = {}
    for top in FOLDERS:
        for path in sorted((TREE / top).rglob("*")):
            name = str(path.relative_to(TREE))
            if path.suffix in (".c", ".cl", ".h") and "/include/" not in name and name.startswith(under):
                lines = {}
                for slip in slips.find(name, path.read_text()):
                    lines.setdefault(slip.line, []).append(slip)
                by_folder.setdefault(folder_of(name), []).extend(lines.values())
    total = sum(len(lines) for lines in by_folder.values())
    drawn = []
    for folder, lines in sorted(by_folder.items()):
        dice = random.Random(f"{seed} {folder}")
        share = max(round(count * len(lines) / total), 3 if count >= 3 * len(by_folder) else 1)
        dice.shuffle(lines)
        drawn.append((share, [dice.choice(line) for line in lines]))
    return drawn


class Tree:
    """The copy, with slips in it."""

    def __init__(self):
        self.clean, self.since = {}, 0.0

    def put(self, some):
        """Writes SOME slips, one a file at most, and compiles; False where that fails."""
        self.restore()
        self.since = time.time() - 0.1  # clocks of files tick in steps
        for slip in some:
            path = TREE / slip.path
            self.clean[slip.path] = path.read_text()
            path.write_text(slip.apply(self.clean[slip.path]))
        return compiled(LIBRARY)

    def restore(self):
        for path, source in self.clean.items():
            (TREE / path).write_text(source)
        self.clean = {}


class Session:
    def __init__(self, arguments):
        self.harmless = read_harmless(pathlib.Path(arguments.harmless))
        self.tree = Tree()
        self.tests, self.code, self.coverage = [], {}, None
        self.lucky = json.loads(LUCKY.read_text()) if LUCKY.exists() else {}
        self.noticed, self.missed, self.spared = {}, {}, {}
        self.waiting = []
        self.quick_s, self.most_s = arguments.quick, arguments.most

    def prepare(self):
        WORK.mkdir(parents=True, exist_ok=True)
        copy_tree()
        self.coverage = measure(SLOWEST_S if self.quick_s is None else SLOWER * self.quick_s)
        configure(BUILD)
        compile_clean(BUILD)
        self.code = {path: code_of(path) for path in objects()}
        self.tests = [test for test in default_tests(BUILD) if self.coverage.measured(test.name, test.text)]
        for test in self.tests:
            test.seconds = self.coverage.seconds(test.name)
        if self.quick_s is not None:
            self.tests = [test for test in self.tests if test.seconds <= self.quick_s]
        quick = [test for test in self.tests if test.seconds <= QUICK_S]
        print(f"mutate: {len(self.tests)} tests, {len(quick)} of at most {QUICK_S:.0f} s", flush=True)

    def running(self, slip):
        """The tests that run its line, in the order to try them."""
        names = self.coverage.runs(slip.path, slip.line)
        tests = self.tests if names is None else [test for test in self.tests if test.name in names]
        ordered = in_order(tests, slip.path, (TREE / slip.path).read_text(), self.lucky.get(slip.path, {}))
        return ordered if self.most_s is None else within(ordered, self.most_s)

    def changes(self, slip):
        """Whether a slip that was put in is anything to a program: no object may be another, of a header above all."""
        return slip.path.startswith("kernels/") or any(
            code_of(path) != self.code.get(path) for path in objects() if path.stat().st_mtime >= self.tree.since)

    def record(self, slip, by):
        to = self.noticed if by else self.missed
        to.setdefault(folder_of(slip.path), []).append(slip)
        if by:
            of = self.lucky.setdefault(slip.path, {})
            of[by] = of.get(by, 0) + 1
            LUCKY.write_text(json.dumps(self.lucky))
        print(f"{'noticed by ' + by if by else 'MISSED'}: {slip.name()}", flush=True)
        if not by:
            print(f"    {slip.text}", flush=True)

    def attempt(self, slip):
        """One slip; False where it does not count."""
        if is_harmless(slip, self.harmless):
            self.spared.setdefault(folder_of(slip.path), []).append(slip)
            return True
        if not self.tree.put([slip]) or not self.changes(slip):
            return False
        running = self.running(slip)
        quick = [test for test in running if test.seconds <= QUICK_S]
        by = first_failure(quick, self.tree.since, LEAST_S[slip.path.startswith("kernels/")])
        if by or len(quick) == len(running):
            self.record(slip, by)
        else:
            if any(slip.path == other.path for other in self.waiting):
                self.finish()
            self.waiting.append(slip)
            if len(self.waiting) == TOGETHER:
                self.finish()
        return True

    def finish(self):
        """The slow tests, for all that wait."""
        if self.waiting:
            self.together(self.waiting)
        self.waiting = []

    def together(self, some):
        names = {test.name for slip in some for test in self.running(slip) if test.seconds > QUICK_S}
        slow = [test for test in self.tests if test.name in names]
        if not self.tree.put(some):
            by = "the compiler"
        else:
            by = first_failure(sorted(slow, key=lambda test: test.seconds), self.tree.since,
                               LEAST_S[any(slip.path.startswith("kernels/") for slip in some)])
        if by is None or len(some) == 1:
            for slip in some:
                self.record(slip, by)
            return
        half = len(some) // 2
        self.together(some[:half])
        self.together(some[half:])

    def report(self, seconds):
        folders = sorted(set(self.noticed) | set(self.missed) | set(self.spared))
        width = max([len(folder) for folder in folders] + [8])
        print(f"\n{'folder':{width}}  tried  noticed  missed  share  95 of 100 times  known harmless")
        total = [0, 0, 0]
        for folder in folders:
            counts = [len(of.get(folder, [])) for of in (self.noticed, self.missed, self.spared)]
            total = [a + b for a, b in zip(total, counts)]
            self.line(folder, counts, width)
        self.line("all", total, width)
        print(f"{seconds / 60:.0f} minutes")
        return total[0] >= WANTED * (total[0] + total[1])

    @staticmethod
    def line(folder, counts, width):
        tried = counts[0] + counts[1]
        low, high = wilson(counts[0], tried)
        share = f"{100 * counts[0] / tried:4.0f} %" if tried else "     -"
        among = f"{100 * low:3.0f} to {100 * high:3.0f} %"
        print(f"{folder:{width}}  {tried:5}  {counts[0]:7}  {counts[1]:6} {share}  {among:>15}  {counts[2]:14}")


def list_unrun(coverage):
    for path, some in sorted(coverage.unrun().items()):
        lines = (TREE / path).read_text().splitlines()
        for first, last in some:
            print(f"{path}:{first}: {last - first + 1} lines: {lines[first - 1].strip()}")


def list_drawn(arguments):
    """Some of them do not compile, for which others of their folder are tried in the end."""
    known = read_harmless(pathlib.Path(arguments.harmless))
    for share, found in draw(arguments.count, arguments.seed, arguments.under):
        for slip in found[:share]:
            print(f"{slip.name()}{', harmless' if is_harmless(slip, known) else ''}: {slip.text}")


def main():
    parser = argparse.ArgumentParser(prog="./dev mutate", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    parser.add_argument("--count", type=int, default=100, help="slips that count (100)")
    parser.add_argument("--seed", type=int, default=1, help="which are drawn (1)")
    parser.add_argument("--under", default="", help="only files below this folder, as lib/sim")
    parser.add_argument("--quick", type=float, metavar="SECONDS",
                        help="leave out tests that take longer, which may notice more")  # fmt: skip
    parser.add_argument("--most", type=float, metavar="SECONDS",
                        help="no more tests for a slip than take so long together, which may notice more")  # fmt: skip
    parser.add_argument("--harmless", default=pathlib.Path(__file__).with_name("harmless.txt"),
                        help="slips known to change nothing")  # fmt: skip
    parser.add_argument("--list", action="store_true", help="list the slips that would be tried")
    parser.add_argument("--unrun", action="store_true", help="list the lines that no test runs")
    arguments = parser.parse_args()
    if arguments.list:
        WORK.mkdir(parents=True, exist_ok=True)
        copy_tree()
        list_drawn(arguments)
        return
    if arguments.unrun:
        WORK.mkdir(parents=True, exist_ok=True)
        copy_tree()
        list_unrun(measure())
        return
    begun = time.monotonic()
    session = Session(arguments)
    session.prepare()
    drawn = draw(arguments.count, arguments.seed, arguments.under)
    if not drawn:
        sys.exit(f"mutate: nothing lies below '{arguments.under}'")
    try:
        for share, found in drawn:
            counted = 0
            for slip in found:
                if counted == share:
                    break
                counted += session.attempt(slip)
        session.finish()
    finally:
        session.tree.restore()
    sys.exit(0 if session.report(time.monotonic() - begun) else 1)


if __name__ == "__main__":
    main()
