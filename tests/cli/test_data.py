"""data/: every scene and mesh is valid, and the generators make what is there."""
import csv
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

import tap
from program import Folder, asdic, need_device

DATA = pathlib.Path(__file__).resolve().parents[2] / "data"


def checked(*paths):
    done = asdic("check", "--json", *paths)
    tap.equal((done.code, done.err), (0, ""))
    return json.loads(done.out)


def test_scenes_are_valid():
    scenes = sorted((DATA / "scenes").glob("*.yaml"))
    tap.equal(len(scenes) >= 14, True, "14 scenes or more")
    scenes += sorted((DATA / "datasets").glob("*.yaml"))
    for scene in checked(*scenes):
        tap.equal((scene["kind"], scene["valid"]), ("scene", True))


def test_trials_are_valid():
    """A trial's path may lead into what its vehicle shall notice: of that alone there is a warning."""
    scenes = [DATA / "trials" / f"{name}.yaml" for name in ("cliff", "net", "pile", "rise")]
    done = asdic("check", "--json", *scenes)
    others = [line for line in done.err.splitlines() if "has the sonar inside it" not in line]
    tap.equal((done.code, others), (0, []))
    for scene in json.loads(done.out):
        tap.equal((scene["kind"], scene["valid"]), ("scene", True))


def test_scenes_have_rays_enough():
    """Nobody is told that a scene of ours has too few; those of benches are as they were measured."""
    for scene in checked(*sorted((DATA / "scenes").glob("*.yaml"))):
        if not pathlib.Path(scene["file"]).name.startswith("bench_"):
            tap.equal([r for r in scene["remarks"] if r.startswith("rays:")], [], scene["file"])


def test_mission_is_long_and_detailed():
    [scene] = checked(DATA / "scenes" / "mission.yaml")
    tap.equal(scene["pings"] >= 200, True, "200 pings or more")
    tap.equal(3 <= len(scene["beams"]) <= 6, True, "3 to 6 beams")
    tap.equal(max(mesh["triangles"] for mesh in scene["meshes"]) >= 100000, True,
              "100,000 triangles or more in one mesh")


def test_solids_are_closed():
    meshes = checked(DATA / "meshes" / "rocks.ply", DATA / "meshes" / "wreck.ply")
    tap.equal([mesh["open_edges"] for mesh in meshes], [0, 0], "open edges")


def test_generators_make_the_files():
    with tempfile.TemporaryDirectory() as folder:
        for script in sorted((DATA / "generate").glob("make_*.py")):
            subprocess.run([sys.executable, script, folder], check=True,
                           stdout=subprocess.DEVNULL)
        made = [path for path in pathlib.Path(folder).rglob("*") if path.is_file()]
        all_kept = [path for place in ("meshes/*", "tracks/*", "casts/*", "sonars/*", "scenes/sonar_*") for path in DATA.glob(place)]
        tap.equal(sorted(path.relative_to(folder) for path in made),
                  sorted(path.relative_to(DATA) for path in all_kept))
        for path in made:
            kept = DATA / path.relative_to(folder)
            tap.equal(path.read_bytes() == kept.read_bytes(), True, f"{kept} is as made")


def test_flat_faces_are_not_cut():
    need_device()
    with Folder() as folder:  # a face of the box is met square on, by rays that stand for much
        done = asdic("run", "-q", DATA / "scenes" / "sonar_m1200d.yaml", "-o", folder / "out")
        tap.equal((done.code, done.err), (0, ""))


def test_sonars_name_the_source_of_every_value():
    for path in sorted((DATA / "sonars").glob("*.yaml")):
        text = path.read_text(encoding="ascii")
        sources = set(re.findall(r"^# (\[\d\]) ", text, re.M))
        sonar = "".join(re.findall(r"^[^#\n].*\n", text, re.M))
        cited = set(re.findall(r"\[\d\]", sonar))
        tap.equal(cited <= sources, True, f"{path.name} lists what it cites")
        for line in sonar.splitlines():
            if re.search(r"^ *(frequency|bandwidth|source|count|sector|step|length)\w*:", line):
                tap.equal(bool(re.search(r"# .*(\[\d\]|assumed|the sector)", line)), True, f"{path.name}: {line}")


def test_scenes_take_their_sonar_from_a_file():
    scenes = sorted((DATA / "scenes").glob("sonar_*.yaml"))
    for scene in scenes:
        tap.contains(scene.read_text(encoding="ascii"),
                     f"sonar: {{file: ../sonars/{scene.name.removeprefix('sonar_')}}}")
    tap.equal(len(scenes), len(list((DATA / "sonars").glob("*.yaml"))), "a scene for each")


def test_beams_may_be_unevenly_spread():
    need_device()
    scene, sonar = DATA / "scenes" / "sonar_aris1200.yaml", DATA / "sonars" / "aris1200.yaml"
    bearings = [float(x) for x in re.findall(r"yaw_deg: (\S+),", sonar.read_text(encoding="ascii"))]
    steps = [b - a for a, b in zip(bearings, bearings[1:])]
    tap.equal((len(bearings), steps[23] > 1.5 * steps[0]), (48, True), "wide in the middle, narrow at the sides")
    done = asdic("run", "-q", "--rays", "50000", scene, "-o", "-").check(code=0, err="")
    rows = [row for row in csv.DictReader(done.out.splitlines())
            if row["object_db"] and 26.5 < float(row["range_m"]) < 27.5]
    pile = bearings[int(max(rows, key=lambda row: float(row["object_db"]))["beam"])]
    off_deg = abs(pile - math.degrees(math.atan2(4, 27)))
    tap.equal(off_deg < 0.35, True, f"a pile {off_deg:.2f} degrees off its beam, little over half a step")


tap.main(globals())
