"""Paths, locales and links: files are written where the user says and nowhere else."""
import json
import os
import re
import subprocess

import program
import tap
from program import Folder, asdic
from run_folder import edit_facts, scene


def tree(path):
    """Every file below PATH, with its content."""
    found = {}
    for folder, _, names in os.walk(path):
        for name in names:
            full = os.path.join(folder, name)
            with open(full, "rb") as file:
                found[os.path.relpath(full, path)] = file.read()
    return found


def test_any_file_name():
    program.need_device()
    names = ["with space", "tücke-日本", "a'b\"c;$(touch x)`y`&|<>*?", "-dash", "n" * 255, "é" * 127,
             os.fsdecode(b"b\xe9ton")]
    with Folder() as folder:
        path = scene(folder, pings=1, rays=64)
        for name in names:
            os.mkdir(folder / "in")
            kept = os.fsencode(name)[:250].decode(errors="ignore") if name[0] in "né" else name
            copy = os.path.join(folder / "in", kept + ".yaml")
            os.rename(path, copy)
            os.mkdir(folder / "out")
            asdic("run", copy, "-o", os.path.join(folder / "out", name), "-q").check(0, "", "")
            tap.equal(sorted(os.listdir(folder / "out")), [name], "folders")
            tap.contains(sorted(os.listdir(os.path.join(folder / "out", name))), "bins.csv")
            with open(os.path.join(folder / "out", name, "run.json"), encoding="utf-8") as file:
                tap.equal(json.load(file)["state"], "complete", "run.json is JSON")
            asdic("render", os.path.join(folder / "out", name), "--ping", 0, "-q").check(0, "", "")
            tap.equal(os.listdir(folder / "in"), [os.path.basename(copy)], "files of the input")
            os.rename(copy, path)
            subprocess.run(["rm", "-r", folder / "in", folder / "out"], check=True)
        asdic("run", path, "-o", folder / ("n" * 256)).check(code=1)
        tap.equal(sorted(os.listdir(folder.path)), ["pool.yaml"], "nothing else")


def test_nothing_outside_the_folder():
    """Links in the output folder are replaced, not followed; names of beams stay names."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=1, rays=64)
        folder.write("precious", "precious")
        before = tree(folder.path)
        os.mkdir(folder / "run")
        for name in ("bins.csv", "run.json", "pings.npy", "levels.npy", "waterfall_forward.png",
                     "bins.csv.part", "run.json.part", "pings.npy.part", "ascope_0.png.part"):
            os.symlink(folder / "precious", folder / f"run/{name}")
        asdic("run", path, "-o", folder / "run", "--force").check(code=0)
        tap.equal({n: b for n, b in tree(folder.path).items() if not n.startswith("run/")}, before,
                  "files outside")
        tap.equal([n for n in os.listdir(folder / "run") if os.path.islink(folder / f"run/{n}")],
                  [], "links that are left")
        asdic("detect", folder / "run").check(code=0)
        for name in ("detections.csv.part", "tracks.csv.part", "occupancy.png.part"):
            os.symlink(folder / "precious", folder / f"run/{name}")
        asdic("detect", folder / "run", "--force").check(code=0)
        edit_facts(folder, "run", '"complete"', '"interrupted"')
        for name in ("pings.npy", "pings.npy.part"):
            os.rename(folder / "run/pings.npy", folder / "records")
            os.symlink(folder / "records", folder / f"run/{name}")
            before = tree(folder.path)
            done = asdic("run", path, "-o", folder / "run", "--resume")
            tap.contains(done.check(code=1).err, f"{name}' is a link")
            tap.equal(tree(folder.path)["records"], before["records"], "records outside")
            os.unlink(folder / f"run/{name}")
            os.rename(folder / "records", folder / "run/pings.npy")
        beams = "    - {name: ../../precious}"
        asdic("run", scene(folder, receivers=beams), "-o", folder / "evil").check(code=3)
        tap.equal(os.path.exists(folder / "evil"), False, "a folder of a refused scene")


def test_no_network_and_no_shell():
    """The library knows no call that would connect, or start a program; it forks to write netCDF alone."""
    done = subprocess.run(["nm", "-D", "--undefined-only", os.environ["ASDIC_LIBRARY"]],
                          capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise tap.Skip("nm does not read the library")
    calls = set(re.findall(r"\bU (\w+)", done.stdout))
    tap.equal(bool(calls & {"fopen", "fopen64"}), True, "nm lists what is used")
    tap.equal(calls & {"system", "popen", "execl", "execve", "execvp", "posix_spawn",
                       "connect", "getaddrinfo", "bind", "listen"}, set(), "calls")


def test_locales_change_no_byte():
    program.need_device()
    where = os.environ.get("LOCPATH", "")
    with Folder() as folder:
        path = scene(folder, pings=2, rays=256)
        asdic("run", path, "-o", folder / "C", LC_ALL="C").check(code=0)
        plain = {n: b for n, b in tree(folder / "C").items() if n != "run.json"}
        for locale in ("de_DE.UTF-8", "tr_TR.UTF-8"):
            if not os.path.isdir(os.path.join(where, locale)):
                raise tap.Skip(f"there is no locale {locale}")
            asdic("run", path, "-o", folder / locale, LC_ALL=locale).check(code=0)
            tap.equal({n: b for n, b in tree(folder / locale).items() if n != "run.json"} == plain,
                      True, f"bytes in {locale}")
            for command in (("model", "sound-speed", "t_degc=10.5", "s_ppt=35", "z_m=1e2"),
                            ("check", path), ("expect", path, "-o", "-")):
                first, second = (asdic(*command, LC_ALL=name) for name in ("C", locale))
                tap.equal((second.code, second.out), (first.code, first.out), f"{command[0]}")


tap.main(globals())
