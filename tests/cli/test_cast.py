"""Water whose sound speed changes with depth: gradient, list and file mean the same; a cast's errors name its
lines; a run folder and a scene that was read keep its points."""
import csv
import io
import json
import math
import random
import sys

import tap
from program import Folder, asdic, need_device
from run_folder import data, facts

FULL = "full" in sys.argv and not sys.argv.remove("full")

SCENE = """version: 1
environment: {water}
bottom: {{depth_m: 12, type: sand}}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  source_level_db: 0
  blanking_m: 0.5
  transmitter: {{length_h_m: 0.05, length_v_m: 0.05}}
  ping_rate_hz: 10
  bin_length_m: 1
  noise: {{enabled: false}}
  receivers: [{{name: forward, length_h_m: 0.05, length_v_m: 0.05}}]
mission: {{pose: {{position_m: [0, 0, 7]}}}}
"""


def levels(folder, water, cast=None):
    if cast:
        folder.write("cast.csv", cast)
    path = folder.write("scene.yaml", SCENE.format(water=water))
    text = asdic("expect", path, "-o", "-").check(code=0).out
    return [float(row["bottom_db"] or "nan") for row in csv.DictReader(io.StringIO(text))]


def check(truth, what):
    if not truth:
        raise AssertionError(what)


def refused(folder, water, cast=None):
    if cast:
        folder.write("cast.csv", cast)
    path = folder.write("scene.yaml", SCENE.format(water=water))
    return asdic("check", path).check(code=3).err


def same(a, b, tolerance):
    return len(a) == len(b) and all(x != x and y != y or abs(x - y) <= tolerance for x, y in zip(a, b))


FILE = "{sound_speed_profile: cast.csv}"
TRACK = "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"


def test_gradient_list_and_file_mean_the_same():
    with Folder() as folder:
        line = levels(folder, "{sound_speed_mps: 1491.4, sound_speed_gradient_per_s: -0.2}")
        own = levels(folder, "{sound_speed_profile: [[0, 1491.4], [60, 1479.4]]}")
        read = levels(folder, FILE, "depth_m,sound_speed_mps\n0,1491.4\n60,1479.4\n")
        straight = levels(folder, "{sound_speed_mps: 1490}")
        check(same(own, read, 0), "a file is its list")
        check(same(line, own, 1e-6), "a gradient is a profile of one slope")
        check(not same(line, straight, 0.5), "rays bend")


def test_one_speed_is_straight():
    with Folder() as folder:
        straight = levels(folder, "{sound_speed_mps: 1490}")
        tap.equal(levels(folder, "{sound_speed_mps: 1490, sound_speed_gradient_per_s: 0}")[5:], straight[5:])
        tap.equal(levels(folder, FILE, "depth_m,sound_speed_mps\n0,1490\n60,1490\n")[5:], straight[5:])


def medwin(t, s, z):
    return 1449.2 + 4.6 * t - 0.055 * t**2 + 0.00029 * t**3 + (1.34 - 0.010 * t) * (s - 35) + 0.016 * z


def test_temperatures_become_speeds():
    rows = [(0, 20, 5), (4, 18.5, 8), (9, 7, 30)]
    with Folder() as folder:
        for salty in (False, True):
            text = "# a cast\n\ndepth_m,temperature_degc" + (",salinity_ppt\n" if salty else "\n")
            text += "".join(f"{z},{t}" + (f",{s}\n" if salty else "\n") for z, t, s in rows)
            points = ", ".join(f"[{z}, {medwin(t, s if salty else 12, z)!r}]" for z, t, s in rows)
            own = levels(folder, "{temperature_degc: 9, salinity_ppt: 12, sound_speed_profile: [%s]}" % points)
            read = levels(folder, "{temperature_degc: 9, salinity_ppt: 12, sound_speed_profile: cast.csv}", text)
            check(same(own, read, 1e-6), "by Medwin's equation")


def absorption(folder, water, text, bottom="{depth_m: 12, type: sand}"):
    folder.write("cast.csv", text)
    path = folder.write("scene.yaml", SCENE.format(water=water).replace("{depth_m: 12, type: sand}", bottom))
    found = json.loads(asdic("check", path, "--json").check(code=0).out)[0]
    return found["absorption_db_per_km"]


