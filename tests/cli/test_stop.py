"""Commands that take long show how far they are, and end soon after a signal."""
import os
import pathlib
import shutil
import signal
import subprocess
import time

import program
import tap
from program import Folder, asdic

SCENES = os.path.join(os.path.dirname(__file__), "..", "..", "data", "scenes")
FAN = os.path.abspath(os.path.join(SCENES, "sonar_m750d.yaml"))
SCENE = """version: 1
environment: {wind_speed_kn: 10}
bottom: {depth_m: 12, type: sand}
objects:
  - {name: ball, sphere: {radius_m: 0.5}, position_m: [20, 0, 10], material: {type: rock}}
sonar:
  frequency_khz: 300
  bandwidth_khz: 50
  ping_rate_hz: 10
  source_level_db: 200
  speckle: rayleigh
  receivers: {fan: {count: 12, sector_deg: 90}}
mission: {waypoints: {points_m: [[0, 0, 7], [60, 0, 7]], speed_mps: 1}}
sampling: {rays: 4096}
output: {images: []}
"""


def begin(folder, *args, **env):
    return subprocess.Popen([program.PATH, *args], cwd=folder.path, stdout=subprocess.DEVNULL,
                            stderr=subprocess.PIPE, env=program.environment(env))


def test_expect_says_how_far_it_is_and_stops():
    """A minute of quadrature for 1,024 beams of long apertures: a line after ten seconds where there is no terminal."""
    with Folder() as folder:
        path = folder.write("scene.yaml", SCENE.replace("count: 12", "count: 1024, length_h_m: 0.5, length_v_m: 0.1"))
        with begin(folder, "expect", path, "-o", "out.csv") as child:
            time.sleep(1)
            child.send_signal(signal.SIGSTOP)  # the clock goes on, and the processor is free
            time.sleep(8.5)
            child.send_signal(signal.SIGCONT)
            line = ""
            while "of 1024 beams" not in line:
                line = child.stderr.readline().decode()
                tap.equal(line != "", True, "a line before the end")
            tap.contains(line, " left")
            program.stop(child)
        tap.equal(folder.names(), ["scene.yaml"])


def test_a_plan_stops_while_kernels_are_compiled():
    program.need_device()
    with Folder() as folder, Folder() as cache:
        with begin(folder, "plan", FAN, POCL_CACHE_DIR=cache.path) as child:
            time.sleep(1)
            program.stop(child, signal.SIGINT)


def test_rays_through_many_layers_stop():
    """Water of 48 layers, each warmer or colder than the next by 9 degrees or more: minutes of quadrature."""
    program.need_device()
    temperatures = (8, 22, 12, 21, 11, 20, 10, 24, 9, 23)
    cast = "".join(f"{i / 4},{temperatures[i % 10]}\n" for i in range(49))
    water = "environment: {wind_speed_kn: 10, sound_speed_profile: cast.csv}"
    with Folder() as folder:
        folder.write("cast.csv", "depth_m,temperature_degc\n" + cast)
        folder.write("scene.yaml", SCENE.replace("environment: {wind_speed_kn: 10}", water))
        with begin(folder, "plan", "scene.yaml") as child:
            time.sleep(1.5)
            program.stop(child)
        tap.equal(folder.names(), ["cast.csv", "scene.yaml"])


def test_a_drawing_stops():
    program.need_device()
    with Folder() as folder:
        path = folder.write("scene.yaml", SCENE)
        asdic("run", path, "-o", folder / "run", "-q").check(0)
        before = sorted(os.listdir(folder / "run"))
        done = asdic("render", folder / "run", "--images", "ascope", "-o", folder / "a.svg", "--ping", "3")
        if "cairo" in done.err:
            raise tap.Skip("built without cairo")
        done.check(0)
        if shutil.which("ffmpeg"):
            with begin(folder, "render", "run", "--video", "film.mp4") as child:
                time.sleep(1)  # of some 40 s
                program.stop(child)
        with begin(folder, "render", "run", "--mosaic", "map.png", "--cell", "0.04") as child:
            time.sleep(1)
            program.stop(child)
        tap.equal(folder.names(), ["a.svg", "run", "scene.yaml"])
        tap.equal(sorted(os.listdir(folder / "run")), before)


def test_a_video_stops_whose_encoder_hangs():
    """One that reads nothing, so that the frames wait for it: it ends too, and neither leaves anything."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("scene.yaml", SCENE.replace("speed_mps: 1", "speed_mps: 20"))
        asdic("run", path, "-o", folder / "run", "-q").check(0)
        os.mkdir(folder / "bin")
        encoder = folder.write("bin/ffmpeg", '#!/bin/sh\necho $$ >pid\nfor file; do :; done\n: >"${file#file:}"\nexec sleep 60\n')
        os.chmod(encoder, 0o755)
        with begin(folder, "render", "run", "--video", "film.mp4",
                   PATH=folder / "bin" + ":" + os.environ["PATH"]) as child:
            while not os.path.exists(folder / "film.part.mp4"):
                time.sleep(0.05)
            time.sleep(1)
            program.stop(child)
        state = pathlib.Path("/proc", folder.read("pid").strip(), "stat")
        tap.equal(not state.exists() or " Z " in state.read_text(encoding="ascii"), True, "the encoder has ended")
        tap.equal(folder.names(), ["bin", "pid", "run", "scene.yaml"])


def test_draws_stop():
    """A million runs or frames are drawn, for minutes, before the first is begun; nothing is there yet."""
    program.need_device()
    with Folder() as folder:
        path = folder.write("scene.yaml", SCENE + "trial: {draws: [{key: mission.waypoints.speed_mps, uniform: [1, 2]}]}\n")
        for command, count in (("trial", "--runs"), ("dataset", "-n")):
            with begin(folder, command, path, count, "999999", "-o", "out") as child:
                time.sleep(1)
                tap.contains(program.stop(child, signal.SIGINT).decode(), "of 999999 draws")
            tap.equal(folder.names(), ["scene.yaml"])


def test_each_shows_a_bar_on_a_terminal():
    program.need_device()
    with Folder() as folder:
        path = folder.write("scene.yaml", SCENE.replace("speed_mps: 1", "speed_mps: 20"))
        asdic("run", path, "-o", folder / "run", "-q").check(0)
        for counted, *args in (("beams", "expect", path, "-o", folder / "e.csv"),
                               ("pings measured", "plan", path),
                               ("draws", "roc", path, "--trials", "120000", "-o", folder / "roc"),
                               ("pings read", "render", folder / "run", "--images", "fan"),
                               ("pings read", "render", folder / "run", "--images", "waterfall"),
                               ("pings", "render", folder / "run", "--mosaic", folder / "m.png")):
            done = program.asdic_on_terminal(*args)
            tap.equal(done.code, 0, done.err)
            tap.contains(done.err, f" {counted}")
            tap.contains(done.err, "\r\033[K[")
            done = program.asdic_on_terminal(*args, *([] if args[0] == "plan" or args[2] == "--images"
                                                      else ["--force"]), "-q")
            tap.equal((done.code, "\r" in done.err.replace("\r\n", "\n")), (0, False), done.err)


tap.main(globals())
