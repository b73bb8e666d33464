"""Pings: simulated one by one, or expected."""
from __future__ import annotations

import functools
import math
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ._library import (ArgumentError, Context, Fields, Handle, Progress, dtype_of, encoded, fail, ffi, fields,
                       lib, number, open_devices, value_of, view, whole, words)
from ._scene import SceneLike, choose_sampling, load_mission

PARTS = tuple(word for word in words("asdic_component") if word != "total")
"""The mechanisms of a level: "bottom", "surface", ..."""


class Levels(Mapping[str, np.ndarray]):
    """Arrays by the name of the mechanism, made when they are asked for."""

    def __init__(self, names: tuple[str, ...], make: Any) -> None:
        self._names, self._make = names, functools.lru_cache(maxsize=None)(make)

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._names:
            raise KeyError(f"{name!r} is none of {', '.join(self._names)}")
        array: np.ndarray = self._make(name)
        return array

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    def __repr__(self) -> str:
        return f"<levels of {', '.join(self._names)}>"


def beams_of(sonar: Any) -> np.ndarray:
    """The receivers: a structured array with name, pitch_rad, yaw_rad, ...; of a scanned sonar its head's."""
    count = int(sonar.receiver_count)
    return view(sonar.receivers, (count,), dtype_of("asdic_beam"), None).copy()


class Ping:
    """One ping. Arrays are [beam, bin] and lie in the library's memory, which they keep alive."""

    index: int
    """Number of the ping, from 0."""
    time: float
    """Simulated time, s."""
    altitude: float
    """Above the bottom straight below, m; infinite where there is none."""

    def __init__(self, handle: Handle, beams: np.ndarray, blanking_m: float) -> None:
        self._handle, self.beams, self._blanking_m = handle, beams, blanking_m
        struct = handle.pointer
        self._shape = (int(struct.beams), int(struct.bins))
        self.index, self.time, self.altitude = 0, math.nan, math.nan
        self._pose = ffi.new("asdic_pose *")

    @property
    def pose(self) -> Fields:
        """Of the sonar: position_m.x, .y, .z, roll_rad, pitch_rad, yaw_rad."""
        return fields(self._pose)

    @functools.cached_property
    def intensity(self) -> Levels:
        """Energy of each bin, linear re 1 uPa^2, of "total" and each mechanism: views, nothing is copied."""
        numbers = words("asdic_component")
        return Levels(tuple(numbers), lambda name: view(
            self._handle.pointer.intensity_lin[numbers[name]], self._shape, np.float64, self._handle))

    def _levels(self, name: str) -> np.ndarray:
        levels = np.empty(self._shape, np.float32)
        lib.asdic_ping_levels(self._handle.pointer, words("asdic_component")[name], ffi.from_buffer("float[]", levels))
        return levels

    @functools.cached_property
    def level_db(self) -> np.ndarray:
        """dB re 1 uPa; NAN where there is no energy."""
        return self._levels("total")

    @functools.cached_property
    def parts(self) -> Levels:
        """Levels of the mechanisms, dB re 1 uPa: parts["bottom"]."""
        return Levels(PARTS, self._levels)

    @property
    def stderr_db(self) -> np.ndarray:
        """One standard error of the level's sampling, dB: a view."""
        return view(self._handle.pointer.stderr_db, self._shape, np.float32, self._handle)

    @functools.cached_property
    def ranges(self) -> np.ndarray:
        """Centres of the bins, m."""
        return (np.arange(self._shape[1]) + 0.5) * self.bin_length_m

    @property
    def bin_length_m(self) -> float:
        return float(self._handle.pointer.bin_length_m)

    @property
    def bearings(self) -> np.ndarray:
        """Where the beams look, degrees to starboard of the bow."""
        return np.degrees(self.beams["yaw_rad"])

    @property
    def rays(self) -> int:
        """Rays that were traced."""
        return int(self._handle.pointer.rays)

    def __repr__(self) -> str:
        return f"<asdic.Ping {self.index}: {self._shape[0]} beams, {self._shape[1]} bins of {self.bin_length_m:g} m>"


def new_ping(context: Context, sonar: Any, bins: int) -> Handle:
    place = ffi.new("asdic_ping **")
    context.call(lib.asdic_ping_create, context.pointer, sonar.receiver_count, bins, place)
    return Handle("ping", place, lib.asdic_ping_destroy)


