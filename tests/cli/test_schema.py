"""asdic schema: valid JSON Schema, that accepts what the reader accepts and refuses what it refuses."""
import json
import os
import pathlib
import shutil
import subprocess

import tap
from program import asdic

SCENES = pathlib.Path(__file__).parent.parent / "unit" / "scenes"


def schema():
    done = asdic("schema")
    tap.equal((done.code, done.err), (0, ""))
    return json.loads(done.out)


def validator():
    try:
        import jsonschema
    except ImportError:
        raise tap.Skip("python3-jsonschema is not installed")
    jsonschema.Draft7Validator.check_schema(schema())
    return jsonschema.Draft7Validator(schema())


def example():
    return json.loads((SCENES / "example.json").read_text())


def test_schema_names_every_part():
    printed = schema()
    tap.equal(printed["$schema"], "http://json-schema.org/draft-07/schema#")
    tap.equal(printed["required"], ["version", "bottom", "sonar", "mission"])
    frequency = printed["properties"]["sonar"]["properties"]["frequency_khz"]
    tap.equal((frequency["minimum"], frequency["maximum"]), (0.1, 3000))
    tap.contains(frequency["description"], "[kHz]")
    tap.equal(printed["properties"]["sampling"]["properties"]["seed"]["maximum"], 2**53)
    tap.equal(printed["properties"]["environment"]["properties"]["ph"]["default"], 8)
    tap.equal(printed["properties"]["output"]["properties"]["images"]["default"],
              ["waterfall", "ascope", "fan", "overview", "plan"])


def test_examples_are_accepted():
    check = validator()
    tap.equal([e.message for e in check.iter_errors(example())], [])
    try:
        import yaml
    except ImportError:
        raise tap.Skip("python3-yaml is not installed")
    scenes = [*SCENES.glob("*.yaml"), *(SCENES.parents[2] / "data" / "scenes").glob("*.yaml")]
    for path in scenes:
        scene = yaml.safe_load(path.read_text())
        tap.equal([e.message for e in check.iter_errors(scene)], [], path.name)


def edits():
    """Changes to the example: a path, a value (None: take it out), and whether that is a scene."""
    yield ("sonar", "frequency_khz"), 3000, True
    yield ("sonar", "frequency_khz"), 3000.5, False
    yield ("sonar", "frequency_khz"), "100", False
    yield ("sonar", "frequency_khz"), None, False
    yield ("sonar", "frequncy_khz"), 3, False
    yield ("sonar", "receivers"), [], False
    yield ("sonar", "receivers"), {"fan": {"count": 3, "sector_deg": 90}}, True
    yield ("sonar", "receivers"), {"fan": {"count": 3}}, False
    yield ("sonar", "receivers"), {"fan": {"count": 3.5, "sector_deg": 90}}, False
    yield ("sonar", "receivers", 0, "name"), "a/b", False
    yield ("sonar", "rear_floor_db"), "some", False
    yield ("bottom",), "none", True
    yield ("bottom",), "nothing", False
    yield ("bottom", "depth_m"), None, False
    yield ("bottom", "none"), True, False
    yield ("bottom", "type"), 2.5, True
    yield ("bottom", "type"), "rock", True
    yield ("bottom", "type"), "clay", False
    yield ("environment", "particle_density"), -80, True
    yield ("environment", "particle_density"), "moderate", True
    yield ("environment",), {"sound_speed_profile": [[0, 1300], [11000, 1700]]}, True
    yield ("environment",), {"sound_speed_profile": [[0, 1500], [9, 5000]]}, False
    yield ("environment",), {"sound_speed_profile": [[0, 1500], [11001, 1490]]}, False
    yield ("environment",), None, True
    yield ("environment",), [], False
    yield ("objects", 0, "position_m"), [1, 2], False
    yield ("objects", 0, "sphere"), {"radius_m": 1}, False
    yield ("objects", 0, "type"), "sand", False
    yield ("objects", 0, "material"), None, True
    yield ("objects", 0, "material", "coherent_area_m2"), 0.5, True
    yield ("objects", 0, "material", "coherent_area_m2"), 0, False
    yield ("sampling", "multipath"), False, True
    yield ("sampling", "multipath"), "second", False
    yield ("sampling", "seed"), -1, False
    yield ("output", "images"), [], True
    yield ("output", "images"), ["waterfall", "sunset"], False
    yield ("surface", "enabled"), "true", False
    yield ("mission", "track"), "t.csv", False
    yield ("mission", "waypoints"), [[0, 0, 5], [1, 0, 5]], False
    yield ("mission",), {"waypoints": [[0, 0, 5], [20, 0, 5]]}, True
    yield ("mission",), {"waypoints": [[0, 0, 5]]}, False
    yield ("mission",), {"waypoints": [[0, 0, 5], [20, 0]]}, False
    yield ("mission",), {"waypoints": {"points_m": [[0, 0, 5], [20, 0, 5]], "speed_mps": 1}}, True
    yield ("mission",), {"waypoints": {"speed_mps": 1}}, False
    yield ("version",), 2, False


def test_schema_and_reader_agree():
    check = validator()
    for path, value, good in edits():
        scene = example()
        place = scene
        for step in path[:-1]:
            place = place[step]
        if value is None:
            del place[path[-1]]
        else:
            place[path[-1]] = value
        what = f"{path} = {value}"
        tap.equal(check.is_valid(scene), good, "schema, " + what)
        tap.equal(asdic("check", "-", stdin=json.dumps(scene)).code, 0 if good else 3,
                  "reader, " + what)


def test_manual_page_names_every_key():
    page = pathlib.Path(os.environ["SCENE_MAN"])
    if not page.exists():
        raise tap.Skip("the manual page was not made")
    text = page.read_text()

    def names(part):
        for name, key in part.get("properties", {}).items():
            yield name
            yield from names(key)
        items = part.get("items", [])
        for inner in (items if isinstance(items, list) else [items]) + part.get("anyOf", []):
            yield from names(inner)
    for name in names(schema()):
        tap.contains(text, f"\n.B {name}\n")
    for name, kind in (("environment", "a map"), ("sonar", "a map; required"),
                       ("sound_speed_profile",
                        "a file or a list of points, 2 numbers in [0, 11000] and [1300, 1700] m and m/s"),
                       ("name", "a name of at most 63 letters, digits, _ \\- and .")):
        tap.contains(text, f"\n.B {name}\n{kind}\n")
    if shutil.which("groff"):
        done = subprocess.run(["groff", "-man", "-ww", "-Tutf8", "-rLL=100n", page],
                              capture_output=True, check=True)
        tap.equal(done.stderr, b"")


tap.main(globals())
