"""asdic detect: what is printed is what --json says; which options go together; whose detector it is."""
import csv
import json
import os

import tap
from program import Folder, asdic, need_device
from run_folder import data

# A ball before nine beams side by side, which all hear it.
SCENE = """version: 1
bottom: {depth_m: 20, type: sand}
objects:
  - {name: ball, sphere: {radius_m: 1}, position_m: [20, 0, 8], material: {impedance_mrayl: 45}}
sonar:
  frequency_khz: 100
  bin_length_m: 0.5
  source_level_db: 220
  receivers: {fan: {count: 9, sector_deg: 4, length_h_m: 0.1, length_v_m: 0.1}}
  speckle: rayleigh
mission: {pose: {position_m: [0, 0, 8]}, pings: 4}
sampling: {rays: 1000}
detector: {pfa: 1.0e-2, target: swerling3, prior: 0.2, snr_db: 12}
output: {images: [], csv: none}
"""


def made(folder, text=SCENE):
    """A run of the scene in out."""
    folder.write("scene.yaml", text)
    asdic("run", "scene.yaml", "-q", "-f", "-o", "out", cwd=folder.path).check(0)


def report(folder, *options):
    done = asdic("detect", "out", "--json", "--force", "--cell", "5", *options, cwd=folder.path)
    return json.loads(done.check(0).out)


def sight_row(seen, beam):
    row = f"{seen['object']:20} {beam:20} {seen['pings_detected']:5}/{seen['pings_seen']:<5} " \
          f"{seen['range_m']:6.4g} m {seen['snr_db']:6.1f} dB {seen['pd']:8.4f} " \
          f"{'yes' if seen['detected'] else 'no':>7}"
    band = seen["model_pd"]
    if band["low"] is not None:
        row += f"   P_D {band['low']:.4f}..{band['high']:.4f} by laws"
    return row


BUOY = """version: 1
environment: {particle_density: -200}
surface: {enabled: false}
bottom: {depth_m: 12, sediment: medium_sand}
objects: [{name: buoy, point: -22, position_m: [40, 0, 7]}]
sonar: {frequency_khz: 100, bandwidth_khz: 1.5, bin_length_m: 0.5, ping_rate_hz: 10, speckle: rayleigh,
        noise: {enabled: false}, receivers: [{name: forward}]}
mission: {pose: {position_m: [0, 0, 7]}}
sampling: {rays: 4000}
detector: {pfa: 1.0e-3}
output: {images: [], csv: none}
"""


def test_bands_are_those_of_the_laws_error():
    """A point that fades as its background does, of one look: P_D = P_FA^(1 / (1 + snr)), where the threshold was set for
    the bottom by quadrature; and the handbook leaves 5 dB of the bottom open, which moves the threshold with it."""
    need_device()
    with Folder() as folder:
        made(folder, BUOY)
        seen, = report(folder)["objects"]
        snr, pd = 10 ** (0.1 * seen["snr_db"]), seen["pd"]
        tap.equal(abs(pd - 1e-3 ** (1 / (1 + snr))) < 1e-2, True, f"P_D {pd} at {seen['snr_db']} dB")
        for end, shift_db in ("low", -5), ("high", 5):
            exact = pd ** ((1 + snr) / (1 + snr * 10 ** (0.1 * shift_db)))
            tap.equal(abs(seen["model_pd"][end] - exact) < 1e-5, True, f"{seen}: {end} in closed form {exact}")
        done = asdic("detect", "out", "--force", "--cell", "5", cwd=folder.path).check(0)
        tap.contains(done.out, sight_row(seen, "forward") + "\n")


def test_objects_are_told_apart_by_beam_and_range():
    """Two points on the axes of two beams: each stands out most in its own beam, in the middle of the bin it lies in."""
    need_device()
    with Folder() as folder:
        points = "{name: port, point: 0, position_m: [17.5, -10.1, 7]}, " \
                 "{name: starboard, point: 0, position_m: [26.5, 15.3, 7]}"  # at 20.2 and 30.6 m, 30 degrees aside
        made(folder, BUOY.replace("{name: buoy, point: -22, position_m: [40, 0, 7]}", points)
             .replace("[{name: forward}]", "{fan: {count: 2, sector_deg: 120, length_h_m: 0.1, length_v_m: 0.1}}"))
        seen = sorted(report(folder)["objects"], key=lambda s: s["snr_db"])
        loudest = {s["object"]: (s["beam"], s["range_m"]) for s in seen}
        tap.equal(loudest, {"port": ("000", 20.25), "starboard": ("001", 30.75)}, "where they lie")


