"""Pictures of runs, read back by programs that are not ours or from their vector forms. A test is skipped where its
program is not installed; `./dev test` installs them."""
import math
import os
import re
import shutil
import subprocess
import xml.etree.ElementTree

import program
import tap
from foreign import numpy, tool
from pool import rows_of, run_of
from program import Folder, asdic
from run_folder import data, facts, pictures, png_texts
from svg_layout import check_layout, svg_marks


def test_pictures_in_pngcheck_and_gdal():
    with Folder() as folder:
        run = run_of(folder)
        asdic("render", run, "--raw", "--db-range", "0:200").check(code=0)
        names = pictures(folder, "r")
        tap.contains(names, "raw_down.png")
        for name in names:
            tap.contains(tool("pngcheck", name, cwd=run), "OK: " + name)
        out = tool("gdalinfo", "-mm", "raw_down.png", cwd=run)
        tap.contains(out, f"Size is {facts(folder, 'r')['bins']}, 4")
        tap.contains(out, "Type=UInt16")
        levels = [float(r["level_db"]) for r in rows_of(folder)
                  if r["beam"] == "down" and r["level_db"]]
        found = re.search(r"Computed Min/Max=([\d.]+),([\d.]+)", out).groups()
        for grey, level in zip(map(float, found), (min(levels), max(levels))):
            if not 0 < level < 200 or abs(grey - (1 + 65534 * level / 200)) > 1:
                raise AssertionError((grey, level))


def render_bytes(run, *arguments):
    """What render writes to the standard output."""
    return subprocess.run([program.PATH, "render", run, *arguments, "-o", "-"], check=True,
                          capture_output=True, timeout=60).stdout


def pixels(folder, run, name):
    """A PNG file without its texts."""
    content, at, found = data(folder, run, name), 8, b""
    while at < len(content):
        length = int.from_bytes(content[at:at + 4], "big")
        found += content[at + 8:at + 8 + length] if content[at + 4:at + 8] == b"IDAT" else b""
        at += 12 + length
    return found


def test_levels_alone_tell_noise_from_echoes():
    """The error that a run states, and what its overview leaves white, hang on the noise, which records of levels
    do not keep. One run hears much, the other nothing."""
    with Folder() as folder:
        for level_db in (200, 100):
            for records in ("full", "levels"):
                loud = f"source_level_db: {level_db}\n  speckle: rayleigh"
                run = run_of(folder, edits={"source_level_db: 200": loud,
                                            "fan]": f"overview], records: {records}"})
                os.rename(run, folder / f"{records}{level_db}")
        full, levels = (facts(folder, f"{records}200")["stderr_db"]["rms"] for records in ("full", "levels"))
        tap.equal(abs(levels / full - 1) < 0.1, True, f"errors {full} dB with all parts, {levels} dB with levels")
        tap.equal(facts(folder, "levels100")["stderr_db"]["rms"], None, "an error where nothing is heard")
        if "overview.png" not in pictures(folder, "full100"):
            raise tap.Skip("built without cairo")
        tap.equal(pixels(folder, "levels100", "overview.png") == pixels(folder, "full100", "overview.png"), True,
                  "the same overview")
        before = data(folder, "levels100", "overview.png")
        asdic("render", folder / "levels100").check(code=0)
        tap.equal(data(folder, "levels100", "overview.png") == before, True, "the same overview drawn again")


def test_a_plan_shows_beams_that_are_no_fan():
    """Nine beams all round have the same areas in whatever order they are listed."""
    with Folder() as folder:
        for name, order in (("r1", (4, 8, 0, 3, 7, 2, 6, 1, 5)), ("r2", (0, 5, 1, 2, 8, 4, 7, 3, 6))):
            beams = "".join(f"\n    - {{name: b{i}, pitch_deg: 30, yaw_deg: {40 * i - 160}}}" for i in order)
            run = run_of(folder, pings=1, edits={"\n    - {name: forward}\n    - {name: down, pitch_deg: 45}": beams,
                                                 "[waterfall, ascope, fan]": "[plan]",
                                                 "level_db: 200": "level_db: 0"})  # no error to note
            os.rename(run, folder / name)
        if not pictures(folder, "r1"):
            raise tap.Skip("built without cairo")
        tap.equal(pixels(folder, "r1", "plan.png") == pixels(folder, "r2", "plan.png"), True, "the same plan")


