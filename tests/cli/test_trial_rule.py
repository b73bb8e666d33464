"""Rules of other programs: what a trial tells them, what it flies of what they say, how they fail."""
import csv
import json
import os
import signal
import subprocess
import sys
import time

import program
import tap
from program import Folder, asdic
from trial_wall import HULL, WALL, fly, rows

RULE = """
import json, sys
for line in sys.stdin:
    ping = json.loads(line)
    near = [d for d in ping["detections"] if d["range_m"] <= 20]
    ACT
"""


def with_rule(folder, act, *options, runs=2, code=0, **env):
    """By one worker: each has a simulator of its own to set up."""
    rule = folder.write("rule.py", RULE.replace("ACT", act))
    scene = folder.write("wall.yaml", WALL.replace("time_s: 45", "time_s: 30"))
    workers = () if "--replay" in options else ("--workers", 1)
    return asdic("trial", scene, "--runs", runs, *workers, "-o", folder / "out", "-f", "--rule",
                 f"exec {sys.executable} -u {rule}", *options, **env).check(code=code)


def test_a_rule_of_another_program():
    """It may do as the scene's rule does, and what it orders is flown."""
    program.need_device()
    with Folder() as folder:
        for holds in "print('{}')", r"sys.stdout.write('{}\r\n')", 'print(json.dumps({"yaw_deg": None, "why": {"near": [1, "\\"2\\""]}}))':
            with_rule(folder, holds)
            tap.equal([row["manoeuvres"] for row in rows(folder)], ["0", "0"])
        # Its first orders are seen again.
        act = 'print(json.dumps({"yaw_deg": 90} if ping["ping"] >= 10 else {}))'
        with_rule(folder, act, "--replay", "1", runs=2)
        with open(folder / "out/track.csv", encoding="utf-8") as file:
            track = list(csv.DictReader(file))
        yaws = [float(row["yaw_deg"]) for row in track]
        tap.equal((len(track), yaws[:11], 80 < yaws[-1] < 91), (30, 11 * [0.0], True), f"{yaws}")
        with_rule(folder, 'print(json.dumps({"yaw_deg": 150} if ping["ping"] >= 10 else {}))')
        for row in rows(folder):
            tap.equal((row["manoeuvres"], row["needless"], row["outcome"]), ("1", "1", "late"))


def test_another_rule_is_another_trial():
    """Also that of another program, or of one with other arguments: what it flew is not another's rest, nor its part."""
    program.need_device()
    with Folder() as folder:
        rule = f"exec {sys.executable} -u {folder.write('rule.py', RULE.replace('ACT', 'print(json.dumps({}))'))}"
        scene = folder.write("wall.yaml", WALL.replace("time_s: 45", "time_s: 2"))

        def command(*options):
            return asdic("trial", scene, "--runs", 2, "--workers", 1, *options)

        command("--rule", f"{rule} a", "-o", folder / "out").check(code=0)
        tap.equal(json.loads(folder.read("out/trial.json"))["command"], f"{rule} a")
        command("--rule", f"{rule} a", "-o", folder / "out", "--resume").check(code=0)
        for options in ("--rule", f"{rule} b"), ():
            tap.contains(command(*options, "-o", folder / "out", "--resume").check(code=1).err, "holds another trial")
        for k in "12":
            command("--rule", f"{rule} {k}", "--shard", f"{k}/2", "-o", folder / k).check(code=0)
        tap.contains(asdic("merge", folder / "1", folder / "2", "-o", folder / "all").check(code=3).err,
                     "parts of different trials")


