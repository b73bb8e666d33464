"""asdic plan: the same in words and in JSON, and a forecast that holds."""
import csv
import json
import math
import os
import pathlib
import re
import time

import tap
from program import Folder, asdic, need_device

SCENES = pathlib.Path(__file__).resolve().parents[2] / "data" / "scenes"
# The second scenario in noise that its echoes sink into; three blocks of pings, the last begun.
NOISY = (SCENES / "scenario2.yaml").read_text(encoding="utf-8").replace(
    "noise: {enabled: false}", "noise: {enabled: true}").replace("source_level_db: 0", "source_level_db: 170").replace(
        "rays: 20000", "rays: 2000").replace("pings: 1", "pings: 65")
# Speeds at the surface and below.
LAYERS = """version: 1
environment: {max_depth_m: 12, sound_speed_profile: [[0, 1482], %s]}
bottom: {depth_m: 12, type: sand}
sonar: {frequency_khz: 100, max_range_m: 10, receivers: [{name: forward}], noise: {enabled: false}}
mission: {pose: {position_m: [0, 0, 7]}}
"""
TRACK = "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,7,0,0,0\n9,30,0,11,0,0,0\n"
NO_DEVICE = {"OCL_ICD_VENDORS": "/nonexistent"}


def words(scene, *args):
    return asdic("plan", scene, "--no-forecast", *args, **NO_DEVICE).check(code=0).out


def told(scene, *args):
    return json.loads(asdic("plan", scene, "--no-forecast", "--json", *args, **NO_DEVICE).check(code=0, err="").out)


def test_words_say_what_json_says():
    with Folder() as folder:
        plan, bounds = told(folder.write("noisy.yaml", NOISY)), set()
        text = words(folder / "noisy.yaml")
        for term, line in zip(plan["terms"], text.splitlines()[1:]):
            bound = {None: "-", 0: "exact"}.get(term["bound_db"]) or f"{term['bound_db']:.2g} dB"
            tap.equal(re.split("  +", line),
                      [term["name"], "kept" if term["kept"] else "left out", bound, term["reason"]])
            bounds.add(bound)
        # Boric acid: 0.116 dB/km over 74.5 m, there and back.
        tap.equal({"-", "exact", "0.017 dB"} <= bounds, True, f"{bounds}")
        tap.contains(text, "\n65 pings of 2000 rays; 12 triangles, 0.0 MB of hierarchy\n")
        tap.equal([plan[key] for key in ("pings", "rays", "triangles")], [65, 2000, 12])
        for word in "measured", "stated", "scan:", "rays:":
            tap.lacks(text, f"\n{word}")
        tap.equal("forecast" in plan, False, "a forecast")
        mission = SCENES / "mission.yaml"
        tap.contains(words(mission), f" {1e-6 * told(mission)['bvh_bytes']:.1f} MB of hierarchy\n")


def test_phase_is_told():
    array = (SCENES / "array.yaml").read_text(encoding="utf-8")
    with Folder() as folder:
        for text, said, needed, coherent in ((array, "needed, and simulated", True, True),
                                             (array.replace("coherent: true, ", ""),
                                              "needed, yet pings add intensities", True, False),
                                             (NOISY, "not needed", False, False)):
            phase = told(folder.write("scene.yaml", text))["phase"]
            tap.equal((phase["needed"], phase["coherent"]), (needed, coherent))
            tap.contains(words(folder / "scene.yaml"), f"\nphase: {said}; {phase['reason']}\n")


def test_what_rays_follow_is_told():
    with Folder() as folder:
        for profile, args, said in (("[9, 1482], [12, 1431]", (), "all layers; "), ("[12, 1470]", (), "one layer; "),
                                    ("[12, 1482.000001]", (), "straight; "),
                                    ("[12, 1470]", ("--refraction", "full"), "all layers, as asked for; "),
                                    ("[12, 1470]", ("--refraction", "layer"), "one layer, as asked for; "),
                                    ("[12, 1470]", ("--refraction", "off"), "straight, as asked for; ")):
            path = folder.write("scene.yaml", LAYERS % profile)
            reason = told(path, *args)["refraction"]["reason"]
            tap.contains(words(path, *args), f"\nrays: {said}{reason}\n")


