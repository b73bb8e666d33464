"""`pip install .` in a fresh virtual environment, and a wheel, from a bare tree without network.

    test_wheel.py [REPORT]

Builds the library once more, a minute or two of processor time.
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile

import tap

ROOT = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
FIRST_FAN = """
import asdic, os, sys
run = asdic.simulate("data/scenes/mission_fan.yaml", rays=2000, pings=slice(0, 1))
print(asdic.__version__, run.level_db.shape, asdic.__file__)
"""
NEEDED = ("mesonpy", "cffi", "numpy", "pip", "venv", "ensurepip")


def clean(changes=None):
    """The environment without the tree's own package."""
    kept = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "LD_LIBRARY_PATH")}
    return {**kept, **(changes or {})}


def run(command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False, timeout=900,
                          env=clean(), **options)
    if done.returncode:
        raise AssertionError(f"{command} answers {done.returncode}: {done.stdout[-3000:]}")
    return done.stdout


def bare_tree(folder):
    """What git has, or would have, of this tree."""
    listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard"], check=False,
                            capture_output=True, text=True)
    if listed.returncode:
        raise tap.Skip(f"this is no clone: {listed.stderr.strip()}")
    for name in listed.stdout.splitlines():
        if os.path.isfile(os.path.join(ROOT, name)):
            os.makedirs(os.path.dirname(os.path.join(folder, name)), exist_ok=True)
            shutil.copy2(os.path.join(ROOT, name), os.path.join(folder, name))


def environment(folder):
    """A fresh virtual environment, which sees the system's numpy and cffi; its Python."""
    run([sys.executable, "-m", "venv", "--system-site-packages", folder])
    return os.path.join(folder, "bin", "python")


def test_from_a_bare_tree_to_the_first_fan():
    for module in NEEDED:
        if subprocess.run([sys.executable, "-c", f"import {module}"], check=False, capture_output=True).returncode:
            raise tap.Skip(f"{sys.executable} has no {module}")
    with tempfile.TemporaryDirectory(prefix="asdic-wheel-") as folder:
        tree, build = (os.path.join(folder, name) for name in ("tree", "build"))
        bare_tree(tree)
        os.mkdir(build)
        python, began = environment(os.path.join(folder, "venv")), time.monotonic()
        pip = [python, "-m", "pip", "--disable-pip-version-check"]
        offline = ["--no-build-isolation", "--no-index", "--config-settings", f"builddir={build}"]
        said = run([*pip, "install", *offline, "."], cwd=tree)
        tap.contains(said, "Successfully installed asdic-")
        installed = time.monotonic() - began
        fan = run([python, "-c", FIRST_FAN], cwd=tree)
        tap.contains(fan, "(1, 512, 123)")
        tap.contains(fan, os.path.join(folder, "venv"))
        with open(os.path.join(ROOT, "meson.build"), encoding="utf-8") as file:
            version = re.search(r"version: '([\d.]+)'", file.read()).group(1)
        tap.contains(fan, version + " ")
        print(f"# {said.splitlines()[-1]}: {installed:.0f} s, the first fan after {time.monotonic() - began:.0f} s")
        wheel_holds_all(pip, offline, tree, folder, version)


def wheel_holds_all(pip, offline, tree, folder, version):
    """A wheel with the package, and nothing but it; it runs where only it was installed."""
    run([*pip, "wheel", *offline, "--no-deps", "-w", os.path.join(folder, "dist"), "."], cwd=tree)
    (name,) = os.listdir(os.path.join(folder, "dist"))
    wheel = os.path.join(folder, "dist", name)
    tap.contains(name, f"asdic-{version}-cp")
    with zipfile.ZipFile(wheel) as content:
        names = [entry for entry in content.namelist() if ".dist-info/" not in entry]
        metadata = content.read(f"asdic-{version}.dist-info/METADATA").decode()
    sources = {f"asdic/{entry}" for entry in os.listdir(os.path.join(ROOT, "lib", "python", "asdic"))
               if entry != "meson.build" and not entry.startswith("__pycache__")}
    tap.equal({entry for entry in names if "/_native.c" not in entry}, sources, "the wheel's files")
    tap.equal(len(names), len(sources) + 1, "and the module")
    for part in ("Requires-Dist: numpy", "Requires-Dist: cffi", "Requires-Python: >="):
        tap.contains(metadata, part)
    python = environment(os.path.join(folder, "other"))
    run([python, "-m", "pip", "install", "--no-index", wheel])
    shutil.rmtree(tree)
    said = run([python, "-c", "import asdic; print(asdic.model('sound-speed', t_degc=10, s_ppt=35, z_m=0)); "
                "print([l for l in open('/proc/self/maps') if 'libasdic' in l])"], cwd=folder)
    tap.equal(said.splitlines()[1], "[]", "other libraries of asdic")
    tap.equal(abs(float(said.split()[0]) - 1490) < 2, True, said)


tap.main(globals())