def test_text_says_what_json_says():
    need_device()
    with Folder() as folder:
        made(folder)
        said = report(folder)
        done = asdic("detect", "out", "--force", cwd=folder.path).check(0)
        lines = done.out.splitlines()
        for row in said["confusion"]:
            rate = row["detected"] / row["bins"] if row["bins"] else 0
            predicted = "" if row["predicted"] is None else f"{row['predicted']:.1f}"
            text = f"{row['truth']:24} {row['bins']:12} {row['detected']:12} {predicted:>12} {rate:10.3g}"
            tap.equal(text in lines, row["bins"] > 0 or row["truth"] == "none", text)
            told = f"  {row['truth']}: "
            tap.equal(told in done.out, row["bins"] > 0 and row["truth"] in ("ghost", "faint", "none"), told)
        rate = said["pfa_measured"]
        tap.contains(done.out, f"P_FA: design 0.01, measured {rate['value']:.4g}, 99 % bounds "
                               f"{rate['low']:.4g}..{rate['high']:.4g}\n")
        tracks = said["tracks"]
        tap.equal(lines[-1], f"tracks: {tracks['begun']} begun, {tracks['confirmed']} confirmed, "
                             f"{tracks['on_objects']} of these on objects; of false alarms alone "
                             f"{tracks['by_chance']:.2g} are to be expected")
        tap.equal(0 < tracks["on_objects"] <= tracks["confirmed"] <= tracks["begun"] <= said["detections"], True, f"{tracks}")
        tap.contains(done.err, f"out: detections.csv ({said['detections']}), tracks.csv, occupancy.png")
        tap.equal(said["detections"], sum(row["detected"] for row in said["confusion"]), "detections")
        # Of nine beams the one in which the ball stands out most.
        tap.equal([s["object"] for s in said["objects"]], ["ball"] * 9, "nine beams hear it")
        best = max(said["objects"], key=lambda s: (s["pd"], s["snr_db"]))
        tap.contains(done.out, "\n" + sight_row(best, best["beam"] + ", best of 9") + "\n")


SHADOWED = """version: 1
environment: {particle_density: low}
bottom: {depth_m: 10, type: sand}
objects:
  - name: box
    box: {size_m: [2, 1.5, 1]}
    position_m: [18, 0, 9.5]
    material: {impedance_mrayl: 8, roughness_rms_mm: 2, slope_rms: 0.3}
sonar:
  frequency_khz: 700
  bandwidth_khz: 20
  max_range_m: 30
  ping_rate_hz: 2
  source_level_db: 200
  bin_length_m: 0.1
  transmitter: {length_h_m: 0.06, length_v_m: 0.005}
  receivers: [{name: head, length_h_m: 0.06, length_v_m: 0.005}]
  speckle: rayleigh
mission: {pose: {position_m: [0, 0, 7], pitch_deg: -5}, pings: 4}
sampling: {rays: 10000}
output: {csv: none, images: []}
"""


def test_an_object_stands_out_from_the_threshold():
    """In its own shadow a weak echo is 50 dB above all else in its bin, and far below the threshold: the bin where the
    object is best detected is another, and of those that were found none is better."""
    need_device()
    with Folder() as folder:
        made(folder, SHADOWED)
        seen, = report(folder)["objects"]
        rows = csv.DictReader(data(folder, "out", "detections.csv").decode().splitlines())
        found = [float(row["pd"]) for row in rows if row["truth"] == "box"]
        tap.equal(len(found) > 3 and seen["pd"] > max(found) - 1e-6, True, f"P_D {seen['pd']}, found with {found}")


def test_shadows_have_fewer_false_alarms():
    """A quiet wall hides the bottom behind it: what is left there is below the threshold for the bottom: of 13152 bins
    477 are detected where 658 were predicted. Design and prediction are told apart."""
    need_device()
    with Folder() as folder:
        made(folder, """version: 1
bottom: {depth_m: 22, type: sand}
objects: [{name: wall, box: {size_m: [2, 80, 22]}, position_m: [31, 0, 11], material: {lambert_db: -55}}]
sonar: {frequency_khz: 100, bandwidth_khz: 5, max_range_m: 60, source_level_db: 205, bin_length_m: 0.6,
        receivers: [{length_h_m: 0.05, length_v_m: 0.05}], speckle: rayleigh}
mission: {pose: {position_m: [0, 0, 9], pitch_deg: -4}, pings: 200}
sampling: {rays: 20000}
detector: {pfa: 0.05}
output: {csv: none, images: []}
""")
        said = report(folder)
        none = said["confusion"][-1]
        tap.equal(abs(said["pfa_design"] / 0.05 - 1) < 1e-9, True, f"design {said['pfa_design']}")
        tap.equal(none["predicted"] < 0.8 * 0.05 * none["bins"], True, f"predicted of {none}")
        tap.equal(abs(none["detected"] - none["predicted"]) < 3.3 * none["predicted"]**0.5, True, f"found of {none}")


def test_means_have_no_false_alarms():
    """Without speckle; of eight beams each is listed."""
    need_device()
    with Folder() as folder:
        made(folder, SCENE.replace("speckle: rayleigh", "speckle: none").replace("count: 9", "count: 8"))
        done = asdic("detect", "out", cwd=folder.path).check(0)
        tap.contains(done.err, "warning: the scene has 'speckle: none'")
        tap.lacks(done.out, "P_FA")
        tap.lacks(done.out, "of false alarms alone")
        said = report(folder)
        tap.equal((said["speckle"], len(said["objects"])), (False, 8), "means of eight beams")
        tap.contains(done.out, "\n".join(sight_row(s, s["beam"]) for s in said["objects"]) + "\n\ntracks: ")


