"""Trials: figures against closed forms, draws that cannot be flown. With the argument `full` the same closed forms
in ten thousand runs."""
import csv
import functools
import json
import math
import os
import re
import shutil
import sys

import program
import tap
from program import Folder, asdic
from run_folder import data
from trial_wall import BIN, CLOSE, FRONT, HULL, IDEAL, REACH, WALL, fly, rows

FULL = sys.argv[1:] == ["full"]
if FULL:
    del sys.argv[1:]
FIRST = 28.9  # m: how far off a boat begins
SPEED, RADIUS, RESPONSE, RATE = 1.5, 5.0, 1.0, 1.0
EMPTY = """
version: 1
bottom: {depth_m: 20, type: sand}
sonar:
  frequency_khz: 100
  ping_rate_hz: 2
  source_level_db: 200
  max_range_m: 30
  bin_length_m: 0.5
  bandwidth_khz: 2
  speckle: rayleigh
  receivers: [{name: forward, length_h_m: 0.05, length_v_m: 0.05}]
mission: {waypoints: {points_m: [[0, 0, 8], [7.4, 0, 8]], speed_mps: 1.5}}
detector: {pfa: 1.0e-3}
sampling: {rays: 4000}
trial: {rule: {reach_m: 20, posterior: 0, hold_s: 1000, climb_m: 0.1}}
"""


@functools.cache
def turn(turn_deg=150):
    """Places (x, y) of a turn by TURN_DEG that begins at (0, 0): Nomoto's equations, T r' + r = r_c with
    r_c = (wanted - heading) / (4 T), at most speed / radius, by small steps."""
    places, x_m, y_m, yaw, rate, step = [], 0.0, 0.0, 0.0, 0.0, 1e-4
    while yaw < math.radians(min(0.95 * turn_deg, 108)):
        wanted = min((math.radians(turn_deg) - yaw) / (4 * RESPONSE), SPEED / RADIUS)
        rate += step * (wanted - rate) / RESPONSE
        yaw += step * rate
        x_m += step * SPEED * math.cos(yaw)
        y_m += step * SPEED * math.sin(yaw)
        places.append((x_m, y_m))
    return places


def chances():
    """At how many pings a detection averts the collision: near enough to be seen, far enough to turn."""
    count, turn_m = 0, max(x for x, _ in turn())  # where it comes nearest to the wall
    for k in range(100):
        x_m = SPEED * k / RATE
        off_m = FRONT - HULL - x_m
        room_m = off_m - turn_m
        assert min(abs(off_m - (REACH + BIN + HULL)), abs(room_m)) > 0.08, (k, off_m, room_m)
        count += off_m < REACH + BIN + HULL and room_m > 0
    return count


def within_99(events, trials, p):
    """Whether a binomial count lies in its central 99 %."""
    below = above = 0.0
    for k in range(trials + 1):
        term = math.exp(math.lgamma(trials + 1) - math.lgamma(k + 1) - math.lgamma(trials - k + 1)
                        + k * math.log(p) + (trials - k) * math.log1p(-p))
        below += term if k <= events else 0.0
        above += term if k >= events else 0.0
    return below > 0.005 and above > 0.005


def test_a_wall_and_a_sonar_of_fixed_pd():
    """P(collision) is the product of 1 - P_D over the pings at which a detection comes in time."""
    runs = 10000 if FULL else 400
    with Folder() as folder:
        for pd in (0.05, 0.2):
            path = folder.write("wall.yaml", CLOSE.replace("PD", str(pd)))
            found, = fly(folder, path, runs)
            wanted = (1 - pd) ** chances()
            if not within_99(found["hit"], runs, wanted):
                raise AssertionError((pd, found, wanted))
            tap.equal(found["hit"], found["not seen"] + found["seen late"])
            tap.equal(found["late"] + found["hit"], runs)
            tap.equal(found["km"] > 0, True, f"km flown: {found['km']}")
            for row in rows(folder):  # straight on unless it turned
                left_m = 1.5 * float(row["time_s"]) - float(row["distance_m"])
                if row["manoeuvres"] == "0" and abs(left_m) > 1e-6:
                    raise AssertionError(row)


def test_a_run_ends_at_its_last_waypoint():
    """Not at the ping after it: what is hit behind it is not on the way. What is hit before it is hit then."""
    for end_m, what, flown_m in ((31, "clear", 31), (60, "hit", FRONT - 20 - HULL)):
        with Folder() as folder:
            scene = IDEAL.replace("PD", "0").replace("ping_rate_hz: 1", "ping_rate_hz: 0.1")
            scene = scene.replace("[60, 0, 10]", "[40, 0, 10]").replace("[100, 0, 10]", f"[{end_m}, 0, 10]")
            fly(folder, folder.write("slow.yaml", scene), 1)
            row, = rows(folder)
            tap.equal(row["outcome"], what)
            late_m = [float(row["distance_m"]) - flown_m, SPEED * float(row["time_s"]) - flown_m]
            tap.equal(all(0 <= late < 0.1 * SPEED for late in late_m), True, f"{row}: {late_m}") # a step of 0.1 s


def test_the_way_is_as_long_as_it_is_flown():
    """Round a corner between two pings as well."""
    with Folder() as folder:
        scene = IDEAL.replace("PD", "0").replace("ping_rate_hz: 1", "ping_rate_hz: 0.05").replace(
            "[100, 0, 10]", "[20, 0, 10], [20, 30, 10], [0, 30, 10]").replace("time_s: 45", "time_s: 100")
        fly(folder, folder.write("corners.yaml", scene), 1)
        row, = rows(folder)
        flown_m = SPEED * float(row["time_s"])
        tap.equal(abs(float(row["distance_m"]) - flown_m) < 0.01 * flown_m, True, f"{row}")


