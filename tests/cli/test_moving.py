"""Objects that move along tracks of their own: where they are heard, in whatever parts it is run."""
import csv
import json
import os
import re
import zlib

import program
import tap
from program import Folder, asdic
from run_folder import data, edit_facts, facts, same, scene

# The ball comes nearer by 2 m a second and sinks; the pings are 0.05 s apart.
BALL_TRACK = """time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg
0,20,0,6,0,0,0
2,16,1,8,0,0,40
"""
FISH = """  - name: fish
    point: -30
    track: fish.csv
sonar:"""


def moving(folder, pings=40, rays=2000):
    """pool.yaml with its ball on a track and a fish beside it; returns its path."""
    text = folder.read(scene(folder, pings=pings, rays=rays).rsplit("/", 1)[1])
    folder.write("ball.csv", BALL_TRACK)
    folder.write("fish.csv", BALL_TRACK.replace("20,0,6", "9,-3,6").replace("16,1,8", "11,3,4"))
    return folder.write("moving.yaml", text.replace("position_m: [20, 0, 6]", "track: ball.csv")
                        .replace("sonar:", FISH))


def levels(folder, run, ping, column="object_db"):
    rows = csv.DictReader(data(folder, run, "bins.csv").decode().splitlines())
    return [float(row[column] or "nan") for row in rows if row["ping"] == str(ping)]


def test_every_ping_is_that_of_a_scene_with_the_object_there():
    program.need_device()
    with Folder() as folder:
        path = moving(folder)
        asdic("run", path, "-o", folder / "moving").check(code=0)
        text = folder.read("moving.yaml")
        # Pings that the sampling is learnt for agree but for rounding, by which a ray may pass an edge on
        # its other side: far less than the stated errors. Others, for which the scene at rest is learnt
        # with the ball elsewhere, agree within those.
        for ping, rounding, errors in ((0, 2e-3, 0), (32, 2e-3, 0.1), (39, 2e-3, 6)):
            share = ping / 40
            ball = [20 - 4 * share, share, 6 + 2 * share]
            fish = [9 + 2 * share, -3 + 6 * share, 6 - 2 * share]
            still = folder.write("still.yaml", text.replace(
                "track: ball.csv", f"position_m: {ball}\n    rotation_deg: [0, 0, {40 * share}]")
                .replace("track: fish.csv", f"position_m: {fish}"))
            asdic("run", still, "--pings", ping, "-o", folder / f"still{ping}").check(code=0)
            runs = [(levels(folder, run, ping), levels(folder, run, ping, "stderr_db"))
                    for run in ("moving", f"still{ping}")]
            for n, (a, b, s, r) in enumerate(zip(runs[0][0], runs[1][0], runs[0][1], runs[1][1])):
                tap.equal(a == a, b == b, f"ping {ping}: energy in the same bins")
                if abs(a - b) > rounding + errors * (s + r):
                    raise AssertionError(f"ping {ping}, row {n}: {a} dB moved, {b} dB at rest")
        nearest = [min(n for n, level in enumerate(levels(folder, "moving", ping)) if level > 60)
                   for ping in (0, 39)]
        if not nearest[0] != nearest[1]:
            raise AssertionError(f"nothing moved: first echo in bins {nearest}")


COMING = """version: 1
bottom: {depth_m: 200}
objects: [{name: fish, point: -20, track: fish.csv}]
sonar: {frequency_khz: 100, ping_rate_hz: 1, source_level_db: 200, max_range_m: 60, receivers: [{name: ahead}]}
mission: {pose: {position_m: [0, 0, 10]}, pings: 12}
sampling: {rays: 1000}
output: {records: compact, images: []}
"""



def test_what_floats_may_have_its_middle_above_the_surface():
    """As an object that stays may; a vehicle's depth is never negative."""
    program.need_device()
    with Folder() as folder:
        path = moving(folder, pings=1)
        folder.write("ball.csv", BALL_TRACK.replace("20,0,6", "12,0,-0.3").replace("16,1,8", "12,1,-0.3"))
        asdic("run", path, "-o", folder / "floats").check(code=0)
        path = folder.write("stays.yaml", folder.read("moving.yaml").replace("track: ball.csv", "position_m: [12, 0, -0.3]"))
        asdic("run", path, "-o", folder / "stays").check(code=0)
        floats, stays = levels(folder, "floats", 0), levels(folder, "stays", 0)
        heard = [(a, b) for a, b in zip(floats, stays) if b == b]
        tap.equal(len(heard) > 0 and all(abs(a - b) < 0.01 for a, b in heard), True, f"{heard}")

