"""Declared errors of a thruster's curve: any continuous function of demand inside the stated accuracy.

The error is piecewise linear between knots over the demands of the log, in units of its bound. Its values at the knots are a Gaussian process
beforehand: a smooth part, and a rough part that is independent from knot to knot. The functions of the diagnosis are the eigenvectors of its
covariance, so that their sizes are independent. Values at the knots lie in [-1, 1] exactly where the error lies inside its bound.

Source: docs/theory.md, "Diagnosis"; Rasmussen and Williams, *Gaussian Processes for Machine Learning*, 2006, section 2.2; Loeve's expansion.
"""

from __future__ import annotations

from collections.abc import Callable
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


def bound_of(thruster: Thruster, curve: ThrustCurve, demand: Array) -> Array:
    """Bound of the thrust error [N] at demands from neutral: no thrust has no error."""
    accuracy = thruster.accuracy
    thrust = np.abs(np.asarray(curve.value(demand + thruster.neutral), dtype=np.float64))
    return np.asarray(np.minimum(accuracy.absolute + accuracy.relative * thrust, thrust), dtype=np.float64)


@dataclass(frozen=True)
class ThrustErrors:
    """Declared errors of one thruster.

    Attributes:
        bound: of the thrust error [N], as a function of demands from neutral.
        places: of the knots, as such demands, shape (knots,).
        spreads: standard deviation of the size of each error beforehand, shape (errors,).
        knots: value of each error at the knots, in units of the bound, shape (knots, errors).
    """

    bound: Callable[[Array], Array]
    places: Array
    spreads: Array
    knots: Array

    @property
    def functions(self) -> tuple[Callable[[Array], Array], ...]:
        """Thrust errors [N] of one unit of each, as functions of the demand from neutral."""
        return tuple(partial(self._one, j) for j in range(len(self.spreads)))

    def _one(self, j: int, demand: Array) -> Array:
        return np.asarray(self.bound(demand) * np.interp(demand, self.places, self.knots[:, j]))

    def at(self, demand: Array) -> Array:
        """Thrust errors [N] of one unit of each at demands from neutral, shape (errors, n)."""
        if not len(self.spreads):
            return np.zeros((0, demand.size))
        return np.asarray(
            self.bound(demand) * np.stack([np.interp(demand, self.places, column) for column in self.knots.T])
        )


def thrust_errors(thruster: Thruster, curve: ThrustCurve, demand: Array) -> ThrustErrors:
    """The declared errors of a thruster; none if no accuracy is declared.

    Args:
        thruster: with its accuracy.
        curve: its thrust curve.
        demand: of the log from neutral, over whose range the knots stand.
    """
    accuracy = thruster.accuracy
    if not accuracy.absolute and not accuracy.relative:
        return ThrustErrors(partial(bound_of, thruster, curve), np.zeros(0), np.zeros(0), np.zeros((0, 0)))
    low, high = float(demand.min()), float(demand.max())
    knots = np.linspace(low, high, KNOTS) if high > low else np.array([low])
    apart = (knots[:, None] - knots) / max(high - low, 1e-300)
    covariance = SMOOTH * np.exp(-0.5 * (apart / CORRELATED) ** 2) + (1 - SMOOTH) * np.eye(knots.size)
    values, vectors = np.linalg.eigh(covariance)

    # The smoothest first.
    order = np.argsort(-values)
    return ThrustErrors(
        partial(bound_of, thruster, curve), knots, BOUNDED * np.sqrt(values[order]), vectors[:, order].copy()
    )
