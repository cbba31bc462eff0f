"""Thrust curves: monotone tables, polynomials, quadratics and gains, each with a bound of its error (paper eq. 18)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Final, TypeAlias, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ivsid.errors import IvsidError
from ivsid.files import units
from ivsid.intervals import IntervalArray, Operand
from ivsid.propulsion.demand_unit import advice
from ivsid.vehicle import Thruster

# Slack for the interpolation in floats, as a share of the table's largest thrust, and for sums of rounded decimals.
# Source: definition: a hundred times the rounding of a cubic in float64.
ROUNDING: Final = 1e-12

# NumPy's types admit no intervals as operands of these functions, its functions do.
_Binary: TypeAlias = Callable[[IntervalArray, Operand], IntervalArray]
_maximum = cast(_Binary, np.maximum)
_minimum = cast(_Binary, np.minimum)

Curve = Callable[[NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class ThrustCurve:
    """The static curve of one thruster: thrust [N] by demand in the thruster's unit."""

    thruster: Thruster

    @cached_property
    def _table(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        table = self.thruster.table
        if table is None:
            raise IvsidError(f"thruster {self.thruster.name} has no table")
        demand = np.array(table.demand)
        thrust = np.array(table.thrust) * units.factor(table.unit, units.FORCE, "a thrust table")
        if demand[0] > 0 and thrust[0] > 0:
            demand, thrust = np.r_[0.0, demand], np.r_[0.0, thrust]
        return demand, thrust

    @cached_property
    def _curve(self) -> Curve:
        t = self.thruster
        if t.table is not None:
            return table_curve(*self._table, linear_start=t.table.demand[0] > 0 and t.table.thrust[0] > 0)
        if t.quadratic is not None:
            ahead, astern = t.quadratic.forward, t.quadratic.astern
            return lambda d: np.where(d < 0, astern, ahead) * d * np.abs(d)
        coefficients = np.array(t.polynomial if t.polynomial is not None else (t.gain, 0.0), dtype=np.float64)
        return lambda d: np.asarray(np.polyval(coefficients, d), dtype=np.float64)

    @property
    def points(self) -> tuple[list[float], list[float]]:
        """Demands from the neutral and thrusts [N] of the table, with the start at rest that it stands for.

        Raises:
            IvsidError: a thruster without a table.
        """
        demand, thrust = self._table
        return demand.tolist(), thrust.tolist()

    @property
    def pieces(self) -> tuple[list[float], list[list[float]]] | None:
        """Knots of the table's demands, and the polynomial of each piece; None without a table.

        A polynomial takes the distance from the lower knot; its coefficients stand highest power first.
        """
        if self.thruster.table is None:
            return None
        linear_start = self.thruster.table.demand[0] > 0 and self.thruster.table.thrust[0] > 0
        return table_pieces(*self._table, linear_start=linear_start)

    @property
    def formula(self) -> Callable[[float], float]:
        """The curve of a thruster without a table, as a function of one demand from its neutral."""
        t = self.thruster
        if t.quadratic is not None:
            ahead, astern = t.quadratic.forward, t.quadratic.astern
            return lambda d: (astern if d < 0 else ahead) * d * abs(d)
        coefficients = t.polynomial if t.polynomial is not None else (t.gain or 0.0, 0.0)

        def horner(d: float) -> float:
            total = 0.0
            for c in coefficients:
                total = total * d + c
            return total

        return horner

    def _modified(self, demand: NDArray[np.float64], thrust: NDArray[np.float64]) -> NDArray[np.float64]:
        """The thrust with the dead band, limit and reverse factor of the file, in the catalogue's order."""
        t = self.thruster
        if t.dead_band is not None:
            thrust = np.where(np.abs(demand) < t.dead_band, 0.0, thrust)
        if t.limit is not None:
            thrust = np.clip(thrust, -t.limit, t.limit)
        return thrust if t.reverse_factor is None else np.where(thrust < 0, thrust * t.reverse_factor, thrust)

    @property
    def range(self) -> tuple[float, float]:
        """The least and the largest demand that the curve covers, counted with the neutral."""
        t = self.thruster
        if t.table is None:
            low, high = t.demand_range or (-np.inf, np.inf)
            return low + t.neutral, high + t.neutral
        demand = self._table[0]
        return float(demand[0]) + t.neutral, float(demand[-1]) + t.neutral

    @cached_property
    def largest(self) -> float:
        """The largest |thrust| [N] of the table, or at the ends of ``demand_range``; 0 for a curve without ends."""
        if self.thruster.table is not None:
            return float(np.abs(self._table[1]).max())
        ends = self.thruster.demand_range
        return 0.0 if ends is None else float(np.abs(self._curve(np.array(ends))).max())

    def value(self, demand: ArrayLike) -> NDArray[np.float64]:
        """Thrust [N] at each demand, in plain floats, of the shape of ``demand``.

        Raises:
            IvsidError: a demand outside the table, unless the thruster says ``outside = "hold"``.
        """
        d = np.asarray(demand, dtype=np.float64)
        low, high = self.range
        self._refuse(d, (d < low) | (d > high))
        from_neutral = np.clip(d, low, high) - self.thruster.neutral
        return self._modified(from_neutral, self._curve(from_neutral))

    def _refuse(self, demand: NDArray[np.float64], outside: NDArray[np.bool_]) -> None:
        if self.thruster.outside != "hold" and outside.any():
            low, high = self.range
            what = "demand_range" if self.thruster.table is None else "table"
            unit = advice(self.thruster, (low, high), demand)
            remedy = (
                f'extend the {what}, or set outside = "hold" to keep its end values'
                if unit is None
                else ": ".join(unit)
            )
            raise IvsidError(
                f"demand {demand[outside].flat[0]:g} of thruster {self.thruster.name} lies outside its {what} ({low:g} to {high:g}); {remedy}"
            )

    def inside(
        self, least: NDArray[np.float64], most: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The ranges from ``least`` to ``most``, with demands beyond the curve moved to its ends; all of one shape.

        Raises:
            IvsidError: a demand that may lie outside the curve by more than the rounding of decimals, unless ``outside = "hold"``.
        """
        low, high = self.range
        if not np.isfinite(low) and not np.isfinite(high):
            return least, most
        # Both ends are sums of rounded decimals.
        edge = ROUNDING * max(abs(low), abs(high))
        self._refuse(least, least < low - edge)
        self._refuse(most, most > high + edge)
        below, above = np.nextafter((low, high), -np.inf), np.nextafter((low, high), np.inf)
        return (
            np.where(least < low, np.maximum(least, below[0]), np.where(least > high, below[1], least)),
            np.where(most > high, np.minimum(most, above[1]), np.where(most < low, above[0], most)),
        )

    def interval(self, demand: ArrayLike, to: ArrayLike | None = None, error: ArrayLike = 0.0) -> IntervalArray:
        """Thrust +- (absolute + relative |T|) [N] at each demand, or over all demands from it to another, of their shape.

        Args:
            demand: demands, as logged.
            to: the other ends of ranges of demands; None for single demands.
            error: largest distance of a logged demand from the one that was sent.

        Raises:
            IvsidError: a demand outside the table, as ``value``.
        """
        d = np.asarray(demand, dtype=np.float64)
        other = d if to is None else np.asarray(to, dtype=np.float64)
        reach = np.asarray(error, dtype=np.float64)
        least, most = self.inside(np.minimum(d, other) - reach, np.maximum(d, other) + reach)
        if least.ndim == 1 and least.size > 1:
            # A demand holds for many rows: each is computed once, which gives the same bits.
            new = np.r_[True, (least[1:] != least[:-1]) | (most[1:] != most[:-1])]
            first = np.flatnonzero(new)
            if 2 * first.size < least.size:
                forces = self._with_accuracy(least[first], most[first])
                times = np.diff(np.r_[first, least.size])
                return IntervalArray._raw((np.repeat(forces.lower, times), np.repeat(forces.upper, times)), least.shape)
        return self._with_accuracy(least, most)

    def _with_accuracy(self, least: NDArray[np.float64], most: NDArray[np.float64]) -> IntervalArray:
        thrust = self._modified_over(least, most, self._over(least, most))
        accuracy = self.thruster.accuracy
        radius = (accuracy.absolute + accuracy.relative * thrust.magnitude) * (1 + ROUNDING)
        return thrust + IntervalArray(-radius, radius)

    def _modified_over(
        self, low: NDArray[np.float64], high: NDArray[np.float64], thrust: IntervalArray
    ) -> IntervalArray:
        """The range of ``_modified`` over demands from ``low`` to ``high``, from that of the curve."""
        t = self.thruster
        if t.dead_band is not None:
            # Demands and band are rounded decimals: within this distance of the band's edge both sides are possible.
            edge = ROUNDING * (t.dead_band + abs(t.neutral))
            a, b = low - t.neutral, high - t.neutral
            surely_in = (a > -t.dead_band + edge) & (b < t.dead_band - edge)
            maybe_in = (a < t.dead_band + edge) & (b > -t.dead_band - edge)
            lower = np.where(surely_in, 0.0, np.where(maybe_in, np.minimum(thrust.lower, 0.0), thrust.lower))
            upper = np.where(surely_in, 0.0, np.where(maybe_in, np.maximum(thrust.upper, 0.0), thrust.upper))
            thrust = IntervalArray(lower, upper)
        if t.limit is not None:
            cap = IntervalArray.around(t.limit, np.spacing(t.limit))
            thrust = _minimum(_maximum(thrust, -cap), cap)
        if t.reverse_factor is not None:
            factor = IntervalArray.around(t.reverse_factor, np.spacing(t.reverse_factor))
            thrust = _maximum(thrust, 0.0) + _minimum(thrust, 0.0) * factor
        return thrust

    def _over(self, low: NDArray[np.float64], high: NDArray[np.float64]) -> IntervalArray:
        """The curve's range over demands from ``low`` to ``high``."""
        t = self.thruster
        if t.table is None:
            d = IntervalArray(low, high) - t.neutral
            if t.quadratic is not None:
                ahead, astern = (
                    IntervalArray.around(k, np.spacing(k)) for k in (t.quadratic.forward, t.quadratic.astern)
                )
                return _maximum(d, 0.0).square() * ahead - _minimum(d, 0.0).square() * astern
            coefficients = t.polynomial if t.polynomial is not None else (t.gain or 0.0, 0.0)
            total = IntervalArray(np.zeros(d.shape))
            for c in coefficients:
                # The interval holds the decimal of the file, which was rounded.
                total = total * d + IntervalArray.around(c, np.spacing(abs(c)))
            return total
        # The curve is monotone between its knots: its extremes stand at the ends of the range and at the knots inside.
        first, last = self.range
        ends = [self._curve(np.clip(e, first, last) - t.neutral) for e in (low, high)]
        least, most = np.asarray(np.minimum(*ends)), np.asarray(np.maximum(*ends))
        # Most ranges are far narrower than the table's steps: only those that hold a knot need more work.
        knots, thrusts = self._table[0] + t.neutral, self._table[1]
        first_knot = np.asarray(np.searchsorted(knots, low, "left"))
        past = np.asarray(np.searchsorted(knots, high, "right"))
        holding = np.flatnonzero(first_knot < past)
        while holding.size:
            thrust = thrusts[first_knot.flat[holding]]
            least.flat[holding] = np.minimum(least.flat[holding], thrust)
            most.flat[holding] = np.maximum(most.flat[holding], thrust)
            first_knot.flat[holding] += 1
            holding = holding[first_knot.flat[holding] < past.flat[holding]]
        # The table's decimals and the interpolation are rounded.
        slack = ROUNDING * self.largest
        return IntervalArray(least, most) + IntervalArray(-slack, slack)


def table_curve(demand: NDArray[np.float64], thrust: NDArray[np.float64], *, linear_start: bool = False) -> Curve:
    """A monotone piecewise cubic (PCHIP; Fritsch and Carlson 1980) through the points.

    Args:
        demand: increasing, shape (n,).
        thrust: at these demands [N], shape (n,).
        linear_start: whether the first piece is straight.
    """
    from scipy.interpolate import PchipInterpolator  # noqa: PLC0415 - slow to import, and only tables need it

    if len(demand) == 2:
        return lambda d: np.interp(d, demand, thrust)
    if not linear_start:
        return PchipInterpolator(demand, thrust)
    if len(demand) == 3:
        return lambda d: np.interp(d, demand, thrust)
    rest = PchipInterpolator(demand[1:], thrust[1:])
    slope = thrust[1] / demand[1]
    return lambda d: np.where(d < demand[1], slope * d, rest(np.maximum(d, demand[1])))


def table_pieces(
    demand: NDArray[np.float64], thrust: NDArray[np.float64], *, linear_start: bool = False
) -> tuple[list[float], list[list[float]]]:
    """Knots of ``table_curve``, and for each piece between them the coefficients of its polynomial, highest power first."""
    from scipy.interpolate import PchipInterpolator  # noqa: PLC0415 - slow to import, and only tables need it

    slopes = np.diff(thrust) / np.diff(demand)
    straight = [[float(s), float(t)] for s, t in zip(slopes, thrust[:-1], strict=True)]
    if len(demand) == 2 or (linear_start and len(demand) == 3):
        return demand.tolist(), straight
    first = 1 if linear_start else 0
    curved = PchipInterpolator(demand[first:], thrust[first:])
    return demand.tolist(), [*straight[:first], *np.asarray(curved.c).T.tolist()]
