"""asdic check: what it says of scenes, meshes and grids, and of what is wrong with them."""
import json
import os
import pathlib
import re
import subprocess
import tempfile

import program
import tap
from program import asdic, need_device

SCENES = pathlib.Path(__file__).parent.parent / "unit" / "scenes"
DATA = pathlib.Path(__file__).resolve().parents[2] / "data"
EXAMPLE = SCENES / "example.yaml"
MINIMAL = """version: 1
bottom: {depth_m: 12}
sonar:
  frequency_khz: 100
  source_level_db: 0
  receivers: [{name: forward}, {name: port, yaw_deg: -20}]
mission:
  pose: {position_m: [0, 0, 7]}
"""
TETRAHEDRON = """v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 2
f 1 3 2
f 1 2 4
f 2 3 4
f 3 1 4
"""


def folder(**files):
    """A temporary folder with FILES, whose names have _ for the dot."""
    made = tempfile.TemporaryDirectory()
    for name, text in files.items():
        path = pathlib.Path(made.name, name.replace("_", ".", 1))
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return made


def without_free_space(text):
    """TEXT without the line that says what is free on the disk, which changes while a test runs."""
    return re.sub(r"  output .* a ping, .* in all; .* free\n", "", text)


def test_example_is_described():
    done = asdic("check", EXAMPLE)
    tap.equal((done.code, done.err), (0, ""))
    described = without_free_space(done.out)
    tap.equal(described, f"""{EXAMPLE}: a valid scene
  pings       1 in 0 s
  beams       1: forward
  bins        149 of 0.5 m, from 0.5 to 74.505 m
  rays        20000 a ping, for a stated error of about 0.022 dB r.m.s., more at objects' edges
  water       1490.1 m/s and 33.57 dB/km at 100 kHz, 7 m deep
  surface     at z = 0
  bottom      flat at z = 12 m
  rise        12 triangles, x 35 .. 75, y -100 .. 100, z 10 .. 12 m
""")


def test_json_holds_the_same():
    done = asdic("check", EXAMPLE, "--json")
    tap.equal((done.code, done.err), (0, ""))
    [scene] = json.loads(done.out)
    tap.equal((scene["valid"], scene["kind"], scene["pings"], scene["bins"]),
              (True, "scene", 1, 149))
    tap.equal((scene["beams"], scene["bottom"], scene["surface"]), (["forward"], "flat", True))
    tap.equal(scene["meshes"][0]["min_m"], [35, -100, 10])
    import hashlib
    tap.equal(scene["sha256"], hashlib.sha256(EXAMPLE.read_bytes()).hexdigest())


def test_an_object_of_one_letter_is_no_bottom():
    scene = (MINIMAL.replace("{depth_m: 12}", "{none: true}") +
             "objects: [{name: a, sphere: {radius_m: 1}, position_m: [9, 0, 7]}]\n")
    tap.contains(asdic("check", "-", stdin=scene).check(code=0).out, "dB r.m.s., more at objects' edges\n")
    [found] = json.loads(asdic("check", "-", "--json", stdin=scene).check(code=0).out)
    tap.equal((found["bottom"], len(found["meshes"])), ("none", 1))


def test_errors_are_foretold_of_the_adaptive_sampler_alone():
    # The others err ten times as much and more: no rule tells how much.
    for sampler, said in (("adaptive", "for a stated error of about 0.036 dB r.m.s."),
                          ("beam", "for an error that 'asdic plan' measures"),
                          ("uniform-sphere", "for an error that 'asdic plan' measures")):
        scene = MINIMAL + f"sampling: {{sampler: {sampler}, rays: 20000}}\n"
        text = asdic("check", "-", stdin=scene).check(code=0, err="")
        tap.contains(text.out, f"  rays        20000 a ping, {said}\n")
        [found] = json.loads(asdic("check", "-", "--json", stdin=scene).check(code=0).out)
        tap.equal(found["expected_stderr_db"] is None, sampler != "adaptive")


def test_json_and_yaml_scenes_are_equal():
    yaml, as_json = (without_free_space(asdic("check", SCENES / f"example.{e}").out)
                     .partition("\n")[2] for e in ("yaml", "json"))
    tap.equal(yaml, as_json)


def test_stdin_and_relative_paths():
    scene = MINIMAL.replace("depth_m: 12", "mesh: {file: m.obj, scale: 1000}")
    scene = scene.replace("[0, 0, 7]", "[300, 300, 7]")
    scene = scene.replace("{mesh", "{position_m: [0, 0, 2050], mesh")
    with folder(m_obj=TETRAHEDRON, s_yaml=scene) as at:
        beside = asdic("check", os.path.join(at, "s.yaml"))
        piped = asdic("check", "-", stdin=scene, cwd=at)
        tap.equal((beside.code, beside.err), (0, ""))
        tap.equal((piped.code, piped.err), (0, ""))
        tap.contains(piped.out, "bottom      4 triangles, x 0 .. 1000, y 0 .. 1000")
        tap.equal(beside.out.partition("\n")[2], piped.out.partition("\n")[2])
        tap.equal(asdic("check", "-", stdin=scene).code, 3)


def test_every_error_in_one_run():
    scene = (MINIMAL.replace("frequency_khz: 100", "frequency_khz: 9000\n  frequncy: 1")
             .replace("depth_m: 12", "mesh: missing.obj")
             .replace("mission:", "objects: [{name: a, mesh: none.ply, position_m: [0, 0, 1]}]\n"
                                  "mission:"))
    with folder(s_yaml=scene) as at:
        done = asdic("check", "s.yaml", cwd=at)
        tap.equal((done.code, done.out), (3, ""))
        lines = done.err.splitlines()
        tap.equal(len(lines), 5, "lines of " + done.err)
        tap.contains(lines[0], "s.yaml:2:16: error: ")
        tap.contains(lines[0], "missing.obj")
        tap.contains(lines[0], "  [bottom.mesh.file]")
        tap.equal(lines[1], "s.yaml:4:18: error: 'frequency_khz' = 9000 is out of range "
                            "[0.1, 3000] kHz  [sonar.frequency_khz]")
        tap.contains(lines[2], "s.yaml:5:3: error: unknown key 'frequncy'")
        tap.contains(lines[3], "s.yaml:8:27: error: ")
        tap.contains(lines[3], "none.ply")
        tap.contains(lines[3], "  [objects[0].mesh.file]")
        tap.equal(lines[4], "error: s.yaml: 4 errors")


