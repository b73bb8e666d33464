"""Coherent runs: element data as NumPy reads it, the same bytes in parts, on threads and resumed, beams
formed outside, and errors."""
import cmath
import csv
import json
import math
import os
import pathlib
import struct
import sys

import program
import tap
from program import Folder, asdic, need_device
from run_folder import data, facts

SCENE = """version: 1
environment: {sound_speed_mps: 1500, particle_density: low}
bottom: {depth_m: 12, type: sand}
objects:
  - {name: p, point: {target_strength_db: 10}, position_m: [12, 3, 7]}
  - name: block
    box: {size_m: [1, 1, 1]}
    position_m: [15, -4, 11.5]
    material: {impedance_mrayl: 8, roughness_rms_mm: 3}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  bin_length_m: 0.15
  max_range_m: 20
  source_level_db: 200
  transmitter: {length_h_m: 0.01, length_v_m: 0.05}
  array: {elements: 13, shading: hann, element: {length_v_m: 0.05}, beams: {count: 9, sector_deg: 60}}
mission: {pose: {position_m: [0, 0, 7]}, pings: 4}
sampling: {coherent: true, rays: 4000}
output: {csv: long, elements: true, images: [], records: full}
"""
FILES = ("bins.csv", "pings.npy", "elements.npy")


def pressures(folder, run):
    """By ping, element and sample; the header is NumPy's."""
    raw = data(folder, run, "elements.npy")
    tap.equal(raw[:8], b"\x93NUMPY\x01\x00")
    length = 10 + struct.unpack("<H", raw[8:10])[0]
    header = eval(raw[10:length].decode(), {"__builtins__": {}})  # pylint: disable=eval-used
    tap.equal(header["descr"], "<c8")
    tap.equal(header["fortran_order"], False)
    pings, elements, samples = header["shape"]
    numbers = memoryview(raw)[length:].cast("f")
    tap.equal(len(numbers), 2 * pings * elements * samples, "numbers")

    def at(ping, element, sample):
        place = 2 * ((ping * elements + element) * samples + sample)
        return complex(numbers[place], numbers[place + 1])
    return header["shape"], at


def same_files(folder, one, other):
    for name in FILES:
        tap.equal(data(folder, one, name) == data(folder, other, name), True,
                  f"{name} of {one} and {other}")


def test_same_bytes_in_parts_and_on_threads():
    program.need_device()
    with Folder() as folder:
        path = folder.write("array.yaml", SCENE)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        asdic("run", path, "-o", folder / "one", POCL_MAX_PTHREAD_COUNT="1").check(code=0)
        same_files(folder, "whole", "one")
        asdic("run", path, "-o", folder / "two", "--device", "all",
              POCL_DEVICES="pthread pthread").check(code=0)
        same_files(folder, "whole", "two")
        for k in (1, 2):
            asdic("run", path, "--shard", f"{k}/2", "-o", folder / f"part{k}").check(code=0)
        asdic("merge", folder / "part1", folder / "part2", "-o", folder / "joined").check(code=0)
        same_files(folder, "whole", "joined")
        tap.equal(facts(folder, "joined")["elements"], facts(folder, "whole")["elements"])


def test_later_parts_of_a_dive_are_joined():
    """Their samples are those of the sound speed where the mission begins, not of that where they do."""
    program.need_device()
    with Folder() as folder:
        folder.write("dive.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,2,0,0,0\n1,1,0,4000,0,0,0\n")
        path = folder.write("dive.yaml", """version: 1
bottom: {depth_m: 5000}
sonar:
  {frequency_khz: 100, bandwidth_khz: 10, bin_length_m: 0.339, max_range_m: 20, source_level_db: 200, ping_rate_hz: 2,
   array: {elements: 4, beams: {count: 4, sector_deg: 90}}}
mission: {track: dive.csv, pings: 3}
sampling: {coherent: true, rays: 1000}
output: {elements: true, images: []}
""")
        for k in (1, 2, 3):
            asdic("run", path, "--pings", f"{k - 1}:{k}", "-o", folder / f"part{k}").check(code=0)
        asdic("merge", folder / "part2", folder / "part3", "-o", folder / "joined").check(code=0)
        tap.equal(pressures(folder, "joined")[0], (2, 4, pressures(folder, "part1")[0][2]), "shape")
        tap.equal(facts(folder, "joined")["elements"], facts(folder, "part1")["elements"])


