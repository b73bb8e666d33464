"""Broken meshes that others collected: each loads with as many triangles, in the same box, as a
reader written apart counts (support/mesh_count.py), or is refused for the reason it should be.

Here are those of the npm package stl-models 0.12.0; Debian's assimp-testmodels has more.
"""
import json
import math
import pathlib

import mesh_count
import tap
from program import asdic

BROKEN = pathlib.Path(__file__).resolve().parents[1] / "fuzz" / "corpus" / "stl"
ASSIMP = pathlib.Path("/usr/share/assimp/models")

# What is refused, and words of the reason; everything else must load.
BROKEN_REFUSED = {
    "broken_empty.stl": "the file is empty",
    "broken_fourVertices.ascii.stl": ":7: a fourth corner",
    "broken_incorrectFaceCounter.bin.stl": "a binary STL of 66 facets has 3384 bytes",
    "broken_quad.ascii.stl": ":7: a fourth corner",
    "broken_twoVertices.ascii.stl": ":7: a facet of 2 corners",
}
ASSIMP_REFUSED = {
    "OBJ/box_UTF16BE.obj": "UTF-16 where text is expected",
    "OBJ/number_formats.obj": ":11: coordinate 3 of this vertex is not a finite number",
    "OBJ/point_cloud.obj": "0 facets",
    "OBJ/testline.obj": "0 facets",
    "OBJ/testpoints.obj": "0 facets",
    "OFF/invalid.off": ":2: the numbers of vertices, facets and edges are expected",
    "PLY/issue623.ply": ":11: a list among a vertex's properties",
    "PLY/points.ply": "0 faces",
    "PLY/pond.0.ply": "0 faces",
    "invalid/OutOfMemory.off": ":2: 353535235358 vertices and 6 facets do not fit 309 bytes",
    "invalid/empty.obj": "the file is empty",
    "invalid/empty.off": "the file is empty",
    "invalid/empty.ply": "the file is empty",
    "invalid/malformed.obj": ":28: corner 1 of this facet names no vertex",
    "invalid/malformed2.obj": ":23: a facet with 0 corners",
}


def same_box(report, corners, name):
    for axis in range(3):
        values = [corner[axis] for corner in corners]
        for told, counted in ((report["min"][axis], min(values)), (report["max"][axis], max(values))):
            if not math.isclose(told, counted, rel_tol=1e-5, abs_tol=1e-6):
                raise AssertionError(f"{name}: axis {axis} ends at {told}, in the file at {counted}")


def judge(folder, files, refused):
    """Each of FILES under FOLDER is refused as REFUSED says, or loads as it is."""
    done = asdic("check", "--json", *files).check(code=3)
    reports = json.loads(done.out)
    tap.equal([r["file"] for r in reports], [str(f) for f in files], "files reported")
    seen = set()
    for path, report in zip(files, reports):
        name = str(path.relative_to(folder))
        if not report["valid"]:
            seen.add(name)
            tap.contains(report["error"], refused.get(name, f"no reason to refuse {name}"))
            tap.contains(report["error"], path.name)
            continue
        triangles, corners = mesh_count.read(path)
        tap.equal(report["triangles"] + report["dropped_facets"] + report["copied_facets"], triangles, f"triangles of {name}")
        same_box(report, corners, name)
    tap.equal(sorted(refused.keys() - seen), [], "files that load but should not")
    print(f"# {len(files) - len(seen)} load, {len(seen)} are refused")


def test_broken_stl_files():
    files = sorted(BROKEN.glob("broken_*.stl"))
    tap.equal(len(files), 14)
    judge(BROKEN, files, BROKEN_REFUSED)


def test_test_models_of_assimp():
    files = sorted(path for path in ASSIMP.rglob("*")
                   if path.suffix.lower() in (".obj", ".off", ".ply", ".stl"))
    if not files:
        raise tap.Skip(f"{ASSIMP} is not there (package assimp-testmodels)")
    judge(ASSIMP, files, ASSIMP_REFUSED)


tap.main(globals())
