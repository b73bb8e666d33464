"""The report: everything the README claims, measured again on this machine, in one folder.

    report.py BUILD FOLDER [--quick]

One Markdown page, with the tables as CSV and the pictures as PNG beside it. A part that fails is named on
the page and in the exit code; the others are made all the same.
"""
import json
import os
import pathlib
import platform
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
QUICK = ["--quick"] if "--quick" in sys.argv[3:] else []
ASDIC = str(BUILD / "cli/asdic")
SCENES = ROOT / "data/scenes"

# Heading; what stands below it; commands of asdic, or tests by name; pictures they make.
PARTS = [
    ("Formulas", "206 values that asdic did not compute, in double and in single precision.",
     [("test", "formulas"), ("test", "formulas_device"), ("test", "model_device")], []),
    ("Expected levels", "Quadrature against an independent program, bin by bin.",
     [("test", "expected")], []),
    ("Slips of the paper", "What each does to the paper's first scenario.",
     [("asdic", "expect", "--errata", SCENES / "scenario1.yaml")], []),
    ("Rays against expectation", "Chi-squared per bin and component, bias, six attitudes.",
     [("test", "null")], []),
    ("Target strength", "Bodies of known strength, through whole pings.", [("test", "target")], []),
    ("Hard cases", "Numerical stability where it is most in danger.", [("test", "hard_cases")], []),
    ("False alarms", "Design value against count, Rayleigh and K, one and several looks.",
     [("test", "false_alarms")], []),
    ("Speed against error", "Rays and time for an error, beside the paper's uniform sphere.",
     [("asdic", "bench", "error", *QUICK, "-o", "error.csv", "--picture", "error.png")],
     ["error.png"]),
    ("Rays", "Millions of rays per second; beside Embree where it was built in.",
     [("asdic", "bench", "rays", *QUICK, "-o", "rays.csv")], []),
    ("Whole pings", "The paper's case over larger and larger floors.",
     [("asdic", "bench", "pings", *QUICK, "-o", "pings.csv")], []),
    ("Latency", "From a pose to its levels.", [("asdic", "bench", "loop", *QUICK, "-o", "loop.csv")],
     []),
    ("The paper's figures", "Levels against expectation, and the rise in three beams.",
     [("asdic", "run", "-q", "--force", SCENES / "scenario1.yaml", "-o", "scenario1"),
      ("asdic", "run", "-q", "--force", SCENES / "scenario2.yaml", "-o", "scenario2")],
     ["scenario1/ascope_0.png", "scenario2/ascope_0.png"]),
]


def text_of(command, env=None):
    done = subprocess.run(list(map(str, command)), cwd=FOLDER, env=env, capture_output=True,
                          text=True, check=False)
    return done.returncode, done.stdout, done.stderr


def find_tests():
    """Command and environment of every test, as Meson knows them."""
    code, out, err = text_of(["meson", "introspect", "--tests", BUILD])
    if code:
        sys.exit(f"report: {err}")
    return {test["name"]: test for test in json.loads(out)}


def lines_of_test(out):
    """What a test measured, without the frame that cmocka and TAP put round it."""
    return "\n".join(line for line in out.splitlines()
                     if line.strip() and not line.startswith(("[", "ok ", "1..")))


def run(tests, command):
    """Exit code, heading and text of one command."""
    if command[0] == "asdic":
        code, out, err = text_of([ASDIC, *command[1:]])
        shown = " ".join(str(word).replace(str(ROOT) + "/", "") for word in command)
        return code, shown, out + (err if code else "")
    test = tests.get(command[1])
    if not test:
        return 1, command[1], "there is no such test"
    env = {**os.environ, **{name: str(value) for name, value in test["env"].items()}}
    code, out, err = text_of(test["cmd"], env)
    measured = lines_of_test(out + (err if code not in (0, 77) else ""))
    return 0 if code == 77 else code, f"meson test {command[1]}", measured


def machine():
    cpu = "?"
    for line in pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
        if line.startswith("model name"):
            cpu = line.split(":")[1].strip()
    commit = subprocess.run(["git", "-C", ROOT, "describe", "--always", "--dirty"],
                            capture_output=True, text=True, check=False).stdout.strip() or "?"
    devices = text_of([ASDIC, "devices"])[1].strip()
    load = os.getloadavg()[0]
    return (f"{time.strftime('%Y-%m-%d')}; commit {commit}; {platform.system()} {platform.machine()}, "
            f"{os.cpu_count()} processors ({cpu}), load before it began {load:.1f}.\n\n"
            f"```\n{devices}\n```\n")


def main():
    FOLDER.mkdir(parents=True, exist_ok=True)
    tests, failed = find_tests(), []
    with open(FOLDER / "report.md.part", "w", encoding="utf-8") as page:
        page.write(f"# asdic, measured\n\n{machine()}")
        for title, about, commands, pictures in PARTS:
            print(f"report: {title}", flush=True)
            page.write(f"\n## {title}\n\n{about}\n")
            for command in commands:
                code, shown, out = run(tests, command)
                if code:
                    failed.append(shown)
                page.write(f"\n`{shown}`{f' failed ({code})' if code else ''}\n")
                page.write(f"\n```\n{out.rstrip()}\n```\n" if out.strip() else "")
            for picture in pictures:
                if (FOLDER / picture).exists():
                    flat = picture.replace("/", "_")
                    if flat != picture:
                        shutil.copyfile(FOLDER / picture, FOLDER / flat)
                    page.write(f"\n![{title}]({flat})\n")
    os.replace(FOLDER / "report.md.part", FOLDER / "report.md")
    print(f"report: {FOLDER / 'report.md'}")
    if failed:
        sys.exit("report: failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
