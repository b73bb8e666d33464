"""Run folders that were damaged: nothing wrong is read without a word, and --resume makes whole again
what it can. With the argument 'full', hundreds of mutations instead of a few (ASDIC_MUTATIONS)."""
import os
import random
import re
import resource
import shutil
import socket
import subprocess
import sys

import program
import tap
from program import Folder, asdic
from run_folder import data, edit_facts, facts, flip, pictures, same, scene

FULL = "full" in sys.argv and not sys.argv.remove("full")
MUTATIONS = int(os.environ.get("ASDIC_MUTATIONS", "400" if FULL else "16"))

WORLD = """
version: 1
bottom: {grid: {file: floor.asc}, type: sand}
objects:
  - name: ball
    sphere: {radius_m: 1}
    position_m: [20, 0, 6]
    material: {impedance_mrayl: 45, roughness_rms_mm: 1, slope_rms: 0.1}
  - name: diver
    sphere: {radius_m: 0.5}
    track: diver.csv
    material: {impedance_mrayl: 45, roughness_rms_mm: 1, slope_rms: 0.1}
sonar:
  frequency_khz: 100
  ping_rate_hz: 20
  source_level_db: 200
  bin_length_m: 1
  receivers:
    - {name: forward}
    - {name: down, pitch_deg: 45}
mission: {track: track.csv}
sampling: {rays: 500, seed: 7}
output: {npy: true, images: [waterfall, ascope, overview, plan]}
"""


FAN = "\n".join(f"    - {{name: b{k}, yaw_deg: {20 * k - 20}}}" for k in range(3))