def test_a_fan_may_be_listed_from_starboard():
    """It has its picture and joins its beams in the plan, which shows the same as one from port."""
    with Folder() as folder:
        for name, order in (("r1", range(9)), ("r2", range(8, -1, -1))):
            beams = "".join(f"\n    - {{name: b{i}, pitch_deg: {20 + i}, yaw_deg: {12 * i - 40}, "
                            f"length_h_m: {0.1 + 0.01 * i}}}" for i in order)
            run = run_of(folder, pings=1, edits={"\n    - {name: forward}\n    - {name: down, pitch_deg: 45}": beams,
                                                 "[waterfall, ascope, fan]": "[fan, plan]",
                                                 "level_db: 200": "level_db: 0"})  # no error to note
            os.rename(run, folder / name)
            tap.equal("fan_0.png" in pictures(folder, name), True, f"a fan picture of {name}")
        if "plan.png" not in pictures(folder, "r1"):
            raise tap.Skip("built without cairo")
        tap.equal(pixels(folder, "r1", "plan.png") == pixels(folder, "r2", "plan.png"), True, "the same plan")


def test_a_plan_joins_beams_that_touch():
    """Two groups of six astern, no fan, of which each makes one area; twelve areas where gaps are between all."""
    for step, areas in (6, 2), (8, 12):
        with Folder() as folder:
            bearings = [(group + step * k + 180) % 360 - 180 for group in (130, 190) for k in range(6)]
            beams = "".join(f"\n    - {{name: b{k}, pitch_deg: 30, yaw_deg: {bearing}, length_h_m: 0.1}}"
                            for k, bearing in enumerate(bearings))
            run = run_of(folder, pings=1, edits={"\n    - {name: forward}\n    - {name: down, pitch_deg: 45}": beams,
                                                 "[waterfall, ascope, fan]": "[plan]"})
            if not pictures(folder, "r"):
                raise tap.Skip("built without cairo")
            text = render_bytes(run, "--images", "plan", "--format", "svg").decode()
            drawn = re.findall(r'<path style="[^"]*fill:rgb\(0%,44[^"]*fill-opacity:0.2', text)
            tap.equal(len(drawn), areas, f"areas of beams {step} degrees apart")


PLAN_LACKS = (("a gain is of pictures of levels; a plan has none", "--tvg", "30"),
              ("a window is of pictures of levels; a plan has none", "--db-range", "0:10"))


def test_a_plan_that_the_scene_asks_for_shows_no_levels():
    with Folder() as folder:
        run = run_of(folder, pings=1, edits={"[waterfall, ascope, fan]": "[plan]"})
        if not pictures(folder, "r"):
            raise tap.Skip("built without cairo")
        for what, *option in PLAN_LACKS:
            tap.contains(asdic("render", run, *option).check(code=2, out="").err, what)
        asdic("render", run, "--images", "ascope", "--tvg", "30").check(code=0)


