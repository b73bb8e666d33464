"""asdic roc: curves, tables, pictures, and designs compared."""
import csv
import json
import math
import os
import pathlib
import subprocess
import time

import program
import tap
from program import Folder, asdic, need_device
from run_folder import png_texts
from scenes import MIRRORED

SCENES = pathlib.Path(__file__).resolve().parents[2] / "data" / "scenes"
SCENE2 = SCENES / "scenario2.yaml"


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def test_the_rise():
    need_device()
    with Folder() as folder:
        umask = os.umask(0)
        done = asdic("roc", SCENE2, "--trials", "100000", "-o", "out", "--json", "-q", cwd=folder.path)
        os.umask(umask)
        done.check(0, err="")
        tap.equal(oct(os.stat(folder / "out").st_mode & 0o777), "0o777", "who may enter")
        curve, = json.loads(done.out)
        tap.equal((curve["variant"], curve["beam"], curve["range_m"], curve["looks"]),
                  ("rise", "forward", 35.25, 7))
        tap.equal(curve["area"]["low"] <= curve["closed_area"] <= curve["area"]["high"], True)
        tap.equal(curve["closed_pd"] > 0.999, True, "P_D of Swerling I at 34 dB")
        tap.equal((curve["target_uncertainty_db"], curve["model_pd"]), (None, {"low": None, "high": None}),
                  "its law states no error")
        table = rows(folder / "out/roc.csv")
        tap.equal(list(table[0]), ["variant", "design_pfa", "threshold_db", "pfa", "pfa_low",
                                   "pfa_high", "pd", "pd_low", "pd_high", "closed_pd"])
        tap.equal((len(table), len(curve["curve"])), (49, 49), "points of the curve")
        for row in table:
            design = float(row["design_pfa"])
            ratio = (float(row["pfa"]) - design) / max(design - float(row["pfa_low"]), 1e-12)
            tap.equal(abs(ratio) < 2, True, f"P_FA {row['pfa']} designed {design}")
        far = rows(folder / "out/roc_range.csv")
        tap.equal(list(far[0]), ["variant", "range_m", "snr_db", "pd", "pd_low", "pd_high",
                                 "closed_pd"])
        tap.equal(float(far[-1]["range_m"]) > 70, True)
        if "roc.png" in os.listdir(folder / "out"):
            tap.equal(title(folder, "out"),
                      ["scenario2: rise at 35.25 m, beam \u2018forward\u2019, 7 looks",
                       "100 kHz, bandwidth 10 kHz  \u00b7  bins of 0.5 m  \u00b7  levels re an SL of 0 dB"])
        done = asdic("roc", SCENE2, "-o", "out", cwd=folder.path).check(1)
        tap.contains(done.err, "--force")


def test_a_target_that_no_beam_hears():
    """Behind the vehicle: its curve is that of chance, and a sentence says why."""
    need_device()
    with Folder() as folder:
        asked = ("roc", SCENE2, "--trials", "1000", "-o", "out", "-f", "--json", "--range", "20", "--bearing")
        done = asdic(*asked, "170", cwd=folder.path).check(0)
        tap.contains(done.err, "a target at 20 m and a bearing of 170 degrees is not heard by any beam: it is detected as")
        curve, = json.loads(done.out)
        tap.equal((round(curve["closed_area"], 6), round(curve["closed_pd"], 9)), (0.5, 0.001), "as often as nothing")
        done = asdic(*asked, "10", cwd=folder.path).check(0)
        tap.equal("nothing is" in done.err, False, done.err)
        # Of several designs that which hears next to nothing is named.
        done = asdic(*asked, "10", "--vary", "sonar.noise.enabled=false,true", cwd=folder.path).check(0)
        told = [line for line in done.err.splitlines() if "nothing is" in line]
        tap.equal(len(told), 1, done.err)
        tap.contains(told[0], "sonar.noise.enabled=true: a target at 20 m and a bearing of 10 degrees is ")
        tap.contains(told[0], " dB below its background: it is detected as often as nothing is")


ARRAY = """version: 1
bottom: {depth_m: 12, type: sand}
objects:
  - {name: ball, sphere: {radius_m: 0.5}, position_m: [15, 0, 9], material: {type: sand}}
  - {name: other, sphere: {radius_m: 0.3}, position_m: [10, 5, 9], material: {type: sand}}
sonar:
  frequency_khz: 100
  max_range_m: 20
  source_level_db: 200
  array: {elements: 16, beams: {count: 8, sector_deg: 60}}
mission: {pose: {position_m: [0, 0, 7]}}
sampling: {coherent: true, rays: 5000}
"""


def test_a_coherent_scene_is_judged_by_its_intensities():
    """A coherent ping does not tell what objects are in a bin."""
    need_device()
    with Folder() as folder:
        folder.write("coherent.yaml", ARRAY)
        folder.write("intensities.yaml", ARRAY.replace("coherent: true, ", ""))
        curves = []
        for name in ("coherent", "intensities"):
            done = asdic("roc", f"{name}.yaml", "--object", "ball", "--trials", "1000", "-o", name, "--json",
                         "-q", cwd=folder.path).check(0)
            curve, = json.loads(done.out)
            curves.append({key: curve[key] for key in ("beam", "range_m", "snr_db", "closed_pd", "area")})
        tap.equal(curves[0], curves[1])
        tap.equal(curves[0]["closed_pd"] > 0.9, True, "the ball is heard")


