"""asdic-bench beside: every set in every scene, the same hits by every kernel, and agreement with Embree
where the program was built with it."""
import csv
import io
import json
import os

import program
import tap
from program import Folder, asdic_bench

MESHES = os.path.join(os.path.dirname(__file__), "..", "..", "data", "meshes")
SETS = ["cone-dense", "mirrored-dense", "cone", "sphere-dense", "sphere", "sphere-random",
        "mirrored-random", "vertices"]


def rays(*arguments):
    done = asdic_bench("beside", "--quick", "--json", *arguments).check(code=0)
    return json.loads(done.out)["rows"]


def check_row(row, embree):
    tap.equal(0 < row["hits"] <= row["rays"], True, f"hits of {row['set']}")
    tap.equal(row["rays_per_s"] > 0 and row["build_s"] > 0, True)
    tap.equal(row["ratio"] is not None, embree, "a ratio when there is another caster")
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
        embree = found[0]["embree_version"] != ""
        tap.equal([(row["scene"], row["set"]) for row in found],
                  [(scene, name) for scene in ("terrain", "object", "small") for name in SETS])
        for row in found:
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
        found = rays("--kernel", kernel, mesh)
        tap.equal({row["scene"] for row in found}, {"wreck.ply"})
        if kernel != "auto":
            tap.equal({row["kernel"] for row in found}, {kernel})
        counts.append([row["hits"] for row in found])
    tap.equal(counts, [counts[0]] * len(counts), "hits by every kernel")


tap.main(globals())
