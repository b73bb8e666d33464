"""asdic view: frames as video and as pictures, keys, recordings that replay, the window under Xvfb."""
import collections
import csv
import functools
import io
import json
import os
import shutil
import signal
import struct
import subprocess
import time

import program
import tap
from program import Folder, asdic
from run_folder import png_rows

SCENES = os.path.join(os.path.dirname(__file__), "..", "..", "data", "scenes")
SCENE = """version: 1
environment: {wind_speed_kn: 10}
bottom: {grid: {file: floor.asc, values: depths}, type: sand}
objects:
  - name: ball
    sphere: {radius_m: 0.7}
    track: ball.csv
    material: {impedance_mrayl: 45}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  ping_rate_hz: 20
  source_level_db: 200
  bin_length_m: 0.25
  speckle: rayleigh
  receivers: [{name: ahead}, {name: down, pitch_deg: 20}]
mission: {waypoints: {points_m: [[0, 0, 7], [40, 0, 8]], speed_mps: 2}}
sampling: {rays: 2048, seed: 5}
"""


def write_scene(folder):
    rows = [" ".join(f"{14 + 0.05 * ((3 * i + 5 * k) % 11):.2f}" for k in range(41)) for i in range(41)]
    folder.write("floor.asc", "ncols 41\nnrows 41\nxllcorner -40\nyllcorner -40\ncellsize 2\n" +
                 "\n".join(rows) + "\n")
    folder.write("ball.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                 "0,15,-3,9,0,0,0\n60,15,27,9,0,0,0\n")
    return folder.write("scene.yaml", SCENE)


def view(scene, *options, code=0, **env):
    return asdic("view", scene, *options, **env).check(code=code)


@functools.cache
def snapshot_of_one_ping():
    with Folder() as folder:
        return asdic("view", write_scene(folder), "--snapshot", "1", "--pings", "1", "-o", folder / "v")


def need_view():
    program.need_device()
    done = snapshot_of_one_ping()
    if "needs cairo" in done.err:
        raise tap.Skip("built without cairo")
    done.check(code=0)


def colours(rows, x0, x1, y0, y1):
    """Different colours within a part of a picture; places are shares of its sides."""
    height, width = len(rows), len(rows[0]) // 3
    found = set()
    for row in rows[int(y0 * height):int(y1 * height)]:
        for x in range(int(x0 * width), int(x1 * width)):
            found.add(row[3 * x:3 * x + 3])
    return len(found)


def commonest(rows, x0, x1, y0, y1):
    """Share of the most frequent colour in a part of a picture: much of an empty panel."""
    height, width = len(rows), len(rows[0]) // 3
    part = [row[3 * x:3 * x + 3] for row in rows[int(y0 * height):int(y1 * height)]
            for x in range(int(x0 * width), int(x1 * width))]
    return collections.Counter(part).most_common(1)[0][1] / len(part)


def check_frame(rows, size):
    tap.equal((len(rows[0]) // 3, len(rows)), size, "size")
    parts = {"sonar": (0.05, 0.44, 0.1, 0.2, 60), "A-scope": (0.05, 0.48, 0.68, 0.95, 10),
             "chase": (0.52, 0.98, 0.1, 0.5, 1000), "plan": (0.52, 0.7, 0.6, 0.9, 60),
             "status": (0.76, 0.98, 0.6, 0.95, 20)}
    for name, (x0, x1, y0, y1, least) in parts.items():
        got = colours(rows, x0, x1, y0, y1)
        if got < least:
            raise AssertionError(f"{name}: {got} colours, {least} at least")


def test_snapshots_are_pictures_of_everything():
    need_view()
    with Folder() as folder:
        scene = write_scene(folder)
        view(scene, "--snapshot", "2", "--pings", "40", "--size", "960x540", "-o", folder / "v")
        tap.equal(sorted(os.listdir(folder / "v")), ["view_19.png", "view_39.png"])
        with open(folder / "v/view_39.png", "rb") as file:
            data = file.read()
        check_frame(png_rows(data), (960, 540))
        view(scene, "--snapshot", "1", "--pings", "40", "-o", folder / "v", code=1)  # exists
        view(scene, "--snapshot", "1", "--pings", "40", "--size", "960x540", "-o", folder / "v", "--force")
        with open(folder / "v/view_39.png", "rb") as file:
            tap.equal(file.read() == data, True, "the same ping gives the same bytes")


def test_snapshots_are_spread_over_the_pings():
    """The last one at the end; before the first ping each of them is looked for."""
    need_view()
    with Folder() as folder:
        ask = (write_scene(folder), "--snapshot", "3", "--pings", "10", "--size", "640x360", "-o", folder / "v")
        view(*ask)
        names = ["view_3.png", "view_6.png", "view_9.png"]
        tap.equal(sorted(os.listdir(folder / "v")), names)
        for name in names:
            for other in os.listdir(folder / "v"):
                os.remove(folder / f"v/{other}")
            folder.write(f"v/{name}", "mine")
            tap.contains(view(*ask, code=1).err, f"/{name}' exists")
            tap.equal((os.listdir(folder / "v"), folder.read(f"v/{name}")), ([name], "mine"), "what was there")


def test_snapshots_end_with_the_mission():
    """Of a mission of three pings no more are asked for, and what was not taken is told."""
    need_view()
    with Folder() as folder:
        write_scene(folder)
        folder.write("way.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,7,0,0,0\n0.1,0.2,0,7,0,0,0\n")
        scene = folder.write("scene.yaml", SCENE.replace(
            "waypoints: {points_m: [[0, 0, 7], [40, 0, 8]], speed_mps: 2}", "track: way.csv"))
        size = ("--size", "640x360")
        view(scene, "--snapshot", "1", "--pings", "20", *size, "-o", folder / "v")
        tap.equal(os.listdir(folder / "v"), ["view_2.png"])
        done = view(scene, "--snapshot", "4", "--pings", "20", "-o", folder / "w", code=2)
        tap.contains(done.err, "pings in the mission: 3")
        tap.lacks(done.err, "--pings gives more")
        done = view(scene, "--snapshot", "2", "--pings", "6", "--keys", "0:b", *size, "-o", folder / "x", code=1)
        tap.contains(done.err, "ended after 3 pings, with 1 of 2 frames")
        folder.write("way.csv", folder.read("way.csv").replace("\n0", "\n1000"))  # keys count from the first ping
        done = view(scene, "--snapshot", "1", "--keys", "0.1:q", *size, "-o", folder / "y", code=1)
        tap.contains(done.err, "ended after 2 pings, with 0 of 1 frames")


def test_few_rays_make_a_fan_of_coarser_bins_not_of_dashes():
    """The fan of 512 beams at the view's floor of rays beside one of ten times as many."""
    need_view()
    with Folder() as folder:
        fans = []
        for rays in 40960, 409600:
            view(os.path.join(SCENES, "sonar_m750d.yaml"), "--snapshot", "1", "--pings", "1", "--rays", rays,
                 "--db-range", "60:130", "--colormap", "gray", "-o", folder / str(rays))
            with open(folder / f"{rays}/view_0.png", "rb") as file:
                fans.append(png_rows(file.read()))
        # Bare sand to starboard of the box and the pile, 15 to 40 m away.
        few, many = ([row[3 * x] for row in fan[200:320] for x in range(340, 440)] for fan in fans)
        off = (sum((a - b) ** 2 for a, b in zip(few, many)) / len(many)) ** 0.5 * 70 / 255
        print(f"# {off:.2f} dB r.m.s.")
        tap.equal(off < 0.8, True, f"{off:.2f} dB r.m.s. between the pictures")


def test_a_scan_is_renewed_turn_by_turn():
    """Half a turn shows one side alone; what was recorded meanwhile runs again to the byte."""
    need_view()
    with Folder() as folder:
        write_scene(folder)
        scene = folder.write("scene.yaml", SCENE.replace(
            "receivers: [{name: ahead}, {name: down, pitch_deg: 20}]",
            "scan: {step_deg: 9}\n  receivers: [{name: head}]"))
        view(scene, "--snapshot", "2", "--pings", "40", "--size", "960x540", "-o", folder / "rec",
             "--keys", "0:r")
        frames = []
        for ping in (19, 39):
            with open(folder / f"rec/view_{ping}.png", "rb") as file:
                frames.append(png_rows(file.read()))
        port, starboard = (0.14, 0.20, 0.2, 0.45), (0.26, 0.31, 0.2, 0.45)
        seen = [[commonest(frame, *side) < 0.3 for side in (port, starboard)] for frame in frames]
        tap.equal(seen, [[True, False], [True, True]], "sides that the picture shows")
        same_bytes(folder, 0)
        with open(folder / "rec/000/track.csv", encoding="utf-8") as file:
            heads = [float(row["head_deg"]) for row in csv.DictReader(file)]
        tap.equal(heads[:3], [-180, -171, -162], "the head's angles")


def test_video_is_read_by_ffmpeg():
    need_view()
    if not shutil.which("ffmpeg"):
        raise tap.Skip("there is no ffmpeg")
    with Folder() as folder:
        scene = write_scene(folder)
        shown = subprocess.Popen([program.PATH, "view", scene, "--y4m", "-", "--pings", "12", "--size",
                                  "640x360"], stdout=subprocess.PIPE)
        read = subprocess.run(["ffmpeg", "-v", "error", "-f", "yuv4mpegpipe", "-i", "-", "-f", "image2",
                               "-pix_fmt", "rgb24", folder / "frame_%02d.png"], stdin=shown.stdout,
                              capture_output=True, check=False)
        shown.stdout.close()
        tap.equal((shown.wait(), read.returncode, read.stderr.decode()), (0, 0, ""))
        frames = [name for name in folder.names() if name.startswith("frame_")]
        tap.equal(len(frames), 12, "frames")
        view(scene, "--snapshot", "1", "--pings", "12", "--size", "640x360", "-o", folder / "v")
        with open(folder / frames[-1], "rb") as file:
            rows = png_rows(file.read())
        with open(folder / "v/view_11.png", "rb") as file:
            same = png_rows(file.read())
        # The video holds what the picture holds, up to the rounding of colours.
        worst = max(abs(a - b) for x, y in zip(rows, same) for a, b in zip(x, y))
        tap.equal(worst <= 4, True, f"differs by {worst}")
        data = subprocess.run([program.PATH, "view", scene, "--y4m", "/dev/stdout", "--pings", "1"],
                              capture_output=True, check=True).stdout
        head, rest = data.split(b"\n", 1)
        tap.equal(head, b"YUV4MPEG2 W1280 H720 F20:1 Ip A1:1 C444 XCOLORRANGE=LIMITED")
        tap.equal(len(rest), 6 + 3 * 1280 * 720)


def test_a_video_appears_whole():
    need_view()
    with Folder() as folder:
        scene = write_scene(folder)
        film = folder.write("film.y4m", "a film")
        options = ["view", scene, "--y4m", film, "--force", "--size", "640x360", "-q"]
        for sign, code in (signal.SIGINT, 130), (signal.SIGKILL, -signal.SIGKILL):
            shown = subprocess.Popen([program.PATH, *options, "--pings", "1000000", "--keys", "0:left"])
            try:
                late_s = time.monotonic() + 60
                while not os.path.exists(film + ".part") or os.path.getsize(film + ".part") < 700000:
                    tap.equal((shown.poll(), time.monotonic() < late_s), (None, True), "under way")
                    time.sleep(0.01)
                if sign == signal.SIGINT:
                    tap.contains(asdic(*options, "--pings", "1").check(code=1).err,
                                 "film.y4m': another process is writing it just now")
                shown.send_signal(sign)
                tap.equal(shown.wait(), code)
            finally:
                shown.kill()
                shown.wait()
            tap.equal(folder.read("film.y4m"), "a film")
            tap.equal(os.path.exists(film + ".part"), sign == signal.SIGKILL, "removed by SIGINT")
        folder.write("film.y4m.part", "left by a killed view, longer than a frame" * 20000)
        asdic(*options, "--pings", "1").check(code=0)
        with open(film, "rb") as file:
            tap.equal(len(file.read().split(b"\n", 1)[1]), 6 + 3 * 640 * 360, "bytes of a frame")
        tap.equal(os.path.exists(film + ".part"), False, "renamed")
        os.mkfifo(folder / "pipe")
        with open(folder / "through", "wb") as file, subprocess.Popen(["cat", folder / "pipe"], stdout=file):
            view(scene, "--y4m", folder / "pipe", "--pings", "1", "--size", "640x360")
        with open(film, "rb") as one, open(folder / "through", "rb") as other:
            tap.equal(one.read() == other.read(), True, "frames through a pipe")
        tap.contains(view(scene, "--y4m", "/dev/full", "--pings", "1", code=1).err,
                     "cannot write '/dev/full': No space left on device")


def same_file(part, again, name):
    with open(f"{part}/{name}", "rb") as one, open(f"{again}/{name}", "rb") as other:
        tap.equal(one.read() == other.read(), True, f"{part}/{name} is the same")


def same_bytes(folder, number):
    """A recording's run, and the run of its scene."""
    part = folder / f"rec/{number:03d}"
    tap.equal({"scene.yaml", "track.csv", "bins.csv", "pings.npy", "run.json"} <= set(os.listdir(part)),
              True, f"files of {number:03d}")
    again = folder / f"again{number}"
    asdic("run", f"{part}/scene.yaml", "-o", again).check(code=0)
    for name in ("bins.csv", "pings.npy", "track.csv"):
        same_file(part, again, name)
    facts = []
    for run in part, again:
        with open(f"{run}/run.json", encoding="utf-8") as file:
            facts.append(json.load(file))
    tap.equal(facts[0]["devices"], facts[1]["devices"], "devices")
    return facts[0]


def test_recordings_replay_to_the_same_bytes():
    need_view()
    with Folder() as folder:
        scene = write_scene(folder)
        keys = ("0.2:r,0.4:up,0.5:right,0.5:right,0.7:pagedown,1.3:h,1.5:p,1.5:4,1.6:l,1.7:m,2.3:left,"
                "2.5:r,2.6:a")
        done = view(scene, "--y4m", "/dev/null", "--pings", "70", "--size", "640x360", "-o",
                    folder / "rec", "--keys", keys)
        tap.equal(done.out, "")
        numbers = sorted(os.listdir(folder / "rec"))
        # Recording began; then wind with bottom, source level, and rays were changed.
        tap.equal(numbers, ["000", "001", "002", "003"])
        pings = []
        for number in range(4):
            facts = same_bytes(folder, number)
            pings.append(facts["pings"])
        tap.equal(sum(pings), 46, f"pings from 0.2 s to 2.5 s: {pings}")
        with open(folder / "rec/003/scene.yaml", encoding="utf-8") as file:
            text = file.read()
        for line in ("wind_speed_kn: 15", "type: 4", "source_level_db: 205", "rays: 4096", "seed: 5",
                     'track: "track.csv"', "terms: all"):
            tap.contains(text, line)
        with open(folder / "rec/003/track.csv", encoding="utf-8") as file:
            track = list(csv.DictReader(file))
        with open(folder / "rec/000/track.csv", encoding="utf-8") as file:
            first = next(csv.DictReader(file))
        if not (float(track[-1]["yaw_deg"]) > 5 and float(track[-1]["z_m"]) > float(first["z_m"]) + 0.1):
            raise AssertionError((first, track[-1]))  # it turned to starboard, and dived
        rows = list(csv.DictReader(io.StringIO(folder.read("rec/003/bins.csv"))))
        tap.equal(len(rows), pings[3] * 2 * len({row["bin"] for row in rows}))


def test_recordings_have_truth_and_pressures():
    """Where the scene's output has them: those of the run again."""
    need_view()
    with Folder() as folder:
        write_scene(folder)
        array = """version: 1
bottom: {depth_m: 12, type: sand}
sonar:
  frequency_khz: 100
  bandwidth_khz: 10
  source_level_db: 200
  bin_length_m: 0.3
  max_range_m: 20
  array: {elements: 8, beams: {count: 4, sector_deg: 90}}
mission: {waypoints: {points_m: [[0, 0, 5], [4, 0, 5]], speed_mps: 2}}
sampling: {coherent: true, rays: 2000}
output: {elements: true}
"""
        # A run that plans would take one layer for two.
        bent = SCENE.replace("wind_speed_kn: 10", "sound_speed_profile: [[0, 1500], [8, 1496], [16, 1491.99]]")
        for name, text in (("truth", bent + "output: {truth: true}\n"), ("elements", array)):
            out = folder / name
            view(folder.write("scene.yaml", text), "--y4m", "/dev/null", "--pings", "4", "--size", "640x360", "-o", out,
                 "--keys", "0:r")
            asdic("run", f"{out}/000/scene.yaml", "-o", f"{out}/again").check(code=0)
            same_file(f"{out}/000", f"{out}/again", f"{name}.npy")
            same_file(f"{out}/000", f"{out}/again", "pings.npy")


def test_recordings_replay_what_moves_alone():
    """Where no ground holds the origin: whatever has moved, and turned, before the recording."""
    need_view()
    with Folder() as folder:
        write_scene(folder)
        folder.write("ball.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
                     "-5,15,-4,9,0,0,0\n60,17,27,8,40,300,70\n")
        ground = "bottom: {grid: {file: floor.asc, values: depths}, type: sand}"
        box = '  - {name: box, box: {size_m: [1, 2, 0.7]}, position_m: [12, 3, 9], material: {impedance_mrayl: 45}}\n'
        for number, objects in enumerate(("objects:\n", "objects:\n" + box)):
            text = SCENE.replace(ground, "bottom: {depth_m: 14}").replace("objects:\n", objects)
            out = folder / f"rec{number}"
            view(folder.write("scene.yaml", text), "--y4m", "/dev/null", "--pings", "24", "--size", "640x360", "-o", out,
                 "--keys", "1:r")
            asdic("run", f"{out}/000/scene.yaml", "-o", f"{out}/again").check(code=0)
            same_file(f"{out}/000", f"{out}/again", "pings.npy")


def test_keys_and_mistakes():
    with Folder() as folder:
        scene = write_scene(folder)
        for options in (["--y4m", "-", "--snapshot", "1"], ["--size", "12"], ["--colormap", "jet"],
                        ["--snapshot", "0"], ["--snapshot", "1", "--db-range", "5:1"]):
            view(scene, *options, code=2)
        for size in "-1x720", "1280x-1", " 640x360", "640x 360", "640x360p", "1e3x720":
            tap.contains(view(scene, "--y4m", "-", "--size", size, code=2).err, f"'{size}' is not WIDTHxHEIGHT")
        program.need_device()
        for keys in ("up", "1:nokey", "x:up", "2:up,1:up", "1:", "0:space", "0:up,0:."):
            view(scene, "--snapshot", "1", "--keys", keys, "-o", folder / "v", code=2)
        tap.contains(view(scene, "--snapshot", "1", "--keys", "1:pgdn", "-o", folder / "v", code=2).err,
                     "there is no key 'pgdn'; the keys are up down left right x pageup pagedown h a space . r b g v c "
                     "t [ ] - = o p 1 2 3 4 k l n m q\n")
        view(scene, "--snapshot", "9", "--pings", "3", "-o", folder / "v", code=2)
        view(scene, "--y4m", folder / "no/such", code=1)
        kept = folder.write("kept.y4m", "a film")
        tap.contains(view(scene, "--y4m", kept, code=1).err, "kept.y4m' exists; --force overwrites it")
        tap.equal(folder.read("kept.y4m"), "a film")
        view(scene, "--y4m", "-", "--size", "100x100", code=2)
        view("nowhere.yaml", "--y4m", "-", code=3)


class Display:
    """An X server of one's own; skips where there is none."""

    def __enter__(self):
        for tool in ("Xvfb", "xdotool", "ffmpeg"):
            if not shutil.which(tool):
                raise tap.Skip(f"there is no {tool}")
        out, number = os.pipe()
        self.server = subprocess.Popen(["Xvfb", "-displayfd", str(number), "-screen", "0",
                                        "1000x600x24", "-nolisten", "tcp"], pass_fds=[number],
                                       stderr=subprocess.DEVNULL)
        os.close(number)
        with os.fdopen(out) as file:
            self.name = ":" + file.readline().strip()
        return self

    def __exit__(self, *_):
        self.server.terminate()
        self.server.wait()

    def tool(self, *words):
        done = subprocess.run(["xdotool", *words], env=program.environment({"DISPLAY": self.name}),
                              capture_output=True, text=True, check=False)
        return done.stdout.strip()

    def screenshot(self, path):
        subprocess.run(["ffmpeg", "-v", "error", "-y", "-f", "x11grab", "-video_size", "1000x600", "-i",
                        self.name, "-frames:v", "1", "-pix_fmt", "rgb24", path], check=True)
        with open(path, "rb") as file:
            return png_rows(file.read())


def wait_for(what, answer, seconds=60):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        value = answer()
        if value:
            return value
        time.sleep(0.1)
    raise AssertionError(f"no {what} in {seconds} s")


def test_without_a_display_it_says_so():
    with Folder() as folder:
        done = asdic("view", write_scene(folder), DISPLAY=None, WAYLAND_DISPLAY=None, SDL_VIDEODRIVER=None)
        if "without SDL2" in done.err:
            raise tap.Skip("built without SDL2")
        tap.equal((done.code, done.out), (1, ""))
        tap.contains(done.err, "cannot open a display")
        tap.contains(done.err, "--y4m")


def test_a_window_says_why_it_closes():
    need_view()
    with Folder() as folder, Display() as display:
        write_scene(folder)
        scene = folder.write("scene.yaml", SCENE.replace("[40, 0, 8]", "[8, 0, 8]"))  # of 4 s
        done = asdic("view", scene, "--size", "960x540", DISPLAY=display.name,
                     SDL_VIDEODRIVER="x11", ASAN_OPTIONS="detect_leaks=0")
        if "without SDL2" in done.err:
            raise tap.Skip("built without SDL2")
        done.check(code=0)
        tap.contains(done.err, "the mission is flown after ")
        done = asdic("view", scene, "--size", "960x540", "--keys", "0.2:up", "--pings", "100", SDL_VIDEODRIVER="dummy",
                     ASAN_OPTIONS="detect_leaks=0").check(code=0)
        tap.contains(done.err, "closed after 100 pings")  # steered, and longer than the mission is


def test_the_window_is_driven_by_keys():
    need_view()
    with Folder() as folder, Display() as display:
        scene = write_scene(folder)
        child = subprocess.Popen([program.PATH, "view", scene, "--size", "960x540", "-o", folder / "rec"],
                                 # Mesa and D-Bus keep what they took until the end.
                                 env=program.environment({"DISPLAY": display.name,
                                                          "SDL_VIDEODRIVER": "x11",
                                                          "ASAN_OPTIONS": "detect_leaks=0"}),
                                 stderr=subprocess.PIPE, text=True)
        time.sleep(1.0)
        if child.poll() is not None and "without SDL2" in child.stderr.read():
            raise tap.Skip("built without SDL2")
        number = wait_for("window", lambda: display.tool("search", "--name", "asdic").split("\n")[0])
        title = lambda: display.tool("getwindowname", number)
        wait_for("ping", lambda: "20 pings/s" in title())
        tap.contains(title(), "scene")
        if not ("real time" in title() or "stretched" in title()):
            raise AssertionError(title())
        before = display.screenshot(folder / "one.png")
        if colours(before, 0.1, 0.9, 0.1, 0.9) < 1500:
            raise AssertionError("the window is empty")
        display.tool("windowfocus", number)
        for key in ("r", "Up", "Right", "Right", "c", "n", "space"):
            display.tool("key", "--window", number, key)
            time.sleep(0.4)
        wait_for("fewer rays", lambda: "1,024 rays" in title())
        paused = display.screenshot(folder / "two.png")
        time.sleep(0.5)
        tap.equal(display.screenshot(folder / "three.png") == paused, True, "nothing moves while paused")
        display.tool("key", "--window", number, "period")
        wait_for("single ping", lambda: display.screenshot(folder / "three.png") != paused, 10)
        for key in ("r", "space", "q"):
            display.tool("key", "--window", number, key)
            time.sleep(0.4)
        err = child.stderr.read()
        tap.equal(child.wait(timeout=60), 0, err)
        tap.contains(err, "closed after ")
        for number in range(len(os.listdir(folder / "rec"))):
            same_bytes(folder, number)
        tap.equal(len(os.listdir(folder / "rec")) >= 2, True, "recordings")


tap.main(globals())
