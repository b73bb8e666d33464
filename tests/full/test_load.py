"""Large scenes, sonars and pings: done, in a stated time and memory; what does not fit is refused before
it begins, with the bytes that are needed and those there are."""
import os
import re
import resource
import subprocess
import time

import program
import tap
from program import Folder, asdic

MOST_MIB = 2048
HEAD = """version: 1
bottom: {bottom}
sonar: {{frequency_khz: 100, bandwidth_khz: {band}, ping_rate_hz: {rate}, bin_length_m: {bin_m},
  source_level_db: 200, receivers: {receivers}}}
mission: {{pose: {{position_m: [0, 0, 5]}}, pings: {pings}}}
sampling: {{rays: {rays}}}
output: {{images: []}}
"""


def scene(bottom="{depth_m: 12}", band=10, rate=20, bin_m=1, receivers="[{name: a}]", pings=1,
          rays=20000):
    return HEAD.format(bottom=bottom, band=band, rate=rate, bin_m=bin_m, receivers=receivers,
                       pings=pings, rays=rays)


def objects(shape):
    """Ten thousand of them, in 1 MiB."""
    return "".join(f"  - {{name: o{i}, {shape}, position_m: [{5 + i % 100 * 0.3:.1f}, "
                   f"{i // 100 * 0.3 - 15:.1f}, 11], type: rock}} # stone number {i} of 10,000\n"
                   for i in range(10000))


def grid(folder, side):
    """A bottom of 2 (SIDE - 1)^2 triangles."""
    rows = [" ".join(str(12 + (i * i % 97 + k) % 7 * 0.01) for i in range(side)) for k in range(7)]
    folder.write("g.asc", f"ncols {side}\nnrows {side}\nxllcorner -35\nyllcorner -35\n"
                 "cellsize 0.05\n" + "\n".join(rows[k % 7] for k in range(side)) + "\n")
    return "{grid: {file: g.asc, values: depths}}"


