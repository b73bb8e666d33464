"""What `meson install` puts down is enough for another project: the examples are compiled against
it, with pkg-config alone, shared and static, and run.

    test_install.py BUILD EXAMPLES SCENE
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

import tap

BUILD, EXAMPLES, SCENE = sys.argv[1:4]
del sys.argv[1:4]
STRICT = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]


class Tree:
    """The installed tree; made once."""
    path = None

    def __init__(self):
        if not Tree.path:
            Tree.path = tempfile.mkdtemp(prefix="asdic-install-")
            run(["meson", "install", "-C", BUILD, "--no-rebuild", "--quiet", "--destdir", Tree.path])
        pc = next(os.path.join(folder, "asdic.pc") for folder, _, names in os.walk(Tree.path)
                  if "asdic.pc" in names)
        self.library = os.path.dirname(os.path.dirname(pc))
        self.env = {**os.environ, "PKG_CONFIG_LIBDIR": os.path.dirname(pc),
                    "PKG_CONFIG_SYSROOT_DIR": Tree.path, "LD_LIBRARY_PATH": self.library}

    def flags(self, *args):
        return run(["pkg-config", *args, "asdic"], env=self.env).split()


def run(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False, **options)
    if done.returncode:
        raise AssertionError(f"{command} answers {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout


def compiled(tree, name, static):
    program = os.path.join(Tree.path, f"{name}_{'static' if static else 'shared'}")
    flags = tree.flags("--cflags", "--libs", *(["--static"] if static else []))
    if static:  # the drivers' loader and the like stay shared
        flags = ["-l:libasdic.a" if flag == "-lasdic" else flag for flag in flags]
    source = os.path.join(EXAMPLES, name + ".c")
    run([os.environ.get("CC", "cc"), "-std=c11", *STRICT, source, "-o", program, *flags, "-lm"], env=tree.env)
    return program


def test_examples_are_cxx_as_well():
    tree = Tree()
    for name in sorted(os.listdir(EXAMPLES)):
        if name.endswith(".c"):
            run(["g++", "-std=c++17", "-Wall", "-Werror", "-fsyntax-only", "-x", "c++", os.path.join(EXAMPLES, name),
                 *tree.flags("--cflags")])


def test_pkg_config_asks_for_nothing_else():
    tree = Tree()
    libraries = [flag for flag in tree.flags("--libs") if not flag.startswith("-L")]
    tap.equal(libraries, ["-lasdic"])


def check_loop(static):
    tree = Tree()
    out = run([compiled(tree, "loop", static), "33"], env=tree.env)
    # A vehicle 12 m deep over ripples of +- 1 m about 20 m: the bottom is 7 to 9 m below.
    for found in re.findall(r"strongest echo at ([0-9.]+) m", out) or ["nothing"]:
        assert 6.5 < float(found) < 10, out
    assert re.search(r"median [0-9.]+ ms, 99th percentile [0-9.]+ ms of 33", out), out


def test_loop_shared():
    check_loop(static=False)


def test_loop_static():
    with open(os.path.join(BUILD, "cli", "asdic"), "rb") as file:
        if b"__asan_init" in file.read():
            raise tap.Skip("the library asks for its sanitizer")
    check_loop(static=True)


def test_waterfall():
    tree = Tree()
    folder = os.path.join(Tree.path, "run")
    program = compiled(tree, "waterfall", static=False)
    with open(SCENE, encoding="utf-8") as file:
        text = file.read()
    scene = os.path.join(Tree.path, "two_pings.yaml")  # of one there is nothing to see over time
    with open(scene, "w", encoding="utf-8") as file:
        file.write(text.replace("\n  pings: 1\n", "\n  pings: 2\n"))
    run([program, scene, folder], env=tree.env)
    names = os.listdir(folder)
    assert "bins.csv" in names and any(name.startswith("waterfall_") for name in names), names
    done = subprocess.run([program, "/nonexistent.yaml", folder], env=tree.env, check=False,
                          capture_output=True, text=True)
    assert done.returncode and "/nonexistent.yaml" in done.stderr, done


def test_detect():
    tree = Tree()
    program = compiled(tree, "detect", static=False)
    out = run([program, SCENE, "rise"], env=tree.env)
    tap.equal(re.findall(r"^(\w+): .* P_D 0\.99", out, re.MULTILINE), ["forward", "down", "up"])
    done = subprocess.run([program, SCENE, "nothing"], env=tree.env, check=False,
                          capture_output=True, text=True)
    assert done.returncode and "nothing" in done.stderr, done


def test_libraries_go_where_loaders_look():
    """Into lib of the prefix, whatever packages meson finds: on Debian without dpkg-dev it takes lib64."""
    source = os.path.join(EXAMPLES, "..", "..", "meson.build")
    options = json.loads(run(["meson", "introspect", source, "--buildoptions"]))
    tap.equal([o["value"] for o in options if o["name"] == "libdir"], ["lib"])


def test_the_program_finds_its_parts_where_they_are_installed():
    """Of a window, which there is not: the part says so, or that it was built without. Alone, the program misses it."""
    tree = Tree()
    program = next(os.path.join(folder, "asdic") for folder, _, names in os.walk(Tree.path)
                   if os.path.basename(folder) == "bin" and "asdic" in names)
    lone = shutil.copy(program, os.path.join(Tree.path, "asdic_alone"))
    said = [subprocess.run([path, "view", SCENE], env={**tree.env, "SDL_VIDEODRIVER": "none"}, check=False,
                           capture_output=True, text=True, timeout=300) for path in (program, lone)]
    tap.equal([done.returncode for done in said], [1, 1])
    assert re.search("cannot open a display|without SDL2", said[0].stderr), said[0].stderr
    tap.contains(said[1].stderr, "cannot load this program's part 'window': it is missing")


def test_manual_pages_are_installed():
    tree = Tree()
    pages = [name for _, _, names in os.walk(Tree.path) for name in names]
    for page in ("asdic.1", "asdic-run.1", "asdic-help.1", "asdic-scene.5"):
        assert page in pages, pages
    assert tree.library


def test_scene_page_names_files_that_are_installed():
    Tree()
    page = next(os.path.join(folder, "asdic-scene.5") for folder, _, names in os.walk(Tree.path)
                if "asdic-scene.5" in names)
    with open(page, encoding="utf-8") as file:
        places = re.findall(r"^\.I share/(\S+)$", file.read(), re.MULTILINE)
    share = os.path.dirname(os.path.dirname(os.path.dirname(page)))
    tap.equal([place for place in places if not os.path.exists(os.path.join(share, place))], [])
    assert "asdic/scenes" in places, places


try:
    tap.main(globals())
finally:
    if Tree.path:
        shutil.rmtree(Tree.path)
