"""Calibrated forward-looking sonar, simulated on any OpenCL device: levels as numpy arrays.

    import asdic
    run = asdic.simulate("scene.yaml")          # run.level_db[ping, beam, bin], dB re 1 uPa
    sonar = asdic.Simulator("scene.yaml")       # a sonar in your own loop
    ping = sonar.ping(0, 0, 7, yaw=3)           # ping.level_db[beam, bin]

Frames: x north, y east, z DOWN, m; bearings are positive to starboard. docs/python.md shows more.
"""
from . import plot
from ._design import Formula, Plan, Roc, Term, devices, formulas, model, plan, roc
from ._library import (ArgumentError, ClosedError, DeviceError, DeviceLostError, Error, ExistsError, FileError, InputError,
                       MemoryShortError, Remark, StoppedError, UnsupportedError, lib as _lib, text as _text)
from ._ping import Ping, Simulator, expect
from ._run import Detections, Run, detect, simulate
from ._scene import Scene, schema

for _kind in (ArgumentError, ClosedError, DeviceError, DeviceLostError, Error, ExistsError, FileError, InputError,
              MemoryShortError, Remark, StoppedError, UnsupportedError):
    _kind.__module__ = "asdic"  # where users see it
__version__ = _text(_lib.asdic_version())
__all__ = [
    "ArgumentError", "ClosedError", "Detections", "DeviceError", "DeviceLostError", "Error", "ExistsError", "FileError",
    "Formula", "InputError", "MemoryShortError", "Ping", "Plan", "Remark", "Roc", "Run", "Scene", "Simulator",
    "StoppedError", "Term", "UnsupportedError", "detect", "devices", "expect", "formulas", "model", "plan", "plot", "roc",
    "schema", "simulate",
]