def test_places_are_judged_beside_other_errors():
    """What a value that could not be read has to do with is left out alone: geometry that is whole, and a flat bottom's
    depth, are compared with the way all the same."""
    grid = "ncols 3\nnrows 3\nxllcorner -50\nyllcorner -50\ncellsize 50\n" + 3 * "4 4 4\n"
    below = "the sonar is at z = 7 m, below the bottom at 4 m; raise it or lower the bottom"
    flat = MINIMAL.replace("depth_m: 12", "depth_m: 4")
    with folder(g_asc=grid, flat_yaml=flat + "sampling: {rays: 1}\n",
                grid_yaml=MINIMAL.replace("depth_m: 12", "grid: {file: g.asc}") + "sampling: {rays: 1}\n",
                law_yaml=flat.replace("depth_m: 4", "depth_m: 4, type: sandd, lambert_db: -27"),
                way_yaml=flat.replace("depth_m: 4", "depth_m: 4, type: sandd").replace(
                    "pose: {position_m: [0, 0, 7]}", "waypoints: [[0, 0, 3], [30, 0, 9]]"),
                sonar_yaml=flat.replace("source_level_db: 0", "source_level_db: 2000\n  ping_rate_hz: 1").replace(
                    "pose: {position_m: [0, 0, 7]}", "waypoints: [[0, 0, 3], [30, 0, 9]]"),
                both_yaml=MINIMAL + "  track: none.csv\n") as at:
        tap.contains(asdic("check", "both.yaml", cwd=at).check(3).err, "error: both.yaml: 1 error\n")
        for name, words in (("flat", ("'rays' = 1 is out of range", below)), ("grid", ("'rays' = 1 is out of range", below)),
                            ("law", ("'type' = sandd is not one of", "'type' has no effect beside 'lambert_db'", below)),
                            ("way", ("'type' = sandd is not one of", "m, below the bottom at 4 m")),
                            ("sonar", ("'source_level_db' = 2000 is out of range", "m, below the bottom at 4 m"))):
            err = asdic("check", name + ".yaml", cwd=at).check(3).err
            for part in (*words, f"error: {name}.yaml: {len(words)} errors"):
                tap.contains(err, part)


def test_a_sonar_is_told_from_a_scene():
    for path in (DATA / "sonars/m750d.yaml", DATA / "trials/one.yaml"):
        done = asdic("check", path).check(3)
        tap.contains(done.err, ": error: these are keys of a sonar, not a scene; check a scene that names this file: "
                     f"'sonar: {{file: {path.name}}}'\nerror: {path}: 1 error\n")


def test_draws_are_judged():
    """By the scene's own limits, at the line of the draw."""
    draws = MINIMAL + "trial:\n  draws:\n"
    for draw, words in (("{key: enviroment.ph, uniform: [7, 8]}", "unknown key 'enviroment'; did you mean 'environment'?"),
                        ("{key: 3, uniform: [7, 8]}", "unknown key '3'; the keys here are version, "),
                        ("{key: 'objects[5].position_m[0]', uniform: [7, 8]}", "there is no 'objects[5]' here"),
                        ("{key: bottom.type, choice: [mud, sandd]}", "'type' = sandd is not one of mud, sand"),
                        ("{key: environment.ph, uniform: [7.5, 9]}", "'ph' = 9 is out of range [7, 8.5]"),
                        ("{key: sampling.seed, choice: [1, 2]}", "'sampling.seed' cannot be drawn")):
        done = asdic("check", "-", stdin=f"{draws}    - {draw}\n").check(3)
        tap.contains(done.err, "stdin:11:")
        tap.contains(done.err, words)


def test_files_of_draws_are_opened():
    """Whatever key the choice is of, and each of them once, at the line of the draw; what is wrong inside at its own."""
    head = MINIMAL + "trial:\n  draws:\n"
    ball = "{name: ball, mesh: {file: %s}, position_m: [9, 0, 7]}"
    objects = "objects:\n" + 2 * "  - {sphere: {radius_m: 1}, position_m: [9, 0, 7]}\n"
    nope = "stdin:11:%d: error: nope.%s: cannot open: No such file or directory  [%s]\nerror: stdin: 1 error\n"
    far = TETRAHEDRON.replace("v 0", "v 5900000000").replace("v 1", "v 5900000001")
    with folder(ball_obj=TETRAHEDRON, far_obj=far, bad_ply="plz\n", bad_csv="time_s,x_m\n", cast_csv="depth_m\n") as at:
        def check(draws, code=3):
            lines = "".join(f"    - {draw}\n" for draw in draws)
            return asdic("check", "-", stdin=head + lines + objects, cwd=at).check(code).err
        for draw, words in (
                ("{key: 'objects[0]', choice: [none, " + ball % "nope.ply" + "]}", nope % (68, "ply", "objects[0].mesh.file")),
                ("{key: bottom, choice: [{grid: nope.asc}, {depth_m: 9}]}", nope % (37, "asc", "bottom.grid.file")),
                ("{key: bottom.mesh.file, choice: [nope.ply, ball.obj]}", nope % (40, "ply", "bottom.mesh.file")),
                ("{key: bottom.curve, choice: [nope.csv]}", nope % (36, "csv", "bottom.curve")),
                ("{key: mission, choice: [{track: nope.csv}]}", nope % (39, "csv", "mission.track")),
                ("{key: 'objects[0].track', choice: [nope.csv]}", nope % (42, "csv", "objects[0].track")),
                ("{key: sonar.file, choice: [nope.yaml]}", nope % (34, "yaml", "sonar.file")),
                ("{key: environment.sound_speed_profile, choice: [nope.csv]}", nope % (55, "csv", "environment.sound_speed_profile")),
                ("{key: bottom.mesh, choice: [bad.ply]}", "stdin:11:35: error: bad.ply:1: does not start with 'ply'"),
                ("{key: mission.track, choice: [bad.csv]}", "bad.csv:1:1: error: missing column 'y_m'"),
                ("{key: environment.sound_speed_profile, choice: [cast.csv]}", "cast.csv:1:1: error: missing column 'sound_speed_mps'")):
            tap.contains(check([draw]), words)
        # Others draw what the object lacks; choices lie within each other, and name a file again.
        inner = ball % "{choice: [ball.obj, ball.obj, ball.obj, nope.ply]}"
        err = check(["{key: 'objects[0]', choice: [" + inner.replace(", position_m: [9, 0, 7]", "") + "]}",
                     "{key: 'objects[0].position_m', choice: [[9, 0, 7]]}",
                     "{key: 'objects[1]', choice: [" + inner + ", " + ball % "nope.ply" + "]}"])
        tap.equal(err.count("nope.ply: cannot open"), 1, "said once")
        for draw in (ball % "{choice: [ball.obj, nope.ply]}" + ", none", "none, none, " + ball % "{choice: [nope.ply, ball.obj]}",
                     "none, {choice: [" + ball % "{choice: [ball.obj, nope.ply]}" + ", none]}"):
            tap.contains(check(["{key: 'objects[0]', choice: [" + draw + "]}"]), "nope.ply: cannot open")
        check(["{key: 'objects[0]', choice: [none, " + ball % "ball.obj" + "]}"], 0)
        check(["{key: 'objects[0]', choice: [none, " + ball % "far.obj, scale: 0.001" + "]}"], 0)


