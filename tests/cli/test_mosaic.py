"""Mosaics of fans: where they lie, what their cells hold."""
import math
import os
import re
import shutil

import program
import tap
from foreign import numpy, tool
from pool import run_of
from program import Folder, asdic
from run_folder import data, facts, png_texts


def mosaic_of(folder, receivers, pings):
    """The run of so many pings with those RECEIVERS, and m.png beside it in cells of half a metre."""
    run = run_of(folder, pings=pings, edits={
        "  receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}": f"  receivers: {receivers}"})
    asdic("render", run, "--mosaic", folder / "m.png", "--cell", "0.5").check(code=0, out="")
    return run


def test_a_mosaic_lies_where_it_says():
    """A ball 20 m north of a vehicle that looks north: the brightest place of its floor."""
    with Folder() as folder:
        run = mosaic_of(folder, "{fan: {count: 64, sector_deg: 90, length_h_m: 0.5, length_v_m: 0.05}}", pings=2)
        world = [float(line) for line in data(folder, "", "m.pgw").decode().split()]
        reach = facts(folder, "r")["bins"]
        ways = [0.25 + 0.5 * k - reach for k in range(4 * reach)]  # to places, by their rows and columns
        seen = [(north, east) for north in ways for east in ways
                if north > abs(east) and math.hypot(north, east, 7) < reach]
        tap.equal(world, [0.5, 0, 0, -0.5, min(east for _, east in seen), max(north for north, _ in seen)], "world file")
        said = png_texts(data(folder, "", "m.png"))
        low, high = float(said["db_low"]), float(said["db_high"])
        tap.equal((low % 10, high % 10, low < high), (0, 0, True), f"window {low} to {high} dB")
        asdic("render", run, "--mosaic", folder / "gain.png", "--tvg", "20", "--colormap", "gray").check(code=0)
        given = png_texts(data(folder, "", "gain.png"))
        tap.equal((said["colormap"], given["colormap"]), ("viridis", "gray"))
        tap.equal(said["gain"].replace("30 log", "20 log"), given["gain"], "gain")
        tap.contains(asdic("render", run, "--mosaic", folder / "m.png").check(code=1).err, "--force")
        os.remove(folder / "m.png")  # the world file alone: as much someone's as the picture
        tap.contains(asdic("render", run, "--mosaic", folder / "m.png").check(code=1).err, "'%s' exists; --force" %
                     (folder / "m.pgw"))
        tap.equal("m.png" in folder.names(), False, "a mosaic beside another's world file")
        os.mkdir(folder / "r.1")  # a name's ending is not its folder's
        asdic("render", run, "--mosaic", folder / "r.1/a", "--cell", "0.5").check(code=0, out="")
        tap.equal(sorted(os.listdir(folder / "r.1")), ["a", "a.pgw"], "a mosaic in a folder with a point")
        asdic("render", run, "--mosaic", folder / "m.png", "--cell", "0.5", "--force").check(code=0, out="")
        if not shutil.which("gdallocationinfo"):
            raise tap.Skip("no gdal")
        def brightness(east, north):
            text = tool("gdallocationinfo", "-valonly", "-geoloc", "m.png", str(east), str(north),
                        cwd=folder.path)
            return sum(map(int, text.split()))
        if brightness(-15, 2) != 3 * 255:
            raise AssertionError("abeam of the vehicle nothing was seen")
        if brightness(0, 19.2) <= brightness(6, 19.2):
            raise AssertionError("the ball is brighter than the floor beside it")


def test_a_mosaic_is_the_mean_of_its_pings():
    """Cell by cell: the mean of the intensities, with gain, of the bins that lie there, of pings under way on two
    headings, rolled and pitched. The beams of a fan in one plane are bearings in that plane, those of a cone about
    the sonar's z axis; of a level fan these are the same."""
    for pitch_deg, shape in (0, "plane"), (30, "plane"), (30, "cone"):
        check_mean(pitch_deg, shape, "{fan: {count: 12, sector_deg: 96, pitch_deg: %d, shape: %s, length_h_m: 0.2, "
                   "length_v_m: 0.02}}" % (pitch_deg, shape))


