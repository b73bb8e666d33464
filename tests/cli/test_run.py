"""asdic run and render: what a run folder holds, and what is refused."""
import csv
import json
import math
import os
import re
import shutil
import struct
import subprocess
import time

import program
import tap
from program import Folder, asdic
from run_folder import HEADER, data, facts, npy, pictures, png_texts, scene


def test_run_folder_holds_what_it_should():
    program.need_device()
    with Folder() as folder:
        asdic("run", scene(folder), cwd=folder.path).check(code=0, out="")
        rows = data(folder, "run_pool", "bins.csv").decode().splitlines()
        tap.equal(rows[0], HEADER, "columns")
        table = list(csv.DictReader(rows))
        run = facts(folder, "run_pool")
        bins, beams, pings = run["bins"], run["beams"], run["pings"]
        tap.equal((pings, beams, run["state"]), (6, 2, "complete"))
        tap.equal(len(table), pings * beams * bins, "rows")
        tap.equal([(r["ping"], r["beam"], r["bin"]) for r in table],
                  [(str(p), b, str(n)) for p in range(pings) for b in ("forward", "down")
                   for n in range(bins)], "keys")
        tap.equal({r["range_m"] for r in table[:3]}, {"0.5", "1.5", "2.5"}, "bin centres")
        tap.equal(sorted({r["time_s"] for r in table}), ["0", "0.05", "0.1", "0.15", "0.2", "0.25"])
        tap.equal({r["object_db"] != "" for r in table if r["bin"] == "19"}, {True}, "echo of ball")
        tap.equal({r["object_db"] for r in table if r["bin"] == "10"}, {""}, "before the ball")
        tap.equal((run["seed"], run["rays"]), (7, 2000), "sampling")
        tap.equal(run["scene"]["text"], folder.read("pool.yaml"), "scene's text")
        tap.equal(len(run["scene"]["sha256"]), 64)
        for key in ("version", "devices", "time_s", "rays_per_s", "rays_traced"):
            if not run[key]:
                raise AssertionError(f"run.json says nothing of {key}")
        if not 0 < run["stderr_db"]["median"] <= run["stderr_db"]["worst"]:
            raise AssertionError(run["stderr_db"])


def test_error_is_said():
    """The r.m.s. stated error of the bins that a mechanism fills above the noise."""
    program.need_device()
    with Folder() as folder:
        done = asdic("run", scene(folder, rays=200), "-o", folder / "r").check(code=0)
        rows = csv.DictReader(data(folder, "r", "bins.csv").decode().splitlines())
        errors = [float(row["stderr_db"]) for row in rows
                  if any(row[f"{echo}_db"] and float(row[f"{echo}_db"]) >= float(row["noise_db"])
                         for echo in ("bottom", "surface", "volume", "object", "multipath"))]
        rms = (sum(error**2 for error in errors) / len(errors)) ** 0.5
        said = facts(folder, "r")["stderr_db"]["rms"]
        tap.equal(abs(said / rms - 1) < 1e-3, True, f"run.json: {said}, bins.csv: {rms}")
        printed = re.search(r"stated error ([\d.]+) dB r\.m\.s\.", done.err)
        tap.equal(abs(float(printed.group(1)) / rms - 1) < 0.06, True, done.err)


LONG_BINS = """version: 1
environment: {max_depth_m: 20, particle_density: high}
surface: {enabled: false}
bottom: {depth_m: 20, type: mud}
sonar:
  frequency_khz: 1000
  max_range_m: 24
  source_level_db: 220
  bin_length_m: 8
  blanking_m: BLANKING
  transmitter: {length_h_m: 0.005, length_v_m: 0.005}
  receivers: RECEIVERS
  noise: {enabled: false}
mission: {pose: {position_m: [0, 0, 7]}}
sampling: {rays: 60000}
output: {images: []}
"""


def test_water_ends_at_the_floor_within_a_bin():
    """In bins so long that sound fades by decibels within one, as the quadrature has it: the floor begins 5 m into the second.
    A beam, and so many that they are summed in another way; water from within the first bin on."""
    program.need_device()
    with Folder() as folder:
        for receivers, blanking, beams in (
                ("[{name: down, pitch_deg: 90, length_h_m: 0.05, length_v_m: 0.05}]", 2, 1),
                ("{fan: {count: 40, sector_deg: 60, pitch_deg: 60, length_h_m: 0.03, length_v_m: 0.05}}", 5.5, 40)):
            path = folder.write("long.yaml", LONG_BINS.replace("RECEIVERS", receivers).replace("BLANKING", str(blanking)))
            asdic("run", path, "-q", "-f", "-o", folder / "out").check(code=0)
            text = asdic("expect", path, "-o", "-").check(code=0).out
            found = list(csv.DictReader(data(folder, "out", "bins.csv").decode().splitlines()))
            exact = list(csv.DictReader(text.splitlines()))
            tap.equal(len(found), 3 * beams, "bins")
            for name in "bottom_db", "volume_db":
                for a, b in zip(found, exact):
                    off = abs(float(a[name] or 0) - float(b[name] or 0))
                    tap.equal((a[name] == "", off < 0.15), (b[name] == "", True),
                              f"{name} of beam {a['beam']}, bin {a['bin']}: {a[name]}, by quadrature {b[name]}")


