"""Devices that fail half-way, unequal devices, and what can go wrong with files."""
import os
import re
import shutil
import subprocess

import program
import tap
from program import Folder, asdic
from run_folder import data, facts, same, scene

FAULT = os.environ["OPENCL_FAULT_LIBRARY"]
POCL = "/etc/OpenCL/vendors/pocl.icd"

# Name, the fault (see opencl_fault.c), words of the warning.
FAULTS = (
    ("build", "build:0:-11", "does not compile"),
    ("build, of the last program", "build:1:-11", "does not compile"),
    ("memory, at the beginning", "buffer:4:-4", "CL_MEM_OBJECT_ALLOCATION_FAILURE"),
    ("resources, first ping", "kernel:0:-5", "CL_OUT_OF_RESOURCES"),
    ("resources, half-way", "kernel:120:-5", "CL_OUT_OF_RESOURCES"),
    ("host memory, half-way", "kernel:160:-6", "CL_OUT_OF_HOST_MEMORY"),
    ("lost, half-way", "read:20:-2", "CL_DEVICE_NOT_AVAILABLE"),
    ("lost, while writing", "write:40:-36", "CL_INVALID_COMMAND_QUEUE"),
)


def with_fault(device, fault, *args, **env):
    return asdic(*args, LD_PRELOAD=FAULT, OPENCL_FAULT=f"{device}:{fault}", **env)


def two_devices():
    """The environment of two unequal devices."""
    env = {"POCL_DEVICES": "pthread basic"}
    if "0:1" not in asdic("devices", **env).out:
        raise tap.Skip("PoCL's pthread and basic devices are not here")
    return env


def test_device_that_fails_is_dropped():
    env = two_devices()
    with Folder() as folder:
        path = scene(folder, pings=80, rays=5000)  # one after the other
        asdic("run", path, "-o", folder / "whole").check(code=0)
        for n, (name, fault, words) in enumerate(FAULTS):
            for device in (n % 2,):
                done = with_fault(device, fault, "run", path, "-o", folder / "r", "--force",
                                  "--device", "all", "--quiet", **env).check(code=0)
                dropped = re.findall(r"device '.*' failed and is no longer used: .*", done.err)
                tap.equal(len(dropped), 1, f"{name}: of it in {done.err!r}")
                tap.contains(dropped[0], words)
                same(folder, "whole", "r")


def test_last_device_that_fails_leaves_a_run_to_resume():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=80, rays=5000)  # one after the other
        asdic("run", path, "-o", folder / "whole").check(code=0)
        done = with_fault(0, "kernel:300:-5", "run", path, "-o", folder / "r").check(code=1)
        tap.contains(done.err, "CL_OUT_OF_RESOURCES")
        tap.contains(done.err, "--resume goes on")
        run = facts(folder, "r")
        tap.equal((run["state"], 0 < run["pings"] < 80), ("interrupted", True))
        asdic("run", path, "-o", folder / "r", "--resume").check(code=0)
        same(folder, "whole", "r")
        with_fault(0, "build:0:-11", "run", path, "-o", folder / "none").check(code=4)
        tap.equal(os.path.exists(folder / "none"), False, "a folder for nothing")


def test_lists_of_devices():
    env = two_devices()
    with Folder() as folder:
        path = scene(folder, pings=80, rays=500)
        asdic("run", path, "-o", folder / "whole", "--device", "0:0", **env).check(code=0)
        for which, count in (("0:1,0:0", 2), ("all", 2), ("cpu", 2), ("name:basic", 1)):
            asdic("run", path, "-o", folder / "r", "--force", "--device", which, **env).check(code=0)
            same(folder, "whole", "r")
            tap.equal(len(facts(folder, "r")["devices"]), count, which)
        asdic("run", path, "-o", folder / "x", "--device", "0:7", **env).check(code=4)
        asdic("run", path, "-o", folder / "x", "--device", "0:0,0:0", **env).check(code=2)


