"""The scripts of docs/gallery draw their pictures, here of few rays."""
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
SCRIPTS = sorted(glob.glob(os.path.join(GALLERY, "*.py")))


def check_maps(pyplot):
    """Maps of the figures that are open lie as seen from above: east is to the right of north."""
    for ax in (ax for number in pyplot.get_fignums() for ax in pyplot.figure(number).axes):
        along, up = ax.get_xlabel(), ax.get_ylabel()
        if {along, up} == {"north, m", "east, m"}:
            tap.equal(ax.xaxis_inverted() != ax.yaxis_inverted(), along == "north, m", "one axis is turned round")


def drawn(script, size):
    """What SCRIPT prints while it draws a picture. All share this process, since importing takes its time."""
    need_device()
    with tempfile.TemporaryDirectory(prefix="asdic-test-") as folder:
        picture, said = os.path.join(folder, "a.png"), io.StringIO()
        sys.argv[1:] = [picture, str(size)]
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
    printed = drawn(os.path.join(GALLERY, "avoid.py"), 2000)
    north, nearest = re.search(r"(\d+) m north, never nearer than ([\d.]+) m", printed).groups()
    tap.equal((int(north) >= 109, float(nearest) > 1.5), (True, True), printed)


def add(script):
    def test():
        drawn(script, 1000)
    globals()[f"test_{os.path.basename(script)[:-3]}"] = test


for one in SCRIPTS:
    if not one.endswith("avoid.py"):
        add(one)

tap.main(globals())
