"""What scene files and scripts rely on stays: limits, defaults, types and words of every key of a scene, limits
of every formula's keys, options and operands of every command. promises.txt holds them, a line each.

    test_promises.py            what is new is allowed, what went or changed is not
    test_promises.py --write    records what is there; needs ASDIC, and PYTHONPATH=tests/support

A limit or a default that changes makes old scene files fail, or mean something else, without a word.
"""
import json
import pathlib
import re
import sys

import tap
from program import asdic

RECORD = pathlib.Path(__file__).with_name("promises.txt")
PROSE = ("description", "title", "what", "source", "$comment")


def leaves(value, path):
    """Every number, word and truth value of a JSON document as 'path = value'; not its prose."""
    if isinstance(value, dict):
        for key, inner in value.items():
            if key not in PROSE or not isinstance(inner, str):
                yield from leaves(inner, f"{path}.{key}")
    elif isinstance(value, list):
        for at, inner in enumerate(value):
            name = inner["name"] if isinstance(inner, dict) and "name" in inner else None
            name = name if isinstance(name, str) else at
            if isinstance(inner, (dict, list)):
                yield from leaves(inner, f"{path}[{name}]")
            else:
                yield f"{path}[] = {json.dumps(inner)}"
    else:
        yield f"{path} = {json.dumps(value)}"


def commands():
    listed = asdic("help").check(code=0).out.split("commands:")[1]
    return re.findall(r"^  (\w+) ", listed, re.M)


def usage(command):
    return asdic(command, "--help").check(code=0).out


def options(command):
    """Each with its letter and its argument."""
    text = usage(command).split("\noptions:")[1].split("\nexamples:")[0]
    for letter, name, argument in re.findall(r"^  (-\w,)? +(--[\w-]+)( [A-Z]\S*)?(?:  |$)", text, re.M):
        yield f"{command} {letter}{name}{argument}"


def promises():
    yield from leaves(json.loads(asdic("schema").check(code=0).out), "scene")
    yield from leaves(json.loads(asdic("model", "--json").check(code=0).out), "model")
    for command in commands():
        yield f"command {usage(command).splitlines()[0]}"
        yield from options(command)


def test_promises_are_kept():
    now = set(promises())
    with open(RECORD, encoding="utf-8") as file:
        lost = [line for line in file.read().splitlines() if line not in now]
    tap.equal(lost, [], "what went or changed")


def test_operands_beyond_the_usage_are_refused():
    """Commands that take a list of them say so by dots."""
    for command in commands():
        operands = usage(command).splitlines()[0].split("[OPTION...]")[1]
        if "..." not in operands:
            known = len(operands.split())
            done = asdic(command, *["x"] * (known + 1)).check(code=2, out="")
            tap.contains(done.err, f"'{command}' does not take 'x'")


if "--write" in sys.argv:
    RECORD.write_text("".join(f"{line}\n" for line in sorted(set(promises()))), encoding="utf-8")
else:
    tap.main(globals())