def test_a_point_that_comes_from_afar_is_planned_for():
    """It is out of range at the first ping: records that leave out what no ping can have keep its levels all the same."""
    program.need_device()
    with Folder() as folder:
        folder.write("fish.csv", BALL_TRACK.replace("20,0,6", "900,0,10").replace("2,16,1,8", "10,20,0,10"))
        path = folder.write("coming.yaml", COMING)
        tap.contains(asdic("plan", path).check(code=0).out, "1 of 1 come within range")
        asdic("run", path, "-o", folder / "r").check(code=0)
        heard = [max([v for v in levels(folder, "r", ping) if v == v], default=0) > 120 for ping in range(12)]
        tap.equal(heard, [False] * 10 + [True] * 2)


def test_parts_and_devices_do_not_change_a_byte():
    program.need_device()
    with Folder() as folder:
        path = moving(folder, pings=70, rays=1000)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        asdic("run", path, "-o", folder / "two", "--device", "all",
              POCL_DEVICES="pthread basic").check(code=0)
        same(folder, "whole", "two")
        for k in (1, 2, 3):
            asdic("run", path, "--shard", f"{k}/3", "-o", folder / f"part{k}").check(code=0)
        asdic("merge", "part3", "part1", "part2", "-o", "joined", cwd=folder.path).check(code=0)
        same(folder, "whole", "joined")
        asdic("render", folder / "joined").check(code=0)
        same(folder, "whole", "joined")
        folder.write("fish.csv", folder.read("fish.csv").replace("11,3", "11,2"))
        asdic("run", path, "--shard", "3/3", "-o", folder / "part3", "--force").check(code=0)
        done = asdic("merge", "part3", "part1", "part2", "-o", "other", cwd=folder.path)
        tap.contains(done.check(code=3).err, "differ in their mesh, grid or track")


def test_routes_are_kept_and_drawn():
    program.need_device()
    with Folder() as folder:
        path = moving(folder)
        folder.write("moving.yaml", folder.read("moving.yaml").replace("fan]", "fan, plan]"))
        asdic("run", path, "-o", folder / "r").check(code=0)
        rows = list(csv.DictReader(data(folder, "r", "routes.csv").decode().splitlines()))
        tap.equal([[float(row[k]) for k in ("time_s", "x_m", "y_m", "yaw_deg")] for row in rows
                   if row["object"] == "ball"][::39], [[0, 20, 0, 0], [1.95, 16.1, 0.975, 39]])
        tap.equal(len(rows), 80, "two objects at 40 pings")
        if not os.path.exists(folder / "r/plan.png"):
            raise tap.Skip("built without cairo")
        drawn = data(folder, "r", "plan.png")
        asdic("render", folder / "r").check(code=0)
        tap.equal(data(folder, "r", "plan.png") == drawn, True, "drawn again")
        whole = data(folder, "r", "routes.csv").decode()
        replace(folder, "routes.csv",
                whole.replace("ball,0,20.000,0.000,", "ball,0,12.000,6.000,").rstrip("\n"))
        asdic("render", folder / "r").check(code=0)
        tap.equal(data(folder, "r", "plan.png") == drawn, False, "routes are seen")
        head = "object,time_s,x_m,y_m,yaw_deg\n"
        for rows in ("ball,0,20,x\n", "ball,0,20,0,0," * 1000, "a,0,0,0,0,b,0,0,0,0,a,0,0,0,0,b,0,0,0,0\n"):
            replace(folder, "routes.csv", head + rows)
            tap.contains(asdic("render", folder / "r").check(code=3).err,
                         "routes.csv' is damaged")
        replace(folder, "routes.csv", whole)
        outlines = data(folder, "r", "objects.csv").decode()
        replace(folder, "objects.csv", re.sub(r"(?m)^(\w+),\d+,", r"\1,-1,", outlines, count=1))
        asdic("render", folder / "r").check(code=0)