def test_options_replace_one_number_each():
    need_device()
    keys = "target", "pfa", "prior", "snr_db", "cost_ratio"
    own = ["swerling3", 0.01, 0.2, 12, None]
    with Folder() as folder:
        made(folder)
        some = ["--target", "swerling0", "--prior", "0.999", "--snr", "-20"]
        for options, right in (([], own), (some, ["swerling0", 0.01, 0.999, -20, None]),
                               (["--pfa", "0.5"], ["swerling3", 0.5, 0.2, 12, None]),
                               (["--cost", "50"], ["swerling3", 0.01, 0.2, 12, 50])):
            said = report(folder, *options)
            tap.equal([said[k] for k in keys], right, " ".join(options))
        tap.equal((said["cfar"], said["background"]), (False, "flat"))
        for options in ["--cfar", "os"], ["--background", "cfar"]:
            done = asdic("detect", "out", "--json", "-f", *options, "--cfar-cells", "1", cwd=folder.path).check(0)
            tap.lacks(done.err, "background")  # which is as it was asked for
            said = json.loads(done.out)
            tap.equal((said["cfar"], said["background"]), (True, "cfar"), " ".join(options))
        # Where the scene has costs, a P_FA that is typed takes their place.
        made(folder, SCENE.replace("pfa: 1.0e-2", "cost_ratio: 30"))
        tap.equal(report(folder)["cost_ratio"], 30)
        tap.equal(report(folder, "--pfa", "0.1")["cost_ratio"], None)


def test_no_bin_with_neighbours_is_no_decision():
    """It is said, where rates of nothing were; in JSON they are null."""
    need_device()
    with Folder() as folder:
        folder.write("few.yaml", """version: 1
bottom: none
sonar: {frequency_khz: 100, bin_length_m: 0.5, max_range_m: 4, source_level_db: 200, receivers: [{name: ahead}], speckle: rayleigh}
mission: {pose: {position_m: [0, 0, 50]}, pings: 3}
sampling: {rays: 2000}
output: {images: [], csv: none}
""")
        asdic("run", "few.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        for guard, decided in ("20", False), ("0", True):
            done = asdic("detect", "out", "-f", "--cfar", "ca", "--cfar-guard", guard, cwd=folder.path).check(0)
            tap.equal("nan" in done.out, False, done.out)
            tap.equal("P_FA: design 0.001, measured" in done.out, decided, done.out)
            tap.equal("nothing was decided: no bin has neighbours beyond its guard" in done.err, not decided, done.err)
        done = asdic("detect", "out", "-f", "--json", "--cfar", "ca", "--cfar-guard", "20", cwd=folder.path).check(0)
        tap.equal(json.loads(done.out)["pfa_measured"]["value"], None, "of nothing")


def test_options_that_exclude_each_other():
    with Folder() as folder:
        for options, why in ((["--cost", "2", "--pfa", "0.1"], "--cost and --pfa are two thresholds"),
                             (["--cfar", "ca", "--background", "flat"], "leave --background flat out"),
                             (["--cfar-cells", "9"], "--cfar-cells and --cfar-guard go with --cfar"),
                             (["--cfar-guard", "1"], "--cfar-cells and --cfar-guard go with --cfar"),
                             (["-o", "other"], "--output goes with a scene")):
            tap.contains(asdic("detect", folder.path, *options).check(2).err, why)


def test_numbers_have_limits():
    """As the manual has them; there is no scene, which is another error than a wrong option."""
    limits = {"pfa": (1e-12, 0.5), "prior": (1e-9, 0.999), "snr": (-20, 60), "truth": (-20, 60), "cell": (0.001, 1000),
              "cfar-cells": (1, 256), "cfar-guard": (0, 256), "cost": (1e-6, 1e12), "speed": (0.001, 100)}
    beyond = {"pfa": (0.9e-12, 0.51), "prior": (0.9e-9, 0.9991), "snr": (-20.1, 60.1), "truth": (-20.1, 60.1),
              "cell": (0.0009, 1001), "cfar-cells": (0, 257), "cfar-guard": (-1, 257), "cost": (0.9e-6, 1.1e12),
              "speed": (0.0009, 101)}

    def detect(numbers, end):
        return asdic("detect", "/nonexistent.yaml", "--cfar", "ca", *(f"--{k}={v[end]}" for k, v in numbers.items()))

    for end in 0, 1:
        detect({k: v for k, v in limits.items() if k != "cost"}, end).check(3)
        detect({k: v for k, v in limits.items() if k != "pfa"}, end).check(3)
        told = detect(beyond, end).check(2).err
        for option in limits:
            tap.contains(told, f"option '--{option}': ")


def test_a_scene_is_run_first():
    need_device()
    with Folder() as folder:
        folder.write("scene.yaml", SCENE)
        asdic("detect", "scene.yaml", "-q", cwd=folder.path).check(0, err="")
        tap.equal("detections.csv" in os.listdir(folder / "run_scene"), True, "its folder")
        asdic("detect", "scene.yaml", "-q", cwd=folder.path).check(1)


tap.main(globals())
