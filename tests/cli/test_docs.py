"""README.md and docs/: every example runs, every link leads somewhere, every name exists.

A fence says how its text is tested:

    ```sh             run line by line, in one folder a page, where data and build/cli/asdic are those
                      of this tree and asdic is on the path
    ```sh by=TEST     run by the test of that name (meson test --list), or, by=hand, by nobody: it
                      installs packages, opens a window, needs ROS 2 or takes minutes
    ```console        '$ command', then what it prints; numbers may have fewer digits
    ```yaml           a scene, kept as scene.yaml; or some keys of one, put in place of those of the
                      page's last scene (README's on a page without): asdic check accepts it
    ```c, ```python   a whole program, compiled without a warning; run, where it takes no argument
    ```c from=FILE    stands in that file, word for word
    ```text           nothing to run
"""
import functools
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import program
import tap
from program import Folder, asdic

ROOT = pathlib.Path(__file__).resolve().parents[2]
README = ROOT / "README.md"
PAGES = [README, *sorted((ROOT / "docs").glob("*.md"))]
FOLDERS = [ROOT / name / "README.md" for name in ("lib", "kernels", "data", "tests")]
KINDS = {"sh", "console", "yaml", "c", "python", "text"}


def text_of(page):
    return page.read_text(encoding="utf-8")


def fences(page):
    """(kind, test that runs it or '', text) of every fence but excerpts, in order."""
    found = re.findall(r"^```(\w+)(?: (by|from)=(\S+))?\n(.*?)^```$", text_of(page), re.M | re.S)
    tap.equal(2 * len(found), len(re.findall(r"^```", text_of(page), re.M)), f"fences of {page.name}")
    return [(kind, by, text) for kind, what, by, text in found if what != "from"]


def prose(page):
    """The page without its fences."""
    return re.sub(r"^```.*?^```$", "", text_of(page), flags=re.M | re.S)