class Simulator:
    """A sonar in your own loop: give it a pose, get a ping.

    It numbers its pings from 0, learns where rays matter as missions do, turns a scanned sonar's head and
    moves objects that have a track. A mission whose track has the same poses gives the same levels.

    Several simulators may work at once, each in a thread of its own: a ping leaves the interpreter to the
    others. One simulator lets one thread in at a time.
    """

    def __init__(self, scene: SceneLike, *, device: str | None = None, rays: int | None = None,
                 seed: int | None = None, sampler: str | None = None, depth_m: float | None = None) -> None:
        """DEVICE: as of `asdic run --device`. DEPTH_M: at which the number of bins is fixed; else where
        the scene's mission begins. Without RAYS the scene's, or 20,000 where it says `rays: auto`."""
        self._context = context = Context()
        context.is_quiet = True  # about what the scene's own mission passes
        self._mission = load_mission(context, scene)
        context.is_quiet = False
        mission = self._mission.pointer
        sampling = choose_sampling(self._mission, rays, seed, sampler)
        if rays is None and lib.asdic_mission_ray_forecast(mission).is_auto:
            sampling.rays = lib.asdic_sampling_default().rays
        sampling.left_out = 0  # nobody knows yet where the vehicle will go
        depth_m = lib.asdic_mission_pose(mission, 0, ffi.NULL).position_m.z if depth_m is None else depth_m
        self._devices = open_devices(context, device)
        self._sonar = lib.asdic_mission_sonar(mission)
        self._handle = context.make(
            "asdic_simulator", lib.asdic_simulator_destroy, lib.asdic_simulator_create, context.pointer,
            self._devices.pointer[0], lib.asdic_mission_scene(mission), lib.asdic_mission_environment(mission),
            self._sonar, sampling, number(depth_m, "depth_m"), keeps=(self._devices, self._mission))
        self._sweep = ffi.new("asdic_sweep *", lib.asdic_mission_sweep(mission))
        self._scene = lib.asdic_mission_scene(mission)
        self._pings = int(lib.asdic_mission_ping_count(mission))
        self._start_s = self._time_of(0)
        self.index = 0
        self.bins = int(lib.asdic_simulator_bin_count(self._handle.pointer))
        self.beams = beams_of(self._sonar)
        self.rays = int(sampling.rays)

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
        """Where the beams look, degrees to starboard of the bow."""
        return np.degrees(self.beams["yaw_rad"])

    def _time_of(self, index: int) -> float:
        place = ffi.new("double *")
        lib.asdic_mission_pose(self._mission.pointer, min(index, self._pings - 1), place)
        return float(place[0])

    def ping(self, x: float, y: float, z: float, roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0, *,
             out: Ping | None = None) -> Ping:
        """The next ping, of a vehicle at X north, Y east, Z down (m), turned by ROLL, PITCH, YAW (degrees).

        OUT is an earlier ping whose memory may be used again: its arrays change with it.
        """
        at = [number(value, what) for value, what in zip((x, y, z, roll, pitch, yaw), "x y z roll pitch yaw".split())]
        if not 0.0 <= at[2] <= 11000.0:
            raise fail(ArgumentError, f"z = {at[2]:g} m is no depth of a vehicle: z is positive down, 0 to 11000 m")
        with self._context.lock:
            simulator = self._handle.pointer
            vehicle = ffi.new("asdic_pose *", {"position_m": at[:3], "roll_rad": math.radians(at[3]),
                                               "pitch_rad": math.radians(at[4]), "yaw_rad": math.radians(at[5])})
            result = self._room(out)
            pose = result._pose  # pylint: disable=protected-access
            pose[0] = lib.asdic_sweep_sonar(self._sweep, vehicle, self.index)
            self._simulate(simulator, pose, result._handle.pointer)  # pylint: disable=protected-access
            result.index, result.time = self.index, self._start_s + self.index / self._sonar.ping_rate_hz
            result.altitude = float(lib.asdic_scene_altitude_m(self._scene, pose.position_m))
            self.index += 1
            return result

    def _simulate(self, simulator: Any, pose: Any, struct: Any) -> None:
        context, index = self._context, self.index
        context.check(lib.asdic_mission_place(self._mission.pointer, simulator, index))
        if index % lib.ASDIC_LEARN_BLOCK == 0:
            context.check(lib.asdic_simulator_learn(simulator, pose, index))
        context.check(lib.asdic_simulator_ping(simulator, pose, index, struct))

    def _room(self, out: Ping | None) -> Ping:
        if out is None:
            return Ping(new_ping(self._context, self._sonar, self.bins), self.beams, self._sonar.blanking_m)
        if not isinstance(out, Ping) or out._shape != (len(self.beams), self.bins):
            raise fail(ArgumentError, f"out = {out!r} is no ping of this simulator, which has {len(self.beams)} beams and "
                       f"{self.bins} bins")
        for name in ("level_db", "parts"):  # what was made of the old energies
            out.__dict__.pop(name, None)
        return out

    def fly(self) -> Iterator[Ping]:
        """The scene's own mission, ping by ping, from where the simulator is."""
        while self.index < self._pings:
            pose = lib.asdic_mission_vehicle_pose(self._mission.pointer, self.index, ffi.NULL)
            at, degrees = pose.position_m, math.degrees
            yield self.ping(at.x, at.y, at.z, degrees(pose.roll_rad), degrees(pose.pitch_rad), degrees(pose.yaw_rad))

    def move(self, name: str, x: float, y: float, z: float, roll: float = 0.0, pitch: float = 0.0,
             yaw: float = 0.0) -> None:
        """Puts the point NAME, or an object that has a track, elsewhere for the pings that follow."""
        angles = [math.radians(number(value, "an angle")) for value in (roll, pitch, yaw)]
        pose = ffi.new("asdic_pose *", {"position_m": [number(value, "a position") for value in (x, y, z)],
                                        "roll_rad": angles[0], "pitch_rad": angles[1], "yaw_rad": angles[2]})
        self._context.call(lib.asdic_simulator_move, self._handle.pointer, encoded(name, "name"), pose)

    def close(self) -> None:
        """Gives the device back; pings that were made stay."""
        with self._context.lock:
            self._handle.close()

    def __enter__(self) -> Simulator:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<asdic.Simulator: {len(self.beams)} beams, {self.bins} bins, {self.rays} rays, {self.index} pings so far>"


def expected(context: Context, flat: Any, environment: Any, sonar: Any, pose: Any, bins: int) -> Ping:
    """The null hypothesis at a place, by quadrature."""
    handle = new_ping(context, sonar, bins)
    place, copied = ffi.new("asdic_flat_scene *", flat), ffi.new("asdic_pose *", pose)
    context.run(lib.asdic_expected_compute, context.pointer, place, environment, sonar, copied, handle.pointer)
    result = Ping(handle, beams_of(sonar), sonar.blanking_m)
    result._pose, result.altitude = copied, float(flat.altitude_m) if flat.has_bottom else math.inf
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
