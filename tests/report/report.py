"""The report: what README.md and docs claim, measured again on this machine, in one folder.

    report.py BUILD FOLDER [--quick]

One Markdown page, with the tables as CSV and the pictures as PNG beside it. A part that fails is named on
the page and in the exit code; the others are made all the same.
"""
import csv
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD, FOLDER = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
QUICK = ["--quick"] if "--quick" in sys.argv[3:] else []
FEW_PINGS = ["--pings", "0:40"] if QUICK else []
ASDIC = str(BUILD / "cli/asdic")
PROJECT_BENCH = str(BUILD / "tests/bench/asdic-bench")
SCENES = ROOT / "data/scenes"

# What tests print, as tables: a pattern for a row and the names of its groups.
NUMBER = r"([-+]?[0-9.]+(?:e[-+]?[0-9]+)?)"
TABLES = {
    "slips": (rf"slip +(\d+)(?: \(all of 'printed'\))?, (\w+) +{NUMBER} \[(\S+), {NUMBER}\] dB",
                 "slip,component,median_db,least_db,largest_db"),
    "cli_scenarios": (rf"# (.+): r\.m\.s\. {NUMBER} dB of {NUMBER}, largest {NUMBER} dB of {NUMBER}",
                      "seed_or_beam,rms_db,rms_allowed_db,largest_db,largest_allowed_db"),
    "formulas": (rf"(\S+) +(\d+) values, largest error {NUMBER} (\S+), {NUMBER} of a tolerance",
                 "formula,values,largest_error,unit,share_of_tolerance"),
    "null": (rf"(\w[\w ]*?)  +(beam|adaptive) +total {NUMBER} +bottom {NUMBER} +surface {NUMBER} +volume {NUMBER}",
             "attitude,sampler,total,bottom,surface,volume"),
    "target": (rf"(\S.*?)  +{NUMBER} +{NUMBER} +{NUMBER} \+- {NUMBER} +{NUMBER} \+- {NUMBER} +\({NUMBER}\)",
               "body,theory_db,ping_db,error_db,error_std_db,beam_sampler_error_db,beam_sampler_std_db,allowed_db"),
    "hard_cases": (rf"(\S.*?)  +{NUMBER} of {NUMBER} +(\S.*)", "case,largest,allowed,unit"),
    "false_alarms": (rf"(\S.*?) +(\d+) looks? +P_FA {NUMBER}: {NUMBER} \[{NUMBER}, {NUMBER}\] in (\d+) bins",
                     "clutter,looks,design_pfa,pfa,pfa_low,pfa_high,bins"),
}

