"""A fit against another log: predicted force against measured (paper, Figs 4-7), simulated motion and tubes against measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.display.shown import Result
from ivsid.display.table import Cells
from ivsid.effects import CHANNELS, causes, terms_of
from ivsid.errors import IvsidError
from ivsid.identification import Identification
from ivsid.intervals import IntervalArray
from ivsid.log import GivenLog, Log, log_of
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
    forces = tuple(_force_check(fit, rows, k, name) for k, name in enumerate(CHANNELS) if _checkable(fit, rows, k))
    own = (
        f"{log.name} is the log that the fit was made of: agreement with it proves nothing; give a log of another run",
    )
    beside = ", ".join(n for g in causes(vehicle) for n in g.named)
    absent = (f"{beside} of [model.fitted] moves the simulated vehicle, and stands in no row of forces and no reading",)
    notes = (*(own if log.sha256 == fit.log_sha256 else ()), *bounded.log.notes, *(absent if beside else ()))
    motion = simulate_windows(fit, bounded.log)
    held = reached(fit, log, asked=tubes, progress=progress)
    return Validation(fit, log.name, log.sha256, forces, motion, notes, held, doubts)


def _checkable(fit: Identification, rows: RegressionRows, index: int) -> bool:
    """Whether the channel has rows, and the fit a value for every parameter in them."""
    here = rows.matrix[rows.channel == index]
    used = ((here.lower != 0) | (here.upper != 0)).any(axis=0)
    known = {*fit.estimate, *fit.parameters}
    return here.shape[0] > 0 and all(t.id in known for t, u in zip(rows.terms, used, strict=True) if u)


def _force_check(fit: Identification, rows: RegressionRows, index: int, channel: str) -> ForceCheck:
    here = rows.channel == index
    matrix, right = rows.matrix[here], rows.right[here]
    ids = [t.id for t in rows.terms]
    point = np.array([fit.estimate.get(i, 0.0) for i in ids])
    known = [fit.parameters.get(i) for i in ids]
    # Without an interval the estimate stands alone, as a point: the parameter of least inflation of a falsified model.
    lower = np.array([p.lower if p else x for p, x in zip(known, point, strict=True)])
    upper = np.array([p.upper if p else x for p, x in zip(known, point, strict=True)])
    predicted = (matrix * IntervalArray(lower, upper)).sum(axis=1)
    mid = matrix.midpoint @ point
    measured = right.midpoint
    error = mid - measured
    meets = (predicted.lower <= right.upper) & (right.lower <= predicted.upper)
    return ForceCheck(
        channel,
        rows.time[here],
        right,
        predicted,
        mid,
        float(error.mean()),
        float(error.std()),
        float(np.abs(error).mean()),
        float(predicted.contains(measured).mean()),
        int((~meets).sum()),
    )


def simulate_windows(fit: Identification, log: Log) -> MotionCheck:
    """Simulates the estimate of a fit from the measured state, window by window, under the logged demands.

    Args:
        fit: an identification with an estimate of every parameter.
        log: with u, v, r and the demands; positions are simulated where it has psi, x, y.
    """
    nothing = np.zeros((0, 3))
    vehicle = fit.vehicle
    nu = np.stack([log.columns[n] for n in ("u", "v", "r")], axis=1)
    force = nominal_force(vehicle, log)
    try:
        runs = runs_of(fit, log, nu, force)
    except IvsidError as refusal:
        return MotionCheck({}, {}, {}, np.zeros(0), nothing, nothing, str(refusal))
    complete: NDArray[np.bool_] = np.asarray(np.isfinite(nu).all(axis=1) & np.isfinite(force).all(axis=1))
    window, rms, median = {}, {}, {}
    starts, count = _windows(log, complete, VELOCITY_WINDOW)
    if not starts.size:
        return MotionCheck({}, {}, {}, np.zeros(0), nothing, nothing, "no window of 10 s without missing samples")
    at = starts[:, None] + np.arange(count + 1)
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            simulated = runs(starts, count)
    except IvsidError as refusal:
        return MotionCheck({}, {}, {}, np.zeros(0), nothing, nothing, str(refusal))
    if not np.isfinite(simulated).all():
        return MotionCheck({}, {}, {}, np.zeros(0), nothing, nothing, "the simulated motion grows without bound")
    window["velocity"] = VELOCITY_WINDOW
    error = simulated - nu[at]
    for j, name in enumerate(("u", "v", "r")):
        each = np.sqrt(np.mean(error[:, :, j] ** 2, axis=1))
        rms[name], median[name] = float(np.sqrt(np.mean(each**2))), float(np.median(each))
    position = _position_error(runs, log, complete)
    if position is not None:
        window["position"] = POSITION_WINDOW
        with np.errstate(over="ignore"):
            rms["position"], median["position"] = float(np.sqrt(np.mean(position**2))), float(np.median(position))
    return MotionCheck(window, rms, median, log.t[at].ravel(), simulated.reshape(-1, 3), nu[at].reshape(-1, 3), None)


# A motion that grows without bound has an infinite error.
@np.errstate(over="ignore", invalid="ignore")
def _position_error(runs: Runs, log: Log, complete: NDArray[np.bool_]) -> NDArray[np.float64] | None:
    """Rms distance [m] over each position window, or None where the log has no pose."""
    if not all(n in log.columns for n in ("psi", "x", "y")):
        return None
    pose = np.stack([log.columns[n] for n in ("x", "y", "psi")], axis=1)
    starts, count = _windows(log, complete & np.isfinite(pose).all(axis=1), POSITION_WINDOW)
    if not starts.size:
        return None
    at = starts[:, None] + np.arange(count + 1)
    steps = np.diff(log.t[at], axis=1)
    run = runs(starts, count)
    middle = 0.5 * (run[:, 1:] + run[:, :-1])
    turn = np.concatenate([np.zeros((starts.size, 1)), np.cumsum(middle[:, :, 2] * steps, axis=1)], axis=1)
    psi = pose[starts, 2][:, None] + turn
    heading = 0.5 * (psi[:, 1:] + psi[:, :-1])
    north = middle[:, :, 0] * np.cos(heading) - middle[:, :, 1] * np.sin(heading)
    east = middle[:, :, 0] * np.sin(heading) + middle[:, :, 1] * np.cos(heading)
    track = np.stack([np.cumsum(north * steps, axis=1), np.cumsum(east * steps, axis=1)], axis=2)
    measured = pose[at[:, 1:], :2] - pose[starts, None, :2]
    error = np.sqrt(np.mean(np.sum((track - measured) ** 2, axis=2), axis=1))
    return np.asarray(np.where(np.isnan(error), np.inf, error), dtype=np.float64)


def _windows(log: Log, complete: NDArray[np.bool_], length: float) -> tuple[NDArray[np.int64], int]:
    """Starts of windows of ``length`` seconds that follow each other, without missing samples or gaps, and their steps."""
    count = max(1, round(length / log.period))
    gap = np.diff(log.t) > GAP * log.period
    bad = np.r_[0, np.cumsum(~complete)]
    gaps = np.r_[0, np.cumsum(gap)]
    starts = np.arange(0, log.t.size - count, count)
    whole = (bad[starts + count + 1] == bad[starts]) & (gaps[starts + count] == gaps[starts])
    return starts[whole], count
