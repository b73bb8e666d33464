"""Readers of our files that others wrote, from npm."""
import fcntl
import json
import os
import shutil
import subprocess

import tap

READERS = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../cli/readers"))
FOLDER = os.path.join(os.environ["BUILD_FOLDER"], "node")


def versions(path):
    """Of the packages that READERS/package.json names: (wanted, what PATH has)."""
    with open(os.path.join(READERS, "package.json"), encoding="utf-8") as file:
        wanted = json.load(file)["dependencies"]
    found = {}
    for name in wanted:
        own = os.path.join(path, "node_modules", name, "package.json")
        if os.path.exists(own):
            with open(own, encoding="utf-8") as file:
                found[name] = json.load(file)["version"]
    return wanted, found


def packages():
    """The folder with the packages, which `./dev test` installs; here where it has not."""
    if not shutil.which("node") or not shutil.which("npm"):
        raise tap.Skip("no node and npm")
    os.makedirs(FOLDER, exist_ok=True)
    with open(os.path.join(FOLDER, "lock"), "w", encoding="utf-8") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        wanted, found = versions(FOLDER)
        if found != wanted:
            shutil.copy(os.path.join(READERS, "package.json"), FOLDER)
            done = subprocess.run(["npm", "install", "--no-package-lock", "--no-audit", "--no-fund", "--silent",
                                   "--fetch-retries=0"], cwd=FOLDER, capture_output=True, text=True,
                                  check=False, timeout=100)
            if done.returncode:
                raise tap.Skip("npm cannot install the readers: " + (done.stdout + done.stderr)[-200:].strip())
    return FOLDER


def read(script, *arguments):
    """What the reader SCRIPT prints."""
    done = subprocess.run(["node", os.path.join(READERS, script), packages(), *arguments],
                          capture_output=True, text=True, check=False, timeout=100)
    tap.equal(done.returncode, 0, done.stderr)
    return done.stdout
