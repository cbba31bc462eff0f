"""A fit against another log: predicted force against measured (paper, Figs 4-7), simulated motion and tubes against measured."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.display.shown import Result
from ivsid.display.table import Cells
from ivsid.effects import CHANNELS, terms_of
from ivsid.errors import IvsidError
from ivsid.identification import Identification, left_out
from ivsid.intervals import IntervalArray
from ivsid.intervals.pieces import interval_pieces
from ivsid.log import GivenLog, Log, log_of
from ivsid.memory.pieces import array_pieces, pieces
from ivsid.memory.room import DOUBLE, room
from ivsid.propulsion.actuation import nominal_force
from ivsid.propulsion.lag import GAP
from ivsid.rows import RegressionRows, build_rows, window_count
from ivsid.sensors.bounds import bound_log
from ivsid.setup import SetupFinding, examined, in_doubt
from ivsid.tubes.reached import TubeCheck, reached
from ivsid.validation.motion import Runs, runs_of

# Length of a window of simulated velocities [s].
# Source: definition: the error measure of docs/guide.md
VELOCITY_WINDOW: Final = 10.0
# Length of a window of simulated positions [s].
# Source: definition: the error measure of docs/guide.md
POSITION_WINDOW: Final = 30.0
# Samples of windows that are simulated at once.
# Source: resource: some 200 MB
TOGETHER: Final = 1 << 20


@dataclass(frozen=True)
class ForceCheck:
    """Predicted against measured force [N] or moment [N m] of one channel, over m rows.

    Attributes:
        channel: surge, sway or yaw.
        time: of each row [s], shape (m,).
        measured: intervals of the known force, shape (m,).
        predicted: intervals of the force by parameters and motion, shape (m,).
        predicted_mid: the force by the midpoints of both, shape (m,).
        mean: of the error ``predicted_mid`` less the midpoint of ``measured``.
        sigma: standard deviation of that error.
        mean_absolute: mean of its absolute value.
        coverage: share of rows whose measured value lies inside the predicted bounds.
        falsified: rows whose predicted and measured intervals do not meet: they contradict the parameters.
    """

    channel: str
    time: NDArray[np.float64]
    measured: IntervalArray
    predicted: IntervalArray
    predicted_mid: NDArray[np.float64]
    mean: float
    sigma: float
    mean_absolute: float
    coverage: float
    falsified: int


@dataclass(frozen=True)
class MotionCheck:
    """Simulated motion over windows that restart from the measured state.

    Attributes:
        window: lengths [s] of windows of ``velocity`` and ``position``, as far as the log allows.
        rms: root mean square error of u, v [m/s], r [rad/s] over velocity windows, of position [m] over position windows.
        median: the same as the median over windows.
        time: samples of the velocity windows [s], shape (n,).
        simulated: u, v, r there, shape (n, 3).
        measured: u, v, r of the log there, shape (n, 3).
        reason: obstacle to a simulation, or None.
    """

    window: dict[str, float]
    rms: dict[str, float]
    median: dict[str, float]
    time: NDArray[np.float64]
    simulated: NDArray[np.float64]
    measured: NDArray[np.float64]
    reason: str | None


@dataclass(frozen=True, repr=False)
class Validation(Result):
    """The checks of one fit on one log."""

    fit: Identification
    log_name: str
    log_sha256: str
    forces: tuple[ForceCheck, ...]
    motion: MotionCheck
    notes: tuple[str, ...]
    tubes: TubeCheck
    setup: tuple[SetupFinding, ...] = ()

    def _heading(self) -> str:
        wrong, rows = sum(f.falsified for f in self.forces), sum(f.time.size for f in self.forces)
        return f"of {self.fit.vehicle.name} by {self.fit.method} on {self.log_name}: {wrong} of {rows} rows contradict the fit{self._moved()}{in_doubt(self.setup)}"

    def _moved(self) -> str:
        outside = max(self.tubes.outside.values(), default=0)
        return f", {outside} have a reading outside of its tube" if outside else ""

    @property
    def contradicted(self) -> bool:
        """Whether a row or a reading contradicts the fit."""
        return any(f.falsified for f in self.forces) or bool(self.tubes.refuted)

    def _cells(self) -> Cells:
        return self._columns()

    def _columns(self) -> dict[str, list[object]]:
        found = self.forces
        return {
            "channel": [f.channel for f in found],
            "unit": ["N m" if f.channel == "yaw" else "N" for f in found],
            "rows": [f.time.size for f in found],
            "mean error": [f.mean for f in found],
            "sigma": [f.sigma for f in found],
            "mean |error|": [f.mean_absolute for f in found],
            "inside bounds": [f.coverage for f in found],
            "contradicting rows": [f.falsified for f in found],
        }


def validate(
    fit: Identification,
    log: GivenLog,
    *,
    tubes: bool | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Validation:
    """Checks a fit on another log than its own.

    Args:
        fit: by ``identify``.
        log: a checked log, its path, or a table in memory.
        tubes: whether readings are compared with the tubes of every consistent vehicle; None does so for logs of moderate length.
        progress: told of each step.

    Returns:
        The checks; ``setup`` holds what is doubtful about the set-up.

    Raises:
        IvsidError: a fit without parameters, a log without the channels of its model, or a wrong set-up that is beyond doubt.
    """
    if not fit.estimate:
        raise IvsidError(
            f"the fit ({fit.method}, {fit.status}) has no parameter to validate: {fit.reason or 'its set is empty'}; identify again"
        )
    vehicle = fit.vehicle
    log = log_of(log, vehicle.log)
    doubts = examined(vehicle, [log], progress)
    progress(f"validating on {log.t.size} samples")
    form = fit.options["form"]
    bounded = bound_log(log, vehicle, window_count(fit.options["window"]))
    rows = build_rows(
        bounded,
        vehicle,
        terms_of(vehicle, form),
        added_mass=form == "added",
        kind=fit.options["rows"],
        window=fit.options["window"],
    )
    beside = ", ".join(n for g in left_out(vehicle, bounded) for n in g.named)
    used = bounded.log
    # A long log lies on the disk: what no later step reads ends here, or the disk would have to hold it beside the simulated motion.
    del bounded
    forces = tuple(_force_check(fit, rows, k, name) for k, name in enumerate(CHANNELS) if _checkable(fit, rows, k))
    del rows
    own = (
        f"{log.name} is the log that the fit was made of: agreement with it proves nothing; give a log of another run",
    )
    absent = (f"{beside} of [model.fitted] moves the simulated vehicle, and stands in no row of forces and no reading",)
    notes = (*(own if log.sha256 == fit.log_sha256 else ()), *used.notes, *(absent if beside else ()))
    motion = simulate_windows(fit, used)
    held = reached(fit, log, asked=tubes, progress=progress)
    return Validation(fit, log.name, log.sha256, forces, motion, notes, held, doubts)


def _checkable(fit: Identification, rows: RegressionRows, index: int) -> bool:
    """Whether the channel has rows, and the fit a value for every parameter in them."""
    used, count = np.zeros(len(rows.terms), dtype=bool), 0
    for part in pieces(rows.channel.size):
        here = rows.channel[part] == index
        held = (rows.matrix.lower[part][here] != 0) | (rows.matrix.upper[part][here] != 0)
        used |= held.any(axis=0)
        count += held.shape[0]
    known = {*fit.estimate, *fit.parameters}
    return count > 0 and all(t.id in known for t, u in zip(rows.terms, used, strict=True) if u)


def _force_check(fit: Identification, rows: RegressionRows, index: int, channel: str) -> ForceCheck:
    rows = rows.take(array_pieces(rows.channel.size, lambda p: rows.channel[p] == index), range(len(rows.terms)))
    matrix, right, count = rows.matrix, rows.right, rows.time.size
    ids = [t.id for t in rows.terms]
    point = np.array([fit.estimate.get(i, 0.0) for i in ids])
    known = [fit.parameters.get(i) for i in ids]
    # Without an interval the estimate stands alone, as a point: the parameter of least inflation of a falsified model.
    lower = np.array([p.lower if p else x for p, x in zip(known, point, strict=True)])
    upper = np.array([p.upper if p else x for p, x in zip(known, point, strict=True)])
    box = IntervalArray(lower, upper)
    predicted = interval_pieces(count, lambda p: (matrix[p] * box).sum(axis=1))
    mid = array_pieces(count, lambda p: _combined(matrix[p].midpoint, point))

    def error(p: slice) -> NDArray[np.float64]:
        return np.asarray(mid[p] - right[p].midpoint)

    def mean(of: Callable[[slice], NDArray[np.float64]]) -> float:
        return math.fsum(float(of(p).sum()) for p in pieces(count)) / count

    bias = mean(error)
    meets = sum(
        int(((predicted.lower[p] <= right.upper[p]) & (right.lower[p] <= predicted.upper[p])).sum())
        for p in pieces(count)
    )
    return ForceCheck(
        channel,
        rows.time,
        right,
        predicted,
        mid,
        bias,
        math.sqrt(mean(lambda p: (error(p) - bias) ** 2)),
        mean(lambda p: np.abs(error(p))),
        mean(lambda p: predicted[p].contains(right[p].midpoint).astype(np.float64)),
        count - meets,
    )


def _combined(columns: NDArray[np.float64], point: NDArray[np.float64]) -> NDArray[np.float64]:
    """The sum of the columns times the numbers, term by term: the same for every part of the rows."""
    total = np.zeros(columns.shape[0])
    for j, x in enumerate(point):
        total += columns[:, j] * x
    return total


def simulate_windows(fit: Identification, log: Log) -> MotionCheck:
    """Simulates the estimate of a fit from the measured state, window by window, under the logged demands.

    Args:
        fit: an identification with an estimate of every parameter.
        log: with u, v, r and the demands; positions are simulated where it has psi, x, y.
    """
    nothing = np.zeros((0, 3))
    vehicle = fit.vehicle
    nu = room((log.t.size, 3), DOUBLE)
    for j, name in enumerate(("u", "v", "r")):
        nu[:, j] = log.columns[name]
    force = nominal_force(vehicle, log)
    try:
        runs = runs_of(fit, log, nu, force)
    except IvsidError as refusal:
        return MotionCheck({}, {}, {}, np.zeros(0), nothing, nothing, str(refusal))
    complete = array_pieces(
        log.t.size, lambda p: np.asarray(np.isfinite(nu[p]).all(axis=1) & np.isfinite(force[p]).all(axis=1))
    )
    window, rms, median = {}, {}, {}
    starts, count = _windows(log, complete, VELOCITY_WINDOW)
    if not starts.size:
        return MotionCheck({}, {}, {}, np.zeros(0), nothing, nothing, "no window of 10 s without missing samples")
    shape = starts.size, count + 1
    time, simulated, measured = room(shape, DOUBLE), room((*shape, 3), DOUBLE), room((*shape, 3), DOUBLE)
    each = np.empty((starts.size, 3))
    for part in _groups(starts.size, count):
        at = starts[part][:, None] + np.arange(count + 1)
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                simulated[part] = runs(starts[part], count)
        except IvsidError as refusal:
            return MotionCheck({}, {}, {}, np.zeros(0), nothing, nothing, str(refusal))
        if not np.isfinite(simulated[part]).all():
            return MotionCheck({}, {}, {}, np.zeros(0), nothing, nothing, "the simulated motion grows without bound")
        time[part], measured[part] = log.t[at], nu[at]
        each[part] = np.sqrt(np.mean((simulated[part] - measured[part]) ** 2, axis=1))
    window["velocity"] = VELOCITY_WINDOW
    for j, name in enumerate(("u", "v", "r")):
        rms[name], median[name] = float(np.sqrt(np.mean(each[:, j] ** 2))), float(np.median(each[:, j]))
    position = _position_error(runs, log, complete)
    if position is not None:
        window["position"] = POSITION_WINDOW
        with np.errstate(over="ignore"):
            rms["position"], median["position"] = float(np.sqrt(np.mean(position**2))), float(np.median(position))
    return MotionCheck(window, rms, median, time.ravel(), simulated.reshape(-1, 3), measured.reshape(-1, 3), None)


def _groups(windows: int, count: int) -> list[slice]:
    """Windows of this many steps that are simulated at once: all of them on a log of moderate length."""
    return pieces(windows, max(1, TOGETHER // count))


# A motion that grows without bound has an infinite error.
@np.errstate(over="ignore", invalid="ignore")
def _position_error(runs: Runs, log: Log, complete: NDArray[np.bool_]) -> NDArray[np.float64] | None:
    """Rms distance [m] over each position window, or None where the log has no pose."""
    if not all(n in log.columns for n in ("psi", "x", "y")):
        return None
    pose = [log.columns[n] for n in ("x", "y", "psi")]
    posed = array_pieces(
        log.t.size, lambda p: np.asarray(complete[p] & np.all([np.isfinite(x[p]) for x in pose], axis=0))
    )
    starts, count = _windows(log, posed, POSITION_WINDOW)
    if not starts.size:
        return None
    return np.concatenate([_distances(runs, log, pose, starts[p], count) for p in _groups(starts.size, count)])


def _distances(
    runs: Runs, log: Log, pose: Sequence[NDArray[np.float64]], starts: NDArray[np.int64], count: int
) -> NDArray[np.float64]:
    """Rms distance [m] of the simulated from the measured track over each window; infinite where it grows without bound."""
    x, y, heading_of = pose
    at = starts[:, None] + np.arange(count + 1)
    steps = np.diff(log.t[at], axis=1)
    run = runs(starts, count)
    middle = 0.5 * (run[:, 1:] + run[:, :-1])
    turn = np.concatenate([np.zeros((starts.size, 1)), np.cumsum(middle[:, :, 2] * steps, axis=1)], axis=1)
    psi = heading_of[starts][:, None] + turn
    heading = 0.5 * (psi[:, 1:] + psi[:, :-1])
    north = middle[:, :, 0] * np.cos(heading) - middle[:, :, 1] * np.sin(heading)
    east = middle[:, :, 0] * np.sin(heading) + middle[:, :, 1] * np.cos(heading)
    track = np.stack([np.cumsum(north * steps, axis=1), np.cumsum(east * steps, axis=1)], axis=2)
    measured = np.stack([x[at[:, 1:]] - x[starts][:, None], y[at[:, 1:]] - y[starts][:, None]], axis=2)
    error = np.sqrt(np.mean(np.sum((track - measured) ** 2, axis=2), axis=1))
    return np.asarray(np.where(np.isnan(error), np.inf, error), dtype=np.float64)


def _windows(log: Log, complete: NDArray[np.bool_], length: float) -> tuple[NDArray[np.int64], int]:
    """Starts of windows of ``length`` seconds that follow each other, without missing samples or gaps, and their steps."""
    count = max(1, round(length / log.period))
    longest = GAP * log.period
    starts = np.arange(0, log.t.size - count, count)

    def whole(part: slice) -> NDArray[np.bool_]:
        rows = slice(part.start * count, part.stop * count)
        there = complete[rows].reshape(-1, count).all(axis=1) & complete[starts[part] + count]
        steps = np.diff(log.t[rows.start : rows.stop + 1]).reshape(-1, count)
        return np.asarray(there & (steps <= longest).all(axis=1))

    return starts[np.concatenate([whole(p) for p in _groups(starts.size, count)])], count