def test_places_that_may_be_meant_otherwise_are_not_judged():
    """Of a bottom that is given twice, a mission that ends at a ping not known or a rate not known it is not said that
    the sonar is below the bottom, or at which ping."""
    flat = MINIMAL.replace("depth_m: 12", "depth_m: 4")
    pose, way = "pose: {position_m: [0, 0, 7]}", "waypoints: [[0, 0, 3], [30, 0, 9]]"
    for text, words in ((flat.replace("depth_m: 4", "depth_m: 4, none: true"), "exclude each other"),
                        (flat.replace("depth_m: 4", "mesh: {file: no.ply}, depth_m: 4"), "exclude each other"),
                        (flat.replace(pose, pose + "\n  waypoints: [[0, 0, x], [30, 0, 9]]"), "exclude each other"),
                        (flat.replace(pose, way + "\n  pings: 3x"), "'pings' = 3x is not a number"),
                        (flat.replace(pose, way + "\n  ping: 3"), "did you mean 'pings'?"),
                        (flat.replace(pose, way).replace("sonar:", "sonar:\n  ping_rte_hz: 1"), "did you mean 'ping_rate_hz'?")):
        err = asdic("check", "-", stdin=text).check(3).err
        tap.contains(err, words)
        tap.lacks(err, "below the bottom")


def test_all_files_are_looked_at():
    with folder(a_yaml="a: 1", b_obj=TETRAHEDRON, c_yaml=MINIMAL) as at:
        done = asdic("check", "a.yaml", "b.obj", "missing.yaml", "c.yaml", "--json", cwd=at)
        tap.equal(done.code, 3)
        tap.equal([entry["valid"] for entry in json.loads(done.out)], [False, True, False, True])
        tap.contains(done.err, "error: missing.yaml: cannot open: No such file or directory\n")
        quiet = asdic("check", "a.yaml", "b.obj", "c.yaml", "-q", cwd=at).check(code=3, out="").err
        tap.equal((quiet.count("a.yaml"), "b.obj" in quiet, "c.yaml" in quiet), (quiet.count("error:"), False, False), quiet)
        tap.equal(len(asdic("check", "c.yaml", "-q", "--json", cwd=at).check(code=0).out) > 100, True, "what is asked for in JSON")


def test_mesh_is_described():
    with folder(m_obj=TETRAHEDRON) as at:
        done = asdic("check", "m.obj", cwd=at)
        tap.equal((done.code, done.err), (0, ""))
        tap.contains(done.out, "m.obj: mesh, in its own axes and units\n"
                               "  extent    1 x 1 x 2\n"
                               "            x 0 .. 1, y 0 .. 1, z 0 .. 2\n"
                               "  facets    4 triangles, 4 vertices, 0 degenerate dropped\n"
                               "  edges     closed\n")
        [mesh] = json.loads(asdic("check", "m.obj", "--json", cwd=at).out)
        tap.equal((mesh["kind"], mesh["triangles"], mesh["open_edges"], mesh["max"]),
                  ("mesh", 4, 0, [1, 1, 2]))


def test_meshes_in_other_units_are_hinted_at():
    """The tetrahedron is two units high; without one of its facets it may be a bottom, which is wider than a body."""
    facet = TETRAHEDRON.rstrip().rpartition("\n")[0] + "\n"
    for body, scale, hint in ((TETRAHEDRON, 0.249, "0.498 m across: not metres? (set a scale)"), (TETRAHEDRON, 0.25, None),
                              (TETRAHEDRON, 100, None), (TETRAHEDRON, 101, "202 m across: millimetres? (scale 0.001)"),
                              (TETRAHEDRON, 3000, "6000 m across: millimetres? (scale 0.001)"), (facet, 10000, None),
                              (facet, 10001, "2e+04 m across: millimetres? (scale 0.001)")):
        mesh = re.sub(r"^v (\S+) (\S+) (\S+)", lambda m: "v " + " ".join(repr(scale * float(x)) for x in m.groups()),
                      body, flags=re.M)
        with folder(m_obj=mesh) as at:
            out = asdic("check", "m.obj", cwd=at).check(0).out
            tap.equal([line for line in out.splitlines() if "hint" in line], [f"  hint      {hint}"] if hint else [],
                      f"{scale}")


def test_grid_is_described():
    """As its file says: x to the east from the lower left corner, y to the north, a value amid each cell."""
    rows = (" ".join(["12"] * 5) + "\n") * 10 + "20 20 20 20 20\n"
    with folder(g_asc="ncols 5\nnrows 11\nxllcorner -40\nyllcorner -10\ncellsize 10\n" + rows) as at:
        tap.contains(asdic("check", "g.asc", cwd=at).check(0).out,
                     "g.asc: grid, in its own axes\n"
                     "  extent    40 x 100 x 8\n"
                     "            x -35 .. 5, y -5 .. 95, z 12 .. 20\n")
        [grid] = json.loads(asdic("check", "g.asc", "--json", cwd=at).out)
        tap.equal((grid["kind"], grid["min"], grid["max"]), ("grid", [-35, -5, 12], [5, 95, 20]))


def test_places_in_utm_are_told_apart():
    """Seven digits before the point: box, point, mesh and grid keep what is behind it."""
    grid = "ncols 3\nnrows 3\nxllcorner 431200.5\nyllcorner 5984300.25\ncellsize 2\n" + "12 12 12.5\n" * 3
    scene = MINIMAL.replace("{depth_m: 12}", "{grid: g.asc, type: sand}").replace(
        "mission:", """objects:
  - {name: box, box: {size_m: [1, 2, 3]}, position_m: [5984302.25, 431203, 9]}
  - {name: p, point: 0, position_m: [5984303.75, 431204.125, 6]}
mission:""").replace("position_m: [0, 0, 7]", "position_m: [5984302, 431203, 7]")
    with folder(g_asc=grid, s_yaml=scene) as at:
        said = asdic("check", "s.yaml", "g.asc", cwd=at).check(0).out
        tap.contains(said, "x 5984301.25 .. 5984305.25, y 431201.5 .. 431205.5, z 12 .. 12.5 m\n")
        tap.contains(said, "x 5984301.75 .. 5984302.75, y 431202 .. 431204, z 7.5 .. 10.5 m\n")
        tap.contains(said, "a point at x 5984303.75, y 431204.12, z 6 m\n")
        tap.contains(said, "            x 431201.5 .. 431205.5, y 5984301.25 .. 5984305.25, z 12 .. 12.5\n")


