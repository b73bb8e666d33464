"""Meshes that nobody on the project made. Debian's assimp-testmodels holds one model in four
formats; sea floors of simulators are looked for in ASDIC_FOREIGN_MESHES, or in shared/meshes beside
the source tree."""
import os
import pathlib
import tempfile

import tap
from levels import read_bins
from program import asdic

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODELS = pathlib.Path("/usr/share/assimp/models")
FOREIGN = pathlib.Path(os.environ.get("ASDIC_FOREIGN_MESHES", ROOT.parent / "shared" / "meshes"))
FOUR = ["OBJ/WusonOBJ.obj", "OFF/Wuson.off", "PLY/Wuson.ply", "STL/Wuson.stl"]

SCENE = """version: 1
bottom: {depth_m: 12, type: sand}
objects:
  - mesh: {file: "%s", scale: 2}
    name: wuson
    position_m: [18, 0.5, 9]
    material: {impedance_mrayl: 20, roughness_rms_mm: 2, slope_rms: 0.3}
sonar:
  frequency_khz: 100
  receivers: [{name: forward}, {name: down, pitch_deg: 15}]
  noise: {enabled: false}
mission: {pose: {position_m: [0, 0, 7]}, pings: 2}
"""
# The file's axes are x, height, z: told as they are, then turned by -90 degrees about x.
SEABED = """version: 1
bottom:
  mesh: {file: "%s", z_up: false}
  rotation_deg: [-90, 0, 0]
  position_m: [0, 0, 20]
  type: gravel
sonar:
  frequency_khz: 200
  bandwidth_khz: 20
  ping_rate_hz: 10
  bin_length_m: 0.25
  source_level_db: 200
  transmitter: {length_h_m: 0.01, length_v_m: 0.02}
  receivers: [{name: forward, length_h_m: 0.03, length_v_m: 0.03},
              {name: down, pitch_deg: 20, length_h_m: 0.03, length_v_m: 0.03}]
mission: {track: track.csv}
"""
TRACK = """time_s,x_m,y_m,z_m,roll_deg,pitch_deg,yaw_deg
0,-40,0,12,0,0,0
20,0,0,12,0,0,0
"""


def simulate(folder, scene, name):
    path = pathlib.Path(folder, f"{name}.yaml")
    path.write_text(scene)
    asdic("run", path, "-q", "-o", f"{folder}/{name}").check(0, "", "")
    return f"{folder}/{name}"


def test_one_model_in_four_formats_gives_equal_bins():
    missing = [name for name in FOUR if not (MODELS / name).exists()]
    if missing:
        raise tap.Skip(f"{MODELS / missing[0]} is not there (package assimp-testmodels)")
    with tempfile.TemporaryDirectory() as folder:
        tables = []
        for name in FOUR:
            run = simulate(folder, SCENE % (MODELS / name), name.partition("/")[0])
            tables.append(pathlib.Path(run, "bins.csv").read_bytes())
            seen = [row for row in read_bins(run)["forward"] if row["object_db"] is not None]
            tap.equal(len(seen) >= 4, True, f"{name} is in two bins of each ping, or more")
    for name, table in zip(FOUR[1:], tables[1:]):
        compare(tables[0].decode(), table.decode(), name)


def compare(first, other, name):
    """The files give their corners to 6 or 7 digits. Levels follow to 0.002 dB, and to half of a
    standard error where multipath counts: single mirror rays just hit or miss."""
    rows = [[line.split(",") for line in table.splitlines()] for table in (first, other)]
    header = rows[0][0]
    level, error = header.index("level_db"), header.index("stderr_db")
    tap.equal(len(rows[0]), len(rows[1]), "number of rows")
    for one, two in zip(*(table[1:] for table in rows)):
        tap.equal(one[:level], two[:level], "ping, time, beam, bin and range")
        for column in range(level, error):
            a, b = one[column], two[column]
            if header[column] == "multipath_db":
                continue
            most = max(0.002, 0.5 * float(one[error] or 0)) if column == level else 0.002
            near = a == b or (a != "" and b != "" and abs(float(a) - float(b)) < most)
            tap.equal(near, True, f"{name}: {header[column]} {a} and {b} alike, in {one[:4]}")


def test_a_sea_floor_of_another_simulator():
    mesh = FOREIGN / "herkules_seabed.ply"
    if not mesh.exists():
        raise tap.Skip(f"{mesh} is not there (set ASDIC_FOREIGN_MESHES)")
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "track.csv").write_text(TRACK)
        beams = read_bins(simulate(folder, SEABED % mesh, "seabed"))
    pings = int(beams["down"][-1]["ping"]) + 1
    tap.equal(pings, 201)
    per_ping = len(beams["down"]) // pings
    for ping in range(0, pings, 20):
        rows = beams["down"][ping * per_ping:(ping + 1) * per_ping]
        first = next(row["range_m"] for row in rows if row["bottom_db"] is not None)
        # The floor lies between 16.3 m and 20 m, the sonar at 12 m.
        tap.equal(4.0 < first < 8.4, True, f"ping {ping}: first bottom echo at {first} m")
        loud = max(row["level_db"] for row in rows[80:160])
        tap.equal(60 < loud < 140, True, f"ping {ping}: {loud} dB between 20 and 40 m")


tap.main(globals())
