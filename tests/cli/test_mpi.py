"""One mission by several processes: mpirun -n N asdic run gives the bytes of a single process."""
import os
import shutil
import signal
import subprocess
import time

import program
import tap
from program import Folder, asdic
from run_folder import facts, same, scene

HAS_MPI = os.environ["ASDIC_MPI"] == "1"
ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def need_mpi():
    if not HAS_MPI:
        raise tap.Skip("asdic was built without MPI")
    if not shutil.which("mpirun"):
        raise tap.Skip("there is no mpirun")
    program.need_device()


def mpirun(processes, *args, command=(program.PATH,)):
    """The command of a launch by Open MPI."""
    return ["mpirun", "-n", str(processes), "--bind-to", "none", "--oversubscribe", *command,
            *map(str, args)]


def launch(*args, **kwargs):
    done = subprocess.run(mpirun(*args, **kwargs), capture_output=True, check=False, timeout=110,
                          env=program.environment(ROOT))
    return program.Result(done.returncode, done.stdout.decode(), done.stderr.decode())


def test_any_number_of_processes_gives_the_same_bytes():
    need_mpi()
    with Folder() as folder:
        scene(folder, pings=70, rays=1000)
        path = folder.write("told.yaml", folder.read("pool.yaml").replace("output: {", "output: {truth: true, "))
        asdic("run", path, "-o", folder / "alone").check(code=0)
        tap.equal(os.path.exists(folder / "alone/truth.npy"), True)
        for n in (1, 2, 4):
            done = launch(n, "run", path, "-o", folder / f"by{n}").check(code=0, out="")
            tap.equal(done.err.count("70 pings"), 1, "one process speaks")
            same(folder, "alone", f"by{n}")
            tap.equal(facts(folder, f"by{n}")["state"], "complete")


def test_failures_are_told_once():
    need_mpi()
    with Folder() as folder:
        path = scene(folder)
        done = launch(3, "run", folder / "absent.yaml").check(code=3)
        tap.equal(done.err.count("error: "), 1, done.err)
        os.mkdir(folder / "r")
        with open(folder / "r/run.json", "w", encoding="ascii") as file:
            file.write("{}")
        done = launch(2, "run", path, "-o", folder / "r").check(code=1)
        tap.equal(done.err.count("holds a run already"), 1, done.err)
        # The second process reads another scene: it is left out.
        folder.write("other.yaml", folder.read("pool.yaml").replace("seed: 7", "seed: 8"))
        pick = ["sh", "-c", 'test "$OMPI_COMM_WORLD_RANK" = 0 || set -- "$1" other.yaml "$3" "$4"; '
                f'cd {folder.path} && exec {program.PATH} "$@"', "sh"]
        done = launch(2, "run", "pool.yaml", "-o", "mixed", command=pick).check(code=0)
        tap.contains(done.err, "process 1 takes no part: it has another scene")
        asdic("run", path, "-o", folder / "alone").check(code=0)
        same(folder, "alone", "mixed")


def test_killed_job_is_resumed_by_another():
    need_mpi()
    with Folder() as folder:
        path = scene(folder, pings=300, rays=4000)
        job = subprocess.Popen(mpirun(2, "run", path, "-o", folder / "r"), start_new_session=True,
                               stderr=subprocess.DEVNULL, env=program.environment(ROOT))
        end = time.monotonic() + 60
        while time.monotonic() < end and job.poll() is None:
            if os.path.exists(folder / "r/pings.npy.part") and \
                    os.path.getsize(folder / "r/pings.npy.part") > 20000:
                break
            time.sleep(0.005)
        os.killpg(job.pid, signal.SIGKILL)
        job.wait()
        end = time.monotonic() + 30
        while True:  # its processes notice that it is gone
            done = launch(2, "run", path, "-o", folder / "r", "--resume")
            if done.code == 0 or time.monotonic() > end:
                break
            tap.contains(done.err, "another process is writing")
        done.check(code=0)
        asdic("run", path, "-o", folder / "alone").check(code=0)
        same(folder, "alone", "r")


def test_without_mpi_processes_do_not_write_over_each_other():
    if HAS_MPI:
        raise tap.Skip("asdic was built with MPI")
    with Folder() as folder:
        path = scene(folder)
        done = asdic("run", path, "-o", folder / "r", OMPI_COMM_WORLD_SIZE="4").check(code=2)
        tap.contains(done.err, "-Dmpi=enabled")


tap.main(globals())
