"""Before a run: what a scene needs, how well a design detects, single formulas, devices."""
from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from ._library import (ArgumentError, Context, Fields, Handle, Progress, dtype_of, encoded, fail, ffi, fields, lib, number,
                       open_devices, text, use_opencl, value_of, view, warn, whole)
from ._scene import SceneLike, choose_sampling, load_mission, remarks


class Term(NamedTuple):
    """A term of the model, kept or left out."""

    name: str
    kept: bool
    bound_db: float
    """Largest change of a level if left out; infinite: not bounded, 0: exact."""
    reason: str


class Plan(NamedTuple):
    """What a scene needs."""

    terms: tuple[Term, ...]
    rays: Fields
    """asdic_ray_forecast: rays a ping, stated error to expect."""
    refraction: Fields
    """asdic_refraction_plan: the simplest form that is needed, and the bounds."""
    remarks: list[str]
    """Laws outside the range of their sources, rays too few."""


def plan(scene: SceneLike, *, progress: Progress | bool = None) -> Plan:
    """What a scene needs, as `asdic plan` says: each term kept or left out, why, and the bound in dB."""
    context = Context(progress)
    mission = load_mission(context, scene)
    found, bent = ffi.new("asdic_plan *"), ffi.new("asdic_refraction_plan *")
    context.run(lib.asdic_mission_plan, context.pointer, mission.pointer, found)
    context.run(lib.asdic_mission_refraction, context.pointer, mission.pointer, bent)
    terms = tuple(Term(text(row.name), bool(row.kept), float(row.bound_db), text(row.reason)) for row in found.rows)
    return Plan(terms, fields(lib.asdic_mission_ray_forecast(mission.pointer)), fields(bent), remarks(mission))


class Roc:
    """P_D against P_FA, and over range. Arrays are views of the library's memory, which they keep."""

    def __init__(self, handle: Handle) -> None:
        self._handle, struct = handle, handle.pointer
        self.info: Fields = fields(struct)
        """The numbers of asdic_roc: beam, range_m, snr_db, pd, area, ..."""
        self.points = view(struct.points, (struct.point_count,), dtype_of("asdic_roc_point"), handle)
        """The curve: design_pfa, threshold_db, pfa and pd with value, low, high (99 %), closed_pd."""
        self.reach = view(struct.reach, (struct.reach_count,), dtype_of("asdic_roc_reach"), handle)
        """P_D of a point as strong over range: range_m, snr_db, pd, closed_pd, model_pd."""
        self.none = view(struct.none, (struct.trials,), np.float64, handle)
        """Intensities drawn without the target, linear re 1 uPa^2."""
        self.present = view(struct.present, (struct.trials,), np.float64, handle)
        """The same with the target."""

    def __repr__(self) -> str:
        return f"<asdic.Roc: beam {self.info.beam}, {self.info.range_m:g} m, {self.info.snr_db:.1f} dB, " \
               f"area {self.info.area.value:.4f}>"


def roc(scene: SceneLike, *, object: str | None = None,  # pylint: disable=redefined-builtin
        range_m: float | None = None, bearing_deg: float | None = None, target_strength_db: float | None = None,
        beam: str | None = None, ping: int = 0, target: str | None = None, pfa: float | None = None,
        trials: int = 1000000, seed: int = 1, rays: int | None = None, device: str | None = None,
        progress: Progress | bool = None) -> Roc:
    """How well a design detects, by drawing speckle and noise round a simulated ping, as `asdic roc` does.

    What is to be detected: OBJECT of the scene, where it stands out most; or a point of TARGET_STRENGTH_DB at
    RANGE_M and BEARING_DEG, level with the vehicle. TARGET: "swerling0" to "swerling3"; it and PFA are those of
    the scene's detector unless given.
    """
    context = Context(progress)
    mission = load_mission(context, scene)
    choose_sampling(mission, rays, None, None)
    if (object is None) == (range_m is None):
        raise fail(ArgumentError, "give the object of the scene that is to be detected, or the range_m and "
                   "target_strength_db of a point")
    if object is not None and (bearing_deg is not None or target_strength_db is not None):
        raise fail(ArgumentError, "bearing_deg and target_strength_db are those of a point at range_m")
    options = ffi.new("asdic_roc_options *", lib.asdic_roc_options_default())
    name = ffi.new("char[]", encoded(object, "object")) if object is not None else ffi.NULL
    by = ffi.new("char[]", encoded(beam, "beam")) if beam is not None else ffi.NULL
    options.object, options.beam = name, by
    options.range_m = math.nan if range_m is None else number(range_m, "range_m")
    if bearing_deg is not None:
        options.bearing_rad = math.radians(number(bearing_deg, "bearing_deg"))
    if target_strength_db is not None:
        options.target_strength_db = number(target_strength_db, "target_strength_db")
    options.ping = whole(ping, "ping", 0, lib.asdic_mission_ping_count(mission.pointer) - 1)
    detector = lib.asdic_mission_detector(mission.pointer)
    options.target = detector.target if target is None else value_of("asdic_target", target, "target")
    options.pfa = detector.pfa if pfa is None else number(pfa, "pfa")
    options.trials = whole(trials, "trials", 1000, 10 ** 8)
    options.seed = whole(seed, "seed", 0, (1 << 64) - 1)
    devices = open_devices(context, device)
    curve = Roc(context.make("asdic_roc", lib.asdic_roc_destroy, lib.asdic_roc_compute, context.pointer, mission.pointer,
                             devices.pointer[0], options, keeps=(name, by)))
    if curve.info.remark:
        warn(curve.info.remark)
    return curve


class Formula(NamedTuple):
    """A formula of `asdic model`."""

    name: str
    unit: str
    what: str
    source: str
    keys: tuple[str, ...]


def formulas() -> tuple[Formula, ...]:
    """The formulas that asdic.model evaluates."""
    found = [lib.asdic_model_get(index) for index in range(lib.asdic_model_count())]
    return tuple(Formula(text(info.name), text(info.unit), text(info.what), text(info.source),
                         tuple(text(info.keys[k].name) for k in range(info.key_count))) for info in found)


def model(name: str, *, device: str | None = None, **keys: float | str) -> float:
    """One formula, as `asdic model` prints it: `model("absorption", f_khz=100, t_degc=10, ...)`.

    In double precision; with DEVICE in single precision there. asdic.formulas() lists names, keys, units.
    """
    context = Context()
    given = {key: value if isinstance(value, str) else repr(number(value, key)) for key, value in keys.items()}
    assignments = [ffi.new("char[]", encoded(f"{key}={value}", key)) for key, value in given.items()]
    devices = open_devices(context, device) if device is not None else None
    out = ffi.new("double *")
    context.run(lib.asdic_model_evaluate, context.pointer, devices.pointer[0] if devices else ffi.NULL,
                encoded(name, "name"), assignments, len(assignments), out)
    return float(out[0])


def devices() -> list[Fields]:
    """The OpenCL devices, as asdic_device_info; `platform` and `device` are the P:D of a selector."""
    context = Context()
    found, count = ffi.new("asdic_device_info **"), ffi.new("size_t *")
    use_opencl(context)
    try:
        context.run(lib.asdic_device_list, context.pointer, found, count)
        return [fields(found[0][index]) for index in range(count[0])]
    finally:
        lib.asdic_device_info_free(found)


__all__ = ["Formula", "Plan", "Roc", "Term", "devices", "formulas", "model", "plan", "roc"]