def test_a_mosaic_of_beams_from_starboard_to_port():
    """Is the mean of its pings as well. Of uneven beams one is half round to port of the middle one in the list: it
    is seen where one of the same beams from port to starboard is."""
    beam = "{yaw_deg: %g, length_h_m: 0.2, length_v_m: 0.02}"
    check_mean(0, "plane", "[" + ", ".join(beam % (44 - 8 * k) for k in range(12)) + "]", starboard_first=True)
    for bearings in (170, 160, 150, 140, -20, -60), (-60, -20, 140, 150, 160, 170):
        with Folder() as folder:
            receivers = "[" + ", ".join(beam % bearing for bearing in bearings) + "]"
            check_bearings(folder, receivers, [-178, -120, -85, -75, -41, -39, 59, 100, 144, 156, 174, 176],
                           [-75, -41, -39, 59, 100, 144, 156, 174])


def check_mean(pitch_deg, shape, receivers, starboard_first=False):
    tilt_deg = pitch_deg if shape == "plane" else 0
    with Folder() as folder:
        folder.write("way.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,3,26,5,6,-4,0\n0.05,3,28,4,6,-4,20\n"
                     "0.1,5,37,4,-8,5,110\n")
        run = run_of(folder, pings=3, edits={
            "  receivers:\n    - {name: forward}\n    - {name: down, pitch_deg: 45}":
                f"  receivers: {receivers}\n  max_range_m: 30",
            "mission: {pose: {position_m: [0, 0, 5]}": f"mission: {{track: {folder / 'way.csv'}"})
        asdic("render", run, "--mosaic", folder / "m.png", "--cell", "0.8", "--colormap", "gray").check(code=0, out="")
        said = asdic("model", "absorption", "t_degc=10", "s_ppt=35", "z_m=5", "ph=8", "f_khz=100").check(code=0).out
        alpha = float(re.search(r"[-+.0-9e]+(?= dB/km)", said)[0])
        texts = png_texts(data(folder, "", "m.png"))
        numpy(f"""
import numpy as np
from PIL import Image
pings, cell, reach = np.load("r/pings.npy"), 0.8, 30.0
assert len(pings) == 3 and pings["level_db"].shape[1:] == (12, 30), pings["level_db"].shape
x, y, z = pings["position_m"].T
south, west = x.min() - reach, y.min() - reach
rows, columns = int(np.ceil((x.max() + reach - south) / cell)), int(np.ceil((y.max() + reach - west) / cell))
north = south + (np.arange(rows)[::-1, None] + 0.5) * cell + np.zeros((rows, columns))
east = west + (np.arange(columns) + 0.5) * cell + np.zeros((rows, columns))
total, count, clear = np.zeros((rows, columns)), np.zeros((rows, columns), int), np.ones((rows, columns), bool)
for p in pings:
    way = np.stack([north - p["position_m"][0], east - p["position_m"][1],
                    np.full((rows, columns), 12.0 - p["position_m"][2])], axis=-1)
    r = np.linalg.norm(way, axis=-1)
    roll, pitch, yaw = p["attitude_rad"]
    ahead = np.array([np.cos(yaw) * np.cos(pitch), np.sin(yaw) * np.cos(pitch), -np.sin(pitch)])
    level = np.array([-np.sin(yaw), np.cos(yaw), 0.0])  # to starboard, before the roll
    starboard = np.cos(roll) * level + np.sin(roll) * np.cross(ahead, level)
    tilt = np.radians({tilt_deg})
    ahead = np.cos(tilt) * ahead + np.sin(tilt) * np.cross(ahead, starboard)
    beam = (np.degrees(np.arctan2(way @ starboard, way @ ahead)) + 48.0) / 8.0
    seen = (r < reach) & (beam > 0) & (beam < 12)
    clear &= (abs(r - np.rint(r)) > 1e-4) & (abs(beam - np.rint(beam)) > 1e-4)
    levels = p["level_db"][::{-1 if starboard_first else 1}].astype(float)
    db = levels[np.clip(beam, 0, 11).astype(int), np.clip(r, 0, 29).astype(int)]
    seen &= np.isfinite(db)
    total += np.where(seen, 10 ** (0.1 * (db + 30 * np.log10(r) + 2 * {alpha} * r / 1000)), 0.0)
    count += seen
assert (count > 1).sum() > 500, np.bincount(count.ravel())
with np.errstate(all="ignore"):
    shown = 10 * np.log10(total / count)
ordered = np.sort(shown[count > 0])
low, high = 10 * np.floor(ordered[len(ordered) // 20] / 10), 10 * np.ceil(ordered[len(ordered) * 995 // 1000] / 10)
assert (low, high) == ({texts["db_low"]}, {texts["db_high"]}), (low, high)
picture = np.array(Image.open("m.png").convert("RGB")).astype(int)
wanted = np.where(count > 0, 255 * np.clip((shown - low) / (high - low), 0, 1), 255)
box = tuple(slice(at.min(), at.max() + 1) for at in np.nonzero(count))  # the picture ends where nothing was seen
assert picture.shape == (*wanted[box].shape, 3) and wanted[box].size < 0.8 * count.size, picture.shape
off = abs(picture[..., 0] - wanted[box])[clear[box]]
assert clear.mean() > 0.95 and off.max() < 1.5, (clear.mean(), off.max(), (off > 1.5).mean())
""", folder / ".", "PIL")


