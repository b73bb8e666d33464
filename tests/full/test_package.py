"""The Debian packages build, lintian finds no error in them, and together they hold a program that runs.

    test_package.py SOURCE
"""
import os
import shutil
import subprocess
import sys
import tempfile

import tap

SOURCE = sys.argv.pop(1)
PACKAGES = ["asdic", "asdic-data", "libasdic-dev", "libasdic0"]


def run(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    if done.returncode:
        raise AssertionError(f"{command} answers {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout


def test_packages_build_and_hold_a_working_program():
    for tool in ("dpkg-buildpackage", "dh", "lintian"):
        if not shutil.which(tool):
            raise tap.Skip(f"there is no {tool}")
    with tempfile.TemporaryDirectory(prefix="asdic-package-") as folder:
        tree = os.path.join(folder, "source")
        shutil.copytree(SOURCE, tree, ignore=shutil.ignore_patterns("build", "build-*", "demo", ".git"))
        run(["./dev", "package"], cwd=tree)  # fails where lintian has an error to tell
        made = os.path.join(tree, "build", "package")
        files = {name.split("_")[0]: os.path.join(made, name) for name in os.listdir(made)
                 if name.endswith(".deb")}
        tap.equal(sorted(name for name in files if not name.endswith("-dbgsym")), PACKAGES)
        root = os.path.join(folder, "root")
        for name in PACKAGES:
            run(["dpkg-deb", "-x", files[name], root])
        library = next(path for path, _, names in os.walk(root) if "libasdic.so.0" in names)
        program = os.path.join(root, "usr/bin/asdic")
        env = {**os.environ, "LD_LIBRARY_PATH": library}
        tap.contains(run([program, "--version"], env=env), "asdic")
        scene = os.path.join(root, "usr/share/asdic/scenes/scenario2.yaml")
        tap.contains(run([program, "check", scene], env=env), "rise")


tap.main(globals())