# Heading; what stands below it; commands of asdic, or tests by name; pictures they make.
PARTS = [
    ("Formulas", "Values that asdic did not compute, in double and in single precision.",
     [("test", "formulas"), ("test", "formulas_device"), ("test", "model_device")], []),
    ("Expected levels", "Quadrature and simulated pings against independent programs, bin by bin.",
     [("test", "expected"), ("test", "cli_scenarios")], []),
    ("Slips of the paper", "What each does to the paper's first scenario.",
     [("test", "slips")], []),
    ("Rays against expectation", "Chi-squared per bin and component, bias, six attitudes.",
     [("test", "null")], []),
    ("Target strength", "Bodies of known strength, through whole pings.", [("test", "target")], []),
    ("Hard cases", "Numerical stability where it is most in danger.", [("test", "hard_cases")], []),
    ("Stated errors", "True over stated error, and errors at all, in scenes that nothing was tuned on.",
     [("test", "cli_honest"), ("test", "robust")], []),
    ("Fans", "Beams that share rays, against quadrature.", [("test", "fan")], []),
    ("Overlapping beams", "False alarms, plots, tracks and map cells of an empty sea.", [("test", "empty_sea")], []),
    ("False alarms", "Design value against count, Rayleigh and K, one and several looks.",
     [("test", "false_alarms")], []),
    ("Detection", "P_D against P_FA, counted and in closed form: the rise of the second scenario; a point of "
     "-20 dB 60 m away, seen by three designs.",
     [("test", "example_detect"),
      ("asdic", "roc", "--force", SCENES / "scenario2.yaml", "-o", "roc_rise"),
      ("asdic", "roc", "--force", SCENES / "scenario2.yaml", "--range", "60", "--strength", "-20", "--vary",
       "sonar.receivers[0].pitch_deg=0,10,20", "-o", "roc_pitch")],
     ["roc_rise/roc.png", "roc_pitch/roc.png"]),
    ("Speed against error", "Rays and time for an error, beside the paper's uniform sphere.",
     [("asdic", "bench", "error", *QUICK, "-o", "error.csv", "--picture", "error.png"),
      ("asdic-bench", "cost", *QUICK, SCENES / "bench_flat.yaml", SCENES / "bench_terrain.yaml", "-o", "cost.csv")],
     ["error.png"]),
    ("Rays", "Millions of rays per second; beside Embree where it was built in.",
     [("asdic-bench", "beside", *QUICK, "-o", "rays.csv")], []),
    ("Whole pings", "The paper's case over larger and larger floors, on one processor and on all.",
     [("asdic", "bench", "pings", *QUICK, "-o", "pings.csv", "--picture", "pings.png"),
      ("asdic-bench", "growth", *QUICK, "-o", "growth.csv"), ("asdic-bench", "start", "-o", "start.csv")],
     ["pings.png"]),
    ("Many beams", "From the same rays; and Project DAVE's published case.",
     [("asdic-bench", "fan", *QUICK, "-o", "fan.csv", "--picture", "fan.png")], ["fan.png"]),
    ("Writing and drawing", "Their share of the time by the clock, the processor being the device.",
     [("asdic", "run", "--force", *FEW_PINGS, SCENES / "mission.yaml", "-o", "mission"),
      ("asdic", "run", "--force", *FEW_PINGS, SCENES / "mission_fan.yaml", "-o", "mission_fan")],
     ["mission/plan.png"]),
    ("Latency", "From a pose to its levels.", [("asdic-bench", "latency", *QUICK, "-o", "loop.csv")],
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


def write_table(name, text):
    """NAME.csv of the rows that a test printed; False where it prints no table."""
    if name not in TABLES:
        return False
    pattern, header = TABLES[name]
    rows = [found.groups() for line in text.splitlines() if (found := re.fullmatch(r"\s*" + pattern, line))]
    with open(FOLDER / f"{name}.csv", "w", encoding="utf-8", newline="") as out:
        csv.writer(out).writerows([header.split(","), *rows])
    return bool(rows)


def tables_of(command, out):
    """The CSV files that belong to a command."""
    if command[0] == "test":
        return [f"{command[1]}.csv"] if write_table(command[1], out) else []
    where = FOLDER / command[command.index("-o") + 1] if "-o" in command else None
    if where and where.is_dir():
        return sorted(f"{where.name}/{path.name}" for path in where.glob("*.csv"))
    return [where.name] if where and where.exists() else []


def drop_bulk():
    """Tables of whole missions are hundreds of megabytes; the page shows how long they took."""
    for path in FOLDER.rglob("*"):
        if path.is_file() and path.stat().st_size > 16 << 20:
            path.unlink()


def run(tests, command):
    """Exit code, heading and text of one command."""
    if command[0] in ("asdic", "asdic-bench"):
        code, out, err = text_of([ASDIC if command[0] == "asdic" else PROJECT_BENCH, *command[1:]])
        shown = " ".join(str(word).replace(str(ROOT) + "/", "") for word in command)
        told = code != 0 or command[1] == "run"  # a run says on stderr where its time went
        return code, shown, out + (err if told else "")
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
                drop_bulk()
                if code:
                    failed.append(shown)
                page.write(f"\n`{shown}`{f' failed ({code})' if code else ''}\n")
                page.write(f"\n```\n{out.rstrip()}\n```\n" if out.strip() else "")
                for table in tables_of(command, out):
                    page.write(f"\n[{table}]({table})\n")
            for picture in pictures:
                if (FOLDER / picture).exists():
                    page.write(f"\n![{title}]({picture})\n")
    os.replace(FOLDER / "report.md.part", FOLDER / "report.md")
    print(f"report: {FOLDER / 'report.md'}")
    if failed:
        sys.exit("report: failed: " + "; ".join(failed))


if __name__ == "__main__":
    main()