def test_a_hull_of_no_size():
    """A bottom 10 m below is not in its way, 15 m before the wall is in reach; there the wall is."""
    for pd, pfa in ((1, 0), (0, 1)):
        with Folder() as folder:
            scene = IDEAL.replace("PD", f"{pd}, pfa: {pfa}").replace("hull_radius_m: 0.2", "hull_radius_m: 0")
            fly(folder, folder.write("thin.yaml", scene), 1, "--vary", "trial.time_s=10,45")
            short, whole = rows(folder)
            tap.equal([short["manoeuvres"], short["needless"]], 2 * [str(pfa)], str(short))
            tap.equal([whole["manoeuvres"], whole["needless"]], ["1", str(pfa)], str(whole))
            tap.equal(whole["outcome"], "late")


def test_half_a_turn_is_to_starboard():
    """From every heading, also where a sum with half a turn is rounded to more than that."""
    ways = [(x_m, y_m) for x_m in (-40, -30, -20) for y_m in range(1, 60)]
    ways = [way for way in ways if math.remainder(math.atan2(way[1], way[0]) + math.pi - math.atan2(way[1], way[0]),
                                                  2 * math.pi) < 0]
    tap.equal(len(ways) > 2, True, f"{ways}")
    scene = """
version: 1
bottom: {depth_m: 200}
sonar: {frequency_khz: 100, ping_rate_hz: 1, receivers: [{name: ahead}]}
mission: {waypoints: {points_m: [[0, 0, 15], WAY], speed_mps: 1.5}}
trial: {time_s: 4, ideal: {pd: 1, pfa: 1}, rule: {manoeuvre: turn, turn_deg: 180}}
"""
    with Folder() as folder:
        for x_m, y_m in ways[:2]:
            path = folder.write("half.yaml", scene.replace("WAY", f"[{x_m}, {y_m}, 15]"))
            asdic("trial", path, "--replay", 0, "-f", "-o", folder / "run").check(code=0)
            with open(folder / "run/track.csv", encoding="utf-8") as file:
                yaws_deg = [float(row["yaw_deg"]) for row in csv.DictReader(file)]
            tap.equal(yaws_deg[0] + 30 < yaws_deg[-1] < yaws_deg[0] + 180, True, f"{yaws_deg}")


def test_the_cause_is_by_the_first_turn():
    """Three turns to starboard, 300 degrees in all, end at a pillar: one to starboard, begun 20 m before it, would have
    cleared it, one to port would not, for the wall there."""
    walls = """
  - {name: port, box: {size_m: [40, 2, 40]}, position_m: [25, -8, 10]}
  - {name: starboard, box: {size_m: [2, 30, 40]}, position_m: [50, 20, 10]}
  - {name: pillar, box: {size_m: [2, 4, 40]}, position_m: [25, 6, 10]}
sonar:"""
    scene = IDEAL.replace("PD", "1, pfa: 0").replace("turn_deg: 150", "turn_deg: 100").replace("\nsonar:", walls, 1)
    scene = scene.replace("time_s: 45", "time_s: 60").replace("depth_m: 20", "depth_m: 200")
    with Folder() as folder:
        path = folder.write("turns.yaml", scene)
        done = asdic("trial", path, "--replay", 0, "-o", folder / "run").check(code=0)
        tap.contains(done.out + done.err, "hit of pillar, seen late")
        with open(folder / "run/track.csv", encoding="utf-8") as file:
            yaws_deg = [float(row["yaw_deg"]) for row in csv.DictReader(file)]
        tap.equal(yaws_deg[-1] % 360 > 200, True, f"{yaws_deg}")


def meets(begin_m):
    """Whether a turn that begins at BEGIN_M meets the wall."""
    return any(begin_m + x_m >= FRONT - HULL for x_m, _ in turn())


def test_causes_are_told_apart():
    """With a ping every 15 m the wall is first seen 4 m before it, where a turn at the reach of 15 m, between two pings,
    would have cleared it; with one every 1.5 m and a reach of 5 m nothing helps. How far off the wall was when the
    manoeuvre began is known, wherever along it the vehicle met it."""
    for rate_hz, reach_m, begin_m, cause in ((0.1, 15, 55, "seen late"), (1, 5, 54, "could not turn")):
        tap.equal(meets(FRONT - reach_m), cause == "could not turn", f"by the equations: {cause}")
        with Folder() as folder:
            scene = IDEAL.replace("PD", "1, pfa: 0").replace("ping_rate_hz: 1", f"ping_rate_hz: {rate_hz}").replace(
                "reach_m: 20", f"reach_m: {reach_m}").replace("[[0, 0, 10]", "[[10, 0, 10]" if rate_hz < 1 else "[[30, 0, 10]")
            found, = fly(folder, folder.write("late.yaml", scene.replace("depth_m: 20", "depth_m: 200")), 1)
            row, = rows(folder)
            tap.equal((row["outcome"], row["cause"], found[cause]), ("hit", cause, 1), f"{row}")
            tap.equal(abs(float(row["seen_m"]) - (FRONT - begin_m)) < 1e-3, True, f"{row}")


def test_the_reach_is_to_the_obstacle():
    """Of a turn that meets the wall far to the side of where it began: how far off the wall was when it began counts, not
    how far the place that was met. As 10.5 m before the wall are enough to turn, all was seen late."""
    far_m = max(x_m for x_m, _ in turn(90)) + HULL
    tap.equal(far_m < 10, True, f"by the equations a turn takes {far_m} m")
    scene = IDEAL.replace("PD", "0.13, pfa: 0").replace("turn_deg: 150", "turn_deg: 90").replace(
        "reach_m: 20, hold_s: 1000", "reach_m: 10.5, hits: 2, of: 3, hold_s: 20").replace("depth_m: 20", "depth_m: 200")
    scene = scene.replace("[[0, 0, 10]", "[[30, 0, 10]") + "  draws: [{key: 'objects[0].position_m[0]', uniform: [59, 61]}]\n"
    with Folder() as folder:
        found, = fly(folder, folder.write("wide.yaml", scene), 400)
        tap.equal((found["seen late"] > 20, found["could not turn"]), (True, 0), f"{found}")


