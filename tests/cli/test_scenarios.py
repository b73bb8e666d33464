"""The paper's scenarios and the benchmark scenes, simulated by asdic run, against levels that
other programs computed by quadrature: tests/golden/flat_expected.h, step_expected.json and
sphere_expected.json. Bounds are on 10 log10(simulated / expected) of the direct echoes, over all
bins from 2 m on."""
import json
import pathlib
import re
import tempfile

import tap
from levels import differences_db, direct_db, read_bins, rms
from program import asdic

TESTS = pathlib.Path(__file__).resolve().parents[1]
SCENES = TESTS.parent / "data" / "scenes"
STEP = json.loads((TESTS / "golden" / "step_expected.json").read_text())
SPHERE = json.loads((TESTS / "golden" / "sphere_expected.json").read_text())


def simulate(name, *options):
    with tempfile.TemporaryDirectory() as folder:
        asdic("run", SCENES / f"{name}.yaml", "-q", "-o", f"{folder}/run", *options).check(0, "", "")
        return read_bins(f"{folder}/run")


def within(differences, rms_db, most_db, what):
    actual = rms(differences), max(map(abs, differences))
    measured = (f"{what}: r.m.s. {actual[0]:.4f} dB of {rms_db}, largest {actual[1]:.4f} dB of "
                f"{most_db}")
    if actual[0] > rms_db or actual[1] > most_db:
        raise AssertionError(measured)
    print(f"# {measured}")


def flat_expected_db():
    text = (TESTS / "golden" / "flat_expected.h").read_text()
    totals = re.findall(r"^ *\{([-0-9.NA]+),", text, re.M)
    return [None if total == "NAN" else float(total) for total in totals]


def test_scenario_1_meets_the_expected_levels():
    expected = flat_expected_db()
    for seed in 1, 2, 3:
        beams = simulate("scenario1", "--seed", seed)
        tap.equal(list(beams), ["forward"])
        within(differences_db(beams["forward"], expected), 0.03, 0.2, f"seed {seed}")


def test_scenario_1_states_its_error():
    """The stated standard error is of the size of the true one, over bins and seeds."""
    expected = flat_expected_db()
    ratios = []
    for seed in range(1, 7):
        rows = simulate("scenario1", "--rays", 4096, "--seed", seed)["forward"]
        for row, difference in zip(rows[10:], differences_db(rows, expected, 10), strict=True):
            ratios.append(difference / row["stderr_db"])
    typical = sorted(map(abs, ratios))[len(ratios) // 2]
    # The median of |N(0, 1)| is 0.67; off by a factor of 3 would mislead.
    tap.equal(0.22 < typical < 2.0, True, f"median of |error| / stated error = {typical:.2f}")


def test_scenario_2_meets_the_reference():
    beams = simulate("scenario2", "--rays", 400000)
    tap.equal(list(beams), ["forward", "down", "up"])
    for name, reference in STEP["scenario2"]["beams"].items():
        within(differences_db(beams[name], reference["total_db"]), 0.05, 0.3, name)


def test_scenario_2_looks_like_the_papers():
    """Bottom at 5 m, surface at 7 m, in the order the paper tells; the rise far above the expected
    level in each beam, also with the paper's number of rays."""
    beams = simulate("scenario2")
    level = {name: [direct_db(row) for row in rows] for name, rows in beams.items()}
    bottom, surface, rise = 10, 14, 70
    for name in level:
        tap.equal(beams[name][rise]["range_m"], 35.25)
        above = level[name][rise] - STEP["flat"]["beams"][name]["total_db"][rise]
        tap.equal(above > 25, True, f"{name}: the rise is 25 dB above the expected level")
    for name in "forward", "down":
        tap.equal(level[name][bottom] > level["up"][bottom] + 10, True, f"bottom, {name}")
    for name in "forward", "up":
        tap.equal(level[name][surface] > level["down"][surface] + 5, True, f"surface, {name}")
    for name in level:  # the transmitter looks ahead
        tap.equal(level["forward"][rise] >= level[name][rise], True, f"loss off axis, {name}")


def test_benchmark_scenes_meet_their_references():
    forward = {"forward": STEP["bench_flat"]["beams"]["forward"]}
    for scene, references, rms_db, most_db in (
            ("bench_flat", forward, 0.01, 0.05),
            ("bench_step", STEP["bench_step"]["beams"], 0.1, 0.8),
            ("bench_sphere", {"forward": SPHERE}, 0.02, 0.1)):
        beams = simulate(scene, "--rays", 400000)
        for name, reference in references.items():
            within(differences_db(beams[name], reference["total_db"]), rms_db, most_db,
                   f"{scene}, {name}")


def test_sphere_is_never_missed():
    """One uniform ray in 57,600 meets it; its level may be rough with few rays, but is there."""
    for rays, most_db in (4096, 4.0), (20000, 1.0):
        for seed in range(1, 9):
            row = simulate("bench_sphere", "--rays", rays, "--seed", seed)["forward"][59]
            error = (row["object_db"] or -999) - SPHERE["object_db"][59]
            tap.equal(abs(error) < most_db, True,
                      f"{rays} rays, seed {seed}: off by {error:.2f} dB, within {most_db} dB")


def test_mission_begins():
    beams = simulate("mission", "--pings", "0:4")
    tap.equal(list(beams), ["forward", "down", "up", "port", "starboard"])
    for name, rows in beams.items():
        tap.equal(len(rows), 4 * 592, f"rows of {name}")
        tap.equal([row["time_s"] for row in rows[::592]], [0, 0.2, 0.4, 0.6])
        # 4 to 10 m above the bottom, and something comes back from the far half.
        first = next(row["range_m"] for row in rows if row["bottom_db"] is not None)
        tap.equal(4 < first < 10, True, f"{name}: first bottom echo at {first} m")
        tap.equal(any(row["bottom_db"] is not None for row in rows[296:592]), True)


tap.main(globals())
