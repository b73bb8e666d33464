"""Runs in parts, on two devices, stopped and resumed: always the same bytes."""
import os
import re
import resource
import shutil
import signal
import subprocess
import time

import program
import tap
from program import Folder, asdic
from run_folder import data, edit_facts, facts, same, scene


def test_same_bytes_on_two_devices():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=12)
        asdic("run", path, "-o", folder / "one").check(code=0)
        asdic("run", path, "-o", folder / "two", "--device", "all",
              POCL_DEVICES="pthread pthread").check(code=0)
        same(folder, "one", "two")


def test_shards_merge_to_the_whole():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=7)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        for k in (1, 2, 3):
            asdic("run", path, "--shard", f"{k}/3", cwd=folder.path).check(code=0)
        parts = [f"run_pool_{k}_of_3" for k in (2, 3, 1)]
        tap.equal(sum(facts(folder, part)["pings"] for part in parts), 7)
        asdic("merge", *parts, "-o", "joined", cwd=folder.path).check(code=0)
        same(folder, "whole", "joined")
        tap.equal(facts(folder, "joined")["devices"], facts(folder, "whole")["devices"], "each device once")
        for what in ("setup", "simulate"):
            spent = sum(facts(folder, part)["time_s"][what] for part in parts)
            tap.equal(abs(facts(folder, "joined")["time_s"][what] - spent) < 0.01, True, f"{what}, of all parts")
        asdic("merge", *parts, "-o", "joined", cwd=folder.path).check(code=1)
        asdic("merge", *parts, cwd=folder.path).check(code=2)
        twice = asdic("merge", parts[0], parts[2], parts[2], "-o", "x", cwd=folder.path).check(code=3)
        tap.contains(twice.err, f"'{parts[2]}' is named twice")
        for some, lacking in ((parts[:2], "0 to 1"), (parts[::2], "4 to 6")):
            done = asdic("merge", *some, "-o", "x", cwd=folder.path).check(code=3)
            tap.contains(done.err, f"pings {lacking} are in none of the parts; '{sorted(some)[0]}' is a part of pings 0 to 6")
        # Of chosen pings the shards join to these.
        asdic("run", path, "--pings", "1:6", "-o", folder / "few").check(code=0)
        for k in (1, 2):
            asdic("run", path, "--pings", "1:6", "--shard", f"{k}/2", "-o", folder / f"few{k}").check(code=0)
        asdic("merge", folder / "few2", folder / "few1", "-o", folder / "joined_few").check(code=0)
        same(folder, "few", "joined_few")
        asdic("run", path, "--pings", "2:5", "-o", folder / "some").check(code=0)
        rows = data(folder, "some", "bins.csv").decode().splitlines()[1:]
        whole = data(folder, "whole", "bins.csv").decode().splitlines()[1:]
        tap.equal(rows, [row for row in whole if row.split(",")[0] in "234"], "--pings 2:5")


def test_shards_beyond_the_pings_are_empty():
    """Three pings among five parts: two have nothing to do, and what joins them passes over these."""
    program.need_device()
    with Folder() as folder:
        path, parts, empty = scene(folder, pings=3), [folder / f"part{k}" for k in range(1, 6)], 0
        asdic("run", path, "-o", folder / "whole").check(code=0)
        for k, part in enumerate(parts, 1):
            done = asdic("run", path, "--shard", f"{k}/5", "-o", part).check(code=0)
            empty += f"--shard {k}/5: nothing to do; pings to share: 3" in done.err
        tap.equal(empty, 2)
        done = asdic("merge", *parts, "-o", folder / "joined").check(code=0)
        tap.contains(done.err, "2 of 5 folders are empty and passed over")
        same(folder, "whole", "joined")
        asdic("merge", parts[0], "-o", folder / "none").check(code=3)
        first = next(k for k, part in enumerate(parts, 1) if not os.listdir(part))
        for there in (folder / "whole", folder.write("file", "")):  # neither is one that 'merge' passes over
            for mode in ([], ["--force"], ["--resume"]):
                done = asdic("run", path, "--shard", f"{first}/5", "-o", there, *mode).check(code=1)
                tap.contains(done.err, "leaves an empty folder, which")
        same(folder, "whole", "joined")