def test_rays_follow_the_sonar():
    """Without a number a fan of many beams gets more than 20,000 rays; few rays are remarked on."""
    program.need_device()
    with Folder() as folder:
        scene(folder, pings=1, receivers="    fan: {count: 64, sector_deg: 120, length_h_m: 0.3}")
        text = folder.read("pool.yaml").replace("rays: 2000", "rays: auto")
        path = folder.write("auto.yaml", text.replace("ping_rate_hz: 20", "ping_rate_hz: 2"))
        wanted = json.loads(asdic("check", path, "--json").check(code=0).out)[0]
        tap.equal((wanted["rays_auto"], 40000 < wanted["rays"] < 200000), (True, True), wanted)
        tap.contains(asdic("check", path).out, f"{wanted['rays']} a ping (auto)")
        done = asdic("run", path, "-o", folder / "r").check(code=0)
        tap.equal(facts(folder, "r")["rays"], wanted["rays"], "rays of the run")
        tap.equal(facts(folder, "r")["stderr_db"]["rms"] < 1, True, "its error")
        tap.equal("few for this sonar" in done.err, False, "remark")
        few = asdic("run", path, "-o", folder / "few", "--rays", 500).check(code=0)
        tap.contains(few.err, "remark: rays: 500 a ping are few for this sonar")
        tap.equal(facts(folder, "few")["rays"], 500, "--rays")
        told = facts(folder, "few")["remarks"]
        tap.equal([few.err.count(remark) for remark in told], [1] * len(told), "what was said, is in run.json")
        tap.contains(" ".join(told), "'rays: auto' would take")
        # As many as there are at all are few for so many bins.
        many = text.replace("count: 64", "count: 1024").replace("length_h_m: 0.3", "length_h_m: 5")
        said = asdic("check", folder.write("many.yaml", many.replace("ping_rate_hz: 20", "ping_rate_hz: 1"))).check(0).err
        tap.contains(said, "rays: 524288 a ping, the most that 'auto' takes, are few for this sonar")
        tap.contains(said, "; a number of your own, or a tolerance, takes more")


def test_times_are_said():
    """What 'asdic run' prints of writing and drawing is what run.json keeps."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=20, rays=4000)
        err = asdic("run", path, "-o", folder / "r").check(code=0).err
        said = re.search(r"[\d.]+ s: devices ([\d.]+) s, writing ([\d.]+) s, drawing ([\d.]+) s "
                         r"\(the last two (\d+) %\)", err)
        kept = facts(folder, "r")["time_s"]
        tap.equal(sorted(kept), ["devices", "pictures", "plan", "setup", "simulate", "whole", "write"], "keys")
        for number, key in zip(said.group(1, 2, 3), ("devices", "write", "pictures")):
            tap.equal(abs(float(number) - kept[key]) < 0.006, True, key)
        share = 100 * (kept["write"] + kept["pictures"]) / kept["whole"]
        tap.equal(abs(float(said.group(4)) - share) < 2, True, "share")
        if not (0 < kept["devices"] and kept["simulate"] <= kept["whole"]
                and 0 < kept["write"] and 0 < kept["pictures"] < kept["whole"]):
            raise AssertionError(kept)


def test_runs_without_rays_are_no_complete_ones():
    """A flat scene by quadrature traces no ray; what is said of it must not be what a second run says."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("flat.yaml", "version: 1\nbottom: {depth_m: 12, type: sand}\n"
                            "sonar: {frequency_khz: 450, ping_rate_hz: 10, source_level_db: 200,\n"
                            "        bin_length_m: 0.5, receivers: [{name: forward}]}\n"
                            "mission: {pose: {position_m: [0, 0, 7]}, pings: 70}\n"
                            "sampling: {multipath: off}\n")
        tap.contains(asdic("run", path, "-o", folder / "r").check(code=0).err, folder / "r: 70 pings, 1 beam")
        tap.equal(facts(folder, "r")["rays_traced"], 0, "rays")
        again = asdic("run", path, "-o", folder / "r", "--resume").check(code=0)
        tap.contains(again.err, "complete already")
        # In fresh water the plan leaves out boric acid as well; the levels are those of asdic expect.
        folder.write("lake.yaml", "environment: {salinity_ppt: 0}\n" + folder.read("flat.yaml"))
        asdic("run", "lake.yaml", "-o", "lake", cwd=folder.path).check(code=0)
        tap.equal(facts(folder, "lake")["rays_traced"], 0, "rays in a lake")
        expected = csv.DictReader(asdic("expect", "lake.yaml", "-o", "-", cwd=folder.path).check(code=0).out.splitlines())
        rows = list(csv.DictReader(data(folder, "lake", "bins.csv").decode().splitlines()))
        apart = [abs(float(a["level_db"]) - float(b["total_db"])) for a, b in zip(rows, expected)]
        tap.equal(len(apart) > 100 and max(apart) < 1e-3, True, f"levels in a lake: {apart[:3]}")


