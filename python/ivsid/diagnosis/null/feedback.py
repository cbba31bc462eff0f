"""Feedback of a log's demands on its motion, regressed from the log, for null logs under the same feedback.

A programme jumps and ramps, and a feedback follows the motion. Increments of the demands over half a second are regressed on those of the
velocities and the heading by iteratively reweighted least squares, in which jumps lose their weight. The feedback acts in the blocks whose
increments it explains. Elsewhere the programme is open loop.

Source: Holland and Welsch, "Robust regression using iteratively reweighted least-squares", Communications in Statistics A6, 1977.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.data.sensor_noise import NORMAL_MEDIAN
from ivsid.diagnosis.estimation.cross_products import RIDGE
from ivsid.diagnosis.prediction.filtered_states import FilteredStates

Array = NDArray[np.float64]
# Time over which increments are taken [s].
# Source: measured: make constants
SPAN: Final = 0.5
# Length of a block in which the programme is either under feedback or open loop [s].
# Source: measured: make constants
BLOCK: Final = 10.0
# Share of a block's increments that feedback on one state has to explain; feedback on more states has to explain more.
# Source: measured: make constants
EXPLAINED: Final = 0.6
# Standard deviations up to which a correlation or an error counts as chance.
# Source: definition: 0.3 % of normal errors lie beyond
SIGMAS: Final = 3.0
# An increment beyond this multiple of their standard deviation is a jump of the programme.
# Source: definition: 0.006 % of normal errors lie beyond
JUMP: Final = 4.0
# Factor on the time of an increment where the yaw rate is faint: the noise of a mean falls with its length.
# Source: measured: make constants
LONGER: Final = 4
# A block is open loop if a larger share of its demands does not change.
# Source: measured: make constants
UNCHANGED: Final = 0.7
# A block counts if at least this share of its samples is usable.
# Source: measured: make constants
USABLE: Final = 0.5
# Iterations of the reweighted regression.
# Source: resource: eight regressions for each block and demand
ROUNDS: Final = 8
# Tuning constant of the Cauchy weights, in median sizes: 2.0 standard deviations, near the usual 2.385.
# Source: Holland and Welsch 1977
CAUCHY: Final = 3.0
# The controller reads the sensors if more than this share of their noise is in the demands.
# Source: definition: the middle between all of the noise and none
READ: Final = 0.5
# A residual beyond this multiple of the median size is a jump, and says nothing of the noise in the demands.
# Source: definition: four standard deviations of normal errors
FAR: Final = 6.0


@dataclass(frozen=True)
class Feedback:
    """Linear feedback of the demands, rudder angles and thruster angles, in this order.

    Attributes:
        feedback_gains: change of each command with u, v, r, psi, shape (sent, 4); zeros without feedback.
        at: samples at which the feedback acts, shape (sent, n).
        lowest: least value of each command in the log, shape (sent,).
        highest: largest value of each command in the log, shape (sent,).
        reads: whether the controller reads the log's sensors; otherwise it knows the true motion.
    """

    feedback_gains: Array
    at: NDArray[np.bool_]
    lowest: Array
    highest: Array
    reads: bool

    @property
    def closed(self) -> bool:
        """Whether the log has any feedback."""
        return bool(self.at.any())


def sent_of(log: Channels) -> Array:
    """Commands of a log: demands, rudder angles and thruster angles, shape (3 thrusters, n)."""
    return np.concatenate([log.demands, log.rudders, log.angles])


def feedback_of(log: Channels, states: FilteredStates, spread: float) -> Feedback:
    """Feedback behind the commands of a log.

    Args:
        log: on its clock.
        states: the filtered motion, which holds less noise than the readings.
        spread: standard deviation of the filtered yaw rate's error [rad/s].
    """
    sent, n = sent_of(log), log.n
    span = max(1, round(SPAN / log.h))
    heading = np.zeros(n) if log.psi is None else states.points.psi[:n]
    motion = np.concatenate([states.points.nu[:, :n], heading[None]])
    # A log without a heading has no feedback on one.
    usable = [0, 1, 2] + ([3] if log.psi is not None else [])
    change = motion[:, span:] - motion[:, :-span]
    good = log.good[span:] & log.good[:-span]
    feedback_gains = np.zeros((len(sent), 4))
    at = np.zeros((len(sent), n), dtype=bool)
    length = max(span, round(BLOCK / log.h))
    for k, x in enumerate(sent):
        moved = x[span:] - x[:-span]
        blocks = [slice(s, s + length) for s in range(0, n - span - length + 1, length)]
        # The yaw rate alone is tried first: most controllers follow it, and four states explain chance.
        explained = [b for b in blocks if _explained(change[[2]][:, b], moved[b], good[b])]
        if explained:
            rows = _rows(explained, good)
            feedback_gains[k, 2] = _robust(change[[2]][:, rows], moved[rows])[0][0]
        rest = [b for b in blocks if b not in explained]
        straight, feedback_gains[k, 2] = _faint(log, x, rest, float(feedback_gains[k, 2]), spread, span)
        explained += straight
        if not explained:
            explained = [b for b in blocks if _explained(change[usable][:, b], moved[b], good[b])]
            if not explained:
                continue
            rows = _rows(explained, good)
            feedback_gains[k, usable] = _robust(change[usable][:, rows], moved[rows])[0]
        for b in explained:
            at[k, b.start : n if b.stop + length > n - span else b.stop] = True
    return Feedback(
        feedback_gains, at, sent.min(axis=1), sent.max(axis=1), _reads(log, motion, sent, feedback_gains, at)
    )


def _robust(x: Array, y: Array) -> tuple[Array, float]:
    """Regression with Cauchy weights: the coefficients, and the share of the median increment that they explain."""
    scale = np.maximum(np.sqrt(np.mean(x**2, axis=1)), 1e-12)
    a = x / scale[:, None]
    weight = np.ones(y.size)
    c = np.zeros(len(a))
    for _ in range(ROUNDS):
        # States have a mean square of 1, so that the sum of the weights is their squared length.
        normal = (a * weight) @ a.T + RIDGE * np.eye(len(a)) * weight.sum()
        c = np.linalg.solve(normal, (a * weight) @ y)
        left = y - c @ a
        size = max(float(np.median(np.abs(left))), 1e-12)
        weight = 1.0 / (1.0 + (left / (CAUCHY * size)) ** 2)
    usual = float(np.median(np.abs(y)))
    share = 1.0 - float(np.median(np.abs(left))) / usual if usual > 0 else 0.0
    return c / scale, share


def _rows(blocks: list[slice], good: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Usable samples of blocks."""
    rows = np.concatenate([np.arange(b.start, b.stop) for b in blocks])
    return np.asarray(rows[good[rows]])


