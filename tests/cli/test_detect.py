"""asdic detect: detections, confusion table, map and tracks of a run."""
import csv
import json
import math
import pathlib
import re
import resource
import struct
import subprocess
import time

import program
import tap
from program import Folder, asdic, need_device
from run_folder import npy, png_texts

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
COLUMNS = ["ping", "time_s", "beam", "bin", "range_m", "x_m", "y_m", "z_m", "level_db",
           "background_db", "llr", "posterior", "pd", "truth"]
# Where nothing is asked of the map.
COARSE = "--cell", "4"
# Rayleigh speckle; two objects at one range on either side, seen by a beam each.
TWO = """version: 1
bottom: {depth_m: 20, type: sand}
objects:
  - {name: left, sphere: {radius_m: 1}, position_m: [26, -15, 8], material: {impedance_mrayl: 45}}
  - {name: right, sphere: {radius_m: 1}, position_m: [26, 15, 8], material: {impedance_mrayl: 45}}
sonar:
  frequency_khz: 100
  source_level_db: 220
  receivers:
    - {name: port, yaw_deg: -30, length_h_m: 0.1, length_v_m: 0.1}
    - {name: starboard, yaw_deg: 30, length_h_m: 0.1, length_v_m: 0.1}
  transmitter: {length_h_m: 0.02, length_v_m: 0.1}
  speckle: rayleigh
mission: {pose: {position_m: [0, 0, 8]}, pings: 20}
sampling: {rays: 20000}
detector: {pfa: 1.0e-4}
"""


def rows(path):
    with open(path, newline="", encoding="ascii") as file:
        return list(csv.DictReader(file))


def scene2(folder, pings=12):
    text = (DATA / "scenes" / "scenario2.yaml").read_text()
    text = text.replace("noise: {enabled: false}", "noise: {enabled: false}\n  speckle: rayleigh")
    return folder.write("rise.yaml", text.replace("pings: 1", f"pings: {pings}"))


def test_objects_keep_their_names_in_another_folder():
    need_device()
    with Folder() as folder:
        scene2(folder, pings=2)
        asdic("run", "rise.yaml", "-q", "-o", "out", cwd=folder.path).check(0)
        (pathlib.Path(folder.path) / "away").mkdir()
        done = asdic("detect", "../out", "--json", "-q", cwd=folder / "away").check(0, err="")
        tap.equal({o["object"] for o in json.loads(done.out)["objects"]}, {"rise"}, "names")


def test_all_beams_find_the_rise():
    need_device()
    with Folder() as folder:
        scene2(folder)
        asdic("run", "rise.yaml", "-q", "-o", "out", cwd=folder.path).check(0)
        done = asdic("detect", "out", "--json", "-q", cwd=folder.path).check(0, err="")
        report = json.loads(done.out)
        tap.equal([o["beam"] for o in report["objects"]], ["forward", "down", "up"])
        for seen in report["objects"]:
            # The wall is at 35 m, for the tilted beams a little beyond: its far ends.
            tap.equal((seen["object"], seen["range_m"] in (35.25, 35.75), seen["pings_detected"]),
                      ("rise", True, 12), seen["beam"])
            tap.equal(seen["pd"] > 0.999, True, "P_D")
        found = rows(folder / "out/detections.csv")
        tap.equal(list(found[0]), COLUMNS)
        tap.equal(len(found), report["detections"])
        walls = [r for r in found if r["bin"] == "70"]
        tap.equal({(r["beam"], r["truth"]) for r in walls},
                  {("forward", "rise"), ("down", "rise"), ("up", "rise")})
        ahead = next(r for r in walls if r["beam"] == "forward")
        tap.equal((float(ahead["x_m"]), float(ahead["y_m"]), float(ahead["z_m"])), (35.25, 0, 7))
        tap.equal(float(ahead["level_db"]) > float(ahead["background_db"]) + 20, True, "level")
        tap.equal(float(ahead["posterior"]) > 0.999, True, "posterior")
        # What the closed form predicts of the object's bins, and what was detected of them.
        rise = next(c for c in report["confusion"] if c["truth"] == "rise")
        tap.equal(abs(rise["detected"] - rise["predicted"]) < 5 * rise["predicted"] ** 0.5, True,
                  f"{rise}")
        tap.equal(sorted(n for n in folder.names() if n.startswith("out")), ["out"])
        tracks = rows(folder / "out/tracks.csv")
        last = [t for t in tracks if t["ping"] == "11" and t["confirmed"] == "1"]
        tap.equal([t["truth"] for t in last], ["rise"] * len(last))
        tap.equal(abs(float(last[0]["x_m"]) - 35.25) < 0.5, True, "the first track is the wall")
        tap.equal(report["tracks"]["on_objects"] >= 1, True)