def test_the_picture_is_of_the_first_ping():
    with Folder() as folder:
        folder.write("track.csv", TRACK)
        drawn = set()
        for mission in "pose: {position_m: [0, 0, 7]}", "pings: 2, track: track.csv":
            path = folder.write("scene.yaml", LAYERS.replace("pose: {position_m: [0, 0, 7]}", mission) % "[12, 1470]")
            done = asdic("plan", path, "--no-forecast", "--picture", folder / "rays.svg", "-f", **NO_DEVICE)
            if "without cairo" in done.err:
                raise tap.Skip("built without cairo")
            done.check(code=0)
            drawn.add(folder.read("rays.svg"))
        tap.equal(len(drawn), 1, "pictures")
        done = asdic("plan", path, "--no-forecast", "--picture", folder / "rays.svg", **NO_DEVICE).check(code=1)
        tap.contains(done.err, "rays.svg' exists; --force overwrites it")


def test_the_forecast_adds_up():
    need_device()
    with Folder() as folder:
        start = time.monotonic()
        text = asdic("plan", folder.write("noisy.yaml", NOISY), "--json").check(code=0).out
        elapsed_ms = 1e3 * (time.monotonic() - start)
        found = json.loads(text)["forecast"]
        plan, first, learn, ping, write = (found[key + "_ms"] for key in ("plan", "first_ping", "learn", "ping", "write"))
        tap.equal(min(plan, first, learn, ping, write) > 0, True, f"{found}")
        tap.equal(plan + first + learn + 5 * ping + write < elapsed_ms, True, f"{found} in {elapsed_ms} ms")
        tap.equal(round(found["mission_s"], 9), round(1e-3 * (plan + first + 3 * learn + 65 * (ping + write)), 9))


