"""asdic serve: a pose a line in, a ping out; the levels of a run; every mistake answered."""
import csv
import io
import json
import os
import signal
import struct
import subprocess
import sys
import time

import program
import tap
from program import Folder, asdic
from scenes import SONAR, ball_over_sand

ROOT = os.path.join(os.path.dirname(__file__), "..", "..")
SCENE2 = os.path.join(ROOT, "data", "scenes", "scenario2.yaml")
PLACE = "{pose: {position_m: [0, 0, 7]}}"
TRACK = "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
POSES = [f"{0.1 * i:.1f},{0.3 * i:.2f},{-0.1 * i:.2f},{7 + 0.01 * i:.2f},{0.7 * i:.1f},-3,{2.3 * i:.2f}"
         for i in range(35)]


def scene_of(mission=PLACE):
    receivers = "receivers: [{name: left, yaw_deg: -8}, {name: right, yaw_deg: 8}]"
    return ball_over_sand(f"{SONAR}, {receivers}", 1024, mission, "model: {terms: all}\n")


def serve(folder, lines, *options, mission=PLACE, code=0):
    scene = folder.write("scene.yaml", scene_of(mission))
    return asdic("serve", scene, *options, stdin="\n".join(lines)).check(code=code)


def test_a_place_below_the_bottom_is_no_place():
    program.need_device()
    with Folder() as folder:
        done = serve(folder, ["0,0,0,91,0,0,0", "0,0,0,11.9,0,0,0"])
        below, above = (json.loads(line) for line in done.out.splitlines())
        tap.contains(below["error"], "the sonar is at z = 91 m, below the bottom at 12 m")
        tap.equal("error" in above, False, above)


def test_a_table_from_a_spreadsheet_is_read():
    """A byte-order mark before the first line is no part of it."""
    program.need_device()
    with Folder() as folder:
        for first in TRACK.strip(), POSES[0]:
            answers = serve(folder, ["\ufeff" + first, POSES[1]]).out.splitlines()
            tap.equal([json.loads(line).get("error") for line in answers], [None] * (1 + (first == POSES[0])))


def test_levels_are_those_of_a_run():
    program.need_device()
    with Folder() as folder:
        folder.write("track.csv", TRACK + "\n".join(POSES) + "\n")
        # One point more: the run's last ping, too, then lies at the beginning of a leg.
        with open(folder / "track.csv", "a", encoding="utf-8") as file:
            file.write(POSES[-1].replace("3.4,", "3.44,", 1) + "\n")
        scene = folder.write("run.yaml", scene_of("{track: track.csv}"))
        asdic("run", scene, "-o", folder / "run").check(code=0)
        rows = list(csv.DictReader(io.StringIO(folder.read("run/bins.csv"))))
        tap.equal(len(rows), 35 * 2 * 149)
        pings = [json.loads(line) for line in serve(folder, POSES).out.splitlines()]
        tap.equal(len(pings), 35)
        for row in rows:
            level = pings[int(row["ping"])]["level_db"][row["beam"]][int(row["bin"])]
            tap.equal(f"{level:.9g}" if level is not None else "", row["level_db"], str(row))


def test_rays_are_as_many_as_asked():
    """Also where the scene leaves them to asdic, and they are just as many as a run would take."""
    program.need_device()
    with Folder() as folder:
        fan = "receivers: {fan: {count: 64, sector_deg: 120, length_h_m: 0.5, length_v_m: 0.02}}"
        text = ball_over_sand(f"{SONAR}, bin_length_m: 0.02, max_range_m: 20, {fan}", "auto")
        path, at = folder.write("scene.yaml", text), "0,0,0,7,0,0,0"
        auto = json.loads(asdic("plan", "--json", path).check(code=0).out)["rays"]
        tap.equal(auto > 20000, True, f"{auto} rays: more than serve takes for auto")
        folder.write("rays.yaml", text.replace("rays: auto", f"rays: {auto}"))
        asked = asdic("serve", path, "--rays", auto, stdin=at).check(code=0).out
        tap.equal(json.loads(asked)["level_db"],
                  json.loads(asdic("serve", folder / "rays.yaml", stdin=at).check(code=0).out)["level_db"], "levels")


