"""Declared errors of a thruster's curve: any continuous function of demand inside the stated accuracy.

The error is piecewise linear between knots over the demands of the log, in units of its bound. Its values at the knots are a Gaussian process
beforehand: a smooth part, and a rough part that is independent from knot to knot. The functions of the diagnosis are the eigenvectors of its
covariance, so that their sizes are independent. Values at the knots lie in [-1, 1] exactly where the error lies inside its bound.

Source: docs/theory.md, "Diagnosis"; Rasmussen and Williams, *Gaussian Processes for Machine Learning*, 2006, section 2.2; Loeve's expansion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
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


@dataclass(frozen=True)
class ThrustErrors:
    """Declared errors of one thruster.

    Attributes:
        functions: thrust errors [N] of one unit of each, as functions of the demand from neutral.
        spreads: standard deviation of the size of each beforehand, shape (functions,).
        knots: value of each at the knots, in units of the bound, shape (knots, functions).
    """

    functions: tuple[Callable[[Array], Array], ...]
    spreads: Array
    knots: Array


def bound_of(thruster: Thruster, curve: ThrustCurve, demand: Array) -> Array:
    """Bound of the thrust error [N] at demands from neutral: no thrust has no error."""
    accuracy = thruster.accuracy
    thrust = np.abs(np.asarray(curve.value(demand + thruster.neutral), dtype=np.float64))
    return np.asarray(np.minimum(accuracy.absolute + accuracy.relative * thrust, thrust), dtype=np.float64)


def thrust_errors(thruster: Thruster, curve: ThrustCurve, demand: Array) -> ThrustErrors:
    """The declared errors of a thruster; none if no accuracy is declared.

    Args:
        thruster: with its accuracy.
        curve: its thrust curve.
        demand: of the log from neutral, over whose range the knots stand.
    """
    accuracy = thruster.accuracy
    if not accuracy.absolute and not accuracy.relative:
        return ThrustErrors((), np.zeros(0), np.zeros((0, 0)))
    low, high = float(demand.min()), float(demand.max())
    knots = np.linspace(low, high, KNOTS) if high > low else np.array([low])
    apart = (knots[:, None] - knots) / max(high - low, 1e-300)
    covariance = SMOOTH * np.exp(-0.5 * (apart / CORRELATED) ** 2) + (1 - SMOOTH) * np.eye(knots.size)
    values, vectors = np.linalg.eigh(covariance)

    def shape(at_knots: Array) -> Callable[[Array], Array]:
        def error(d: Array) -> Array:
            return bound_of(thruster, curve, d) * np.interp(d, knots, at_knots)

        return error

    # The smoothest first.
    order = np.argsort(-values)
    functions = tuple(shape(vectors[:, j].copy()) for j in order)
    return ThrustErrors(functions, BOUNDED * np.sqrt(values[order]), vectors[:, order])
