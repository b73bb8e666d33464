"""Runs the asdic program in tests: its path is in the environment as ASDIC."""
import os
import subprocess


class Result:
    def __init__(self, process):
        self.code = process.returncode
        self.out = process.stdout.decode()
        self.err = process.stderr.decode()


def asdic(*args, stdin=b"", cwd=None, **env):
    """Exit code, standard output and error of asdic ARGS; ENV adds to the environment."""
    if isinstance(stdin, str):
        stdin = stdin.encode()
    return Result(subprocess.run([os.environ["ASDIC"], *map(str, args)], input=stdin, cwd=cwd,
                                 capture_output=True, timeout=120, check=False,
                                 env={**os.environ, **env}))