def test_every_object_is_described():
    """A tetrahedron that lacks a face and has a degenerate one, a point, a box; of many objects the first forty."""
    open_mesh = TETRAHEDRON.replace("f 3 1 4", "f 1 1 2")
    point = "  - {name: p%d, point: {target_strength_db: 0}, position_m: [9, -3, 6]}\n"
    head = """objects:
  - {name: frame, mesh: m.obj, position_m: [20, 0, 7]}
  - {name: c, box: {size_m: [1, 2, 3]}, position_m: [30, 0, 9], rotation_deg: [90, 0, 0]}
  - {name: d, box: {size_m: [1.8642, 1.8642, 1.8642]}, position_m: [10.123, 3.4567, 9.87654]}
"""
    with folder(m_obj=open_mesh) as at:
        for points in 37, 38:
            objects = head + "".join(point % i for i in range(points)) + "mission:"
            scene = MINIMAL.replace("{depth_m: 12}", "none").replace("mission:", objects)
            said = without_free_space(asdic("check", "-", stdin=scene, cwd=at).check(0).out)
            tap.contains(said, "  beams       2: forward .. port\n")
            tap.equal(said.partition("  surface ")[2], """    at z = 0
  bottom      none
  frame       3 triangles, x 20 .. 21, y 0 .. 1, z 5 .. 7 m
              1 degenerate facets dropped
              3 open edges
  c           12 triangles, x 29.5 .. 30.5, y -1.5 .. 1.5, z 8 .. 10 m
  d           12 triangles, x 9.191 .. 11.06, y 2.525 .. 4.389, z 8.944 .. 10.81 m
""" + "".join(f"  p{i:<10} a point at x 9, y -3, z 6 m\n" for i in range(37))
                      + ("" if points == 37 else "  ...         1 more; --json lists all\n"))
        [told] = json.loads(asdic("check", "-", "--json", stdin=scene, cwd=at).check(0).out)
        tap.equal((told["bottom"], told["triangles"], len(told["meshes"])), ("none", 27, 41))
        tap.equal([told["meshes"][0][key] for key in ("name", "triangles", "dropped_facets", "open_edges", "moves")],
                  ["frame", 3, 1, 3, False])


def test_places_are_checked_against_meshes():
    floor = "v -50 -50 -20\nv 150 -50 -20\nv 150 50 -20\nv -50 50 -20\nf 1 2 3\nf 1 3 4\n"
    scene = MINIMAL.replace("depth_m: 12", "mesh: floor.obj")
    with folder(floor_obj=floor, up_yaml=scene.replace("floor.obj", "{file: floor.obj, z_up: false}"),
                ok_yaml=scene, deep_yaml=scene.replace("0, 7]", "0, 27]")) as at:
        [ok] = json.loads(asdic("check", "ok.yaml", "--json", cwd=at).check(0).out)
        tap.equal((ok["bottom"], ok["meshes"][0]["max_m"]), ("mesh", [50, 150, 20]))
        up = asdic("check", "up.yaml", cwd=at)
        tap.equal(up.code, 3)
        tap.contains(up.err, "up.yaml:2:23: error: the bottom lies above the sea surface, from z = "
                             "-20 to -20 m; give 'z_up: true' if it is upside down, or "
                             "'position_m'  [bottom.mesh.file]\n")
        deep = asdic("check", "deep.yaml", cwd=at)
        tap.equal(deep.code, 3)
        tap.contains(deep.err, "the sonar is at z = 27 m, below the bottom at 20 m; raise it or lower the bottom  [mission.pose.position_m[2]]")


def test_objects_out_of_reach_are_remarked_on():
    scene = MINIMAL.replace("mission:", """objects:
  - {name: sky, sphere: {radius_m: 1}, position_m: [0, 0, -5]}
  - {name: far, sphere: {radius_m: 1}, position_m: [80, 0, 5]}
  - {name: near, sphere: {radius_m: 1}, position_m: [75, 0, 7]}
mission:""")
    done = asdic("check", "-", stdin=scene)
    tap.equal(done.code, 0)
    tap.equal(done.err, "stdin:8:5: warning: object 'sky' lies above the sea surface; z is "
                        "positive down  [objects[0]]\n"
                        "stdin:9:5: warning: object 'far' is beyond the maximum range: "
                        "79.01 m away, heard to 74.51 m  [objects[1]]\n")


def remarks_on(scene):
    done = asdic("check", "-", stdin=scene).check(code=0)
    return re.sub(r"(stdin|-)(:\d+)*: ", "", done.err)


def test_what_is_hardly_meant_is_remarked_on():
    objects = """objects:
  - {name: grave, sphere: {radius_m: 1}, position_m: [20, 0, 13.5]}
  - {name: sunk, sphere: {radius_m: 1}, position_m: [20, 0, 12.5]}
  - {name: tank, cylinder: {radius_m: 2, length_m: 6}, position_m: [0, 0.5, 7]}
  - {name: beside, sphere: {radius_m: 2}, position_m: [1.2, 1.2, 8.2]}
mission:"""
    # The pose is 2.08 m from the middle of the last: in the box round it, not in it.
    tap.equal(remarks_on(MINIMAL.replace("mission:", objects)),
              "warning: object 'grave' lies wholly below the bottom; z is positive down  [objects[0]]\n"
              "warning: object 'tank' has the sonar inside it at ping 0  [objects[2]]\n")
    tap.equal(remarks_on(MINIMAL.replace("  source", "  bandwidth_khz: 0.75\n  source")), "")
    tap.contains(remarks_on(MINIMAL.replace("  source", "  bandwidth_khz: 0.149\n  source")),
                 "remark: sonar: the range resolution c / (2 bandwidth) of 5 m is 10 bins, of which each holds "
                 "its part of an echo, 10.0 dB less than all; 'bandwidth_khz' is 0.149 kHz")
    tap.equal(remarks_on(MINIMAL.replace("depth_m: 12", "depth_m: 81")), "")
    tap.equal(remarks_on(MINIMAL.replace("depth_m: 12", "depth_m: 82")),
              "warning: the bottom is never in range: 75 m away, heard to 74.51 m  [bottom]\n")


def test_bodies_of_few_wavelengths_are_remarked_on():
    """Of 15 mm, k a is 5.03 at a radius of 12 mm."""
    ball = "objects:\n  - {name: %s, sphere: {radius_m: %g}, position_m: [5, 0, 7]}\n"
    tap.equal(remarks_on(MINIMAL.replace("mission:", ball % ("a", 0.012) + "mission:")), "")
    both = ball % ("a", 0.011) + (ball % ("b", 0.007)).split("\n", 1)[1]
    tap.equal(remarks_on(MINIMAL.replace("mission:", both + "mission:")),
              "remark: objects: of 'b' k a is 3, and 2 in all have less than 5: too small for rays and facets; a "
              "'point' has the strength that is known of it\n")