def test_every_format_says_the_same():
    program.need_device()
    with Folder() as folder:
        lines = POSES[:2]
        pings = [json.loads(line) for line in serve(folder, lines, "--expected").out.splitlines()]
        text = serve(folder, lines, "--expected", "--format", "csv").out
        rows = list(csv.DictReader(io.StringIO(text)))
        raw = subprocess.run([program.PATH, "serve", folder / "scene.yaml", "--expected", "-f", "raw"],
                             input="\n".join(lines).encode(), capture_output=True, check=True).stdout
        size = 56 + 4 * 2 * 2 * 149
        tap.equal((len(pings), len(rows), len(raw)), (2, 2, 2 * size))
        for i, ping in enumerate(pings):
            head = struct.unpack_from("<4sIQdddIIII", raw, i * size)
            tap.equal(head, (b"ASDP", 0, i, ping["time_s"], ping["altitude_m"], 0.5, 2, 149, 2, i + 1))
            floats = struct.unpack_from("<596f", raw, i * size + 56)
            for b, beam in enumerate(("left", "right")):
                for n in range(149):
                    level, expected = ping["level_db"][beam][n], ping["expected_db"][beam][n]
                    tap.equal(rows[i][f"{beam}_{n}"], "" if level is None else f"{level:.9g}")
                    if level is not None:
                        tap.equal(f"{floats[b * 149 + n]:.9g}", f"{level:.9g}")
                        tap.equal(f"{floats[298 + b * 149 + n]:.9g}", f"{expected:.9g}")


def test_expectations_do_not_depend_on_what_was_asked_before():
    """Kept while altitude and attitude are, whatever the heading; made anew for each that differs."""
    program.need_device()
    with Folder() as folder:
        lines = ["0,0,0,7,0,0,0", "0,5,1,7,0,0,90", "0,0,0,7,0,3,0", "0,0,0,6.99,0,0,0",
                 "0,0,0,6.99,1,0,0", "0,0,0,7,0,0,0"]
        expected = [json.loads(line)["expected_db"]
                    for line in serve(folder, lines, "--expected").out.splitlines()]
        for i, line in enumerate(lines):
            alone = json.loads(serve(folder, [line], "--expected").out)["expected_db"]
            tap.equal(alone == expected[i], True, line)
        tap.equal([e == expected[0] for e in expected], [True, True, False, False, False, True])


