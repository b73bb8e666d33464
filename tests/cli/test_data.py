"""data/: every scene and mesh is valid, and the generators make what is there."""
import json
import pathlib
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
    for scene in checked(*scenes):
        tap.equal((scene["kind"], scene["valid"]), ("scene", True))


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
        tap.equal(len(made), 15, "number of files")
        for path in made:
            kept = DATA / path.relative_to(folder)
            tap.equal(path.read_bytes() == kept.read_bytes(), True, f"{kept} is as made")


def test_flat_faces_are_not_cut():
    need_device()
    with Folder() as folder:  # a face of the box is met square on, by rays that stand for much
        done = asdic("run", "-q", DATA / "scenes" / "sonar_m1200d.yaml", "-o", folder / "out")
        tap.equal((done.code, done.err), (0, ""))


tap.main(globals())