def test_facets_of_smooth_bodies_in_coherent_pings_are_remarked_on():
    """33.33 wavelengths of radius need pi / 0.3 of each, 350; 200 the twenty pi of their root, 889; 500 more than there are."""
    scene = """version: 1
environment: {sound_speed_mps: 1500}
bottom: {none: true}
objects: [{name: ball, sphere: {radius_m: 0.5}, position_m: [9, 0, 7], material: {impedance_mrayl: 45, slope_rms: 0}}]
sonar:
  frequency_khz: 100
  max_range_m: 25
  source_level_db: 200
  array: {elements: 2, spacing_wl: 0.5, element: {length_v_m: 0.05}, beams: {count: 1, sector_deg: 10}}
mission: {pose: {position_m: [0, 0, 7]}}
sampling: {coherent: true, rays: 3000}
"""
    says = ("warning: object 'ball' is smooth and has {} 'segments', each a flat mirror: in coherent pings its level may "
            "be wrong by 10 dB; {} 'segments: {}'  [objects[0]]\n")

    def remarked(*changes):
        text = scene
        for old, new in changes:
            text = text.replace(old, new)
        return [line + "\n" for line in remarks_on(text).splitlines() if "smooth" in line]
    tap.equal(remarked(), [says.format(96, "give", 350)])
    tap.equal(remarked(("0.5}", "0.5, segments: 349}")), [says.format(349, "give", 350)])
    tap.equal(remarked(("0.5}", "0.5, segments: 350}")), [])
    tap.equal(remarked(("sphere: {radius_m: 0.5}", "cylinder: {radius_m: 3, length_m: 1}")), [says.format(96, "give", 889)])
    tap.equal(remarked(("0.5}", "7.5}"), ("[9,", "[20,")), [says.format(96, "closest comes", 1024)])
    tap.equal(remarked(("0.5}", "7.5, segments: 1024}"), ("[9,", "[20,")), [])
    tap.equal(remarked(("coherent: true, ", "")), [])
    tap.equal(remarked((", slope_rms: 0", "")), [])


