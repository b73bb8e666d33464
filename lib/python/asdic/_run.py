"""Runs: simulated into a folder, read from it as arrays, judged by detectors."""
from __future__ import annotations

import contextlib
import csv
import functools
import json
import math
import os
import shutil
import tempfile
import zlib
from typing import TYPE_CHECKING, Any, Iterator, Sequence, Union

import numpy as np

from ._library import (ArgumentError, Context, ExistsError, Fields, FileError, Handle, InputError, Progress, counted,
                       encoded, fail, ffi, fields, lib, note_opencl, number, open_devices, prepare_opencl, table, value_of,
                       warn, whole)
from ._ping import PARTS, Levels, Ping, beams_of, expected
from ._scene import Scene, SceneLike, choose_sampling, load_mission, remarks

if TYPE_CHECKING:
    import xarray

Folder = Union[str, "os.PathLike[str]"]


def _pings(pings: slice | range | None, count: int) -> tuple[int, int]:
    """The first of PINGS and their number."""
    if pings is None:
        return 0, count
    if not isinstance(pings, (slice, range)):
        raise TypeError(f"pings is a {type(pings).__name__}; it must be a slice or a range, as range(0, 10)")
    chosen = range(count)[pings] if isinstance(pings, slice) else pings
    if chosen.step != 1 or len(chosen) == 0 or chosen.start < 0 or chosen.stop > count:
        raise fail(ArgumentError, f"pings = {pings} is no row of pings, one after the other, among the {count} there are")
    return chosen.start, len(chosen)


def _keep_tolerance(context: Context, mission: Handle, devices: Handle, tolerance_db: float) -> None:
    wanted = ffi.new("asdic_tolerance *", {"stderr_db": number(tolerance_db, "tolerance_db"), "share": 0.99,
                                           "most_rays": 1 << 22})
    budget = ffi.new("asdic_ray_budget *")
    context.run(lib.asdic_mission_find_rays, context.pointer, mission.pointer, devices.pointer[0], wanted, budget)
    if budget.judged == 0:
        warn(f"no bin is above the noise, so that none can keep {tolerance_db:g} dB; the {budget.rays} rays a ping stay")
    elif not budget.is_kept:
        warn(f"{budget.rough_count} of {budget.judged} bins, in the {counted(budget.pings, 'ping')} looked at, stay above "
             f"{tolerance_db:g} dB with {budget.rays} rays a ping")


def _content(path: str) -> bytes | None:
    """What a file holds; None where it cannot be read."""
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError:
        return None


def _place(scene: SceneLike, folder: str, force: bool, resume: bool) -> str | None:
    """Where a SCENE in memory is kept: in the run's FOLDER, where detectors read it, and so does the program. None: it is a
    file, or the library refuses the folder."""
    if not isinstance(scene, Scene):
        return None
    path = os.path.join(folder, "scene.json")
    there = _content(path)
    is_other = there not in (None, scene.saved_json().encode(errors="surrogateescape"))
    if resume and is_other:
        raise fail(InputError, f"{path} is not the scene to be resumed; force begins anew")
    goes_on = resume and there is not None
    if os.path.exists(os.path.join(folder, "run.json")) and not force and not goes_on:
        return None
    if is_other and not force:
        raise fail(ExistsError, f"{path} is there, and is another scene; force replaces it")
    return path


@contextlib.contextmanager
def _saved(scene: Scene, path: str) -> Iterator[None]:
    """Saves SCENE at PATH. If what follows fails and leaves no run of its own, the folder is as it was."""
    folder = os.path.dirname(path)
    run = os.path.join(folder, "run.json")
    there, earlier = _content(path), _content(run)
    meshes = (os.path.join(folder, name) for name in scene._meshes)  # pylint: disable=protected-access
    made = [mesh for mesh in meshes if not os.path.exists(mesh)] + [path] * (there is None)
    folders, parent = [], os.path.abspath(folder)
    while not os.path.isdir(parent):
        folders.append(parent)
        parent = os.path.dirname(parent)
    try:
        scene.save(folder)
        yield
    except BaseException:
        if _content(run) in (None, earlier):
            for remove, one in [(os.remove, file) for file in made] + [(os.rmdir, empty) for empty in folders]:
                with contextlib.suppress(OSError):
                    remove(one)
            if there is not None:
                with open(path, "wb") as file:
                    file.write(there)
        raise