def test_multipath_has_a_column():
    """A polished wall 25 m ahead shows the ball's back, 29 m away over the wall; off, nothing does."""
    program.need_device()
    wall = ("objects:\n  - name: wall\n    plate: {size_m: [20, 10]}\n    position_m: [25, 0, 6]\n"
            "    material: {impedance_mrayl: 45, roughness_rms_mm: 0, slope_rms: 0}\n")
    with Folder() as folder:
        scene(folder, pings=1, rays=20000, npy="false")
        text = folder.read("pool.yaml").replace("objects:\n", wall)
        columns = {}
        for way in ("off", "first"):
            folder.write("pool.yaml", text.replace("seed: 7", f"seed: 7, multipath: {way}"))
            asdic("run", "pool.yaml", "-o", way, cwd=folder.path).check(code=0)
            rows = list(csv.DictReader(data(folder, way, "bins.csv").decode().splitlines()))
            columns[way] = [r["multipath_db"] for r in rows if r["beam"] == "forward"]
        tap.equal(set(columns["off"]), {""}, "multipath: off")
        tap.equal([columns["first"][n] != "" for n in (10, 28, 29)], [False, True, True])


def test_binary_and_text_agree():
    program.need_device()
    with Folder() as folder:
        asdic("run", scene(folder, pings=2), "-o", folder / "r").check(code=0)
        header, body = npy(data(folder, "r", "levels.npy"))
        bins = facts(folder, "r")["bins"]
        tap.equal(header, {"descr": "<f4", "fortran_order": False, "shape": (2, 2, bins)})
        levels = struct.unpack(f"<{4 * bins}f", body)
        rows = list(csv.DictReader(data(folder, "r", "bins.csv").decode().splitlines()))
        for row, level in zip(rows, levels):
            text = row["level_db"]
            read = struct.unpack("<f", struct.pack("<f", float(text)))[0] if text else None
            if read != level and not (text == "" and level != level):
                raise AssertionError(f"{row}: {level!r}")
        header, body = npy(data(folder, "r", "pings.npy"))
        tap.equal(header["shape"], (2,))
        tap.equal([field[0] for field in header["descr"]][-9:], HEADER.split(",")[5:] + ["crc32"],
                  "fields")


def check_windows(folder, low, high):
    """An A-scope reaches 20 dB below the waterfalls' window, and over the loudest bin by 2 dB; the overview holds the
    strongest echo of every ping and beam, with its gain, and nothing else."""
    if "ascope_0.png" not in pictures(folder, "r"):
        return
    rows = list(csv.DictReader(data(folder, "r", "bins.csv").decode().splitlines()))
    most = max(float(row[part]) for row in rows for part in ("level_db", "object_db") if row[part])
    scope = png_texts(data(folder, "r", "ascope_0.png"))
    tap.equal((float(scope["db_low"]), float(scope["db_high"])),
              (low - 20, max(high, 10 * math.ceil((most + 2) / 10))), "window of an A-scope")
    asdic("render", folder / "r", "--images", "overview", "-o", folder / "overview.png").check(code=0)
    whole = png_texts(data(folder, "", "overview.png"))
    loss = re.fullmatch(r"40 log r \+ (\S+) r dB", whole["gain"])[1]
    strongest = {}
    for row in rows:
        r = float(row["range_m"])
        if row["level_db"] and float(row["level_db"]) > float(row["noise_db"]) + 10:
            shown = float(row["level_db"]) + 40 * math.log10(r) + float(loss) * r
            at = row["ping"], row["beam"]
            strongest[at] = max(strongest.get(at, shown), shown)
    tap.equal((float(whole["db_low"]), float(whole["db_high"])),
              (10 * math.floor(min(strongest.values()) / 10), 10 * math.ceil(max(strongest.values()) / 10)),
              f"window of the overview of {strongest}")