def test_detections_are_those_above_the_threshold():
    program.need_device()
    with Folder() as folder:
        lines = ["0,0,0,7,0,0,0", "bad", "0,1,0,7,0,0,0"]
        answers = [json.loads(line) for line in serve(folder, lines, "--detect").out.splitlines()]
        rows = list(csv.DictReader(io.StringIO(serve(folder, lines, "--detect", "-f", "csv").out)))
        raw = subprocess.run([program.PATH, "serve", folder / "scene.yaml", "--detect", "-f", "raw"],
                             input="\n".join(lines).encode(), capture_output=True, check=True).stdout
        size = 56 + 4 * 2 * 2 * 149
        tap.equal((len(answers), len(rows), len(raw)), (3, 3, 3 * size))
        tap.equal((rows[1]["detections"], bool(rows[1]["error"])), ("", True))
        for i in (0, 2):
            found = answers[i]["detections"]
            # A ball of 0.5 m at 15.2 m and a little to the right stands out of 596 bins.
            near = [d for d in found if d["beam"] == "right" and abs(d["range_m"] - 14.7 + i / 2) < 1.1]
            tap.equal((len(near) > 0, len(found) < 30), (True, True), str(found))
            tap.equal(rows[i]["detections"],
                      " ".join(f"{d['beam']}:{d['range_m']:.15g}" for d in found))
            llr = struct.unpack_from("<298f", raw, i * size + 56 + 4 * 298)
            here = [("left", "right")[n // 149] + f":{(n % 149 + 0.5) * 0.5:.15g}"
                    for n, value in enumerate(llr) if value == value]
            tap.equal(" ".join(here), rows[i]["detections"])


PLANE = "{depth_m: 12, type: sand}"
RISING = "ncols 60\nnrows 60\nxllcorner -60\nyllcorner -60\ncellsize 2\n"
BEAMS = "receivers: [{name: left, yaw_deg: -8}, {name: right, yaw_deg: 8}]"
ARRAY = "transmitter: {length_h_m: 0.01, length_v_m: 0.05}, array: {elements: 8, beams: {count: 9, sector_deg: 60}}"


def test_detections_are_those_of_a_run():
    """Over a plane and of coherent pings those of `detect`, whose background is of the very place: a bin in ten thousand
    may be on the other side of a threshold. Over a bottom that is no plane those of OS-CFAR, as in trials, which is told: 274 bins,
    where 713 stand out from a plane. Of coherent pings 23 bins were other ones, with pulses' edges among them."""
    program.need_device()
    rows = [" ".join(f"{12 + 2 * ((3 * i + 5 * j) % 7) / 7:.2f}" for j in range(60)) for i in range(60)]
    loud = "frequency_khz: 100, bandwidth_khz: 10, ping_rate_hz: 10, source_level_db: 200, max_range_m: 40, bin_length_m: 0.075"
    with Folder() as folder:
        folder.write("rising.asc", RISING + "\n".join(rows) + "\n")
        folder.write("track.csv", TRACK + "\n".join(POSES[:9]) + "\n")
        for bottom, receivers, sampling, cfar in ((PLANE, f"speckle: rayleigh, {BEAMS}", "", ()), (PLANE, ARRAY, ", coherent: true", ()),
                                                  ("{grid: rising.asc, type: sand}", f"speckle: rayleigh, {BEAMS}", "", ("--cfar", "os"))):
            path = folder.write("scene.yaml", f"version: 1\nbottom: {bottom}\nsonar: {{{loud}, {receivers}}}\n"
                                f"sampling: {{rays: 20000{sampling}}}\nmission: {{track: track.csv}}\noutput: {{images: []}}\n"
                                "model: {terms: all, refraction: full}\ndetector: {pfa: 1.0e-2}\n")
            asdic("run", path, "-o", folder / "out", "-f", "-q").check(code=0)
            asdic("detect", folder / "out", "-f", "-q", *cfar).check(code=0)
            done = asdic("serve", path, "--detect", stdin="\n".join(POSES[:9])).check(code=0)
            found = {(ping, d["beam"], int(d["range_m"] / 0.075)) for ping, line in enumerate(done.out.splitlines())
                     for d in json.loads(line)["detections"]}
            right = {(int(row["ping"]), row["beam"], int(row["bin"]))
                     for row in csv.DictReader(io.StringIO(folder.read("out/detections.csv")))}
            cells = 9 * (9 if sampling else 2) * 40 / 0.075
            what = f"{bottom}{sampling}: {len(found)}, rather than {len(right)}, of {cells:.0f}"
            tap.equal((len(right) > 100, len(found ^ right) <= 1e-4 * cells), (True, True), what)
            tap.equal("held against their neighbours (OS-CFAR)" in done.err, bool(cfar), done.err)


def test_every_line_that_asks_is_answered():
    program.need_device()
    lines = ['{"x_m": 1, "y_m": 2, "z_m": 7, "yaw_deg": 30, "name": "auv", "armed": true}', "",
             '{"x_m": 1, "y_m": 2}', '{"x_m": 1 "y_m": 2, "z_m": 7}', "1,2,3", "0,0,0,7,0,0,nan",
             "0,0,0,-1,0,0,0", "x_m,y_m", "z_m, x_m ,y_m,mode", "7,1,2,4", "8" * 17_000_000,
             '{"x_m": 1, "y_m": 2, "z_m": 7} rest', "7,1,2,4\r"]
    with Folder() as folder:
        done = serve(folder, lines)
        answers = [json.loads(line) for line in done.out.splitlines()]
        tap.equal([a.get("line", a.get("ping")) for a in answers], [0, 3, 4, 5, 6, 7, 8, 1, 11, 12, 2])
        tap.equal([key for key in ("x_m", "y_m", "z_m", "yaw_deg") if answers[7][key] !=
                   {"x_m": 1, "y_m": 2, "z_m": 7, "yaw_deg": 0}[key]], [])
        for answer, part in zip(answers[1:], (
                "'z_m' is missing", "column 11: a comma or }", "values where 7 are expected",
                "'yaw_deg' = 'nan' is not a number", "above the sea surface", "lacks x_m, y_m or z_m")):
            tap.contains(answer["error"], part)
        tap.contains(answers[8]["error"], "longer than 16777216")
        tap.contains(answers[9]["error"], "the end of the line")
        tap.equal(done.err.count("warning:"), 8, "warnings")
        rows = list(csv.DictReader(io.StringIO(serve(folder, ["1,2", POSES[0]], "-f", "csv").out)))
        tap.equal([bool(row["error"]) for row in rows], [True, False])
        tap.equal(None in rows[0], False, "the line of an error has as many fields")
        long = ['{"x_m": 1, "y_m": 2, "z_m": 7, "name": "%s"}' % (size * "a") for size in (4054, 4055, 50_000, 2**24 - 42, 3)]
        tap.equal([len(line) for line in long], [4096, 4097, 50_042, 2**24, 45])
        for more, error in (0, False), (1, True):
            answers = [json.loads(line) for line in serve(folder, [*long[:3], more * " " + long[3], long[4]]).out.splitlines()]
            tap.equal(["error" in answer for answer in answers], [False] * 3 + [error, False], "the longest line")


def test_a_misspelt_name_is_no_angle_of_zero():
    """Nor is one of another convention, or an angle that this one has no name for; whole messages pass."""
    program.need_device()
    place = '{"x_m": 0, "y_m": 0, "z_m": 7, %s}'
    wrong = {"yaw": "yaw_deg", "pitch_dg": "pitch_deg", "Yaw_deg": "yaw_deg", "time": "time_s", "x": "x_m", "yaw_rad": "yaw_deg",
             "heading_deg": "yaw_deg", "Heading": "yaw_deg", "hdg": "yaw_deg", "psi_rad": "yaw_deg", "theta": "pitch_deg",
             "phi": "roll_deg", "\\u0079aw": "yaw_deg"}
    angles = ["elevation_deg", "elevation_rad", "qx", "qw"]
    attitudes = ['"orientation": {"x": 0, "y": 0, "z": 0.7, "w": 0.7}', '"attitude": [0, 0, 90]', '"rpy": [0, 0, 1.57]']
    others = ["id", "seq", "mode", "frame", "speed_mps", "lat", "cm", "altitude_m", "depth", "x_error_m", ""]
    wholes = ['"heading_deg": 90, "yaw_deg": 30', '"roll_deg": 0, "pitch_deg": 0, "yaw_deg": 0, "lat_deg": 54.5, "lon_deg": 7',
              '"header": {"stamp": {"sec": 7}, "frame_id": "map"}, "time": "2026-11-30T02:21Z", "yaw": {"rate": [0.1]}',
              '"time_ms": 5, "time_s": 6', '"roll_deg": 0, "pitch_deg": 0, "yaw_deg": 0, "orientation": {"w": 1}, "qx": 0',
              '"orientation": null', '"\\u0079\\u0061w_deg": 90', '"ranges": [%s]' % ", ".join(300 * ["12.3456789012"])]
    with Folder() as folder:
        lines = [place % f'"{name}": 30' for name in [*wrong, *angles, *others]]
        lines += [place % rest for rest in attitudes + wholes]
        lines += ["x_m,y_m,z_m,rol_deg", "x_m,y_m,z_m,heading_deg", "x_m,y_m,z_m,depth,note", "x_m,y_m,z_m,qx,qy,qz,qw", '{"x_m": 0, "y_m": 0, "depth_m": 7}',
                  '{"note": 5}']
        answers = [json.loads(line) for line in serve(folder, lines).out.splitlines()]
        last = [("rol_deg", "roll_deg"), ("heading_deg", "yaw_deg"), ("depth_m", "z_m")]
        names = TRACK.strip()
        told = [f"unknown name '{name}'; did you mean '{meant}'?".replace("\\u0079", "y") for name, meant in wrong.items()]
        told += [f"unknown name '{name}'; the names are {names}" for name in [*angles, "orientation", "attitude", "rpy"]]
        told += [f"unknown name '{name}'; did you mean '{meant}'?" for name, meant in last]
        told.insert(-1, f"unknown name 'qx'; the names are {names}")
        told += [f"none of the names is known; they are {names}"]
        tap.equal([answer["error"] for answer in answers if "error" in answer], told)
        tap.equal(len(answers), len(told) + len(others) + len(wholes))
        escaped = [answer for answer in answers if answer.get("yaw_deg") == 90]
        tap.equal(len(escaped), 1, "names with escapes")


def test_lines_without_a_time_go_on_from_the_last_that_had_one():
    program.need_device()
    lines = ['{"x_m": 0, "y_m": 0, "z_m": 7%s}' % time
             for time in ("", "", ', "time_s": 100.5', "", "", ', "time_s": 50', "")]
    with Folder() as folder:
        times = [json.loads(line)["time_s"] for line in serve(folder, lines).out.splitlines()]
        tap.equal([round(time, 9) for time in times], [0.0, 0.1, 100.5, 100.6, 100.7, 50.0, 50.1])


def test_a_time_or_a_list_that_is_no_pose():
    """Rounding would keep all poses behind it at such a time."""
    program.need_device()
    with Folder() as folder:
        lines = ['{"x_m": 0, "y_m": 0, "z_m": 7, "time_s": 1e300}', "[1, 2, 3]", '{"x_m": 0, "y_m": 0, "z_m": 7}']
        long, many, good = (json.loads(line) for line in serve(folder, lines).out.splitlines())
        tap.contains(long["error"], "'time_s' = 1e+300 is out of range [-1e+12, 1e+12] s")
        tap.contains(many["error"], "column 1: a { expected in the JSON object")
        tap.equal(good["time_s"], 0)


def test_lines_that_are_no_text_are_answered_in_text():
    program.need_device()
    lines = [b'{"x_m": 1, "y_m": 2, "z_m": 7}', b"\0\0\0\0", b'{"x_m": 1, "\xff\xfe": 2, "z_m": 7}',
             b"x_m,\xc3\x28,z_m", b"\xed\xa0\x80", b"1,2\0,7", '{"x_m": 1, "y_m": 2, "z_m": 7, "é𝄞": "日"}'.encode()]
    with Folder() as folder:
        scene = folder.write("scene.yaml", scene_of())
        for form in ("json", "csv"):
            done = subprocess.run([program.PATH, "serve", scene, "-f", form], input=b"\n".join(lines),
                                  capture_output=True, check=False, timeout=100)
            text = done.stdout.decode("utf-8")  # or it raises
            if form == "json":
                answers = [json.loads(line) for line in text.splitlines()]
                tap.equal(["error" in a for a in answers], [False, True, True, True, True, True, False])
                tap.contains(answers[1]["error"], "column 1: the byte 0x00 is no text in UTF-8")
                tap.contains(answers[2]["error"], "column 13: the byte 0xff")


def talk(folder, *options):
    scene = folder.write("scene.yaml", scene_of())
    return subprocess.Popen([program.PATH, "serve", scene, *options], stdin=subprocess.PIPE,
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_answers_are_flushed_and_signals_end_it():
    program.need_device()
    with Folder() as folder:
        with talk(folder) as server:
            print("0,0,0,7,0,0,0", file=server.stdin, flush=True)
            tap.equal(json.loads(server.stdout.readline())["ping"], 0)  # while the input is open
            print("0,0", end="", file=server.stdin, flush=True)
            time.sleep(0.2)  # half a line is there, which is no line when it ends
            server.send_signal(signal.SIGINT)
            tap.equal((server.wait(timeout=20), server.stdout.read()), (130, ""))
        with talk(folder) as server:
            server.stdout.close()
            print("0,0,0,7,0,0,0", file=server.stdin, flush=True)
            tap.equal(server.wait(timeout=20) in (-signal.SIGPIPE, 141), True, "code")
            tap.equal(server.stderr.read(), "", "stderr")


def test_mistakes_have_their_exit_codes():
    asdic("serve").check(code=2, out="")
    asdic("serve", "-").check(code=2, out="")
    asdic("serve", SCENE2, "--format", "xml").check(code=2, out="")
    asdic("serve", "nowhere.yaml").check(code=3, out="")


def test_the_vehicle_avoids_the_rise():
    program.need_device()
    done = subprocess.run([sys.executable, os.path.join(ROOT, "data", "examples", "avoid.py"),
                           program.PATH, SCENE2], capture_output=True, text=True, check=True, timeout=100)
    track = [{k: float(v) if v else None for k, v in row.items()}
             for row in csv.DictReader(io.StringIO(done.stdout))]
    tap.equal((track[0]["z_m"], track[-1]["x_m"] > 59), (11.0, True))
    first = next(row for row in track if row["nearest_m"])
    # The wall stands at 35 m: what is heard first is the wall, from afar.
    if not (abs(first["x_m"] + first["nearest_m"] - 35) < 1 and first["nearest_m"] > 25):
        raise AssertionError(first)
    clearance = min(10 - row["z_m"] for row in track if row["x_m"] >= 34)
    if not clearance > 1.5:
        raise AssertionError(f"passes {clearance} m above the rise")


tap.main(globals())