def _moving(y: Array, good: NDArray[np.bool_]) -> bool:
    """Whether a block has enough usable samples and its demand changes in enough of them."""
    return bool(good.sum() >= USABLE * good.size and np.mean(y[good] == 0.0) <= UNCHANGED)


def _explained(x: Array, y: Array, good: NDArray[np.bool_]) -> bool:
    """Whether increments of the motion explain those of a block's demand; the share asked for grows with the number of states."""
    return _moving(y, good) and _robust(x[:, good], y[good])[1] >= 1.0 - (1.0 - EXPLAINED) / len(x)


def _faint(
    log: Channels, sent: Array, blocks: list[slice], known: float, spread: float, span: int
) -> tuple[list[slice], float]:
    """Blocks under feedback on straight courses, and the gain of the yaw rate.

    The yaw rate is mostly noise there and the demand is not, so the yaw rate is regressed on the demand. Its residual must not exceed the
    noise of the sensor and the filter. The ``known`` gain is kept if it is not zero.
    """
    long = LONGER * span
    mean = uniform_filter1d(log.nu[2], span)
    x, y = mean[long:] - mean[:-long], sent[long:] - sent[:-long]
    good = log.good[long:] & log.good[:-long]
    noise = SIGMAS * float(np.hypot(spread, log.noise["r"] / np.sqrt(span)))
    blocks = [b for b in blocks if b.stop <= y.size and _moving(y[b], good[b])]
    if not blocks:
        return [], known
    rows = _rows(blocks, good)
    # A jump of the programme would outweigh all other increments.
    calm = np.abs(y) <= JUMP * _size(y[rows])
    rows = rows[calm[rows]]
    feedback_gain = known
    if not feedback_gain:
        back = _robust(y[None, rows], x[rows])[0][0]
        one = _robust(x[None, rows], y[rows])[0][0]
        if one * back * rows.size / long < SIGMAS**2 or _size(x[rows] - back * y[rows]) > noise:
            return [], known
        feedback_gain = float(1.0 / back)
    return [b for b in blocks if _size((x[b] - y[b] / feedback_gain)[good[b] & calm[b]]) <= noise], feedback_gain


def _size(x: Array) -> float:
    """Robust standard deviation, from the median absolute value; infinite for an empty array."""
    return float(np.median(np.abs(x))) / NORMAL_MEDIAN if x.size else np.inf


def _reads(log: Channels, motion: Array, sent: Array, feedback_gains: Array, at: NDArray[np.bool_]) -> bool:
    """Whether the noise of the rate sensor stands in the demands."""
    noise = np.diff(log.nu[2] - motion[2])
    total = weight = 0.0
    for x, feedback_gain, here in zip(sent, feedback_gains, at, strict=True):
        if not feedback_gain[2]:
            continue
        use = here[1:] & log.good[1:] & log.good[:-1]
        left = np.diff(x) - feedback_gain @ np.diff(motion, axis=1)
        use &= np.abs(left) <= FAR * max(float(np.median(np.abs(left[use]))), 1e-12) if use.any() else use
        power = float(noise[use] @ noise[use])
        total += float(left[use] @ noise[use]) / feedback_gain[2]
        weight += power
    return weight > 0 and total / weight > READ