def anchor(heading):
    """As GitHub makes them of headings."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def headings(page, level):
    return re.findall(rf"^{'#' * level} (.+)$", prose(page), re.M)


def test_readme_is_two_screens():
    tap.equal(len(text_of(README)) <= 9000, True, f"{len(text_of(README))} characters are 9,000 at most")


def test_every_page_lists_its_contents():
    for page in PAGES[1:]:
        parts = [name for name in headings(page, 2) if name != "Contents"]
        if page.name == "README.md":
            listed = set(re.findall(r"\]\((\w+\.md)\)", text_of(page)))
            tap.equal(listed, {other.name for other in PAGES[1:]} - {"README.md"}, "pages of docs/README.md")
        else:
            contents = re.findall(r"^- \[(.+)\]\(#(.+)\)$", prose(page), re.M)
            tap.equal(contents, [(name, anchor(name)) for name in parts], f"contents of {page.name}")


def test_links_lead_somewhere():
    for page in PAGES + FOLDERS:
        for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
            if re.match(r"https?:", target):
                continue
            name, _, place = target.partition("#")
            there = (page.parent / name).resolve() if name else page
            tap.equal(there.exists(), True, f"{page.name}: {target} exists")
            if place:
                known = [anchor(heading) for level in (1, 2, 3) for heading in headings(there, level)]
                tap.contains(known, place)


def test_excerpts_stand_in_their_files():
    for page in PAGES:
        for name, text in re.findall(r"^```\w+ from=(\S+)\n(.*?)^```$", text_of(page), re.M | re.S):
            tap.contains(text_of(ROOT / name), text)


def test_names_of_files_exist():
    """Words in backticks that begin with one of our folders."""
    for page in PAGES + FOLDERS:
        for word in re.findall(r"`((?:lib|kernels|cli|tests|data|docs)/[^`\s]*)`", prose(page)):
            if "<" not in word:
                tap.equal(any(ROOT.glob(word.rstrip("/"))), True, f"{page.name}: {word} exists")


def test_a_commands_row_is_where_it_is_said_to_be():
    file, = re.findall(r"a row in `(cli/[^`]+)`", prose(ROOT / "docs" / "extend.md"))
    tap.contains(text_of(ROOT / file), "X(run)")


def test_names_of_tests_exist():
    build = pathlib.Path(program.PATH).parents[1]
    done = subprocess.run(["meson", "introspect", "--tests", build], capture_output=True, text=True, check=False)
    if done.returncode:
        raise tap.Skip(f"meson does not tell the tests: {done.stderr.strip()}")
    known = {test["name"] for test in json.loads(done.stdout)}
    # What this build leaves out, as without Python, is named as well.
    known |= {name for file in (ROOT / "tests").glob("*/meson.build")
              for name in re.findall(r"\btest\('(\w+)'", text_of(file))}
    for page in PAGES + FOLDERS:
        named = re.findall(r"`meson test -C build(?: --setup full)? ([^`]+)`", prose(page))
        if page in PAGES:
            named += [by for _, by, _ in fences(page) if by and by != "hand"]
        for name in set(" ".join(named).split()) - {"NAME"}:
            tap.equal(name in known, True, f"{page.name}: there is a test {name}")
        for name in re.findall(r"build/tests/(\w+/\w+)", text_of(page)):
            built = {f"{source.parent.name}/{source.stem}" for source in (ROOT / "tests").glob("*/*.c")}
            tap.equal(name in built or name.split("/")[1] in known, True, f"{page.name}: build/tests/{name} is built")


def test_commands_have_the_options_that_are_named():
    table = {c["name"]: c for c in json.loads(asdic("help", "--json").check(code=0).out)}
    for page in PAGES + FOLDERS:
        for command in re.findall(r"`(?:build/cli/)?asdic ([a-z][^`]*)`", prose(page)):
            name, *words = command.split()
            tap.equal(name in table, True, f"{page.name}: asdic {name} is a command")
            known = [f"--{option['name']}" for option in table[name]["options"]]
            known += [f"-{option['letter']}" for option in table[name]["options"] if option["letter"]]
            tap.equal([w for w in words if re.match(r"--?[a-z]", w) and w.split("=")[0] not in known], [],
                      f"{page.name}: unknown options of asdic {command}")
            kinds = table[name]["operands"].split()[:1]
            if words and kinds and re.fullmatch(r"[a-z|]+", kinds[0]):
                tap.contains(kinds[0].split("|"), words[0])


def replaced(scene, keys):
    """SCENE with its top-level keys replaced by those of KEYS, or with these added."""
    for key in re.findall(r"^(\w+):", keys, re.M):
        scene = re.sub(rf"^{key}:.*\n(?:(?:[ #].*)?\n)*", "", scene, flags=re.M)
    return scene + keys


def test_commands_of_dev_exist():
    usage = text_of(ROOT / "dev").split("usage: ./dev COMMAND")[1].split("\nTEXT\n")[0]
    for page in PAGES + FOLDERS:
        for word in re.findall(r"\./dev ([a-z]+)", text_of(page)):
            tap.contains(usage, f"\n  {word} ")


def dev(folder, *args, **env):
    """./dev ARGS in a copy that has nothing else, on a machine that has no packages; what it said."""
    os.makedirs(folder / "bin", exist_ok=True)
    for name in ("sh", "dirname", "cat", "mkdir", "ls", "awk", "nproc", "id"):
        if not os.path.exists(folder / f"bin/{name}"):
            os.symlink(shutil.which(name), folder / f"bin/{name}")
    shutil.copy(ROOT / "dev", folder.path)
    return subprocess.run(["sh", folder / "dev", *args], capture_output=True, text=True, check=False,
                          env={"PATH": folder / "bin", "HOME": folder.path, **env})


def test_dev_says_what_is_lost_without_a_package():
    with Folder() as folder:
        done = dev(folder, "build")
        tap.equal(done.returncode, 1, done.stderr)
        for words in ("libsdl2-dev 'asdic view' has no window", "openmpi-bin 'mpirun asdic run' is not possible",
                      "libcairo2-dev pictures have no axes"):
            tap.contains(done.stdout, f"dev: without {words}")
        line = re.search("sudo apt-get install (.*)", done.stderr).group(1).split()
        tap.equal({"meson", "libcairo2-dev", "openmpi-bin"} <= set(line), True, f"in one line: {line}")


def test_dev_help_makes_nothing():
    with Folder() as folder:
        for args in (["help"], ["gpu", "--help"], ["bench", "fan", "-h"], ["test", "--full", "--help"]):
            tap.contains(dev(folder, *args).stdout, "usage: ./dev COMMAND")
        tap.equal(sorted(os.listdir(folder.path)), ["bin", "dev"], "files")


def test_waters_have_the_figures_that_asdic_model_prints():
    rows = re.findall(r"^\| [^|]+ \| `\{(temperature_degc: [^`]*)\}` \| (\d+) \| (\d+) \|$",
                      text_of(ROOT / "data" / "README.md"), re.M)
    tap.equal(len(rows) >= 6, True, "six waters or more")
    for water, *figures in rows:
        value = dict(re.findall(r"(\w+): ([-\d.]+)", water))
        keys = [f"t_degc={value['temperature_degc']}", f"s_ppt={value['salinity_ppt']}", "z_m=5"]
        printed = [asdic("model", "sound-speed", *keys).check(code=0).out,
                   asdic("model", "absorption", *keys, f"ph={value['ph']}", "f_khz=450").check(code=0).out]
        tap.equal([f"{float(line.split()[0]):.0f}" for line in printed], figures, water)


def is_scene(text):
    return text.startswith("version:")


class Workplace(Folder):
    """A folder that looks like the top of a tree that was built."""

    def __enter__(self):
        super().__enter__()
        os.makedirs(self / "build/cli")
        os.makedirs(self / "build/lib")
        os.makedirs(self / "bin")
        for name in ("build/cli/asdic", "bin/asdic"):
            os.symlink(program.PATH, self / name)
        os.symlink(os.environ["LIBASDIC"], self / "build/lib/libasdic.so.0")
        os.symlink(ROOT / "data", self / "data")
        return self

    def start(self, command):
        env = program.environment({"PATH": f"{self / 'bin'}:{os.environ['PATH']}",
                                   "PYTHONPATH": os.environ.get("ASDIC_PYTHON"),
                                   "LD_LIBRARY_PATH": self / "build/lib"})
        return subprocess.run(command, cwd=self.path, env=env, capture_output=True, text=True,
                              timeout=100, check=False)

    def run(self, command, what):
        done = self.start(command)
        tap.equal(done.returncode, 0, f"{what}: {done.stdout[-2000:]}{done.stderr[-2000:]}\ncode")
        return done


def compile_c(place, text):
    if not shutil.which("cc"):
        raise tap.Skip("there is no C compiler")
    place.write("example.c", text)
    place.run(["cc", "-std=c11", "-D_GNU_SOURCE", "-Wall", "-Wextra", "-Wpedantic", "-Werror",
               f"-I{ROOT / 'lib/include'}", "example.c", "-o", "example", os.environ["LIBASDIC"], "-lm",
               f"-Wl,-rpath,{os.path.dirname(os.environ['LIBASDIC'])}"], "compile")


def as_shown(actual, shown):
    """ACTUAL with the numbers that SHOWN has with fewer digits rounded to as many."""
    decimals = iter(re.findall(r"-?\d+\.(\d+)", shown))

    def shorter(number):
        return f"{float(number.group()):.{len(next(decimals, number.group(1)))}f}"
    return re.sub(r"-?\d+\.(\d+)", shorter, actual)


def check_console(place, text, page):
    for command, expected in re.findall(r"^\$ (.+)\n((?:(?!\$ ).*\n)*)", text, re.M):
        done = place.start(["sh", "-c", command + " 2>&1"])
        tap.equal(as_shown(done.stdout, expected), expected, f"{page.name}: {command}")


def imports_of(text):
    return "; ".join(re.findall(r"^import .+$", text, re.M))


@functools.cache
def python_with(imports):
    """The first Python that does IMPORTS, or None."""
    with Workplace() as place:
        return next((p for p in (sys.executable, "/usr/bin/python3") if place.start([p, "-c", imports]).returncode == 0),
                    None)


def check_fence(place, page, kind, text):
    if kind == "sh":
        place.run(["sh", "-ec", text], f"{page.name}: {text}")
    elif kind == "console":
        check_console(place, text, page)
    elif kind == "yaml":
        name = "scene.yaml" if is_scene(text) else "changed.yaml"
        place.write(name, text if is_scene(text) else replaced(place.read("scene.yaml"), text))
        done = place.run(["asdic", "check", name], f"{page.name}: {text}")
        tap.lacks(done.stderr, "look where 'transmitter' sends less")
    elif kind == "c":
        compile_c(place, text)
        if "argc" not in text:
            place.run(["./example"], f"{page.name}: the program")
    elif kind == "python":
        python = python_with(imports_of(text))
        if not python:
            raise tap.Skip(f"no python3 does '{imports_of(text)}'")
        place.run([python, place.write("example.py", text)], f"{page.name}: {text}")


def check_page(page):
    with Workplace() as place:
        place.write("scene.yaml", next(text for kind, _, text in fences(README) if kind == "yaml"))
        for kind, by, text in fences(page):
            tap.equal(kind in KINDS, True, f"{page.name}: a fence is {kind}")
            if not by:
                check_fence(place, page, kind, text)


def add_page(page):
    def test():
        program.need_device()
        check_page(page)
    folder = "" if page == README else "docs_"
    globals()[f"test_examples_of_{folder}{page.stem.lower()}"] = test


for one in PAGES:
    if fences(one):
        add_page(one)

tap.main(globals())
