"""Runs the asdic program in tests: its path is in the environment as ASDIC.

    from program import asdic
    done = asdic("devices", "--json", OCL_ICD_VENDORS="/nonexistent")
    tap.equal(done.code, 4)
"""
import functools
import os
import pathlib
import pty
import shutil
import signal
import subprocess
import tempfile
import time

import tap

PATH = os.environ["ASDIC"]


class Result:
    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err

    def check(self, code=None, out=None, err=None):
        """The exit code, standard output and error are these, as far as given; returns itself."""
        for what, actual, expected in (("exit code", self.code, code), ("stdout", self.out, out),
                                       ("stderr", self.err, err)):
            if expected is not None:
                tap.equal(actual, expected, f"{what} (stderr: {self.err.strip()!r})")
        return self


def environment(changes):
    """The tests' environment with CHANGES; a value of None removes."""
    return {name: value for name, value in {**os.environ, **changes}.items() if value is not None}


def asdic(*args, stdin=b"", cwd=None, most_s=120, **env):
    """Exit code, standard output and error of asdic ARGS, which may take MOST_S; ENV adds to the environment."""
    if isinstance(stdin, str):
        stdin = stdin.encode()
    done = subprocess.run([PATH, *map(str, args)], input=stdin, cwd=cwd, capture_output=True,
                          timeout=most_s, check=False, env=environment(env))
    return Result(done.returncode, done.stdout.decode(), done.stderr.decode())


def asdic_bench(*args, **env):
    """The same of asdic-bench, the benches that only the project needs; a build inside another is too far from its
    data."""
    env.setdefault("ASDIC_DATA", str(pathlib.Path(__file__).parents[2] / "data"))
    done = subprocess.run([os.environ["ASDIC_BENCH"], *map(str, args)], capture_output=True,
                          timeout=240, check=False, env=environment(env))
    return Result(done.returncode, done.stdout.decode(), done.stderr.decode())


def asdic_on_terminal(*args, **env):
    """The same when stderr is a terminal; stdout is dropped."""
    try:
        master, slave = pty.openpty()
    except OSError as error:
        raise tap.Skip(f"no pseudo-terminal: {error}") from error
    child = subprocess.Popen([PATH, *map(str, args)], stdin=subprocess.DEVNULL,
                             stdout=subprocess.DEVNULL, stderr=slave,
                             env=environment({"TERM": "xterm", "NO_COLOR": None, **env}))
    os.close(slave)
    text = b""
    while True:
        try:
            piece = os.read(master, 4096)
        except OSError:  # Linux says EIO at the end
            break
        if not piece:
            break
        text += piece
    os.close(master)
    return Result(child.wait(), "", text.decode())


@functools.cache
def devices_lack():
    """Why no OpenCL device is usable, or ''. Asked once: it takes a tenth of a second."""
    done = asdic("devices")
    return done.err.strip() if done.code == 4 else ""


def need_device():
    """Skips the test where no OpenCL device is usable."""
    if devices_lack():
        raise tap.Skip(devices_lack())


def is_sanitized():
    """Whether the program was built with a sanitizer, which wants a processor's whole address space."""
    return "san.so" in subprocess.run(["ldd", PATH], capture_output=True, text=True, check=False).stdout


class Folder:
    """A temporary folder: `with Folder() as folder: folder.write("a.yaml", text)`."""

    def __enter__(self):
        self.path = tempfile.mkdtemp(prefix="asdic-test-")
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.path)

    def __truediv__(self, name):
        return os.path.join(self.path, name)

    def write(self, name, text):
        path = self / name
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return path

    def read(self, name):
        with open(self / name, encoding="utf-8") as file:
            return file.read()

    def names(self):
        return sorted(os.listdir(self.path))


def stop(child, number=signal.SIGTERM, most_s=2):
    """Sends CHILD the signal, and returns what it still says (text or bytes). It ends within a second (two where the
    machine is busy), counted in waits: where the whole machine stands still these take longer, too."""
    tap.equal(child.poll(), None, "still at work")
    child.send_signal(number)
    waits = 0
    while child.poll() is None and waits < 1000:
        time.sleep(0.02)
        waits += 1
    if child.poll() is None:
        child.kill()
    err = child.communicate()[1]
    tap.equal(child.returncode, 128 + number, "exit code")
    tap.equal(waits < 50 * most_s, True, f"{waits} waits of 20 ms until it stopped")
    return err