def test_pictures_say_what_they_show():
    program.need_device()
    with Folder() as folder:
        asdic("run", scene(folder, pings=3), "-o", folder / "r").check(code=0)
        expected = ["waterfall_down.png", "waterfall_forward.png"]
        if "ascope_0.png" in pictures(folder, "r"):
            expected = ["ascope_0.png", "ascope_2.png"] + expected
        tap.equal(pictures(folder, "r"), expected, "pictures")
        texts = png_texts(data(folder, "r", "waterfall_forward.png"))
        run = facts(folder, "r")
        tap.equal(texts["scene_sha256"], run["scene"]["sha256"])
        tap.equal((texts["seed"], texts["version"], texts["beam"]), ("7", run["version"], "forward"))
        low, high = float(texts["db_low"]), float(texts["db_high"])
        levels = sorted(float(row["level_db"]) for row in csv.DictReader(
            data(folder, "r", "bins.csv").decode().splitlines()) if row["level_db"])
        tap.equal((low, high), (10 * math.floor(levels[len(levels) // 20] / 10),
                                10 * math.ceil(levels[len(levels) * 995 // 1000] / 10)), "window")
        check_windows(folder, low, high)
        tap.equal(texts["Description"], "100 kHz, bandwidth 10 kHz  \u00b7  bins of 1 m  \u00b7  "
                  "source level 200 dB re 1 \u00b5Pa at 1 m", "subtitle")
        if shutil.which("pngcheck"):
            subprocess.run(["pngcheck", "-q"] + [folder / "r/" + n for n in expected], check=True)


def test_levels_without_a_source_level_say_so():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=2)
        text = data(folder, "", "pool.yaml").decode().replace("  source_level_db: 200\n", "")
        for noise, shown, said in (("false", "levels re an SL of 0 dB", "stated error"),
                                   ("true", "source level 0 dB re 1 \u00b5Pa at 1 m", "no bin is above the noise")):
            quiet = text.replace("sonar:\n", f"sonar:\n  noise: {{enabled: {noise}}}\n")
            done = asdic("run", folder.write("pool.yaml", quiet), "-o", folder / noise).check(code=0)
            tap.contains(png_texts(data(folder, noise, "waterfall_forward.png"))["Description"], shown)
            tap.contains(done.err, said)


def test_pictures_say_and_show_what_they_should():
    """An overview without a gain of its own makes good spreading and the absorption at the sonar, both ways; an A-scope
    has curves of its own for all that it expects."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("s.yaml", "version: 1\nbottom: {depth_m: 12}\n"
                            "sonar: {frequency_khz: 100, source_level_db: 200, ping_rate_hz: 2, bin_length_m: 2, "
                            "receivers: [{name: a}, {name: b, pitch_deg: 45}]}\n"
                            "mission: {pose: {position_m: [0, 0, 7]}, pings: 3}\n"
                            "sampling: {rays: 500}\noutput: {images: [overview, ascope]}\n")
        asdic("run", path, "-o", folder / "r").check(code=0)
        if "ascope_0.png" not in pictures(folder, "r"):
            raise tap.Skip("no cairo")
        loss = float(re.search(r"and (\S+) dB/km", asdic("check", path).check(code=0).out)[1])
        gain = re.fullmatch(r"40 log r \+ (\S+) r dB", png_texts(data(folder, "r", "overview.png"))["gain"])
        tap.equal(abs(float(gain[1]) - 2e-3 * loss) < 5e-4, True, f"{gain[0]}, {loss} dB/km one way")
        asdic("render", folder / "r", "--images", "ascope", "--ping", 0, "-o", folder / "a.svg").check(code=0)
        curves = [d for d in re.findall(r' d="([^"]*)"', folder.read("a.svg")) if d.count("L") > 40]
        tap.equal(len(curves) >= 10 and len(set(curves)) == len(curves), True, f"{len(curves)} curves, none twice")


def test_ascopes_of_a_run_are_alike():
    """Of one size, window and scale, though a loud ball and multipath are in the second ping alone: they are a video's
    frames. One that is drawn alone is the same picture."""
    program.need_device()
    with Folder() as folder:
        folder.write("way.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,7,0,0,0\n1,40,0,7,0,0,0\n")
        path = folder.write("s.yaml", "version: 1\nbottom: {depth_m: 12}\n"
                            "objects: [{name: ball, sphere: {radius_m: 3}, position_m: [60, 0, 7]}]\n"
                            "sonar: {frequency_khz: 100, source_level_db: 200, ping_rate_hz: 1, max_range_m: 30, "
                            "receivers: [{name: a}]}\nmission: {track: way.csv}\n"
                            "sampling: {rays: 500}\noutput: {images: [ascope]}\n")
        asdic("run", path, "-o", folder / "r").check(code=0)
        if "ascope_0.png" not in pictures(folder, "r"):
            raise tap.Skip("no cairo")
        scopes = [data(folder, "r", f"ascope_{ping}.png") for ping in (0, 1)]
        tap.equal(len({(scope[16:24], png_texts(scope)["db_low"], png_texts(scope)["db_high"])
                       for scope in scopes}), 1, "sizes and windows")
        asdic("render", folder / "r", "--images", "ascope", "--ping", 1, "-o", folder / "one.png").check(code=0)
        with open(folder / "one.png", "rb") as file:
            tap.equal(file.read() == scopes[1], True, "the second ping alone")


def test_plans_know_a_flat_bottom():
    """A beam that looks down meets a flat bottom, and none where there is no bottom: then its area is dashed."""
    program.need_device()
    with Folder() as folder:
        for bottom, is_dashed in (("{depth_m: 12}", False), ("none", True)):
            path = folder.write("s.yaml", f"version: 1\nbottom: {bottom}\n"
                                "sonar: {frequency_khz: 100, source_level_db: 200, ping_rate_hz: 5, bin_length_m: 1, "
                                "receivers: [{name: a, pitch_deg: 45}]}\n"
                                "mission: {pose: {position_m: [0, 0, 7]}, pings: 1}\n"
                                "sampling: {rays: 100}\noutput: {images: [plan]}\n")
            asdic("run", path, "-o", folder / "r", "--force").check(code=0)
            if pictures(folder, "r") != ["plan.png"]:
                raise tap.Skip("no cairo")
            asdic("render", folder / "r", "--images", "plan", "-o", folder / "p.svg", "--force").check(code=0)
            tap.equal("stroke-dasharray" in folder.read("p.svg"), is_dashed, f"a dashed area, bottom: {bottom}")


def test_times_in_titles_are_round():
    """The third ping of 15 a second comes at 0.1333... s."""
    program.need_device()
    with Folder() as folder:
        scene(folder, pings=3)
        text = re.sub(r"ping_rate_hz: \d+", "ping_rate_hz: 15", folder.read("pool.yaml"))
        asdic("run", folder.write("pool.yaml", text), "-o", folder / "r").check(code=0)
        if "ascope_2.png" not in pictures(folder, "r"):
            raise tap.Skip("no cairo")
        tap.equal(png_texts(data(folder, "r", "ascope_2.png"))["Title"], "pool: ping 2, t = 0.133 s")


def test_one_ping_has_no_time_to_draw():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=3)
        asdic("run", path, "-o", folder / "r", "--pings", "0:1").check(code=0)
        tap.equal([n for n in pictures(folder, "r") if "ascope" not in n], [], "pictures")
        done = asdic("render", folder / "r", "--images", "waterfall,overview").check(code=2)
        tap.contains(done.err, "no waterfall, no overview: they need two pings or more")
        tap.contains(done.err, "none of the pictures asked for can be drawn of this run")
        tap.equal([n for n in pictures(folder, "r") if "ascope" not in n], [], "by name")


def test_fan_pictures():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=1, receivers="    fan: {count: 12, sector_deg: 90, "
                     "length_h_m: 0.1, length_v_m: 0.05}")
        asdic("run", path, "-o", folder / "r").check(code=0)
        names = pictures(folder, "r")
        tap.contains(names, "fan_0.png")
        asdic("run", scene(folder, pings=2, receivers="    fan: {count: 12, sector_deg: 90, "
                           "length_h_m: 0.1, length_v_m: 0.05}"), "-o", folder / "s").check(code=0)
        tap.equal(len([n for n in pictures(folder, "s") if n.startswith("waterfall_")]), 1,
                  "waterfalls of a fan")


def test_a_plan_outlines_beams_side_by_side():
    """A fan has one area; of other beams those have whose lobes touch, from port to starboard: an outline round more would
    enclose what none sees."""
    program.need_device()
    port, starboard = [-60 + 5 * i for i in range(5)], [40 + 5 * i for i in range(5)]
    with Folder() as folder:
        for yaws, length_m, areas in ((port + starboard, 0.1, 1), (starboard + port, 0.1, 2), (starboard + port, 1, 10),
                                      (port + port + starboard, 0.1, 3)):
            beams = ", ".join(f"{{name: b{i}, yaw_deg: {yaw}, pitch_deg: 10, length_h_m: {length_m}}}"
                              for i, yaw in enumerate(yaws))
            path = folder.write("s.yaml", "version: 1\nbottom: {depth_m: 12}\n"
                                "sonar: {frequency_khz: 100, source_level_db: 200, ping_rate_hz: 20, bin_length_m: 1, "
                                f"receivers: [{beams}]}}\nmission: {{pose: {{position_m: [0, 0, 7]}}}}\n"
                                "sampling: {rays: 100}\noutput: {images: [plan], csv: none}\n")
            asdic("run", path, "-q", "-f", "-o", folder / "r").check(code=0)
            if "plan.png" not in pictures(folder, "r"):
                raise tap.Skip("built without cairo")
            asdic("render", folder / "r", "--images", "plan", "-o", folder / "plan.svg", "--force").check(code=0)
            tap.equal(folder.read("plan.svg").count("fill-opacity:0.2;"), areas, f"areas of beams at {yaws}, {length_m} m long")


def test_pictures_are_the_same_drawn_later():
    """Of records with all parts, with those that a scene can have, and with none: to the byte what the run itself drew."""
    program.need_device()
    with Folder() as folder:
        text = data(folder, "", os.path.basename(scene(folder, pings=4))).decode()
        sizes = []
        for records in "full", "compact", "levels":
            path = folder.write("pool.yaml", text.replace(
                "npy: true, images: [waterfall, ascope, fan]",
                f"images: [waterfall, ascope, fan, overview, plan], records: {records}"))
            asdic("run", path, "-q", "-f", "-o", folder / "r").check(code=0)
            drawn = {name: data(folder, "r", name) for name in pictures(folder, "r")}
            sizes.append(len(data(folder, "r", "pings.npy")))
            for name in drawn:
                os.remove(folder / "r/" + name)
            asdic("render", folder / "r", "--images", "waterfall,ascope,fan,overview,plan").check(code=0)
            again = {name: data(folder, "r", name) for name in pictures(folder, "r")}
            tap.equal(sorted(again), sorted(drawn), f"pictures of {records} records")
            tap.equal([name for name in drawn if drawn[name] != again[name]], [], f"drawn otherwise of {records} records")
        tap.equal(sizes, sorted(set(sizes), reverse=True), "bytes of the records")


def test_render_draws_again():
    program.need_device()
    with Folder() as folder:
        run = folder / "r"
        asdic("run", scene(folder, pings=3), "-o", run).check(code=0)
        before = {n: data(folder, "r", n) for n in pictures(folder, "r")}
        asdic("render", run).check(code=0, out="")
        tap.equal({n: data(folder, "r", n) for n in pictures(folder, "r")}, before, "same pictures")
        asdic("render", run, "--db-range", "-20:120", "--colormap", "gray", "--tvg", "40", "--beam",
              "down", "--images", "waterfall", "--raw").check(code=0)
        texts = png_texts(data(folder, "r", "waterfall_down.png"))
        tap.equal((texts["db_low"], texts["db_high"], texts["colormap"]), ("-20", "120", "gray"))
        tap.contains(texts["gain"], "40 log r + 0.0")
        tap.equal(data(folder, "r", "waterfall_forward.png"), before["waterfall_forward.png"])
        raw = data(folder, "r", "raw_down.png")
        width, height, depth, colour = struct.unpack(">IIBB", raw[16:26])
        tap.equal((width, height, depth, colour), (facts(folder, "r")["bins"], 3, 16, 0))
        # Without a window, one that shows the levels with their gain: 40 log r is 31 dB at 6 m, where
        # the bottom begins; an A-scope's levels have none.
        window = [(int(t["db_low"]), int(t["db_high"]), t["gain"]) for t in (
            png_texts(before[name]) for name in ("waterfall_down.png", "ascope_0.png"))]
        asdic("render", run, "--tvg", "40").check(code=0)
        gained, scope = (png_texts(data(folder, "r", name))
                         for name in ("waterfall_down.png", "ascope_0.png"))
        tap.equal(int(gained["db_high"]) >= window[0][1] + 20, True, "the window's end goes along")
        tap.equal((int(scope["db_low"]), int(scope["db_high"]), scope["gain"]), window[1], "A-scope")
        for arguments in (["--beam", "sideways"], ["--ping", "3"], ["--colormap", "jet"],
                          ["--images", "overview,plan", "--beam", "down"], ["--images", "waterfall", "--ping", "1"],
                          ["--db-range", "5:-5"], ["--images", "portrait"], ["--tvg", "x"]):
            asdic("render", run, *arguments).check(code=2)
        asdic("render", folder.path).check(code=3)


def test_what_is_there_is_not_overwritten():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=1)
        run = folder / "r"
        os.mkdir(run)
        others = "notes.txt", "roc.csv", "roc.png", "roc_range.csv"  # as by 'asdic roc -o r'
        for name in others:
            folder.write(f"r/{name}", "mine")
        asdic("run", path, "-o", run).check(code=0)
        csv_before = data(folder, "r", "bins.csv")
        done = asdic("run", path, "-o", run, "--seed", "8").check(code=1)
        tap.contains(done.err, "--force")
        tap.equal(data(folder, "r", "bins.csv"), csv_before, "bins.csv")
        asdic("run", path, "-o", run, "--seed", "8", "--resume").check(code=1)
        asdic("run", path, "-o", run, "--seed", "8", "--force").check(code=0)
        tap.equal(facts(folder, "r")["seed"], 8)
        tap.equal([data(folder, "r", name) for name in others], [b"mine"] * 4, "what is no run's")
        asdic("run", path, "-o", run, "--seed", "8", "--resume").check(code=0)
        asdic("run", path, "-o", folder / "pool.yaml").check(code=1)
        asdic("run", path, "-o", folder / "no/such").check(code=1)


def test_flown_track_is_written_and_replays():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, rays=500)
        at_rest = "pose: {position_m: [0, 0, 5]}, pings: 6"
        for vehicle in ("nomoto", "remus100"):
            flight = ("waypoints: {points_m: [[-6, 1, 5], [4, -2, 7], [6, 3, 5]], altitude_m: 6.3, "
                      "current_mps: [0.2, -0.3], vehicle: " + vehicle + "}")
            flown = folder.write("flown.yaml", folder.read("pool.yaml").replace(at_rest, flight))
            asdic("run", flown, "-o", folder / "flown", "--force").check(code=0)
            lines = data(folder, "flown", "track.csv").decode().splitlines()
            tap.equal(lines[0], "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg")
            tap.equal(len(lines) - 1, facts(folder, "flown")["pings"], "rows")
            replay = folder.write("replay.yaml", folder.read("pool.yaml").replace(
                at_rest, "track: flown/track.csv"))
            asdic("run", replay, "-o", folder / "replay", "--force").check(code=0)
            for name in ("bins.csv", "pings.npy", "track.csv"):
                if data(folder, "flown", name) != data(folder, "replay", name):
                    raise AssertionError(f"{vehicle}: {name} of the replay differs")
            asdic("run", flown, "--shard", "1/2", "-o", folder / "a", "--force").check(code=0)
            asdic("run", flown, "--shard", "2/2", "-o", folder / "b", "--force").check(code=0)
            asdic("merge", folder / "a", folder / "b", "-o", folder / "ab", "--force").check(code=0)
            tap.equal(data(folder, "ab", "track.csv").decode().splitlines(), lines, "merged track")


def test_a_part_learns_where_the_whole_does():
    """A vehicle that pitches learns anew within a block of pings; a part of the block begins after that."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, rays=500)
        folder.write("pitch.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + "".join(
            f"{0.05 * k:.2f},{0.1 * k:.1f},0,5,0,{-3 * k},0\n" for k in range(8)))
        text = folder.read("pool.yaml").replace("pose: {position_m: [0, 0, 5]}, pings: 6", "track: pitch.csv")
        path = folder.write("pitch.yaml", text)
        lessons = json.loads(asdic("plan", path, "--json").check(code=0).out)["forecast"]["lessons"]
        tap.equal(1 < lessons < 8, True, f"learns {lessons} times")
        asdic("run", path, "-o", folder / "whole").check(code=0)
        asdic("run", path, "--pings", "5:8", "-o", folder / "part").check(code=0)
        rows = data(folder, "whole", "bins.csv").decode().splitlines()
        part = data(folder, "part", "bins.csv").decode().splitlines()
        tap.equal(part[1:], [row for row in rows[1:] if int(row.split(",")[0]) >= 5], "rows of the part")


def test_no_force_replaces_what_the_scene_reads():
    """A run writes terrain.asc and track.csv, names that a scene's own files may have."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, rays=500)
        track = folder.write(
            "track.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,5,0,0,0\n1,1,0,5,0,0,0\n")
        flown = folder.write("flown.yaml", folder.read("pool.yaml").replace(
            "pose: {position_m: [0, 0, 5]}, pings: 6", "track: track.csv"))
        before = data(folder, ".", "track.csv")
        for where in (folder.path, folder / "."):
            done = asdic("run", flown, "-o", where, "--force").check(code=1)
            tap.contains(done.err, "track.csv', which the scene reads, is in")
        asdic("run", flown, "-o", folder / "part").check(code=0)
        for where in (folder.path, folder / "."):
            done = asdic("merge", folder / "part", "-o", where, "--force").check(code=1)
            tap.contains(done.err, "track.csv', which the scene reads, is in")
        asdic("run", path, "-o", folder / "r").check(code=0)
        os.remove(folder / "r/track.csv")
        os.symlink(track, folder / "r/track.csv")  # the link is the run's to replace, but for this scene
        done = asdic("run", flown, "-o", folder / "r", "--force").check(code=1)
        tap.contains(done.err, "which the scene reads")
        tap.equal(data(folder, ".", "track.csv"), before)
        asdic("run", path, "-o", folder / "r", "--force").check(code=0)
        tap.equal(data(folder, ".", "track.csv"), before)
        piped = asdic("run", "-", "-o", ".", "--force", cwd=folder.path, stdin=folder.read("flown.yaml"))
        tap.contains(piped.check(code=1).err, "which the scene reads")


def test_tolerance_finds_rays():
    program.need_device()
    with Folder() as folder:
        done = asdic("run", scene(folder), "--rays", 64, "--tolerance", 0.5, "-o", "fine",
                     cwd=folder.path).check(code=0, out="")
        rays = facts(folder, "fine")["rays"]
        if not (rays > 64 and f"tolerance 0.5 dB: {rays} rays per ping" in done.err):
            raise AssertionError((rays, done.err))
        kept = float(re.search(r"keep it in ([\d.]+) % of bins", done.err).group(1))
        tap.equal(kept >= 99, True, done.err)
        asdic("run", folder / "pool.yaml", "--rays", rays, "-o", "same",
              cwd=folder.path).check(code=0)
        tap.equal(data(folder, "fine", "bins.csv") == data(folder, "same", "bins.csv"), True, "bins")
        asdic("run", folder / "pool.yaml", "--tolerance", 0, "-o", "none",
              cwd=folder.path).check(code=2, out="")


def test_a_tolerance_is_kept_by_the_mission():
    """Also towards its end, where a hull comes near that the first ping does not hear."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("hull.yaml", """version: 1
bottom: {depth_m: 25, type: sand}
objects:
  - {name: hull, cylinder: {radius_m: 4, length_m: 40}, position_m: [70, 5, 22], rotation_deg: [0, 0, 60],
     material: {preset: steel, roughness_rms_mm: 3, slope_rms: 0.3}}
sonar:
  {frequency_khz: 180, ping_rate_hz: 0.5, max_range_m: 40, bin_length_m: 0.25, source_level_db: 205,
   receivers: {fan: {count: 7, sector_deg: 70, length_h_m: 0.04, length_v_m: 0.03}}}
mission: {waypoints: {points_m: [[0, 0, 12], [55, 0, 12]], speed_mps: 1.2}}
output: {images: []}
""")
        done = asdic("run", path, "--rays", 4000, "--tolerance", 1, "--tolerance-percent", 95, "-o",
                     folder / "r").check(code=0)
        said = re.search(r"keep it in ([\d.]+) % of bins, worst bin ([\d.]+) dB", done.err)
        echoes = ("bottom", "surface", "volume", "object", "multipath")
        errors = []
        for row in csv.DictReader(data(folder, "r", "bins.csv").decode().splitlines()):
            echo = sum(10 ** (float(row[f"{name}_db"]) / 10) for name in echoes if row[f"{name}_db"])
            if echo > 0 and echo >= 10 ** (float(row["noise_db"]) / 10):
                errors.append(float(row["stderr_db"]))
        kept = 100 * sum(error <= 1 for error in errors) / len(errors)
        tap.equal(abs(kept - float(said.group(1))) < 1 and kept > 94.5, True, f"{kept} % keep it; {done.err}")
        tap.equal(float(said.group(2)) <= max(errors) + 0.006, True, f"{max(errors)} dB; {done.err}")
        tap.contains(done.err, "dB, in the 16 of 23 pings looked at")


def test_tolerance_is_for_a_share_of_the_bins():
    """Fewer rays where fewer bins must keep it; who does not is named, with what it would take."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=3)
        rays = {}
        for percent in (50, 100):
            done = asdic("run", path, "--rays", 64, "--tolerance", 0.5, "--tolerance-percent",
                         percent, "-o", folder / f"p{percent}").check(code=0)
            rays[percent] = facts(folder, f"p{percent}")["rays"]
            said = re.search(r"(\d+) rays per ping keep it in ([\d.]+) % of bins", done.err)
            tap.equal((int(said.group(1)), float(said.group(2)) >= percent), (rays[percent], True))
            rough = re.search(r"(\d+) of (\d+) bins above the noise", done.err)
            share = int(rough.group(1)) / int(rough.group(2)) if rough else 0
            tap.equal(abs(float(said.group(2)) - 100 * (1 - share)) < 0.006, True, done.err)
            tap.contains(done.err, "3 pings take about ")
            tap.contains(done.err, "in the 3 of 3 pings looked at")
            tap.equal(bool(re.search(r"stay above 0.5 dB; the roughest:\n  ping [012], beam '", done.err)),
                      percent == 50, done.err)
        tap.equal(rays[50] < rays[100], True, rays)
        asdic("run", path, "--tolerance-percent", 50, "-o", folder / "no").check(code=2, out="")


def test_tolerance_needs_a_bin_and_an_error():
    """A scene that the noise drowns is not said to keep one, and coherent pings are refused."""
    program.need_device()
    with Folder() as folder:
        quiet = folder.write("quiet.yaml", "version: 1\nbottom: {depth_m: 12}\nsonar: {frequency_khz: 100, ping_rate_hz: 50, "
                             "source_level_db: 20, receivers: [{name: a}]}\nmission: {pose: {position_m: [0, 0, 7]}}\n"
                             "output: {images: []}\n")
        done = asdic("run", quiet, "--rays", 64, "--tolerance", 0.5, "-o", folder / "r").check(code=0)
        tap.contains(done.err, "tolerance 0.5 dB: no bin is above the noise in the 1 of 1 pings looked at, so that none can keep "
                               "it; the 64 rays per ping stay as they are")
        tap.lacks(done.err, "100 %")
        tap.equal(facts(folder, "r")["rays"], 64)
        text = folder.read("quiet.yaml").replace("receivers: [{name: a}]", "array: {elements: 8, beams: {count: 3, sector_deg: 30}}")
        array = folder.write("array.yaml", text + "sampling: {coherent: true}\n")
        done = asdic("run", array, "--tolerance", 0.5, "-o", folder / "c").check(code=2)
        tap.contains(done.err, "a tolerance of 0.5 dB cannot be kept with 'sampling: {coherent: true}', whose pings state no "
                               "error; set the number of rays instead")
        tap.equal(folder.names(), ["array.yaml", "quiet.yaml", "r"], "files afterwards")


def test_tolerance_says_the_time():
    """That of a ping and of its learning, both of which were measured on the way."""
    program.need_device()
    with Folder() as folder:
        began_s = time.monotonic()
        done = asdic("run", scene(folder, pings=1), "--rays", 200000, "--tolerance", 20, "-o",
                     folder / "r").check(code=0)
        spent_s = time.monotonic() - began_s
        said = float(re.search(r"1 ping takes about (\S+) s on one device", done.err).group(1))
        tap.equal(0 < said < spent_s, True, f"{said} s said, {spent_s} s with all that was tried")


def test_mistakes_have_their_exit_codes():
    with Folder() as folder:
        path = scene(folder)
        for arguments in (["--rays", "3"], ["--rays", "many"], ["--sampler", "grid"],
                          ["--seed", "-1"], ["--force", "--resume"], ["--shard", "4/3"],
                          ["--shard", "1"], ["--pings", "3:2"], ["--pings", "0:7"],
                          ["--pings", "6"], ["--shard", "8/7"], ["extra"]):
            asdic("run", path, *arguments, "-o", folder / "r").check(code=2, out="")
        asdic("run").check(code=2)
        asdic("run", folder / "absent.yaml").check(code=3)
        for arguments in (["--force", "--resume"], ["--tolerance-percent", "50"]):  # before a scene is loaded
            asdic("run", folder / "absent.yaml", *arguments).check(code=2, out="")
        bad = folder.write("bad.yaml", folder.read("pool.yaml").replace("bottom:", "botom:"))
        tap.contains(asdic("run", bad).check(code=3).err, "did you mean 'bottom'")
        asdic("run", path, "-o", folder / "r", OCL_ICD_VENDORS="/nonexistent").check(code=4)
        tap.equal(folder.names(), ["bad.yaml", "pool.yaml"], "files afterwards")


def test_no_ping_below_the_bottom_is_simulated():
    """Of 1,200,001 pings every second one is tested before; the others as they come."""
    program.need_device()
    with Folder() as folder:
        rows = [(0, 5), (90000, 5), (90000.1, 15), (90000.2, 5), (120000, 5)]
        folder.write("dip.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                     + "".join(f"{time},0,0,{z},0,0,0\n" for time, z in rows))
        name = folder.write("dip.yaml", "version: 1\nbottom: {depth_m: 12}\n"
                            "mission: {track: dip.csv}\nsampling: {rays: 100}\n"
                            "sonar: {frequency_khz: 100, ping_rate_hz: 10, source_level_db: 200, "
                            "receivers: [{name: a}]}\n")
        err = asdic("run", name, "-o", folder / "r", "--pings", "900000:900003").check(code=3).err
        tap.contains(err, "error: ping 900001 at 90000.1 s: the sonar is at z = 15 m, below the "
                     "bottom at 12 m; raise it or lower the bottom; 1 of 3 pings are kept in ")


def test_progress_on_a_terminal_only():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=600, rays=4000)
        done = program.asdic_on_terminal("run", path, "-o", folder / "a")
        tap.equal(done.code, 0)
        if not re.search(r"\[#*\.*\] \d+/600 pings  [\d.]+ [kMG]?rays/s  \d+:\d\d:\d\d left", done.err):
            raise AssertionError(f"no bar with pings, rays and time left in {done.err!r}")
        done = asdic("run", path, "-o", folder / "b").check(code=0)
        tap.lacks(done.err, "\r")
        tap.contains(done.err, "rays/s")
        one = asdic("run", path, "-o", folder / "one", "--pings", "0:1").check(code=0)
        tap.contains(one.err, "1 ping, ")
        tap.lacks(one.err, "rays/s")  # its time went into compiling
        asdic("run", path, "-o", folder / "c", "-q").check(code=0, err="")
        done = program.asdic_on_terminal("run", path, "-o", folder / "d", "-q")
        tap.equal(done.err, "")


tap.main(globals())
