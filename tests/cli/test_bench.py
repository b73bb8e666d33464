"""asdic bench: the figures are there, they add up, and the goals that do not depend on the machine
are kept."""
import csv
import io
import json
import math
import os
import re
import shutil
import subprocess

import program
import tap
from program import Folder, asdic

SCENES = os.path.join(os.path.dirname(__file__), "..", "..", "data", "scenes")


def between(x0, y0, x1, y1, x):
    """Where the line through log (x, y) of two points meets log x."""
    t = math.log(x / x0) / math.log(x1 / x0)
    return y0 * (y1 / y0) ** t


def check_what_follows_from_points(curves):
    """Rays and time at an error of 1 dB, and how many times less that is than the sphere's."""
    at_1db = {}
    for name, points in curves.items():
        for a, b in zip(points, points[1:]):
            if a["rms_db"] > 1 >= b["rms_db"]:
                rays = between(a["rms_db"], a["rays"], b["rms_db"], b["rays"], 1.0)
                at_1db[name] = rays, between(a["rays"], a["ping_s"], b["rays"], b["ping_s"], rays)
    tap.equal("uniform-sphere" in at_1db and len(at_1db) > 1, True, f"errors cross 1 dB: {at_1db}")
    for name, (rays, seconds) in at_1db.items():
        most_rays, most_seconds = at_1db["uniform-sphere"]
        for key, value in (("rays_for_1db", rays), ("seconds_for_1db", seconds),
                           ("fewer_rays", most_rays / rays), ("less_time", most_seconds / seconds)):
            for row in curves[name]:
                tap.equal(abs(row[key] / value - 1) < 1e-3, True, f"{name}: {key} {row[key]}, {value}")
        for row in curves[name]:
            tap.equal(row["far_rms_db"] <= row["max_db"] and row["rms_db"] <= row["max_db"], True, "the mean error")
            tap.equal(abs(row["bias_db"]) <= row["rms_db"], True, "the bias")


def check_bias(points):
    """What pings' spread explains of the error in their mean, rms / sqrt(pings), is taken off: no bias is left."""
    shares = [p["bias_db"] / p["rms_db"] * math.sqrt(p["pings"]) for p in points if p["rms_db"] < 1]
    tap.equal(len(shares) > 0 and sum(shares) / len(shares) < 0.7, True, f"bias beside the spread: {shares}")


