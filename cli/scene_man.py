"""Makes asdic-scene(5), the manual page of the scene file, from what `asdic schema` prints.

    scene_man.py ASDIC EXAMPLE.yaml MATERIAL_PRESETS.h VERSION > asdic-scene.5
"""
import json
import re
import subprocess
import sys

INTRODUCTION = """\
A scene file holds everything that a simulation depends on: the water, the bottom, the objects, the
sonar and its track. It is YAML 1.1, or JSON. Every key carries its unit in its name; a key that is
left out has the default given here. Unknown keys, values out of range and keys that contradict
each other are errors. All errors of a file are reported in one run, each with line, column, key,
value, limit and remedy. Anchors, aliases, tags and repeated keys are refused; numbers are plain
decimals.

Positions are north, east, down, in metres from a point on the sea surface. Rotations are roll,
pitch, yaw in degrees, applied yaw first (aerospace order). A vehicle's positive pitch raises the
bow; a beam's positive pitch looks down. Paths are relative to the scene file."""


TARGETS = """\
An object scatters by its impedance, its roughness and slope, and the flat area that reflects in
phase; or as a type of bottom. This is geometric optics on facets, which is good for bodies of many
wavelengths. It cannot represent bodies of few wavelengths (ka below 5), edges, tips, the side lobes
of plates seen obliquely, thin shells and elastic resonances. Describe calibration spheres, fish and
floats as a point with a measured target strength.

The presets have these impedances in MRayl: density times longitudinal speed, for bodies many
wavelengths thick (Kinsler, Frey, Coppens, Sanders, Fundamentals of Acoustics, 4th ed. 2000, table
A10): {}."""


def presets(path):
    """NAME VALUE, ... from the table in the library."""
    with open(path, encoding="utf-8") as file:
        return ", ".join(" ".join(found) for found in re.findall(r"X\((\w+), ([\d.]+)\)", file.read()))


def escape(text):
    """TEXT in roff: backslashes, minus signs, and no line that looks like a request."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\n".join("\\&" + line if line.startswith((".", "'")) else line for line in text.split("\n"))


def words(enum):
    return ", ".join(str(word) for word in enum if word is not False)


def kind(schema):
    """What a value may be, in a few words."""
    if "anyOf" in schema:
        return " or ".join(filter(None, (kind(choice) for choice in schema["anyOf"])))
    if "enum" in schema:
        return words(schema["enum"])
    if "const" in schema:
        return json.dumps(schema["const"]).strip('"')
    if "type" not in schema:
        return "any value"
    of = schema.get("type")
    if of == "object":
        return "a map"
    if of == "array":
        item = schema["items"]
        if isinstance(item, list):  # a number of each
            limits = (f"[{one['minimum']:g}, {one['maximum']:g}]" for one in item)
            return f"a list of {len(item)} numbers in {' and '.join(limits)}"
        least, most = schema.get("minItems"), schema.get("maxItems")
        count = f"{least} " if least == most and least else ""
        if item.get("type") == "array":
            return f"a list of points, {kind(item)[len('a list of '):]}"
        if item.get("type") == "number":
            return f"a list of {count}numbers in [{item['minimum']:g}, {item['maximum']:g}]"
        return "a list of " + (words(item["enum"]) if "enum" in item else "maps")
    if of in ("number", "integer"):
        if schema["minimum"] == schema["maximum"]:
            return f"{schema['minimum']}"
        name = "a number" if of == "number" else "a whole number"
        return f"{name} in [{schema['minimum']:.10g}, {schema['maximum']:.16g}]"
    if of == "boolean":
        return "true or false"
    if "pattern" in schema:
        return f"a name of at most {schema['maxLength']} letters, digits, _ - and ."
    return "a file"


def maps(schema):
    """The maps that SCHEMA allows, each with the suffix that its key's name gets."""
    if schema.get("type") == "object":
        yield "", schema
    elif schema.get("type") == "array" and isinstance(schema["items"], dict):
        yield from (("[]" + suffix, found) for suffix, found in maps(schema["items"]))
    for choice in schema.get("anyOf", []):
        yield from maps(choice)


def print_map(path, schema, title):
    print(f".SS {escape(title)}")
    for name, key in schema["properties"].items():
        print(f".TP\n.B {escape(name)}")
        required = name in schema.get("required", [])
        without = schema["if"]["not"]["required"][0] if name in schema.get("then", {}).get(
            "required", []) else None
        default = json.dumps(key["default"]).replace('"', "") if "default" in key else None
        note = (f"; required without {without}" if without else "; required" if required else
                f"; default {default}" if default else "")
        about, unit = re.fullmatch(r"(.*?)(?: \[([^]]*)\])?", key["description"]).groups()
        if about.split()[0].strip(",:;").isalpha():
            about = about[0].upper() + about[1:]
        print(escape(kind(key) + (f" {unit}" if unit else "") + note))
        print(f".br\n{escape(about)}.")
    choices = [choice["required"][0] for choice in schema.get("oneOf", [])]
    if choices:
        print(f".PP\nExactly one of {escape(', '.join(choices))} is given.")
    excluded = schema.get("not", {}).get("required")
    if excluded:
        print(f".PP\nAt most one of {escape(', '.join(excluded))} is given.")
    laws = [set(law["propertyNames"]["enum"]) for rule in schema.get("allOf", []) for law in rule["anyOf"]]
    if len(laws) > 1:
        own = [" ".join(name for name in schema["properties"] if name in law - set.intersection(*laws))
               for law in laws]
        print(f".PP\nKeys of one scattering law at most: {escape('; '.join(own))}.")
    for name, key in schema["properties"].items():
        for suffix, inner in maps(key):
            inner_path = f"{path}.{name}{suffix}" if path else f"{name}{suffix}"
            print_map(inner_path, inner, inner_path)


def main():
    program, example, materials, version = sys.argv[1:5]
    schema = json.loads(subprocess.run([program, "schema"], capture_output=True, check=True).stdout)
    with open(example, encoding="utf-8") as file:
        text = file.read()
    print(f'.TH ASDIC\\-SCENE 5 "" "asdic {version}" "File formats"')
    print(".SH NAME\nasdic\\-scene \\- scene file of asdic")
    print(".SH DESCRIPTION\n" + escape(INTRODUCTION).replace("\n\n", "\n.PP\n"))
    print(".SH KEYS")
    print_map("", schema, "The file")
    targets = escape(TARGETS.format(presets(materials))).replace("\n\n", "\n.PP\n")
    print(".SH TARGETS\n" + targets)
    print(".SH EXAMPLE\n.nf\n" + escape(text.rstrip()) + "\n.fi")
    print(".SH FILES\n.TP\n.I share/asdic/scenes\nExamples, and sonars on the market to start from; under the prefix of "
          "the installation.\n.TP\n.I share/asdic/README.md\nWhat each scene shows; waters and types of bottom.")
    print(".SH SEE ALSO\n" + ",\n".join(f".BR {page} (1)" for page in (
        "asdic", "asdic\\-check", "asdic\\-run", "asdic\\-schema")))


if __name__ == "__main__":
    main()