def test_absorption_takes_the_temperatures_of_the_cast():
    """Their mean from the surface to the bottom, on lines between the rows and constant outside; what the scene gives
    itself stays."""
    head, salty = "depth_m,temperature_degc\n", "depth_m,temperature_degc,salinity_ppt\n"
    with Folder() as folder:
        for text, own in (
                (salty + "0,20,0.1\n12,8,0.1\n", "14, salinity_ppt: 0.1"),
                (salty + "4,20,10\n12,8,10\n", "16, salinity_ppt: 10"),  # (4 * 20 + 8 * 14) / 12
                (salty + "0,20,30\n24,8,36\n", "17, salinity_ppt: 31.5"),  # the upper half of the lines
                (salty + "0,20,30\n6,8,36\n", "11, salinity_ppt: 34.5"),  # 14 and 33 above 8 and 36
                (head + "0,20\n12,8\n", "14")):
            water = "{sound_speed_profile: cast.csv%s}"
            tap.equal(absorption(folder, water % "", text), absorption(folder, water % f", temperature_degc: {own}", text))
            points = water % f", temperature_degc: {own}"
            check(same(levels(folder, water % "", text), levels(folder, points, text), 0), "levels too")
        lake = salty + "0,20,0.1\n12,8,0.1\n24,2,0.1\n"
        tap.equal(absorption(folder, water % "", lake, "none"),
                  absorption(folder, water % ", temperature_degc: 9.5", lake, "none"))  # (12 * 14 + 12 * 5) / 24
        sea = absorption(folder, water % ", salinity_ppt: 35, temperature_degc: 10", lake)
        tap.equal(sea, absorption(folder, "{sound_speed_mps: 1490}", lake))
        check(absorption(folder, water % "", lake) < 0.2 * sea, "a lake absorbs little")


CHANNEL = """version: 1
environment:
  sound_speed_profile: [[0, 1490.6], [5.7, 1509.9], [9.89, 1494.96], [12.93, 1490.82], [18.15, 1500.37]]
bottom: {{depth_m: 30, lambert_db: -100}}
objects: [{{name: p, point: -10, position_m: [85.83, 0, 12.93]}}]
sonar:
  frequency_khz: {khz}
  bandwidth_khz: 20
  ping_rate_hz: 6
  source_level_db: 200
  bin_length_m: 0.5
  noise: {{enabled: false}}
  transmitter: {{length_h_m: 0.03, length_v_m: 0.01}}
  receivers: [{{name: a, length_h_m: 0.02, length_v_m: 0.015}}]
mission: {{pose: {{position_m: [0, 0, 12.93]}}}}
model: {{refraction: {form}}}
sampling: {{rays: 4096, multipath: off}}
output: {{images: []}}
"""


def test_a_point_on_the_axis_of_a_channel_is_as_loud_as_waves_make_it():
    """Beside a parabolic equation (split steps of 0.25 m, cells of 2 cm or less, a source of 0.15 rad), the mean of |p|^4
    re water of one speed at nine frequencies over a band of 20, 20 and 40 kHz."""
    need_device()
    with Folder() as folder:
        for khz, rise_db in ((45.2, 20.65), (90, 24.38), (200, 26.86)):
            heard = []
            for form in "full", "off":
                path = folder.write("channel.yaml", CHANNEL.format(khz=khz, form=form))
                asdic("run", "-q", "--force", path, "-o", folder / "out").check(code=0)
                with open(folder / "out/bins.csv", encoding="utf-8") as file:
                    levels_db = [float(row["object_db"]) for row in csv.DictReader(file) if row["object_db"]]
                heard.append(10 * math.log10(sum(10**(db / 10) for db in levels_db)))
            check(abs(heard[0] - heard[1] - rise_db) < 2, f"{heard[0] - heard[1]} dB at {khz} kHz")


