"""Scanned sonars: a head that looks in one direction a ping, through all that asdic makes of it."""
import csv
import json
import math
import re
import shutil
import subprocess

import program
import tap
from program import Folder, asdic
from run_folder import data, facts, pictures, png_rows, png_texts, same

SCENE = """
version: 1
bottom: {depth_m: 10, type: sand}
objects:
  - name: pile
    cylinder: {radius_m: 0.4, length_m: 10}
    position_m: [-6, 10, 5]
    rotation_deg: [90, 0, 0]
    material: {impedance_mrayl: 45, roughness_rms_mm: 2, slope_rms: 0.3}
sonar:
  frequency_khz: 200
  ping_rate_hz: 25
  source_level_db: 200
  bin_length_m: 0.25
SCAN  transmitter: {pitch_deg: 8, yaw_deg: AIM, length_h_m: 0.12, length_v_m: 0.015}
  receivers: [{name: head, pitch_deg: 8, yaw_deg: AIM, length_h_m: 0.12, length_v_m: 0.015}]
mission: {pose: {position_m: [0, 0, 7], roll_deg: ROLL, pitch_deg: PITCH, yaw_deg: 30}PINGS}
sampling: {rays: 2000}
output: {images: [fan], netcdf: NETCDF}
"""
CIRCLE = "  scan: {sector_deg: 360, step_deg: 6}\n"
SECTOR = "  scan: {sector_deg: 60, step_deg: 15}\n"


def scene(folder, name, scan, aim=0.0, roll=12, pitch=-4, pings="", netcdf="false"):
    text = SCENE.replace("SCAN", scan).replace("AIM", str(aim)).replace("ROLL", str(roll)).replace("PITCH", str(pitch))
    return folder.write(name, text.replace("PINGS", pings).replace("NETCDF", netcdf))


def expected_levels(path, *options):
    rows = asdic("expect", path, "-o", "-", *options).check(code=0).out.splitlines()
    return [(r["bottom_db"], r["volume_db"], r["total_db"]) for r in csv.DictReader(rows)]


def test_a_turned_head_is_an_aimed_one():
    """Ping k of a scan on a tilted vehicle expects what beams aimed at the head's angle expect."""
    with Folder() as folder:
        scan = scene(folder, "scan.yaml", CIRCLE)
        for ping, aim in ((0, 180), (13, -102), (30, 0), (47, 102)):
            found = expected_levels(scan, "--ping", ping)
            wanted = expected_levels(scene(folder, "aimed.yaml", "", aim))
            tap.equal(len(found), len(wanted), "rows")
            for row, other in zip(found, wanted):
                for a, b in zip(row, other):
                    if a != b and abs(float(a) - float(b)) > 1e-3:
                        raise AssertionError((ping, row, other))


def test_poses_are_the_vehicles_with_the_head_beside():
    program.need_device()
    for roll in 12, 0:
        check_poses(roll)


def check_poses(roll):
    with Folder() as folder:
        asdic("run", scene(folder, "scan.yaml", CIRCLE, roll=roll), "-o", folder / "r").check(code=0)
        rows = list(csv.DictReader(data(folder, "r", "track.csv").decode().splitlines()))
        tap.equal(len(rows), 60, "one turn where no pings are given")
        tap.equal({(r["roll_deg"], r["pitch_deg"], r["yaw_deg"]) for r in rows}, {(str(roll), "-4", "30")},
                  "the vehicle at rest")
        tap.equal([float(r["head_deg"]) for r in rows], [6.0 * k - 180 for k in range(60)], "the head")
        tap.equal(facts(folder, "r")["scan"], {"directions": 60, "step_deg": 6, "circle": True}, "run.json")
        for name in pictures(folder, "r"):
            tap.lacks(png_texts(data(folder, "r", name))["Title"], "of a scan")  # there is one beam
        text = folder.read("scan.yaml")
        replay = folder.write("replay.yaml", re.sub(r"mission: .*", "mission: {track: r/track.csv}", text))
        asdic("run", replay, "-o", folder / "again").check(code=0)
        for part in (1, 2):
            asdic("run", folder / "scan.yaml", "--shard", f"{part}/2", "-o", folder / f"p{part}").check(code=0)
        asdic("merge", folder / "p1", folder / "p2", "-o", folder / "joined").check(code=0)
        same(folder, "r", "joined")
        for name in ("bins.csv", "pings.npy", "track.csv"):
            tap.equal(data(folder, "again", name) == data(folder, "r", name), True, name)