def title(folder, name):
    """The two lines above the picture of a folder."""
    return png_texts(pathlib.Path(folder / name, "roc.png").read_bytes())["Title"].split("\n")


def test_other_beams_and_targets():
    need_device()
    with Folder() as folder:
        def ask(*options):
            done = asdic("roc", SCENE2, "--trials", "2000", "-o", "out", "--force", "--json", "-q",
                         *options, cwd=folder.path).check(0)
            return json.loads(done.out)[0]

        for beam in "down", "up":
            curve = ask("--beam", beam)
            tap.equal((curve["beam"], curve["closed_pd"] > 0.99), (beam, True))
        point = ask("--range", "60", "--strength", "-20", "--target", "swerling0", "--pfa", "1e-4")
        tap.equal((point["variant"], point["range_m"], point["pfa"]), ("target", 60, 1e-4))
        # The sonar equation by hand, on axis: TS - 40 log r - 2 alpha (r - 1), bins of one echo.
        level = -20 - 40 * 1.7781512503836436 - 2 * 0.03358 * 59
        tap.equal(abs(point["target_db"] - level) < 0.05, True, f"{point['target_db']} {level}")
        # At a range of roc_range.csv it says the same.
        there = ask("--range", "60.75", "--strength", "-20")
        with open(folder / "out/roc_range.csv", encoding="utf-8") as file:
            reach = {float(row["range_m"]): row for row in csv.DictReader(file)}
        for key in "snr_db", "closed_pd":
            off = float(reach[60.75][key]) - there[key]
            tap.equal(abs(off) < 1e-3, True, f"{key} by range: {off} off")
        aside = ask("--range", "60", "--strength", "-20", "--bearing", "10")
        tap.equal(aside["target_db"] < point["target_db"] - 3, True, "off the axis")


def test_a_point_has_its_strength():
    """Wherever it lies, as deep as it lies, in whichever beam; the beam that is named is asked, though another
    hears it better."""
    need_device()
    with Folder() as folder:
        for yaw_deg, pitch_deg, z_m, beams in ((30, 0, 11.5, ["any"]), (135, 0, 7, ["any", "aside"]), (250, 0, 2.5, ["any"]),
                                               (80, -45, 27, ["any"])):
            yaw, flat_m = math.radians(yaw_deg), math.sqrt(28.25**2 - (z_m - 7) ** 2)
            scene = SEDIMENT.replace("0, 7]", f"0, 7], yaw_deg: {yaw_deg}, pitch_deg: {pitch_deg}").replace(
                "depth_m: 12", f"depth_m: {max(12, z_m + 5)}").replace(
                "{name: forward}", "{name: aside, yaw_deg: 40}, {name: ahead}")
            folder.write("s.yaml", f"""{scene}objects:
  - {{name: buoy, point: -5, position_m: [{flat_m * math.cos(yaw)}, {flat_m * math.sin(yaw)}, {z_m}]}}
""")
            for beam in beams:
                done = asdic("roc", "s.yaml", "--object", "buoy", "--trials", "2000", "-o", "out", "--force", "--json",
                             "-q", *([] if beam == "any" else ["--beam", beam]), cwd=folder.path).check(0)
                curve, = json.loads(done.out)
                tap.equal(curve["beam"], "ahead" if beam == "any" else beam)
                tap.equal(curve["range_m"], 28.25)
                tap.equal(abs(curve["target_strength_db"] + 5) < 0.1, True,
                          f"{yaw_deg}, {beam}: {curve['target_strength_db']} dB")


def test_a_points_strength_does_not_depend_on_its_bin():
    """Near the edges of bins, also of those nearest, in which a spherical wave loses much; where a pulse is longer than a
    bin as well."""
    need_device()
    with Folder() as folder:
        for bandwidth_khz in 10, 1.4:
            for range_m in 1.02, 1.48, 3.01, 18.49:
                folder.write("s.yaml", SEDIMENT.replace("ping_rate_hz", f"bandwidth_khz: {bandwidth_khz}, bin_length_m: 0.5, "
                                                        "ping_rate_hz") + f"""objects:
  - {{name: buoy, point: 0, position_m: [{range_m}, 0, 7]}}
""")
                done = asdic("roc", "s.yaml", "--object", "buoy", "--trials", "1000", "-o", "out", "--force", "--json", "-q",
                             cwd=folder.path).check(0)
                off_db = json.loads(done.out)[0]["target_strength_db"]
                tap.equal(abs(off_db) < 0.15, True, f"{bandwidth_khz} kHz, {range_m} m: {off_db} dB")