def test_one_picture_goes_to_a_file_or_standard_output():
    with Folder() as folder:
        run = run_of(folder)
        names = pictures(folder, "r")
        tap.equal(render_bytes(run, "--images", "waterfall", "--beam", "down"),
                  data(folder, "r", "waterfall_down.png"), "the waterfall on standard output")
        tap.equal(render_bytes(run, "--raw", "--beam", "down")[16:29],
                  facts(folder, "r")["bins"].to_bytes(4, "big") + b"\0\0\0\4\x10\0\0\0\0", "raw")
        asdic("render", run, "--images", "waterfall", "--beam", "down", "-o",
              folder / "w.png").check(code=0, out="")
        tap.contains(asdic("render", run, "--images", "waterfall", "--beam", "down", "-o",
                           folder / "w.png").check(code=1).err, "--force")
        asdic("render", run, "--images", "waterfall", "--beam", "down", "-o", folder / "w.png",
              "--force").check(code=0)
        tap.contains(asdic("render", run, "-o", "-").check(code=2, out="").err, "these are")
        asdic("render", run, "--images", "ascope", "-o", "-").check(code=2, out="")
        asdic("render", run, "--format", "jpg").check(code=2)
        tap.contains(asdic("render", run, "--images", "").check(code=2, out="").err, "no picture ''; there are")
        for what, *option in PLAN_LACKS:
            tap.contains(asdic("render", run, "--images", "plan", *option).check(code=2, out="").err, what)
        waterfall = "render", run, "--images", "waterfall", "--beam", "down"
        tap.contains(asdic(*waterfall, "-o", folder / "w.jpg").check(code=2, out="").err,
                     "w.jpg: a picture is a file in .png, .pdf or .svg")
        for name, options, begins in (("w.PDF", (), b"%PDF"), ("w.Svg", (), b"<?xml"), ("W.PNG", (), b"\x89PNG"),
                                      ("w.v2/w", (), b"\x89PNG"), ("w.jpg", ("--format", "svg"), b"<?xml")):
            os.makedirs(folder / "w.v2", exist_ok=True)
            asdic(*waterfall, "-o", folder / name, *options).check(code=0, out="")
            tap.equal(data(folder, ".", name)[: len(begins)], begins, name)
        for name, form in ("x.png", "pdf"), ("x.PDF", "svg"), ("x.svg", "png"):
            tap.contains(asdic(*waterfall, "-o", folder / name, "--format", form).check(code=2, out="").err,
                         f"--format {form} writes no such file as --output")
            tap.equal(os.path.exists(folder / name), False, name)
        asdic(*waterfall, "-o", folder / "x.pdf", "--format", "pdf").check(code=0, out="")
        tap.contains(asdic(*waterfall, "--raw", "-o", folder / "r.PDF").check(code=2, out="").err, "PNG")
        for vector in (("-o", folder / "raw.pdf"), ("-o", folder / "raw.svg"), ("-o", "-", "--format", "svg")):
            tap.contains(asdic("render", run, "--raw", "--beam", "down", *vector).check(code=2, out="").err, "PNG")
        os.symlink("/dev/full", folder / "full")  # a link: no slip may replace the device itself
        asdic("render", run, "--images", "waterfall", "--beam", "down", "-o",
              folder / "full").check(code=1)
        tap.equal(pictures(folder, "r"), names, "pictures of the run")


def test_videos_last_as_long_as_their_runs():
    """At 1 to 60 frames a second, which players take."""
    for ping_hz, frame_hz in (20, 20), (80, 60), (0.5, 1):
        with Folder() as folder:
            run = run_of(folder, pings=3, edits={"ping_rate_hz: 20": f"ping_rate_hz: {ping_hz}\n  max_range_m: 9",
                                                 "[waterfall, ascope, fan]": "[]"})
            os.makedirs(folder / "bin")
            folder.write("bin/ffmpeg", '#!/bin/sh\necho "$@" >"$0.args"\nexit 3\n')
            os.chmod(folder / "bin/ffmpeg", 0o755)
            done = asdic("render", run, "--video", "v.mp4", "--images", "ascope", cwd=folder.path, PATH=folder / "bin")
            if "cairo" in done.err:
                raise tap.Skip("built without cairo")
            done.check(code=1)
            tap.contains(folder.read("bin/ffmpeg.args"), f" -framerate {frame_hz}000/1000 ")