def test_joined_parts_keep_the_vehicles_poses():
    """Angles beyond a quarter turn are not those that the sonar's attitude would be taken apart into."""
    program.need_device()
    with Folder() as folder:
        for roll, pitch in ((0, -100), (10, 90), (200, 30)):
            scan = scene(folder, "scan.yaml", SECTOR, roll=roll, pitch=pitch)
            for part, more in (("whole", ()), ("a", ("--shard", "1/2")), ("b", ("--shard", "2/2"))):
                asdic("run", scan, "-q", "-f", "-o", folder / part, *more).check(code=0)
            asdic("merge", "-q", "-f", folder / "a", folder / "b", "-o", folder / "joined").check(code=0)
            for name in ("track.csv", "pings.npy", "bins.csv"):
                tap.equal(data(folder, "joined", name), data(folder, "whole", name), f"{pitch}: {name}")


def test_answers_of_serve_say_where_the_head_looked():
    program.need_device()
    with Folder() as folder:
        for scan, heads in ((CIRCLE, [6.0 * k - 180 for k in (*range(60), 0, 1)]),
                            (SECTOR, [-30, -15, 0, 15, 30, 15, 0, -15, -30, -15]), ("", [None] * 3)):
            path = scene(folder, "scan.yaml", scan)
            out = asdic("serve", path, "--rays", "64", stdin='{"x_m": 0, "y_m": 0, "z_m": 7}\n' * len(heads)).check(code=0).out
            tap.equal([json.loads(line).get("head_deg") for line in out.splitlines()], heads, f"head_deg of '{scan}'")


def test_what_is_met_lies_where_it_is():
    """The pile is 120.96 degrees from north: 90.96 to starboard of the bow; its echo is at the ping
    at which the head looks there, and detections are put on it."""
    program.need_device()
    with Folder() as folder:
        asdic("run", scene(folder, "scan.yaml", CIRCLE, roll=0), "-o", folder / "r").check(code=0)
        best = {}
        for row in csv.DictReader(data(folder, "r", "bins.csv").decode().splitlines()):
            if row["object_db"]:
                ping = int(row["ping"])
                best[ping] = max(best.get(ping, -999), float(row["object_db"]))
        tap.equal(max(best, key=best.get), 45, "ping of the strongest echo, head at 90 degrees")
        asdic("detect", folder / "r").check(code=0)
        found = [r for r in csv.DictReader(data(folder, "r", "detections.csv").decode().splitlines())
                 if r["truth"] == "pile"]
        if not found:
            raise AssertionError("the pile is not detected")
        for row in found:
            off = math.hypot(float(row["x_m"]) + 6, float(row["y_m"]) - 10)
            if off > 2.5:  # half a beam of 3.3 degrees and a step of 6 at 11.7 m, a side lobe aside
                raise AssertionError((off, row))


def test_pictures_are_of_turns():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, "scan.yaml", CIRCLE, pings=", pings: 150")
        asdic("run", path, "-o", folder / "r").check(code=0)
        tap.equal(pictures(folder, "r"), ["fan_149.png", "fan_59.png"], "the first turn and the last")
        asdic("render", folder / "r", "--images", "fan", "--ping", "80", "-o", folder / "p.png").check(code=0)
        tap.equal("p.png" in folder.names(), True, "a picture after any ping")
        # The ping itself is in it: after the first there is nothing else.
        after = []
        for roll in 12, 40:
            path = scene(folder, "scan.yaml", CIRCLE, roll=roll)
            asdic("run", path, "-o", folder / "r", "--force").check(code=0)
            asdic("render", folder / "r", "--images", "fan", "--ping", "0", "--db-range", "40:140", "-o", folder / "p.png",
                  "--force").check(code=0)
            content = data(folder, ".", "p.png")
            after.append(content[content.index(b"IDAT"):])
        tap.equal(after[0] != after[1], True, "the head's first ping shows where it looks")