def test_motion_within_a_ping_is_remarked_on():
    """A ping of 0.1 s and beams of 15 degrees; 50 m/s are ten bins of 0.5 m, 150 degrees per second a beam."""
    with folder(own_yaml="") as at:
        def remarks(speed_mps, turn_dps, sonar="sonar:\n"):
            rows = "".join(f"{s},{speed_mps * s},0,7,0,0,{turn_dps * s}\n" for s in range(3))
            pathlib.Path(at, "track.csv").write_text("time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + rows)
            scene = re.sub(r"mission:.*", "mission: {track: track.csv, pings: 10}", MINIMAL, flags=re.DOTALL)
            pathlib.Path(at, "scene.yaml").write_text(scene.replace("sonar:\n", sonar))
            return asdic("check", pathlib.Path(at, "scene.yaml")).check(0).err
        tap.equal(remarks(45, 0), "")
        tap.contains(remarks(60, 0), "remark: mission: until the last echo of a ping the vehicle goes up to 6 m and "
                     "turns up to 0 degrees, of beams of ")
        tap.equal(remarks(0, 90), "")
        tap.contains(remarks(0, 170), "turns up to 17 degrees")
        scan = "sonar:\n  scan: {sector_deg: 360, step_deg: 60}\n"
        tap.equal(remarks(0, 0, scan), "", "a head that is scanned turns between pings")


def test_a_missing_source_level_is_remarked_on():
    without = MINIMAL.replace("  source_level_db: 0\n", "")
    quiet = without.replace("sonar:\n", "sonar:\n  noise: {enabled: false}\n")
    tap.equal(remarks_on(MINIMAL), "")
    tap.equal(remarks_on(quiet), "remark: sonar: no 'source_level_db': levels are those of a source of 0 dB re 1 uPa at "
                                 "1 m\n")
    tap.equal(remarks_on(without), "remark: sonar: no 'source_level_db': echoes are those of a source of 0 dB re 1 uPa "
                                   "at 1 m, far below the noise, which is absolute; give one, or 'noise: {enabled: "
                                   "false}'\n")
    with folder(own_yaml="frequency_khz: 100\nsource_level_db: 0\nreceivers: [{name: a}]\n") as at:
        path = pathlib.Path(at, "scene.yaml")
        path.write_text("version: 1\nbottom: {depth_m: 12}\nsonar: {file: own.yaml}\n"
                        "mission: {pose: {position_m: [0, 0, 7]}}\n")
        tap.equal(asdic("check", path).check(0).err, "")


def test_moving_objects_out_of_place_are_remarked_on():
    """Judged over all pings: what is in place at one of them is not remarked on."""
    head = "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n"
    tracks = {"sunk": "0,20,0,15,0,0,0\n9,30,0,14,0,0,0\n", "rises": "0,20,0,15,0,0,0\n9,20,0,12.5,0,0,0\n",
              "far": "0,900,0,6,0,0,0\n9,100,0,6,0,0,0\n", "comes": "0,900,0,6,0,0,0\n9,60,0,6,0,0,0\n",
              # A long box passes over the sonar: turned across its way in time it does not.
              "hits": "0,30,0,7,0,0,0\n9,5.5,0,7,0,0,0\n", "turns": "0,30,0,7,0,0,0\n9,5.5,0,7,0,0,90\n"}
    shapes = {name: "box: {size_m: [12, 2, 2]}" if name in ("hits", "turns") else "sphere: {radius_m: 1}"
              for name in tracks}
    objects = "objects:\n" + "".join(
        f"  - {{name: {name}, {shapes[name]}, track: {name}.csv}}\n" for name in tracks)
    files = {f"{name}_csv": head + rows for name, rows in tracks.items()}
    with folder(**files) as at:
        path = pathlib.Path(at, "scene.yaml")
        path.write_text(MINIMAL.replace("mission:", objects + "mission:") + "  pings: 91\n")
        scene = path.read_text().replace("frequency", "ping_rate_hz: 10\n  frequency")
        path.write_text(scene)
        said = asdic("check", path).check(0).err
        found = re.findall(r"object '(\w+)' (.*?)(?:;|:|  \[)", said)
        tap.equal(found[:-1], [("sunk", "lies wholly below the bottom"), ("far", "is beyond the maximum range")])
        tap.equal(re.sub(r"\d+$", "N", found[-1][1]), "has the sonar inside it at ping N")
        tap.equal(found[-1][0], "hits")
        tap.contains(said, "99 m away")


def test_objects_far_from_a_track_are_remarked_on():
    track = "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n0,0,0,7,0,0,0\n10,100,0,7,0,0,0\n"
    scene = (MINIMAL.replace("pose: {position_m: [0, 0, 7]}", "track: t.csv").replace(
        "{depth_m: 12}", "{mesh: {file: floor.obj, z_up: false}, position_m: [%s, 0, 0]}").replace(
            "mission:", """objects:
  - {name: met, sphere: {radius_m: 1}, position_m: [160, 0, 10]}
  - {name: far, sphere: {radius_m: 1}, position_m: [5100, 0, 10]}
  - {name: round, box: {size_m: [4, 4, 4]}, position_m: [10, 0, 8]}
mission:"""))
    floor = "v -100 -80 20\nv 200 -80 20\nv 200 80 20\nv -100 80 20\nf 1 2 3\nf 1 3 4\n"
    with folder(floor_obj=floor, t_csv=track, here_yaml=scene % 0, away_yaml=scene % 400000) as at:
        here = asdic("check", "here.yaml", cwd=at).check(code=0).err
        away = asdic("check", "away.yaml", cwd=at).check(code=0).err
    tap.equal(here.count("warning"), 2, here)
    tap.contains(here, "object 'far' is beyond the maximum range: 4999 m away, heard to 74.51 m")
    tap.contains(here, "object 'round' has the sonar inside it at ping ")
    tap.contains(away, "the bottom is never in range: 3.998e+05 m away, heard to 74.51 m  [bottom]")


def test_upright_bottom_is_remarked_on():
    # A floor of 100 m by 80 m, 10 m deep and more, as modellers with y up write it.
    floor = "v 0 -10 0\nv 100 -10 0\nv 100 -12 -80\nv 0 -12 -80\nf 1 2 3\nf 1 3 4\n"
    scene = MINIMAL.replace("{depth_m: 12}", "{mesh: floor.obj, position_m: [0, 0, 80]}")
    with folder(floor_obj=floor, up_yaml=scene,
                ok_yaml=scene.replace("80]", "0], rotation_deg: [0, 90, 0]")) as at:
        up = asdic("check", "up.yaml", cwd=at)
        tap.contains(up.err, "up.yaml:2:16: warning: the bottom stands upright: 2 m north, 100 m "
                             "east, 80 m down; if its file has y up, give 'rotation_deg: "
                             "[0, 90, 0]' beside 'mesh'  [bottom.mesh]\n")
        ok = asdic("check", "ok.yaml", cwd=at)
        tap.equal((ok.code, ok.err), (0, ""))
        # North is -z, east x, down -y.
        tap.contains(ok.out, "x 0 .. 80, y 0 .. 100, z 10 .. 12 m")


def test_tracks_give_the_pings():
    track = "time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n100,0,0,5,0,0,0\n105,10,0,{},0,0,0\n"
    scene = MINIMAL.replace("pose: {position_m: [0, 0, 7]}", "track: t.csv")
    with folder(t_csv=track.format(6), s_yaml=scene, deep_csv=track.format(13),
                d_yaml=scene.replace("t.csv", "deep.csv"), many_yaml=scene + "  pings: 52\n",
                few_yaml=scene + "  pings: 51\n", bad_csv="time_s,x_m\n",
                b_yaml=scene.replace("t.csv", "bad.csv")) as at:
        tap.contains(asdic("check", "s.yaml", cwd=at).out, "  pings       51 in 5 s\n")
        tap.equal(asdic("check", "few.yaml", cwd=at).code, 0)
        tap.contains(asdic("check", "many.yaml", cwd=at).err,
                     "many.yaml:9:10: error: 'pings' = 52 is more than the 51 that 'track' covers "
                     "at ping_rate_hz = 10; leave 'pings' out for all of it  [mission.pings]\n")
        tap.contains(asdic("check", "d.yaml", cwd=at).err,
                     "d.yaml:8:10: error: ping 44 at 104.4 s: the sonar is at z = 12.04 m, below "
                     "the bottom at 12 m; raise it or lower the bottom  [mission.track]\n")
        for end, code, said in ((100000099.9, 0, "  pings       1000000000 in "), (100000100, 3, (
                "s.yaml:8:10: error: 'track' covers 1000000001 pings, at most 1e9 are possible; give 'pings'"))):
            with open(os.path.join(at, "t.csv"), "w", encoding="ascii") as file:
                file.write(track.format(6).replace("\n105", f"\n{end!r}"))
            done = asdic("check", "s.yaml", cwd=at).check(code)
            tap.contains(done.err if code else done.out, said)
        bad = asdic("check", "b.yaml", cwd=at)
        tap.equal(bad.code, 3)
        tap.contains(bad.err, "bad.csv:1:1: error: missing column 'y_m'")
        tap.contains(bad.err, "error: b.yaml: 5 errors\n")


def test_tracks_may_begin_at_any_time():
    """As loggers do that count seconds from 1970: what a track was made of is what it gives."""
    scene = MINIMAL.replace("pose: {position_m: [0, 0, 7]}", "track: t.csv")
    for pings in 2, 4, 7, 9, 51:
        rows = "".join(f"{1700000000 + k / 10:.1f},{k},0,5,0,0,0\n" for k in range(pings))
        with folder(t_csv="time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + rows, s_yaml=scene) as at:
            written = asdic("check", "s.yaml", "--track", "-", cwd=at).out.splitlines()
            tap.equal(len(written) - 1, pings, "pings")
            tap.equal([row.split(",")[1] for row in written[1:]], [str(k) for k in range(pings)], "places")


def test_tracks_may_be_rounded_to_milliseconds():
    """Nothing is lost of a track that has a point for each ping; a way that ends before the next has no more."""
    for rate, times, pings in ((3, [f"{k / 3:.3f}" for k in range(11)], 11), (7, [f"{k / 7:.3f}" for k in range(9)], 9),
                               (3, ["0", "3.332"], 10), (3, ["0", "3.3325"], 11), (60, ["0", "0.999"], 61),
                               (400, ["0", "0.0097"], 4), (400, ["0", "0.0098"], 5)):
        scene = (MINIMAL.replace("pose: {position_m: [0, 0, 7]}", "track: t.csv")
                 .replace("source_level_db: 0", f"ping_rate_hz: {rate}"))
        rows = "".join(f"{time},{k},0,5,0,0,0\n" for k, time in enumerate(times))
        with folder(t_csv="time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg\n" + rows, s_yaml=scene) as at:
            written = asdic("check", "s.yaml", "--track", "-", cwd=at).check().out.splitlines()
            tap.equal(len(written) - 1, pings, f"pings at {rate} Hz to {times[-1]} s")
            place = min((pings - 1) / rate / float(times[-1]), 1.0) * (len(times) - 1)
            tap.equal(round(float(written[-1].split(",")[1]) - place, 2), 0.0, "how far from its place the last one is")


def test_waypoints_are_flown_and_written():
    scene = MINIMAL.replace("pose: {position_m: [0, 0, 7]}",
                            "waypoints: [[0, 0, 7], [60, 0, 7], [60, 40, 9]]")
    with folder(s_yaml=scene, replay_yaml=scene.replace(
            "waypoints: [[0, 0, 7], [60, 0, 7], [60, 40, 9]]", "track: t.csv")) as at:
        flown = asdic("check", "s.yaml", cwd=at)
        tap.equal((flown.code, flown.err), (0, ""))
        written = asdic("check", "s.yaml", "--track", "t.csv", cwd=at)
        tap.equal((written.code, written.out, written.err), (0, "", ""))
        lines = pathlib.Path(at, "t.csv").read_text().splitlines()
        tap.equal(lines[:2], ["time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg", "0,0,0,7,0,0,0"])
        tap.contains(flown.out, f"  pings       {len(lines) - 1} in ")
        told = [re.sub(r"; .* free$", "", done.out.partition("\n")[2].rstrip())  # others write meanwhile
                for done in (asdic("check", "replay.yaml", cwd=at), flown)]
        tap.equal(told[0], told[1])
        again = asdic("check", "replay.yaml", "--track", "-", cwd=at)
        tap.equal(again.out.splitlines(), lines, "the same track, to the last digit")
        refused = asdic("check", "s.yaml", "--track", "t.csv", cwd=at)
        tap.equal((refused.code, refused.err), (1, "error: 't.csv' exists; --force overwrites it\n"))
        tap.equal(asdic("check", "s.yaml", "--track", "t.csv", "--force", cwd=at).code, 0)
        tap.equal(asdic("check", "s.yaml", "replay.yaml", "--track", "u.csv", cwd=at).code, 2)
        with open(os.path.join(at, "v.csv"), "w", encoding="utf-8") as file:  # which is there, and not asked for by name
            subprocess.run([program.PATH, "check", "s.yaml", "--track", "/dev/stdout"], cwd=at, stdout=file, check=True)
        tap.equal(pathlib.Path(at, "v.csv").read_text().splitlines(), lines, "to the standard output by its name")


def quick(*command):
    """As asdic, but a command that waits for input is a failure."""
    done = subprocess.run([program.PATH, *command], capture_output=True, text=True, check=False, timeout=60)
    tap.equal((done.returncode, done.stdout), (3, ""))
    return done.stderr


def test_a_key_without_its_colon_is_named():
    """libyaml misses the colon where the next key's stands."""
    done = asdic("check", "-", stdin=MINIMAL.replace("source_level_db: 0", "source_level_db 0")).check(3)
    tap.contains(done.err, "stdin:5:3: error: not valid YAML: could not find expected ':' after this key")


def test_limits_of_whole_numbers_are_whole():
    done = asdic("check", "-", stdin=MINIMAL + "sampling: {seed: -1}\n").check(3)
    tap.contains(done.err, "'seed' = -1 is out of range [0, 9007199254740992]")
    asdic("check", "-", stdin=MINIMAL + "sampling: {seed: 9007199254740992}\n").check(0)
    done = asdic("check", "-", stdin=MINIMAL + "sampling: {seed: 9007199254740993}\n").check(3)
    tap.contains(done.err, "'seed' = 9007199254740993 is too large: whole numbers go to 2^53")


def test_odd_inputs_are_refused():
    for path, words in (("/nonexistent/a.yaml", "cannot open"), ("/tmp", "Is a directory"),
                        ("/dev/null", "the file is empty")):
        done = asdic("check", path)
        tap.equal((done.code, done.out), (3, ""))
        tap.contains(done.err, words)
    tap.contains(asdic("plan", "/tmp").check(3).err, "Is a directory; give a scene file")
    grid = MINIMAL.replace("depth_m: 12", "grid: g.nc")
    with folder(s_yaml=re.sub(r"mission:.*", "mission: {track: t}", MINIMAL, flags=re.DOTALL)) as at:
        track = pathlib.Path(at, "t")
        os.mkfifo(track)
        tap.contains(quick("check", f"{at}/s.yaml"), "t: not a regular file")
        track.unlink()
        track.symlink_to("/dev/zero")
        tap.contains(quick("check", f"{at}/s.yaml"), "t: not a regular file")
        os.mkfifo(f"{at}/m.obj")
        tap.contains(quick("check", f"{at}/m.obj"), "m.obj: not a regular file")
        piped = subprocess.run(["bash", "-c", '"$0" check <(printf "%s" "$1")', program.PATH, MINIMAL],
                               capture_output=True, text=True, check=False, timeout=60)
        tap.contains(piped.stdout, ": a valid scene")
    with folder(a_dae="<x/>", g_nc=b"CDF\x02\0\0\0\0", s_yaml=grid) as at:
        tap.contains(asdic("check", "a.dae", cwd=at).err, "'.dae' is not a mesh format")
        words = "netCDF grids are not supported yet in this version; 'gdal_translate -of AAIGrid"
        tap.contains(asdic("check", "g.nc", cwd=at).err, words)
        tap.contains(asdic("check", "s.yaml", cwd=at).err, words)
    with folder(big_yaml=b"#" * (4 << 20) + b"\n") as at:
        done = asdic("check", "big.yaml", cwd=at)
        tap.equal(done.code, 3)
        tap.contains(done.err, "longer than 4194304 bytes")


def test_encodings_make_no_difference():
    plain = asdic("check", "-", stdin=MINIMAL).out
    for encoded in (MINIMAL.encode("utf-16"), MINIMAL.encode("utf-8-sig"),
                    b"\xfe\xff" + MINIMAL.encode("utf-16-be"),
                    MINIMAL.replace("\n", "\r\n").encode()):
        done = asdic("check", "-", stdin=encoded)
        tap.equal((done.code, done.out, done.err), (0, plain, ""))


def test_laws_beyond_their_sources_are_remarked_once():
    beyond = MINIMAL.replace("frequency_khz: 100", "frequency_khz: 600").replace(
        "version: 1", "version: 1\nenvironment: {temperature_degc: 28, salinity_ppt: 7}")
    with folder(s_yaml=beyond, fixed_yaml=beyond.replace("salinity_ppt: 7", "salinity_ppt: 33, sound_speed_mps: 1500")
                .replace("28", "36").replace("{depth_m: 12}", "none").replace("bottom:", "surface: {enabled: false}\nbottom:"),
                within_yaml=MINIMAL) as at:
        expected = [
            "absorption: outside the validity of its source, with 't_degc' = 28 not in [-2, 22], "
            "'s_ppt' = 7 not in [30, 35]",
            "bottom-backscatter: outside the validity of its source, with 'f_khz' = 600 not in [50, 400]",
            "surface-backscatter: outside the validity of its source, with 'f_khz' = 600 not in [1, 400]"]
        scene = os.path.join(at, "s.yaml")
        lines = "".join(f"{scene}: remark: {text}\n" for text in expected)
        tap.equal(asdic("check", scene).check(code=0).err, lines)
        tap.equal(asdic("plan", "--no-forecast", scene).check(code=0).err, lines)
        for command in (["check", "--json"], ["plan", "--json", "--no-forecast"]):
            found = json.loads(asdic(*command, scene).check(code=0, err="").out)
            tap.equal((found[0] if command[0] == "check" else found)["remarks"], expected)
        # A speed that is given needs no law; what is not there is not remarked on.
        [fixed] = json.loads(asdic("check", "--json", os.path.join(at, "fixed.yaml")).check(code=0).out)
        tap.equal(fixed["remarks"], ["absorption: outside the validity of its source, with "
                                     "'t_degc' = 36 not in [-2, 22]"])
        asdic("check", os.path.join(at, "within.yaml")).check(code=0, err="")
        need_device()
        done = asdic("run", scene, "--rays", "4000", "-o", os.path.join(at, "out")).check(code=0)
        tap.equal(done.err.startswith(lines), True, "remarks come first")
        tap.equal(done.err.count("remark"), 3)
        asdic("run", "-q", "--force", scene, "--rays", "4000", "-o", os.path.join(at, "out")).check(0, "", "")
        with open(os.path.join(at, "out", "run.json"), encoding="utf-8") as file:
            tap.equal(json.load(file)["remarks"], expected)
        asdic("merge", "-q", os.path.join(at, "out"), "-o", os.path.join(at, "all")).check(0, "", "")
        with open(os.path.join(at, "all", "run.json"), encoding="utf-8") as file:
            tap.equal(json.load(file)["remarks"], expected, "remarks of a merged run")


def test_depth_of_absorption_water_and_facets_beyond_their_sources_are_remarked():
    """As `asdic model` warns of the same numbers."""
    deep = MINIMAL.replace("version: 1", "version: 1\nenvironment: {max_depth_m: 9000}")
    ball = "\nobjects: [{name: ball, sphere: {radius_m: 0.5}, position_m: [20, 0, 8], material: {slope_rms: %s}}]"
    high = MINIMAL.replace("frequency_khz: 100", "frequency_khz: 2500").replace("{depth_m: 12}", "none")
    with folder() as at:
        for scene, remarks in (
                (deep, ["absorption: outside the validity of its source, with 'z_m' = 9000 not in [0, 3500]"]),
                (high.replace("bottom:", "surface: {enabled: false}\nbottom:"), [
                    "absorption: outside the validity of its source, with 'f_khz' = 2500 not in [0.2, 1000]",
                    "volume-backscatter: outside the validity of its source, with 'f_khz' = 2500 not in [0.1, 1000]"]),
                (MINIMAL + ball % 0.31, []),
                (MINIMAL + ball % 0.7, ["rough-facet: outside the validity of its source, with 'slope_rms' = 0.7 not in "
                                        "[0, 0.316228]"])):
            path = os.path.join(at, "scene.yaml")
            with open(path, "w", encoding="utf-8") as file:
                file.write(scene)
            [found] = json.loads(asdic("check", "--json", path).check(code=0).out)
            tap.equal([text for text in found["remarks"] if "outside" in text], remarks)


def test_numbers_of_a_sediment_beyond_the_handbook_are_remarked():
    handbook = MINIMAL.replace("frequency_khz: 100", "frequency_khz: 300").replace(
        "{depth_m: 12}", "{depth_m: 12, sediment: medium_sand, density_ratio: 4}").replace(
            "version: 1", "version: 1\nsurface: {law: apl}")
    with folder(s_yaml=handbook, two_yaml=handbook.replace("density_ratio: 4", "grain_size_phi: 2"),
                within_yaml=handbook.replace("300", "30").replace("density_ratio: 4", "density_ratio: 2")) as at:
        [found] = json.loads(asdic("check", "--json", os.path.join(at, "s.yaml")).check(code=0).out)
        tap.equal(found["remarks"], [
            "apl-bottom: outside the validity of its source, with 'density_ratio' = 4 not in [1, 3], "
            "'f_khz' = 300 not in [10, 100]",
            "apl-surface: outside the validity of its source, with 'f_khz' = 300 not in [10, 100]"])
        asdic("check", os.path.join(at, "within.yaml")).check(code=0, err="")
        done = asdic("check", os.path.join(at, "two.yaml")).check(code=3)
        tap.contains(done.err, "'sediment' and 'grain_size_phi' exclude each other")


def test_sizes_are_told_in_units_that_fit():
    """In kB to PB, by three digits of what --json has in bytes; of the disk's room too, which others take of meanwhile."""
    units, seen = ["kB", "MB", "GB", "TB", "PB"], set()
    for pings in 1, 40, 30000, 10**6, 10**9:
        for fan in "[{name: a}]", "{fan: {count: 1024, sector_deg: 90, length_h_m: 0.1, length_v_m: 0.1}}":
            text = MINIMAL.replace("pose:", f"pings: {pings}\n  pose:").replace(
                "[{name: forward}, {name: port, yaw_deg: -20}]", fan)
            said = asdic("check", "-", stdin=text).check(code=0).out
            [found] = json.loads(asdic("check", "--json", "-", stdin=text).check(code=0).out)
            found = found["output"]
            told = re.search(r"output +(\S+) (\S+) a ping, (\S+) (\S+) in all; (\S+) (\S+) free\n", said).groups()
            for at, (key, off) in enumerate((("ping_bytes", 0.005), ("bytes", 0.005), ("free_bytes", 0.1))):
                number, unit = float(told[2 * at]), units.index(told[2 * at + 1])
                tap.equal(number < 1000 and (number >= 1 or unit == 0), True, f"{number} {units[unit]}")
                tap.equal(abs(number * 1000**(unit + 1) / found[key] - 1) < off, True, f"{told} of {found}")
                seen.add(unit)
            tap.equal(found["bytes"] >= pings * found["ping_bytes"], True, "all pings")
            tap.equal(found["fits"], found["bytes"] <= found["free_bytes"], f"{found}")
    tap.equal(seen, set(range(5)), "units")


def test_pictures_count_in_the_size():
    """A waterfall a beam, or one of all where beams are many; ping by ping pictures of the first and the last."""
    def size(image, beams, pings):
        text = MINIMAL.replace("pose:", f"pings: {pings}\n  pose:").replace(
            "[{name: forward}, {name: port, yaw_deg: -20}]", f"{{fan: {{count: {beams}, sector_deg: 90}}}}")
        output = f"output: {{csv: none, images: [{image}]}}\n"
        [found] = json.loads(asdic("check", "--json", "-", stdin=text + output).check(code=0).out)
        return found["output"]["bytes"]

    def of(image, beams, pings):
        return size(image, beams, pings) - size("", beams, pings)

    one = of("waterfall", 1, 40)
    tap.equal((one > 10000, of("waterfall", 3, 40), of("waterfall", 512, 40), of("waterfall", 3, 1)), (True, 3 * one, one, 0))
    one = of("ascope", 3, 1)
    tap.equal((one > 10000, of("ascope", 3, 40)), (True, 2 * one))
    one = of("fan", 20, 1)
    tap.equal((one > 10000, of("fan", 20, 40), of("fan", 1, 40)), (True, 2 * one, 0))
    tap.equal((of("overview", 3, 40) > 10000, of("overview", 3, 1), of("plan", 3, 1) > 10000), (True, 0, True))


def test_errors_are_foretold():
    """Of many rays and of few: what check says before a run is within a factor of 2 of what its bins state."""
    need_device()
    scene = (DATA / "scenes/sonar_p900.yaml").read_text(encoding="ascii").replace("../sonars", str(DATA / "sonars"))
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder, "s.yaml")
        for rays in 20000, 100000:
            path.write_text(re.sub("rays: .*", f"rays: {rays}}}", scene) + "output: {csv: none, images: []}\n", encoding="ascii")
            said = asdic("check", path).check(code=0).out
            told = float(re.search(r"for a stated error of about ([\d.]+) dB", said)[1])
            asdic("run", path, "-o", f"{folder}/out", "-f", "-q").check(code=0)
            stated = json.loads(pathlib.Path(folder, "out/run.json").read_text(encoding="utf-8"))["stderr_db"]["rms"]
            tap.equal(0.5 < stated / told < 2, True, f"{rays} rays: {told} dB foretold, {stated} stated")


tap.main(globals())
