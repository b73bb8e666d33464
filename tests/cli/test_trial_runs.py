"""The runs of a trial: the same bytes however they are dealt, in parts, by processes and devices, after changes of its
files and on full disks."""
import csv
import json
import math
import os
import re
import resource
import shutil
import subprocess
import sys

import program
import tap
from program import Folder, asdic
from run_folder import data
from trial_wall import CLOSE, IDEAL, WALL


def check_table(text, figures):
    """What is printed of designs is what trial.json says of FIGURES."""
    want = ["design runs collision 95 % bounds needless per km, bounds nearest m"]
    for v in figures:
        want += [v["name"], v["runs"], "{:.4f} {:.4f}..{:.4f}".format(*v["collision"]),
                 "{:.3f} {:.3f}..{:.3f}".format(*v["needless_per_km"]), f"{v['least_clearance_m']:.2f}"]
    want += ["design hits not seen seen late could not turn late void broken km"]
    for v in figures:
        want += [v["name"], *(v[key] for key in ("hit", "not seen", "seen late", "could not turn", "late", "void",
                                                 "broken")), f"{v['km']:.2f}"]
    want += ["less the first collision 95 % bounds by chance runs, of unpaired"]
    for v in figures[1:]:
        want += [v["name"], "{:+.4f} {:+.4f}..{:+.4f}".format(*v["difference"]), f"{v['mcnemar']:.2g}",
                 f"{100 * v['paired_share']:.0f} %"]
    tap.equal(" ".join(text.split()), " ".join(map(str, want)), "table")