def test_what_is_met_on_the_way_back_could_not_be_cleared():
    """A vehicle turns round, 19.5 m off a pile, and meets the wall behind which it began, on a way of 36 m that begins 21.5 m
    from it: the same turn, begun there, meets it as well. Half as far again as straight on was too short to say so."""
    pile = "  - {name: pile, box: {size_m: [2, 2, 40]}, position_m: [40, 0, 10]}"
    scene = IDEAL.replace("PD", "1, pfa: 0").replace("turn_deg: 150", "turn_deg: 180").replace("depth_m: 20", "depth_m: 200")
    scene = scene.replace("position_m: [60, 0, 10]}", f"position_m: [-3, 0, 10]}}\n{pile}")
    with Folder() as folder:
        fly(folder, folder.write("back.yaml", scene), 1)
        row, = rows(folder)
        tap.equal((row["what"], row["cause"], float(row["seen_m"])), ("wall", "could not turn", 21.5), f"{row}")
        tap.equal(float(row["distance_m"]) - 19.5 > 1.5 * 21.5, True, f"{row}")


def meet_boat(scene, first_m, end_s, heard_m):
    """A boat, half of it 2 m, comes at 8 m/s from FIRST_M off: it is heard at the first ping of five a second from which it is
    nearer than HEARD_M, and is hit, as nobody can turn that late."""
    off_m = [first_m - step * (8 + 1.5) / 5 for step in range(5 * end_s)]
    with Folder() as folder:
        folder.write("boat.csv", f"time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,{first_m + 2},0,20,0,0,0\n"
                     f"{end_s},{first_m + 2 - 8 * end_s},0,20,0,0,0\n")
        fly(folder, folder.write("boat.yaml", scene), 1)
        row, = rows(folder)
        tap.equal((row["what"], row["cause"]), ("boat", "could not turn"), f"{row}")
        tap.equal(abs(float(row["seen_m"]) - max(m for m in off_m if m < heard_m)) < 0.05, True, f"{row}: {off_m}")


def test_a_boat_that_comes_was_seen_in_time():
    """At 8 m/s, head-on: its bow comes within the reach of 20 m between two pings and is detected at the next, 19.4 m off;
    it is met two seconds later, 3 m ahead, where nobody has turned by its half breadth of 2 m."""
    program.need_device()
    scene = """
version: 1
bottom: {none: true}
objects: [{name: boat, box: {size_m: [4, 4, 4]}, track: boat.csv}]
sonar: {frequency_khz: 100, ping_rate_hz: 5, max_range_m: 40, source_level_db: 200, speckle: rayleigh,
        receivers: [{length_h_m: 0.06, length_v_m: 0.06}]}
mission: {waypoints: {points_m: [[0, 0, 20], [60, 0, 20]], speed_mps: 1.5}}
detector: {pfa: 1.0e-6}
sampling: {rays: 2000}
trial:
  hull_radius_m: 0.2
  rule: {manoeuvre: turn, turn_deg: 90, reach_m: 20}
"""
    meet_boat(scene, FIRST, 9, 20)


def test_an_ideal_sonar_hears_what_is_near():
    """A boat at 8 m/s, head-on, is heard from 20 m on, not while it is 126 m off and holding on for 20 m would meet it."""
    scene = """
version: 1
bottom: {none: true}
objects: [{name: boat, box: {size_m: [4, 4, 4]}, track: boat.csv}]
sonar: {frequency_khz: 100, ping_rate_hz: 5, max_range_m: 40, bin_length_m: 0.5, receivers: [{}]}
mission: {waypoints: {points_m: [[0, 0, 20], [60, 0, 20]], speed_mps: 1.5}}
trial:
  hull_radius_m: 0.2
  ideal: {pd: 1}
  rule: {manoeuvre: turn, turn_deg: 90, reach_m: 20}
"""
    meet_boat(scene, 160, 30, 20.7)