def _again(context: Context, mission: Handle, path: str) -> Handle:
    """MISSION as its file at PATH has it, which warns of the same."""
    sampling = ffi.new("asdic_sampling *", lib.asdic_mission_sampling(mission.pointer)[0])
    mission.close()
    context.is_quiet = True
    found = load_mission(context, path)
    context.is_quiet = False
    lib.asdic_mission_sampling(found.pointer)[0] = sampling[0]
    return found


_MENDS = "'asdic run' with --resume mends the run"


def _check(path: str, records: np.ndarray, first: int) -> None:
    """Whether RECORDS, of the pings from FIRST on, are as they were written: each ends in the CRC-32 of its other bytes."""
    records = np.asarray(records)  # no map, whose fields are slow to come by
    rows, sums, pings = records.view(np.uint8), records["crc32"], records["ping"]
    for k, row in enumerate(rows.reshape(len(records), records.dtype.itemsize)):
        if zlib.crc32(row[:-4]) != sums[k] or pings[k] != first + k:
            raise fail(InputError, f"'{path}' is damaged: ping {first + k} is not as it was written; {_MENDS}")


def _check_whole(path: str, files: list[dict[str, Any]]) -> None:
    """Whether the file at PATH has the sum that FILES of run.json have of it."""
    said, found = next((one["crc32"] for one in files if one["name"] == os.path.basename(path)), None), 0
    with open(path, "rb") as file:
        while some := file.read(1 << 20):
            found = zlib.crc32(some, found)
    if said != f"{found:08x}":
        raise fail(InputError, f"'{path}' is missing or damaged; {_MENDS}")


def _temporary() -> Handle:
    """A folder, the handle's pointer, that goes with it."""
    try:
        place = [tempfile.mkdtemp(prefix="asdic-")]
    except OSError as error:
        raise fail(FileError, f"no temporary folder can be made: {error.strerror}; give a folder") from error
    return Handle("temporary folder", place, lambda made: shutil.rmtree(made[0], ignore_errors=True))


def simulate(scene: SceneLike, folder: Folder | None = None, *, device: str | None = None, rays: int | None = None,
             seed: int | None = None, sampler: str | None = None, tolerance_db: float | None = None,
             pings: slice | range | None = None, force: bool = False, resume: bool = False,
             progress: Progress | bool = None) -> Run:
    """Simulates the pings of a scene, as `asdic run` does, and returns the run.

    SCENE is a scene file or an asdic.Scene, which is saved in the folder. FOLDER is kept; without one the run is in a
    temporary folder that goes with the run (its arrays stay). DEVICE: "auto", "all", "cpu", "gpu", "0:0", "name:TEXT".
    TOLERANCE_DB doubles the rays until 99 % of the bins keep it. PINGS: a slice or range of the mission's.

    PROGRESS: True for a bar, or a function of (what, done, total), called in this thread; what it raises stops
    the run. Ctrl-C stops at the next ping; what was simulated until then is in FOLDER, and RESUME goes on.
    """
    context = Context(progress)
    temporary = _temporary() if folder is None else None
    folder = os.fsdecode(encoded(folder, "folder")) if temporary is None else os.path.join(temporary.pointer, "run")
    place = _place(scene, folder, force, resume)
    mission = load_mission(context, scene)
    choose_sampling(mission, rays, seed, sampler)
    for remark in remarks(mission):
        warn(remark)
    first, count = _pings(pings, lib.asdic_mission_ping_count(mission.pointer))
    devices = open_devices(context, device)
    if tolerance_db is not None:
        _keep_tolerance(context, mission, devices, tolerance_db)
    path = ffi.new("char[]", encoded(folder, "folder"))
    options = ffi.new("asdic_run_options *", lib.asdic_run_options_default())
    options.folder, options.force, options.resume = path, bool(force), bool(resume)
    options.first, options.count = first, count
    options.progress, options.user = lib.asdic_python_run_progress, context.progress_user
    with _saved(scene, place) if isinstance(scene, Scene) and place else contextlib.nullcontext():
        if place:
            mission = _again(context, mission, place)
        context.run(lib.asdic_mission_run, context.pointer, mission.pointer, devices.pointer, devices.count, options)
    return Run(folder, _keep=temporary)