def test_errors_name_the_line():
    head = "depth_m,sound_speed_mps\n"
    with Folder() as folder:
        for cast, line, part in (
                (head + "0,1490\n5,1485\n5,1480\n", 4, "'depth_m' = 5 is not deeper than 5 at line 3"),
                (head + "0,1490\n3.048,1485\n3.0480001,1484\n", 4, "a depth of 3.0480001 m is less than 0.001 m below the "
                 "3.048 m before; leave one of the two out"),
                (head + "0,1490\n5,1299\n", 3, "'sound_speed_mps' = 1299 is out of range [1300, 1700]"),
                (head + "0,1490\n", 2, "1 point; a cast has 2 to 64"),
                (head + "".join(f"{z},1490\n" for z in range(65)), 66, "65 points; a cast has 2 to 64"),
                (head + "-1,1490\n5,1480\n", 2, "'depth_m' = -1 is out of range [0, 11000]"),
                ("depth_m,temperature_degc\n0,20\n5,50\n", 3, "'temperature_degc' = 50 is out of range [-2, 40]"),
                (head + "0,1490\n5,warm\n", 3, "'sound_speed_mps' = warm"),
                ("depth,sound_speed_mps\n0,1490\n", 1, "missing column 'depth_m'"),
                ("# C\n\nDepth_m,Sound_Speed_mps\n0,1490\n", 3,
                 "none of the columns is known; the header is depth_m,sound_speed_mps in any order, or "
                 "depth_m,temperature_degc[,salinity_ppt]"),
                ("depth_m,temperature_degc\n0,20\n11000,35\n", 3,
                 "= 1731.25875 is out of range [1300, 1700] m/s"),
                ("depth_m;sound_speed_mps\n0;1490\n5;1480\n", 1, "separated by semicolons; they must be by commas"),
                (head + "0,1490,5\n5,1485\n6,1484\n", 2, "3 fields, but the header has 2")):
            err = refused(folder, FILE, cast)
            tap.contains(err, f"cast.csv:{line}:")
            tap.contains(err, part)
            tap.contains(err, "1 error")


def test_scenes_are_judged_as_a_whole():
    with Folder() as folder:
        for water, part in (
                ("{sound_speed_gradient_per_s: 0.1, sound_speed_profile: [[0, 1490], [9, 1480]]}", "exclude each other"),
                ("{sound_speed_mps: 1490, sound_speed_profile: [[0, 1490], [9, 1480]]}", "has no effect beside"),
                ("{sound_speed_profile: [[0, 1490], [0, 1480]]}", "not below the 0 m before"),
                ("{sound_speed_profile: [[0, 1490], [5, 1480], [4, 1470], [9, 1480]]}",
                 "a depth of 4 m is not below the 5 m before"),
                ("{sound_speed_profile: [[0, 1490], [5, 1480], [5, 1470]]}", "5 m is not below the 5 m before"),
                ("{sound_speed_profile: [[0, 1490], [7, 1485], [7.000001, 1480]]}",
                 "7.000001 m is less than 0.001 m below the 7 m before"),
                ("{sound_speed_profile: [[0, 1490], [5, 1800]]}", "'sound_speed_profile' = 1800 is out of range [1300, 1700] m/s"),
                ("{sound_speed_profile: [[0, 1490]]}", "1 entries"),
                ("{sound_speed_profile: gone.csv}", "gone.csv"),
                ("{sound_speed_mps: 1490, sound_speed_gradient_per_s: -20}", "1300 m/s at a depth of 9.5 m;"),
                ("{sound_speed_mps: 1490, sound_speed_gradient_per_s: -30, max_depth_m: 9}", "at a depth of 6.333 m;"),
                ("{sound_speed_gradient_per_s: 31}", "out of range [-30, 30] 1/s")):
            err = refused(folder, water)
            tap.contains(err, part)
            tap.contains(err, "1 error")
        # Without a bottom rays go down to the range, of 73 m.
        steep = SCENE.format(water="{sound_speed_mps: 1490, sound_speed_gradient_per_s: -3}")
        path = folder.write("open.yaml", steep.replace("bottom: {depth_m: 12, type: sand}", "bottom: none"))
        for command in ("check", "run", "expect"):
            err = asdic(command, path).check(code=3).err
            tap.contains(err, "open.yaml:2:")
            tap.contains(err, "1300 m/s at a depth of 63.33 m; without a bottom rays go down to 80 m: give")


def test_the_speed_is_that_at_the_sonar():
    with Folder() as folder:
        folder.write("cast.csv", "depth_m,sound_speed_mps\n0,1490\n60,1480\n")
        path = folder.write("scene.yaml", SCENE.format(water=FILE))
        first = json.loads(asdic("check", path, "--json").check(code=0).out)[0]
        folder.write("cast.csv", "depth_m,sound_speed_mps\n0,1490\n60,1470\n")
        second = json.loads(asdic("check", path, "--json").check(code=0).out)[0]
        check(first["sound_speed_mps"] != second["sound_speed_mps"], "the speed at the sonar's depth")