def test_a_run_of_another_file_is_not_resumed():
    """A curve, a mesh whose box stays, a track: each a tenth off."""
    program.need_device()
    files = {"c.csv": ("grazing_deg,strength_db\n5,-40\n45,{}\n90,-5\n", -20, -20.1),
             "m.obj": ("v 0 0 0\nv 2 0 0\nv 0 2 0\nv 2 2 0\nv 0 0 -2\nv 1 1 {}\nf 1 2 5\nf 3 4 5\nf 1 3 6\nf 2 4 6\n",
                       -1, -1.1),
             "t.csv": ("time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,7,0,0,0\n1,1,0,{},0,0,0\n", 7, 7.1)}
    with Folder() as folder:
        path = folder.write("s.yaml", "version: 1\nbottom: {depth_m: 12, curve: c.csv}\n"
                            "objects: [{name: rock, mesh: {file: m.obj}, position_m: [20, 0, 11]}]\n"
                            "sonar: {frequency_khz: 100, receivers: [{name: a}]}\n"
                            "mission: {track: t.csv}\nsampling: {rays: 500}\n")
        for name, (text, value, _) in files.items():
            folder.write(name, text.format(value))
        asdic("run", path, "-o", folder / "r").check(code=0)
        for name, (text, value, other) in files.items():
            folder.write(name, text.format(other))
            tap.contains(asdic("run", path, "-o", folder / "r", "--resume").check(code=1).err,
                         "another mesh, grid or track, or measured law")
            folder.write(name, text.format(value))
        tap.contains(asdic("run", path, "-o", folder / "r", "--resume").check(code=0).err, "complete already")