def test_two_platforms_in_one_process():
    """Oclgrind, an interpreter, beside PoCL: the pings of both, in order, within 1e-3 dB of one's."""
    found = subprocess.run(["sh", "-c", "ls /usr/lib/*/oclgrind/liboclgrind-rt-icd.so "
                            "/usr/lib/*/liboclgrind-rt-icd.so /usr/lib/liboclgrind-rt-icd.so"],
                           capture_output=True, text=True, check=False).stdout.split()
    if not found or not os.path.exists(POCL):
        raise tap.Skip("Oclgrind's or PoCL's ICD library is not here")
    with Folder() as folder:
        vendors = folder / "vendors"
        os.mkdir(vendors)
        shutil.copy("/etc/OpenCL/vendors/pocl.icd", vendors)
        with open(os.path.join(vendors, "oclgrind.icd"), "w", encoding="ascii") as icd:
            icd.write(found[0] + "\n")
        env = {"OCL_ICD_VENDORS": vendors}
        listed = asdic("devices", **env).check(code=0).out
        if "Oclgrind" not in listed:
            raise tap.Skip("Oclgrind's device does not show")
        path = scene(folder, pings=96, rays=64, receivers="    - {name: forward}")
        asdic("run", path, "-o", folder / "pocl", "--device", "cpu").check(code=0)
        asdic("run", path, "-o", folder / "both", "--device", "0:0,1:0", **env).check(code=0)
        tap.equal(len(facts(folder, "both")["devices"]), 2, "devices")
        rows = [[line.split(",") for line in data(folder, run, "bins.csv").decode().splitlines()[1:]]
                for run in ("pocl", "both")]
        tap.equal([r[:5] for r in rows[0]], [r[:5] for r in rows[1]], "order")
        for a, b in zip(*rows):
            for x, y in zip(a[5:12], b[5:12]):
                if (x == "") != (y == "") or (x and abs(float(x) - float(y)) > 1e-3):
                    raise AssertionError(f"{a}\n{b}")


def test_a_signal_ends_what_waits_for_a_compiler():
    """Within two seconds, wherever the driver compiles: PoCL does so when a kernel first runs, too."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=3, rays=64)
        asdic("run", path, "-o", folder / "whole").check(code=0)
        for call in ("build", "kernel", "read"):
            env = {"LD_PRELOAD": FAULT, "OPENCL_FAULT": f"0:{call}:0:0"}
            with subprocess.Popen([program.PATH, "run", path, "-o", folder / call], text=True,
                                  stderr=subprocess.PIPE, env=program.environment(env)) as child:
                for line in child.stderr:
                    if line.startswith("opencl_fault: hangs"):
                        break
                err = program.stop(child)
            tap.contains(err, "interrupted while a driver compiled; --resume goes on")
            if os.path.exists(folder / call):
                asdic("run", path, "-o", folder / call, "--resume").check(code=0)
                same(folder, "whole", call)


def unprivileged(*args, cwd, **env):
    """asdic as a user who may not write everywhere: root without its privileges, which still may read the
    program in a home of its own that others may not enter."""
    drop = [] if os.getuid() != 0 else ["setpriv", "--bounding-set=-all", "--inh-caps=-all", "--"]
    if drop and not shutil.which("setpriv"):
        raise tap.Skip("there is no setpriv to drop root's privileges with")
    done = subprocess.run([*drop, program.PATH, *map(str, args)], cwd=cwd, capture_output=True, check=False,
                          env=program.environment(env))
    return program.Result(done.returncode, done.stdout.decode(), done.stderr.decode())


def test_read_only_folders():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=4, rays=500)
        asdic("run", path, "-o", folder / "r", "--pings", "0:2").check(code=0)
        before = data(folder, "r", "bins.csv")
        os.chmod(folder / "r", 0o555)
        os.chmod(folder.path, 0o555)
        try:
            for args in (["-o", folder / "new"], ["-o", folder / "r", "--force"]):
                done = unprivileged("run", path, *args, cwd="/").check(code=1)
                tap.contains(done.err, "Permission denied")
            tap.equal(before == data(folder, "r", "bins.csv"), True, "what was there")
            tap.equal(facts(folder, "r")["state"], "complete", "what was there")
        finally:
            os.chmod(folder.path, 0o755)
            os.chmod(folder / "r", 0o755)


def test_kernel_cache_that_cannot_be_written():
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=1, rays=500)
        closed = folder / "closed"
        os.mkdir(closed)
        os.chmod(closed, 0o555)
        places = (({"HOME": closed, "XDG_CACHE_HOME": None, "POCL_CACHE_DIR": None}, "Permission denied"),
                  ({"XDG_CACHE_HOME": closed, "POCL_CACHE_DIR": None}, "Permission denied"),
                  ({"POCL_CACHE_DIR": closed}, "Permission denied"),
                  ({"HOME": "/" + 4096 * "h", "XDG_CACHE_HOME": None, "POCL_CACHE_DIR": None}, "File name too long"),
                  ({"HOME": None, "XDG_CACHE_HOME": None, "POCL_CACHE_DIR": None}, "HOME is not set"))
        try:
            for place, why in places:
                env = {name: value and str(value) for name, value in place.items()}
                done = unprivileged("run", path, "-o", folder / "r", "--force", cwd="/",
                                    TMPDIR=folder.path, **env).check(code=0)
                tap.contains(done.err, "warning: compiled kernels cannot be kept in")
                tap.contains(done.err, f"({why}); they are kept in '{folder.path}/asdic-kernels-")
            kept = [name for name in os.listdir(folder.path) if name.startswith("asdic-kernels-")]
            tap.equal(len(kept), 1, "folders, which later runs share")
            done = unprivileged("devices", cwd="/", TMPDIR=folder.path, POCL_CACHE_DIR="").check(code=0)
            if not os.path.exists(POCL):
                return
            done = unprivileged("devices", cwd="/", TMPDIR="/dev/null", POCL_CACHE_DIR="/dev/null/x",
                                OCL_ICD_VENDORS=POCL).check(code=4)
            tap.contains(done.err, "cannot be kept in '/dev/null/x' (Not a directory), nor below '/dev/null' (Not a "
                         "directory); set POCL_CACHE_DIR")
            tap.contains(done.err, "set POCL_CACHE_DIR to a folder that can be written to: '/dev/null/x' cannot (Not a "
                         "directory); else install a driver")
        finally:
            os.chmod(closed, 0o755)


def test_kernel_cache_without_room():
    """LLVM would end the process at the first file that it cannot write whole."""
    program.need_device()
    with Folder() as folder:
        path = scene(folder, pings=1, rays=500)
        asdic("run", path, "-o", folder / "r").check(code=0)
        before = data(folder, "r", "bins.csv")
        shell = f"""