def test_resume_makes_what_is_missing():
    program.need_device()
    with Folder() as folder:
        path = folder.write("array.yaml", SCENE)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        asdic("run", path, "-o", folder / "again").check(code=0)
        os.remove(os.path.join(folder.path, "again", "elements.npy"))
        done = asdic("run", path, "-o", folder / "again", "--resume").check(code=0)
        tap.contains(done.err, "elements.npy' is missing or damaged; made again")
        same_files(folder, "whole", "again")
        raw = data(folder, "again", "elements.npy")
        pathlib.Path(folder / "again", "elements.npy").write_bytes(raw[:-9999] + b"XXXX" + raw[-9995:])
        asdic("merge", folder / "whole", "-o", folder / "kept").check(code=0)
        for where in (folder / "joined",), (folder / "kept", "--force"):
            tap.contains(asdic("merge", folder / "again", "-o", *where).check(code=3).err,
                         "again/elements.npy' is missing or damaged")
        same_files(folder, "whole", "kept")  # a part that is damaged costs no earlier result
        asdic("run", path, "-o", folder / "again", "--resume").check(code=0)
        same_files(folder, "whole", "again")


def test_beams_can_be_formed_outside():
    """Delay-free sums of the element data, by the lengths in run.json, towards the point peak where it is, as loud as it
    is and with the phase of the way."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("array.yaml", SCENE.replace("bandwidth_khz: 10", "bandwidth_khz: 5"))
        asdic("run", path, "-o", folder / "run").check(code=0)
        shape, at = pressures(folder, "run")
        tap.equal(shape[:2], (4, 13))
        distance, length = math.hypot(12, 3), facts(folder, "run")["elements"]
        tap.equal([round(length[name], 9) for name in ("spacing_m", "sample_m", "wavelength_m")],
                  [0.0075, round(133 * 0.15 / shape[2], 9), 0.015], "lengths")
        sample = int(distance / length["sample_m"])

        def beam(bearing_deg):
            turn = 2j * math.pi * length["spacing_m"] / length["wavelength_m"] * math.sin(math.radians(bearing_deg))
            return sum(at(0, e, sample) * cmath.exp(-turn * (e - 6)) for e in range(13)) / 13

        def level(bearing_deg):
            return 20 * math.log10(abs(beam(bearing_deg)))
        best = max(range(-45, 46), key=level)
        tap.equal(abs(best - math.degrees(math.atan2(3, 12))) < 1, True, f"{best} degrees")
        turns = cmath.phase(beam(best)) / (2 * math.pi) + 2 * distance / length["wavelength_m"]
        tap.equal(abs(turns - round(turns)) < 0.05, True, f"{turns} turns")
        side_wl, y = 0.01 / 0.015, 3 / distance
        sinc = lambda x: math.sin(math.pi * x) / (math.pi * x)
        expected = (200 + 10 - 40 * math.log10(distance) - 2 * (distance - 1) * 0.0335 +
                    20 * math.log10(sinc(side_wl * y) * sinc(0.5 * y)))
        tap.equal(abs(level(best) - expected) < 0.5, True,
                  f"{level(best):.2f} dB, expected {expected:.2f} dB")


def test_plan_says_when_phase_matters():
    program.need_device()
    plain = SCENE.replace("shading: hann", "shading: none")
    smooth = SCENE.replace("roughness_rms_mm: 3", "roughness_rms_mm: 0, slope_rms: 0")
    shallow = plain.replace("[12, 3, 7]", "[18, 3, 0.2]").replace("[0, 0, 7]", "[0, 0, 1]")
    shallow = shallow.replace("sound_speed_mps: 1500,", "sound_speed_mps: 1500, wind_speed_kn: 1,")
    with Folder() as folder:
        for text, told in ((SCENE, "needed, and simulated; the side lobes of a shaded array"),
                           (smooth, "needed, and simulated; 'block' is smooth"),
                           (plain, "not needed, and simulated; nothing here"),
                           (shallow, "needed, and simulated; 'p' and its image")):
            done = asdic("plan", folder.write("plan.yaml", text), "--no-forecast").check(code=0)
            tap.contains(done.out, f"phase: {told}")


def test_errors_are_one_each():
    program.need_device()
    with Folder() as folder:
        path = folder.write("array.yaml", SCENE)
        done = asdic("run", path, "-o", "-").check(code=1)
        tap.contains(done.err, "'output: {elements: true}' needs a run folder: give one with -o")
        with open("/proc/meminfo", encoding="ascii") as file:
            left = next(int(line.split()[1]) for line in file if line.startswith("MemAvailable"))
        if left < 40e6: # kB
            huge = folder.write("huge.yaml", SCENE.replace("rays: 4000", "rays: 268435456"))
            done = asdic("run", huge, "-o", folder / "huge").check(code=1)
            tap.contains(done.err, "a ping of 268435456 scatterers or more needs")
            tap.contains(done.err, "use fewer rays")


def test_arrays_are_as_long_as_a_run_takes():
    """Whatever check says: elements of 120 m, beams of 1.3 km though elements are short, beams of 20 micrometres."""
    with Folder() as folder:
        for khz, array, said in ((0.1, "elements: 8, spacing_wl: 8", 120),
                                 (0.1, "elements: 100, spacing_wl: 1, element: {length_h_m: 5}", 1340),
                                 (3000, "elements: 2, spacing_wl: 0.02", 1.787e-05)):
            path = folder.write("array.yaml", SCENE.replace("frequency_khz: 100", f"frequency_khz: {khz}").replace(
                "bandwidth_khz: 10", "bandwidth_khz: 0.1").replace(
                "elements: 13, shading: hann, element: {length_v_m: 0.05}", array))
            for command in (["check"], ["run", "-o", folder / "r"]):
                tap.contains(asdic(*command, path).check(code=3).err, f"makes an aperture of {said:.4g} m, which is out "
                             "of range [0.0001, 100] m; change it, 'elements' or 'frequency_khz'  [sonar.array.spacing_wl]\n")


def test_detections_are_held_against_the_scene_by_intensities():
    """Coherent pings state no parts; those of the same scene by intensities say what is in a bin."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("array.yaml", SCENE)
        done = asdic("run", path, "-o", folder / "out").check(code=0)
        tap.lacks(done.err, "stated error")
        done = asdic("detect", folder / "out", "--json").check(code=0)
        tap.lacks(done.err, "speckle: none")
        tap.contains(done.err, "the same scene by intensities, kept as parts.npy")
        report = json.loads(done.out)
        tap.equal(report["speckle"], True)
        tap.equal(report["tracks"]["by_chance"], None, "false alarms come again where the speckle stays")
        rows = {row["truth"]: row for row in report["confusion"]}
        for name in ("p", "block"):
            found, should = rows[name]["detected"], rows[name]["predicted"]
            tap.equal(0 < should / 2 < found < 2 * should, True, f"{rows[name]}: as many as predicted")
        tap.equal(rows["none"]["detected"] < 0.03 * rows["none"]["bins"], True, f"{rows['none']} is quiet")
        kept = data(folder, "out", "parts.npy")
        asdic("detect", folder / "out", "--force").check(code=0)
        tap.equal(data(folder, "out", "parts.npy") == kept, True, "kept")
        (pathlib.Path(folder.path) / "array.yaml").unlink()
        done = asdic("detect", folder / "out", "--force").check(code=3)
        tap.contains(done.err, "coherent pings do not say what is in a bin")