# What docs/trials.md says of the rule, from what a program is told.
FOLLOW = """
import json, math, sys
rule, beams = json.loads(sys.argv[1]), json.loads(sys.argv[2])
for line in sys.stdin:
    ping = json.loads(line)
    if ping["ping"] == 0:
        history, order, until = [], {}, 0
    near = [d for d in ping["detections"] if d["range_m"] <= rule["reach_m"]
            and abs(beams[d["beam"]]) <= rule["sector_deg"]
            and 1 / (1 + math.exp(-d["llr"]) * 0.99 / 0.01) >= rule["posterior"]]
    history = (history + [len(near) > 0])[-rule["of"]:]
    if near and sum(history) >= rule["hits"]:
        side = -1 if beams[max(near, key=lambda d: d["llr"])["beam"]] > 0 else 1
        if "climb_m" in rule:
            order = {"z_m": min(order.get("z_m", 1e9), ping["z_m"] - rule["climb_m"])}
        elif not order or abs(math.remainder(order["yaw_deg"] - ping["yaw_deg"], 360)) < math.degrees(0.1):
            order = {"yaw_deg": ping["yaw_deg"] + side * rule["turn_deg"]}
        until = ping["time_s"] + rule["hold_s"]
    elif ping["time_s"] >= until:
        order = {}
    print(json.dumps(order), flush=True)
"""


def test_a_program_that_keeps_the_scenes_rule_flies_as_it():
    """Ping by ping: reach, sector, posterior, hits, the side to turn to, how long to hold, and back to the waypoints."""
    program.need_device()
    beams = {"port": -30, "ahead": 0, "starboard": 30}
    rules = ({"turn_deg": 40, "reach_m": 20, "sector_deg": 180, "posterior": 0.02, "hits": 2, "of": 3, "hold_s": 3.5},
             {"turn_deg": 70, "reach_m": 30, "sector_deg": 20, "posterior": 0.05, "hits": 1, "of": 1, "hold_s": 2.5},
             {"climb_m": 1.5, "reach_m": 25, "sector_deg": 30, "posterior": 0.03, "hits": 3, "of": 6, "hold_s": 4.5})
    fans = ", ".join(f"{{name: {name}, yaw_deg: {yaw}, length_h_m: 0.05, length_v_m: 0.05}}" for name, yaw in beams.items())
    scene = WALL.replace("[{name: forward, length_h_m: 0.05, length_v_m: 0.05}]", f"[{fans}]").replace(
        "pfa: 1.0e-4", "pfa: 0.01").replace("speckle:", "bandwidth_khz: 1.5\n  speckle:").replace(
        "depth_m: 20", "depth_m: 200").replace("[0, 0, 10], [100, 0, 10]", "[0, 0, 60], [100, 0, 60]").replace(
        "[60, 0, 10]", "[60, 0, 60]").replace("source_level_db: 200", "source_level_db: 154")
    columns = ("outcome", "what", "pings", "manoeuvres", "needless")
    manoeuvres = 0
    for rule in rules:
        with Folder() as folder:
            what = "manoeuvre: " + ("climb" if "climb_m" in rule else "turn") + ", "
            own = what + ", ".join(f"{key}: {value}" for key, value in rule.items())
            path = folder.write("own.yaml", scene.replace("manoeuvre: turn, turn_deg: 150, reach_m: 20, hold_s: 1000", own))
            other = folder.write("follow.py", FOLLOW)
            fly(folder, path, 6)
            wanted = rows(folder)
            fly(folder, path, 6, "--rule", f"exec {sys.executable} {other} '{json.dumps(rule)}' '{json.dumps(beams)}'")
            for a, b in zip(wanted, rows(folder)):
                tap.equal([b[c] for c in columns], [a[c] for c in columns], f"{rule}: {a}")
                for column in "time_s", "distance_m", "clearance_m":
                    tap.equal(abs(float(a[column]) - float(b[column])) < 1e-6, True, f"{rule}: {a}, {b}")
                manoeuvres += int(a["manoeuvres"])
    tap.equal(manoeuvres > 30, True, f"{manoeuvres} manoeuvres")