def measured(what, *arguments):
    """Runs asdic ARGUMENTS, which must succeed within MOST_MIB."""
    begin = time.monotonic()
    child = subprocess.Popen([program.PATH, *arguments, "-q"], env=program.environment({}),
                             stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    child.returncode = os.waitstatus_to_exitcode(status)
    peak_mib = usage.ru_maxrss / 1024
    print(f"# {what}: {time.monotonic() - begin:.1f} s, {peak_mib:.0f} MiB")
    tap.equal(child.returncode, 0, f"exit code of {what}")
    tap.equal(peak_mib < MOST_MIB, True, f"{what}: {peak_mib} MiB")


def run(what, text, rows, folder):
    program.need_device()
    path = folder.write("s.yaml", text)
    measured(what, "run", path, "-o", folder / "r")
    with open(folder / "r/bins.csv", "rb") as table:
        tap.equal(sum(1 for _ in table) - 1, rows, "rows of bins.csv")


def test_ten_thousand_objects_in_a_mebibyte():
    with Folder() as folder:
        text = scene() + "objects:\n" + objects("box: {size_m: [0.2, 0.2, 0.2]}")
        tap.equal(len(text) >= 1 << 20, True, f"{len(text)} bytes")
        run("10,000 objects in a scene of 1 MiB", text, 37, folder)


def test_four_million_triangles():
    with Folder() as folder:
        run("4 million triangles", scene(bottom=grid(folder, 1416)), 37, folder)


def test_thousand_beams_of_four_thousand_bins():
    text = scene(band=50, rate=7, bin_m=0.026, rays=100000,
                 receivers="{fan: {count: 1024, sector_deg: 120}}")
    with Folder() as folder:
        path = folder.write("s.yaml", text)
        bins = int(re.search(r"bins +(\d+)", asdic("check", path).check(code=0).out).group(1))
        tap.equal(bins >= 4000, True, f"{bins} bins")
        run(f"1,024 beams of {bins} bins", text, 1024 * bins, folder)


def test_ten_million_rays_in_a_ping():
    with Folder() as folder:
        run("10 million rays", scene(rays=10000000), 37, folder)


def refused(text, *words, by=("run", "check", "plan"), files=()):
    """By run and by check, within seconds, where a process may have 2 GiB."""
    with Folder() as folder:
        path = folder.write("s.yaml", text)
        for name, content in dict(files).items():
            folder.write(name, content)
        for command in (["run", path, "-o", folder / "r"], ["check", path], ["plan", path]):
            if command[0] not in by:
                continue
            begin = time.monotonic()
            done = subprocess.run([program.PATH, *command], capture_output=True, text=True,
                                  check=False, preexec_fn=lambda: resource.setrlimit(
                                      resource.RLIMIT_AS, (2 << 30, 2 << 30)))
            tap.equal(done.returncode, 1, f"exit code of {command[0]} ({done.stderr})")
            errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
            tap.equal(len(errors), 1, f"errors ({done.stderr})")
            for word in words:
                tap.contains(done.stderr, word)
            sizes = re.search(r"needs? (\d+) bytes of memory, (\d+) are available", done.stderr)
            tap.equal(int(sizes.group(1)) > int(sizes.group(2)) > 0, True, done.stderr)
            tap.equal(time.monotonic() - begin < 10, True, "refused at once")
        tap.equal(os.path.exists(folder / "r"), False, "a folder for nothing")


def test_triangles_beyond_memory_are_refused_beforehand():
    refused(scene() + "objects:\n" + objects("sphere: {radius_m: 0.1, segments: 128}"),
            "triangles", "segments")


def test_copies_of_a_mesh_beyond_memory_are_refused_beforehand():
    ridge = ("".join(f"v {i} {i % 3} 0\n" for i in range(3000))
             + "".join(f"f {i} {i + 1} {i + 2}\n" for i in range(1, 2999)))
    refused(scene() + "objects:\n" + objects("mesh: {file: ridge.obj}"), "19980000 triangles",
            files={"ridge.obj": ridge})


def test_pings_beyond_memory_are_refused_beforehand():
    refused(scene(pings=1000000000), "1000000000 pings", by=("run", "plan"))


def test_a_thousand_million_pings_are_checked_at_once():
    """Nothing is kept, nor looked at, for each of them."""
    with Folder() as folder:
        begin = time.monotonic()
        asdic("check", folder.write("s.yaml", scene(pings=1000000000))).check(code=0)
        tap.equal(time.monotonic() - begin < 5, True, "checked at once")


def test_ten_thousand_objects_on_one_track():
    """The track's file of 1 MiB is kept once; each of them apart would be 30 GiB."""
    rows = "".join(f"{i},0,0,11,0,0,0\n" for i in range(50000))
    text = scene() + "objects:\n" + "".join(
        f"  - {{name: o{i}, box: {{size_m: [1, 1, 1]}}, track: t.csv, type: rock}}\n"
        for i in range(10000))
    with Folder() as folder:
        folder.write("t.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + rows)
        measured("10,000 objects on one track", "check", folder.write("s.yaml", text))


def test_levels_beyond_memory_are_refused_beforehand():
    refused(scene(band=90, rate=0.6, bin_m=0.02,
                  receivers="{fan: {count: 1024, sector_deg: 120}}"), "1024 beams of", "bin_length_m")


def test_more_than_a_device_takes_in_one_buffer_is_refused():
    """The hierarchy of a million triangles takes 0.2 GiB; PoCL is told to have a gigabyte."""
    program.need_device()
    if asdic("devices", "--json", POCL_MEMORY_LIMIT="1").out == asdic("devices", "--json").out:
        raise tap.Skip("the device's memory cannot be limited (PoCL's can)")
    with Folder() as folder:
        path = folder.write("s.yaml", scene(bottom=grid(folder, 1416)))
        done = asdic("run", path, "-o", folder / "r", POCL_MEMORY_LIMIT="1").check(code=1)
        tap.equal(len(re.findall(r"[0-9.]+ MiB", done.err)), 2, f"sizes told ({done.err})")


tap.main(globals())
