"""asdic bench rays: every set in every scene, the same hits by every kernel, and agreement with Embree
where the program was built with it."""
import csv
import io
import json
import os

import program
import tap
from program import Folder, asdic

MESHES = os.path.join(os.path.dirname(__file__), "..", "..", "data", "meshes")
SETS = ["cone-dense", "mirrored-dense", "cone", "sphere-dense", "sphere", "sphere-random",
        "mirrored-random", "vertices"]


def rays(*arguments):
    done = asdic("bench", "rays", "--quick", "--json", *arguments).check(code=0)
    return json.loads(done.out)


def check_row(row, embree):
    tap.equal(0 < row["hits"] <= row["rays"], True, f"hits of {row['set']}")
    tap.equal(row["rays_per_s"] > 0, True)
    tap.equal("ratio" in row, embree, "a ratio when there is another caster")
    if embree:
        tap.equal(row["ratio"] > 0, True)
        # Rays past a silhouette or between two facets that touch may differ.
        if row["set"] != "vertices" and row["disagree"] > 1e-3 * row["rays"]:
            raise AssertionError(f"{row['set']}: {row['disagree']} of {row['rays']} disagree")
    if row["set"] == "vertices":
        tap.equal(row["missed"], 0, "rays that slipped through a vertex")


def test_all_sets_and_scenes():
    program.need_device()
    with Folder() as folder:
        found = rays("-o", folder / "rays.csv")
        embree = found["embree"] is not None
        tap.equal([s["scene"] for s in found["scenes"]], ["terrain", "object", "small"])
        for scene in found["scenes"]:
            tap.equal([row["set"] for row in scene["rows"]], SETS)
            tap.equal(scene["build_s"] > 0, True)
            for row in scene["rows"]:
                check_row(row, embree)
        rows = list(csv.DictReader(io.StringIO(folder.read("rays.csv"))))
        tap.equal(len(rows), 3 * len(SETS))
        tap.equal([bool(row["ratio"]) for row in rows], [embree] * len(rows))
        tap.equal(folder.names(), ["rays.csv"], "nothing left over")


def test_kernels_agree_on_a_mesh():
    program.need_device()
    mesh = os.path.join(MESHES, "wreck.ply")
    counts = []
    for kernel in ("auto", "wide8", "pkt16", "frustum64", "scalar"):
        scene, = rays("--kernel", kernel, mesh)["scenes"]
        tap.equal(scene["scene"], "wreck.ply")
        if kernel != "auto":
            tap.equal({row["kernel"] for row in scene["rows"]}, {kernel})
        counts.append([row["hits"] for row in scene["rows"]])
    tap.equal(counts, [counts[0]] * len(counts), "hits by every kernel")


def test_mistakes_have_their_exit_codes():
    asdic("bench", "rays", "--threads", "0").check(code=2, out="")
    asdic("bench", "rays", "--picture", "x.png").check(code=2, out="")
    program.need_device()
    asdic("bench", "rays", "nowhere.ply").check(code=3)
    done = asdic("bench", "rays", "--quick", "--kernel", "fast").check(code=2)
    tap.contains(done.err, "'fast' is not a form of the ray kernel")


tap.main(globals())