def plan(folder, water, *args, ping_rate=10):
    text = SCENE.format(water=water).replace("ping_rate_hz: 10", f"ping_rate_hz: {ping_rate}")
    path = folder.write("scene.yaml", text)
    return json.loads(asdic("plan", path, "--no-forecast", "--json", *args).check(code=0).out)


def test_remarks_tell_where_rays_do_not_come():
    with Folder() as folder:
        upward = "{sound_speed_mps: 1480, sound_speed_gradient_per_s: 1}"
        remarks = plan(folder, upward, ping_rate=4)["remarks"]
        # The last ray grazes the bottom. Its circle about the plane of c = 0 has the radius c_b / g.
        reach = math.sqrt(1492.0**2 - 1487.0**2)
        check(any(f"reaches the bottom beyond {reach:.4g} m: a shadow" in r for r in remarks), remarks)
        check(not any("water:" in r for r in plan(folder, "{sound_speed_mps: 1490}", ping_rate=4)["remarks"]), "straight")
        channel = "{sound_speed_profile: [[0, 1500], [7, 1480], [20, 1500]]}"
        check(any("trapped in a channel" in r for r in plan(folder, channel)["remarks"]), "a channel")
        thermocline = "{sound_speed_profile: [[0, 1510], [5, 1510], [9, 1480], [30, 1480]]}"
        check(any("turn before they end" in r for r in plan(folder, thermocline)["remarks"]), "a thermocline")


def test_a_run_keeps_the_form_and_the_points():
    need_device()
    with Folder() as folder:
        folder.write("cast.csv", "depth_m,sound_speed_mps\n0,1490\n60,1440\n")
        path = folder.write("scene.yaml", SCENE.format(water=FILE) + "sampling: {rays: 500}\n")
        asdic("run", "-q", path, "-o", folder / "off", "--refraction", "off").check(code=0)
        kept = facts(folder, "off")
        tap.equal(kept["refraction"], "off")
        tap.contains(kept["scene"]["text"], "- [60, 1440]")
        check("cast.csv" not in kept["scene"]["text"], "the points, not the file's name")
        straight = folder.write("straight.yaml", SCENE.format(water="{sound_speed_mps: %.17g}" % (1490 - 7 * 50 / 60))
                                + "sampling: {rays: 500}\n")
        asdic("run", "-q", straight, "-o", folder / "straight").check(code=0)
        a, b = (data(folder, name, "bins.csv") for name in ("off", "straight"))
        check(a == b, "straight rays at the sonar's speed")


def test_a_run_and_its_parts_keep_the_layer_that_was_planned():
    """A profile with a kink too small to matter; what joins the parts reads the layer from their folders."""
    need_device()
    with Folder() as folder:
        water = "{sound_speed_profile: [[0, 1490], [7, 1484], [14, 1478.01]]}"
        path = folder.write("scene.yaml", SCENE.format(water=water).replace("7]}}", "7]}, pings: 2}")
                            + "sampling: {rays: 500}\n")
        told = json.loads(asdic("plan", path, "--no-forecast", "--json").check(code=0).out)["refraction"]
        tap.equal(told["needed"], "layer")
        for name, options in ("whole", []), ("one", ["--shard", "1/2"]), ("two", ["--shard", "2/2"]):
            asdic("run", "-q", path, "-o", folder / name, *options).check(code=0)
            kept = facts(folder, name)
            tap.equal((kept["refraction"], kept["layer_m"]), ("layer", {"from": 7, "to": 12}), name)
        asdic("merge", folder / "one", folder / "two", "-o", folder / "joined").check(code=0)
        kept = facts(folder, "joined")
        tap.equal((kept["refraction"], kept["layer_m"]), ("layer", {"from": 7, "to": 12}), "joined")
        check(data(folder, "whole", "bins.csv") == data(folder, "joined", "bins.csv"), "the whole run and its parts")