class Run:
    """A run folder as arrays, read from its files when they are looked at; nothing is copied. A file's sums are checked
    when it is first looked at.

    Arrays are [ping, beam, bin]: level_db, stderr_db and parts["bottom"], dB re 1 uPa, NAN without energy.
    """

    def __init__(self, folder: Folder, *, _keep: Any = None) -> None:
        self.folder = os.fsdecode(folder)
        self._keep = _keep
        self._context = Context()
        self._run = self._context.make("asdic_run", lib.asdic_run_close, lib.asdic_run_open, self._context.pointer,
                                       encoded(folder, "folder"), keeps=(_keep,))
        self._described = self._describe()
        info = self._info()
        path = os.path.join(self.folder, "pings.npy")
        try:
            self._records = np.load(path, mmap_mode="r")[:info.pings]
        except (OSError, ValueError) as error:
            raise fail(InputError, f"{path}: {error}") from error
        self._first = int(info.first_ping)
        self.beams = beams_of(info.sonar)

    def __reduce__(self) -> Any:
        if self._keep:
            raise TypeError("a run in a temporary folder goes with its process; give simulate a folder")
        return Run, (os.path.abspath(self.folder),)

    def _info(self) -> Any:
        return lib.asdic_run_get_info(self._run.pointer)

    def _describe(self) -> bytes:
        """run.json, which no two runs share: it ends in a sum of bytes and says how long each took."""
        path = os.path.join(self.folder, "run.json")
        try:
            with open(path, "rb") as file:
                return file.read()
        except OSError as error:
            raise fail(InputError, f"{path}: {error}") from error

    def _refuse_another(self) -> None:
        """Before the folder is looked at again: what is mapped stays the old run's when that was replaced."""
        if self._describe() != self._described:
            raise fail(InputError, f"'{self.folder}' was written anew since this run was opened; open it again by asdic.Run")

    @functools.cached_property
    def records(self) -> np.ndarray:
        """Everything, a structured array of a record a ping, as in pings.npy."""
        _check(os.path.join(self.folder, "pings.npy"), self._records, self._first)
        return self._records

    @functools.cached_property
    def info(self) -> dict[str, Any]:
        """run.json: version, scene, devices, times, errors, remarks."""
        return dict(json.loads(self._described))

    @property
    def sonar(self) -> Fields:
        """The sonar's settings, as in asdic/sonar.h."""
        return fields(self._info().sonar)

    @property
    def environment(self) -> Fields:
        """The water, as in asdic/environment.h."""
        return fields(self._info().environment)

    def _column(self, name: str) -> np.ndarray:
        if name not in (self._records.dtype.names or ()):
            raise KeyError(f"{name} is not among the records of {self.folder}")
        return np.asarray(self.records[name])

    @property
    def level_db(self) -> np.ndarray:
        """Levels, dB re 1 uPa."""
        return self._column("level_db")

    @property
    def stderr_db(self) -> np.ndarray:
        """One standard error of the levels' sampling, dB."""
        return self._column("stderr_db")

    @functools.cached_property
    def _made(self) -> dict[str, np.ndarray]:
        return {}

    @property
    def parts(self) -> Levels:
        """Levels of the mechanisms, dB re 1 uPa: parts["bottom"]. In float16 where the run is compact."""
        names = tuple(name for name in PARTS if f"{name}_db" in (self._records.dtype.names or ()))
        return Levels(names, lambda name: self._column(f"{name}_db"), self._made)

    @functools.cached_property
    def truth(self) -> np.ndarray:
        """What each bin's energy comes from, a structured array [ping] of arrays [beam, bin]: docs/dataset.md."""
        return self._beside("truth.npy", "truth")

    @functools.cached_property
    def pressure(self) -> np.ndarray:
        """Of a coherent run: baseband pressure, complex, re 1 uPa, [ping, element, sample]."""
        return self._beside("elements.npy", "elements")

    def _beside(self, name: str, key: str) -> np.ndarray:
        self._refuse_another()
        path = os.path.join(self.folder, name)
        try:
            array: np.ndarray = np.load(path, mmap_mode="r")
        except FileNotFoundError as error:
            stopped = len(self) < self._info().pings_planned
            why = ", and it comes with the last ping, before which this run was stopped" if stopped else ""
            raise fail(InputError, f"{path} is not there; the scene asks for it by output: {{{key}: true}}{why}") from error
        except (OSError, ValueError) as error:
            raise fail(InputError, f"{path}: {error}") from error
        if array.dtype.names:
            _check(path, array, self._first)
        else:
            _check_whole(path, self.info["files"])
        return array

    @property
    def pings(self) -> np.ndarray:
        """Numbers of the pings in the mission."""
        return self._column("ping")

    @property
    def times(self) -> np.ndarray:
        """Times of the pings, s."""
        return self._column("time_s")

    @property
    def positions(self) -> np.ndarray:
        """Where the sonar was, [ping, (north, east, down)], m."""
        return self._column("position_m")

    @property
    def attitudes(self) -> np.ndarray:
        """How the sonar was turned, a scanned one's head, [ping, (roll, pitch, yaw)], rad."""
        return self._column("attitude_rad")

    @property
    def altitudes(self) -> np.ndarray:
        """Heights above the bottom straight below, m."""
        return self._column("altitude_m")

    @property
    def ranges(self) -> np.ndarray:
        """Centres of the bins, m."""
        return (np.arange(self._records.dtype["level_db"].shape[1]) + 0.5) * self.sonar.bin_length_m

    @property
    def bearings(self) -> np.ndarray:
        """Where the beams look, degrees to starboard of the bow; of a scanned sonar of the head, which attitudes turn."""
        return np.degrees(self.beams["yaw_rad"])

    @property
    def names(self) -> list[str]:
        """The beams' names."""
        return list(self.beams["name"].tolist())

    def __len__(self) -> int:
        return len(self._records)

    def __repr__(self) -> str:
        beams, bins = self._records.dtype["level_db"].shape
        return f"<asdic.Run {self.folder}: {counted(len(self), 'ping')}, {counted(beams, 'beam')}, {counted(bins, 'bin')}>"

    def expect(self, ping: int = 0, *, progress: Progress | bool = None) -> Ping:
        """What is expected of record PING over a flat bottom without any object."""
        ping = whole(ping, "ping", 0, len(self) - 1)
        context, info, record = Context(progress), self._info(), ffi.new("asdic_record *")
        with self._context.lock:
            self._context.check(lib.asdic_run_read(self._run.pointer, ping, record))
            flat, pose = lib.asdic_run_flat_scene(self._run.pointer, record), record.pose
            result = expected(context, flat, info.environment, info.sonar, pose, info.bins)
        result.index, result.time = int(self.pings[ping]), float(self.times[ping])
        return result

    def detect(self, **options: Any) -> Detections:
        """asdic.detect(run, ...)."""
        return detect(self, **options)

    def to_xarray(self) -> xarray.Dataset:
        """An xarray.Dataset: dims ping, beam, range; coordinates with units; parts beside the level."""
        import xarray as xr  # pylint: disable=import-outside-toplevel,redefined-outer-name
        dims = ("ping", "beam", "range")
        level = {"units": "dB re 1 uPa"}
        names = {"level": self.level_db, **{name: self.parts[name] for name in self.parts}}
        stored = {"dtype": "float32"}  # netCDF has no float16, in which compact runs keep parts and errors
        data = {name: (dims, values, {**level, "long_name": f"{name} level" if name != "level" else "level"}, stored)
                for name, values in names.items()}
        data["stderr"] = (dims, self.stderr_db, {"units": "dB", "long_name": "one standard error of level"}, stored)
        metres, radians = {"units": "m"}, {"units": "rad"}
        coords: dict[str, Any] = {
            "ping": ("ping", self.pings), "beam": ("beam", self.names), "range": ("range", self.ranges, metres),
            "time": ("ping", self.times, {"units": "s"}),
            "bearing": ("beam", self.bearings, {"units": "degree", "long_name": "to starboard of yaw, of a scanned sonar its head's"}),
            "altitude": ("ping", self.altitudes, metres)}
        for k, name in enumerate(("north", "east", "down")):
            coords[name] = ("ping", self.positions[:, k], metres)
        for k, name in enumerate(("roll", "pitch", "yaw")):
            coords[name] = ("ping", self.attitudes[:, k], radians)
        attributes = {"asdic_version": self.info["version"], "seed": self.info["seed"], "rays": self.info["rays"],
                      "frequency_hz": self.sonar.frequency_hz}
        return xr.Dataset(data, coords, attributes)


