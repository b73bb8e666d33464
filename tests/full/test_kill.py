"""A mission stopped hundreds of times at random moments, by SIGINT, SIGTERM and SIGKILL.

After each stop the exit code is the right one, an interrupt says one sentence, the folder is valid,
and --resume goes on; now and then it goes on to the end, and the bytes equal those of an
undisturbed run. Then merge, render and detect killed in the same way, and pairs of commands on one
folder. ASDIC_KILLS is how often each (default 200).
"""
import glob
import os
import random
import re
import shutil
import signal
import subprocess
import time

import program
import tap
from program import Folder, asdic
from run_folder import data, facts, pictures, png_texts, same, scene

KILLS = int(os.environ.get("ASDIC_KILLS", "200"))
CODES = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGKILL: -9}


def found(folder, run):
    """The state of the run and the names of its files."""
    names = os.listdir(folder / run) if os.path.isdir(folder / run) else []
    return facts(folder, run)["state"] if "run.json" in names else None, names


def valid(folder, run, was_killed, before):
    """What may be there after a stop. BEFORE: what the stopped program found. What a killed one left
    stays where its resumption is stopped before it comes to it: the state "running", with files under
    way, or a picture's."""
    (before_state, before_names), (state, names) = before, found(folder, run)
    if state is None:  # stopped before the first ping
        tap.equal([n for n in names if not n.endswith(".part")], [], "files without run.json")
        return
    if not was_killed:
        allowed = ("interrupted", "complete", before_state)
        tap.equal(state in allowed, True, f"state {state} after {before_state}")
        parts = [n for n in names if n.endswith(".part")]
        left = [n for n in before_names if state == "running" or n.endswith(".png.part")]
        tap.equal([n for n in parts if n not in left], [], "unfinished files")


def stop_once(folder, path, longest_s, luck):
    """One stop; the seconds that the run had. None when it was through before."""
    stop = luck.choice(list(CODES))
    before = found(folder, "r")
    resume = ["--resume"] if os.path.exists(folder / "r/run.json") else ["--force"]
    begin = time.monotonic()
    child = subprocess.Popen([program.PATH, "run", path, "-o", folder / "r", *resume],
                             stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)
    try:
        child.wait(timeout=luck.uniform(0, longest_s))
    except subprocess.TimeoutExpired:
        child.send_signal(stop)
    err = child.communicate()[1].decode()
    took = time.monotonic() - begin
    if child.returncode == 0:
        return None, stop, took
    # Before the handlers stand, a signal ends a program at once; Python gives -2 and -15 for that.
    tap.equal(child.returncode in (CODES[stop], -stop), True,
              f"exit code {child.returncode} of {stop.name} ({err!r})")
    if child.returncode > 0:
        # LLVM's own handler removes what it is writing, so that its compiler complains as well.
        lines = [line for line in err.splitlines()
                 if line != "1 error generated." and " a ping, " not in line]
        tap.equal(len(lines), 1, f"sentences ({err!r})")
        began = resume == ["--resume"] or found(folder, "r") != before
        tap.contains(lines[0], "--resume" if began else "was changed")
    # Where a driver compiles, the program does not wait for it and ends as if it were killed.
    valid(folder, "r", child.returncode < 0 or "compil" in err, before)
    return child.returncode, stop, took


def children(parent):
    """Whether any thread of PARENT has started a process that still runs."""
    for listed in glob.glob(f"/proc/{parent}/task/*/children"):
        try:
            with open(listed, encoding="ascii") as file:
                if file.read().strip():
                    return True
        except OSError:
            pass  # the thread has ended
    return False


def test_stopped_at_random_moments():
    program.need_device()
    luck = random.Random(1)
    with Folder() as folder:
        path = scene(folder, pings=60, rays=1000)
        asdic("run", path, "-o", folder / "first").check(code=0)  # compiles
        begin = time.monotonic()
        asdic("run", path, "-o", folder / "whole").check(code=0)
        longest_s = 1.1 * (time.monotonic() - begin)
        stops, through, seen = 0, 0, {}
        while stops < KILLS:
            code, stop, _ = stop_once(folder, path, longest_s, luck)
            if code is None:
                through += 1
                same(folder, "whole", "r")
                for name in os.listdir(folder / "r"):
                    os.unlink(folder / f"r/{name}")
            else:
                stops += 1
                seen[stop.name, code] = seen.get((stop.name, code), 0) + 1
        asdic("run", path, "-o", folder / "r", "--resume").check(code=0)
        same(folder, "whole", "r")
        told = ", ".join(f"{name} ({code}) {count}" for (name, code), count in sorted(seen.items()))
        print(f"# {stops} stops: {told}; finished and equal {through + 1} times")