def test_a_point_is_heard_by_rays_that_bend():
    """One that stands in the scene, whose echo is simulated, has its strength; in the shadow of a thermocline one at a
    range is not heard. By straight rays it stood 26 dB above the background, and the strength was 0.6 dB less."""
    need_device()
    for z_m, range_m, options in ((9, 12.25, ("--object", "p")), (4, 45.25, ("--object", "p")),
                                  (9, 65.25, ("--range", 65.25, "--strength=-10"))):
        with Folder() as folder:
            folder.write("point.yaml", f"""version: 1
environment: {{sound_speed_profile: [[0, 1482], [3, 1480], [6, 1468], [9, 1440], [13, 1431]]}}
bottom: {{depth_m: 12, type: mud}}
objects: [{{name: p, point: -10, position_m: [{range_m}, 0, {z_m}]}}]
sonar: {{frequency_khz: 100, ping_rate_hz: 9, source_level_db: 200, bin_length_m: 0.5, bandwidth_khz: 1.5,
  receivers: [{{name: ahead}}]}}
mission: {{pose: {{position_m: [0, 0, {z_m}]}}}}
sampling: {{rays: 4000}}
""")
            done = asdic("roc", "point.yaml", "--trials", 1000, "-o", "out", "--json", "-q", *options, cwd=folder.path)
            curve, = json.loads(done.check(0).out)
            if "--object" in options:
                off_db = curve["target_strength_db"] + 10
                tap.equal(abs(off_db) < 0.3, True, f"{range_m} m: {off_db} dB")
            else:
                tap.equal(curve["snr_db"] is None or curve["snr_db"] < -10, True, f"{curve['snr_db']}")


def test_an_object_is_found_where_bent_rays_are_heard():
    """In water in which sound slows down by 0.5 m/s a metre it takes arcosh(1 + d^2 / 8 c1 c2) / 0.5 s over the distance
    d, by which an object 315 m off is heard 4.6 m behind that: outside its box, where nothing was found before."""
    need_device()
    with Folder() as folder:
        folder.write("deep.yaml", """version: 1
environment: {sound_speed_mps: 1500, sound_speed_gradient_per_s: -0.5}
bottom: {depth_m: 150, type: mud}
objects: [{name: p, point: 0, position_m: [300, 0, 100]}]
sonar: {frequency_khz: 50, ping_rate_hz: 2, source_level_db: 220, bin_length_m: 0.25, receivers: [{name: a, pitch_deg: 18}]}
mission: {pose: {position_m: [0, 0, 5]}}
sampling: {rays: 4000}
""")
        done = asdic("roc", "deep.yaml", "--trials", 1000, "-o", "out", "--json", "-q", cwd=folder.path)
        curve, = json.loads(done.check(0).out)
        here, there = 1500 - 0.5 * 5, 1500 - 0.5 * 100
        time_s = math.acosh(1 + 0.25 * (300 ** 2 + 95 ** 2) / (2 * here * there)) / 0.5
        tap.equal(abs(curve["range_m"] - here * time_s) <= 0.25, True, f"{curve['range_m']}, not {here * time_s} m")
        tap.equal(curve["snr_db"] is not None and curve["snr_db"] > 10, True, f"{curve['snr_db']} dB")
        tap.equal(abs(curve["target_strength_db"]) < 0.15, True, f"{curve['target_strength_db']} dB")


def test_a_pulse_spreads_its_echo():
    """Of 0.75 m over bins of 0.1 m: a point of the scene is one of its range and strength."""
    need_device()
    with Folder() as folder:
        folder.write("s.yaml", SEDIMENT.replace("ping_rate_hz", "bandwidth_khz: 1, bin_length_m: 0.1, ping_rate_hz")
                     + "objects:\n  - {name: buoy, point: -20, position_m: [20.07, 0, 7]}\n")
        found = []
        for target in ("--object", "buoy"), ("--range", "20.07", "--strength=-20"):
            done = asdic("roc", "s.yaml", *target, "--trials", "2000", "-o", "out", "--force", "--json", "-q",
                         cwd=folder.path).check(0)
            found.append(json.loads(done.out)[0])
        buoy, point = found
        tap.equal(abs(buoy["target_strength_db"] + 20) < 0.2, True, f"{buoy['target_strength_db']} dB")
        tap.equal(abs(buoy["target_db"] - point["target_db"]) < 1e-3, True,
                  f"{buoy['target_db']}, by range {point['target_db']} dB")


def test_an_object_has_its_own_echo():
    """Two points at one range: each is heard as if it were alone, and not where the other is louder."""
    need_device()
    with Folder() as folder:
        def ask(code, objects, *options):
            folder.write("s.yaml", SEDIMENT.replace("{name: forward}", "{name: port, yaw_deg: -45}, "
                                                    "{name: starboard, yaw_deg: 45}") + f"objects:\n{objects}")
            done = asdic("roc", "s.yaml", "--trials", "2000", "-o", "out", "--force", "--json", "-q", *options,
                         cwd=folder.path).check(code)
            return done.err if code else json.loads(done.out)[0]

        points = {name: f"  - {{name: {name}, point: {db}, position_m: [20, {y_m}, 7]}}\n"
                  for name, db, y_m in (("buoy", -40, 20), ("ship", 10, -20))}
        for name, beam, strength_db in ("buoy", "starboard", -40), ("ship", "port", 10):
            alone = ask(0, points[name])
            among = ask(0, "".join(points.values()), "--object", name)
            tap.equal((among["beam"], alone["beam"], among["range_m"]), (beam, beam, 28.25))
            tap.equal(abs(among["target_strength_db"] - strength_db) < 0.1, True, f"{among['target_strength_db']} dB")
            for key in "target_db", "closed_pd":
                tap.equal(abs(among[key] - alone[key]) < 1e-3, True, f"{key}: {among[key]}, alone {alone[key]}")
        tap.contains(ask(2, "".join(points.values()), "--object", "buoy", "--beam", "port"),
                     "other objects are louder than 'buoy'")


