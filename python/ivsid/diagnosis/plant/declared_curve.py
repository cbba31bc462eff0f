"""The thrust curve of one thruster with its declared errors, at given demands."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.plant.thrust_errors import ThrustErrors, bound_at
from ivsid.linear.filters import ThrustError, table_thrust
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.vehicle import Thruster

Array = NDArray[np.float64]
# Coefficients of a polynomial between two demands of a table.
# Source: definition: a cubic
POWERS: Final = 4


class DeclaredCurve:
    """The thrust of one thruster by its curve, with declared errors of given sizes.

    Args:
        thruster: whose curve it is.
        curve: without dead bands, limits and losses.
        declared: errors of the curve.
    """

    def __init__(self, thruster: Thruster, curve: ThrustCurve, declared: ThrustErrors) -> None:
        self.thruster, self.curve, self.declared = thruster, curve, declared
        # Polynomials of a table, lowest power first; other curves are formulas.
        self._pieces: tuple[list[float], list[list[float]]] | None = None
        if (found := curve.pieces) is not None:
            knots, pieces = found
            self._pieces = knots, [[*reversed(p), *[0.0] * (POWERS - len(p))] for p in pieces]

    def thrust(self, demand: Array, sizes: Sequence[float] = ()) -> Array:
        """Thrusts [N] at demands from neutral in the order of time, shape (n,).

        Args:
            demand: shape (n,).
            sizes: of the declared errors, in units of their bounds; none by default.
        """
        t = self.thruster
        if self._pieces is not None:
            return table_thrust(demand, t.neutral, *self._pieces, self._error(sizes) if any(sizes) else None)
        found = np.asarray(self.curve.value(demand + t.neutral), dtype=np.float64)
        return found + self.declared.total(demand, sizes, bound_at(t, found)) if any(sizes) else found

    def _error(self, sizes: Sequence[float]) -> ThrustError:
        accuracy, e = self.thruster.accuracy, self.declared
        values, branch = e.values(sizes)
        return accuracy.absolute, accuracy.relative, e.places, values, (e.turns, branch) if np.any(branch) else None


class ThrustAt:
    """One thruster at given demands: its thrust by the curve, and its declared errors, worked out when first asked for.

    Attributes:
        demand: from the thruster's neutral, in its own unit, shape (n,).
        kept: whether many hypotheses ask for it, so that each error is worth working out by itself.
    """

    def __init__(self, curve: DeclaredCurve, demand: Array, *, kept: bool) -> None:
        self.demand, self.kept = demand, kept
        self._curve = curve
        # Hypotheses that are compared differ in effects, and seldom in these sizes.
        self._last: tuple[tuple[float, ...], Array] | None = None

    @cached_property
    def thrust(self) -> Array:
        """Thrust by the curve [N], shape (n,)."""
        return self._curve.thrust(self.demand)

    @cached_property
    def errors(self) -> Array:
        """Thrust errors [N] of one unit of each declared error, shape (errors, n)."""
        return self._curve.declared.at(self.demand)

    def pushed(self, sizes: Sequence[float]) -> Array:
        """Thrust with declared errors of given sizes [N], shape (n,)."""
        if not any(sizes):
            return self.thrust
        if not self.kept:
            return self._curve.thrust(self.demand, sizes)
        key = tuple(sizes)
        if self._last is None or self._last[0] != key:
            self._last = key, self.thrust + np.asarray(sizes) @ self.errors
        return self._last[1]