mount -t tmpfs -o size=200k none disk || exit 77
export POCL_CACHE_DIR=disk/cache
"{program.PATH}" devices || exit 1
TMPDIR=disk "{program.PATH}" run "{path}" -o r --force --quiet; code=$?
exit $((10 + code))
"""
        os.mkdir(folder / "disk")
        done = subprocess.run(["unshare", "-m", "sh", "-c", shell], cwd=folder.path, check=False, text=True,
                              env=program.environment({"TMPDIR": folder.path}),
                              capture_output=True) if shutil.which("unshare") else None
        if not done or done.returncode == 77 or "unshare" in done.stderr:
            raise tap.Skip("no file system of its own can be mounted here")
        tap.contains(done.stderr, "cannot be kept in 'disk/cache' (No space left on device); they are kept in "
                     f"'{folder.path}/asdic-kernels-")
        if not os.path.exists(POCL):
            return
        tap.equal(done.returncode, 11, done.stderr)
        tap.contains(done.stderr, "compiled kernels have no room in 'disk/cache' (No space left on device); free 8 MB")
        tap.equal((before == data(folder, "r", "bins.csv"), facts(folder, "r")["state"]), (True, "complete"), "")


def test_what_may_be_missing_makes_no_kernel_cache():
    """Where there is no driver nothing is compiled, and saying what is missing leaves no folder."""
    with Folder() as folder:
        done = asdic("devices", HOME=folder.path, XDG_CACHE_HOME=None, POCL_CACHE_DIR=None,
                     OCL_ICD_VENDORS=folder.path).check(code=4)
        tap.contains(done.err, "install a driver")
        tap.equal(os.listdir(folder.path), [], "what was made")


def test_mesh_that_vanishes():
    program.need_device()
    with Folder() as folder:
        folder.write("floor.obj", "v -50 -50 -12\nv 50 -50 -12\nv 50 50 -12\nv -50 50 -12\n"
                     "f 1 2 3\nf 1 3 4\n")
        text = folder.read(os.path.basename(scene(folder, pings=4, rays=500)))
        path = folder.write("floor.yaml", text.replace("bottom: {depth_m: 12, type: sand}",
                                                       "bottom: {mesh: {file: floor.obj}}"))
        asdic("run", path, "-o", folder / "r", "--shard", "1/2").check(code=0)
        before = {name: data(folder, "r", name) for name in os.listdir(folder / "r")}
        os.rename(folder / "floor.obj", folder / "gone.obj")
        for args in (["--shard", "1/2", "--resume"], ["--force"]):
            done = asdic("run", path, "-o", folder / "r", *args).check(code=3)
            tap.contains(done.err, "floor.obj: cannot open: No such file")
        tap.equal({name: data(folder, "r", name) for name in os.listdir(folder / "r")}, before,
                  "the run that was there")
        asdic("render", folder / "r").check(code=0)  # needs no mesh
        os.rename(folder / "gone.obj", folder / "floor.obj")
        asdic("run", path, "-o", folder / "r", "--force").check(code=0)


tap.main(globals())