def most_apart(a_db, b_db):
    """The largest change of a level that no shift of echoes by a fortieth of a bin, in A or B, makes up for."""
    def about(levels_db, n):
        lin = [10 ** (0.1 * db) for db in levels_db]
        beside = lin[max(n - 1, 0)], lin[n], lin[min(n + 1, len(lin) - 1)]
        return [10 * math.log10(lin[n] + (other - lin[n]) / 40) for other in beside]

    worst = 0.0
    for n in range(min(len(a_db), len(b_db))):
        a, b = about(a_db, n), about(b_db, n)
        worst = max(worst, min(a) - max(b), min(b) - max(a))
    return worst


def test_plan_and_tolerance_measure_what_the_run_does():
    """A cast that hardly bends: straight rays do, and what they err is what is foretold, and what rays are counted by."""
    need_device()
    text = """version: 1
environment: {wind_speed_kn: 0, sound_speed_profile: [[0, 1500], [120, 1498], [240, 1480], [800, 1483]]}
bottom: {depth_m: 400, type: gravel}
sonar: {frequency_khz: 900, bandwidth_khz: 1, ping_rate_hz: 5.25, max_range_m: 120, source_level_db: 205,
  bin_length_m: 10.909091, transmitter: {length_h_m: 0.00083, length_v_m: 0.00425, pitch_deg: 10},
  receivers: {fan: {count: 8, sector_deg: 30, pitch_deg: 10, length_h_m: 0.03, length_v_m: 0.00425}}}
mission: {pose: {position_m: [0, 0, 300]}}
sampling: {rays: 2000}
output: {csv: none, images: []}
"""
    with Folder() as folder:
        path, foretold, rays = folder.write("scene.yaml", text), [], []
        for form in ([], ["--refraction", "off"]):
            told = json.loads(asdic("plan", path, "--json", *form).check(code=0).out)
            tap.equal(told["refraction"]["needed"], "off")
            foretold.append({key: told["forecast"][key] for key in told["forecast"] if key.startswith("stderr")})
            asdic("run", path, "-o", folder / "run", "-f", "--tolerance", "0.1", *form).check(code=0)
            tap.equal(facts(folder, "run")["refraction"], "off")
            rays.append(facts(folder, "run")["rays"])
        print("#", foretold, rays)
        tap.equal(foretold[0], foretold[1])
        tap.equal(rays[0], rays[1])


def test_the_plan_bounds_what_simpler_forms_leave_out():
    """Nine profiles, sixty in the full tier, a track that dives: at places that the plan does not look at the change is within its bound."""
    draw = random.Random(20)
    depths = [4.0, 4.7, 5.6, 6.5, 7.3, 8.2, 8.8]
    with Folder() as folder:
        folder.write("track.csv", TRACK + "".join(f"{0.1 * i:.1f},{i},0,{z},0,0,0\n" for i, z in enumerate(depths)))
        text = SCENE.replace("pose: {{position_m: [0, 0, 7]}}", "track: track.csv, pings: 7").replace(
            "noise: {{enabled: false}}", "noise: {{enabled: true}}").replace(
                "source_level_db: 0", "source_level_db: 150").replace("ping_rate_hz: 10", "ping_rate_hz: 20")
        needed = {"off": 0, "layer": 0, "full": 0}
        for number in range(60 if FULL else 9):
            count = draw.randint(2, 6)
            depth = sorted(draw.uniform(0, 14) for _ in range(count))
            slope, rough = draw.uniform(-1, 1) * (number % 3 > 0), 10 ** draw.uniform(-3.5, 1 - 4 * (number % 3 == 2))
            points = [[round(z, 3), round(1480 + slope * z + rough * draw.uniform(-1, 1), 4)] for z in depth]
            path = folder.write("scene.yaml", text.format(water="{sound_speed_profile: %s}" % points))
            told = json.loads(asdic("plan", path, "--no-forecast", "--json").check(code=0).out)["refraction"]
            needed[told["needed"]] += 1
            total = {}
            for form in ("full", "layer", "off"):
                out = asdic("expect", path, "-o", "-", "--ping", "14"[number % 2], "--refraction", form).check(code=0).out
                total[form] = [float(row["total_db"]) for row in csv.DictReader(io.StringIO(out))]
            for form in ("layer", "off"):
                worst = most_apart(total["full"], total[form])
                check(worst <= told[form + "_db"] + 1e-3, f"{points}: {form} {worst} dB, told {told[form + '_db']}")
        print("# needed:", needed)
        check(min(needed.values()) > 0, needed)


tap.main(globals())