def test_a_fan_that_turns_is_the_same_in_parts():
    """At one depth, and so of one wavelength, all that a simulator keeps from ping to ping is in use:
    a part that begins anywhere must not see that it lacks the pings before."""
    program.need_device()
    fan = "    fan: {count: 32, sector_deg: 60, length_h_m: 0.3, length_v_m: 0.02}"
    with Folder() as folder:
        text = folder.read(scene(folder, pings=70, rays=500, receivers=fan).rsplit("/", 1)[1])
        path = folder.write("pool.yaml", text.replace("pose: {position_m: [0, 0, 5]}",
                                                      "track: turn.csv"))
        folder.write("turn.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                     "0,0,0,5,0,0,170\n3.5,3,1,5,4,-3,250\n")
        asdic("run", path, "-o", folder / "whole").check(code=0)
        asdic("run", path, "-o", folder / "all", "--device", "all",
              POCL_DEVICES="pthread basic").check(code=0)
        same(folder, "whole", "all")
        for k in (1, 2):
            asdic("run", path, "--shard", f"{k}/2", cwd=folder.path).check(code=0)
        asdic("merge", *[f"run_pool_{k}_of_2" for k in (1, 2)], "-o", "joined",
              cwd=folder.path).check(code=0)
        same(folder, "whole", "joined")


def without_pictures(folder, name, pings):
    """The pool as NAME: what is run many times draws nothing, since other tests compare pictures."""
    scene(folder, pings=pings, rays=500)
    folder.write(name, folder.read("pool.yaml").replace("[waterfall, ascope, fan]", "[]"))
    os.remove(folder / "pool.yaml")


def page_text():
    return open(os.path.join(os.path.dirname(__file__), "..", "..", "docs", "machines.md"),
                encoding="utf-8").read()


def test_the_slurm_recipe():
    """The script for a Slurm array, as printed, with what Slurm sets for each task; then its merge."""
    program.need_device()
    page = page_text()
    script = re.search(r"```sh by=cli_resume\n(#!/bin/sh\n#SBATCH --array=1-(\d+)\n.*?)```", page, re.DOTALL)
    tasks = int(script.group(2))
    merge = re.search(rf"`(asdic merge run_mission_\*_of_{tasks} [^`]*)`", page).group(1)
    with Folder() as folder:
        without_pictures(folder, "mission.yaml", pings=tasks)
        asdic("run", "mission.yaml", "-o", "whole", cwd=folder.path).check(code=0)
        os.symlink(program.PATH, folder / "asdic")
        os.chmod(folder.write("recipe.sh", script.group(1)), 0o755)
        path = {"PATH": f"{folder.path}:{os.environ['PATH']}", "SLURM_ARRAY_TASK_COUNT": str(tasks)}
        for task in range(tasks, 0, -1):
            subprocess.run(["./recipe.sh"], cwd=folder.path, check=True, capture_output=True,
                           env=program.environment({**path, "SLURM_ARRAY_TASK_ID": str(task)}))
        subprocess.run(["sh", "-ec", merge], cwd=folder.path, check=True, capture_output=True,
                       env=program.environment(path))
        same(folder, "whole", "run_mission")


def test_multipath_between_boundaries_goes_on():
    """run.json names the kind of multipath: a run of each can be drawn again and finished."""
    program.need_device()
    for way in ("off", "first", "boundaries"):
        with Folder() as folder:
            path = scene(folder, pings=3, rays=500)
            text = folder.read("pool.yaml").replace("seed: 7", f"seed: 7, multipath: {way}")
            folder.write("pool.yaml", text)
            asdic("run", path, "-o", folder / "whole").check(code=0)
            asdic("run", path, "-o", folder / "r").check(code=0)
            tap.equal(facts(folder, "r")["multipath"], way)
            os.remove(folder / "r/waterfall_down.png")
            asdic("render", folder / "r").check(code=0)
            same(folder, "whole", "r")
            # As a run killed after two pings leaves it.
            records = data(folder, "r", "pings.npy")
            head = 10 + int.from_bytes(records[8:10], "little")
            kept = head + (len(records) - head) * 2 // 3
            with open(folder / "r/pings.npy.part", "wb") as part:
                part.write(records[:kept])
            os.remove(folder / "r/pings.npy")
            edit_facts(folder, "r", '"complete"', '"running"')
            asdic("run", path, "-o", folder / "r", "--resume").check(code=0)
            same(folder, "whole", "r")


def test_what_was_found_in_a_part_goes_with_it():
    program.need_device()
    found = ["detections.csv", "detections.mcap", "occupancy.png", "tracks.csv"]
    with Folder() as folder:
        path = scene(folder, pings=3, rays=500)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        for state, stays in (("running", False), ("complete", True)):  # made again as they were: damaged pings
            shutil.copytree(folder / "whole", folder / "r")
            for name in [*found, "background.npy"]:
                folder.write("r/" + name, "of fewer pings")
            records = data(folder, "r", "pings.npy")
            head = 10 + int.from_bytes(records[8:10], "little")
            with open(folder / "r/pings.npy", "wb") as part:
                part.write(records[:head + (len(records) - head) * 2 // 3])
            edit_facts(folder, "r", '"complete"', f'"{state}"')
            said = asdic("run", path, "-o", folder / "r", "--resume").check(code=0).err
            left = [name for name in found if os.path.exists(folder / ("r/" + name))]
            tap.equal(left, found if stays else [], f"what was found in a run that was {state}")
            warning = f"'{folder / 'r'}' gets more pings: what 'asdic detect' found in those before is removed; run it again"
            tap.equal(warning in said, not stays, said)
            tap.equal(folder.read("r/background.npy"), "of fewer pings", "it says itself of which pings it is")
            for name in [*left, "background.npy"]:
                os.remove(folder / ("r/" + name))
            same(folder, "whole", "r")
            shutil.rmtree(folder / "r")


def test_what_was_found_stays_when_a_mending_is_interrupted():
    """The first --resume of a complete run with a damaged ping leaves it interrupted."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=3, rays=500)
        asdic("run", path, "-o", folder / "r").check(code=0)
        folder.write("r/tracks.csv", "of all pings")
        records = bytearray(data(folder, "r", "pings.npy"))
        records[-100] ^= 1
        with open(folder / "r/pings.npy", "wb") as file:
            file.write(records)
        edit_facts(folder, "r", '"complete"', '"interrupted"')
        said = asdic("run", path, "-o", folder / "r", "--resume").check(code=0).err
        tap.contains(said, "made again")
        tap.equal("gets more pings" in said, False, said)
        tap.equal(folder.read("r/tracks.csv"), "of all pings")


def test_recipes_of_the_page_on_many_machines():
    """The commands for xargs and GNU parallel, as printed, give the bytes of one run."""
    program.need_device()
    page = page_text()
    merge = re.search(r"^asdic merge run_mission_\*_of_8 .*$", page, re.MULTILINE).group()
    recipes = {"xargs": re.search(r"^seq 8 \| xargs .*$", page, re.MULTILINE).group(),
               "parallel": re.search(r"`(parallel [^`]*)`", page).group(1)}
    with Folder() as folder:
        without_pictures(folder, "mission.yaml", pings=24)
        asdic("run", "mission.yaml", "-o", "whole", cwd=folder.path).check(code=0)
        os.symlink(program.PATH, folder / "asdic")
        for tool, recipe in recipes.items():
            version = subprocess.run([tool, "--version"], capture_output=True, check=False) \
                if shutil.which(tool) else None
            if not version or b"GNU" not in version.stdout:
                continue
            subprocess.run(["sh", "-ec", recipe + "\n" + merge], cwd=folder.path, check=True,
                           env=program.environment({"PATH": f"{folder.path}:{os.environ['PATH']}"}))
            same(folder, "whole", "run_mission")
            for name in folder.names():
                if name.startswith("run_mission"):
                    shutil.rmtree(folder / name)


def start(path, run):
    return subprocess.Popen([program.PATH, "run", path, "-o", run], stderr=subprocess.PIPE)


def wait_for_pings(child, run, size):
    """Until the records of a running child have grown beyond SIZE bytes."""
    end = time.monotonic() + 60
    while time.monotonic() < end and child.poll() is None:
        try:
            if os.path.getsize(os.path.join(run, "pings.npy.part")) > size:
                return
        except FileNotFoundError:
            pass
        time.sleep(0.002)
    raise AssertionError("the run ended before it could be stopped")


def test_killed_and_interrupted_runs_go_on():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=150, rays=4000)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        child = start(path, folder / "r")
        wait_for_pings(child, folder / "r", 20000)
        child.send_signal(signal.SIGSTOP)
        for option in ("--resume", "--force"):
            done = asdic("run", path, "-o", folder / "r", option).check(code=1)
            tap.contains(done.err, "another process is writing to")
        child.kill()
        child.communicate()
        tap.equal(facts(folder, "r")["state"], "running", "state")
        for stop, code in ((signal.SIGINT, 130), (signal.SIGTERM, 143)):
            before = os.path.getsize(folder / "r/pings.npy.part")
            child = subprocess.Popen([program.PATH, "run", path, "-o", folder / "r", "--resume"],
                                     stderr=subprocess.PIPE)
            wait_for_pings(child, folder / "r", before)
            child.send_signal(stop)
            _, err = child.communicate()
            tap.equal(child.returncode, code, "exit code")
            tap.contains(err.decode(), "--resume")
            run = facts(folder, "r")
            tap.equal(run["state"], "interrupted", "state")
            tap.equal(len(data(folder, "r", "bins.csv").splitlines()),
                      1 + run["pings"] * run["beams"] * run["bins"], "rows of a valid folder")
            tap.equal([n for n in os.listdir(folder / "r") if n.endswith(".part")], [], "parts")
            os.rename(folder / "r/pings.npy", folder / "r/pings.npy.part")
        asdic("run", path, "-o", folder / "r", "--resume").check(code=0)
        same(folder, "whole", "r")


def test_full_disk_is_an_error_that_loses_nothing():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=800)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        # bins.csv has 5 MB; a driver's compiler may need more than 1 MB for a file of its own.
        done = subprocess.run(
            [program.PATH, "run", path, "-o", folder / "r"], capture_output=True, check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (3000000, 3000000)))
        tap.equal(done.returncode, 1, "exit code")
        tap.contains(done.stderr.decode(), "File too large")
        tap.contains(done.stderr.decode(), "--resume")
        asdic("run", path, "-o", folder / "r", "--resume").check(code=0)
        same(folder, "whole", "r")


def test_reads_and_writes_that_do_a_part():
    program.need_device()
    short = {"LD_PRELOAD": os.environ["SHORT_IO_LIBRARY"]}
    with Folder() as folder:
        path = scene(folder, pings=9, rays=500)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        for k in (1, 2):
            asdic("run", path, "-o", folder / f"part{k}", "--shard", f"{k}/2", **short).check(code=0)
        asdic("merge", folder / "part1", folder / "part2", "-o", folder / "r", **short).check(code=0)
        same(folder, "whole", "r")


def test_disk_that_is_full_and_then_larger():
    """A small file system of its own: records, tables, pictures and run.json all meet its end."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=60, rays=500)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        size = sum(os.path.getsize(folder / "whole/" + n) for n in os.listdir(folder / "whole"))
        shell = f"""
set -eu
mount -t tmpfs -o size={{size}}k none disk || exit 77
option=--force
for part in {{parts}}; do
  mount -o remount,size=${{{{part}}}}k disk
  code=0; "{program.PATH}" run pool.yaml -o disk/r $option 2>>messages || code=$?
  echo $code >>codes
  option=--resume
done
cp -r disk/r out
"""
        os.mkdir(folder / "disk")
        kilobytes = size // 1024
        # Pages of 4 KiB: ends in the records, in the tables, in the pictures; then there is room.
        parts = [kilobytes * k // 100 for k in (20, 45, 70, 90, 97)] + [3 * kilobytes]
        done = subprocess.run(
            ["unshare", "-m", "sh", "-c", shell.format(
                size=parts[0], parts=" ".join(map(str, parts)))],
            cwd=folder.path, capture_output=True, check=False) if shutil.which("unshare") else None
        if not done or done.returncode == 77 or b"unshare" in done.stderr:
            raise tap.Skip("no file system of its own can be mounted here")
        tap.equal((done.returncode, done.stderr), (0, b""))
        codes = folder.read("codes").split()
        tap.equal((set(codes[:-1]) <= {"0", "1"}, codes[:2], codes[-1]), (True, ["1", "1"], "0"), "")
        tap.contains(folder.read("messages"), "No space left on device")
        tap.contains(folder.read("messages"), "--resume goes on")
        same(folder, "whole", "out")


tap.main(globals())
