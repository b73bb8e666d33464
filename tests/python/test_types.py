"""The package's types, as mypy reads them: of its source, and of a user's script."""
import os
import subprocess
import sys
import tempfile

from package import ROOT
import tap

CACHE = tempfile.TemporaryDirectory(prefix="asdic-test-")  # pylint: disable=consider-using-with

USER = """
import asdic
import numpy as np
scene = asdic.Scene(bottom={"depth_m": 12})
scene.add_mesh(np.zeros((3, 3)), [[0, 1, 2]], "steel")
run = asdic.simulate(scene, rays=1000, pings=slice(0, 2))
level: np.ndarray = run.level_db[0]
ping = asdic.Simulator("scene.yaml").ping(0, 0, 7, yaw=3)
energy: np.ndarray = ping.intensity["total"]
"""


def mypy(*args, path):
    try:
        done = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", CACHE.name, "--ignore-missing-imports", *args],
                              capture_output=True, text=True, check=False, env={**os.environ, "MYPYPATH": path})
    except OSError as error:
        raise tap.Skip(str(error)) from error
    if "No module named mypy" in done.stderr:
        raise tap.Skip("there is no mypy")
    return done.returncode, done.stdout + done.stderr


def test_source_is_typed():
    folder = os.path.join(ROOT, "lib", "python")
    # What comes out of cffi has no types: these three are about that.
    about_cffi = ["--allow-untyped-decorators", "--no-warn-return-any", "--implicit-reexport"]
    code, said = mypy("--strict", "--allow-any-generics", *about_cffi, "-p", "asdic", path=folder)
    tap.equal(code, 0, said)


def test_users_see_types():
    folder = os.path.join(ROOT, "lib", "python")
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as place:
        for text, wrong in ((USER, False), (USER + "asdic.simulate(scene, ray=3)\n", True),
                            (USER + "name: str = run.level_db\n", True)):
            script = os.path.join(place, "user.py")
            with open(script, "w", encoding="ascii") as file:
                file.write(text)
            code, said = mypy(script, path=folder)
            tap.equal(code != 0, wrong, said)


tap.main(globals())
