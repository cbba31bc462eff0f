"""``tube``: bounds of every trajectory that the data allow."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.display.shown import Result
from ivsid.display.table import Cells
from ivsid.errors import IvsidError, meant
from ivsid.identification import Identification
from ivsid.intervals import IntervalArray
from ivsid.log import GivenLog, log_of
from ivsid.setup import SetupFinding, examined, in_doubt
from ivsid.tubes import given as taken
from ivsid.tubes.attained import attained
from ivsid.tubes.checked import Checked, checked
from ivsid.tubes.equations import Equations, equations_of
from ivsid.tubes.horizons import Horizon, follow
from ivsid.tubes.inputs import course_of
from ivsid.tubes.refuted import Refutation, refutations

Array: TypeAlias = NDArray[np.float64]
# Lengths of windows [s] beside the whole log.
# Source: definition: the windows of velocities and positions of ``validate``
WINDOWS: Final = (10.0, 30.0)
# Equal parts into which each step is cut.
# Source: definition: one step a hold interval
PARTS: Final = 1
# Most cells of the yaw rate.
# Source: resource: each takes the time of a tube
MOST_YAW_CELLS: Final = 1024
# Faults of the checker that a result lists.
# Source: definition: what a reader looks at
MOST_FAULTS: Final = 20
CHANNELS: Final = ("all", "surge", "straight")
NAMES: Final = ("u", "v", "r", "psi", "x", "y")
UNITS: Final = ("m/s", "m/s", "rad/s", "rad", "m", "m")


@dataclass(frozen=True)
class Run:
    """The tubes of one length of window, with what is attained of them.

    Attributes:
        horizon: the tubes.
        inner: least and largest of the members at the rows, shape (n, 6), NaN where there is none; None where not asked for.
        refuted: the first readings outside, each over its shortest window.
        outside: number of rows with a reading outside.
        seconds: of computation for the tubes alone.
    """

    horizon: Horizon
    inner: tuple[Array, Array] | None
    refuted: tuple[Refutation, ...]
    outside: int
    seconds: float

    @property
    def name(self) -> str:
        """``whole``, or the length of the windows."""
        return "whole" if self.horizon.length is None else f"{self.horizon.length:g} s"

    def ratio(self, component: int) -> Array:
        """Width of the tube over that of the members, at rows with both and a width, shape (k,)."""
        if self.inner is None:
            return np.zeros(0)
        outer = self.horizon.bounds.upper[:, component] - self.horizon.bounds.lower[:, component]
        inner = self.inner[1][:, component] - self.inner[0][:, component]
        there = np.isfinite(outer) & np.isfinite(inner) & (inner > 0)
        return np.asarray(outer[there] / inner[there])


@dataclass(frozen=True, repr=False)
class Tube(Result):
    """Bounds of every trajectory that the data allow.

    Attributes:
        fit: whose parameters move.
        log_name: name of the log.
        log_sha256: SHA-256 of the log.
        channels: ``all``, ``surge`` (v and r as measured) or ``straight`` (v = r = 0).
        t: times of the rows [s], shape (n,).
        measured: u, v, r at the rows, shape (n, 3).
        runs: the whole log first, then windows.
        guaranteed: whether the fit is, and every bound here.
        assumes: sentences that the bounds rely on.
        vertices: numbers of vertices of the parameters in surge, sway and yaw.
        parts: equal parts of each step.
        pieces: number of pieces of the parameters.
        yaw_cells: cells of the yaw rate, at most.
        checked: what the checker proved of the tubes without restarts; None where not asked for.
        setup: what is doubtful about the set-up.
    """

    fit: Identification
    log_name: str
    log_sha256: str
    channels: str
    t: Array
    measured: IntervalArray
    runs: tuple[Run, ...]
    guaranteed: bool
    assumes: tuple[str, ...]
    vertices: tuple[int, int, int]
    parts: int
    pieces: int
    yaw_cells: int = 1
    checked: Checked | None = None
    setup: tuple[SetupFinding, ...] = ()

    @property
    def components(self) -> tuple[int, ...]:
        """Components that are followed, as numbers of ``NAMES``."""
        return tuple(range(6)) if self.channels == "all" else (0,)

    @property
    def refuted(self) -> bool:
        """Whether a reading contradicts the model."""
        return any(r.refuted for r in self.runs)

    def _heading(self) -> str:
        word = "guaranteed" if self.guaranteed else "not guaranteed"
        verdict = "a reading contradicts the fit" if self.refuted else "no reading contradicts the fit"
        return f"of {self.fit.vehicle.name} on {self.log_name}: {word}, {verdict}{in_doubt(self.setup)}"

    def _cells(self) -> Cells:
        return self._columns()

    def _columns(self) -> Mapping[str, Sequence[object]]:
        rows = [(r, k) for r in self.runs for k in self.components]
        summary = [widths(r, k) for r, k in rows]
        return {
            "window": [r.name for r, _ in rows],
            "component": [NAMES[k] for _, k in rows],
            "unit": [UNITS[k] for _, k in rows],
            "median width": [s["median_width"] for s in summary],
            "largest width": [s["largest_width"] for s in summary],
            "outer / inner": [s.get("median_ratio") for s in summary],
        }


def widths(run: Run, component: int) -> dict[str, float | None]:
    """Widths of a component, and their ratios to those of the members; None without any."""
    bounds = run.horizon.bounds
    wide = bounds.upper[:, component] - bounds.lower[:, component]
    wide = wide[np.isfinite(wide)]
    ratio = run.ratio(component)
    found: dict[str, float | None] = {
        "median_width": float(np.median(wide)) if wide.size else None,
        "largest_width": float(wide.max()) if wide.size else None,
    }
    if run.inner is not None:
        found["median_ratio"] = float(np.median(ratio)) if ratio.size else None
        found["largest_ratio"] = float(ratio.max()) if ratio.size else None
    return found


def tube(
    fit: Identification,
    log: GivenLog,
    *,
    channels: str = "all",
    windows: Sequence[float] = WINDOWS,
    whole: bool = True,
    steps: int | None = None,
    parts: int = PARTS,
    cells: int = 1,
    yaw_cells: int = 1,
    inner: bool = True,
    early: bool = False,
    check: bool = False,
    examine: bool = True,
    equations: Equations | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Tube:
    """Bounds of every trajectory of every parameter that is consistent with the fit's log, under the demands of a log.

    Args:
        fit: by ``identify``.
        log: a checked log, its path, or a table in memory.
        channels: ``all`` follows u, v, r, heading and position; ``surge`` follows u alone with v and r as measured; ``straight`` follows u
            of a run without drift and turn, which is then an assumption.
        windows: lengths [s] after which a tube restarts from the measured state.
        whole: whether the log is followed without restarts as well, before the windows.
        steps: of all windows of one length together, at most; evenly spaced windows are followed where there are more. None follows all.
        parts: equal parts into which each step is cut; more are narrower and slower.
        cells: equal parts into which the interval of each parameter is cut; the tube is the hull of the tubes of all pieces, narrower and
            slower by their number.
        yaw_cells: cells of the yaw rate, at most, that are followed by themselves in a tube of all channels and cut anew each half second:
            narrower, most of all in surge and sway while it turns, and slower by about half of their number.
        inner: whether members are simulated beside the tubes.
        early: whether a tube of all channels ends after a minute at 20 Hz (1,200 steps) where its yaw rate is so wide by then that it bounds little and takes long.
        check: whether each part of the first tube, which is the one without restarts if there is one, is proved once more in exact arithmetic, by code that shares nothing with the
            engine; some 5 ms a step of surge, 25 ms of all channels.
        examine: whether the set-up is examined first.
        equations: of the fit and the channels, where a caller has them already.
        progress: told of each step.

    Returns:
        The tubes, and the readings that contradict them.

    Raises:
        IvsidError: a fit, model, vehicle or log that a tube cannot follow, or a wrong set-up that is beyond doubt.
    """
    _asked(channels, windows, whole=whole, parts=parts, cells=cells, yaw_cells=yaw_cells, check=check)
    vehicle = fit.vehicle
    data = log_of(log, vehicle.log)
    doubts = examined(vehicle, [data], progress) if examine else ()
    course = course_of(vehicle, data)
    progress("vertices of the parameters")
    alone = channels != "all"
    free = (True, not alone, not alone)
    equations = equations_of(fit, free, cells=cells) if equations is None else equations
    equations = replace(equations, yaw_cells=yaw_cells)
    given = None
    if alone:
        given = taken.straight(course) if channels == "straight" else taken.measured(course, vehicle)
    runs = []
    for length in (*((None,) if whole else ()), *windows):
        progress("following the whole log" if length is None else f"following windows of {length:g} s")
        begun = time.perf_counter()
        horizon = follow(
            equations, course, length, given, parts=parts, steps=None if length is None else steps, early=early
        )
        seconds = time.perf_counter() - begun
        found, count = refutations(equations, course, horizon, given, parts=parts)
        within = None
        if inner:
            low, high = np.full((data.t.size, 6), np.nan), np.full((data.t.size, 6), np.nan)
            for number, w in enumerate(horizon.windows):
                least, most = attained(equations, course, w, given)
                # As in the tube, a row that ends a window holds its end.
                begin = 0 if number == 0 or horizon.windows[number - 1].proved < w.first else 1
                low[w.first + begin : w.proved + 1], high[w.first + begin : w.proved + 1] = least[begin:], most[begin:]
            within = low, high
        runs.append(Run(horizon, within, tuple(found), count, seconds))
    if not any(r.horizon.windows for r in runs):
        raise IvsidError(
            f"{data.name} has no step with known forces after a complete measured state; look at the missing samples and the gaps"
        )
    first = runs[0].horizon.windows
    again = checked(fit, equations, course, first, given, parts=parts, progress=progress) if check else None
    assumes = [*fit.assumes, *course.assumes]
    if channels == "straight":
        assumes.append("the run is straight: v = r = 0")
    if channels == "surge":
        assumes.append("v and r are as measured, and between samples keep the stated limits of their rates")
    return Tube(
        fit,
        data.name,
        data.sha256,
        channels,
        data.t,
        course.measured,
        tuple(runs),
        fit.guaranteed and not course.statistical,
        tuple(dict.fromkeys(assumes)),
        equations.vertices,
        parts,
        len(equations.pieces),
        yaw_cells,
        again,
        tuple(doubts),
    )


def _asked(
    channels: str, windows: Sequence[float], *, whole: bool, parts: int, cells: int, yaw_cells: int, check: bool
) -> None:
    """Refuses options that no tube has."""
    if channels not in CHANNELS:
        raise IvsidError(f"channels '{channels}' are unknown; {meant(channels, CHANNELS)}use {', '.join(CHANNELS)}")
    if parts < 1:
        raise IvsidError(f"parts = {parts} was given; a number of equal parts of a step, at least 1, is needed")
    if cells < 1:
        raise IvsidError(f"cells = {cells} was given; a number of equal parts of each interval, at least 1, is needed")
    if not 1 <= yaw_cells <= MOST_YAW_CELLS:
        raise IvsidError(
            f"yaw_cells = {yaw_cells} was given; a number of cells of the yaw rate, at least 1 and at most {MOST_YAW_CELLS}, is needed"
        )
    if yaw_cells > 1 and channels != "all":
        raise IvsidError(
            f"cells of the yaw rate are those of tubes of all channels; leave yaw_cells out for {channels}"
        )
    if any(not 0 < w < np.inf for w in windows):
        raise IvsidError(f"windows of {', '.join(f'{w:g}' for w in windows)} s were given; positive lengths are needed")
    if not whole and not windows:
        raise IvsidError("neither the whole log nor windows were asked for; give lengths of windows, or whole")
    if check and channels == "surge":
        raise IvsidError(
            "the checker proves tubes of all channels and of straight runs; give channels all or straight with check"
        )


def record_of(made: Tube) -> dict[str, object]:
    """The summary of result.json, without its envelope."""
    return {
        "guaranteed": made.guaranteed,
        "assumes": list(made.assumes),
        "channels": made.channels,
        "parts": made.parts,
        "pieces": made.pieces,
        "yaw_cells": made.yaw_cells,
        "vertices": dict(zip(("surge", "sway", "yaw"), made.vertices, strict=True)),
        "fit": {"log": made.fit.log_name, "sha256": made.fit.log_sha256},
        "checked": None
        if made.checked is None
        else {"parts": made.checked.parts, "proved": made.checked.proved, "faults": made.checked.faults[:MOST_FAULTS]},
        "setup": [f.record() for f in made.setup],
        "runs": [
            {
                "window": r.horizon.length,
                "windows": len(r.horizon.windows),
                "rows": [[w.first, w.last, w.proved] for w in r.horizon.windows],
                "proved": all(w.proved == w.last for w in r.horizon.windows),
                "components": {NAMES[k]: {"unit": UNITS[k], **widths(r, k)} for k in made.components},
                "outside": r.outside,
                "refuted": [f.record() for f in r.refuted],
            }
            for r in made.runs
        ],
    }
