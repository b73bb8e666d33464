"""Every public header compiles alone, as C and as C++, without a warning."""
import glob
import os
import shutil
import subprocess
import sys

import tap

INCLUDE = sys.argv.pop(1)
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror", "-fsyntax-only"]


def compile_all(compiler, language, standard):
    if not shutil.which(compiler):
        raise tap.Skip(f"there is no {compiler}")
    headers = sorted(glob.glob(os.path.join(INCLUDE, "asdic", "*.h")))
    tap.equal(len(headers) > 10, True, "headers are found")
    for path in headers:
        name = os.path.relpath(path, INCLUDE)
        # Twice: the guard works, too.
        text = f"#include <{name}>\n#include <{name}>\n"
        done = subprocess.run([compiler, *STRICT, f"-std={standard}", "-x", language, "-I", INCLUDE,
                               "-"], input=text, capture_output=True, text=True, check=False)
        if done.returncode:
            raise AssertionError(f"{name}: {done.stderr}")


def test_gcc_c11():
    compile_all("gcc", "c", "c11")


def test_gcc_c99():
    compile_all("gcc", "c", "c99")


def test_gcc_cpp11():
    compile_all("g++", "c++", "c++11")


def test_clang_c11():
    compile_all("clang", "c", "c11")


def test_clang_cpp17():
    compile_all("clang++", "c++", "c++17")


def test_lines_fit_a_page():
    for path in sorted(glob.glob(os.path.join(INCLUDE, "asdic", "*.h"))):
        with open(path, encoding="utf-8") as file:
            long = [number for number, line in enumerate(file, 1) if len(line.rstrip("\n")) > 100]
        tap.equal(long, [], f"lines of {os.path.basename(path)} over 100 columns")


tap.main(globals())