def test_a_video_shows_fans_and_leaves_no_parts():
    with Folder() as folder:
        run = run_of(folder, pings=2)
        if "ascope_0.png" not in pictures(folder, "r"):
            raise tap.Skip("built without cairo")
        before = sorted(os.listdir(folder.path))
        for images, code, why in (("waterfall", 2, "--video is of '--images fan'"),
                                  ("fan", 2, "three beams or more"), ("ascope", 1, "did not write")):
            # An ffmpeg that fails; the run's two beams are no fan.
            os.makedirs(folder / "bin", exist_ok=True)
            folder.write("bin/ffmpeg", '#!/bin/sh\necho "$@" >"$0.args"\nexit 3\n')
            os.chmod(folder / "bin/ffmpeg", 0o755)
            tap.contains(asdic("render", run, "--video", folder / "v.mp4", "--images", images,
                               PATH=folder / "bin").check(code=code).err, why)
        asdic("render", run, "--video", "x:1.mp4", "--images", "ascope", cwd=folder.path,
              PATH=folder / "bin").check(code=1)
        tap.contains(folder.read("bin/ffmpeg.args"), " file:x:1.part.mp4\n")  # a colon begins no protocol
        tap.equal(sorted(set(os.listdir(folder.path)) - {"bin"}), before, "nothing is left")
        # One that keeps what it gets.
        folder.write("bin/ffmpeg", '#!/bin/sh\nfor last; do :; done\nexec /bin/cat >"${last#file:}"\n')
        asdic("render", run, "--video", folder / "v.mp4", "--images", "ascope",
              PATH=folder / "bin").check(code=0, out="")
        tap.equal(data(folder, "", "v.mp4").count(b"\x89PNG\r\n"), 2, "pictures of two pings")
        tap.equal(sorted(set(os.listdir(folder.path)) - {"bin", "v.mp4"}), before, "no part is left")
        os.remove(folder / "v.mp4")
        shutil.rmtree(folder / "r")
        fan = "  receivers:\n    fan: {count: 12, sector_deg: 90, length_h_m: 0.1, length_v_m: 0.05}"
        run_of(folder, pings=2, edits={"  receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                                       fan})
        if not shutil.which("ffmpeg") or not shutil.which("ffprobe"):
            raise tap.Skip("no ffmpeg")
        asdic("render", run, "--video", folder / "v.mp4").check(code=0, out="")
        tap.equal(tool("ffprobe", "-v", "error", "-count_frames", "-show_entries", "stream=nb_read_frames",
                       "-of", "csv=p=0", "v.mp4", cwd=folder.path).strip(), "2", "frames")


def test_a_video_is_a_file_with_an_ending():
    for name in "-", "", "video", "a.b/video", "video.":
        done = asdic("render", "nowhere", "--video", name).check(code=2, out="")
        tap.contains(done.err, f"--video '{name}': a file, by whose ending ffmpeg knows")


def test_a_video_has_a_frame_for_each_ping():
    with Folder() as folder:
        run = run_of(folder)
        if "ascope_0.png" not in pictures(folder, "r"):
            raise tap.Skip("built without cairo")
        names = pictures(folder, "r")
        done = asdic("render", run, "--video", folder / "v.mp4", "--images", "ascope",
                     PATH=folder.path).check(code=1)
        tap.contains(done.err, "a video needs ffmpeg")
        asdic("render", run, "--video", folder / "v.mp4", "--ping", "1").check(code=2)
        done = asdic("render", run, "--video", folder / "v.mp4", "--images", "fan").check(code=2)
        tap.contains(done.err, "error: none of the pictures asked for can be drawn of this run")
        tap.lacks(done.err, "ffmpeg")
        if not shutil.which("ffmpeg") or not shutil.which("ffprobe"):
            raise tap.Skip("no ffmpeg")
        asdic("render", run, "--video", folder / "v.mp4", "--images", "ascope").check(code=0, out="")
        facts_of = tool("ffprobe", "-v", "error", "-count_frames", "-show_entries",
                        "stream=nb_read_frames,r_frame_rate", "-of", "csv=p=0", "v.mp4",
                        cwd=folder.path)
        tap.equal(facts_of.strip(), "20/1,4", "frames a second, frames")
        tap.contains(asdic("render", run, "--video", folder / "v.mp4", "--images",
                           "ascope").check(code=1).err, "--force")
        tap.equal(pictures(folder, "r"), names, "pictures of the run")


def test_ascope_says_how_many_beams_it_leaves_out():
    with Folder() as folder:
        more = "".join(f"\n    - {{name: more{i}, pitch_deg: {9 * i}}}" for i in range(3))
        down = "    - {name: down, pitch_deg: 45}"
        run_of(folder, pings=1, edits={down: down + more})
        tap.contains(data(folder, "r", "ascope_0.png").decode("latin-1"), "t = 0 s, 4 of 5 beams")


def test_beams_that_look_down_make_a_section():
    with Folder() as folder:
        run_of(folder, pings=2, edits={"  receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                                       "  receivers: {fan: {count: 13, sector_deg: 120, pitch_deg: 90}}"})
        found = pictures(folder, "r")
        for name in ("fan_0.png", "fan_1.png", "waterfall_006.png"):
            if name not in found:
                raise AssertionError((name, found))


def test_beams_straight_down_make_no_fan():
    """Their yaws ascend, and turn them about their own axis."""
    with Folder() as folder:
        beams = "".join(f"\n    - {{name: b{i}, pitch_deg: 90, yaw_deg: {20 * i - 40}}}" for i in range(5))
        run_of(folder, pings=1, edits={"\n    - {name: forward}\n    - {name: down, pitch_deg: 45}": beams})
        tap.equal([name for name in pictures(folder, "r") if name.startswith("fan_")], [], "fan pictures")
        done = asdic("render", folder / "r", "--images", "fan").check(code=2)
        tap.contains(done.err, "no fan picture: it needs three beams or more in the order of their bearings")
        tap.contains(done.err, "error: ")
        asdic("render", folder / "r", "--images", "fan,ascope").check(code=0)


def test_rings_of_fans_lie_at_their_ranges():
    with Folder() as folder:
        run = run_of(folder, edits={"receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                                    "receivers: {fan: {count: 9, sector_deg: 90, length_h_m: 0.1}}"})
        if not any(name.startswith("fan") for name in pictures(folder, "r")):
            raise tap.Skip("built without cairo")
        svg = render_bytes(run, "--images", "fan", "--ping", "0", "--format", "svg").decode()
        drawn = re.findall(r'stroke:rgb\(54\.5[^"]*" d="M ([\d.]+) ([\d.]+) ([CL])', svg)
        lines = [(float(x), float(y)) for x, y, kind in drawn if kind == "L"]
        sonar = max(lines, key=lines.count)  # both edges of the sector begin there
        radii = [math.dist(sonar, (float(x), float(y))) for x, y, kind in drawn if kind == "C"]
        said = facts(folder, "r")
        reach_m = said["bins"] * said["bin_length_m"]
        tap.equal(len(radii) > 2 and radii[0] > 300, True, f"the outermost, then the others: {radii}")
        metres = [radius * reach_m / radii[0] for radius in radii[1:]]
        tap.equal([m for k, m in enumerate(metres, 1) if abs(m - k * round(metres[0])) > 0.05], [], f"rings at {metres}")


def test_an_overview_names_up_to_sixteen_beams():
    """More of them have numbers on an axis."""
    words = {}
    for beams in 16, 17:
        with Folder() as folder:
            run = run_of(folder, pings=2, edits={
                "fan]": "overview]", "    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                f"    fan: {{count: {beams}, sector_deg: 90}}"})
            if "overview.png" not in pictures(folder, "r"):
                raise tap.Skip("built without cairo")
            svg = render_bytes(run, "--images", "overview", "--format", "svg").decode()
            words[beams] = len(svg_marks(svg)[1])
    tap.equal(words[16] >= words[17] + 8, True, f"{words} words")


def test_vector_pictures():
    with Folder() as folder:
        run = run_of(folder, edits={"fan]": "fan, overview, plan]"})
        if "plan.png" not in pictures(folder, "r"):
            raise tap.Skip("built without cairo")
        stems = [name[:-4] for name in pictures(folder, "r")]
        sha256 = facts(folder, "r")["scene"]["sha256"].encode()
        asdic("render", run, "--format", "pdf").check(code=0)
        asdic("render", run, "--format", "svg").check(code=0)
        for stem in stems:
            content = data(folder, "r", stem + ".pdf")
            tap.equal((content[:5], b"%%EOF" in content[-8:], sha256 in content),
                      (b"%PDF-", True, True), stem)
            if not re.search(rb"/Keywords \((\w+: [^;)]+; )*\w+: [^;)]+\)", content):
                raise AssertionError(f"{stem}: no keywords")
            said = png_texts(data(folder, "r", stem + ".png"))
            if said["Title"].isascii():
                tap.equal(f"/Title ({said['Title']})".encode() in content, True, f"{stem}: {said['Title']}")
            if stem == "waterfall_down":
                for key in ("db_low", "db_high"):
                    tap.contains(content.decode("latin-1"), f"{key}: {said[key]}")
            root = xml.etree.ElementTree.fromstring(data(folder, "r", stem + ".svg"))
            tap.equal(root.tag, "{http://www.w3.org/2000/svg}svg", stem)
            check_layout(data(folder, "r", stem + ".svg").decode(), stem)
        root = xml.etree.ElementTree.fromstring(
            render_bytes(run, "--images", "plan", "--format", "svg"))
        tap.equal(root.tag, "{http://www.w3.org/2000/svg}svg", "on standard output")
        # Pictures in any format go when the run is replaced.
        asdic("run", folder / "pool.yaml", "-o", run, "--force").check(code=0)
        tap.equal([n for n in os.listdir(run) if n.endswith((".pdf", ".svg"))], [], "left over")


SVG = """
import csv, io, re
import numpy as np
text = open("x.svg").read()
paths = []  # colour, closed, corners
for style, d in re.findall(r'<path style="([^"]*)" d="([^"]*)"', text):
    found = re.search(r"stroke:rgb\\(([^)]*)\\)", style)
    if found:
        rgb = "".join("%02x" % round(2.55 * float(part[:-1])) for part in found[1].split(","))
        xy = np.array(re.findall(r"[ML] (\\S+) (\\S+)", d), float)
        paths.append((rgb, " Z" in d, xy))
"""


def test_ascopes_show_the_run():
    """Every curve of both beams, read from the vector picture: what was simulated, and what is expected."""
    with Folder() as folder:
        folder.write("way.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,5,5,-6,0\n0.1,1,0,8,5,-6,0\n")
        run = run_of(folder, pings=3, edits={
            "{name: down, pitch_deg: 45}": "{name: down, pitch_deg: 45, length_h_m: 0.2}",  # hears another noise
            "mission: {pose: {position_m: [0, 0, 5]}": f"mission: {{track: {folder / 'way.csv'}"})
        if "ascope_0.png" not in pictures(folder, "r"):
            raise tap.Skip("built without cairo")
        window = png_texts(data(folder, "r", "ascope_2.png"))
        low, high = float(window["db_low"]), float(window["db_high"])
        asdic("render", run, "--images", "ascope", "--ping", "2", "--tvg", "30", "-o", folder / "x.svg").check(code=0)
        folder.write("e.csv", asdic("expect", folder / "pool.yaml", "--ping", "2", "-o", "-", "-q").check(code=0).out)
        numpy(SVG + f"""
low, high = {low}, {high}
record = np.load("r/pings.npy")[2]
bins = record["level_db"].shape[1]
assert low < high and np.nanmax(np.load("r/pings.npy")["level_db"]) < high - 1.9
rows = list(csv.DictReader(open("e.csv")))
frames = sorted((xy for rgb, closed, xy in paths if closed and len(xy) == 5 and np.ptp(xy[:, 0]) > 800),
                key=lambda xy: xy[:, 1].min())
assert len(frames) == 3, len(frames)  # the last is that of the differences
wanted = {{"e69f00": "noise_db", "009e73": "volume_db", "56b4e9": "surface_db", "0072b2": "bottom_db",
          "b4b4b4": "total_db", "000000": "level_db", "d55e00": "object_db"}}
for beam, (name, frame) in enumerate(zip(("forward", "down"), frames)):
    (left, top), (right, bottom) = frame.min(0) + 0.5, frame.max(0) - 0.5
    for rgb, column in wanted.items():
        if column in ("level_db", "object_db"):
            levels = record[column][beam].astype(float)
        else:
            levels = np.array([float(row[column] or "nan") for row in rows if row["beam"] == name])
        curves = [xy for colour, _, xy in paths if colour == rgb]
        x = left + (np.arange(bins) + 0.5) / bins * (right - left)
        y = bottom - (levels - low) / (high - low) * (bottom - top)
        there = np.isfinite(y) & (y > top + 1) & (y < bottom - 1)
        assert there.sum() >= (2 if column == "object_db" else 5), (name, column, there.sum())
        off = [min((abs(np.interp(u, *xy.T) - v) for xy in curves if -0.1 < u - xy[0, 0] < 0.2 + np.ptp(xy[:, 0])),
                   default=np.inf) for u, v in zip(x[there], y[there])]
        assert max(off) < 0.7, (name, column, max(off))
""", folder / ".")


def test_a_plan_shows_where_lobes_meet_the_bottom():
    """At the first, the middle and the last ping of a vehicle that swims east, 45 degrees down: from near edge to far
    one, and of a head that scans, over its sector round the bow."""
    said = asdic("model", "sound-speed", "t_degc=10", "s_ppt=35", "z_m=5").check(code=0).out
    wave = float(re.search(r"[-+.0-9e]+(?= m.s)", said)[0]) / 1e5
    for scan, pings in ("", 5), ("  scan: {sector_deg: 90, step_deg: 6}\n", 31):
        with Folder() as folder:
            folder.write("way.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,5,0,0,90\n10,0,500,5,0,0,90\n")
            run = run_of(folder, pings=pings, edits={
                "receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                    "receivers: [{name: down, pitch_deg: 45, length_h_m: 0.1, length_v_m: 0.08}]\n" + scan,
                "mission: {pose: {position_m: [0, 0, 5]}": f"mission: {{track: {folder / 'way.csv'}",
                "fan]": "fan, plan]"})
            if "plan.png" not in pictures(folder, "r"):
                raise tap.Skip("built without cairo")
            asdic("render", run, "--images", "plan", "-o", folder / "x.svg", "--force").check(code=0)
            numpy(SVG + f"""
half_v, half_h = (np.degrees(np.arcsin(0.442946 * {wave} / length)) for length in (0.08, 0.1))
[track] = [xy for rgb, closed, xy in paths if rgb == "d55e00" and len(xy) == 2 and xy[0, 1] > 100]
areas = [xy for rgb, closed, xy in paths if rgb == "0072b2" and len(xy) > 20]
scale = (track[1, 0] - track[0, 0]) / (2.5 * {pings - 1})
assert abs(track[1, 1] - track[0, 1]) < 0.1 and len(areas) == 3, len(areas)
near, far = (7 / np.tan(np.radians(45 + sign * half_v)) for sign in (1, -1))
sector = {45 if scan else 0} + half_h / np.cos(np.radians(45))
for place, area in enumerate(areas):
    east = (area[:, 0] - track[0, 0]) / scale - 2.5 * ({pings - 1} // 2 * place)
    south = (area[:, 1] - track[0, 1]) / scale
    r, bearing = np.hypot(east, south), np.degrees(np.arctan2(south, east))
    assert abs(r.min() - near) < 0.05 * near and abs(r.max() - far) < 0.05 * far, (place, r.min(), near, r.max(), far)
    assert max(abs(abs(bearing.min()) - sector), abs(bearing.max() - sector)) < 2, (place, bearing, sector)
""", folder / ".")


tap.main(globals())