def test_a_mosaic_goes_without_what_it_cannot_follow():
    """Before the run is looked at: there is none."""
    with Folder() as folder:
        for others in (("--mosaic", "m.png", "--beam", "down"), ("--mosaic", "m.png", "--ping", "1"),
                       ("--mosaic", "m.png", "--images", "plan"), ("--mosaic", "m.png", "--raw"),
                       ("--mosaic", "m.png", "--format", "png"), ("--mosaic", "m.png", "-o", "o.png"),
                       ("--mosaic", "m.png", "--video", "v.mp4"), ("--mosaic", "m.pdf"), ("--mosaic", "-"),
                       ("--cell", "1"), ("--cell", "1", "--video", "v.mp4")):
            tap.contains(asdic("render", "r", *others, cwd=folder.path).check(code=2, out="").err, "--mosaic")
        tap.equal(folder.names(), [], "files that were written")


def test_a_mosaic_of_a_fan_that_looks_astern():
    """Both halves of its floor, beyond 180 degrees as well."""
    with Folder() as folder:
        check_bearings(folder, "{fan: {count: 4, sector_deg: 120, yaw_deg: 180}}",
                       [0, 90, 115, 125, 150, 178, 182, 200, 235, 245, 270], [125, 150, 178, 182, 200, 235])


def check_bearings(folder, receivers, yaws, seen):
    """Of these places 20 m off those at SEEN were seen."""
    mosaic_of(folder, receivers, pings=1)
    places = "".join(f"{20 * math.sin(math.radians(y))} {20 * math.cos(math.radians(y))}\n" for y in yaws)
    out = tool("gdallocationinfo", "-valonly", "-b", "1", "-geoloc", "m.png", cwd=folder.path,
               stdin=places).splitlines()  # empty beyond the picture
    tap.equal([yaw for yaw, value in zip(yaws, out) if value not in ("", "255")], seen, "bearings that were seen")


STEP = """version: 1
bottom: {mesh: {file: step.ply}, type: sand}
objects:
  - {name: ball, sphere: {radius_m: 0.5}, position_m: [20, 0, 13.5], material: {impedance_mrayl: 45}}
sonar:
  frequency_khz: 300
  ping_rate_hz: 18
  source_level_db: 200
  bin_length_m: 0.25
  transmitter: {length_h_m: 0.004, length_v_m: 0.006}
  receivers:
    fan: {count: 64, sector_deg: 90, length_h_m: 0.15, length_v_m: 0.006}
mission: {pose: {position_m: [0, 0, 10], roll_deg: 5, pitch_deg: -10}, pings: 2}
sampling: {rays: 20000}
output: {csv: none, images: []}
"""


