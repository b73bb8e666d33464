"""Builds the project another way inside the build folder, and runs its tests if asked to.

    nested.py FOLDER SOURCE [--tests | --only NAME,NAME...] [--then TEST.py] [MESON_OPTION...]

Compilers come from CC and CXX; --tests runs the default tests, --only those of them that are named;
TEST.py is run on asdic-bench, which alone is built then.
"""
import json
import os
import subprocess
import sys


def run(number, title, command, **environment):
    """One line of TAP; the output matters only when COMMAND fails."""
    done = subprocess.run(command, capture_output=True, text=True, check=False,
                          env={**os.environ, **environment})
    good = done.returncode == 0
    print(f"{'ok' if good else 'not ok'} {number} - {title}", flush=True)
    if not good:
        lines = (done.stdout + done.stderr).strip().splitlines()
        print("\n".join("# " + line for line in lines[-60:]), flush=True)
    return good


def report_tests(folder):
    """The lines of every test program of the nested run."""
    good = True
    with open(f"{folder}/meson-logs/testlog-quick.json", encoding="utf-8") as log:
        for program in map(json.loads, log):
            print(program.get("stdout", ""))
            print(program.get("stderr", ""))
            if program["result"] not in ("OK", "SKIP"):
                good = False
                print(f"not ok 0 - {program['name']} ended with {program['result']}")
    return good


def take(options, name):
    """The word behind NAME, which leaves OPTIONS with it; None without."""
    if name not in options:
        return None
    at = options.index(name)
    word = options[at + 1]
    del options[at:at + 2]
    return word


def main():
    folder, source, *options = sys.argv[1:]
    only = take(options, "--only")
    then = take(options, "--then")
    tests = only is not None or "--tests" in options
    options = [option for option in options if option != "--tests"]
    names = only.split(",") if only else []
    meson = ["meson", "setup", folder, source, *options]
    if os.path.exists(f"{folder}/build.ninja"):
        meson.insert(2, "--reconfigure")
    built = ["cli/asdic", "asdic-bench"] if then else []
    good = run(1, "configure", meson) and run(2, "compile", ["meson", "compile", "-C", folder, *built])
    if good and tests:
        subprocess.run(["meson", "test", "-C", folder, "--no-rebuild",
                        "--setup", "quick", "-t", "8", *names], check=False,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        good = report_tests(folder)
    if good and then:
        good = run(3, os.path.basename(then), [sys.executable, then],
                   ASDIC=f"{folder}/cli/asdic", ASDIC_BENCH=f"{folder}/tests/bench/asdic-bench")
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