def world(folder):
    """A scene with every file that a run folder may hold."""
    rows = "\n".join(" ".join(str(round(14 + 0.1 * ((i * k) % 7), 1)) for k in range(31))
                     for i in range(31))
    folder.write("floor.asc", "ncols 31\nnrows 31\nxllcenter -30\nyllcenter -30\n"
                 f"cellsize 2\nNODATA_value -9999\n{rows}\n")
    folder.write("track.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                 "0,0,0,5,0,0,0\n0.55,1,0.5,5,0,0,0\n")
    folder.write("diver.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                 "0,15,3,6,0,0,0\n0.55,16,2,6,0,0,0\n")
    return folder.write("pool.yaml", WORLD)


def test_a_bad_ping_is_named_and_made_again():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=12, rays=500, receivers=FAN)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        shutil.copytree(folder / "whole", folder / "r")
        size = os.path.getsize(folder / "r/pings.npy")
        each = (size - 10 - int.from_bytes(data(folder, "r", "pings.npy")[8:10], "little")) // 12
        for ping, byte in ((5, each // 2), (9, each - 3)):
            flip(folder / "r/pings.npy", size - (12 - ping) * each + byte)
        shutil.copytree(folder / "whole", folder / "kept")
        for command in (("merge", folder / "r", "-o", folder / "m"), ("render", folder / "r"),
                        ("merge", folder / "r", "-o", folder / "kept", "--force"), ("detect", folder / "r", "--background", "flat"),
                        ("render", folder / "r", "--mosaic", folder / "m.png")):
            err = asdic(*command).check(code=3).err
            tap.contains(err, "pings.npy' is damaged: ping 5 is not as it was written")
            tap.contains(err, "; 'asdic run' with --resume mends the run")
        same(folder, "whole", "kept")  # a part that is damaged costs no earlier result
        err = asdic("run", path, "-o", folder / "r", "--resume").check(code=0).err
        tap.equal(err.count("ping 5 is not as it was written; made again"), 1)
        tap.lacks(err, "'asdic run' with --resume")
        tap.contains(err, "1 more of its pings are damaged")
        same(folder, "whole", "r")
        os.unlink(folder / "r/levels.npy")
        flip(folder / "r/waterfall_b1.png", 3000)
        flip(folder / "r/bins.csv", 3000)
        for said in (f"'{folder / 'r'}/bins.csv', '{folder / 'r'}/levels.npy', '{folder / 'r'}/waterfall_b1.png' "
                     "are missing or damaged", "complete already"):
            err = asdic("run", path, "-o", folder / "r", "--resume").check(code=0).err
            tap.contains(err, said)
        same(folder, "whole", "r")


def test_complete_runs_are_checked():
    program.need_device()
    with Folder() as folder:
        path = world(folder)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        names = [n for n in os.listdir(folder / "whole") if n != "run.json"]
        tap.equal({"routes.csv", "objects.csv", "terrain.asc"} <= set(names), True, "files")
        shutil.copytree(folder / "whole", folder / "r")
        for number, name in enumerate(names):
            if number % 2:
                os.unlink(f"{folder / 'r'}/{name}")
            else:
                os.truncate(f"{folder / 'r'}/{name}", 30)
            err = asdic("run", path, "-o", folder / "r", "--resume").check(code=0).err
            tap.contains(err, f"{name}'")
            tap.lacks(err, "complete already")
            same(folder, "whole", "r")
        tap.contains(asdic("run", path, "-o", folder / "r", "--resume").check(code=0).err,
                     "complete already")
        lost = sorted(set(names) - {"pings.npy"})
        for name in lost:
            os.unlink(f"{folder / 'r'}/{name}")
        err = asdic("run", path, "-o", folder / "r", "--resume").check(code=0).err
        tap.equal((err.count(f"'{folder / 'r'}/"), f" and {len(lost) - 5} more are missing or damaged" in err),
                  (5, True), err)
        same(folder, "whole", "r")
        # Pictures that render drew in another way are whole, too.
        asdic("render", folder / "r", "--colormap", "gray").check(code=0)
        tap.contains(asdic("run", path, "-o", folder / "r", "--resume").check(code=0).err,
                     "complete already")
        text = data(folder, "r", "run.json")
        for at in range(10, len(text), 211):
            flip(folder / "r/run.json", at)
            tap.contains(asdic("render", folder / "r").check(code=3).err, "run.json' is damaged, or of another version")
            flip(folder / "r/run.json", at)
        edit_facts(folder, "r", '"seed": 7', '"seed": 8')
        tap.contains(asdic("run", path, "-o", folder / "r", "--resume").check(code=1).err, "seed")
        tap.equal(facts(folder, "r")["seed"], 8, "the other run's")
        for wrong in ("8.5", "8x", "-8", "9" * 25):  # another program's, with a sum that is right
            edit_facts(folder, "r", '"seed": 8', f'"seed": {wrong}')
            tap.contains(asdic("render", folder / "r").check(code=3).err, "run.json' is damaged")
            edit_facts(folder, "r", f'"seed": {wrong}', '"seed": 8')
        # What an older program did not write counts as none.
        for key in "terms", "remarks", "files", "pictures":
            edit_facts(folder, "r", f'"{key}":', f'"no_{key}":')
        asdic("render", folder / "r").check(code=0)


# --- what somebody has put where files are written --------------------------------------------------

def obstacle(kind, path, precious):
    if kind == "link":
        os.symlink(precious, path)
    elif kind == "hard link":
        os.link(precious, path)
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        with socket.socket(socket.AF_UNIX) as listener:
            listener.bind(path)


def quick(*command):
    """As asdic, but a command that waits is a failure."""
    return subprocess.run([program.PATH, *map(str, command)], capture_output=True, text=True,
                          check=False, timeout=60)


def test_what_is_no_runs_stays():
    """A track beside its scene has the name of one that a run writes."""
    program.need_device()
    with Folder() as folder:
        text = re.sub(r"mission:.*", "mission: {track: track.csv}", open(scene(folder, pings=2, rays=64)).read())
        track = "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,7,0,0,0\n2,2,0,7,0,0,0\n"
        path = folder.write("pool.yaml", text)
        folder.write("track.csv", track)
        done = asdic("run", path, "-o", folder.path).check(code=1)
        tap.contains(done.err, "holds 'track.csv', which a run may write there")
        tap.equal(sorted(folder.names()), ["pool.yaml", "track.csv"])
        asdic("run", path, "-o", folder / "r").check(code=0)
        folder.write("plan.png", "a plan of mine")
        os.unlink(folder / "track.csv")
        tap.contains(asdic("merge", folder / "r", "-o", folder.path).check(code=1).err, "holds 'plan.png'")
        tap.equal(folder.read("plan.png"), "a plan of mine")
        # What is left of a run whose records are gone is not the next one's.
        os.mkdir(folder / "left")
        for name in ("terrain.asc", "routes.csv", "truth.npy"):
            folder.write("left/" + name, "of another scene")
        folder.write("track.csv", track)
        asdic("run", folder / "pool.yaml", "-o", folder / "left").check(code=1)
        asdic("run", folder / "pool.yaml", "-o", folder / "left", "--force").check(code=0)
        tap.equal(sorted(os.listdir(folder / "left")), sorted(os.listdir(folder / "r")), "files")


def test_obstacles_are_replaced():
    program.need_device()
    with Folder() as folder:
        precious = folder.write("precious", "precious")
        path = scene(folder, pings=2, rays=64)
        text = folder.read("pool.yaml")
        netcdf = asdic("run", folder.write("n.yaml", text.replace("npy: true", "netcdf: true")), "-o",
                       folder / "n").code == 0
        if netcdf:
            folder.write("pool.yaml", text.replace("npy: true", "npy: true, netcdf: true"))
        asdic("run", path, "-o", folder / "part").check(code=0)
        asdic("detect", folder / "part").check(code=0)
        names = sorted(os.listdir(folder / "part"))
        for kind in ("link", "hard link", "pipe", "socket"):
            os.mkdir(folder / "r")
            for name in names:
                if name != "pings.npy":  # it would make the folder one that holds a run
                    obstacle(kind, f"{folder / 'r'}/{name}.part", precious)
            for command in (("run", path, "-o", folder / "r"), ("render", folder / "r"),
                            ("detect", folder / "r"),
                            ("merge", folder / "part", "-o", folder / "r", "--force")):
                done = quick(*command)
                tap.equal((done.returncode, folder.read("precious")), (0, "precious"),
                          f"{command[0]} past a {kind} ({done.stderr})")
                for name in names:
                    if not os.path.lexists(f"{folder / 'r'}/{name}.part") and name != "pings.npy":
                        obstacle(kind, f"{folder / 'r'}/{name}.part", precious)
            shutil.rmtree(folder / "r")
        # What a run adds to must be its own.
        shutil.copytree(folder / "part", folder / "r")
        os.link(folder / "r/pings.npy", folder / "copy")
        os.truncate(folder / "r/bins.csv", 5)
        tap.contains(asdic("run", path, "-o", folder / "r", "--resume").check(code=1).err, "is a link")
        os.unlink(folder / "copy")
        os.unlink(folder / "r/pings.npy")
        os.mkfifo(folder / "r/pings.npy")
        tap.equal(quick("render", folder / "r").returncode, 3, "a pipe of records")
        err = asdic("merge", folder / "part", "-o", folder / "r").check(code=1).err
        tap.contains(err, "--force")
        tap.lacks(err, "--resume")


def test_full_disk_loses_nothing():
    """Files of at most so many bytes: one sentence, whole files or none, and the parts as they were."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=40, rays=200)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        asdic("detect", folder / "whole").check(code=0)
        shutil.copytree(folder / "whole", folder / "r")
        for room in (0, 500, 5000, 60000):
            for command in (("merge", folder / "whole", "-o", folder / "m"), ("render", folder / "r"),
                            ("detect", folder / "r", "--force")):
                done = subprocess.run(
                    [program.PATH, *command], capture_output=True, text=True, check=False,
                    preexec_fn=lambda n=room: resource.setrlimit(resource.RLIMIT_FSIZE, (n, n)))
                fails = room < 5000 or done.returncode != 0  # what detect writes is small
                errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
                tap.equal((done.returncode, len(errors)), (1, 1) if fails else (0, 0), done.stderr)
                tap.equal("File too large" in done.stderr, fails, done.stderr)
                tap.equal(os.path.exists(folder / "m/pings.npy.part"), False, "a part left over")
            same(folder, "whole", "r")
        asdic("merge", folder / "whole", "-o", folder / "m", "--force").check(code=0)


# --- several processes -------------------------------------------------------------------------------

def test_many_starts_one_run():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=6, rays=500)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        for option in ([], ["--force"], ["--resume"]):
            children = [subprocess.Popen([program.PATH, "run", path, "-o", folder / "r", *option],
                                         stderr=subprocess.PIPE, text=True) for _ in range(4)]
            ends = [(child.communicate()[1], child.returncode) for child in children]
            tap.equal(0 in [code for _, code in ends], True, f"one is through ({ends})")
            for err, code in ends:
                if code != 0:
                    tap.equal(bool(re.search("another process is writing to|"
                                             "holds a run already", err)), True, err)
            same(folder, "whole", "r")
        for command in (["render", folder / "r"], ["merge", folder / "whole", "-o", folder / "r",
                                                   "--force"]):
            children = [subprocess.Popen([program.PATH, *command], stderr=subprocess.PIPE, text=True)
                        for _ in range(4)]
            for child in children:
                err = child.communicate()[1]
                tap.equal(child.returncode == 0 or "another process is writing" in err, True, err)
            same(folder, "whole", "r")


# --- mutations ---------------------------------------------------------------------------------------

def mutate(path, luck):
    """Damages the file PATH in one of the ways in which files are damaged; says how."""
    with open(path, "rb") as file:
        old = file.read()
    way = luck.choice(["bit", "bit", "bit", "byte", "zeros", "cut", "longer", "moved", "gone"])
    at, new = luck.randrange(len(old)), bytearray(old)
    if way == "bit":
        new[at] ^= 1 << luck.randrange(8)
    elif way == "byte":
        new[at] = luck.randrange(256)
    elif way == "zeros":
        new[at:at + 64] = bytes(len(new[at:at + 64]))
    elif way == "cut":
        del new[at:]
    elif way == "longer":
        new += bytes(luck.randrange(256) for _ in range(luck.randrange(1, 100)))
    elif way == "moved":
        to = luck.randrange(len(old))
        new[at:at + 16], new[to:to + 16] = old[to:to + 16], old[at:at + 16]
    os.unlink(path)  # not through a link
    if way != "gone":
        with open(path, "wb") as file:
            file.write(new)
    return f"{os.path.basename(path)} {way} {at}"


def content(folder, run, names):
    return {name: data(folder, run, name) for name in names
            if os.path.exists(os.path.join(folder.path, run, name))}


def test_mutations_make_no_silent_errors():
    """Each command either fails or gives what it gives without the damage."""
    program.need_device()
    luck = random.Random(23)
    with Folder() as folder:
        path = world(folder)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        asdic("detect", folder / "whole").check(code=0)
        names = sorted(os.listdir(folder / "whole"))
        found = ["detections.csv", "tracks.csv", "occupancy.png"]
        outputs = [n for n in names if n not in ("run.json", "background.npy", *found)]
        commands = [(("merge", folder / "r", "-o", folder / "m", "-f"), "m", outputs),
                    (("render", folder / "r"), "r", [n for n in pictures(folder, "whole") if n not in found]),
                    (("detect", folder / "r", "--force"), "r", found),
                    (("run", path, "-o", folder / "r", "--resume"), "r", outputs)]
        # Pictures and tables are not read back: there is little to find.
        read = [n for n in names if n in ("pings.npy", "run.json", "terrain.asc", "objects.csv",
                                          "routes.csv", "track.csv", "background.npy")]
        silent, told = [], {}
        for number in range(MUTATIONS):
            shutil.rmtree(folder / "r", ignore_errors=True)
            shutil.copytree(folder / "whole", folder / "r")
            name = luck.choice(read if luck.random() < 0.8 else names)
            damage = mutate(f"{folder / 'r'}/{name}", luck)
            # A few in the default tier: one command each, in turn.
            for command, run, compared in commands if FULL else [commands[number % 4]]:
                done = asdic(*command)
                tap.equal(done.code in (0, 1, 3), True, f"{damage}: {command[0]} ({done.err})")
                told[command[0], done.code] = told.get((command[0], done.code), 0) + 1
                if done.code == 0 and content(folder, run, compared) != \
                        content(folder, "whole", compared):
                    silent.append(f"{damage}: {command[0]}")
        counts = ", ".join(f"{c} exit {code}: {n}" for (c, code), n in sorted(told.items()))
        print(f"# {MUTATIONS} mutations, {len(silent)} silent errors ({counts})")
        tap.equal(silent, [], "silent errors")


tap.main(globals())