def test_rules_that_fail_are_counted():
    program.need_device()
    with Folder() as folder:
        for act, sentence in (("sys.exit(3)", "the rule ended with code 3 without an answer"),
                              ("import os; os.kill(os.getpid(), 9)", "the rule was ended by signal 9"),
                              ('print("starboard")', "the rule answered 'starboard': column 1"),
                              ('print(json.dumps({"z_m": -3}))', "z_m = -3, out of range"),
                              ('print(json.dumps({"yaw_deg": 1e300}))', "yaw_deg = 1e+300, beyond 5.72958e+08 degrees"),
                              ('print(json.dumps({"pitch_deg": 4}))', "asks for pitch_deg; it can ask for z_m and"),
                              ('print(json.dumps({"heading_deg": 90}))', "unknown name 'heading_deg'; did you mean 'yaw_deg'?"),
                              ('print(json.dumps({"yaw_deg": 90, "depth_m": 5}))', "did you mean 'z_m'? (it can ask for z_m and"),
                              ('print(json.dumps({"turn": True}))', "none of the names is known; they are"),
                              ('print("{" + 2000 * " " + "}")', "longer than 1023 characters"),
                              ('print("{}\\n{}")', "answered a ping with more than a line"),
                              ("import time; time.sleep(60)", "did not answer within 0.5 s")):
            done = with_rule(folder, act, "--rule-timeout", "5" if "sleep" not in act else "0.5", code=1)
            tap.contains(done.err, sentence)
            tap.contains(done.err, "the rule failed in 2 runs")
            # They end where they begin, or a ping after one answer: 10 m above the bottom, less the hull.
            for row in rows(folder):
                tap.equal((row["outcome"], row["distance_m"]), ("broken", "1.5" if 'print("{}' in act else "0"), act)
                tap.equal(abs(float(row["clearance_m"]) - (10 - HULL)) < 1e-6, True, row["clearance_m"])
        # One that ends after an answer, when nobody reads the next ping.
        done = with_rule(folder, 'import os, time; os.close(0); print("{}"); time.sleep(0.2); os._exit(4)', code=1)
        tap.contains(done.err, "the rule ended with code 4 without an answer")
        tap.equal([row["outcome"] for row in rows(folder)], ["broken", "broken"])
        # What fails in one run is begun anew for the next.
        fails = folder / "failed"
        with_rule(folder, f'import os; again = os.path.exists({fails!r}); open({fails!r}, "w").close(); '
                  'print("{}" if again else "x")', code=1)
        tap.equal([row["outcome"] for row in rows(folder)], ["broken", "late"])


def test_a_rule_ends_with_the_program():
    """At a second Ctrl-C, too, where it and what it started do not read, and would not notice."""
    program.need_device()
    with Folder() as folder:
        scene = folder.write("wall.yaml", WALL)
        rule = f"echo $$ >{folder / 'pid'}; sleep 300; echo '{{}}'"
        job = subprocess.Popen([program.PATH, "trial", scene, "--runs", "1", "-o", folder / "out", "--rule", rule,
                                "--rule-timeout", "200"], stderr=subprocess.DEVNULL)
        end = time.monotonic() + 60
        while time.monotonic() < end and not (os.path.exists(folder / "pid") and folder.read("pid").strip()):
            time.sleep(0.05)
        group = int(folder.read("pid"))
        for _ in range(2):
            job.send_signal(signal.SIGINT)
            time.sleep(0.3)
        tap.equal(job.wait(timeout=20), -signal.SIGINT)
        left = [1]
        while left and time.monotonic() < end:
            listed = subprocess.run(["ps", "-e", "-o", "pgid=,stat=,args="], capture_output=True, text=True, check=True)
            left = [line for line in listed.stdout.splitlines()
                    if int(line.split()[0]) == group and line.split()[1][0] != "Z"]
            end -= 10
        for _ in left:
            os.killpg(group, signal.SIGKILL)
            break
        tap.equal(left, [])


tap.main(globals())