def test_an_object_that_turns_is_found():
    """A bar across the beam, which a second later is end-on, and a cube that then stands on an edge, at which a narrow
    beam looks: as one that always was."""
    need_device()
    with Folder() as folder:
        for turn, size, north_m, beam, range_m in (
                ("0, 0, 0", "40, 0.5, 2", 60, "", 40.25),
                ("0, 45, 0", "6, 6, 6", 25, ", pitch_deg: -11, length_v_m: 0.1", None)):
            found = []
            folder.write("turn.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                         f"0,{north_m},0,7,0,0,90\n1,{north_m},0,7,{turn.replace(' ', '')}\n")
            for place in "track: turn.csv", f"position_m: [{north_m}, 0, 7], rotation_deg: [{turn}]":
                folder.write("s.yaml", SEDIMENT.replace("0, 7]}", "0, 7]}, pings: 11").replace(
                    "name: forward", "name: forward" + beam) + f"""objects:
  - {{name: bar, box: {{size_m: [{size}]}}, material: {{lambert_db: -10}}, {place}}}
""")
                done = asdic("roc", "s.yaml", "--ping", "10", "--trials", "2000", "-o", "out", "--force", "--json", "-q",
                             cwd=folder.path).check(0)
                found.append(json.loads(done.out)[0])
            turned, still = found
            tap.equal(turned["range_m"], range_m or still["range_m"], "the bin of its near end")
            for key in "target_db", "target_strength_db":
                tap.equal(abs(turned[key] - still[key]) < 1e-3, True, f"{key}: {turned[key]}, at rest {still[key]}")


def test_an_objects_strength_does_not_depend_on_the_compass():
    """A large box, whose middle is north-east, south-east, ... of the sonar, as the bow is."""
    need_device()
    with Folder() as folder:
        found = []
        for north, east, yaw_deg in (30, 30, 45), (-30, 30, 135), (-30, -30, 225), (30, -30, 315):
            folder.write("s.yaml", SEDIMENT.replace("0, 7]", f"0, 7], yaw_deg: {yaw_deg}").replace(
                "{name: forward}", "{name: forward, length_h_m: 0.3}") + f"""objects:
  - {{name: block, box: {{size_m: [10, 10, 4]}}, material: {{lambert_db: -10}}, position_m: [{north}, {east}, 10]}}
""")
            done = asdic("roc", "s.yaml", "--object", "block", "--trials", "2000", "-o", "out", "--force", "--json",
                         "-q", cwd=folder.path).check(0)
            found.append(json.loads(done.out)[0]["target_strength_db"])
        tap.equal(max(found) - min(found) < 0.2, True, f"{found} dB")
        # A face of 45 degrees to either side of the corner, 4 m high, in a cell of a few decimetres: no more
        # than a few square metres at -10 dB.
        tap.equal(-25 < min(found) < 5, True, f"{found} dB")


def test_a_background_holds_what_boundaries_mirror():
    """Between a rough bottom and a smooth surface, mirrored echoes are louder than direct ones."""
    need_device()
    with Folder() as folder:
        for speckle in "none", "rayleigh":
            folder.write(speckle + ".yaml", f"""version: 1
environment: {{wind_speed_kn: 2}}
bottom: {{depth_m: 6, type: rock}}
sonar:
  frequency_khz: 30
  bandwidth_khz: 3
  source_level_db: 210
  receivers: [{{name: ahead, length_v_m: 0.03}}]
  speckle: {speckle}
mission: {{pose: {{position_m: [0, 0, 3]}}}}
sampling: {{rays: 100000, multipath: boundaries}}
output: {{images: []}}
""")
        asdic("run", "none.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        ping = next(r for r in rows(folder / "out/bins.csv") if r["bin"] == "120")
        done = asdic("roc", "rayleigh.yaml", "--range", "60.1", "--strength=-10", "--trials", "1000", "-o", "roc",
                     "--json", "-q", cwd=folder.path).check(0)
        told = json.loads(done.out)[0]["background_db"]
        tap.equal(float(ping["multipath_db"]) > float(ping["bottom_db"]) + 3, True, "mirrored echoes")
        tap.equal(abs(told - float(ping["level_db"])) < 0.5, True, f"{told} dB of {ping['level_db']}")


def test_mirrors_have_no_texture():
    """As speckle is drawn: the threshold over them was that of K speckle alone. One look of K of shape 1/2 over a share
    f without texture: P(z > t) is the mean of exp(-t / (f + (1 - f) x^2)) over normal x."""
    need_device()
    with Folder() as folder:
        folder.write("mirrored.yaml", MIRRORED)
        asdic("run", "mirrored.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        row = rows(folder / "out/bins.csv")[84]
        lin = {k: 10 ** (0.1 * float(row[f"{k}_db"])) for k in ("bottom", "surface", "volume", "multipath", "noise")
               if row[f"{k}_db"]}
        f = (lin["multipath"] + lin["noise"]) / sum(lin.values())
        tap.equal(f > 0.5, True, f"a share of {f} by way of mirrors")
        done = asdic("roc", "mirrored.yaml", "--range", "42.2", "--strength", "0", "--trials", "1000", "-o", "roc", "--json",
                     "-q", cwd=folder.path).check(0)
        curve, = json.loads(done.out)
        for point in curve["curve"]:
            design = point["design_pfa"]
            if not 1e-5 < design < 0.2:
                continue
            t = 10 ** (0.1 * (point["threshold_db"] - curve["background_db"]))
            pfa = sum(0.01 * math.exp(-t / (f + (1 - f) * x * x) - 0.5 * x * x) / math.sqrt(2 * math.pi)
                      for x in (0.01 * i for i in range(-900, 901)))
            tap.equal(0.97 < pfa / design < 1.03, True, f"P_FA {pfa} designed {design}")


def test_bearings_are_from_the_bow():
    """Of a sonar whose head turns: a target is on its axis when the head looks there, and hardly heard beside it."""
    need_device()
    with Folder() as folder:
        folder.write("s.yaml", SEDIMENT.replace("0, 7]", "0, 7], yaw_deg: 100").replace(
            "receivers", "scan: {sector_deg: 120, step_deg: 30}, receivers"))

        def target_db(ping, bearing_deg):
            done = asdic("roc", "s.yaml", "--range", "30", "--bearing", str(bearing_deg), "--ping", str(ping),
                         "--trials", "2000", "-o", "out", "--force", "--json", "-q", cwd=folder.path).check(0)
            return json.loads(done.out)[0]["target_db"]

        ahead_db = target_db(2, 0)  # the head at -60, -30, 0, 30, 60 degrees
        for ping, bearing_deg in (0, -60), (3, 30), (4, 60):
            off_db = target_db(ping, bearing_deg) - ahead_db
            tap.equal(abs(off_db) < 1e-6, True, f"on the axis at ping {ping}: {off_db} dB")
        tap.equal(target_db(2, 30) < ahead_db - 20, True, "off the axis")


def test_a_beam_among_others_is_as_alone():
    need_device()
    with Folder() as folder:
        text = SCENE2.read_text(encoding="utf-8")
        others = [line for line in text.splitlines() if "{name: forward" in line or "{name: up" in line]
        folder.write("three.yaml", text)
        for line in others:
            text = text.replace(line + "\n", "")
        folder.write("one.yaml", text)
        levels = {}
        for name in "three", "one":
            asdic("roc", name + ".yaml", "--beam", "down", "--range", "40", "--trials", "2000", "-q", "-o", name,
                  cwd=folder.path).check(0)
            levels[name] = [(float(row["range_m"]), float(row["snr_db"]))
                            for row in rows(folder / (name + "/roc_range.csv"))]
        tap.equal(len(levels["one"]) > 50, True, "ranges")
        tap.equal([r for r, _ in levels["three"]], [r for r, _ in levels["one"]], "ranges")
        apart = max(abs(a - b) for (_, a), (_, b) in zip(levels["three"], levels["one"]))
        tap.equal(apart < 0.01, True, f"{apart} dB")


def test_designs_are_compared():
    need_device()
    with Folder() as folder:
        done = asdic("roc", SCENE2, "--range", "60", "--strength", "-20", "--beam", "forward",
                     "--vary", "sonar.receivers[0].pitch_deg=0,1,10", "--trials", "50000", "-o",
                     "out", "--json", "-q", cwd=folder.path).check(0)
        first, near, far = json.loads(done.out)
        tap.equal([first["variant"], near["variant"], far["variant"]], ["0", "1", "10"])
        wide = near["area"]["high"] - near["area"]["low"]
        for other in near, far:
            difference = other["area_difference"]
            tap.equal(difference["high"] < 0, True, "a beam aimed elsewhere is worse")
            tap.equal(difference["high"] - difference["low"] < 0.8 * wide, True, "pairs")
        tap.equal({row["variant"] for row in rows(folder / "out/roc.csv")},
                  {"pitch_deg = 0", "pitch_deg = 1", "pitch_deg = 10"})
        asdic("roc", SCENE2, "--vary", "sonar.frequency_khz=80,100", "--trials", "5000", "-o",
              "tone", cwd=folder.path).check(0)
        text = asdic("roc", SCENE2, "--vary", "objects[0].position_m[0]=55,60", "--trials", "5000",
                     "-o", "place", cwd=folder.path).check(0).out
        tap.contains(text, "40.25 m")
        if "roc.png" in os.listdir(folder / "out"):
            first, facts = title(folder, "out")
            tap.equal(first, "scenario2: sonar.receivers[0].pitch_deg, the first at 60 m, beam \u2018forward\u2019, "
                             "7 looks")
            tap.equal(facts.startswith("100 kHz, "), True, facts)
            tap.equal(title(folder, "tone")[1].startswith("the first: 80 kHz, "), True, "facts that differ")


def test_the_background_is_told():
    need_device()
    terrain = pathlib.Path(SCENE2).parent.parent / "meshes/terrain.ply"
    mesh = f"""version: 1
bottom: {{mesh: {{file: "{terrain}"}}, type: sand}}
sonar: {{frequency_khz: 200, source_level_db: 200, receivers: [{{name: ahead}}]}}
mission: {{pose: {{position_m: [20, 0, 25]}}}}
sampling: {{rays: 2000}}
"""
    with Folder() as folder:
        folder.write("mesh.yaml", mesh)
        common = ("--range", "40", "--strength=-20", "--trials", "2000")
        flat = asdic("roc", SCENE2, *common, "-o", "a", cwd=folder.path).check(0)
        tap.contains(flat.out, "background: what is expected over a plane\n")
        tap.contains(flat.out, "P_D at P_FA = 0.001; ")
        strict = asdic("roc", SCENE2, *common, "-o", "d", "--vary", "detector.pfa=1e-2,1e-5", cwd=folder.path).check(0)
        tap.contains(strict.out, "P_D at P_FA = 0.01, 1e-05; ")
        tap.equal(strict.out.count("background: "), 1, "one for both")
        rays = asdic("roc", "mesh.yaml", *common, "-o", "e", "--vary", "sampling.rays=1000,64000",
                     cwd=folder.path).check(0)
        for name in "1000", "64000":
            tap.contains(rays.out, f"\n{name}: background: the rest of one simulated ping, standard error ")
        rough = asdic("roc", "mesh.yaml", *common, "-o", "b", cwd=folder.path).check(0)
        tap.contains(rough.out, "background: the rest of one simulated ping, standard error ")
        curve, = json.loads(asdic("roc", "mesh.yaml", *common, "--json", "-o", "c",
                                  cwd=folder.path).check(0).out)
        tap.equal(curve["background_error_db"] > 0, True, "the error of few rays")


def test_more_draws_than_memory_holds_are_refused():
    """Before anything is simulated: 80 bytes each while they are sorted. They were drawn, 1.6 GB, and then ran out."""
    need_device()
    if program.is_sanitized():
        raise tap.Skip("sanitizers do not start in limited memory")
    with Folder() as folder:
        few = ["sh", "-c", 'ulimit -v 6000000; exec "$@"', "sh", program.PATH]
        done = subprocess.run([*few, "roc", SCENE2, "--trials", "100000000", "-o", folder / "out"], capture_output=True,
                              check=False, text=True, timeout=60, env=program.environment({}))
        tap.equal(done.returncode, 1, done.stderr)
        tap.contains(done.stderr, "100000000 trials need 8000000000 bytes of memory")
        tap.contains(done.stderr, "use fewer")


def test_mistakes():
    need_device()
    with Folder() as folder:
        def fail(code, says, *options):
            done = asdic("roc", *options, "-o", "out", cwd=folder.path).check(code)
            tap.contains(done.err, says)
            tap.equal(folder.names(), ["blanked.yaml", "mesh.yaml"], "files left behind")

        terrain = SCENES.parent / "meshes/terrain.ply"
        folder.write("mesh.yaml", SEDIMENT.replace("depth_m: 12, sediment: medium_sand",
                                                   f"mesh: {{file: '{terrain}'}}, type: sand"))
        folder.write("blanked.yaml", SEDIMENT.replace("noise: {enabled: false}", "blanking_m: 10"))
        fail(2, "KEY=VALUE", SCENE2, "--vary", "sonar")
        fail(2, "none of them empty", SCENE2, "--vary", "sonar.frequency_khz=80,,90")
        fail(3, "frequency_khz", SCENE2, "--vary", "sonar.frequenci_khz=80")
        fail(2, "no object 'wreck'", SCENE2, "--object", "wreck")
        fail(2, "no object ''", "mesh.yaml", "--object", "")  # the bottom's mesh has no name
        fail(2, "no beam 'aft'", SCENE2, "--beam", "aft")
        fail(2, "give --range", SCENES / "scenario1.yaml")
        fail(2, "those of a target at --range", SCENE2, "--strength", "3")
        fail(2, "two targets", SCENE2, "--object", "rise", "--range", "5")
        fail(2, "end at 74.5 m", SCENE2, "--range", "500")
        fail(2, "blanked to 10 m", "blanked.yaml", "--range", "9.9", "--strength=-30")
        fail(2, "ping 7 of a mission of 1", SCENE2, "--ping", "7")
        fail(3, "nothing.yaml", "nothing.yaml")
        os.mkdir(folder / "mine")
        asdic("roc", SCENE2, "--object", "wreck", "-o", "mine", cwd=folder.path).check(2)
        tap.equal(folder.names(), ["blanked.yaml", "mesh.yaml", "mine"], "a folder that was there before")


# No noise, no surface, clear water: all that the target stands in is the bottom's.
SEDIMENT = """version: 1
environment: {particle_density: -200}
surface: {enabled: false}
bottom: {depth_m: 12, sediment: medium_sand}
mission: {pose: {position_m: [0, 0, 7]}}
sonar: {frequency_khz: 100, ping_rate_hz: 10, speckle: rayleigh, noise: {enabled: false},
        receivers: [{name: forward}]}
"""


def test_the_laws_error_moves_detection():
    need_device()
    with Folder() as folder:
        def ask(scene, *options):
            done = asdic("roc", scene, "--trials", "2000", "-o", "out", "--force", "--json", "-q",
                         "--range", "40", *options, cwd=folder.path).check(0)
            return json.loads(done.out)

        pathlib.Path(folder / "sand.yaml").write_text(SEDIMENT, encoding="utf-8")
        curve, = ask("sand.yaml", "--strength", "-20")
        tap.equal(round(curve["background_uncertainty_db"], 6), 5.0)
        tap.equal(curve["target_uncertainty_db"], None, "a point's strength is given")
        for end, shift in ("low", -25), ("high", -15):
            moved, = ask("sand.yaml", "--strength", str(shift))
            off = curve["model_pd"][end] - moved["closed_pd"]
            tap.equal(abs(off) < 1e-9, True, f"a background 5 dB {end}: {off}")
        measured = SEDIMENT.replace("medium_sand", "medium_sand, spectral_strength_cm4: 0.0044, "
                                                   "volume_ratio: 0.002")
        pathlib.Path(folder / "measured.yaml").write_text(measured, encoding="utf-8")
        known, = ask("measured.yaml", "--strength", "-20")
        tap.equal(round(known["background_uncertainty_db"], 6), 3.0, "numbers that are known")
        paired = ask("sand.yaml", "--strength", "-20", "--vary",
                     "sonar.receivers[0].pitch_deg=0,4")
        ends = sorted(paired[1]["model_pd"][e] - paired[0]["model_pd"][e] for e in ("low", "high"))
        told = paired[1]["model_pd_difference"]
        tap.equal([told["low"], told["high"]], ends, "the same error for both")
        spiky = SEDIMENT.replace("speckle: rayleigh", "speckle: k, speckle_shape: 0.5")
        pathlib.Path(folder / "spiky.yaml").write_text(spiky, encoding="utf-8")
        among, = ask("spiky.yaml", "--strength", "-20")
        tap.equal(among["closed_pd"] < curve["closed_pd"] - 0.05, True, "spikes raise the threshold")
        silent, = ask(SCENE2, "--strength", "-20")
        tap.equal(silent["model_pd"], {"low": None, "high": None}, "the course states none")

        pathlib.Path(folder / "rise.yaml").write_text(SEDIMENT + """objects:
  - {name: rise, box: {size_m: [4, 20, 2]}, position_m: [37, 0, 11], material: {sediment: rock}}
""", encoding="utf-8")
        asdic("run", "rise.yaml", "-o", "run", "-q", cwd=folder.path).check(0)
        facts = json.loads(pathlib.Path(folder / "run/run.json").read_text(encoding="utf-8"))
        tap.equal(facts["model_uncertainty_db"], {"bottom": 5, "surface": None, "object": 10})
        done = asdic("detect", "run", "--json", "-q", cwd=folder.path).check(0)
        sights = json.loads(done.out)["objects"]
        tap.equal(len(sights) > 0, True, "the rise is seen")
        for sight in sights:
            band = sight["model_pd"]
            tap.equal(band["low"] <= sight["pd"] <= band["high"], True, f"{band} {sight['pd']}")
        # Of two objects each errs by its own law; the bottom's without an error, the metal has no band.
        certain = SEDIMENT.replace("sediment: medium_sand", "type: sand")
        pathlib.Path(folder / "two.yaml").write_text(certain + """objects:
  - {name: metal, sphere: {radius_m: 0.5}, position_m: [25, 0, 7]}
  - {name: rise, box: {size_m: [4, 20, 2]}, position_m: [37, 0, 11], material: {sediment: rock}}
""", encoding="utf-8")
        for name, error_db in ("metal", None), ("rise", 10):
            done = asdic("roc", "two.yaml", "--object", name, "--trials", "2000", "-o", "out", "--force", "--json",
                         "-q", cwd=folder.path).check(0)
            tap.equal(json.loads(done.out)[0]["target_uncertainty_db"], error_db, name)
        done = asdic("detect", "two.yaml", "-o", "two", "--json", "-q", cwd=folder.path).check(0)
        stated = {o["object"]: o["model_pd"]["low"] is not None for o in json.loads(done.out)["objects"]}
        tap.equal(stated, {"metal": False, "rise": True}, "whose P_D has a band")
        done = asdic("expect", "sand.yaml", "-o", "out.csv", cwd=folder.path).check(0)
        tap.contains(done.err, "model_uncertainty_db: bottom 5")


def test_thresholds_err_as_the_background_they_stand_over():
    """A slab hides the bottom. Of one look P_D is exp(-threshold / echo): 5 dB of background raise it to 10^0.5."""
    need_device()
    with Folder() as folder:
        text = SEDIMENT.replace("frequency_khz: 100", "frequency_khz: 100, bandwidth_khz: 1.5, source_level_db: 200")
        pathlib.Path(folder / "slab.yaml").write_text(text + """objects:
  - {name: slab, box: {size_m: [60, 200, 0.4]}, position_m: [55, 0, 11.9], material: {type: gravel}}
""", encoding="utf-8")
        asdic("run", "slab.yaml", "-o", "run", "-q", cwd=folder.path).check(0)
        for background in "flat", "simulated":
            done = asdic("detect", "run", "--background", background, "--pfa", "0.01", "--force", "--json", "-q",
                         cwd=folder.path).check(0)
            slab, = json.loads(done.out)["objects"]
            for end, factor in ("low", 10**0.5), ("high", 10**-0.5):
                off = slab["model_pd"][end] - slab["pd"]**factor
                tap.equal(abs(off) < 0.01, True, f"{background}: {slab}")


def test_words_say_what_json_says():
    need_device()
    with Folder() as folder:
        def bounds(band, form):
            return f"{band['low']:{form}}..{band['high']:{form}}"

        # One look: a bin as long as a pulse.
        pathlib.Path(folder / "sand.yaml").write_text(
            SEDIMENT.replace("ping_rate_hz: 10", "max_range_m: 20, bin_length_m: 0.075"), encoding="utf-8")
        for vary in (), ("--vary", "sonar.receivers[0].pitch_deg=0.0000000,4"):
            ask = ("roc", "sand.yaml", "--range", "18", "--strength=-30", "--trials", "2000", "--force", *vary)
            curves = json.loads(asdic(*ask, "--json", cwd=folder.path).check(0).out)
            text = asdic(*ask, cwd=folder.path).check(0).out.splitlines()
            tap.equal({line.index("forward") for line in text[1:1 + len(curves)]}, {text[0].index("beam")}, "columns")
            lines = [" ".join(line.split()) for line in text]
            told, models = [], []
            for c in curves:
                told.append(f"{c['variant']} forward {c['range_m']:.2f} m {c['snr_db']:.2f} dB {c['pd']['value']:.4f} "
                             f"{bounds(c['pd'], '.4f')} {c['closed_pd']:.4f} {c['area']['value']:.5f} "
                             f"{bounds(c['area'], '.5f')} {c['closed_area']:.5f}")
                models.append(f"{c['variant']}: P_D {bounds(c['model_pd'], '.4f')} "
                              "over the error of the scattering laws")
                is_first = c is curves[0]
                tap.equal(["area_difference" in c, "model_pd_difference" in c], [not is_first] * 2)
                if not is_first:
                    less = c["area_difference"]
                    told[-1] += f" {less['value']:+.5f} ({bounds(less, '+.5f')})"
                    models[-1] += ("; less the first's, with the same error, "
                                   + bounds(c["model_pd_difference"], "+.4f"))
            count = len(curves)
            tap.equal(lines[0].endswith("area - first's"), count > 1, "the last column")
            tap.equal(lines[1:1 + count], told)
            tap.contains(lines[1 + count], "P_D at P_FA = 0.001; 2000 draws each, ")
            tap.equal(lines[2 + count], "background: what is expected over a plane")
            tap.equal(lines[3 + count:3 + 2 * count], models)
            decades = [f"{p['design_pfa']:.0e} {p['threshold_db']:.2f} dB {p['pfa']['value']:.4e} "
                       f"{bounds(p['pfa'], '.4e')}" for p in curves[0]["curve"]
                       if any(abs(p["design_pfa"] * 10**n - 1) < 1e-6 for n in range(1, 7))]
            tap.equal(len(decades), 6)
            tap.equal(lines[5 + 2 * count:], decades if count == 1 else [], "thresholds by decades")
            if "roc.png" in os.listdir(folder / "roc_sand"):
                line = title(folder, "roc_sand")[0]
                tap.equal(line.endswith(", 1 look"), True, line)


def test_a_mistake_is_told_once():
    need_device()
    with Folder() as folder:
        scene1 = pathlib.Path(SCENE2).with_name("scenario1.yaml")
        done = asdic("roc", scene1, cwd=folder.path).check(2)
        tap.contains(done.err, "error: the scene has no object; give --range")
        tap.equal(done.err.count("error:"), 1, "sentences")
        many = folder.write("many.yaml", "version: 1\nbottom: none\nobjects:\n" + "".join(
            f"  - {{name: b{i}, point: {{target_strength_db: 0}}, position_m: [{9 + i}, 0, 5]}}\n" for i in range(9))
            + "sonar: {frequency_khz: 100, ping_rate_hz: 10, source_level_db: 200, receivers: [{name: port, yaw_deg: -9}, {name: starboard, yaw_deg: 9}]}\n"
              "mission: {pose: {position_m: [0, 0, 5]}}\n")
        for option, name, end in (("--object", "c1", ", ".join(f"'b{i}'" for i in range(8)) + ", ..."),
                                  ("--beam", "stern", "there are 'port' to 'starboard'")):
            done = asdic("roc", many, "--object", "b0", option, name, cwd=folder.path).check(2)
            tap.equal(done.err.strip().endswith(f"{name}'; {'it has ' if name == 'c1' else ''}{end}"), True, done.err)
        tap.equal(folder.names(), ["many.yaml"])


def test_it_stops_within_a_second():
    need_device()
    with Folder() as folder:
        command = [program.PATH, "roc", SCENE2, "--object", "rise", "--trials", "20000000",
                   "-o", "out"]
        with subprocess.Popen(command, cwd=folder.path, stderr=subprocess.PIPE) as child:
            time.sleep(1.5)  # of a quarter of a minute or more of drawing
            program.stop(child)
        tap.equal(folder.names(), [])


tap.main(globals())