class Detections:
    """What a detector found in a run, and what was there. `table` has a row a detection."""

    def __init__(self, run: Run, handle: Handle) -> None:
        self._handle, self._run = handle, run
        struct = handle.pointer
        self.report: Fields = fields(struct)
        """The numbers of asdic_detect_report: pfa, tracks, sampling_error_db, ..."""
        self.classes = table(struct.classes, struct.class_count, "asdic_detect_class", handle)
        """A row of the confusion table each: name, bins, detected, expected."""
        self.sights = table(struct.sights, struct.sight_count, "asdic_detect_sight", handle)
        """Each object as each beam saw it: object, beam, pings_seen, pings_detected, snr_db, pd."""
        with open(os.path.join(run.folder, "detections.csv"), encoding="utf-8", newline="") as file:
            self._lines = file.readlines()  # another detection replaces the file

    @functools.cached_property
    def table(self) -> np.ndarray:
        """detections.csv as a structured array: ping and bin whole numbers, beam and truth text, the rest floats."""
        names, *rows = csv.reader(self._lines)
        columns = [_column(name, [row[k] for row in rows]) for k, name in enumerate(names)]
        dtype = [(name, column.dtype) for name, column in zip(names, columns)]
        table = np.empty(len(rows), dtype)
        for name, column in zip(names, columns):
            table[name] = column
        return table

    def __repr__(self) -> str:
        return f"<asdic.Detections: {self.report.detections} in {counted(self.report.bins, 'bin')} of " \
               f"{counted(self.report.pings, 'ping')}>"


