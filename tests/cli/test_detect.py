"""asdic detect: detections, confusion table, map and tracks of a run."""
import csv
import json
import math
import pathlib
import re
import resource

import tap
from detections import COARSE, DATA, rows
from program import Folder, asdic, need_device
from run_folder import png_texts

COLUMNS = ["ping", "time_s", "beam", "bin", "range_m", "x_m", "y_m", "z_m", "level_db",
           "background_db", "llr", "posterior", "pd", "truth"]
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
        tap.contains(text, "  none: no echo to speak of; every detection is a false alarm; there are fewer in shadows\n")
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
