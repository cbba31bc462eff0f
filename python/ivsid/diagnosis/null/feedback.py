"""What a log's demands answer to: gains on the motion, regressed from the log, for null logs under the same feedback.

A programme jumps and ramps, a feedback follows the motion: increments over half a second are regressed on those of the velocities and the heading,
with weights that forget jumps, and counted only in the blocks that they explain. Elsewhere the programme is open loop.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.prediction.states import FilteredStates

Array = NDArray[np.float64]
# Increments over this time [s], blocks of this length [s], and what of a block's increments a feedback has to explain.
SPAN: Final = 0.5
BLOCK: Final = 10.0
EXPLAINED: Final = 0.6
# Standard deviations of a correlation that is none, and of the filter's errors that increments may be off.
CERTAIN: Final = 3.0
NOISE: Final = 3.0
JUMP: Final = 4.0
# Times longer increments where the yaw rate is faint.
LONGER: Final = 4
# A block whose demand stands still more than this is open loop.
STILL: Final = 0.7
ROUNDS: Final = 8
# Half of the sensors' noise in the demand: it is the sensors that are read.
READ: Final = 0.5


@dataclass(frozen=True)
class Feedback:
    """Linear feedback of the demands, rudders and angles, in this order.

    Attributes:
        feedback_gains: change of each with u, v, r, psi, shape (sent, 4); zeros where there is none.
        at: samples at which it acts, shape (sent, n).
        lowest: of each, as far as the log goes.
        highest: likewise.
        reads: the feedback holds the sensors' noise; else it knows the motion better than they do.
    """

    feedback_gains: Array
    at: NDArray[np.bool_]
    lowest: Array
    highest: Array
    reads: bool

    @property
    def closed(self) -> bool:
        """Whether there is any."""
        return bool(self.at.any())


def sent_of(log: Channels) -> Array:
    """Everything that is commanded: demands, rudder angles and thruster angles, shape (3 thrusters, n)."""
    return np.concatenate([log.demands, log.rudders, log.angles])


def feedback_of(log: Channels, states: FilteredStates, spread: float) -> Feedback:
    """The feedback behind a log.

    Args:
        log: on its clock.
        states: filtered motion, which hold less noise than the readings.
        spread: standard deviation of the filtered yaw rate's error [rad/s].
    """
    sent, n = sent_of(log), log.n
    span = max(1, round(SPAN / log.h))
    heading = np.zeros(n) if log.psi is None else states.points.psi[:n]
    motion = np.concatenate([states.points.nu[:, :n], heading[None]])
    # Without a heading nothing can have followed one.
    usable = [0, 1, 2] + ([3] if log.psi is not None else [])
    change = motion[:, span:] - motion[:, :-span]
    good = log.good[span:] & log.good[:-span]
    feedback_gains = np.zeros((len(sent), 4))
    at = np.zeros((len(sent), n), dtype=bool)
    length = max(span, round(BLOCK / log.h))
    for k, x in enumerate(sent):
        moved = x[span:] - x[:-span]
        blocks = [slice(s, s + length) for s in range(0, n - span - length + 1, length)]
        # One state is enough for most programmes, and it is never mistaken for four.
        explained = [b for b in blocks if _explained(change[[2]][:, b], moved[b], good[b])]
        if explained:
            rows = _rows(explained, good)
            feedback_gains[k, 2] = _robust(change[[2]][:, rows], moved[rows])[0][0]
        explained += _faint(log, x, [b for b in blocks if b not in explained], feedback_gains[k], spread, span)
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
    """Coefficients by iterated weights that forget jumps, and the share of the increments that they explain, by median sizes."""
    scale = np.maximum(np.sqrt(np.mean(x**2, axis=1)), 1e-12)
    a = x / scale[:, None]
    weight = np.ones(y.size)
    c = np.zeros(len(a))
    for _ in range(ROUNDS):
        normal = (a * weight) @ a.T + 1e-9 * np.eye(len(a)) * weight.sum()
        c = np.linalg.solve(normal, (a * weight) @ y)
        left = y - c @ a
        size = max(float(np.median(np.abs(left))), 1e-12)
        weight = 1.0 / (1.0 + (left / (3.0 * size)) ** 2)
    usual = float(np.median(np.abs(y)))
    share = 1.0 - float(np.median(np.abs(left))) / usual if usual > 0 else 0.0
    return c / scale, share


def _rows(blocks: list[slice], good: NDArray[np.bool_]) -> NDArray[np.int64]:
    rows = np.concatenate([np.arange(b.start, b.stop) for b in blocks])
    return np.asarray(rows[good[rows]])


def _moving(y: Array, good: NDArray[np.bool_]) -> bool:
    return bool(good.sum() >= 0.5 * good.size and np.mean(y[good] == 0.0) <= STILL)


def _explained(x: Array, y: Array, good: NDArray[np.bool_]) -> bool:
    """Whether the motion make a block's demand; more motion have to explain more."""
    return _moving(y, good) and _robust(x[:, good], y[good])[1] >= 1.0 - (1.0 - EXPLAINED) / len(x)


def _faint(
    log: Channels, sent: Array, blocks: list[slice], feedback_gain: Array, spread: float, span: int
) -> list[slice]:
    """Blocks on straight courses: the yaw rate is mostly noise there, and the demand is not, so it stands on the other side.

    What is left of the yaw rate must be no more than its noise. The gain is set where none was known.
    """
    long = LONGER * span
    mean = uniform_filter1d(log.nu[2], span)
    x, y = mean[long:] - mean[:-long], sent[long:] - sent[:-long]
    good = log.good[long:] & log.good[:-long]
    noise = NOISE * float(np.hypot(spread, log.noise["r"] / np.sqrt(span)))
    blocks = [b for b in blocks if b.stop <= y.size and _moving(y[b], good[b])]
    if not blocks:
        return []
    rows = _rows(blocks, good)
    # A jump of the programme would be a lever.
    calm = np.abs(y) <= JUMP * _size(y[rows])
    rows = rows[calm[rows]]
    if not feedback_gain[2]:
        back = _robust(y[None, rows], x[rows])[0][0]
        one = _robust(x[None, rows], y[rows])[0][0]
        if one * back * rows.size / long < CERTAIN**2 or _size(x[rows] - back * y[rows]) > noise:
            return []
        feedback_gain[2] = 1.0 / back
    return [b for b in blocks if _size((x[b] - y[b] / feedback_gain[2])[good[b] & calm[b]]) <= noise]


def _size(x: Array) -> float:
    return float(np.median(np.abs(x))) / 0.6745 if x.size else np.inf


def _reads(log: Channels, motion: Array, sent: Array, feedback_gains: Array, at: NDArray[np.bool_]) -> bool:
    """Whether the demands hold the noise of the rate sensor."""
    noise = np.diff(log.nu[2] - motion[2])
    total = weight = 0.0
    for x, feedback_gain, here in zip(sent, feedback_gains, at, strict=True):
        if not feedback_gain[2]:
            continue
        use = here[1:] & log.good[1:] & log.good[:-1]
        left = np.diff(x) - feedback_gain @ np.diff(motion, axis=1)
        use &= np.abs(left) <= 6.0 * max(float(np.median(np.abs(left[use]))), 1e-12) if use.any() else use
        power = float(noise[use] @ noise[use])
        total += float(left[use] @ noise[use]) / feedback_gain[2]
        weight += power
    return weight > 0 and total / weight > READ