def check_a_point(folder, path, row):
    """The figures of 1024 rays, of the pings as 'asdic run' writes them against 'asdic expect', from 2 m on."""
    tap.equal((row["rays"], row["pings"]), (1024, 128))
    asdic("run", path, "-q", "--rays", "1024", "-o", folder / "run").check(code=0)
    exact = {bin_["bin"]: bin_["total_db"] for bin_ in
             csv.DictReader(asdic("expect", path, "-o", "-").check(code=0).out.splitlines())}
    off, stated, far = [], [], []
    for bin_ in csv.DictReader(folder.read("run/bins.csv").splitlines()):
        if int(bin_["bin"]) >= 4:
            off.append(float(bin_["level_db"]) - float(exact[bin_["bin"]]))
            stated.append(float(bin_["stderr_db"]))
            far.append(int(bin_["bin"]) >= 149 - (149 - 4) // 3)
    bins = len(off) // 128
    tap.equal(bins, 145, "bins that are counted")

    def mean(values):
        return sum(values) / len(values)

    biases = []
    for k in range(bins):
        ratios = [10 ** (0.1 * value) for value in off[k::bins]]
        spread = math.sqrt(sum((r - mean(ratios)) ** 2 for r in ratios) / 128 / 127) / mean(ratios)
        biases.append((10 * math.log10(mean(ratios))) ** 2 - (10 / math.log(10) * spread) ** 2)
    squares = [o * o for o in off]
    honest = [(o / d) ** 2 for o, d in zip(off, stated)]
    far_squares, far_honest = ([v for v, is_far in zip(values, far) if is_far] for values in (squares, honest))
    wanted = {"rms_db": math.sqrt(mean(squares)), "far_rms_db": math.sqrt(mean(far_squares)),
              "max_db": math.sqrt(max(squares)), "bias_db": math.sqrt(max(mean(biases), 0)),
              "true_over_stated": math.sqrt(mean(honest)), "far_true_over_stated": math.sqrt(mean(far_honest))}
    for key, value in wanted.items():
        tap.equal(abs(row[key] - value) < 3e-3 * value + 5e-4 * (key == "bias_db"), True, f"{key}: {row[key]}, of runs {value}")


def check_words(text, rows):
    """What a bench says of the samplers that cross 1 dB is what the table has of them."""
    for name, row in rows.items():
        line = f"  {name:14} 1 dB with {row['rays_for_1db']:.4g} rays in {1e3 * row['seconds_for_1db']:.4g} ms"
        if name != "uniform-sphere":
            line += f": {row['fewer_rays']:.4g}x fewer rays, {row['less_time']:.4g}x less time than the uniform sphere"
        tap.contains(text, f"\n{line}\n")
    tap.equal(text.count(" 1 dB with "), len(rows), "samplers that are told of")


def numbers(row):
    """A row of a table, its words left; no number where there is none."""
    return {key: value if key in ("scene", "sampler", "reference") else float(value or "nan")
            for key, value in row.items()}


def test_error_keeps_its_goals():
    program.need_device()
    with Folder() as folder, open(os.path.join(SCENES, "bench_flat.yaml"), encoding="utf-8") as scene:
        # Rising so slowly that nothing shows it, but that each ping has its own place: runs of one place take quadratures.
        folder.write("rise.csv", "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,7,0,0,0\n12.75,0,0,6.9999,0.001,0,0\n")
        path = folder.write('flat, "1".yaml', scene.read().replace("pose: {position_m: [0, 0, 7]}\n  pings: 1",
                                                                   "track: rise.csv"))
        done = asdic("bench", "error", "--quick", "-o", folder / "error.csv", path).check(code=0)
        rows = [numbers(row) for row in csv.DictReader(io.StringIO(folder.read("error.csv")))]
        tap.equal({(r["scene"], r["beams"], r["bins"], r["reference"]) for r in rows},
                  {('flat, "1"', 1, 149, "quadrature")})
        curves = {}
        for row in rows:
            curves.setdefault(row["sampler"], []).append(row)
        tap.equal(sorted(curves), ["adaptive", "beam", "uniform-sphere"])
        rms = {p["rays"]: p["rms_db"] for p in curves["adaptive"]}
        if not (rms[4096] < 0.05 and rms[20000] < 0.01):
            raise AssertionError(rms)
        if not curves["adaptive"][0]["fewer_rays"] > 3000:
            raise AssertionError(curves["adaptive"][0]["fewer_rays"])
        for name, points in curves.items():
            errors = [p["rms_db"] for p in points]
            tap.equal(errors, sorted(errors, reverse=True), f"{name}: error over rays")
        check_a_point(folder, path, curves["adaptive"][2])
        check_what_follows_from_points(curves)
        check_bias(curves["beam"])
        check_words(done.out, {name: points[0] for name, points in curves.items() if points[0]["rays_for_1db"] > 0})
        tap.equal(folder.names(), ["error.csv", 'flat, "1".yaml', "rise.csv", "run"], "nothing left over")


BALL = """version: 1
bottom: {depth_m: 200, type: sand}
objects: [{name: ball, sphere: {radius_m: 2, segments: 32}, position_m: [10, 0, 100]}]
sonar: {frequency_khz: 100, ping_rate_hz: 40, source_level_db: 200, bin_length_m: 0.5, receivers: [{name: forward}]}
mission: {pose: {position_m: [0, 0, 100]}, pings: 1}
environment: {max_depth_m: 200}
sampling: {multipath: off}
"""


def test_error_of_a_scene_without_quadrature():
    """Its truth is the mean of 16 pings of 262,144 rays (docs/refraction.md), good to about 0.002 dB."""
    program.need_device()
    with Folder() as folder:
        done = asdic("bench", "error", "--quick", "-o", folder / "e.csv", folder.write("ball.yaml", BALL)).check(code=0)
        rows = [numbers(row) for row in csv.DictReader(io.StringIO(folder.read("e.csv")))]
    tap.equal({(r["scene"], r["reference"], r["reference_rays"]) for r in rows},
              {("ball", "mean of pings", 16 * 262144)})
    tap.contains(done.out, "counted from 2 m; truth: 4.19e+06 rays, good to ")
    spreads = {r["reference_spread_db"] for r in rows}
    tap.equal(len(spreads) == 1 and 0 < max(spreads) < 0.01, True, f"the truth's own error {spreads}")
    beam = [r["true_over_stated"] for r in rows if r["sampler"] == "beam" and r["pings"] > 4]
    tap.equal(len(beam) == 4 and all(0.7 < share < 1.5 for share in beam), True, f"true over stated error {beam}")


def check_pings(rows):
    is_processor = any(
        d["auto"] and d["kind"] == "cpu" for d in json.loads(asdic("devices", "--json").check(code=0).out))
    for row in rows:
        tap.equal(0 < row["mission_pings_per_s"] <= row["pings_per_s"], True)
        phases = ("sample", "trace", "shade", "bounce", "collect", "reduce", "levels")
        tap.equal(all(row[f"{phase}_s"] >= 0 for phase in phases), True)
        together = sum(row[f"{phase}_s"] for phase in phases)
        tap.equal(together < 8 / row["pings_per_s"] + 0.5, True, f"phases of {together:.3g} s")
        # A processor receives after it has shaded, for few beams and for many.
        idle = [phase for phase in phases if phase != "bounce" and is_processor and row[f"{phase}_s"] == 0]
        tap.equal(idle, [], "phases that take no time")


def test_pings_of_floors_and_scenes():
    program.need_device()
    with Folder() as folder:
        done = asdic("bench", "pings", "--quick", "--json", "--picture", folder / "pings.svg",
                     "-o", folder / "pings.csv").check(code=0)
        tap.contains(folder.read("pings.svg"), "</svg>")
        rows = list(csv.DictReader(io.StringIO(folder.read("pings.csv"))))
    found = json.loads(done.out)["rows"]
    tap.equal([(r["triangles"] > 50000, r["bins"]) for r in found],
              [(large, bins) for large in (False, True) for bins in (150, 1000, 2048, 4000)])
    tap.equal([int(r["bins"]) for r in rows], [r["bins"] for r in found])
    check_pings(found)
    scenes = ["scenario1", "bench_sphere"]
    done = asdic("bench", "pings", "--quick", "--json", "--threads", "1",
                 *(os.path.join(SCENES, f"{name}.yaml") for name in scenes)).check(code=0)
    found = json.loads(done.out)["rows"]
    tap.equal([r["scene"] for r in found], scenes)
    check_pings(found)


def test_tables_go_where_they_are_sent():
    """Alone to standard output, and not over what is there."""
    program.need_device()
    flat = os.path.join(SCENES, "bench_flat.yaml")
    with Folder() as folder:
        out = asdic("bench", "loop", "--quick", "-o", "-", flat, cwd=folder.path).check(code=0).out
        row, = csv.DictReader(io.StringIO(out))
        tap.equal((row["scene"], folder.names()), ("bench_flat", []))
        for name in "-", "/dev/stdout":
            asdic("bench", "loop", "--quick", "-o", name, "--json", flat).check(code=2)
        for option in "-o", "--picture":
            kept = folder.write("kept.svg", "kept")
            err = asdic("bench", "pings", "--quick", option, kept, flat).check(code=1).err
            tap.contains(err, "kept.svg' exists; --force overwrites it")
            tap.equal(folder.read("kept.svg"), "kept")


def test_loop_of_a_scene():
    program.need_device()
    out = asdic("bench", "loop", "--quick", "--json", os.path.join(SCENES, "bench_flat.yaml"),
                POCL_MAX_PTHREAD_COUNT="").check(code=0).out
    row, = json.loads(out)["rows"]
    tap.equal(json.loads(out)["threads"], 0, "threads: as many as the device likes")
    tap.equal((row["scene"], row["pings"] > 0), ("bench_flat", True))
    tap.equal(0 < row["latency_median_s"] <= row["latency_p99_s"], True)
    tap.equal(row["latency_p99_s"], row["latency_worst_s"], "of less than a hundred pings")


def test_rays_of_the_terrain_and_a_mesh():
    """All forms of the ray kernel meet the same."""
    program.need_device()
    mesh = os.path.join(SCENES, "..", "meshes", "wreck.ply")
    hits = []
    # One thread, so that forms can be compared, unless somebody asks for more.
    for kernel, option, limit, threads in (("auto", [], "", 1), ("wide8", [], "2", 2), ("pkt16", ["--threads", "2"], "1", 2),
                                           ("frustum64", [], "", 1), ("scalar", [], "", 1)):
        out = asdic("bench", "rays", "--quick", "--json", "--kernel", kernel, *option, mesh,
                    POCL_MAX_PTHREAD_COUNT=limit).check(code=0).out
        rows = json.loads(out)["rows"]
        tap.equal(json.loads(out)["threads"], threads, "threads")
        tap.equal([r["set"] for r in rows], ["cone-dense", "cone", "sphere-dense", "sphere", "sphere-random"])
        tap.equal({r["scene"] for r in rows}, {"wreck.ply"})
        tap.equal(all(0 < r["hits"] <= r["rays"] and r["rays_per_s"] > r["rays"] for r in rows), True, "less than a second")
        if kernel != "auto":
            tap.equal({r["kernel"] for r in rows}, {kernel})
        hits.append([r["hits"] for r in rows])
    tap.equal(hits, [hits[0]] * len(hits), "hits by every kernel")
    out = asdic("bench", "rays", "--quick").check(code=0).out
    tap.contains(out, "terrain")


def test_help_measures_nothing():
    tap.contains(program.asdic_bench("fan", "--help").check(code=0, err="").out, "usage: ")


def test_scenes_are_found_beside_the_program():
    """In share/ beside bin/, in data/ above it, above that, below the folder one is in; where ASDIC_DATA says, there alone."""
    program.need_device()
    with Folder() as folder:
        os.makedirs(folder / "a/b/bin")
        os.makedirs(folder / "here")
        copy = shutil.copy(program.PATH, folder / "a/b/bin/asdic")
        libraries = os.path.join(os.path.dirname(program.PATH), "..", "lib")
        for given, place, found in (("", None, None), ("", "here/data", "data"), ("", "data", "a/b/bin/../../../data"),
                                    ("", "a/data", "a/b/bin/../../data"),
                                    ("", "a/b/share/asdic", "a/b/bin/../share/asdic"), (folder / "mine", None, "mine")):
            if place:
                os.makedirs(folder / place + "/scenes")
                folder.write(place + "/scenes/bench_flat.yaml", "version: 0")
            done = subprocess.run([copy, "bench", "error", "--quick"], cwd=folder / "here", capture_output=True, text=True,
                                  timeout=120, check=False, env={**os.environ, "ASDIC_DATA": given,
                                                                 "LD_LIBRARY_PATH": libraries})
            wanted = "data" if found in (None, "data") else folder / found
            tap.equal(done.returncode, 3, f"exit code ({done.stderr})")
            tap.equal(re.findall(r"[^ '\n]*bench_flat.yaml", done.stderr)[0], wanted + "/scenes/bench_flat.yaml")


def test_mistakes_have_their_exit_codes():
    asdic("bench").check(code=2, out="")
    asdic("bench", "rain").check(code=2, out="")
    asdic("bench", "honest").check(code=2, out="")
    asdic("bench", "rays", "--threads", "0").check(code=2, out="")
    for kind in "error", "honest", "loop", "pings", "rays":
        for option, value, said, takes_it in (
                ("--picture", "x.png", f"'bench {kind}' draws nothing; -o writes a table", ("error", "pings")),
                ("--kernel", "scalar", f"--kernel is of rays alone; 'bench {kind}' times what a ping takes", ("rays",))):
            if kind not in takes_it:
                tap.contains(asdic("bench", kind, option, value, "x.yaml").check(code=2, out="").err, said)
    done = asdic("bench", "error", "--picture", "x.png", *["nowhere.yaml"] * 9).check(code=2, out="")
    tap.contains(done.err, "a picture shows 8 scenes at most, not 9")
    program.need_device()
    asdic("bench", "error", "nowhere.yaml").check(code=3, out=None)
    asdic("bench", "error", "--picture", "x.png", *["nowhere.yaml"] * 8).check(code=3, out=None)
    asdic("bench", "pings", "nowhere.yaml").check(code=3, out=None)
    asdic("bench", "rays", "nowhere.ply").check(code=3)
    done = asdic("bench", "rays", "--quick", "--kernel", "fast").check(code=2)
    tap.contains(done.err, "'fast' is not a form of the ray kernel")
    with Folder() as folder:
        asdic("bench", "error", ASDIC_DATA=folder.path).check(code=3)


tap.main(globals())