THIN = """version: 1
environment: {sound_speed_mps: 1500, particle_density: -200}
surface: {enabled: false}
bottom: {depth_m: 15, type: sand}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  bin_length_m: 0.075
  max_range_m: 40
  source_level_db: 200
  transmitter: {length_h_m: 0.0005, length_v_m: 0.05}
  array: {elements: 48, element: {length_h_m: 0.0005, length_v_m: 0.05}, beams: {count: 7, sector_deg: 154}}
mission: {pose: {position_m: [0, 0, 5]}}
sampling: {rays: 20000}
output: {csv: long, images: []}
"""


AT_REST = """version: 1
bottom: {depth_m: 12, type: sand}
sonar: {frequency_khz: 100, max_range_m: 40, bandwidth_khz: 10, source_level_db: 200,
  array: {elements: 8, beams: {count: 8, sector_deg: 60}}}
mission: {pose: {position_m: [0, 0, 7]}, pings: 20}
sampling: {rays: 5000, coherent: true}
detector: {pfa: 1.0e-2}
output: {images: [], csv: none}
"""


def test_speckle_that_stays_counts_once():
    """A vehicle at rest hears the same false alarms in every ping. Bounds that took twenty pings for twenty trials left the
    mean over six seeds out. And nothing is decided where a pulse's edge is what is heard: in the blanked bin, and before
    the bottom's first echo at 5 m, in bins of 0.5 m; these were found in nine pings of ten."""
    need_device()
    with Folder() as folder:
        folder.write("rest.yaml", AT_REST)
        found = []
        for seed in range(11, 17):
            asdic("run", "rest.yaml", "-o", "out", "-f", "-q", "--seed", str(seed), cwd=folder.path).check(code=0)
            done = asdic("detect", "out", "--json", "-q", cwd=folder.path).check(code=0)
            found.append(json.loads(done.out)["pfa_measured"])
            with open(folder / "out/detections.csv", newline="", encoding="ascii") as file:
                bins = {int(row["bin"]) for row in csv.DictReader(file)}
            tap.equal((bins & {0, 9}, bins != set()), (set(), True), "bins with a pulse's edge")
        mean = sum(each["value"] for each in found) / len(found)
        tap.equal([each for each in found if not each["low"] < mean < each["high"]], [], f"bounds that miss {mean}")