def test_a_mosaic_lies_on_the_terrain():
    """A ball on a floor 4 m below a vehicle that flies 12 m above a lower one: its near side, 19.8 m
    away, lies 19.4 m north on the upper floor and would lie 15.7 m north on the lower one."""
    program.need_device()
    with Folder() as folder:
        corners = [(x, y, z) for y, z in ((-60, -22), (10, -22), (10, -14), (60, -14)) for x in (-60, 60)]
        sides = [(2 * i + a, 2 * i + b, 2 * i + c) for i in range(3) for a, b, c in ((0, 1, 3), (0, 3, 2))]
        folder.write("step.ply", "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\n"
                     "property float y\nproperty float z\nelement face 6\nproperty list uchar int "
                     "vertex_index\nend_header\n" + "".join("%g %g %g\n" % c for c in corners) +
                     "".join("3 %d %d %d\n" % s for s in sides))
        asdic("run", folder.write("step.yaml", STEP), "-o", folder / "r").check(code=0)
        asdic("render", folder / "r", "--mosaic", folder / "m.png", "--colormap", "gray").check(code=0, out="")
        norths = [16.5 + 0.25 * i for i in range(30)]
        places = "".join(f"{east} {north}\n" for east in (0, 3) for north in norths)
        out = tool("gdallocationinfo", "-valonly", "-b", "1", "-geoloc", "m.png", cwd=folder.path,
                   stdin=places)
        grey = list(map(int, out.split()))
        ball, beside = grey[:len(norths)], grey[len(norths):]
        bright = [n for n, g in zip(norths, ball) if g == max(ball)]
        if max(ball) <= max(beside) or not all(abs(n - 19.4) < 0.75 for n in bright):
            raise AssertionError((bright, ball, beside))


LINE = """version: 1
environment: {sound_speed_mps: 1500, wind_speed_kn: 0}
bottom: {depth_m: 12, type: mud}
objects:
  - {name: right, point: {target_strength_db: 20}, position_m: [8, 9, 11.9]}
  - {name: left, point: {target_strength_db: 20}, position_m: [10, -5, 11.9]}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  source_level_db: 200
  bin_length_m: 0.075
  max_range_m: 20
  transmitter: {length_h_m: 0.01, length_v_m: 0.01}
  array: {elements: 64, spacing_wl: 0.5, element: {length_v_m: 0.01}, beams: {count: 128, sector_deg: 120}}
mission: {pose: {position_m: [0, 0, 7], roll_deg: 4}, pings: 1}
sampling: {coherent: true, rays: 1000}
output: {csv: none, images: []}
"""


def test_a_mosaic_of_a_line_of_elements():
    """Its beams are cones about it: 20 degrees down and 48 aside a point is heard by the beam at 44 degrees. Laid as a fan of
    upright beams it would be 0.9 m off."""
    program.need_device()
    with Folder() as folder:
        asdic("run", folder.write("line.yaml", LINE), "-o", folder / "r").check(code=0)
        asdic("render", folder / "r", "--mosaic", folder / "m.png", "--cell", "0.1", "--colormap", "gray",
              "--db-range", "0:300").check(code=0, out="")
        for north, east in (8, 9), (10, -5):
            near = [(x / 10, y / 10) for x in range(-15, 16) for y in range(-15, 16)]
            out = tool("gdallocationinfo", "-valonly", "-b", "1", "-geoloc", "m.png", cwd=folder.path,
                       stdin="".join(f"{east + x} {north + y}\n" for x, y in near))
            levels = [0 if level == "255" else int(level) for level in out.split()]  # white: nothing was heard
            peak = [at for at, level in zip(near, levels) if level == max(levels)]
            middle = [sum(at[k] for at in peak) / len(peak) for k in (0, 1)]
            if math.hypot(*middle) > 0.2:
                raise AssertionError((north, east, middle, peak))


tap.main(globals())
