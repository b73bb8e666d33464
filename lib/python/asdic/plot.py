"""Pictures by matplotlib, each one call: they draw into AX, or into the current axes, and return it."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._design import Roc
from ._library import ArgumentError, fail
from ._ping import Ping
from ._run import Run

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def _axes(ax: Axes | None, **keys: Any) -> Axes:
    import matplotlib.pyplot as plt  # pylint: disable=import-outside-toplevel
    return ax if ax is not None else plt.gcf().add_subplot(**keys) if keys else plt.gca()


def _colorbar(ax: Axes, image: Any) -> None:
    ax.figure.colorbar(image, ax=ax, label="level, dB re 1 µPa")


def _beam(of: Run | Ping, beam: int | str | None) -> int:
    """The number of a beam by number or name; None: the middle one."""
    names = of.beams["name"].tolist()
    if isinstance(beam, str):
        if beam not in names:
            raise KeyError(f"beam {beam!r} is none of {', '.join(names[:8])}{', ...' * (len(names) > 8)}")
        return names.index(beam)
    return (len(names) - 1) // 2 if beam is None else range(len(names))[beam]


def _edges(centres: np.ndarray) -> np.ndarray:
    """Between neighbouring centres, and as far beyond the first and last."""
    if len(centres) == 1:
        return centres[0] + np.array([-0.5, 0.5])
    middle = 0.5 * (centres[1:] + centres[:-1])
    return np.concatenate([[2 * centres[0] - middle[0]], middle, [2 * centres[-1] - middle[-1]]])


def _around(bearings: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The order of BEARINGS, degrees, from port to starboard, and they in it, ascending, also where they pass astern."""
    order = np.argsort(bearings)
    gaps = np.diff(bearings[order])
    if len(gaps) and gaps.max() > 360 - gaps.sum():  # no beam looks there: that is where a fan begins
        order = np.roll(order, -1 - int(gaps.argmax()))
    return order, np.unwrap(bearings[order], period=360)


def fan(of: Run | Ping, ping: int = 0, ax: Axes | None = None, **keys: Any) -> Axes:
    """Levels over ahead and starboard, as the sonar looks at them. KEYS go to pcolormesh (vmin, cmap, ...)."""
    order, bearings = _around(of.bearings)
    if np.any(np.diff(bearings) <= 0):
        raise fail(ArgumentError, "beams that look to the same bearing make no fan; asdic.plot.ascope draws a beam")
    ax = _axes(ax)
    levels = of.level_db[ping] if isinstance(of, Run) else of.level_db
    bearing, distance = np.meshgrid(np.radians(_edges(bearings)), _edges(of.ranges), indexing="ij")
    image = ax.pcolormesh(distance * np.sin(bearing), distance * np.cos(bearing), levels[order], **{"shading": "flat", **keys})
    ax.set(xlabel="starboard, m", ylabel="ahead, m", aspect="equal")
    _colorbar(ax, image)
    return ax


def ascope(of: Run | Ping, beam: int | str | None = None, ping: int = 0, expected: Ping | None = None,
           ax: Axes | None = None, **keys: Any) -> Axes:
    """A beam's level over range with bars of one standard error, which coherent pings do not state; EXPECTED beside it."""
    ax, beam = _axes(ax), _beam(of, beam)
    levels, errors = (of.level_db[ping], of.stderr_db[ping]) if isinstance(of, Run) else (of.level_db, of.stderr_db)
    errors = np.asarray(errors[beam], np.float64)
    label, bars = ("simulated, one standard error", errors) if np.isfinite(errors).any() else ("simulated", None)
    ax.errorbar(of.ranges, levels[beam], yerr=bars, **{"fmt": ".", "markersize": 3, "linewidth": 1, "label": label, **keys})
    if expected is not None:
        ax.plot(expected.ranges, expected.level_db[beam], linewidth=1, label="expected")
    ax.set(xlabel="range, m", ylabel="level, dB re 1 µPa")
    ax.legend()
    return ax


def waterfall(run: Run, beam: int | str | None = None, ax: Axes | None = None, **keys: Any) -> Axes:
    """A beam's levels over range and time."""
    ax = _axes(ax)
    image = ax.pcolormesh(_edges(run.ranges), _edges(run.times), run.level_db[:, _beam(run, beam)], **{"shading": "flat", **keys})
    ax.set(xlabel="range, m", ylabel="time, s")
    _colorbar(ax, image)
    return ax


def roc(curve: Roc, ax: Axes | None = None, **keys: Any) -> Axes:
    """P_D against P_FA with its 99 % bounds, and the closed form."""
    ax = _axes(ax)
    points = curve.points
    ax.fill_between(points["design_pfa"], points["pd"]["low"], points["pd"]["high"], alpha=0.3)
    ax.semilogx(points["design_pfa"], points["closed_pd"], **{"label": f"{curve.info.snr_db:.1f} dB", **keys})
    ax.set(xlabel="$P_{FA}$", ylabel="$P_D$", ylim=(0, 1))
    ax.legend()
    return ax


__all__ = ["ascope", "fan", "roc", "waterfall"]
