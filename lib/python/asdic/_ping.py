"""Pings: simulated one by one, or expected."""
# pylint: disable=protected-access # a simulator fills its pings
from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Callable

import numpy as np
from numpy.typing import ArrayLike

from ._library import (ArgumentError, Context, Fields, Handle, Progress, counted, doubles, encoded, fail, ffi, fields,
                       lib, masked, number, open_devices, table, value_of, whole, words)
from ._scene import SceneLike, choose_sampling, load_mission

PARTS = tuple(word for word in words("asdic_component") if word != "total")
"""The mechanisms of a level: "bottom", "surface", ..."""


AXES = ("x", "y", "z", "roll", "pitch", "yaw")
POSE, DOUBLES, FLOATS = map(ffi.typeof, ("asdic_pose *", "double[]", "float[]"))
HEAD = -(-ffi.sizeof("asdic_ping") // 8)  # doubles
NUMBERS = (float, int)
LEARN_BLOCK = int(lib.ASDIC_LEARN_BLOCK)


class Levels(Mapping[str, np.ndarray]):
    """Arrays by the name of the mechanism, made when they are asked for, and kept in MADE by their owner: it does not
    know these levels, so that both go when nobody wants them, without the garbage collector."""

    def __init__(self, names: tuple[str, ...], make: Callable[[str], np.ndarray], made: dict[str, np.ndarray]) -> None:
        self._names, self._make, self._made = names, make, made

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._names:
            raise KeyError(f"{name!r} is none of {', '.join(self._names)}")
        if name not in self._made:
            self._made[name] = self._make(name)
        return self._made[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise TypeError(f"these are several arrays; take one by its name, of {', '.join(self._names)}")

    def __repr__(self) -> str:
        return f"<levels of {', '.join(self._names)}>"


def beams_of(sonar: Any) -> np.ndarray:
    """The receivers: a structured array with name, pitch_rad, yaw_rad, ...; of a scanned sonar its head's."""
    return table(sonar.receivers, int(sonar.receiver_count), "asdic_beam", None)


COMPONENTS = words("asdic_component")
PATHS = words("asdic_path")
TRUTH = ("strongest", "share", "object", "object_share", *(name.replace("-", "_") for name in PATHS), "depression_rad")
"""The names of a bin's truth, as in truth.npy: docs/dataset.md."""


class _Mount:
    """How a mission carries its sonar: what pings keep of it."""

    def __init__(self, mission: Handle) -> None:
        self._mission, self._scene = mission, lib.asdic_mission_scene(mission.pointer)
        self._sweep = ffi.new("asdic_sweep *", lib.asdic_mission_sweep(mission.pointer))
        mission.outlive()  # pings are asked for pose and altitude to the very end

    def set_pose(self, pose: Any, at: tuple[float, ...], index: int) -> None:
        """Where the sonar is and looks, which is where the vehicle does unless a head turns."""
        pose[0] = lib.asdic_python_place(self._sweep, index, *at)

    def refuse_below_bottom(self, at: Sequence[float]) -> None:
        """As scene files and `asdic serve` do: from there levels would be those of a sea without a bottom."""
        bottom_m = lib.asdic_python_bottom(self._scene, at[0], at[1])
        if at[2] > bottom_m + 1e-6 * abs(bottom_m):  # a mesh in float is not exact to the last digit
            raise fail(ArgumentError, f"the vehicle is at z = {at[2]:g} m, below the bottom at {bottom_m:g} m")

    def altitude(self, pose: Any) -> float:
        """Above the bottom straight below, m."""
        return float(lib.asdic_scene_altitude_m(self._scene, pose.position_m))


class Ping:
    """One ping. Arrays are [beam, bin]; the library writes into their memory, and nothing is copied."""

    index = 0
    """Number of the ping, from 0."""
    time = math.nan
    """Simulated time, s."""
    _altitude = math.nan
    _level_db: np.ndarray | None = None
    _stderr_db: np.ndarray | None = None
    _at: tuple[_Mount, tuple[float, ...]] | None = None  # the vehicle, and where it was
    truth: Mapping[str, np.ndarray] | None = None
    """What each bin's energy comes from, by name (docs/dataset.md); None where it was not asked for."""
    pressure: np.ndarray | None = None
    """Of a coherent ping: baseband pressure, complex, re 1 uPa, [element, sample]; else None."""

    def __init__(self, beams: np.ndarray, bins: int, *, truth: bool = False, samples: tuple[int, int] = (0, 0)) -> None:
        self.beams = beams
        """The receivers: name, pitch_rad, yaw_rad, roll_rad, length_h_m, length_v_m."""
        self._shape = shape = (len(beams), bins)
        size = shape[0] * bins
        # The struct, energies, errors: one piece of memory, which the library fills whole. What looks at it is made when
        # it is asked for: the interpreter's code is no longer in the processor's caches after a ping.
        self._memory = memory = np.empty(HEAD + len(COMPONENTS) * size + (size + 1) // 2)
        self._struct = lib.asdic_python_lay(ffi.from_buffer(DOUBLES, memory), shape[0], bins)
        if truth:
            self._add_truth(shape)
        if samples[0]:
            self.pressure = np.zeros(samples, np.complex64)
            self._struct.elements, self._struct.samples = samples
            self._struct.pressure = ffi.from_buffer("float[]", self.pressure)

    def __reduce__(self) -> Any:
        raise TypeError("a ping lies in memory that the library writes into and cannot be copied or pickled; its arrays "
                        "can, as level_db")

    def _add_truth(self, shape: tuple[int, int]) -> None:
        self.truth = {name: np.zeros(shape, np.int16 if name in ("strongest", "object") else np.float32)
                      for name in TRUTH}
        at = {name: ffi.from_buffer("int16_t[]" if array.dtype == np.int16 else "float[]", array)
              for name, array in self.truth.items()}
        self._truth = ffi.new("asdic_ping_truth *", {
            **{name: at[name] for name in ("strongest", "share", "object", "object_share", "depression_rad")},
            "path": [at[name.replace("-", "_")] for name in PATHS]})
        self._struct.truth = self._truth

    @property
    def stderr_db(self) -> np.ndarray:
        """One standard error of the level's sampling, dB; NAN where there is no energy, and of a coherent ping."""
        if self._stderr_db is None:
            size = math.prod(self._shape)
            errors = self._memory[HEAD + len(COMPONENTS) * size:].view(np.float32)[:size].reshape(self._shape)
            self._stderr_db = np.where(self._energies[COMPONENTS["total"]] > 0, errors, np.float32(np.nan))
        return self._stderr_db

    @functools.cached_property
    def _energies(self) -> np.ndarray:
        count = len(COMPONENTS) * math.prod(self._shape)
        return self._memory[HEAD:HEAD + count].reshape(len(COMPONENTS), *self._shape)

    @functools.cached_property
    def _pose(self) -> Any:
        place = ffi.new(POSE)
        if self._at:
            mount, at = self._at
            mount.set_pose(place, at, self.index)
        return place

    @functools.cached_property
    def _made(self) -> dict[str, np.ndarray]:
        return {}

    @property
    def intensity(self) -> Levels:
        """Energy of each bin, linear re 1 uPa^2, of "total" and each mechanism."""
        return Levels(tuple(COMPONENTS), lambda name: self._energies[COMPONENTS[name]], {})

    def _levels(self, name: str) -> np.ndarray:
        levels = np.empty(self._shape, np.float32)
        lib.asdic_ping_levels(self._struct, COMPONENTS[name], ffi.from_buffer(FLOATS, levels))
        return levels

    @property
    def level_db(self) -> np.ndarray:
        """dB re 1 uPa; NAN where there is no energy."""
        if self._level_db is None:
            self._level_db = self._levels("total")
        return self._level_db

    @property
    def parts(self) -> Levels:
        """Levels of the mechanisms, dB re 1 uPa: parts["bottom"]."""
        return Levels(PARTS, self._levels, self._made)

    @property
    def pose(self) -> Fields:
        """Of the sonar: position_m.x, .y, .z, roll_rad, pitch_rad, yaw_rad."""
        return fields(self._pose)

    @property
    def altitude(self) -> float:
        """Above the bottom straight below, m; infinite where there is none."""
        if self._at:
            return self._at[0].altitude(self._pose)
        return self._altitude

    @property
    def ranges(self) -> np.ndarray:
        """Centres of the bins, m."""
        return (np.arange(self._shape[1]) + 0.5) * self.bin_length_m

    @property
    def bin_length_m(self) -> float:
        """Length of a bin."""
        return float(self._struct.bin_length_m)

    @property
    def bearings(self) -> np.ndarray:
        """Where the beams look, degrees to starboard of the bow; of a scanned sonar of the head, which `pose` turns."""
        return np.degrees(self.beams["yaw_rad"])

    @property
    def sample_m(self) -> float:
        """Range between samples of the pressure, m; sample n lies at (n + 1/2) of it."""
        return float(self._struct.sample_m)

    @property
    def rays(self) -> int:
        """Rays that were traced."""
        return int(self._struct.rays)

    def __repr__(self) -> str:
        beams, bins = self._shape
        return f"<asdic.Ping {self.index}: {counted(beams, 'beam')}, {counted(bins, 'bin')} of {self.bin_length_m:g} m>"


class Simulator:
    """A sonar in your own loop: give it a pose, get a ping.

    It numbers its pings from 0, learns where rays matter as missions do, turns a scanned sonar's head and
    moves objects that have a track. A mission whose track has the same poses gives the same levels.

    Several simulators may work at once, each in a thread of its own: a ping leaves the interpreter to the
    others. One simulator lets one thread in at a time.
    """

    def __init__(self, scene: SceneLike, *, device: str | None = None, rays: int | None = None,
                 seed: int | None = None, sampler: str | None = None, depth_m: float | None = None,
                 truth: bool | None = None) -> None:
        """DEVICE: as of `asdic run --device`. DEPTH_M: at which the number of bins is fixed; else where
        the scene's mission begins. Without RAYS the scene's, or 20,000 where it says `rays: auto`. TRUTH:
        pings say what each bin's energy comes from; else where the scene's output has it. Coherent pings
        have the pressure at every element."""
        self._context = context = Context()
        context.is_quiet = True  # about what the scene's own mission passes
        self._mission = load_mission(context, scene)
        context.is_quiet = False
        mission = self._mission.pointer
        sampling = choose_sampling(self._mission, rays, seed, sampler)
        if rays is None and lib.asdic_mission_ray_forecast(mission).is_auto:
            sampling.rays = lib.asdic_sampling_default().rays
        sampling.left_out = 0  # nobody knows yet where the vehicle will go
        if truth is not None:
            sampling.truth = bool(truth)
        self._truth = bool(sampling.truth)
        first = lib.asdic_mission_pose(mission, 0, ffi.NULL)  # kept: what is inside a struct does not keep it
        depth_m = first.position_m.z if depth_m is None else depth_m
        self._devices = open_devices(context, device)
        self._sonar = lib.asdic_mission_sonar(mission)
        self._handle = context.make(
            "asdic_simulator", lib.asdic_simulator_destroy, lib.asdic_simulator_create, context.pointer,
            self._devices.pointer[0], lib.asdic_mission_scene(mission), lib.asdic_mission_environment(mission),
            self._sonar, sampling, number(depth_m, "depth_m"), keeps=(self._devices, self._mission))
        self._mount, self._pose = _Mount(self._mission), ffi.new(POSE)
        self._rate_hz = float(self._sonar.ping_rate_hz)
        self._moves = any(lib.asdic_mission_get_object(mission, k).moves
                          for k in range(lib.asdic_mission_object_count(mission)))
        self._pings = int(lib.asdic_mission_ping_count(mission))
        self._moved: dict[bytes, Any] = {}
        self._start_s = self._time_of(0)
        self.index = 0
        self.bins = int(lib.asdic_simulator_bin_count(self._handle.pointer))
        self.beams = beams_of(self._sonar)
        self.rays = int(sampling.rays)
        samples = int(lib.asdic_simulator_sample_count(self._handle.pointer))
        self._samples = (int(self._sonar.array.elements) if samples else 0, samples)

    @property
    def sonar(self) -> Fields:
        """The sonar's settings, as in asdic/sonar.h."""
        self._handle.pointer  # pylint: disable=pointless-statement # says when it is closed
        return fields(self._sonar)

    @property
    def environment(self) -> Fields:
        """The water, as in asdic/environment.h."""
        self._handle.pointer  # pylint: disable=pointless-statement
        return fields(lib.asdic_mission_environment(self._mission.pointer))

    @property
    def ranges(self) -> np.ndarray:
        """Centres of the bins, m."""
        return (np.arange(self.bins) + 0.5) * self.sonar.bin_length_m

    @property
    def bearings(self) -> np.ndarray:
        """Where the beams look, degrees to starboard of the bow; of a scanned sonar of its head."""
        return np.degrees(self.beams["yaw_rad"])

    def _time_of(self, index: int) -> float:
        place = ffi.new("double *")
        lib.asdic_mission_pose(self._mission.pointer, min(index, self._pings - 1), place)
        return float(place[0])

    def ping(self, x: float, y: float, z: float, roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0, *,
             out: Ping | None = None) -> Ping:
        """The next ping, of a vehicle at X north, Y east, Z down (m), turned by ROLL, PITCH, YAW (degrees).

        OUT is an earlier ping whose memory may be used again: its energies, truth and pressure change with it, and its
        levels and errors are made anew when they are asked for.
        """
        at: tuple[float, ...] = (x, y, z, roll, pitch, yaw)
        for value in at:
            if type(value) not in NUMBERS or not -1e30 < value < 1e30:  # one that is neither says what it is
                at = tuple(number(one, what) for one, what in zip(at, AXES))
                break
        if not 0.0 <= at[2] <= 11000.0:
            raise fail(ArgumentError, f"z = {at[2]:g} m is no depth of a vehicle: z is positive down, 0 to 11000 m")
        self._mount.refuse_below_bottom(at)
        with self._context.lock:
            simulator = self._handle.pointer
            result = self._new_ping() if out is None else self._again(out)
            index = self.index
            self._mount.set_pose(self._pose, at, index)
            self._prepare(simulator, self._pose)
            self._context.check(lib.asdic_simulator_ping(simulator, self._pose, index, result._struct))
            self._note(result, at, index)
            self.index = index + 1
            return result

    def pings(self, poses: ArrayLike) -> list[Ping]:
        """A ping for each row of POSES: x, y, z in m, and roll, pitch, yaw in degrees if there are six columns.

        The same pings as one by one, in fewer calls of the library, which may simulate some together.
        """
        rows = masked(poses, "poses")
        if rows.shape == (0,):  # numpy sees no columns in []
            return []
        if rows.ndim != 2 or rows.shape[1] not in (3, 6):
            raise fail(ArgumentError, f"poses have the shape {rows.shape}; it must be (n, 3) or (n, 6)")
        rows = doubles(rows, "poses")
        bad = ~np.isfinite(rows).all(axis=1) | ~((rows[:, 2] >= 0.0) & (rows[:, 2] <= 11000.0))
        if bad.any():
            first = int(np.flatnonzero(bad)[0])
            raise fail(ArgumentError, f"pose {first} is {rows[first].tolist()}; its numbers must be finite, z positive "
                       "down, 0 to 11000 m")
        for row in rows.tolist():
            self._mount.refuse_below_bottom(row)
        with self._context.lock:
            results: list[Ping] = []
            while len(results) < len(rows):  # up to where the simulator learns, or things move
                most = 1 if self._moves else LEARN_BLOCK
                results += self._together(rows[len(results):len(results) + most].tolist())
            return results

    def _together(self, rows: list[list[float]]) -> list[Ping]:
        """Pings of the first of ROWS, up to one before which the simulator learns."""
        simulator, results = self._handle.pointer, []
        poses = ffi.new("asdic_pose[]", len(rows))
        for k, row in enumerate(rows):
            at = (*row, 0.0, 0.0, 0.0)[:6]
            self._mount.set_pose(poses + k, at, self.index + k)
            if k == 0:
                self._prepare(simulator, poses)
            elif lib.asdic_simulator_learn_is_due(simulator, poses + k, self.index + k):
                break
            results.append(self._new_ping())
            self._note(results[k], at, self.index + k)
        self._context.check(lib.asdic_simulator_pings(simulator, poses, self.index, len(results),
                                                      [result._struct for result in results]))
        self.index += len(results)
        return results

    def _note(self, result: Ping, at: tuple[float, ...], index: int) -> None:
        result.index, result.time, result._at = index, self._start_s + index / self._rate_hz, (self._mount, at)

    def _new_ping(self) -> Ping:
        return Ping(self.beams, self.bins, truth=self._truth, samples=self._samples)

    def _prepare(self, simulator: Any, pose: Any) -> None:
        """Before the ping of the current index, at POSE."""
        if self._moves:
            self._context.check(lib.asdic_mission_place(self._mission.pointer, simulator, self.index))
            for name, place in self._moved.items():  # off its track
                self._context.check(lib.asdic_simulator_move(simulator, name, place))
        if lib.asdic_simulator_learn_is_due(simulator, pose, self.index):
            self._context.check(lib.asdic_simulator_learn(simulator, pose, self.index))

    def _again(self, out: Ping) -> Ping:
        samples = self._samples if self._samples[0] else None
        if (not isinstance(out, Ping) or out._shape != (len(self.beams), self.bins)
                or (out.truth is not None) != self._truth
                or (None if out.pressure is None else out.pressure.shape) != samples):
            raise fail(ArgumentError, f"out = {out!r} is no ping of this simulator, which has {len(self.beams)} beams "
                       f"and {self.bins} bins, {'with' if self._truth else 'without'} truth, "
                       f"{f'with {samples[1]} samples of pressure' if samples else 'without pressure'}")
        out.beams = self.beams
        for name in ("_level_db", "_stderr_db", "_pose"):  # what was made of the old ping
            out.__dict__.pop(name, None)
        out._made.clear()  # which `parts` that somebody kept share
        return out

    def fly(self) -> Iterator[Ping]:
        """The scene's own mission, ping by ping, from where the simulator is."""
        while self.index < self._pings:
            pose = lib.asdic_mission_vehicle_pose(self._mission.pointer, self.index, ffi.NULL)
            at, degrees = pose.position_m, math.degrees
            yield self.ping(at.x, at.y, at.z, degrees(pose.roll_rad), degrees(pose.pitch_rad), degrees(pose.yaw_rad))

    def move(self, name: str, x: float, y: float, z: float, roll: float = 0.0, pitch: float = 0.0,
             yaw: float = 0.0) -> None:
        """Puts the point NAME, or an object off the track that it has, elsewhere for the pings that follow."""
        angles = [math.radians(number(value, "an angle")) for value in (roll, pitch, yaw)]
        pose = ffi.new("asdic_pose *", {"position_m": [number(value, "a position") for value in (x, y, z)],
                                        "roll_rad": angles[0], "pitch_rad": angles[1], "yaw_rad": angles[2]})
        called = encoded(name, "name")
        with self._context.lock:
            self._context.check(lib.asdic_simulator_move(self._handle.pointer, called, pose))
            self._moved[called] = pose

    def close(self) -> None:
        """Gives the device back; pings that were made stay."""
        with self._context.lock:
            self._handle.close()

    def __enter__(self) -> Simulator:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __reduce__(self) -> Any:
        return self._handle.__reduce__()

    def __repr__(self) -> str:
        return f"<asdic.Simulator: {counted(len(self.beams), 'beam')}, {counted(self.bins, 'bin')}, {self.rays} rays, " \
               f"{counted(self.index, 'ping')} so far>"


def expected(context: Context, flat: Any, environment: Any, sonar: Any, pose: Any, bins: int) -> Ping:
    """The null hypothesis at a place, by quadrature."""
    result = Ping(beams_of(sonar), bins)
    place, result._pose[0] = ffi.new("asdic_flat_scene *", flat), pose
    context.run(lib.asdic_expected_compute, context.pointer, place, environment, sonar, result._pose, result._struct)
    result._altitude = float(flat.altitude_m) if flat.has_bottom else math.inf
    return result


def expect(scene: SceneLike, ping: int = 0, *, variant: str | None = None, progress: Progress | bool = None) -> Ping:
    """The levels of ping PING over a flat bottom without any object: the null hypothesis.

    By quadrature in double precision, whatever the rays do. VARIANT: "corrected" or "printed".
    """
    context = Context(progress)
    mission = load_mission(context, scene)
    pointer = mission.pointer
    ping = whole(ping, "ping", 0, lib.asdic_mission_ping_count(pointer) - 1)
    environment = ffi.new("asdic_environment *", lib.asdic_mission_environment(pointer)[0])
    if variant is not None:
        environment.variant = value_of("asdic_variant", variant, "variant")
    sonar, first = lib.asdic_mission_sonar(pointer), lib.asdic_mission_pose(pointer, 0, ffi.NULL)
    speed = lib.asdic_environment_sound_speed_mps(environment, first.position_m.z)
    time = ffi.new("double *")
    pose = lib.asdic_mission_pose(pointer, ping, time)
    result = expected(context, lib.asdic_mission_flat_scene(pointer, ping), environment, sonar, pose,
                      lib.asdic_sonar_bin_count(sonar, speed))
    result.index, result.time = ping, float(time[0])
    return result


__all__ = ["PARTS", "Levels", "Ping", "Simulator", "beams_of", "expect", "expected"]
