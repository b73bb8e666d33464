"""asdic devices: the table, JSON, no device, several devices; what --device answers."""
import json
import os

import tap
from program import Folder, asdic, asdic_on_terminal, need_device

SCENE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../data/scenes/scenario1.yaml")

NO_PLATFORM = {"OCL_ICD_VENDORS": "/nonexistent"}


def listed(**env):
    return json.loads(asdic("devices", "--json", **env).check(code=0, err="").out)


def test_table_shows_each_device_with_its_place():
    need_device()
    text = asdic("devices").check(code=0, err="").out
    devices = listed()
    for device in devices:
        tap.contains(text, device["device"])
        tap.contains(text, device["name"])
    tap.equal(sum(d["auto"] for d in devices), 1, "devices that auto takes")
    tap.equal(sum(line.startswith("* ") for line in text.splitlines()[:-1]), 1, "marked lines")


def test_json_has_the_numbers():
    need_device()
    for device in listed():
        tap.equal(device["kind"] in ("cpu", "gpu", "acc", "other"), True, "kind is known")
        tap.equal(device["usable"], device["lacks"] == "" or "atomics" in device["lacks"])
        if not 0 < device["max_alloc_bytes"] <= device["global_bytes"]:
            raise AssertionError(f"sizes of {device}")


def test_table_has_the_numbers_of_json():
    """PoCL with a limit of 1 GiB has one size of GiB and one of MiB."""
    need_device()
    limited = {"POCL_MEMORY_LIMIT": "1"}
    lines = asdic("devices", **limited).check(code=0, err="").out.splitlines()
    rows = {line[2:].split()[0]: line for line in lines if line[2:3].isdigit()}
    for device in listed(**limited):
        row = rows[device["device"]]
        for key in ("global_bytes", "max_alloc_bytes"):
            size, unit = (device[key] / 2**30, "GiB") if device[key] >= 2**30 else (device[key] / 2**20, "MiB")
            tap.contains(row, f"  {size:6.1f} {unit}")
        tap.equal(row[2:].split()[1:3], [device["kind"], str(device["compute_units"])])
        for heading, value in (("name", device["name"]), ("platform", device["platform"]), ("lacks", device["lacks"] or "-")):
            tap.equal(row[lines[0].index(f" {heading}") + 1:].startswith(value), True, f"'{heading}' of '{row}'")
        tap.equal(row.endswith("  " + (device["lacks"] or "-")), True, f"what is lacking ends '{row}'")


def test_two_devices_of_one_platform():
    need_device()
    devices = listed(POCL_DEVICES="pthread basic")
    pocl = [d for d in devices if d["platform"] == "Portable Computing Language"]
    if not pocl:
        raise tap.Skip("PoCL is not installed")
    tap.equal(len(pocl), 2, "devices of PoCL")
    tap.equal(len({d["device"] for d in devices}), len(devices), "distinct places")


def test_no_platform_names_the_packages():
    text = asdic("devices", **NO_PLATFORM).check(code=4, out="").err
    tap.contains(text, "error: no OpenCL device was found")
    tap.contains(text, "apt-get install pocl-opencl-icd ocl-icd-libopencl1")
    text = asdic("devices", "--json", **NO_PLATFORM).check(code=4).out
    tap.equal(json.loads(text), [])


def run_on(device=None, **env):
    with Folder() as folder:
        arguments = ["run", SCENE, "-o", folder / "out"] + (["--device", device] if device else [])
        done = asdic(*arguments, **env)
        tap.equal(folder.names() if done.code else [], [], "files left by a refused run")
        return done


def test_device_that_is_not_there_exits_4():
    need_device()
    for done in (run_on("9:9"), run_on(ASDIC_DEVICE="9:9")):
        tap.contains(done.check(code=4, out="").err, "error: there is no device 9:9")
    tap.contains(run_on("name:nothing").check(code=4, out="").err, "name:nothing")
    tap.contains(run_on(**NO_PLATFORM).check(code=4, out="").err, "pocl-opencl-icd")


def test_selector_that_is_not_understood_exits_2():
    for selector in ("gpus", "0:", "0:0,0:0"):
        if selector == "0:0,0:0":
            need_device()
        tap.contains(run_on(selector).check(code=2, out="").err, f"'{selector}'")


def test_compiling_is_said_once_to_whoever_waits():
    need_device()
    with Folder() as folder:
        def err():
            done = asdic_on_terminal("run", SCENE, "--rays", 500, "--pings", "0:1", "-o", folder / "r", "-f",
                                     POCL_CACHE_DIR=folder / "cache")
            return done.err
        cold, warm = err(), err()
        if not os.path.isdir(folder / "cache"):
            raise tap.Skip("no device with PoCL's cache")
        tap.equal(cold.count("compiling kernels for device '"), 1, "in an empty cache")
        tap.lacks(warm, "compiling")


tap.main(globals())
