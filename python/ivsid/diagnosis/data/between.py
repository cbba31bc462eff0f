"""Demands and angles inside the steps of a clock, and where the readings of its samples were taken."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Final, Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# Farthest distance of a sample from its time on the clock [steps]: a single lost sample is interpolated, a longer gap is not.
# Source: geometry: the neighbours of a single lost sample are one step away, and their stamps are rounded
FARTHEST: Final = 1.05


@dataclass(frozen=True)
class Between:
    """Held demands and angles at equal parts of each step of a clock that is slower than the log, shape (thrusters, n, parts) each.

    Attributes:
        demands: of thrusters, in their own unit.
        angles: of azimuth thrusters [rad].
        rudders: angles of rudders [rad].
        read: parts from a sample to each of the readings whose mean it is.
    """

    demands: Array
    angles: Array
    rudders: Array
    read: tuple[int, ...] = (0,)

    @property
    def apart(self) -> bool:
        """Whether readings are those of other moments than their sample."""
        return len(self.read) > 1

    @cached_property
    def _readings(self) -> list[NDArray[np.int64]]:
        """Parts at the readings of each sample, shape (n,) each."""
        n, count = self.demands.shape[1:]
        first = np.arange(0, n * count, count)
        return [np.clip(first + k, 0, n * count - 1) for k in self.read]

    def sampled(self, x: Array) -> Array:
        """The mean of a quantity over the readings of each sample, shape (..., n), from its values at the starts of all parts, shape (..., n parts)."""
        first, *others = (x[..., at] for at in self._readings)
        return np.asarray(sum(others, first) / len(self.read))

    def mean(self, x: Array) -> Array:
        """Means over steps, shape (..., n), from those over their parts, shape (..., n, parts)."""
        # A reduction along an axis of a few numbers takes ten times as long.
        return np.asarray(x @ np.full(x.shape[-1], 1 / x.shape[-1]))

    @cached_property
    def lean(self) -> Array:
        """Weights of the parts in the lead of a step's mean velocity over a straight line, shape (parts,).

        The mean velocity of a step is a double integral of the forces: a force in the first part acts on the whole step, one in the last
        part on almost none of it. Equal weights would be 1 / parts each, and are subtracted.
        """
        count = self.demands.shape[2]
        return np.asarray(2 * (count - np.arange(count) - 0.5) / count**2 - 1 / count)

    @cached_property
    def around(self) -> tuple[Array, Array]:
        """Weights of the parts of the step after a sample and of the step before it in the mean of its readings, in steps, shape (parts,) each.

        A constant acceleration moves the readings before and after a sample apart and leaves their mean; one that changes moves it.
        """
        count = self.demands.shape[2]
        part, read = np.arange(count), np.array(self.read)[:, None]
        share = 1 / (len(self.read) * count)
        return share * (part < read).sum(axis=0), -share * (part >= count + read).sum(axis=0)

    def moved(self, rate: Array, first: Array | float = 0.0) -> Array:
        """The mean of the readings of each sample less the value there, in steps, shape (..., n), of what changes at a rate, shape (..., n, parts).

        Args:
            rate: over the parts of each step.
            first: the rate before the first sample, shape (...).
        """
        after, before = self.around
        found = rate @ after
        found[..., 0] += first * before.sum()
        found[..., 1:] += rate[..., :-1, :] @ before
        return np.asarray(found)

    @cached_property
    def spread(self) -> Array | float:
        """Mean square of the times from a sample to its readings, in steps squared."""
        return float(np.mean(np.square(self.read)) / self.demands.shape[2] ** 2)


@dataclass(frozen=True)
class Rows:
    """Rows of a log before and after each place of readings.

    Attributes:
        back: times from the places back to the rows before [steps], shape (readings, n).
        on: times on to the rows after [steps], shape (readings, n).
        at: parts, from the first one on, with the demands that are in force at all rows before and then at all rows after, shape (2 readings, n).
        lost: whether there are lost rows between both, shape (readings, n).
    """

    back: Array
    on: Array
    at: NDArray[np.int64]
    lost: NDArray[np.bool_]

    def nearer(self, readings: int) -> tuple[Array, Array, Array]:
        """``back`` and ``on``, at most a step each, and the weights of all rows before and after in the mean of so many readings, shape (2 readings, n).

        A row farther away counts as one a step away, with the weight of that: the times of a reading's rows have its own as their mean.
        """
        back, on = np.clip([self.back, self.on], 0.0, 1.0)
        whole = back + on
        before = np.where(whole > 0, on / np.where(whole > 0, whole, 1.0), 1.0)
        return back, on, np.concatenate([before, 1.0 - before]) / readings


@dataclass(frozen=True)
class Straddled(Between):
    """The same where each reading of a sample lies on the straight line between a row before it and one after it, at irregular times.

    Attributes:
        times: from each sample to the rows of its velocities, in steps, at most one either way, shape (rows, n).
        weights: of these rows in the sample, shape (rows, n).
        felt: weights of the rows of its accelerations, shape (rows, n).
        at: parts, from the first one on, with the demands that are in force at the latter, shape (rows, n).
        far: samples with a reading over lost rows that lies between rows farther away than a step, shape (n,).
    """

    times: Array = field(kw_only=True)
    weights: Array = field(kw_only=True)
    felt: Array = field(kw_only=True)
    at: NDArray[np.int64] = field(kw_only=True)
    far: NDArray[np.bool_] = field(kw_only=True)

    @classmethod
    def of(cls, between: Between, places: Array, read: Rows, felt: Rows) -> Self:
        """The same demands and angles, with the rows of irregular readings.

        Args:
            between: at a regular clock.
            places: of the readings, from their sample [steps], shape (readings,).
            read: rows of velocities around them.
            felt: rows of accelerations around them.
        """
        away = np.maximum(np.abs(places[:, None] - read.back), np.abs(places[:, None] + read.on))
        far = np.any(read.lost & (away > FARTHEST), axis=0)
        back, on, weights = read.nearer(len(places))
        times = np.clip(np.concatenate([places[:, None] - back, places[:, None] + on]), -1.0, 1.0)
        return cls(
            between.demands,
            between.angles,
            between.rudders,
            times=times,
            weights=weights,
            felt=felt.nearer(len(places))[2],
            at=felt.at,
            far=far,
        )

    @property
    def apart(self) -> bool:
        """As of ``Between``."""
        return True

    def sampled(self, x: Array) -> Array:
        """As of ``Between``."""
        first, *others = (w * x[..., k] for w, k in zip(self.felt, self.at, strict=True))
        return np.asarray(sum(others, first))

    @cached_property
    def around(self) -> tuple[Array, Array]:
        """As of ``Between``, for each sample, shape (n, parts) each."""
        n, count = self.demands.shape[1:]
        part, after, before = np.arange(count), np.zeros((n, count)), np.zeros((n, count))
        for time, weight in zip(self.times, self.weights, strict=True):
            after += weight[:, None] * np.clip(count * time[:, None] - part, 0.0, 1.0) / count
            before -= weight[:, None] * np.clip(part + 1 - count * (1 + time[:, None]), 0.0, 1.0) / count
        return after, before

    def moved(self, rate: Array, first: Array | float = 0.0) -> Array:
        """As of ``Between``."""
        after, before = self.around
        found = np.einsum("...np,np->...n", rate, after)
        found[..., 0] += first * before[0].sum()
        found[..., 1:] += np.einsum("...np,np->...n", rate[..., :-1, :], before[1:])
        return np.asarray(found)

    @cached_property
    def spread(self) -> Array | float:
        """As of ``Between``, for each sample, shape (n,)."""
        return np.asarray(np.sum(self.weights * self.times**2, axis=0))
