"""What unit tests allocate they free: those that are named run again on the heap of LeakSanitizer.

    test_leaks.py PATH_OF_LIBLSAN PROGRAM...
"""
import os
import subprocess
import sys

import tap

LIBRARY, *PROGRAMS = sys.argv[1:]
del sys.argv[1:]
KNOWN = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "full", "leaks.txt")
LEAKED = 86  # the exit code


def run(program):
    """Its exit code, and what it said."""
    environment = {**os.environ, "LD_PRELOAD": LIBRARY,
                   "LSAN_OPTIONS": f"exitcode={LEAKED}:print_suppressions=0:suppressions={KNOWN}"}
    done = subprocess.run([program], env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", check=False)
    return done.returncode, done.stdout


def test_programs_free_what_they_allocate():
    leaks = []
    for program in PROGRAMS:
        code, said = run(program)
        if "LeakSanitizer has encountered a fatal error" in said:  # as where a debugger looks on
            raise tap.Skip("LeakSanitizer does not work here")
        if code == LEAKED:
            leaks.append(said[said.rindex("ERROR: LeakSanitizer"):])
    tap.equal(leaks, [], "leaks")


tap.main(globals())