def test_the_same_bytes_however_dealt():
    """Of one process, of shards, of a trial that was stopped, and of another order of workers."""
    with Folder() as folder:
        path = folder.write("wall.yaml", IDEAL.replace("PD", "0.1") + """  draws:
    - {key: 'objects[0].position_m[0]', uniform: [59, 65]}
    - {key: 'objects[0].material.type', choice: [mud, rock]}
    - {key: 'objects[0].box.size_m', choice: [[2, 400, 40]]}
""")
        vary = ("--vary", "trial.rule.reach_m=10,20")
        done = asdic("trial", path, "--runs", 20, *vary, "-o", folder / "whole").check(code=0)
        check_table(done.out, json.loads(folder.read("whole/trial.json"))["variants"])
        for k in (1, 2, 3):
            asdic("trial", path, "--runs", 20, *vary, "--shard", f"{k}/3", "-o",
                  folder / f"part{k}").check(code=0)
        asdic("merge", folder / "part3", folder / "part1", folder / "part2", "-o",
              folder / "merged").check(code=0)
        shutil.copytree(folder / "whole", folder / "cut")
        os.rename(folder / "cut/trial.json", folder / "cut/trial.part.json")
        with open(folder / "cut/trial.csv", "rb") as file:
            content = file.read()
        with open(folder / "cut/trial.part.csv", "wb") as file:
            file.write(content[:len(content) // 2])
        os.remove(folder / "cut/trial.csv")
        os.remove(folder / "cut/trial.png")
        asdic("trial", path, "--runs", 20, *vary, "-o", folder / "cut").check(code=1)
        asdic("trial", path, "--runs", 21, *vary, "-o", folder / "cut", "--resume").check(code=1)
        asdic("trial", path, "--runs", 20, *vary, "-o", folder / "cut", "--resume").check(code=0)
        with open(folder / "whole/trial.csv", encoding="utf-8") as file:
            drawn = [row["objects[0].box.size_m"] for row in csv.DictReader(file)]
        tap.equal(drawn, 40 * ["[2, 400, 40]"], "a field with commas")
        for name in ("trial.csv", "trial.json", "trial.png"):
            for other in ("merged", "cut"):
                tap.equal(data(folder, other, name), data(folder, "whole", name), f"{other}/{name}")
        tap.equal(sorted(os.listdir(folder / "cut")), ["trial.csv", "trial.json", "trial.png"])
        asdic("trial", path, "--runs", 20, *vary, "-o", folder / "cut", "--resume").check(code=0) # nothing is left
        for options in (("--runs", 21), ("--runs", 20, "--seed", 2), ("--runs", 20, "--shard", "1/2")):
            done = asdic("trial", path, *options, *vary, "-o", folder / "cut", "--resume").check(code=1)
            tap.contains(done.err, "holds another trial")
        done = asdic("merge", folder / "part1", folder / "part3", "-o", folder / "gap").check(code=3)
        tap.contains(done.err, "runs 6 to 12 are in no part")
        for some, lacking in (("23", "0 to 5"), ("12", "13 to 19")):
            done = asdic("merge", *(folder / f"part{k}" for k in some), "-o", folder / "gap").check(code=3)
            tap.contains(done.err, f"runs {lacking} are in no part")
        asdic("trial", path, "--runs", 20, "-o", folder / "whole").check(code=1)


HILLS = """ncols 30
nrows 30
xllcorner -30
yllcorner -30
cellsize 5
"""


def test_terrain_is_kept_from_run_to_run():
    """Objects drawn over a bottom of triangles: a worker that flies all runs, and keeps the bottom, writes
    what workers write that fly one run each and build it anew; also where sound bends, for which the bottom is
    lifted."""
    program.need_device()
    waters = ("", "environment: {sound_speed_gradient_per_s: -0.5}\n",
              "environment: {sound_speed_profile: cast.csv}\n")
    with Folder() as folder:
        heights = "\n".join(" ".join("%.3f" % (18 + math.sin(0.7 * i) * math.cos(0.4 * k))
                                      for k in range(30)) for i in range(30))
        folder.write("hills.asc", HILLS + heights + "\n")
        folder.write("cast.csv", "depth_m,sound_speed_mps\n0,1510\n8,1508\n12,1490\n")
        scene = WALL.replace("depth_m: 20", "grid: {file: hills.asc, values: depths}").replace(
            "time_s: 45", "time_s: 8") + """  draws:
    - {key: 'objects[0].position_m[0]', uniform: [20, 160]}
    - {key: 'objects[0].box.size_m[2]', uniform: [10, 40]}
    - {key: 'mission.waypoints.points_m[0][2]', uniform: [9, 11]}
    - {key: environment.wind_speed_kn, uniform: [0, 20]}
"""
        for i, water in enumerate(waters):
            path = folder.write("hills.yaml", water + scene)
            asdic("trial", path, "--runs", 2, "--workers", 1, "-o", folder / f"one{i}").check(code=0)
            for k in (1, 2):
                asdic("trial", path, "--runs", 2, "--shard", f"{k}/2", "-o", folder / f"part{i}{k}").check(code=0)
            asdic("merge", *(folder / f"part{i}{k}" for k in (1, 2)), "-o", folder / f"all{i}").check(code=0)
            tap.equal(data(folder, f"all{i}", "trial.csv"), data(folder, f"one{i}", "trial.csv"))


def test_folders_have_the_names_of_their_scenes():
    with Folder() as folder:
        folder.write("wall.yaml", CLOSE.replace("PD", "1"))
        for options in (), ("--shard", "2/3"):
            asdic("trial", "wall.yaml", "--runs", 3, *options, cwd=folder.path).check(code=0)
        tap.equal(folder.names(), ["trial_wall", "trial_wall_2_of_3", "wall.yaml"], "folders")


def test_parts_are_of_one_trial():
    """Whatever differs in the section `trial`, or in the values of a key of it, parts are not joined."""
    base = IDEAL.replace("PD", "0.1") + "  draws: [{key: 'objects[0].position_m[0]', uniform: [59, 65]}]\n"
    vary = ("--vary", "trial.rule.turn_deg=30,60")
    others = [(base.replace(a, b), vary) for a, b in (("pd: 0.1", "pd: 0.2"), ("pd: 0.1", "pd: 0.1, pfa: 0.1"),
                                                      ("time_s: 45", "time_s: 20"), ("59, 65", "59, 66"),
                                                      ("reach_m: 20", "reach_m: 20, sector_deg: 30"))]
    others += [(base, ("--vary", "trial.rule.turn_deg=30,90")), (base, ("--vary", "trial.rule.climb_m=30,60"))]
    with Folder() as folder:
        path = folder.write("one.yaml", base)
        asdic("trial", path, "--runs", 2, *vary, "--shard", "1/2", "-o", folder / "one").check(code=0)
        for i, (text, option) in enumerate(others):
            asdic("trial", folder.write("one.yaml", text), "--runs", 2, *option, "--shard", "2/2", "-o",
                  folder / f"two{i}").check(code=0)
            done = asdic("merge", folder / "one", folder / f"two{i}", "-o", folder / "all").check(code=3)
            tap.contains(done.err, "these are parts of different trials")
            tap.equal(os.path.exists(folder / "all"), False, "a folder of nothing")


def test_several_devices_give_the_same_bytes():
    """Runs dealt to two kinds of PoCL's devices, and to workers that share one."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("wall.yaml", WALL.replace("time_s: 45", "time_s: 12") + """  draws:
    - {key: 'objects[0].position_m[0]', uniform: [20, 65]}
""")
        for name, options, devices in (("one", ("--device", "0:0", "--workers", 1), "pthread"),
                                       ("three", ("--device", "0:0", "--workers", 3), "pthread"),
                                       ("two", ("--device", "all", "--workers", 2), "pthread basic"),
                                       ("list", ("--device", "0:1,0:0"), "pthread basic")):
            asdic("trial", path, "--runs", 5, *options, "-o", folder / name,
                  POCL_DEVICES=devices).check(code=0)
            for file in ("trial.csv", "trial.json", "trial.png"):
                tap.equal(data(folder, name, file), data(folder, "one", file), f"{name}/{file}")


def test_rays_by_a_tolerance():
    """A finer tolerance takes more rays; a trial with them is that with as many --rays."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("wall.yaml", WALL.replace("time_s: 45", "time_s: 5"))
        rays = []
        for tolerance in (0.5, 3):
            few = ("trial", path, "--runs", 2, "--workers", 1)
            done = asdic(*few, "--tolerance", tolerance, "-o", folder / "out", "-f").check(code=0)
            tap.lacks(done.err, "do not keep")
            rays.append(json.loads(folder.read("out/trial.json"))["rays"])
            asdic(*few, "--rays", rays[-1], "-o", folder / "same", "-f").check(code=0)
            tap.equal(data(folder, "same", "trial.csv"), data(folder, "out", "trial.csv"))
        assert rays[0] > rays[1] >= 1024, rays
        # Where the bottom is in the way, too: from 30 m on it is above the vehicle.
        rise = "".join(("5 " if north_m > 30 else "20 ") * 3 + "\n" for north_m in range(90, -20, -10))
        folder.write("rise.asc", "ncols 3\nnrows 11\nxllcorner -15\nyllcorner -15\ncellsize 10\n" + rise)
        path = folder.write("rise.yaml", WALL.replace("depth_m: 20", "grid: {file: rise.asc, values: depths}")
                            .replace("[60, 0, 10]", "[200, 0, 10]").replace("time_s: 45", "time_s: 5"))
        asdic("trial", path, "--runs", 2, "--tolerance", 3, "-o", folder / "rise").check(code=0)
        asdic("trial", path, "--runs", 1, "--rays", 500, "--tolerance", 20, "-o", folder / "x").check(code=0)
        tap.equal(json.loads(folder.read("x/trial.json"))["rays"], 500, "rays, where --rays keeps the tolerance")
        path = folder.write("quiet.yaml", WALL.replace("time_s: 45", "time_s: 1").replace("db: 200", "db: 20"))
        done = asdic("trial", path, "--runs", 1, "--tolerance", 3, "-o", folder / "quiet").check(code=0)
        tap.contains(done.err, "tolerance 3 dB: no bin is above the noise along the way of run 0, so that none can keep it; "
                               "the search ends at its first 1024 rays per ping")


def test_rays_of_its_own_choice():
    """As few as leave no rough pings: 4,096 for one wide beam, more for a fan of narrow beams and short bins."""
    program.need_device()
    fan = ", ".join(f"{{name: b{k}, yaw_deg: {0.4 * (k - 79.5):.1f}, length_h_m: 0.2, length_v_m: 0.02}}"
                    for k in range(160))
    quick = WALL.replace("sampling: {rays: 1000}\n", "").replace("time_s: 45", "time_s: 1")
    fine = quick.replace("bin_length_m: 0.5", "bandwidth_khz: 40\n  bin_length_m: 0.05").replace(
        "{name: forward, length_h_m: 0.05, length_v_m: 0.05}", fan)
    with Folder() as folder:
        found = []
        for name, text in (("one", quick), ("fan", fine)):
            asdic("trial", folder.write(name + ".yaml", text), "--runs", 1, "--replay", 0, "-o",
                  folder / name).check(code=0)
            facts = json.loads(folder.read(name + "/run.json"))
            found.append((facts["rays"], facts["stderr_db"]["rms"]))
        print("# rays, stated error:", found)
        tap.equal(found[0][0], 4096)
        tap.equal(found[1][0] in (8192, 16384, 32768, 65536) and found[1][1] < 1.6, True, f"{found}")


def test_several_processes():
    if os.environ["ASDIC_MPI"] != "1" or not shutil.which("mpirun"):
        raise tap.Skip("no MPI")
    root = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    with Folder() as folder:
        path = folder.write("wall.yaml", IDEAL.replace("PD", "0.1"))
        asdic("trial", path, "--runs", 11, "-o", folder / "alone").check(code=0)
        done = subprocess.run(["mpirun", "-n", "3", "--bind-to", "none", "--oversubscribe", program.PATH,
                               "trial", path, "--runs", "11", "-o", folder / "team"], check=False,
                              capture_output=True, timeout=100, env=program.environment(root))
        tap.equal(done.returncode, 0, done.stderr)
        for name in ("trial.csv", "trial.json", "trial.png"):
            tap.equal(data(folder, "team", name), data(folder, "alone", name), name)
        tap.equal(sorted(os.listdir(folder / "team")), ["trial.csv", "trial.json", "trial.png"])
        # What two processes left goes on with three: the part has a row that none of them would fly.
        os.mkdir(folder / "team2")
        asdic("trial", path, "--runs", 11, "--shard", "2/2", "-o", folder / "team2/part_5_11").check(code=0)
        folder.write("team2/part_5_11/trial.csv", re.sub(r"^9,0,.*", "9,0,clear,,,7,7,7,7,0,0,",
                                                         folder.read("team2/part_5_11/trial.csv"), flags=re.MULTILINE))
        done = subprocess.run(["mpirun", "-n", "3", "--bind-to", "none", "--oversubscribe", program.PATH,
                               "trial", path, "--runs", "11", "--resume", "-o", folder / "team2"], check=False,
                              capture_output=True, timeout=100, env=program.environment(root))
        tap.equal(done.returncode, 0, done.stderr)
        flown, alone = (folder.read(name + "/trial.csv").splitlines() for name in ("team2", "alone"))
        tap.equal(flown, [*alone[:10], "9,0,clear,,,7,7,7,7,0,0,", alone[11]], "rows")
        tap.equal(sorted(os.listdir(folder / "team2")), ["trial.csv", "trial.json", "trial.png"])
        # A run again is one process's: the others, here in a folder of their own, write nothing.
        os.mkdir(folder / "other")
        apart = f'cd {folder.path} && test "$OMPI_COMM_WORLD_RANK" = 0 || cd other; exec {program.PATH} "$@"'
        done = subprocess.run(["mpirun", "-n", "2", "--bind-to", "none", "--oversubscribe", "sh", "-c", apart, "sh",
                               "trial", path, "--replay", "3", "-o", "again"], check=False,
                              capture_output=True, timeout=100, env=program.environment(root))
        tap.equal(done.returncode, 0, done.stderr)
        tap.equal((os.path.exists(folder / "again/track.csv"), os.listdir(folder / "other")), (True, []))


def test_changed_files_are_another_trial():
    """A mesh, or a sonar that only some runs draw, or a design has: rows of the one are not those of the other."""
    with Folder() as folder:
        sides = ("v 0 0 0\nv 0 9 0\nv 0 9 9\nf 1 2 3\n", "v 0 0 0\nv 0 8 0\nv 0 8 8\nf 1 2 3\n")
        sonar = "{frequency_khz: %d, ping_rate_hz: 1, receivers: [{name: a}]}\n"
        scene = IDEAL.replace("PD", "0.1").replace("box: {size_m: [2, 400, 40]}", "mesh: {file: wall.obj}")
        scene += "  draws: [{key: sonar.file, choice: [a.yaml, b.yaml]}]\n"
        path = folder.write("wall.yaml", scene)
        before = {"wall.obj": sides[0], "other.obj": sides[0], "a.yaml": sonar % 100, "b.yaml": sonar % 100}
        after = {"wall.obj": sides[1], "other.obj": sides[1], "a.yaml": sonar % 200, "b.yaml": sonar % 200}
        for name, text in before.items():
            folder.write(name, text)
        command = ("trial", path, "--runs", 4, "--vary", "objects[0].mesh.file=wall.obj,other.obj", "-o",
                   folder / "out")
        asdic(*command).check(code=0)
        asdic(*command, "--resume").check(code=0)
        for name, text in before.items():
            folder.write(name, after[name])
            done = asdic(*command, "--resume").check(code=1)
            tap.contains(done.err, "holds another trial: scene or its files, seed")
            folder.write(name, text)
        asdic(*command, "--resume").check(code=0)


def test_a_scene_edited_meanwhile_is_not_flown_on():
    """Rows are of one scene; put back it goes on, to the same bytes. A rule edits it in the first run."""
    program.need_device()
    with Folder() as folder:
        text = WALL.replace("time_s: 45", "time_s: 3")
        path = folder.write("wall.yaml", text)
        folder.write("rule.py", f"""
import sys
for line in sys.stdin:
    with open({folder / "then.yaml"!r}, encoding="ascii") as then, open({path!r}, "w", encoding="ascii") as file:
        file.write(then.read())
    print("{{}}", flush=True)
""")
        def command(then, out):
            folder.write("then.yaml", text.replace("time_s: 3", then))
            return ("trial", path, "--runs", 3, "--workers", 1, "-o", folder / out, "--rule",
                    f"exec {sys.executable} {folder / 'rule.py'}")
        done = asdic(*command("time_s: 2", "out")).check(code=3)
        tap.contains(done.err, "wall.yaml has changed since its trial began")
        tap.equal(len(data(folder, "out", "trial.part.csv").splitlines()), 2)
        folder.write("wall.yaml", text)
        asdic(*command("time_s: 3", "out"), "--resume").check(code=0)
        asdic(*command("time_s: 3", "whole")).check(code=0)
        tap.equal(data(folder, "out", "trial.csv"), data(folder, "whole", "trial.csv"))


def test_a_disk_that_is_full_ends_a_trial():
    """At once, for the reason that there is; what was flown is kept, what it was to replace is not."""
    with Folder() as folder:
        path = folder.write("wall.yaml", IDEAL.replace("PD", "0.1"))
        whole = asdic("trial", path, "--runs", 300, "-o", folder / "whole").check(code=0)
        asdic("trial", path, "--runs", 3, "-o", folder / "out").check(code=0)
        done = subprocess.run([program.PATH, "trial", path, "--runs", "300", "-o", folder / "out", "--force"],
                              capture_output=True, text=True, check=False, preexec_fn=lambda: resource.setrlimit(
                                  resource.RLIMIT_FSIZE, (6000, 6000)))  # fmt: skip
        tap.equal(done.returncode, 1, done.stderr)
        tap.contains(done.stderr, "error: cannot write 'trial.part.csv': File too large")
        with open(folder / "out/trial.part.csv", "rb") as file:
            tap.equal(len(file.read()), 6000, "what is kept")
        asdic("trial", path, "--runs", 300, "-o", folder / "out", "--resume").check(code=0)
        tap.equal(folder.read("out/trial.csv") == folder.read("whole/trial.csv"), True, whole.err)


def test_a_disk_that_is_full_at_the_end_loses_no_run():
    """Not even where nothing but trial.json has no room any more."""
    with Folder() as folder:
        path = folder.write("wall.yaml", IDEAL.replace("PD", "0.1"))
        asdic("trial", path, "--runs", 9, "-o", folder / "whole").check(code=0)
        os.makedirs(folder / "out/trial.json.part")
        done = asdic("trial", path, "--runs", 9, "-o", folder / "out").check(code=1)
        tap.contains(done.err, "cannot write")
        with open(folder / "out/trial.part.csv", "rb") as file:
            tap.equal(file.read(), data(folder, "whole", "trial.csv"), "what is kept")
        os.rmdir(folder / "out/trial.json.part")
        asdic("trial", path, "--runs", 9, "-o", folder / "out", "--resume").check(code=0)
        tap.equal(sorted(os.listdir(folder / "out")), sorted(os.listdir(folder / "whole")))
        for name in ("trial.csv", "trial.json"):
            tap.equal(data(folder, "out", name), data(folder, "whole", name), name)


tap.main(globals())
