"""The scripts of docs/gallery draw the pictures that are kept beside them."""
import contextlib
import glob
import io
import os
import re
import runpy
import sys
import tempfile

from package import ROOT, need_device
import tap

GALLERY = os.path.join(ROOT, "docs", "gallery")
MOST_PIXELS = 20  # of another colour; a digit of a title has more
CLOSED_LOOPS = ("avoid.py",)  # each echo turns the way on: the last digit of a level makes another one
SCRIPTS = sorted(glob.glob(os.path.join(GALLERY, "*.py")))


def check_maps(pyplot):
    """Maps of the figures that are open lie as seen from above: east is to the right of north."""
    for ax in (ax for number in pyplot.get_fignums() for ax in pyplot.figure(number).axes):
        along, up = ax.get_xlabel(), ax.get_ylabel()
        if {along, up} == {"north, m", "east, m"}:
            tap.equal(ax.xaxis_inverted() != ax.yaxis_inverted(), along == "north, m", "one axis is turned round")


def check_same(picture, script):
    """PICTURE is the one that is kept of SCRIPT, where the same matplotlib drew that: others set type otherwise, and
    devices round otherwise, which moves a curve by part of a pixel."""
    kept = script[:-3] + ".png"
    with open(kept, "rb") as file:
        if f"version{sys.modules['matplotlib'].__version__}," not in file.read().decode("latin-1"):
            return
    seen, wanted = (sys.modules["matplotlib.pyplot"].imread(path)[..., :3] for path in (picture, kept))
    tap.equal(seen.shape, wanted.shape, f"pixels of {kept}")
    others = (abs(seen - wanted).max(axis=-1) > 0.1).sum()
    tap.equal(others < MOST_PIXELS, True, f"{others} pixels of {kept} are others: python3 {script} {kept}\nsame")


def drawn(script):
    """What SCRIPT prints while it draws its picture. All share this process, since importing takes its time."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        picture, said = os.path.join(folder, "a.png"), io.StringIO()
        sys.argv[1:] = [picture]
        try:
            with contextlib.redirect_stdout(said):
                runpy.run_path(script, run_name="__main__")
            check_maps(sys.modules["matplotlib.pyplot"])
        except ModuleNotFoundError as error:
            if error.name in ("matplotlib", "xarray"):
                raise tap.Skip(str(error)) from error
            raise
        finally:
            if "matplotlib.pyplot" in sys.modules:
                sys.modules["matplotlib.pyplot"].close("all")
        with open(picture, "rb") as file:
            content = file.read()
        tap.equal((content[:4], len(content) > 5000), (b"\x89PNG", True), "a picture")
        if os.path.basename(script) not in CLOSED_LOOPS:
            check_same(picture, script)
        return said.getvalue()


def test_seven_scripts_have_their_pictures():
    tap.equal(len(SCRIPTS), 7, "scripts")
    with open(os.path.join(ROOT, "docs", "python.md"), encoding="utf-8") as file:
        page = file.read()
    for script in SCRIPTS:
        name = os.path.basename(script)[:-3]
        tap.contains(page, f"(gallery/{name}.png)")
        tap.contains(page, f"(gallery/{name}.py)")
        tap.equal(os.path.getsize(os.path.join(GALLERY, name + ".png")) < 150000, True, f"{name}.png is small")


def test_the_controller_finds_its_way():
    printed = drawn(os.path.join(GALLERY, "avoid.py"))
    north, nearest = re.search(r"(\d+) m north, never nearer than ([\d.]+) m", printed).groups()
    tap.equal((int(north) >= 109, float(nearest) > 1.5), (True, True), printed)


def add(script):
    def test():
        drawn(script)
    globals()[f"test_{os.path.basename(script)[:-3]}"] = test


for one in SCRIPTS:
    if not one.endswith("avoid.py"):
        add(one)

tap.main(globals())
