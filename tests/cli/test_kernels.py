"""Devices without luxuries: the same bins from every ray kernel, every number of threads, and a device
that runs one work-item after the other; no kernel needs local memory or double precision."""
import glob
import os
import re

import program
import tap
from program import Folder, asdic

HERE = os.path.dirname(__file__)
SCENE = os.path.join(HERE, "kernels.yaml")


def bins(folder, name, *options, **environment):
    asdic("run", SCENE, "--rays", "6000", "-o", folder / name, *options, **environment).check(code=0)
    return folder.read(os.path.join(name, "bins.csv"))


def test_same_bins_everywhere():
    program.need_device()
    with Folder() as folder:
        plain = bins(folder, "plain")
        tap.equal(len(plain.splitlines()) > 20, True)
        for kernel in ("wide8", "pkt16", "frustum64", "scalar"):
            tap.equal(bins(folder, kernel, "--kernel", kernel), plain, kernel)
        tap.equal(bins(folder, "one", POCL_MAX_PTHREAD_COUNT="1"), plain, "one thread")
        tap.equal(bins(folder, "basic", POCL_DEVICES="basic"), plain, "PoCL's plainest device")


def test_kernels_compile_in_silence():
    """PoCL prints how many warnings its compiler has, and other drivers take some for errors."""
    program.need_device()
    with Folder() as folder:
        done = asdic("run", SCENE, "--rays", "64", "-q", "-o", folder / "cold",
                     POCL_CACHE_DIR=folder / "cache")
        done.check(code=0, err="")


def test_kernels_need_no_luxuries():
    """Local memory is never used, so that any amount is enough; neither is double precision."""
    for path in glob.glob(os.path.join(HERE, "..", "..", "kernels", "*.cl")):
        with open(path, encoding="utf-8") as file:
            text = re.sub(r"/\*.*?\*/", "", file.read(), flags=re.DOTALL)
        for word in ("__local", "double", "cl_khr_fp64"):
            tap.equal(re.findall(rf"\b{word}\b", text), [], os.path.basename(path))


def test_mistakes_have_their_exit_codes():
    asdic("run", SCENE, "--kernel", "fast").check(code=2, out="")


tap.main(globals())