def _column(name: str, values: Sequence[str]) -> np.ndarray:
    """A column of detections.csv: names stay text, whatever they look like; of numbers empty ones are NAN."""
    if name in ("beam", "truth"):
        return np.array(values, str)
    if name in ("ping", "bin"):
        return np.array([int(value) for value in values], np.int64)
    return np.array([float(value) if value else math.nan for value in values], np.float64)


def _detector(run: Run, pfa: float | None, target: str | None, prior: float | None, snr_db: float | None,
              cost_ratio: float | None) -> Any:
    """The scene's detector with what is given in its place."""
    if pfa is not None and cost_ratio is not None:
        raise fail(ArgumentError, "pfa and cost_ratio are two thresholds; give one of them")
    detector = ffi.new("asdic_detector *", run._info().detector[0])  # pylint: disable=protected-access
    for name, value in (("pfa", pfa), ("prior", prior), ("snr_db", snr_db), ("cost_ratio", cost_ratio)):
        if value is not None:
            setattr(detector, name, number(value, name))
    if pfa is not None:
        detector.cost_ratio = math.nan
    if target is not None:
        detector.target = value_of("asdic_target", target, "target")
    return detector


def detect(run: Run | Folder, *, pfa: float | None = None, target: str | None = None, prior: float | None = None,
           snr_db: float | None = None, cost_ratio: float | None = None, background: str = "auto",
           cfar: str | None = None, cfar_cells: int | None = None, cfar_guard: int | None = None,
           truth_snr_db: float | None = None, cell_m: float | None = None, speed_mps: float | None = None,
           device: str | None = None, force: bool = False, progress: Progress | bool = None) -> Detections:
    """Judges every bin of a run, as `asdic detect` does; writes its tables into the run's folder.

    TARGET: "swerling0" to "swerling3". BACKGROUND: "auto", "flat", "simulated", "cfar". CFAR: "ca" or "os", over
    CFAR_CELLS (8) bins on either side but for CFAR_GUARD (2) next to the bin.
    SPEED_MPS (0.5): how fast objects go that are tracked, a standard deviation north and east.
    FORCE replaces what an earlier call left.
    """
    run = run if isinstance(run, Run) else Run(run)
    run._refuse_another()  # pylint: disable=protected-access
    context = Context(progress)
    options = ffi.new("asdic_detect_options *", lib.asdic_detect_options_default())
    options.detector = detector = _detector(run, pfa, target, prior, snr_db, cost_ratio)
    options.background = value_of("asdic_background_source", background, "background")
    if cfar is not None and background not in ("auto", "cfar"):
        raise fail(ArgumentError, f"cfar is a background of its own; leave background = {background!r} out")
    options.has_cfar = cfar is not None or background == "cfar"
    if cfar is not None:
        options.cfar.kind = value_of("asdic_cfar_kind", cfar, "cfar")
    if not options.has_cfar and (cfar_cells is not None or cfar_guard is not None):
        raise fail(ArgumentError, "cfar_cells and cfar_guard go with cfar")
    if cfar_cells is not None:
        options.cfar.cells = whole(cfar_cells, "cfar_cells", 1, 256)
    if cfar_guard is not None:
        options.cfar.guard = whole(cfar_guard, "cfar_guard", 0, 256)
    if truth_snr_db is not None:
        options.truth_snr_db = number(truth_snr_db, "truth_snr_db")
    if cell_m is not None:
        options.cell_m = number(cell_m, "cell_m")
    if speed_mps is not None:
        options.tracker.speed_mps = number(speed_mps, "speed_mps")
    selector = ffi.new("char[]", encoded(device, "device")) if device is not None else ffi.NULL
    options.device, options.force = selector, bool(force)
    options.progress, options.user = lib.asdic_python_run_progress, context.progress_user
    is_coherent = run._info().sampling.coherent  # pylint: disable=protected-access # what is in its bins is simulated
    is_simulated = is_coherent or not options.has_cfar and background != "flat"  # perhaps
    if is_simulated:
        prepare_opencl(context, "" if is_coherent else ", or detect with background='flat' or 'cfar'")
    try:
        report = context.make("asdic_detect_report", lib.asdic_detect_report_destroy, lib.asdic_run_detect, context.pointer,
                              encoded(run.folder, "folder"), options, keeps=(detector, selector))
        is_simulated = is_coherent or report.pointer.background == lib.ASDIC_BACKGROUND_SIMULATED
    finally:
        if is_simulated:
            note_opencl()
    return Detections(run, report)


__all__ = ["Detections", "Folder", "Run", "detect", "simulate"]
