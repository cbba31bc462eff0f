"""Declared errors of a thruster's curve: any continuous function of demand inside the stated accuracy, and a hysteresis beside it.

The error is piecewise linear between knots over the demands of the log, in units of its bound. Its values at the knots are a Gaussian process
beforehand: a smooth part, and a rough part that is independent from knot to knot. The functions of the diagnosis are the eigenvectors of its
covariance, so that their sizes are independent. Values at the knots lie in [-1, 1] exactly where the error lies inside its bound.

A hysteresis is half the difference of two such curves, of demands that have risen and of those that have fallen, between fewer knots. Its
functions stand beside those of the curve: what no declared error takes counts as noise, and a log with a hysteresis inside its accuracy would
show no cause.

Source: docs/theory.md, "Diagnosis"; Rasmussen and Williams, *Gaussian Processes for Machine Learning*, 2006, section 2.2; Loeve's expansion.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Thruster

Array = NDArray[np.float64]
# Knots of a thrust error over the demands of a log.
# Source: resource: each is a column of every fit; fifteen pieces follow a wave of four periods to a tenth
KNOTS: Final = 16
# Standard deviation of an error of which only a bound is known, in units of the bound.
# Source: theorem: a uniform distribution within the bound has 1/sqrt(3) = 0.577
BOUNDED: Final = 0.6
# Share of the variance that is smooth.
# Source: geometry: a curve of one bend, and one that jumps from knot to knot, cost about as much chi-squared
SMOOTH: Final = 0.6
# Distance over which the smooth part is correlated, as a share of the demands.
# Source: geometry: a calibration error bends a few times over the range
CORRELATED: Final = 0.3
# Knots of a hysteresis over the demands of a log.
# Source: resource: each is a column of every fit; three pieces follow half a difference that bends twice
BRANCHES: Final = 4


def bound_of(thruster: Thruster, curve: ThrustCurve, demand: Array) -> Array:
    """Bound of the thrust error [N] at demands from neutral; a thrust of none has the absolute accuracy."""
    return bound_at(thruster, np.asarray(curve.value(demand + thruster.neutral), dtype=np.float64))


def bound_at(thruster: Thruster, thrust: Array) -> Array:
    """The same at thrusts by the curve [N]."""
    accuracy = thruster.accuracy
    return np.asarray(accuracy.absolute + accuracy.relative * np.abs(thrust), dtype=np.float64)


@dataclass(frozen=True)
class ThrustErrors:
    """Declared errors of one thruster.

    Attributes:
        bound: of the thrust error [N], as a function of demands from neutral.
        places: of the knots, as such demands, shape (knots,).
        spreads: standard deviation of the size of each error beforehand, those of the curve first, shape (errors,).
        knots: value of each error of the curve at the knots, in units of the bound, shape (knots, knots).
        turns: knots of the hysteresis, shape (turns,).
        branches: value of each error of the hysteresis at its knots where a demand has risen, and its negative where it has fallen, shape
            (turns, turns).
    """

    bound: Callable[[Array], Array]
    places: Array
    spreads: Array
    knots: Array
    turns: Array
    branches: Array

    def largest(self, thruster: str, sizes: Mapping[str, float]) -> float:
        """The largest error by the sizes of a hypothesis, in units of the bound.

        Args:
            thruster: name of the thruster.
            sizes: of declared errors, by name.
        """
        held = np.array([sizes.get(name, 0.0) for name in self.names(thruster)])
        curve, half = np.split(held, [len(self.places)])
        apart = np.interp(self.places, self.turns, self.branches @ half) if half.size else 0.0
        return float((np.abs(self.knots @ curve) + np.abs(apart)).max(initial=0.0))

    def names(self, thruster: str) -> list[str]:
        """Names of the errors, in the order of their spreads.

        Args:
            thruster: name of the thruster.
        """
        return [f"~thrust.{thruster}.{j}" for j in range(self.knots.shape[1])] + [
            f"~hysteresis.{thruster}.{j}" for j in range(self.branches.shape[1])
        ]

    def sizes(self, side: float) -> Array:
        """Sizes of the errors by the values at the knots of one branch, then those of the hysteresis, shape (errors, values).

        Args:
            side: 1 for the branch of demands that have risen, -1 for that of demands that have fallen.
        """
        there = np.array([np.interp(self.places, self.turns, one) for one in np.eye(self.turns.size)]).reshape(
            -1, self.places.size
        )
        # The values are orthogonal combinations of the sizes.
        upper = np.hstack([self.knots.T, -side * self.knots.T @ there.T])
        lower = np.hstack([np.zeros((self.turns.size, self.places.size)), self.branches.T])
        return np.vstack([upper, lower])

    def at(self, demand: Array) -> Array:
        """Thrust errors [N] of one unit of each at demands from neutral in the order of time, shape (errors, n)."""
        if not len(self.spreads):
            return np.zeros((0, demand.size))
        curve = [np.interp(demand, self.places, column) for column in self.knots.T]
        side = np.where(upward(demand), 1.0, -1.0)
        branch = [side * np.interp(demand, self.turns, column) for column in self.branches.T]
        return np.asarray(self.bound(demand) * np.stack([*curve, *branch]))

    def values(self, sizes: Sequence[float]) -> tuple[Array, Array]:
        """Sums of the errors of given sizes at the knots of the curve, and at those of the hysteresis, in units of the bound."""
        count = self.knots.shape[1]
        return self.knots @ np.asarray(sizes[:count]), self.branches @ np.asarray(sizes[count:])

    def total(self, demand: Array, sizes: Sequence[float], bound: Array) -> Array:
        """Sum of the thrust errors [N] of given sizes at demands from neutral in the order of time, shape (n,).

        Args:
            demand: shape (n,).
            sizes: of the errors, in units of the bound.
            bound: at these demands [N], shape (n,), where it costs less than ``bound``.
        """
        curve, branch = self.values(sizes)
        found = np.interp(demand, self.places, curve)
        if np.any(branch):
            found += np.where(upward(demand), 1.0, -1.0) * np.interp(demand, self.turns, branch)
        return np.asarray(bound * found)


def upward(d: Array) -> NDArray[np.bool_]:
    """Whether the last change of a demand was a rise, at each sample in the order of time; a first stretch counts as risen."""
    if not d.size:
        return np.ones(0, dtype=bool)
    change = np.diff(d, prepend=d[:1])
    change[0] = 1.0
    last = np.maximum.accumulate(np.where(change != 0.0, np.arange(d.size), 0))
    return np.asarray((change > 0.0)[last])


def thrust_errors(thruster: Thruster, curve: ThrustCurve, demand: Array) -> ThrustErrors:
    """The declared errors of a thruster; none if no accuracy is declared.

    Args:
        thruster: with its accuracy.
        curve: its thrust curve.
        demand: of the log from neutral, over whose range the knots stand.
    """
    accuracy, bound = thruster.accuracy, partial(bound_of, thruster, curve)
    none, empty = np.zeros(0), np.zeros((0, 0))
    if not accuracy.absolute and not accuracy.relative:
        return ThrustErrors(bound, none, none, empty, none, empty)
    low, high = float(demand.min()), float(demand.max())
    if high <= low:
        # A demand that never changes has no second branch.
        return ThrustErrors(bound, np.array([low]), np.array([BOUNDED]), np.eye(1), none, empty)
    places, turns = np.linspace(low, high, KNOTS), np.linspace(low, high, BRANCHES)
    (spreads, knots), (more, branches) = _functions(places), _functions(turns)
    return ThrustErrors(bound, places, np.r_[spreads, more], knots, turns, branches)


def _functions(knots: Array) -> tuple[Array, Array]:
    """Standard deviations of the independent functions of an error, the smoothest first, and their values at its knots."""
    apart = (knots[:, None] - knots) / np.ptp(knots)
    covariance = SMOOTH * np.exp(-0.5 * (apart / CORRELATED) ** 2) + (1 - SMOOTH) * np.eye(knots.size)
    values, vectors = np.linalg.eigh(covariance)
    order = np.argsort(-values)
    return BOUNDED * np.sqrt(values[order]), vectors[:, order].copy()