def test_the_error_is_that_of_the_first_ping():
    """Of a vehicle that moves, and what a run of that ping says; a bin that nothing comes from states none."""
    need_device()
    with Folder() as folder:
        folder.write("track.csv", TRACK)
        for scene in NOISY, NOISY.replace("noise: {enabled: true}", "noise: {enabled: false}"):
            path = folder.write("scene.yaml", scene.replace("pose: {position_m: [0, 0, 7]}", "track: track.csv") +
                                "\noutput: {records: full, images: []}\n")
            asdic("run", path, "--pings", "0:1", "-q", "--force", "-o", folder / "run").check(code=0)
            with open(os.path.join(folder / "run", "bins.csv"), newline="", encoding="utf-8") as file:
                bins = list(csv.DictReader(file))

            def is_heard(row):
                return any(row[part + "_db"] and float(row[part + "_db"]) >= float(row["noise_db"] or "-inf")
                           for part in ("bottom", "surface", "volume", "object", "multipath"))

            errors = sorted(float(row["stderr_db"]) for row in bins if row["stderr_db"])
            heard = [float(row["stderr_db"]) for row in bins if is_heard(row)]
            tap.equal(0 < len(heard) < len(bins), True, "some are heard")
            wanted = {"rms": math.hypot(*heard) / math.sqrt(len(heard)), "worst": errors[-1]}
            found = json.loads(asdic("plan", path, "--json").check(code=0).out)["forecast"]
            for name, value in wanted.items():
                tap.equal(abs(found[f"stderr_{name}_db"] / value - 1) < 1e-6, True, f"{name}: {found}, not {value}")
            tap.equal(abs(found["stderr_median_db"] / errors[(len(errors) - 1) // 2] - 1) < 0.004, True, f"{found}")
            said = json.loads(folder.read("run/run.json"))["stderr_db"]
            tap.equal({name: float(f"{found[f'stderr_{name}_db']:.4g}") for name in said}, said)
        text = asdic("plan", path).check(code=0).out
        tap.contains(text, f"first ping: {wanted['rms']:.2f} dB r.m.s. in bins above the noise; of all, median "
                           f"{said['median']:.3f} dB, worst {wanted['worst']:.2f} dB\n")
        path = folder.write("quiet.yaml", NOISY.replace("source_level_db: 170", "source_level_db: 20"))
        tap.contains(asdic("plan", path).check(code=0).out, "first ping: no bin is above the noise; of all, median ")
        # it sinks from 7 m to 11, and goes 30 m past an object
        tap.contains(text, " ms to learn, 6 times: about ")


def test_a_blank_or_coherent_ping_has_the_error_of_its_run():
    """More than half of the bins are blanked; coherent pings."""
    need_device()
    blank = LAYERS.replace(", sound_speed_profile: [[0, 1482], %s]", "").replace(
        "noise: {enabled: false}", "blanking_m: 6, noise: {enabled: false}")
    array = blank.replace("receivers: [{name: forward}]", "array: {elements: 8, beams: {count: 3, sector_deg: 30}}")
    with Folder() as folder:
        for text in (blank + "sampling: {rays: 500}\n", array + "sampling: {rays: 500, coherent: true}\n"):
            path = folder.write("scene.yaml", text + "output: {records: full, images: []}\n")
            asdic("run", path, "-q", "--force", "-o", folder / "run").check(code=0)
            found = json.loads(asdic("plan", path, "--json").check(code=0).out)["forecast"]
            said = json.loads(folder.read("run/run.json"))["stderr_db"]
            tap.equal(set(said.values()) == {None}, "coherent" in text, f"none is stated: {said}")
            for name, value in said.items():
                error = found[f"stderr_{name}_db"]
                tap.equal(error if error is None else float(f"{error:.4g}"), value, f"{name} of {text}")


OMNI = """version: 1
environment: {max_depth_m: 500, wind_speed_kn: WIND, particle_density: -60}
bottom: {depth_m: 500}
sonar:
  frequency_khz: 100
  max_range_m: 60
  source_level_db: 190
  bin_length_m: BIN
  blanking_m: BLANKING
  transmitter: {length_h_m: 0.001, length_v_m: 0.001}
  receivers: [{name: a, pitch_deg: -60, length_h_m: 0.001, length_v_m: 0.001}]
mission: {pose: {position_m: [0, 0, DEPTH]}}
"""


def test_bounds_are_what_they_say():
    """Of the surface a whole ring in the first bin at full gain, in closed form; of the water no less than a sonar with the
    least of apertures hears by quadrature, and not much more."""
    with Folder() as folder:
        for depth, bin_m, blanking, wind in (7, 0.5, 0.3, 10), (2, 0.25, 0.3, 20), (1, 2, 5, 20), (9, 1, 1, 30), (3.3, 0.5, 4, 5):
            text = OMNI
            for key, value in (("DEPTH", depth), ("BIN", bin_m), ("BLANKING", blanking), ("WIND", wind)):
                text = text.replace(key, str(value))
            path = folder.write("omni.yaml", text)
            done = asdic("plan", path, "--no-forecast", "--json", "-q", **NO_DEVICE).check(code=0)
            terms = {term["name"]: term for term in json.loads(done.out)["terms"]}
            alpha = float(re.search(r"(\S+) dB/km at 100 kHz", asdic("check", path).check(code=0).out)[1])
            exact = list(csv.DictReader(asdic("expect", path, "-o", "-").check(code=0).out.splitlines()))
            noise_db = float(exact[-1]["noise_db"])

            def above_noise(name):
                return 10 * math.log10(10 ** (0.1 * terms[name]["bound_db"]) - 1)

            near = bin_m * math.floor(max(depth, blanking) / bin_m)
            grazing = math.degrees(math.asin(min(1, depth / near)))
            scatter = asdic("model", "surface-backscatter", f"wind_kn={wind}", "f_khz=100",
                            f"grazing_deg={grazing}").check(code=0)
            ring = (190 + float(scatter.out.split()[0]) + 10 * math.log10(2 * math.pi * (near + bin_m / 2) * bin_m)
                    - 40 * math.log10(near) - 2e-3 * alpha * near - noise_db)
            tap.equal(abs(above_noise("surface") - ring) < 0.1, True, f"{above_noise('surface')} dB, in closed form {ring}")
            loudest = max(float(row["volume_db"]) for row in exact if row["volume_db"]) - noise_db
            tap.equal(0 < above_noise("volume") - loudest < 7, True, f"{above_noise('volume')} dB, by quadrature {loudest}")


tap.main(globals())