def test_tracks_follow_what_is_as_fast_as_was_said():
    """A boat that goes away at 4 m/s: too fast for a track that expects what drifts."""
    need_device()
    with Folder() as folder:
        folder.write("boat.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,10,0,8,0,0,0\n5,30,0,8,0,0,0\n")
        folder.write("fast.yaml", """version: 1
bottom: none
objects: [{name: boat, point: 0, track: boat.csv}]
sonar: {frequency_khz: 100, ping_rate_hz: 4, max_range_m: 35, source_level_db: 200, receivers: [{name: ahead}]}
mission: {pose: {position_m: [0, 0, 8]}, pings: 20}
sampling: {rays: 1000}
output: {images: [], csv: none}
""")
        asdic("run", "fast.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        for speed, on_objects in ([], 0), (["--speed", "5"], 1):
            done = asdic("detect", "out", "--force", "--json", *COARSE, *speed, cwd=folder.path).check(0)
            tap.equal(json.loads(done.out)["tracks"]["on_objects"], on_objects, f"tracks with {speed}")
        last = rows(folder / "out/tracks.csv")[-1]
        tap.equal((last["ping"], last["truth"], abs(float(last["vx_mps"]) - 4) < 0.3), ("19", "boat", True), f"{last}")


def test_objects_are_named_and_mapped():
    need_device()
    with Folder() as folder:
        folder.write("two.yaml", TWO)
        done = asdic("detect", "two.yaml", "-o", "out", "--json", cwd=folder.path).check(0)
        report = json.loads(done.out)
        seen = {(o["object"], o["beam"]) for o in report["objects"] if o["pings_detected"] > 15}
        tap.equal(seen, {("left", "port"), ("right", "starboard")})
        tap.equal(report["confusion"][-1]["truth"], "none")
        hits = [{t["ping"] for t in rows(folder / "out/tracks.csv") if t["truth"] == name and t["hit"] == "1"}
                for name in ("left", "right")]
        tap.equal(len(hits[0] & hits[1]) > 15, True, "pings with a plot of either object")
        with open(folder / "out/occupancy.png", "rb") as file:
            texts = png_texts(file.read())
        if "Title" in texts:  # with cairo
            tap.contains(texts["Title"], "two: occupancy after 20 pings\n")
            tap.contains(texts["Title"], "bandwidth 10 kHz  \u00b7  bins of ")
        # The table in text says the same; a run is not detected in twice without --force.
        asdic("detect", "out", cwd=folder.path).check(1)
        text = asdic("detect", "out", "--force", cwd=folder.path).check(0).out
        tap.contains(text, "P_FA: design 0.0001")
        tap.contains(text, "  none: no echo to speak of; every detection is a false alarm\n")
        tap.equal("  faint: " in text, any(k["truth"] == "faint" and k["bins"] for k in report["confusion"]),
                  "what a row means is said where there is one")
        tap.lacks(text, "(of ")
        tap.contains(text, "left")
        # Elsewhere the scene is not there: one name for all.
        (pathlib.Path(folder.path) / "two.yaml").unlink()
        done = asdic("detect", "out", "--force", "--json", cwd=folder.path).check(0)
        tap.contains(done.err, "have no names")
        tap.equal({o["object"] for o in json.loads(done.out)["objects"]}, {"object"})


def test_tracks_move_with_the_whole_scene():
    """North 400 m, west 300 m: over a flat bottom nothing else changes."""
    need_device()
    with Folder() as folder:
        tracks = {}
        for name, north, east in ("here", 0, 0), ("there", 400, -300):
            text = TWO.replace("pings: 20", "pings: 6")
            for x, y in (26, -15), (26, 15), (0, 0):
                text = text.replace(f"position_m: [{x}, {y}, 8]", f"position_m: [{x + north}, {y + east}, 8]")
            folder.write(name + ".yaml", text)
            asdic("detect", name + ".yaml", "-q", "-o", name, cwd=folder.path).check(0)
            tracks[name] = [{k: v if k == "truth" else float(v) for k, v in row.items()}
                            for row in rows(folder / (name + "/tracks.csv"))]
            for row in tracks[name]:
                row["x_m"] -= north
                row["y_m"] -= east
        tap.equal(len(tracks["here"]) >= 6, True, "tracks")
        tap.equal(len(tracks["there"]), len(tracks["here"]), "tracks")
        for here, there in zip(tracks["here"], tracks["there"]):
            for key, value in here.items():
                same = value == there[key] if key == "truth" else abs(value - there[key]) < 0.02
                tap.equal(same, True, f"{key}: {value} {there[key]}")


def test_options_replace_the_scenes_detector():
    need_device()
    with Folder() as folder:
        scene2(folder, 6)
        asdic("run", "rise.yaml", "-q", "-o", "out", cwd=folder.path).check(0)

        def detect(*options):
            done = asdic("detect", "out", "--json", "--force", *options, cwd=folder.path)
            return json.loads(done.check(0).out)

        many = detect("--pfa", "0.1")
        tap.equal(many["pfa"], 0.1)
        low, high = many["pfa_measured"]["low"], many["pfa_measured"]["high"]
        tap.equal(low <= 0.1 <= high, True, f"P_FA in {low}..{high}")
        for kind in "ca", "os":
            cfar = detect("--cfar", kind, "--pfa", "0.01", "--cfar-cells", "12")
            tap.equal((cfar["cfar"], cfar["detections"] > 0), (True, True))
        tap.equal(detect("--target", "swerling3", "--prior", "0.5")["target"], "swerling3")
        dear, cheap = detect("--cost", "1000"), detect("--cost", "1")
        tap.equal(dear["detections"] > cheap["detections"], True, "misses are dear")
        none = dear["confusion"][-1]
        low, high = (dear["pfa_measured"][k] * none["bins"] for k in ("low", "high"))
        tap.equal(low <= none["predicted"] <= high, True, f"{none} in {low}..{high}")
        strict = detect("--truth", "20")["confusion"][0]["bins"]
        tap.equal(strict < detect()["confusion"][0]["bins"], True, "bins that hold the rise")


def test_by_cost_a_background_from_neighbours_makes_more_false_alarms():
    """Of one look, for targets of 10 dB, the threshold is 1.1 ln(11 x 99 / cost) means; over the mean of 16 bins it is
    passed by chance (1 + threshold / 16)^-16 of the time (Finn & Johnson 1968), near the ends more often."""
    need_device()
    with Folder() as folder:
        folder.write("water.yaml", """version: 1
bottom: none
sonar:
  frequency_khz: 100
  bandwidth_khz: 1.5
  bin_length_m: 0.5
  source_level_db: 200
  receivers: [{name: ahead}]
  speckle: rayleigh
mission: {pose: {position_m: [0, 0, 50]}, pings: 150}
sampling: {rays: 2000}
output: {images: [], csv: none}
""")
        done = asdic("detect", "water.yaml", "-o", "out", "--cost", "100", "--cfar", "ca", "--json", "-q",
                     *COARSE, cwd=folder.path)
        report = json.loads(done.check(0).out)
        none, pfa = report["confusion"][-1], report["pfa_measured"]
        predicted = none["predicted"] / none["bins"]
        inner = (1 + 1.1 * math.log(11 * 99 / 100) / 16)**-16
        tap.equal(inner < predicted < 1.03 * inner, True, f"{predicted} of {inner}")
        tap.equal(pfa["low"] <= predicted <= pfa["high"], True, f"{predicted} in {pfa}")


def test_neighbours_of_bins_shorter_than_a_pulse_are_a_pulse_apart():
    """Four bins a pulse share speckle: means of as many bins in a row are those of few, and were exceeded three times as
    often as they should be. Of 24 bins a pulse the guards were part of the echo: hardly ever. By cost the rate is said."""
    need_device()
    with Folder() as folder:
        for bin_m, pings in (0.125, 60), (0.02, 15):
            folder.write("noise.yaml", f"""version: 1
bottom: none
surface: {{enabled: false}}
environment: {{sound_speed_mps: 1500}}
sonar:
  {{frequency_khz: 100, bandwidth_khz: 1.5, bin_length_m: {bin_m}, max_range_m: 100, ping_rate_hz: 5, source_level_db: 0,
   receivers: [{{name: ahead}}], speckle: rayleigh}}
mission: {{pose: {{position_m: [0, 0, 50]}}, pings: {pings}}}
sampling: {{rays: 64}}
output: {{images: [], csv: none}}
""")
            asdic("run", "noise.yaml", "-o", "out", "-f", "-q", cwd=folder.path).check(0)
            for options in (("--cfar", "ca", "--pfa", "0.01"), ("--cfar", "os", "--pfa", "0.01"),
                            ("--cfar", "ca", "--cost", "100")):
                done = asdic("detect", "out", "-f", "--json", "-q", *COARSE, *options, cwd=folder.path).check(0)
                report = json.loads(done.out)
                none, pfa = report["confusion"][-1], report["pfa_measured"]
                predicted = none["predicted"] / none["bins"]
                tap.equal("--cost" in options or abs(predicted / 0.01 - 1) < 1e-9, True, f"{predicted}")
                tap.equal(0.97 * pfa["low"] <= predicted <= 1.03 * pfa["high"], True,
                          f"{bin_m} m, {options}: {predicted} in {pfa}")
                tap.equal(pfa["high"] < 1.6 * pfa["value"], True, f"enough to see: {pfa}")


def test_spiky_speckle_exceeds_its_neighbours_more_often():
    """Thresholds of CFAR are those of Rayleigh speckle: no rate is predicted in K speckle, nor tracks of such alarms.
    It was said to be the design's, a twentieth of what it is."""
    need_device()
    with Folder() as folder:
        folder.write("spiky.yaml", """version: 1
bottom: none
sonar: {frequency_khz: 100, bandwidth_khz: 1.5, bin_length_m: 0.5, source_level_db: 250, receivers: [{name: ahead}], speckle: k,
  speckle_shape: 1}
mission: {pose: {position_m: [0, 0, 50]}, pings: 30}
sampling: {rays: 2000}
detector: {pfa: 1.0e-3}
output: {images: [], csv: none}
""")
        asdic("run", "spiky.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        for kind in "ca", "os":
            done = asdic("detect", "out", "--cfar", kind, "-f", "--json", *COARSE, cwd=folder.path).check(0)
            report = json.loads(done.out)
            tap.equal(done.err.count("K speckle exceeds them more often than P_FA says"), 1, done.err)
            tap.lacks(done.err, "tracks are not for this sonar")
            tap.equal((report["confusion"][-1]["predicted"], report["tracks"]["by_chance"]), (None, None))
            tap.equal(report["pfa_measured"]["low"] > 0.01, True, f"{report['pfa_measured']}")
        done = asdic("detect", "out", "--cfar", "ca", "-f", *COARSE, cwd=folder.path).check(0)
        tap.contains(done.out, "P_FA: measured ")
        for options in ((), ("--cfar", "ca", "--cost", "100")):
            done = asdic("detect", "out", "-f", "--json", *COARSE, *options, cwd=folder.path).check(0)
            tap.lacks(done.err, "K speckle")
            tap.equal(json.loads(done.out)["confusion"][-1]["predicted"] > 0, True, f"{options}")


# Eight beams of one degree, a quarter of a degree apart, and nothing to see.
EMPTY = """version: 1
bottom: {depth_m: 12, type: sand}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  ping_rate_hz: 40
  bin_length_m: 0.0745
  source_level_db: 200
  speckle: rayleigh
  receivers: {fan: {count: 8, sector_deg: 1.75, length_h_m: 0.75, length_v_m: 0.05}}
mission: {pose: {position_m: [0, 0, 7]}, pings: 600}
sampling: {rays: 20000}
detector: {pfa: 3.0e-3}
output: {images: [], csv: none}
"""


def test_an_empty_sea_has_the_false_tracks_that_are_said():
    need_device()
    with Folder() as folder:
        folder.write("empty.yaml", EMPTY)
        done = asdic("detect", "empty.yaml", "-o", "out", "--json", *COARSE, cwd=folder.path).check(0)
        report = json.loads(done.out)
        tracks, pfa = report["tracks"], report["pfa_measured"]
        tap.equal(pfa["low"] <= 0.003 <= pfa["high"], True, f"{pfa}")
        # Of 6 false alarms a ping, which are 2.8 plots: 1 in 170 is confirmed. Independent beams
        # would make 4.9 plots a ping, and 50 tracks.
        said, found = tracks["by_chance"], tracks["confirmed"]
        tap.equal(2 < said < 30, True, f"{said} are said")
        tap.equal(abs(found - said) < 3.3 * said ** 0.5 + 0.3 * said + 1, True,
                  f"{found} false tracks of {said}")
        tap.equal(found > 0, True, "false tracks")
        tap.equal(tracks["on_objects"], 0, "false tracks of an object")
        tap.equal({row["truth"] for row in rows(folder / "out/tracks.csv")}, {"none"}, "names of tracks")
        text = asdic("detect", "out", "--force", *COARSE, cwd=folder.path).check(0).out
        tap.contains(text, "of false alarms alone")


def test_no_false_track_is_confirmed_sooner_than_it_can_be():
    need_device()
    with Folder() as folder:
        said = []
        for pings in 3, 4:  # a track is confirmed by three plots
            folder.write("short.yaml", EMPTY.replace("pings: 600", f"pings: {pings}"))
            done = asdic("detect", "short.yaml", "-o", f"out{pings}", "--json", cwd=folder.path).check(0)
            said.append(json.loads(done.out)["tracks"]["by_chance"])
        tap.equal(said[0], 0)
        # One in 170 of 2.8 plots, as in the long run; so few pings have their plots by chance.
        tap.equal(0.005 < said[1] < 0.05, True, f"{said}")


def said_of(folder, *changes):
    """How many false tracks are to be expected of the empty sea with these CHANGES, (old, new) each."""
    text = EMPTY
    for old, new in (("pings: 600", "pings: 30"), ("rays: 20000", "rays: 500"), *changes):
        tap.contains(text, old)
        text = text.replace(old, new)
    folder.write("sea.yaml", text)
    done = asdic("detect", "sea.yaml", "-o", "out", "-f", "--json", "-q", *COARSE, cwd=folder.path).check(0)
    return json.loads(done.out)["tracks"]["by_chance"]


def test_false_tracks_are_where_beams_look():
    """Plots lie on the axes of beams: those that no gate joins have the tracks of as many single ones, however far apart
    they look. Twice as many were said."""
    need_device()
    with Folder() as folder:
        said = {}
        width = math.degrees(2 * math.asin(0.5 * 0.886 * 1500 / (100e3 * math.hypot(0.001, 0.1))))
        for name, places in ("one", (0,)), ("near", (0, 1)), ("apart", (0, 4)), ("far", (0, 8)), ("three", (-8, 0, 8)):
            beams = ", ".join(f"{{yaw_deg: {place * width}, length_h_m: 0.1}}" for place in places)
            said[name] = said_of(folder,
                                 ("{fan: {count: 8, sector_deg: 1.75, length_h_m: 0.75, length_v_m: 0.05}}", f"[{beams}]"),
                                 ("receivers", "transmitter: {length_h_m: 0.001}\n  receivers"), ("3.0e-3", "1.0e-6"),
                                 ("bottom:", "environment: {sound_speed_mps: 1500}\nbottom:"))
        for name, beams in ("apart", 2), ("far", 2), ("three", 3):
            tap.equal(abs(said[name] / said["one"] / beams - 1) < 0.05, True, f"{name}: {said}")
        tap.equal(said["near"] > 1.1 * said["far"], True, f"near each other {said}")


def test_a_vehicle_that_dives_keeps_the_false_alarm_rate():
    """In faster water, deeper down, a bin has one look in place of two."""
    need_device()
    with Folder() as folder:
        folder.write("dive.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                     "0,0,0,50,0,0,0\n0.1,0,0,50,0,0,0\n0.2,0,0,650,0,0,0\n9,0,0,650,0,0,0\n")
        text = EMPTY
        for old, new in (("bandwidth_khz: 10", "bandwidth_khz: 2.24"), ("0.0745", "0.5"), ("3.0e-3", "0.01"),
                         ("{fan: {count: 8, sector_deg: 1.75, length_h_m: 0.75, length_v_m: 0.05}}", "[{name: f}]"),
                         ("{pose: {position_m: [0, 0, 7]}, pings: 600}", "{track: dive.csv, pings: 60}"),
                         ("bottom: {depth_m: 12, type: sand}", "bottom: none"),
                         ("ping_rate_hz: 40", "ping_rate_hz: 7")):
            tap.contains(text, old)
            text = text.replace(old, new)
        folder.write("dive.yaml", text)
        done = asdic("detect", "dive.yaml", "-o", "out", "--json", "-q", cwd=folder.path).check(0)
        report = json.loads(done.out)
        # 180 false alarms of 18,000 bins; 640 by the threshold of two looks.
        tap.equal(0.007 < report["pfa_measured"]["value"] < 0.014, True, f"{report['pfa_measured']}")
        tap.equal(report["looks"], 2, "at the first ping's depth")


def test_false_tracks_do_not_depend_on_the_compass():
    """A fan that looks across south, where bearings begin anew, hears as wide a sea as one to the north."""
    need_device()
    with Folder() as folder:
        quiet = ("3.0e-3", "1.0e-6")  # hardly a false alarm: none are counted
        said = [said_of(folder, quiet, ("[0, 0, 7]", f"[0, 0, 7], yaw_deg: {yaw}")) for yaw in (0, 90, 180)]
        tap.equal(all(abs(s / said[0] - 1) < 1e-6 for s in said), True, f"{said}")


def test_false_tracks_do_not_depend_on_the_order_of_beams():
    """Nor on one that looks straight down, whose plots fall on one spot."""
    need_device()
    with Folder() as folder:
        fan = "{fan: {count: 8, sector_deg: 1.75, length_h_m: 0.75, length_v_m: 0.05}}"
        ahead, aside, low, down = ("{}", "{yaw_deg: 30}", "{yaw_deg: 3, pitch_deg: 60}", "{pitch_deg: 90}")
        said = {beams: said_of(folder, ("3.0e-3", "1.0e-6"), (fan, f"[{', '.join(beams)}]"))
                for beams in ((ahead, aside), (ahead, down, aside), (down, ahead, aside),
                              (ahead, low, aside), (low, ahead, aside), (ahead, aside, low), (down, down))}
        two, middle, first, *three, none = said.values()
        tap.equal(all(abs(s / two - 1) < 1e-6 for s in (middle, first)), True, f"{said}")
        tap.equal(all(abs(s / three[0] - 1) < 1e-6 for s in three), True, f"{said}")
        tap.equal(three[0] > two, True, f"{said}")
        tap.equal(none, 0, "down alone")


def test_false_tracks_of_a_scanned_sonar_are_not_said():
    """Beams of one degree: five pings at a quarter of it stay within a beam, at half of it they do not."""
    need_device()
    with Folder() as folder:
        fan = "{fan: {count: 8, sector_deg: 1.75, length_h_m: 0.75, length_v_m: 0.05}}"
        said = []
        for step_deg in 0, 0.2, 0.5:
            scan = f"scan: {{sector_deg: 12, step_deg: {step_deg}}}\n  " if step_deg else ""
            said.append(said_of(folder, (fan, "[{length_h_m: 0.75}]"), ("speckle:", f"{scan}speckle:")))
        tap.equal((said[0] > 0, abs(said[1] / said[0] - 1) < 1e-6, said[2]), (True, True, None), f"{said}")
        done = asdic("detect", "out", "-f", cwd=folder.path).check(0)
        tap.lacks(done.out, "to be expected")
        tap.contains(done.err, "tracks are not for this sonar")


# So few rays that levels err by half a dB.
FEW = """version: 1
bottom: {depth_m: 12, type: sand}
objects:
  - {name: ball, sphere: {radius_m: 0.1}, position_m: [30, 0, 9], material: {impedance_mrayl: 45}}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  bin_length_m: 0.075
  source_level_db: 200
  noise: {enabled: false}
  speckle: rayleigh
  receivers: [{name: ahead, length_h_m: 0.15}]
mission: {pose: {position_m: [0, 0, 7]}, pings: 600}
sampling: {rays: 8000}
output: {images: [], csv: none}
"""


def test_few_rays_keep_the_false_alarm_rate():
    need_device()
    with Folder() as folder:
        folder.write("few.yaml", FEW)
        done = asdic("detect", "few.yaml", "-o", "out", "--json", *COARSE, cwd=folder.path).check(0)
        report = json.loads(done.out)
        rate = report["pfa_measured"]["value"]  # 1.25e-3 where the error is not allowed for
        tap.equal(0.8e-3 < rate < 1.1e-3, True, f"{rate}")
        tap.equal(0.4 < report["sampling_error_db"] < 0.8, True, f"{report['sampling_error_db']}")
        tap.equal(0.1 < report["sampling_lift_db"] < 0.3, True, f"{report['sampling_lift_db']}")
        tap.contains(done.err, "sampling error")


def test_a_large_sampling_error_is_a_warning():
    """Above 0.5 dB; above 0.1 a note; both with the report's figures."""
    need_device()
    with Folder() as folder:
        for rays, mark in ((6000, "warning: "), (12000, "")):
            folder.write("some.yaml", FEW.replace("rays: 8000", f"rays: {rays}").replace("pings: 600", "pings: 24"))
            done = asdic("detect", "some.yaml", "-o", f"out{rays}", "--json", cwd=folder.path).check(0)
            report = json.loads(done.out)
            error_db, lift_db = report["sampling_error_db"], report["sampling_lift_db"]
            tap.equal(error_db > 0.5 if mark else 0.1 < error_db < 0.5, True, f"{error_db}")
            told = [line for line in done.err.splitlines() if "sampling error, " in line]
            tap.equal(len(told), 1, done.err)
            tap.equal(told[0].startswith(f"{mark}the levels' sampling error"), True, told[0])
            tap.contains(told[0], f"sampling error, {error_db:.2g} dB in the median bin")
            tap.contains(told[0], f"are {lift_db:.2g} dB higher")
        told = asdic("detect", f"out{rays}", "--force", "--cost", "10", cwd=folder.path).check(0).err
        tap.contains(told, "by cost does not allow for it. More rays lessen it")
        tap.lacks(told, "dB higher")


# Over sand waves, with a ball above them.
WAVES = """version: 1
bottom: {mesh: {file: "%s"}, type: sand}
objects:
  - {name: ball, sphere: {radius_m: 0.5}, position_m: [40, 0, 20], material: {impedance_mrayl: 45}}
sonar:
  frequency_khz: 200
  bandwidth_khz: 10
  ping_rate_hz: 10
  source_level_db: 200
  bin_length_m: 0.1
  receivers: {fan: {count: 8, sector_deg: 60, length_h_m: 0.05, length_v_m: 0.02}}
  transmitter: {length_h_m: 0.01, length_v_m: 0.02, pitch_deg: 10}
  speckle: rayleigh
mission:
  waypoints: {points_m: [[0, 0, 20], [30, 5, 20]], speed_mps: 1.5}
  pings: 40
sampling: {rays: 20000}
output: {images: [], csv: none}
"""


def test_a_background_is_simulated_over_a_mesh():
    need_device()
    with Folder() as folder:
        folder.write("waves.yaml", WAVES.replace("pings: 40", "pings: 20") % (DATA / "meshes/terrain.ply"))
        scene = pathlib.Path(folder.path) / "waves.yaml"
        out = pathlib.Path(folder.path) / "out"
        asdic("run", "waves.yaml", "-o", "out", "-q", cwd=folder.path).check(0)

        def detect(*options):
            done = asdic("detect", "out", "--json", "--force", *COARSE, *options, cwd=folder.path).check(0)
            return json.loads(done.out), done.err

        found, said = detect()
        tap.equal((found["background"], found["cfar"]), ("simulated", False))
        tap.contains(said, "without its objects, simulated in")
        rate = found["pfa_measured"]["value"]
        tap.equal(0.5e-3 < rate < 2e-3, True, f"P_FA {rate} of 1e-3")
        tracks = found["tracks"]
        others = tracks["confirmed"] - tracks["on_objects"]
        tap.equal(tracks["on_objects"] >= 1 and others <= 1, True, f"{tracks}")
        ball = [o for o in found["objects"] if o["pings_detected"] > 15]
        tap.equal(len(ball) >= 1, True, "the ball is found")
        # What neighbours say of sand waves, and what a plane would return.
        for other in "cfar", "flat":
            rate = detect("--background", other)[0]["pfa_measured"]["value"]
            tap.equal(rate > 3e-3, True, f"P_FA {rate} by {other}")
        # It is kept, and made again for other rays.
        again, said = detect("--background", "simulated")
        tap.equal((again["background_s"], again["pfa_measured"]), (0, found["pfa_measured"]))
        kept = (out / "background.npy").read_bytes()
        (out / "background.npy").write_bytes(kept[:-1])
        again, said = detect()
        tap.equal((again["background_s"] > 0, again["pfa_measured"]), (True, found["pfa_measured"]))
        tap.equal((out / "background.npy").read_bytes() == kept, True, "the same bytes")
        # Without the scene there is none.
        scene.write_text(scene.read_text() + "# changed\n")
        (out / "background.npy").unlink()
        again, said = detect()
        tap.equal(again["background"], "cfar")
        done = asdic("detect", "out", "--force", "--background", "simulated", cwd=folder.path)
        tap.contains(done.check(3).err, "not there as it was")
        tap.equal([n.name for n in out.iterdir() if n.suffix == ".part"], [])


# A slope of 45 degrees, whose first echo comes from 6.36 m, and a point in the noise before it.
SLOPE = """OFF
4 2 0
-8 -40 20
8 -40 4
8 40 4
-8 40 20
3 0 1 2
3 0 2 3
"""
BEFORE_SLOPE = """version: 1
bottom: {mesh: {file: slope.off, z_up: false}, lambert_db: -20}
surface: {enabled: false}
objects: [{name: near, point: -58, position_m: [-0.24, 4.481, 7]}]
sonar:
  frequency_khz: 120
  max_range_m: 12
  source_level_db: 190
  bin_length_m: 0.3
  speckle: rayleigh
  receivers: [{yaw_deg: 50}]
mission: {pose: {position_m: [-4, 0, 7]}, pings: 300}
sampling: {rays: 20000}
detector: {pfa: 1.0e-3}
output: {images: [], csv: none}
"""


def test_what_is_before_an_echo_of_many_rays_is_seen():
    """What the floor's first echo may err by is not the error of noise half a metre before it."""
    need_device()
    with Folder() as folder:
        folder.write("slope.off", SLOPE)
        folder.write("slope.yaml", BEFORE_SLOPE)
        asdic("run", "slope.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        found = json.loads(asdic("detect", "out", "--json", *COARSE, cwd=folder.path).check(0).out)
        tap.equal(found["background"], "simulated")
        near = found["confusion"][0]
        tap.equal((near["truth"], near["bins"]), ("near", 300))
        tap.equal(near["detected"] > 270, True, f"{near}, at 10 dB")


# A fan in an attitude of its own at every ping.
ROLLING = """version: 1
bottom: {depth_m: 12, type: sand}
sonar:
  frequency_khz: 300
  ping_rate_hz: 50
  source_level_db: 200
  bin_length_m: 0.5
  receivers: {fan: {count: BEAMS, sector_deg: 90}}
mission: {track: rolling.csv}
sampling: {rays: 2000}
detector: {pfa: 1.0e-3}
output: {images: [], csv: none}
"""


def test_many_attitudes_of_many_beams_are_simulated():
    """Over a plane, where integrals would take a minute; without a device they do."""
    need_device()
    with Folder() as folder:
        for beams, turns, background in ((500, 21, "simulated"), (500, 1, "flat"), (16, 12, "flat")):
            folder.write("rolling.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + "".join(
                f"{k / 50},0,0,{7 + k / 100},{min(k, turns - 1) / 10},{-min(k, turns - 1) / 20},{k}\n" for k in range(22)))
            folder.write("rolling.yaml", ROLLING.replace("BEAMS", str(beams)))
            asdic("run", "rolling.yaml", "-o", "out", "-q", "-f", cwd=folder.path).check(0)
            found = asdic("detect", "out", "--json", "-f", *COARSE, cwd=folder.path).check(0)
            tap.equal("the background is simulated" in found.err, False, "a note, which only who waits reads")
            tap.equal(json.loads(found.out)["background"], background, f"{beams} beams, {turns} attitudes")


def test_a_background_has_rays_of_its_own():
    """Where no object is, the run's own would err as the run does, and thresholds allow for both errors."""
    need_device()
    with Folder() as folder:
        folder.write("still.yaml", ROLLING.replace("BEAMS", "1").replace("track: rolling.csv", "pose: {position_m: [0, 0, 5]}")
                     .replace("csv: none", "csv: none, npy: true"))
        asdic("run", "still.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        asdic("detect", "out", "-q", "--background", "simulated", cwd=folder.path).check(0)
        out = pathlib.Path(folder.path) / "out"
        levels = npy((out / "levels.npy").read_bytes())[1]
        background = npy((out / "background.npy").read_bytes())[1][16:16 + len(levels)]
        bins = len(levels) // 4
        off = [a - b for a, b in zip(*(struct.unpack(f"<{bins}f", each) for each in (levels, background)))
               if not math.isnan(a)]
        tap.equal(sum(d != 0 for d in off) > 0.8 * len(off), True, f"{off} dB")
        tap.equal(max(map(abs, off)) < 1.0, True, f"{off} dB")


def test_a_background_may_be_quiet():
    """Of a source of 0 dB and without noise, levels are far below 1 uPa: errors are shares of them all the same."""
    need_device()
    with Folder() as folder:
        quiet = WAVES.replace("source_level_db: 200", "source_level_db: 0\n  noise: {enabled: false}")
        folder.write("quiet.yaml", quiet.replace("pings: 40", "pings: 5") % (DATA / "meshes/terrain.ply"))
        asdic("run", "quiet.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        done = asdic("detect", "out", "--json", "-v", cwd=folder.path).check(0)
        rate = json.loads(done.out)["pfa_measured"]["value"]
        tap.equal(0.3e-3 < rate < 3e-3, True, f"P_FA {rate} of 1e-3")
        # Of a vehicle under way no more than four times the run's.
        rays, enough = background_rays(folder, done.err, 5)
        tap.equal((rays, enough > 80000), (80000, True), f"enough were {enough} rays")


def background_rays(folder, said, pings):
    """How many rays each of so many PINGS of a background has, as SAID, and how many an error of 0.25 dB takes."""
    rays = int(re.search(rf": {pings} pings? of the scene without its objects, (\d+) rays each", said)[1])
    facts = json.loads((pathlib.Path(folder.path) / "out/run.json").read_text())
    return rays, facts["rays"] * (facts["stderr_db"]["median"] / 0.25) ** 2


def test_a_background_bends_as_the_run():
    """Through a thermocline straight rays reach the floor elsewhere."""
    need_device()
    with Folder() as folder:
        text = WAVES % (DATA / "meshes/terrain.ply")
        for old, new in (("bottom:", "environment: {sound_speed_profile: [[0, 1482], [8, 1480], [12, 1460], "
                                     "[20, 1445], [35, 1440]]}\nbottom:"),
                         ("waypoints: {points_m: [[0, 0, 20], [30, 5, 20]], speed_mps: 1.5}",
                          "pose: {position_m: [0, 0, 9]}"), ("pings: 40", "pings: 20"), ("rays: 20000", "rays: 8000"),
                         ("frequency_khz: 200", "frequency_khz: 100"), ("bin_length_m: 0.1", "bin_length_m: 0.5")):
            tap.contains(text, old)
            text = text.replace(old, new)
        folder.write("bent.yaml", text)
        backgrounds = {}
        for form in "off", "full":
            asdic("run", "bent.yaml", "-o", "out", "-q", "-f", "--refraction", form, cwd=folder.path).check(0)
            for name, kept in backgrounds.items():  # another form's is not taken for its own
                (pathlib.Path(folder.path) / "out/background.npy").write_bytes(kept)
            done = asdic("detect", "out", "--json", "-f", "-v", cwd=folder.path).check(0)
            found = json.loads(done.out)
            tap.equal(found["background_s"] > 0, True, form)
            rays, enough = background_rays(folder, done.err, 1)  # at rest as many as are enough
            tap.equal((rays > 8000, abs(rays / enough - 1) < 0.01), (True, True), f"{rays} rays, not {enough}")
            backgrounds[form] = (pathlib.Path(folder.path) / "out/background.npy").read_bytes()
            rate = found["pfa_measured"]["value"]
            tap.equal(0.3e-3 < rate < 3e-3, True, f"P_FA {rate} of 1e-3, {form}")


def test_a_background_is_of_the_mesh_that_was_run():
    """A scene file that stays the same does not say that its meshes do."""
    need_device()
    with Folder() as folder:
        mesh = pathlib.Path(folder.path) / "bottom.ply"
        mesh.write_bytes((DATA / "meshes/terrain.ply").read_bytes())
        folder.write("waves.yaml", (WAVES % "bottom.ply").replace("pings: 40", "pings: 4"))
        asdic("run", "waves.yaml", "-o", "out", "-q", cwd=folder.path).check(0)

        def source():
            done = asdic("detect", "out", "--json", "--force", cwd=folder.path).check(0)
            return json.loads(done.out)["background"]

        tap.equal(source(), "simulated")
        mesh.write_bytes((DATA / "meshes/rocks.ply").read_bytes())
        tap.equal(source(), "cfar", "another mesh under the same name")
        done = asdic("detect", "out", "--force", "--background", "simulated", cwd=folder.path)
        tap.contains(done.check(3).err, "not there as it was")
        mesh.unlink()
        tap.equal(source(), "cfar", "no mesh")


def test_naming_long_thin_objects_is_quick():
    """A cylinder is made of triangles that are far longer than wide: cut in halves until they fit
    bins, 40 pings of four piles took 4.7 s of CPU."""
    need_device()
    with Folder() as folder:
        pile = "  - {name: pile_%d, cylinder: {radius_m: 0.6, length_m: 36}, " \
               "position_m: [%d, 8, 6], rotation_deg: [90, 0, 0], material: {type: rock}}\n"
        piles = "".join(pile % (i, 20 + 10 * i) for i in range(4))
        head, rest = TWO.split("objects:\n")
        rest = rest[rest.index("sonar:"):].replace("pings: 20", "pings: 40")
        rest = rest.replace("pose: {position_m: [0, 0, 8]}",
                            "waypoints: {points_m: [[0, 0, 8], [10, 0, 8]], speed_mps: 1}")
        rest = rest.replace("speckle:", "bin_length_m: 0.1\n  speckle:")
        folder.write("piles.yaml", head + "objects:\n" + piles + rest)
        asdic("run", "piles.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = asdic("detect", "out", "--background", "cfar", "--json", cwd=folder.path).check(0)
        spent = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        tap.equal({o["object"] for o in json.loads(done.out)["objects"]} >= {"pile_0", "pile_3"},
                  True, "names")
        tap.equal(spent < 1.5, True, f"{spent:.1f} s of CPU")


def test_echoes_are_faint_from_20_db_below_the_rest():
    """Of points a metre apart, as loud as the rest of their bins and down to 24 dB less."""
    need_device()
    with Folder() as folder:
        def run(strengths_db):
            points = "".join(f"  - {{point: {db}, position_m: [{10.25 + n}, 0, 50]}}\n"
                             for n, db in enumerate(strengths_db))
            folder.write("faint.yaml", f"""version: 1
environment: {{particle_density: -200}}
surface: {{enabled: false}}
bottom: none
objects:
{points}sonar: {{frequency_khz: 100, source_level_db: 200, receivers: [{{name: ahead}}]}}
mission: {{pose: {{position_m: [0, 0, 50]}}}}
sampling: {{rays: 500}}
output: {{images: [], csv: long}}
""")
            asdic("run", "faint.yaml", "-o", "out", "-q", "-f", cwd=folder.path).check(0)
            ratios = []
            for row in rows(folder / "out/bins.csv"):
                rest = sum(10 ** (float(row[f"{part}_db"]) / 10)
                           for part in ("bottom", "surface", "volume", "noise") if row[f"{part}_db"])
                if row["object_db"]:
                    ratios.append(float(row["object_db"]) - 10 * math.log10(rest))
            return ratios

        equal = run([0] * 60)
        ratios = run([-ratio - 0.1 - 0.4 * n for n, ratio in enumerate(equal)])
        tap.equal(len([r for r in ratios if -20 < r < -19.6]) > 0, True, f"{ratios}")
        report = json.loads(asdic("detect", "out", "--json", "-q", cwd=folder.path).check(0).out)
        faint, = (c["bins"] for c in report["confusion"] if c["truth"] == "faint")
        tap.equal(faint, len([r for r in ratios if -20 < r < 0]), f"of {ratios}")


# Two points at one range, ahead and astern.
POINTS = """version: 1
bottom: none
objects:
  - {name: ahead, point: {target_strength_db: 0}, position_m: [20, 12, 50]}
  - {name: astern, point: {target_strength_db: 0}, position_m: [-23.3238, 0, 50]}
sonar:
  frequency_khz: 100
  source_level_db: 200
  receivers: [{name: f}]
  speckle: rayleigh
mission: {pose: {position_m: [0, 0, 50]}, pings: 2}
sampling: {rays: 1000}
output: {csv: none, images: []}
"""


def named(folder, text):
    """What bins with echoes are named by detections.csv: the same where the run kept the truth."""
    names = []
    for kept in "false", "true":
        folder.write("points.yaml", text.replace("output: {", f"output: {{truth: {kept}, "))
        asdic("detect", "points.yaml", "-o", "out", "-q", "-f", cwd=folder.path).check(0)
        names.append({row["truth"] for row in rows(folder / "out/detections.csv") if row["pd"]})
    tap.equal(names[0], names[1], "names without truth, and with it")
    return names[0]


def test_echoes_from_behind_are_named_as_loud_as_they_are_heard():
    """A face that hears as well from behind hears 'astern' on its axis."""
    need_device()
    with Folder() as folder:
        tap.equal(named(folder, POINTS), {"ahead"}, "deaf behind")
        tap.equal(named(folder, POINTS.replace("sonar:", "sonar:\n  rear_floor_db: 0")), {"astern"}, "not deaf")


def test_echoes_are_named_after_the_stronger_point():
    """At one range, 4.6 degrees to the right and 10 to the left, where the beam hears 9 dB less."""
    need_device()
    with Folder() as folder:
        points = POINTS.replace("[20, 12, 50]", "[20.05, 1.6, 50]").replace("[-23.3238, 0, 50]", "[19.8, -3.5, 50]")
        tap.equal(named(folder, points), {"ahead"}, "as strong")
        louder = points.replace("astern, point: {target_strength_db: 0}", "astern, point: {target_strength_db: 50}")
        tap.equal(named(folder, louder), {"astern"}, "by 50 dB")


def test_echoes_are_named_by_where_they_are_heard():
    """Where rays bend that is 4.6 m behind where the near one of two is, 314.7 m off, and nearer to the far one."""
    need_device()
    with Folder() as folder:
        deep = POINTS.replace("[20, 12, 50]", "[300, 0, 100]").replace("[-23.3238, 0, 50]", "[305, 0, 100]")
        deep = deep.replace("[0, 0, 50]", "[0, 0, 5]").replace("sonar:", "sonar:\n  ping_rate_hz: 2\n  max_range_m: 330")
        water = ("environment: {sound_speed_mps: 1500, sound_speed_gradient_per_s: -0.5}\n"
                 "model: {refraction: full}\n")
        deep = water + deep.replace("source_level_db: 200", "source_level_db: 220")
        tap.equal(named(folder, deep.replace("{name: f}", "{name: f, pitch_deg: 18}")), {"ahead", "astern"})


def test_a_map_has_cells_by_the_bins():
    """Half a bin, 0.5 m at least; twice as long as often as there are else more than 4 million: of 10 by 10 km 8 m."""
    need_device()
    way = "{track: way.csv}"
    with Folder() as folder:
        folder.write("way.csv", "time_s,x_m,y_m,z_m,yaw_deg,pitch_deg,roll_deg\n0,0,0,50,0,0,0\n10,1e4,1e4,50,0,0,0\n")
        for bin_m, cell_m, mission in ((0.5, 0.5, None), (4, 2, None), (0.5, 8, way)):
            text = POINTS.replace("sonar:", f"sonar:\n  bin_length_m: {bin_m}", 1)
            text = text if mission is None else re.sub("mission: .*", f"mission: {mission}", text)
            text = text.replace("sonar:", "sonar:\n  ping_rate_hz: 0.1\n  max_range_m: 60", 1) if mission else text
            folder.write("map.yaml", text)
            asdic("run", "map.yaml", "-o", "out", "--force", "-q", cwd=folder.path).check(0)
            maps = []
            for cell in ((), ("--cell", str(cell_m)), ("--cell", str(2 * cell_m))):
                asdic("detect", "out", *cell, "--force", "-q", cwd=folder.path).check(0)
                maps.append((pathlib.Path(folder.path) / "out/occupancy.png").read_bytes())
            tap.equal([m == maps[0] for m in maps], [True, True, False], f"bins of {bin_m} m")


def test_a_map_reaches_as_far_as_a_steep_beam_hears():
    """80 degrees down and 56 tall: heard up to 0.75 heights above its axis, 38 degrees down."""
    need_device()
    with Folder() as folder:
        height_m = 0.443 * 1500 / 100e3 / math.sin(math.radians(28)) / math.sqrt(2)
        face = f"pitch_deg: 80, length_v_m: {height_m}"
        text = POINTS.replace("{name: f}", f"{{name: f, {face}}}")
        text = text.replace("sonar:", f"sonar:\n  transmitter: {{{face}}}")
        folder.write("steep.yaml", "environment: {sound_speed_mps: 1500}\n" + text)
        asdic("run", "steep.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        # Cells that are too small are refused with the number that there would be.
        refused = asdic("detect", "out", "--cell", "0.001", cwd=folder.path).check(2).err
        north, east = (int(word) for word in refused.split("a map of ")[1].split(" cells")[0].split(" x "))
        done = asdic("detect", "out", "--json", "-q", cwd=folder.path).check(0)
        reach_m = 0.5 * json.loads(done.out)["bins"] / 2
        tap.equal(abs(north * 0.001 - reach_m * math.cos(math.radians(38))) < 0.1, True, f"{north} mm of {reach_m} m")
        # Aside over 1.5 widths and the half of a quarter that a direction stands for.
        aside = 1.625 * 2 * math.asin(0.443 * 0.015 / math.hypot(0.05, 0.05))
        tap.equal(abs(east / north - 2 * math.sin(aside)) < 0.01, True, f"{east} mm aside")


# Shallow water in which bottom and surface mirror each other's echoes; nothing else is there.
SHALLOW = """version: 1
environment: {wind_speed_kn: 2}
bottom: {depth_m: 6, type: rock}
sonar:
  frequency_khz: 30
  bandwidth_khz: 3
  source_level_db: 210
  transmitter: {length_v_m: 0.03}
  receivers: [{name: ahead, length_v_m: 0.03}]
  speckle: rayleigh
mission: {pose: {position_m: [0, 0, 3]}, pings: 8}
sampling: {rays: 20000, multipath: boundaries}
output: {images: [], csv: none}
"""


def test_echoes_by_way_of_boundaries_are_background():
    need_device()
    with Folder() as folder:
        folder.write("shallow.yaml", SHALLOW)
        done = asdic("detect", "shallow.yaml", "-o", "out", "--json", cwd=folder.path).check(0)
        found = json.loads(done.out)
        tap.equal((found["background"], found["tracks"]["confirmed"]), ("simulated", 0))
        tap.equal(found["detections"] < 0.01 * found["bins"], True, f"{found['detections']} of {found['bins']} bins")
        done = asdic("detect", "out", "--force", "--json", "--background", "flat", cwd=folder.path).check(0)
        tap.contains(done.err, "knows no 'multipath: boundaries'")


# A triangle that rises from 31 m away to 45 m, and a ball before it.
RISE = """version: 1
bottom: {depth_m: 20, type: mud}
objects:
  - {name: slope, mesh: {file: slope.ply, z_up: false}, position_m: [0, 0, 0], material: {lambert_db: -10}}
  - {name: ball, sphere: {radius_m: 0.15}, position_m: [38, 0, 5], material: {lambert_db: -10}}
sonar:
  frequency_khz: 100
  source_level_db: 220
  receivers: [{name: ahead, length_h_m: 0.1, length_v_m: 0.02}]
  transmitter: {length_h_m: 0.1, length_v_m: 0.02}
  speckle: rayleigh
mission: {pose: {position_m: [0, 0, 8]}, pings: 3}
sampling: {rays: 20000}
"""


def test_a_large_triangle_is_named_all_over():
    """Its first and last corner are its nearest edge; a ball has its name in its own bins alone."""
    need_device()
    with Folder() as folder:
        folder.write("slope.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
                     "30 -3 14\n45 0 2\n30 3 14\n3 0 1 2\n")
        folder.write("rise.yaml", RISE)
        asdic("detect", "rise.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        found = rows(folder / "out/detections.csv")
        where = {name: [float(r["range_m"]) for r in found if r["truth"] == name] for name in ("slope", "ball")}
        tap.equal((min(where["slope"]) < 32, max(where["slope"]) > 42), (True, True), f"{where['slope']}")
        tap.equal([r for r in where["ball"] if abs(r - math.hypot(38, 3)) > 1.5], [], "far from the ball")
        tap.equal(len(where["slope"]) > 25, True, f"{where['slope']}")


def test_a_background_stops_when_told():
    need_device()
    with Folder() as folder:
        long = (WAVES % (DATA / "meshes/terrain.ply")).replace("count: 8", "count: 128")
        folder.write("waves.yaml", long.replace("pings: 40", "pings: 6"))
        out = pathlib.Path(folder.path) / "out"
        asdic("run", "waves.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        before = sorted(n.name for n in out.iterdir())
        command = [program.PATH, "detect", "out"]
        with subprocess.Popen(command, cwd=folder.path, stderr=subprocess.PIPE) as child:
            while not (out / "background.npy.part").exists() and child.poll() is None:
                time.sleep(0.01)
            program.stop(child, most_s=5)
        # While a driver compiles nothing can be cleared away: the next try replaces it.
        whole = [n.name for n in out.iterdir() if n.suffix != ".part"]
        tap.equal(sorted(whole), before)


def test_mistakes():
    need_device()
    with Folder() as folder:
        asdic("detect").check(2)
        asdic("detect", folder.path).check(3)
        asdic("detect", "nothing.yaml", cwd=folder.path).check(3)
        done = asdic("detect", folder.path, "--cfar", "cb").check(2)
        tap.contains(done.err, "did you mean 'ca'")
        done = asdic("detect", folder.path, "--cfar-cells", "4").check(2)
        tap.contains(done.err, "go with --cfar")
        done = asdic("detect", folder.path, "--pfa", "0.1", "--cost", "2").check(2)
        tap.contains(done.err, "two thresholds")
        done = asdic("detect", folder.path, "--pfa", "2").check(2)
        tap.contains(done.err, "[1e-12, 0.5]")
        scene2(folder, 1)
        asdic("run", "rise.yaml", "-q", "-o", "out", cwd=folder.path).check(0)
        # A map that cannot be is refused before a background is simulated.
        done = asdic("detect", "out", "--cell", "0.001", "--background", "simulated", cwd=folder.path).check(2)
        tap.contains(done.err, "larger")
        tap.equal([n for n in (pathlib.Path(folder.path) / "out").iterdir()
                   if n.suffix == ".part" or n.name == "background.npy"], [])


def test_a_sonar_that_looks_down_knows_places_to_a_bin():
    """Straight below there is no bearing: a track was taken to be known to 0.1 um."""
    need_device()
    with Folder() as folder:
        path = folder.write("down.yaml", """version: 1
bottom: {depth_m: 30}
objects:
  - sphere: {radius_m: 1}
    position_m: [1, 0, 15]
    material: {impedance_mrayl: 45, roughness_rms_mm: 1, slope_rms: 0.3}
sonar:
  frequency_khz: 100
  source_level_db: 200
  ping_rate_hz: 4
  speckle: rayleigh
  transmitter: {pitch_deg: 90}
  receivers: [{name: down, pitch_deg: 90}]
mission: {waypoints: {points_m: [[0, 0, 5], [2, 0, 5]], speed_mps: 1}}
sampling: {rays: 2000}
""")
        asdic("run", path, "-o", folder / "r").check(code=0)
        asdic("detect", folder / "r").check(code=0)
        rows = list(csv.DictReader(folder.read("r/tracks.csv").splitlines()))
        tap.equal(len(rows) > 3, True, "rows of tracks")
        for row in rows:
            for key in ("sd_x_m", "sd_y_m"):
                tap.equal(0.05 < float(row[key]) <= 0.5 / math.sqrt(12) + 1e-3, True, f"{key} {row[key]}")


tap.main(globals())