def test_interrupted_with_its_compilers():
    """As by Ctrl-C in a terminal, which all processes get: also the linker that PoCL started."""
    program.need_device()
    stops = 0
    with Folder() as folder:
        path = scene(folder, pings=60, rays=1000)
        for number in range(5):
            env = program.environment({"POCL_CACHE_DIR": folder / f"cache{number}"})
            child = subprocess.Popen([program.PATH, "run", path, "-o", folder / "r", "--force"],
                                     stderr=subprocess.PIPE, env=env, start_new_session=True)
            while child.poll() is None and not children(child.pid):
                time.sleep(0.001)
            if child.poll() is None:
                os.killpg(child.pid, signal.SIGINT)
                stops += 1
            err = child.communicate()[1].decode()
            tap.equal(child.returncode in (0, 130), True, f"exit code {child.returncode} ({err!r})")
            tap.equal(len(err.splitlines()) <= 3, True, f"sentences ({err!r})")
    if not stops:
        raise tap.Skip("the device starts no compiler")
    print(f"# {stops} stops while compilers ran")


def kill_at_random(command, longest_s, luck):
    """Whether COMMAND was killed before it was through."""
    child = subprocess.Popen([program.PATH, *command], stderr=subprocess.PIPE,
                             stdout=subprocess.DEVNULL)
    try:
        child.wait(timeout=luck.uniform(0, longest_s))
    except subprocess.TimeoutExpired:
        child.kill()
    err = child.communicate()[1].decode()
    tap.equal(child.returncode in (0, -signal.SIGKILL), True, f"exit code {child.returncode} ({err})")
    return child.returncode != 0


def kill_often(folder, command, check):
    """CHECK must hold after each kill, and when COMMAND is through."""
    luck = random.Random(2)
    begin = time.monotonic()
    asdic(*command).check(code=0)
    longest_s = 1.1 * (time.monotonic() - begin)
    kills = 0
    while kills < KILLS:
        kills += kill_at_random(command, longest_s, luck)
        check()
    asdic(*command).check(code=0)
    check()
    tap.equal([n for n in os.listdir(folder) if n.endswith(".part")], [], "unfinished files")
    print(f"# {command[0]} killed {kills} times")


def test_merge_killed():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=40, rays=500)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        for k in (1, 2):
            asdic("run", path, "-o", folder / f"p{k}", "--shard", f"{k}/2").check(code=0)
        before = {k: data(folder, k, "pings.npy") for k in ("p1", "p2")}

        def check():
            if os.path.exists(folder / "m/pings.npy"):
                tap.equal(data(folder, "m", "pings.npy") == data(folder, "whole", "pings.npy"), True,
                          "all records or no such file")
            tap.equal({k: data(folder, k, "pings.npy") for k in before} == before, True, "the parts")

        kill_often(folder / "m", ("merge", folder / "p1", folder / "p2", "-o", folder / "m", "--force"),
                   check)
        same(folder, "whole", "m")


def test_render_and_detect_killed():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=40, rays=500)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        detect = ("--background", "simulated", "--force")
        asdic("detect", folder / "whole", *detect).check(code=0)
        shutil.copytree(folder / "whole", folder / "r")

        def check():
            for name in pictures(folder, "r"):
                png_texts(data(folder, "r", name))
            for name in ("detections.csv", "tracks.csv"):
                if os.path.exists(folder / f"r/{name}"):
                    tap.equal(data(folder, "r", name) == data(folder, "whole", name), True, name)

        kill_often(folder / "r", ("render", folder / "r"), check)
        kill_often(folder / "r", ("detect", folder / "r", *detect), check)
        same(folder, "whole", "r")


def test_pairs_on_one_folder():
    """Each command is through, or says in one sentence why not; nothing is lost."""
    program.need_device()
    luck = random.Random(3)
    with Folder() as folder:
        path = scene(folder, pings=20, rays=500)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        asdic("detect", folder / "whole").check(code=0)
        shutil.copytree(folder / "whole", folder / "part")
        r = folder / "r"
        commands = [("run", path, "-o", r), ("run", path, "-o", r, "--resume"),
                    ("run", path, "-o", r, "--force"), ("render", r), ("detect", r, "--force"),
                    ("merge", folder / "part", "-o", r), ("merge", folder / "part", "-o", r, "--force")]
        seen = {}
        for _ in range(KILLS):
            shutil.rmtree(r, ignore_errors=True)
            if luck.random() < 0.7:
                shutil.copytree(folder / "whole", r)
                if luck.random() < 0.3:
                    os.truncate(folder / "r/pings.npy", luck.randrange(40000))
            pair = []
            for command in (luck.choice(commands), luck.choice(commands)):
                pair.append((command[0], subprocess.Popen(
                    [program.PATH, *command], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL)))
                time.sleep(luck.choice((0, luck.uniform(0, 0.3))))
            for name, child in pair:
                err = child.communicate()[1].decode()
                errors = [line for line in err.splitlines() if line.startswith("error:")]
                tap.equal((child.returncode in (0, 1, 3), len(errors)), (True, child.returncode != 0),
                          f"{[n for n, _ in pair]}: {name}: {err}")
                tap.equal(re.search("write.*No such file", err), None, "a file that was taken away")
                seen[name, child.returncode] = seen.get((name, child.returncode), 0) + 1
            asdic("run", path, "-o", r, "--resume").check(code=0)
            asdic("detect", r, "--force").check(code=0)
            same(folder, "whole", "r")
        told = ", ".join(f"{name} ({code}) {count}" for (name, code), count in sorted(seen.items()))
        print(f"# {KILLS} pairs: {told}")


tap.main(globals())
