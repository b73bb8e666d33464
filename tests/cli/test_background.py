"""What 'asdic detect' takes for the level without objects: simulated, flat, from neighbours, and what its error does to
false alarms."""
import json
import math
import pathlib
import re
import struct
import subprocess
import time

import program
import tap
from detections import COARSE, DATA, EMPTY
from program import Folder, asdic, need_device
from run_folder import npy
from scenes import MIRRORED


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
        words = "warning: no background can be simulated, the scene file is not there as it was: it is from neighbouring bins"
        tap.contains(said, words)
        tap.contains(detect("-q")[1], words)
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


def test_mirrors_have_no_texture():
    """What came by way of them is drawn without that of K speckle, and so the threshold over it is lower: where ghosts
    stand out, which are background here, false alarms were a fifth of what was asked."""
    need_device()
    with Folder() as folder:
        folder.write("mirrored.yaml", MIRRORED.replace("7]}", "7]}, pings: 400"))
        done = asdic("detect", "mirrored.yaml", "-o", "out", "--json", *COARSE, cwd=folder.path).check(0)
        ghosts, = [each for each in json.loads(done.out)["confusion"] if each["truth"] == "ghost"]
        rate, spread = ghosts["detected"] / ghosts["bins"], math.sqrt(0.01 / ghosts["bins"])
        tap.equal((ghosts["bins"] > 10000, abs(rate - 0.01) < 3 * spread), (True, True), f"{ghosts}")


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


tap.main(globals())