def test_a_trial_decides_nothing_beside_loud_bins():
    """What is told to a rule, as in detections of a run: no bin that holds a pulse's edge, which nine pings of ten had."""
    need_device()
    flown = AT_REST.replace("mission: {pose: {position_m: [0, 0, 7]}, pings: 20}",
                            "mission: {waypoints: {points_m: [[0, 0, 7], [60, 0, 7]], speed_mps: 1.5}}")
    flown = flown.replace("sonar: {", "sonar: {ping_rate_hz: 2, ") + "trial: {time_s: 10}\n"
    with Folder() as folder:
        folder.write("flown.yaml", flown)
        rule = f"exec {sys.executable} -u -c 'for line in open(0): print(\"{{}}\"); print(line, file=open(\"heard\", \"a\"), end=\"\")'"
        asdic("trial", "flown.yaml", "--runs", 1, "--rule", rule, "-o", "out", "-q", cwd=folder.path).check(code=0)
        pings = [json.loads(line) for line in folder.read("heard").splitlines()]
        bins = {int(d["range_m"] / 0.5) for ping in pings for d in ping["detections"]}
        tap.equal((len(pings), bins & {0, 9}, bins != set()), (20, set(), True), "bins with a pulse's edge")


def test_intensities_of_thin_elements_are_those_of_the_array():
    """Beams at 0, 22, 44 and 66 degrees: of intensities they were 10 dB quieter than the noise, 5 dB than the bottom."""
    need_device()
    level_db = {}
    with Folder() as folder:
        for coherent in "true", "false":
            folder.write("thin.yaml", THIN.replace("rays: 20000", f"rays: 20000, coherent: {coherent}"))
            asdic("run", "thin.yaml", "-o", coherent, "-q", cwd=folder.path).check(0)
            for row in csv.DictReader(data(folder, coherent, "bins.csv").decode().splitlines()):
                power = 10 ** (0.1 * float(row["level_db"]))
                part = "noise" if int(row["bin"]) < 120 else "bottom"
                of = level_db.setdefault((row["beam"], part), {}).setdefault(coherent, [])
                of += [power] if not 120 <= int(row["bin"]) < 200 else []
    for (beam, part), powers in level_db.items():
        apart_db = 10 * math.log10(sum(powers["true"]) / sum(powers["false"]))
        tap.equal(abs(apart_db) < 2, True, f"beam {beam}: {part} of coherent pings {apart_db:.1f} dB above")