def test_a_sector_stays_whole_on_the_way_back():
    """Of six directions the first was heard nine pings ago."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, "scan.yaml", SECTOR.replace("60", "75"), pings=", pings: 10")
        asdic("run", path, "-o", folder / "r").check(code=0)

        def empty(ping):
            asdic("render", folder / "r", "--images", "fan", "--ping", str(ping), "-o", folder / "p.png", "--force").check(code=0)
            rows = png_rows(data(folder, ".", "p.png"))
            return sum(row.count(rows[0][:3]) for row in rows)

        there, half, back = empty(5), empty(3), empty(9)
        tap.equal((half > 1.1 * there, abs(back / there - 1) < 0.02), (True, True), f"{there}, {half}, {back} pixels")


def test_the_plan_is_of_a_turn():
    """The area on the bottom is a ring round the vehicle, not the wedge of the first ping."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, "scan.yaml", CIRCLE, pings=", pings: 60")
        asdic("run", path, "-o", folder / "r").check(code=0)
        done = asdic("render", folder / "r", "--images", "plan", "-o", folder / "p.svg")
        if "without cairo" in done.err:
            raise tap.Skip("built without cairo")
        done.check(code=0)
        drawn = re.findall(r'<path [^>]*stroke[:="]+rgb\(0%, *44.7[^>]* d="([^"]*)"', folder.read("p.svg"))
        numbers = [float(x) for x in re.findall(r"-?[0-9.]+", max(drawn, key=len))]
        sides = sorted(max(n) - min(n) for n in (numbers[0::2], numbers[1::2]))
        if sides[0] < 0.8 * sides[1]:
            raise AssertionError(sides)


def test_check_and_plan_say_how_it_turns():
    with Folder() as folder:
        circle = scene(folder, "circle.yaml", CIRCLE)
        sector = scene(folder, "sector.yaml", SECTOR)
        said = "60 directions, 6 degrees apart, round and round; a turn takes 2.4 s"
        tap.contains(asdic("check", circle).check(code=0).out, said)
        tap.contains(asdic("plan", "--no-forecast", circle).check(code=0).out, said)
        tap.contains(asdic("check", sector).check(code=0).out,
                     "5 directions, 15 degrees apart, back and forth; one way takes 0.2 s, to 30 degrees")
        for command in (("check",), ("plan", "--no-forecast")):
            answer = json.loads(asdic(*command, "--json", circle).check(code=0).out)
            answer = answer[0] if isinstance(answer, list) else answer
            tap.equal(answer["scan"], {"directions": 60, "step_deg": 6, "circle": True, "turn_s": 2.4})
        still = scene(folder, "still.yaml", "")
        tap.lacks(asdic("check", still).check(code=0).out, "scan  ")


def test_steps_must_fill_the_sector():
    with Folder() as folder:
        for sector, step, times, steps, sectors in (
                (100, 7, "14.29", 7.14285714, "98"), (100, 0.9, "111.1", 0.900900901, "99.9"),
                (10, 30, "0.3333", 10, "30"), (359, 0.93, "386", 0.930051813, "358.98"),
                (359.9, 7, "51.41", 7.05686275, "357"), (359.9, 0.8, "449.9", 0.799777778, "359.2"),
                (360, 0.7, "514.3", 0.700389105, "359.8, which is gone back and forth")):
            path = scene(folder, "bad.yaml", f"  scan: {{sector_deg: {sector}, step_deg: {step}}}\n")
            err = asdic("check", path).check(code=3).err
            tap.contains(err, f"'step_deg' = {step} goes {times} times into 'sector_deg' = {sector}; it must be a "
                         f"whole number of times, as with {steps}, or as with 'sector_deg' = {sectors}  [sonar.scan")
            for remedy in (sector, steps), (sectors.split(",")[0], step):
                path = scene(folder, "good.yaml", "  scan: {{sector_deg: {}, step_deg: {}}}\n".format(*remedy))
                asdic("check", path).check(code=0)


def test_netcdf_has_the_direction_of_every_ping():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, "scan.yaml", SECTOR, netcdf="true", pings=", pings: 7")
        if not shutil.which("ncdump"):
            raise tap.Skip("no ncdump")
        asdic("run", path, "-o", folder / "r").check(code=0)
        text = subprocess.run(["ncdump", "-p", "9,17", folder / "r/run.nc"], capture_output=True,
                              text=True, check=True).stdout
        heads = [-30, -15, 0, 15, 30, 15, 0]
        down = math.radians(8)
        want = {"head_angle": heads,
                "heading": [30] * 7, "roll": [12] * 7, "pitch": [-4] * 7,
                "beam_direction_x": [math.cos(down) * math.cos(math.radians(h)) for h in heads],
                "beam_direction_y": [math.cos(down) * math.sin(math.radians(h)) for h in heads],
                "beam_direction_z": [math.sin(down)] * 7}
        for name, values in want.items():
            body = re.findall(rf"\n\s*{name} =\s(.*?);", text, re.S)[-1]
            found = [float(word) for word in re.split(r"[,\s]+", body.strip())]
            tap.equal([round(x, 9) + 0.0 for x in found], [round(x, 9) + 0.0 for x in values], name)


tap.main(globals())