def test_routes_of_many_objects_are_as_long_as_can_be_drawn():
    """A thousand of them share what is kept; each is where its track has it, from the first ping to the last."""
    program.need_device()
    shoal = [f"fish_{i}" for i in range(1000)]
    with Folder() as folder:
        path = moving(folder, pings=700, rays=64)
        text = folder.read("moving.yaml").replace("    track: ball.csv", "    track: fish.csv").replace(
            FISH, "".join(f"  - {{name: {name}, point: -60, track: {name[-1]}.csv}}\n" for name in shoal) + "sonar:")
        for i in range(10):
            folder.write(f"{i}.csv", BALL_TRACK.splitlines()[0] + f"\n0,9,{i},5,0,0,0\n34.95,79,{i},5,0,0,0\n")
        folder.write("moving.yaml", text)
        asdic("run", path, "--pings", "0", "-o", folder / "r").check(code=0)
        routes = {}
        for name, *numbers in csv.reader(data(folder, "r", "routes.csv").decode().splitlines()[1:]):
            routes.setdefault(name, []).append([float(number) for number in numbers])
        tap.equal(sorted(routes), sorted(shoal + ["ball"]))
        for name in shoal:
            tap.equal((routes[name][0][0], routes[name][-1][0]), (0, 34.95), name)
            tap.equal(100 < len(routes[name]) < 264, True, f"{len(routes[name])} points of {name}")
            for time_s, north_m, east_m, yaw_deg in routes[name]:
                where = (abs(north_m - 9 - 2.0028612 * time_s) < 2e-3, east_m, yaw_deg)
                tap.equal(where, (True, int(name[-1]), 0), name)
        asdic("render", folder / "r", "--images", "plan").check(code=0)


def replace(folder, name, text):
    """The file NAME in the run r, of which run.json states length and sum."""
    def stated(body):
        return f'"{name}", "bytes": {len(body)}, "crc32": "{zlib.crc32(body):08x}"'

    before = data(folder, "r", name)
    folder.write("r/" + name, text)
    edit_facts(folder, "r", stated(before), stated(text.encode()))


def test_check_tells_what_moves():
    with Folder() as folder:
        path = moving(folder)
        out = asdic("check", path).check(code=0).out
        tap.contains(out, "fish        a point at x 9, y -3, z 6 m; moves, this is at ping 0")
        described = json.loads(asdic("check", "--json", path).check(code=0).out)
        tap.equal([o["moves"] for o in described[0]["meshes"]], [True, True])
        text = folder.read("moving.yaml")
        for old, new, words in (
                ("track: ball.csv", "track: no.csv", "no.csv: cannot open"),
                ("track: ball.csv", "type: sand", "missing key 'position_m', in m"),
                ("track: ball.csv", "position_m: [1, 2, 3]\n    track: ball.csv",
                 "'position_m' has no effect beside 'track'")):
            bad = folder.write("bad.yaml", text.replace(old, new))
            tap.contains(asdic("check", bad).check(code=3).err, words)


def test_check_warns_of_other_clocks_and_gaps():
    with Folder() as folder:
        path = moving(folder)
        tap.lacks(asdic("check", path).check(code=0).err, "warning")
        head = "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
        rows = [f"{1000 + 0.1 * k},{0.1 * k},0,5,0,0,0\n" for k in range(60)]
        folder.write("moving.yaml", folder.read("moving.yaml").replace(
            "pose: {position_m: [0, 0, 5]}", "track: own.csv"))
        folder.write("own.csv", head + "".join(rows))
        err = asdic("check", path).check(code=0).err
        tap.contains(err, "warning: object 'ball' never moves: its track covers 0 to 2 s, the pings "
                     "are from 1000 to 1001.95 s")
        tap.contains(err, "object 'fish' never moves")
        folder.write("own.csv", head + "5,0,0,5,0,0,0\n5.5333333333333333,1,0,5,0,0,0\n")
        third = folder.read("moving.yaml").replace("ping_rate_hz: 20", "ping_rate_hz: 3.75")
        folder.write("third.yaml", third.replace(", pings: 40", ""))
        err = asdic("check", folder / "third.yaml").check(code=0).err
        tap.contains(err, "the pings are from 5 to 5.533 s")
        folder.write("own.csv", head + "".join(rows))
        tap.lacks(err, "has no point")
        folder.write("own.csv", head + "".join(rows[:20] + rows[40:]))
        tap.contains(asdic("check", path).check(code=0).err, "moving.yaml:20:18: warning: the track "
                     "has no point for 2.1 s after 1001.9 s")


tap.main(globals())