def test_check_foretells_scatterers():
    """Without a device check finds as many as a ping then has: over sand, by mirrors, and of a smooth wall of 2,000 by 2,000
    wavelengths, whose edges do for its area: cut to a quarter of a wavelength it had 57 million."""
    need_device()
    wall = """version: 1
environment: {sound_speed_mps: 1500}
bottom: none
objects:
  - {name: wall, plate: {size_m: [10, 10]}, position_m: [15, 0, 20], rotation_deg: [0, 0, 30],
     material: {preset: steel, roughness_rms_mm: 0, slope_rms: 0}}
sonar:
  frequency_khz: 300
  bandwidth_khz: 30
  bin_length_m: 0.025
  max_range_m: 30
  transmitter: {length_h_m: 0.0025, length_v_m: 0.01}
  array: {elements: 64, spacing_wl: 0.5, element: {length_v_m: 0.01}, beams: {count: 4, sector_deg: 90}}
mission: {pose: {position_m: [0, 0, 20]}}
sampling: {coherent: true, rays: 2000}
"""
    scenes = {"sand": SCENE, "mirrors": SCENE.replace("coherent: true", "coherent: true, multipath: boundaries"),
              "wall": wall}
    with Folder() as folder:
        for name, scene in scenes.items():
            folder.write(f"{name}.yaml", scene)
            asdic("run", "-q", f"{name}.yaml", "-o", name, cwd=folder.path).check(0)
            checked = json.loads(asdic("check", "--json", f"{name}.yaml", cwd=folder.path).check(0).out)
            checked = checked[0] if isinstance(checked, list) else checked
            found = checked["coherent"]
            traced = facts(folder, name)["rays_traced"] / checked["pings"]
            tap.equal(abs(found["scatterers"] / traced - 1) < 0.02, True, (name, found, traced))
            tap.equal((found["fits"], found["bytes"] > 60 * found["scatterers"]), (True, True), found)
            tap.equal(0.1e-6 < found["processor_s"] / found["scatterers"] < 10e-6, True, found)
            if name == "wall":
                tap.equal(found["scatterers"] < 30000, True, found)
            text = asdic("check", f"{name}.yaml", cwd=folder.path).check(0).out
            tap.contains(text, f"  scatterers  {found['scatterers']} a ping")
        void = wall[:wall.index("bottom:")] + "bottom: none\nsurface: {enabled: false}\n" + wall[wall.index("sonar:"):]
        folder.write("void.yaml", void.replace("1500}", "1500, particle_density: -200}"))
        found = json.loads(asdic("check", "--json", "void.yaml", cwd=folder.path).check(0).out)[0]["coherent"]
        tap.equal((found["scatterers"], found["bytes"], found["fits"]), (0, 0, True), "of nothing")


def test_a_smooth_plate_is_silent_off_its_mirror_direction():
    """An upright plate at the sonar's depth answers straight back; by way of the surface it throws its echo past the
    sonar, however large its pieces are."""
    need_device()
    with Folder() as folder:
        folder.write("plate.yaml", """version: 1
environment: {wind_speed_kn: 0}
bottom: none
objects:
  - name: plate
    plate: {size_m: [2, 2]}
    position_m: [20, 0, 5]
    material: {preset: steel, roughness_rms_mm: 0, slope_rms: 0}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  bin_length_m: 0.25
  max_range_m: 26
  source_level_db: 200
  transmitter: {length_h_m: 0.004, length_v_m: 0.004}
  array:
    elements: 4
    spacing_wl: 0.5
    element: {length_v_m: 0.004}
    beams: {count: 1, sector_deg: 10}
mission: {pose: {position_m: [0, 0, 5]}}
sampling: {coherent: true, rays: 1000, multipath: boundaries}
output: {images: []}
""")
        asdic("run", "plate.yaml", "-o", "out", "-q", cwd=folder.path).check(0)
        with open(folder / "out/bins.csv", newline="", encoding="utf-8") as file:
            level_db = {float(r["range_m"]): float(r["level_db"]) for r in csv.DictReader(file)}
        for range_m, legs in (21.125, "one leg"), (22.375, "both legs"):
            below_db = level_db[20.125] - level_db[range_m]
            tap.equal(below_db > 30, True, f"{legs} by way of the surface: {below_db} dB below the straight echo")


tap.main(globals())
