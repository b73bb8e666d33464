"""What scene files and scripts rely on stays: limits, defaults, types and words of every key of a scene, limits
of every formula's keys, options and operands of every command. promises.txt holds them, a line each.

    test_promises.py            what is new is allowed, what went or changed is not
    test_promises.py --write    records what is there; needs ASDIC, and PYTHONPATH=tests/support

A limit or a default that changes makes old scene files fail, or mean something else, without a word.
"""
import functools
import itertools
import json
import math
import pathlib
import re
import sys

import tap
from program import asdic

RECORD = pathlib.Path(__file__).with_name("promises.txt")
OPTION = r"^  (-\w,)? +(--[\w-]+)( [A-Z]\S*)?(?:  |$)"
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


@functools.cache
def commands():
    listed = asdic("help").check(code=0).out.split("commands:")[1]
    return re.findall(r"^  (\w+) ", listed, re.M)


@functools.cache
def usage(command):
    return asdic(command, "--help").check(code=0).out


def option_lines(command):
    return usage(command).split("\noptions:")[1].split("\nexamples:")[0]


def options(command):
    """Each with its letter and its argument."""
    for letter, name, argument in re.findall(OPTION, option_lines(command), re.M):
        yield f"{command} {letter}{name}{argument}"


def refusals(command, values):
    """{option: what COMMAND says of its value} of those of VALUES, {option: value}, that it does not take."""
    told, given = {}, [f"{option}={value}" for option, value in values.items()]
    for line in asdic(command, *given, "nowhere.yaml").err.splitlines():
        name, says, rest = line.removeprefix("error: option '").partition("': ")
        if says and rest.startswith(f"'{values.get(name)}' is "):
            told[name] = rest.removeprefix(f"'{values[name]}' is ")
    return told


@functools.cache
def ranges(command):
    """[{option: what its values are}] of all options that take no '?': those that are judged together, then each
    of the others."""
    names = [name for _, name, argument in re.findall(OPTION, option_lines(command), re.M) if argument]
    together = refusals(command, dict.fromkeys(names, "?"))
    alone = [refusals(command, {name: "?"}) for name in names if name not in together]
    return [{name: told.replace("not ", "") for name, told in some.items()} for some in [together, *alone]]


def promises():
    yield from leaves(json.loads(asdic("schema").check(code=0).out), "scene")
    yield from leaves(json.loads(asdic("model", "--json").check(code=0).out), "model")
    for command in commands():
        yield f"command {usage(command).splitlines()[0]}"
        yield from options(command)
        for some in ranges(command):
            yield from (f"{command} {name}: {values}" for name, values in some.items())


def edges(values):
    """Values at the limits of what '?' was told to be, and the nearest beyond them."""
    whole = re.match(r"a whole number in \[(\d+), (\d+)\]", values)
    if whole:
        low, high = int(whole[1]), int(whole[2])
        return [low, high], [high + 1, f"{low}.5", f" {low}", f"{low}x", ""] + [low - 1] * (low > 0)
    number = re.match(r"a number in \[(\S+), (\S+)\]", values)
    if number:
        low, high = float(number[1]), float(number[2])
        beyond = [math.nextafter(low, -math.inf), math.nextafter(high, math.inf)]
        return [repr(low), repr(high)], [repr(x) for x in beyond] + ["nan", "inf", f" {low}", f"{low}x", ""]
    pair = re.match(r"LOW:HIGH with (\S+) <= LOW < HIGH <= (\S+)", values)
    if pair:
        low, high = float(pair[1]), float(pair[2])
        less, more = math.nextafter(low, -math.inf), math.nextafter(high, math.inf)
        return [f"{low}:{high}"], [f"{less!r}:{high}", f"{low}:{more!r}", "1:1", "2:1", "1", "1:", ":1", "1:2x"]
    if values.startswith("K/N"):
        return ["1/1", "2/2", "1/2"], ["1/1000000001", "0/1", "2/1", "0/0", "1/", "/1", "1", "1/2x", "x/2"]
    if values.startswith("FIRST:END"):
        return ["0:1", "3", "3:", ":3"], ["1:1", "2:1", "3x", "0:1x", "x:1", "0:x"]
    words = re.match(r"one of (.*)", values)
    return (words[1].split(", "), [words[1].split(", ")[0] + "x"]) if words else ([], [])


def rounds(values):
    """{option: value}, one of VALUES, {option: [value, ...]}, each."""
    for some in itertools.zip_longest(*values.values()):
        yield {name: value for name, value in zip(values, some) if value is not None}


def test_limits_of_options_are_where_they_are_said_to_be():
    for command in commands():
        for some in ranges(command):
            for given in rounds({name: edges(values)[0] for name, values in some.items()}):
                tap.equal(refusals(command, given), {}, f"{command} {given}")
            for given in rounds({name: edges(values)[1] for name, values in some.items()}):
                told = {name: says.split(";")[0] for name, says in refusals(command, given).items()}
                tap.equal(told, {name: f"not {some[name]}" for name in given}, f"{command} {given}")


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