def test_a_boat_does_not_hide_what_stands():
    """A wall is heard at the same ping, as far off as a hull of 1.5 m makes it, whether a boat is far away or 150 m off, on
    its way to where holding on would meet it before the wall."""
    scene = IDEAL.replace("PD", "1").replace("hull_radius_m: 0.2", "hull_radius_m: 1.5").replace("depth_m: 20", "depth_m: 200")
    boat = "  - {name: boat, box: {size_m: [4, 4, 4]}, track: boat.csv}\nsonar:"
    flown = []
    with Folder() as folder:
        for way in None, ("500,0", "600,0"), ("53,500", "53,-137"):
            if way:
                folder.write("boat.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                             f"0,{way[0]},10,0,0,0\n45,{way[1]},10,0,0,0\n")
            path = folder.write("boat.yaml", scene.replace("sonar:", boat, 1) if way else scene)
            asdic("trial", path, "--replay", 0, "-f", "-o", folder / "run").check(code=0)
            with open(folder / "run/track.csv", encoding="utf-8") as file:
                flown.append(file.read())
    tap.equal(flown[1:], 2 * flown[:1])


def test_a_ratio_of_losses_is_a_posterior():
    """To give way for nothing loses 1, to hold on to something L: it is given way from p L = 1 - p on, and seldom later."""
    program.need_device()
    with Folder() as folder:
        scene = EMPTY.replace("pfa: 1.0e-3", "pfa: 0.05")
        tables = []
        for words in "posterior: 0.2", "loss_ratio: 4", "loss_ratio: 0.25":
            fly(folder, folder.write("loss.yaml", scene.replace("posterior: 0", words)), 12)
            tables.append(rows(folder))
        tap.equal(tables[1], tables[0])
        gave_way = [sum(row["manoeuvres"] != "0" for row in table) for table in tables[1:]]
        tap.equal(0 < gave_way[0] > gave_way[1], True, f"{gave_way} of 12 runs")


def test_a_climb_does_not_dive():
    """Not even near the surface: from 0.2 m there is nowhere to climb to, from 2 m half a metre is left."""
    for z_m, least_m in ((0.2, 0.2), (2, 0.5)):
        with Folder() as folder:
            scene = IDEAL.replace("PD", "1, pfa: 1").replace("manoeuvre: turn", "manoeuvre: climb")
            scene = scene.replace("[0, 0, 10], [100, 0, 10]", f"[0, 0, {z_m}], [100, 0, {z_m}]")
            path = folder.write("shallow.yaml", scene)
            asdic("trial", path, "--replay", 0, "-o", folder / "run").check(code=0)
            with open(folder / "run/track.csv", encoding="utf-8") as file:
                depths_m = [float(row["z_m"]) for row in csv.DictReader(file)]
            tap.equal(all(least_m - 0.05 < z <= z_m for z in depths_m), True, f"{depths_m}")
            tap.equal(abs(depths_m[-1] - least_m) < 0.05, True, f"{depths_m}")


def test_a_hold_of_tenths_is_as_long_as_it_says():
    """What lasts until a ping ends there, though neither its time nor the hold is a whole number of bits."""
    scene = EMPTY.replace("ping_rate_hz: 2", "ping_rate_hz: 10").replace("{rule: {", "{ideal: {pd: 0, pfa: 0.3}, rule: {")
    with Folder() as folder:
        for hold_s in (0.3, 0.2999):
            fly(folder, folder.write("tenths.yaml", scene.replace("hold_s: 1000", f"hold_s: {hold_s}")), 20)
            os.rename(folder / "out", folder / f"held_{hold_s}")
        tenths, less = ([row["manoeuvres"] for row in rows(folder, f"held_{hold_s}")] for hold_s in (0.3, 0.2999))
        tap.equal(tenths, less)


def test_what_moves_is_met_where_it_is():
    """A boat of 1 m that crosses the way at 1 m/s when the vehicle is there, at 20 s, or 10 s before: then it is missed
    by |(1.5, 1) x (15, 0)| / |(1.5, 1)| less its radius and the hull's. One of 0.5 m at 25 m/s, which goes 25 m from one
    ping to the next, is met as well, and so is what is a point."""
    ball = "sphere: {radius_m: 1}"
    cases = ((ball, 1, 0, "hit", 20 - 1.2 / math.hypot(1.5, 1)), (ball, 1, 10, "late", 15 / math.hypot(1.5, 1) - 1.2),
             ("sphere: {radius_m: 0.5}", 25, 0, "hit", 20 - 0.7 / math.hypot(1.5, 25)),
             ("point: -20", 1, 0, "hit", 20 - 0.2 / math.hypot(1.5, 1)))
    scene = WALL.replace("depth_m: 20", "depth_m: 200").replace("time_s: 45", "time_s: 30") + "  ideal: {pd: 1.0e-9}\n"
    i, j = scene.index("  - {name: wall"), scene.index("sonar:")
    for what, speed_mps, lead_s, outcome, expected in cases:
        with Folder() as folder:
            ways = [speed_mps * (t - 20 + lead_s) for t in (0, 60)]
            folder.write("boat.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                         f"0,30,{ways[0]},10,0,0,0\n60,30,{ways[1]},10,0,0,0\n")
            boat = "  - {name: boat, " + what + ", track: boat.csv}\n"
            fly(folder, folder.write("cross.yaml", scene[:i] + boat + scene[j:]), 1)
            row, = rows(folder)
            tap.equal(row["outcome"], outcome, f"{what}: {row}")
            if outcome == "hit":
                tap.equal(row["what"], "boat")
                tap.equal(0 <= float(row["time_s"]) - expected < 0.11, True, f"met at {expected} s, to a step: {row}")
            else:
                tap.equal(abs(float(row["clearance_m"]) - expected) < 0.02, True, f"{expected} m: {row}")


def test_intervals_cover():
    """Of many intervals of 95 % that many hold the closed form's probability: Clopper and Pearson's
    hold it a little more often. 20 seeds in the full tier; blocks of runs of them."""
    seeds, runs, block = (20, 10000, 500) if FULL else (4, 500, 50)
    wanted, held, blocks = 0.8 ** chances(), 0, 0
    with Folder() as folder:
        path = folder.write("wall.yaml", CLOSE.replace("PD", "0.2"))
        for seed in range(1, seeds + 1):
            fly(folder, path, runs, "--seed", seed)
            hits = [row["outcome"] == "hit" for row in rows(folder)]
            for first in range(0, len(hits), block):
                events, blocks = sum(hits[first:first + block]), blocks + 1
                low, high = clopper_pearson(events, block)
                held += low <= wanted <= high
    print(f"# {held} of {blocks} intervals hold {wanted:.4f}")
    least = 0.93 if FULL else 0.85 # of 40, so few in one of ten thousand cases
    assert least <= held / blocks, (held, blocks)
    assert not FULL or held / blocks <= 0.97, (held, blocks)


@functools.cache
def clopper_pearson(k, n):
    def tail(p, least, most):
        return sum(math.exp(math.lgamma(n + 1) - math.lgamma(j + 1) - math.lgamma(n - j + 1)
                            + j * math.log(p) + (n - j) * math.log1p(-p)) for j in range(least, most + 1))

    def solve(good):
        low, high = 1e-12, 1 - 1e-12
        for _ in range(50):
            middle = (low + high) / 2
            low, high = (middle, high) if good(middle) else (low, middle)
        return low
    return (solve(lambda p: tail(p, k, n) < 0.025) if k else 0.0,
            solve(lambda p: tail(p, 0, k) > 0.025) if k < n else 1.0)


def test_bounds_are_those_of_clopper_and_pearson():
    with Folder() as folder:
        path = folder.write("wall.yaml", IDEAL.replace("PD", "0.1"))
        found, = fly(folder, path, 200)
        low, high = clopper_pearson(found["hit"], 200)
        for a, b in zip(found["collision"], (found["hit"] / 200, low, high)):
            assert abs(a - b) < 1e-6, (found["collision"], low, high)


def test_false_alarms_are_those_of_the_design():
    """Over an empty bottom a run gives way to nothing as often as one of its bins exceeds. Of K speckle, which is spiky
    where sand is heard and not where noise is: thresholds know the noise's share of each bin."""
    program.need_device()
    runs = 10000 if FULL else 200
    spiky = EMPTY.replace("speckle: rayleigh", "speckle: k\n  speckle_shape: 0.5").replace(
        "source_level_db: 200", "source_level_db: 154")
    for name, scene in ("rayleigh", EMPTY), ("k", spiky):
        with Folder() as folder:
            found, = fly(folder, folder.write("empty.yaml", scene), runs)
            pings, bins = found["pings"] // runs, 40
            tap.equal(found["pings"], pings * runs)
            wanted = 1 - (1 - 1e-3) ** (bins * pings)
            events = round(found["needless"][0] * runs)
            print(f"# {name}: {events} of {runs} runs of {pings} pings, {wanted * runs:.1f} by design")
            assert within_99(events, runs, wanted), (name, events, runs, wanted)


def test_pairs_need_fewer_runs():
    with Folder() as folder:
        path = folder.write("wall.yaml", CLOSE.replace("PD", "0.10"))
        runs = 10000 if FULL else 400
        first, second = fly(folder, path, runs, "--vary", "trial.ideal.pd=0.10,0.12")
        hits = {}
        for row in rows(folder):
            hits.setdefault(row["run"], []).append(row["outcome"] == "hit")
        worse = sum(a and not b for a, b in hits.values())
        better = sum(b and not a for a, b in hits.values())
        difference = (better - worse) / runs
        assert abs(second["difference"][0] - difference) < 1e-8, (second, difference)
        assert second["difference"][1] < difference < second["difference"][2]
        p, q = first["collision"][0], second["collision"][0]
        share = ((worse + better) / runs - difference ** 2) / (p * (1 - p) + q * (1 - q))
        assert abs(second["paired_share"] - share) < 1e-8, (second, share)
        assert share < 0.25, share
        print(f"# pairs take {share:.3f} of the runs of designs flown apart")


def test_what_is_varied_is_not_drawn():
    """A value of --vary stands in place of a draw of the same key, also of one that names a file."""
    with Folder() as folder:
        for name, rate in (("slow", 1), ("fast", 4)):
            folder.write(name + ".yaml", f"frequency_khz: 100\nping_rate_hz: {rate}\nspeckle: rayleigh\n"
                         "source_level_db: 200\nmax_range_m: 40\nbin_length_m: 0.5\n"
                         "receivers: [{name: forward, length_h_m: 0.05, length_v_m: 0.05}]\n")
        sonar = IDEAL[IDEAL.index("sonar:"):IDEAL.index("mission:")]
        path = folder.write("wall.yaml", IDEAL.replace("PD", "0.1").replace(
            sonar, "sonar: {file: slow.yaml}\n") + """  draws:
    - {key: sonar.file, choice: [slow.yaml, fast.yaml]}
    - {key: 'objects[0].position_m[0]', uniform: [59, 65]}
""")
        for key, values in (("sonar.file", ("slow.yaml", "fast.yaml")),
                            ("objects[0].position_m[0]", ("61", "64"))):
            asdic("trial", path, "--runs", 6, "--vary", f"{key}={','.join(values)}", "-o",
                  folder / "out", "-f").check(code=0)
            found = rows(folder)
            tap.equal([row[key] for row in found], list(values) * 6)
            late = [(row["run"], int(row["pings"])) for row in found if row["outcome"] == "late"]
            if key == "sonar.file":
                tap.equal(sorted({pings for _, pings in late}), [45, 180])


def test_designs_of_whole_maps_share_their_runs():
    """Of a run all designs have one seed and what is drawn, also where a map or list is varied that either is in; runs
    have other ones. The rays that are asked for are flown."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("wall.yaml", WALL.replace("time_s: 45", "time_s: 2") + """  draws:
    - {key: environment.wind_speed_kn, uniform: [0, 30]}
    - {key: 'objects[0].position_m[1]', uniform: [-3, 3]}
""")
        thin, thick = (f"[{{name: wall, box: {{size_m: [{size}, 400, 40]}}, position_m: [60, 0, 10]}}]" for size in (1, 2))
        seeds = set()
        for vary, rays in (("sampling={rays: 500},{rays: 600}", 3000), (f"objects={thin},{thick}", 3000),
                           ("environment={temperature_degc: 5},{temperature_degc: 15}", 1000)):
            options = ("--runs", 2, "--vary", vary, *(("--rays", rays) if rays != 1000 else ()))
            asdic("trial", path, *options, "-o", folder / "out", "-f").check(code=0)
            for row in rows(folder):
                tap.equal(row["environment.wind_speed_kn"], rows(folder)[int(row["run"]) * 2]["environment.wind_speed_kn"])
                asdic("trial", path, *options, "--replay", f"{row['run']}:{row['variant']}", "-o", folder / "again",
                      "-f").check(code=0)
                scene = folder.read("again/scene.yaml")
                tap.contains(scene, f"wind_speed_kn: {row['environment.wind_speed_kn']}\n")
                tap.contains(scene, f"[60, {row['objects[0].position_m[1]']}, 10]")
                tap.contains(scene, f"rays: {rays}\n")
                seeds.add((row["run"], re.search(r"seed: (\d+)", scene)[1]))
        tap.equal((len(seeds), len({seed for _, seed in seeds})), (2, 2), f"{sorted(seeds)}")
        asdic("trial", path, "--runs", 1, "--vary", f"objects=[],{thin}", "-o", folder / "out", "-f").check(code=0)
        tap.equal([row["objects[0].position_m[1]"] == "" for row in rows(folder)], [True, False], "drawn where there is one")
        for key, what in (("objects[0].postion_m[1]", "unknown key 'postion_m'; did you mean 'position_m'?"),
                          ("objects[1].position_m[1]", "cannot set 'objects[1].position_m[1]'"),
                          ("objects[0].position_m[7]", "'position_m' has no entry '[7]'")):
            folder.write("wall.yaml", folder.read("wall.yaml").replace("objects[0].position_m[1]", key))
            done = asdic("trial", path, "--runs", 1, "--vary", f"objects={thin},{thick}", "-o", folder / "no").check(code=3)
            tap.contains(done.err, what)
            folder.write("wall.yaml", folder.read("wall.yaml").replace(key, "objects[0].position_m[1]"))


def test_detectors_without_mirrors_are_told_of():
    """What is expected over a plane knows no mirrored echoes; where none are simulated, or nothing is expected, no word."""
    program.need_device()
    quick = WALL.replace("time_s: 45", "time_s: 1")
    mirrors = quick.replace("rays: 1000", "rays: 1000, multipath: boundaries")
    with Folder() as folder:
        for text, warns in ((quick, 0), (mirrors, 1), (mirrors + "  background: ca\n", 0),
                            (mirrors + "  ideal: {pd: 0.5}\n", 0)):
            path = folder.write("wall.yaml", text)
            done = asdic("trial", path, "--runs", 1, "-o", folder / "out", "-f").check(code=0)
            tap.equal(done.err.count("expects no echoes that surface and bottom mirror"), warns, done.err)
        spiky = quick.replace("speckle: rayleigh", "speckle: k\n  speckle_shape: 1")
        for text, warns in ((spiky, 0), (spiky + "  background: os\n", 1), (quick + "  background: os\n", 0),
                            (spiky.replace("pfa: 1.0e-4", "cost_ratio: 100") + "  background: os\n", 0)):
            path = folder.write("wall.yaml", text)
            done = asdic("trial", path, "--runs", 1, "-o", folder / "out", "-f").check(code=0)
            tap.equal(done.err.count("K speckle exceeds them more often"), warns, done.err)


def test_means_are_told_of():
    """Levels without speckle have no false alarms: in whichever design, once; not where none is simulated."""
    program.need_device()
    quick = WALL.replace("time_s: 45", "time_s: 1")
    means = quick.replace("  speckle: rayleigh\n", "")
    rule = f"exec {sys.executable} -u -c 'for line in __import__(\"sys\").stdin: print(\"{{}}\")'"
    with Folder() as folder:
        for text, options, warns in ((quick, (), 0), (means, (), 1), (means + "  ideal: {pd: 0.5}\n", (), 0),
                                     (means, ("--rule", rule), 1),
                                     (quick, ("--vary", "sonar.speckle=rayleigh,none,none"), 1)):
            path = folder.write("wall.yaml", text)
            done = asdic("trial", path, "--runs", 1, *options, "-o", folder / "out", "-f").check(code=0)
            tap.equal(done.err.count("of which none is a false alarm"), warns, done.err)


def test_without_a_limit_a_run_may_take_thrice_its_way():
    with Folder() as folder:
        scene = IDEAL.replace("PD", "1, pfa: 1").replace("  time_s: 45\n", "").replace("[100, 0, 10]", "[30, 0, 10]")
        fly(folder, folder.write("off.yaml", scene), 1)
        row, = rows(folder)
        tap.equal((row["outcome"], 60 <= float(row["time_s"]) <= 61), ("late", True), f"{row}")  # of 20 s


def test_a_run_ends_in_time():
    """Not at the ping after that: what would be hit 1.2 s later, before it, is not. Nor with a ping more, where sums of
    tenths are a little less than they should be."""
    with Folder() as folder:
        scene = IDEAL.replace("PD", "0").replace("[60, 0, 10]", "[40, 0, 10]")
        path = folder.write("end.yaml", scene.replace("ping_rate_hz: 1", "ping_rate_hz: 0.1"))
        fly(folder, path, 1, "--vary", "trial.time_s=24.5,26.5")
        before, after = rows(folder)
        tap.equal((before["outcome"], before["time_s"], before["distance_m"], before["pings"]),
                  ("late", "24.5", "36.75", "3"))
        tap.equal((after["outcome"], float(after["time_s"]) < 26.1), ("hit", True), f"{after}")
        path = folder.write("tenths.yaml", scene.replace("ping_rate_hz: 1", "ping_rate_hz: 10"))
        ends = [0.1 * k for k in (3, 6, 7, 12, 14, 17, 19, 23, 24, 28, 33, 34, 46, 57, 67, 69)]
        fly(folder, path, 1, "--vary", "trial.time_s=" + ",".join(f"{end:.1f}" for end in ends))
        tap.equal([(row["time_s"], row["pings"]) for row in rows(folder)],
                  [(f"{end:.9g}", f"{10 * end:.0f}") for end in ends])


def test_a_scanned_head_is_turned():
    """What a head that goes round hears astern is not ahead, and it turns away from what it hears abeam."""
    program.need_device()
    scene = """
version: 1
bottom: none
objects: [{name: ball, sphere: {radius_m: 2}, position_m: PLACE, material: {type: rock}}]
sonar:
  {frequency_khz: 100, ping_rate_hz: 1, max_range_m: 30, source_level_db: 160,
   scan: {sector_deg: 360, step_deg: 90}, receivers: [{name: head, length_h_m: 0.06, length_v_m: 0.06}]}
mission: {waypoints: {points_m: [[0, 0, 50], [60, 0, 50]], speed_mps: 1.5}}
sampling: {rays: 2000}
trial: {time_s: 7, rule: {manoeuvre: turn, reach_m: 15, sector_deg: SECTOR}}
"""
    for place, sector_deg, side in (([-12, 0, 50], 20, 0), ([4, 12, 50], 180, -1), ([4, -12, 50], 180, 1)):
        with Folder() as folder:
            path = folder.write("scan.yaml", scene.replace("PLACE", str(place)).replace("SECTOR", str(sector_deg)))
            asdic("trial", path, "--replay", 0, "-o", folder / "run").check(code=0)
            with open(folder / "run/track.csv", encoding="utf-8") as file:
                yaws_deg = [float(row["yaw_deg"]) for row in csv.DictReader(file)]
            tap.equal((yaws_deg[-1] > 5) - (yaws_deg[-1] < -5), side, f"ball at {place}: {yaws_deg}")


def test_draws_into_the_bottom_are_counted():
    with Folder() as folder:
        draws = "  draws:\n    - {key: 'mission.waypoints.points_m[0][2]', uniform: [LOW, HIGH]}\n"
        path = folder.write("wall.yaml", IDEAL.replace("PD", "0.1") + draws.replace(
            "LOW", "15").replace("HIGH", "25"))
        done = asdic("trial", path, "--runs", 40, "-o", folder / "out", "--json").check(code=0)
        found, = json.loads(done.out)["variants"]
        below = [float(row["mission.waypoints.points_m[0][2]"]) > 19.8 for row in rows(folder)]
        tap.equal([row["outcome"] == "void" for row in rows(folder)], below)
        tap.equal((found["void"], found["runs"]), (sum(below), 40 - sum(below)))
        tap.contains(done.err, f"{sum(below)} runs are void")
        path = folder.write("deep.yaml", IDEAL.replace("PD", "0.1") + draws.replace(
            "LOW", "21").replace("HIGH", "25"))
        done = asdic("trial", path, "--runs", 4, "-o", folder / "deep").check(code=1)
        tap.contains(done.err, "no run could be flown")
        tap.equal("nan" in done.out or "inf" in done.out, False, done.out)
        key = "mission.waypoints.points_m[0][2]"
        done = asdic("trial", path, "--runs", 4, "--vary", f"{key}=10,25", "-o", folder / "half").check(code=0)
        tap.equal(done.out.splitlines()[-1].split(), [key, "=", "25", "-", "-", "-"], done.out)


def test_pings_of_the_scene_may_be_more_than_a_run_flies():
    """They are those of 'asdic run'; where a draw shortens the way a trial goes on."""
    with Folder() as folder:
        scene = IDEAL.replace("PD", "0").replace("response_s: 1}", "response_s: 1}\n  pings: 60")
        draws = "  draws: [{key: 'mission.waypoints.points_m[1][0]', uniform: [20, 120]}]\n"
        path = folder.write("way.yaml", scene + draws)
        asdic("trial", path, "--runs", 10, "-o", folder / "out").check(code=0)
        asdic("trial", path, "--runs", 10, "--replay", 0, "-o", folder / "again").check(code=0)


def test_none_is_a_word_in_json_too():
    """Where it stands in quotes: an object that is drawn so is gone."""
    with Folder() as folder:
        scene = IDEAL.replace("PD", "1") + """  draws:
    - {key: "objects[0]", choice: ["none", {"choice": ["none"]}]}
"""
        fly(folder, folder.write("empty.yaml", scene), 4)
        tap.equal([row["objects[0]"] for row in rows(folder)], 4 * ["none"])
        tap.equal({row["manoeuvres"] for row in rows(folder)}, {"0"})


def test_draws_do_not_undo_each_other():
    """What holds a part is drawn before it, and a key once; a part of the water stays where all of it is drawn."""
    with Folder() as folder:
        ideal = IDEAL.replace("PD", "0")
        ball = "{name: ball, sphere: {radius_m: 1}, position_m: [30, 0, 15]}"
        part = "    - {key: 'objects[0].position_m[0]', uniform: [10, 11]}\n"
        whole = f"    - {{key: 'objects[0]', choice: [{ball}]}}\n"

        def flown(draws, code=0):
            path = folder.write("draws.yaml", ideal + "  draws:\n" + draws)
            return asdic("trial", path, "--runs", 2, "-o", folder / "out", "-f").check(code=code).err
        tap.contains(flown(part + whole, 3), "'objects[0]' is drawn after its part 'objects[0].position_m[0]', which")
        tap.contains(flown(part + part, 3), "'objects[0].position_m[0]' is drawn at line ")
        flown(whole + part)
        flown("    - {key: environment, choice: [{salinity_ppt: 5, wind_speed_kn: 4}]}\n"
              "    - {key: environment.salinity_ppt, uniform: [30, 31]}\n")
        asdic("trial", folder / "draws.yaml", "--runs", 2, "--replay", 0, "-o", folder / "run").check(code=0)
        tap.contains(folder.read("run/scene.yaml"), "salinity_ppt: " + rows(folder)[0]["environment.salinity_ppt"])
        folder.write("own.yaml", "{frequency_khz: 100, ping_rate_hz: 1, receivers: [{name: a}]}\n")
        flown("    - {key: sonar, choice: [{file: own.yaml}]}\n")


def test_scenes_and_options_that_cannot_be():
    with Folder() as folder:
        def refuse(text, code, sentence, *options):
            path = folder.write("bad.yaml", text)
            done = asdic("trial", path, "--runs", 5, "-o", folder / "bad", *options).check(code=code)
            tap.contains(done.err, sentence)
        ideal = IDEAL.replace("PD", "0.1")
        refuse(ideal.replace("waypoints: {points_m: [[0, 0, 10], [100, 0, 10]], speed_mps: 1.5, "
                             "turn_radius_m: 5, response_s: 1}", "pose: {position_m: [0, 0, 10]}"),
               3, "a trial flies along 'mission: {waypoints: ...}'")
        refuse(ideal + "  draws: [{key: environment.salnity_ppt, uniform: [1, 2]}]\n", 3,
               "did you mean 'salinity_ppt'")
        refuse(ideal + "  draws: [{key: environment.salinity_ppt, uniform: [0, 60]}]\n", 3,
               f"'salinity_ppt' = 60 is out of range [0, 45] ppt  [trial.draws[0]]\nerror: {folder / 'bad.yaml'}: 1 error\n")
        shutil.rmtree(folder / "bad")
        # Tails of a later run, also by what keys say together: it is named before any run is flown.
        for key, mean, sd, words in (("environment.salinity_ppt", 30, 6, "is out of range [0, 45] ppt  [environment.sal"),
                                     ("mission.waypoints.points_m[0][2]", 5, 2, "m above the sea surface")):
            draws = f"  draws: [{{key: '{key}', normal: [{mean}, {sd}]}}]\n"
            asdic("trial", folder.write("few.yaml", ideal + draws), "--runs", 2, "-o", folder / "few", "-f").check(code=0)
            refuse(ideal + draws, 3, words, "--runs", 1000)
            refuse(ideal + draws, 3, " with seed 1; keep what is drawn to what a scene may have, tails of 'normal' by "
                   "'within'", "--runs", 1000)
            tap.equal(os.path.exists(folder / "bad"), False, "flown before the error")
        mesh = "{name: ball, mesh: no.ply, position_m: [40, 0, 30]}"
        refuse(ideal + f"  draws: [{{key: 'objects[0]', choice: [none, none, none, none, {mesh}]}}]\n", 3,
               f"no.ply: cannot open: No such file or directory  [objects[0].mesh.file]\nerror: {folder / 'bad.yaml'}: 1 error\n")
        tap.equal(os.path.exists(folder / "bad"), False, "flown before the error")
        refuse(ideal + "  draws: [{key: 'objects[4].position_m', choice: [[1, 2, 3]]}]\n", 3,
               "there is no '[4]' here")
        refuse(ideal + "  draws: [{key: 'mission.waypoints.current_mps[1]', uniform: [0, 1]}]\n", 3,
               "there is no 'current_mps[1]' here  [trial.draws[0].key]\n"
               f"error: {folder / 'bad.yaml'}: 1 error, as drawn")
        refuse(ideal.replace("hold_s: 1000", "hits: 3, of: 2"), 3, "'hits' = 3 is more than 'of' = 2")
        refuse(ideal, 2, "is not KEY=VALUE", "--vary", "nonsense")
        for run in ("3:1", "99999999999999999999", " -1", "-1", "1:-0", "1:", ":0", "1:0:0"):
            refuse(ideal, 2, "is no RUN or RUN:VARIANT", "--replay=" + run)
        refuse(ideal, 2, "--rule-timeout needs --rule", "--rule-timeout", "3")
        refuse(ideal, 2, "--force starts afresh and --resume goes on; give one of them", "--force", "--resume")
        done = asdic("trial", "-", "-o", folder / "none", stdin=ideal).check(code=2)
        tap.contains(done.err, "the scene is read for every run; it must be a file")
        refuse(ideal, 2, "'trial: {ideal: ...}' makes no pings that a rule of another program (--rule) could read; take "
               "'ideal' out, or fly by the scene's own rule", "--rule", "cat")
        refuse(ideal, 2, "'sampling.seed' cannot be varied", "--vary", "sampling.seed=5,6")
        refuse(ideal, 2, "'sampling.rays' cannot be varied", "--vary", "sampling.rays=500,600", "--rays", 700)
        refuse(ideal + "  draws: [{key: sampling.seed, choice: [7, 8]}]\n", 3, "'sampling.seed' cannot be drawn")
        refuse(ideal, 2, "there is no program './mistyped.py --fast'", "--rule", "./mistyped.py --fast")


def test_an_ideal_sonar_has_no_rays():
    words = "the trial's sonar is 'ideal' and casts no rays: --rays and --tolerance change nothing"
    with Folder() as folder:
        path = folder.write("ideal.yaml", CLOSE.replace("PD", "1"))
        for options, times in ((), 0), (("--rays", 100), 1):
            done = asdic("trial", path, "--runs", 2, *options, "-o", folder / "out", "-f").check(code=0)
            tap.equal(done.err.count(words), times, done.err)


def test_a_run_can_be_seen_again():
    """A replay is a run folder whose pings are those of the trial: the same rule sees the same."""
    program.need_device()
    with Folder() as folder:
        # A run of the scene would do without the gradient; the trial follows it.
        wall = WALL.replace("version: 1\n", "version: 1\nenvironment: {sound_speed_gradient_per_s: 0.002}\n")
        path = folder.write("wall.yaml", wall.replace("time_s: 45", "time_s: 33") + """  draws:
    - {key: 'objects[0].position_m[0]', uniform: [55, 65]}
""")
        asdic("trial", path, "--runs", 3, "--workers", 1, "-o", folder / "out").check(code=0)
        done = asdic("trial", path, "--runs", 3, "--replay", 2, "-o", folder / "again").check(code=0)
        tap.contains(done.err, f"'asdic view {folder / 'again'}/scene.yaml' shows it")
        before = data(folder, "again", "track.csv"), data(folder, "again", "scene.yaml")
        done = asdic("trial", path, "--runs", 3, "--replay", 1, "-o", folder / "again").check(code=1)
        tap.contains(done.err, "holds a scene, a track or a run already; use --force")
        tap.equal((data(folder, "again", "track.csv"), data(folder, "again", "scene.yaml")), before, "the first")
        asdic("render", folder / "again").check(code=0)
        shutil.copy(path, folder / "scene.yaml")
        own = folder.read("scene.yaml")
        done = asdic("trial", folder / "scene.yaml", "--runs", 3, "--replay", 1, "-o", folder.path, "-f").check(code=1)
        tap.contains(done.err, "is the trial's own scene")
        tap.equal(folder.read("scene.yaml") == own, True, "the trial's scene")
        row = rows(folder)[2]
        with open(folder / "again/track.csv", encoding="utf-8") as file:
            track = list(csv.DictReader(file))
        tap.equal(len(track), int(row["pings"]))
        x_m = row["objects[0].position_m[0]"]
        tap.contains(folder.read("again/scene.yaml"), f"position_m: [{x_m}, 0, 10]")
        tap.contains(folder.read("again/scene.yaml"), "refraction: full")
        # Serve at the same poses of the same scene gives the same levels.
        poses = "".join("%s,%s,%s,%s,%s,%s,%s\n" % tuple(p[c] for c in (
            "time_s", "x_m", "y_m", "z_m", "roll_deg", "pitch_deg", "yaw_deg")) for p in track[:5])
        served = asdic("serve", folder / "again/scene.yaml", "-q", stdin=poses).check(code=0)
        levels = {}
        with open(folder / "again/bins.csv", encoding="utf-8") as file:
            for bins in csv.DictReader(file):
                levels.setdefault(int(bins["ping"]), []).append(bins["level_db"])
        for line in served.out.splitlines():
            ping = json.loads(line)
            values = ["" if v is None else "%.9g" % v for v in ping["level_db"]["forward"]]
            tap.equal(values, levels[ping["ping"]])
        # And it is seen in the viewer.
        seen = asdic("view", folder / "again/scene.yaml", "--snapshot", "1", "--pings", "2", "--size", "960x540",
                     "-o", folder / "v")
        if "needs cairo" not in seen.err:
            seen.check(code=0)
            with open(folder / "v/view_1.png", "rb") as file:
                tap.equal(file.read(8), b"\x89PNG\r\n\x1a\n")


if FULL:
    for name in [name for name in globals() if name.startswith("test_")]:
        if name not in ("test_a_wall_and_a_sonar_of_fixed_pd", "test_intervals_cover",
                        "test_false_alarms_are_those_of_the_design", "test_pairs_need_fewer_runs"):
            del globals()[name]
tap.main(globals())
